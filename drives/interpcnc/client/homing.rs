//! Homing and probing, from the command to its result.

use std::time::Duration;

use super::{BoardState, InterpCnc, motion::targets_mask, outcome::Patience};
use crate::{
    AxisValues, Command,
    protocol::registers::{AxisMask, BoardAxis, ExtendedStatus, Status},
};
use twin_drives::{Action, Axes, Clock, DriveError};

/// Homing of one axis by command 78.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HomeAxis {
    /// The axis.
    pub axis: BoardAxis,
    /// Input of the switch, 1 to 32.
    pub input: u8,
    /// Whether the contact is normally open (NO), so that the input is 1 on the switch.
    pub normally_open: bool,
    /// Acceleration, 1000 steps/s².
    pub acceleration_khz_per_s: u16,
    /// Speed towards the switch, steps/s.
    pub fast_hz: u32,
    /// Deceleration, 1000 steps/s².
    pub deceleration_khz_per_s: u16,
    /// Longest way, steps; its sign is the direction.
    pub max_stroke: i32,
    /// Speed off the switch, steps/s.
    pub slow_hz: u16,
    /// Counter at the end, steps.
    pub final_position: i32,
}

impl HomeAxis {
    /// As a command.
    pub fn command(&self) -> Command {
        Command::HomeAxis {
            axis: self.axis,
            input: self.input.into(),
            contact: self.normally_open.into(),
            acceleration_khz_per_s: self.acceleration_khz_per_s,
            fast_hz: self.fast_hz,
            deceleration_khz_per_s: self.deceleration_khz_per_s,
            max_stroke: self.max_stroke,
            slow_hz: self.slow_hz,
            final_position: self.final_position,
        }
    }
}

/// A probing move by command 40.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeMove {
    /// The axis.
    pub axis: BoardAxis,
    /// Towards larger positions.
    pub positive: bool,
    /// Input, 1 to 32.
    pub input: u8,
    /// Level of the input that ends the move.
    pub level: bool,
    /// Longest way, steps, more than 0.
    pub max_stroke: i32,
    /// Speed, steps/s.
    pub speed_hz: u32,
    /// Start and stop frequency, steps/s.
    pub start_stop_hz: u16,
    /// Acceleration, 1000 steps/s².
    pub acceleration_khz_per_s: u16,
    /// Deceleration, 1000 steps/s².
    pub deceleration_khz_per_s: u16,
}

impl ProbeMove {
    /// As a command.
    pub fn command(&self) -> Command {
        Command::Probe {
            axes: self.axis.mask(),
            positive: self.positive,
            input: self.input.into(),
            level: self.level.into(),
            max_stroke: self.max_stroke,
            speed_hz: self.speed_hz,
            start_stop_hz: self.start_stop_hz,
            acceleration_khz_per_s: self.acceleration_khz_per_s,
            deceleration_khz_per_s: self.deceleration_khz_per_s,
        }
    }
}

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

    /// Homes axes side by side, each by its own command 78, and waits until all have ended.
    ///
    /// # Errors
    /// If homing of any fails (the others go on until they end), the board refuses or is locked, it does not end in
    /// time, or no proper answer comes.
    pub async fn home_axes(
        &mut self,
        axes: &[HomeAxis],
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let mut mask = AxisMask::NONE;
        let mut action = Action::ReadState;
        for home in axes {
            let command = home.command();
            action = command.action();
            self.send_motion(&command, clock).await?;
            mask = mask.union(home.axis.mask());
        }
        let mut left = Patience::new(patience);
        loop {
            let over = left.is_over().await;
            let extended = self.extended_status(clock).await?;
            if extended.homing().intersection(mask).is_empty() {
                return self.homed(mask, extended, action, clock).await;
            }
            let (state, _) = self.state(clock).await?;
            self.check_obeys(&state, action)?;
            if over {
                return Err(DriveError::Unfinished { at: self.at(action), patience });
            }
        }
    }

    /// Whether the end of homing is a good one.
    async fn homed(
        &mut self,
        axes: AxisMask,
        extended: ExtendedStatus,
        action: Action,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let (state, _) = self.state(clock).await?;
        self.check_obeys(&state, action)?;
        let failed = extended.homing_failed().intersection(axes);
        if failed.is_empty() {
            return Ok(());
        }
        Err(DriveError::HomingFailed { at: self.at(action), axes: Axes::Letters(failed.bits()) })
    }

    /// Moves an axis until an input changes (command 40); the counter at the edge, before the deceleration.
    ///
    /// # Errors
    /// If the input does not come within the stroke or has the level already, the board refuses it or is locked, it
    /// does not end in time, or no proper answer comes.
    pub async fn probe(
        &mut self,
        probe: &ProbeMove,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<i32, DriveError> {
        let command = probe.command();
        self.send_motion(&command, clock).await?;
        let action = command.action();
        self.wait(action, patience, clock, |board, state| {
            if let Err(locked) = board.check_obeys(state, action) {
                return Some(Err(locked));
            }
            if state.status.probing() {
                return None;
            }
            Some(if state.status.probe_failed() {
                Err(DriveError::ProbeFailed { at: board.at(action) })
            } else {
                Ok(())
            })
        })
        .await?;
        self.probe_result(clock).await
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
