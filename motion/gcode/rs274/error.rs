//! Decode errors and warnings, with line and columns.

use super::control::ControlFinding;
use super::expression::ExpressionError;
use super::flow::FlowError;
use super::leniency::Leniency;
use super::message::Message;
use super::parameters::ParameterError;
use super::settings::OffsetError;
use crate::decode;
use crate::decode::{Rule, TextError};
use std::ops::Range;
use twin_number::{Short, counted};
use twin_path::{Place, ProbeTrip, Probing};

/// One thing wrong with a block.
pub type Diagnostic = decode::Diagnostic<DecodeError>;
/// Reason why the decoder has no element.
pub type Failure = decode::Failure<DecodeError>;
/// Output item of the decoder.
pub type Item = decode::Item<DecodeError>;

/// Error or warning of a block. Numbers are in the units of the program unless said otherwise.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DecodeError {
    /// A line without end.
    #[error("the line is longer than {0} bytes")]
    LineTooLong(usize),
    /// A character that begins no word.
    #[error("{0:?} is not part of a word: a block is made of letters followed by numbers")]
    UnexpectedCharacter(char),
    /// A byte that is not text.
    #[error("byte {0:#04x} is neither ASCII nor UTF-8 text")]
    UnexpectedByte(u8),
    /// `(` without `)`.
    #[error("the comment is not closed with ) in its line")]
    UnclosedComment,
    /// `(` within a comment.
    #[error("comments cannot be nested")]
    NestedComment,
    /// The file ends, and the program does not.
    #[error("the program does not end with M2, M30 or a second %")]
    MissingEnd,
    /// The program ends with `%` only.
    #[error("the program ends with %, and must begin with it then")]
    MissingPercent,
    /// What LinuxCNC refuses and is read nevertheless. A warning.
    #[error("{0} (LinuxCNC refuses it)")]
    Lenient(Leniency),
    /// What the control of the program does not take as LinuxCNC does. A warning unless it refuses it.
    #[error("{0}")]
    OfControl(ControlFinding),
    /// A warning that comes again.
    #[error("{error}; {} more, last in line {last}", counted(*more, "time"))]
    Repeated {
        /// The warning.
        error: Box<DecodeError>,
        /// How often it comes after this line.
        more: usize,
        /// The last line with it.
        last: u32,
    },
    /// A letter without its number.
    #[error("a number must follow after {0}")]
    MissingNumber(char),
    /// The letter is not followed by a number.
    #[error("what follows {0} is not a number")]
    InvalidNumber(char),
    /// N is not followed by a block number.
    #[error("a whole number must follow after N")]
    InvalidBlockNumber,
    /// An N word that does not open the block.
    #[error("N must be the first word of its block")]
    MisplacedBlockNumber,
    /// A fraction where only whole numbers are allowed.
    #[error("{letter} takes a whole number, not {}", Short(*value))]
    NotWhole {
        /// The word's letter.
        letter: char,
        /// Its number.
        value: f64,
    },
    /// A number, or the position it leads to, out of range.
    #[error("{letter} is {}{unit}, outside {}{unit} to {}{unit}", Short(*value), Short(*min), Short(*max))]
    OutOfRange {
        /// The word's letter.
        letter: char,
        /// Its number.
        value: f64,
        /// Smallest number allowed.
        min: f64,
        /// Largest number allowed.
        max: f64,
        /// Unit with a blank before it, or nothing.
        unit: &'static str,
    },
    /// The same letter twice.
    #[error("a second {0} word in one block")]
    RepeatedWord(char),
    /// Two words of one modal group.
    #[error(
        "{letter}{number} contradicts another {letter} word of this block: they belong to one modal group"
    )]
    Conflict {
        /// G or M.
        letter: char,
        /// Number of the second of them.
        number: f64,
    },
    /// More M words than a line may have.
    #[error("a block has at most {0} M words")]
    TooManyMWords(u8),
    /// A word that nothing in its line uses.
    #[error("{0} has no effect in this block")]
    UnusedWord(char),
    /// Axis words, but no motion is in force.
    #[error("axis words without a motion: no G0, G1, G2, G3 or canned cycle is in force")]
    AxesWithoutMotion,
    /// `@` or `^` in a block that does not move, or with G28, G30, G53 or G92.
    #[error("polar coordinates (@ and ^) are for motions, and not with G28, G30, G53 or G92")]
    PolarWithoutMotion,
    /// `@` or `^` in another plane than that of X and Y.
    #[error("polar coordinates (@ and ^) need the plane G17: write it in a block before")]
    PolarOutsideXy,
    /// `@` or `^` and X or Y.
    #[error("polar coordinates (@ and ^) cannot be used with X or Y in one block")]
    PolarAndCoordinate,
    /// `@` alone, or incremental, at the origin.
    #[error(
        "the angle is undetermined: the tool is at the origin of the polar coordinates; write both @ and ^, with G90"
    )]
    PolarAtOrigin,
    /// Repetitions of an incremental polar canned cycle.
    #[error("L above 1 cannot be used with incremental polar coordinates: write a loop")]
    PolarRepeated,
    /// G28, G30 or G92 together with a motion.
    #[error(
        "G{0} and another G word of this block both use its axis words: write them in two blocks"
    )]
    AxesUsedTwice(f64),
    /// No axis word where one is needed.
    #[error("G{0} needs an axis word")]
    MissingAxes(f64),
    /// Feed motion before any F, or after G94 without a new one. Reported once until there is an F.
    #[error("motion without a feed: F has not been set, or not since G94")]
    MissingFeed,
    /// Feed motion with F0.
    #[error("motion without a feed: F is 0")]
    ZeroFeed,
    /// G93 without F.
    #[error("with inverse time (G93) every block with feed motion needs its F")]
    MissingInverseTime,
    /// G93 and a canned cycle.
    #[error("canned cycles cannot be used with inverse time (G93)")]
    InverseTimeCycle,
    /// M66 with P and E.
    #[error("M66 reads one input: either the digital one of P or the analog one of E")]
    WaitForTwoInputs,
    /// M66 that waits for an analog input.
    #[error("M66 cannot wait for an analog input (E): leave L out, or use L0")]
    WaitForAnalog,
    /// M66 that waits without end.
    #[error("M66 with L1 to L4 needs its longest waiting time Q in seconds, more than 0")]
    WaitWithoutTimeout,
    /// M72 without M70 or M73.
    #[error(
        "M72 has nothing to restore: save the modal state with M70 or M73 in the same subroutine first"
    )]
    NoSavedModes,
    /// M72 with other words.
    #[error("M72 needs a block of its own: LinuxCNC leaves out the words next to it")]
    WordsWithRestore,
    /// One of two words of a spline that belong together.
    #[error("G{number} needs both {first} and {second}")]
    IncompleteSpline {
        /// Number behind G.
        number: f64,
        /// Letter of the one.
        first: char,
        /// Letter of the other.
        second: char,
    },
    /// G5 or G5.1 with G18 or G19.
    #[error("G5 and G5.1 make curves in X and Y: select their plane with G17 first")]
    SplineOutsideXy,
    /// P alone within a NURBS.
    #[error(
        "P without X and Y is the weight of the first control point: write it in the block that begins the curve"
    )]
    WeightOfStart,
    /// G5.3 without G5.2.
    #[error("G5.3 ends no curve: begin one with G5.2")]
    NurbsNotBegun,
    /// Another motion, or the end of the program, behind G5.2.
    #[error(
        "the curve of G5.2 must end with G5.3, in a block without another motion, before anything else moves"
    )]
    NurbsNotEnded,
    /// Something has moved the tool between G5.2 and G5.3.
    #[error("the tool has left the start of its curve: nothing may move it between G5.2 and G5.3")]
    NurbsLeft,
    /// Less control points than the order.
    #[error(
        "a curve of order {order} (L) needs at least {order} control points, its start included: it has {count}"
    )]
    FewControlPoints {
        /// Order.
        order: usize,
        /// Number of control points.
        count: usize,
    },
    /// Too many control points.
    #[error("a curve of G5.2 has at most {0} control points: divide it")]
    ManyControlPoints(usize),
    /// G53 and G91.
    #[error("G53 cannot be used with incremental distances (G91)")]
    MachineFrameIncremental,
    /// A probing move that must trip, to where the tool is.
    #[error("{0} goes nowhere: its start and its end are the same")]
    ProbeNowhere(Probing),
    /// A probing move that must trip and begins where it would have.
    #[error("{} begins {}", .0, already(*.0))]
    ProbeTripped(Probing),
    /// A probing move that must trip and does not.
    #[error("{} reaches its end without {}", .0, lacking(*.0))]
    ProbeNotTripped(Probing),
    /// A probing move whose end is not known. A warning.
    #[error("{0} is assumed to reach its end: nothing is described that it could touch")]
    ProbeUnknown(Probing),
    /// A tool that is not in the table.
    #[error("tool {0} is not in the tool table")]
    UnknownTool(u32),
    /// G43 without a tool table. A warning.
    #[error("without a tool table the length of tool {0} is assumed to be 0")]
    NoToolTable(u32),
    /// A code without a word that it needs.
    #[error("{code} needs {word}")]
    MissingWord {
        /// G or M word.
        code: String,
        /// The missing word and its purpose.
        word: String,
    },
    /// A word of a canned cycle, of a thread or of M19 that is not more than its limit.
    #[error("{letter} of {code} is {}, it must be more than {}", Short(*value), Short(*limit))]
    TooSmall {
        /// G or M word.
        code: String,
        /// Letter of the word.
        letter: char,
        /// Its number.
        value: f64,
        /// The number that it must exceed.
        limit: f64,
    },
    /// G76 with I0.
    #[error(
        "I of G76 is 0, it must lead from the start to the peak of the thread: below 0 for outside, above 0 for inside"
    )]
    ThreadWithoutPeak,
    /// A canned cycle or a thread without the spindle it needs.
    #[error(
        "G{motion} needs a spindle that turns with {needed}, but it {found}; program {needed} before it"
    )]
    SpindleDirection {
        /// The number after G.
        motion: f64,
        /// M word that turns the spindle as needed.
        needed: &'static str,
        /// What the spindle does.
        found: &'static str,
    },
    /// Feed per revolution with S0 or without S.
    #[error("feed per revolution with a spindle speed of 0; program S above 0")]
    ZeroSpeed,
    /// G96 without D, and a feed per revolution at X0.
    #[error(
        "feed per revolution at X0, where G96 has no highest speed; program it with D in the block of G96"
    )]
    SurfaceSpeedAtCenter,
    /// Probing with G95.
    #[error("probing cannot be used with feed per revolution (G95); program G94 and F before it")]
    ProbePerRevolution,
    /// The retract plane is below the bottom of the hole.
    #[error("the retract plane R at {} is below the bottom of the hole at {}", Short(*retract), Short(*bottom))]
    RetractBelowBottom {
        /// Height of R.
        retract: f64,
        /// Height of the bottom.
        bottom: f64,
    },
    /// Compensation in another plane than those of X and Y or Z and X.
    #[error("G{0} needs the plane G17 or G18")]
    CompensationPlane(f64),
    /// Compensation that is on already.
    #[error("G{0} begins cutter radius compensation, which is on already: end it with G40 before")]
    CompensationTwice(f64),
    /// A word that cannot be used with compensation.
    #[error("{0} cannot be used with cutter radius compensation: end it with G40 before")]
    Compensated(&'static str),
    /// G92.1, G92.2 or G92.3 with compensation. A warning.
    #[error(
        "G92.1, G92.2 and G92.3 do nothing with cutter radius compensation, as in LinuxCNC: end it with G40 before"
    )]
    CompensatedOffset,
    /// G41 or G42 without a tool table.
    #[error(
        "without a tool table G{word} does not know the diameter of tool {tool}: give a table, or use G{word}.1 with the diameter D"
    )]
    NoDiameter {
        /// 41 or 42.
        word: f64,
        /// Number of the tool.
        tool: u32,
    },
    /// A lathe tool in another plane than that of X and Z.
    #[error("G{word} needs the plane G18 for the orientation {orientation} of a lathe tool")]
    LatheToolPlane {
        /// 41, 42, 41.1 or 42.1.
        word: f64,
        /// Orientation of the tool.
        orientation: u32,
    },
    /// An arc directly behind G40.
    #[error("the first move behind G40 must be straight (G0 or G1)")]
    ArcAfterCompensation,
    /// An entry move that is too short.
    #[error(
        "the first move with cutter radius compensation is {} mm long in its plane; it must be longer than the tool's radius of {} mm: begin it further away",
        Short(*length_mm),
        Short(*radius_mm)
    )]
    CompensationEntry {
        /// Distance of its end from its start in the plane, mm.
        length_mm: f64,
        /// Radius of the tool, mm.
        radius_mm: f64,
    },
    /// The tool is within an arc that is too small for it.
    #[error(
        "the radius of the arc is {} mm; with the tool inside it must be larger than the tool's radius of {} mm: take a smaller tool",
        Short(*arc_mm),
        Short(*radius_mm)
    )]
    CompensationRadius {
        /// Radius of the arc, mm.
        arc_mm: f64,
        /// Radius of the tool, mm.
        radius_mm: f64,
    },
    /// An inner corner that the tool does not reach without gouging.
    #[error(
        "a tool with a radius of {} mm does not fit into the corner with the move of {other}: it would gouge the contour; take a smaller tool, or lengthen that move",
        Short(*radius_mm)
    )]
    CompensationGouge {
        /// Block of the other move.
        other: Place,
        /// Radius of the tool, mm.
        radius_mm: f64,
    },
    /// Too much comes between two moves in the plane.
    #[error(
        "with cutter radius compensation {0} moves, dwells and M functions follow each other without a move in the plane, the most that are kept: end it with G40 before"
    )]
    CompensationQueue(usize),
    /// Too many repetitions or pecks.
    #[error("this canned cycle has more than {0} moves")]
    EndlessCycle(usize),
    /// Offsets set by the program.
    #[error(transparent)]
    Offset(#[from] OffsetError),
    /// Both C and U, the same extra axis.
    #[error(
        "{second} and {first}, which the program has used before, are the same extra axis: use one of them only, or V or W in place of U"
    )]
    SharedAxis {
        /// C or U, which has come first.
        first: char,
        /// The other one.
        second: char,
    },
    /// A spindle that does not exist.
    #[error(
        "$ selects the spindle {}, but there is one spindle, number 0: leave $ out{}",
        Short(*number),
        if *takes_all { ", or write $-1 for all spindles" } else { "" }
    )]
    Spindle {
        /// Number of the spindle.
        number: f64,
        /// -1 is all spindles.
        takes_all: bool,
    },
    /// An arc in a plane of U, V and W.
    #[error(
        "G2 and G3 are not possible in G17.1, G18.1 and G19.1: select a plane of X, Y and Z (G17 to G19) before"
    )]
    ArcInParallelPlane,
    /// A letter that is not executed.
    #[error("{0} words are not supported")]
    UnsupportedLetter(char),
    /// A G or M word that is not executed.
    #[error("{letter}{number} is not supported")]
    UnsupportedCode {
        /// G or M.
        letter: char,
        /// Its number.
        number: f64,
    },
    /// A value that cannot be computed.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// A parameter that cannot be read or set.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Loops, conditions and subroutines.
    #[error(transparent)]
    Flow(#[from] FlowError),
    /// A message of the program. A note.
    #[error("{}: {}", .0.kind, .0.text)]
    Message(Message),
    /// An O word behind other words.
    #[error("O must be the first word of its block, or follow its N")]
    MisplacedLabel,
    /// G2 or G3 with neither R nor a centre.
    #[error("an arc needs its radius R or its centre")]
    ArcWithoutCenter,
    /// G2 or G3 with both.
    #[error("an arc takes either its radius R or its centre, not both")]
    RadiusAndCenter,
    /// A word of the centre along the normal of the plane.
    #[error("{0} is not in the plane of the arc")]
    CenterOutsidePlane(char),
    /// One word of the centre is missing where they are absolute (G90.1).
    #[error("{0} is missing: with G90.1 the centre of an arc needs both its words")]
    IncompleteCenter(char),
    /// An arc by R without an end.
    #[error("an arc by R needs an axis word of its plane")]
    RadiusWithoutEnd,
    /// An arc by R from a point to itself.
    #[error(
        "start and end of an arc by R are the same point, so that its centre is undetermined: a full circle needs its centre"
    )]
    RadiusWithoutChord,
    /// R is less than half the chord.
    #[error(
        "no arc of radius R {} mm joins two points that are 2 × {} mm apart",
        Short(*radius_mm),
        Short(*half_chord_mm)
    )]
    RadiusTooSmall {
        /// R without its sign, mm.
        radius_mm: f64,
        /// Half the distance from start to end in the plane, mm.
        half_chord_mm: f64,
    },
    /// Start or end is at the centre: their distances from it, mm.
    #[error(
        "the radius of the arc is zero: {} mm at its start, {} mm at its end",
        Short(.0[0]),
        Short(.0[1])
    )]
    ZeroRadius([f64; 2]),
    /// Start and end are not on one circle: their distances from the centre, mm.
    #[error(
        "start and end are not on one circle: {} mm and {} mm from the centre",
        Short(.0[0]),
        Short(.0[1])
    )]
    CenterMismatch([f64; 2]),
}

/// State in which a probing move must not begin, in words.
fn already(probing: Probing) -> &'static str {
    match probing.trips {
        ProbeTrip::Touch => "where something is touched already",
        ProbeTrip::Release => "where nothing is touched",
    }
}

/// Purpose of a probing move, in words.
fn lacking(probing: Probing) -> &'static str {
    match probing.trips {
        ProbeTrip::Touch => "touching anything",
        ProbeTrip::Release => "coming free",
    }
}

impl DecodeError {
    pub(super) fn missing(code: impl Into<String>, word: impl Into<String>) -> Self {
        Self::MissingWord { code: code.into(), word: word.into() }
    }

    /// True if it may only be one of where an arc begins.
    pub(super) fn depends_on_start(&self) -> bool {
        matches!(
            self,
            Self::CenterMismatch { .. }
                | Self::ZeroRadius { .. }
                | Self::RadiusTooSmall { .. }
                | Self::RadiusWithoutChord
        )
    }
}

impl TextError for DecodeError {
    fn rule(&self) -> Rule {
        match self {
            Self::Repeated { error, .. } => error.rule(),
            Self::OfControl(_) => Rule::Control,
            Self::Lenient(leniency) => leniency.refusal().rule(),
            Self::UnsupportedLetter(_) | Self::SharedAxis { .. } | Self::UnsupportedCode { .. } => {
                Rule::UnsupportedWord
            }
            Self::ArcWithoutCenter
            | Self::RadiusAndCenter
            | Self::CenterOutsidePlane(_)
            | Self::IncompleteCenter(_)
            | Self::RadiusWithoutEnd
            | Self::RadiusWithoutChord
            | Self::RadiusTooSmall { .. }
            | Self::ZeroRadius(_)
            | Self::Offset(OffsetError::RotatedArc(_))
            | Self::CenterMismatch(_) => Rule::ArcGeometry,
            Self::CompensationRadius { .. } | Self::CompensationGouge { .. } => {
                Rule::CompensationGouge
            }
            Self::ProbeTripped(_) | Self::ProbeNotTripped(_) | Self::ProbeUnknown(_) => Rule::Probe,
            _ => Rule::Syntax,
        }
    }

    fn hint(&self) -> Option<String> {
        match self {
            Self::OfControl(finding) => finding.hint(),
            Self::Repeated { error, .. } => error.hint(),
            // As other controls have it, with the option that reads it so.
            Self::Flow(FlowError::NotFound(label))
                if label.parse().is_ok_and(|number: u32| number > 9999) =>
            {
                Some(
                    "on Fanuc the digits before the last four are the number of calls: --for fanuc"
                        .to_owned(),
                )
            }
            Self::UnsupportedCode { letter: 'G', number: 70.0 | 71.0 } => Some(
                "on Mach3 G70 is inches and G71 millimetres, as G20 and G21: --for mach3"
                    .to_owned(),
            ),
            Self::MissingAxes(5.0 | 5.1) => Some(
                "on Fanuc G5 P and G5.1 Q set how far the control looks ahead: --for fanuc"
                    .to_owned(),
            ),
            _ => None,
        }
    }

    fn is_note(&self) -> bool {
        match self {
            Self::Message(_) => true,
            Self::Repeated { error, .. } => error.is_note(),
            _ => false,
        }
    }
}

/// An error of the current block and the bytes of its line to point at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Problem {
    pub(super) columns: Option<Range<usize>>,
    pub(super) error: DecodeError,
}

impl<E: Into<DecodeError>> From<E> for Problem {
    /// An error of the line as a whole.
    fn from(error: E) -> Self {
        Self { columns: None, error: error.into() }
    }
}
