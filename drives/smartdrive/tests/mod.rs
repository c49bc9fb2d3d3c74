//! The driver against frames computed elsewhere, and against the emulator on a pseudo-terminal.

mod requests;
mod terminal;
mod wire;
