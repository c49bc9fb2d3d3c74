//! SmartDRIVE v1.2, drives for step motors with one axis each, up to 31 on one RS485 bus, protocol ATB.
//!
//! [`SmartDrive`] is the client of all drives of a bus, one exchange after the other, [`SmartDriveBus`] makes up to five of
//! them a [`twin_drives::Drive`]; [`emulator`] is the drives without hardware, and [`SmartDrivePrediction`] both in
//! simulated time. All take commands, answers and parameters from the tables of [`protocol`], which are checked against
//! frames computed elsewhere.
//!
//! Source: "SmartDRIVE v1.2 - Protocole série ATB".

mod assumptions;
mod client;
mod drive;
pub mod emulator;
mod family;
mod prediction;
pub mod protocol;
#[cfg(test)]
mod tests;

pub use assumptions::{
    AccCurrent, Assumptions, BadFrame, BothBits, HomePosition, LimitStop, SetEffect, StepFrom,
    ZeroRate,
};
pub use client::{
    Accelerations, AxisOptions, DriveState, IoState, ParameterValue, SmartDrive, SmartDriveOptions,
};
pub use drive::{OUTPUTS, SmartDriveBus};
pub use family::{SmartDriveEntry, SmartDriveFamily};
pub use prediction::{BusDelays, SmartDrivePrediction};
pub use protocol::command::{Command, Init, IoUpdate, LoadSource, Mode};
pub use protocol::fault::Fault;
pub use protocol::frame::AnswerLength;
pub use protocol::line::{ADDRESSES, BAUD, Execution, wire_time};
pub use protocol::status::{Alarms, RejectCode, Status, TagLayout, TrajectoryFlags};
pub use protocol::units::StepsPerTurn;
