//! Drawings (DXF) to paths and back (manual 3.3, "DXF import").
//!
//! [`import`] takes the lines, arcs, circles, polylines, ellipses, splines and inserted blocks of a drawing, joins what
//! touches to connected sections, orders them, and makes programs of them: one for all, one per layer or one per
//! section. Its [`Note`]s list omitted and approximated parts.
//!
//! The `dxf` crate reads entities and blocks. It ignores unknown entities, stops silently at one it cannot read, and
//! does not report frozen layers. Therefore the file is surveyed first, the crate gets only the understood entities,
//! and its results are counted.
//!
//! [`DxfWriter`] writes a path as a drawing with the layers RAPID, CUT and PROBE. [`import`] reads straight lines on the
//! layer RAPID as rapids.

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
