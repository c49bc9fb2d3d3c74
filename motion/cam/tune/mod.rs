//! Tuning a cam offline: offsets and scalings from a recorded run or within limits, dead times from switchings, and ramps.
//!
//! Every estimate comes with an interval that holds the true value in 95 % of all runs (`motion/cam/tune/bootstrap.rs`). Data that
//! do not determine a value, or contradict it, are refused.

#![allow(
    clippy::indexing_slicing,
    reason = "fixed arrays of the four values, and loops over the indexed array"
)]

mod bootstrap;
mod constrained;
mod distributions;
mod fit;
mod quantum;
mod ramp_in;
mod residuals;
#[cfg(test)]
mod tests;

pub use constrained::{
    Bound, Constrained, ConstraintError, Constraints, Objective, constrained_fit,
};
pub use distributions::{student_975, student_exceeds};
pub use fit::{Fit, FitOptions, Free, Sample, fit};
pub use ramp_in::{
    RampError, RampGoal, RampIn, RampMoment, RampShown, RampWish, on_cam, ramp_in, ramp_shown,
};

use twin_number::Short;

/// A value and how far the true one is from it at most, in 95 % of all runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Half the width of the interval; 0 for what was given.
    pub half_width: f64,
}

impl Estimate {
    /// Whether the interval holds a value.
    pub fn holds(&self, value: f64) -> bool {
        (value - self.value).abs() <= self.half_width
    }
}

/// Why data are not fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Too few samples.
    #[error(
        "{found} sample{} too few for {unknowns} unknown{}: {needed} are needed",
        if *.found == 1 { " is" } else { "s are" }, if *.unknowns == 1 { "" } else { "s" }
    )]
    TooFew {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
        /// For how many unknowns.
        unknowns: usize,
    },
    /// A sample is not a finite number, or its weight is not greater than 0.
    #[error("sample {index}: {value} is not a {what}")]
    NoNumber {
        /// Its number, from 1.
        index: usize,
        /// Of what.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The data do not determine unknowns.
    #[error("the data do not determine {}", .unknowns.join(" and "))]
    Undetermined {
        /// Which.
        unknowns: Vec<&'static str>,
    },
    /// Two different answers fit alike, and what the fit began with does not say which is meant.
    #[error(
        "{} and {} fit equally well as {unknown}, and neither is clearly nearer to {}, where the search began",
        Short(*.one), Short(*.other), Short(*.begun)
    )]
    Ambiguous {
        /// Of what.
        unknown: &'static str,
        /// One answer.
        one: f64,
        /// The other one.
        other: f64,
        /// What was given of it.
        begun: f64,
    },
    /// What fits best is not where it is looked for.
    #[error(
        "the best fit of {unknown} is {}, which is not between {} and {}",
        Short(*.value), Short(.between[0]), Short(.between[1])
    )]
    Beyond {
        /// Of what.
        unknown: &'static str,
        /// What fits best.
        value: f64,
        /// Where it is looked for.
        between: [f64; 2],
    },
    /// The master does not move.
    #[error("the master is at {} in all {samples} samples, which does not determine {}", Short(*.master), .unknowns.join(" and "))]
    Still {
        /// Where, u.
        master: f64,
        /// How many there are.
        samples: usize,
        /// What was to be found.
        unknowns: Vec<&'static str>,
    },
    /// Some samples have nothing to do with the others.
    #[error("{}", said_of_outliers(.outliers))]
    Outliers {
        /// Which, from 1, and how far the slave is from where the others have it, u.
        outliers: Vec<(usize, f64)>,
    },
    /// The model does not describe the data.
    #[error(
        "the data do not follow the cam: residuals of {} rms remain of a spread of {} rms; check that master and slave are in the cam's units and that the run is of this cam",
        Short(*.rms), Short(*.spread)
    )]
    Unexplained {
        /// The residuals, root mean square, u.
        rms: f64,
        /// Spread of the data, root mean square, u.
        spread: f64,
    },
    /// The first and the second half of the data ask for different answers.
    #[error("both halves of the data contradict each other (F = {})", Short(*.f))]
    Contradictory {
        /// How many times larger than by chance the difference is.
        f: f64,
    },
}

fn said_of_outliers(outliers: &[(usize, f64)]) -> String {
    let each = outliers.iter().map(|(index, by)| format!("{index} (by {})", Short(*by)));
    format!(
        "the slave is far from where the other samples have it in sample {}",
        each.collect::<Vec<_>>().join(", ")
    )
}
