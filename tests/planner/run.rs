//! Test run: plans a path, samples it and measures peaks against the limits.

use super::machines::Machine;
use nalgebra::Vector3;
use std::sync::Arc;
use std::time::Instant;
use twin_kinematics::AxisVector;
use twin_path::PathElement;
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_planner::blended_path::{BlendOptions, BlendedElement, Order};
use twin_planner::time_optimal::{
    AxisLimits, AxisPath, AxisPoint, Effort, Leg, LimitError, LimitOptions, Planned, Planner,
};

/// Servo cycle, s.
const CYCLE: f64 = 1e-3;
/// In legs that take less time, s, a jerk limit lets the acceleration change by a thousandth of its limit.
const BRIEF: f64 = 2e-5;
/// The root of what is left of u̇² by rounding, m/s.
const AT_REST: f64 = 1e-7;

/// Settings of planning.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub machine: Machine,
    pub jerk: bool,
    /// Of joints, m.
    pub tolerance: f64,
    /// Sharper turns are stops, rad.
    pub angle: f64,
    pub horizon: f64,
}

impl Settings {
    pub fn options(&self) -> LimitOptions {
        let mut blending = BlendOptions::new(self.tolerance);
        if self.machine.turns() {
            blending.turning = true;
            blending.order = if self.jerk { Order::Jerk } else { Order::Acceleration };
        }
        let options = LimitOptions::new(blending);
        LimitOptions { horizon: self.horizon, ..options }
    }
}

/// Largest value, with its line and time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    pub value: f64,
    /// Of the program.
    pub line: u32,
    /// s.
    pub time: f64,
}

impl Peak {
    fn raise(&mut self, value: f64, line: u32, time: f64) {
        if value > self.value || value.is_nan() {
            *self = Self { value, line, time };
        }
    }
}

/// Report about a motion. Peaks are parts of the limits, of any axis.
#[derive(Clone, Debug, Default)]
pub struct Report {
    pub duration: f64,
    pub velocity: Peak,
    pub acceleration: Peak,
    pub jerk: Peak,
    /// That in legs of less than 20 µs, beside the others.
    pub brief_jerk: Peak,
    /// From differences of positions.
    pub third_difference: Peak,
    /// Part of F.
    pub feed: Peak,
    /// Part of E+ or E−.
    pub path_acceleration: Peak,
    /// Of the tool tip, m/s².
    pub tool_acceleration: Peak,
    /// Step of the velocity and of the acceleration of the parameter from leg to leg, m/s and m/s².
    pub velocity_step: Peak,
    pub acceleration_step: Peak,
    /// Lines whose elements were visited, in order, each once.
    pub lines: Vec<u32>,
    /// Pauses, and stops between elements.
    pub stops: u32,
    pub errors: Vec<String>,
    pub effort: Effort,
    /// Of planning, s.
    pub took: f64,
    pub legs: u64,
}

impl Report {
    pub fn points_per_second(&self) -> f64 {
        self.effort.committed as f64 / self.took
    }
}

/// Follows the legs in equal cycles.
pub struct Watch<'m, A> {
    axes: &'m A,
    /// s.
    cycle: f64,
    limits: Vec<AxisLimits>,
    near: AxisVector,
    /// Positions of the last three cycles, the latest first.
    before: [AxisVector; 3],
    cycles: u64,
    /// Where the last leg ended: element, parameter, u̇, ü.
    last: Option<(Arc<BlendedElement>, f64, f64, f64)>,
    pub report: Report,
    /// The override, and from when on the path may be faster only where it slows down, s.
    pub factor: (f64, f64),
}

impl<'m, A: AxisPath> Watch<'m, A> {
    pub fn new(axes: &'m A) -> Self {
        Self {
            cycle: CYCLE,
            limits: axes.limits().to_vec(),
            near: axes.home(),
            axes,
            before: [axes.home(); 3],
            cycles: 0,
            last: None,
            report: Report::default(),
            factor: (1.0, 0.0),
        }
    }

    /// Rests for some time.
    pub fn wait(&mut self, time: f64) {
        if let Some((element, s, ..)) = &self.last {
            let rests = self.axes.axes(element, *s, &self.near).unwrap().position;
            for _ in 0..3 {
                self.differ(rests, 0, self.report.duration);
            }
        }
        self.report.duration += time;
        self.cycles = (self.report.duration / self.cycle).ceil() as u64;
    }

    pub fn leg(&mut self, leg: &Leg) {
        let line = leg.element.place().line;
        let stretch = &leg.stretch;
        let start = self.report.duration;
        let (b, a) = stretch.at_position(0.0);
        let mut v0 = 0.0;
        let mut a0 = 0.0;
        let mut joined = false;
        let mut stop = true;
        if self.last.is_none() {
            // It stood there before.
            let start = self.axes.axes(&leg.element, leg.from, &self.near).unwrap().position;
            self.before = [start; 3];
        }
        if let Some((element, s, velocity, acceleration)) = self.last.take() {
            (v0, a0) = (velocity, acceleration);
            joined = Arc::ptr_eq(&element, &leg.element);
            stop = !joined && element.stops_at_end();
            let from = if joined { s } else { 0.0 };
            let fits = (leg.from - from).abs() <= 1e-9 * leg.element.length().max(1e-6);
            assert!(fits, "line {line}: begins at {} instead of {from}", leg.from);
            let end = element.length();
            assert!(joined || (s - end).abs() <= 1e-9 * end, "line {line}: left at {s} of {end}");
        }
        if !joined && !leg.element.is_turn() {
            self.report.lines.push(line);
        }
        if stop {
            assert!(b == 0.0 && v0.abs() < AT_REST, "line {line}: {v0}, {b} at a stop");
            self.report.stops += 1;
        }
        self.report.velocity_step.raise((b.sqrt() - v0).abs(), line, start);
        self.report.acceleration_step.raise((a - a0).abs(), line, start);
        let end = start + stretch.duration();
        assert!(end.is_finite() && end >= start, "line {line}: {stretch:?}");
        while self.cycle * (self.cycles as f64) <= end {
            let time = self.cycle * (self.cycles as f64);
            self.sample(leg, line, time, time - start);
            self.cycles += 1;
        }
        let (b, a) = stretch.at_position(stretch.length());
        self.last = Some((Arc::clone(&leg.element), leg.from + stretch.length(), b.sqrt(), a));
        self.report.duration = end;
        self.report.legs += 1;
    }

    fn sample(&mut self, leg: &Leg, line: u32, time: f64, into: f64) {
        let progress = leg.stretch.at(into);
        let s = leg.from + progress.position;
        let AxisPoint { position, rates } = self.axes.axes(&leg.element, s, &self.near).unwrap();
        self.near = position;
        let (v, a, j) = (progress.velocity, progress.acceleration, progress.jerk);
        let report = &mut self.report;
        for (axis, limits) in self.limits.iter().enumerate() {
            let (d1, d2, d3) = (rates.first[axis], rates.second[axis], rates.third[axis]);
            report.velocity.raise((d1 * v).abs() / limits.velocity, line, time);
            let acceleration = d1 * a + d2 * v * v;
            report.acceleration.raise(acceleration.abs() / limits.acceleration, line, time);
            if let Some(limit) = limits.jerk {
                let jerk = d1 * j + 3.0 * d2 * v * a + d3 * v * v * v;
                let brief = leg.stretch.duration() < BRIEF;
                let peak = if brief { &mut report.brief_jerk } else { &mut report.jerk };
                peak.raise(jerk.abs() / limit, line, time);
            }
        }
        self.differ(position, line, time);
        if leg.element.is_turn() {
            return;
        }
        let point = leg.element.at(s);
        let norm = point.first.norm();
        // Where only extra axes move the parameter is the way.
        let speed = if norm > 0.0 { norm } else { 1.0 };
        let report = &mut self.report;
        let (factor, from) = self.factor;
        if factor >= 1.0 && from == 0.0 || factor > 0.0 && time > from && a >= 0.0 {
            report.feed.raise(speed * v / (factor * leg.element.feed()), line, time);
        }
        let tool = point.first * a + point.second * (v * v);
        report.tool_acceleration.raise(tool.norm(), line, time);
        let along = speed * a + point.first.dot(&point.second) / speed * v * v;
        let limit =
            if along > 0.0 { leg.element.acceleration() } else { leg.element.deceleration() };
        report.path_acceleration.raise(along.abs() / limit, line, time);
    }

    fn differ(&mut self, position: AxisVector, line: u32, time: f64) {
        let [p1, p2, p3] = self.before;
        for (axis, limits) in self.limits.iter().enumerate() {
            let Some(limit) = limits.jerk else { continue };
            let third = position[axis] - 3.0 * p1[axis] + 3.0 * p2[axis] - p3[axis];
            let value = third.abs() / self.cycle.powi(3) / limit;
            self.report.third_difference.raise(value, line, time);
        }
        self.before = [position, p1, p2];
    }

    pub fn rest(&mut self) {
        if let Some((element, s, velocity, _)) = &self.last {
            assert!(velocity.abs() < AT_REST, "{velocity} m/s at rest");
            assert!((s - element.length()).abs() <= 1e-9 * element.length());
            let line = element.place().line;
            let end = element.length();
            if let Ok(point) = self.axes.axes(element, end, &self.near) {
                for _ in 0..3 {
                    self.differ(point.position, line, self.report.duration);
                }
            }
        }
        self.last = None;
    }
}

/// Plans `path` and looks at every millisecond of it.
pub fn run(
    path: impl Iterator<Item = PathElement>,
    settings: &Settings,
    options: LimitOptions,
) -> Report {
    let Settings { machine, jerk, angle, .. } = *settings;
    run_on([machine.path(jerk), machine.path(jerk)], path, angle, options, CYCLE)
}

/// Plans `path` on a machine, of which there are two, and looks at it every `cycle` s.
pub fn run_on<A: AxisPath>(
    [axes, watched]: [A; 2],
    path: impl Iterator<Item = PathElement>,
    angle: f64,
    options: LimitOptions,
    cycle: f64,
) -> Report {
    let checked = CheckVelocities::new(path.map(Ok::<_, CheckError>), angle);
    let mut planner = Planner::new(checked, axes, options);
    let mut watch = Watch { cycle, ..Watch::new(&watched) };
    loop {
        #[expect(clippy::disallowed_methods, reason = "how long planning takes")]
        let begun = Instant::now();
        let next = planner.next();
        watch.report.took += begun.elapsed().as_secs_f64();
        match next {
            Some(Ok(Planned::Leg(leg))) => watch.leg(&leg),
            Some(Ok(Planned::Pause(element))) => {
                watch.rest();
                watch.report.lines.push(element.place().line);
                watch.report.stops += 1;
            }
            Some(Ok(Planned::Hold { .. })) => panic!("held without being asked to"),
            Some(Err(LimitError::Upstream(error))) => panic!("{error}"),
            Some(Err(error)) => {
                watch.last = None;
                watch.report.errors.push(error.to_string());
            }
            None => break,
        }
    }
    watch.rest();
    watch.report.effort = planner.effort();
    watch.report
}

/// The direction in which a path arrives, if it has one.
pub fn arrives(element: &PathElement) -> Option<Vector3<f64>> {
    (element.length() > 0.0).then(|| element.at(element.length()).tangent)
}
