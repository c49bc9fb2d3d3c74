//! Two-arm chain in a plane: the common part of SCARAs with two and with three arms.
//!
//! # Derivation
//!
//! With r² = x² + y², the law of cosines gives c = cos β = (r² − L1² − L2²) / (2·L1·L2), the manual's formula. An arc
//! cosine loses half the digits where the arms are nearly stretched or folded, so the code uses the two factors of
//! (2·L1·L2·sin β)² = ((L1 + L2)² − r²)·(r² − (L1 − L2)²) instead; they are also the test of reach:
//!
//! ```text
//!   o = (L1 + L2)² − r²,  i = r² − (L1 − L2)²,  k = ±√(o·i) = 2·L1·L2·sin β
//!   β = atan2(k, (i − o)/2)
//!   α = atan2(y, x) − atan2(L2·sin β, L1 + L2·cos β)
//!     = atan2(y·m − x·k, x·m + y·k)   with m = r² + L1² − L2² = 2·L1·(L1 + L2·cos β)
//! ```
//!
//! With the arms as vectors U = L1·(cos α, sin α) and W = L2·(cos(α+β), sin(α+β)), E the turn by 90°, ν = α̇ and ω = α̇ + β̇ the
//! rates at which they turn, p = U + W:
//!
//! ```text
//!   ṗ = ν·E·U + ω·E·W
//!   p̈ = ν̇·E·U + ω̇·E·W − ν²·U − ω²·W
//!   p⃛ = ν̈·E·U + ω̈·E·W − 3·ν·ν̇·U − 3·ω·ω̇·W − ν³·E·U − ω³·E·W
//!   ν = ṗ·W/(U×W),  ω = −ṗ·U/(U×W),  U×W = L1·L2·sin β
//! ```

use crate::disc::{Square, first_root};
use nalgebra::Vector2;
use std::f64::consts::SQRT_2;
use wide::f64x2;

/// Distance from an edge of the reach that counts as rounding, in parts of L1 + L2: four units in the last place.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Lengths of two arms, the way the second bends, and what follows from them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TwoArms {
    pub(super) first: f64,
    pub(super) second: f64,
    /// 1 for β ≥ 0, −1 for β ≤ 0.
    sign: f64,
    /// (L1 + L2)².
    outer_squared: f64,
    /// (L1 − L2)².
    inner_squared: f64,
    /// L1² − L2².
    difference: f64,
    /// What counts as rounding in the squares of the outer and the inner distance.
    rounding: [f64; 2],
}

/// Part of what is left to an edge of the reach that a disc takes.
const DISC: f64 = 0.6;
/// Part of the distance from the first axis that it takes, so that the direction to the wrist stays analytic.
const AROUND: f64 = 0.35;

impl TwoArms {
    /// A disc of the parameter up to `most` on which α and β are analytic, and how far they change within it, where the
    /// end of the second arm has the distance `wrist` from the axis of the first.
    ///
    /// With w = r², dβ/dw = −1/√(o·i), and α is the direction to the wrist less an angle with the derivative
    /// ½ + (L2² − L1²)/2w by β.
    pub(super) fn disc(&self, wrist: &Square, most: f64) -> (f64, [f64; 2]) {
        if wrist.rate == 0.0 && wrist.bend == 0.0 {
            // It stays where it is, and so do the arms, at an edge of the reach as well.
            return (most, [0.0; 2]);
        }
        let w = wrist.size * wrist.size;
        let (outer, inner) = (self.outer_squared - w, w - self.inner_squared);
        let room = DISC * outer.min(inner).min(w);
        let around = first_root(wrist.rate, 0.5 * wrist.bend, AROUND * wrist.size);
        let radius = wrist.radius(room, most.min(around));
        let change = wrist.change(radius);
        let beta = change / ((outer - change) * (inner - change)).sqrt();
        let arm = 0.5 + self.difference.abs() / (2.0 * (w - change));
        let alpha = 2.0 * SQRT_2 * wrist.way(radius) / wrist.size + arm * beta;
        (radius, [alpha, beta])
    }
}

/// The arms at one target, within reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bent {
    x: f64,
    y: f64,
    r_squared: f64,
    m: f64,
    k: f64,
    /// 2·L1·L2·cos β.
    cosine: f64,
    at_edge: bool,
}

impl TwoArms {
    pub(super) fn new(first: f64, second: f64, sign: f64) -> Self {
        let (sum, gap) = (first + second, first - second);
        let tolerance = ROUNDING * sum;
        let square_tolerance = |edge: f64| (2.0 * edge + tolerance) * tolerance;
        Self {
            first,
            second,
            sign,
            outer_squared: sum * sum,
            inner_squared: gap * gap,
            difference: sum * gap,
            rounding: [square_tolerance(sum), square_tolerance(gap.abs())],
        }
    }

    /// Smallest and largest distance of the end of the second arm from the axis of the first.
    pub(super) fn reach(&self) -> [f64; 2] {
        [(self.first - self.second).abs(), self.first + self.second]
    }

    /// Distance of a point at the radius `r` from the nearer edge of the reach; negative outside.
    pub(super) fn margin(&self, r: f64) -> f64 {
        let [inner, outer] = self.reach();
        // An inner edge that is a point cannot be left inwards, but the arms are folded there all the same.
        (outer - r).min(r - inner)
    }

    /// The arms with the end of the second at (x, y); `None` out of reach, also for what is not a number.
    #[inline]
    pub(super) fn bend(&self, x: f64, y: f64) -> Option<Bent> {
        let r_squared = x * x + y * y;
        let outer = self.outer_squared - r_squared;
        let inner = r_squared - self.inner_squared;
        // Written so that NaN is out of reach, too.
        if !(outer >= -self.rounding[0] && inner >= -self.rounding[1]) {
            return None;
        }
        let k = self.sign * (outer.max(0.0) * inner.max(0.0)).sqrt();
        Some(Bent {
            x,
            y,
            r_squared,
            m: r_squared + self.difference,
            k,
            cosine: 0.5 * (inner - outer),
            at_edge: outer <= self.rounding[0] || inner <= self.rounding[1],
        })
    }
}

impl Bent {
    /// α and β, in −π..=π; α is 0 where it is free.
    #[inline]
    pub(super) fn angles(&self) -> [f64; 2] {
        let Self { x, y, m, k, .. } = *self;
        // Both at once, without branches to mispredict. Where one of the angles is free its lane is 0/0.
        let opposite = f64x2::from([y * m - x * k, k]);
        let adjacent = f64x2::from([x * m + y * k, self.cosine]);
        let [alpha, beta] = opposite.atan2(adjacent).to_array();
        [if self.alpha_is_free() { 0.0 } else { alpha }, beta]
    }

    /// The end of the second arm is on the axis of the first.
    #[inline]
    pub(super) fn alpha_is_free(&self) -> bool {
        self.r_squared <= 0.0
    }

    /// The arms as vectors, without trigonometry.
    #[inline]
    pub(super) fn vectors(&self) -> Pair {
        let Self { x, y, m, k, .. } = *self;
        let half = 0.5 / self.r_squared;
        let u = Vector2::new((x * m + y * k) * half, (y * m - x * k) * half);
        Pair { u, w: Vector2::new(x, y) - u, cross: (!self.at_edge).then_some(0.5 * k) }
    }
}

/// Two arms as vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) u: Vector2<f64>,
    pub(super) w: Vector2<f64>,
    /// U×W; `None` at an edge of the reach.
    cross: Option<f64>,
}

/// `v` turned by 90°.
#[inline]
pub(super) fn turned(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

impl Pair {
    /// The arms with the first at `alpha` and the second bent by `beta`.
    #[inline]
    pub(super) fn at(arms: &TwoArms, alpha: f64, beta: f64) -> Self {
        let (first_sin, first_cos) = alpha.sin_cos();
        let (sin, cos) = (alpha + beta).sin_cos();
        let cross = arms.first * arms.second * beta.sin();
        // Angles that are rounded are never quite at an edge, so only exact zeros are one.
        Self {
            u: Vector2::new(first_cos, first_sin) * arms.first,
            w: Vector2::new(cos, sin) * arms.second,
            cross: (cross != 0.0).then_some(cross),
        }
    }

    /// The end of the second arm.
    #[inline]
    pub(super) fn end(&self) -> Vector2<f64> {
        self.u + self.w
    }

    /// Velocity of the end for the rates ν and ω.
    #[inline]
    pub(super) fn rate(&self, nu: f64, omega: f64) -> Vector2<f64> {
        turned(self.u * nu + self.w * omega)
    }

    /// ν and ω for a velocity of the end.
    #[inline]
    pub(super) fn solve(&self, rate: &Vector2<f64>) -> Option<[f64; 2]> {
        if *rate == Vector2::zeros() {
            return Some([0.0; 2]);
        }
        let scale = 1.0 / self.cross?;
        let rates = [rate.dot(&self.w) * scale, -rate.dot(&self.u) * scale];
        rates.iter().all(|rate| rate.is_finite()).then_some(rates)
    }

    /// Part of the end's acceleration that the rates ν and ω alone cause.
    #[inline]
    pub(super) fn second(&self, nu: f64, omega: f64) -> Vector2<f64> {
        self.u * (-nu * nu) + self.w * (-omega * omega)
    }

    /// Part of the end's jerk that the rates and their first derivatives alone cause.
    #[inline]
    pub(super) fn third(&self, [nu, omega]: [f64; 2], change: [f64; 2]) -> Vector2<f64> {
        self.u * (-3.0 * nu * change[0])
            + self.w * (-3.0 * omega * change[1])
            + turned(self.u * (-nu * nu * nu) + self.w * (-omega * omega * omega))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn bent([x, y]: [f64; 2], k: f64, cosine: f64) -> Bent {
        // m = 1 and no k in α's terms: α is the direction of (x, y).
        Bent { x, y, r_squared: x * x + y * y, m: 1.0, k, cosine, at_edge: false }
    }

    #[test]
    fn folded_arms_keep_the_side_of_their_zero() {
        let angles = |k: f64| bent([1.0, 0.0], k, -1.0).angles();
        assert!((angles(0.0)[1] - PI).abs() < 1e-15);
        assert!((angles(-0.0)[1] + PI).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn angles_are_those_of_the_standard_library(
            x in -2.0..2.0_f64, y in -2.0..2.0_f64, k in -2.0..2.0_f64, cosine in -2.0..2.0_f64,
            scale in -12..12_i32,
        ) {
            let scale = 10f64.powi(scale);
            let [alpha, _] = bent([x, y * scale], 0.0, 1.0).angles();
            let [_, beta] = bent([1.0, 0.0], k, cosine * scale).angles();
            prop_assert!((alpha - (y * scale).atan2(x)).abs() <= 1e-15);
            prop_assert!((beta - k.atan2(cosine * scale)).abs() <= 1e-15);
        }
    }
}
