//! Bounds of a cam: largest velocity, acceleration and jerk of its slave (`SMC_CAMBounds`, manual 5.5).
//!
//! With y(x) the curve and x the master, the slave's velocity is y′·v, its acceleration y″·v² + y′·a and its jerk
//! y‴·v³ + 3·y″·v·a + y′·j. For given v, a and j each is a polynomial on every piece, so its extremes are found exactly.

use super::curve::{Curve, Range};
use super::knot::Derivatives;
use super::polynomial::{Coefficients, Extremes, extremes};
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

/// Bounds of a cam (`SMC_CAMBounds`). Places are master positions of the curve, scaled.
#[doc(alias = "SMC_CAMBounds")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// `dMinPos`, `dMaxPos`: the slave's position, u.
    pub position: Range,
    /// `dMinVel`, `dMaxVel`: its velocity with the master at its largest one, u/s.
    pub velocity: Range,
    /// `dMinAccDec`, `dMaxAccDec`: its acceleration with the master at its largest velocity, and its acceleration
    /// anywhere between both signs, u/s².
    pub acceleration: Range,
    /// Its jerk with the master at its largest velocity, its acceleration and jerk anywhere between both signs, u/s³. The
    /// block gives none.
    pub jerk: Range,
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

    pub(super) fn of(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Velocity => self.velocity,
            Quantity::Acceleration => self.acceleration,
            Quantity::Jerk => self.jerk,
        }
    }
}

/// Limited quantity.
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
    /// Its master position on the curve, scaled.
    pub master: f64,
}

impl Curve {
    /// Extremes of the slave's position, velocity, acceleration and jerk when the master moves as fast as `master`
    /// (`SMC_CAMBounds`, manual 5.5); exact. Acceleration and jerk of the slave are linear in those of the master, so their
    /// extremes are where these have one sign or the other.
    ///
    /// Jumps of the derivatives, which tables have, are not among them: see [`Curve::jumps`].
    pub fn bounds(&self, master: &MasterMotion, factors: Factors) -> Bounds {
        let mut found = [Extremes::NONE; 4];
        let v = master.velocity * factors.master;
        let a = master.acceleration * factors.master;
        let j = master.jerk * factors.master;
        for piece in self.pieces() {
            let [y, first, second, third] =
                piece.polynomials().map(|c| c.map(|c| c * factors.slave));
            let [position, velocity, acceleration, jerk] = &mut found;
            let join = |into: &mut Extremes, c: &Coefficients| {
                into.join(&extremes(c, piece.width), piece.start);
            };
            join(position, &y);
            join(velocity, &first.map(|c| c * v));
            for a in signs(a) {
                join(acceleration, &weighted(&second, v * v, &first, a));
                let both = weighted(&third, v * v * v, &second, 3.0 * v * a);
                for j in signs(j) {
                    join(jerk, &weighted(&both, 1.0, &first, j));
                }
            }
        }
        let [position, velocity, acceleration, jerk] = found.map(Range::from);
        Bounds { position, velocity, acceleration, jerk }
    }

    /// The slave's largest velocity, acceleration or jerk in magnitude, whatever the master does up to `master`; exact.
    pub fn peak(&self, quantity: Quantity, master: &MasterMotion, factors: Factors) -> Peak {
        let (peak, _) = self.peak_and_derivatives(quantity, &scaled(master, factors.master));
        Peak { value: peak.value * factors.slave.abs(), ..peak }
    }

    /// The peak, and the derivatives there.
    pub(super) fn peak_and_derivatives(
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

pub(super) fn scaled(master: &MasterMotion, factor: f64) -> MasterMotion {
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
