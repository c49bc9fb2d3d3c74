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
    /// A statement of Fanuc's macro language.
    #[error("{statement} of Fanuc's macro language is not read: write it as an O word: {rewrite}")]
    Macro {
        /// Its word.
        statement: &'static str,
        /// The O words to use.
        rewrite: &'static str,
    },
    /// The keyword needs a value in brackets.
    #[error("{0} needs a value in brackets: [ ]")]
    MissingValue(&'static str),
    /// More arguments than parameters.
    #[error("a subroutine takes at most {LOCAL} arguments")]
    TooManyArguments,
    /// A label for the second time, and the line of its first use.
    #[error(
        "label {0} is used in line {1} already: a loop or condition needs a label of its own in its subroutine"
    )]
    Duplicate(String, u32),
    /// A subroutine for the second time, and the line of its definition.
    #[error("subroutine {0} is defined in line {1} already")]
    Redefined(String, u32),
    /// An end, or a jump, whose loop or condition is not open: its keyword, the keyword that opens it, and its label.
    #[error("{0} without its beginning: no {1} with label {2} is open here")]
    NotOpen(&'static str, &'static str, String),
    /// A subroutine within another.
    #[error("a subroutine cannot be defined within another: the one of line {0} is not closed")]
    Nested(u32),
    /// Outside a subroutine.
    #[error("{0} outside of a subroutine")]
    Outside(&'static str),
    /// A subroutine without a definition.
    #[error(
        "subroutine {0} is neither defined in this program nor a file {0}.ngc in the folders of subroutines"
    )]
    NotFound(String),
    /// A subroutine of one style that is called or ended in the other.
    #[error(
        "subroutine {0} mixes two styles: sub goes with call and endsub, O and a number go with M98 and M99"
    )]
    Style(String),
    /// The end of the file within a part that is skipped or repeated: the keyword that is missing, and its label.
    #[error("the file ends before the {0} of label {1} that this line needs")]
    NotClosed(&'static str, String),
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
    /// The file of a subroutine cannot be read: its name, and the reason of the system.
    #[error("the file of subroutine {0} cannot be read: {1}")]
    File(String, String),
}
