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
    #[error(
        "{place}: a program for {control} cannot contain {word}{}: leave it out",
        in_brackets(reason)
    )]
    Word {
        /// The element's block.
        place: Place,
        /// The word.
        word: String,
        /// The control.
        control: Control,
        /// What it does instead; may be empty.
        reason: &'static str,
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
    /// Something that moves, arcs and M functions of RS274 cannot express.
    #[error("{place}: cannot be written as RS274: {what}")]
    Inexpressible {
        /// The element's block.
        place: Place,
        /// Part of the element, and what to do.
        what: &'static str,
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

fn in_brackets(reason: &str) -> String {
    if reason.is_empty() { String::new() } else { format!(" ({reason})") }
}
