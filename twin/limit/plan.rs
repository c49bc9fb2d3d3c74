//! Time-optimal plan of a program within all limits, set-point by set-point.

use super::feeds::LineFeed;
use super::gaps::Gaps;
use super::machine_path::{AxisRules, MachinePath, MachinePathError, efforts, overloaded};
use super::out_of_reach;
use super::watch::Watch;
use super::{Change, ProfileSample};
use crate::finding::{Finding, Rule};
use crate::m_function::Acknowledgement;
use crate::messages::unreachable;
use crate::program::{Findings, Halt, Prepared, ProgramFile};
use std::io;
use std::num::NonZeroU32;
use std::sync::Arc;
use twin_gcode::refeed::LineLimit;
use twin_kinematics::AxisVector;
use twin_machine::{DirectionRule, Machine};
use twin_path::Place;
use twin_path::prepare::CheckedElement;
use twin_planner::blended_path::{BlendOptions, BlendedElement, Order};
use twin_planner::controller::{DEFAULT_CYCLE_NS, ToolSetpoint};
use twin_planner::planned_motion::PlannedPiece;
use twin_planner::time_optimal::{
    AxisPath, Effort, Followed, Follower, LimitError, LimitOptions, NotSolved, ParallelPlanner,
    Planner, Rates, Shown,
};

/// Limits that count in a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub struct LimitRules {
    /// The axes.
    pub axes: AxisRules,
    /// The programmed velocity (F), and that of rapids.
    pub feed: bool,
    /// The programmed accelerations (E).
    pub path_acceleration: bool,
    /// The acceleration of the tool tip, where the machine file gives one.
    pub tool_acceleration: bool,
    /// The acceleration towards the centre of curves and its jumps, where the machine file limits them.
    pub centripetal: bool,
}

impl Default for LimitRules {
    fn default() -> Self {
        Self {
            axes: AxisRules::default(),
            feed: true,
            path_acceleration: true,
            tool_acceleration: true,
            centripetal: true,
        }
    }
}

/// Errors that make a plan impossible.
#[derive(Debug, thiserror::Error)]
pub enum LimitFailure {
    /// The file.
    #[error(transparent)]
    Read(#[from] io::Error),
    /// The machine.
    #[error(transparent)]
    Machine(#[from] MachinePathError),
}

/// Largest number of grid steps in a part of a plan that no override changes.
const LONGEST: f64 = 32.0;

/// Plans `path` on `machine` with the override `factor`; `changes`: it may change on the way.
///
/// # Errors
/// If the machine is of a kind that cannot be planned for.
pub(crate) fn planner<I, E>(
    path: I,
    machine: &Machine,
    rules: LimitRules,
    (factor, changes): (f64, bool),
) -> Result<Planner<I, E, MachinePath<'_>>, MachinePathError>
where
    I: Iterator<Item = Result<CheckedElement, E>>,
{
    let axes = MachinePath::new(machine, rules.axes)?;
    let limits = &machine.path_limits;
    let mut blending = BlendOptions::new(limits.blend_tolerance);
    blending.turning = matches!(machine.direction, DirectionRule::Path(..));
    let jerk_limited = axes.limits().iter().any(|axis| axis.jerk.is_some());
    // The direction of the path is a derivative already.
    blending.order = match (jerk_limited, blending.turning) {
        (false, false) => Order::Velocity,
        (true, false) | (false, true) => Order::Acceleration,
        (true, true) => Order::Jerk,
    };
    let usual = LimitOptions::new(blending);
    let options = LimitOptions {
        longest: if changes { usual.longest } else { LONGEST },
        feed: rules.feed,
        path_acceleration: rules.path_acceleration,
        tool_acceleration: limits.tool_acceleration.filter(|_| rules.tool_acceleration),
        centripetal: rules.centripetal(machine),
        ..usual
    };
    let mut planner = Planner::new(path, axes, options);
    planner.set_override(factor);
    Ok(planner)
}

/// No profile was found from `place` on.
pub(crate) fn not_solved(place: Place, error: NotSolved) -> Finding {
    let message = format!("no profile was found within the limits: {error}");
    Finding::error(Rule::FeedReduced, place, message)
}

/// Items of a [`Profile`].
#[derive(Debug)]
pub enum ProfileItem {
    /// The next set-point.
    Sample(Box<ProfileSample>),
    /// Something wrong with the program; what follows begins from rest.
    Finding(Finding),
    /// The file cannot be read any further.
    Io(io::Error),
}

/// A program on a machine, as fast as all limits allow: one sample per cycle.
#[derive(Debug)]
pub struct Profile<'m> {
    pub(super) machine: &'m Machine,
    pub(super) axes: MachinePath<'m>,
    pub(super) follower: Follower<ParallelPlanner<Prepared, Halt, MachinePath<'m>>>,
    pub(super) rules: LimitRules,
    near: AxisVector,
    found: Findings,
    pub(super) line: Option<LineFeed>,
    pub(super) lines: Vec<LineLimit>,
    /// True if lines whose feed cannot be held are reported, and not kept.
    pub(super) tells_feeds: bool,
    pub(super) watch: Watch<'m>,
    /// `None` in a check, which bridges gaps itself.
    gaps: Option<Gaps<'m>>,
    /// The last one.
    tool: Option<ToolSetpoint>,
    /// The element it is on, and whether it is the first on it.
    element: Option<Arc<BlendedElement>>,
    entered: bool,
}

impl<'m> Profile<'m> {
    /// The program `program` on `machine`.
    ///
    /// # Errors
    /// If it cannot be opened, or the machine is of a kind that cannot be planned for.
    pub fn new(
        program: &ProgramFile,
        machine: &'m Machine,
        rules: LimitRules,
    ) -> Result<Self, LimitFailure> {
        let (path, found) = program.path_for_limits(&machine.conditions)?;
        let axes = MachinePath::new(machine, rules.axes)?;
        let near = axes.home();
        let factor = program.settings().inputs.override_factor.factor();
        let planner = planner(path, machine, rules, (factor, false))?;
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let machines: Result<Vec<_>, _> =
            (0..cores).map(|_| MachinePath::new(machine, rules.axes)).collect();
        let planner = ParallelPlanner::new(planner, machines?);
        let cycle = u32::try_from(machine.cycle_ns).ok().and_then(NonZeroU32::new);
        let follower = Follower::new(planner, cycle.unwrap_or(DEFAULT_CYCLE_NS));
        Ok(Self {
            machine,
            axes,
            follower,
            rules,
            near,
            found,
            line: None,
            lines: Vec::new(),
            tells_feeds: false,
            watch: Watch::new(machine),
            gaps: Some(Gaps::new(machine)),
            tool: None,
            element: None,
            entered: false,
        })
    }

    /// Settings for a check. M functions take the time that `rules` give them. Findings report every line whose feed
    /// cannot be held; [`Self::line_limits`] is then empty.
    pub(crate) fn for_check(self, rules: &Acknowledgement) -> Self {
        let follower = self.follower.with_m_times(rules.times());
        Self { follower, tells_feeds: true, gaps: None, ..self }
    }

    /// Records the pieces of the plan from now on.
    pub(crate) fn record(&mut self) {
        self.follower.record();
    }

    /// Sets the density of the samples from now on.
    pub(crate) fn show(&mut self, shown: Shown) {
        self.follower.show(shown);
    }

    /// The next piece of the plan that is over.
    pub(crate) fn next_piece(&mut self) -> Option<PlannedPiece> {
        self.follower.next_piece()
    }

    /// The set-point of the last sample.
    pub(crate) fn tool(&self) -> Option<&ToolSetpoint> {
        self.tool.as_ref()
    }

    /// True if the last sample is the first on its element.
    pub(crate) fn has_entered(&self) -> bool {
        self.entered
    }

    /// Known facts of the file.
    pub(crate) fn file(&self) -> &Findings {
        &self.found
    }

    /// Planning effort so far.
    pub fn effort(&self) -> Effort {
        self.follower.plan().planner().effort()
    }

    /// Time gained by raising each limit that gains any, the largest gain first.
    pub fn changes(&self) -> Vec<Change> {
        let mut changes: Vec<Change> = Vec::new();
        for (constraint, time) in self.follower.plan().planner().costs() {
            let Some(binding) = self.binding_of(*constraint) else { continue };
            let gain_s = binding.gain(*time, Change::RAISED);
            match changes.iter_mut().find(|change| change.binding == binding) {
                Some(change) => change.gain_s += gain_s,
                None => changes.push(Change { binding, gain_s }),
            }
        }
        changes.retain(|change| change.gain_s > 0.0);
        changes.sort_by(|one, other| other.gain_s.total_cmp(&one.gain_s));
        changes
    }

    /// Duration of the path, s: exact at the end.
    pub fn duration(&self) -> f64 {
        self.follower.duration()
    }

    /// The largest feed of every line so far that the axes allow at constant velocity, in the order of the program.
    pub fn line_limits(self) -> Vec<LineLimit> {
        let mut lines = self.lines;
        lines.extend(self.line.map(|line| line.limit()));
        lines
    }

    /// Bytes of the file read so far.
    pub fn bytes_read(&self) -> u64 {
        self.found.bytes_read()
    }

    fn sample(&mut self, followed: &Followed) -> ProfileItem {
        let Followed { tool, element, progress } = followed;
        let point = match self.axes.axes(element, progress.position, &self.near) {
            Ok(point) => point,
            Err(error) => return ProfileItem::Finding(unreachable(tool.place, &error)),
        };
        self.near = point.position;
        self.watch.positions(tool.place, &point.position);
        let Rates { first, second, third } = &point.rates;
        let (v, a, j) = (progress.velocity, progress.acceleration, progress.jerk);
        let values = first.iter().zip(second.iter()).zip(third.iter());
        let of = |map: &dyn Fn(f64, f64, f64) -> f64| {
            AxisVector::from_values(values.clone().map(|((d1, d2), d3)| map(*d1, *d2, *d3)))
        };
        let along = tool.velocity.try_normalize(0.0).unwrap_or_default();
        let mut sample = ProfileSample {
            time_ns: tool.time_ns,
            place: tool.place,
            way: tool.way,
            feed: if element.element().kind.is_motion() { tool.feed } else { 0.0 },
            path_velocity: tool.path_velocity,
            path_acceleration: tool.acceleration.dot(&along),
            path_jerk: if element.is_turn() { 0.0 } else { j },
            position: point.position,
            velocity: of(&|d1, _, _| d1 * v),
            acceleration: of(&|d1, d2, _| d1 * a + d2 * v * v),
            jerk: of(&|d1, d2, d3| d1 * j + 3.0 * d2 * v * a + d3 * v * v * v),
            effort: None,
            binding: None,
        };
        let torque = self.axes.torque(&point.position, first, second);
        if let Some(torque) = &torque {
            sample.effort = Some(efforts(torque, [a, v], &sample.velocity));
            if self.rules.axes.effort {
                self.watch.motors(tool.place, overloaded(torque));
            }
        }
        self.tool = Some(*tool);
        self.entered = !self.element.as_ref().is_some_and(|last| Arc::ptr_eq(last, element));
        if self.entered {
            self.element = Some(Arc::clone(element));
        }
        sample.binding = self.binding(&sample, torque.as_ref(), followed);
        self.include(&point.rates, torque.as_ref(), followed);
        match &mut self.gaps {
            Some(gaps) => {
                gaps.opens(&self.axes, tool, &sample.position);
                gaps.pass(sample)
            }
            None => ProfileItem::Sample(Box::new(sample)),
        }
    }

    /// The machine.
    pub fn machine(&self) -> &'m Machine {
        self.machine
    }
}

impl Iterator for Profile<'_> {
    type Item = ProfileItem;

    fn next(&mut self) -> Option<ProfileItem> {
        if let Some(finding) = self.watch.take() {
            return Some(ProfileItem::Finding(finding));
        }
        if let Some(finding) = self.found.take() {
            return Some(ProfileItem::Finding(finding));
        }
        if let Some(item) = self.gaps.as_mut().and_then(|gaps| gaps.cross(&self.axes)) {
            return Some(item);
        }
        let Some(next) = self.follower.next() else {
            if self.tells_feeds {
                let line = self.line.take();
                self.leave_line(line);
            }
            self.watch.finish();
            return self.found.take().or_else(|| self.watch.take()).map(ProfileItem::Finding);
        };
        Some(match next {
            Ok(followed) => self.sample(&followed),
            Err(LimitError::Upstream(Halt::Io(error))) => ProfileItem::Io(error),
            Err(LimitError::Upstream(Halt::Finding(finding))) => ProfileItem::Finding(*finding),
            Err(LimitError::Kinematics { element, error }) => {
                ProfileItem::Finding(out_of_reach(self.machine, &element, &error))
            }
            Err(LimitError::NotSolved { place, error }) => {
                ProfileItem::Finding(not_solved(place, error))
            }
        })
    }
}
