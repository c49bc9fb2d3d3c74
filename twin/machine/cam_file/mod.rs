//! Cams in files: TOML by hand, tables as CSV or SoftMotion's ASCII.
//!
//! `examples/cams/*.toml` are commented as documentation of the format.

pub mod columns;
mod csv_form;
mod csv_units;
mod error;
mod file;
mod form;
mod toml_coupling;
mod toml_form;
mod toml_table;
mod toml_writer;

pub use csv_form::csv_of;
pub use error::CamFileError;
pub use file::{CamFile, CamRemark, Form, digits, write_file};
pub(crate) use form::START_MODES;
pub use form::{AxisScale, Coupling, WANTED, no_scaling, unit_fits, unit_of};
pub use toml_writer::{Number, tappet as tappet_line, write_toml};
