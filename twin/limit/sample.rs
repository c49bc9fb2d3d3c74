//! Profile sample: path and axes at one instant.

use super::Binding;
use twin_kinematics::AxisVector;
use twin_path::Place;

/// The path and the axes at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileSample {
    /// Since the start of the program, ns.
    pub time_ns: i64,
    /// The block being traversed.
    pub place: Place,
    /// Way along the path since the start of the program, m.
    pub way: f64,
    /// Programmed velocity, F or that of rapids, m/s; 0 where the path is at rest.
    pub feed: f64,
    /// Along the path, m/s.
    pub path_velocity: f64,
    /// Along the path, m/s².
    pub path_acceleration: f64,
    /// Along the path, m/s³.
    pub path_jerk: f64,
    /// Axes in machine-file order, m or rad.
    pub position: AxisVector,
    /// m/s or rad/s.
    pub velocity: AxisVector,
    /// m/s² or rad/s².
    pub acceleration: AxisVector,
    /// m/s³ or rad/s³.
    pub jerk: AxisVector,
    /// Forces or torques of the motors, N or Nm, if they are known.
    pub effort: Option<AxisVector>,
    /// The binding limit, if it is known.
    pub binding: Option<Binding>,
}
