//! BIBOX BIM2AX-BOCM, a module for two stepper axes behind a dual-port RAM.
//!
//! [`Bim2Ax`] is the client over any [`Memory`], [`Bim2AxDrive`] the same as a [`twin_drives::Drive`]; [`emulator`] is the
//! module without hardware, and [`Bim2AxPrediction`] both in simulated time. All take zones, bits and parameters from the
//! tables of [`protocol`], which are checked against vectors packed elsewhere and against a second reading of the manual.
//!
//! Nothing in the module watches its host. If that is gone, a programmed move goes on to its target, which while a
//! plan is followed lies within the plan's horizon; homing goes on to the origin or an end switch, and a manual move
//! until the end switch: manual moves need a host that lives.
//!
//! Source: "Module BIM2AX-BOCM, Manuel d'utilisation", MUT/0712/0206D, revision D of May 2013.
//!
//! ```
//! use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter};
//! use twin_bim2ax::{DriveMode, ModuleAxis};
//!
//! // Parameters of the manual: $63 is the version of the software, $15 the acceleration of axis 2.
//! assert_eq!(Parameter::Version.number(), Some(0x63));
//! let acceleration = Parameter::Axis(AxisParameter::Acceleration, ModuleAxis::Two);
//! assert_eq!(acceleration.number(), Some(0x15));
//! assert_eq!(Parameter::from_number(0x15), Some(acceleration));
//! // Drive mode $60: 64 µsteps per full step.
//! assert_eq!(DriveMode::from_code(0x60).map(DriveMode::microsteps), Some(64));
//! ```

mod assumptions;
mod client;
mod drive;
pub mod emulator;
mod family;
mod prediction;
pub mod protocol;
#[cfg(test)]
mod tests;

pub use assumptions::{Assumptions, CamStart, Corrections, EntryOrder};
pub use client::{Bim2Ax, Bim2AxOptions, BusStamp, Identity, Start};
pub use drive::{Bim2AxDrive, Bim2AxDriveOptions};
pub use emulator::{Bench, Contact, EncoderBench, EncoderKind, SharedModule};
pub use family::{Bim2AxEntry, Bim2AxFamily, ModuleEncoder};
pub use prediction::{Bim2AxPrediction, PredictionOptions};
pub use protocol::describe::describe_messages;
pub use protocol::fault::Fault;
pub use protocol::memory::{ByteOrder, MappedMemory, Master, Memory, MemoryFile, file_offset};
pub use protocol::mode::DriveMode;
pub use protocol::parameter::{MOST_POSITION, ModuleAxis};
pub use protocol::settings::{AxisSettings, REFERENCES};

/// Axes of a module.
pub const AXES: usize = 2;
