//! Unwrap of runs that were recorded within the periods of axes: master and slave go on where their positions begin again.
//!
//! The master's period is given, or the one of this cam that its positions jump back by: whole passes of the cam, whole turns of an
//! axis in degrees, or whole passes with the scaling in effect. The slave's is that of the machine's axis or of the cam's file. Whole
//! periods of a slave are the same place, and so is its gain in whole passes of a master whose earlier turns are unknown: the slave
//! is taken to be where that is nearest to its set-point.

use super::super::check::CamUse;
use super::super::run::{RecordedRun, RunSample, median, turns};
use super::errors;
use std::borrow::Cow;
use twin_machine::axis_kind::AxisKind;
use twin_machine::cam_file::CamFile;
use twin_machine::cam_file::unit_fits;

/// A jump of the master is that of a period but for this part, and this many standard deviations of its noise; that of a slave,
/// which its cam accelerates, but for a larger part.
const NEAR: f64 = 0.02;
const NOISE: f64 = 6.0;
const SLAVE_NEAR: f64 = 0.25;

/// A run that goes on, and after what positions of its master and its slave began again, u.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unwound<'a> {
    pub(crate) run: Cow<'a, RecordedRun>,
    /// Of the master.
    pub(crate) master: Option<f64>,
    /// Of the slave.
    pub(crate) slave: Option<f64>,
}

/// The same run with a master and a slave that go on where their positions begin again; `period` is that of the master, if it is
/// given.
pub(crate) fn unwound<'a>(
    file: &CamFile,
    using: &CamUse,
    run: &'a RecordedRun,
    period: Option<f64>,
) -> Unwound<'a> {
    let master = period.or_else(|| master_period(file, using, run));
    let mut found = Unwound { run: Cow::Borrowed(run), master: None, slave: None };
    if let Some(period) = master
        && let Cow::Owned(other) = run.unwound(period)
    {
        (found.run, found.master) = (Cow::Owned(other), Some(period));
    }
    let goes_round = using.slave_period(file).filter(|_| {
        let of_axis = using.limits.period.is_some() || using.gain(file).is_some();
        of_axis || is_angle(&file.slave)
    });
    if let Some(period) = goes_round
        && let Some(turns) = slave_turns(&found.run, period)
    {
        let samples = found.run.to_mut().samples.iter_mut();
        samples.zip(turns).for_each(|(sample, turns)| sample.slave += turns * period);
        found.slave = Some(period);
    }
    let gained = using.gain(file).map(|gain| (gain * using.coupling.input.slave_scaling).abs());
    let whole = goes_round.or(gained.filter(|_| found.master.is_some()));
    if let Some(whole) = whole.filter(|whole| *whole > 0.0) {
        let off = errors(file, using, &found.run).into_iter().map(|(_, error)| error).collect();
        let by = (median(off) / whole).round() * whole;
        if by != 0.0 && by.is_finite() {
            found.run.to_mut().samples.iter_mut().for_each(|sample| sample.slave -= by);
        }
    }
    found
}

fn is_angle(scale: &twin_machine::cam_file::AxisScale) -> bool {
    !scale.unit.is_empty() && unit_fits(scale, AxisKind::Rotary)
}

/// Period within which the master was recorded, if its positions jump back by one that a master of this cam has.
fn master_period(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Option<f64> {
    let curve = file.cam.curve();
    let width = curve.end() - curve.start();
    let jump = jump(run, |sample| sample.master);
    let turn = if is_angle(&file.master) { 360.0 } else { width };
    let scaled = width / using.coupling.input.master_scaling.abs();
    let all = [width, turn, scaled].map(|period| (jump / period).round() * period);
    let nearest = all.into_iter().min_by(|a, b| (jump - a).abs().total_cmp(&(jump - b).abs()));
    nearest.filter(|period| {
        let room = NEAR * period + NOISE * run.noise();
        using.repeated && *period > 0.0 && (jump - period).abs() <= room
    })
}

/// How far the largest step from one sample to the next is from the usual one: where positions begin again that is their period.
fn jump(run: &RecordedRun, position: fn(&RunSample) -> f64) -> f64 {
    let steps = run.samples.windows(2).map(|two| position(&two[1]) - position(&two[0]));
    let steps: Vec<f64> = steps.collect();
    let usual = median(steps.clone());
    steps.into_iter().map(|step| (step - usual).abs()).fold(0.0, f64::max)
}

/// How many turns each sample of a slave is on from where it was recorded within `period`; none if it was not.
fn slave_turns(run: &RecordedRun, period: f64) -> Option<Vec<f64>> {
    let jump = jump(run, |sample| sample.slave);
    ((jump - period).abs() <= SLAVE_NEAR * period)
        .then(|| turns(run.samples.iter().map(|sample| sample.slave), period, period / 2.0))
}
