//! BIBOX BIM2AX-BOCM, a module for two stepper axes behind a dual-port RAM.
//!
//! [`Bim2Ax`] is the driver over any [`Memory`], [`Bim2AxDrive`] the same as a [`crate::Drive`]; [`emulator`] is the
//! module without hardware, and [`Bim2AxRehearsal`] what a plan becomes of in simulated time. Driver and emulator take
//! zones, bits and parameters from the same tables, which are checked against vectors packed elsewhere and against a
//! second reading of the manual.
//!
//! Nothing in the module watches its host. If that is gone, a programmed move goes on to its target, which while a
//! plan is followed lies within the plan's horizon; homing goes on to the origin or an end switch, and a manual move
//! until the end switch: manual moves want a host that lives.
//!
//! Source: "Module BIM2AX-BOCM, Manuel d'utilisation", MUT/0712/0206D, revision D of May 2013.

mod assumptions;
mod axis;
pub mod bits;
mod describe;
mod drive;
mod driver;
pub mod emulator;
mod fault;
mod follow;
pub mod memory;
mod mode;
mod options;
pub mod parameter;
mod rehearsal;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod vectors;
pub mod zone;

pub use assumptions::{Assumptions, CamStart, Corrections, EntryOrder};
pub use axis::{
    AxisSettings, Bench, Contact, EncoderBench, EncoderKind, MOST_POSITION, REFERENCES,
};
pub use describe::describe_messages;
pub use drive::Bim2AxDrive;
pub use driver::{Bim2Ax, Bim2AxOptions, BusStamp, Identity, Move, Start};
pub use fault::Fault;
pub use memory::{ByteOrder, MappedMemory, Master, Memory, MemoryFile, SharedModule, file_offset};
pub use mode::DriveMode;
pub use options::Bim2AxDriveOptions;
pub use parameter::ModuleAxis;
pub use rehearsal::{Bim2AxRehearsal, RehearsalOptions};

/// Axes of a module.
pub const AXES: usize = 2;
