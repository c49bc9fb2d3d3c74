//! Ramps of constant acceleration: the fastest motion under limits of velocity and acceleration.
//!
//! The way to a position is one ramp to a velocity v, possibly a stretch at v, and one ramp from there. Over v the way
//! is a parabola, whichever signs the velocities have:
//!
//! ```text
//! way(v) = K·v² − c,  K = (1/A + 1/D)/2,  c = v0²/2A₀ + v1²/2A₁
//! ```
//!
//! for v not below v0 and v1, with A₀ the acceleration A or, where v0 is negative, the deceleration D, and A₁ the other
//! way round. The other direction is its mirror image. Further than straight from v0 to v1 leads the upper side only,
//! and the fastest way there is the rising branch of the parabola: in the same time nothing gets further.

use super::AxisLimits;
use super::segment::Track;

/// Change of the velocity per time between two velocities of the same direction, u/s².
fn rate(limits: AxisLimits, from: f64, to: f64) -> f64 {
    limits.rate(to.abs() > from.abs())
}

/// The way from one velocity to another, u.
fn way(limits: AxisLimits, from: f64, to: f64) -> f64 {
    let half = |from: f64, to: f64| 0.5 * (to - from).abs() * (from + to) / rate(limits, from, to);
    if from * to < 0.0 { half(from, 0.0) + half(0.0, to) } else { half(from, to) }
}

/// Goes to a velocity, through a standstill where it turns.
pub(super) fn ramp(track: &mut Track, velocity: f64, limits: AxisLimits) {
    let from = track.state.velocity;
    if from * velocity < 0.0 {
        straight(track, 0.0, limits);
    }
    straight(track, velocity, limits);
    track.state.acceleration = 0.0;
}

fn straight(track: &mut Track, velocity: f64, limits: AxisLimits) {
    let change = velocity - track.state.velocity;
    let rate = rate(limits, track.state.velocity, velocity);
    track.push(change.abs() / rate, rate.copysign(change), 0.0);
    track.state.velocity = velocity;
}

/// Goes to a position and has `end_velocity`, at most the limit, there.
pub(super) fn to_position(track: &mut Track, target: f64, end_velocity: f64, limits: AxisLimits) {
    let AxisLimits { velocity: most, acceleration, deceleration, .. } = limits;
    let start = track.state.velocity;
    if start.abs() > most {
        ramp(track, most.copysign(start), limits);
    }
    let way_to_go = target - track.state.position;
    let start = track.state.velocity;
    let excess = way_to_go - way(limits, start, end_velocity);
    // The mirror image, so that it is always further than straight to the end velocity.
    let sign = if excess < 0.0 { -1.0 } else { 1.0 };
    let [way_to_go, v0, v1] = [way_to_go, start, end_velocity].map(|value| sign * value);
    let curvature = 0.5 * (1.0 / acceleration + 1.0 / deceleration);
    let offset = 0.5 * (v0 * v0 / limits.rate(v0 >= 0.0) + v1 * v1 / limits.rate(v1 < 0.0));
    let peak = ((way_to_go + offset) / curvature).max(0.0).sqrt().max(v0).max(v1);
    let (peak, cruise) = if peak < most {
        (peak, 0.0)
    } else {
        (most, (way_to_go + offset) / most - curvature * most)
    };
    ramp(track, sign * peak, limits);
    track.push(cruise, 0.0, 0.0);
    ramp(track, end_velocity, limits);
}
