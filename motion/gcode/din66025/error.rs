//! Decode errors and warnings, with line and columns.

use crate::decode;
use crate::decode::{Rule, TextError};
use std::ops::Range;
use twin_number::Short;
use twin_path::EllipseError;

/// One thing wrong with a block.
pub type Diagnostic = decode::Diagnostic<DecodeError>;
/// Reason why the decoder has no element.
pub type Failure = decode::Failure<DecodeError>;
/// Output item of the decoder.
pub type Item = decode::Item<DecodeError>;

/// Error or warning of a block (manual 3.2). Numbers are in the units of the program.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DecodeError {
    /// The first line is not the `%` line.
    #[error("a program begins with a line with %, and its name if it has one")]
    MissingPercent,
    /// A `%` with text behind it elsewhere.
    #[error(
        "only the first line of a program begins with % and a name; a % alone ends the program"
    )]
    MisplacedPercent,
    /// A `%` alone at the end. A note.
    #[error("this % ends the program")]
    ClosingPercent,
    /// A `%` alone with lines behind it. A warning.
    #[error(
        "this % ends the program, and the lines after it are not read; remove it if they belong to the program"
    )]
    LinesBehindPercent,
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
    /// A letter without its number.
    #[error("a number must follow directly after {0}")]
    MissingNumber(char),
    /// The letter is not followed by a number.
    #[error("what follows {0} is not a number")]
    InvalidNumber(char),
    /// A decimal comma.
    #[error(
        "what follows {0} is not a number: decimals are set off with a point, not with a comma"
    )]
    DecimalComma(char),
    /// A fraction where only whole numbers are allowed (G, N).
    #[error("{letter} takes a whole number, not {}", Short(*value))]
    NotWhole {
        /// The word's letter.
        letter: char,
        /// Its number.
        value: f64,
    },
    /// A number, or the position it leads to, beyond what any machine has.
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
    /// F is zero or negative.
    #[error("the feed F is {} mm/s, it must be more than 0 mm/s", Short(*.0))]
    NonPositiveFeed(f64),
    /// E is zero: neither an acceleration (`SMC_DEC_ACC_TOO_LITTLE`, 1200) nor a deceleration
    /// (`SMC_DEC_RET_TOO_LITTLE`, 1201).
    #[error(
        "E is 0 mm/s², it must be more than 0 mm/s² (acceleration) or less than 0 mm/s² (deceleration)"
    )]
    ZeroAcceleration,
    /// Motion before any F. Reported once per program.
    #[error(
        "motion without a feed: F has not been set yet (SoftMotion error 1001, SMC_INT_VEL_ZERO)"
    )]
    MissingFeed,
    /// More than one G word.
    #[error(
        "a second G word, G{second}, in a block that has G{first} already: there can be only one"
    )]
    SecondG {
        /// Number of the first G word.
        first: f64,
        /// Number of this one.
        second: f64,
    },
    /// A G word with other words before it: they would act after the motion.
    #[error("G{0} must be the first word after N: words act from right to left")]
    MisplacedG(f64),
    /// An N word that does not open the block.
    #[error("N{0} must be the first word of its block")]
    MisplacedN(f64),
    /// A block without N word. A warning, once per program.
    #[error(
        "this block has no N word: SoftMotion requires one at the beginning of every block; number the blocks N10, N20 …"
    )]
    MissingBlockNumber,
    /// A coordinate in a block that cannot use it.
    #[error("{letter} has no effect in a block with G{command}: put it into a block with a motion")]
    WordWithoutMotion {
        /// The word's letter.
        letter: char,
        /// Number of the block's G word.
        command: u8,
    },
    /// A word the motion of its block does not look at. A warning.
    #[error("{letter} has no effect in a block with G{command}")]
    UnusedWord {
        /// The word's letter.
        letter: char,
        /// Number of the block's G word, or of the one in force.
        command: u8,
    },
    /// A second word of a letter. A warning.
    #[error("a second {letter} word: words act from right to left, so {letter}{} counts", Short(*value))]
    DuplicateWord {
        /// The letter.
        letter: char,
        /// The number that counts.
        value: f64,
    },
    /// A variable that nobody has given a value (`SMC_RNCF_VAR_COULDNT_BE_REPLACED`, 2004).
    #[error(
        "the variable ${0}$ is unknown (SoftMotion error 2004, SMC_RNCF_VAR_COULDNT_BE_REPLACED)"
    )]
    UnknownVariable(String),
    /// O names no parameters of an M function.
    #[error("${0}$ is not a set of parameters for M functions")]
    UnknownParameters(String),
    /// O with a number where a variable is to be changed.
    #[error("O{0} names no variable: G36 and G37 take O$name$, or no O for the implicit variable")]
    VariableExpected(f64),
    /// G36 or G37 without D.
    #[error("G{0} needs the value for its variable, D")]
    ValueMissing(u8),
    /// G36 or G37 make a variable larger or smaller than its type allows.
    #[error(
        "the variable would become {}, but {kind} holds {} to {}",
        Short(*value),
        Short(*min),
        Short(*max)
    )]
    VariableOverflow {
        /// Name of its type.
        kind: &'static str,
        /// Value that it would get.
        value: f64,
        /// Smallest value of the type.
        min: f64,
        /// Largest value of the type.
        max: f64,
    },
    /// O with a number where an M function takes parameters.
    #[error("O{} names no parameters: M functions take O$name$", Short(*.0))]
    ParametersExpected(f64),
    /// A switch that does not exist.
    #[error("switch {0} does not exist: H takes 1 to 32, below zero to switch off")]
    SwitchNumber(f64),
    /// An axis without S profile.
    #[error("S{0} names no axis: 3 is Z, 7 to 11 are P Q U V W, below zero switches off")]
    ProfileAxis(f64),
    /// More H words than a path object takes.
    #[error("a block can have at most {0} switches (H)")]
    TooManySwitches(usize),
    /// H without L or O.
    #[error(
        "H needs its place on its right: L in mm from the start (below zero from the end), or O from 0 to 1"
    )]
    SwitchWithoutPlace,
    /// A switch beyond the ends of its object.
    #[error(
        "the switch is at {at:.6} of the object's length of {} mm; it must lie between 0 and 1",
        Short(*length_mm)
    )]
    SwitchBeyond {
        /// The part of the length.
        at: f64,
        /// The length, mm.
        length_mm: f64,
    },
    /// D below zero where it is a radius.
    #[error("D is {}: a radius or distance must not be below 0 mm", Short(*.0))]
    NegativeToolRadius(f64),
    /// G20 without L.
    #[error("G20 needs L, the number of the block at which the program continues")]
    JumpWithoutTarget,
    /// No block has the number that G20 names.
    #[error("block N{0}, at which the program should continue, does not exist")]
    JumpTarget(u32),
    /// G20 in a program that can be read only once.
    #[error("G20 needs a program that can be read again: a file, not a stream")]
    JumpInStream,
    /// More jumps than allowed: the program probably never ends.
    #[error("the program has jumped {0} times and still goes on; what follows is not read")]
    TooManyJumps(u32),
    /// A letter that SoftMotion's dialect does not have.
    #[error("{0} words are unknown to SoftMotion's dialect of DIN 66025")]
    UnknownLetter(char),
    /// A G word that SoftMotion's dialect does not have.
    #[error("G{0} is unknown to SoftMotion's dialect of DIN 66025")]
    UnknownCommand(f64),
    /// G6, G8 or G9 without I and J.
    #[error("G{0} needs I and J")]
    CurveWithoutPoint(u8),
    /// No ellipse fits. A warning; it becomes a straight line.
    #[error("{0}: replaced by a straight line")]
    NoEllipse(EllipseError),
    /// R of an ellipse is not the ratio that start and end determine. A warning.
    #[error("start and end are on an ellipse of ratio {}: R{} has no effect", Short(*ratio), Short(*given))]
    OtherRatio {
        /// R.
        given: f64,
        /// The ratio of the ellipse that is taken.
        ratio: f64,
    },
    /// I/J of a parabola is on the line through start and end and not between them: it would turn back on itself. A
    /// warning; it becomes a straight line.
    #[error(
        "start, end and I/J of the parabola are on one line, on which it would turn: replaced by a straight line"
    )]
    StraightParabola,
    /// The centre of an arc is its start. A warning; the arc becomes a straight line.
    #[error("the centre I/J is the start of the arc itself: replaced by a straight line")]
    CenterAtStart,
    /// G2 or G3 with neither R nor I and J.
    #[error("an arc needs its radius R or its centre I and J")]
    ArcWithoutCenter,
    /// G2 or G3 with both.
    #[error("an arc takes either its radius R or its centre I and J, not both")]
    RadiusAndCenter,
    /// One of I and J is missing where they are absolute (G98).
    #[error("{0} is missing: with G98 the centre of an arc needs both I and J")]
    IncompleteCenter(char),
    /// R is less than half the chord. A warning; the arc becomes a straight line.
    #[error(
        "no arc of radius R {} mm joins two points that are 2 × {} mm apart: replaced by a straight line",
        Short(*radius_mm),
        Short(*half_chord_mm)
    )]
    RadiusTooSmall {
        /// R without its sign, mm.
        radius_mm: f64,
        /// Half the distance from start to end in the plane, mm.
        half_chord_mm: f64,
    },
    /// An arc by R from a point to itself. A warning; the arc becomes a straight line.
    #[error(
        "start and end of the arc of radius R {} mm are the same point, so that its centre is undetermined: replaced by a straight line (a full circle needs I and J)",
        Short(*radius_mm)
    )]
    RadiusWithoutChord {
        /// R without its sign, mm.
        radius_mm: f64,
    },
    /// A negative R. A warning.
    #[error(
        "the sign of R {} mm has no meaning: an arc by R is at most a semicircle (larger ones need I and J)",
        Short(*radius_mm)
    )]
    NegativeRadius {
        /// R, mm.
        radius_mm: f64,
    },
    /// Start and end are not on one circle about I/J. A warning; the arc becomes a straight line.
    #[error(
        "start and end are not on one circle: {} mm and {} mm from the centre I/J: replaced by a straight line",
        Short(*start_radius_mm),
        Short(*end_radius_mm)
    )]
    CenterMismatch {
        /// Distance of the start from the centre, mm.
        start_radius_mm: f64,
        /// Distance of the end from the centre, mm.
        end_radius_mm: f64,
    },
}

impl TextError for DecodeError {
    fn rule(&self) -> Rule {
        match self {
            Self::UnknownLetter(_) | Self::UnknownCommand(_) => Rule::UnsupportedWord,
            Self::ArcWithoutCenter
            | Self::CurveWithoutPoint(_)
            | Self::NoEllipse(_)
            | Self::OtherRatio { .. }
            | Self::StraightParabola
            | Self::CenterAtStart
            | Self::RadiusAndCenter
            | Self::IncompleteCenter(_)
            | Self::RadiusTooSmall { .. }
            | Self::RadiusWithoutChord { .. }
            | Self::NegativeRadius { .. }
            | Self::CenterMismatch { .. } => Rule::ArcGeometry,
            _ => Rule::Syntax,
        }
    }

    fn is_note(&self) -> bool {
        matches!(self, Self::ClosingPercent)
    }
}

/// An error of the current block and the bytes of its line to point at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Problem {
    pub(super) columns: Range<usize>,
    pub(super) error: DecodeError,
}
