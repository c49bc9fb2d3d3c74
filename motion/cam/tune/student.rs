//! Student's distribution.

use super::chance::student_exceeds;

/// The value that Student's t of `freedom` degrees exceeds in magnitude in 5 % of all cases; infinite for 0 degrees.
pub fn student_975(freedom: usize) -> f64 {
    if freedom == 0 {
        return f64::INFINITY;
    }
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let freedom = freedom as f64;
    // From beyond what the normal distribution has to beyond what one degree has.
    let (mut low, mut high) = (1.0, 13.0);
    for _ in 0..60 {
        let t = f64::midpoint(low, high);
        if student_exceeds(t, freedom) > 0.05 {
            low = t;
        } else {
            high = t;
        }
    }
    f64::midpoint(low, high)
}

#[cfg(test)]
mod tests {
    use super::student_975;

    /// From the printed tables.
    #[test]
    fn tables() {
        for (freedom, value) in [
            (1, 12.706),
            (2, 4.303),
            (3, 3.182),
            (4, 2.776),
            (5, 2.571),
            (10, 2.228),
            (11, 2.201),
            (30, 2.042),
            (60, 2.000),
            (120, 1.980),
            (100_000, 1.960),
        ] {
            assert!(
                (student_975(freedom) - value).abs() < 6e-4,
                "{freedom}: {}",
                student_975(freedom)
            );
        }
        assert!(student_975(0).is_infinite());
        // Infinitely many have the normal distribution's.
        assert!((student_975(100_000_000) - 1.959_964).abs() < 1e-6);
    }
}
