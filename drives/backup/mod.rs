//! Parameters of a device on file: `SMC_WriteDriveParamsToFile` (2.5), and the way back.
//!
//! A file has the parameters of one device, as text. The manual gives no format; this is our own:
//!
//! ```text
//! drive-parameters 1
//! family SmartDRIVE
//! # station number value
//! 3 30 500 # Trj_VelMax [rpm]
//! ```
//!
//! Names and units are for people: numbers count. Before anything is written to a device, [`plan`] holds the whole file
//! against it and says what would change; [`Plan::carry_out`] writes that and reads everything back.

mod error;
mod plan;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use error::{BackupError, LineError, LineFault, RestoreError};
pub use plan::{Change, Plan, plan};
pub use read::{Backup, Entry, read};
pub use write::write_parameters;

/// Version of the format.
const VERSION: u32 = 1;
/// First word of a file.
const HEAD: &str = "drive-parameters";
