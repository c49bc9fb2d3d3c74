//! What manual and published sources leave open about the board, and what is assumed instead.
//!
//! Paragraphs are those of the digest that the tests list (`drives/tests/assumptions.rs`).

use std::time::Duration;

use super::{
    options::{Line, Parity},
    parameters,
};

/// How an axis is brought to rest when the board does it by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardStop {
    /// Without ramp.
    AtOnce,
    /// On the deceleration ramp of its move.
    OnRamp,
}

/// How parameter 101 says a speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaudCode {
    /// The speed itself, bits per second.
    Raw,
    /// Hundreds of bits per second.
    Hundreds,
    /// 0 to 7 for 4800, 9600, 19200, 38400, 57600, 115200, 128000, 256000.
    Index,
}

/// The speeds of [`BaudCode::Index`]: usual ones within the 4800 to 256000 b/s that the firmware supports.
pub const BAUD_RATES: [u32; 8] = [4800, 9600, 19_200, 38_400, 57_600, 115_200, 128_000, 256_000];

impl BaudCode {
    /// The parameter for a speed, if there is one.
    pub fn encode(self, baud: u32) -> Option<u32> {
        match self {
            Self::Raw => Some(baud),
            Self::Hundreds => baud.is_multiple_of(100).then_some(baud / 100),
            Self::Index => {
                let place = BAUD_RATES.iter().position(|rate| *rate == baud)?;
                u32::try_from(place).ok()
            }
        }
    }

    /// The speed that a parameter says, if it says one.
    pub fn decode(self, code: u32) -> Option<u32> {
        let baud = match self {
            Self::Raw => code,
            Self::Hundreds => code.checked_mul(100)?,
            Self::Index => *BAUD_RATES.get(usize::try_from(code).ok()?)?,
        };
        (4800..=256_000).contains(&baud).then_some(baud)
    }
}

/// What parameters 87, 92, 93 and 94 hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputCode {
    /// One bit per output, OUT1 in bit 0 (the manual's table allows all 32 bits).
    Mask,
    /// Number of one output, 0 for none (a comment in published sources).
    Number,
}

impl OutputCode {
    /// The outputs that a parameter names, OUT1 in bit 0.
    pub fn outputs(self, parameter: u32) -> u32 {
        match self {
            Self::Mask => parameter,
            Self::Number => {
                let place = parameter.checked_sub(1);
                place.and_then(|place| 1_u32.checked_shl(place)).unwrap_or(0)
            }
        }
    }
}

/// Exception codes whose use the manual does not tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExceptionCodes {
    /// Outside the map, reserved, read only, or outside a recipe. Default 2.
    pub address: u8,
    /// Counts, coil values, axis masks, unknown commands, speeds of 0. Default 3.
    pub value: u8,
    /// Full command buffer, an axis that is busy with a move of the other kind, EEPROM failure. Default 4.
    pub failure: u8,
}

/// What is assumed where the manual is silent. The emulated board behaves by it, and the driver expects it where it
/// matters to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a question of its own, answered by yes or no"
)]
pub struct Assumptions {
    /// Segments that wait in the command buffer; the one that is carried out is not in it (§2). Default 64.
    pub buffer_segments: u16,
    /// Whether arguments absent from a command keep their last value; else they are 0 (§2). Default true.
    pub arguments_stay: bool,
    /// What coil 288 reads on a locked board; writing the opposite tries to unlock (§1). Default true.
    pub lock_coil: bool,
    /// Silence that ends a frame; none: what "MODBUS over serial line" asks for ([`Line::silence`]) (§1). Default none.
    pub silence: Option<Duration>,
    /// Registers that one frame reads at most (§1). Default 125, as Modbus has it.
    pub most_read: u16,
    /// Registers that one frame writes at most (§1). Default 123, as Modbus has it.
    pub most_written: u16,
    /// Parameter with the acceleration and deceleration of interpolated moves, 1000 steps/s² (§2). Default 4.
    pub segment_acceleration: u16,
    /// Parameter with the start and stop frequency of interpolated moves, steps/s (§2). Default 5.
    pub segment_start_stop: u16,
    /// Whether broadcasts (station 0) are carried out; they are never answered. If not, the driver sends none (§1).
    /// Default true.
    pub broadcasts: bool,
    /// Exception to motion commands and output writes on a locked board; none: they are answered as usual and do
    /// nothing. The driver says that the board is locked either way (§3). Default none.
    pub locked_exception: Option<u8>,
    /// Whether a motion command for an axis in a move of the other kind (independent, interpolated) is refused with
    /// [`ExceptionCodes::failure`]; else it is answered as usual and does nothing, and a move by hand looks before it sends one;
    /// a run has its board for itself and sends moves of one kind alone.
    /// Default true.
    pub busy_axis_refuses: bool,
    /// How axes stop when ENABLE is lost (§3). Default at once.
    pub enable_loss: BoardStop,
    /// Whether segments that wait when ENABLE is lost are carried out once the board is unlocked; the driver then
    /// empties the buffer (command 43) before it unlocks (§3). Default false: the buffer is emptied.
    pub enable_loss_keeps_segments: bool,
    /// How an axis stops that runs onto its limit switch. Default at once.
    pub limit_stop: BoardStop,
    /// How long B22 to B26 read 0 when a retargeted move reverses (firmware before 5.31), ns; 0: never. Default 0.
    pub reversal_gap_ns: i64,
    /// Whether command 71 homes its axes one after the other, X first; else all at once. Default false.
    pub home_one_by_one: bool,
    /// How parameter 101 says the speed (§4). Default raw.
    pub baud_code: BaudCode,
    /// Whether parameters 101 to 103 count from the next power-up on; else at once. Default true.
    pub line_at_restart: bool,
    /// What parameters 87, 92, 93, 94 hold. Default masks.
    pub output_code: OutputCode,
    /// Time that writing one register to the EEPROM takes, ns. Default 5 ms, as serial EEPROMs need for a page.
    pub eeprom_write_ns: i64,
    /// Whether a write to a failing EEPROM is also refused with [`ExceptionCodes::failure`]. Default true.
    pub eeprom_refuses: bool,
    /// Exception codes (§5). Default 2, 3, 4.
    pub exceptions: ExceptionCodes,
}

impl Default for Assumptions {
    fn default() -> Self {
        Self {
            buffer_segments: 64,
            arguments_stay: true,
            lock_coil: true,
            silence: None,
            most_read: 125,
            most_written: 123,
            segment_acceleration: parameters::DEFAULT_ACCELERATION,
            segment_start_stop: parameters::DEFAULT_START_STOP,
            broadcasts: true,
            locked_exception: None,
            busy_axis_refuses: true,
            enable_loss: BoardStop::AtOnce,
            enable_loss_keeps_segments: false,
            limit_stop: BoardStop::AtOnce,
            reversal_gap_ns: 0,
            home_one_by_one: false,
            baud_code: BaudCode::Raw,
            line_at_restart: true,
            output_code: OutputCode::Mask,
            eeprom_write_ns: 5_000_000,
            eeprom_refuses: true,
            exceptions: ExceptionCodes { address: 2, value: 3, failure: 4 },
        }
    }
}

impl Assumptions {
    /// Silence that ends a frame on a line.
    pub fn silence_on(&self, line: Line) -> Duration {
        self.silence.unwrap_or_else(|| line.silence())
    }
}

impl Parity {
    /// As parameter 102 says it: 0 none, 1 even, 2 odd (assumed).
    pub fn code(self) -> u32 {
        match self {
            Self::None => 0,
            Self::Even => 1,
            Self::Odd => 2,
        }
    }

    /// What parameter 102 says.
    pub fn from_code(code: u32) -> Option<Self> {
        [Self::None, Self::Even, Self::Odd].into_iter().find(|parity| parity.code() == code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_coded_three_ways() {
        for (code, parameter) in
            [(BaudCode::Raw, 19_200), (BaudCode::Hundreds, 192), (BaudCode::Index, 2)]
        {
            assert_eq!(code.encode(19_200), Some(parameter));
            assert_eq!(code.decode(parameter), Some(19_200));
        }
        assert_eq!(BaudCode::Raw.decode(300), None);
        assert_eq!(BaudCode::Index.decode(8), None);
        assert_eq!(BaudCode::Index.encode(12_345), None);
        assert_eq!(BaudCode::Hundreds.encode(12_345), None);
    }

    #[test]
    fn outputs_are_named_by_mask_or_number() {
        assert_eq!(OutputCode::Mask.outputs(0x8001), 0x8001);
        assert_eq!(OutputCode::Number.outputs(16), 0x8000);
        assert_eq!((OutputCode::Number.outputs(0), OutputCode::Number.outputs(33)), (0, 0));
    }
}
