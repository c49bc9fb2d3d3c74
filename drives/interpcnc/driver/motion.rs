//! Moves, homing and probing, from the command to its result.

use std::time::Duration;

use super::{BoardState, InterpCnc};
use crate::{
    Clock, DriveError, Stamp,
    interpcnc::{
        AxisValues, Command, MoveProfile,
        registers::{AXES, AxisMask, BoardAxis, ExtendedStatus, Status},
    },
};

/// Samples in a row in which an axis that does not move stands on the same wrong position before it counts as
/// stopped there: firmware before 5.31 shows no motion at the instant at which a move reverses.
const STANDING_SAMPLES: u32 = 3;

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
    /// Sends a command that moves axes and makes sure that the board obeys: a locked board accepts it and does nothing.
    pub(super) async fn send_motion(
        &mut self,
        command: &Command,
        clock: &dyn Clock,
    ) -> Result<Stamp, DriveError> {
        let stamp = self.send(command, clock).await?;
        let (state, _) = self.state(clock).await?;
        self.check_obeys(&state, command.action())?;
        Ok(stamp)
    }

    /// Moves one axis (command 80) and waits until it stands on its target.
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
                let axis = axis.number() - 1;
                DriveError::NotArrived { at, axis, target: target.into(), found: found.into() }
            } else {
                DriveError::LimitSwitch { at, axes: on_switch.bits() }
            }))
        })
        .await
    }

    /// Changes the speed of axes in independent moves (command 96). Axes at rest or in their final deceleration ignore
    /// it.
    ///
    /// # Errors
    /// If the board refuses it or no proper answer comes.
    pub async fn change_speed(
        &mut self,
        axes: AxisMask,
        speed_hz: u32,
        clock: &dyn Clock,
    ) -> Result<Stamp, DriveError> {
        self.send(&Command::ChangeSpeed { axes, speed_hz }, clock).await
    }

    /// Brings all axes to rest on their ramps (command 42), empties the buffer and waits for it.
    ///
    /// # Errors
    /// If they still move after `patience` or no proper answer comes.
    pub async fn ramp_stop(
        &mut self,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<BoardState, DriveError> {
        self.stop_by(&Command::RampStop, AxisMask::ALL, patience, clock).await
    }

    /// Brings independent moves of some axes to rest on their ramps (command 41) and waits for it.
    ///
    /// # Errors
    /// If they still move after `patience` or no proper answer comes.
    pub async fn ramp_stop_axes(
        &mut self,
        axes: AxisMask,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<BoardState, DriveError> {
        self.stop_by(&Command::RampStopAxes { axes }, axes, patience, clock).await
    }

    async fn stop_by(
        &mut self,
        command: &Command,
        axes: AxisMask,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<BoardState, DriveError> {
        self.send(command, clock).await?;
        let action = command.action();
        let independent_only = matches!(command, Command::RampStopAxes { .. });
        self.wait(action, patience, clock, |_, state| {
            let status = state.status;
            let moving = if independent_only { status.independent() } else { status.moving() };
            moving.intersection(axes).is_empty().then_some(Ok(*state))
        })
        .await
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
            Err(DriveError::Moving { at, axes: moving.bits() })
        } else if state.status.locked() {
            Ok(state)
        } else {
            Err(DriveError::NotLocked { at })
        }
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
        let (action, axes) = (command.action(), targets_mask(max_strokes).bits());
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
        let mut action = crate::Action::ReadState;
        for home in axes {
            let command = home.command();
            action = command.action();
            self.send_motion(&command, clock).await?;
            mask = mask.union(home.axis.mask());
        }
        let mut left = super::outcome::Patience::new(patience);
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
        action: crate::Action,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let (state, _) = self.state(clock).await?;
        self.check_obeys(&state, action)?;
        let failed = extended.homing_failed().intersection(axes);
        if failed.is_empty() {
            return Ok(());
        }
        Err(DriveError::HomingFailed { at: self.at(action), axes: failed.bits() })
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

    /// Sets position counters (command 67) of axes at rest and reads them back.
    ///
    /// # Errors
    /// If an axis moves, a counter does not hold what was written, the board refuses it or no proper answer comes.
    pub async fn write_positions(
        &mut self,
        positions: &AxisValues,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let command = Command::WritePosition { positions: *positions };
        let action = command.action();
        let (before, _) = self.state(clock).await?;
        let moving = before.status.moving().intersection(targets_mask(positions));
        if !moving.is_empty() {
            return Err(DriveError::Moving { at: self.at(action), axes: moving.bits() });
        }
        self.send(&command, clock).await?;
        let (after, _) = self.state(clock).await?;
        match off_target(&after, positions) {
            None => Ok(()),
            Some((axis, written, found)) => Err(DriveError::NotWritten {
                at: self.at(action),
                axis: axis.number() - 1,
                written: written.into(),
                found: found.into(),
            }),
        }
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
