//! How likely a value is by chance: Fisher's distribution, and that of the correlation of noise with itself.

use statrs::function::beta::checked_beta_reg;

/// How likely F of `above` and `below` degrees of freedom exceeds `f` by chance.
pub(super) fn fisher_exceeds(f: f64, above: f64, below: f64) -> f64 {
    if f.is_nan() || f <= 0.0 {
        return 1.0;
    }
    incomplete_beta(below / 2.0, above / 2.0, below / (below + above * f))
}

/// How likely |t| of `freedom` degrees exceeds `t` by chance: its square is F of 1 and `freedom`.
pub fn student_exceeds(t: f64, freedom: f64) -> f64 {
    fisher_exceeds(t * t, 1.0, freedom)
}

/// How likely the correlation of `samples` of white noise from one to the next, Σ e·e′ / Σ e², exceeds `r` in magnitude by
/// chance.
///
/// It is a mean of the eigenvalues cos(k·π/(n + 1)) with random weights (von Neumann), so it lies between ± cos(π/(n + 1)),
/// and its variance is (n − 1)/(n·(n + 2)): taken is the even beta distribution with this reach and variance.
pub(super) fn correlation_exceeds(r: f64, samples: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let n = samples as f64;
    if n < 3.0 {
        return 1.0;
    }
    let reach = (std::f64::consts::PI / (n + 1.0)).cos();
    let variance = (n - 1.0) / (n * (n + 2.0));
    let share = (r / reach).powi(2);
    if share >= 1.0 {
        return 0.0;
    }
    let shape = (reach * reach / variance - 1.0) / 2.0;
    incomplete_beta(shape, 0.5, 1.0 - share)
}

/// The regularized incomplete beta function; 1 where it has no value, as of 0 degrees of freedom: that says nothing.
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    checked_beta_reg(a, b, x).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::student_975;
    use super::{correlation_exceeds, fisher_exceeds, student_exceeds};

    /// From the printed tables of F.
    #[test]
    fn tables_of_fisher() {
        for (above, below, f, chance) in [
            (1.0, 1.0, 161.45, 0.05),
            (2.0, 8.0, 4.459, 0.05),
            (4.0, 20.0, 4.431, 0.01),
            (3.0, 12.0, 5.953, 0.01),
            (4.0, 120.0, 2.447, 0.05),
        ] {
            let found = fisher_exceeds(f, above, below);
            assert!((found / chance - 1.0).abs() < 2e-3, "{above} {below}: {found}");
        }
        // With two above it is closed: (1 + 2·f/n)^(−n/2).
        for (below, f) in [(8.0_f64, 36.0_f64), (5.0, 1.5), (400.0, 12.0), (2.0, 1e6)] {
            let closed = (1.0 + 2.0 * f / below).powf(-below / 2.0);
            let found = fisher_exceeds(f, 2.0, below);
            assert!((found / closed - 1.0).abs() < 1e-10, "{below} {f}: {found} {closed}");
        }
        assert!(fisher_exceeds(0.0, 2.0, 9.0) >= 1.0);
        assert!(fisher_exceeds(f64::INFINITY, 2.0, 9.0) <= 0.0);
    }

    #[test]
    fn student_is_the_same_as_by_its_own_series() {
        for freedom in [1_u32, 2, 7, 30, 400] {
            let count = usize::try_from(freedom).expect("a count");
            let found = student_exceeds(student_975(count), f64::from(freedom));
            assert!((found - 0.05).abs() < 1e-9, "{freedom}: {found}");
        }
    }

    /// Of 200,000 draws of noise as many exceed a correlation as it says, a tenth more or less.
    #[test]
    fn correlations_of_noise() {
        let mut random = super::super::tests::Random(11);
        for (samples, r) in [(6_usize, 0.6), (12, 0.5), (20, 0.45)] {
            let mut beyond = 0_u32;
            for _ in 0..200_000 {
                let (mut square, mut beside, mut before) = (0.0, 0.0, 0.0);
                for _ in 0..samples {
                    let e = random.normal();
                    square += e * e;
                    beside += e * before;
                    before = e;
                }
                beyond += u32::from((beside / square).abs() > r);
            }
            let (found, said) = (f64::from(beyond) / 2e5, correlation_exceeds(r, samples));
            assert!((found / said - 1.0).abs() < 0.1, "{samples}: {found} {said}");
        }
        assert!(correlation_exceeds(1.0, 12) <= 0.0);
    }
}
