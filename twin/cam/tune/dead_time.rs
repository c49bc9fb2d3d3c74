//! Dead time of tappets, from the outputs of a recorded run.
//!
//! An output that changes between two samples is taken to change half way between, and the tappet to be passed when the master, on
//! straight lines between the samples, was there. The tappet is the nearest one that switches so in the master's direction.
//! Outputs that switch at random are refused.

use super::super::check::CamUse;
use super::super::run::{RecordedRun, median};
use super::TuneError;
use super::unwrap::unwound;
use twin_cam::tune::{Estimate, student_975};
use twin_cam::{Action, Passage, Tappet};
use twin_machine::cam_file::CamFile;

/// Switchings that a dead time needs: of four at random fewer than one run in a hundred scatters as little as is accepted.
const NEEDED: usize = 4;
/// Switchings of a group scatter by this part of the time from one tappet to the next at most, standard deviation.
const SCATTER: f64 = 0.05;
/// A longer dead time, as a part of the time from one tappet to the next of its kind, may be that of another tappet or of an
/// inverted output.
const LONGEST: f64 = 0.25;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seen {
    pub(crate) group: i16,
    /// How long after the tappet it switched, s.
    pub(crate) behind_s: f64,
    /// Half the time between the samples around it, s.
    pub(crate) within_s: f64,
    /// After what time the master comes to a tappet that switches so again, s.
    pub(crate) every_s: f64,
}

/// What some switchings have in common.
struct Switchings {
    count: f64,
    /// How long after the tappet they are, the mean, s.
    mean_s: f64,
    /// Sum of the squares of their distances from it, s².
    square: f64,
    /// How far samples may have shifted the mean, s.
    within_s: f64,
}

impl Switchings {
    #[expect(clippy::needless_pass_by_value, reason = "an iterator that is read twice")]
    fn new<'a>(seen: impl Iterator<Item = &'a Seen> + Clone) -> Self {
        let sum = |of: &dyn Fn(&Seen) -> f64| seen.clone().map(of).sum::<f64>();
        let count = sum(&|_| 1.0);
        let mean_s = sum(&|seen| seen.behind_s) / count.max(1.0);
        let square = sum(&|seen| (seen.behind_s - mean_s).powi(2));
        let within_s = sum(&|seen| seen.within_s) / count.max(1.0);
        Self { count, mean_s, square, within_s }
    }
}

/// The dead time of a run's outputs, including the compensated one, and the number of switchings.
/// [`TuneError::NoGroup`] if the cam has no tappet for an output, and as [`tappet_dead_time`].
pub(crate) fn run_dead_time(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
) -> Result<(Estimate, usize), TuneError> {
    let has = distinct(file.cam.tappets().iter().map(|tappet| tappet.group));
    if let Some(group) = run.groups.iter().find(|group| !has.contains(group)) {
        return Err(TuneError::NoGroup { group: *group, has });
    }
    let run = &*unwound(file, using, run, None).run;
    let seen = switchings(file, using, run);
    Ok((tappet_dead_time(using, &seen)?, seen.len()))
}

fn distinct(groups: impl Iterator<Item = i16>) -> Vec<i16> {
    let mut groups: Vec<_> = groups.collect();
    groups.sort_unstable();
    groups.dedup();
    groups
}

/// The switchings of a run whose master is unwrapped ([`super::unwound`]).
pub(crate) fn switchings(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Vec<Seen> {
    let input = &using.coupling.input;
    let place = |master: f64| master * input.master_scaling + input.master_offset;
    let places: Vec<_> = run.samples.iter().map(|one| [one.time_s, place(one.master)]).collect();
    let mut seen = Vec::new();
    for (index, pair) in run.samples.windows(2).enumerate() {
        let [from, to] = [places[index], places[index + 1]];
        let velocity =
            f64::midpoint(run.velocity(index), run.velocity(index + 1)) * input.master_scaling;
        if velocity == 0.0 || !velocity.is_finite() {
            continue;
        }
        let [time, place] = [0, 1].map(|index: usize| f64::midpoint(from[index], to[index]));
        let outputs = run.groups.iter().zip(pair[0].outputs.iter().zip(&pair[1].outputs));
        for (group, (_, on)) in outputs.filter(|(_, (was, is))| was != is) {
            let nearest = nearest(file, using, (*group, *on), place, velocity);
            // Between samples that are so far apart any tappet may have switched it.
            let Some([far, delay, every]) =
                nearest.filter(|[.., every]| (to[1] - from[1]).abs() < *every)
            else {
                continue;
            };
            let target = place - far - velocity * delay;
            let Some(passed) = passage(&places, index, target, velocity) else { continue };
            seen.push(Seen {
                group: *group,
                behind_s: time - passed - delay,
                within_s: (to[0] - from[0]) / 2.0,
                every_s: every / velocity.abs(),
            });
        }
    }
    seen
}

/// When the master passed `target` last, in the direction of `velocity`, before the sample behind `index`; else when it does next.
fn passage(places: &[[f64; 2]], index: usize, target: f64, velocity: f64) -> Option<f64> {
    let beyond = |place: f64| (place - target) * velocity.signum() >= 0.0;
    let crosses = |pair: &&[[f64; 2]]| !beyond(pair[0][1]) && beyond(pair[1][1]);
    let before = places.get(..index + 2)?.windows(2).rev().find(crosses);
    let pair = before.or_else(|| places.get(index..)?.windows(2).find(crosses))?;
    let share = (target - pair[0][1]) / (pair[1][1] - pair[0][1]);
    Some(pair[0][0] + share * (pair[1][0] - pair[0][0]))
}

/// How far a place is behind the nearest tappet that switches so, u, its own delay, s, and the way between two of its kind, u.
fn nearest(
    file: &CamFile,
    using: &CamUse,
    (group, on): (i16, bool),
    place: f64,
    velocity: f64,
) -> Option<[f64; 3]> {
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
    Some([far, delay, every])
}

/// The dead time of switchings, including the compensated one: the value for `DeadTimeCompensation`.
///
/// A switching is known to half the time between two samples. Where samples come in step with the cam the error is the same
/// each time, so this half is added to the interval of the scatter, and never divided by the number of switchings.
/// [`TuneError`] if there are too few switchings, or they come at random or have nothing to do with the tappets.
pub(crate) fn tappet_dead_time(using: &CamUse, seen: &[Seen]) -> Result<Estimate, TuneError> {
    let count = seen.len();
    if count < NEEDED {
        return Err(TuneError::FewSwitchings { found: count, needed: NEEDED });
    }
    let all = Switchings::new(seen.iter());
    let t = student_975(count - 1);
    let scatter = t * (all.square / (all.count - 1.0) / all.count).sqrt();
    let half_width = scatter + all.within_s;
    let value = all.mean_s + using.coupling.dead_time_s;
    refuse_scattered(seen)?;
    if value < -half_width {
        return Err(TuneError::Early { value_s: value, half_width_s: half_width });
    }
    let every_s = median(seen.iter().map(|seen| seen.every_s).collect());
    if all.mean_s.abs() > (LONGEST * every_s).max(half_width) {
        return Err(TuneError::Late { value_s: all.mean_s, every_s });
    }
    Ok(Estimate { value, half_width })
}

/// Refuses a group whose switchings scatter too widely: they may come at random.
fn refuse_scattered(seen: &[Seen]) -> Result<(), TuneError> {
    for group in distinct(seen.iter().map(|seen| seen.group)) {
        let of_group = seen.iter().filter(|seen| seen.group == group);
        let every_s = median(of_group.clone().map(|seen| seen.every_s).collect());
        let Switchings { count, square, .. } = Switchings::new(of_group);
        let scatter_s = (square / (count - 1.0).max(1.0)).sqrt();
        if scatter_s > SCATTER * every_s {
            return Err(TuneError::Scattered { group, count, scatter_s, every_s });
        }
    }
    Ok(())
}
