//! SOPROLEC InterpCNC V2.1, a stepper board for five axes on Modbus RTU.
//!
//! [`InterpCncDrive`] is the driver; [`emulator`] is the board without hardware. Both take registers and commands
//! from the same tables ([`registers`], [`Command`]), which are checked against frames computed elsewhere.
//!
//! Source: "Carte d'axe SOPROLEC InterpCNC V2.1, Protocole de communication MODBUS" (firmware up to 5.30).

mod assumptions;
mod blocking;
mod command;
mod driver;
pub mod emulator;
mod exception;
mod follow;
mod options;
pub mod parameters;
mod port;
pub mod registers;
mod rehearsal;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod vectors;

pub use crate::Stamp;
pub use assumptions::{Assumptions, BAUD_RATES, BaudCode, BoardStop, OutputCode};
pub use blocking::InterpCncDrive;
pub use command::{AxisValues, BadCommand, Command, CommandRegisters, MoveProfile};
pub use driver::{BoardState, HomeAxis, Identity, InterpCnc, ProbeMove, Recipes, Snapshot};
pub use exception::Exception;
pub use options::{AxisOptions, EncoderOptions, Following, InterpCncOptions, Line, Parity};
pub use registers::{AxisMask, BoardAxis};
pub use rehearsal::{InterpCncRehearsal, Prediction, predict, rehearse};
