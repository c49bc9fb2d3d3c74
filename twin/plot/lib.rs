//! Pictures as SVG: charts of rows over a common axis, and maps at equal scale.
//!
//! The room knows only plain data: lines, marks, labels, units and colours. It imports no other room of `twin`; each of
//! them hands over what it wants to be seen. Everything that is written as SVG is written by `svg.rs`.

mod chart;
mod color;
mod map;
mod page;
mod row;
mod series;
mod svg;
#[cfg(test)]
mod tests;
mod ticks;
mod timeline;

pub use chart::{Across, Chart, Strip, charts};
pub use color::{BACK, Color, FAINT, INK, MARK, Paint, Stroke};
pub use map::{Map, Scale, Sheet, hull};
pub use page::{Legend, Sign};
pub use row::{Mark, Row, Shape, Side, reach};
pub use series::{Series, Stretches};
pub use svg::number;
pub use ticks::short;
pub use timeline::Timeline;

/// A place in the units of the picture: across, up.
pub type Point = (f64, f64);
