//! The board's own homing (command 71) as a [`twin_drives::Drive`] offers it.

use super::{InterpCncDrive, Watched, no_clock};
use crate::{
    AxisValues, BoardAxis, BoardState, Command,
    protocol::{
        parameters,
        registers::{AXES, AxisMask, Status},
    },
};
use twin_drives::{Action, Axes, DriveError, HomingWays, MAX_DRIVE_AXES};

/// Homing as the client knows it: the board shows whether one is under way and whether the last one has failed, no more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Homing {
    /// Axes that this driver has ever homed.
    asked: AxisMask,
    /// Of the homing that is under way, or has ended unseen.
    under_way: AxisMask,
    /// Homed and not stopped hard since.
    homed: AxisMask,
}

impl Homing {
    fn begin(&mut self, axes: AxisMask) {
        self.asked = self.asked.union(axes);
        self.under_way = axes;
        self.homed = self.homed.without(axes);
    }

    /// Steps may have been lost: nothing is home any more.
    pub(super) fn lose(&mut self) {
        self.under_way = AxisMask::NONE;
        self.homed = AxisMask::NONE;
    }

    /// Steps of one axis are lost.
    pub(super) fn lose_axis(&mut self, axis: BoardAxis) {
        self.under_way = self.under_way.without(axis.mask());
        self.homed = self.homed.without(axis.mask());
    }

    /// Takes note of the board's state.
    pub(super) fn seen(&mut self, status: Status) {
        if status.locked() {
            self.lose();
        } else if !status.has(Status::HOMING_IN_PROGRESS) {
            let homed =
                if status.has(Status::HOMING_ERROR) { AxisMask::NONE } else { self.under_way };
            self.homed = self.homed.union(homed);
            self.under_way = AxisMask::NONE;
        }
    }
}

impl InterpCncDrive {
    /// Command 71 for the axes that have a way; parameters 9 to 60 say how they home.
    pub(super) fn start_homing(&mut self, ways: &HomingWays) -> Result<(), DriveError> {
        self.restart();
        let mut max_strokes: AxisValues = [None; AXES];
        let mut mask = AxisMask::NONE;
        let wanted: Vec<_> =
            self.axes().zip(ways).filter_map(|(axis, way)| Some((axis, (*way)?))).collect();
        for (axis, way) in wanted {
            let number = parameters::home_input(axis);
            if self.runtime.block_on(self.board.parameter(number, &no_clock))? == 0 {
                let at = self.board.at(Command::HomeMachine { max_strokes }.action());
                return Err(DriveError::Unsupported { at, what: "home switch for the axis" });
            }
            let way = self.counter_value(
                &Command::HomeMachine { max_strokes },
                crate::protocol::registers::COMMAND + 2,
                way.into(),
            )?;
            if let Some(slot) = max_strokes.get_mut(axis.index()) {
                *slot = Some(way);
            }
            mask = mask.union(axis.mask());
        }
        if mask.is_empty() {
            return Ok(());
        }
        // An error of an earlier homing must not be taken for one of this.
        self.runtime.block_on(self.board.clear_errors(true, false, &no_clock))?;
        let watched = self.encoder.is_some_and(|watched| mask.contains(watched.axis()));
        if watched {
            self.refer_encoder()?;
            self.encoder.iter_mut().for_each(Watched::homes);
        }
        self.homing.begin(mask);
        let command = Command::HomeMachine { max_strokes };
        self.runtime.block_on(self.board.begin(&command, &no_clock))
    }

    /// Which axes are homed, as far as board and driver know.
    pub(super) fn homed_axes(&mut self) -> Result<[Option<bool>; MAX_DRIVE_AXES], DriveError> {
        let (BoardState { status, positions }, _) = self.state(&no_clock)?;
        let ending = self.homing.under_way;
        self.homing.seen(status);
        self.check_zero(ending.intersection(self.homing.homed), &positions)?;
        let failed = self.failed_before(status)?;
        let mut homed = [None; MAX_DRIVE_AXES];
        for (place, axis) in homed.iter_mut().zip(self.axes()) {
            *place = if self.homing.asked.contains(axis) {
                Some(self.homing.homed.contains(axis))
            } else {
                failed.contains(axis).then_some(false)
            };
        }
        Ok(homed)
    }

    /// Checks that the counters of axes that have just come home are 0: the board makes them so only if parameter 128 says so.
    fn check_zero(&mut self, home: AxisMask, positions: &[i32; AXES]) -> Result<(), DriveError> {
        for (axis, found) in BoardAxis::ALL.into_iter().zip(*positions) {
            if home.contains(axis) && found != 0 {
                self.homing.homed = self.homing.homed.without(home);
                let at = self.board.at(Command::HomeMachine { max_strokes: [None; AXES] }.action());
                let axis = Axes::Letters(axis.mask().bits());
                let (target, found) = (0, found.into());
                return Err(DriveError::NotArrived { at, axis, target, found });
            }
        }
        Ok(())
    }

    /// Axes that this driver has not homed and of which the board says that homing has failed: each by its own command 78, all
    /// of them by command 71, whose bit does not name the axis.
    fn failed_before(&mut self, status: Status) -> Result<AxisMask, DriveError> {
        let others = self.axes().fold(AxisMask::NONE, |mask, axis| mask.union(axis.mask()));
        let others = others.without(self.homing.asked);
        if others.is_empty() || status.has(Status::HOMING_ERROR) {
            return Ok(others);
        }
        let extended = self.runtime.block_on(self.board.extended_status(&no_clock))?;
        Ok(extended.homing_failed().intersection(others))
    }

    /// Locks a board whose axes are at rest (command 43).
    pub(super) fn lock(&mut self) -> Result<(), DriveError> {
        let (state, _) = self.state(&no_clock)?;
        let moving = self.moving(&state);
        if !moving.is_empty() {
            let at = self.board.at(Action::ReadState);
            return Err(DriveError::Moving { at, axes: Axes::Letters(moving.bits()) });
        }
        // Nothing moved, so nothing is lost: what is home stays there.
        let homing = self.homing;
        self.lock_at_once()?;
        self.homing = homing;
        Ok(())
    }

    /// Stops and locks (command 43), and checks both.
    pub(super) fn lock_at_once(&mut self) -> Result<(), DriveError> {
        self.restart();
        self.homing.lose();
        self.encoder.iter_mut().for_each(Watched::forget);
        self.send(&Command::Stop, &no_clock)?;
        let (state, _) = self.state(&no_clock)?;
        let at = || self.board.at(Command::Stop.action());
        let moving = self.moving(&state);
        if !moving.is_empty() {
            Err(DriveError::Moving { at: at(), axes: Axes::Letters(moving.bits()) })
        } else if state.status.locked() {
            Ok(())
        } else {
            Err(DriveError::NotLocked { at: at() })
        }
    }
}
