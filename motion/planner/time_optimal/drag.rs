//! Bounds with drag: half planes that also depend on u̇, because the drag on an axis grows with u̇, not with u̇².

use super::bound::Row;

/// Where drag is that of a velocity below this part of the largest that it leaves possible, it counts as that.
const LEAST: f64 = 1e-4;

/// The bound a·ü + b·u̇² + `drag`·u̇ ≤ 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DragRow {
    /// a and b.
    pub row: Row,
    /// Coefficient of u̇, at least 0: at the velocity 1/`drag` nothing is left.
    pub drag: f64,
}

impl DragRow {
    /// Used part of the bound at these ü and u̇.
    pub fn part(&self, acceleration: f64, velocity: f64) -> f64 {
        let Self { row: Row { a, b }, drag } = *self;
        a * acceleration + (b * velocity + drag) * velocity
    }

    /// Excess of [`Self::tangent`] at the velocity `reference` over the bound at `velocity`, as a part of the bound.
    pub(super) fn surplus(&self, velocity: f64, reference: f64) -> f64 {
        if self.drag <= 0.0 {
            return 0.0;
        }
        let reference = self.usable(reference);
        0.5 * self.drag * (velocity - reference).powi(2) / reference
    }

    /// The half plane that says the same at the velocity `reference`, and more at every other: u̇ ≤ ½·(r + u̇²/r). A
    /// reference above the largest possible velocity, or none, counts as that, and one next to 0 as a ten thousandth of it.
    pub fn tangent(&self, reference: f64) -> Row {
        let Self { row, drag } = *self;
        if drag <= 0.0 {
            return row;
        }
        let reference = self.usable(reference);
        let left = 1.0 - 0.5 * drag * reference;
        Row { a: row.a / left, b: (row.b + 0.5 * drag / reference) / left }
    }

    fn usable(&self, reference: f64) -> f64 {
        let most = 1.0 / self.drag;
        if reference < most { reference.max(LEAST * most) } else { most }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever the reference, what the tangent allows the bound does; at the reference they allow the same.
        #[test]
        fn tangents_are_safe_everywhere_and_exact_at_one_place(
            coefficients in (-5.0..5.0_f64, -5.0..5.0_f64, 0.0..4.0_f64),
            reference in prop_oneof![0.0..3.0_f64, Just(0.0), Just(f64::INFINITY), Just(f64::NAN)],
            motion in (-3.0..3.0_f64, 0.0..3.0_f64),
        ) {
            let (a, b, drag) = coefficients;
            let row = DragRow { row: Row { a, b }, drag };
            let tangent = row.tangent(reference);
            let of = |acceleration: f64, v: f64| tangent.a * acceleration + tangent.b * v * v;
            let (acceleration, v) = motion;
            prop_assert!(of(acceleration, v) > 1.0 || row.part(acceleration, v) <= 1.0 + 1e-12);
            let most = if drag > 0.0 { 1.0 / drag } else { 3.0 };
            let v = reference.min(most).max(2.0 * LEAST * most);
            let same = (1.0 - of(acceleration, v)) * (1.0 - 0.5 * drag * v);
            prop_assert!(row.surplus(v, v) == 0.0);
            if reference >= v {
                prop_assert!((same - 1.0 + row.part(acceleration, v)).abs() < 1e-9);
            }
            // What is too much is the difference of the two.
            let r = if drag > 0.0 { row.usable(reference) } else { v };
            let of = (1.0 - of(acceleration, motion.1)) * (1.0 - 0.5 * drag * r);
            let surplus = 1.0 - row.part(acceleration, motion.1) - of;
            let expected = row.surplus(motion.1, reference);
            prop_assert!(drag <= 0.0 || (surplus - expected).abs() < 1e-9 * (1.0 + expected), "{surplus} {expected}");
        }
    }
}
