//! The dead time of a run's outputs, and whether tappets can have switched them: outputs that contradict each other, or that
//! something else switches, are told.

use super::super::check::CamUse;
use super::super::run::RecordedRun;
use super::TuneError;
use super::from_run::{Seen, median, switchings, tappet_dead_time};
use super::tappet_error::{OutputError, Part, SwitchingPart};
use super::unwrap::unwound;
use twin_cam::tune::{DeadTime, student_exceeds};
use twin_machine::cam_file::CamFile;

/// What noise does in one run of so many is told.
pub(super) const CHANCE: f64 = 1e-4;
/// Switchings at random are taken for those of tappets in one run of so many.
const AT_RANDOM: f64 = 1e-3;
/// Switchings scatter by this part of the time from one tappet to the next at most.
const SCATTER: f64 = 0.1;
/// By this part of it, standard deviation, outputs scatter that nothing is wrong with.
const OWN: f64 = 0.01;
/// Places that random switchings keep to so often tell nothing.
const TELLING: f64 = 0.1;

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
    let run = &*unwound(file, using, run, None).run;
    let seen = switchings(file, using, run);
    Ok((tappet_dead_time(using, &seen, run.between_s())?, seen.len()))
}

/// Switchings that lie no closer together than those at random do.
///
/// At random they are anywhere between two tappets. That all n of them lie within the part w of the way from one to the next,
/// wherever, has the chance n·wⁿ⁻¹ (points on a circle, Stevens 1939). A few lie close together by chance more easily than
/// their tappets can keep them: as far apart as what is known of their instants makes them, they are no more suspicious, if
/// that would be told from chance at all.
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
        let chance = |apart_s: f64| part.count * (apart_s / every_s).powf(part.count - 1.0);
        let scatter_s = (part.square / (part.count - 1.0)).sqrt();
        let [within_s, noise_s] = [|one: &Seen| one.within_s, |one: &Seen| one.noise_s]
            .map(|of| of_group.iter().map(|one| of(one)).fold(0.0, f64::max));
        let usual_s = 2.0 * within_s + range_of(part.count) * noise_s.hypot(OWN * every_s);
        let apart_s = ends[1] - ends[0];
        let close =
            chance(apart_s) <= AT_RANDOM || (apart_s <= usual_s && chance(usual_s) <= TELLING);
        // What samples and noise cannot tell better is no scatter.
        if !close || scatter_s > (SCATTER * every_s).max(within_s + noise_s) {
            return Err(OutputError::Random { group, count, ends, every_s });
        }
    }
    Ok(())
}

/// So many times their standard deviation `count` values of normal noise lie apart at most, but in one case of 10,000: each of
/// the pairs exceeds x·√2 with a chance of less than exp(−x²/2).
fn range_of(count: f64) -> f64 {
    let pairs = count * (count - 1.0) / 2.0;
    2.0 * (pairs / CHANCE).ln().max(0.0).sqrt()
}

/// Groups, edges of one group, halves of the run and heaps of switchings that have different dead times.
///
/// Means are compared by Student's t with the scatter of all parts together. Samples may have shifted each mean by half the time between two, which is no difference.
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
    // Samples may hide scatter: anywhere between two of them has this variance.
    let hidden = |part: &SwitchingPart| part.within_s * part.within_s / 3.0;
    let scatter = |part: &SwitchingPart| part.square.max((part.count - 1.0) * hidden(part));
    let square: f64 = parts.iter().map(scatter).sum();
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
            let chance = student_exceeds(by / pooled, freedom);
            if chance < CHANCE {
                return Err(OutputError::Contradictory { one: *one, other: *other });
            }
        }
    }
    Ok(())
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
