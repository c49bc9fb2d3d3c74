//! Maximum master velocity and acceleration of a cam under the limits of its slave.
//!
//! The largest magnitude of the slave's velocity, acceleration and jerk over all |v|, |a|, |j| of the master up to
//! given ones is a sum of magnitudes, which is convex and grows with each of them. Newton's method, started above,
//! therefore comes down to the point where it reaches a limit without ever passing it.

use super::bounds::{Factors, MasterMotion, Peak, Quantity, SlaveLimits, scaled};
use super::curve::{Curve, Jump};
use super::knot::Derivatives;
use twin_number::Short;

/// The largest motion a master may make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    /// Velocity, u/s, or acceleration, u/s²; infinite if nothing limits it.
    pub value: f64,
    /// Limiting quantity, and the master position; none if nothing limits it.
    pub limited: Option<(Quantity, f64)>,
}

/// Reason why no motion of the master is slow enough.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LimitError {
    /// The master's acceleration or jerk alone, or its velocity where the acceleration is asked for, asks for too much.
    #[error("the slave's {quantity} reaches {} at master {}, its limit is {}",
        Short(.peak.value), Short(.peak.master), Short(*.limit))]
    TooMuch {
        /// Of what.
        quantity: Quantity,
        /// The peak.
        peak: Peak,
        /// The limit.
        limit: f64,
    },
    /// The curve jumps, so that what comes out is infinite at any velocity.
    #[error("y{} jumps by {} at master {}: the slave's {quantity} has no bound",
        if matches!(.quantity, Quantity::Velocity) { "" } else if matches!(.quantity, Quantity::Acceleration) { "\u{2032}" } else { "\u{2033}" },
        Short(.jump.by), Short(.jump.master))]
    Unbounded {
        /// The quantity without a bound.
        quantity: Quantity,
        /// The jump of the derivative before.
        jump: Jump,
    },
    /// A limit or a magnitude is negative or not a number.
    #[error("{name} is {value}, which is not a magnitude")]
    NoMagnitude {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}

/// Jumps below this part of a derivative's own magnitude are rounding.
const ROUNDING: f64 = 1e-9;

impl Curve {
    /// The largest velocity of the master with which the slave stays within `limits`, if the master accelerates and
    /// jerks by up to what `master` says; its velocity does not count. With `repeated` the curve is periodic.
    ///
    /// # Errors
    /// [`LimitError`] if no velocity is small enough, or a magnitude is none.
    pub fn largest_master_velocity(
        &self,
        limits: &SlaveLimits,
        master: &MasterMotion,
        factors: Factors,
        repeated: bool,
    ) -> Result<Largest, LimitError> {
        self.largest(limits, factors, repeated, &|velocity| MasterMotion { velocity, ..*master })
    }

    /// The largest acceleration of the master with which the slave stays within `limits`, if the master moves and jerks
    /// by up to what `master` says; its acceleration does not count. With `repeated` the curve is periodic.
    ///
    /// # Errors
    /// [`LimitError`] if no acceleration is small enough, or a magnitude is none.
    pub fn largest_master_acceleration(
        &self,
        limits: &SlaveLimits,
        master: &MasterMotion,
        factors: Factors,
        repeated: bool,
    ) -> Result<Largest, LimitError> {
        self.largest(limits, factors, repeated, &|acceleration| MasterMotion {
            acceleration,
            ..*master
        })
    }

    fn largest(
        &self,
        limits: &SlaveLimits,
        factors: Factors,
        repeated: bool,
        motion: &dyn Fn(f64) -> MasterMotion,
    ) -> Result<Largest, LimitError> {
        let MasterMotion { velocity, acceleration, jerk } = motion(0.0);
        for (name, value) in [
            ("the limit of velocity", limits.velocity),
            ("the limit of acceleration", limits.acceleration),
            ("the limit of jerk", limits.jerk),
            ("the master's velocity", velocity),
            ("the master's acceleration", acceleration),
            ("the master's jerk", jerk),
        ] {
            if value.is_nan() || value < 0.0 {
                return Err(LimitError::NoMagnitude { name, value });
            }
        }
        self.refuse_jumps(limits, repeated)?;
        let mut least = Largest { value: f64::INFINITY, limited: None };
        for quantity in Quantity::ALL {
            let limit = limits.of(quantity) / factors.slave.abs();
            if !limit.is_finite() {
                continue;
            }
            let at = |value| scaled(&motion(value), factors.master);
            let (lowest, _) = self.peak_and_derivatives(quantity, &at(0.0));
            if lowest.value > limit {
                let peak = Peak { value: lowest.value * factors.slave.abs(), ..lowest };
                return Err(LimitError::TooMuch { quantity, peak, limit: limits.of(quantity) });
            }
            if let Some(found) = self.reach(quantity, limit, &at)
                && found.value < least.value
            {
                least = Largest { value: found.value, limited: Some((quantity, found.master)) };
            }
        }
        Ok(least)
    }

    /// Value at which the peak reaches `limit`; none if it never does.
    fn reach(
        &self,
        quantity: Quantity,
        limit: f64,
        motion: &dyn Fn(f64) -> MasterMotion,
    ) -> Option<Peak> {
        let exceeds = |value: f64| self.peak_and_derivatives(quantity, &motion(value)).0;
        let mut value = 1.0;
        let mut peak = exceeds(value);
        // From above: powers of two, up to where doubles end.
        while peak.value <= limit {
            value *= 2.0;
            if value > 1e100 {
                return None;
            }
            peak = exceeds(value);
        }
        // And at most twice the result: a far larger start loses the result in its rounding.
        while value > 1e-100 && exceeds(value / 2.0).value > limit {
            value /= 2.0;
        }
        for _ in 0..400 {
            let here = motion(value);
            let (at, d) = self.peak_and_derivatives(quantity, &here);
            peak = at;
            // By how much the master's motion changes per unit of the unknown.
            let ahead = motion(value + 1.0);
            let by_velocity = ahead.velocity - here.velocity;
            let by_acceleration = ahead.acceleration - here.acceleration;
            let slope = slope(quantity, &here, &d, by_velocity, by_acceleration);
            let next = value - (peak.value - limit) / slope;
            if next.is_nan() || next >= value {
                break;
            }
            value = next.max(0.0);
        }
        // The last digits: the result keeps the limit.
        for _ in 0..100 {
            if exceeds(value).value <= limit {
                break;
            }
            value *= 1.0 - 2.0 * f64::EPSILON;
        }
        Some(Peak { value, master: peak.master })
    }

    /// Largest jumps of position, velocity and acceleration; jumps by rounding alone do not count. With `repeated` also
    /// from end to begin.
    pub fn real_jumps(&self, repeated: bool) -> [Option<Jump>; 3] {
        let jumps = self.jumps(repeated);
        let [position, velocity, acceleration] = self.jump_sizes();
        [(jumps.position, position), (jumps.velocity, velocity), (jumps.acceleration, acceleration)]
            .map(|(jump, size)| Self::is_jump(jump.by, size).then_some(jump))
    }

    /// Magnitudes of position, y′ and y″, relative to which a jump may be rounding alone.
    pub(super) fn jump_sizes(&self) -> [f64; 3] {
        let extremes = self.extremes();
        let width = self.end() - self.start();
        let position = extremes.position.magnitude();
        // A curve that is almost a line has an acceleration of rounding alone.
        let velocity = extremes.velocity.magnitude().max(position / width);
        [position, velocity, extremes.acceleration.magnitude().max(velocity / width)]
    }

    /// True if a jump is more than rounding.
    pub(super) fn is_jump(by: f64, size: f64) -> bool {
        by.abs() > ROUNDING * size
    }

    /// Jumps at the end of a pass that is not repeated (manual 4.6.1, `Periodic` FALSE): the slave stays where the
    /// curve leads, so its velocity and acceleration end at once. The pass ends at the end of the
    /// range, or, with `backwards`, at its begin. Rounding alone does not count.
    pub fn stop_jumps(&self, backwards: bool) -> [Option<Jump>; 2] {
        let master = if backwards { self.start() } else { self.end() };
        let here = self.at(master);
        let [_, velocity, acceleration] = self.jump_sizes();
        [(here.velocity, velocity), (here.acceleration, acceleration)]
            .map(|(left, size)| Self::is_jump(left, size).then_some(Jump { master, by: -left }))
    }

    pub(super) fn refuse_jumps(
        &self,
        limits: &SlaveLimits,
        repeated: bool,
    ) -> Result<(), LimitError> {
        let [position, velocity, acceleration] = self.real_jumps(repeated);
        // What follows a jump has no bound either.
        for (limit, jumps) in [
            (limits.velocity, &[(Quantity::Velocity, position)][..]),
            (limits.acceleration, &[(Quantity::Acceleration, velocity)]),
            (limits.jerk, &[(Quantity::Acceleration, velocity), (Quantity::Jerk, acceleration)]),
        ] {
            let first = jumps.iter().find_map(|(quantity, jump)| Some((*quantity, (*jump)?)));
            if let Some((quantity, jump)) = first.filter(|_| limit.is_finite()) {
                return Err(LimitError::Unbounded { quantity, jump });
            }
        }
        Ok(())
    }
}

/// Growth of the peak with the unknown.
fn slope(
    quantity: Quantity,
    at: &MasterMotion,
    d: &Derivatives,
    by_velocity: f64,
    by_acceleration: f64,
) -> f64 {
    let [first, second, third] = [d.velocity.abs(), d.acceleration.abs(), d.jerk.abs()];
    let (v, a) = (at.velocity.abs(), at.acceleration.abs());
    let (velocity, acceleration) = match quantity {
        Quantity::Velocity => (first, 0.0),
        Quantity::Acceleration => (2.0 * second * v, first),
        Quantity::Jerk => (3.0 * third * v * v + 3.0 * second * a, 3.0 * second * v),
    };
    velocity * by_velocity.abs() + acceleration * by_acceleration.abs()
}
