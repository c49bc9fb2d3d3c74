//! Parts of a ramp segment to search for extremes while the cam repeats.
//!
//! Apart from its mean velocity a periodic cam does the same in every pass. The motion of the ramp, with that mean
//! velocity added, is monotonic between the zeros of its derivative. So from one such zero to the next the extremes of
//! the sum lie in the first or in the last pass, for position, velocity, acceleration and jerk alike.

use super::course::Pull;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The parts, as times from the begin of a stretch that takes `duration` s. `velocity` is that of ramp and cam there in the
/// mean of a pass, which takes `pass` s.
pub(super) fn parts(pull: &Pull, velocity: f64, duration: f64, pass: f64) -> Vec<[f64; 2]> {
    // Also where there are no passes: their time is infinite then.
    if duration <= 2.0 * pass {
        return vec![[0.0, duration]];
    }
    let mut turns = turns(pull, velocity, duration);
    turns.retain(|time| *time > 0.0 && *time < duration);
    turns.extend([0.0, duration]);
    turns.sort_by(f64::total_cmp);
    let pairs = turns.iter().zip(turns.iter().skip(1));
    let ends = |(from, to): (&f64, &f64)| {
        let all = vec![[*from, *to]];
        if to - from <= 2.0 * pass { all } else { vec![[*from, from + pass], [to - pass, *to]] }
    };
    pairs.flat_map(ends).collect()
}

/// Where the derivative of position, velocity, acceleration or jerk of the ramp may be 0.
fn turns(pull: &Pull, velocity: f64, duration: f64) -> Vec<f64> {
    let Pull { acceleration, jerk, angular } = *pull;
    if angular == 0.0 {
        // v + a·t + j·t²/2 = 0, and a + j·t = 0.
        let root = (acceleration * acceleration - 2.0 * jerk * velocity).max(0.0).sqrt();
        let far = -(acceleration + root.copysign(acceleration));
        return vec![far / jerk, 2.0 * velocity / far, -acceleration / jerk];
    }
    // The acceleration is â·sin(φ + ωt), the velocity v + â/ω·(cos φ − cos(φ + ωt)).
    let phase = acceleration.atan2(jerk / angular);
    let amplitude = acceleration.hypot(jerk / angular);
    let still = (phase.cos() + velocity * angular / amplitude).clamp(-1.0, 1.0).acos();
    let last = phase + angular * duration;
    let mut angles = Vec::new();
    for first in [0.0, FRAC_PI_2, PI, -FRAC_PI_2, still, -still] {
        let mut angle = first + ((phase - first) / TAU).ceil() * TAU;
        while angle < last {
            angles.push((angle - phase) / angular);
            angle += TAU;
        }
    }
    angles
}
