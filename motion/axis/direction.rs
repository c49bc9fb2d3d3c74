//! Direction of a rotary move: positive, negative, shortest, fastest (manual 5.3).

use super::Axis;
use super::math::fmod;
use twin_profile::{AxisLimits, Profile, State};

/// Positions closer than this part of a period are the same.
pub(super) const SAME: f64 = 1e-9;

/// Direction of a motion (`MC_Direction`). Absolute moves of linear axes ignore it.
#[doc(alias = "MC_Direction")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Direction {
    /// −1 `negative`.
    Negative,
    /// 0 `shortest`: the way from the present position; half a period goes the positive way.
    #[default]
    Shortest,
    /// 1 `positive`.
    Positive,
    /// 2 `current`: as the axis moves, at rest as it moved last.
    Current,
    /// 3 `fastest`: whatever takes less time from the present state of motion.
    Fastest,
}

impl Direction {
    /// The sign of a velocity in this direction; none for shortest and fastest.
    pub(crate) fn sign(self, axis: &Axis, start: State) -> Option<f64> {
        match self {
            Self::Negative => Some(-1.0),
            Self::Positive => Some(1.0),
            Self::Current => {
                let rests = start.velocity == 0.0;
                let negative = start.velocity < 0.0 || (rests && axis.was_negative());
                Some(if negative { -1.0 } else { 1.0 })
            }
            Self::Shortest | Self::Fastest => None,
        }
    }

    /// Unwound target position with which the axis ends at `target` u within its period; both in the drive's
    /// coordinates.
    pub(crate) fn unwound(
        self,
        axis: &Axis,
        start: State,
        target: f64,
        limits: AxisLimits,
        end_velocity: f64,
    ) -> f64 {
        let Some(period) = axis.period() else { return target };
        let way = fmod(target - start.position, period);
        let [forward, backward] = if way < SAME * period || period - way < SAME * period {
            let short = if way < period / 2.0 { way } else { way - period };
            [start.position + short; 2]
        } else {
            [start.position + way, start.position + way - period]
        };
        let time = |target| {
            let profile = Profile::to_position(start, target, end_velocity, limits, axis.ramp());
            profile.map_or(f64::INFINITY, |profile| profile.duration())
        };
        let goes_forward = match self.sign(axis, start) {
            Some(sign) => sign > 0.0,
            None if self == Self::Shortest => way <= period / 2.0,
            None => time(forward) <= time(backward),
        };
        if goes_forward { forward } else { backward }
    }
}
