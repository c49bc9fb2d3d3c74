//! The driver against frames computed elsewhere, and against the emulator on a pseudo-terminal.

mod assumptions;
mod faults;
mod in_step;
mod requests;
mod terminal;
mod vectors;
mod wire;
mod witness;
