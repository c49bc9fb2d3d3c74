//! Student's distribution.

/// The value that Student's t of `freedom` degrees exceeds in magnitude in 5 % of all cases; infinite for 0 degrees.
///
/// By the finite series of the distribution for whole degrees of freedom (Abramowitz and Stegun, 26.7.3 and 26.7.4), and
/// beyond a thousand of them by its expansion about the normal distribution (26.7.5).
pub fn student_975(freedom: usize) -> f64 {
    const NORMAL: f64 = 1.959_963_984_540_054;
    if freedom == 0 {
        return f64::INFINITY;
    }
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let n = freedom as f64;
    if freedom > 1000 {
        let z = NORMAL;
        let first = (z.powi(3) + z) / 4.0;
        let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
        return z + first / n + second / (n * n);
    }
    let (mut low, mut high) = (1.0, 13.0);
    for _ in 0..60 {
        let t = f64::midpoint(low, high);
        if within(t, n, freedom) < 0.95 {
            low = t;
        } else {
            high = t;
        }
    }
    f64::midpoint(low, high)
}

/// How likely |t| is less than this.
fn within(t: f64, n: f64, freedom: usize) -> f64 {
    let angle = (t / n.sqrt()).atan();
    let (sin, cos) = angle.sin_cos();
    let odd = !freedom.is_multiple_of(2);
    let (mut term, mut sum) = (if odd { cos } else { 1.0 }, 0.0);
    // Powers of the cosine up to that of freedom − 2, every other one.
    let mut power = if odd { 1.0 } else { 0.0 };
    while power <= n - 2.0 {
        sum += term;
        term *= cos * cos * (power + 1.0) / (power + 2.0);
        power += 2.0;
    }
    if odd { (angle + sin * sum) * std::f64::consts::FRAC_2_PI } else { sin * sum }
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
        // Both formulae meet.
        assert!((student_975(1000) - student_975(1001)).abs() < 1e-5);
    }
}
