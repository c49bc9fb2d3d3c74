//! Homing and probing, from the command to its result.

use std::time::Duration;

use super::{BoardState, InterpCnc, motion::targets_mask};
use crate::{AxisValues, Command, protocol::registers::Status};
use twin_drives::{Axes, Clock, DriveError};

impl InterpCnc {
    /// Starts homing, which goes on after the answer.
    pub(crate) async fn begin(
        &mut self,
        command: &Command,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        self.send_motion(command, clock).await.map(|_| ())
    }

    /// Homes axes by the board's parameters (command 71), each with its longest way, and waits for the end.
    ///
    /// # Errors
    /// If homing fails, the board refuses it or is locked, it does not end in time, or no proper answer comes.
    pub async fn home_machine(
        &mut self,
        max_strokes: &AxisValues,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<BoardState, DriveError> {
        let command = Command::HomeMachine { max_strokes: *max_strokes };
        self.send_motion(&command, clock).await?;
        let (action, axes) = (command.action(), Axes::Letters(targets_mask(max_strokes).bits()));
        self.wait(action, patience, clock, |board, state| {
            if let Err(locked) = board.check_obeys(state, action) {
                return Some(Err(locked));
            }
            if state.status.has(Status::HOMING_IN_PROGRESS) {
                return None;
            }
            Some(if state.status.has(Status::HOMING_ERROR) {
                Err(DriveError::HomingFailed { at: board.at(action), axes })
            } else {
                Ok(*state)
            })
        })
        .await
    }

    /// Clears "Homing Error" (command 66 b1) and "Probe Error" (b2) without unlocking.
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn clear_errors(
        &mut self,
        homing_error: bool,
        probe_error: bool,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let command = Command::Reset { unlock: false, homing_error, probe_error };
        self.send(&command, clock).await.map(|_| ())
    }
}
