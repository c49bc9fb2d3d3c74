//! Finds what `twin tune cam` is asked for, one thing after the other.

use super::cam::Arguments;
use super::least::{intervals, sought_within};
use super::report::Report;
use super::words::SlaveColumn;
use crate::cam::run::RecordedRun;
use crate::cam::tune::{
    self, Deviation, RunFit, TuneError, errors, fit_run, limited, minimise, ramp_wish,
    run_dead_time, within_limits,
};
use twin_cam::file::clean;
use twin_cam::tune::{RampGoal, ramp_in};
use twin_cam::{Quantity, StartMode};
use twin_machine::cam_file::CamFile;
use twin_profile::State;

/// Finds what the options ask for.
pub(super) fn tuned(
    arguments: &Arguments,
    file: &CamFile,
    recorded: Option<&RecordedRun>,
    report: &mut Report<'_>,
) -> Result<(), TuneError> {
    let before = report.before;
    // What was measured moves the slave, not the tappets; of a motion that was taught they are a part.
    let mut held = true;
    if let Some(run) = recorded {
        let deviation = from_run(arguments, file, run, report)?;
        held = deviation.is_some();
        within_run(arguments, (file, run), deviation.as_ref(), report)?;
    } else if !arguments.find.is_empty() {
        let sought = sought_within(&arguments.find);
        if let Some(quantity) = arguments.least.quantity() {
            let (after, found) = minimise(file, &before, quantity, sought)?;
            (report.after, report.least) = (after, Some(found));
        } else {
            let (after, found) = within_limits(file, &before, sought)?;
            (report.after, report.within) = (after, Some(found));
        }
    }
    if held {
        report.kept = tune::keep_tappets(file, &before, &report.after)?.map(Box::new);
    }
    report.fold();
    arguments.ramp_in.map_or(Ok(()), |start| onto_cam(arguments, file, start, report))
}

/// Finds the ramp of a start: where the master is, where the slave is, and its velocity.
fn onto_cam(
    arguments: &Arguments,
    file: &CamFile,
    [master, position, velocity]: [f64; 3],
    report: &mut Report<'_>,
) -> Result<(), TuneError> {
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
    Ok(())
}

/// What the limits leave of the fit of a run.
fn within_run(
    arguments: &Arguments,
    (file, run): (&CamFile, &RecordedRun),
    deviation: Option<&Deviation>,
    report: &mut Report<'_>,
) -> Result<(), TuneError> {
    let Some(fit) = report.fit else { return Ok(()) };
    let (before, proposed) = (report.before, report.after);
    let run_fit = RunFit { before: &before, proposed: &proposed, fit: &fit, deviation };
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
    let between = intervals(&arguments.find);
    let found = fit_run(file, &reference, run, arguments.free(), between)?;

    if measured && between[3].is_none() {
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
