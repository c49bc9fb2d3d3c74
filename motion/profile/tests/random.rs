//! Random states, targets and limits from a seed.

use super::*;

/// A reproducible sequence of numbers (`SplitMix64`).
#[derive(Clone, Debug)]
pub(super) struct Random(pub(super) u64);

impl Random {
    /// Evenly spread from 0 to 1.
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let upper = u32::try_from((mixed ^ (mixed >> 31)) >> 32).unwrap();
        f64::from(upper) / f64::from(u32::MAX)
    }

    /// Evenly spread from −1 to 1.
    pub(super) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Spread evenly over the powers of ten.
    pub(super) fn decades(&mut self, from: f64, to: f64) -> f64 {
        10.0_f64.powf(from + (to - from) * self.unit())
    }

    /// One time in `count`.
    pub(super) fn once_in(&mut self, count: f64) -> bool {
        self.unit() * count < 1.0
    }
}

/// Random cases of a seed that are wanted.
pub(super) fn cases(seed: u64, count: usize, equal: bool, wanted: fn(&Case) -> bool) -> Vec<Case> {
    let mut random = Random(seed);
    let all = std::iter::repeat_with(|| Case::new(&mut random, equal));
    all.filter(wanted).take(count).collect()
}

/// Planning problem.
#[derive(Clone, Copy, Debug)]
pub(super) struct Case {
    pub(super) from: State,
    pub(super) target: f64,
    pub(super) end_velocity: f64,
    pub(super) limits: AxisLimits,
}

impl Case {
    /// Start and limits of all proportions, start within the limits, some values 0 or at the limit. With `equal` limits
    /// for acceleration and deceleration.
    pub(super) fn new(random: &mut Random, equal: bool) -> Self {
        let velocity = random.decades(-1.0, 1.5);
        let acceleration = random.decades(-1.0, 1.5);
        let deceleration = if equal { acceleration } else { random.decades(-1.0, 1.5) };
        let jerk = random.decades(-1.0, 2.5);
        let limits = AxisLimits { velocity, acceleration, deceleration, jerk };
        let mut part = |zero: f64| {
            let value = random.signed();
            if random.once_in(zero) {
                0.0
            } else if random.once_in(10.0) {
                value.signum()
            } else {
                value
            }
        };
        let rate = acceleration.min(deceleration);
        let from = State {
            position: 10.0 * part(4.0),
            velocity: velocity * part(4.0),
            acceleration: rate * part(4.0),
        };
        let end_velocity = velocity * part(2.0);
        let far = random.decades(-2.0, 2.0) * random.signed().signum();
        let target = if random.once_in(20.0) { from.position } else { from.position + far };
        Self { from, target, end_velocity, limits }
    }

    /// True if the velocity limit can be kept from the start on.
    pub(super) fn keeps_velocity(&self) -> bool {
        let State { velocity, acceleration, .. } = self.from;
        let settled = velocity + 0.5 * acceleration * acceleration.abs() / self.limits.jerk;
        settled.abs() <= self.limits.velocity
    }
}
