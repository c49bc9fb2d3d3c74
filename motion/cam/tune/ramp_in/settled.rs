//! Clean-up of an optimised ramp: no value is larger than the ramp needs, and all have few digits.

use super::place::Aim;
use super::problem::{Problem, values};
use super::wish::{RampError, RampIn};
use crate::Quantity;

/// What is known of a ramp's values: less than this part is what the search left over.
const NEAT: f64 = 1e-7;
/// A part of the velocity that is a hair.
const HAIR: f64 = 1e-4;
/// Halvings on a scale of ratios, down to a part.
const HALVINGS: usize = 40;
const LEAST_FACTOR: f64 = 1e-9;

impl Problem<'_> {
    /// The same ramp as it is told.
    pub(super) fn settled(&self, ramp: RampIn, aim: &Aim) -> Result<RampIn, RampError> {
        let ramp = self.softer(ramp, aim)?;
        let ramp = match aim.least {
            _ if !self.limited() => ramp,
            Some(Quantity::Jerk) => self.with_least_jerk(ramp, aim)?,
            _ => self.with_the_jerk_of_the_axis(ramp, aim)?,
        };
        let ramp = self.slower(self.without_a_hair(ramp, aim)?, aim)?;
        self.neat(ramp, aim)
    }

    /// Whether another ramp is as good but for a part of it.
    fn as_good(&self, tried: &RampIn, ramp: &RampIn, aim: &Aim, part: f64) -> bool {
        let same = |one: f64, other: f64| one <= other * (1.0 + part);
        self.keeps(tried)
            && tried.duration_s <= aim.within_s
            && same(tried.duration_s, ramp.duration_s)
            && same(tried.peak_velocity, ramp.peak_velocity)
            && same(tried.peak_acceleration, ramp.peak_acceleration)
            && same(tried.peak_jerk, ramp.peak_jerk)
    }

    /// With the jerk that the axis has, if that is as good: nothing of it is to be changed then.
    fn with_the_jerk_of_the_axis(&self, ramp: RampIn, aim: &Aim) -> Result<RampIn, RampError> {
        let [velocity, up, down, _] = values(&ramp);
        let tried = self.ramp([velocity, up, down, self.wish.limits.jerk])?;
        let in_time = self.keeps(&tried) && tried.duration_s <= aim.within_s;
        Ok(if in_time && aim.of(&tried) <= aim.of(&ramp) * (1.0 + NEAT) { tried } else { ramp })
    }

    /// With the least jerk of the axis that is enough: accelerations that are reached late leave jerk over that nothing needs.
    fn with_least_jerk(&self, ramp: RampIn, aim: &Aim) -> Result<RampIn, RampError> {
        let [velocity, up, down, most] = values(&ramp);
        let (mut low, mut high) = (LEAST_FACTOR.ln(), 0.0);
        let mut best = ramp;
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            let tried = self.ramp([velocity, up, down, most * middle.exp()])?;
            // As gentle and in time.
            let enough = self.keeps(&tried)
                && tried.duration_s <= aim.within_s
                && tried.peak_jerk <= ramp.peak_jerk * (1.0 + NEAT);
            if enough {
                (high, best) = (middle, tried);
            } else {
                low = middle;
            }
        }
        Ok(best)
    }

    /// With accelerations that are not beyond the limit of the axis, if that changes nothing: where the jerk says how quick a
    /// ramp is, these do not.
    fn softer(&self, ramp: RampIn, aim: &Aim) -> Result<RampIn, RampError> {
        let most = self.wish.limits.acceleration;
        let [velocity, up, down, jerk] = values(&ramp);
        let tried = self.ramp([velocity, up.min(most), down.min(most), jerk])?;
        Ok(if self.as_good(&tried, &ramp, aim, NEAT) { tried } else { ramp })
    }

    /// With no more velocity than is reached.
    fn slower(&self, ramp: RampIn, aim: &Aim) -> Result<RampIn, RampError> {
        let [reached, ..] = self.way(values(&ramp))?.reached();
        let [velocity, up, down, jerk] = values(&ramp);
        if reached <= 0.0 || reached >= velocity {
            return Ok(ramp);
        }
        let tried = self.ramp([reached, up, down, jerk])?;
        Ok(if self.as_good(&tried, &ramp, aim, NEAT) { tried } else { ramp })
    }

    /// A velocity that is less by a hair than what is reached without it costs next to no time: it is left out.
    fn without_a_hair(&self, ramp: RampIn, aim: &Aim) -> Result<RampIn, RampError> {
        let [velocity, up, down, jerk] = values(&ramp);
        let tried = self.ramp([(velocity * (1.0 + HAIR)).min(self.most), up, down, jerk])?;
        let [reached, ..] = self.way(values(&tried))?.reached();
        let free = reached < tried.velocity_difference && tried.duration_s <= aim.within_s;
        let as_good = aim.of(&tried) <= aim.of(&ramp) * (1.0 + NEAT);
        Ok(if free && as_good && self.keeps(&tried) { tried } else { ramp })
    }

    /// With as few digits as change nothing that the search could tell: 2 in place of 1.999999967. A velocity is rounded up: one
    /// that is just reached would hold the ramp otherwise. The jerk, which is the axis's, stays as it is.
    fn neat(&self, ramp: RampIn, aim: &Aim) -> Result<RampIn, RampError> {
        let mut best = ramp;
        for index in 0..3 {
            for digits in 1..9_u8 {
                let mut tried = values(&best);
                let Some(value) = tried.get_mut(index) else { break };
                *value = rounded(*value, digits, index == 0);
                let tried = self.ramp(tried)?;
                if self.as_good(&tried, &ramp, aim, NEAT) {
                    best = tried;
                    break;
                }
            }
        }
        Ok(best)
    }
}

/// The nearest number with so many digits behind the first one, or the next one that is not less.
fn rounded(value: f64, digits: u8, up: bool) -> f64 {
    let short = |value: f64| -> f64 {
        let digits = usize::from(digits);
        format!("{value:.digits$e}").parse().unwrap_or(value)
    };
    let nearest = short(value);
    let last = 10.0_f64.powf(value.log10().floor() - f64::from(digits));
    if up && nearest < value { short(nearest + last) } else { nearest }
}
