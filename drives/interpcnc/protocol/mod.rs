//! Registers, commands, parameters and exceptions of the board (Modbus RTU), without a wire.

pub mod command;
pub mod exception;
pub(crate) mod frame;
pub mod line;
pub mod parameters;
pub mod registers;
#[cfg(test)]
pub(crate) mod vectors;
