//! Decoder output of every dialect: path elements, and diagnostics of the text.

use std::io;
use std::ops::Range;
use twin_path::PathElement;
use twin_path::Place;

/// Output item of a decoder; `E` is the error type of its dialect.
#[derive(Clone, Debug, PartialEq)]
pub enum Item<E> {
    /// The next piece of the path. It starts where the one before ends, bit for bit.
    Element(PathElement),
    /// The program runs, but perhaps not as meant: a straight line instead of an arc, a word without effect.
    Warning(Diagnostic<E>),
}

/// One thing wrong with a block, with the place to point at.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {error}")]
pub struct Diagnostic<E> {
    /// The block.
    pub place: Place,
    /// Bytes of the line to point at, counted from 0; `None` if it is the line as a whole.
    pub columns: Option<Range<usize>>,
    /// The error.
    pub error: E,
}

/// Reason why a decoder has no element.
#[derive(Debug, thiserror::Error)]
pub enum Failure<E> {
    /// A block is wrong. Decoding goes on with the next one.
    #[error(transparent)]
    Diagnostic(Diagnostic<E>),
    /// The program cannot be read any further. Nothing follows.
    #[error("the program cannot be read")]
    Io(#[source] io::Error),
}

impl<E> From<Diagnostic<E>> for Failure<E> {
    fn from(diagnostic: Diagnostic<E>) -> Self {
        Self::Diagnostic(diagnostic)
    }
}

/// The rule that something wrong with a program's text breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rule {
    /// The text is not a program of its dialect.
    Syntax,
    /// A word that the dialect, or this version, does not know.
    UnsupportedWord,
    /// An arc or another curve whose parameters do not fit its ends.
    ArcGeometry,
    /// A probing move that does not end as it must, or of which nobody knows how it ends.
    Probe,
    /// A tool whose radius does not fit the contour.
    CompensationGouge,
    /// A word that the control of the program does not take as its dialect has it.
    Control,
}

/// Error of a block in one dialect.
pub trait TextError: std::error::Error {
    /// The rule it breaks.
    fn rule(&self) -> Rule;

    /// What to do about it, if more can be said than the rule says.
    fn hint(&self) -> Option<String> {
        None
    }

    /// True if it only says how the text is read, and nothing is wrong.
    fn is_note(&self) -> bool {
        false
    }
}
