//! The module's own homing and its lock as a [`crate::Drive`] offers them.

use std::time::Duration;

use super::{Bim2AxDrive, no_clock};
use crate::{Action, DriveError, HomingWays, MAX_DRIVE_AXES, bim2ax::bits::message};

impl Bim2AxDrive {
    /// Homes the axes in use, both at a time, and waits for the end.
    ///
    /// # Errors
    /// If an axis does not start, has not ended after `patience`, or has not found its cam.
    pub fn home(&mut self, patience: Duration) -> Result<(), DriveError> {
        self.forget();
        let axes = self.options.axes.clone();
        let seen = self.runtime.block_on(async {
            self.module.home(&axes, &no_clock).await?;
            self.module.rested(patience, &no_clock).await
        })?;
        self.check(&seen.0, Action::ReadState, |messages| messages & message::HOMED == 0)
    }

    /// Switches phases off, at rest.
    pub(super) fn lock(&mut self) -> Result<(), DriveError> {
        self.forget();
        let (seen, _) = self.look(&no_clock)?;
        let moving = self.moving(&seen);
        if moving != 0 {
            return Err(DriveError::Moving {
                at: self.module.at(Action::ReadState),
                axes: self.names(moving),
            });
        }
        let axes = self.options.axes.clone();
        self.runtime.block_on(self.module.set_phases(&axes, false, &no_clock))
    }

    /// The module's homing of the axes that have a way, which it cannot be given.
    pub(super) fn start_homing(&mut self, ways: &HomingWays) -> Result<(), DriveError> {
        self.forget();
        let chosen = self.options.axes.iter().zip(ways).filter(|(_, way)| way.is_some());
        let axes: Vec<_> = chosen.map(|(axis, _)| *axis).collect();
        if axes.is_empty() {
            return Ok(());
        }
        self.homing = true;
        self.runtime.block_on(self.module.home(&axes, &no_clock))
    }

    /// Which axes are homed: the module keeps it.
    pub(super) fn homed_axes(&mut self) -> Result<[Option<bool>; MAX_DRIVE_AXES], DriveError> {
        let (seen, _) = self.look(&no_clock)?;
        let mut homed = [None; MAX_DRIVE_AXES];
        for (place, axis) in homed.iter_mut().zip(&self.options.axes) {
            *place = seen.messages.get(axis.index()).map(|word| word & message::HOMED != 0);
        }
        Ok(homed)
    }
}
