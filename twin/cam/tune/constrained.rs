//! Offsets and scalings within limits, in the units of the axes: with the least error against a run or the motion so far, or the
//! smallest peak of the slave.

use super::super::check::{CamCheck, CamUse};
use super::super::run::RecordedRun;
use super::correction::{Deviation, of_coupling, wanted, with_exactly, with_values};
use super::{TuneError, errors, rms, same};
use crate::finding::{Finding, Rule, Severity};
use twin_cam::Quantity;
use twin_cam::file::clean;
use twin_cam::tune::{
    self as motion, Bound, ConstraintError, Constraints, Estimate, Fit, Free, Objective, Sample,
    constrained_fit,
};
use twin_machine::cam_file::CamFile;
use twin_number::significant;

/// Values that constraints have changed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Constrained {
    /// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` before.
    pub(crate) from: [f64; 4],
    /// The constraints that hold each of them.
    pub(crate) held: [Vec<Bound>; 4],
    /// The error of the slave without the constraints, root mean square, u; or its peak before, u/s² or u/s³.
    pub(crate) before: f64,
    /// The same with them.
    pub(crate) after: f64,
    /// Of which quantity the peak is; none of an error or a change.
    pub(crate) quantity: Option<Quantity>,
    /// What the slave of a run does with the proposal.
    pub(crate) does: CamUse,
}

/// What a run determines, before the limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunFit<'a> {
    /// The coupling that was in effect.
    pub(crate) before: &'a CamUse,
    pub(crate) proposed: &'a CamUse,
    /// What was found in the run.
    pub(crate) fit: &'a Fit,
    /// How the slave deviates, if it was measured; else the run is the motion wanted.
    pub(crate) deviation: Option<&'a Deviation>,
}

/// Between what `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling` may be; none for what stays.
pub(crate) type Intervals = [Option<[f64; 2]>; 4];

/// Places of a pass at which a motion is compared with the one so far.
const PASS: u32 = 360;

/// The interval of what may be anything.
pub(crate) const ANYTHING: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Offsets and scalings with the least error that is possible within the limits of the set-points; none if the proposal keeps them.
/// [`TuneError::NoRoom`] if nothing does.
pub(crate) fn limited(
    file: &CamFile,
    run_fit: &RunFit<'_>,
    run: &RecordedRun,
    free: Free,
) -> Result<Option<(CamUse, Constrained)>, TuneError> {
    let RunFit { before, proposed, fit, deviation } = *run_fit;
    if keeps(file, proposed) {
        return Ok(None);
    }
    let target = wanted(before);
    // Where the slave sees the master, and its set-point there.
    let sample = |one: &super::super::run::RunSample| match deviation {
        Some(deviation) => Sample {
            master: deviation.sees(one.master),
            slave: deviation.commanded_at(super::slave_on_cam(file, &target, one.master)),
            weight: 1.0,
        },
        None => Sample { master: one.master, slave: one.slave, weight: 1.0 },
    };
    let samples: Vec<Sample> = run.samples.iter().map(sample).collect();
    let from = of_coupling(proposed);
    let sought = free.list().map(|free| free.then_some(ANYTHING));
    let wish = wish(file, proposed, sought)?;
    let found = constrained_fit(file.cam.curve(), Objective::Error(&samples), &wish)
        .map_err(|error| no_room(&error))?;
    let old = of_coupling(before);
    let with = |change: &dyn Fn(usize, f64) -> f64| {
        let value = |index: usize| {
            let value = found.values[index];
            // What no limit moved is as it was proposed.
            if same(value, from[index]) { value } else { change(index, value) }
        };
        with_exactly(proposed, [0, 1, 2, 3].map(value))
    };
    // Values have the digits that the run determines; a value within its interval of the one in effect stays.
    let short = |index: usize, value: f64| {
        let half_width = fit.estimates[index].half_width;
        let held = !found.held[index].is_empty();
        if held { clean(value) } else { super::rounded(Estimate { value, half_width }) }
    };
    let stays = |index: usize, value: f64| {
        let known = (value - old[index]).abs() <= fit.estimates[index].half_width;
        if known { old[index] } else { short(index, value) }
    };
    let all = [with(&stays), with(&short), with(&|_, value| clean(value))];
    let kept = all.into_iter().find(|one| keeps(file, one));
    let mut after = kept.unwrap_or_else(|| with(&|_, value| value));
    after.coupling.wanted = before.coupling.wanted;
    if deviation.is_some() && after.coupling.input != before.coupling.input {
        after.coupling.wanted = Some(of_coupling(&target));
    }
    let (mut does, left, otherwise) =
        (after, rms(&errors(file, &after, run)), rms(&errors(file, proposed, run)));
    let (left, otherwise) = match deviation {
        Some(deviation) => {
            does = with_exactly(&after, deviation.done(of_coupling(&after)));
            let pairs = errors(file, &does, run).into_iter().zip(errors(file, &target, run));
            let apart: Vec<_> = pairs.map(|((at, one), (_, other))| (at, other - one)).collect();
            (rms(&apart), 0.0)
        }
        None => (left, otherwise),
    };
    let held = found.held;
    let found = Constrained { from, held, before: otherwise, after: left, quantity: None, does };
    Ok(Some((after, found)))
}

/// Offset and scalings with which the cam keeps the limits at the motion of the master, and its slave is nearest to the motion so
/// far: the least error over a pass.
/// [`TuneError::NoRoom`] if nothing keeps them.
pub(crate) fn within_limits(
    file: &CamFile,
    using: &CamUse,
    [_, sought @ ..]: Intervals,
) -> Result<(CamUse, Constrained), TuneError> {
    let [scaling, shift, factor] = sought;
    let wish = wish(file, using, [None, scaling, shift, factor])?;
    let [from, to] = using.starts(file.cam.curve());
    let sample = |index: u32| {
        let master = from + (to - from) * (f64::from(index) + 0.5) / f64::from(PASS);
        Sample { master, slave: super::slave_on_cam(file, using, master), weight: 1.0 }
    };
    let samples: Vec<_> = (0..PASS).map(sample).collect();
    let found = constrained_fit(file.cam.curve(), Objective::Error(&samples), &wish)
        .map_err(|error| no_room(&error))?;
    let clean = with_values(using, found.values);
    let after = if keeps(file, &clean) { clean } else { with_exactly(using, found.values) };
    Ok((after, of_motion(using, &after, found, None)))
}

/// Finds offsets and scalings with the smallest peak.
/// [`TuneError::Minimise`] if nothing is left, or nothing holds a scaling.
pub(crate) fn minimise(
    file: &CamFile,
    using: &CamUse,
    quantity: Quantity,
    sought: Intervals,
) -> Result<(CamUse, Constrained), TuneError> {
    let wish = Constraints {
        sought,
        limits: using.limits.motion,
        position: using.limits.position,
        ..Constraints::new(of_coupling(using), using.master, using.repeated)
    };
    let found = constrained_fit(file.cam.curve(), Objective::Peak(quantity), &wish)
        .map_err(TuneError::Minimise)?;
    let after = with_values(using, found.values);
    Ok((after, of_motion(using, &after, found, Some(quantity))))
}

fn of_motion(
    using: &CamUse,
    after: &CamUse,
    found: motion::Constrained,
    quantity: Option<Quantity>,
) -> Constrained {
    let (from, does) = (of_coupling(using), *after);
    let motion::Constrained { held, before, after, .. } = found;
    Constrained { from, held, before, after, quantity, does }
}

fn wish(file: &CamFile, using: &CamUse, sought: Intervals) -> Result<Constraints, TuneError> {
    let position = using.limits.position;
    if let Some(rise) = using.gain(file).filter(|_| using.is_limited()) {
        let rise = rise * using.coupling.input.slave_scaling;
        let [rise, low, high] = [rise, position[0], position[1]].map(|u| significant(u, 6));
        let why = format!("the slave gains {rise} in every pass and leaves {low} to {high}");
        return Err(TuneError::NoRoom { what: "offset or scaling", why });
    }
    Ok(Constraints {
        sought,
        limits: using.limits.motion,
        position,
        ..Constraints::new(of_coupling(using), using.master, using.repeated)
    })
}

/// Whether a use of the cam keeps the limits of the slave's axis, as the check has it.
fn keeps(file: &CamFile, using: &CamUse) -> bool {
    !CamCheck::new(file, *using).findings.iter().any(exceeds)
}

/// Whether a finding says that what was found is of no use: the slave exceeds a limit, or is not coupled at all.
pub(crate) fn refuses(finding: &Finding) -> bool {
    exceeds(finding) || finding.severity == Severity::Error && finding.rule == Rule::Coupling
}

/// Whether a finding says that the slave exceeds a limit of its axis.
pub(crate) fn exceeds(finding: &Finding) -> bool {
    let limits = [Rule::AxisPosition, Rule::AxisVelocity, Rule::AxisAcceleration, Rule::AxisJerk];
    finding.severity == Severity::Error && limits.contains(&finding.rule)
}

fn no_room(error: &ConstraintError) -> TuneError {
    let ConstraintError::Contradictory { unknown, one, other } = error else {
        return TuneError::NoRoom { what: "offset or scaling", why: error.to_string() };
    };
    let why = match other {
        Bound::Given => format!("{one}, is exceeded whatever it is"),
        _ => format!("{one}, and {other}, contradict each other"),
    };
    TuneError::NoRoom { what: unknown, why }
}
