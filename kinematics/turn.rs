//! Whole turns of rotary axes: nearest turn and folding into a period.

/// `value` plus the whole periods (2π for angles in rad) that bring it closest to `near`: the answer is within half a
/// period of it.
#[inline]
pub fn nearest_turn(value: f64, near: f64, period: f64) -> f64 {
    value + period * ((near - value) / period).round()
}

/// `value` less the whole periods in it: 0 ≤ answer < `period`. This is how a drive of a modulo axis shows its position
/// (`fPositionPeriod`, SoftMotion manual 2.2).
pub fn fold(value: f64, period: f64) -> f64 {
    let folded = value.rem_euclid(period);
    // The remainder of a tiny negative number rounds up to the period itself.
    if folded < period { folded } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::{fold, nearest_turn};

    #[test]
    fn turns() {
        for (value, near, expected) in [
            (10.0, 350.0, 370.0),
            (350.0, 10.0, -10.0),
            (90.0, 100.0, 90.0),
            (0.0, 725.0, 720.0),
            (-170.0, 175.0, 190.0),
        ] {
            let found = nearest_turn(value, near, 360.0);
            assert!((found - expected).abs() < 1e-12, "{value} near {near}: {found}");
        }
    }

    #[test]
    fn folds_into_the_period() {
        for (value, expected) in [(370.0, 10.0), (-10.0, 350.0), (360.0, 0.0), (0.0, 0.0)] {
            assert!((fold(value, 360.0) - expected).abs() < 1e-12, "{value}");
        }
        assert!(fold(-1e-20, 360.0) < 360.0);
    }
}
