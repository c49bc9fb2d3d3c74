//! Cams: a slave axis as a function of a master axis (manual 4, 5.4, 5.5, 10.3).
//!
//! [`Source`] is what people edit: points, straight lines and tappets on a scale. It is compiled to a [`Cam`], polynomial
//! or a table, whose [`Curve`] gives the slave's position and derivatives anywhere.
//!
//! Everything is in the axes' technical units u. There is no clock: who works cycle by cycle is told the time.

mod bounds;
mod cam;
mod curve;
mod error;
mod knot;
mod polynomial;
mod source;
mod table;
mod tappet;
#[cfg(test)]
mod tests;

pub use bounds::{Bounds, Factors, Largest, LimitError, MasterMotion, Peak, Quantity, SlaveLimits};
pub use cam::{Cam, Shape};
pub use curve::{Curve, CurveExtremes, Jump, Jumps, MAX_POINTS, Range};
pub use error::CamError;
pub use knot::{Derivatives, Knot, quintic};
pub use source::{Compile, Element, Kind, Scale, Source};
pub use table::{Equidistant, Interpolation, PairTable, TableScale, VariableType};
pub use tappet::{Action, Passage, Tappet};
