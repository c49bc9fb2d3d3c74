//! Start of a recorded run: whether its slave was coupled there, and the start of a ramp that begins as the run does.

use super::super::check::CamUse;
use super::super::run::RecordedRun;
use super::TuneError;
use super::correction::Deviation;
use super::recorded::state;
use twin_machine::cam_file::CamFile;
use twin_profile::State;

/// So many standard deviations of the master's noise are no motion.
const NOISE: f64 = 6.0;
/// Rounding takes so many of the last digits at most.
const LAST: u32 = 16;

/// Where the master was when the slave of a run was coupled, as far as the run says so: where it begins, if the coupling in
/// effect starts there. A run that begins beyond the cam began when the slave was on it already. A master that stands beside
/// an end of the cam by its noise alone stands at the end.
pub fn started_at(file: &CamFile, using: &CamUse, run: &RecordedRun) -> Option<f64> {
    let curve = file.cam.curve();
    let first = run.samples.first()?.master;
    let noise = NOISE * (run.noise() * using.coupling.input.master_scaling).abs();
    let place = using.place_at(first);
    let end = [curve.start(), curve.end()].into_iter().find(|end| (place - end).abs() <= noise);
    let master = end.map_or(first, |end| onto(using, file, using.master_at(end)));
    using.starts_at(curve, master).then_some(master)
}

/// A place of the master at an end of the cam, without the rounding that puts it beside it.
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
pub struct Begin {
    /// Where the master is, on a pass of the cam on which `MC_CamIn` starts.
    pub master: f64,
    /// Where the slave is told to be, and how fast, so that it is where it was.
    pub slave: State,
    /// The line of the run.
    pub line: u64,
    /// How many passes of the cam before the master of the run that is.
    pub passes: f64,
    /// How many samples of the run come before, which lie beyond a cam that is passed once.
    pub before: usize,
}

/// Where both are at the first sample with which `MC_CamIn` starts: of a cam that is put end to end the first one of all, on
/// the pass that it starts on.
///
/// # Errors
/// [`TuneError::BeyondCam`] if the run never comes onto a cam that is passed once.
pub fn begin(
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
