//! SmartDRIVE v1.2, drives for step motors with one axis each, up to 31 on one RS485 bus, protocol ATB.
//!
//! [`SmartDrive`] is the client of all drives of a bus, one exchange after the other, [`SmartDriveBus`] makes up to five of
//! them a [`twin_drives::Drive`]; [`emulator`] is the drives without hardware, and [`SmartDrivePrediction`] both in
//! simulated time. All take commands, answers and parameters from the tables of [`protocol`], which are checked against
//! frames computed elsewhere.
//!
//! Source: "SmartDRIVE v1.2 - Protocole série ATB".
//!
//! ```
//! use twin_smartdrive::protocol::frame;
//! use twin_smartdrive::{Command, StepsPerTurn};
//!
//! // A motor of 200 full steps with 16 µsteps each: 3200 µsteps per turn, 32000 µsteps/s at 600 rpm.
//! let turn = StepsPerTurn::new(200, 16).ok_or("no turn")?;
//! assert_eq!(turn.get(), 3200);
//! assert!((turn.steps(600.0) - 32_000.0).abs() < 1e-9);
//! // GOTO +3200 for address 1: code 23h, the position with its low byte first, and the exclusive or of all bytes.
//! let frame = frame::encode(1, &Command::GoTo { target: 3200, profile: None });
//! assert_eq!(frame, [0x01, 0x23, 0x80, 0x0C, 0x00, 0x00, 0xAE]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
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

pub use assumptions::{
    AccCurrent, Assumptions, BadFrame, BothBits, HomePosition, LimitStop, SetEffect, StepFrom,
    ZeroRate,
};
pub use client::{AxisOptions, DriveState, IoState, ParameterValue, SmartDrive, SmartDriveOptions};
pub use drive::{OUTPUTS, SmartDriveBus};
pub use family::{SmartDriveEntry, SmartDriveFamily};
pub use prediction::{BusDelays, SmartDrivePrediction};
pub use protocol::command::{Command, Init, IoUpdate, LoadSource, Mode};
pub use protocol::fault::Fault;
pub use protocol::frame::AnswerLength;
pub use protocol::line::{ADDRESSES, BAUD, Execution, wire_time};
pub use protocol::status::{Alarms, RejectCode, Status, TagLayout, TrajectoryFlags};
pub use protocol::units::StepsPerTurn;
