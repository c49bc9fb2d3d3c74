//! Trapezoidal profiles: the fastest motion under limits of velocity and acceleration.
//!
//! A motion to a position is one ramp to a velocity v, possibly a phase at v, and one ramp from there. As a function of
//! v its distance is a parabola, for all signs of the velocities:
//!
//! ```text
//! way(v) = way(straight) + K·(v² − m²),  K = (1/A + 1/D)/2,  m = max(v0, v1)
//! ```
//!
//! for v not below m, with the acceleration A and the deceleration D. The other direction is its mirror image. Only the
//! upper side leads further than the straight ramp from v0 to v1, and the fastest motion is on the rising branch of the
//! parabola: no other motion gets further in the same time.

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
    let start = track.state.velocity;
    let excess = target - track.state.position - way(limits, start, end_velocity);
    // The mirror image, so that it is always further than straight to the end velocity.
    let sign = if excess < 0.0 { -1.0 } else { 1.0 };
    let excess = excess.abs();
    // Straight leads the way over the larger of the two; so no constant is left that would take digits.
    let least = (sign * start).max(sign * end_velocity);
    let curvature = 0.5 * (1.0 / acceleration + 1.0 / deceleration);
    let peak = (least * least + excess / curvature).sqrt();
    let (peak, cruise) = if peak < most {
        (peak, 0.0)
    } else {
        (most, (excess / most - curvature * (most - least) * (1.0 + least / most)).max(0.0))
    };
    ramp(track, sign * peak, limits);
    track.push(cruise, 0.0, 0.0);
    ramp(track, end_velocity, limits);
}
