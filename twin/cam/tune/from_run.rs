//! Fit of a recorded run: offsets, scalings, and the dead time of tappets.

use super::super::check::CamUse;
use super::super::run::{RecordedRun, RunSample};
use super::TuneError;
use super::correction::of_coupling;
use super::tappets::{CHANCE, refuse_contradictory, refuse_random};
use twin_cam::file::clean;
use twin_cam::tune::{
    DeadTime, Estimate, Fit, FitError, FitOptions, Free, Sample, Switching, dead_time, fit,
    student_975, student_exceeds,
};
use twin_cam::{Action, Passage, Tappet};
use twin_machine::cam_file::CamFile;
use twin_number::significant;

/// Finds offsets and scalings in a run, beginning with those in use; `between` says between what `MasterOffset`, `MasterScaling`,
/// `SlaveOffset` and `SlaveScaling` are, where that is known.
///
/// # Errors
/// [`TuneError::Fit`] if the run does not say them, or contradicts the cam or itself; [`TuneError::Missing`] if it would not
/// with a scaling that is not looked for.
pub fn fit_run(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
    free: Free,
    scaling_range: f64,
    between: [Option<[f64; 2]>; 4],
) -> Result<Fit, TuneError> {
    let fitted = |free| fit_free(file, using, run, free, (scaling_range, between));
    let error = match fitted(free) {
        Ok(found) => return Ok(found),
        Err(error) => error,
    };
    let contradicts = match &error {
        TuneError::NoNoise { .. } => true,
        TuneError::Fit(error) => {
            matches!(error, FitError::Contradictory { .. } | FitError::Unexplained { .. })
        }
        _ => false,
    };
    let more = [
        ("slave-scaling", Free { slave_scaling: true, ..free }),
        ("master-scaling", Free { master_scaling: true, ..free }),
        (
            "slave-scaling and master-scaling",
            Free { slave_scaling: true, master_scaling: true, ..free },
        ),
    ];
    let explains = |(_, more): &(&str, Free)| *more != free && fitted(*more).is_ok();
    match more.into_iter().filter(|_| contradicts).find(explains) {
        Some((with, _)) => Err(TuneError::Missing { error: Box::new(error), with }),
        None => Err(error),
    }
}

/// The same for these unknowns alone.
fn fit_free(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
    free: Free,
    (scaling_range, between): (f64, [Option<[f64; 2]>; 4]),
) -> Result<Fit, TuneError> {
    let from = of_coupling(using);
    let options = FitOptions { free, from, scaling_range, repeated: using.repeated, between };
    let samples: Vec<_> = run
        .samples
        .iter()
        .map(|sample| Sample { master: sample.master, slave: sample.slave, weight: 1.0 })
        .collect();
    let found = fit(file.cam.curve(), &samples, &options).map_err(|error| match error {
        // Of the file that was read, not of the samples.
        FitError::Outliers { outliers } => {
            let line = |index: usize| run.samples.get(index.wrapping_sub(1)).map(|one| one.line);
            let told = |(index, by): (usize, f64)| Some((line(index)?, by));
            TuneError::Outliers { outliers: outliers.into_iter().filter_map(told).collect() }
        }
        other => TuneError::Fit(other),
    })?;
    if found.is_noise(samples.len()) {
        Ok(found)
    } else {
        let (correlation, rms, unit) = (found.correlation, found.rms, file.slave.unit().to_owned());
        let named = using.coupling.numbers().into_iter().zip(found.estimates).zip(free.list());
        let sought = named.filter(|(_, sought)| *sought);
        let values: Vec<_> = sought
            .map(|(((_, name, _), found), _)| format!("{name} {}", significant(found.value, 4)))
            .collect();
        Err(TuneError::NoNoise { correlation, rms, unit, nearest: values.join(", ") })
    }
}

/// The value to a thousandth of its interval: digits beyond say nothing. What was given stays as it is.
pub fn rounded(estimate: Estimate) -> f64 {
    let Estimate { value, half_width } = estimate;
    if !(half_width > 0.0 && half_width.is_finite()) {
        return clean(value);
    }
    let unit = 10_f64.powf((half_width * 1e-3).log10().floor());
    // Through text: a multiple of a power of ten is not the nearest number to its decimal.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "limited just before"
    )]
    let decimals = (-unit.log10().round()).clamp(0.0, 15.0) as usize;
    format!("{value:.decimals$}").parse().unwrap_or(value)
}

/// How far the slave of a run was from the cam: master and error of each sample.
pub fn errors(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Vec<(f64, f64)> {
    let error = |sample: &RunSample| {
        (sample.master, sample.slave - super::told_at(file, using, sample.master))
    };
    run.samples.iter().map(error).collect()
}

/// Root mean square.
pub fn rms(errors: &[(f64, f64)]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = errors.len().max(1) as f64;
    (errors.iter().map(|(_, error)| error * error).sum::<f64>() / count).sqrt()
}

/// A switching and where it was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The line of the run in which the output had switched.
    pub line: u64,
    /// Group of the output.
    pub group: i16,
    /// Whether it has switched on.
    pub on: bool,
    /// How long after the tappet it switched, s.
    pub behind_s: f64,
    /// How far from that the switching was at most, s: it is known to have been between two samples.
    pub within_s: f64,
    /// After what time the master comes to a tappet that switches so again, s.
    pub every_s: f64,
    /// What noise of the master makes of the tappet's time, standard deviation, s.
    pub noise_s: f64,
    /// For the fit.
    pub switching: Switching,
}

/// What the outputs of a run tell of the tappets that switch them; its master is to be unwound
/// ([`super::unwound`]).
///
/// An output that changes between two samples is taken to change half way between, and the tappet to be passed when the
/// master, on straight lines between the samples, was there. Whose tappet it was is the nearest one that switches so in the
/// master's direction.
pub fn switchings(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Vec<Seen> {
    let input = &using.coupling.input;
    let places: Vec<_> = run
        .samples
        .iter()
        .map(|sample| (sample.time_s, sample.master * input.master_scaling + input.master_offset))
        .collect();
    let noise = (run.noise() * input.master_scaling).abs();
    let mut seen = Vec::new();
    for (index, pair) in run.samples.windows(2).enumerate() {
        let ([before, after], Some([from, to])) = (pair, places.get(index..index + 2)) else {
            continue;
        };
        let velocity =
            f64::midpoint(run.velocity(index), run.velocity(index + 1)) * input.master_scaling;
        if velocity == 0.0 || !velocity.is_finite() {
            continue;
        }
        let (time, place) = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
        for ((group, was), is) in run.groups.iter().zip(&before.outputs).zip(&after.outputs) {
            let Some(Nearest { far, delay, every }) =
                nearest(file, using, (*group, *is), place, velocity).filter(|_| was != is)
            else {
                continue;
            };
            // Between samples that are so far apart any tappet may have switched it.
            if (to.1 - from.1).abs() >= every {
                continue;
            }
            let target = place - far - velocity * delay;
            if let Some(passed) = passage(&places, index, target, velocity) {
                let behind_s = time - passed - delay;
                // The time of a switching is known to half that between two samples: its place to that times the velocity.
                let switching = Switching {
                    velocity,
                    distance: velocity * behind_s,
                    weight: 1.0 / (velocity * velocity),
                };
                let (within_s, every_s) = ((to.0 - from.0) / 2.0, every / velocity.abs());
                let (line, group, on) = (after.line, *group, *is);
                let noise_s = noise / velocity.abs();
                seen.push(Seen {
                    line,
                    group,
                    on,
                    behind_s,
                    within_s,
                    every_s,
                    noise_s,
                    switching,
                });
            }
        }
    }
    seen
}

/// When the master passed `target` last, in the direction of `velocity`, before the sample behind `index`; else when it does next.
fn passage(places: &[(f64, f64)], index: usize, target: f64, velocity: f64) -> Option<f64> {
    let beyond = |place: f64| (place - target) * velocity.signum() >= 0.0;
    let crosses = |pair: &&[(f64, f64)]| !beyond(pair[0].1) && beyond(pair[1].1);
    let before = places.get(..index + 2)?.windows(2).rev().find(crosses);
    let pair = before.or_else(|| places.get(index..)?.windows(2).find(crosses))?;
    let share = (target - pair[0].1) / (pair[1].1 - pair[0].1);
    Some(pair[0].0 + share * (pair[1].0 - pair[0].0))
}

/// The nearest tappet that switches so.
struct Nearest {
    /// How far behind it a place is, u.
    far: f64,
    /// Its own delay, s.
    delay: f64,
    /// Way between two of its kind, on an average, u.
    every: f64,
}

/// The nearest tappet of a group that switches so.
fn nearest(
    file: &CamFile,
    using: &CamUse,
    (group, on): (i16, bool),
    place: f64,
    velocity: f64,
) -> Option<Nearest> {
    let curve = file.cam.curve();
    let width = curve.end() - curve.start();
    let behind = |tappet: &Tappet| {
        let delay = match (tappet.action, on) {
            (Action::On | Action::Invert, true) | (Action::Off | Action::Invert, false) => 0.0,
            #[expect(clippy::cast_precision_loss, reason = "a day at most")]
            (Action::Timed { delay_ns, .. }, true) => delay_ns as f64 * 1e-9,
            _ => return None,
        };
        let passes = match tappet.passage {
            Passage::Every => true,
            Passage::Positive => velocity > 0.0,
            Passage::Negative => velocity < 0.0,
        };
        let far = place - tappet.master - velocity * delay;
        let far = if using.repeated { far - (far / width).round() * width } else { far };
        passes.then_some((far, delay))
    };
    let tappets = file.cam.tappets().iter().filter(|tappet| tappet.group == group);
    let all: Vec<_> = tappets.filter_map(behind).collect();
    #[expect(clippy::cast_precision_loss, reason = "a count of tappets")]
    let every = width / all.len().max(1) as f64;
    let (far, delay) = all.into_iter().min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
    Some(Nearest { far, delay, every })
}

/// A switching that is farther from the median of all than this many times what they are usually apart is no noise.
const OUTLIER: f64 = 10.0;

/// Of the time from one tappet to the next of its kind: a dead time that is longer, or known worse, is not told from other
/// tappets, from an inverted output, or from switchings at random.
const TOLD_APART: [f64; 2] = [0.25, 0.1];

/// The dead time of what tappets switch, the compensation in use included: what `DeadTimeCompensation` should be.
/// `between_s` is the time between two samples.
///
/// A switching is known to half the time between two samples. Where samples come in step with the cam the error is the same
/// each time, so this half is added to what the scatter of the switchings says, and never divided by their number.
///
/// # Errors
/// [`TuneError::DeadTime`] if too few switchings were seen, [`TuneError::Outlier`] if one of them has nothing to do with the
/// others, [`TuneError::Output`] if they contradict each other or come at random, [`TuneError::Scattered`],
/// [`TuneError::Early`] and [`TuneError::Late`] if none has to do with the tappets.
pub fn tappet_dead_time(
    using: &CamUse,
    seen: &[Seen],
    between_s: f64,
) -> Result<DeadTime, TuneError> {
    let all: Vec<_> = seen.iter().map(|seen| seen.switching).collect();
    let found = dead_time(&all, false).map_err(TuneError::DeadTime)?;
    let middle = median(seen.iter().map(|seen| seen.behind_s).collect());
    let apart = median(seen.iter().map(|seen| (seen.behind_s - middle).abs()).collect());
    // Samples alone make switchings differ by this much.
    let usual = apart.max(between_s / 4.0);
    let far = |seen: &&Seen| (seen.behind_s - middle).abs() > OUTLIER * usual;
    let near = Usual::of(seen.iter().filter(|one| !far(one)).map(|one| one.behind_s), between_s);
    if let Some(outlier) = seen.iter().find(|one| far(one) && near.is_far(one.behind_s)) {
        // A heap of them is no accident of one.
        refuse_contradictory(seen)?;
        let (line, behind_s) = (outlier.line, outlier.behind_s);
        return Err(TuneError::Outlier { line, behind_s, usual_s: middle });
    }
    let count = seen.len();
    #[expect(clippy::cast_precision_loss, reason = "a count of switchings")]
    let sampling = seen.iter().map(|seen| seen.within_s).sum::<f64>() / count.max(1) as f64;
    let half_width = found.dead_time_s.half_width + sampling;
    let value = found.dead_time_s.value + using.coupling.dead_time_s;
    let every_s = median(seen.iter().map(|seen| seen.every_s).collect());
    let [longest, widest] = TOLD_APART.map(|part| part * every_s);
    // What samples cannot tell better is no scatter: half of them at one end of what they leave open, half at the other.
    #[expect(clippy::cast_precision_loss, reason = "a count of switchings")]
    let open = sampling * (student_975(count - 1) / ((count - 1) as f64).sqrt()).max(2.0);
    if found.dead_time_s.half_width > widest.max(open) {
        return Err(TuneError::Scattered { count, half_width_s: half_width, every_s });
    }
    refuse_random(seen)?;
    refuse_contradictory(seen)?;
    if value < -half_width {
        return Err(TuneError::Early { value_s: value, half_width_s: half_width });
    }
    if found.dead_time_s.value.abs() > longest.max(half_width) {
        return Err(TuneError::Late { value_s: found.dead_time_s.value, every_s });
    }
    Ok(DeadTime { dead_time_s: Estimate { value, half_width }, ..found })
}

/// How switchings are that are near each other.
struct Usual {
    count: f64,
    mean: f64,
    /// By how much one of them is beside the mean, standard deviation, s.
    apart: f64,
}

impl Usual {
    fn of(near: impl Iterator<Item = f64> + Clone, between_s: f64) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a count of switchings")]
        let count = near.clone().count() as f64;
        let mean = near.clone().sum::<f64>() / count;
        let square = near.map(|one| (one - mean).powi(2)).sum::<f64>() / (count - 1.0);
        // Anywhere between two samples has this variance.
        let apart = (square.max(between_s * between_s / 12.0) * (1.0 + 1.0 / count)).sqrt();
        Self { count, mean, apart }
    }

    /// Whether a switching is none of these by Student's t, however few they are: the median of few says little of how they
    /// scatter.
    fn is_far(&self, behind_s: f64) -> bool {
        let Self { count, mean, apart } = self;
        *count >= 2.0
            && student_exceeds((behind_s - mean) / apart, count - 1.0) * (count + 1.0) < CHANCE
    }
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}
