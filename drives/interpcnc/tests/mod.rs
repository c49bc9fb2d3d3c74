//! The driver against frames computed elsewhere, and against the emulator on a pseudo-terminal.

#[path = "../../tests/common.rs"]
#[allow(dead_code, reason = "each family uses a part")]
mod common;
#[path = "../../tests/peer.rs"]
#[allow(dead_code, reason = "each family uses a part")]
mod peer;

mod assumptions;
mod board;
mod encoder;
mod faults;
mod peers;
mod terminal;
mod vectors;
mod wire;
