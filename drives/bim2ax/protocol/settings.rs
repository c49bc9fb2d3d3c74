//! Settings of one axis, as the module's parameters give them.

use super::parameter::MOST_POSITION;
use crate::{DriveMode, protocol::bits::coefficient};
use twin_drives::ramp::Ramp;

/// Number of reference positions of an axis.
pub const REFERENCES: usize = 10;

/// The parameters of one axis that its motion depends on. Positions and distances are µsteps (increments of the
/// drive mode), speeds and accelerations in the unit of the drive mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisSettings {
    /// Coefficient, parameter 0 or 1: bits of [`super::bits::coefficient`].
    pub coefficient: u16,
    /// Drive mode, parameter 2 or 3.
    pub mode: DriveMode,
    /// "Arrêt origine", parameter 8 or 9: way from the cam's edge to the origin.
    pub origin_stop: u32,
    /// Fast speed, parameter $A or $B, 1 to 65535.
    pub fast_speed: u16,
    /// Start-stop speed, parameter $C or $D, 1 to 65535.
    pub start_stop_speed: u16,
    /// Way of the unidirectional approach, parameter $E or $F.
    pub approach: u32,
    /// Soft limit +, parameter $10 or $11.
    pub soft_plus: i32,
    /// Soft limit −, parameter $12 or $13.
    pub soft_minus: i32,
    /// Acceleration and deceleration, parameter $14 or $15, 1 to 65535.
    pub acceleration: u16,
    /// Reference positions 1 to 10, parameters $16–$1F or $20–$29.
    pub references: [i32; REFERENCES],
    /// Homing hysteresis, parameter $2A or $2B.
    pub hysteresis: u32,
}

impl Default for AxisSettings {
    /// A present axis without end switches, 1/16 steps, speeds in steps/s: 1000 fast, 100 start-stop,
    /// 2000 steps/s²; no approach, limits as wide as they go. The manual gives no defaults.
    fn default() -> Self {
        Self {
            coefficient: coefficient::PRESENT
                | coefficient::IGNORE_SWITCHES
                | coefficient::CAM_CLOSES
                | coefficient::SWITCHES_CLOSE,
            mode: DriveMode::from_code(0x0400).unwrap_or(DriveMode::FULL_STEP),
            origin_stop: 0,
            fast_speed: 1000,
            start_stop_speed: 100,
            approach: 0,
            soft_plus: MOST_POSITION,
            soft_minus: -MOST_POSITION,
            acceleration: 2000,
            references: [0; REFERENCES],
            hysteresis: 0,
        }
    }
}

impl AxisSettings {
    /// True if a bit of the coefficient is set.
    pub fn has(&self, bit: u16) -> bool {
        self.coefficient & bit != 0
    }

    /// Start-stop speed, µsteps/s. A value of 0, which the manual excludes, counts as 1.
    pub fn start_stop(&self) -> f64 {
        f64::from(self.start_stop_speed.max(1)) * self.mode.speed_unit()
    }

    /// A programmed speed, at most the fast speed and at least 1, µsteps/s.
    pub fn speed(&self, programmed: u16) -> f64 {
        f64::from(programmed.min(self.fast_speed).max(1)) * self.mode.speed_unit()
    }

    /// Acceleration, µsteps/s².
    pub fn rate(&self) -> f64 {
        f64::from(self.acceleration.max(1)) * self.mode.speed_unit()
    }

    /// The ramp of a move to `target` at `speed` µsteps/s.
    pub(crate) fn ramp(&self, speed: f64, target: f64) -> Ramp {
        let rate = self.rate();
        Ramp {
            start_stop: self.start_stop(),
            acceleration: rate,
            speed,
            deceleration: rate,
            target,
        }
    }
}
