//! Drawings (DXF) to paths and back (manual 3.3, "DXF import").
//!
//! [`import`] takes the lines, arcs, circles, polylines, ellipses, splines and inserted blocks of a drawing, joins what
//! touches to connected sections, orders them, and makes a program of all, one per layer or one per section. What it
//! leaves out or only approximates it says in its [`Note`]s.
//!
//! The `dxf` crate reads entities and blocks. It says nothing about entities it does not know, stops without a word
//! at one it cannot read, and does not tell which layers are frozen; so the file is surveyed first, only what is
//! understood is handed to the crate, and what comes back is counted.
//!
//! [`DxfWriter`] writes a path as a drawing with the layers RAPID, CUT and PROBE.

mod arrange;
mod entity;
mod error;
mod expand;
mod export;

mod import;
mod primitive;
mod spline;
mod survey;
#[cfg(test)]
mod tests;

pub use error::{DxfReadError, Note, Reason};

pub use export::{DxfWriteError, DxfWriter};
pub use import::{Heights, Import, ImportOptions, Limits, Order, Program, Split, import};
