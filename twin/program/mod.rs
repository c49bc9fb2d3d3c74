//! A program file and the stages it streams through.

mod source;
mod stream;

pub use stream::{ElementItem, Elements, ProgramItem, Setpoints};

use crate::machine::Machine;
use crate::settings::ReadSettings;
use source::{Counted, Decoded, Ledger};
use std::cell::RefCell;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::SystemTime;
use stream::{Prepared, Stage};
use twin_motion::din66025::{self, Decoder, DecoderOptions};
use twin_motion::interpolate::{DEFAULT_CYCLE_NS, Interpolator, LookAhead};
use twin_motion::path::Marks;
use twin_motion::prepare::{Incompatible, Notices, Preparation};

/// The language of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Dialect {
    /// CoDeSys SoftMotion's dialect of DIN 66025 (.cnc)
    Din66025,
    /// Shop-floor RS274 (.ngc .nc .tap .gcode); not read yet
    Rs274,
}

/// Why a program's dialect cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum DialectError {
    /// Nothing tells which dialect it is.
    #[error("{} does not tell its dialect: its ending is none of .cnc .ngc .nc .tap .gcode and it does not begin with % and N blocks; say --dialect", .0.display())]
    Unknown(PathBuf),
    /// A dialect of a later version.
    #[error("{} is RS274 by its ending or --dialect, and RS274 is not read yet; only a program in SoftMotion's dialect can be read with --dialect din66025", .0.display())]
    NotYet(PathBuf),
}

impl Dialect {
    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Din66025 => "din66025",
            Self::Rs274 => "rs274",
        }
    }

    /// The dialect that a file's ending or, where that says nothing, its beginning tells.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn guess(path: &Path) -> io::Result<Option<Self>> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("cnc") => return Ok(Some(Self::Din66025)),
            Some("ngc" | "nc" | "tap" | "gcode") => return Ok(Some(Self::Rs274)),
            _ => {}
        }
        let mut beginning = Vec::new();
        File::open(path)?.take(4096).read_to_end(&mut beginning)?;
        let text = String::from_utf8_lossy(&beginning);
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let percent = lines.next().is_some_and(|line| line.starts_with('%'));
        let blocks = lines.find(|line| !line.starts_with(['(', '/']));
        let numbered = blocks.is_some_and(|line| line.starts_with(['N', 'n']));
        Ok((percent && numbered).then_some(Self::Din66025))
    }
}

/// A program on disk. It is read as a stream, each time it is opened, and never held as a whole.
#[derive(Clone, Debug)]
pub struct ProgramFile {
    path: PathBuf,
    dialect: Dialect,
    settings: ReadSettings,
    stamp: Option<Stamp>,
}

/// What tells whether a file is still the one that was looked at before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stamp {
    bytes: u64,
    modified: Option<SystemTime>,
}

impl Stamp {
    /// None for what is no regular file.
    fn of(metadata: &std::fs::Metadata) -> Option<Self> {
        metadata
            .is_file()
            .then(|| Self { bytes: metadata.len(), modified: metadata.modified().ok() })
    }

    fn verify(stamp: Option<Self>, file: &File) -> io::Result<()> {
        match stamp {
            Some(stamp) if Self::of(&file.metadata()?) != Some(stamp) => {
                Err(io::Error::other("the file has changed since it was first looked at"))
            }
            _ => Ok(()),
        }
    }
}

impl ProgramFile {
    /// The program at `path`, read by `settings`. Should the file change from now on, reading it is an error: what is run must be what was checked.
    ///
    /// # Errors
    /// If the dialect is not known or not read yet.
    pub fn new(
        path: &Path,
        dialect: Option<Dialect>,
        settings: ReadSettings,
    ) -> Result<Self, DialectError> {
        match dialect {
            Some(dialect @ Dialect::Din66025) => {
                let stamp = std::fs::metadata(path).ok().as_ref().and_then(Stamp::of);
                Ok(Self { path: path.to_owned(), dialect, settings, stamp })
            }
            Some(Dialect::Rs274) => Err(DialectError::NotYet(path.to_owned())),
            None => Err(DialectError::Unknown(path.to_owned())),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How it is read.
    pub fn dialect(&self) -> Dialect {
        self.dialect
    }

    /// True if it can be read more than once: a regular file, no pipe.
    pub fn is_repeatable(&self) -> bool {
        self.stamp.is_some()
    }

    /// Its size, bytes.
    ///
    /// # Errors
    /// If there is no such file.
    pub fn size(&self) -> io::Result<u64> {
        Ok(std::fs::metadata(&self.path)?.len())
    }

    /// Its path elements as programmed, starting at `start` (m, work frame).
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn elements(&self, start: [f64; 3]) -> io::Result<Elements> {
        let (decoded, ledger) = self.decode(start)?;
        Ok(Elements::new(Stage::Decoded(Box::new(decoded)), Notices::default(), ledger))
    }

    /// Its path elements after preparation, with transition velocities for turns of up to `angle_tolerance` (rad).
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn prepared(&self, start: [f64; 3], angle_tolerance: f64) -> io::Result<Elements> {
        let notices = Notices::default();
        let (prepared, ledger) = self.prepare(start, angle_tolerance, &notices)?;
        Ok(Elements::new(Stage::Prepared(Box::new(prepared)), notices, ledger))
    }

    /// Its set-points on `machine`.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn open(&self, machine: &Machine) -> io::Result<Setpoints> {
        let notices = Notices::default();
        let (checked, ledger) = self.prepare(machine.start, machine.angle_tolerance, &notices)?;
        let cycle = u32::try_from(machine.cycle_ns)
            .ok()
            .and_then(NonZeroU32::new)
            .unwrap_or(DEFAULT_CYCLE_NS);
        let interpolator = Interpolator::new(LookAhead::new(checked), cycle);
        Ok(Setpoints::new(interpolator, notices, ledger))
    }

    /// The path through all the preparation that the program asks for.
    fn prepare(
        &self,
        start: [f64; 3],
        angle_tolerance: f64,
        notices: &Notices,
    ) -> io::Result<(Prepared, Rc<RefCell<Ledger>>)> {
        let (preparation, incompatible) = self.preparation(start)?;
        let (decoded, ledger) = self.decode(start)?;
        if let Some(incompatible) = incompatible {
            ledger.borrow_mut().report(source::incompatible(incompatible));
        }
        // What cannot be combined has been left out.
        let prepared = preparation
            .check(decoded, angle_tolerance, notices)
            .map_err(|error| io::Error::other(error.to_string()))?;
        Ok((prepared, ledger))
    }

    /// What the program's G41 to G61 ask for; without what cannot be combined, and that.
    fn preparation(&self, start: [f64; 3]) -> io::Result<(Preparation, Option<Incompatible>)> {
        // What can be read only once is prepared for the most usual.
        let mut marks = Marks::CORRECTION_LEFT.with(Marks::LOOPS);
        if self.is_repeatable() {
            marks = din66025::marks_in(BufReader::with_capacity(1 << 16, File::open(&self.path)?))?;
            if Preparation::for_marks(marks).is_err() {
                // Perhaps only comments name them together.
                let (decoded, _) = self.decode(start)?;
                marks = decoded
                    .filter_map(Result::ok)
                    .fold(Marks::default(), |marks, element| marks.with(element.marks));
            }
        }
        Ok(match Preparation::for_marks(marks) {
            Ok(preparation) => (preparation, None),
            Err(incompatible) => (Preparation::default(), Some(incompatible)),
        })
    }

    fn decode(&self, start: [f64; 3]) -> io::Result<(Decoded, Rc<RefCell<Ledger>>)> {
        let ledger = Rc::new(RefCell::new(Ledger::default()));
        let file = File::open(&self.path)?;
        // Reading a directory fails later and less clearly.
        if file.metadata()?.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory"));
        }
        Stamp::verify(self.stamp, &file)?;
        let file = Counted { file, stamp: self.stamp, ledger: Rc::clone(&ledger) };
        let ReadSettings { skip_suppressed, variables, jumps } = self.settings.clone();
        let options = DecoderOptions {
            start,
            skip_suppressed_blocks: skip_suppressed,
            variables,
            jumps,
            ..DecoderOptions::default()
        };
        let reader = BufReader::with_capacity(1 << 16, file);
        let decoder = if self.is_repeatable() {
            Decoder::with_jumps(reader, options)
        } else {
            Decoder::new(reader, options)
        };
        Ok((Decoded { decoder, ledger: Rc::clone(&ledger), halted: false }, ledger))
    }
}
