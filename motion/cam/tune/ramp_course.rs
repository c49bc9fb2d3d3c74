//! What a ramp and the cam beside it reach together.

use super::super::polynomial::{Coefficients, Extremes, extremes, value};
use super::along::along;
use super::ramp_in::Problem;
use super::ramp_wish::RampIn;
use super::swing::Swing;
use crate::axis::profile::RampType;
use std::f64::consts::{FRAC_PI_2, PI};

/// The motion of a ramp.
#[derive(Debug)]
pub(super) struct Way {
    /// Where the master is on the scale of the cam when it begins.
    pub(super) place: f64,
    /// The slave's velocity beside the cam's, u/s.
    pub(super) velocity: f64,
    /// How long each stretch takes, s, its acceleration at the beginning, u/s², its jerk there, u/s³, and the angular
    /// frequency with which the acceleration swings, rad/s.
    pub(super) pieces: Vec<[f64; 4]>,
}

impl Way {
    /// The largest velocity where stretches end, u/s.
    pub(super) fn reached(&self) -> f64 {
        let ends = self.pieces.iter().scan(self.velocity, |velocity, piece| {
            let [duration, acceleration, jerk, angular] = *piece;
            *velocity += Pull { acceleration, jerk, angular }.later(duration).1;
            Some(velocity.abs())
        });
        ends.fold(0.0, f64::max)
    }
}

/// A stretch of a ramp from some moment on: acceleration and jerk then, and the angular frequency.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    pub(super) acceleration: f64,
    pub(super) jerk: f64,
    pub(super) angular: f64,
}

/// Polynomial and sine of a motion.
pub(super) type Motion = (Coefficients, Swing);

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

    /// Way, velocity, acceleration and jerk from a velocity on, over what passes `rate` s each.
    pub(super) fn motion(&self, velocity: f64, rate: f64) -> [Motion; 4] {
        let Self { acceleration, jerk, angular } = *self;
        let still = Swing::default();
        if angular == 0.0 {
            let (a, j) = (acceleration, jerk);
            return [
                [0.0, velocity * rate, a / 2.0 * rate * rate, j / 6.0 * rate.powi(3)],
                [velocity, a * rate, j / 2.0 * rate * rate, 0.0],
                [a, j * rate, 0.0, 0.0],
                [j, 0.0, 0.0, 0.0],
            ]
            .map(|[c0, c1, c2, c3]| ([c0, c1, c2, c3, 0.0, 0.0, 0.0], still));
        }
        // â·sin(φ + ωt), its integrals and its derivative.
        let amplitude = acceleration.hypot(jerk / angular);
        let phase = acceleration.atan2(jerk / angular);
        let (sin, cos) = phase.sin_cos();
        let (of_velocity, of_way) = (amplitude / angular, amplitude / (angular * angular));
        let swing = |amplitude: f64, by: f64| Swing {
            amplitude,
            phase: phase + by,
            angular: angular * rate,
        };
        let line = |c0: f64, c1: f64| [c0, c1, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mean = velocity + of_velocity * cos;
        [
            (line(of_way * sin, mean * rate), swing(of_way, PI)),
            (line(mean, 0.0), swing(of_velocity, -FRAC_PI_2)),
            (line(0.0, 0.0), swing(amplitude, 0.0)),
            (line(0.0, 0.0), swing(amplitude * angular, FRAC_PI_2)),
        ]
    }
}

/// Extremes of what the cam does and of what the ramp does beside it.
fn together(of_cam: &Coefficients, (ramp, swing): &Motion, width: f64) -> Extremes {
    let mut sum = *of_cam;
    for (sum, ramp) in sum.iter_mut().zip(ramp) {
        *sum += ramp;
    }
    swing.extremes(&sum, width)
}

/// What a ramp and the cam beside it reach, stretch by stretch.
#[derive(Clone, Debug)]
pub(super) struct Course {
    pub(super) ramp: RampIn,
    /// Least and greatest velocity, acceleration and jerk of each stretch of the ramp; none of one that takes no time.
    pub(super) stretches: Vec<Option<[[f64; 2]; 3]>>,
    /// The steps of the ramp's acceleration, each with what follows within a cycle, u/s².
    pub(super) steps: Vec<f64>,
}

fn ends(extremes: &Extremes) -> [f64; 2] {
    [extremes.min, extremes.max]
}

fn magnitude([least, greatest]: [f64; 2]) -> f64 {
    least.abs().max(greatest.abs())
}

impl Problem<'_> {
    /// What ramp and cam reach together.
    pub(super) fn follow(&self, way: &Way, course: &mut Course) {
        let Course { ramp: found, stretches, steps } = course;
        let speed = self.speed();
        let factor = self.wish.input.slave_scaling;
        let Way { mut velocity, place, .. } = *way;
        let mut from = place;
        let mut position = self.wish.slave.position;
        let mut jerks = [Extremes::NONE; 2];
        // The slave comes without acceleration, and the cam has its own from the start on.
        let table = &self.wish.table;
        let here = self.curve();
        let here = if table.periodic { here.repeated(place) } else { here.at(place) };
        let mut changes = vec![(0.0, -here.acceleration * speed * speed * factor)];
        for [duration, acceleration, jerk, angular] in way.pieces.iter().copied() {
            let distance = speed * duration;
            if duration > 0.0 {
                changes.push((found.duration_s, acceleration));
            }
            let pull = Pull { acceleration, jerk, angular };
            let mut both = [Extremes::NONE; 3];
            let mut reached = Extremes::NONE;
            along(
                self.curve(),
                from,
                distance,
                self.wish.table.periodic,
                &mut |[y, first, second, third], width, gone| {
                    // Time is the way over the speed; a master that stands takes the whole duration at one place.
                    let stands = speed == 0.0;
                    let (rate, width) =
                        if stands { (1.0, duration) } else { (1.0 / speed.abs(), width) };
                    let since = if stands { 0.0 } else { gone * rate };
                    // What the cam does over the way, or at its place over the time.
                    let of_cam = |c: Coefficients, by: f64| {
                        let c = c.map(|c| c * by);
                        if stands { [c[0], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] } else { c }
                    };
                    let (now, gained) = pull.later(since);
                    let [way, v, a, j] = now.motion(velocity + gained, rate);
                    let [of_velocity, of_acceleration, of_jerk] = &mut both;
                    let sum = of_cam(first, speed * factor);
                    of_velocity.join(&together(&sum, &v, width), 0.0);
                    let sum = of_cam(second, speed * speed * factor);
                    of_acceleration.join(&together(&sum, &a, width), 0.0);
                    let [alone, _] = &mut jerks;
                    let sum = of_cam(third, speed.powi(3) * factor);
                    alone.join(&extremes(&sum, width), 0.0);
                    of_jerk.join(&together(&sum, &j, width), 0.0);
                    // From where the stretch begins on.
                    let mut sum = of_cam(y, factor);
                    sum[0] = position;
                    reached.join(&together(&sum, &way, width), 0.0);
                    let (ramp, swing) = &way;
                    position = value(&sum, width) + swing.value(ramp, width);
                },
            );
            let [_, beside] = &mut jerks;
            beside.join(&both[2], 0.0);
            let both = both.map(|extremes| ends(&extremes));
            stretches.push((duration > 0.0).then_some(both));
            if duration > 0.0 {
                let [v, a, _] = both.map(magnitude);
                found.peak_velocity = found.peak_velocity.max(v);
                found.peak_acceleration = found.peak_acceleration.max(a);
                let [least, greatest] = &mut found.positions;
                (*least, *greatest) = (least.min(reached.min), greatest.max(reached.max));
            }
            found.duration_s += duration;
            velocity += pull.later(duration).1;
            from += distance;
        }
        if way.pieces.is_empty() {
            return;
        }
        changes.push((found.duration_s, 0.0));
        let [of_cam, of_both] = jerks.map(|extremes| magnitude(ends(&extremes)));
        found.peak_cam_jerk = of_cam;
        *steps = self.steps(&changes);
        let largest = steps.iter().copied().fold(0.0, f64::max);
        found.peak_jerk = match self.wish.ramp {
            RampType::Trapezoid => largest / self.wish.cycle_s + of_cam,
            // Rounding aside it is no more than the ramp's own and the cam's.
            RampType::Sigmoid | RampType::Parabolic => of_both.min(found.ramp_jerk + of_cam),
        };
    }

    /// The changes of the ramp's acceleration within a cycle each, of its times and values from then on.
    fn steps(&self, changes: &[(f64, f64)]) -> Vec<f64> {
        let mut steps = Vec::with_capacity(changes.len());
        for (index, (_, before)) in changes.iter().enumerate() {
            let mut after = changes.iter().skip(index + 1);
            let Some((from, value)) = after.next() else { break };
            // What follows less than a cycle later changes it in the same one.
            let at_once = after.take_while(|(at, _)| at - from < self.wish.cycle_s);
            let first = (value - before).abs();
            steps.push(at_once.fold(first, |most, (_, value)| most.max((value - before).abs())));
        }
        steps
    }
}
