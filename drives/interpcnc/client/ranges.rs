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
        let within = |offset: u16, value: u32, unit, high: u32| {
            if (1..=high).contains(&value) {
                return Ok(());
            }
            Err(DriveError::Range {
                at: self.at(command.action()),
                register: COMMAND + offset,
                value: value.into(),
                unit,
                low: 1.0,
                high: high.into(),
            })
        };
        let speed = |offset, value| within(offset, value, "steps/s", MAX_SPEED_HZ);
        let rate =
            |offset, value: u16| within(offset, value.into(), "1000 steps/s²", u16::MAX.into());
        match *command {
            Command::Move { profile, .. } => {
                rate(3, profile.acceleration_khz_per_s)?;
                speed(4, profile.speed_hz)?;
                rate(6, profile.deceleration_khz_per_s)
            }
            Command::ChangeSpeed { speed_hz, .. } | Command::Interpolated { speed_hz, .. } => {
                speed(2, speed_hz)
            }
            Command::Probe {
                speed_hz,
                acceleration_khz_per_s,
                deceleration_khz_per_s,
                input,
                ..
            } => {
                within(3, input.into(), "", INPUTS.into())?;
                speed(7, speed_hz)?;
                rate(10, acceleration_khz_per_s)?;
                rate(11, deceleration_khz_per_s)
            }
            Command::HomeAxis {
                fast_hz,
                slow_hz,
                acceleration_khz_per_s,
                deceleration_khz_per_s,
                input,
                ..
            } => {
                within(2, input.into(), "", INPUTS.into())?;
                rate(4, acceleration_khz_per_s)?;
                speed(5, fast_hz)?;
                rate(7, deceleration_khz_per_s)?;
                within(10, slow_hz.into(), "steps/s", u16::MAX.into())
            }
            _ => Ok(()),
        }
    }
}
