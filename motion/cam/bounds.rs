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

    /// The same limits with another one of a quantity.
    pub(super) fn with(mut self, quantity: Quantity, limit: f64) -> Self {
        match quantity {
            Quantity::Velocity => self.velocity = limit,
            Quantity::Acceleration => self.acceleration = limit,
            Quantity::Jerk => self.jerk = limit,
        }
        self
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

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
        }
    }

    /// Factors of y′, y″ and y‴ in this quantity, with both signs of the master's acceleration and jerk.
    pub(super) fn factors(self, master: &MasterMotion) -> Vec<[f64; 3]> {
        let MasterMotion { velocity: v, acceleration, jerk } = *master;
        match self {
            Self::Velocity => vec![[v, 0.0, 0.0]],
            Self::Acceleration => signs(acceleration).map(|a| [a, v * v, 0.0]).collect(),
            Self::Jerk => {
                let both = signs(acceleration).flat_map(|a| signs(jerk).map(move |j| (a, j)));
                both.map(|(a, j)| [j, 3.0 * v * a, v * v * v]).collect()
            }
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
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
        let MasterMotion { velocity, acceleration, jerk } = *master;
        let [velocity, acceleration, jerk] =
            [velocity, acceleration, jerk].map(|value| value * factors.master);
        let master = MasterMotion { velocity, acceleration, jerk };
        for piece in self.pieces() {
            let y = piece.polynomials().map(|c| c.map(|c| c * factors.slave));
            let [position, others @ ..] = &mut found;
            position.join(&extremes(&y[0], piece.width), piece.start);
            for (found, quantity) in others.iter_mut().zip(Quantity::ALL) {
                for factors in quantity.factors(&master) {
                    found.join(&extremes(&weighted(&y, factors), piece.width), piece.start);
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
        let mut found = Peak { value: 0.0, master: self.start() };
        let mut derivatives = Derivatives::default();
        let all = quantity.factors(master);
        for piece in self.pieces() {
            let y = piece.polynomials();
            for factors in &all {
                let extremes = extremes(&weighted(&y, *factors), piece.width);
                for (u, value) in [(extremes.at_min, extremes.min), (extremes.at_max, extremes.max)]
                {
                    if value.abs() > found.value {
                        found = Peak { value: value.abs(), master: piece.start + u };
                        derivatives = piece.at(u);
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

/// A quantity of the slave as a polynomial, of y and its derivatives with the factors of [`Quantity::factors`].
#[expect(clippy::indexing_slicing, reason = "arrays of one length")]
pub(super) fn weighted(y: &[Coefficients; 4], [one, two, three]: [f64; 3]) -> Coefficients {
    let [_, first, second, third] = y;
    std::array::from_fn(|index| third[index] * three + second[index] * two + first[index] * one)
}
