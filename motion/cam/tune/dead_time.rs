//! The dead time of what a tappet switches, from where it was seen to switch.

use super::distributions::student_975;
use super::{Estimate, FitError};

/// A switching that was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switching {
    /// Velocity of the master then, u/s, with its sign.
    pub velocity: f64,
    /// How far behind the tappet's position the master was, u, with its sign.
    pub distance: f64,
    /// Its weight: 1 over the variance of the distance, up to a common factor.
    pub weight: f64,
}

/// What switchings tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadTime {
    /// Dead time, s: what `DeadTimeCompensation` should be.
    pub dead_time_s: Estimate,
    /// How far the tappet stands beside where it should, u.
    pub offset: Estimate,
    /// What is left over, weighted root mean square, u.
    pub rms: f64,
}

/// Finds the dead time T by weighted least squares: distance = velocity · T + offset. Without `with_offset` the tappet
/// stands where it should.
///
/// # Errors
/// [`FitError`] if there are too few switchings, or all are at the same velocity while an offset is looked for.
pub fn dead_time(seen: &[Switching], with_offset: bool) -> Result<DeadTime, FitError> {
    let unknowns = if with_offset { 2 } else { 1 };
    let needed = unknowns + 2;
    if seen.len() < needed {
        return Err(FitError::TooFewSwitchings { found: seen.len(), needed });
    }
    for (index, each) in (1..).zip(seen) {
        let wrong = |what, value: f64| Err(FitError::NoNumber { index, what, value });
        if !each.velocity.is_finite() {
            return wrong("velocity", each.velocity);
        }
        if !each.distance.is_finite() {
            return wrong("distance", each.distance);
        }
        if !(each.weight.is_finite() && each.weight > 0.0) {
            return wrong("weight", each.weight);
        }
    }
    let sum = |of: &dyn Fn(&Switching) -> f64| seen.iter().map(|s| s.weight * of(s)).sum::<f64>();
    let total = sum(&|_| 1.0);
    // Without an offset the velocities count from 0, with one from their mean.
    let (v0, d0) = if with_offset {
        (sum(&|s| s.velocity) / total, sum(&|s| s.distance) / total)
    } else {
        (0.0, 0.0)
    };
    let spread = sum(&|s| (s.velocity - v0).powi(2));
    if spread <= 1e-12 * sum(&|s| s.velocity.powi(2)) || spread == 0.0 {
        let unknowns = if with_offset { vec!["dead time", "offset"] } else { vec!["dead time"] };
        return Err(FitError::Undetermined { unknowns });
    }
    let time = sum(&|s| (s.velocity - v0) * (s.distance - d0)) / spread;
    let offset = d0 - v0 * time;
    let left = sum(&|s| (s.distance - s.velocity * time - offset).powi(2));
    let freedom = seen.len() - unknowns;
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let variance = left / freedom as f64;
    let t = student_975(freedom);
    let half = |share: f64| t * (variance * share).sqrt();
    let offset = if with_offset {
        Estimate { value: offset, half_width: half(1.0 / total + v0 * v0 / spread) }
    } else {
        Estimate::given(0.0)
    };
    let dead_time_s = Estimate { value: time, half_width: half(1.0 / spread) };
    Ok(DeadTime { dead_time_s, offset, rms: (left / total).sqrt() })
}
