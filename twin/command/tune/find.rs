//! Finds what `twin tune cam` is asked for, one thing after the other.

use super::cam::Arguments;
use super::least::intervals;
use super::report::Report;
use super::words::SlaveColumn;
use crate::cam::check::CamUse;
use crate::cam::run::RecordedRun;
use crate::cam::tune;
use crate::cam::tune::{
    Deviation, Least, RunFit, TuneError, errors, fit_run, limited, minimise, ramp_wish,
    run_dead_time, within_limits,
};
use twin_cam::file::clean;
use twin_cam::tune::{Fit, RampGoal, ramp_in};
use twin_cam::{Quantity, StartMode};
use twin_machine::cam_file::CamFile;
use twin_profile::State;

/// Within this part of itself `MasterScaling` is looked for in a run by default.
const USUAL_RANGE: f64 = 0.05;

/// Finds what the options ask for.
pub(super) fn tuned(
    arguments: &Arguments,
    file: &CamFile,
    recorded: Option<&RecordedRun>,
    report: &mut Report<'_>,
) -> Result<(), TuneError> {
    let before = report.before;
    let deviation = match recorded {
        Some(run) => from_run(arguments, file, run, report)?,
        None => None,
    };
    // What was measured moves the slave, not the tappets; of a motion that was taught they are a part.
    let held = deviation.is_some() || recorded.is_none();
    let peak = arguments.least.least(&arguments.find);
    // A peak is minimised within the limits itself.
    if let (Some(run), Some(fit), None) = (recorded, report.fit, &peak) {
        within_run(arguments, (file, run, &fit), deviation.as_ref(), report)?;
    } else if recorded.is_none() && peak.is_none() && !arguments.find.is_empty() {
        let range = arguments.scaling_range;
        let (using, found) = within_limits(file, &before, arguments.free(), range)?;
        (report.after, report.within) = (using, Some(found));
    }
    if let Some(least) = peak {
        // From where the slave does the wanted motion.
        let corrected = report.after;
        let least = arguments.within_range(least, &before, &corrected);
        let (mut after, found) = minimise(file, &corrected, &least)?;
        if let Some(deviation) = &deviation {
            after.coupling.wanted = tune::wants(deviation, &corrected, &after);
        }
        report.after = after;
        report.least = Some(found);
    }
    if held {
        report.kept = tune::keep_tappets(file, &before, &report.after)?.map(Box::new);
    }
    let moved = report.kept.as_ref().map(|kept| kept.file.clone());
    let file = moved.as_ref().unwrap_or(file);
    report.fold();
    if let Some([master, position, velocity]) = arguments.ramp_in {
        let slave = State { position, velocity, acceleration: 0.0 };
        let least = arguments.least.quantity().unwrap_or(Quantity::Acceleration);
        let goal = arguments
            .within
            .map_or(RampGoal::Soonest, |within_s| RampGoal::Gentlest { within_s, least });
        let wish = ramp_wish(file, &report.after, master, slave, (arguments.ramp.into(), goal));
        let found = ramp_in(&wish)?;
        report.start = Some(Box::new(wish));
        let input = &mut report.after.coupling.input;
        input.velocity_difference = clean(found.velocity_difference);
        input.acceleration = clean(found.acceleration);
        input.deceleration = clean(found.deceleration);
        if matches!(input.start_mode, StartMode::Absolute | StartMode::Relative) {
            input.start_mode = StartMode::RampIn;
        }
        report.ramp = Some((arguments.ramp.into(), found));
    }
    Ok(())
}

/// What the limits leave of the fit of a run.
fn within_run(
    arguments: &Arguments,
    (file, run, fit): (&CamFile, &RecordedRun, &Fit),
    deviation: Option<&Deviation>,
    report: &mut Report<'_>,
) -> Result<(), TuneError> {
    let (before, proposed) = (report.before, report.after);
    let scaling_range = arguments.scaling_range;
    let run_fit = RunFit { before: &before, proposed: &proposed, fit, deviation, scaling_range };
    if let Some((after, found)) = limited(file, &run_fit, run, arguments.free())? {
        (report.after, report.limited) = (after, Some(found));
        // Limits have no intervals.
        report.proposed = None;
        let [_, errors] = report.run_errors(run);
        report.error_after = Some(tune::rms(&errors));
    }
    Ok(())
}

/// Fits a run; returns how the slave deviates, if it was measured.
fn from_run(
    arguments: &Arguments,
    file: &CamFile,
    run: &RecordedRun,
    report: &mut Report<'_>,
) -> Result<Option<Deviation>, TuneError> {
    let before = report.before;
    let mut deviation = None;
    report.samples = run.samples.len();
    let measured = arguments.slave == SlaveColumn::Measured;
    // The slave does the wanted motion but for the unknowns.
    let reference = if measured { tune::wanted(&before) } else { before };
    report.error_before = Some(tune::rms(&errors(file, &reference, run)));
    let range = arguments.scaling_range.unwrap_or(USUAL_RANGE);
    let found = fit_run(file, &reference, run, arguments.free(), range, arguments.between())?;
    let [.., said] = intervals(&arguments.find);
    if measured && said.is_none() {
        tune::refuse_stroke(&reference, &found)?;
    }
    let did = tune::as_fitted(&before, &found);
    if measured {
        let (after, by) = tune::corrected(file, &before, &found);
        report.proposed = Some(tune::within(&by, &reference, &after));
        (report.after, deviation) = (after, Some(by));
        report.wanted = Some(reference);
    } else {
        report.after = tune::with_exactly(&before, found.estimates.map(tune::rounded));
    }
    report.error_after = Some(tune::rms(&errors(file, &did, run)));
    report.did = Some(did);
    report.fit = Some(found);
    if !run.groups.is_empty() {
        // The tappets of a slave that was measured are where the coupling in effect has them.
        let register = if measured { before } else { did };
        match run_dead_time(file, &register, run) {
            Ok((time, seen)) => {
                // A compensation within the interval stays.
                if !time.holds(before.coupling.dead_time_s) {
                    report.after.coupling.dead_time_s = tune::rounded(time);
                }
                report.dead_time = Some((time, seen));
            }
            // Too few of them do not prevent offsets and scalings.
            Err(few @ TuneError::FewSwitchings { .. }) => {
                report.no_dead_time = Some(few.to_string());
            }
            Err(error) => return Err(error),
        }
    }
    Ok(deviation)
}

impl Arguments {
    /// Intervals of the values of a fit; with a peak to be smallest intervals are for that.
    fn between(&self) -> [Option<[f64; 2]>; 4] {
        if self.least.quantity().is_some() { [None; 4] } else { intervals(&self.find) }
    }

    /// `MasterScaling` without an interval of its own stays within the range that was said.
    fn within_range(&self, mut least: Least, before: &CamUse, corrected: &CamUse) -> Least {
        let [_, scaling, ..] = &mut least.sought;
        let anything = scaling.filter(|[low, high]| low.is_infinite() && high.is_infinite());
        if self.scaling_range.is_some() && anything.is_some() {
            *scaling = Some(tune::scalings(self.scaling_range, before, corrected));
        }
        least
    }
}
