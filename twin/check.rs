//! Validates a program on the virtual machine: everything that must be known before anything moves.

use crate::finding::{self, Finding, Rule, Severity};
use crate::machine::{Axis, Machine};
use crate::physics::PhysicsError;
use crate::plant::Plant;
use crate::program::{ProgramFile, ProgramItem};
use crate::report::{AxisPeak, Peak, seconds};
use crate::setpoint::{AxisSetpoint, Transformer};
use crate::simulated::Simulated;
use std::collections::BTreeMap;
use std::io;
use twin_kinematics::{AxisVector, KinematicsError};
use twin_motion::Place;
use twin_motion::interpolate::ToolSetpoint;

/// Findings beyond this number are counted, not kept: a program that is wrong on every one of ten million lines is
/// reported as well by its first thousand.
const MAX_FINDINGS: usize = 1000;

/// A value may exceed its limit by this fraction before it counts: rounding, not motion.
const ROUNDING: f64 = 1e-9;

/// What checking a program has told.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Number of path elements.
    pub elements: u64,
    /// Length of the path, m.
    pub length: f64,
    /// Duration, ns.
    pub duration_ns: i64,
    /// Largest values per axis, machine-file order.
    pub peaks: Vec<AxisPeak>,
    /// What was found, worst first.
    pub findings: Vec<Finding>,
    /// How many further findings there are.
    pub findings_left_out: u64,
    /// Where the axes are at the first set-point, m or rad.
    pub start: Option<AxisVector>,
}

/// Why a program could not be checked.
#[derive(Debug, thiserror::Error)]
pub enum CheckFailure {
    /// The file.
    #[error(transparent)]
    Read(#[from] io::Error),
    /// The simulated machine.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
}

/// Checks a whole program; with `physics` also on the simulated machine. `progress` is told the bytes read so far.
///
/// # Errors
/// If the file cannot be read, or the simulated machine cannot be built.
pub fn check(
    machine: &Machine,
    program: &ProgramFile,
    physics: bool,
    progress: &mut dyn FnMut(u64),
) -> Result<Outcome, CheckFailure> {
    let mut checker = Checker::new(machine);
    let mut twin: Option<Simulated> = None;
    let mut items = program.open(machine)?;
    let mut countdown = 0u32;
    while let Some(item) = items.next() {
        match item {
            ProgramItem::Setpoint(tool) => {
                let Some(setpoint) = checker.setpoint(&tool) else { continue };
                if physics {
                    let twin = match &mut twin {
                        Some(twin) => twin,
                        None => twin.insert(Simulated::new(machine, &setpoint.axes.position)?),
                    };
                    twin.command(&setpoint)?;
                    while let Some(feedback) = twin.feedback()? {
                        checker.following(&setpoint, &feedback.position);
                    }
                }
            }
            ProgramItem::Diagnostic(finding) => checker.findings.add(None, finding),
            ProgramItem::Io(error) => return Err(error.into()),
        }
        countdown = countdown.checked_sub(1).unwrap_or_else(|| {
            progress(items.bytes_read());
            1000
        });
    }
    let mut outcome = checker.finish();
    outcome.elements = items.elements();
    outcome.length = items.length();
    Ok(outcome)
}

/// What makes a finding one finding: later ones that agree in this only raise its value.
type Key = (u32, Rule, Option<usize>, Option<usize>);

/// Findings, bounded in number.
#[derive(Debug, Default)]
struct Findings {
    kept: BTreeMap<Key, Finding>,
    left_out: u64,
}

impl Findings {
    fn add(&mut self, axis: Option<usize>, finding: Finding) {
        let column = finding.columns.as_ref().map(|columns| columns.start);
        let key = (finding.line, finding.rule, axis, column);
        let full = self.kept.len() >= MAX_FINDINGS;
        match self.kept.get_mut(&key) {
            Some(kept) if excess(&finding) > excess(kept) => *kept = finding,
            Some(_) => {}
            None if full => self.left_out += 1,
            None => {
                self.kept.insert(key, finding);
            }
        }
    }
}

/// How far a finding's value is from its limit.
fn excess(finding: &Finding) -> f64 {
    finding.value.zip(finding.limit).map_or(0.0, |(value, limit)| (value - limit).abs())
}

/// Looks at every set-point.
#[derive(Debug)]
struct Checker<'m> {
    machine: &'m Machine,
    transformer: Transformer<'m>,
    findings: Findings,
    peaks: Vec<AxisPeak>,
    last: Option<AxisSetpoint>,
    start: Option<AxisVector>,
    duration_ns: i64,
}

impl<'m> Checker<'m> {
    fn new(machine: &'m Machine) -> Self {
        Self {
            machine,
            transformer: Transformer::new(machine),
            findings: Findings::default(),
            peaks: vec![AxisPeak::default(); machine.axes.len()],
            last: None,
            start: None,
            duration_ns: 0,
        }
    }

    /// `None` if the machine cannot take this set-point.
    fn setpoint(&mut self, tool: &ToolSetpoint) -> Option<AxisSetpoint> {
        self.duration_ns = tool.time_ns;
        let setpoint = match self.transformer.axes(tool) {
            Ok(setpoint) => setpoint,
            Err(error) => {
                self.findings.add(None, unreachable(tool.place, &error));
                self.last = None;
                return None;
            }
        };
        let last = self.last.replace(setpoint);
        self.start.get_or_insert(setpoint.axes.position);
        // What differences between cycles show: a jump of the set-point (G92) has no velocity of its own.
        let cycle = seconds(self.machine.cycle_ns);
        let machine = self.machine;
        for (index, (axis, peak)) in machine.axes.iter().zip(&mut self.peaks).enumerate() {
            let value = |vector: &AxisVector| vector.get(index).copied().unwrap_or_default();
            let motion = &setpoint.axes;
            let position = value(&motion.position);
            let before =
                last.map(|last| (value(&last.axes.position), value(&last.axes.acceleration)));
            let stepped = before.map_or(0.0, |(before, _)| (position - before).abs() / cycle);
            let velocity = value(&motion.velocity).abs().max(stepped);
            let acceleration = value(&motion.acceleration).abs();
            let jerk = before
                .map_or(0.0, |(_, before)| (value(&motion.acceleration) - before).abs() / cycle);
            let [low, high] = peak.position.unwrap_or([position; 2]);
            peak.position = Some([low.min(position), high.max(position)]);
            peak.velocity.include(velocity, tool.place);
            peak.acceleration.include(acceleration, tool.place);
            peak.jerk.include(jerk, tool.place);
            let mut report = |finding| self.findings.add(Some(index), finding);
            if let Some(finding) = beyond_position(axis, tool.place, position) {
                report(finding);
            }
            let speed = setpoint.path_velocity;
            if exceeds(velocity, axis.max_velocity) {
                // Along a given path the axes' velocities are proportional to the feed.
                let feed = (speed > 0.0).then(|| speed * axis.max_velocity / velocity);
                report(too_much(
                    axis,
                    Rule::AxisVelocity,
                    "velocity",
                    "/s",
                    tool.place,
                    velocity,
                    axis.max_velocity,
                    feed,
                ));
            }
            if exceeds(acceleration, axis.max_acceleration) {
                // At constant feed they grow with its square; while the feed changes nothing so simple holds.
                let along = tool.acceleration.dot(&tool.velocity).abs();
                let steady = speed > 0.0 && along < 1e-6 * speed;
                let feed = steady.then(|| speed * (axis.max_acceleration / acceleration).sqrt());
                let limit = axis.max_acceleration;
                report(too_much(
                    axis,
                    Rule::AxisAcceleration,
                    "acceleration",
                    "/s²",
                    tool.place,
                    acceleration,
                    limit,
                    feed,
                ));
            }
            if let Some(limit) = axis.max_jerk.filter(|limit| exceeds(jerk, *limit)) {
                let mut finding =
                    too_much(axis, Rule::AxisJerk, "jerk", "/s³", tool.place, jerk, limit, None);
                // A trapezoidal profile steps in acceleration; that alone makes no program unfit.
                finding.severity = Severity::Warning;
                report(finding);
            }
        }
        Some(setpoint)
    }

    /// Compares the simulated machine with its set-point.
    fn following(&mut self, setpoint: &AxisSetpoint, actual: &AxisVector) {
        let pairs = setpoint.axes.position.iter().zip(actual.iter());
        let axes = self.machine.axes.iter().zip(&mut self.peaks);
        for (index, ((axis, peak), (wanted, actual))) in axes.zip(pairs).enumerate() {
            let error = (actual - wanted).abs();
            peak.following_error.get_or_insert(Peak::default()).include(error, setpoint.place);
            if let Some(limit) = axis.max_following_error.filter(|limit| exceeds(error, *limit)) {
                let finding = too_much(
                    axis,
                    Rule::FollowingError,
                    "following error",
                    "",
                    setpoint.place,
                    error,
                    limit,
                    None,
                );
                self.findings.add(Some(index), finding);
            }
        }
    }

    fn finish(self) -> Outcome {
        let mut findings: Vec<_> = self.findings.kept.into_values().collect();
        finding::sort(&mut findings);
        Outcome {
            elements: 0,
            length: 0.0,
            duration_ns: self.duration_ns,
            peaks: self.peaks,
            findings,
            findings_left_out: self.findings.left_out,
            start: self.start,
        }
    }
}

fn exceeds(value: f64, limit: f64) -> bool {
    value > limit * (1.0 + ROUNDING)
}

/// A set-point that the kinematics refuses.
fn unreachable(place: Place, error: &KinematicsError) -> Finding {
    let rule = match error {
        KinematicsError::Singular { .. } => Rule::Singularity,
        _ => Rule::Reach,
    };
    let finding = Finding::error(rule, place, format!("the tool cannot be there: {error}"));
    match error {
        KinematicsError::Unreachable { distance, reach: [near, far], .. } => {
            let limit = if distance < near { near } else { far };
            finding.with_value(distance * 1e3, limit * 1e3, "mm")
        }
        _ => finding,
    }
}

fn beyond_position(axis: &Axis, place: Place, position: f64) -> Option<Finding> {
    let [low, high] = axis.position_limits;
    let tolerance = ROUNDING * (high - low);
    let limit = if position < low - tolerance {
        low
    } else if position > high + tolerance {
        high
    } else {
        return None;
    };
    let (value, limit, unit) = (axis.from_si(position), axis.from_si(limit), axis.unit());
    let side = if position < low { "below" } else { "above" };
    let message = format!(
        "axis {} at {value:.3} {unit} is {side} its software limit of {limit:.3} {unit}",
        axis.name
    );
    let mut finding =
        Finding::error(Rule::AxisPosition, place, message).with_value(value, limit, unit);
    finding.axis = Some(axis.name.clone());
    Some(finding)
}

#[expect(
    clippy::too_many_arguments,
    reason = "every one a number or name of the sentence it writes"
)]
fn too_much(
    axis: &Axis,
    rule: Rule,
    what: &str,
    per: &'static str,
    place: Place,
    value: f64,
    limit: f64,
    largest_feed: Option<f64>,
) -> Finding {
    let (value, limit) = (axis.from_si(value), axis.from_si(limit));
    let unit = axis.unit();
    let message = format!(
        "axis {}: {what} {value:.4} {unit}{per} is above its limit of {limit:.4} {unit}{per}",
        axis.name
    );
    let unit = match (unit, per) {
        ("deg", "/s") => "deg/s",
        ("deg", "/s²") => "deg/s^2",
        ("deg", "/s³") => "deg/s^3",
        (_, "/s") => "mm/s",
        (_, "/s²") => "mm/s^2",
        (_, "/s³") => "mm/s^3",
        (unit, _) => unit,
    };
    let mut finding = Finding::error(rule, place, message).with_value(value, limit, unit);
    finding.axis = Some(axis.name.clone());
    finding.largest_feed_mm_per_s = largest_feed.map(|feed| feed * 1e3);
    finding
}
