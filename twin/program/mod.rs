//! Program file and the stages that process it as a stream.

mod dialect;
pub mod inputs;
mod operations;
pub mod settings;
mod source;
mod stream;
mod workpiece;

pub use dialect::{Dialect, DialectError};
pub use operations::Operations;
pub(crate) use source::Halt;
pub use stream::{ElementItem, Elements, Facts, FileFacts, ProgramItem, Setpoints};
pub(crate) use stream::{Findings, Prepared};

use crate::m_function::Acknowledgement;
use crate::spindle::{Spindle, ToolLeft};
use settings::ReadSettings;
use source::{Counted, Decoded, Decoder, Ledger};
use std::cell::RefCell;
use std::fs::File;
use std::io::{self, BufReader};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::time::SystemTime;
use stream::{Motion, Stage};
use twin_gcode::{din66025, rs274};
use twin_machine::text::{self, Text};
use twin_machine::{Along, Machine, ProgramConditions, limited_read};
use twin_path::Place;
use twin_path::prepare::{Incompatible, Notices, Preparation, Sections};
use twin_path::{Marks, PathElement};
use twin_planner::controller::{DEFAULT_CYCLE_NS, Interpolator, LookAhead};
use workpiece::ByPosition;

/// A program on disk. It is read as a stream, each time it is opened, and never held as a whole.
#[derive(Clone, Debug)]
pub struct ProgramFile {
    path: PathBuf,
    dialect: Dialect,
    settings: ReadSettings,
    stamp: Option<Stamp>,
    /// The tool that the program before has left in the spindle.
    tool: Option<ToolLeft>,
    /// A path that was made of the file before.
    made: Option<Arc<Vec<PathElement>>>,
}

/// Fingerprint of a file, to find out whether it has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stamp {
    bytes: u64,
    modified: Option<SystemTime>,
}

/// No job is longer, bytes.
const LONGEST_TEXT: u64 = 1 << 20;

impl Stamp {
    /// None if it is not a regular file.
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
    /// The program at `path`, read by `settings`. If the file changes from now on, reading it is an error: the run must
    /// execute what was checked.
    ///
    /// # Errors
    /// If the dialect is not known.
    pub fn new(
        path: &Path,
        dialect: Option<Dialect>,
        settings: ReadSettings,
    ) -> Result<Self, DialectError> {
        let dialect = match dialect {
            Some(Dialect::Dxf) => return Err(DialectError::Drawing(path.to_owned())),
            Some(dialect) => dialect,
            None => return Err(DialectError::Unknown(path.to_owned())),
        };
        let stamp = std::fs::metadata(path).ok().as_ref().and_then(Stamp::of);
        Ok(Self { path: path.to_owned(), dialect, settings, stamp, tool: None, made: None })
    }

    /// A path that was made of the drawing at `path`.
    pub fn of_drawing(path: &Path, elements: Vec<PathElement>, settings: ReadSettings) -> Self {
        let made = Some(Arc::new(elements));
        let (dialect, stamp, tool) = (Dialect::Dxf, None, None);
        Self { path: path.to_owned(), dialect, settings, stamp, tool, made }
    }

    /// The program behind one that has left this tool in the spindle.
    #[must_use]
    pub fn with_tool(self, tool: Option<ToolLeft>) -> Self {
        Self { tool, ..self }
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its read settings besides the dialect.
    pub fn settings(&self) -> &ReadSettings {
        &self.settings
    }

    /// Its dialect.
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

    /// The whole text of a job, which is short.
    ///
    /// # Errors
    /// If it cannot be read, has changed, or is not text.
    pub(crate) fn text(&self) -> io::Result<String> {
        let file = Text::open(&self.path)?;
        Stamp::verify(self.stamp, file.inner())?;
        limited_read::as_text(limited_read::all_of(file, LONGEST_TEXT)?)
    }

    /// Its path elements as programmed.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn elements(&self, conditions: &ProgramConditions) -> io::Result<Elements> {
        let (decoded, ledger) = self.decode(conditions, EmptyMoves::Kept)?;
        let decoded = self.settings.operations.apply(decoded)?;
        Ok(Elements::new(Stage::Decoded(Box::new(decoded)), Notices::default(), ledger))
    }

    /// Its path elements after preparation, with transition velocities.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn prepared(&self, conditions: &ProgramConditions) -> io::Result<Elements> {
        let notices = Notices::default();
        let (prepared, ledger) = self.prepare(conditions, &notices)?;
        Ok(Elements::new(Stage::Prepared(Box::new(prepared)), notices, ledger))
    }

    /// Its set-points on `machine`, with M functions acknowledged as `acknowledgement` says.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn open(
        &self,
        machine: &Machine,
        acknowledgement: Acknowledgement,
    ) -> io::Result<Setpoints> {
        let cycle = u32::try_from(machine.cycle_ns).ok().and_then(NonZeroU32::new);
        self.setpoints(&machine.conditions, cycle, acknowledgement)
    }

    /// Its set-points under `conditions`, one per `cycle` (ns; 1 ms if none is given).
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn setpoints(
        &self,
        conditions: &ProgramConditions,
        cycle: Option<NonZeroU32>,
        acknowledgement: Acknowledgement,
    ) -> io::Result<Setpoints> {
        let notices = Notices::default();
        let (checked, ledger) = self.prepare(conditions, &notices)?;
        let cycle = cycle.unwrap_or(DEFAULT_CYCLE_NS);
        let motion = if let Some(workpiece) = &self.settings.workpiece {
            Motion::Workpiece(Box::new(ByPosition::new(checked, workpiece, cycle)))
        } else {
            let ahead = LookAhead::with_window(checked, self.settings.look_ahead);
            Motion::Path(Box::new(Interpolator::new(ahead, cycle)))
        };
        Ok(Setpoints::new(motion, (notices, ledger), &self.settings, cycle, acknowledgement))
    }

    /// Its path after preparation, with transition velocities, for time-optimal planning, and its findings.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub(crate) fn path_for_limits(
        &self,
        conditions: &ProgramConditions,
    ) -> io::Result<(Prepared, Findings)> {
        let notices = Notices::default();
        let mut conditions = conditions.clone();
        conditions.preparation.circular = None;
        if let Some((_, along)) = &mut conditions.pace {
            *along = Along::Strongest;
        }
        let (prepared, ledger) = self.prepare(&conditions, &notices)?;
        Ok((prepared, Findings::new(notices, ledger)))
    }

    /// Result true if preparation changes the path.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn is_changed_by_preparation(&self, conditions: &ProgramConditions) -> io::Result<bool> {
        let (preparation, _) = self.preparation(conditions)?;
        let Preparation { tool_radius, loops, smoothing, rounding, circular: _ } = preparation;
        Ok(tool_radius.is_some() || loops.is_some() || smoothing.is_some() || rounding.is_some())
    }

    /// The path through all the preparation that the program asks for.
    fn prepare(
        &self,
        conditions: &ProgramConditions,
        notices: &Notices,
    ) -> io::Result<(Prepared, Rc<RefCell<Ledger>>)> {
        let (preparation, incompatible) = self.preparation(conditions)?;
        let (mut decoded, ledger) = self.decode(conditions, EmptyMoves::LeftOut)?;
        if !self.is_repeatable() && self.made.is_none() {
            decoded.unforeseen = Marks::STARTS;
        }
        let decoded = self.settings.operations.apply(decoded)?;
        if let Some((incompatible, place)) = incompatible {
            ledger.borrow_mut().report(source::incompatible(incompatible, place));
        }
        let prepared = preparation.check(decoded, conditions.angle_tolerance, notices);
        Ok((if conditions.stops { prepared } else { prepared.without_stops() }, ledger))
    }

    /// What the program's G41 to G61 ask for; nothing where sections overlap that cannot be combined, and the place of
    /// the second of them.
    fn preparation(
        &self,
        conditions: &ProgramConditions,
    ) -> io::Result<(Preparation, Option<(Incompatible, Place)>)> {
        let (marks, overlap) = match self.dialect {
            Dialect::Din66025 if self.is_repeatable() => {
                let marks = din66025::marks_in(text::lines_of(&self.path)?)?;
                if Sections::cannot_overlap(marks) {
                    (marks, None)
                } else {
                    // Perhaps only comments name them.
                    self.marks(conditions)?
                }
            }
            // What can be read only once cannot be looked through first; the others ask for nothing.
            Dialect::Din66025 | Dialect::Rs274 | Dialect::Job | Dialect::Dxf => {
                (Marks::default(), None)
            }
        };
        let preparation = match overlap {
            None => Preparation::for_marks(marks),
            Some(_) => Preparation::default(),
        };
        Ok((conditions.preparation.complete(preparation), overlap))
    }

    /// The marks of all elements together, and where the second of two sections begins that cannot be combined.
    fn marks(
        &self,
        conditions: &ProgramConditions,
    ) -> io::Result<(Marks, Option<(Incompatible, Place)>)> {
        let (decoded, _) = self.decode(conditions, EmptyMoves::LeftOut)?;
        let (mut marks, mut overlap) = (Marks::default(), None);
        let mut sections = Sections::default();
        for element in decoded.filter_map(Result::ok) {
            marks = marks.with(element.marks);
            if let Err(incompatible) = sections.pass(element.marks) {
                overlap.get_or_insert((incompatible, element.place));
            }
        }
        Ok((marks, overlap))
    }

    fn decode(
        &self,
        conditions: &ProgramConditions,
        empty: EmptyMoves,
    ) -> io::Result<(Decoded, Rc<RefCell<Ledger>>)> {
        let ledger = Rc::new(RefCell::new(Ledger::default()));
        let decoded = |decoder| Decoded {
            decoder,
            ledger: Rc::clone(&ledger),
            halted: false,
            unforeseen: Marks::default(),
            pace: conditions.pace.clone().filter(|_| self.dialect == Dialect::Rs274),
        };
        if let Some(made) = &self.made {
            let made = decoded(Decoder::Made { elements: Arc::clone(made), next: 0 });
            return Ok((made, ledger));
        }
        let file = File::open(&self.path)?;
        // Reading a directory fails later and less clearly.
        if file.metadata()?.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory"));
        }
        Stamp::verify(self.stamp, &file)?;
        let text = match self.dialect {
            Dialect::Din66025 | Dialect::Rs274 => Text::of_program(file)?,
            Dialect::Job | Dialect::Dxf => Text::binary(file),
        };
        let file = Counted { text, stamp: self.stamp, ledger: Rc::clone(&ledger) };
        let reader = BufReader::with_capacity(1 << 16, file);
        let decoded = decoded(self.decoder(reader, conditions, empty));
        Ok((decoded, ledger))
    }

    /// The spindle of `machine` at the beginning of the program; only programs of RS274 have tools of a table.
    pub fn spindle(&self, machine: &Machine) -> Spindle {
        if self.dialect != Dialect::Rs274 {
            return Spindle::default();
        }
        let options = self.rs274_options(&machine.conditions);
        Spindle::new(options.tools.unwrap_or_default(), options.tool)
    }

    /// Decoder options for DIN 66025.
    pub(crate) fn din66025_options(
        &self,
        conditions: &ProgramConditions,
    ) -> din66025::DecoderOptions {
        let ReadSettings { skip_suppressed, variables, jumps, .. } = self.settings.clone();
        din66025::DecoderOptions {
            start: conditions.start,
            start_extra: conditions.start_additional,
            skip_suppressed_blocks: skip_suppressed,
            variables,
            jumps,
        }
    }

    /// Decoder options for RS274.
    pub(crate) fn rs274_options(&self, conditions: &ProgramConditions) -> rs274::DecoderOptions {
        let ReadSettings {
            skip_suppressed, tools, jumps, depth, subroutines, control, strict, ..
        } = self.settings.clone();
        let own = self.path.parent().map(Path::to_path_buf);
        let mut options = rs274::DecoderOptions {
            skip_suppressed_blocks: skip_suppressed,
            flow_limits: rs274::FlowLimits { jumps: jumps.into(), depth },
            subroutine_folders: own.into_iter().chain(subroutines).collect(),
            strict,
            ..conditions.rs274.clone()
        };
        options.tools = tools.or(options.tools);
        options.control = control.or(options.control);
        if let Some(ToolLeft { number, offset }) = self.tool {
            (options.tool, options.tool_offset) = (number, offset);
        }
        options
    }

    fn decoder(
        &self,
        reader: BufReader<Counted>,
        conditions: &ProgramConditions,
        empty: EmptyMoves,
    ) -> Decoder {
        match self.dialect {
            Dialect::Din66025 => {
                let options = self.din66025_options(conditions);
                Decoder::Din66025(Box::new(if self.is_repeatable() {
                    din66025::Decoder::with_jumps(reader, options)
                } else {
                    din66025::Decoder::new(reader, options)
                }))
            }
            Dialect::Rs274 => {
                let options = self.rs274_options(conditions);
                let kept = empty == EmptyMoves::Kept;
                let options = rs274::DecoderOptions {
                    keep_empty_moves: kept,
                    // As little in the program as the stops of empty moves.
                    probe_settle_ns: if kept { 0 } else { options.probe_settle_ns },
                    ..options
                };
                Decoder::Rs274(Box::new(rs274::Decoder::new(reader, options)))
            }
            // A job calls blocks and has no path; the path of a drawing is made before.
            Dialect::Job | Dialect::Dxf => Decoder::Made { elements: Arc::default(), next: 0 },
        }
    }
}

/// What becomes of the moves of RS274 that go nowhere: they are in the program, but the path does not stop there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EmptyMoves {
    Kept,
    LeftOut,
}
