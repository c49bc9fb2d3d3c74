//! Peaks and positions of a ramp and its cam together.

use super::super::along::along;
use super::passes::parts;
use super::problem::Problem;
use super::wish::RampIn;
use crate::polynomial::{Coefficients, Extremes, extremes, shifted, value};
use twin_profile::RampType;

/// The motion of a ramp.
#[derive(Debug)]
pub(super) struct Way {
    /// The slave's velocity relative to the cam's, u/s.
    pub(super) velocity: f64,
    /// How long each stretch takes, s, its acceleration at the beginning, u/s², its jerk there, u/s³, and the angular
    /// frequency of its sine, rad/s; a sine takes [`SPAN`] at most.
    pub(super) pieces: Vec<[f64; 4]>,
}

/// Sines are split into parts of this angle, rad.
const SPAN: f64 = 0.2;

impl Way {
    pub(super) fn new(velocity: f64, stretches: impl Iterator<Item = [f64; 4]>) -> Self {
        let mut pieces = Vec::new();
        for [duration, acceleration, jerk, angular] in stretches {
            let pull = Pull { acceleration, jerk, angular };
            let parts = (angular * duration / SPAN).ceil().clamp(1.0, 1e4);
            let part = duration / parts;
            let mut index = 0.0;
            while index < parts {
                let (Pull { acceleration, jerk, .. }, _) = pull.later(index * part);
                pieces.push([part, acceleration, jerk, angular]);
                index += 1.0;
            }
        }
        Self { velocity, pieces }
    }

    /// How long it takes, s.
    pub(super) fn duration(&self) -> f64 {
        self.pieces.iter().map(|[duration, ..]| duration).sum()
    }

    /// The largest velocity that it reaches.
    pub(super) fn fastest(&self) -> f64 {
        let mut velocity = self.velocity;
        let mut most = velocity.abs();
        for [duration, acceleration, jerk, angular] in self.pieces.iter().copied() {
            velocity += Pull { acceleration, jerk, angular }.later(duration.max(0.0)).1;
            most = most.max(velocity.abs());
        }
        most
    }
}

/// What a ramp does from some moment of a stretch on: acceleration and jerk then, and the angular frequency.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    pub(super) acceleration: f64,
    pub(super) jerk: f64,
    pub(super) angular: f64,
}

impl Pull {
    /// The same stretch `time` s later, and by how much the velocity has changed.
    pub(super) fn later(&self, time: f64) -> (Self, f64) {
        let Self { acceleration, jerk, angular } = *self;
        if angular == 0.0 {
            let later = Self { acceleration: acceleration + jerk * time, ..*self };
            return (later, time * (acceleration + jerk * time / 2.0));
        }
        let (sin, cos) = (angular * time).sin_cos();
        let half = (0.5 * angular * time).sin();
        let later = Self {
            acceleration: acceleration * cos + jerk / angular * sin,
            jerk: jerk * cos - acceleration * angular * sin,
            angular,
        };
        (later, (acceleration * sin + jerk / angular * 2.0 * half * half) / angular)
    }

    /// Way, velocity, acceleration and jerk from a velocity on for `span` s, over what passes `rate` s each. Sines are expanded about
    /// the middle of the span: up to [`SPAN`] that is exact but for 2e-11 of their amplitude.
    pub(super) fn motion(&self, velocity: f64, span: f64, rate: f64) -> [Coefficients; 4] {
        let middle = span / 2.0;
        let (Self { acceleration, jerk, angular }, gained) = self.later(middle);
        // The derivatives of the way in the middle, from the velocity on.
        let mut derivatives = [velocity + gained, acceleration, jerk, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for index in 3..derivatives.len() {
            derivatives[index] = -angular * angular * derivatives[index - 2];
        }
        [0, 1, 2, 3].map(|first: usize| {
            let mut c: Coefficients = [0.0; 7];
            let mut by = 1.0;
            for (power, slot) in (0_u32..).zip(&mut c) {
                by /= f64::from(power.max(1));
                // The way itself begins with 0.
                let order = first + usize::try_from(power).unwrap_or_default();
                *slot = order.checked_sub(1).map_or(0.0, |order| by * derivatives[order]);
            }
            let mut c = shifted(&c, -middle);
            c[0] = if first == 0 { 0.0 } else { c[0] };
            let mut passed = 1.0;
            c.map(|c| {
                let value = c * passed;
                passed *= rate;
                value
            })
        })
    }
}

/// Extremes of what the cam does and of what the ramp adds to it.
fn together(of_cam: &Coefficients, ramp: &Coefficients, width: f64) -> Extremes {
    extremes(&std::array::from_fn(|index| of_cam[index] + ramp[index]), width)
}

fn magnitude(extremes: &Extremes) -> f64 {
    extremes.min.abs().max(extremes.max.abs())
}

/// Where a stretch of a ramp begins.
struct Begin {
    /// s after the start.
    time: f64,
    /// The slave's velocity on top of the cam's, u/s, and its way on top of it, u.
    velocity: f64,
    gone: f64,
}

impl Problem<'_> {
    /// Adds to a ramp what ramp and cam reach together.
    pub(super) fn follow(&self, way: &Way, found: &mut RampIn) {
        let mut begin = Begin { time: 0.0, velocity: way.velocity, gone: 0.0 };
        // The slave comes without acceleration, and the cam has its own from the start on.
        let mut changes = vec![(0.0, -self.cam_at(self.place).acceleration)];
        for [duration, acceleration, jerk, angular] in way.pieces.iter().copied() {
            if duration <= 0.0 {
                continue;
            }
            changes.push((begin.time, acceleration));
            let pull = Pull { acceleration, jerk, angular };
            self.follow_stretch(&begin, &pull, duration, found);
            begin.gone += value(&pull.motion(begin.velocity, duration, 1.0)[0], duration);
            begin.velocity += pull.later(duration).1;
            begin.time += duration;
        }
        found.duration_s = begin.time;
        if changes.len() == 1 {
            return;
        }
        changes.push((begin.time, 0.0));
        found.peak_jerk = match self.wish.ramp {
            RampType::Trapezoid => {
                self.largest_step(&changes) / self.wish.cycle_s + found.peak_cam_jerk
            }
            // Rounding aside it is at most the ramp's own and the cam's.
            RampType::Sigmoid | RampType::Parabolic => {
                found.peak_jerk.min(found.ramp_jerk + found.peak_cam_jerk)
            }
        };
    }

    /// Adds the peaks and positions of a stretch.
    fn follow_stretch(&self, begin: &Begin, pull: &Pull, duration: f64, found: &mut RampIn) {
        let speed = self.speed();
        let factor = self.wish.input.slave_scaling;
        let curve = self.curve();
        let repeated = self.wish.table.periodic;
        // Time is the way over the speed; a master at rest takes the whole duration at one place.
        let rests = speed == 0.0;
        let rate = if rests { 1.0 } else { 1.0 / speed.abs() };
        let width = curve.end() - curve.start();
        let pass = if repeated { width / speed.abs() } else { f64::INFINITY };
        let mean = curve.rise() / width * speed * factor;
        for [from, to] in parts(pull, begin.velocity + mean, duration, pass) {
            let place = self.place + speed * (begin.time + from);
            let mut position = self.position(begin, pull, from);
            let mut add = |[y, first, second, third]: [Coefficients; 4], width, gone| {
                let width = if rests { to - from } else { width };
                let since = if rests { from } else { from + gone * rate };
                // What the cam does over the way, or at its place over the time.
                let of_cam = |c: Coefficients, by: f64| {
                    let c = c.map(|c| c * by);
                    if rests { [c[0], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] } else { c }
                };
                let (now, gained) = pull.later(since);
                let span = if rests { to - from } else { width * rate };
                let [way, v, a, j] = now.motion(begin.velocity + gained, span, rate);
                let jerk = of_cam(third, speed.powi(3) * factor);
                for (peak, of_cam, of_ramp) in [
                    (&mut found.peak_velocity, of_cam(first, speed * factor), v),
                    (&mut found.peak_acceleration, of_cam(second, speed * speed * factor), a),
                    (&mut found.peak_jerk, jerk, j),
                ] {
                    *peak = peak.max(magnitude(&together(&of_cam, &of_ramp, width)));
                }
                found.peak_cam_jerk = found.peak_cam_jerk.max(magnitude(&extremes(&jerk, width)));
                let mut sum = of_cam(y, factor);
                sum[0] = position;
                let here = together(&sum, &way, width);
                let [least, greatest] = &mut found.positions;
                (*least, *greatest) = (least.min(here.min), greatest.max(here.max));
                position = value(&sum, width) + value(&way, width);
            };
            along(curve, place, speed * (to - from), repeated, &mut add);
        }
    }

    /// Where ramp and cam have the slave at a time after the begin of a stretch.
    fn position(&self, begin: &Begin, pull: &Pull, since: f64) -> f64 {
        let place = self.place + self.speed() * (begin.time + since);
        let of_cam = self.cam_at(place).position - self.cam_at(self.place).position;
        self.wish.slave.position
            + of_cam
            + begin.gone
            + value(&pull.motion(begin.velocity, since, 1.0)[0], since)
    }

    /// The largest change of the ramp's acceleration within a cycle, of its times and values from then on.
    fn largest_step(&self, changes: &[(f64, f64)]) -> f64 {
        let mut largest = 0.0_f64;
        for (index, (_, before)) in changes.iter().enumerate() {
            let after = changes.get(index + 1..).unwrap_or_default();
            let Some((from, _)) = after.first() else { break };
            // What follows less than a cycle later changes it in the same one.
            let at_once = after.iter().take_while(|(at, _)| at - from < self.wish.cycle_s);
            largest = at_once.fold(largest, |most, (_, value)| most.max((value - before).abs()));
        }
        largest
    }
}
