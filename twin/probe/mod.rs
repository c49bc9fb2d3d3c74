//! Probing by one axis of the simulated machine, and what boards refuse of a probing move.

mod axis;
mod board;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod vice_tests;

pub use axis::{AxisProbe, AxisProbeEnd, AxisProbeError};
pub use board::BoardRefusal;
