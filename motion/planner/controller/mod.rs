//! Interpolator: one set-point per cycle along the prepared path (`SMC_Interpolator`, manual 6.2.9).
//!
//! [`LookAhead`] plans the velocities at the transitions, [`Profile`] fills in the element between them, and
//! [`Interpolator`] samples the result at the cycle:
//!
//! ```text
//! CheckedElement ─ LookAhead ─▶ PlannedElement ─ Interpolator ─▶ ToolSetpoint
//!                                      Inputs (override, stops, M) ─┘   └─▶ status, switches, M, extra axes
//! ```
//!
//! [`VelocityMode`] chooses between constant acceleration, sin² ramps (`SIGMOID`) and limited jerk.
//! [`TwoWayInterpolator`] follows a path held as a whole forwards and backwards; [`XInterpolator`] follows it by the
//! position of a workpiece.

mod ambiguity;
mod braking;
mod by_position;
mod control;
mod error;
mod heading;
mod inputs;
mod interpolator;
mod look_ahead;
mod profile;
mod ramp;
mod run;
mod setpoint;
mod source;
mod spans;
mod sum;
pub(crate) mod switches;
#[cfg(test)]
mod tests;
mod transition;
mod two_way;

pub use ambiguity::XAmbiguity;
pub use by_position::{XDirection, XInterpolator};
pub use error::IpoError;
pub use heading::Heading;
pub use inputs::{Inputs, Override, VelocityMode};
pub use interpolator::{DEFAULT_CYCLE_NS, Interpolator};
pub use look_ahead::{DEFAULT_WINDOW, LookAhead, PlannedElement};
pub use profile::{Profile, trapezoid};
pub use setpoint::{ExtraMotion, Status, ToolSetpoint};
pub use source::{Incoming, Source};
pub use two_way::{Direction, TwoWayInterpolator, TwoWayPath};
