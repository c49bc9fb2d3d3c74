//! Errors of the program writers: path elements that a program of the dialect cannot express.

use std::io;
use twin_path::{Place, Probing};

/// Error of writing a path as a program. The place is the element's.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// Writing fails.
    #[error("the program cannot be written")]
    Io(#[from] io::Error),
    /// The element does not start where the one before ended, and is not a jump.
    #[error("{place}: the path has a gap of {gap_mm} mm (or degrees)")]
    Gap {
        /// The element's block.
        place: Place,
        /// Largest difference of a coordinate, mm or degrees.
        gap_mm: f64,
    },
    /// A number that its word must not have.
    #[error("{place}: {letter} cannot be {value}")]
    Value {
        /// The element's block.
        place: Place,
        /// The word's letter.
        letter: char,
        /// The number, in the units of the program.
        value: f64,
    },
    /// Something that no word of the dialect expresses.
    #[error("{place}: cannot be written: {what}")]
    Inexpressible {
        /// The element's block.
        place: Place,
        /// Part of the element, and what to do.
        what: &'static str,
    },
    /// SoftMotion does not read RS274.
    #[error("SoftMotion reads its dialect of DIN 66025 only: use --format din66025")]
    SoftMotion,
    /// A word of RS274 that the control does not have.
    #[error(
        "{place}: a program for {control} cannot contain {word}{}: leave it out",
        in_brackets(reason)
    )]
    Word {
        /// The element's block.
        place: Place,
        /// The word.
        word: String,
        /// Name of the control.
        control: &'static str,
        /// What it does instead; may be empty.
        reason: &'static str,
    },
    /// A parameter of an M function that its word of RS274 cannot take.
    #[error("{place}: M{number} of RS274 cannot take the parameter {parameter} of the path")]
    Parameter {
        /// The element's block.
        place: Place,
        /// Number of the M function.
        number: u16,
        /// K, L or O.
        parameter: char,
    },
    /// A move behind a probing move.
    #[error("{place}: the position depends on where {probing} ends on the machine")]
    AfterProbe {
        /// The element's block.
        place: Place,
        /// The probing move before.
        probing: Probing,
    },
    /// An arc that is not in X and Y.
    #[error("{0}: SoftMotion's dialect has arcs in X and Y only: make lines of this one first")]
    UprightArc(Place),
    /// An arc, a parabola or an ellipse that the decoder of SoftMotion's dialect would not read back to within a
    /// nanometre: one that goes around several times, or whose ends do not lie on it.
    #[error("{0}: G words cannot describe this curve to within 1 nm: convert it to lines first")]
    Curve(Place),
    /// A cubic that is neither a parabola (G6) nor the piece of a spline (G5) that its neighbours make it.
    #[error("{0}: a cubic that is neither a parabola nor a spline piece: make lines of it first")]
    Cubic(Place),
    /// A probing move: SoftMotion's dialect has no word for it.
    #[error("{place}: SoftMotion's dialect has no probing ({probing} of RS274)")]
    Probe {
        /// The element's block.
        place: Place,
        /// The programmed move.
        probing: Probing,
    },
    /// Marks that exclude one another, or that begin a section with an element that is not a path object.
    #[error("{place}: preparation cannot begin with these marks: {marks:#010b}")]
    Marks {
        /// The element's block.
        place: Place,
        /// The marks.
        marks: u8,
    },
    /// An M function with parameters that are given with the program, not in it.
    #[error(
        "{place}: M{number} takes its parameters O from variables outside the program (--variables), which a program text cannot contain"
    )]
    Parameters {
        /// The element's block.
        place: Place,
        /// Number of the M function.
        number: u16,
    },
}

fn in_brackets(reason: &str) -> String {
    if reason.is_empty() { String::new() } else { format!(" ({reason})") }
}
