//! Ramp-in from the slave's position to its cam (`ramp_in`, manual 4.6.1), under limited velocity and accelerations.
//! `motion/cam/jerk_limited_ramp_in.rs` has the ramp-in of an axis with limited jerk: a coupling knows no axis.

/// A motion that ends at rest: pieces of constant acceleration, as fast as velocity and accelerations allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RampIn {
    /// Duration in seconds and acceleration of each.
    pieces: [(f64, f64); 4],
    velocity: f64,
    distance: f64,
}

/// Limits of a bridge, all greater than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RampInLimits {
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
    pub(crate) deceleration: f64,
}

impl RampInLimits {
    /// Distance of a stop from `velocity`, with its sign.
    pub(crate) fn stop(&self, velocity: f64) -> f64 {
        velocity * velocity.abs() / (2.0 * self.deceleration)
    }
}

impl RampIn {
    /// Goes `distance` on, from `velocity` to rest.
    pub(crate) fn new(distance: f64, velocity: f64, limits: &RampInLimits) -> Self {
        let RampInLimits { velocity: most, acceleration: up, deceleration: down } = *limits;
        // All that follows is for a motion that ends forwards.
        let sign = if distance - limits.stop(velocity) < 0.0 { -1.0 } else { 1.0 };
        let (mut v, mut left) = (velocity * sign, distance * sign);
        let mut pieces = [(0.0, 0.0); 4];
        let [first, second, third, fourth] = &mut pieces;
        if v < 0.0 {
            *first = (-v / down, down * sign);
            left += v * v / (2.0 * down);
            v = 0.0;
        } else if v > most {
            *first = ((v - most) / down, -down * sign);
            left -= (v * v - most * most) / (2.0 * down);
            v = most;
        }
        let peak_v2 = (2.0 * left + v * v / up) * up * down / (up + down);
        // Rounding aside, the peak is not below v: the rest is more than a stop.
        let peak = peak_v2.max(v * v).sqrt().min(most);
        *second = ((peak - v) / up, up * sign);
        let ramps = (peak * peak - v * v) / (2.0 * up) + peak * peak / (2.0 * down);
        if peak > 0.0 {
            *third = (((left - ramps) / peak).max(0.0), 0.0);
        }
        *fourth = (peak / down, -down * sign);
        Self { pieces, velocity, distance }
    }

    /// Remaining distance, velocity and acceleration `t` seconds after the begin; true if it is over.
    pub(crate) fn at(&self, t: f64) -> (f64, f64, f64, bool) {
        let (mut gone, mut velocity, mut left) = (0.0, self.velocity, t);
        for (duration, acceleration) in self.pieces {
            let part = left.min(duration);
            gone += (velocity + acceleration * part / 2.0) * part;
            velocity += acceleration * part;
            if left < duration {
                return (self.distance - gone, velocity, acceleration, false);
            }
            left -= part;
        }
        (0.0, 0.0, 0.0, true)
    }
}

#[cfg(test)]
mod tests {
    use super::{RampIn, RampInLimits};
    use proptest::prelude::*;

    proptest! {
        /// It ends where it should, at rest, without a step and within its limits (but for a velocity it begins with).
        #[test]
        fn bridges_arrive(distance in -50.0..50.0_f64, velocity in -20.0..20.0_f64, most in 0.1..30.0_f64, up in 0.1..30.0_f64, down in 0.1..30.0_f64) {
            let limits = RampInLimits { velocity: most, acceleration: up, deceleration: down };
            let bridge = RampIn::new(distance, velocity, &limits);
            let total: f64 = bridge.pieces.iter().map(|(duration, _)| duration).sum();
            prop_assert!(bridge.pieces.iter().all(|(duration, _)| *duration >= 0.0));
            let (left, speed, ..) = bridge.at(total * (1.0 - 1e-12));
            prop_assert!(left.abs() < 1e-7 && speed.abs() < 1e-7, "{left} {speed}");
            prop_assert_eq!(bridge.at(total * (1.0 + 1e-9) + 1e-9), (0.0, 0.0, 0.0, true));
            let begin = bridge.at(0.0);
            let begun = (begin.0 - distance).abs() < 1e-12 && (begin.1 - velocity).abs() < 1e-12;
            prop_assert!(begun || total == 0.0);
            let (mut before, step) = ((distance, velocity), total / 1000.0);
            for index in 1..1000 {
                let (left, speed, ..) = bridge.at(f64::from(index) * step);
                prop_assert!(speed.abs() <= most.max(velocity.abs()) + 1e-9);
                prop_assert!((speed - before.1).abs() <= up.max(down) * step * (1.0 + 1e-9) + 1e-12);
                let mean = f64::midpoint(speed, before.1);
                // A kink of the velocity within the step.
                prop_assert!((before.0 - left - mean * step).abs() <= (up + down) * step * step + 1e-9);
                before = (left, speed);
            }
        }
    }

    /// 10 at 2 u/s, 1 and 2 u/s²: 2 s up, 1 s down, 3 u of ramps and 7 u at 2 u/s.
    #[test]
    fn a_trapezoid() {
        let limits = RampInLimits { velocity: 2.0, acceleration: 1.0, deceleration: 2.0 };
        let bridge = RampIn::new(10.0, 0.0, &limits);
        let total: f64 = bridge.pieces.iter().map(|(duration, _)| duration).sum();
        assert!((total - 6.5).abs() < 1e-12);
        assert_eq!(bridge.at(2.0), (8.0, 2.0, 0.0, false));
    }
}
