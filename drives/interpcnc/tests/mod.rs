//! The driver against frames computed elsewhere, and against the emulator on a pseudo-terminal.

mod assumptions;
mod board;
mod encoder;
mod faults;
mod peers;
mod terminal;
mod vectors;
mod wire;
