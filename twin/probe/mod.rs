//! Probing moves of one axis of the simulated machine, and arguments that boards reject.

mod axis;
mod board;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod vice_tests;

pub use axis::{AxisProbe, AxisProbeEnd, AxisProbeError};
pub use board::BoardRefusal;
