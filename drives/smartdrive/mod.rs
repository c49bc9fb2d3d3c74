//! SmartDRIVE v1.2, drives for step motors with one axis each, up to 31 on one RS485 bus, protocol ATB.
//!
//! [`SmartDrive`] speaks to all drives of a bus, one exchange after the other, and [`SmartDriveBus`] makes up to five of
//! them a [`crate::Drive`]; [`emulator`] is the drives without hardware, and [`SmartDriveRehearsal`] what both make of a
//! plan in simulated time. Commands and answers, [`parameters`] and variables are the same tables for all, checked
//! against frames computed elsewhere.
//!
//! Source: "SmartDRIVE v1.2 - Protocole série ATB".

mod assumptions;
mod blocking;
mod command;
mod driver;
pub mod emulator;
mod fault;
mod follow;
pub mod frame;
mod in_step;
mod memory;
mod motion;
mod options;
pub mod parameters;
mod rehearsal;
mod requests;
mod search;
mod status;
#[cfg(test)]
mod tests;
mod travel;
mod units;
#[cfg(test)]
mod vectors;

pub use assumptions::{
    AccCurrent, AnswerLength, Assumptions, BadFrame, BothBits, HomePosition, LimitStop, SetEffect,
    StepFrom, ZeroRate,
};
pub use blocking::{OUTPUTS, SmartDriveBus};
pub use command::{Command, Init, IoUpdate, LoadSource, Mode};
pub use driver::SmartDrive;
pub use fault::Fault;
pub use memory::{Accelerations, ParameterValue};
pub use options::{ADDRESSES, AxisOptions, BAUD, Execution, SmartDriveOptions, wire_time};
pub use rehearsal::{BusDelays, SmartDriveRehearsal};
pub use requests::{DriveState, IoState};
pub use status::{Alarms, RejectCode, Status, TagLayout, TrajectoryFlags};
pub use units::StepsPerTurn;
