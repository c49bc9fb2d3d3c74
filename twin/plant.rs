//! What set-points can be sent to: a simulated machine or drives.

use crate::setpoint::AxisSetpoint;
use twin_kinematics::AxisVector;

/// Where the axes were found at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisFeedback {
    /// Since the start of the program, ns.
    pub time_ns: i64,
    /// m or rad, machine-file order.
    pub position: AxisVector,
}

/// Something whose axes follow set-points.
///
/// Set-points come in order, one per cycle, time-stamped and possibly ahead of time; feedback comes when it comes.
pub trait Plant {
    /// Why it cannot go on.
    type Error;

    /// Takes the next set-point.
    ///
    /// # Errors
    /// If the plant has failed; its axes have then been brought to a stop as well as it can.
    fn command(&mut self, setpoint: &AxisSetpoint) -> Result<(), Self::Error>;

    /// The next feedback that has arrived, if any.
    ///
    /// # Errors
    /// As [`Self::command`].
    fn feedback(&mut self) -> Result<Option<AxisFeedback>, Self::Error>;
}
