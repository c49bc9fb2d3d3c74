//! The controller of a job: its axes and blocks, cycle by cycle.

mod end;
mod inputs;
mod moved;
mod watch;

use super::block::{Fired, With};
use super::{Begins, Call, Job, ON_TOP, cam_before};
use crate::finding::{Finding, Rule, Severity};
use crate::machine::Machine;
use crate::report::seconds;
use inputs::Inputs;
use moved::{Moved, Moving, assumed_jerks};
use twin_motion::Place;
use twin_motion::axis::{AxisConfig, Language, Master, Outputs, SmcError};
use twin_motion::cam::Trigger;

/// Where an axis is and how it moves, in its unit; a rotary axis from period to period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct State {
    pub(super) position: f64,
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
}

/// The block that keeps its axis when it is done.
const STOP: &str = "MC_Stop";

/// Values of a virtual axis that nobody limits.
const UNLIMITED: f64 = 1e9;

/// Axes and blocks of a job under way.
#[derive(Debug)]
pub(super) struct Engine {
    axes: Vec<Moved>,
    calls: Vec<Running>,
    /// Axes, masters first, each with the numbers of its calls.
    order: Vec<(usize, Vec<usize>)>,
    /// The triggers of probes.
    inputs: Inputs,
    /// What blocks have had to tell since it was asked for.
    notes: Vec<Finding>,
    /// Tappets that acted in the last cycle.
    fired: Vec<Fired>,
    /// Those that had no room in it, since the beginning.
    lost: u64,
    cycle_ns: i64,
    /// Since the beginning.
    now_ns: i64,
    /// When every axis that leads is halted.
    duration_ns: Option<i64>,
    /// When something moved or began last.
    moved_ns: i64,
    /// The block that has begun last.
    line: u32,
    last_line: u32,
}

/// A block under way, or before or after that.
#[derive(Debug)]
struct Running {
    call: Call,
    begun_ns: Option<i64>,
    over_ns: Option<i64>,
}

impl Engine {
    /// Of `job` on `machine`, whose axes stand at `start` (their units).
    pub(super) fn new(job: Job, machine: &Machine, start: &[f64]) -> Self {
        let cycle_ns = machine.cycle_ns.max(1);
        let config = AxisConfig {
            cycle: seconds(cycle_ns),
            ramp: job.ramp,
            max_velocity: UNLIMITED,
            ..AxisConfig::default()
        };
        let real = machine.axes.iter().zip(start).map(|(axis, start)| {
            let of = |value| axis.from_si(value);
            let acceleration = of(axis.max_acceleration);
            let jerk = axis.max_jerk.map(of);
            let velocity = of(axis.max_velocity);
            let limits = (velocity, acceleration, jerk);
            let (name, period, start) = (axis.name.clone(), axis.period.map(of), *start);
            Moving { name, unit: axis.unit(), period, limits, start }
        });
        let imagined = job.virtual_axes.iter().map(|axis| {
            let limits = (UNLIMITED, axis.max_acceleration.unwrap_or(UNLIMITED), axis.max_jerk);
            let (name, period, start) = (axis.name.clone(), axis.period, axis.start);
            Moving { name, unit: axis.unit, period, limits, start }
        });
        let moving: Vec<_> = real.chain(imagined).collect();
        let without_jerk: Vec<_> = moving
            .iter()
            .map(|axis| axis.limits.2.is_none().then(|| axis.assumed_jerk()))
            .collect();
        // Blocks tell axes by their numbers.
        let config = |drive_id| AxisConfig { drive_id, ..config };
        let axes = (0..).zip(moving).map(|(id, moving)| Moved::new(moving, config(id)));
        let axes = axes.map(Moved::switched_on).collect();
        let assumed = assumed_jerks(&job, &without_jerk);
        let running = |call| Running { call, begun_ns: None, over_ns: None };
        let last_line = job.calls.iter().map(|call| call.line).max().unwrap_or(1);
        Self {
            axes,
            line: job.calls.first().map_or(1, |call| call.line),
            last_line,
            calls: job.calls.into_iter().map(running).collect(),
            order: job.order,
            inputs: Inputs::new(&job.triggers),
            notes: assumed,
            fired: Vec::new(),
            lost: 0,
            cycle_ns,
            now_ns: 0,
            moved_ns: 0,
            duration_ns: job.duration.map(nanoseconds),
        }
    }

    /// How the axes move now, those of the machine first.
    pub(super) fn states(&self) -> impl Iterator<Item = State> {
        self.axes.iter().map(|moved| moved.state)
    }

    /// Where the axes are by their own zeros, in the order of their states.
    pub(super) fn positions(&self) -> impl Iterator<Item = f64> {
        self.axes.iter().map(|moved| moved.axis.set_position())
    }

    /// Whether blocks take `slave` from what has it follow `master` all the time, or move the zero of one of them.
    pub(super) fn disturbs(&self, slave: usize, master: usize) -> bool {
        let called = self.calls.iter().map(|running| &running.call);
        called.filter(|call| call.begins != Begins::Standing).any(|call| {
            let zero = ["MC_SetPosition", "MC_Home"].contains(&call.name);
            (call.axis == master && zero)
                || (call.axis == slave && (zero || !ON_TOP.contains(&call.name)))
        })
    }

    /// Tappets that acted in the last cycle.
    pub(super) fn fired(&self) -> &[Fired] {
        &self.fired
    }

    /// What blocks have told since the last time.
    pub(super) fn take_notes(&mut self) -> Vec<Finding> {
        std::mem::take(&mut self.notes)
    }

    /// Tappets that did not because there were too many in a cycle, since the beginning.
    pub(super) fn lost(&self) -> u64 {
        self.lost
    }

    /// The time of the last cycle, ns.
    pub(super) fn now_ns(&self) -> i64 {
        self.now_ns
    }

    /// The block that has begun last.
    pub(super) fn place(&self) -> Place {
        Place { line: self.line, block: None }
    }

    /// The part of the blocks that have begun, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        f64::from(self.line) / f64::from(self.last_line.max(1))
    }

    /// The next cycle; false if everything is done and stands.
    ///
    /// # Errors
    /// What a block says is wrong, what never ends.
    pub(super) fn step(&mut self) -> Result<bool, Box<Finding>> {
        if self.is_over()? {
            return Ok(false);
        }
        let begin_ns = self.now_ns;
        self.now_ns += self.cycle_ns;
        self.fired.clear();
        self.axes.iter_mut().for_each(Moved::begin);
        self.inputs.see(begin_ns, self.cycle_ns, &self.axes);
        self.raise(begin_ns);
        let order = std::mem::take(&mut self.order);
        let called = order.iter().try_for_each(|(axis, calls)| self.call_on(*axis, calls));
        self.order = order;
        called?;
        self.axes.iter_mut().for_each(Moved::end);
        self.refuse_jumps()?;
        if !self.axes.iter().all(Moved::stands) {
            self.moved_ns = self.now_ns;
        }
        let failed = self.axes.iter().find_map(|moved| Some((moved, moved.axis.error_id()?)));
        match failed {
            Some((moved, id)) => {
                let error = u16::try_from(id).ok().and_then(SmcError::from_number);
                let said = error.map_or(format!("error {id}"), told);
                let message = format!("axis {} stops by itself: {said}", moved.name);
                Err(Finding::error(Rule::FunctionBlock, self.place(), message).into())
            }
            None => Ok(true),
        }
    }

    /// Lets begin what is due at `now_ns`.
    fn raise(&mut self, now_ns: i64) {
        if self.is_halting() {
            return;
        }
        let (mut previous_begun, mut previous_over) = (Some(0), Some(0));
        for running in &mut self.calls {
            let due_ns = match running.call.begins {
                Begins::At(time) => Some(nanoseconds(time)),
                Begins::WithPrevious => previous_begun,
                Begins::Standing => Some(0),
                // In the middle of a cycle.
                Begins::EndOfProfile => None,
                Begins::Next => previous_over,
                Begins::After(pause) => {
                    previous_over.map(|over: i64| over.saturating_add(nanoseconds(pause)))
                }
            };
            if running.begun_ns.is_none() && due_ns.is_some_and(|due| due <= now_ns) {
                running.begun_ns = Some(now_ns);
                self.moved_ns = now_ns;
                self.line = running.call.line.max(1);
            }
            if running.call.begins != Begins::Standing {
                (previous_begun, previous_over) = (running.begun_ns, running.over_ns);
            }
        }
    }

    /// Calls the blocks of an axis; at the end of the job it is halted, before its slaves look at it.
    fn call_on(&mut self, axis: usize, calls: &[usize]) -> Result<(), Box<Finding>> {
        calls.iter().try_for_each(|index| self.call(*index))?;
        if self.is_halting() {
            let master_moves = self.master(axis).is_some_and(|master| !master.stands());
            if let Some(moved) = self.axes.get_mut(axis) {
                moved.halt(master_moves);
            }
        }
        Ok(())
    }

    /// Whether the block that has this one's axis on a cam, and has been called in this cycle, has come to its end.
    fn comes_behind_a_profile(&self, index: usize) -> bool {
        let waits = self.calls.get(index).is_some_and(|running| {
            running.begun_ns.is_none() && running.call.begins == Begins::EndOfProfile
        });
        if !waits || self.is_halting() {
            return false;
        }
        let Some((before, behind)) = self.calls.split_at_checked(index) else { return false };
        let cam = behind.first().and_then(|waiting| {
            let blocks = before.iter().map(|running| (running.call.name, running.call.axis));
            before.get(cam_before(blocks, waiting.call.axis)?)
        });
        cam.is_some_and(|cam| cam.call.block.ends_profile())
    }

    /// Calls a block, if it has begun.
    fn call(&mut self, index: usize) -> Result<(), Box<Finding>> {
        let follows = self.comes_behind_a_profile(index);
        let Some(running) = self.calls.get_mut(index) else { return Ok(()) };
        if follows {
            let begin_ns = self.now_ns - self.cycle_ns;
            running.begun_ns = Some(begin_ns);
            self.moved_ns = begin_ns;
            self.line = running.call.line.max(1);
        }
        let Some(begun_ns) = running.begun_ns else { return Ok(()) };
        let first = begun_ns + self.cycle_ns == self.now_ns;
        let call = &mut running.call;
        let master = call.master.and_then(|master| self.axes.get(master));
        let master = master.map(|moved| Master::of(&moved.axis));
        let Some(moved) = self.axes.get_mut(call.axis) else { return Ok(()) };
        // A stop keeps its axis until Execute falls: when the axis stands, so that others may move it.
        let execute = !(call.name == STOP && running.over_ns.is_some());
        let with = With { master, triggers: self.inputs.triggers() };
        let Outputs { done, command_aborted, error, busy: _ } =
            call.block.call(execute, &mut moved.axis, with);
        let place = Place { line: call.line, block: None };
        if let Some(error) = error {
            let message = format!("{} of axis {}: {}", call.name, moved.name, told(error));
            let mut finding = Finding::error(Rule::FunctionBlock, place, message);
            finding.axis = Some(moved.name.clone());
            let more = format!("`twin explain {}` says more", error.number());
            let start = call.block.cam_start().filter(|_| error == SmcError::CiMasterOutOfScale);
            let master = call.master.and_then(|master| self.axes.get(master));
            finding.hint = Some(if error.name().ends_with("_VELACC_VALUES") {
                format!("velocity, acceleration and deceleration have to be greater than 0; {more}")
            } else if let (Some(start), Some(master)) = (start, master) {
                format!("{}; {more}", watch::beside(start, master))
            } else {
                more
            });
            return Err(finding.into());
        }
        if let (Some(data), Some(master)) = (call.block.tappets(), call.master) {
            self.lost = self.lost.saturating_add(u64::try_from(data.lost).unwrap_or(u64::MAX));
            // The axes had their power before the job began to count.
            let (slave, later_ns) = (call.axis, self.now_ns - data.now_ns);
            let dead_time = call.block.dead_time();
            self.fired.extend(data.triggers().map(|trigger| {
                let time_ns = trigger.time_ns.saturating_add(later_ns);
                Fired { slave, master, trigger: Trigger { time_ns, ..*trigger }, dead_time }
            }));
        }
        let over = running.over_ns.is_some();
        if done || command_aborted {
            running.over_ns.get_or_insert(self.now_ns);
        }
        if let Some(position) = call.block.recorded().filter(|_| !over) {
            let Moved { name, unit, .. } = moved;
            let message = format!("{} has recorded axis {name} at {position:.6} {unit}", call.name);
            let mut note = Finding::error(Rule::FunctionBlock, place, message);
            (note.severity, note.axis) = (Severity::Note, Some(name.clone()));
            self.notes.push(note);
        }
        if command_aborted && !over && !self.is_halting() {
            return self.loses(index);
        }
        if first && !command_aborted {
            return self.takes(index);
        }
        Ok(())
    }
}

/// An error in words.
fn told(error: SmcError) -> String {
    format!("{} ({}): {}", error.name(), error.number(), error.text(Language::English))
}

#[expect(clippy::cast_possible_truncation, reason = "a day at most")]
fn nanoseconds(time: f64) -> i64 {
    (time * 1e9).round() as i64
}
