//! Pictures as SVG: charts of rows over a common axis, and maps at equal scale.
//!
//! The crate knows only plain data: lines, marks, labels, units and colours. Only `svg.rs` writes SVG.
//!
//! ```
//! use twin_plot::{Across, Chart, Color, Row, Shape, Stroke};
//!
//! // Velocity of a move: up to 50 mm/s in 0.1 s, and back to 0 from 2.0 s to 2.1 s.
//! let points = vec![(0.0, 0.0), (0.1, 50.0), (2.0, 50.0), (2.1, 0.0)];
//! let mut row = Row::fitted("velocity", "mm/s", 200.0, Some([0.0, 50.0]), &[60.0]);
//! assert!(row.shows_limit(), "60 mm/s is near enough");
//! row.shapes.push(Shape::Line(points, Stroke::solid(Color::series(0), 2.0)));
//! let chart = Chart {
//!     title: "Line of 100 mm".to_owned(),
//!     subtitle: String::new(),
//!     across: Across::time([0.0, 2.1]),
//!     rows: vec![row],
//!     strips: Vec::new(),
//!     legend: Vec::new(),
//! };
//! let svg = chart.svg();
//! assert!(svg.starts_with("<svg") && svg.contains("time (s)"));
//! ```

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

pub use chart::{Across, Chart, Strip};
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
