//! Outputs of a block with Execute, and the time for which they stay (manual 5.2).

use super::SmcError;
use super::ownership::Refusal;

/// Outputs of a block. At most one of `done`, `command_aborted` and `error` is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outputs {
    /// `Done`; of endless motion `InVelocity`, `InEndVelocity`, `InGear` or `InSync`.
    pub done: bool,
    /// `Busy`: the block is not finished and has to be called.
    pub busy: bool,
    /// `CommandAborted`: another block has taken the axis, or `MC_Stop` or homing holds it.
    pub command_aborted: bool,
    /// `Error` and `ErrorID`.
    pub error: Option<SmcError>,
}

/// Outcome of a block: done (or target reached), aborted, or failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Done,
    Aborted,
    Failed(SmcError),
}

impl From<Refusal> for Outcome {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Locked => Self::Aborted,
            Refusal::Error(error) => Self::Failed(error),
        }
    }
}

/// Latch of Execute and the outputs: they stay while Execute is TRUE; if it fell earlier, they show for one cycle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Latch {
    execute: bool,
    outcome: Option<Outcome>,
    shown: bool,
}

impl Latch {
    /// Takes in Execute; true at a rising edge, which clears the outputs.
    pub(crate) fn rises(&mut self, execute: bool) -> bool {
        let rises = execute && !self.execute;
        self.execute = execute;
        if rises {
            self.outcome = None;
            self.shown = false;
        }
        rises
    }

    /// The block ends.
    pub(crate) fn end(&mut self, outcome: Outcome) {
        self.outcome = Some(outcome);
        self.shown = false;
    }

    /// The target is reached, and the block goes on.
    pub(crate) fn reach(&mut self) {
        if !self.is_done() {
            self.outcome = Some(Outcome::Done);
            self.shown = false;
        }
    }

    /// The target is not reached (any more).
    pub(crate) fn reopen(&mut self) {
        self.outcome = None;
    }

    pub(crate) fn is_done(self) -> bool {
        self.outcome == Some(Outcome::Done)
    }

    /// Outputs of this cycle.
    pub(crate) fn outputs(&mut self, busy: bool) -> Outputs {
        let showing = self.outcome.filter(|_| self.execute || !self.shown);
        self.shown |= showing.is_some();
        Outputs {
            done: showing == Some(Outcome::Done),
            busy,
            command_aborted: showing == Some(Outcome::Aborted),
            error: match showing {
                Some(Outcome::Failed(error)) => Some(error),
                _ => None,
            },
        }
    }
}
