//! Planned motion: path elements and the laws by which they are travelled, as a value of its own.
//!
//! A plan is a sequence of [`PlannedPiece`]s: a part of an element with a law of motion whose derivatives are known in
//! closed form. Set-points sample it; [`crate::extremes`] bounds what the axes do along a piece, without samples.

mod instant;
mod law;
mod profile_segment;

pub(crate) use instant::Instant;
pub use law::{Law, PathState, Piece, PlannedPiece};
pub use profile_segment::{ProfileSegment, Progress, SegmentLaw};
