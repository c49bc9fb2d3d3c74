//! Jerk-limited ramp: the fastest change from a velocity and an acceleration to a velocity without acceleration.
//!
//! Upwards the acceleration rises with the jerk j to a peak p, stays there if that is the limit, and falls to 0:
//!
//! ```text
//! v1 − v0 = (2p² − a0² − a1²)/2j + p·hold
//! ```
//!
//! Where the velocity goes through 0, braking ends and speeding up begins, each with a limit of its own. At 0 the
//! acceleration may only be the smaller of them. A ramp that would exceed it there has two such humps, which meet at
//! velocity 0 with this acceleration. Downwards everything is the mirror image.

use crate::rates::Rates;
use crate::segment::Track;

/// The acceleration goes from one value up to a peak and down to another one.
#[derive(Clone, Copy, Debug, Default)]
struct Hump {
    /// At the beginning.
    from: f64,
    peak: f64,
    /// Durations, s. To a peak below the acceleration at the beginning the rise is a fall.
    rise: f64,
    hold: f64,
    fall: f64,
}

/// A ramp upwards: to a velocity that is not below the one at which the acceleration, taken back at once, gets 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Up {
    first: Hump,
    second: Option<Hump>,
    /// Velocity at the end, u/s.
    to: f64,
    /// From the beginning to the end, u.
    pub(super) way: f64,
}

impl Up {
    /// Peak of the acceleration at the side of the beginning.
    pub(super) fn first_peak(&self) -> f64 {
        self.first.peak
    }

    /// Peak of the acceleration at the side of the end.
    pub(super) fn last_peak(&self) -> f64 {
        self.second.map_or(self.first.peak, |second| second.peak)
    }

    /// Appends it, or with `sign` −1 its mirror image.
    pub(super) fn push(&self, track: &mut Track, sign: f64, jerk: f64) {
        for hump in [Some(self.first), self.second].into_iter().flatten() {
            let (from, peak) = (sign * hump.from, sign * hump.peak);
            let rising = if hump.peak < hump.from { -sign * jerk } else { sign * jerk };
            track.push(hump.rise, from, rising);
            track.push(hump.hold, peak, 0.0);
            track.push(hump.fall, peak, -sign * jerk);
        }
        track.state.velocity = sign * self.to;
        track.state.acceleration = 0.0;
    }
}

impl Rates {
    /// The ramp from a velocity and an acceleration up to a velocity.
    pub(super) fn up(&self, velocity: f64, acceleration: f64, to: f64) -> Up {
        let (half, up, down) = (0.5 * self.inverse, self.acceleration, self.deceleration);
        let (v0, a0) = (velocity, acceleration);
        let lowest = if a0 < 0.0 { v0 - half * a0 * a0 } else { v0 };
        if lowest >= 0.0 || to <= 0.0 || up.total_cmp(&down).is_eq() {
            return self.single(v0, a0, to, if to > 0.0 { up } else { down });
        }
        let middle = up.min(down);
        if to < half * middle * middle {
            // Through 0 when the acceleration falls already.
            return self.single(v0, a0, to, down);
        }
        if v0 + half * (middle - a0).signum() * (middle * middle - a0 * a0) > 0.0 {
            // Through 0 before it has risen as far.
            return self.single(v0, a0, to, up);
        }
        let (first, way) = self.hump([v0, 0.0], [a0, middle], down);
        let (second, more) = self.hump([0.0, to], [middle, 0.0], up);
        Up { first, second: Some(second), to, way: way + more }
    }

    fn single(&self, velocity: f64, acceleration: f64, to: f64, limit: f64) -> Up {
        let (first, way) = self.hump([velocity, to], [acceleration, 0.0], limit);
        Up { first, second: None, to, way }
    }

    /// A hump between velocities and accelerations, and its way.
    #[inline]
    fn hump(&self, [v0, v1]: [f64; 2], [a0, a1]: [f64; 2], limit: f64) -> (Hump, f64) {
        let Self { jerk, inverse, .. } = *self;
        let half = 0.5 * inverse;
        let square = jerk * (v1 - v0) + 0.5 * (a0 * a0 + a1 * a1);
        let (peak, hold, side) = if square < limit * limit {
            (square.max(0.0).sqrt().max(a0).max(a1), 0.0, 1.0)
        } else {
            let sign = if a0 > limit { -1.0 } else { 1.0 };
            let rise = sign * half * (limit * limit - a0 * a0);
            let fall = half * (limit * limit - a1 * a1);
            (limit, ((v1 - v0 - rise - fall) / limit).max(0.0), sign)
        };
        let (rise, fall) = (side * (peak - a0) * inverse, (peak - a1) * inverse);
        let rising = side * jerk;
        let at_peak = v0 + rise * (a0 + 0.5 * rising * rise);
        let way = rise * (v0 + rise * (0.5 * a0 + rising * rise / 6.0))
            + hold * (at_peak + 0.5 * peak * hold)
            + fall * (v1 - fall * (0.5 * a1 + jerk * fall / 6.0));
        (Hump { from: a0, peak, rise, hold, fall }, way)
    }
}
