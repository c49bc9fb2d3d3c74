//! Zones, register bits, parameters and memory of the module, as host and module share them.

pub mod bits;
pub mod describe;
pub mod fault;
pub mod memory;
pub mod mode;
pub mod parameter;
pub mod settings;
#[cfg(test)]
pub(crate) mod vectors;
pub mod zone;
