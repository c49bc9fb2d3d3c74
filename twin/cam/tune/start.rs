//! Start of a recorded run: whether its slave was coupled there.

use super::super::check::CamUse;
use super::super::run::RecordedRun;
use twin_machine::cam_file::CamFile;

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
