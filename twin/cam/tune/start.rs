//! Start of a recorded run: whether its slave was coupled there, and the start of a ramp that begins as the run does.

use super::super::check::CamUse;
use super::super::run::RecordedRun;
use super::TuneError;
use super::correction::Deviation;
use super::recorded::state;
use twin_machine::cam_file::CamFile;
use twin_profile::State;

/// Standard deviations of the master's noise that do not count as motion.
const NOISE: f64 = 6.0;
/// Steps of the last digit that rounding takes at most.
const LAST: u32 = 16;

/// Where the master was when the slave of a run was coupled, as far as the run says so: where it begins, if the coupling in
/// effect starts there. A run that begins beyond the cam began when the slave was on it already. A master that is
/// off an end of the cam by its noise alone is at that end.
pub(crate) fn started_at(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Option<f64> {
    let curve = file.cam.curve();
    let first = run.samples.first()?.master;
    let noise = NOISE * (run.noise() * using.coupling.input.master_scaling).abs();
    let place = using.place_at(first);
    let end = [curve.start(), curve.end()].into_iter().find(|end| (place - end).abs() <= noise);
    let master = end.map_or(first, |end| onto(using, file, using.master_at(end)));
    using.starts_at(curve, master).then_some(master)
}

/// A place of the master at an end of the cam, without the rounding that puts it off the cam.
fn onto(using: &CamUse, file: &CamFile, master: f64) -> f64 {
    let curve = file.cam.curve();
    let (mut below, mut above) = (master, master);
    for _ in 0..LAST {
        if let Some(on_cam) = [below, above].into_iter().find(|at| using.starts_at(curve, *at)) {
            return on_cam;
        }
        (below, above) = (below.next_down(), above.next_up());
    }
    master
}

/// Where a ramp begins that is to begin as a run does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Begin {
    /// Where the master is, on a pass of the cam on which `MC_CamIn` starts.
    pub(crate) master: f64,
    /// Set-point and velocity with which the slave is where it was.
    pub(crate) slave: State,
    pub(crate) line: u64,
    /// How many passes of the cam before the master of the run that is.
    pub(crate) passes: f64,
    /// How many samples of the run come before, which lie beyond a cam that is passed once.
    pub(crate) before: usize,
}

/// Where both are at the first sample with which `MC_CamIn` starts: of a periodic cam the first one of all, on
/// the pass that it starts on.
/// [`TuneError::BeyondCam`] if the run never comes onto a cam that is passed once.
pub(crate) fn begin(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
    deviation: Option<&Deviation>,
) -> Result<Begin, TuneError> {
    let curve = file.cam.curve();
    let starts = |master: f64| using.repeated || using.starts_at(curve, master);
    let beyond =
        || TuneError::BeyondCam { range: using.starts(curve), unit: file.master.unit().to_owned() };
    let before = run.samples.iter().position(|one| starts(one.master)).ok_or_else(beyond)?;
    let samples = run.samples.get(before..).unwrap_or_default();
    let first = samples.first().ok_or_else(beyond)?;
    let mut slave = state(samples, deviation).ok_or_else(beyond)?;
    let place = using.place_at(first.master);
    if curve.contains(place) {
        return Ok(Begin { master: first.master, slave, line: first.line, passes: 0.0, before });
    }
    let input = &using.coupling.input;
    let (inside, passes) = curve.wrap(place);
    slave.position -= passes * curve.rise() * input.slave_scaling;
    let master = onto(using, file, using.master_at(inside));
    Ok(Begin { master, slave, line: first.line, passes, before })
}
