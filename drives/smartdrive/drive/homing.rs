//! The drives' own homing and their lock as a [`twin_drives::Drive`] offers them.

use super::{Seen, SmartDriveBus, no_clock};
use crate::{Command, Init, Mode, TrajectoryFlags};
use twin_drives::{Action, Axes, DriveError, HomingWays, MAX_DRIVE_AXES};

/// Homing of a drive as the client knows it: the drive shows whether homing runs, and no more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Homing {
    /// Nothing.
    #[default]
    Unknown,
    /// Begun by this driver and not seen at its end.
    UnderWay,
    /// Ended on the switch.
    Home,
    /// Failed, or the position has been lost since.
    NotHome,
}

impl SmartDriveBus {
    /// TRJINIT 2 for the drives of the axes that have a way, which these drives cannot be given.
    pub(super) fn start_homing(&mut self, ways: &HomingWays) -> Result<(), DriveError> {
        self.restart();
        let chosen: Vec<(usize, u8)> = self
            .axes()
            .zip(ways)
            .enumerate()
            .filter_map(|(index, (address, way))| way.is_some().then_some((index, address)))
            .collect();
        for (index, address) in chosen {
            self.position_lost(index);
            let begun = self.runtime.block_on(self.bus.init(address, Init::Homing));
            begun.map_err(|error| self.explain(address, error))?;
            if let Some(homing) = self.homing.get_mut(index) {
                *homing = Homing::UnderWay;
            }
        }
        Ok(())
    }

    /// The drive counts from another zero from now on, and it is not home.
    pub(super) fn position_lost(&mut self, index: usize) {
        if let Some(zero) = self.zeros.get_mut(index) {
            *zero = 0;
        }
        if let Some(homing) = self.homing.get_mut(index).filter(|known| **known != Homing::Unknown)
        {
            *homing = Homing::NotHome;
        }
    }

    pub(super) fn homed_axes(&mut self) -> Result<[Option<bool>; MAX_DRIVE_AXES], DriveError> {
        let seen = self.states(&no_clock)?;
        for (homing, (state, _)) in self.homing.iter_mut().zip(&seen) {
            // An alarm switches the drive off, and the axis may move.
            let lost = !state.alarms.is_empty() || state.mode != Mode::Remote.number();
            if lost && *homing != Homing::Unknown {
                *homing = Homing::NotHome;
            } else if *homing == Homing::UnderWay && !state.homing {
                let done = state.flags.contains(TrajectoryFlags::DONE);
                *homing = if done { Homing::Home } else { Homing::NotHome };
            }
        }
        Ok(self.homing.map(|homing| match homing {
            Homing::Unknown => None,
            Homing::Home => Some(true),
            Homing::UnderWay | Homing::NotHome => Some(false),
        }))
    }

    /// Checks that no drive moves.
    pub(super) fn check_rest(&self, seen: &[Seen]) -> Result<(), DriveError> {
        let moving = seen.iter().position(|(state, _)| state.moving());
        let Some(index) = moving else { return Ok(()) };
        let address = self.axes().nth(index).unwrap_or(0);
        let at = self.bus.at(address, Action::ReadState);
        Err(DriveError::Moving { at, axes: Axes::Only })
    }

    /// MODE 0, drive by drive, at rest.
    pub(super) fn lock(&mut self) -> Result<(), DriveError> {
        let seen = self.states(&no_clock)?;
        self.check_rest(&seen)?;
        self.restart();
        let addresses: Vec<u8> = self.axes().collect();
        for address in addresses {
            self.switched_off(address, &Command::Mode(Some(Mode::Off)))?;
        }
        Ok(())
    }
}
