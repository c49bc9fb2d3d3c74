//! Motion in a recorded run: velocity and acceleration of the master.

use super::super::check::CamUse;
use super::super::run::{RecordedRun, RunSample};
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

/// The parabola that fits some samples best: y = c₀ + c₁·b₁ + c₂·b₂ with u from −1 to 1, b₁ = u − m, b₂ = u² − q − k·b₁, each
/// orthogonal to the others on the samples.
struct Parabola {
    /// Half of its duration, s.
    half_s: f64,
    /// c₁ and c₂; 0 where they are noise.
    c: [f64; 2],
    /// Their standard errors.
    errors: [f64; 2],
    /// k.
    skew: f64,
}

impl Parabola {
    fn of(samples: &[RunSample], value: fn(&RunSample) -> f64) -> Option<Self> {
        let (first, last) = (samples.first()?, samples.last()?);
        if samples.len() < LEAST {
            return None;
        }
        let half_s = (last.time_s - first.time_s) / 2.0;
        let middle = f64::midpoint(first.time_s, last.time_s);
        let points = || {
            samples.iter().map(|one| ((one.time_s - middle) / half_s, value(one) - value(first)))
        };
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = samples.len() as f64;
        let mean = |of: &dyn Fn(f64) -> f64| points().map(|(u, _)| of(u)).sum::<f64>() / count;
        let (m, q) = (mean(&|u| u), mean(&|u| u * u));
        let one = |u: f64| u - m;
        let skew = mean(&|u| u * u * one(u)) / mean(&|u| one(u).powi(2));
        let two = |u: f64| u * u - q - skew * one(u);
        let along = |of: &dyn Fn(f64) -> f64| {
            let (mut above, mut below) = (0.0, 0.0);
            for (u, y) in points() {
                above += y * of(u);
                below += of(u).powi(2);
            }
            (above / below, below)
        };
        let ((c1, of_one), (c2, of_two)) = (along(&one), along(&two));
        let c0 = points().map(|(_, y)| y).sum::<f64>() / count;
        let left = points().map(|(u, y)| (y - c0 - c1 * one(u) - c2 * two(u)).powi(2)).sum::<f64>();
        let noise = (left / (count - 3.0)).sqrt();
        let size = points().map(|(_, y)| y.abs()).fold(0.0, f64::max);
        let errors = [of_one, of_two].map(|below| noise / below.sqrt());
        let seen = |c: f64, error: f64| {
            if c.abs() > (SEEN * error).max(ROUNDING * size) { c } else { 0.0 }
        };
        Some(Self { half_s, c: [seen(c1, errors[0]), seen(c2, errors[1])], errors, skew })
    }

    /// The derivative at a part of the window, −1 to 1.
    fn velocity(&self, u: f64) -> f64 {
        (self.c[0] + self.c[1] * (2.0 * u - self.skew)) / self.half_s
    }

    /// Velocity in the middle and acceleration, as much as there is of them for certain.
    fn certain(&self) -> [f64; 2] {
        let [fast, pull] = [self.velocity(0.0).abs(), 2.0 * self.c[1].abs() / self.half_s];
        let less = [self.errors[0], 2.0 * self.errors[1]].map(|error| LUCK * error);
        [
            (fast - less[0] / self.half_s).max(0.0),
            (pull - less[1] / self.half_s).max(0.0) / self.half_s,
        ]
    }
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
        let Some(parabola) = Parabola::of(window, |sample| sample.master) else { continue };
        let [velocity, acceleration] = parabola.certain();
        motion.velocity = motion.velocity.max(velocity);
        motion.acceleration = motion.acceleration.max(acceleration);
    }
    (motion.velocity > 0.0).then_some(motion)
}
