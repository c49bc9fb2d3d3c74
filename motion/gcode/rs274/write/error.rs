//! Errors of the writer: path elements that a program of the control cannot express.

use crate::rs274::Control;
use std::io;
use twin_path::{Place, Probing};

/// Error of writing a path as a program of RS274. The place is the element's.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// Writing fails.
    #[error("the program cannot be written")]
    Io(#[from] io::Error),
    /// SoftMotion does not read RS274.
    #[error("SoftMotion reads its dialect of DIN 66025 only: use --format din66025")]
    SoftMotion,
    /// A word that the control does not have.
    #[error("{place}: {control} does not have {word}")]
    Word {
        /// The element's block.
        place: Place,
        /// The word.
        word: String,
        /// The control.
        control: Control,
    },
    /// A parameter of an M function that its word cannot take.
    #[error("{place}: M{number} of RS274 cannot take the parameter {parameter} of the path")]
    Parameter {
        /// The element's block.
        place: Place,
        /// Number of the M function.
        number: u16,
        /// K, L or O.
        parameter: char,
    },
    /// Part of an element that no word of RS274 expresses.
    #[error("{place}: RS274 cannot express {what}")]
    Inexpressible {
        /// The element's block.
        place: Place,
        /// The part.
        what: &'static str,
    },
    /// Tool radius compensation and other preparation that is still to be done.
    #[error("{0}: the path is not prepared (G41, G42, G51, G52, G61): use --prepare")]
    Unprepared(Place),
    /// A thread (G33, G33.1, G76), whose moves follow the angle of the spindle.
    #[error("{0}: moves of a thread follow the angle of the spindle, which lines cannot repeat")]
    Thread(Place),
    /// A probing move whose programmed end is behind the point where the probe trips.
    #[error("{place}: the path does not contain the programmed end of {probing}")]
    ProbeEnd {
        /// The element's block.
        place: Place,
        /// The programmed move.
        probing: Probing,
    },
    /// A move behind a probing move.
    #[error("{place}: the position depends on where {probing} ends on the machine")]
    AfterProbe {
        /// The element's block.
        place: Place,
        /// The probing move before.
        probing: Probing,
    },
    /// The element does not start where the one before ended.
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
}
