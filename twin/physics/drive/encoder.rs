//! Encoder of a drive: measured position of its axis.

/// Mounting side of an encoder: motor or axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncoderSide {
    /// On the motor: it does not see the deflection of the transmission.
    Motor,
    /// On the axis: a scale, or an encoder behind the gear.
    Axis,
}

/// The encoder of an axis. The velocity loop takes the motor's velocity in any case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderParameters {
    /// Mounting side.
    pub side: EncoderSide,
    /// One increment, m or rad at the axis; 0 for an ideal one. Encoders of motors have 10³ to 10⁷ increments a turn.
    pub resolution: f64,
}

impl EncoderParameters {
    /// On the motor, with any number of increments.
    pub(crate) const IDEAL: Self = Self { side: EncoderSide::Motor, resolution: 0.0 };

    /// `position` in whole increments, m or rad.
    pub(super) fn measured(&self, position: f64) -> f64 {
        if self.resolution > 0.0 {
            (position / self.resolution).round() * self.resolution
        } else {
            position
        }
    }
}
