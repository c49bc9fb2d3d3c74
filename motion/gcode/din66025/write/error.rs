//! Errors of the writer: path elements that the dialect cannot express.

use std::io;
use twin_path::Place;
use twin_path::Probing;

/// Error of writing a path as a program of SoftMotion's dialect. The place is the element's.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// Writing fails.
    #[error("the program cannot be written")]
    Io(#[from] io::Error),
    /// An arc that is not in X and Y.
    #[error("{0}: SoftMotion's dialect has arcs in X and Y only: make lines of this one first")]
    UprightArc(Place),
    /// An arc, a parabola or an ellipse that the decoder would not read back to within a nanometre: one that goes
    /// around several times, or whose ends do not lie on it.
    #[error("{0}: G words cannot describe this curve to within 1 nm: convert it to lines first")]
    Curve(Place),
    /// A cubic that is neither a parabola (G6) nor the piece of a spline (G5) that its neighbours make it.
    #[error("{0}: a cubic that is neither a parabola nor a spline piece: make lines of it first")]
    Cubic(Place),
    /// A rapid that is not straight.
    #[error("{0}: a rapid along a curve cannot be written")]
    CurvedRapid(Place),
    /// A dwell: there is no word for it.
    #[error("{0}: SoftMotion's dialect has no dwell; remove the dwell from the source program")]
    Dwell(Place),
    /// A probing move: there is no word for it.
    #[error("{place}: SoftMotion's dialect has no probing ({probing} of RS274)")]
    Probe {
        /// The element's block.
        place: Place,
        /// The programmed move.
        probing: Probing,
    },
    /// The element does not start where the one before ended, and is not a jump.
    #[error("{place}: the path has a gap of {gap_mm} mm (or u) here")]
    Gap {
        /// The element's block.
        place: Place,
        /// Largest difference of a coordinate, mm or u.
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
