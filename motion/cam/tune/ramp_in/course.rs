//! Motion of a ramp, and the extremes that ramp and cam reach together.

use super::super::super::polynomial::{Coefficients, Extremes, extremes, value};
use super::super::along::along;
use super::super::polynomial_extrema::Swing;
use super::passes::parts;
use super::problem::Problem;
use super::wish::RampIn;
use std::f64::consts::{FRAC_PI_2, PI};
use twin_profile::RampType;

/// The motion of a ramp.
#[derive(Debug)]
pub(super) struct Way {
    /// The slave's velocity beside the cam's, u/s.
    pub(super) velocity: f64,
    /// How long each stretch takes, s, its acceleration at the beginning, u/s², its jerk there, u/s³, and the angular
    /// frequency with which the acceleration swings, rad/s.
    pub(super) pieces: Vec<[f64; 4]>,
}

impl Way {
    /// How long it takes, s.
    pub(super) fn duration(&self) -> f64 {
        self.pieces.iter().map(|[duration, ..]| duration).sum()
    }

    /// The largest velocity, and the largest growth and fall of the speed, that it reaches, and its largest jerk: what is less than its
    /// values says that these do not hold it.
    pub(super) fn reached(&self) -> [f64; 4] {
        let mut velocity = self.velocity;
        let mut most = [velocity.abs(), 0.0, 0.0, 0.0];
        for [duration, acceleration, jerk, angular] in self.pieces.iter().copied() {
            if duration <= 0.0 {
                continue;
            }
            let pull = Pull { acceleration, jerk, angular };
            let (end, gained) = pull.later(duration);
            let middle = pull.later(duration / 2.0);
            let grows = (velocity + middle.1) * middle.0.acceleration > 0.0;
            let swings = if angular > 0.0 && jerk * end.jerk < 0.0 {
                acceleration.hypot(jerk / angular)
            } else {
                0.0
            };
            let pulled = acceleration.abs().max(end.acceleration.abs()).max(swings);
            velocity += gained;
            let [v, up, down, j] = &mut most;
            *v = v.max(velocity.abs());
            let side = if grows { up } else { down };
            *side = side.max(pulled);
            *j = j.max(jerk.abs()).max(end.jerk.abs());
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

/// What a ramp and the cam beside it reach.
#[derive(Clone, Debug)]
pub(super) struct Course {
    pub(super) ramp: RampIn,
    /// The stretches of the ramp that take some time.
    pub(super) stretches: Vec<Stretch>,
    /// What is reached on each of them beside each piece of the cam, in their order.
    pub(super) reached: Vec<Reached>,
    /// The steps of the ramp's acceleration, each with what follows within a cycle, u/s²: where each stretch begins, and at the
    /// end.
    pub(super) steps: Vec<f64>,
}

/// A stretch of a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    /// The signs of acceleration and jerk: a stretch of one kind stays one where values change a little.
    pub(super) kind: [i8; 2],
    /// s.
    pub(super) duration: f64,
}

impl Stretch {
    fn new(pull: &Pull, duration: f64) -> Self {
        let sign = |value: f64| i8::from(value > 0.0) - i8::from(value < 0.0);
        let middle = pull.later(duration / 2.0).0;
        Self { kind: [sign(middle.acceleration), sign(pull.jerk)], duration }
    }
}

/// What is reached on a stretch beside a piece of the cam.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reached {
    pub(super) stretch: usize,
    /// Counted through all passes.
    pub(super) piece: i64,
    /// Least and greatest velocity, acceleration and jerk.
    pub(super) ends: [[f64; 2]; 3],
}

fn magnitude(extremes: &Extremes) -> f64 {
    extremes.min.abs().max(extremes.max.abs())
}

/// Where a stretch of a ramp begins.
struct Begin {
    /// Which it is.
    stretch: usize,
    /// s after the start.
    time: f64,
    /// The slave's velocity beside the cam's, u/s, and how far it has gone beside it, u.
    velocity: f64,
    gone: f64,
}

impl Problem<'_> {
    /// What ramp and cam reach together.
    pub(super) fn follow(&self, way: &Way, course: &mut Course) {
        let mut begin = Begin { stretch: 0, time: 0.0, velocity: way.velocity, gone: 0.0 };
        // The slave comes without acceleration, and the cam has its own from the start on.
        let mut changes = vec![(0.0, -self.cam_at(self.place).acceleration)];
        for [duration, acceleration, jerk, angular] in way.pieces.iter().copied() {
            if duration <= 0.0 {
                continue;
            }
            changes.push((begin.time, acceleration));
            let pull = Pull { acceleration, jerk, angular };
            course.stretches.push(Stretch::new(&pull, duration));
            self.follow_stretch(&begin, &pull, duration, course);
            let [(ramp, swing), ..] = pull.motion(begin.velocity, 1.0);
            begin.gone += swing.value(&ramp, duration);
            begin.velocity += pull.later(duration).1;
            begin.time += duration;
            begin.stretch += 1;
        }
        let Course { ramp: found, reached, steps, stretches } = course;
        found.duration_s = begin.time;
        if stretches.is_empty() {
            return;
        }
        reached.sort_by_key(|part| (part.stretch, part.piece));
        changes.push((begin.time, 0.0));
        *steps = self.steps(&changes);
        let largest = steps.iter().copied().fold(0.0, f64::max);
        found.peak_jerk = match self.wish.ramp {
            RampType::Trapezoid => largest / self.wish.cycle_s + found.peak_cam_jerk,
            // Rounding aside it is no more than the ramp's own and the cam's.
            RampType::Sigmoid | RampType::Parabolic => {
                found.peak_jerk.min(found.ramp_jerk + found.peak_cam_jerk)
            }
        };
    }

    /// Adds what is reached on a stretch.
    fn follow_stretch(&self, begin: &Begin, pull: &Pull, duration: f64, course: &mut Course) {
        let Course { ramp: found, reached, .. } = course;
        let speed = self.speed();
        let factor = self.wish.input.slave_scaling;
        let curve = self.curve();
        let repeated = self.wish.table.periodic;
        // Time is the way over the speed; a master that stands takes the whole duration at one place.
        let stands = speed == 0.0;
        let rate = if stands { 1.0 } else { 1.0 / speed.abs() };
        let width = curve.end() - curve.start();
        let pass = if repeated { width / speed.abs() } else { f64::INFINITY };
        let mean = curve.rise() / width * speed * factor;
        for [from, to] in parts(pull, begin.velocity + mean, duration, pass) {
            let place = self.place + speed * (begin.time + from);
            let mut position = self.position(begin, pull, from);
            let mut tell = |[y, first, second, third]: [Coefficients; 4], width, gone| {
                let width = if stands { to - from } else { width };
                let since = if stands { from } else { from + gone * rate };
                // What the cam does over the way, or at its place over the time.
                let of_cam = |c: Coefficients, by: f64| {
                    let c = c.map(|c| c * by);
                    if stands { [c[0], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] } else { c }
                };
                let (now, gained) = pull.later(since);
                let [way, v, a, j] = now.motion(begin.velocity + gained, rate);
                let jerk = of_cam(third, speed.powi(3) * factor);
                let all = [
                    together(&of_cam(first, speed * factor), &v, width),
                    together(&of_cam(second, speed * speed * factor), &a, width),
                    together(&jerk, &j, width),
                ];
                let peaks =
                    [&mut found.peak_velocity, &mut found.peak_acceleration, &mut found.peak_jerk];
                for (peak, extremes) in peaks.into_iter().zip(&all) {
                    *peak = peak.max(magnitude(extremes));
                }
                found.peak_cam_jerk = found.peak_cam_jerk.max(magnitude(&extremes(&jerk, width)));
                let mut sum = of_cam(y, factor);
                sum[0] = position;
                let here = together(&sum, &way, width);
                let [least, greatest] = &mut found.positions;
                (*least, *greatest) = (least.min(here.min), greatest.max(here.max));
                let (ramp, swing) = &way;
                position = value(&sum, width) + swing.value(ramp, width);
                let ends = all.map(|extremes| [extremes.min, extremes.max]);
                let middle = speed.signum() * (gone + width / 2.0);
                let piece = if stands { 0 } else { self.piece(place + middle) };
                reached.push(Reached { stretch: begin.stretch, piece, ends });
            };
            along(curve, place, speed * (to - from), repeated, &mut tell);
        }
    }

    /// Which piece of the cam the master is on, counted through all passes.
    fn piece(&self, place: f64) -> i64 {
        let curve = self.curve();
        let (inside, passes) =
            if self.wish.table.periodic { curve.wrap(place) } else { (place, 0.0) };
        let count = curve.pieces().len();
        let piece = curve.pieces().partition_point(|piece| piece.start <= inside);
        #[expect(clippy::cast_possible_truncation, reason = "passes of a ramp")]
        let passes = passes as i64;
        let [count, piece] = [count, piece].map(|count| i64::try_from(count).unwrap_or(i64::MAX));
        passes.saturating_mul(count).saturating_add(piece)
    }

    /// Where ramp and cam have the slave so many seconds after the begin of a stretch.
    fn position(&self, begin: &Begin, pull: &Pull, since: f64) -> f64 {
        let [(ramp, swing), ..] = pull.motion(begin.velocity, 1.0);
        let place = self.place + self.speed() * (begin.time + since);
        let of_cam = self.cam_at(place).position - self.cam_at(self.place).position;
        self.wish.slave.position + of_cam + begin.gone + swing.value(&ramp, since)
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
