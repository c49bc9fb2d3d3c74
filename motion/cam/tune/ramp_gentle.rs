//! The gentlest ramp in a given time.
//!
//! For each `VelocityDiff` the ramp is as gentle as the time allows: one factor of its accelerations, or of its jerk, is
//! found by bisection. What comes of it is best at one velocity, or at one on either side of a step: this is found on a
//! grid and between its places by golden section. From there each value is changed as long as that is better, and then all of
//! them at once (`motion/cam/tune/ramp_search.rs`).

use super::super::bounds::{Quantity, SlaveLimits};
use super::ramp_in::{Problem, Values, WAYS, WAYS_WITH_JERK};
use super::ramp_search::Aim;
use super::ramp_wish::{RampError, RampIn};
use crate::axis::profile::RampType;

/// Parts of the velocity that are tried, each this part of the one before.
const PART: f64 = std::f64::consts::FRAC_1_SQRT_2;
const PARTS: i32 = 24;
/// Steps between them.
const SECTIONS: usize = 40;
/// Halvings on a scale of ratios, from the limits down to a part of them.
const HALVINGS: usize = 40;
const LEAST_FACTOR: f64 = 1e-9;
/// Peaks that differ by less than this part are the same.
const ALIKE: f64 = 1e-7;

impl Problem<'_> {
    /// The ramp with the smallest peak of one quantity that takes `within_s` at most, which `soonest` does.
    pub(super) fn gentlest(
        &self,
        soonest: &RampIn,
        within_s: f64,
        least: Quantity,
    ) -> Result<RampIn, RampError> {
        let score = |ramp: &RampIn| {
            let peak = match least {
                Quantity::Velocity => ramp.peak_velocity,
                Quantity::Acceleration => ramp.peak_acceleration,
                Quantity::Jerk => ramp.peak_jerk,
            };
            if ramp.duration_s <= within_s && self.keeps(ramp) { peak } else { f64::INFINITY }
        };
        let SlaveLimits { velocity, acceleration, jerk } = self.wish.limits;
        let with_jerk = least == Quantity::Jerk && self.wish.ramp != RampType::Trapezoid;
        let mut families: Vec<&dyn Fn(f64, f64) -> Values> = Vec::new();
        let of_pull = |v: f64, factor: f64| [v, acceleration * factor, acceleration * factor, jerk];
        let of_jerk = |v: f64, factor: f64| [v, acceleration, acceleration, jerk * factor];
        let of_both = |v: f64, factor: f64| {
            let pull = acceleration * factor.powf(2.0 / 3.0);
            [v, pull, pull, jerk * factor]
        };
        if with_jerk {
            families.extend([&of_jerk as &dyn Fn(f64, f64) -> Values, &of_both]);
        } else {
            families.push(&of_pull);
        }
        let ways: &[Values] = if with_jerk { &WAYS_WITH_JERK } else { &WAYS };
        let mut best = self.improved(*soonest, ways, &score)?;
        for family in families {
            let at = |log: f64| self.slowest(velocity * log.exp(), within_s, family);
            let Some(found) = valley(&at, &score)? else { continue };
            let found = self.improved(found, ways, &score)?;
            // Of those that are alike the one that asks for less of the axis.
            let alike = score(&found) <= score(&best) * (1.0 + ALIKE);
            if score(&found) < score(&best) * (1.0 - ALIKE)
                || (alike && with_jerk && found.ramp_jerk < best.ramp_jerk)
            {
                best = found;
            }
        }
        let searched = self.searched(best, Aim { least: Some(least), within_s })?;
        let searched = self.improved(searched, ways, &score)?;
        if score(&searched) < score(&best) * (1.0 - ALIKE) {
            best = searched;
        }
        if with_jerk { self.with_least_jerk(best, within_s) } else { Ok(best) }
    }

    /// The same ramp with the least jerk of the axis that is enough for it: accelerations that are reached late leave jerk over
    /// that nothing needs.
    fn with_least_jerk(&self, ramp: RampIn, within_s: f64) -> Result<RampIn, RampError> {
        let RampIn { velocity_difference, acceleration, deceleration, ramp_jerk, .. } = ramp;
        let (mut low, mut high) = (LEAST_FACTOR.ln(), 0.0);
        let mut best = ramp;
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            let jerk = ramp_jerk * middle.exp();
            let tried = self.ramp([velocity_difference, acceleration, deceleration, jerk])?;
            // As gentle and in time.
            let enough = self.keeps(&tried)
                && tried.duration_s <= within_s.max(ramp.duration_s)
                && tried.peak_jerk <= ramp.peak_jerk * (1.0 + ALIKE);
            if enough {
                (high, best) = (middle, tried);
            } else {
                low = middle;
            }
        }
        Ok(best)
    }

    /// With this velocity the ramp of a family that takes as long as it may.
    fn slowest(
        &self,
        velocity: f64,
        within_s: f64,
        family: &dyn Fn(f64, f64) -> Values,
    ) -> Result<RampIn, RampError> {
        let (mut low, mut high) = (LEAST_FACTOR.ln(), 0.0);
        let mut best = self.ramp(family(velocity, 1.0))?;
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            let tried = self.ramp(family(velocity, middle.exp()))?;
            if tried.duration_s <= within_s {
                (high, best) = (middle, tried);
            } else {
                low = middle;
            }
        }
        Ok(best)
    }
}

/// The best of a grid, and of the golden section beside it; none if no place of the grid has a finite score.
fn valley(
    at: &dyn Fn(f64) -> Result<RampIn, RampError>,
    score: &dyn Fn(&RampIn) -> f64,
) -> Result<Option<RampIn>, RampError> {
    let step = -PART.ln();
    let mut best: Option<(f64, RampIn)> = None;
    for index in 0..PARTS {
        let log = -step * f64::from(index);
        let found = at(log)?;
        if score(&found) < best.as_ref().map_or(f64::INFINITY, |(_, best)| score(best)) {
            best = Some((log, found));
        }
    }
    let Some((log, mut best)) = best else { return Ok(None) };
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (log - step, (log + step).min(0.0));
    let place = |low: f64, high: f64| [high - golden * (high - low), low + golden * (high - low)];
    for _ in 0..SECTIONS {
        let [one, other] = place(low, high);
        let (at_one, at_other) = (at(one)?, at(other)?);
        for found in [at_one, at_other] {
            if score(&found) < score(&best) {
                best = found;
            }
        }
        if score(&at_one) <= score(&at_other) {
            high = other;
        } else {
            low = one;
        }
    }
    Ok(Some(best))
}
