//! Tail probabilities of Student's t, Fisher's F and the lag-1 correlation of white noise.

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::beta::checked_beta_reg;

/// Degrees of freedom from which Student's t is expanded about the normal distribution.
const MANY: f64 = 1000.0;

/// Probability that F of `above` and `below` degrees of freedom exceeds `f`.
pub(super) fn fisher_exceeds(f: f64, above: f64, below: f64) -> f64 {
    incomplete_beta(below / 2.0, above / 2.0, below / (below + above * f))
}

/// Probability that |t| of `freedom` degrees of freedom exceeds `t`.
pub fn student_exceeds(t: f64, freedom: f64) -> f64 {
    fisher_exceeds(t * t, 1.0, freedom)
}

/// The value that |t| of `freedom` degrees of freedom exceeds in 5 % of all cases; infinite for 0 degrees.
///
/// From 1,000 degrees on by the first term of its expansion about the normal distribution (Abramowitz and Stegun 26.7.5), whose
/// rest is below 3e-6: the continued fraction of `statrs` takes minutes for 1e8 degrees.
pub fn student_975(freedom: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let n = freedom as f64;
    if n < MANY {
        return StudentsT::new(0.0, 1.0, n).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975));
    }
    let z = 1.959_963_984_540_054_f64;
    z + (z.powi(3) + z) / (4.0 * n)
}

/// Probability that the lag-1 correlation of `samples` values of white noise, Σ e·e′ / Σ e², exceeds `r` in magnitude.
///
/// The correlation lies between ± cos(π/(n + 1)), and its variance is (n − 1)/(n·(n + 2)) (von Neumann); a symmetric beta
/// distribution of this range and variance approximates it.
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
    incomplete_beta((reach * reach / variance - 1.0) / 2.0, 0.5, 1.0 - share)
}

/// The regularised incomplete beta function; 1 where it is not defined.
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    checked_beta_reg(a, b, x).unwrap_or(1.0)
}
