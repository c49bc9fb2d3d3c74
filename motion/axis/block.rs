//! Function block framework: the common behaviour of all blocks that move an axis (PLCopen; manual 5.2).

use super::latch::{Latch, Outcome, Outputs};
use super::ownership::{Refusal, Start};
use super::state::AxisState;
use super::{Axis, Master, SmcError};
use std::fmt;
use twin_profile::State;

/// Motion of a block: the inputs that it takes over at a rising edge of Execute, and their effect on its axis.
///
/// [`Block`] gives it the rules of all blocks.
pub trait Motion {
    /// Further input of every cycle: nothing, or the [`Master`](super::Master).
    type With: Copy;
    /// State of the motion between the edge and the end.
    type Run: fmt::Debug + Clone;
    /// State of the axis meanwhile.
    const STATE: AxisState;
    /// True if it keeps the axis after its end until Execute falls (`MC_Stop`).
    const LOCKS: bool = false;
    /// True if each set-point goes on from the one before, not along a plan: if another block ends in the cycle in which
    /// this one begins, that end is this cycle's set-point.
    const GOES_ON: bool = false;
    /// True if the inputs are set-points that count every cycle, not only at the rising edge (`SMC_Follow…`).
    const LIVE: bool = false;

    /// Checks the inputs and plans.
    ///
    /// # Errors
    ///
    /// The manual's error for invalid inputs. Motion of another block goes on then; motion of the block itself has ended
    /// with the edge (manual 5.2 b): the axis goes into errorstop with the error.
    fn plan(&self, start: Start, axis: &Axis, with: Self::With) -> Result<Self::Run, SmcError>;

    /// End position of the motion, if there is one, in the drive's coordinates (`fAimPosition`).
    fn aim(_run: &Self::Run) -> Option<f64> {
        None
    }

    /// Duration of the motion from its beginning, s, if it is known then; of an endless motion the time until it
    /// reaches its target velocity.
    fn duration(_run: &Self::Run) -> Option<f64> {
        None
    }

    /// Checks that the motion may begin; by default as [`Axis::admits`].
    ///
    /// # Errors
    ///
    /// A [`Refusal`].
    fn admitted(&self, axis: &Axis) -> Result<(), Refusal> {
        axis.admits(Self::STATE)
    }

    /// Error that the block shows when the axis goes into errorstop under it with this error.
    fn lost(_axis: &Axis, error: SmcError) -> SmcError {
        error
    }

    /// This cycle's set-point.
    ///
    /// # Errors
    ///
    /// An error that ends the motion; the axis goes into errorstop with it.
    fn step(
        &self,
        run: &mut Self::Run,
        axis: &mut Axis,
        with: Self::With,
    ) -> Result<Progress, SmcError>;
}

/// One cycle of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The set-point, in the drive's coordinates, unwound.
    pub setpoint: State,
    /// Progress of the motion.
    pub stage: Stage,
}

/// Progress of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// On the way.
    Busy,
    /// What was asked for holds now (`InVelocity` and the like); the block goes on.
    Reached,
    /// At the end; the axis is given back.
    Done,
}

/// A block that moves an axis.
///
/// A rising edge of Execute takes over the inputs and begins. Until it is done the block has to be called every cycle,
/// with any Execute. `done`, `command_aborted` and `error` stay while Execute is TRUE; if it fell earlier, they
/// show for one cycle. A new edge begins anew from the present motion; with invalid inputs the axis brakes in errorstop
/// with the error of the block.
#[derive(Clone, Debug)]
pub struct Block<M: Motion> {
    /// The inputs; taken over at the next rising edge.
    pub inputs: M,
    taken: Option<Taken<M>>,
    latch: Latch,
}

/// The inputs as taken over, what goes on, and who moves the axis.
#[derive(Clone, Debug)]
struct Taken<M: Motion> {
    inputs: M,
    run: M::Run,
    owner: i64,
    /// `wDriveId` of the axis.
    drive: i64,
    /// This cycle's set-point is there already ([`Motion::GOES_ON`]).
    waits: bool,
}

impl<M: Motion + Clone> Block<M> {
    /// A block with these inputs, not begun.
    pub fn new(inputs: M) -> Self {
        Self { inputs, taken: None, latch: Latch::default() }
    }

    /// Its owner number while it moves the axis (`iOwner`).
    #[must_use]
    pub fn owner(&self) -> Option<i64> {
        self.taken.as_ref().map(|taken| taken.owner)
    }

    /// `Active`: the block controls its axis (manual 5.4). Blocks do not wait for each other here, so this equals `busy`; a
    /// gear that waits for its master already has the slave.
    #[doc(alias = "Active")]
    #[must_use]
    pub fn is_active(&self) -> bool {
        self.taken.is_some()
    }

    /// State of its running motion.
    #[must_use]
    pub fn running(&self) -> Option<&M::Run> {
        self.taken.as_ref().map(|taken| &taken.run)
    }

    /// Duration of its running motion from the beginning, s, if it is known ([`Motion::duration`]).
    #[must_use]
    pub fn duration(&self) -> Option<f64> {
        M::duration(self.running()?)
    }

    /// Calls it, for a cycle, with Execute, its axis and what else it needs.
    pub fn call_with(&mut self, execute: bool, axis: &mut Axis, with: M::With) -> Outputs {
        if self.latch.rises(execute) {
            self.begin(axis, with);
        }
        self.advance(axis, with);
        if M::LOCKS
            && !execute
            && self.latch.is_done()
            && let Some(taken) = self.taken.take()
        {
            axis.release(taken.owner);
        }
        self.latch.outputs(self.taken.is_some())
    }

    fn begin(&mut self, axis: &mut Axis, with: M::With) {
        let same = |taken: Taken<M>| taken.drive == axis.values.drive_id && axis.owns(taken.owner);
        let own = self.taken.take().is_some_and(same);
        let start = axis.start();
        let admitted = if own { Ok(()) } else { self.inputs.admitted(axis) };
        let planned = admitted.and_then(|()| Ok(self.inputs.plan(start, axis, with)?));
        match planned {
            Ok(run) => {
                let owner = axis.claim(M::STATE, start);
                axis.aim = M::aim(&run);
                self.taken = Some(Taken {
                    inputs: self.inputs.clone(),
                    run,
                    owner,
                    drive: axis.values.drive_id,
                    waits: M::GOES_ON && start.lead == 0.0,
                });
            }
            Err(refusal) => {
                if let (true, Refusal::Error(error)) = (own, refusal) {
                    axis.fail_with(error.number());
                }
                self.latch.end(refusal.into());
            }
        }
    }

    fn advance(&mut self, axis: &mut Axis, with: M::With) {
        let Some(Taken { inputs, run, owner, drive, waits }) = &mut self.taken else { return };
        let (owner, drive) = (*owner, *drive);
        let latched = if M::LIVE { &self.inputs } else { &*inputs };
        if drive != axis.values.drive_id {
            self.taken = None;
            return self.latch.end(Outcome::Failed(SmcError::AxisRefChangedDuringOperation));
        }
        if !axis.owns(owner) {
            self.taken = None;
            // A stop that is done cannot be aborted.
            if !(M::LOCKS && self.latch.is_done()) {
                let failed = |error| Outcome::Failed(M::lost(axis, error));
                self.latch.end(axis.loss().map_or(Outcome::Aborted, failed));
            }
            return;
        }
        if std::mem::take(waits) {
            axis.drive_to(axis.base);
            return self.latch.reopen();
        }
        match latched.step(run, axis, with) {
            Ok(progress) => {
                axis.drive_to(progress.setpoint);
                match progress.stage {
                    Stage::Busy => self.latch.reopen(),
                    Stage::Reached => self.latch.reach(),
                    Stage::Done if M::LOCKS => self.latch.reach(),
                    Stage::Done => {
                        self.taken = None;
                        axis.release(owner);
                        self.latch.end(Outcome::Done);
                    }
                }
            }
            Err(error) => {
                self.taken = None;
                axis.fail_with(error.number());
                self.latch.end(Outcome::Failed(error));
            }
        }
    }
}

impl<M: Motion<With = ()> + Clone> Block<M> {
    /// Calls it, for a cycle, with Execute and its axis.
    pub fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
        self.call_with(execute, axis, ())
    }
}

impl<M: Motion<With = Master> + Clone> Block<M> {
    /// Calls it, for a cycle, with Execute, the axis it follows and the axis it moves.
    pub fn follow(&mut self, execute: bool, master: &Axis, slave: &mut Axis) -> Outputs {
        self.call_with(execute, slave, Master::of(master))
    }
}
