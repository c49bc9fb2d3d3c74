//! Trapezoidal velocity profile of one element (`TRAPEZOID` of `SMC_INT_VELMODE`, manual 6.2.9).

use crate::planned_motion::{Law, PathState, Piece};
use twin_path::PathElement;

/// Velocity over time along one element: constant acceleration from the start velocity to the peak, constant
/// velocity, constant deceleration to the end velocity. Each of the three may have no duration.
///
/// The rising part is computed from the start of the element and the falling part back from its end, so that both
/// ends are met exactly and rounding is left where they meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    length: f64,
    start_velocity: f64,
    /// In the middle part.
    peak_velocity: f64,
    end_velocity: f64,
    /// In the first part, negative where the path starts too fast.
    acceleration: f64,
    deceleration: f64,
    /// Length of the first part, m.
    rise_length: f64,
    /// Durations of the three parts, s.
    rise: f64,
    cruise: f64,
    fall: f64,
}

/// Limits of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    /// Largest velocity, m/s.
    pub(super) feed: f64,
    /// Acceleration, m/s².
    pub(super) acceleration: f64,
    /// Deceleration, m/s², positive.
    pub(super) deceleration: f64,
}

impl Limits {
    /// Those of `element` with all velocities times `scale`.
    pub(super) fn of(element: &PathElement, scale: f64) -> Self {
        Self {
            feed: scale * element.feed,
            acceleration: element.acceleration,
            deceleration: element.deceleration,
        }
    }
}

impl Profile {
    /// The fastest profile over `length` from `start_velocity` to `end_velocity`, both at most the feed and each
    /// within reach of the other up to rounding (|v₁² − v₀²| ≤ 2·a·length).
    ///
    /// Accelerations come out as given, never a little larger to make ends meet. Where rounding has put an end
    /// velocity out of reach, the velocity is off by that rounding instead.
    pub(super) fn new(length: f64, start_velocity: f64, end_velocity: f64, limits: Limits) -> Self {
        let Limits { feed, acceleration, deceleration } = limits;
        let (v0, v1) = (start_velocity, end_velocity);
        // Differences of squares as products: exact where the velocities are nearly equal.
        let length_to_feed = |v: f64, rate: f64| ((feed - v) * (feed + v) / (2.0 * rate)).max(0.0);
        let (up, down) = (length_to_feed(v0, acceleration), length_to_feed(v1, deceleration));
        let (rise_length, cruise_length, fall_length, peak) = if up + down <= length {
            (up, length - up - down, down, feed)
        } else {
            // Where v0² + 2·a·s meets v1² + 2·d·(length − s), from either side: the difference of the two lengths
            // would lose the digits of the shorter one.
            let difference = (v1 - v0) * (v1 + v0);
            let sum = 2.0 * (acceleration + deceleration);
            let rise = ((2.0 * deceleration * length + difference) / sum).min(length).max(0.0);
            let fall = ((2.0 * acceleration * length - difference) / sum).min(length).max(0.0);
            (rise, 0.0, fall, (v0 * v0 + 2.0 * acceleration * rise).sqrt().min(feed))
        };
        let peak = peak.max(v0).max(v1);
        Self {
            length,
            start_velocity,
            peak_velocity: peak,
            end_velocity,
            acceleration,
            deceleration,
            rise_length,
            rise: ramp_time(rise_length, v0 + peak),
            cruise: ramp_time(cruise_length, 2.0 * peak),
            fall: ramp_time(fall_length, peak + v1),
        }
    }

    /// Constant deceleration over `length` from `start_velocity` to an `end_velocity` that fits it up to rounding.
    pub(super) fn braking(
        length: f64,
        start_velocity: f64,
        end_velocity: f64,
        deceleration: f64,
    ) -> Self {
        Self {
            length,
            start_velocity,
            peak_velocity: start_velocity,
            end_velocity,
            acceleration: 0.0,
            deceleration,
            rise_length: 0.0,
            rise: 0.0,
            cruise: 0.0,
            fall: ramp_time(length, start_velocity + end_velocity),
        }
    }

    /// From a `start_velocity` above the feed: down to the feed with the deceleration, then as [`Self::new`]. Where
    /// the length does not suffice for that, braking all the way.
    pub(super) fn slowing(
        length: f64,
        start_velocity: f64,
        end_velocity: f64,
        limits: Limits,
    ) -> Self {
        let Limits { feed, deceleration, .. } = limits;
        let slowing = (start_velocity - feed) * (start_velocity + feed) / (2.0 * deceleration);
        if slowing >= length {
            return Self::braking(length, start_velocity, end_velocity, deceleration);
        }
        let rest = Self::new(length - slowing, feed, end_velocity, limits);
        Self {
            length,
            start_velocity,
            acceleration: -deceleration,
            rise_length: slowing,
            rise: ramp_time(slowing, start_velocity + feed),
            ..rest
        }
    }

    /// Time from start to end, s.
    pub fn duration(&self) -> f64 {
        self.rise + self.cruise + self.fall
    }

    /// Durations of acceleration, constant velocity and deceleration, s.
    pub fn phases(&self) -> [f64; 3] {
        [self.rise, self.cruise, self.fall]
    }

    /// Path length from start to end, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Largest velocity, m/s.
    pub fn peak_velocity(&self) -> f64 {
        self.peak_velocity.max(self.start_velocity)
    }

    /// Velocity at the end, m/s.
    pub fn end_velocity(&self) -> f64 {
        self.end_velocity
    }

    /// Its parts of constant acceleration: begin (s), path length there (m) and law.
    pub(super) fn parts(&self) -> [(f64, f64, Law); 3] {
        let law = |velocity, acceleration| Law::Poly { velocity, acceleration, jerk: 0.0 };
        let (last, gain) = (self.rise + self.cruise, self.deceleration * self.fall);
        let left = (self.end_velocity + 0.5 * gain) * self.fall;
        [
            (0.0, 0.0, law(self.start_velocity, self.acceleration)),
            (self.rise, self.rise_length, law(self.peak_velocity, 0.0)),
            (last, self.length - left, law(self.end_velocity + gain, -self.deceleration)),
        ]
    }

    /// State `time` s after the start. Where the acceleration steps it is the one that follows; before the start
    /// and after the end the state is that of the start and the end.
    pub fn at(&self, time: f64) -> PathState {
        let time = time.max(0.0);
        let remaining = self.duration() - time;
        let (position, velocity, acceleration) = if time < self.rise {
            let gain = self.acceleration * time;
            (
                (self.start_velocity + 0.5 * gain) * time,
                self.start_velocity + gain,
                self.acceleration,
            )
        } else if remaining > self.fall {
            (self.rise_length + self.peak_velocity * (time - self.rise), self.peak_velocity, 0.0)
        } else if remaining > 0.0 {
            let gain = self.deceleration * remaining;
            let left = (self.end_velocity + 0.5 * gain) * remaining;
            (self.length - left, self.end_velocity + gain, -self.deceleration)
        } else {
            (self.length, self.end_velocity, 0.0)
        };
        // Only rounding lies outside.
        PathState {
            position: position.min(self.length).max(0.0),
            velocity: velocity.min(self.peak_velocity.max(self.start_velocity)).max(0.0),
            acceleration,
        }
    }
}

/// The fastest pieces along `length`, m, with constant accelerations `up` and `down` (m/s²), from and to these velocities
/// and with `feed` at most (m/s): as the controller plans an element on its own.
pub fn trapezoid(length: f64, ends: [f64; 2], feed: f64, [up, down]: [f64; 2]) -> Vec<Piece> {
    let limits = Limits { feed, acceleration: up, deceleration: down };
    let reach = |from: f64, rate: f64| (from * from + 2.0 * rate * length).sqrt();
    let [from, to] = ends.map(|velocity| velocity.min(feed));
    let [from, to] = [from.min(reach(to, down)), to.min(reach(from, up))];
    let profile = Profile::new(length, from, to, limits);
    let parts = profile.parts();
    let begins = parts.iter().skip(1).map(|(begin, ..)| *begin);
    let ends = begins.chain([profile.duration()]);
    let pieces = parts.iter().zip(ends).map(|((begin, from, law), end)| Piece {
        from: *from,
        duration: end - begin,
        law: *law,
    });
    pieces.filter(|piece| piece.duration > 0.0).collect()
}

/// Time for `length` at half of `sum_of_velocities`, s; 0 for nothing to travel.
fn ramp_time(length: f64, sum_of_velocities: f64) -> f64 {
    if length > 0.0 { 2.0 * length / sum_of_velocities } else { 0.0 }
}
