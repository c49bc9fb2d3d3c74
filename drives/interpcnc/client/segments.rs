//! Interpolated moves (command 6), few of them in the board at a time.
//!
//! How full the board's buffer is cannot be read, only that it is empty (B5). The driver counts what it has sent: once
//! the most are outstanding it waits until the buffer is empty, when only the one under way is left.

use std::time::Duration;

use super::{InterpCnc, motion::targets_mask};
use crate::{AxisValues, Command, protocol::registers::Status};
use twin_drives::{Axes, Clock, DriveError, Stamp};

impl InterpCnc {
    /// Queues an interpolated move: all axes with a target arrive together, the one with the longest way at
    /// `speed_hz`. Waits for room, as no more than [`crate::InterpCncOptions::most_segments`] are to be in
    /// the board.
    ///
    /// # Errors
    /// If one of the axes is in an independent move, the board refuses it or is locked, there is no room in time, or
    /// no proper answer comes; then whether the board has the segment is unknown.
    pub async fn queue_segment(
        &mut self,
        speed_hz: u32,
        targets: &AxisValues,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<Stamp, DriveError> {
        let command = Command::Interpolated { speed_hz, targets: *targets };
        let (action, axes) = (command.action(), targets_mask(targets));
        let most = self.options().most_segments;
        let mut outstanding = self.outstanding;
        self.wait(action, patience, clock, |board, state| {
            if let Err(locked) = board.check_obeys(state, action) {
                return Some(Err(locked));
            }
            let independent = state.status.independent().intersection(axes);
            if !independent.is_empty() {
                let at = board.at(action);
                return Some(Err(DriveError::Moving {
                    at,
                    axes: Axes::Letters(independent.bits()),
                }));
            }
            if state.status.segments_finished() {
                outstanding = 0;
            } else if state.status.has(Status::BUFFER_EMPTY) {
                outstanding = outstanding.min(1);
            }
            (outstanding < most).then_some(Ok(()))
        })
        .await?;
        // Counted before: a segment whose answer is lost may be in the board.
        self.outstanding = outstanding.saturating_add(1);
        self.send(&command, clock).await
    }

    /// Segments that may be in the board, as far as the driver knows.
    pub fn outstanding_segments(&self) -> u16 {
        self.outstanding
    }

    /// Waits until all interpolated moves are finished: the buffer is empty (B5) and no axis is in one (B0 to B4).
    ///
    /// # Errors
    /// If the board is locked, a limit switch is active, it does not end in time, or no proper answer comes.
    pub async fn finish_segments(
        &mut self,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let action = Command::Interpolated { speed_hz: 0, targets: [None; 5] }.action();
        self.wait(action, patience, clock, |board, state| {
            if let Err(locked) = board.check_obeys(state, action) {
                return Some(Err(locked));
            }
            if !state.status.segments_finished() {
                return None;
            }
            let switches = state.status.on_limit_switch();
            Some(if switches.is_empty() {
                Ok(())
            } else {
                Err(DriveError::LimitSwitch {
                    at: board.at(action),
                    axes: Axes::Letters(switches.bits()),
                })
            })
        })
        .await?;
        self.outstanding = 0;
        Ok(())
    }
}
