//! SOPROLEC InterpCNC V2.1, a stepper board for five axes on Modbus RTU.
//!
//! [`InterpCnc`] is the client, [`InterpCncDrive`] the same as a [`twin_drives::Drive`], [`emulator`] the board without
//! hardware, and [`InterpCncPrediction`] both in simulated time. All take registers and commands from the tables of
//! [`protocol`], which are checked against frames computed elsewhere.
//!
//! Source: "Carte d'axe SOPROLEC InterpCNC V2.1, Protocole de communication MODBUS" (firmware up to 5.30).
//!
//! ```
//! use twin_interpcnc::Command;
//! use twin_interpcnc::emulator::{Board, BoardOptions};
//!
//! // Command 67 of the manual, second example: counter X := 1000 and Z := 0. X and Z are bits 0 and 2.
//! let command = Command::WritePosition { positions: [Some(1000), None, Some(0), None, None] };
//! assert_eq!(command.registers(), [67, 0b00101, 0, 1000, 0, 0]);
//! // The emulated board unlocks (command 66) and confirms, as frames of Modbus RTU.
//! let mut board = Board::new(&BoardOptions::default());
//! assert!(board.status().locked());
//! let unlock = [0x01, 0x10, 0x10, 0, 0, 2, 4, 0, 66, 0, 1, 0x5F, 0xBB];
//! assert_eq!(board.handle(&unlock), Some(vec![0x01, 0x10, 0x10, 0, 0, 2, 0x45, 0x08]));
//! assert!(!board.status().locked());
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

pub use assumptions::{Assumptions, BAUD_RATES, BaudCode, BoardStop, OutputCode};
pub use client::{
    AxisOptions, BoardState, EncoderOptions, Following, Identity, InterpCnc, InterpCncOptions,
    Snapshot,
};
pub use drive::InterpCncDrive;
pub use family::{InterpCncEntry, InterpCncFamily};
pub use prediction::{InterpCncPrediction, PredictionSummary, board_prediction, predict};
pub use protocol::command::{AxisValues, BadCommand, Command, CommandRegisters, MoveProfile};
pub use protocol::exception::Exception;
pub use protocol::line::{Line, Parity};
pub use protocol::registers::{AxisMask, BoardAxis};
pub use twin_drives::Stamp;
