//! Correlation of what is left over from sample to sample, and by how much it makes variances larger.
//!
//! As autoregression of what is left over, of an order that the data choose by Akaike's criterion: den Haan and Levin, A
//! Practitioner's Guide to Robust Covariance Matrix Estimation (Handbook of Statistics 15, 1997). The lags of a kernel would
//! have to be cut off, which makes the variance too small.
//!
//! Where samples are few, the criterion overlooks weak correlation, and higher orders that chance has made undo some of what is
//! there. So it is asked what noise of the first order does as well, with the bias taken out that a correlation of few samples has
//! beside what fitting takes, −2·ρ/n (Marriott and Pope, Bias in the Estimation of Autocorrelations, Biometrika 41, 1954;
//! Kendall, the same volume), and the larger one of both variances counts.

/// The largest order.
const ORDERS: usize = 8;
/// Beyond so many lags, or below so much, correlations do not count.
const LAGS: usize = 400;
const SMALL: f64 = 1e-3;
/// Noise of the first order does not go on more strongly.
const MOST_OF_FIRST: f64 = 0.95;
/// A partial correlation that is larger is none of noise.
const MOST: f64 = 0.98;

/// Correlations at the lags 1, 2, … of noise with these covariances at 0, 1, 2, … of so many samples; none if the noise is
/// independent.
pub(super) fn correlations(covariances: &[f64], samples: usize) -> Vec<f64> {
    let Some((variance, rest)) = covariances.split_first() else { return Vec::new() };
    if *variance <= 0.0 {
        return Vec::new();
    }
    let known: Vec<f64> = rest.iter().map(|covariance| covariance / variance).collect();
    let factors = autoregression(&known, samples);
    let mut found: Vec<f64> = Vec::new();
    let order = factors.len();
    while order > 0 && found.len() < LAGS {
        let lag = found.len() + 1;
        // Yule and Walker's equations, which hold for the known lags and go on beyond them.
        let of = |lag: isize| match lag.unsigned_abs() {
            0 => 1.0,
            lag if lag <= order => known.get(lag - 1).copied().unwrap_or(0.0),
            lag => found.get(lag - 1).copied().unwrap_or(0.0),
        };
        let next = if lag <= order {
            known.get(lag - 1).copied().unwrap_or(0.0)
        } else {
            (1..)
                .zip(&factors)
                .map(|(back, factor)| {
                    factor * of(isize::try_from(lag).unwrap_or(isize::MAX) - back)
                })
                .sum()
        };
        found.push(next);
        let last = found.iter().rev().take(order + 1);
        if lag > order && last.fold(0.0, |most: f64, value| most.max(value.abs())) < SMALL {
            break;
        }
    }
    found
}

/// Correlations of noise of the first order, with that of neighbours as so many samples show it; none if it is not above 0.
pub(super) fn first_order(beside: f64, samples: f64) -> Vec<f64> {
    let known = beside > 0.0;
    if !known {
        return Vec::new();
    }
    let beside = (beside * (1.0 + 2.0 / samples)).min(MOST_OF_FIRST);
    let next = |value: &f64| Some(value * beside).filter(|value| *value >= SMALL);
    std::iter::successors(Some(beside), next).take(LAGS).collect()
}

/// Factors of the best order, by Levinson's and Durbin's recursion.
fn autoregression(known: &[f64], samples: usize) -> Vec<f64> {
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = samples as f64;
    let (mut factors, mut best): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let (mut left, mut score, mut least) = (1.0_f64, 0.0, 0.0);
    for (order, correlation) in known.iter().take(ORDERS.min(samples / 10)).enumerate() {
        let before: f64 =
            factors.iter().zip(known.iter().take(order).rev()).map(|(f, r)| f * r).sum();
        let partial = (correlation - before) / left;
        if partial.abs() > MOST || left <= 0.0 {
            break;
        }
        let turned: Vec<f64> = factors.iter().rev().copied().collect();
        for (factor, turned) in factors.iter_mut().zip(turned) {
            *factor -= partial * turned;
        }
        factors.push(partial);
        left *= 1.0 - partial * partial;
        score += count * (1.0 - partial * partial).ln() + 2.0;
        if score < least {
            least = score;
            best.clone_from(&factors);
        }
    }
    best
}

/// By how much correlations make the variance of Σ share · noise larger; 1 if they make it less.
pub(super) fn inflation(shares: &[f64], correlations: &[f64]) -> f64 {
    let square: f64 = shares.iter().map(|share| share * share).sum();
    if square <= 0.0 {
        return 1.0;
    }
    let with = |lag: usize| -> f64 {
        shares.iter().zip(shares.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>() / square
    };
    let more: f64 = (1..).zip(correlations).map(|(lag, r)| 2.0 * r * with(lag)).sum();
    (1.0 + more).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::{correlations, first_order, inflation};

    /// Of a first order with ρ the correlations are ρʰ, and the variance of the mean is (1 + ρ)/(1 − ρ) times that of
    /// independent noise.
    #[test]
    fn first_order_in_closed_form() {
        let rho: f64 = 0.3;
        let covariances: Vec<f64> = (0..=8).map(|lag| 2.0 * rho.powi(lag)).collect();
        let found = correlations(&covariances, 400);
        for (lag, value) in (1..).zip(&found) {
            assert!((value - rho.powi(lag)).abs() < 1e-12, "{lag}: {value}");
        }
        let more = inflation(&vec![1.0; 100_000], &found);
        assert!((more / (1.3 / 0.7) - 1.0).abs() < 1e-3, "{more}");
    }

    /// ρ + 2·ρ/n, and on in powers of it; a mean of many has (1 + ρ)/(1 − ρ) of the variance.
    #[test]
    fn first_order_of_few() {
        let found = first_order(0.4, 50.0);
        let rho: f64 = 0.4 * 1.04;
        for (lag, value) in (1..).zip(&found) {
            assert!((value - rho.powi(lag)).abs() < 1e-12, "{lag}: {value}");
        }
        let more = inflation(&vec![1.0; 100_000], &found);
        assert!((more / ((1.0 + rho) / (1.0 - rho)) - 1.0).abs() < 3e-3, "{more}");
        assert!(first_order(-0.4, 50.0).is_empty() && first_order(f64::NAN, 50.0).is_empty());
    }

    /// A second order whose correlations follow r(h) = 0.5·r(h − 1) − 0.4·r(h − 2), r(1) = 0.5/1.4.
    #[test]
    fn second_order() {
        let mut truth = vec![1.0, 0.5 / 1.4];
        for lag in 2..40_usize {
            truth.push(0.5 * truth[lag - 1] - 0.4 * truth[lag - 2]);
        }
        let found = correlations(&truth[..9], 1000);
        for (value, truth) in found.iter().zip(&truth[1..]) {
            assert!((value - truth).abs() < 1e-9, "{value} {truth}");
        }
        assert!(correlations(&[1.0, 0.01, -0.02, 0.01], 100).is_empty());
    }
}
