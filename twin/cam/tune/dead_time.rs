//! Dead time of tappets, from the outputs of a recorded run.
//!
//! An output that changes between two samples is taken to change half way between, and the tappet to be passed when the master, on
//! straight lines between the samples, was there. The tappet is the nearest one that switches so in the master's direction.
//! Outputs that contradict each other, or that switch at random, are refused.

use super::super::check::CamUse;
use super::super::run::{RecordedRun, median};
use super::TuneError;
use super::unwrap::unwound;
use std::fmt;
use twin_cam::tune::{Estimate, student_975, student_exceeds};
use twin_cam::{Action, Passage, Tappet};
use twin_machine::cam_file::CamFile;
use twin_number::significant;

/// Switchings that a dead time needs: of four at random fewer than one run in a hundred scatters as little as is accepted.
const NEEDED: usize = 4;
/// Switchings of a group scatter by this part of the time from one tappet to the next at most, standard deviation.
const SCATTER: f64 = 0.05;
/// Probability with which noise alone is refused.
const CHANCE: f64 = 1e-4;
/// A switching that is farther from the median of all than this many times their usual distance is suspect.
const OUTLIER: f64 = 10.0;
/// A longer dead time, as a part of the time from one tappet to the next of its kind, may be that of another tappet or of an
/// inverted output.
const LONGEST: f64 = 0.25;
/// Switchings that each of two heaps has at least, and the gap between them in times of their scatter.
const HEAP: usize = 4;
const APART: f64 = 10.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seen {
    /// The line of the run in which the output had switched.
    pub(crate) line: u64,
    pub(crate) group: i16,
    pub(crate) on: bool,
    /// How long after the tappet it switched, s.
    pub(crate) behind_s: f64,
    /// Half the time between the samples around it, s.
    pub(crate) within_s: f64,
    /// After what time the master comes to a tappet that switches so again, s.
    pub(crate) every_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    All,
    Group(i16),
    On(i16),
    Off(i16),
    First,
    Second,
    Early,
    Late,
}

/// What a part of the switchings has in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SwitchingPart {
    pub(crate) which: Part,
    pub(crate) count: f64,
    /// How long after the tappet they are, the mean, s.
    pub(crate) mean_s: f64,
    /// Sum of the squares of their distances from it, s².
    pub(crate) square: f64,
    /// How far samples may have shifted the mean, s.
    pub(crate) within_s: f64,
}

impl SwitchingPart {
    #[expect(clippy::needless_pass_by_value, reason = "an iterator that is read twice")]
    fn new<'a>(which: Part, seen: impl Iterator<Item = &'a Seen> + Clone) -> Self {
        let sum = |of: &dyn Fn(&Seen) -> f64| seen.clone().map(of).sum::<f64>();
        let count = sum(&|_| 1.0);
        let mean_s = sum(&|seen| seen.behind_s) / count.max(1.0);
        let square = sum(&|seen| (seen.behind_s - mean_s).powi(2));
        let within_s = sum(&|seen| seen.within_s) / count.max(1.0);
        Self { which, count, mean_s, square, within_s }
    }
}

impl fmt::Display for SwitchingPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { which, count, mean_s, .. } = self;
        let which = match which {
            Part::All => "outputs switch".to_owned(),
            Part::Group(group) => format!("group {group} switches"),
            Part::On(group) => format!("group {group} switches on"),
            Part::Off(group) => format!("group {group} switches off"),
            Part::First => "in the first half of the run outputs switch".to_owned(),
            Part::Second => "in the second half they switch".to_owned(),
            Part::Early => "some outputs switch".to_owned(),
            Part::Late => "others switch".to_owned(),
        };
        let plural = if *count > 1.0 { "switchings" } else { "switching" };
        write!(f, "{which} {} s behind its tappets ({count} {plural})", significant(*mean_s, 4))
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
    Ok((tappet_dead_time(using, &seen, run.between_s())?, seen.len()))
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
                line: pair[1].line,
                group: *group,
                on: *on,
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

/// The dead time of switchings, including the compensated one: the value for `DeadTimeCompensation`. `between_s` is the time between
/// two samples.
///
/// A switching is known to half the time between two samples. Where samples come in step with the cam the error is the same
/// each time, so this half is added to the interval of the scatter, and never divided by the number of switchings.
/// [`TuneError`] if there are too few switchings, they contradict each other, come at random or have nothing to do with the tappets.
pub(crate) fn tappet_dead_time(
    using: &CamUse,
    seen: &[Seen],
    between_s: f64,
) -> Result<Estimate, TuneError> {
    let count = seen.len();
    if count < NEEDED {
        return Err(TuneError::FewSwitchings { found: count, needed: NEEDED });
    }
    let all = SwitchingPart::new(Part::All, seen.iter());
    let t = student_975(count - 1);
    let scatter = t * (all.square / (all.count - 1.0) / all.count).sqrt();
    refuse_outlier(seen, between_s)?;
    let half_width = scatter + all.within_s;
    let value = all.mean_s + using.coupling.dead_time_s;
    refuse_scattered(seen)?;
    refuse_contradictory(seen)?;
    if value < -half_width {
        return Err(TuneError::Early { value_s: value, half_width_s: half_width });
    }
    let every_s = median(seen.iter().map(|seen| seen.every_s).collect());
    if all.mean_s.abs() > (LONGEST * every_s).max(half_width) {
        return Err(TuneError::Late { value_s: all.mean_s, every_s });
    }
    Ok(Estimate { value, half_width })
}

/// Refuses a switching that is far from the others, by Student's t.
fn refuse_outlier(seen: &[Seen], between_s: f64) -> Result<(), TuneError> {
    let middle = median(seen.iter().map(|seen| seen.behind_s).collect());
    let apart = |seen: &Seen| (seen.behind_s - middle).abs();
    // Samples alone make switchings differ by a quarter of the time between two.
    let usual = median(seen.iter().map(apart).collect()).max(between_s / 4.0);
    let far = |seen: &&Seen| apart(seen) > OUTLIER * usual;
    let near = SwitchingPart::new(Part::All, seen.iter().filter(|one| !far(one)));
    // Anywhere between two samples has this variance.
    let variance = (near.square / (near.count - 1.0)).max(between_s * between_s / 12.0);
    let deviation = (variance * (1.0 + 1.0 / near.count)).sqrt();
    let is_none = |one: &&Seen| {
        let chance = student_exceeds((one.behind_s - near.mean_s) / deviation, near.count - 1.0);
        near.count >= 2.0 && chance * (near.count + 1.0) < CHANCE
    };
    let Some(one) = seen.iter().filter(far).find(is_none) else { return Ok(()) };
    // Those of another group, or of another edge, are not one accident.
    refuse_contradictory(seen)?;
    Err(TuneError::Outlier { line: one.line, behind_s: one.behind_s, usual_s: middle })
}

/// Refuses a group whose switchings scatter too widely: they may come at random.
fn refuse_scattered(seen: &[Seen]) -> Result<(), TuneError> {
    for group in distinct(seen.iter().map(|seen| seen.group)) {
        let of_group = seen.iter().filter(|seen| seen.group == group);
        let every_s = median(of_group.clone().map(|seen| seen.every_s).collect());
        let SwitchingPart { count, square, .. } = SwitchingPart::new(Part::Group(group), of_group);
        let scatter_s = (square / (count - 1.0).max(1.0)).sqrt();
        if scatter_s > SCATTER * every_s {
            return Err(TuneError::Scattered { group, count, scatter_s, every_s });
        }
    }
    Ok(())
}

/// Refuses groups, edges of one group, halves of the run and heaps of switchings that have different dead times.
fn refuse_contradictory(seen: &[Seen]) -> Result<(), TuneError> {
    let part =
        |which, of: &dyn Fn(&&Seen) -> bool| SwitchingPart::new(which, seen.iter().filter(of));
    let groups = distinct(seen.iter().map(|seen| seen.group));
    let of_groups: Vec<_> =
        groups.iter().map(|group| part(Part::Group(*group), &|s| s.group == *group)).collect();
    refuse_apart(&of_groups)?;
    for group in groups {
        let edges = [(Part::On(group), true), (Part::Off(group), false)];
        refuse_apart(&edges.map(|(which, on)| part(which, &|s| s.group == group && s.on == on)))?;
    }
    let mut lines: Vec<_> = seen.iter().map(|seen| seen.line).collect();
    lines.sort_unstable();
    let middle = lines.get(lines.len().saturating_sub(1) / 2).copied().unwrap_or_default();
    refuse_apart(&[
        part(Part::First, &|s| s.line <= middle),
        part(Part::Second, &|s| s.line > middle),
    ])?;
    refuse_heaps(seen)
}

/// Compares means by Student's t with the scatter of all parts together. Samples may have shifted each mean by half the time between
/// two, which does not count.
fn refuse_apart(parts: &[SwitchingPart]) -> Result<(), TuneError> {
    // Samples may hide scatter: anywhere between two of them has this variance.
    let hidden = |part: &SwitchingPart| part.within_s * part.within_s / 3.0;
    let scatter = |part: &SwitchingPart| part.square.max((part.count - 1.0) * hidden(part));
    let square: f64 = parts.iter().map(scatter).sum();
    let freedom: f64 = parts.iter().map(|part| (part.count - 1.0).max(0.0)).sum();
    for (index, one) in parts.iter().enumerate() {
        for other in parts.iter().skip(index + 1) {
            let within = (one.within_s + other.within_s) * (1.0 + 1e-6);
            let by = (one.mean_s - other.mean_s).abs() - within;
            let pooled = (square / freedom * (1.0 / one.count + 1.0 / other.count)).sqrt();
            let compares = one.count >= 1.0 && other.count >= 1.0 && freedom >= 1.0 && by > 0.0;
            if compares && student_exceeds(by / pooled, freedom) < CHANCE {
                return Err(TuneError::TwoDeadTimes { one: *one, other: *other });
            }
        }
    }
    Ok(())
}

/// Refuses switchings in two heaps with nothing between, far apart for how wide they are.
fn refuse_heaps(seen: &[Seen]) -> Result<(), TuneError> {
    let mut sorted = seen.to_vec();
    sorted.sort_by(|one, other| one.behind_s.total_cmp(&other.behind_s));
    let gap = |at: &usize| sorted[*at].behind_s - sorted[at - 1].behind_s;
    let places = HEAP..(sorted.len() + 1).saturating_sub(HEAP);
    let Some(at) = places.max_by(|one, other| gap(one).total_cmp(&gap(other))) else {
        return Ok(());
    };
    let one = SwitchingPart::new(Part::Early, sorted[..at].iter());
    let other = SwitchingPart::new(Part::Late, sorted[at..].iter());
    let scatter = ((one.square + other.square) / (one.count + other.count - 2.0)).sqrt();
    let two = gap(&at) > 2.0 * (one.within_s + other.within_s) && gap(&at) > APART * scatter;
    if two { Err(TuneError::TwoDeadTimes { one, other }) } else { Ok(()) }
}
