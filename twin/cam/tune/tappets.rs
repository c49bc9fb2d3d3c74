//! The dead time of a run's outputs, and whether tappets can have switched them: outputs that contradict each other, or that
//! something else switches, are told.

use super::super::CamFile;
use super::super::check::CamUse;
use super::super::run::RecordedRun;
use super::TuneError;
use super::from_run::{Seen, median, switchings, tappet_dead_time};
use super::tappet_error::{OutputError, Part, SwitchingPart};
use twin_motion::cam::tune::{DeadTime, student_exceeds};
use twin_motion::cam::{Action, Passage, Tappet};

/// What noise does in one run of so many is told.
const CHANCE: f64 = 1e-4;
/// Switchings at random are taken for those of tappets in one run of so many.
const AT_RANDOM: f64 = 1e-3;
/// Switchings scatter by this part of the time from one tappet to the next at most.
const SCATTER: f64 = 0.1;
/// With so many switchings each part has a scatter of its own.
const OWN_SCATTER: f64 = 5.0;
/// Outputs may switch so many times more than the tappets that were passed say: of two the run has not shown the passage.
const PENDING: usize = 2;

/// The dead time that a run's outputs tell, and of how many switchings.
///
/// # Errors
/// [`TuneError::Output`] if tappets cannot have switched an output so, and as [`tappet_dead_time`].
pub fn run_dead_time(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
) -> Result<(DeadTime, usize), TuneError> {
    let mut has: Vec<_> = file.cam.tappets().iter().map(|tappet| tappet.group).collect();
    has.sort_unstable();
    has.dedup();
    if let Some(group) = run.groups.iter().find(|group| !has.contains(group)) {
        return Err(OutputError::NoGroup { group: *group, has }.into());
    }
    let counted =
        (0..run.groups.len()).try_for_each(|output| refuse_count(file, using, run, output));
    let seen = switchings(file, using, run);
    match (tappet_dead_time(using, &seen, run.between_s()), counted) {
        // A line of the run says more.
        (Err(outlier @ TuneError::Outlier { .. }), _) => Err(outlier),
        (_, Err(count)) => Err(count.into()),
        (found, Ok(())) => Ok((found?, seen.len())),
    }
}

/// Switchings that lie no closer together than those at random do.
///
/// At random they are anywhere between two tappets. That all n of them lie within the part w of the way from one to the next,
/// wherever, has the chance n·wⁿ⁻¹ (points on a circle, Stevens 1939).
pub(super) fn refuse_random(seen: &[Seen]) -> Result<(), OutputError> {
    let mut groups: Vec<_> = seen.iter().map(|seen| seen.group).collect();
    groups.sort_unstable();
    groups.dedup();
    for group in groups {
        let of_group: Vec<_> = seen.iter().filter(|seen| seen.group == group).collect();
        let part = SwitchingPart::new(Part::Group(group), &of_group);
        let count = of_group.len();
        if count < 3 {
            continue;
        }
        let every_s = median(of_group.iter().map(|seen| seen.every_s).collect());
        let ends = of_group.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], seen| {
            [low.min(seen.behind_s), high.max(seen.behind_s)]
        });
        let within = (ends[1] - ends[0]) / every_s;
        let chance = part.count * within.powf(part.count - 1.0);
        let scatter_s = (part.square / (part.count - 1.0)).sqrt();
        // What samples cannot tell better is no scatter.
        if chance > AT_RANDOM || scatter_s > (SCATTER * every_s).max(part.within_s) {
            return Err(OutputError::Random { group, count, ends, every_s });
        }
    }
    Ok(())
}

/// Groups, edges of one group, halves of the run and heaps of switchings that have different dead times.
///
/// Means are compared by Student's t with the scatter of all parts together (that few switchings tell better) and, of many,
/// by Welch's with their own. Samples may have shifted each mean by half the time between two, which is no difference.
pub(super) fn refuse_contradictory(seen: &[Seen]) -> Result<(), OutputError> {
    let part = |which, of: &dyn Fn(&Seen) -> bool| {
        SwitchingPart::new(which, &seen.iter().filter(|seen| of(seen)).collect::<Vec<_>>())
    };
    let mut groups: Vec<_> = seen.iter().map(|seen| seen.group).collect();
    groups.sort_unstable();
    groups.dedup();
    let of_groups: Vec<_> =
        groups.iter().map(|group| part(Part::Group(*group), &|s| s.group == *group)).collect();
    refuse_apart(&of_groups)?;
    for group in groups {
        let edges = [(Part::On(group), true), (Part::Off(group), false)];
        let edges = edges.map(|(which, on)| part(which, &|s| s.group == group && s.on == on));
        refuse_apart(&edges)?;
    }
    let middle = median_line(seen);
    refuse_apart(&[
        part(Part::First, &|s| s.line <= middle),
        part(Part::Second, &|s| s.line > middle),
    ])?;
    refuse_heaps(seen)
}

fn median_line(seen: &[Seen]) -> u64 {
    let mut lines: Vec<_> = seen.iter().map(|seen| seen.line).collect();
    lines.sort_unstable();
    lines.get(lines.len().saturating_sub(1) / 2).copied().unwrap_or_default()
}

fn refuse_apart(parts: &[SwitchingPart]) -> Result<(), OutputError> {
    let square: f64 = parts.iter().map(|part| part.square).sum();
    let freedom: f64 = parts.iter().map(|part| (part.count - 1.0).max(0.0)).sum();
    for (index, one) in parts.iter().enumerate() {
        for other in parts.iter().skip(index + 1) {
            if one.count < 1.0 || other.count < 1.0 || freedom < 1.0 {
                continue;
            }
            let by = (one.mean_s - other.mean_s).abs();
            let by = by - (one.within_s + other.within_s) * (1.0 + 1e-6);
            if by <= 0.0 {
                continue;
            }
            let pooled = (square / freedom * (1.0 / one.count + 1.0 / other.count)).sqrt();
            let mut chance = student_exceeds(by / pooled, freedom);
            if one.count >= OWN_SCATTER && other.count >= OWN_SCATTER {
                chance = chance.max(welch(one, other, by));
            }
            if chance < CHANCE {
                return Err(OutputError::Contradictory { one: *one, other: *other });
            }
        }
    }
    Ok(())
}

/// How likely two means are so far apart by chance, each with its own scatter (Welch 1947, with Satterthwaite's freedom).
fn welch(one: &SwitchingPart, other: &SwitchingPart, by: f64) -> f64 {
    let [a, b] = [one, other].map(|part| part.square / (part.count - 1.0) / part.count);
    if a + b <= 0.0 {
        return 0.0;
    }
    let freedom = (a + b).powi(2)
        / (a * a / (one.count - 1.0) + b * b / (other.count - 1.0)).max(f64::MIN_POSITIVE);
    student_exceeds(by / (a + b).sqrt(), freedom)
}

/// Switchings in two heaps with nothing between, far apart for how wide they are.
fn refuse_heaps(seen: &[Seen]) -> Result<(), OutputError> {
    const LEAST: usize = 3;
    const APART: f64 = 10.0;
    let mut sorted: Vec<_> = seen.iter().collect();
    sorted.sort_by(|one, other| one.behind_s.total_cmp(&other.behind_s));
    let gap = |index: usize| match sorted.get(index - 1..=index) {
        Some([one, other]) => other.behind_s - one.behind_s,
        _ => 0.0,
    };
    let places = LEAST..sorted.len().saturating_sub(LEAST - 1);
    let Some(at) = places.max_by(|one, other| gap(*one).total_cmp(&gap(*other))) else {
        return Ok(());
    };
    let (early, late) = sorted.split_at(at);
    let one = SwitchingPart::new(Part::Early, early);
    let other = SwitchingPart::new(Part::Late, late);
    let scatter = ((one.square + other.square) / (one.count + other.count - 2.0)).sqrt();
    let told = sorted.len() > 2 * LEAST
        && gap(at) > 2.0 * (one.within_s + other.within_s)
        && gap(at) > APART * scatter;
    if told { Err(OutputError::Contradictory { one, other }) } else { Ok(()) }
}

/// How often an output may have switched: what the tappets that the master passed say, one after the other.
struct Passed {
    /// Tappets of the group that were passed.
    tappets: usize,
    /// Changes of the bit.
    changes: usize,
    /// Changes from one sample to the next.
    shown: usize,
    /// Whether a pulse is among them, whose end is a matter of time.
    timed: bool,
}

fn refuse_count(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
    output: usize,
) -> Result<(), OutputError> {
    let Some(group) = run.groups.get(output).copied() else { return Ok(()) };
    let value = |index: usize| {
        run.samples.get(index).and_then(|sample| sample.outputs.get(output)).copied()
    };
    let count = (1..run.samples.len()).filter(|index| value(index - 1) != value(*index)).count();
    let passed = passed(file, using, run, group, value(0).unwrap_or_default());
    if count > passed.changes + PENDING {
        let Passed { tappets, changes, .. } = passed;
        return Err(OutputError::TooOften { group, count, tappets, changes });
    }
    // Where half of what was to be seen is not, something else decides.
    if !passed.timed && 2 * count + PENDING < passed.shown {
        let Passed { tappets, shown, .. } = passed;
        return Err(OutputError::TooRare { group, count, tappets, changes: shown });
    }
    Ok(())
}

fn passed(file: &CamFile, using: &CamUse, run: &RecordedRun, group: i16, begin: bool) -> Passed {
    let input = &using.coupling.input;
    let curve = file.cam.curve();
    let width = curve.end() - curve.start();
    let tappets: Vec<&Tappet> =
        file.cam.tappets().iter().filter(|tappet| tappet.group == group).collect();
    let place = |master: f64| master * input.master_scaling + input.master_offset;
    let mut found = Passed { tappets: 0, changes: 0, shown: 0, timed: false };
    let mut on = begin;
    for pair in run.samples.windows(2) {
        let [from, to] = pair else { continue };
        let (from, to) = (place(from.master), place(to.master));
        let forwards = to > from;
        let before = on;
        let mut crossed: Vec<(f64, Action)> = Vec::new();
        for tappet in &tappets {
            let passes = match tappet.passage {
                Passage::Every => true,
                Passage::Positive => forwards,
                Passage::Negative => !forwards,
            };
            if !passes || (from - to).abs() > MOST_PASSES * width {
                continue;
            }
            if !using.repeated {
                if (from < tappet.master) != (to < tappet.master) {
                    crossed.push((tappet.master, tappet.action));
                }
                continue;
            }
            let passes = |at: f64| ((at - tappet.master) / width).floor();
            let (mut pass, last) = (passes(from.min(to)) + 1.0, passes(from.max(to)));
            while pass <= last {
                crossed.push((tappet.master + pass * width, tappet.action));
                let next = pass + 1.0;
                // So far away no number tells one pass from the next.
                if next <= pass {
                    break;
                }
                pass = next;
            }
        }
        crossed.sort_by(|one, other| one.0.total_cmp(&other.0));
        if !forwards {
            crossed.reverse();
        }
        found.tappets += crossed.len();
        for (_, action) in crossed {
            let next = match action {
                Action::On => true,
                Action::Off => false,
                Action::Invert => !on,
                Action::Timed { .. } => {
                    (found.timed, found.changes) = (true, found.changes + 2);
                    on
                }
            };
            found.changes += usize::from(next != on);
            on = next;
        }
        found.shown += usize::from(before != on);
    }
    found
}

/// More passes from one sample to the next say nothing of tappets.
const MOST_PASSES: f64 = 2.0;
