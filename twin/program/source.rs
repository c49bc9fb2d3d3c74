//! Program text source: reads, counts and decodes the text, and separates its diagnostics.

use super::Stamp;
use super::stream::FileFacts;
use crate::finding::{Finding, Rule, Severity};
use crate::spindle::ToolLeft;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::rc::Rc;
use std::sync::Arc;
use twin_gcode::decode;
use twin_gcode::decode::{Diagnostic, Failure, Item, TextError};
use twin_gcode::{din66025, rs274};
use twin_machine::text::Text;
use twin_machine::{Along, AxisPace};
use twin_path::Place;
use twin_path::prepare::{CheckError, CornerError, Incompatible, Notice, ToolRadiusError};
use twin_path::{ElementKind, Marks, OperationError, PathElement, ProbeOutcome, ProbeTrip};

/// Facts and findings that the stages record for the reader of the stream.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    pub(super) bytes: u64,
    pub(super) elements: u64,
    pub(super) length: f64,
    pub(super) findings: VecDeque<Finding>,
    errors: usize,
    warnings: usize,
    pub(super) left_out: u64,
    pub(super) facts: FileFacts,
    /// The tool that an RS274 program leaves in the spindle, after all of it has been read.
    pub(super) tool: Option<ToolLeft>,
}

/// More diagnostics of one severity than this are counted, not kept, so that a file that is wrong on every line takes
/// no more memory than another.
const MAX_DIAGNOSTICS: usize = 1000;

impl Ledger {
    pub(super) fn report(&mut self, finding: Finding) {
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

/// Reader that counts bytes, and fails if the file changes meanwhile.
#[derive(Debug)]
pub(super) struct Counted {
    pub(super) text: Text<File>,
    pub(super) stamp: Option<Stamp>,
    pub(super) ledger: Rc<RefCell<Ledger>>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.text.read(buffer)?;
        Stamp::verify(self.stamp, self.text.inner())?;
        self.ledger.borrow_mut().bytes += u64::try_from(count).unwrap_or(u64::MAX);
        Ok(count)
    }
}

impl Seek for Counted {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.text.seek(to)
    }
}

/// Reasons that end a stream early.
#[derive(Debug)]
pub(crate) enum Halt {
    Io(io::Error),
    /// A stage cannot go on.
    Finding(Box<Finding>),
}

impl Halt {
    fn stage(place: Place, error: &dyn std::error::Error) -> Self {
        Self::Finding(Box::new(Finding::error(Rule::Syntax, place, without_place(place, error))))
    }
}

/// What stages say begins with the place, which findings say themselves.
fn without_place(place: Place, said: &dyn std::fmt::Display) -> String {
    let said = said.to_string();
    said.strip_prefix(&format!("{place}: ")).unwrap_or(&said).to_owned()
}

impl From<CheckError> for Halt {
    fn from(error: CheckError) -> Self {
        Self::stage(error.place(), &error)
    }
}

impl From<ToolRadiusError> for Halt {
    fn from(error: ToolRadiusError) -> Self {
        Self::stage(error.place(), &error)
    }
}

impl From<OperationError> for Halt {
    fn from(error: OperationError) -> Self {
        let place = match error {
            OperationError::UprightArc(place) | OperationError::SplitProbe(place) => place,
            OperationError::Factor(_) | OperationError::SplitPlace(_) => Place::at(1),
        };
        Self::stage(place, &error)
    }
}

impl From<io::Error> for Halt {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<CornerError> for Halt {
    fn from(error: CornerError) -> Self {
        Self::stage(error.place(), &error)
    }
}

/// Notice of preparation as a finding; it is an error where the tool damages the part.
pub(super) fn noticed(notice: &Notice) -> Finding {
    let place = notice.place();
    let (rule, severity) = match notice {
        Notice::Gouge { .. } => (Rule::CompensationGouge, Severity::Error),
        Notice::TooNarrow { .. } => (Rule::CompensationGouge, Severity::Warning),
        Notice::NoRadius { .. } => (Rule::Syntax, Severity::Warning),
        Notice::LoopCut { .. } => (Rule::LoopCut, Severity::Note),
        Notice::SwitchLost { .. } => (Rule::SwitchLost, Severity::Warning),
    };
    Finding { severity, ..Finding::error(rule, place, without_place(place, notice)) }
}

/// Overlapping sections of stages that cannot be combined.
pub(super) fn incompatible(error: Incompatible, place: Place) -> Finding {
    let message = format!("{error}; end the first section (G40 or G50) before the second begins");
    Finding::error(Rule::Syntax, place, message)
}

/// Decoder of a program's file.
#[derive(Debug)]
pub(super) enum Decoder {
    Din66025(Box<din66025::Decoder<BufReader<Counted>>>),
    Rs274(Box<rs274::Decoder<BufReader<Counted>>>),
    /// Elements that are there already.
    Made {
        elements: Arc<Vec<PathElement>>,
        next: usize,
    },
}

/// What it makes of the next piece of it.
enum Piece {
    Element(PathElement),
    Wrong(Finding),
    Failed(io::Error),
}

impl Piece {
    fn of<E: TextError>(item: Result<Item<E>, Failure<E>>) -> Self {
        match item {
            Ok(Item::Element(element)) => Self::Element(element),
            Ok(Item::Warning(diagnostic)) => {
                let severity =
                    if diagnostic.error.is_note() { Severity::Note } else { Severity::Warning };
                Self::Wrong(Finding { severity, ..finding(&diagnostic) })
            }
            Err(Failure::Diagnostic(diagnostic)) => Self::Wrong(finding(&diagnostic)),
            Err(Failure::Io(error)) => Self::Failed(error),
        }
    }
}

impl Decoder {
    fn facts(&self) -> FileFacts {
        match self {
            Self::Din66025(decoder) => {
                FileFacts { name: decoder.name().map(str::to_owned), lines: decoder.lines() }
            }
            Self::Rs274(decoder) => FileFacts {
                name: decoder.program_number().map(|number| format!("O{number}")),
                lines: decoder.lines(),
            },
            Self::Made { .. } => FileFacts::default(),
        }
    }

    fn tool_left(&self) -> Option<ToolLeft> {
        match self {
            Self::Rs274(decoder) => {
                Some(ToolLeft { number: decoder.tool(), offset: *decoder.tool_offset() })
            }
            Self::Din66025(_) | Self::Made { .. } => None,
        }
    }

    fn read(&mut self) -> Option<Piece> {
        match self {
            Self::Din66025(decoder) => decoder.next().map(Piece::of),
            Self::Rs274(decoder) => decoder.next().map(Piece::of),
            Self::Made { elements, next } => {
                let element = elements.get(*next)?.clone();
                *next += 1;
                Some(Piece::Element(element))
            }
        }
    }
}

/// The decoder with its diagnostics taken out, so that an erroneous block does not end the stream: all errors of a
/// program are found at once.
#[derive(Debug)]
pub(crate) struct Decoded {
    pub(super) decoder: Decoder,
    pub(super) ledger: Rc<RefCell<Ledger>>,
    /// True after an element with an absurd duration; only diagnostics follow.
    pub(super) halted: bool,
    /// Marks of what has not been prepared for, because the file cannot be looked through first.
    pub(super) unforeseen: Marks,
    /// Limits of the axes, where the language leaves velocities or accelerations open.
    pub(super) pace: Option<(Arc<AxisPace>, Along)>,
}

/// No single move takes longer than this, s: a day. What does is a slip of the pen (`J999999999`, `F0.0000001`,
/// `E0.0000001`), and sampling it every millisecond would take the check as long.
const LONGEST_MOVE: f64 = 86_400.0;

/// Preparation begins where nobody has looked for it.
const UNFORESEEN: &str =
    "preparation begins here and reads the program twice: it must be a file, not a pipe";

/// Error of an element that takes absurdly long.
fn endless(element: &PathElement) -> Option<Finding> {
    if let ElementKind::Dwell { time_ns } = element.kind {
        let time = twin_number::seconds(time_ns);
        return (time > LONGEST_MOVE).then(|| {
            let message = format!(
                "this dwell takes {time:.0} s; the limit is {LONGEST_MOVE:.0} s, and what follows is not planned"
            );
            Finding::error(Rule::Syntax, element.place, message).with_value(time, LONGEST_MOVE, "s")
        });
    }
    let length = element.length();
    if !(element.feed > 0.0 && element.acceleration > 0.0 && element.deceleration > 0.0) {
        return None;
    }
    // At the feed, and from rest to rest without ever reaching it.
    let cruise = length / element.feed;
    let ramps = (2.0 * length * (1.0 / element.acceleration + 1.0 / element.deceleration)).sqrt();
    let time = cruise.max(ramps);
    (time > LONGEST_MOVE).then(|| {
        // Additional axes alone move in mm or degrees.
        let unit = if element.tool_length() > 0.0 { "mm" } else { "mm or degrees" };
        let (length, feed) = (length * 1e3, element.feed * 1e3);
        let (up, down) = (element.acceleration * 1e3, element.deceleration * 1e3);
        let pace =
            if cruise >= ramps { format!("F{feed}") } else { format!("E{up} and E-{down}") };
        let message = format!(
            "this move is {length:.1} {unit} long and would take {time:.0} s with {pace}; the limit for one move is \
             {LONGEST_MOVE:.0} s, and what follows is not planned"
        );
        Finding::error(Rule::Syntax, element.place, message).with_value(time, LONGEST_MOVE, "s")
    })
}

/// Where the probe of a probing move trips, if it does.
fn tripped(element: &PathElement) -> Option<Finding> {
    let ElementKind::Probe { probing, outcome: ProbeOutcome::Tripped } = element.kind else {
        return None;
    };
    let what = match probing.trips {
        ProbeTrip::Touch => "touches",
        ProbeTrip::Release => "comes free",
    };
    // To the micrometre; adding 0 turns −0 into 0.
    let [x, y, z] = element.end().coords.map(|metres| (metres * 1e6).round() / 1e3 + 0.0).into();
    let message = format!("probe {what} at X {x:.3} Y {y:.3} Z {z:.3} mm");
    let finding = Finding::error(Rule::Probe, element.place, message);
    Some(Finding { severity: Severity::Note, ..finding })
}

impl Iterator for Decoded {
    type Item = Result<PathElement, Halt>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let Some(piece) = self.decoder.read() else {
                let mut ledger = self.ledger.borrow_mut();
                (ledger.facts, ledger.tool) = (self.decoder.facts(), self.decoder.tool_left());
                return None;
            };
            let mut element = match piece {
                Piece::Element(element) => element,
                Piece::Wrong(finding) => {
                    self.ledger.borrow_mut().report(finding);
                    continue;
                }
                Piece::Failed(error) => return Some(Err(Halt::Io(error))),
            };
            if self.halted {
                continue;
            }
            if let Some((pace, along)) = &self.pace {
                pace.limit(&mut element, *along);
            }
            let mut ledger = self.ledger.borrow_mut();
            if let Some(finding) = endless(&element) {
                ledger.report(finding);
                self.halted = true;
                continue;
            }
            if element.marks.0 & self.unforeseen.0 != 0 {
                self.unforeseen = Marks::default();
                ledger.report(Finding::error(Rule::Syntax, element.place, UNFORESEEN.to_owned()));
            }
            if let Some(finding) = tripped(&element) {
                ledger.report(finding);
            }
            ledger.elements += 1;
            ledger.length += element.tool_length();
            return Some(Ok(element));
        }
    }
}

/// A diagnostic of a decoder as a finding.
fn finding<E: TextError>(diagnostic: &Diagnostic<E>) -> Finding {
    let rule = match diagnostic.error.rule() {
        decode::Rule::Syntax => Rule::Syntax,
        decode::Rule::UnsupportedWord => Rule::UnsupportedWord,
        decode::Rule::ArcGeometry => Rule::ArcGeometry,
        decode::Rule::Probe => Rule::Probe,
        decode::Rule::CompensationGouge => Rule::CompensationGouge,
        decode::Rule::Control => Rule::Control,
    };
    let mut finding = Finding::error(rule, diagnostic.place, diagnostic.error.to_string());
    finding.columns.clone_from(&diagnostic.columns);
    finding.hint = diagnostic.error.hint();
    finding
}
