//! Inputs, outputs and counters of the board.

use super::{BoardState, InterpCnc};
use crate::protocol::registers::{
    ANALOG_OUTPUT, ENCODER, EXTENDED_STATUS, ExtendedStatus, FIRST_OUTPUT, MAX_ANALOG, OUTPUTS,
    SNAPSHOT_REGISTERS, STATUS, join,
};
use twin_drives::{Action, Clock, DriveError};

/// All that registers 1024 to 1055 say at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Snapshot {
    /// Status and positions.
    pub state: BoardState,
    /// Inputs, bit 0 = IN1.
    pub inputs: u32,
    /// Outputs, bit 0 = OUT1.
    pub outputs: u32,
    /// Analog inputs 1 to 4, 0 to 1023.
    pub analog_inputs: [u16; 4],
    /// Result of the last probing move, steps.
    pub probe_result: i32,
    /// Extended status.
    pub extended: ExtendedStatus,
}

impl Snapshot {
    fn from_registers(registers: &[u16]) -> Option<Self> {
        let (state, rest) = registers.split_at_checked(12)?;
        let [ih, il, oh, ol, a, b, c, d, ph, pl, .., eh, el] = *rest else { return None };
        Some(Self {
            state: BoardState::from_registers(state)?,
            inputs: join(ih, il),
            outputs: join(oh, ol),
            analog_inputs: [a, b, c, d],
            probe_result: join(ph, pl).cast_signed(),
            extended: ExtendedStatus(join(eh, el)),
        })
    }
}

/// A value of 32 bits, high word first.
fn long(registers: &[u16]) -> Option<u32> {
    match *registers {
        [high, low] => Some(join(high, low)),
        _ => None,
    }
}

fn longs(registers: &[u16]) -> Vec<u32> {
    registers.chunks_exact(2).filter_map(long).collect()
}

/// A word of bits, the first lowest.
fn word(bits: &[bool]) -> u32 {
    bits.iter().zip(0_u32..32).fold(0, |word, (bit, place)| word | u32::from(*bit) << place)
}

impl InterpCnc {
    /// Everything that changes by itself, in one exchange.
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn snapshot(&mut self, clock: &dyn Clock) -> Result<Snapshot, DriveError> {
        let what = "all input registers";
        let registers = self.read_input(what, STATUS, SNAPSHOT_REGISTERS, clock).await?;
        let action = Action::Read { what, address: STATUS, count: SNAPSHOT_REGISTERS };
        Snapshot::from_registers(&registers).ok_or_else(|| self.garbled(action))
    }

    /// An answer of the right kind without the values it should have.
    fn garbled(&self, action: Action) -> DriveError {
        DriveError::Protocol { at: self.at(action), fault: twin_drives::ProtocolFault::Garbled }
    }

    /// The extended status.
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn extended_status(
        &mut self,
        clock: &dyn Clock,
    ) -> Result<ExtendedStatus, DriveError> {
        let registers = self.read_input("extended status", EXTENDED_STATUS, 2, clock).await?;
        Ok(ExtendedStatus(long(&registers).unwrap_or(0)))
    }

    /// Outputs, bit 0 = OUT1, as coils (function 1).
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn outputs(&mut self, clock: &dyn Clock) -> Result<u32, DriveError> {
        let count = OUTPUTS.into();
        Ok(word(&self.read_coils("outputs", FIRST_OUTPUT, count, clock).await?))
    }

    /// Analog outputs 1 and 2, 0 to 1023.
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn analog_outputs(&mut self, clock: &dyn Clock) -> Result<[u16; 2], DriveError> {
        let registers = self.read_holding("analog outputs", ANALOG_OUTPUT, 2, clock).await?;
        Ok(registers.try_into().unwrap_or_default())
    }

    /// Sets analog output `number` (1 or 2) to 0 to 1023 and reads it back.
    ///
    /// # Errors
    /// If the output or value does not exist, the board refuses it or is locked, or no proper answer comes.
    pub async fn set_analog_output(
        &mut self,
        number: u8,
        value: u16,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let what = "analog outputs";
        let first = u16::from(number).wrapping_sub(1);
        let writing = |address, count| Action::Write { what, address, count };
        let address = self.within_area(writing, (ANALOG_OUTPUT, 2), first, 1)?;
        let action = writing(address, 1);
        if value > MAX_ANALOG {
            return Err(DriveError::Range {
                at: self.at(action),
                register: address,
                value: value.into(),
                unit: "",
                low: 0.0,
                high: MAX_ANALOG.into(),
            });
        }
        if let Err(error) = self.write_holding(what, address, &[value], clock).await {
            return Err(self.if_locked(error, clock).await);
        }
        let found = self.read_holding(what, address, 1, clock).await?;
        if found == [value] { Ok(()) } else { Err(DriveError::Locked { at: self.at(action) }) }
    }

    /// Encoder position alone, points (registers 4218 and 4219, from board version V2.1D).
    ///
    /// # Errors
    /// If the board has no such registers or no proper answer comes.
    pub async fn encoder_position(&mut self, clock: &dyn Clock) -> Result<i32, DriveError> {
        let registers = self.read_holding("encoder position", ENCODER, 2, clock).await?;
        Ok(long(&registers).unwrap_or(0).cast_signed())
    }

    /// Encoder position and pulse counters A and B (from board version V2.1D).
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn counters(&mut self, clock: &dyn Clock) -> Result<(i32, [u32; 2]), DriveError> {
        let registers = self.read_holding("encoder and counters", ENCODER, 6, clock).await?;
        Ok(match *longs(&registers).as_slice() {
            [encoder, a, b] => (encoder.cast_signed(), [a, b]),
            _ => (0, [0; 2]),
        })
    }
}
