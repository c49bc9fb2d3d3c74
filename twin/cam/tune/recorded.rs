//! Motion in a recorded run: velocity and acceleration of the master.

use super::super::check::CamUse;
use super::super::run::{RecordedRun, RunSample};
use nalgebra::{Matrix3, Vector3};
use twin_cam::MasterMotion;
use twin_machine::cam_file::CamFile;

/// Samples that a parabola is laid through, and the fewest that determine one.
const WINDOW: usize = 21;
const LEAST: usize = 5;
/// A derivative that is less than this many times its standard error is noise: of thousands of windows none exceeds it by chance.
const SEEN: f64 = 8.0;
/// Standard errors by which the largest of many windows exceeds the true value.
const LUCK: f64 = 3.0;
/// A part of the way in a window that is rounding.
const ROUNDING: f64 = 1e-9;

/// Velocity in the middle of a window and acceleration, as much as there is of them for certain: by the parabola that fits best.
fn certain(window: &[RunSample]) -> Option<[f64; 2]> {
    let (first, last) = (window.first()?, window.last()?);
    if window.len() < LEAST {
        return None;
    }
    let half_s = (last.time_s - first.time_s) / 2.0;
    let middle = f64::midpoint(first.time_s, last.time_s);
    let point = |one: &RunSample| {
        let u = (one.time_s - middle) / half_s;
        (Vector3::new(1.0, u, u * u), one.master - first.master)
    };
    let points: Vec<_> = window.iter().map(point).collect();
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (row, y) in &points {
        matrix += row * row.transpose();
        right += row * *y;
    }
    let inverse = matrix.try_inverse()?;
    let c = inverse * right;
    let left = points.iter().map(|(row, y)| (y - row.dot(&c)).powi(2)).sum::<f64>();
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let noise = (left / (points.len() as f64 - 3.0)).sqrt();
    let size = points.iter().map(|(_, y)| y.abs()).fold(0.0, f64::max);
    let sure = |c: f64, variance: f64| {
        let error = noise * variance.sqrt();
        let seen = c.abs() > (SEEN * error).max(ROUNDING * size);
        if seen { c.abs() - LUCK * error } else { 0.0 }
    };
    Some([sure(c.y, inverse.m22) / half_s, 2.0 * sure(c.z, inverse.m33) / (half_s * half_s)])
}

/// The largest velocity and acceleration of the master in a run, as far as they exceed its noise; none if it is at rest. What
/// a run says of its jerk is noise. A master that goes round is not taken to be back where its positions begin again.
pub(crate) fn master_motion(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
) -> Option<MasterMotion> {
    let curve = file.cam.curve();
    let turn = (curve.end() - curve.start()) / using.coupling.input.master_scaling.abs();
    let goes_on = |window: &&[RunSample]| {
        window
            .iter()
            .zip(window.iter().skip(1))
            .all(|(one, next)| (next.master - one.master).abs() < turn / 2.0)
    };
    let mut motion = MasterMotion { velocity: 0.0, acceleration: 0.0, jerk: 0.0 };
    let size = run.samples.len().min(WINDOW);
    for window in run.samples.windows(size.max(1)).filter(goes_on) {
        let Some([velocity, acceleration]) = certain(window) else { continue };
        motion.velocity = motion.velocity.max(velocity);
        motion.acceleration = motion.acceleration.max(acceleration);
    }
    (motion.velocity > 0.0).then_some(motion)
}
