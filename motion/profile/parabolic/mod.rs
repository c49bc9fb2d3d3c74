//! Jerk-limited profiles: the fastest motion under limits of velocity, acceleration and jerk.
//!
//! The problem is that of Berscheid and Kröger, "Jerk-limited Real-time Trajectory Generation with Arbitrary Target
//! States" (2021), for one axis and an end without acceleration, with a limit for the growth and one for the fall of
//! the speed. The solution here is different; it uses the positions that can be reached in a given time:
//!
//! The straight ramp to the end velocity ends at some position. With more time T all positions between a nearest and a
//! furthest one can be reached, and both move continuously with T. So the fastest motion to a further target is the
//! first of the furthest motions that reaches it; nearer targets are the mirror image. The furthest ones are, in the
//! order of T:
//!
//! 1. *Easing*, where the axis brakes at the start and has to brake further: the acceleration rises from a0 to −α and
//!    then goes on down to the end velocity. α goes from |a0| to 0.
//! 2. *Peaks*: up to a velocity v and down from it. v goes from the highest of the velocities at start and end to the
//!    limit.
//! 3. *Cruising* at the limit.
//!
//! The place of the end moves, with p and q the peaks of acceleration before and after v or α, by
//!
//! ```text
//! peaks:   dx/dT = v + p·q/2j                       dT = (1/p + 1/q)·dv
//! easing:  dx/dT = v₁ − α·(q − α)/2j                dT = −2/j·(1 − α/q)·dα
//! ```
//!
//! Over the peaks dx/dT only grows, so a target further than the first has exactly one peak: Newton's method within a
//! bracket finds it. Easing is followed piece by piece between the zeros of dx/dT.

mod ease;
mod ramp;

use super::rates::{Rates, side};
use super::segment::Track;
use ease::Ease;
use ramp::Up;

/// Steps of a search. Halving the bracket alone gets to the last bit of a number that is not extremely small.
const MOST_STEPS: u32 = 80;

/// Part of the ways on the way that the end may be off.
const PRECISION: f64 = 1e-13;

/// Goes to a velocity.
pub(super) fn ramp(track: &mut Track, velocity: f64, limits: &Rates) {
    let start = track.state;
    let sign = side(velocity - limits.settled(start.velocity, start.acceleration));
    limits.up(sign * start.velocity, sign * start.acceleration, sign * velocity).push(
        track,
        sign,
        limits.jerk,
    );
}

/// Goes to a position and has `end_velocity`, at most the limit, there.
pub(super) fn to_position(track: &mut Track, target: f64, end_velocity: f64, limits: &Rates) {
    let most = limits.velocity;
    let settled = limits.settled(track.state.velocity, track.state.acceleration);
    if track.state.velocity.abs() <= most && settled.abs() <= most {
        plan(track, target, end_velocity, limits);
        return;
    }
    // Too fast, or bound to be: back to the limit as soon as can be, or so that it can be kept from there on. Which of
    // them is faster in the end depends on how far it is.
    let mut hard = *track;
    let over = side(if settled.abs() > most { settled } else { track.state.velocity });
    brake(&mut hard, over, limits);
    if limits.settled(hard.state.velocity, hard.state.acceleration).abs() > most {
        // That would be too much, so only as much as leads to the limit on the other side.
        hard = *track;
        ramp(&mut hard, -over * most, limits);
    }
    plan(&mut hard, target, end_velocity, limits);
    if settled.abs() > most {
        ramp(track, over * most, limits);
    }
    plan(track, target, end_velocity, limits);
    if hard.duration < track.duration {
        *track = hard;
    }
}

/// Brakes from beyond the velocity limit on the side of `sign` until it is kept.
fn brake(track: &mut Track, sign: f64, limits: &Rates) {
    let (excess, acceleration) =
        (sign * track.state.velocity - limits.velocity, sign * track.state.acceleration);
    let Rates { deceleration, jerk, .. } = *limits;
    if acceleration < -deceleration {
        let ease = (-deceleration - acceleration) / jerk;
        // The velocity may get below the limit within this time; it is kept then.
        track.push(ease, sign * acceleration, sign * jerk);
        let left = sign * track.state.velocity - limits.velocity;
        track.push(left / deceleration, -sign * deceleration, 0.0);
        return;
    }
    // Where the acceleration falls all the way: 0 = excess + a·t − j·t²/2.
    let root = (acceleration * acceleration + 2.0 * jerk * excess).max(0.0).sqrt();
    if root <= deceleration {
        track.push((acceleration + root) / jerk, sign * acceleration, -sign * jerk);
        track.state.velocity = sign * limits.velocity;
        return;
    }
    track.push((acceleration + deceleration) / jerk, sign * acceleration, -sign * jerk);
    let left = sign * track.state.velocity - limits.velocity;
    track.push(left / deceleration, -sign * deceleration, 0.0);
    track.state.velocity = sign * limits.velocity;
    track.state.acceleration = -sign * deceleration;
}

/// A way to go, turned so that its end is further than that of the straight ramp.
#[derive(Clone, Copy, Debug)]
struct Way {
    /// Velocity and acceleration at the start.
    v0: f64,
    a0: f64,
    /// Velocity at the end.
    v1: f64,
    /// From start to end, u.
    length: f64,
    /// How far the end may be off, u.
    tolerance: f64,
}

/// From a state that keeps the velocity limit and can go on keeping it.
fn plan(track: &mut Track, target: f64, end_velocity: f64, limits: &Rates) {
    let start = track.state;
    let jerk = limits.jerk;
    let length = target - start.position;
    let settled = limits.settled(start.velocity, start.acceleration);
    let up = side(end_velocity - settled);
    let direct = limits.up(up * start.velocity, up * start.acceleration, up * end_velocity);
    let excess = length - up * direct.way;
    let tolerance = PRECISION * (length.abs() + direct.way.abs());
    if excess.abs() <= tolerance {
        direct.push(track, up, jerk);
        return;
    }
    let sign = side(excess);
    let way = Way {
        v0: sign * start.velocity,
        a0: sign * start.acceleration,
        v1: sign * end_velocity,
        length: sign * length,
        tolerance,
    };
    let settled = sign * settled;
    if way.a0 < 0.0
        && way.v1 < settled
        && let Some(alpha) = (Ease { way: &way, limits, settled }).alpha()
    {
        track.push((-alpha - way.a0) / jerk, sign * way.a0, sign * jerk);
        let velocity = settled + 0.5 * alpha * alpha / jerk;
        limits.up(-velocity, alpha, -way.v1).push(track, -sign, jerk);
        return;
    }
    let lowest = settled.max(way.v1).min(limits.velocity);
    let (up, down, cruise) = over_a_peak(&way, lowest, excess.abs(), limits);
    up.push(track, sign, jerk);
    track.push(cruise, 0.0, 0.0);
    down.push(track, -sign, jerk);
}

/// The ramps up to the velocity of the peak, which is at least `lowest`, and down from it, and how long it lasts. The
/// straight ramp ends `missing` before the target.
fn over_a_peak(way: &Way, lowest: f64, missing: f64, limits: &Rates) -> (Up, Up, f64) {
    let Rates { velocity: most, acceleration, deceleration, jerk, inverse } = *limits;
    let at = |peak: f64| (limits.up(way.v0, way.a0, peak), limits.up(-peak, 0.0, -way.v1));
    let excess = |up: &Up, down: &Up| up.way - down.way - way.length;
    // The derivative of the way, divided by the derivative of the time.
    let rates = |up: &Up, down: &Up| {
        let (p, q) = (up.last_peak(), down.first_peak());
        (1.0 / p + 1.0 / q, 0.5 * inverse * (p + q))
    };
    let (mut up, mut down) = at(most);
    let more = excess(&up, &down);
    if more <= 0.0 {
        return (up, down, -more / most);
    }
    // The peaks go to 0 with the root of v − lowest, so that the way is smooth over x = √(v − lowest).
    let (mut low, mut high) = (0.0, (most - lowest).sqrt());
    // Where both peaks are at their limits the way is a parabola over the velocity; near the lowest velocity it is about
    // 2·x³ + 4·lowest·x, divided by √j.
    let (curvature, slope) = rates(&up, &down);
    let rest = most * (curvature * most + 2.0 * slope) - 2.0 * more;
    let held = ((slope * slope + curvature * rest).max(0.0).sqrt() - slope) / curvature - lowest;
    let limit = acceleration.max(deceleration);
    let mut x = if held * jerk > limit * limit {
        held.sqrt()
    } else {
        let scaled = 0.5 * missing * jerk.sqrt();
        let cubic = scaled.cbrt();
        if scaled > 2.0 * lowest * cubic { cubic } else { scaled / (2.0 * lowest) }
    };
    for _ in 0..MOST_STEPS {
        if !(low < x && x < high) {
            x = 0.5 * (low + high);
        }
        let peak = lowest + x * x;
        (up, down) = at(peak);
        let more = excess(&up, &down);
        if more.abs() <= way.tolerance {
            break;
        }
        if more > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let (curvature, slope) = rates(&up, &down);
        let next = x - more / (2.0 * x * (peak * curvature + slope));
        if next.total_cmp(&x).is_eq() {
            break;
        }
        x = next;
    }
    (up, down, 0.0)
}
