//! Ownership of an axis: one block at a time moves it (`iOwner`, `iNoOwner`; manual 5.2).

use super::config::Movement;
use super::state::AxisState;
use super::{Axis, SmcError};
use twin_profile::State;

/// Reason why a block does not get the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// `MC_Stop` or homing holds the axis: the block shows `CommandAborted`.
    Locked,
    /// The block shows this error.
    Error(SmcError),
}

impl From<SmcError> for Refusal {
    fn from(error: SmcError) -> Self {
        Self::Error(error)
    }
}

/// Start of a block's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Motion of the axis there, in the drive's coordinates; of a rotary axis within one period of the program's.
    pub state: State,
    /// Time of the beginning before this cycle's set-point, s: one cycle, or none where another block has come to its
    /// end in this cycle.
    pub lead: f64,
    /// Target of the discrete motion that is being replaced, in the same coordinates.
    pub aim: Option<f64>,
}

impl Axis {
    /// Start of a block that takes over now.
    ///
    /// It takes over from the set-point of the last cycle and replaces this cycle's. If the block before has ended in this
    /// cycle, it goes on from that end.
    pub(crate) fn start(&self) -> Start {
        let ended =
            self.values.moved_in_this_cycle && self.values.owner == 0 && self.overlay_owner == 0;
        let (state, lead) =
            if ended { (self.total(), 0.0) } else { (self.saved, self.values.task_cycle) };
        let position = match self.movement {
            Movement::Linear => state.position,
            Movement::Rotary { .. } => self.to_drive(self.in_program(state.position)),
        };
        let below = if ended { self.base } else { self.saved_base };
        let aim = self.pending(state.position - below.position);
        let aim = aim.map(|aim| aim - state.position + position);
        Start { state: State { position, ..state }, lead, aim }
    }

    /// Checks that a block that moves the axis in `state` may begin.
    ///
    /// # Errors
    ///
    /// [`Refusal::Error`] with the axis's error in errorstop and with 20 without power or with the brake on;
    /// [`Refusal::Locked`] where the state does not lead there.
    pub fn admits(&self, state: AxisState) -> Result<(), Refusal> {
        match self.state {
            AxisState::ErrorStop => Err(self.error_of_blocks().into()),
            _ if !self.is_powered() => Err(SmcError::RegulatorOrStartNotSet.into()),
            current if current.leads_to(state) && current != AxisState::Stopping => Ok(()),
            _ => Err(Refusal::Locked),
        }
    }

    /// End position of the present discrete motion, with the superimposed distance, u; of a superimposed motion alone
    /// its own target.
    pub(super) fn pending(&self, on_top: f64) -> Option<f64> {
        if self.values.owner == 0 && self.overlay_owner != 0 {
            return Some(self.base.position + self.overlay_aim);
        }
        self.aim.map(|aim| aim + on_top)
    }

    /// Gives the axis to a new owner, in `state`, and returns its number.
    pub(crate) fn claim(&mut self, state: AxisState, start: Start) -> i64 {
        // A target counts from the begin of the motion, also for a later owner in this cycle.
        let from = if start.lead == 0.0 { self.total() } else { self.saved };
        let turned = start.state.position - from.position;
        if turned != 0.0 {
            self.saved.position += turned;
        }
        self.values.owners += 1;
        self.values.owner = self.values.owners;
        self.overlay = State::default();
        self.overlay_owner = 0;
        self.base = start.state;
        self.saved_base = self.saved;
        self.aim = None;
        self.stop_homing();
        self.enter(state);
        self.values.owner
    }

    /// Releases the axis after the last set-point; it is at standstill unless a superimposed motion runs.
    pub(crate) fn release(&mut self, owner: i64) {
        if self.owns(owner) {
            self.values.owner = 0;
            self.stop_homing();
            if self.overlay_owner == 0 {
                self.rest();
            } else {
                self.enter(AxisState::DiscreteMotion);
            }
        }
    }

    /// No block moves the axis any more: the overlay becomes part of its position.
    pub(super) fn rest(&mut self) {
        self.base = self.total();
        self.overlay = State::default();
        self.aim = None;
        self.enter(AxisState::Standstill);
    }

    /// True if `owner` has the axis.
    pub(crate) fn owns(&self, owner: i64) -> bool {
        self.values.owner == owner
    }

    /// Ends the drive's own homing.
    pub(crate) fn stop_homing(&mut self) {
        self.home = None;
    }

    /// The set-point of the owner for this cycle, in the drive's coordinates, unwound.
    pub(crate) fn drive_to(&mut self, base: State) {
        #[cfg(test)]
        {
            self.commands[0] += 1;
        }
        self.base = base;
        self.values.moved_in_this_cycle = true;
        self.show_set_values();
    }

    /// Error of a block that has lost the axis: the axis's error, 20 after loss of power, none if another block took
    /// it.
    pub(crate) fn loss(&self) -> Option<SmcError> {
        match self.state {
            AxisState::ErrorStop => Some(self.error_of_blocks()),
            AxisState::PowerOff => Some(SmcError::RegulatorOrStartNotSet),
            _ => None,
        }
    }

    /// The axis's error as blocks show it; 1 for one of the drive's own numbers.
    fn error_of_blocks(&self) -> SmcError {
        let number = if self.drive.error.is_some() { None } else { self.error_id() };
        let known = number.and_then(|number| u16::try_from(number).ok());
        known.and_then(SmcError::from_number).unwrap_or(SmcError::DiGeneralCommunicationError)
    }
}
