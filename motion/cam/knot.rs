//! Points (knots) of a cam and the polynomials between them.

use super::polynomial::Coefficients;

/// Largest magnitude of a cam's masters, slaves and derivatives: with the largest scalings and velocities of a master all that
/// follows from them is finite.
pub(crate) const MOST: f64 = 1e80;

/// A point of a polynomial cam (`SMC_CAMXYVA`, manual 4.7): where the slave is, and how it moves there.
///
/// Velocity and acceleration are derivatives by the master's position: those of the slave in time when the master moves
/// by one unit a second.
#[doc(alias = "SMC_CAMXYVA")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Knot {
    /// Master position (`dX`), u.
    pub master: f64,
    /// Slave position (`dY`), u.
    pub slave: f64,
    /// First derivative (`dV`).
    pub velocity: f64,
    /// Second derivative (`dA`), 1/u.
    pub acceleration: f64,
}

impl Knot {
    /// A point with a horizontal tangent, as the editor inserts them (manual 4.4.3).
    pub const fn at_rest(master: f64, slave: f64) -> Self {
        Self { master, slave, velocity: 0.0, acceleration: 0.0 }
    }

    /// True if no value is larger than `most`.
    pub(crate) fn is_within(&self, most: f64) -> bool {
        [self.master, self.slave, self.velocity, self.acceleration].iter().all(|v| v.abs() <= most)
    }
}

/// Coefficients of the polynomial of degree 5 from `from` to `to`, in ascending powers of the share of the way between
/// both masters, 0 to 1 (manual 4.2). With the velocities of its chord and no acceleration it is a straight line.
pub fn quintic(from: &Knot, to: &Knot) -> [f64; 6] {
    let h = to.master - from.master;
    let (v0, v1) = (from.velocity * h, to.velocity * h);
    let (a0, a1) = (from.acceleration * h * h, to.acceleration * h * h);
    let rest = to.slave - from.slave - v0 - a0 / 2.0;
    let p = v1 - v0 - a0;
    let r = a1 - a0;
    [
        from.slave,
        v0,
        a0 / 2.0,
        10.0 * rest - 4.0 * p + r / 2.0,
        -15.0 * rest + 7.0 * p - r,
        6.0 * rest - 3.0 * p + r / 2.0,
    ]
}

/// Slave position and its derivatives by the master's position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivatives {
    /// Position y, u.
    pub position: f64,
    /// y′.
    pub velocity: f64,
    /// y″, 1/u.
    pub acceleration: f64,
    /// y‴, 1/u².
    pub jerk: f64,
}

/// A polynomial on a stretch of the master; one line of cache.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(crate) struct Piece {
    /// Its begin, master.
    pub(crate) start: f64,
    /// Its width, master.
    pub(crate) width: f64,
    /// Coefficients in ascending powers of the distance from the start.
    pub(crate) c: [f64; 6],
}

impl Piece {
    /// From coefficients by the share of the way.
    pub(crate) fn new(start: f64, width: f64, shares: [f64; 6]) -> Self {
        let mut power = 1.0;
        let c = shares.map(|share| {
            let scaled = share / power;
            power *= width;
            scaled
        });
        Self { start, width, c }
    }

    pub(crate) fn between(from: &Knot, to: &Knot) -> Self {
        Self::new(from.master, to.master - from.master, quintic(from, to))
    }

    /// The cubic that has values and tangents of both points.
    pub(crate) fn cubic(from: &Knot, to: &Knot) -> Self {
        let h = to.master - from.master;
        let (v0, v1) = (from.velocity * h, to.velocity * h);
        let rise = to.slave - from.slave;
        let shares = [from.slave, v0, 3.0 * rise - 2.0 * v0 - v1, v0 + v1 - 2.0 * rise, 0.0, 0.0];
        Self::new(from.master, h, shares)
    }

    /// The straight line.
    pub(crate) fn linear(from: &Knot, to: &Knot) -> Self {
        let shares = [from.slave, to.slave - from.slave, 0.0, 0.0, 0.0, 0.0];
        Self::new(from.master, to.master - from.master, shares)
    }

    /// Everything at the distance `u` from the start.
    #[inline]
    pub(crate) fn at(&self, u: f64) -> Derivatives {
        let [c0, c1, c2, c3, c4, c5] = self.c;
        // Sums of even and odd powers do not wait for each other.
        let u2 = u * u;
        let position = (c0 + u2 * (c2 + u2 * c4)) + u * (c1 + u2 * (c3 + u2 * c5));
        let velocity = (c1 + u2 * (3.0 * c3 + u2 * (5.0 * c5))) + u * (2.0 * c2 + u2 * (4.0 * c4));
        let acceleration = (2.0 * c2 + u2 * (12.0 * c4)) + u * (6.0 * c3 + u2 * (20.0 * c5));
        let jerk = (6.0 * c3 + u2 * (60.0 * c5)) + u * (24.0 * c4);
        Derivatives { position, velocity, acceleration, jerk }
    }

    /// True if neither it nor its derivatives can be larger than `most`.
    pub(crate) fn is_within(&self, most: f64) -> bool {
        let largest = |coefficients: &Coefficients| {
            coefficients.iter().rev().fold(0.0, |sum: f64, c| sum * self.width + c.abs())
        };
        self.width > 0.0 && self.polynomials().iter().all(|one| largest(one) <= most)
    }

    pub(crate) fn begin(&self) -> Derivatives {
        self.at(0.0)
    }

    pub(crate) fn end(&self) -> Derivatives {
        self.at(self.width)
    }

    /// The polynomial itself, and its first three derivatives.
    pub(crate) fn polynomials(&self) -> [Coefficients; 4] {
        let [c0, c1, c2, c3, c4, c5] = self.c;
        [
            [c0, c1, c2, c3, c4, c5, 0.0],
            [c1, 2.0 * c2, 3.0 * c3, 4.0 * c4, 5.0 * c5, 0.0, 0.0],
            [2.0 * c2, 6.0 * c3, 12.0 * c4, 20.0 * c5, 0.0, 0.0, 0.0],
            [6.0 * c3, 24.0 * c4, 60.0 * c5, 0.0, 0.0, 0.0, 0.0],
        ]
    }
}
