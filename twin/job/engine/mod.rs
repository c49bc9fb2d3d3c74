//! Job engine: the simulated controller with its axes and blocks, cycle by cycle.

mod called;
mod deadlock;
mod end;
mod inputs;
mod moved;
mod order;
mod schedule;
#[cfg(test)]
mod tests;
mod watch;

use super::block::Fired;
use super::{Begins, Call, CamsBefore, Job, ON_TOP, SUPERIMPOSED};
use crate::finding::{Finding, Rule};
use called::message;
use inputs::Inputs;
use moved::{Moved, Moving, assumed_jerks};
use schedule::Schedule;
use std::collections::BTreeMap;
use twin_axis::{AxisConfig, SmcError};
use twin_machine::Machine;
use twin_number::seconds;
use twin_path::Place;

/// State of motion of an axis, in its unit; a rotary axis from period to period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct State {
    pub(super) position: f64,
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
}

/// The block that keeps its axis when it is done.
const STOP: &str = "MC_Stop";

/// Limits of a virtual axis without limits.
const UNLIMITED: f64 = 1e9;

/// Axes and blocks of a job under way.
#[derive(Debug)]
pub(super) struct Engine {
    axes: Vec<Moved>,
    calls: Vec<Running>,
    /// Axes, masters first.
    order: Vec<usize>,
    /// Blocks that have begun since that was made.
    began: Vec<usize>,
    schedule: Schedule,
    /// Blocks to be called of each axis, in the order of the file: those under way, and those that wait for the end of a cam
    /// under way.
    active: Vec<Vec<usize>>,
    /// Blocks that wait for the end of a cam that has not begun, by the cam's number.
    waiting: BTreeMap<usize, Vec<usize>>,
    /// The first block that is not over.
    open: usize,
    /// How many have not begun.
    unbegun: usize,
    /// The triggers of probes.
    inputs: Inputs,
    /// New notes of blocks.
    notes: Vec<Finding>,
    /// Tappets that acted in the last cycle.
    fired: Vec<Fired>,
    /// Tappets beyond the limit of a cycle, since the beginning.
    lost: u64,
    cycle_ns: i64,
    /// Since the beginning.
    now_ns: i64,
    /// When every axis that leads is halted.
    duration_ns: Option<i64>,
    /// When something moved or began last.
    moved_ns: i64,
    /// When an axis changed its velocity or a block began or was over last.
    changed_ns: i64,
    /// The block that has begun last.
    line: u32,
    /// How often blocks have been called.
    #[cfg(test)]
    called: u64,
}

/// A block under way, or before or after that.
#[derive(Debug)]
struct Running {
    call: Call,
    begun_ns: Option<i64>,
    over_ns: Option<i64>,
    /// Over, and with nothing left to do: it is not called any more.
    ended: bool,
    /// The block whose cam it waits for the end of.
    behind: Option<usize>,
}

impl Engine {
    /// Engine of `job` on `machine`, whose axes are at rest at `start` (their units).
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
            let deceleration = of(axis.max_deceleration);
            Moving { name, unit: axis.unit(), period, limits, deceleration, start }
        });
        let imagined = job.virtual_axes.iter().map(|axis| {
            let limits = (UNLIMITED, axis.max_acceleration.unwrap_or(UNLIMITED), axis.max_jerk);
            let (name, period, start) = (axis.name.clone(), axis.period, axis.start);
            let deceleration = limits.1;
            Moving { name, unit: axis.unit, period, limits, deceleration, start }
        });
        let moving: Vec<_> = real.chain(imagined).collect();
        let without_jerk: Vec<_> = moving
            .iter()
            .map(|axis| axis.limits.2.is_none().then(|| axis.assumed_jerk()))
            .collect();
        // Blocks tell axes by their numbers.
        let config = |drive_id| AxisConfig { drive_id, ..config };
        let axes = (0..).zip(moving).map(|(id, moving)| Moved::new(moving, config(id)));
        let axes: Vec<_> = axes.map(Moved::switched_on).collect();
        let assumed = assumed_jerks(&job, &without_jerk);
        let schedule = Schedule::new(&job.calls);
        let (line, unbegun) = (job.calls.first().map_or(1, |call| call.line), job.calls.len());
        let (mut cams, mut waiting) = (CamsBefore::default(), BTreeMap::<_, Vec<_>>::new());
        let running = |(index, call): (usize, Call)| {
            let behind = cams.of(call.axis).filter(|_| call.begins == Begins::EndOfProfile);
            if let Some(cam) = behind {
                waiting.entry(cam).or_default().push(index);
            }
            cams.pass(index, call.name, call.axis);
            Running { call, begun_ns: None, over_ns: None, ended: false, behind }
        };
        let calls = job.calls.into_iter().enumerate().map(running).collect();
        Self {
            order: (0..axes.len()).collect(),
            active: vec![Vec::new(); axes.len()],
            waiting,
            axes,
            line,
            calls,
            began: Vec::new(),
            schedule,
            open: 0,
            unbegun,
            inputs: Inputs::new(&job.triggers),
            notes: assumed,
            fired: Vec::new(),
            lost: 0,
            cycle_ns,
            now_ns: 0,
            moved_ns: 0,
            changed_ns: 0,
            duration_ns: job.duration.map(nanoseconds),
            #[cfg(test)]
            called: 0,
        }
    }

    /// Present states of the axes, those of the machine first.
    pub(super) fn states(&self) -> impl Iterator<Item = State> {
        self.axes.iter().map(|moved| moved.state)
    }

    /// Positions of the axes from their own zeros, in the order of their states.
    pub(super) fn positions(&self) -> impl Iterator<Item = f64> {
        self.axes.iter().map(|moved| moved.axis.set_position())
    }

    /// True if blocks release `slave` from its standing coupling to `master`, or move the zero of one of them.
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

    /// Notes of blocks since the last call.
    pub(super) fn take_notes(&mut self) -> Vec<Finding> {
        std::mem::take(&mut self.notes)
    }

    /// Tappets that did not because there were too many in a cycle, since the beginning.
    pub(super) fn lost(&self) -> u64 {
        self.lost
    }

    /// Name of an axis.
    fn name(&self, axis: usize) -> &str {
        self.axes.get(axis).map_or("", |moved| &moved.name)
    }

    /// The time of the last cycle, ns.
    pub(super) fn now_ns(&self) -> i64 {
        self.now_ns
    }

    /// The block that has begun last.
    pub(super) fn place(&self) -> Place {
        Place::at(self.line)
    }

    #[cfg(test)]
    pub(super) fn block_calls(&self) -> u64 {
        self.called
    }

    /// Completed part of the job, 0 to 1, if the job gives its duration. The duration of its blocks is not known in
    /// advance.
    pub(super) fn progress(&self) -> Option<f64> {
        let duration_ns = self.duration_ns.filter(|duration| *duration > 0)?;
        Some((seconds(self.now_ns) / seconds(duration_ns)).min(1.0))
    }

    /// Executes the next cycle; false if everything is done and at rest.
    ///
    /// # Errors
    /// The error of a block, or a wait or motion without end.
    pub(super) fn step(&mut self) -> Result<bool, Box<Finding>> {
        while self.calls.get(self.open).is_some_and(|running| running.over_ns.is_some()) {
            self.open += 1;
        }
        if self.is_over()? {
            return Ok(false);
        }
        let begin_ns = self.now_ns;
        self.now_ns += self.cycle_ns;
        self.fired.clear();
        self.axes.iter_mut().for_each(Moved::begin);
        self.inputs.observe(begin_ns, self.cycle_ns, &self.axes);
        self.raise(begin_ns);
        self.reorder()?;
        for place in 0..self.order.len() {
            if let Some(axis) = self.order.get(place).copied() {
                self.call_on(axis)?;
            }
        }
        self.axes.iter_mut().for_each(Moved::end);
        self.refuse_jumps()?;
        if !self.axes.iter().all(Moved::stands) {
            self.moved_ns = self.now_ns;
        }
        if !self.axes.iter().all(Moved::is_steady) {
            self.changed_ns = self.now_ns;
        }
        let failed = self.axes.iter().find_map(|moved| Some((moved, moved.axis.error_id()?)));
        match failed {
            Some((moved, id)) => {
                let error = u16::try_from(id).ok().and_then(SmcError::from_number);
                let said = error.map_or(format!("error {id}"), message);
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
        let mut last = None;
        while let Some(index) = self.schedule.next(now_ns) {
            self.begin(index, now_ns);
            last = last.max(Some(index));
        }
        if let Some(running) = last.and_then(|last| self.calls.get(last)) {
            self.line = running.call.line.max(1);
        }
    }

    /// A block begins; so may those that wait for the end of its cam, once that comes.
    fn begin(&mut self, index: usize, now_ns: i64) {
        let Some(running) = self.calls.get_mut(index) else { return };
        running.begun_ns = Some(now_ns);
        let axis = running.call.axis;
        self.line = running.call.line.max(1);
        (self.moved_ns, self.changed_ns) = (now_ns, now_ns);
        self.unbegun = self.unbegun.saturating_sub(1);
        self.began.push(index);
        self.schedule.begun(index, now_ns);
        let Some(active) = self.active.get_mut(axis) else { return };
        let waiting = self.waiting.remove(&index).unwrap_or_default();
        for index in waiting.into_iter().chain([index]) {
            if let Err(place) = active.binary_search(&index) {
                active.insert(place, index);
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a day at most")]
fn nanoseconds(time: f64) -> i64 {
    (time * 1e9).round() as i64
}
