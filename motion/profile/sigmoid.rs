//! Sigmoid ramps: the velocity follows sin², so that the acceleration is half a sine (manual 2.1.3).
//!
//! ```text
//! a(t) = â·sin(φ + ωt), φ + ωT = π:   v1 − v0 = â/ω·(1 + cos φ),  a0 = â·sin φ,  â ≤ limit,  â·ω ≤ j
//! from a0 = 0:  T = max(π·Δv/2a, π·√(Δv/2j))
//! ```
//!
//! A ramp that starts with an acceleration in its own direction begins within the sine. An acceleration against it is
//! first taken back, with the largest jerk. If growth and fall of the speed have different limits, the velocity reaches
//! 0 with one half sine and goes on with another one. An acceleration that the jerk cannot end before 0 is held up to there.
//!
//! Motions to a position are composed like those of parabolic ramps: straight, eased at first, or over a velocity that
//! is held if it is the limit. They are not the fastest; there is exactly one of this form for every target.

use super::State;
use super::rates::{Rates, side};
use super::segment::{Segment, Track};

/// Steps of a search; each second one at least halves the bracket.
const MOST_STEPS: u32 = 160;

/// Part of the ways on the way that the end may be off.
const PRECISION: f64 = 1e-13;

/// Stretches of a ramp upwards: duration, acceleration and jerk at the beginning, angular frequency.
#[derive(Clone, Copy, Debug)]
struct Up {
    parts: [[f64; 4]; 3],
    count: usize,
    /// At the end, with the way as position.
    end: State,
}

impl Up {
    fn new(velocity: f64, acceleration: f64) -> Self {
        let end = State { position: 0.0, velocity, acceleration };
        Self { parts: [[0.0; 4]; 3], count: 0, end }
    }

    #[expect(clippy::indexing_slicing, reason = "two halves, and a part before the first one")]
    fn add(&mut self, duration: f64, jerk: f64, angular: f64) {
        let part = [duration, self.end.acceleration, jerk, angular];
        if duration > 0.0 {
            self.parts[self.count] = part;
            self.count += 1;
            self.end = Segment { start: 0.0, state: self.end, jerk, angular }.after(duration);
        }
    }

    /// Half a sine, or what is left of it, to a velocity.
    fn rise(&mut self, to: f64, limit: f64, jerk: f64) {
        if self.end.acceleration > limit {
            self.add((self.end.acceleration - limit) / jerk, -jerk, 0.0);
            self.end.acceleration = limit;
        }
        // Not below 0; −0 would be the other end of the sine.
        let a0 = self.end.acceleration.abs();
        let change = to - self.end.velocity;
        let rest = 2.0 * change * jerk - a0 * a0;
        if rest <= 1e-14 * a0 * a0 {
            // All of it is needed to take the acceleration back.
            self.add(a0 / jerk, -jerk, 0.0);
        } else {
            let square = change * change * jerk * jerk / rest;
            let cos = rest / (change * jerk) - 1.0;
            let (peak, cos, angular) = if cos <= 0.0 || square <= limit * limit {
                let peak = square.sqrt();
                (peak, cos, jerk / peak)
            } else {
                let cos = (1.0 - (a0 / limit) * (a0 / limit)).max(0.0).sqrt();
                (limit, cos, limit / change * (1.0 + cos))
            };
            let left = (a0 / peak).atan2(-cos);
            self.add(left / angular, peak * angular * cos, angular);
        }
        self.end.velocity = to;
        self.end.acceleration = 0.0;
    }

    /// Appends it, or with `sign` −1 its mirror image.
    fn push(&self, track: &mut Track, sign: f64) {
        for [duration, acceleration, jerk, angular] in self.parts.into_iter().take(self.count) {
            track.swing(duration, sign * acceleration, sign * jerk, angular);
        }
        track.state.velocity = sign * self.end.velocity;
        track.state.acceleration = 0.0;
    }
}

/// The ramp from a velocity and an acceleration up to a velocity that is not below that at which the acceleration,
/// taken back at once, gets 0.
fn up(limits: &Rates, velocity: f64, acceleration: f64, to: f64) -> Up {
    let Rates { acceleration: growth, deceleration: fall, jerk, .. } = *limits;
    let mut ramp = Up::new(velocity, acceleration);
    if acceleration < 0.0 {
        ramp.add(-acceleration / jerk, jerk, 0.0);
        ramp.end.acceleration = 0.0;
    }
    let (from, to) = (ramp.end.velocity, to.max(ramp.end.velocity));
    let settled = limits.settled(from, ramp.end.acceleration);
    if settled < 0.0 && to > 0.0 && growth.total_cmp(&fall).is_ne() {
        ramp.rise(0.0, fall, jerk);
        ramp.rise(to, growth, jerk);
        return ramp;
    }
    let mut limit = if to > 0.0 { growth } else { fall };
    if from < 0.0 && to > 0.0 && growth > fall {
        // The speed falls up to 0, and no jerk ends the acceleration before.
        let held = ramp.end.acceleration;
        if limits.settled(0.0, held) <= to {
            ramp.add(-from / held, 0.0, 0.0);
        } else {
            limit = fall.max(held);
        }
    }
    ramp.rise(to, limit, jerk);
    ramp
}

/// Goes to a velocity.
pub(super) fn ramp(track: &mut Track, velocity: f64, limits: &Rates) {
    let State { velocity: from, acceleration, .. } = track.state;
    let sign = side(velocity - limits.settled(from, acceleration));
    up(limits, sign * from, sign * acceleration, sign * velocity).push(track, sign);
}

/// Goes to a position and has `end_velocity`, at most the limit, there.
pub(super) fn to_position(track: &mut Track, target: f64, end_velocity: f64, limits: &Rates) {
    let (most, jerk) = (limits.velocity, limits.jerk);
    let settled = |state: State| limits.settled(state.velocity, state.acceleration);
    if settled(track.state).abs() > most {
        let limit = most.copysign(settled(track.state));
        ramp(track, limit, limits);
    }
    let start = track.state;
    let settled = settled(start);
    let length = target - start.position;
    let sign = side(end_velocity - settled);
    let direct = up(limits, sign * start.velocity, sign * start.acceleration, sign * end_velocity);
    let excess = length - sign * direct.end.position;
    let tolerance = PRECISION * (length.abs() + direct.end.position.abs());
    if excess.abs() <= tolerance {
        direct.push(track, sign);
        return;
    }
    let sign = side(excess);
    let [length, v0, a0, v1, settled] =
        [length, start.velocity, start.acceleration, end_velocity, settled].map(|x| sign * x);
    if a0 < 0.0 && v1 < settled {
        let eased = |alpha: f64| {
            let mut first = Up::new(v0, a0);
            first.add((-alpha - a0) / jerk, jerk, 0.0);
            let velocity = settled + 0.5 * alpha * alpha / jerk;
            let second = up(limits, -velocity, alpha, -v1);
            (first.end.position - second.end.position - length, first, second)
        };
        if eased(0.0).0 >= 0.0 {
            let alpha = zero(|alpha| eased(alpha).0, [-a0, 0.0], tolerance);
            let (_, mut first, second) = eased(alpha);
            first.end.velocity = settled + 0.5 * alpha * alpha / jerk;
            first.push(track, sign);
            second.push(track, -sign);
            return;
        }
    }
    let over = |peak: f64| {
        let (first, second) = (up(limits, v0, a0, peak), up(limits, -peak, 0.0, -v1));
        (first.end.position - second.end.position - length, first, second)
    };
    let lowest = settled.max(v1).min(most);
    let excess = over(most).0;
    let (peak, cruise) = if excess <= 0.0 {
        (most, -excess / most)
    } else {
        let x = zero(|x| over(lowest + x * x).0, [0.0, (most - lowest).sqrt()], tolerance);
        (lowest + x * x, 0.0)
    };
    let (_, first, second) = over(peak);
    first.push(track, sign);
    track.push(cruise, 0.0, 0.0);
    second.push(track, -sign);
}

/// Where a function that is negative at the first place and positive at the second one is 0 within a tolerance: by
/// secants that are kept from hanging on to one end (Illinois), and by halving each third time.
fn zero(function: impl Fn(f64) -> f64, [below, above]: [f64; 2], tolerance: f64) -> f64 {
    let (mut below, mut above) = (below, above);
    let (mut low, mut high) = (function(below), function(above));
    for step in 0..MOST_STEPS {
        let secant = (below * high - above * low) / (high - low);
        let inside = (secant - below) * (secant - above) < 0.0;
        let place = if inside && step % 3 != 2 { secant } else { 0.5 * (below + above) };
        let value = function(place);
        if value.abs() <= tolerance
            || place.total_cmp(&below).is_eq()
            || place.total_cmp(&above).is_eq()
        {
            return place;
        }
        if value < 0.0 {
            (below, low) = (place, value);
            high *= 0.5;
        } else {
            (above, high) = (place, value);
            low *= 0.5;
        }
    }
    0.5 * (below + above)
}
