//! Calls that need several orders: switching motor current on, and moves and homing until the axes rest.

use std::time::Duration;

use super::{Action, Bim2Ax, Clock, DriveError, ModuleAxis, Positions, Start};
use crate::{
    Fault,
    protocol::bits::{message, uc},
};
use twin_drives::{Axes, Exchange};

/// What keeps a motor from getting current.
const FAULTS: u16 = message::POWER_ABSENT | message::PHASE_OPEN | message::PHASE_SHORT;

impl Bim2Ax {
    /// Gives motors current, at standstill: by the order for that, or by a motor test where the module does not know it.
    ///
    /// # Errors
    /// If power is absent, a phase is open or has a short circuit, or the module does not answer.
    pub async fn energise(
        &mut self,
        axes: &[ModuleAxis],
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        match self.set_phases(axes, true, clock).await {
            // Modules from before revision D do not know that order; a motor test switches phases on, too, and clears
            // faults that are gone (7.6).
            Err(error)
                if matches!(error.fault(), Some(Fault::AxisMessages { messages, .. })
                    if messages & FAULTS == 0) =>
            {
                self.test_motors(axes, clock).await
            }
            done => done,
        }
    }

    /// Homes axes and waits until both rest, which they do within `patience`; what they say then.
    ///
    /// # Errors
    /// [`DriveError::Unfinished`] if one still moves after `patience`, [`Fault::AxisMessages`] if one is not homed when
    /// both rest; else as [`Bim2Ax::home`] and [`Bim2Ax::rested`].
    pub async fn home_to_end(
        &mut self,
        axes: &[ModuleAxis],
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<Positions, DriveError> {
        self.home(axes, clock).await?;
        let (seen, _) = self.rested(patience, clock).await.map_err(|error| match error {
            DriveError::Moving { at, .. } => {
                let action = Action::Order { bits: uc::HOME, name: "homing" };
                DriveError::Unfinished { at: Exchange { action, ..at }, patience }
            }
            other => other,
        })?;
        axes.iter().try_for_each(|axis| {
            self.blame(&seen, *axis, |messages| messages & message::HOMED == 0)
        })?;
        Ok(seen)
    }

    /// Moves one axis to a position, µsteps, at a speed in the unit of its drive mode (none: the fast speed), and waits until
    /// it rests there, which it does within `patience`.
    ///
    /// # Errors
    /// [`Fault::AxisMessages`] with the reason if it is elsewhere (end switch, limit, motor), or
    /// [`DriveError::NotArrived`] if it reports none; else as [`Bim2Ax::start`] and [`Bim2Ax::rested`].
    pub async fn travel(
        &mut self,
        axis: ModuleAxis,
        (target, speed): (i32, Option<u16>),
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let start = Start { speed, ..Start::to(target) };
        let starts = ModuleAxis::ALL.map(|any| (any == axis).then_some(start));
        self.start(starts, clock).await?;
        let (seen, _) = self.rested(patience, clock).await?;
        let found = seen.positions.get(axis.index()).copied().unwrap_or(0);
        if found == target {
            return Ok(());
        }
        let no_reason = message::MOVING | message::HOMED | message::ON_CAM;
        self.blame(&seen, axis, |messages| messages & !no_reason != 0)?;
        let (at, axis) = (self.at(Action::ReadState), Axes::Numbers(1 << axis.index()));
        Err(DriveError::NotArrived { at, axis, target: target.into(), found: found.into() })
    }

    /// Fails with the messages of an axis if these are wrong.
    fn blame(
        &self,
        seen: &Positions,
        axis: ModuleAxis,
        wrong: impl Fn(u16) -> bool,
    ) -> Result<(), DriveError> {
        let messages = seen.messages.get(axis.index()).copied().unwrap_or(0);
        if !wrong(messages) {
            return Ok(());
        }
        let axis = u8::try_from(axis.number()).unwrap_or(0);
        Err(Fault::AxisMessages { axis, messages }.at(self.at(Action::ReadState)))
    }
}
