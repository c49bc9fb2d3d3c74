//! A program file and the stages it streams through.

use crate::finding::{Finding, Rule, Severity};
use crate::machine::Machine;
use crate::settings::ReadSettings;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::SystemTime;
use twin_motion::decode::{self, Diagnostic, TextError};
use twin_motion::din66025::{self, Decoder, DecoderOptions};
use twin_motion::interpolate::{DEFAULT_CYCLE_NS, Interpolator, LookAhead, ToolSetpoint};
use twin_motion::path::{ElementKind, PathElement};
use twin_motion::prepare::{CheckError, CheckVelocities};

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

    /// Its path elements, starting at `start` (m, work frame); with an angle tolerance (rad) also their transition
    /// velocities.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn elements(&self, start: [f64; 3], angle_tolerance: Option<f64>) -> io::Result<Elements> {
        let (decoded, ledger) = self.decode(start)?;
        let stage = match angle_tolerance {
            None => Stage::Decoded(Box::new(decoded)),
            Some(tolerance) => Stage::Prepared(Box::new(CheckVelocities::new(decoded, tolerance))),
        };
        Ok(Elements { stage, ledger })
    }

    /// Its set-points on `machine`.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn open(&self, machine: &Machine) -> io::Result<Setpoints> {
        let (decoded, ledger) = self.decode(machine.start)?;
        let checked = CheckVelocities::new(decoded, machine.angle_tolerance);
        let cycle = u32::try_from(machine.cycle_ns)
            .ok()
            .and_then(NonZeroU32::new)
            .unwrap_or(DEFAULT_CYCLE_NS);
        Ok(Setpoints { interpolator: Interpolator::new(LookAhead::new(checked), cycle), ledger })
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

/// What the stages leave behind for whoever reads the stream.
#[derive(Debug, Default)]
struct Ledger {
    bytes: u64,
    elements: u64,
    length: f64,
    findings: VecDeque<Finding>,
    errors: usize,
    warnings: usize,
    left_out: u64,
}

/// More diagnostics of one severity than this are counted, not kept, so that a file that is wrong on every line takes
/// no more memory than another.
const MAX_DIAGNOSTICS: usize = 1000;

impl Ledger {
    fn report(&mut self, finding: Finding) {
        let count = match finding.severity {
            Severity::Error => &mut self.errors,
            Severity::Warning | Severity::Note => &mut self.warnings,
        };
        if *count == MAX_DIAGNOSTICS {
            self.left_out += 1;
        } else {
            *count += 1;
            self.findings.push_back(finding);
        }
    }
}

/// Counts what is read, and stops if somebody writes to the file meanwhile.
#[derive(Debug)]
struct Counted {
    file: File,
    stamp: Option<Stamp>,
    ledger: Rc<RefCell<Ledger>>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        Stamp::verify(self.stamp, &self.file)?;
        self.ledger.borrow_mut().bytes += u64::try_from(count).unwrap_or(u64::MAX);
        Ok(count)
    }
}

impl Seek for Counted {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// What ends a stream early.
#[derive(Debug)]
enum Halt {
    Io(io::Error),
    Check(CheckError),
}

impl From<CheckError> for Halt {
    fn from(error: CheckError) -> Self {
        Self::Check(error)
    }
}

impl Halt {
    fn finding(error: &CheckError) -> Finding {
        let place = match error {
            CheckError::NonPositiveLimit { place, .. }
            | CheckError::EndVelocity { place, .. }
            | CheckError::Length { place, .. } => *place,
        };
        Finding::error(Rule::Syntax, place, error.to_string())
    }
}

/// The decoder with its diagnostics taken out, so that an erroneous block does not end the stream: all errors of a
/// program are found at once.
#[derive(Debug)]
struct Decoded {
    decoder: Decoder<BufReader<Counted>>,
    ledger: Rc<RefCell<Ledger>>,
    /// After an element that nobody would wait for, only diagnostics follow.
    halted: bool,
}

/// No single move takes longer than this, s: a day. What does is a slip of the pen (`J999999999`, `F0.0000001`,
/// `E0.0000001`), and sampling it every millisecond would take the check as long.
const LONGEST_MOVE: f64 = 86_400.0;

/// What is wrong with an element that takes absurdly long.
fn endless(element: &PathElement) -> Option<Finding> {
    let length = element.length();
    if !(element.feed > 0.0 && element.acceleration > 0.0 && element.deceleration > 0.0) {
        return None;
    }
    // At the feed, and from rest to rest without ever reaching it.
    let cruise = length / element.feed;
    let ramps = (2.0 * length * (1.0 / element.acceleration + 1.0 / element.deceleration)).sqrt();
    let time = cruise.max(ramps);
    (time > LONGEST_MOVE).then(|| {
        let (length, feed) = (length * 1e3, element.feed * 1e3);
        let (up, down) = (element.acceleration * 1e3, element.deceleration * 1e3);
        let pace =
            if cruise >= ramps { format!("F{feed}") } else { format!("E{up} and E-{down}") };
        let message = format!(
            "this move is {length:.1} mm long and would take {time:.0} s with {pace}; the limit for one move is \
             {LONGEST_MOVE:.0} s, and what follows is not planned"
        );
        Finding::error(Rule::Syntax, element.place, message).with_value(time, LONGEST_MOVE, "s")
    })
}

impl Iterator for Decoded {
    type Item = Result<PathElement, Halt>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.decoder.next()? {
                Ok(din66025::Item::Element(element)) => {
                    if self.halted {
                        continue;
                    }
                    let mut ledger = self.ledger.borrow_mut();
                    if let Some(finding) = endless(&element) {
                        ledger.report(finding);
                        self.halted = true;
                        continue;
                    }
                    ledger.elements += 1;
                    if element.kind != ElementKind::Jump {
                        ledger.length += element.length();
                    }
                    return Some(Ok(element));
                }
                Ok(din66025::Item::Warning(diagnostic)) => {
                    let finding = Finding { severity: Severity::Warning, ..finding(&diagnostic) };
                    self.ledger.borrow_mut().report(finding);
                }
                Err(din66025::Failure::Io(error)) => return Some(Err(Halt::Io(error))),
                Err(din66025::Failure::Diagnostic(diagnostic)) => {
                    self.ledger.borrow_mut().report(finding(&diagnostic));
                }
            }
        }
    }
}

/// A diagnostic of a decoder as a finding.
fn finding<E: TextError>(diagnostic: &Diagnostic<E>) -> Finding {
    let rule = match diagnostic.error.rule() {
        decode::Rule::Syntax => Rule::Syntax,
        decode::Rule::UnsupportedWord => Rule::UnsupportedWord,
        decode::Rule::ArcGeometry => Rule::ArcGeometry,
    };
    let mut finding = Finding::error(rule, diagnostic.place, diagnostic.error.to_string());
    finding.columns.clone_from(&diagnostic.columns);
    finding
}

/// Path elements of a program.
#[derive(Debug)]
pub struct Elements {
    stage: Stage,
    ledger: Rc<RefCell<Ledger>>,
}

impl Elements {
    /// Diagnostics of the text that were left out because there are too many.
    pub fn left_out(&self) -> u64 {
        self.ledger.borrow().left_out
    }
}

#[derive(Debug)]
enum Stage {
    Decoded(Box<Decoded>),
    Prepared(Box<CheckVelocities<Decoded, Halt>>),
}

/// What comes out of [`Elements`].
#[derive(Debug)]
pub enum ElementItem {
    /// The next element.
    Element(PathElement),
    /// Something wrong with the program; the elements after it follow.
    Diagnostic(Finding),
    /// The file cannot be read any further.
    Io(io::Error),
}

impl Iterator for Elements {
    type Item = ElementItem;

    fn next(&mut self) -> Option<ElementItem> {
        if let Some(finding) = self.ledger.borrow_mut().findings.pop_front() {
            return Some(ElementItem::Diagnostic(finding));
        }
        let next = match &mut self.stage {
            Stage::Decoded(decoded) => decoded.next(),
            Stage::Prepared(prepared) => prepared
                .next()
                .map(|next| next.map(twin_motion::prepare::CheckedElement::into_element)),
        };
        match next {
            Some(Ok(element)) => Some(ElementItem::Element(element)),
            Some(Err(Halt::Io(error))) => Some(ElementItem::Io(error)),
            Some(Err(Halt::Check(error))) => Some(ElementItem::Diagnostic(Halt::finding(&error))),
            None => self.ledger.borrow_mut().findings.pop_front().map(ElementItem::Diagnostic),
        }
    }
}

/// Set-points of a program, one per cycle.
#[derive(Debug)]
pub struct Setpoints {
    interpolator: Interpolator<LookAhead<CheckVelocities<Decoded, Halt>, Halt>, Halt>,
    ledger: Rc<RefCell<Ledger>>,
}

/// What comes out of [`Setpoints`].
#[derive(Debug)]
pub enum ProgramItem {
    /// The next set-point.
    Setpoint(ToolSetpoint),
    /// Something wrong with the program; the set-points after it follow the path as if the block were not there.
    Diagnostic(Finding),
    /// The file cannot be read any further.
    Io(io::Error),
}

impl Setpoints {
    /// Brakes along the path and ends.
    pub fn request_stop(&mut self) {
        self.interpolator.request_stop();
    }

    /// Path elements decoded so far.
    pub fn elements(&self) -> u64 {
        self.ledger.borrow().elements
    }

    /// Length of the path decoded so far, m.
    pub fn length(&self) -> f64 {
        self.ledger.borrow().length
    }

    /// Diagnostics of the text that were left out because there are too many.
    pub fn left_out(&self) -> u64 {
        self.ledger.borrow().left_out
    }

    /// Bytes of the file read so far.
    pub fn bytes_read(&self) -> u64 {
        self.ledger.borrow().bytes
    }
}

impl Iterator for Setpoints {
    type Item = ProgramItem;

    fn next(&mut self) -> Option<ProgramItem> {
        let waiting = self.ledger.borrow_mut().findings.pop_front();
        if let Some(finding) = waiting {
            return Some(ProgramItem::Diagnostic(finding));
        }
        match self.interpolator.next() {
            Some(Ok(setpoint)) => Some(ProgramItem::Setpoint(setpoint)),
            Some(Err(Halt::Io(error))) => Some(ProgramItem::Io(error)),
            Some(Err(Halt::Check(error))) => Some(ProgramItem::Diagnostic(Halt::finding(&error))),
            None => self.ledger.borrow_mut().findings.pop_front().map(ProgramItem::Diagnostic),
        }
    }
}
