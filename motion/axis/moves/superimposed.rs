//! Superimposed motion on top of another one (`MC_MoveSuperImposed`).

use super::Planned;
use crate::latch::{Latch, Outcome, Outputs};
use crate::ownership::{Refusal, Start};
use crate::{Axis, AxisState, SmcError, Stage};
use twin_profile::State;

/// A distance on top of the motion there is (`MC_MoveSuperImposed`, manual 5.3).
///
/// Velocity, acceleration and deceleration count relative to the motion below, which goes on and is not aborted. When
/// another block takes the axis, both are aborted. It has to be called after the block below. Without
/// a motion below it moves the axis alone. [`SuperImposed`] is the block with these inputs.
#[doc(alias = "MC_MoveSuperImposed")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveSuperImposed {
    /// Way to add, u, with its sign.
    pub distance: f64,
    /// Largest velocity on top, u/s; it need not be reached.
    pub velocity_diff: f64,
    /// Acceleration, u/s².
    pub acceleration: f64,
    /// Deceleration, u/s².
    pub deceleration: f64,
}

/// [`MoveSuperImposed`] as a block, like [`Block`](crate::Block) for motions that take the axis.
#[derive(Clone, Debug)]
pub struct SuperImposed {
    /// The inputs; taken over at the next rising edge.
    pub inputs: MoveSuperImposed,
    /// The running motion, its owner number, and `wDriveId` of the axis.
    taken: Option<(Planned, i64, i64)>,
    latch: Latch,
}

impl SuperImposed {
    /// A block with these inputs, not begun.
    #[must_use]
    pub fn new(inputs: MoveSuperImposed) -> Self {
        Self { inputs, taken: None, latch: Latch::default() }
    }

    /// Its owner number while it moves the axis on top of another block, or alone.
    #[must_use]
    pub fn owner(&self) -> Option<i64> {
        self.taken.as_ref().map(|(_, owner, _)| *owner)
    }

    /// Duration of its running motion from the beginning, s.
    #[must_use]
    pub fn duration(&self) -> Option<f64> {
        self.taken.as_ref().map(|(planned, ..)| planned.duration())
    }

    /// Calls it, for a cycle, with Execute and its axis.
    pub fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
        if self.latch.rises(execute) {
            let own = self.taken.take().is_some_and(|(_, owner, drive)| {
                axis.overlay_owner == owner && axis.values.drive_id == drive
            });
            match self.begin(axis) {
                Ok(planned) => {
                    let owner = axis.claim_overlay(planned.target());
                    self.taken = Some((planned, owner, axis.values.drive_id));
                }
                Err(refusal) => {
                    // The edge has ended its motion (manual 5.2 b), which had a velocity.
                    if let (true, Refusal::Error(error)) = (own, refusal) {
                        axis.fail_with(error.number());
                    }
                    self.latch.end(refusal.into());
                }
            }
        }
        self.advance(axis);
        self.latch.outputs(self.taken.is_some())
    }

    fn begin(&self, axis: &Axis) -> Result<Planned, Refusal> {
        axis.admits(AxisState::DiscreteMotion)?;
        let MoveSuperImposed { distance, velocity_diff, acceleration, deceleration } = self.inputs;
        let limits = axis.limits(velocity_diff, acceleration, deceleration);
        let state = axis.overlay;
        let lead = if axis.overlay_moved { 0.0 } else { axis.cycle() };
        let start = Start { state, lead, aim: None };
        Planned::to(state.position + distance, limits, start, axis)
            .map_err(|_invalid| SmcError::MsiInvalidVelaccValues.into())
    }

    fn advance(&mut self, axis: &mut Axis) {
        let Some((planned, owner, drive)) = &mut self.taken else { return };
        let (owner, drive) = (*owner, *drive);
        if drive != axis.values.drive_id {
            self.taken = None;
            return self.latch.end(Outcome::Failed(SmcError::AxisRefChangedDuringOperation));
        }
        if axis.overlay_owner != owner {
            self.taken = None;
            let outcome = axis.loss().map_or(Outcome::Aborted, Outcome::Failed);
            return self.latch.end(outcome);
        }
        let progress = planned.step(axis, Stage::Done);
        axis.overlay_to(progress.setpoint);
        if progress.stage == Stage::Done {
            self.taken = None;
            axis.release_overlay();
            self.latch.end(Outcome::Done);
        }
    }
}

impl Axis {
    /// Gives what is on top of the motion to a new owner, who takes it to `aim` u.
    fn claim_overlay(&mut self, aim: f64) -> i64 {
        self.values.owners += 1;
        self.overlay_owner = self.values.owners;
        self.overlay_aim = aim;
        if self.values.owner == 0 {
            self.enter(AxisState::DiscreteMotion);
        }
        self.overlay_owner
    }

    fn overlay_to(&mut self, overlay: State) {
        #[cfg(test)]
        {
            self.commands[1] += 1;
        }
        self.overlay = overlay;
        self.overlay_moved = true;
        self.show_set_values();
    }

    fn release_overlay(&mut self) {
        self.overlay_owner = 0;
        if self.values.owner == 0 {
            self.values.moved_in_this_cycle = true;
            self.rest();
        }
    }
}
