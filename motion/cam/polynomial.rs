//! Real roots and extremes of polynomials of low degree on an interval from 0.
//!
//! A polynomial is monotone between the roots of its derivative, so the roots of the last derivative but one (a line)
//! part the interval for the one before it, and so on up to the polynomial itself. Nothing is sampled and nothing is
//! divided by a leading coefficient, which may be 0: a root is a change of sign on an interval that can hold only one.

/// Most coefficients of a polynomial here: degree 6.
pub(crate) const MOST: usize = 7;

/// Coefficients in ascending powers.
pub(crate) type Coefficients = [f64; MOST];

/// The roots found, in ascending order.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Roots {
    values: [f64; MOST],
    count: usize,
}

impl Roots {
    fn push(&mut self, value: f64) {
        if let Some(slot) = self.values.get_mut(self.count) {
            *slot = value;
            self.count += 1;
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().copied().take(self.count)
    }
}

/// The value at `u`.
pub(crate) fn value(c: &Coefficients, u: f64) -> f64 {
    // Not fused: where the processor is not known to have it, a fused step is a call that costs as much as ten.
    c.iter().rev().fold(0.0, |sum, c| sum * u + c)
}

/// The derivative.
pub(crate) fn derivative(c: &Coefficients) -> Coefficients {
    let mut result = [0.0; MOST];
    let mut power = 0.0;
    for (slot, c) in result.iter_mut().zip(c.iter().skip(1)) {
        power += 1.0;
        *slot = power * c;
    }
    result
}

/// The polynomial counted from `by` on: its value at u is that of `c` at u + `by`.
pub(crate) fn shifted(c: &Coefficients, by: f64) -> Coefficients {
    let mut result = *c;
    // Horner's scheme again and again: each round leaves one coefficient of the new polynomial behind.
    for done in 0..MOST {
        let mut carried = 0.0;
        for slot in result.iter_mut().skip(done).rev() {
            *slot += by * carried;
            carried = *slot;
        }
    }
    result
}

/// The roots within [0, `width`] at which the sign changes, and ends that are roots.
pub(crate) fn roots(c: &Coefficients, width: f64) -> Roots {
    let degree = c.iter().rposition(|c| *c != 0.0).unwrap_or(0);
    let mut chain = [*c; MOST];
    let mut last = *c;
    for slot in chain.iter_mut().take(degree).skip(1) {
        last = derivative(&last);
        *slot = last;
    }
    let mut found = Roots::default();
    // The last of the chain is a line.
    for c in chain.iter().take(degree).rev() {
        found = between(c, &found, width);
    }
    found
}

/// The roots of `c`, whose derivative has the roots `turns`.
fn between(c: &Coefficients, turns: &Roots, width: f64) -> Roots {
    let mut found = Roots::default();
    let (mut low, mut at_low) = (0.0, value(c, 0.0));
    if at_low == 0.0 {
        found.push(0.0);
    }
    for high in turns.iter().chain([width]) {
        let at_high = value(c, high);
        if high > low {
            if at_low * at_high < 0.0 || (at_low != 0.0 && at_high == 0.0) {
                found.push(bracketed(c, low, high, at_low < 0.0));
            }
            (low, at_low) = (high, at_high);
        }
    }
    found
}

/// The root between `low` and `high`, where the polynomial is monotone: Newton's steps, halved where they leave it.
fn bracketed(c: &Coefficients, mut low: f64, mut high: f64, rises: bool) -> f64 {
    let slope = derivative(c);
    let mut u = f64::midpoint(low, high);
    // Bisection alone needs 53 halvings and those of the exponent; with Newton's steps it is five to ten.
    for _ in 0..200 {
        let at = value(c, u);
        if at == 0.0 {
            return u;
        }
        if (at < 0.0) == rises {
            low = u;
        } else {
            high = u;
        }
        let newton = u - at / value(&slope, u);
        let next = if newton > low && newton < high { newton } else { f64::midpoint(low, high) };
        if (next - u).abs() <= f64::EPSILON * u || high - low <= f64::EPSILON * high {
            return next;
        }
        u = next;
    }
    u
}

/// Least and greatest value, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extremes {
    pub(crate) min: f64,
    pub(crate) at_min: f64,
    pub(crate) max: f64,
    pub(crate) at_max: f64,
}

impl Extremes {
    /// Of nothing.
    pub(crate) const NONE: Self =
        Self { min: f64::INFINITY, at_min: 0.0, max: f64::NEG_INFINITY, at_max: 0.0 };

    /// With one more value.
    pub(crate) fn include(&mut self, at: f64, value: f64) {
        if value < self.min {
            (self.min, self.at_min) = (value, at);
        }
        if value > self.max {
            (self.max, self.at_max) = (value, at);
        }
    }

    /// With those of another stretch, which begins at `shift`.
    pub(crate) fn join(&mut self, other: &Self, shift: f64) {
        self.include(other.at_min + shift, other.min);
        self.include(other.at_max + shift, other.max);
    }
}

/// Extremes on [0, `width`].
pub(crate) fn extremes(c: &Coefficients, width: f64) -> Extremes {
    let mut found = Extremes::NONE;
    for u in [0.0, width].into_iter().chain(roots(&derivative(c), width).iter()) {
        found.include(u, value(c, u));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{Coefficients, extremes, roots, shifted, value};
    use proptest::prelude::*;

    /// The polynomial with these roots.
    fn with_roots(list: &[f64]) -> Coefficients {
        let mut c = [0.0; 7];
        c[0] = 1.0;
        for (degree, root) in list.iter().enumerate() {
            for power in (0..=degree + 1).rev() {
                let below = if power == 0 { 0.0 } else { c[power - 1] };
                c[power] = below - root * c[power];
            }
        }
        c
    }

    #[test]
    fn known_roots() {
        for list in [
            &[0.5][..],
            &[0.0, 1.0],
            &[0.1, 0.2, 0.3],
            &[0.125, 0.25, 0.5, 0.75],
            &[-1.0, 0.25, 0.5, 0.625, 3.0],
            &[0.1, 0.2, 0.4, 0.6, 0.8, 0.9],
        ] {
            let found: Vec<_> = roots(&with_roots(list), 1.0).iter().collect();
            let inside: Vec<_> = list.iter().copied().filter(|r| (0.0..=1.0).contains(r)).collect();
            assert_eq!(found.len(), inside.len(), "{list:?}: {found:?}");
            for (found, root) in found.iter().zip(&inside) {
                assert!((found - root).abs() < 1e-12, "{list:?}: {found}");
            }
        }
    }

    #[test]
    fn nothing_to_find() {
        assert_eq!(roots(&[1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], 1.0).iter().count(), 0);
        assert_eq!(roots(&[2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0).iter().count(), 0);
    }

    #[test]
    fn extremes_of_a_parabola() {
        // u − u² on [0, 2]: 1/4 at 1/2, −2 at 2.
        let found = extremes(&[0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0], 2.0);
        assert!((found.max - 0.25).abs() < 1e-15 && (found.at_max - 0.5).abs() < 1e-15);
        assert!((found.min + 2.0).abs() < 1e-15 && (found.at_min - 2.0).abs() < 1e-15);
    }

    proptest! {
        /// The same values from elsewhere.
        #[test]
        fn shifts(c in prop::array::uniform7(-10.0..10.0_f64), by in -2.0..2.0_f64, u in -2.0..2.0_f64) {
            let size = c.iter().rev().fold(0.0, |sum, c| sum * 4.0 + c.abs());
            prop_assert!((value(&shifted(&c, by), u) - value(&c, by + u)).abs() < 1e-13 * size);
        }

        /// No sample lies outside the extremes, and each of them is a value of the polynomial.
        #[test]
        fn extremes_hold(c in prop::array::uniform7(-10.0..10.0_f64), width in 1e-3..10.0_f64) {
            let found = extremes(&c, width);
            let size = c.iter().rev().fold(0.0, |sum, c| sum * width + c.abs());
            for index in 0..=500 {
                let at = value(&c, width * f64::from(index) / 500.0);
                prop_assert!(at <= found.max + 1e-13 * size && at >= found.min - 1e-13 * size);
            }
            prop_assert_eq!(value(&c, found.at_max).to_bits(), found.max.to_bits());
            prop_assert_eq!(value(&c, found.at_min).to_bits(), found.min.to_bits());
        }
    }
}
