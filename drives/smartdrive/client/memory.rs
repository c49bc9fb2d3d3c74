//! Parameters and variables, each in a call.

use crate::{
    Command, LoadSource, SetEffect, SmartDrive,
    protocol::{
        frame::Answer,
        parameters::{ADDRESS, Entry, parameter_at, variable_at},
    },
};
use twin_drives::DriveError;

/// The three copies of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterValue {
    /// In the flash memory.
    pub saved: i64,
    /// In use.
    pub working: i64,
    /// From the factory.
    pub factory: i64,
}

/// The 32 bits of two words.
fn join(low: u16, high: u16) -> u32 {
    u32::from(high) << 16 | u32::from(low)
}

impl SmartDrive {
    /// READ: a variable.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`crate::Fault::Rejected`] if the variable does not exist.
    pub async fn read(&mut self, address: u8, variable: u16) -> Result<i64, DriveError> {
        let number = self.ask_surely(address, Command::Read { variable }).await?.number();
        Ok(variable_at(variable).map_or(number.into(), |entry| entry.value(number.cast_unsigned())))
    }

    /// WRITE: changes a variable; its value afterwards.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`crate::Fault::Rejected`] if the variable does not exist or cannot be written.
    pub async fn write_variable(
        &mut self,
        address: u8,
        variable: u16,
        value: u32,
    ) -> Result<i64, DriveError> {
        let number = self.ask(address, Command::Write { variable, value }).await?.number();
        Ok(variable_at(variable).map_or(number.into(), |entry| entry.value(number.cast_unsigned())))
    }

    /// GET: the three copies of a parameter, 32-bit ones in two steps.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`crate::Fault::Rejected`] if the parameter does not exist.
    pub async fn parameter(
        &mut self,
        address: u8,
        index: u16,
    ) -> Result<ParameterValue, DriveError> {
        let low = self.ask_surely(address, Command::Get { parameter: index }).await?;
        let entry = parameter_at(index).filter(|(_, is_high)| !is_high).map(|(entry, _)| entry);
        let high = match entry {
            Some(entry) if entry.kind.is_long() => {
                Some(self.ask_surely(address, Command::Get { parameter: index + 1 }).await?)
            }
            _ => None,
        };
        Ok(copies(entry, low, high))
    }

    /// SET: changes the working value of a parameter, 32-bit ones in two steps, the high word last; the copies
    /// afterwards. Where SET begins the mode anew ([`SetEffect::RestartsMode`]), it returns when the drive is back in it,
    /// at position 0.
    ///
    /// # Errors
    /// As [`SmartDrive::send`]; [`twin_drives::DriveError::Value`] if the parameter cannot have this value, or the drive does
    /// not show it afterwards; [`crate::Fault::Rejected`] if the drive does not have the parameter.
    pub async fn set_parameter(
        &mut self,
        address: u8,
        index: u16,
        value: i64,
    ) -> Result<ParameterValue, DriveError> {
        let [a, b, c, d, ..] = value.to_le_bytes();
        let (low, high) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
        let command = Command::Set { parameter: index, value: low };
        let entry = parameter_at(index).filter(|(_, is_high)| !is_high).map(|(entry, _)| entry);
        let (least, most) = entry.map_or((0, 0xFFFF), |entry| (entry.low, entry.high));
        let beyond = |at| {
            #[expect(clippy::cast_precision_loss, reason = "for a message")]
            let (value, low, high) = (value as f64, least as f64, most as f64);
            let (what, unit) = entry.map_or(("parameter", ""), |entry| (entry.name, entry.unit));
            DriveError::Value { at, what, value, unit, low, high }
        };
        let possible = entry.map_or((least..=most).contains(&value), |entry| entry.accepts(value));
        if !possible {
            return Err(beyond(self.at(address, command.action())));
        }
        let first = self.set_word(address, command).await?;
        let second = match entry {
            Some(entry) if entry.kind.is_long() => {
                let command = Command::Set { parameter: index + 1, value: high };
                Some(self.set_word(address, command).await?)
            }
            _ => None,
        };
        let now = copies(entry, first, second);
        if now.working == value { Ok(now) } else { Err(beyond(self.at(address, command.action()))) }
    }

    /// SET of a word, waited for where it begins the mode anew.
    async fn set_word(&mut self, address: u8, command: Command) -> Result<Answer, DriveError> {
        let answer = self.ask(address, command).await?;
        if self.options().assumptions.set_effect == SetEffect::RestartsMode {
            // A drive with a new address listens to that from then on.
            let address = match command {
                Command::Set { parameter: ADDRESS, value } => value.to_le_bytes()[0],
                _ => address,
            };
            self.changed(address, &command).await?;
        }
        Ok(answer)
    }

    /// SAVE: saves all working values; returns when the drive is back in its mode, at position 0.
    ///
    /// # Errors
    /// As [`SmartDrive::set_mode`].
    pub async fn save(&mut self, address: u8) -> Result<(), DriveError> {
        self.ask(address, Command::Save).await?;
        self.changed(address, &Command::Save).await.map(|_| ())
    }

    /// LOAD: takes all working values from the saved ones or the factory's; returns when the drive is back in its mode,
    /// at position 0.
    ///
    /// # Errors
    /// As [`SmartDrive::set_mode`].
    pub async fn load(&mut self, address: u8, source: LoadSource) -> Result<(), DriveError> {
        self.ask(address, Command::Load(source)).await?;
        self.changed(address, &Command::Load(source)).await.map(|_| ())
    }
}

/// The copies of a parameter from the answers with its words.
fn copies(entry: Option<&Entry>, low: Answer, high: Option<Answer>) -> ParameterValue {
    let value = |low: u16, high: u16| {
        let bits = join(low, high);
        entry.map_or(bits.into(), |entry| entry.value(bits))
    };
    let (saved, working) = low.words();
    let (saved_high, working_high) = high.map_or((0, 0), |high| high.words());
    ParameterValue {
        saved: value(saved, saved_high),
        working: value(working, working_high),
        factory: value(low.tag, high.map_or(0, |answer| answer.tag)),
    }
}
