//! Eased braking: less braking at first, for distances between the straight ramp and the ramp over a constant velocity.

use super::{MOST_STEPS, Way};
use crate::rates::Rates;

/// Eased braking with the acceleration −α instead of the first one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ease<'a> {
    pub(super) way: &'a Way,
    pub(super) limits: &'a Rates,
    /// Velocity with α = 0.
    pub(super) settled: f64,
}

impl Ease<'_> {
    /// The α with which the end is met soonest, if there is one.
    pub(super) fn alpha(&self) -> Option<f64> {
        let most = -self.way.a0;
        let mut high = most;
        if self.way.v1 < 0.0 {
            // The end may go forth, back and forth again as α shrinks.
            let mut turns = self.turns();
            turns.sort_by(|a, b| b.total_cmp(a));
            for turn in turns {
                if turn > 0.0 && turn < high {
                    if self.excess(turn).0 >= 0.0 {
                        return Some(self.between(turn, high));
                    }
                    high = turn;
                }
            }
        }
        (self.excess(0.0).0 >= 0.0).then(|| self.between(0.0, high))
    }

    /// Distance of the end beyond the target, u, the velocity where the acceleration is −α, and the peak of the
    /// deceleration.
    fn excess(&self, alpha: f64) -> (f64, f64, f64) {
        let Self { way, limits, settled } = *self;
        let jerk = limits.jerk;
        let velocity = settled + 0.5 * alpha * alpha / jerk;
        let down = limits.up(-velocity, alpha, -way.v1);
        let time = (-alpha - way.a0) / jerk;
        let eased = time * (velocity + time * (0.5 * alpha + jerk * time / 6.0));
        (eased - down.way - way.length, velocity, down.first_peak())
    }

    /// The α between one that leads too far and one that does not lead far enough.
    fn between(&self, far: f64, near: f64) -> f64 {
        let (mut far, mut near) = (far, near);
        let mut alpha = 0.5 * (far + near);
        let jerk = self.limits.jerk;
        for _ in 0..MOST_STEPS {
            let (excess, velocity, peak) = self.excess(alpha);
            if excess.abs() <= self.way.tolerance {
                break;
            }
            if excess > 0.0 {
                far = alpha;
            } else {
                near = alpha;
            }
            let along = velocity - 0.5 * alpha * (peak - alpha) / jerk;
            let slope = -2.0 / jerk * (1.0 - alpha / peak) * along;
            let next = alpha - excess / slope;
            let next = if far < next && next < near { next } else { 0.5 * (far + near) };
            if next.total_cmp(&alpha).is_eq() {
                break;
            }
            alpha = next;
        }
        alpha
    }

    /// Possible turning points of the end: the zeros of 2α² − α·q + c with c = 2j·v at α = 0 for every form of q, the
    /// limits and √(α² + k), with k for a ramp to the end velocity and to a standstill at the smaller limit. A value that
    /// is not a zero only divides a piece.
    fn turns(&self) -> [f64; 8] {
        let Rates { acceleration, deceleration, jerk, .. } = *self.limits;
        let c = 2.0 * jerk * self.settled;
        let middle = acceleration.min(deceleration);
        let held = |limit: f64, sign: f64| {
            0.25 * (limit + sign * (limit * limit - 8.0 * c).max(0.0).sqrt())
        };
        // 3α⁴ + (4c − k)·α² + c² = 0.
        let free = |k: f64, sign: f64| {
            let b = k - 4.0 * c;
            let root = (b * b - 12.0 * c * c).max(0.0).sqrt();
            ((b + sign * root) / 6.0).max(0.0).sqrt()
        };
        let straight = jerk * (self.settled - self.way.v1);
        let standstill = jerk * self.settled + 0.5 * middle * middle;
        [
            held(acceleration, 1.0),
            held(acceleration, -1.0),
            held(deceleration, 1.0),
            held(deceleration, -1.0),
            free(straight, 1.0),
            free(straight, -1.0),
            free(standstill, 1.0),
            free(standstill, -1.0),
        ]
    }
}
