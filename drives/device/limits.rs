//! Limits of an axis as its device reports them.

/// Limits of an axis as the device has them in its parameters, or as it is built. What it does not have is absent:
/// there the driver's own options are all that limits the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeviceLimits {
    /// Largest speed, increments/s.
    pub speed: Option<f64>,
    /// Largest acceleration, increments/s².
    pub acceleration: Option<f64>,
    /// Largest deceleration, increments/s².
    pub deceleration: Option<f64>,
    /// Smallest position the device goes to, increments as [`crate::Drive::sample`] counts now.
    pub lowest: Option<i64>,
    /// Largest position the device goes to, increments as [`crate::Drive::sample`] counts now.
    pub highest: Option<i64>,
}
