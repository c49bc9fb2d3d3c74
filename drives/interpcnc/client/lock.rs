//! Boards that are locked.

use super::{Clock, Command, DriveError, InterpCnc};
use crate::Exception;

impl InterpCnc {
    /// Clears "Board Locked" (command 66) and checks that it is cleared. Where the board keeps the segments that waited
    /// when it lost ENABLE ([`crate::Assumptions::enable_loss_keeps_segments`]), they are thrown away first
    /// (command 43), so that nothing moves by what has been forgotten.
    ///
    /// # Errors
    /// If the ENABLE input is open, the board stays locked, or no proper answer comes.
    pub async fn unlock(&mut self, clock: &dyn Clock) -> Result<(), DriveError> {
        let command = Command::Reset { unlock: true, homing_error: false, probe_error: false };
        if self.options().assumptions.enable_loss_keeps_segments {
            let (state, _) = self.state(clock).await?;
            if state.status.locked() {
                self.send(&Command::Stop, clock).await?;
            }
        }
        self.send(&command, clock).await?;
        // The board answers normally even where it stays locked.
        let (state, _) = self.state(clock).await?;
        self.check_obeys(&state, command.action())
    }

    /// What an error of a request that locked boards refuse means, where they do so with an exception: with that exception,
    /// that the board is locked, if it says so. Others may refuse with the same number: a full buffer, a broken EEPROM.
    pub(super) async fn if_locked(&mut self, error: DriveError, clock: &dyn Clock) -> DriveError {
        let Some(code) = Exception::code_of(&error) else { return error };
        if self.options().assumptions.locked_exception != Some(code) {
            return error;
        }
        let action = error.at().action;
        match self.state(clock).await {
            Ok((state, _)) => self.check_obeys(&state, action).err().unwrap_or(error),
            // What the board has refused says more than that it does not answer any more.
            Err(_) => error,
        }
    }
}
