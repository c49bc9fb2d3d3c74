//! A run: the same set-points to the simulated machine and to the drives, and what both make of them.

use crate::clock::Clock;
use crate::compare::{Comparison, Measured};
use crate::hardware::{HORIZON_NS, Hardware, HardwareError};
use crate::machine::Machine;
use crate::physics::PhysicsError;
use crate::plant::{AxisFeedback, Plant};
use crate::program::{ProgramFile, ProgramItem};
use crate::setpoint::{AxisSetpoint, Transformer};
use std::collections::VecDeque;
use std::time::Duration;
use twin_kinematics::{AxisVector, KinematicsError};
use twin_motion::Place;

/// How long set-points and twin are remembered for samples of the drives that come late, in cycles.
const HISTORY: usize = 4000;

/// Set-points simulated in one go where nothing has to wait for the wall clock.
const BATCH_NS: i64 = 100_000_000;

/// How long drives may take to come to rest at the end before the session ends without them.
const LONGEST_SETTLING: Duration = Duration::from_secs(10);

/// One cycle of the simulated machine.
#[derive(Clone, Copy, Debug)]
pub struct TwinCycle<'a> {
    /// The set-point.
    pub setpoint: &'a AxisSetpoint,
    /// Where the set-point has the tool.
    pub wanted: &'a Measured,
    /// Where the simulated machine is.
    pub twin: &'a Measured,
}

/// One sample of the drives.
#[derive(Clone, Copy, Debug)]
pub struct DriveSample<'a> {
    /// When, ns since the start of the program.
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

/// Who watches a run.
pub trait Observer {
    /// A cycle of the simulated machine.
    fn twin(&mut self, cycle: &TwinCycle<'_>);
    /// A sample of the drives.
    fn drives(&mut self, sample: &DriveSample<'_>);
}

/// How a run ended.
#[derive(Debug)]
pub struct Ending {
    /// Errors of twin and drives.
    pub comparison: Comparison,
    /// Time of the last set-point that was executed, ns.
    pub executed_ns: i64,
    /// Why it did not go to the end of the program.
    pub stopped: Option<Stopped>,
}

impl Ending {
    /// The ending of a run that never began.
    pub fn nothing(machine: &Machine) -> Self {
        Self { comparison: Comparison::new(machine.axes.len()), executed_ns: 0, stopped: None }
    }
}

/// Why a run stopped before the end of the program. Twin and drives have come to rest.
#[derive(Debug, thiserror::Error)]
pub enum Stopped {
    /// The user asked for it.
    #[error("stopped by the user at {0}")]
    Interrupted(Place),
    /// The drives failed; the simulated machine braked on the path.
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
        source: PhysicsError,
    },
    /// A set-point that the machine cannot reach, although the check let the program pass: the file has changed.
    #[error("{place}: {source}; has the program file changed since it was checked?")]
    Path {
        /// The block.
        place: Place,
        /// Why.
        source: KinematicsError,
    },
    /// The program file could no longer be read.
    #[error("the program file cannot be read any further: {0}")]
    Read(std::io::Error),
    /// The drives did not come to rest at the end of the program.
    #[error("the drives did not come to rest at the end of the program")]
    Unsettled,
}

/// A run before it starts.
#[derive(Debug)]
pub struct Session<'a, P> {
    /// The machine.
    pub machine: &'a Machine,
    /// The program, already checked.
    pub program: &'a ProgramFile,
    /// The simulated machine, standing at the start of the program.
    pub twin: P,
    /// The drives, standing there too.
    pub hardware: Option<Hardware>,
    /// In step with the wall clock; with drives it always is.
    pub realtime: bool,
}

impl<P: Plant<Error = PhysicsError>> Session<'_, P> {
    /// Runs the program to its end, or until `interrupts` counts one (a second one brakes the drives where
    /// they are), and brings everything to rest.
    ///
    /// # Errors
    /// If the program cannot be opened.
    pub fn run(
        mut self,
        observer: &mut dyn Observer,
        interrupts: &dyn Fn() -> u32,
    ) -> std::io::Result<Ending> {
        let machine = self.machine;
        let mut items = self.program.open(machine)?;
        let mut transformer = Transformer::new(machine);
        let mut history = History::new(machine);
        let mut comparison = Comparison::new(machine.axes.len());
        let mut planned = VecDeque::new();
        let mut planning = true;
        let mut stopped: Option<Stopped> = None;
        let paced = self.realtime || self.hardware.is_some();
        let clock = Clock::start();
        if let Some(hardware) = &mut self.hardware {
            hardware.follow(clock);
        }
        let mut simulated_ns = 0;
        let mut place = Place::default();
        while planning || !planned.is_empty() {
            let now = if paced { clock.now_ns() } else { simulated_ns + BATCH_NS };
            let ahead = if self.hardware.is_some() { HORIZON_NS } else { 0 };
            let interrupted = interrupts();
            if stopped.is_none() && interrupted > 0 {
                stopped = Some(Stopped::Interrupted(place));
                items.request_stop();
            }
            if interrupted > 1
                && let Some(hardware) = &mut self.hardware
            {
                hardware.stop();
            }
            // Plan as far ahead as the drives need to see.
            while planning
                && planned.back().is_none_or(|last: &AxisSetpoint| last.time_ns <= now + ahead)
            {
                match items.next() {
                    Some(ProgramItem::Setpoint(tool)) => match transformer.axes(&tool) {
                        Ok(setpoint) => {
                            if let Some(hardware) = &mut self.hardware
                                && let Err(source) = hardware.command(&setpoint)
                            {
                                stopped.get_or_insert(Stopped::Drives { place, source });
                                items.request_stop();
                            }
                            planned.push_back(setpoint);
                        }
                        Err(source) => {
                            stopped = Some(Stopped::Path { place: tool.place, source });
                            planning = false;
                        }
                    },
                    // The check has refused programs with errors; warnings have been shown by it.
                    Some(ProgramItem::Diagnostic(_)) => {}
                    Some(ProgramItem::Io(error)) => {
                        stopped = Some(Stopped::Read(error));
                        planning = false;
                    }
                    None => planning = false,
                }
            }
            if !planning && let Some(hardware) = &mut self.hardware {
                hardware.finish();
            }
            // The simulated machine takes what is due.
            while let Some(setpoint) = planned.front().copied().filter(|next| next.time_ns <= now) {
                planned.pop_front();
                simulated_ns = setpoint.time_ns;
                place = setpoint.place;
                let feedback = self.twin.command(&setpoint).and_then(|()| self.twin.feedback());
                let feedback = match feedback {
                    Ok(Some(feedback)) => feedback,
                    Ok(None) => continue,
                    Err(source) => {
                        // Nothing to compare with any more: brake the drives and end.
                        stopped.get_or_insert(Stopped::Twin { place, source });
                        if let Some(hardware) = &mut self.hardware {
                            hardware.stop();
                        }
                        planning = false;
                        planned.clear();
                        break;
                    }
                };
                if let Some((wanted, twin)) = history.push(machine, &setpoint, &feedback) {
                    comparison.twin(&wanted, &twin, place);
                    observer.twin(&TwinCycle { setpoint: &setpoint, wanted: &wanted, twin: &twin });
                }
            }
            if let Some(hardware) = &mut self.hardware
                && let Err(source) =
                    compare_drives(machine, hardware, &history, &mut comparison, observer)
            {
                if stopped.is_none() {
                    stopped = Some(Stopped::Drives { place, source });
                    items.request_stop();
                }
                self.hardware = None;
            }
            if paced {
                std::thread::sleep(Duration::from_micros(500));
            }
        }
        if let Some(mut hardware) = self.hardware.take() {
            let deadline =
                clock.now_ns() + i64::try_from(LONGEST_SETTLING.as_nanos()).unwrap_or(i64::MAX);
            hardware.finish();
            while hardware.is_running() && clock.now_ns() < deadline {
                let result =
                    compare_drives(machine, &mut hardware, &history, &mut comparison, observer);
                if let Err(source) = result {
                    stopped.get_or_insert(Stopped::Drives { place, source });
                    break;
                }
                std::thread::sleep(Duration::from_millis(1));
            }
            if hardware.is_running() {
                stopped.get_or_insert(Stopped::Unsettled);
            }
            compare_drives(machine, &mut hardware, &history, &mut comparison, observer)
                .unwrap_or_default();
        }
        Ok(Ending { comparison, executed_ns: simulated_ns, stopped })
    }
}

/// Takes every sample that has arrived.
fn compare_drives(
    machine: &Machine,
    hardware: &mut Hardware,
    history: &History,
    comparison: &mut Comparison,
    observer: &mut dyn Observer,
) -> Result<(), HardwareError> {
    while let Some(feedback) = hardware.feedback()? {
        let Some(drives) = Measured::new(machine, feedback.position) else { continue };
        let Some((place, wanted, twin)) = history.at(machine, feedback.time_ns) else { continue };
        comparison.drives(&wanted, &twin, &drives, place);
        let time_ns = feedback.time_ns;
        observer.drives(&DriveSample {
            time_ns,
            place,
            wanted: &wanted,
            twin: &twin,
            drives: &drives,
        });
    }
    Ok(())
}

/// Set-points and simulated machine of the last seconds, to compare late samples with.
#[derive(Debug)]
struct History {
    cycle_ns: i64,
    first_ns: i64,
    entries: VecDeque<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    place: Place,
    wanted: AxisVector,
    twin: AxisVector,
}

impl History {
    fn new(machine: &Machine) -> Self {
        Self { cycle_ns: machine.cycle_ns, first_ns: 0, entries: VecDeque::with_capacity(HISTORY) }
    }

    fn push(
        &mut self,
        machine: &Machine,
        setpoint: &AxisSetpoint,
        feedback: &AxisFeedback,
    ) -> Option<(Measured, Measured)> {
        if self.entries.len() == HISTORY {
            self.entries.pop_front();
            self.first_ns += self.cycle_ns;
        }
        let (wanted, twin) = (setpoint.axes.position, feedback.position);
        self.entries.push_back(Entry { place: setpoint.place, wanted, twin });
        let tool = setpoint.tool.pose.position;
        Some((Measured { axes: wanted, tool }, Measured::new(machine, twin)?))
    }

    /// Set-point and twin at `time_ns`, interpolated; at the ends they rest. `None` if that is no longer known.
    #[expect(clippy::cast_precision_loss, reason = "a fraction of a cycle")]
    fn at(&self, machine: &Machine, time_ns: i64) -> Option<(Place, Measured, Measured)> {
        let since = time_ns - self.first_ns;
        if since < 0 {
            return None;
        }
        let index = usize::try_from(since / self.cycle_ns).ok()?;
        let last = self.entries.back()?;
        let from = self.entries.get(index).unwrap_or(last);
        let to = self.entries.get(index + 1).unwrap_or(last);
        let fraction = (since % self.cycle_ns) as f64 / self.cycle_ns as f64;
        let between = |from: &AxisVector, to: &AxisVector| {
            let values = from.iter().zip(to.iter()).map(|(from, to)| from + (to - from) * fraction);
            Measured::new(machine, AxisVector::from_values(values))
        };
        Some((from.place, between(&from.wanted, &to.wanted)?, between(&from.twin, &to.twin)?))
    }
}
