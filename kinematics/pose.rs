//! Tool pose, and its motion: velocity, acceleration and jerk.

use nalgebra::{Point3, Vector3};

/// Pose of a tool: the position of its tip and its direction about the vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Tool tip, m.
    pub position: Point3<f64>,
    /// Direction of the tool about +z, rad, 0 = +x (the manual's 0° = East), counter-clockwise. Transforms without
    /// an axis for it report 0 and ignore it.
    pub direction: f64,
}

impl Pose {
    /// A tool tip at `x`, `y`, `z` (m) with direction 0.
    pub fn at(x: f64, y: f64, z: f64) -> Self {
        Self { position: Point3::new(x, y, z), direction: 0.0 }
    }

    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        self.position.iter().all(|value| value.is_finite()) && self.direction.is_finite()
    }
}

/// A moving tool: pose, velocity and acceleration at one instant, all in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolMotion {
    /// Pose of the tool tip.
    pub pose: Pose,
    /// Velocity of the tool tip, m/s.
    pub velocity: Vector3<f64>,
    /// Acceleration of the tool tip, m/s².
    pub acceleration: Vector3<f64>,
    /// Rate of [`Pose::direction`], rad/s.
    pub direction_velocity: f64,
    /// Second derivative of [`Pose::direction`], rad/s².
    pub direction_acceleration: f64,
}

impl ToolMotion {
    /// At rest at `pose`.
    pub fn at_rest(pose: Pose) -> Self {
        Self {
            pose,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            direction_velocity: 0.0,
            direction_acceleration: 0.0,
        }
    }

    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        self.pose.is_finite()
            && self.velocity.iter().chain(&self.acceleration).all(|value| value.is_finite())
            && self.direction_velocity.is_finite()
            && self.direction_acceleration.is_finite()
    }
}

/// The third derivative of a tool pose by time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolJerk {
    /// Of the tool tip, m/s³.
    pub linear: Vector3<f64>,
    /// Of [`Pose::direction`], rad/s³.
    pub direction: f64,
}

impl ToolJerk {
    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        self.linear.iter().all(|value| value.is_finite()) && self.direction.is_finite()
    }
}
