//! Samples that have nothing to do with the others.

use super::super::FitError;
use super::super::chance::student_exceeds;
use super::growth::MEDIAN;
use super::{FitOptions, Fitted, Parameters, Problem, Sample};

/// A sample is told as an outlier if no more than one run in a million has one as far by chance.
const CHANCE: f64 = 1e-6;
/// What is farther than so many times the usual is looked at at all.
const SUSPECT: f64 = 4.0;
/// One in so many samples may be an outlier: more of them are no exceptions.
const ONE_IN: usize = 10;
/// More of them are not looked for.
const MOST: usize = 20;
/// By so much a sample may be farther off than the straight model has it: what concerns the master bends it.
const BENT: f64 = 1.05;
/// Of the size of the slave's positions this part is rounding.
const ROUNDING: f64 = 1e-9;
/// A position that is rounded may be half a step from where it is, the fit another half from there, and the next step is one
/// that little noise takes once.
const STEPS: f64 = 1.5;

impl Problem<'_> {
    /// Takes out the sample that is farthest off, fits the others again, and so on, as far as there may be outliers; all up
    /// to the last one that is too far off by its own studentized residual (Rosner's procedure, with Bonferroni's bound for
    /// the largest of so many) are told. So one of them does not hide another. It ends as soon as no sample that is left could
    /// be told, whatever hides it.
    pub(super) fn refuse_outliers(
        &self,
        fitted: &Fitted,
        options: &FitOptions,
        step: Option<f64>,
    ) -> Result<(), FitError> {
        let step = step.unwrap_or_default();
        // Noise that grows with the slope has more of what is far off where the cam is steep: each counts by its own.
        if let Some(growth) = self.growth(fitted.best, step) {
            let samples = self.evened(fitted.best, &growth);
            let even = Problem { samples: &samples, ..*self };
            return match even.solved(options) {
                Some(fitted) => {
                    even.refuse_far(&fitted, options, (step, even.steep_variance(fitted.best)))
                }
                None => Ok(()),
            };
        }
        self.refuse_far(fitted, options, (step, 0.0))
    }

    /// The variance of what is left over of the steeper half, by weight and median. Where the cam hardly moves the slave, noise may be
    /// far less than what is reckoned with there, and would make the rest of it seem far off.
    fn steep_variance(&self, p: Parameters) -> f64 {
        let steep = |s: &Sample| self.slope(p, s).abs();
        let mut both: Vec<(f64, f64)> =
            self.samples.iter().map(|s| (steep(s), self.over(p, s).abs())).collect();
        both.sort_by(|a, b| b.0.total_cmp(&a.0));
        both.truncate(both.len().div_ceil(2));
        both.sort_by(|a, b| a.1.total_cmp(&b.1));
        let median = both.get(both.len() / 2).map_or(0.0, |(_, over)| *over);
        (median / MEDIAN).powi(2)
    }

    /// Positions may be rounded to `step`, and the variance of what is left over is `variance` at least.
    fn refuse_far(
        &self,
        fitted: &Fitted,
        options: &FitOptions,
        (step, variance): (f64, f64),
    ) -> Result<(), FitError> {
        let most = (self.samples.len() / ONE_IN).clamp(1, MOST);
        let weight = self.samples.iter().map(|s| s.weight).fold(0.0, f64::max);
        let floor = (ROUNDING * self.size()).max(STEPS * step * weight.sqrt());
        if !self.has_suspects(fitted.best, floor) {
            return Ok(());
        }
        let mut left: Vec<(usize, Sample)> = (0..).zip(self.samples.iter().copied()).collect();
        let mut best = fitted.best;
        let mut taken: Vec<Far> = Vec::new();
        let mut told = 0;
        for round in 0..most {
            let samples: Vec<_> = left.iter().map(|(_, sample)| *sample).collect();
            let some = Problem { samples: &samples, ..*self };
            let Some(offs) = some.offs(best) else { break };
            if some.least_chance(&offs, most - round) > CHANCE {
                break;
            }
            let Some(mut far) = some.farthest(&offs, (floor, variance)) else { break };
            let (index, _) = left.remove(far.index);
            far.index = index;
            let chance = far.chance;
            taken.push(far);
            if chance <= CHANCE {
                told = taken.len();
            }
            let samples: Vec<_> = left.iter().map(|(_, sample)| *sample).collect();
            let rest = Problem { samples: &samples, ..*self };
            let Some(Fitted { best: again, .. }) = rest.solved(options) else { break };
            best = again;
        }
        taken.truncate(told);
        if taken.is_empty() {
            return Ok(());
        }
        // How far each is from where the others have it.
        let found = |far: &Far| {
            let sample = self.samples.get(far.index).copied();
            let by = sample.map_or(0.0, |s| s.slave - self.model(best, s.master).0);
            (far.index + 1, by)
        };
        let mut outliers: Vec<_> = taken.iter().map(found).collect();
        outliers.sort_unstable_by_key(|(index, _)| *index);
        Err(FitError::Outliers { outliers })
    }

    /// Whether anything is far off of what is usual, the median.
    fn has_suspects(&self, p: Parameters, floor: f64) -> bool {
        let mut off: Vec<_> = self.samples.iter().map(|s| self.over(p, s).abs()).collect();
        let middle = off.len() / 2;
        let largest = off.iter().copied().fold(0.0, f64::max);
        off.select_nth_unstable_by(middle, f64::total_cmp);
        // Of normal noise the median is 0.6745 standard deviations.
        let usual = off.get(middle).copied().unwrap_or_default() / 0.6745;
        largest > SUSPECT * usual && largest > floor
    }

    /// What is left over of a sample, by its weight.
    fn over(&self, p: Parameters, sample: &Sample) -> f64 {
        sample.weight.sqrt() * (sample.slave - self.model(p, sample.master).0)
    }

    /// The largest position: what rounding is measured against.
    fn size(&self) -> f64 {
        self.samples.iter().map(|s| s.weight.sqrt() * s.slave.abs()).fold(0.0, f64::max)
    }

    /// What is left over of every sample.
    fn offs(&self, p: Parameters) -> Option<Vec<Off>> {
        let (matrix, _) = self.normal(p, self.samples);
        let inverse = matrix.try_inverse()?;
        let off = |sample: &Sample| {
            let row = self.row(p, sample);
            let leverage = sample.weight * row.dot(&(&inverse * &row));
            Off { over: self.over(p, sample), leverage }
        };
        Some(self.samples.iter().map(off).collect())
    }

    /// The sample with the largest studentized residual, of those that are off by more than `floor`, where the variance is `least` at
    /// least; none if there are too few.
    fn farthest(&self, offs: &[Off], (floor, least): (f64, f64)) -> Option<Far> {
        let freedom = offs.len().checked_sub(self.free.len() + 1).filter(|n| *n > 0)?;
        let square: f64 = offs.iter().map(|off| off.over.powi(2)).sum();
        #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
        let (freedom, count) = (freedom as f64, offs.len() as f64);
        let mut farthest: Option<(usize, f64)> = None;
        for (index, off) in offs.iter().enumerate() {
            let residual = off.over;
            if residual.abs() <= floor {
                continue;
            }
            let free = 1.0 - off.leverage;
            // A sample that alone says something cannot contradict the others.
            if free <= 1e-9 {
                continue;
            }
            // With its own part of what is left over taken out.
            let rest = ((square - residual * residual / free).max(0.0) / freedom).max(least);
            let t = residual.abs() / (rest * free).sqrt();
            if farthest.is_none_or(|(_, other)| t > other) {
                farthest = Some((index, t));
            }
        }
        let (index, t) = farthest?;
        Some(Far { index, chance: count * student_exceeds(t, freedom) })
    }

    /// Less than this no chance can be of the farthest sample in as many `rounds`, whichever samples are taken out before it;
    /// 0 if nothing can be said.
    ///
    /// Let H be the hat matrix, r what is left over, and T all that is taken out, with leverages of L together at most. No
    /// eigenvalue of H on T exceeds L. So without T the squares fall by |r|²/(1 − L) at most, summed over T; no other sample is
    /// moved by more than √(h·L)·|r|/(1 − L), and its leverage falls short of 1 by 1 − L at least.
    fn least_chance(&self, offs: &[Off], rounds: usize) -> f64 {
        let Some(freedom) = offs.len().checked_sub(self.free.len() + 1) else { return 0.0 };
        if rounds == 0 || freedom <= rounds {
            return 0.0;
        }
        let mut squares: Vec<_> = offs.iter().map(|off| off.over * off.over).collect();
        let mut leverages: Vec<_> = offs.iter().map(|off| off.leverage).collect();
        let all: f64 = squares.iter().sum();
        let [(gone, farthest), (leverage, most)] =
            [&mut squares, &mut leverages].map(|values| largest(values, rounds));
        let free = 1.0 - leverage;
        let rest = all - gone / free;
        if !(free > 0.0 && rest > 0.0) {
            return 0.0;
        }
        let residual = farthest.sqrt() + (most * leverage * gone).sqrt() / free;
        #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
        let (freedom, count) = (freedom as f64, (offs.len() - rounds + 1) as f64);
        let t = BENT * residual * (freedom / (free * rest)).sqrt();
        count * student_exceeds(t, freedom)
    }
}

/// The sum of the so many largest values, and the largest one.
fn largest(values: &mut [f64], count: usize) -> (f64, f64) {
    if count < values.len() {
        values.select_nth_unstable_by(count, |a, b| b.total_cmp(a));
    }
    let first = values.iter().take(count);
    (first.clone().sum(), first.copied().fold(0.0, f64::max))
}

/// What is left over of a sample, by its weight, and how much of it the sample itself has made small.
struct Off {
    over: f64,
    leverage: f64,
}

/// A sample and how likely one of all is as far off by chance.
struct Far {
    index: usize,
    chance: f64,
}

#[cfg(test)]
mod tests {
    use super::super::super::super::knot::Knot;
    use super::super::super::tests::Random;
    use super::super::{Curve, Problem, Sample};
    use super::CHANCE;

    fn lift() -> Curve {
        let knots = [(0.0, 0.0), (110.0, 80.0), (230.0, 30.0), (360.0, 0.0)];
        let knots = knots.map(|(master, slave)| Knot::at_rest(master, slave));
        Curve::polynomial(&knots).expect("a curve")
    }

    fn noise(random: &mut Random, curve: &Curve, count: u32) -> Vec<Sample> {
        (0..count)
            .map(|index| {
                let master = 720.0 * f64::from(index) / f64::from(count);
                let slave = curve.repeated(master).position + 0.2 * random.normal();
                Sample { master, slave, weight: 1.0 }
            })
            .collect()
    }

    const BEST: [f64; 4] = [0.0, 1.0, 0.0, 1.0];

    /// With offset and scaling of the slave the model is straight, so the bound is exact: samples are taken out one after the
    /// other, the farthest or any, the others fitted again, and no chance is ever below it.
    #[test]
    fn no_sample_is_less_likely_than_the_bound() {
        let curve = lift();
        let mut said = 0;
        for seed in 0..300 {
            let mut random = Random(seed + 12_000);
            let mut samples =
                noise(&mut random, &curve, 80 + 7 * (u32::try_from(seed).expect("small") % 30));
            // Nothing, one that is far off, or two that hide each other.
            let by = [0.0, random.between(0.5, 3.0)][usize::from(seed % 3 != 0)];
            samples[20].slave += by;
            samples[21].slave += if seed % 3 == 2 { by } else { 0.0 };
            let whole = Problem { curve: &curve, samples: &samples, free: &[2, 3], repeated: true };
            let (_, best) = whole.descend(BEST).expect("a fit");
            let rounds = 1 + usize::try_from(seed % 8).expect("small");
            let bound = whole.least_chance(&whole.offs(best).expect("determined"), rounds);
            said += usize::from(bound > 0.0);
            for any in [false, true] {
                let mut left = samples.clone();
                for _ in 0..rounds {
                    let some = Problem { samples: &left, ..whole };
                    let (_, best) = some.descend(BEST).expect("a fit");
                    let offs = some.offs(best).expect("determined");
                    let far = some.farthest(&offs, (0.0, 0.0)).expect("a sample");
                    assert!(far.chance >= bound, "{seed}: {} {bound}", far.chance);
                    let part = random.share() * 0.999;
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        clippy::cast_precision_loss,
                        reason = "a place among a few hundred samples"
                    )]
                    let other = (part * left.len() as f64) as usize;
                    left.remove(if any { other } else { far.index });
                }
            }
        }
        assert!(said >= 250, "{said}");
    }

    /// Long runs of noise end at once, with all four unknowns; with two slips among them they do not.
    #[test]
    fn noise_needs_no_second_fit() {
        let curve = lift();
        let free = [0, 1, 2, 3];
        let mut samples = noise(&mut Random(5), &curve, 200_000);
        let said = |samples: &[Sample]| {
            let problem = Problem { curve: &curve, samples, free: &free, repeated: true };
            let (_, best) = problem.descend(BEST).expect("a fit");
            let suspects = problem.has_suspects(best, 1e-9);
            let chance = problem.least_chance(&problem.offs(best).expect("determined"), 20);
            (suspects, chance > CHANCE)
        };
        // In so much noise there always is one beyond four times the usual.
        assert_eq!(said(&samples), (true, true));
        samples[700].slave += 1.6;
        samples[701].slave += 1.6;
        assert_eq!(said(&samples), (true, false));
    }
}
