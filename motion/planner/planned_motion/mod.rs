//! Planned motion: path elements and the laws by which they are travelled, as a value of its own.
//!
//! A plan is a sequence of [`Piece`]s: a part of an element with a law of motion whose derivatives are known in closed
//! form. Set-points sample it; [`Examiner`] bounds what the axes do along a piece, without samples.

mod bernstein;
mod extremes;
mod law;
#[cfg(test)]
mod tests;

pub use extremes::{AxisExtremes, Examiner, Extremes, Floor, Largest, Node, OutOfReach};
pub use law::{Law, Piece, PlannedPiece};
