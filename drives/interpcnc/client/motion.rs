//! Moves and stops, from the command to its result.

use std::time::Duration;

use tokio::time::sleep;

use super::{BoardState, InterpCnc};
use crate::{
    AxisValues, Command, MoveProfile,
    protocol::registers::{AXES, AxisMask, BoardAxis},
};
use twin_drives::{Axes, Clock, DriveError, Stamp};

/// Samples in a row in which an axis that does not move is at the same wrong position before it counts as
/// stopped there: firmware before 5.31 shows no motion at the instant at which a move reverses.
const STANDING_SAMPLES: u32 = 3;

impl InterpCnc {
    /// Sends a command that moves axes and makes sure that the board obeys: a locked board accepts it and does nothing. One
    /// that does so for an axis in an interpolated move, too, is asked before.
    pub(super) async fn send_motion(
        &mut self,
        command: &Command,
        clock: &dyn Clock,
    ) -> Result<Stamp, DriveError> {
        if !self.options().assumptions.busy_axis_refuses {
            let (state, _) = self.state(clock).await?;
            let busy = state.status.interpolating().intersection(command.moved_axes());
            if !busy.is_empty() {
                let axes = Axes::Letters(busy.bits());
                return Err(DriveError::Moving { at: self.at(command.action()), axes });
            }
        }
        let stamp = self.send(command, clock).await?;
        let (state, _) = self.state(clock).await?;
        self.check_obeys(&state, command.action())?;
        Ok(stamp)
    }

    /// Moves one axis (command 80) and waits until it is at rest on its target.
    ///
    /// # Errors
    /// If the board refuses it, is locked, runs onto a limit switch or stops elsewhere; if the axis does not arrive in
    /// time or no proper answer comes. An axis that has not arrived may still move.
    pub async fn move_axis(
        &mut self,
        axis: BoardAxis,
        profile: &MoveProfile,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let command = Command::Move { axis, profile: *profile };
        self.send_motion(&command, clock).await?;
        let mut targets = [None; AXES];
        if let Some(target) = targets.get_mut(axis.index()) {
            *target = Some(profile.target);
        }
        self.wait_for_targets(&command, &targets, patience, clock).await
    }

    /// Waits until the axes that a command moves stand on their targets: neither the bits nor the counters alone say
    /// so.
    ///
    /// # Errors
    /// As [`Self::move_axis`].
    pub async fn wait_for_targets(
        &mut self,
        command: &Command,
        targets: &AxisValues,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let action = command.action();
        let mut standing = (0, [0; AXES]);
        self.wait(action, patience, clock, |board, state| {
            if let Err(locked) = board.check_obeys(state, action) {
                return Some(Err(locked));
            }
            let off = off_target(state, targets);
            let wanted = targets_mask(targets);
            let moving = !state.status.moving().intersection(wanted).is_empty();
            let Some((axis, target, found)) = off.filter(|_| !moving) else {
                standing.0 = 0;
                return (!moving).then_some(Ok(()));
            };
            standing.0 = if standing.1 == state.positions { standing.0 + 1 } else { 1 };
            standing.1 = state.positions;
            if standing.0 < STANDING_SAMPLES {
                return None;
            }
            let at = board.at(action);
            let on_switch = state.status.on_limit_switch().intersection(wanted);
            Some(Err(if on_switch.is_empty() {
                let axis = Axes::Letters(axis.mask().bits());
                DriveError::NotArrived { at, axis, target: target.into(), found: found.into() }
            } else {
                DriveError::LimitSwitch { at, axes: Axes::Letters(on_switch.bits()) }
            }))
        })
        .await
    }

    /// Brings all axes to rest on their ramps (command 42), empties the buffer and waits for both: axes that stand go on
    /// if segments wait.
    ///
    /// # Errors
    /// If they still move after `patience`, the buffer is not empty (B5) then, or no proper answer comes.
    pub async fn ramp_stop(
        &mut self,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<BoardState, DriveError> {
        let command = Command::RampStop;
        self.send_stop(&command, clock).await?;
        self.wait(command.action(), patience, clock, |_, state| {
            state.status.stopped(AxisMask::ALL).then_some(Ok(*state))
        })
        .await
    }

    /// Sends what stops axes, and once more if a move that was sent before may arrive after it.
    pub(crate) async fn send_stop(
        &mut self,
        command: &Command,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let late = self.is_late();
        self.send(command, clock).await?;
        if late {
            sleep(self.options().worst_latency).await;
            self.send(command, clock).await?;
        }
        Ok(())
    }

    /// Stops all axes without ramp, empties the buffer and locks the board (command 43), and checks it.
    ///
    /// # Errors
    /// If an axis still moves, the board is not locked, or no proper answer comes.
    pub async fn stop_and_lock(&mut self, clock: &dyn Clock) -> Result<BoardState, DriveError> {
        let command = Command::Stop;
        self.send(&command, clock).await?;
        let (state, _) = self.state(clock).await?;
        let at = self.at(command.action());
        let moving = state.status.moving();
        if !moving.is_empty() {
            Err(DriveError::Moving { at, axes: Axes::Letters(moving.bits()) })
        } else if state.status.locked() {
            Ok(state)
        } else {
            Err(DriveError::NotLocked { at })
        }
    }
}

/// Axes that have a value.
pub(super) fn targets_mask(values: &AxisValues) -> AxisMask {
    let named = BoardAxis::ALL.into_iter().zip(values).filter(|(_, value)| value.is_some());
    named.fold(AxisMask::NONE, |mask, (axis, _)| mask.union(axis.mask()))
}

/// The first axis that is not where it should be, with both positions.
fn off_target(state: &BoardState, targets: &AxisValues) -> Option<(BoardAxis, i32, i32)> {
    let pairs = BoardAxis::ALL.into_iter().zip(targets).zip(state.positions);
    let mut off = pairs.filter_map(|((axis, target), found)| {
        target.filter(|target| *target != found).map(|target| (axis, target, found))
    });
    off.next()
}
