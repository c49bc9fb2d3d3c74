//! A run under way, in rounds: plan, simulate what is due, listen to the drives.

use super::history::History;
use super::{Answer, DriveSample, Ending, Observer, Stopped, TwinCycle};
use crate::clock::Clock;
use crate::compare::{Comparison, Measured};
use crate::hardware::{Hardware, HardwareError};
use crate::m_function::{MCall, MFunction};
use crate::machine::Machine;
use crate::physics::PhysicsError;
use crate::plant::{AxisFeedback, Plant};
use crate::program::{ProgramItem, Setpoints};
use crate::setpoint::{AxisSetpoint, Transformer};
use std::collections::VecDeque;
use std::time::Duration;
use twin_motion::Place;

/// How long drives may take to come to rest at the end before the session ends without them.
const LONGEST_SETTLING: Duration = Duration::from_secs(10);

/// A run under way.
pub(super) struct Run<'a, P> {
    machine: &'a Machine,
    items: Setpoints,
    transformer: Transformer<'a>,
    twin: P,
    twin_failed: bool,
    hardware: Option<Hardware>,
    /// Whether time passes by itself.
    realtime: bool,
    /// Of the drives, from later than the simulated machine has come: drives are heard of at any time, it is simulated
    /// once per round.
    samples: VecDeque<AxisFeedback>,
    history: History,
    comparison: Comparison,
    /// Set-points that are planned and not yet due.
    planned: VecDeque<AxisSetpoint>,
    /// Whether there are more.
    planning: bool,
    stopped: Option<Stopped>,
    /// Time of the last set-point that was executed.
    executed_ns: i64,
    /// Its block.
    place: Place,
    /// The M function executed last.
    m_call: Option<MCall>,
}

impl<'a, P: Plant<Error = PhysicsError>> Run<'a, P> {
    /// Of `items` on `twin` and `hardware`, which stand at the start.
    pub(super) fn new(
        machine: &'a Machine,
        items: Setpoints,
        twin: P,
        hardware: Option<Hardware>,
        realtime: bool,
    ) -> Self {
        Self {
            machine,
            items,
            transformer: Transformer::new(machine),
            twin,
            twin_failed: false,
            hardware,
            realtime,
            samples: VecDeque::new(),
            history: History::new(machine),
            comparison: Comparison::new(machine.axes.len()),
            planned: VecDeque::new(),
            planning: true,
            stopped: None,
            executed_ns: 0,
            place: Place::default(),
            m_call: None,
        }
    }

    /// Whether the plan goes on only when an M function is acknowledged. A stop does not wait for that.
    pub(super) fn waits_for_word(&self) -> bool {
        self.stopped.is_none() && self.items.waits_for_word()
    }

    /// Takes notice of an M function that is executed now.
    fn begin_m_function(&mut self, call: MCall, observer: &mut dyn Observer) {
        if self.m_call.is_some_and(|last| last.index == call.index) {
            return;
        }
        self.m_call = Some(call);
        let switched = self.switches(call.number);
        if let (Some(function), Some(hardware)) = (switched, &mut self.hardware) {
            hardware.switch(&function.outputs_on, &function.outputs_off);
        }
        observer.m_function(&call, self.items.waits_for_word() && switched.is_none());
    }

    /// What the M function switches on the drives, if there are any.
    fn switches(&self, number: u16) -> Option<&'a MFunction> {
        self.hardware.as_ref()?;
        self.machine.m_functions.iter().find(|function| function.number == number)
    }

    /// Lets the path go on if the M function at which it stands is done: the drives have switched what it switches and
    /// its time is over, or the user says so.
    pub(super) fn acknowledge(&mut self, observer: &mut dyn Observer) {
        // First it has to be executed: the plan is ahead.
        let Some(call) = self.m_call.filter(|call| self.items.m_call() == Some(*call)) else {
            return;
        };
        if !self.waits_for_word() {
            return;
        }
        if let Some(function) = self.switches(call.number) {
            let switched = self.hardware.as_ref().is_none_or(Hardware::has_switched);
            if switched && self.executed_ns - call.since_ns >= function.time_ns {
                self.items.acknowledge();
            }
            return;
        }
        match observer.answer() {
            Answer::NotYet => {}
            Answer::Done => self.items.acknowledge(),
            Answer::Nobody => {
                let MCall { number, place, .. } = call;
                self.stopped = Some(Stopped::Unacknowledged { number, place });
                self.items.request_stop();
            }
        }
    }

    /// From now on the drives follow the plan by `clock`.
    pub(super) fn begin(&mut self, clock: Clock) {
        if let Some(hardware) = &mut self.hardware {
            hardware.follow(clock);
        }
    }

    /// Whether there are set-points left.
    pub(super) fn goes_on(&self) -> bool {
        self.planning || !self.planned.is_empty()
    }

    pub(super) fn executed_ns(&self) -> i64 {
        self.executed_ns
    }

    /// What has come of it.
    pub(super) fn ending(self) -> Ending {
        let Self { comparison, executed_ns, stopped, hardware, .. } = self;
        let left_on = hardware.map(|hardware| hardware.left_on().to_vec()).unwrap_or_default();
        Ending { comparison, executed_ns, stopped, left_on }
    }

    /// Obeys the user, who has interrupted so many times.
    pub(super) fn heed(&mut self, interrupts: u32) {
        // What is planned to its end goes to its end.
        let stops = if self.planning { interrupts > 0 } else { interrupts > 1 };
        if self.stopped.is_none() && stops {
            self.stopped = Some(Stopped::Interrupted(self.place));
            self.items.request_stop();
        }
        if interrupts > 1
            && let Some(hardware) = &mut self.hardware
        {
            hardware.stop();
        }
    }

    /// Plans beyond `until_ns`, and hands the drives what is planned.
    pub(super) fn plan(&mut self, until_ns: i64) {
        let paced = self.hardware.is_some() || self.realtime;
        while self.planning
            && (paced || !self.waits_for_word())
            && self.planned.back().is_none_or(|last| last.time_ns <= until_ns)
        {
            match self.items.next() {
                Some(ProgramItem::Setpoint(tool)) => {
                    let call = self.items.m_call();
                    match self.transformer.axes(&tool, call) {
                        Ok(setpoint) => {
                            if let Some(hardware) = &mut self.hardware
                                && let Err(source) = hardware.command(&setpoint)
                            {
                                self.lose_drives(source);
                            }
                            self.planned.push_back(setpoint);
                        }
                        Err(source) => self.lose_plan(Stopped::Path { place: tool.place, source }),
                    }
                }
                // The check has refused programs with errors; warnings have been shown by it.
                Some(ProgramItem::Diagnostic(_)) => {}
                Some(ProgramItem::Io(error)) => self.lose_plan(Stopped::Read(error)),
                None => self.planning = false,
            }
        }
        if !self.planning
            && let Some(hardware) = &mut self.hardware
        {
            hardware.finish(self.stopped.is_some());
        }
    }

    /// No set-points any more that lead to rest: the drives brake now; the simulated machine takes what there is.
    fn lose_plan(&mut self, reason: Stopped) {
        self.stopped.get_or_insert(reason);
        self.planning = false;
        if let Some(hardware) = &mut self.hardware {
            hardware.stop();
        }
    }

    /// The simulated machine takes what is due.
    pub(super) fn simulate(&mut self, now_ns: i64, observer: &mut dyn Observer) {
        while let Some(setpoint) = self.planned.pop_front_if(|next| next.time_ns <= now_ns) {
            self.executed_ns = setpoint.time_ns;
            self.place = setpoint.place;
            if let Some(call) = setpoint.m_call {
                self.begin_m_function(call, observer);
            }
            let feedback = self.twin.command(&setpoint).and_then(|()| self.twin.feedback());
            let feedback = match feedback {
                Ok(Some(feedback)) => feedback,
                Ok(None) => continue,
                Err(source) => return self.lose_twin(source),
            };
            if let Some((wanted, twin)) = self.history.push(self.machine, &setpoint, &feedback) {
                self.comparison.twin(&wanted, &twin, self.place);
                observer.twin(&TwinCycle { setpoint: &setpoint, wanted: &wanted, twin: &twin });
            }
        }
    }

    /// Nothing to compare with any more: the drives brake, and that is the end.
    fn lose_twin(&mut self, source: PhysicsError) {
        self.twin_failed = true;
        self.stopped.get_or_insert(Stopped::Twin { place: self.place, source });
        if let Some(hardware) = &mut self.hardware {
            hardware.stop();
        }
        self.planning = false;
        self.planned.clear();
    }

    /// The simulated machine brakes on the path. That the drives fail is worth more words than that the user has
    /// stopped them before.
    fn lose_drives(&mut self, source: HardwareError) {
        self.items.request_stop();
        if matches!(self.stopped, None | Some(Stopped::Interrupted(_) | Stopped::Unsettled)) {
            self.stopped = Some(Stopped::Drives { place: self.place, source });
        }
    }

    /// Takes what the drives have said and compares what is comparable.
    pub(super) fn listen(&mut self, observer: &mut dyn Observer) {
        let failure = loop {
            match self.hardware.as_mut().map(Plant::feedback) {
                Some(Ok(Some(feedback))) => self.samples.push_back(feedback),
                Some(Ok(None)) | None => break None,
                Some(Err(source)) => break Some(source),
            }
        };
        // After the end everything rests; before it, what a sample is compared with must have been simulated.
        let known_ns = if self.goes_on() { self.executed_ns } else { i64::MAX };
        while let Some(sample) = self.samples.pop_front_if(|sample| sample.time_ns <= known_ns) {
            self.compare(&sample, observer);
        }
        if let Some(source) = failure {
            self.lose_drives(source);
        }
    }

    fn compare(&mut self, sample: &AxisFeedback, observer: &mut dyn Observer) {
        if self.twin_failed {
            return;
        }
        let Some(drives) = Measured::new(self.machine, sample.position) else { return };
        let Some((place, wanted, twin)) = self.history.at(self.machine, sample.time_ns) else {
            return;
        };
        self.comparison.drives(&wanted, &twin, &drives, place);
        observer.drives(&DriveSample {
            time_ns: sample.time_ns,
            place,
            wanted: &wanted,
            twin: &twin,
            drives: &drives,
        });
    }

    /// Waits until the drives rest, too.
    pub(super) fn settle(
        &mut self,
        clock: Clock,
        observer: &mut dyn Observer,
        interrupts: &dyn Fn() -> u32,
    ) {
        let patience_ns = i64::try_from(LONGEST_SETTLING.as_nanos()).unwrap_or(i64::MAX);
        let deadline_ns = clock.now_ns().saturating_add(patience_ns);
        loop {
            // First whether it runs, then what it has said: what it says last is said before it ends.
            let running = self.hardware.as_ref().is_some_and(Hardware::is_running);
            self.listen(observer);
            if !running {
                return;
            }
            if clock.now_ns() >= deadline_ns {
                self.stopped.get_or_insert(Stopped::Unsettled);
                return;
            }
            if interrupts() > 1 {
                self.heed(interrupts());
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}
