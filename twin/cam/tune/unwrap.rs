//! Unwrap of runs that were recorded within the periods of axes: master and slave go on where their positions begin again.
//!
//! After what the master's positions begin again is given, or it is what they jump back by, if that is a period that a master of
//! this cam has: whole passes of the cam, whole turns of an axis in degrees, or whole passes with the scaling in effect. A slave
//! goes round if its axis does: with the period of the machine's axis, or of the cam's file. Whole periods of it are the same
//! place, and so is its gain in whole passes of a master whose earlier turns are unknown: the slave is
//! taken to be where that is nearest to its set-point.

use super::super::check::CamUse;
use super::super::run::{RecordedRun, RunSample, median, turns};
use super::errors;
use std::borrow::Cow;
use twin_machine::axis_kind::AxisKind;
use twin_machine::cam_file::CamFile;
use twin_machine::cam_file::unit_fits;

/// Passes or turns that a period may have.
const MOST: u32 = 12;
/// A jump is that of a period but for this part, and this many standard deviations of its noise.
const NEAR: f64 = 0.02;
const NOISE: f64 = 6.0;
/// Of several near periods the first one that is as near as this part is taken.
const EXACT: f64 = 1e-3;

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

/// After what the master's positions begin again, if they do by what a master of this cam has for a period.
fn master_period(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Option<f64> {
    let curve = file.cam.curve();
    let width = curve.end() - curve.start();
    let jump = Jump::of(run, |sample| sample.master).filter(|_| using.repeated)?;
    let turn = is_angle(&file.master).then_some(360.0);
    let scaled = width / using.coupling.input.master_scaling.abs();
    let known = [Some(width), turn, Some(scaled)];
    let all = known.into_iter().flatten().filter(|period| period.is_finite() && *period > 0.0);
    let all: Vec<f64> =
        all.flat_map(|period| (1..=MOST).map(move |times| f64::from(times) * period)).collect();
    let off = |period: &f64| (jump.by - period).abs();
    let exact = all.iter().find(|period| off(period) <= EXACT * **period + jump.error);
    let near = || all.iter().min_by(|one, other| off(one).total_cmp(&off(other)));
    let near = exact.or_else(near).copied()?;
    (off(&near) <= NEAR * near + NOISE * run.noise() + jump.error).then_some(near)
}

/// What positions jump back by where they begin again.
struct Jump {
    by: f64,
    /// How well that is known: four standard errors.
    error: f64,
}

impl Jump {
    /// None if no step goes over more than half of where positions are at all.
    fn of(run: &RecordedRun, position: fn(&RunSample) -> f64) -> Option<Self> {
        let values: Vec<f64> = run.samples.iter().map(position).collect();
        let steps: Vec<f64> =
            values.iter().zip(values.iter().skip(1)).map(|(one, next)| next - one).collect();
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let [least, most] = values.iter().fold(ends, |[a, b], v| [a.min(*v), b.max(*v)]);
        let jumps = |step: &f64| step.abs() > (most - least) / 2.0;
        // The steps on both sides.
        let around = |index: usize| {
            let both = [index.checked_sub(1), Some(index + 1)].into_iter().flatten();
            let both: Vec<f64> = both
                .filter_map(|index| steps.get(index).copied())
                .filter(|step| !jumps(step))
                .collect();
            #[expect(clippy::cast_precision_loss, reason = "two at most")]
            let count = both.len().max(1) as f64;
            both.iter().sum::<f64>() / count
        };
        let all: Vec<f64> = steps
            .iter()
            .enumerate()
            .filter(|(_, step)| jumps(step))
            .map(|(index, step)| (step - around(index)).abs())
            .collect();
        if all.is_empty() {
            return None;
        }
        let by = median(all.clone());
        let apart = median(all.iter().map(|jump| (jump - by).abs()).collect()) / 0.6745;
        #[expect(clippy::cast_precision_loss, reason = "a count of jumps")]
        let error = 4.0 * apart / (all.len() as f64).sqrt();
        Some(Self { by, error })
    }
}

/// How many turns each sample of a slave is on from where it was recorded within `period`; none if it was not.
fn slave_turns(run: &RecordedRun, period: f64) -> Option<Vec<f64>> {
    let jump = Jump::of(run, |sample| sample.slave)?;
    if (jump.by - period).abs() > NEAR * period + jump.error {
        return None;
    }
    Some(turns(run.samples.iter().map(|sample| sample.slave), period, 0.0))
}
