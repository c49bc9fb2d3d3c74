//! What a cam asks of its slave, and how fast its master may move (`SMC_CAMBounds`, manual 5.5).
//!
//! With y(x) the curve and x the master, the slave's velocity is y′·v, its acceleration y″·v² + y′·a and its jerk
//! y‴·v³ + 3·y″·v·a + y′·j. For given v, a and j each is a polynomial on every piece, so its extremes are found exactly.
//! Its largest magnitude over all |v|, |a|, |j| up to given ones is Σ of magnitudes, which is convex and grows with
//! each of them: where it reaches a limit Newton's method, begun above, comes down to without ever passing it.

use super::curve::{Curve, Jump, Range};
use super::knot::Derivatives;
use super::polynomial::{Coefficients, Extremes, extremes};
use crate::short::Short;
use std::fmt;

/// Magnitudes that a master does not exceed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MasterMotion {
    /// Velocity (`dMasterVelMax`), u/s.
    pub velocity: f64,
    /// Acceleration and deceleration (`dMasterAccMax`), u/s².
    pub acceleration: f64,
    /// Jerk, u/s³; counts for the jerk of the slave only.
    pub jerk: f64,
}

impl Default for MasterMotion {
    /// 1 u/s, without acceleration (manual 5.5).
    fn default() -> Self {
        Self { velocity: 1.0, acceleration: 0.0, jerk: 0.0 }
    }
}

/// Factors of master and slave (`dMasterScaling`, `dSlaveScaling`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors {
    /// Of the master's position, before the curve.
    pub master: f64,
    /// Of the slave's, behind it.
    pub slave: f64,
}

impl Default for Factors {
    fn default() -> Self {
        Self { master: 1.0, slave: 1.0 }
    }
}

/// What `SMC_CAMBounds` gives. Places are master positions of the curve, scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// `dMinPos`, `dMaxPos`: the slave's position, u.
    pub position: Range,
    /// `dMinVel`, `dMaxVel`: its velocity with the master at its largest one, u/s.
    pub velocity: Range,
    /// `dMinAccDec`, `dMaxAccDec`: its acceleration with the master at its largest velocity, and its acceleration
    /// anywhere between both signs, u/s².
    pub acceleration: Range,
}

/// Magnitudes a slave must not exceed; infinite where there is no limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlaveLimits {
    /// u/s.
    pub velocity: f64,
    /// u/s².
    pub acceleration: f64,
    /// u/s³.
    pub jerk: f64,
}

impl SlaveLimits {
    /// No limit at all.
    pub const NONE: Self =
        Self { velocity: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY };

    fn of(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Velocity => self.velocity,
            Quantity::Acceleration => self.acceleration,
            Quantity::Jerk => self.jerk,
        }
    }
}

/// What is limited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The slave's velocity.
    Velocity,
    /// Its acceleration.
    Acceleration,
    /// Its jerk.
    Jerk,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Velocity, Self::Acceleration, Self::Jerk];
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
        })
    }
}

/// The largest magnitude of something, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// The magnitude.
    pub value: f64,
    /// Where, master position of the curve, scaled.
    pub master: f64,
}

/// The largest motion a master may make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    /// Velocity, u/s, or acceleration, u/s²; infinite if nothing limits it.
    pub value: f64,
    /// What limits it, and where the master is then; none if nothing does.
    pub limited: Option<(Quantity, f64)>,
}

/// Why no motion of the master is slow enough.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LimitError {
    /// The master's acceleration or jerk alone, or its velocity where the acceleration is asked for, asks for too much.
    #[error("the slave's {quantity} reaches {} at master {}, its limit is {}",
        Short(.peak.value), Short(.peak.master), Short(*.limit))]
    TooMuch {
        /// Of what.
        quantity: Quantity,
        /// How much it is.
        peak: Peak,
        /// What is allowed.
        limit: f64,
    },
    /// The curve jumps, so that what comes out is infinite at any velocity.
    #[error("y{} jumps by {} at master {}: the slave's {quantity} has no bound",
        if matches!(.quantity, Quantity::Velocity) { "" } else if matches!(.quantity, Quantity::Acceleration) { "\u{2032}" } else { "\u{2033}" },
        Short(.jump.by), Short(.jump.master))]
    Unbounded {
        /// What has no bound.
        quantity: Quantity,
        /// The jump of the derivative before.
        jump: Jump,
    },
    /// A limit or a magnitude is negative or not a number.
    #[error("{name} is {value}, which is no magnitude")]
    NoMagnitude {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}

/// Jumps below this part of a derivative's own magnitude are rounding.
const ROUNDING: f64 = 1e-9;

impl Curve {
    /// Extremes of the slave's position, velocity and acceleration when the master moves as fast as `master`
    /// (`SMC_CAMBounds`, manual 5.5); exact.
    ///
    /// Jumps of the derivatives, which tables have, are not among them: see [`Curve::jumps`].
    pub fn bounds(&self, master: &MasterMotion, factors: Factors) -> Bounds {
        let mut found = [Extremes::NONE; 3];
        let v = master.velocity * factors.master;
        let a = master.acceleration * factors.master;
        for piece in self.pieces() {
            let [y, first, second, _] = piece.polynomials().map(|c| c.map(|c| c * factors.slave));
            let [position, velocity, acceleration] = &mut found;
            let join = |into: &mut Extremes, c: &Coefficients| {
                into.join(&extremes(c, piece.width), piece.start);
            };
            join(position, &y);
            join(velocity, &first.map(|c| c * v));
            join(acceleration, &weighted(&second, v * v, &first, a));
            if a != 0.0 {
                join(acceleration, &weighted(&second, v * v, &first, -a));
            }
        }
        let [position, velocity, acceleration] = found.map(Range::from);
        Bounds { position, velocity, acceleration }
    }

    /// The slave's largest velocity, acceleration or jerk in magnitude, whatever the master does up to `master`; exact.
    pub fn peak(&self, quantity: Quantity, master: &MasterMotion, factors: Factors) -> Peak {
        let (peak, _) = self.peak_and_derivatives(quantity, &scaled(master, factors.master));
        Peak { value: peak.value * factors.slave.abs(), ..peak }
    }

    /// The largest velocity of the master with which the slave stays within `limits`, if the master accelerates and
    /// jerks by up to what `master` says; its velocity does not count. With `repeated` the curve is put end to end.
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
    /// by up to what `master` says; its acceleration does not count. With `repeated` the curve is put end to end.
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

    /// Where the peak reaches `limit`; none if it never does.
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
        for _ in 0..400 {
            let here = motion(value);
            let (at, d) = self.peak_and_derivatives(quantity, &here);
            peak = at;
            // By how much the master's motion changes per unit of what is looked for.
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
        // The last digits: what is given keeps the limit.
        for _ in 0..100 {
            if exceeds(value).value <= limit {
                break;
            }
            value *= 1.0 - 2.0 * f64::EPSILON;
        }
        Some(Peak { value, master: peak.master })
    }

    fn refuse_jumps(&self, limits: &SlaveLimits, repeated: bool) -> Result<(), LimitError> {
        let jumps = self.jumps(repeated);
        let extremes = self.extremes();
        let too_large = |jump: &Jump, range: &Range| jump.by.abs() > ROUNDING * range.magnitude();
        let width = self.end() - self.start();
        // A curve that is almost a line has an acceleration of rounding alone.
        let floor = |range: Range, scale: f64| Range { max: range.magnitude().max(scale), ..range };
        let velocity = floor(extremes.velocity, extremes.position.magnitude() / width);
        let acceleration = floor(extremes.acceleration, velocity.magnitude() / width);
        let unbounded = |quantity, jump| Err(LimitError::Unbounded { quantity, jump });
        if limits.velocity.is_finite() && too_large(&jumps.position, &extremes.position) {
            return unbounded(Quantity::Velocity, jumps.position);
        }
        if limits.acceleration.is_finite() && too_large(&jumps.velocity, &velocity) {
            return unbounded(Quantity::Acceleration, jumps.velocity);
        }
        if limits.jerk.is_finite() {
            if too_large(&jumps.velocity, &velocity) {
                return unbounded(Quantity::Acceleration, jumps.velocity);
            }
            if too_large(&jumps.acceleration, &acceleration) {
                return unbounded(Quantity::Jerk, jumps.acceleration);
            }
        }
        Ok(())
    }

    /// The peak, and the derivatives there.
    fn peak_and_derivatives(
        &self,
        quantity: Quantity,
        master: &MasterMotion,
    ) -> (Peak, Derivatives) {
        let MasterMotion { velocity: v, acceleration: a, jerk: j } = *master;
        let mut found = Peak { value: 0.0, master: self.start() };
        let mut derivatives = Derivatives::default();
        for piece in self.pieces() {
            let [_, first, second, third] = piece.polynomials();
            let mut look = |c: &Coefficients| {
                let extremes = extremes(c, piece.width);
                for (u, value) in [(extremes.at_min, extremes.min), (extremes.at_max, extremes.max)]
                {
                    if value.abs() > found.value {
                        found = Peak { value: value.abs(), master: piece.start + u };
                        derivatives = piece.at(u);
                    }
                }
            };
            match quantity {
                Quantity::Velocity => look(&first.map(|c| c * v)),
                Quantity::Acceleration => {
                    for a in signs(a) {
                        look(&weighted(&second, v * v, &first, a));
                    }
                }
                Quantity::Jerk => {
                    for a in signs(a) {
                        let both = weighted(&third, v * v * v, &second, 3.0 * v * a);
                        for j in signs(j) {
                            look(&weighted(&both, 1.0, &first, j));
                        }
                    }
                }
            }
        }
        (found, derivatives)
    }
}

/// How much the peak grows with what is looked for.
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

fn scaled(master: &MasterMotion, factor: f64) -> MasterMotion {
    let factor = factor.abs();
    MasterMotion {
        velocity: master.velocity * factor,
        acceleration: master.acceleration * factor,
        jerk: master.jerk * factor,
    }
}

/// Both signs, or 0 once.
fn signs(value: f64) -> impl Iterator<Item = f64> {
    [value, -value].into_iter().take(if value == 0.0 { 1 } else { 2 })
}

fn weighted(p: &Coefficients, by: f64, q: &Coefficients, with: f64) -> Coefficients {
    let mut sum = *p;
    for (sum, q) in sum.iter_mut().zip(q) {
        *sum = *sum * by + q * with;
    }
    sum
}
