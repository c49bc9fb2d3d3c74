//! Run session: sends the same set-points to the simulated machine and to the drives, and compares their responses.

mod braking;
mod drives;
mod history;
mod m_calls;
mod overrides;
mod punctuality;
mod rest;
mod run;

use crate::clock::Clock;
use crate::compare::{Comparison, Measured};
use crate::hardware::{Hardware, HardwareError, Heard, LastHeard, SwitchedOutputs};
use crate::limit::{LimitFailure, Limits};
use crate::m_function::{Acknowledge, Acknowledgement, MCall};
use crate::planning::Planning;
use crate::plant::{Plant, PlantRecord};
use crate::program::ProgramFile;
use crate::program::inputs::Steps;
use crate::setpoint::AxisSetpoint;
use nalgebra::Isometry3;
pub use overrides::{OverrideAt, OverrideAtError, OverrideChange, override_factor};
pub use punctuality::Punctuality;
pub use rest::{Rest, whereabouts};
use run::Run;
use std::time::Duration;
use twin_kinematics::AxisVector;
use twin_machine::axis_couplings::AxesError;
use twin_machine::{Machine, SimulationError};
use twin_number::seconds;
use twin_path::Place;
use twin_physics::{MotorState, PhysicsError};

/// Set-points simulated in one go where nothing has to wait for the wall clock.
const BATCH_NS: i64 = 100_000_000;

/// Longest time between two looks at user and drives in step with the wall clock, ns.
const ROUND_NS: i64 = 1_000_000;

/// One cycle of the simulated machine.
#[derive(Clone, Copy, Debug)]
pub struct TwinCycle<'a> {
    /// The set-point.
    pub setpoint: &'a AxisSetpoint,
    /// Tool and axes of the set-point.
    pub wanted: &'a Measured,
    /// Tool and axes of the simulated machine.
    pub twin: &'a Measured,
    /// States of its motors in the cycle, in machine-file order; none where they are not known.
    pub motors: &'a [MotorState],
    /// Poses of its loose bodies, machine frame.
    pub bodies: &'a [Isometry3<f64>],
}

/// One sample of the drives.
#[derive(Clone, Copy, Debug)]
pub struct DriveSample<'a> {
    /// Time, ns since the start of the program.
    pub time_ns: i64,
    /// The block in which the set-point was then.
    pub place: Place,
    /// The set-point at that time.
    pub wanted: &'a Measured,
    /// The simulated machine at that time.
    pub twin: &'a Measured,
    /// The drives.
    pub drives: &'a Measured,
}

/// Observer of a run.
pub trait Observer {
    /// A cycle of the simulated machine.
    fn twin(&mut self, cycle: &TwinCycle<'_>);
    /// Something has happened to the simulated machine, in words.
    fn happened(&mut self, _time_ns: i64, _place: Place, _what: &str) {}
    /// A sample of the drives.
    fn drives(&mut self, sample: &DriveSample<'_>);
    /// The path stands at an M function; [`Self::answer`] is asked when the user is to acknowledge it.
    fn m_function(&mut self, call: &MCall, asked: bool);
    /// What the user says to the M function at which the path stands.
    fn answer(&mut self) -> Answer;
    /// The override that the user wants from now on, if that is another than before; 0 is a feed hold.
    fn new_override(&mut self) -> Option<f64> {
        None
    }
    /// Single step and waiting at the next stop as the user wants them from now on, if that is not as before.
    fn new_steps(&mut self) -> Option<Steps> {
        None
    }
}

/// Answer of the user to an M function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Nothing yet.
    NotYet,
    /// It is done.
    Done,
    /// There is nobody who could say anything.
    Nobody,
}

/// Result of a run.
#[derive(Debug)]
pub struct Ending {
    /// Errors of twin and drives.
    pub comparison: Comparison,
    /// Record of the simulated machine.
    pub record: PlantRecord,
    /// Time of the last set-point that was executed, ns.
    pub executed_ns: i64,
    /// Reason of a stop before the end of the program.
    pub stopped: Option<Stopped>,
    /// Rest positions of the axes after a stop.
    pub rest: Option<Rest>,
    /// Place where the axes left the path to come to rest, each at its own limits.
    pub off_path: Option<Place>,
    /// Changes of the override.
    pub overrides: Vec<OverrideChange>,
    /// Number of new plans that came too late, so that the path went on as planned before.
    pub late_plans: u64,
    /// Cycle lateness, in step with the wall clock.
    pub punctuality: Option<Punctuality>,
    /// Sample statistics of each device, by its name.
    pub heard: Vec<(String, Heard)>,
    /// Switching delays of devices, by their names.
    pub switched: Vec<(String, SwitchedOutputs)>,
    /// Last known axis positions of each device.
    pub last_heard: Vec<LastHeard>,
    /// Outputs of the drives that are perhaps still on although the run has ended early.
    pub left_on: Vec<u8>,
    /// Devices that did not confirm that they stop, and why: whether their axes move is not known.
    pub not_stopped: Vec<String>,
    /// Devices that were found restarted after they had failed, in words.
    pub restarted: Vec<String>,
    /// Drives of which some still wait for an answer of their device before they can stop it: dropping them waits for that.
    pub stopping: Option<Hardware>,
}

impl Ending {
    /// The ending of a run that never began.
    pub fn nothing(machine: &Machine) -> Self {
        let comparison = Comparison::new(machine.axes.len());
        Self {
            comparison,
            record: PlantRecord::default(),
            executed_ns: 0,
            stopped: None,
            rest: None,
            off_path: None,
            overrides: Vec::new(),
            late_plans: 0,
            punctuality: None,
            heard: Vec::new(),
            switched: Vec::new(),
            last_heard: Vec::new(),
            left_on: Vec::new(),
            not_stopped: Vec::new(),
            restarted: Vec::new(),
            stopping: None,
        }
    }

    /// How long this computer stood still before the drives failed, ns, if longer than the plan of the drives lasts.
    pub fn standstill_ns(&self) -> Option<i64> {
        let failed = matches!(self.stopped, Some(Stopped::Drives { .. }));
        self.punctuality.as_ref().filter(|_| failed)?.standstill_ns()
    }

    /// Reason of a stop before the end of the program, and the way to rest, in words.
    pub fn reason(&self) -> Option<String> {
        let stopped = self.stopped.as_ref()?;
        let mut reason = stopped.to_string();
        if let Some(standstill_ns) = self.standstill_ns() {
            let standstill = seconds(standstill_ns);
            reason = format!(
                "{reason}; this computer stood still for {standstill:.1} s before: the process was stopped, or the computer slept \
                 or was overloaded"
            );
        }
        for cause in &self.restarted {
            reason = format!("{reason}; {cause}");
        }
        Some(match self.off_path {
            Some(place) => format!(
                "{reason}; from {place} on the axes left the path and braked, each at its own limits"
            ),
            None => reason,
        })
    }
}

/// Reasons of a stop before the end of the program. Twin and drives have come to rest.
#[derive(Debug, thiserror::Error)]
pub enum Stopped {
    /// The user asked for it.
    #[error("stopped by the user at {0}; from there the axes braked along the path")]
    Interrupted(Place),
    /// The drives failed; every axis of the simulated machine braked at its own limits.
    #[error("the drives failed at {place}: {source}")]
    Drives {
        /// The block in which the set-point was.
        place: Place,
        /// Why.
        source: HardwareError,
    },
    /// The simulated machine failed.
    #[error("the simulated machine failed at {place}: {source}")]
    Twin {
        /// The block in which the set-point was.
        place: Place,
        /// Why.
        source: SimulationError,
    },
    /// A set-point that the machine cannot reach, although the check let the program pass: the file has changed.
    #[error("{place}: {source}; has the program file changed since it was checked?")]
    Path {
        /// The block.
        place: Place,
        /// Why.
        source: AxesError,
    },
    /// A program in which something is found wrong that the check has not found: the file has changed.
    #[error("{place}: {message}; has the program file changed since it was checked?")]
    Program {
        /// The block.
        place: Place,
        /// What is wrong.
        message: String,
    },
    /// The program file could no longer be read.
    #[error("the program file cannot be read any further: {0}")]
    Read(std::io::Error),
    /// An M function that nobody can acknowledge.
    #[error("M{number} at {place} cannot be acknowledged: standard input has ended")]
    Unacknowledged {
        /// Its number.
        number: u16,
        /// Its block.
        place: Place,
    },
    /// The drives did not come to rest at the end of the program.
    #[error("the drives did not come to rest at the end of the program")]
    Unsettled,
}

/// How often it is asked again for what a run without a clock waits for.
const ASKED_AGAIN: Duration = Duration::from_micros(500);

/// How long drives follow before the program begins: a few of their rounds.
const LEAD: Duration = Duration::from_millis(100);

/// A run before it starts.
#[derive(Debug)]
pub struct Session<'a, P> {
    /// The machine.
    pub machine: &'a Machine,
    /// The program, already checked.
    pub program: &'a ProgramFile,
    /// Axis positions at the end of the program before, m or rad: the axes bridge the gap to the start of this one.
    pub continues: Option<AxisVector>,
    /// The simulated machine, at rest at the start of the program, or where the one before ended.
    pub twin: P,
    /// The drives, standing there too.
    pub hardware: Option<Hardware>,
    /// Limits that the path is planned with, as it was checked.
    pub limits: Limits,
    /// Acknowledgement of M functions that the machine file does not define.
    pub acknowledge: Acknowledge,
    /// Scheduled override changes, besides those of the user during the run ([`Observer::new_override`]). A change is
    /// requested before the first set-point that is not earlier.
    pub overrides: &'a [OverrideAt],
    /// In step with the wall clock; with drives it always is.
    pub realtime: bool,
}

impl<P: Plant<Error = PhysicsError>> Session<'_, P> {
    /// Runs the program to its end, or until `interrupts` counts one, and brings everything to rest: on the path with the
    /// first, within the limits that it is planned with; with the second every axis at its own acceleration and jerk; the next
    /// one leaves the drives to the ramps of their devices.
    ///
    /// # Errors
    /// If the program cannot be opened, or the machine is none whose axes a path can be planned for.
    pub fn run(
        self,
        observer: &mut dyn Observer,
        interrupts: &dyn Fn() -> u32,
    ) -> Result<Ending, LimitFailure> {
        let outputs = self.hardware.is_some();
        let rules = Acknowledgement::for_run(self.machine, self.acknowledge, outputs);
        std::thread::scope(|scope| {
            let Self { machine, program, limits, .. } = self;
            let paced = self.is_paced();
            let items = Planning::for_run(scope, machine, program, limits, rules, paced)?;
            Ok(self.follow(items, observer, interrupts))
        })
    }

    /// Whether time passes by itself.
    fn is_paced(&self) -> bool {
        self.realtime || self.hardware.is_some()
    }

    fn follow(
        self,
        items: Planning<'_>,
        observer: &mut dyn Observer,
        interrupts: &dyn Fn() -> u32,
    ) -> Ending {
        let paced = self.is_paced();
        let mut run = Run::new(self.machine, items, self.twin, self.hardware, self.realtime)
            .with_overrides(self.overrides);
        if let Some(start) = self.continues {
            run.continue_from(start);
        }
        let ahead_ns = run.horizon_ns();
        // Drives that begin to follow find a plan.
        run.handle_interrupt(interrupts());
        run.plan(ahead_ns);
        // Drives that have looked around are ready for the first move when it is due.
        let lead = if run.hardware.is_some() { LEAD } else { Duration::ZERO };
        let clock = Clock::in_future(lead);
        run.begin(clock, paced);
        let round_ns = self.machine.cycle_ns.clamp(1, ROUND_NS);
        let mut calendar_ns = clock.calendar_ahead_ns();
        while run.goes_on() {
            let before_ns = std::mem::replace(&mut calendar_ns, clock.calendar_ahead_ns());
            run.record_sleep(calendar_ns.saturating_sub(before_ns));
            let now_ns = if paced { clock.now_ns() } else { run.executed_ns() + BATCH_NS };
            run.handle_interrupt(interrupts());
            run.heed_override(observer);
            run.heed_steps(observer);
            run.lose_overdue(now_ns);
            // Time that nobody has waited for shall not pass.
            let waits = !paced && run.waits_for_word();
            if !waits {
                run.plan(now_ns + ahead_ns);
            }
            run.record_lateness(now_ns);
            run.simulate(now_ns, observer);
            run.listen(observer);
            run.acknowledge(observer);
            if paced {
                // What takes longer than a round is made up for: cycles are due by the clock, not by each other.
                clock.sleep_until((now_ns.div_euclid(round_ns) + 1) * round_ns);
            } else if waits {
                std::thread::sleep(ASKED_AGAIN);
            }
        }
        run.arrive(observer);
        run.settle(clock, observer, interrupts);
        run.ending()
    }
}
