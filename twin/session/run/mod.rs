//! Run loop: each round plans, simulates the set-points that are due, and reads the drives.

mod stopping;

use super::history::History;
use super::m_calls::tappet_outputs;
use super::overrides::{OverrideAt, Overrides};
use super::punctuality::Punctuality;
use super::rest::Resting;
use super::{Ending, Observer, Stopped, TwinCycle};
use crate::check;
use crate::clock::Clock;
use crate::compare::Comparison;
use crate::finding::Severity;
use crate::hardware::Hardware;
use crate::m_function::MCall;
use crate::planning::Planning;
use crate::plant::{AxisFeedback, Plant};
use crate::setpoint::HORIZON_NS;
use crate::setpoint::{AxisSetpoint, Transformer, resting_behind};
use crate::setpoint_source::PlanItem;
use std::collections::VecDeque;
use std::task::Poll;
use twin_kinematics::AxisVector;
use twin_machine::{Machine, SimulationError};
use twin_path::Place;
use twin_physics::PhysicsError;

/// State of the plan: more set-points, or a stop on or off the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plan {
    /// More of them.
    GoesOn,
    /// Nothing: they lead along the path to rest.
    Ends,
    /// Nothing: they lead off the path to rest, as fast as the axes can.
    Brakes,
}

/// A run under way.
pub(super) struct Run<'a, 'i, P> {
    pub(super) machine: &'a Machine,
    pub(super) items: Planning<'i>,
    transformer: Transformer<'a>,
    twin: P,
    pub(super) twin_failed: bool,
    pub(super) hardware: Option<Hardware>,
    /// Whether time passes by itself.
    realtime: bool,
    /// What set-points are due by, if that is the wall clock.
    clock: Option<Clock>,
    /// Samples of the drives that are later than the simulated machine. Samples arrive at any time; the machine is
    /// simulated once per round.
    pub(super) samples: VecDeque<AxisFeedback>,
    pub(super) history: History,
    pub(super) comparison: Comparison,
    /// Of a run in step with the wall clock.
    punctuality: Option<Punctuality>,
    /// Set-points that are planned and not yet due.
    planned: VecDeque<AxisSetpoint>,
    /// State of the plan behind them.
    pub(super) plan: Plan,
    pub(super) stopped: Option<Stopped>,
    overrides: Overrides,
    /// Signals of tappets, with the outputs that follow them: index, device, output.
    pub(super) tappet_outputs: Vec<(usize, usize, u8)>,
    /// How often the user has interrupted.
    interrupts: u32,
    /// Watcher of the rest positions.
    pub(super) resting: Resting,
    /// Where they leave it.
    off_path: Option<Place>,
    /// The last set-point that was executed.
    executed: Option<AxisSetpoint>,
    /// The M function executed last.
    pub(super) m_call: Option<MCall>,
}

impl<'a, 'i, P: Plant<Error = PhysicsError>> Run<'a, 'i, P> {
    /// Run of `items` on `twin` and `hardware`, which are at rest at the start.
    pub(super) fn new(
        machine: &'a Machine,
        items: Planning<'i>,
        twin: P,
        hardware: Option<Hardware>,
        realtime: bool,
    ) -> Self {
        let transformer = Transformer::new(machine);
        let tappet_outputs = tappet_outputs(machine, items.signals(&transformer));
        Self {
            machine,
            items,
            transformer,
            twin,
            twin_failed: false,
            hardware,
            realtime,
            clock: None,
            samples: VecDeque::new(),
            history: History::new(machine),
            comparison: Comparison::new(machine.axes.len()),
            punctuality: None,
            planned: VecDeque::new(),
            plan: Plan::GoesOn,
            stopped: None,
            overrides: Overrides::new(&[]),
            tappet_outputs,
            interrupts: 0,
            resting: Resting::default(),
            off_path: None,
            executed: None,
            m_call: None,
        }
    }

    /// Begins where the program before ended.
    pub(super) fn continue_from(&mut self, start: AxisVector) {
        self.transformer = Transformer::continuing(self.machine, start);
    }

    /// The run with scheduled override changes.
    pub(super) fn with_overrides(self, overrides: &[OverrideAt]) -> Self {
        Self { overrides: Overrides::new(overrides), ..self }
    }

    /// Applies an override request of the user.
    pub(super) fn heed_override(&mut self, observer: &mut dyn Observer) {
        if let Some(factor) = observer.new_override()
            && self.plan == Plan::GoesOn
            && self.stopped.is_none()
        {
            let time_ns = self.clock.map_or(self.executed_ns(), |clock| clock.now_ns());
            let factor = factor.min(self.items.most_override());
            self.overrides.ask(OverrideAt { time_ns, factor }, &mut self.items);
        }
    }

    /// Applies a request of the user for single step or a wait at the next stop.
    pub(super) fn heed_steps(&mut self, observer: &mut dyn Observer) {
        if let Some(steps) = observer.new_steps()
            && self.plan == Plan::GoesOn
            && self.stopped.is_none()
        {
            self.items.set_steps(steps);
        }
    }

    /// From now on the drives follow the plan by `clock`.
    pub(super) fn begin(&mut self, clock: Clock, paced: bool) {
        self.clock = paced.then_some(clock);
        self.punctuality = paced.then(Punctuality::new);
        if let Some(hardware) = &mut self.hardware {
            hardware.follow(clock);
        }
    }

    /// True if there are set-points left.
    pub(super) fn goes_on(&self) -> bool {
        self.plan == Plan::GoesOn || !self.planned.is_empty()
    }

    /// Planning horizon ahead of what is due, ns.
    pub(super) fn horizon_ns(&self) -> i64 {
        let hardware = if self.hardware.is_some() { HORIZON_NS } else { 0 };
        self.twin.horizon_ns().max(hardware)
    }

    /// Time of the last set-point that was executed, ns.
    pub(super) fn executed_ns(&self) -> i64 {
        self.executed.map_or(0, |executed| executed.time_ns)
    }

    /// Its block.
    pub(super) fn place(&self) -> Place {
        self.executed.map_or(Place::default(), |executed| executed.place)
    }

    /// Result of the run.
    pub(super) fn ending(self) -> Ending {
        let executed_ns = self.executed_ns();
        let late_plans = self.items.late_plans();
        let record = self.twin.record();
        let Self { comparison, punctuality, stopped, off_path, mut hardware, overrides, .. } = self;
        let rest = stopped.as_ref().and_then(|_| self.resting.rest());
        // Drives that have not come to rest are stopped now, and their answers are reported, too.
        if let Some(hardware) = hardware.as_mut().filter(|hardware| hardware.is_running()) {
            hardware.abandon();
        }
        let attached = hardware.as_ref();
        let not_stopped =
            attached.map(|attached| attached.not_stopped().to_vec()).unwrap_or_default();
        let restarted = attached.map(|attached| attached.restarted().to_vec()).unwrap_or_default();
        let heard = attached.map(Hardware::heard).unwrap_or_default();
        let switched = attached.map(Hardware::switched).unwrap_or_default();
        let last_heard = attached.map(Hardware::last_heard).unwrap_or_default();
        let left_on = attached.map(|attached| attached.left_on().to_vec()).unwrap_or_default();
        let stopping = hardware.filter(Hardware::is_running);
        let overrides = overrides.into_changes();
        Ending {
            comparison,
            record,
            executed_ns,
            stopped,
            rest,
            off_path,
            overrides,
            late_plans,
            punctuality,
            heard,
            switched,
            last_heard,
            left_on,
            not_stopped,
            restarted,
            stopping,
        }
    }

    /// Plans beyond `until_ns`, and sends the plan to the drives.
    pub(super) fn plan(&mut self, until_ns: i64) {
        let paced = self.hardware.is_some() || self.realtime;
        // Before the beginning there is time.
        let waits = self.clock.is_none();
        while self.plan == Plan::GoesOn
            && (paced || !self.waits_for_word())
            && self.planned.back().is_none_or(|last| last.time_ns <= until_ns)
        {
            if self.stopped.is_none() {
                let last = self.planned.back().or(self.executed.as_ref());
                let next_ns = last.map_or(0, |last| last.time_ns + self.machine.cycle_ns);
                self.overrides.apply_due(next_ns, &mut self.items);
            }
            let Poll::Ready(item) = self.items.poll(waits) else { break };
            match item {
                Some(PlanItem::Tool(tool)) => {
                    self.overrides.observe(tool.time_ns, &self.items);
                    if let Some(bridge) = self.transformer.bridge(&tool) {
                        self.items.bridge(bridge, &tool);
                        continue;
                    }
                    let call = self.items.m_call();
                    match self.transformer.axes(&tool, call) {
                        Ok(setpoint) => self.take(&setpoint),
                        Err(source) => self.fail_plan(Stopped::Path { place: tool.place, source }),
                    }
                }
                Some(PlanItem::Bridging(instant)) => match self.transformer.bridging(&instant) {
                    Ok(setpoint) => self.take(&setpoint),
                    Err(source) => {
                        self.fail_plan(Stopped::Path { place: instant.place, source });
                    }
                },
                Some(PlanItem::Axes(setpoint)) => {
                    self.overrides.observe(setpoint.time_ns, &self.items);
                    self.take(&setpoint);
                }
                // The check has refused programs with errors; warnings have been shown by it.
                Some(PlanItem::Diagnostic(finding)) => {
                    if finding.severity == Severity::Error {
                        let (place, message) = (finding.place(), finding.message);
                        self.fail_plan(Stopped::Program { place, message });
                    }
                }
                Some(PlanItem::Io(error)) => self.fail_plan(Stopped::Read(error)),
                None => {
                    self.plan = Plan::Ends;
                    self.settle_stop();
                }
            }
        }
        if self.plan != Plan::GoesOn
            && let Some(hardware) = &mut self.hardware
        {
            hardware.finish(self.stopped.is_some());
        }
    }

    /// A set-point more is planned.
    fn take(&mut self, setpoint: &AxisSetpoint) {
        self.planned.push_back(*setpoint);
        if let Some(hardware) = &mut self.hardware
            && let Err(source) = hardware.command(setpoint)
        {
            self.lose_drives(source);
        }
    }

    /// Records the lateness of the cycles that are due, in step with the wall clock.
    pub(super) fn record_lateness(&mut self, now_ns: i64) {
        let Some(punctuality) = &mut self.punctuality else { return };
        for due in self.planned.iter().take_while(|next| next.time_ns <= now_ns) {
            punctuality.record(due.time_ns, now_ns);
        }
    }

    /// The computer has slept.
    pub(super) fn record_sleep(&mut self, slept_ns: i64) {
        if let Some(punctuality) = &mut self.punctuality {
            punctuality.slept(slept_ns);
        }
    }

    /// Simulates the set-points that are due.
    pub(super) fn simulate(&mut self, now_ns: i64, observer: &mut dyn Observer) {
        while let Some(setpoint) = self.planned.pop_front_if(|next| next.time_ns <= now_ns) {
            let before = self.executed.replace(setpoint);
            self.resting.executed(&setpoint);
            if self.twin_failed {
                continue;
            }
            if let Some(call) = setpoint.m_call {
                self.begin_m_function(call, observer);
            }
            self.switch_outputs(before.as_ref(), &setpoint);
            let feedback = self.twin.command_before(&setpoint, &self.planned);
            let feedback = feedback.and_then(|()| self.twin.feedback());
            for news in self.twin.news() {
                if let Some(finding) = check::happening(self.machine, &news) {
                    observer.happened(setpoint.time_ns, news.place, &finding.message);
                }
            }
            for news in self.twin.body_news() {
                if let Some(finding) = check::handled(self.machine, &news) {
                    observer.happened(setpoint.time_ns, news.place, &finding.message);
                }
            }
            let feedback = match feedback {
                Ok(Some(feedback)) => feedback,
                Ok(None) => continue,
                Err(source) => {
                    let source = SimulationError::with_tool(self.machine, source, self.twin.tool());
                    observer.happened(setpoint.time_ns, setpoint.place, &source.to_string());
                    return self.lose_twin(source);
                }
            };
            if let Some((wanted, twin)) = self.history.push(self.machine, &setpoint, &feedback) {
                self.comparison.twin(&wanted, &twin, setpoint.place);
                self.resting.twin = Some(twin);
                let motors = self.twin.motors();
                let (wanted, twin) = (&wanted, &twin);
                let bodies = &self.twin.body_poses();
                observer.twin(&TwinCycle { setpoint: &setpoint, wanted, twin, motors, bodies });
            }
        }
    }

    /// Lets drives in the loop of the simulated machine come to rest behind the last set-point.
    pub(super) fn arrive(&mut self, observer: &mut dyn Observer) {
        let Some(last) = self.executed else { return };
        for resting in resting_behind(&last, self.machine.cycle_ns) {
            if self.twin_failed || self.twin.has_arrived() {
                break;
            }
            self.planned.push_back(resting);
            self.simulate(resting.time_ns, observer);
        }
        // The program has ended when its last set-point was there.
        self.executed = Some(last);
    }
}
