//! Configuration of an axis (manual 2.1.3).

use twin_profile::RampType;

/// Linear, or rotary with a period (`iMovementType`, `fPositionPeriod`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Movement {
    /// Positions without an end.
    Linear,
    /// Positions in [0, period).
    Rotary {
        /// Length of a period, u; positive.
        period: f64,
    },
}

/// Configuration of an axis, as set in the dialogue of a drive (manual 2.1.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisConfig {
    /// Linear or rotary.
    pub movement: Movement,
    /// Cycle time (`fTaskCycle`), s.
    pub cycle: f64,
    /// Shape of the velocity ramps.
    pub ramp: RampType,
    /// Jerk of sigmoid and parabolic ramps (`fMaxJerk`, `fSWMaxJerk`), u/s³.
    pub jerk: f64,
    /// Largest velocity of direct set-points and implicit motion (`fSWMaxVelocity`), u/s.
    pub max_velocity: f64,
    /// Largest acceleration of the same (`fSWMaxAcceleration`), u/s².
    pub max_acceleration: f64,
    /// Largest deceleration of the same (`fSWMaxDeceleration`), u/s². An axis in errorstop brakes with it.
    pub max_deceleration: f64,
    /// Software limits, negative and positive (`bSWLimitEnable`, `fSWLimitNegative`, `fSWLimitPositive`), u. Linear axes
    /// only.
    pub software_limits: Option<[f64; 2]>,
    /// True if the drive can limit a capture to a window of positions.
    pub capture_window: bool,
    /// Number of the drive (`wId`, `wDriveId`); blocks tell axes by it.
    pub drive_id: u16,
}

impl Default for AxisConfig {
    /// A linear axis of 1 ms with the manual's initial values: 100 u/s, 100 u/s², 100 u/s³.
    fn default() -> Self {
        Self {
            movement: Movement::Linear,
            cycle: 0.001,
            ramp: RampType::Trapezoid,
            jerk: 100.0,
            max_velocity: 100.0,
            max_acceleration: 100.0,
            max_deceleration: 100.0,
            software_limits: None,
            capture_window: true,
            drive_id: 0,
        }
    }
}
