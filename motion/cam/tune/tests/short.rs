//! Values of points with few digits.

use super::super::reshape::near;

#[test]
fn values_are_short_decimals_within_their_tolerance() {
    for (old, found, tolerance, decimals, expected) in [
        (70.0, 70.999_999_999_575_89, 1.0, 0, 71.0),
        (70.0, 69.000_000_000_4, 1.0, 5, 69.0),
        (0.0, 0.099_999_999_960_8, 0.1, 0, 0.1),
        (0.1, 0.799_999_999_99, 0.7, 0, 0.8),
        (70.0, 70.000_000_000_4, 1.0, 0, 70.0),
        (70.123, 70.777_777, 1.0, 1, 70.8),
        (70.123, 70.777_777, 1.0, 3, 70.778),
        (70.123, 71.1, 1.0, 0, 71.0),
        // Beyond the tolerance nothing is rounded to.
        (70.9, 71.6, 0.8, 0, 71.6),
        (70.0, 70.96, 0.9, 0, 70.9),
        (0.0, -0.000_4, 0.05, 0, 0.0),
        (1200.0, 1537.0, 500.0, 0, 1500.0),
        (5.0, 7.0, 0.0, 3, 5.0),
    ] {
        let short = near(old, found, tolerance, decimals);
        assert_eq!(short.to_string(), expected.to_string(), "{old} {found} {tolerance}");
    }
}
