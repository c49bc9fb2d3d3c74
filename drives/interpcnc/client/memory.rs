//! Inputs, outputs and counters of the board.

use super::{BoardState, InterpCnc};
use crate::protocol::registers::{
    ANALOG_OUTPUT, AxisMask, ENCODER, EXTENDED_STATUS, ExtendedStatus, FIRST_ENCODER_INPUT,
    FIRST_INPUT, FIRST_OUTPUT, FIRST_STATUS_BIT, LOCK_COIL, MAX_ANALOG, OUTPUT_WORDS, OUTPUTS,
    PROBE_RESULT, SNAPSHOT_REGISTERS, STATUS, Status, join, words,
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

    /// The counter at the edge that ended the last probing move, steps (registers 1044 and 1045).
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn probe_result(&mut self, clock: &dyn Clock) -> Result<i32, DriveError> {
        let registers = self.read_input("result of the probe", PROBE_RESULT, 2, clock).await?;
        Ok(long(&registers).unwrap_or(0).cast_signed())
    }

    /// Status, directions of X to B (true: positive) and encoder inputs A, B, C bit by bit (function 2, 2080 to 2119),
    /// as masters without function 4 read them.
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn status_bits(
        &mut self,
        clock: &dyn Clock,
    ) -> Result<(Status, AxisMask, [bool; 3]), DriveError> {
        let count = FIRST_ENCODER_INPUT + 3 - FIRST_STATUS_BIT;
        let bits = self.read_bits("status bits", FIRST_STATUS_BIT, count, false, clock).await?;
        let (status, rest) = bits.split_at_checked(32).unwrap_or_default();
        let (directions, encoder) = rest.split_at_checked(5).unwrap_or_default();
        let directions = AxisMask::from_bits(word(directions));
        Ok((Status(word(status)), directions, encoder.try_into().unwrap_or_default()))
    }

    /// Inputs IN1 to IN16 bit by bit (function 2), bit 0 = IN1. All 32 are in [`Self::snapshot`].
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn input_bits(&mut self, clock: &dyn Clock) -> Result<u32, DriveError> {
        Ok(word(&self.read_bits("inputs", FIRST_INPUT, 16, false, clock).await?))
    }

    /// Outputs, bit 0 = OUT1, as coils (function 1).
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn outputs(&mut self, clock: &dyn Clock) -> Result<u32, DriveError> {
        let count = OUTPUTS.into();
        Ok(word(&self.read_bits("outputs", FIRST_OUTPUT, count, true, clock).await?))
    }

    /// Switches several outputs at once, `first` (from 1) and those after it (function 15), and reads them back.
    ///
    /// # Errors
    /// If the outputs do not exist, the board refuses or is locked, or no proper answer comes.
    pub async fn switch_outputs(
        &mut self,
        first: u8,
        on: &[bool],
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let what = "outputs";
        let address = FIRST_OUTPUT + u16::from(first.max(1)) - 1;
        let count = u16::try_from(on.len()).unwrap_or(u16::MAX);
        let action = Action::Write { what, address, count };
        let last = usize::from(first) + on.len();
        if first == 0 || on.is_empty() || last > usize::from(OUTPUTS) + 1 {
            let (value, high) = (first.into(), OUTPUTS.into());
            return Err(DriveError::Range {
                at: self.at(action),
                register: FIRST_OUTPUT,
                value,
                unit: "",
                low: 1.0,
                high,
            });
        }
        if let Err(error) = self.write_bits(what, address, on, clock).await {
            return Err(self.if_locked(error, clock).await);
        }
        let found = self.read_bits(what, address, count, true, clock).await?;
        if found == on { Ok(()) } else { Err(DriveError::Locked { at: self.at(action) }) }
    }

    /// Sets all outputs at once, bit 0 = OUT1 (registers 4148 and 4149), and reads them back.
    ///
    /// # Errors
    /// If the board refuses or is locked, or no proper answer comes.
    pub async fn set_outputs(&mut self, outputs: u32, clock: &dyn Clock) -> Result<(), DriveError> {
        let outputs_words = words(outputs);
        if let Err(error) = self.write_holding("outputs", OUTPUT_WORDS, &outputs_words, clock).await
        {
            return Err(self.if_locked(error, clock).await);
        }
        let found = self.read_holding("outputs", OUTPUT_WORDS, 2, clock).await?;
        if long(&found) == Some(outputs) {
            return Ok(());
        }
        let action = Action::Write { what: "outputs", address: OUTPUT_WORDS, count: 2 };
        Err(DriveError::Locked { at: self.at(action) })
    }

    /// Whether the board is locked, by its coil 288.
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn lock_coil(&mut self, clock: &dyn Clock) -> Result<bool, DriveError> {
        let bits = self.read_bits("board lock", LOCK_COIL, 1, true, clock).await?;
        Ok(bits.first() == Some(&self.options().assumptions.lock_coil))
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
        let address = self.within_area(what, ANALOG_OUTPUT, 2, first, 1)?;
        let action = Action::Write { what, address, count: 1 };
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
