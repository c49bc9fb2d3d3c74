//! Cams in files: TOML by hand, tables as CSV or SoftMotion's ASCII; checked, drawn and tuned.
//!
//! `examples/cams/*.toml` are commented as documentation of the format.

pub mod check;
mod columns;
mod csv_form;
mod csv_units;
pub mod edit;
mod error;
mod file;
mod form;
mod lost;
pub mod picture;
pub mod run;
pub mod sample;
mod start;
#[cfg(test)]
mod tests;
mod toml_coupling;
mod toml_form;
mod toml_table;
mod toml_writer;
pub mod tune;
mod usage;

pub use csv_form::csv_of;
pub use error::CamFileError;
pub use file::{CamFile, Form, write_file};
pub(crate) use form::no_scaling;
pub use form::{AxisScale, Coupling, LEAST_SCALING, START_MODES, WANTED, unit_fits};
pub use lost::lost;
pub(crate) use toml_writer::tappet as tappet_line;
pub use toml_writer::write_toml;
