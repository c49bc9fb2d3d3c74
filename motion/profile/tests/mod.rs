//! Tests of profiles against closed forms and invariants.

mod parabolic;
mod random;
mod refused;
mod ruckig;
mod table;
mod trapezoid;

use super::*;
use random::{Case, Random, cases};

fn limits(velocity: f64, acceleration: f64, deceleration: f64) -> AxisLimits {
    AxisLimits { velocity, acceleration, deceleration, jerk: 200.0 }
}

/// True if two numbers agree within 1e-9, relative to the larger of them and 1.
fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0)
}

/// The limit of the acceleration in this state.
fn rate(limits: &AxisLimits, state: State) -> f64 {
    let grows = state.velocity * state.acceleration > 0.0;
    if grows { limits.acceleration } else { limits.deceleration }
}

/// States from start to end, `count` equal steps and the end itself.
fn sampled(profile: &Profile, count: u32) -> Vec<(f64, State)> {
    let at = |index: u32| {
        let time = profile.duration() * f64::from(index) / f64::from(count);
        (time, profile.at(time))
    };
    (0..=count).map(at).collect()
}
