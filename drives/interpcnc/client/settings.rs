//! Identity of the board, and access to its parameters.

use std::time::Duration;

use super::InterpCnc;
use crate::{
    Exception, Line, Parity,
    protocol::{
        parameters::{self, FIRST_PARAMETER, PARAMETERS},
        registers::{RECIPE_SIZE, Status, join, words},
    },
};
use twin_drives::{Action, Clock, DriveError};

/// Identity of a board: the manual knows no register for its name or firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Station address by parameter 103.
    pub address: u32,
    /// Speed by parameter 101, as it is coded there.
    pub speed: u32,
    /// Parity by parameter 102, as it is coded there.
    pub parity: u32,
    /// Speed and parity, if the codes make sense as assumed.
    pub line: Option<Line>,
    /// Whether it has recipes: firmware 5.30 or later, which also knows command 78.
    pub has_recipes: bool,
}

impl InterpCnc {
    /// Reads the identity of the board. Changes nothing.
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn identify(&mut self, clock: &dyn Clock) -> Result<Identity, DriveError> {
        let speed = self.parameter(parameters::MODBUS_SPEED, clock).await?;
        let parity = self.parameter(parameters::MODBUS_PARITY, clock).await?;
        let address = self.parameter(parameters::MODBUS_ADDRESS, clock).await?;
        let has_recipes = match self.read_holding("recipe size", RECIPE_SIZE, 1, clock).await {
            Ok(_) => true,
            Err(error) if Exception::code_of(&error).is_some() => false,
            Err(error) => return Err(error),
        };
        let baud = self.options().assumptions.baud_code.decode(speed);
        let line = baud.zip(Parity::from_code(parity)).map(|(baud, parity)| Line { baud, parity });
        Ok(Identity { address, speed, parity, line, has_recipes })
    }

    /// Address of a parameter.
    fn parameter_address(
        &self,
        number: u16,
        count: usize,
        written: bool,
    ) -> Result<u16, DriveError> {
        let what = "parameter";
        let action = |address, count| {
            if written {
                Action::Write { what, address, count }
            } else {
                Action::Read { what, address, count }
            }
        };
        let area = (FIRST_PARAMETER, 2 * PARAMETERS);
        self.within_area(action, area, number.saturating_mul(2), 2 * count)
    }

    /// Parameter `number` (0 to 383).
    ///
    /// # Errors
    /// If there is none or no proper answer comes.
    pub async fn parameter(&mut self, number: u16, clock: &dyn Clock) -> Result<u32, DriveError> {
        let values = self.parameters(number, 1, clock).await?;
        Ok(values.first().copied().unwrap_or(0))
    }

    /// `count` parameters from `first` on; all of them are 384 from 0.
    ///
    /// # Errors
    /// If they are fewer or no proper answer comes.
    pub async fn parameters(
        &mut self,
        first: u16,
        count: u16,
        clock: &dyn Clock,
    ) -> Result<Vec<u32>, DriveError> {
        let address = self.parameter_address(first, count.into(), false)?;
        let registers = self.read_holding("parameter", address, 2 * count, clock).await?;
        let pairs = registers.chunks_exact(2);
        Ok(pairs
            .filter_map(|pair| <[u16; 2]>::try_from(pair).ok())
            .map(|[high, low]| join(high, low))
            .collect())
    }

    /// Writes a parameter, waits until the EEPROM has it and reads it back. Writes only what is not so already: every
    /// write wears the EEPROM. After a write that has failed (B15) what is read may be in RAM alone, and is written again.
    ///
    /// # Errors
    /// If there is none, the board refuses it, the EEPROM fails or is not ready in time, the parameter reads back
    /// otherwise, or no proper answer comes.
    pub async fn set_parameter(
        &mut self,
        number: u16,
        value: u32,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let address = self.parameter_address(number, 1, true)?;
        if self.parameter(number, clock).await? == value {
            let (state, _) = self.state(clock).await?;
            let doubtful = [Status::EEPROM_BUSY, Status::EEPROM_ERROR];
            if !doubtful.into_iter().any(|bit| state.status.has(bit)) {
                return Ok(());
            }
        }
        self.write_kept("parameter", address, &words(value), patience, clock).await?;
        let found = self.parameter(number, clock).await?;
        if found == value {
            return Ok(());
        }
        let action = Action::Write { what: "parameter", address, count: 2 };
        Err(DriveError::NotKept { at: self.at(action), address: number, written: value, found })
    }

    /// Writes registers that the EEPROM keeps and waits until it has them: B14 clear, then B15 shows the outcome.
    async fn write_kept(
        &mut self,
        what: &'static str,
        address: u16,
        values: &[u16],
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let count = u16::try_from(values.len()).unwrap_or(u16::MAX);
        let action = Action::Write { what, address, count };
        let failure = self.options().assumptions.exceptions_failure;
        match self.write_holding(what, address, values, clock).await {
            Err(error) if Exception::code_of(&error) == Some(failure) => {
                return Err(DriveError::EepromFailed { at: error.at().clone() });
            }
            written => written?,
        }
        self.wait(action, patience, clock, |board, state| {
            if state.status.has(Status::EEPROM_BUSY) {
                return None;
            }
            Some(if state.status.has(Status::EEPROM_ERROR) {
                Err(DriveError::EepromFailed { at: board.at(action) })
            } else {
                Ok(())
            })
        })
        .await
    }
}
