//! Charts of a program along its time: curves of any length in the room of a page, and below them the lines of the program.

mod colors;
mod envelope;
mod page;
mod strips;

pub(crate) use colors::color_of;
pub(crate) use envelope::{Envelope, Input};
pub(crate) use page::{
    Area, Failure, GAP, LEFT, LINE, RIGHT, Row, Sign, TOP, WIDTH, dashes, legend, legend_places,
    line, ticks, title, words,
};
pub(crate) use strips::Strips;

/// Columns that are kept of the curves: at least one for each pixel.
pub(crate) const COLUMNS: usize = 1800;
