//! Touch probe: latches a position at a trigger (`MC_TouchProbe`, manual 5.3).
//!
//! The manual does not define from when on an input counts. An input of the program counts, as a level, in every cycle
//! in which a block waits for it, including that of the rising edge of Execute: an input that is already TRUE latches
//! at once. The drive gets the latch request at the end of that cycle, so its own trigger counts from the next cycle
//! on.

use crate::latch::{Latch, Outcome, Outputs};
use crate::{Axis, Capture, SmcError, fmod};

/// An input that latches (`TRIGGER_REF`).
#[doc(alias = "TRIGGER_REF")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trigger {
    /// `bFastLatching`: the drive latches; else the block does, once a cycle.
    pub fast_latching: bool,
    /// `iTriggerNumber`: which of the drive's triggers; for fast latching.
    pub number: i64,
    /// `bInput`: TRUE latches; without fast latching (the manual's table has it the wrong way round).
    pub input: bool,
    /// Block that waits for it (`bActive`), 0 for none, and their number so far.
    owner: u64,
    owners: u64,
}

impl Trigger {
    /// A trigger of the drive.
    #[must_use]
    pub fn of_drive(number: i64) -> Self {
        Self { fast_latching: true, number, input: false, owner: 0, owners: 0 }
    }

    /// An input of the program.
    #[must_use]
    pub fn of_program() -> Self {
        Self { fast_latching: false, number: -1, input: false, owner: 0, owners: 0 }
    }

    /// True if a block waits for it (`bActive`).
    #[must_use]
    pub fn is_active(&self) -> bool {
        self.owner != 0
    }

    /// Gives it to a block that waits from now on, and says who that is.
    fn claim(&mut self) -> u64 {
        self.owners = self.owners.wrapping_add(1).max(1);
        self.owner = self.owners;
        self.owner
    }
}

/// Latches the position at a trigger (`MC_TouchProbe`, manual 5.3), whatever the axis is doing.
#[doc(alias = "MC_TouchProbe")]
#[derive(Clone, Copy, Debug, Default)]
pub struct TouchProbe {
    /// `WindowOnly`, `FirstPosition`, `LastPosition`: positions, u, between which it counts; on a rotary axis it may
    /// reach over the end of the period; a whole period or more is everywhere.
    pub window: Option<[f64; 2]>,
    /// The window as taken over, while it waits.
    waiting: Option<Waiting>,
    recorded: f64,
    latch: Latch,
}

/// A latch that is waited for, with its window.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    window: Option<[f64; 2]>,
    /// Who it is for its trigger.
    owner: u64,
}

/// Outputs of [`TouchProbe`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probed {
    /// `Done`, `CommandAborted`, `Error`.
    pub outputs: Outputs,
    /// `RecordedPosition`, u; counts when done.
    pub recorded_position: f64,
}

impl TouchProbe {
    /// A block with or without a window, not begun.
    #[must_use]
    pub fn new(window: Option<[f64; 2]>) -> Self {
        Self { window, ..Self::default() }
    }

    /// Calls it, for a cycle, with Execute, its axis and its trigger.
    ///
    /// 400 if the trigger (or the drive's capture) is in use, 401 if the drive has no windows, 402 if it does not answer.
    pub fn call(&mut self, execute: bool, axis: &mut Axis, trigger: &mut Trigger) -> Probed {
        let begins = self.latch.rises(execute);
        if begins {
            // A new edge releases the block's own trigger first.
            if self.waiting.take().is_some_and(|waiting| waiting.owner == trigger.owner) {
                free(axis, trigger);
            }
            match self.begin(axis, trigger) {
                Ok(owner) => self.waiting = Some(Waiting { window: self.window, owner }),
                Err(error) => self.latch.end(Outcome::Failed(error)),
            }
        }
        // A capture that the drive reports in the cycle of the edge is older than the request.
        if let Some(waiting) = self.waiting.filter(|_| !(begins && trigger.fast_latching)) {
            self.wait(waiting, axis, trigger);
        }
        let outputs = self.latch.outputs(self.waiting.is_some());
        Probed { outputs, recorded_position: self.recorded }
    }

    fn begin(&self, axis: &mut Axis, trigger: &mut Trigger) -> Result<u64, SmcError> {
        if trigger.is_active() || (trigger.fast_latching && axis.capture.is_some()) {
            return Err(SmcError::TpTriggeroccupied);
        }
        if trigger.fast_latching {
            if self.window.is_some() && !axis.has_capture_window {
                return Err(SmcError::TpCouldntSetWindow);
            }
            if !axis.values.communication {
                return Err(SmcError::TpCommError);
            }
            let window = self.window.map(|window| window.map(|position| axis.to_drive(position)));
            axis.capture = Some(Capture { trigger: trigger.number, window });
        }
        Ok(trigger.claim())
    }

    fn wait(&mut self, waiting: Waiting, axis: &mut Axis, trigger: &mut Trigger) {
        let Waiting { window, owner } = waiting;
        // It was released, and another block may wait for it since.
        if trigger.owner != owner {
            self.waiting = None;
            return self.latch.end(Outcome::Aborted);
        }
        let here = axis.act_position();
        let latched = if trigger.fast_latching {
            axis.drive.captured.map(|position| axis.in_program(position))
        } else {
            let inside = window.is_none_or(|window| is_inside(window, here, axis));
            (trigger.input && inside).then_some(here)
        };
        let outcome = if let Some(position) = latched {
            self.recorded = position;
            Outcome::Done
        } else if trigger.fast_latching && !axis.values.communication {
            Outcome::Failed(SmcError::TpCommError)
        } else {
            return;
        };
        self.waiting = None;
        free(axis, trigger);
        self.latch.end(outcome);
    }
}

/// Releases the trigger.
fn free(axis: &mut Axis, trigger: &mut Trigger) {
    trigger.owner = 0;
    if trigger.fast_latching {
        axis.capture = None;
    }
}

fn is_inside([first, last]: [f64; 2], position: f64, axis: &Axis) -> bool {
    match axis.period() {
        // A whole turn and more is everywhere.
        Some(period) => {
            last - first >= period || fmod(position - first, period) <= fmod(last - first, period)
        }
        None => (first..=last).contains(&position),
    }
}

/// Releases a trigger (`MC_AbortTrigger`, manual 5.3): the block that waits for it shows `CommandAborted`.
#[doc(alias = "MC_AbortTrigger")]
#[derive(Clone, Copy, Debug, Default)]
pub struct AbortTrigger {
    latch: Latch,
}

impl AbortTrigger {
    /// Calls it, for a cycle, with Execute, the axis and the trigger; 410 if nobody waits for it.
    pub fn call(&mut self, execute: bool, axis: &mut Axis, trigger: &mut Trigger) -> Outputs {
        if self.latch.rises(execute) {
            let outcome = if trigger.is_active() {
                free(axis, trigger);
                Outcome::Done
            } else {
                Outcome::Failed(SmcError::AtTriggernotoccupied)
            };
            self.latch.end(outcome);
        }
        self.latch.outputs(false)
    }
}
