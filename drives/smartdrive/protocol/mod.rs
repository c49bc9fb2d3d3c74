//! Frames, commands, status words, parameters and units of the protocol ATB, without a wire.

pub mod command;
pub mod fault;
pub mod frame;
pub mod line;
pub mod parameters;
pub mod status;
pub mod units;
#[cfg(test)]
pub(crate) mod vectors;
