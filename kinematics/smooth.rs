//! Derivatives of a smooth map along a path, up to the third.
//!
//! For y = f(x) with x moving in time,
//!
//! ```text
//!   ẏ = J·ẋ
//!   ÿ = J·ẍ + J̇·ẋ
//!   y⃛ = J·x⃛ + 2·J̇·ẍ + J̈·ẋ
//! ```
//!
//! J̇·ẋ is a quadratic form B(ẋ, ẋ) of the velocities (the second derivative of f), and 2·J̇·ẍ + J̈·ẋ is 3·B(ẋ, ẍ) +
//! C(ẋ, ẋ, ẋ). A solver of J·ẋ = ẏ inverts the map order by order. A serial mechanism is a map from its axes to the
//! tool, a parallel one a map from the tool to its axes: one trait serves both.

use nalgebra::{SMatrix, SVector};

/// One value for each of N axes or N tool coordinates.
pub type Values<const N: usize> = SVector<f64, N>;

/// A map with N inputs and N outputs, at one point.
pub trait SmoothMap<const N: usize> {
    /// True if the map has no derivatives at this point.
    #[inline]
    fn is_singular(&self) -> bool {
        false
    }

    /// J·v.
    fn rate(&self, v: &Values<N>) -> Values<N>;

    /// The v for which J·v = `rate`; `None` where there is none, or no single one.
    fn solve(&self, rate: &Values<N>) -> Option<Values<N>>;

    /// J̇·v, where the inputs move with the velocity v.
    fn second(&self, v: &Values<N>) -> Values<N>;

    /// 2·J̇·a + J̈·v, where the inputs move with the velocity v and the acceleration a.
    fn third(&self, v: &Values<N>, a: &Values<N>) -> Values<N>;

    /// J·v and J·a + J̇·v: velocity and acceleration of the outputs.
    #[inline]
    fn along(&self, v: &Values<N>, a: &Values<N>) -> [Values<N>; 2] {
        [self.rate(v), self.rate(a) + self.second(v)]
    }

    /// J·v, J·a + J̇·v and J·j + 2·J̇·a + J̈·v: the jerk of the outputs, too.
    #[inline]
    fn along_jerk(&self, [v, a, j]: &[Values<N>; 3]) -> [Values<N>; 3] {
        let [velocity, acceleration] = self.along(v, a);
        [velocity, acceleration, self.rate(j) + self.third(v, a)]
    }

    /// J.
    fn matrix(&self) -> SMatrix<f64, N, N> {
        SMatrix::from_columns(&unit_vectors().map(|unit| self.rate(&unit)))
    }
}

fn unit_vectors<const N: usize>() -> [Values<N>; N] {
    std::array::from_fn(|index| SVector::from_fn(|row, _| if row == index { 1.0 } else { 0.0 }))
}
