//! Errors of the flow of control.

use crate::rs274::parameters::LOCAL;

/// Error of the flow of control.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// Something else than a keyword behind a label.
    #[error(
        "a keyword must follow the label: sub endsub return call if elseif else endif while endwhile do repeat endrepeat break continue"
    )]
    UnknownKeyword,
    /// The keyword needs a value in brackets.
    #[error("{0} needs a value in brackets: [ ]")]
    MissingValue(&'static str),
    /// More arguments than parameters.
    #[error("a subroutine takes at most {LOCAL} arguments")]
    TooManyArguments,
    /// A label for the second time.
    #[error(
        "label {label} is used in line {line} already: a loop or condition needs a label of its own in its subroutine"
    )]
    Duplicate {
        /// The label.
        label: String,
        /// Line of its first use.
        line: u32,
    },
    /// A subroutine for the second time.
    #[error("subroutine {label} is defined in line {line} already")]
    Redefined {
        /// The label.
        label: String,
        /// Line of its definition.
        line: u32,
    },
    /// An end, or a jump, whose loop or condition is not in work.
    #[error("{keyword} without its beginning: no {wanted} with label {label} is open here")]
    NotOpen {
        /// The keyword.
        keyword: &'static str,
        /// The keyword that opens it.
        wanted: &'static str,
        /// The label.
        label: String,
    },
    /// A subroutine within another.
    #[error("a subroutine cannot be defined within another: the one of line {0} is not closed")]
    Nested(u32),
    /// Outside a subroutine.
    #[error("{0} outside of a subroutine")]
    Outside(&'static str),
    /// A subroutine that nobody defines.
    #[error(
        "subroutine {0} is neither defined in this program nor a file {0}.ngc in the folders of subroutines"
    )]
    NotFound(String),
    /// A subroutine of one style that is called or ended in the other.
    #[error(
        "subroutine {0} mixes two styles: sub goes with call and endsub, O and a number go with M98 and M99"
    )]
    Style(String),
    /// The end of the file within a part that is skipped or repeated.
    #[error("the file ends before the {keyword} of label {label} that this line needs")]
    NotClosed {
        /// Keyword that is missing.
        keyword: &'static str,
        /// Label of it.
        label: String,
    },
    /// Loops without end.
    #[error(
        "endless: loops and calls have jumped {0} times, the most that are allowed (--max-jumps)"
    )]
    Endless(u64),
    /// Recursion without end.
    #[error(
        "subroutines call each other {0} times in a row, the most that are allowed (--max-depth)"
    )]
    TooDeep(usize),
    /// The number of repetitions is negative or too large.
    #[error("{} is not a number of repetitions", twin_number::Short(*.0))]
    Repetitions(f64),
    /// M98 without P.
    #[error("M98 needs P, the number of a subroutine")]
    MissingProgram,
    /// M98 or M99 with other words.
    #[error("{0} has no effect next to M98 or M99: write it in a block of its own")]
    Beside(char),
    /// M99 outside of a subroutine: an endless program. A warning.
    #[error("M99 begins the program anew, without end: it is read once")]
    EndlessProgram,
    /// The message (ABORT, ...).
    #[error("the program ends itself: {0}")]
    Abort(String),
    /// The file of a subroutine cannot be read.
    #[error("the file of subroutine {label} cannot be read: {cause}")]
    File {
        /// Name of the subroutine.
        label: String,
        /// Reason of the system.
        cause: String,
    },
}
