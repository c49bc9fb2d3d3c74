//! Range checks of command values before they are sent to the board.

use super::InterpCnc;
use crate::protocol::{
    command::Command,
    registers::{COMMAND, INPUTS, MAX_SPEED_HZ},
};
use twin_drives::DriveError;

impl InterpCnc {
    /// Checks values that fit the registers and not the board.
    pub(super) fn check(&self, command: &Command) -> Result<(), DriveError> {
        let within = |register: u16, value: u32, unit, high: u32| {
            if (1..=high).contains(&value) {
                return Ok(());
            }
            let at = self.at(command.action());
            Err(DriveError::Range {
                at,
                register,
                value: value.into(),
                unit,
                low: 1.0,
                high: high.into(),
            })
        };
        match command {
            Command::Move { profile, .. } => {
                within(
                    COMMAND + 3,
                    profile.acceleration_khz_per_s.into(),
                    "1000 steps/s²",
                    u16::MAX.into(),
                )?;
                within(COMMAND + 4, profile.speed_hz, "steps/s", MAX_SPEED_HZ)?;
                within(
                    COMMAND + 6,
                    profile.deceleration_khz_per_s.into(),
                    "1000 steps/s²",
                    u16::MAX.into(),
                )
            }
            Command::ChangeSpeed { speed_hz, .. } | Command::Interpolated { speed_hz, .. } => {
                within(COMMAND + 2, *speed_hz, "steps/s", MAX_SPEED_HZ)
            }
            Command::Probe {
                speed_hz,
                acceleration_khz_per_s,
                deceleration_khz_per_s,
                input,
                ..
            } => {
                within(COMMAND + 3, (*input).into(), "", INPUTS.into())?;
                within(COMMAND + 7, *speed_hz, "steps/s", MAX_SPEED_HZ)?;
                within(
                    COMMAND + 10,
                    (*acceleration_khz_per_s).into(),
                    "1000 steps/s²",
                    u16::MAX.into(),
                )?;
                within(
                    COMMAND + 11,
                    (*deceleration_khz_per_s).into(),
                    "1000 steps/s²",
                    u16::MAX.into(),
                )
            }
            Command::HomeAxis {
                fast_hz,
                slow_hz,
                acceleration_khz_per_s,
                deceleration_khz_per_s,
                input,
                ..
            } => {
                within(COMMAND + 2, (*input).into(), "", INPUTS.into())?;
                within(
                    COMMAND + 4,
                    (*acceleration_khz_per_s).into(),
                    "1000 steps/s²",
                    u16::MAX.into(),
                )?;
                within(COMMAND + 5, *fast_hz, "steps/s", MAX_SPEED_HZ)?;
                within(
                    COMMAND + 7,
                    (*deceleration_khz_per_s).into(),
                    "1000 steps/s²",
                    u16::MAX.into(),
                )?;
                within(COMMAND + 10, (*slow_hz).into(), "steps/s", u16::MAX.into())
            }
            _ => Ok(()),
        }
    }
}
