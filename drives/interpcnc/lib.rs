//! SOPROLEC InterpCNC V2.1, a stepper board for five axes on Modbus RTU.
//!
//! [`InterpCnc`] is the client, [`InterpCncDrive`] the same as a [`twin_drives::Drive`], [`emulator`] the board without
//! hardware, and [`InterpCncPrediction`] both in simulated time. All take registers and commands from the tables of
//! [`protocol`], which are checked against frames computed elsewhere.
//!
//! Source: "Carte d'axe SOPROLEC InterpCNC V2.1, Protocole de communication MODBUS" (firmware up to 5.30).

mod assumptions;
mod client;
mod drive;
pub mod emulator;
mod family;
mod prediction;
pub mod protocol;
#[cfg(test)]
mod tests;

pub use assumptions::{Assumptions, BAUD_RATES, BaudCode, BoardStop, OutputCode};
pub use client::{
    AxisOptions, BoardState, EncoderOptions, Following, HomeAxis, Identity, InterpCnc,
    InterpCncOptions, ProbeMove, Recipes, Snapshot,
};
pub use drive::InterpCncDrive;
pub use family::{InterpCncEntry, InterpCncFamily};
pub use prediction::{InterpCncPrediction, PredictionSummary, board_prediction, predict};
pub use protocol::command::{AxisValues, BadCommand, Command, CommandRegisters, MoveProfile};
pub use protocol::exception::Exception;
pub use protocol::line::{Line, Parity};
pub use protocol::registers::{AxisMask, BoardAxis};
pub use twin_drives::Stamp;
