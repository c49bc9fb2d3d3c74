//! Offsets and scalings within the limits of the slave: with the least error of a slave that was recorded, or with the least
//! change.

use super::super::CamFile;
use super::super::check::{CamCheck, CamUse};
use super::super::run::RecordedRun;
use super::correct::{Deviation, of_coupling, wanted, with_exactly, with_values};
use super::{TuneError, errors, rms, same};
use crate::finding::{Finding, Rule, Severity};
use crate::number::significant;
use twin_motion::cam::file::clean;
use twin_motion::cam::tune::{
    Bound, BoundedWish, Estimate, Fit, Free, GentleError, Sample, bounded, nearest,
};

/// What the limits of the slave left of what a run tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Limited {
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` that were proposed without limits.
    pub without: [f64; 4],
    /// Those within them.
    pub values: [f64; 4],
    /// What holds each of them.
    pub held: [Vec<Bound>; 4],
    /// What the slave does with what is proposed, if it was measured.
    pub does: CamUse,
    /// What is left of its error, root mean square, u; its noise comes on top if it was measured.
    pub left: f64,
    /// What was left of it without limits.
    pub otherwise: f64,
}

/// What a run tells, before the limits.
#[derive(Clone, Copy, Debug)]
pub struct Told<'a> {
    /// The coupling that was in effect.
    pub before: &'a CamUse,
    /// What is proposed without limits.
    pub proposed: &'a CamUse,
    /// What was found in the run.
    pub fit: &'a Fit,
    /// How the slave deviates, if it was measured; else the run is the motion wanted.
    pub deviation: Option<&'a Deviation>,
    /// Within which part of itself `MasterScaling` has to stay, if that was said.
    pub scaling_range: Option<f64>,
}

/// What keeps the limits without a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Within {
    /// The nearest offsets and scalings.
    pub using: CamUse,
    /// What holds `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`.
    pub held: [Vec<Bound>; 4],
}

/// Offsets and scalings with the least error that is possible within the limits of what the slave is told, with which it can be
/// coupled; none if what is proposed does that.
///
/// # Errors
/// [`TuneError::NoRoom`] and [`TuneError::NoStart`] if nothing does.
pub fn limited(
    file: &CamFile,
    told: &Told<'_>,
    run: &RecordedRun,
    free: Free,
) -> Result<Option<(CamUse, Limited)>, TuneError> {
    let Told { before, proposed, fit, deviation, scaling_range } = *told;
    if keeps(file, proposed) {
        return Ok(None);
    }
    let target = wanted(before);
    let to_be = |master: f64| {
        let input = &target.coupling.input;
        let x = master * input.master_scaling + input.master_offset;
        let curve = file.cam.curve();
        target.slave_at(if target.repeated { curve.repeated(x) } else { curve.at(x) }.position)
    };
    // Where the slave sees the master, and what it has to be told there.
    let samples: Vec<Sample> = run
        .samples
        .iter()
        .map(|one| match deviation {
            Some(deviation) => {
                let (master, slave) =
                    (deviation.sees(one.master), deviation.told_at(to_be(one.master)));
                Sample { master, slave, weight: 1.0 }
            }
            None => Sample { master: one.master, slave: one.slave, weight: 1.0 },
        })
        .collect();
    let from = of_coupling(proposed);
    let scalings = scalings(scaling_range, before, proposed);
    let wish = BoundedWish { scalings, ..wish(file, proposed, from, free)? };
    let found = bounded(file.cam.curve(), &samples, &wish)
        .map_err(|error| no_room(file, proposed, &error))?;
    let known = [fit.master_offset, fit.master_scaling, fit.slave_offset, fit.slave_scaling];
    // What was in effect stays where the run does not tell it from what was found; values have no more digits than it tells.
    let as_it_was = |index: usize, value: f64| {
        let (Some(known), Some(old)) = (known.get(index), of_coupling(before).get(index).copied())
        else {
            return value;
        };
        if (value - old).abs() <= known.half_width { old } else { value }
    };
    let short = |index: usize, value: f64| {
        let half_width = known.get(index).map_or(0.0, |known| known.half_width);
        let held = found.held.get(index).is_some_and(|held| !held.is_empty());
        if held { clean(value) } else { super::rounded(Estimate { value, half_width }) }
    };
    let with = |change: &dyn Fn(usize, f64) -> f64| {
        let mut use_it = *proposed;
        let mut values = found.values;
        for (index, (value, from)) in values.iter_mut().zip(from).enumerate() {
            // What no limit moved is as it was proposed.
            *value = if same(*value, from) { from } else { change(index, *value) };
        }
        let input = &mut use_it.coupling.input;
        [input.master_offset, input.master_scaling, input.slave_offset, input.slave_scaling] =
            values;
        use_it
    };
    let stays = |index, value| {
        let old = as_it_was(index, value);
        if same(old, value) { short(index, value) } else { old }
    };
    let all = [with(&stays), with(&short), with(&|_, value| clean(value))];
    let kept = all.into_iter().find(|one| keeps(file, one) && in_range(&scalings, one));
    let mut after = kept.unwrap_or_else(|| with(&|_, value| value));
    after.coupling.wanted = before.coupling.wanted;
    if deviation.is_some() && after.coupling.input != before.coupling.input {
        after.coupling.wanted = Some(of_coupling(&target));
    }
    let mut does = after;
    let (left, otherwise) = match deviation {
        Some(deviation) => {
            let input = &mut does.coupling.input;
            [input.master_offset, input.master_scaling, input.slave_offset, input.slave_scaling] =
                deviation.done(of_coupling(&after));
            (distance(file, &does, &target, run), 0.0)
        }
        None => (rms(&errors(file, &after, run)), rms(&errors(file, proposed, run))),
    };
    let (values, held) = (of_coupling(&after), found.held);
    Ok(Some((after, Limited { without: from, values, held, does, left, otherwise })))
}

/// How far apart a slave is with two couplings in a run, root mean square.
fn distance(file: &CamFile, one: &CamUse, other: &CamUse, run: &RecordedRun) -> f64 {
    let pairs = errors(file, one, run).into_iter().zip(errors(file, other, run));
    let apart: Vec<_> = pairs.map(|((at, one), (_, other))| (at, other - one)).collect();
    rms(&apart)
}

/// The nearest offset and scalings with which the cam keeps the limits, at the motion of the master: those for which the sum of
/// the squares of the changes is least, of the scalings as parts of themselves, of `SlaveOffset` as a part of the stroke.
/// `scaling_range` is the part of itself within which `MasterScaling` has to stay, if that was said.
///
/// # Errors
/// [`TuneError::NoRoom`] and [`TuneError::NoStart`] if nothing does.
pub fn within_limits(
    file: &CamFile,
    using: &CamUse,
    free: Free,
    scaling_range: Option<f64>,
) -> Result<Within, TuneError> {
    let from = of_coupling(using);
    let scalings = scalings(scaling_range, using, using);
    let wish = BoundedWish { scalings, ..wish(file, using, from, free)? };
    let found = nearest(file.cam.curve(), &wish).map_err(|error| no_room(file, using, &error))?;
    let all = [with_values(using, found.values), with_exactly(using, found.values)];
    let kept = all.into_iter().find(|one| keeps(file, one) && in_range(&scalings, one));
    Ok(Within { using: kept.unwrap_or(all[1]), held: found.held })
}

/// Between what `MasterScaling` may be: within a part of what is in effect, and what is proposed without limits as well.
pub fn scalings(range: Option<f64>, before: &CamUse, proposed: &CamUse) -> [f64; 2] {
    let Some(part) = range else { return [f64::NEG_INFINITY, f64::INFINITY] };
    let [scaling, other] = [before, proposed].map(|using| using.coupling.input.master_scaling);
    let [one, two] = [1.0 - part, 1.0 + part].map(|part| part * scaling);
    [one.min(two).min(other), one.max(two).max(other)]
}

fn in_range([low, high]: &[f64; 2], using: &CamUse) -> bool {
    (*low..=*high).contains(&using.coupling.input.master_scaling)
}

fn wish(
    file: &CamFile,
    using: &CamUse,
    from: [f64; 4],
    free: Free,
) -> Result<BoundedWish, TuneError> {
    let mut position = using.limits.position;
    if let Some(rise) = using.gain(file) {
        if using.is_limited() {
            let rise = rise * using.coupling.input.slave_scaling;
            let [rise, low, high] = [rise, position[0], position[1]].map(|u| significant(u, 6));
            let why = format!("the slave gains {rise} in every pass and leaves {low} to {high}");
            return Err(TuneError::NoRoom { what: "offset or scaling", why });
        }
        // An axis without limits goes everywhere.
        position = [f64::NEG_INFINITY, f64::INFINITY];
    }
    let (limits, repeated) = (using.limits.motion, using.repeated);
    let scalings = [f64::NEG_INFINITY, f64::INFINITY];
    // Of a cam that is put end to end another pass starts wherever the master is.
    let start = using.start.filter(|_| !using.repeated);
    let master = using.master;
    Ok(BoundedWish { from, free, master, limits, position, repeated, scalings, start })
}

/// Whether a use of the cam keeps the limits of the slave's axis, and can be started, as the check has it.
fn keeps(file: &CamFile, using: &CamUse) -> bool {
    let start = using.start.filter(|_| !using.repeated);
    !CamCheck::new(file, CamUse { start, ..*using }).findings.iter().any(refuses)
}

/// Whether a finding says that what was found is of no use: the slave exceeds a limit, or is not coupled at all.
pub fn refuses(finding: &Finding) -> bool {
    exceeds(finding) || finding.severity == Severity::Error && finding.rule == Rule::Coupling
}

/// Whether a finding says that the slave exceeds a limit of its axis.
pub fn exceeds(finding: &Finding) -> bool {
    let limits = [Rule::AxisPosition, Rule::AxisVelocity, Rule::AxisAcceleration, Rule::AxisJerk];
    finding.severity == Severity::Error && limits.contains(&finding.rule)
}

pub(super) fn no_room(file: &CamFile, using: &CamUse, error: &GentleError) -> TuneError {
    if let GentleError::Contradictory {
        one: Bound::Start { master }, other: Bound::Given, ..
    } = error
    {
        let (range, unit) = (using.starts(file.cam.curve()), file.master.unit().to_owned());
        return TuneError::NoStart { master: *master, range, unit };
    }
    let GentleError::Contradictory { unknown, one, other } = error else {
        return TuneError::NoRoom { what: "offset or scaling", why: error.to_string() };
    };
    let why = if *other == Bound::Given {
        format!("{one}, is exceeded whatever it is")
    } else {
        format!("{one}, and {other}, contradict each other")
    };
    TuneError::NoRoom { what: unknown, why }
}
