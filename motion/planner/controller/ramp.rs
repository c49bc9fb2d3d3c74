//! Velocity ramps without steps of the acceleration, which is 0 at both ends (`SIGMOID`, manual 6.2.9, and limited
//! jerk).

use super::VelocityMode;
use super::setpoint::Status;
use crate::planned_motion::Law;
use crate::planned_motion::PathState;
use std::f64::consts::PI;

/// Shape of a ramp between two velocities.
///
/// Both shapes are symmetric about the middle of the ramp, so that every ramp is as long as its mean velocity times
/// its duration; they differ in the duration:
///
/// ```text
/// sin²:    v = v0 + Δv·sin²(πt/2T), T = |Δv|/a: as long as with constant acceleration; the largest is π/2·a
/// jerk j:  the acceleration rises with j to at most a and falls with j:
///          T = |Δv|/a + a/j, where |Δv| ≥ a²/j; else T = 2·√(|Δv|/j)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Smoothness {
    Sine,
    Jerk(f64),
}

impl Smoothness {
    /// That of `mode`; none for the trapezoid.
    pub(super) fn of(mode: VelocityMode) -> Option<Self> {
        match mode {
            VelocityMode::Sigmoid => Some(Self::Sine),
            VelocityMode::JerkLimited { jerk } if jerk > 0.0 && jerk.is_finite() => {
                Some(Self::Jerk(jerk))
            }
            VelocityMode::Trapezoid | VelocityMode::JerkLimited { .. } => None,
        }
    }

    /// Time for a change of the velocity by `change` m/s with at most `rate` m/s² (sin²: on average), s.
    fn duration(self, change: f64, rate: f64) -> f64 {
        match self {
            Self::Sine => change / rate,
            Self::Jerk(jerk) if change * jerk >= rate * rate => change / rate + rate / jerk,
            Self::Jerk(jerk) => 2.0 * (change / jerk).sqrt(),
        }
    }

    /// Length of the ramp between two velocities, m.
    pub(super) fn length(self, from: f64, to: f64, rate: f64) -> f64 {
        0.5 * (from + to) * self.duration((to - from).abs(), rate)
    }

    /// The largest velocity not below `velocity` and not above `limit` that a ramp over `length` joins with it.
    pub(super) fn reach(self, velocity: f64, length: f64, rate: f64, limit: f64) -> f64 {
        if limit <= velocity {
            return limit;
        }
        if self == Self::Sine {
            return (velocity * velocity + 2.0 * rate * length).sqrt().max(velocity).min(limit);
        }
        largest(velocity, limit, |v| self.length(velocity, v, rate) <= length)
    }

    /// The largest velocity between `least` and `limit` to which the path can go up, and from there to `end`, within
    /// `length`.
    pub(super) fn peak(
        self,
        [start, end]: [f64; 2],
        length: f64,
        [up, down]: [f64; 2],
        limit: f64,
    ) -> f64 {
        let least = start.max(end);
        if limit <= least {
            return least;
        }
        largest(least, limit, |v| self.length(start, v, up) + self.length(v, end, down) <= length)
    }

    /// The largest velocity up to `most` to which the path can brake within `length`, if it can come to rest within it
    /// and not brake to `most`: under limited jerk the last bit down to rest is gone through faster than into another
    /// constant velocity.
    pub(super) fn below(self, velocity: f64, most: f64, length: f64, rate: f64) -> f64 {
        largest(0.0, most, |v| self.length(velocity, v, rate) <= length)
    }

    /// The smallest velocity from `least` to `velocity` to which the path can brake within `length`, if it cannot get
    /// below `least`.
    pub(super) fn slowest(self, velocity: f64, least: f64, length: f64, rate: f64) -> f64 {
        // The slower, the longer the ramp, as far as it fits at all.
        let change = largest(0.0, velocity - least, |change| {
            self.length(velocity, velocity - change, rate) <= length
        });
        velocity - change
    }
}

/// The largest value from `low`, which fits, to `high` that `fits`, given that those that do lie below those that do
/// not. By bisection down to neighbouring numbers, or nearly.
fn largest(low: f64, high: f64, fits: impl Fn(f64) -> bool) -> f64 {
    if fits(high) {
        return high;
    }
    let (mut low, mut high) = (low, high);
    for _ in 0..60 {
        let middle = low.midpoint(high);
        if fits(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// One ramp, or a stretch at constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramp {
    start_velocity: f64,
    end_velocity: f64,
    length: f64,
    duration: f64,
    shape: Shape,
    /// Beginning of what is left of a ramp that was cut, s; the velocity is then lower by `less`, and the position
    /// counted from `before`.
    skipped: f64,
    less: f64,
    before: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Constant,
    Sine,
    /// The acceleration changes during this time at both ends, s.
    Jerk(f64),
}

impl Ramp {
    /// Along `length` with constant velocity.
    pub(super) fn constant(velocity: f64, length: f64) -> Self {
        let duration = if velocity > 0.0 { length / velocity } else { 0.0 };
        Self::new(velocity, velocity, length, duration, Shape::Constant)
    }

    /// Between two velocities, with `rate` as far as rounding lets it go by exactly `length`, which is
    /// [`Smoothness::length`] or more.
    pub(super) fn over(
        length: f64,
        [from, to]: [f64; 2],
        rate: f64,
        smoothness: Smoothness,
    ) -> Self {
        let sum = from + to;
        let duration = if sum > 0.0 && length > 0.0 { 2.0 * length / sum } else { 0.0 };
        let shape = match smoothness {
            Smoothness::Sine => Shape::Sine,
            Smoothness::Jerk(jerk) => {
                let change = (to - from).abs();
                let part = if change * jerk >= rate * rate {
                    // What the duration has more than needed is spread over the whole.
                    rate / jerk * (duration / smoothness.duration(change, rate))
                } else {
                    0.5 * duration
                };
                Shape::Jerk(part.min(0.5 * duration))
            }
        };
        Self::new(from, to, length, duration, shape)
    }

    /// Between two velocities, as fast as may be.
    pub(super) fn between(velocities: [f64; 2], rate: f64, smoothness: Smoothness) -> Self {
        let [from, to] = velocities;
        Self::over(smoothness.length(from, to, rate), velocities, rate, smoothness)
    }

    fn new(
        start_velocity: f64,
        end_velocity: f64,
        length: f64,
        duration: f64,
        shape: Shape,
    ) -> Self {
        let duration = if duration.is_finite() { duration } else { 0.0 };
        Self {
            start_velocity,
            end_velocity,
            length,
            duration,
            shape,
            skipped: 0.0,
            less: 0.0,
            before: 0.0,
        }
    }

    /// From now, `time` s after the start, without further acceleration: what lies between the present acceleration and
    /// the same one on its way back to 0 is left out, so that the acceleration stays continuous. None if it is on its
    /// way back already, or the ramp goes down.
    pub(super) fn cut(self, time: f64) -> Option<Self> {
        let time = time + self.skipped;
        let full = self.duration + self.skipped;
        if self.end_velocity <= self.start_velocity || time >= 0.5 * full || self.skipped > 0.0 {
            return None;
        }
        let (now, later) = (self.at(time), self.at(full - time));
        let less = later.velocity - now.velocity;
        let duration = time;
        Some(Self {
            end_velocity: self.end_velocity - less,
            length: (self.length - later.position - less * duration).max(0.0),
            duration,
            skipped: full - time,
            less,
            before: later.position,
            ..self
        })
    }

    pub(super) fn length(&self) -> f64 {
        self.length
    }

    pub(super) fn duration(&self) -> f64 {
        self.duration
    }

    pub(super) fn end_velocity(&self) -> f64 {
        self.end_velocity
    }

    /// Status of the interpolator during it.
    pub(super) fn status(&self) -> Status {
        Status::of_acceleration(if self.shape == Shape::Constant {
            0.0
        } else {
            self.end_velocity - self.start_velocity
        })
    }

    /// True if the velocity is the same all along.
    pub(super) fn is_constant(&self) -> bool {
        self.shape == Shape::Constant
    }

    /// Its parts with one law each: begin (s), path length there (m) and law.
    pub(super) fn parts(&self) -> Vec<(f64, f64, Law)> {
        let part = |time: f64, jerk: f64| {
            let PathState { position, velocity, acceleration } = self.at(time);
            (time, position, Law::Poly { velocity, acceleration, jerk })
        };
        let full = self.duration + self.skipped;
        let change = self.end_velocity + self.less - self.start_velocity;
        match self.shape {
            Shape::Constant => vec![part(0.0, 0.0)],
            Shape::Sine => {
                let velocity = self.start_velocity - self.less;
                let (angular, skipped) = (PI / full, self.skipped);
                vec![(0.0, 0.0, Law::Sine { velocity, change, angular, skipped })]
            }
            Shape::Jerk(bend) => {
                let jerk = change / (full - bend) / bend;
                let parts = [(0.0, jerk), (bend, 0.0), (full - bend, -jerk)];
                let cut = parts.map(|(from, jerk)| ((from - self.skipped).max(0.0), jerk));
                cut.map(|(from, jerk)| part(from, jerk)).into()
            }
        }
    }

    /// When the path length is `position`, s after the start.
    pub(super) fn time_at(&self, position: f64) -> f64 {
        largest(0.0, self.duration, |time| self.at(time).position <= position)
    }

    /// State `time` s after the start; before it and after the end that of the start and the end.
    pub(super) fn at(&self, time: f64) -> PathState {
        if time >= self.duration {
            return PathState {
                position: self.length,
                velocity: self.end_velocity,
                acceleration: 0.0,
            };
        }
        let time = time.max(0.0);
        let state = self.uncut(time + self.skipped);
        PathState {
            position: (state.position - self.before - self.less * time).min(self.length).max(0.0),
            velocity: (state.velocity - self.less).max(0.0),
            acceleration: state.acceleration,
        }
    }

    fn uncut(&self, time: f64) -> PathState {
        let (v0, full) = (self.start_velocity, self.duration + self.skipped);
        let change = self.end_velocity + self.less - v0;
        match self.shape {
            Shape::Constant => PathState { position: v0 * time, velocity: v0, acceleration: 0.0 },
            Shape::Sine => {
                let angular = PI / full;
                let (sin, cos) = (angular * time).sin_cos();
                PathState {
                    position: v0 * time + 0.5 * change * (time - sin / angular),
                    velocity: v0 + 0.5 * change * (1.0 - cos),
                    acceleration: 0.5 * change * angular * sin,
                }
            }
            Shape::Jerk(part) => {
                let peak = change / (full - part);
                let left = full - time;
                if time < part {
                    let acceleration = peak * time / part;
                    PathState {
                        position: (v0 + acceleration * time / 6.0) * time,
                        velocity: v0 + 0.5 * acceleration * time,
                        acceleration,
                    }
                } else if left > part {
                    let middle = time - 0.5 * part;
                    PathState {
                        position: v0 * time + 0.5 * peak * (middle * middle + part * part / 12.0),
                        velocity: v0 + peak * middle,
                        acceleration: peak,
                    }
                } else {
                    let acceleration = peak * left / part;
                    let v1 = v0 + change;
                    let whole = 0.5 * (v0 + v1) * full;
                    PathState {
                        position: whole - (v1 - acceleration * left / 6.0) * left,
                        velocity: v1 - 0.5 * acceleration * left,
                        acceleration,
                    }
                }
            }
        }
    }
}
