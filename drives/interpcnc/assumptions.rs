//! Assumptions about the board where manual and published sources are silent.
//!
//! Paragraphs are those of the digest that the tests list (`drives/tests/assumptions.rs`).

use std::time::Duration;

use crate::{protocol::line::Line, protocol::parameters};
use twin_drives::assumptions::{Choice, FLAG, Microseconds, Number, OrNone, assumptions};

/// Stop of an axis that the board makes by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardStop {
    /// Without ramp.
    AtOnce,
    /// On the deceleration ramp of its move.
    OnRamp,
}

/// Coding of a speed in parameter 101.
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

/// Coding of outputs in parameters 87, 92, 93 and 94.
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

const STOP: Choice<BoardStop> =
    Choice(&[("at-once", BoardStop::AtOnce), ("on-ramp", BoardStop::OnRamp)]);
const BAUD: Choice<BaudCode> =
    Choice(&[("raw", BaudCode::Raw), ("hundreds", BaudCode::Hundreds), ("index", BaudCode::Index)]);
const CODE: Number<u8> = Number(1..=255, "(code)");
const TIME_NS: Number<i64> = Number(0..=10_000_000_000, "ns");

assumptions! {
    /// Assumptions where the manual is silent. The emulated device behaves by them, and the client expects them where it
    /// matters to it.
    pub struct Assumptions {
        buffer_segments: u16 = 64, Number(1..=1024, "segments"),
            (97, "How many segments wait in the buffer?",
                "fewer, more", "keeps two in the board");
        arguments_stay: bool = true, FLAG,
            (77, "What are arguments absent from a command?",
                "0", "always writes all of them");
        lock_coil: bool = true, FLAG,
            (23, "What does coil 288 read on a locked board?",
                "0 when locked", "does not read it");
        silence: Option<Duration> = None, OrNone(Microseconds(1..=1_000_000)),
            (11, "What silence ends a frame?",
                "any; none is that of Modbus over serial line", "keeps it between frames");
        most_read: u16 = 125, Number(1..=125, "registers"),
            (11, "How many registers does one frame read at most?",
                "fewer", "reads in several frames; asks for 12, those of one sample");
        most_written: u16 = 123, Number(1..=123, "registers"),
            (11, "How many registers does one frame write at most?",
                "fewer", "writes in several frames; asks for 14, those of one command");
        segment_acceleration: u16 = parameters::DEFAULT_ACCELERATION, Number(0..=383, "(number of a parameter)"),
            (97, "Which parameter has the acceleration of segments?",
                "any other", "compares it with what it plans by");
        segment_start_stop: u16 = parameters::DEFAULT_START_STOP, Number(0..=383, "(number of a parameter)"),
            (97, "Which parameter has their start frequency?",
                "any other", "compares it with what it plans by");
        broadcasts: bool = true, FLAG,
            (11, "Are broadcasts carried out?",
                "ignored", "sends none");
        locked_exception: Option<u8> = None, OrNone(CODE),
            (107, "What is a motion command to a locked board answered with?",
                "an exception", "says that the board is locked");
        busy_axis_refuses: bool = true, FLAG,
            (0, "What becomes of a move of an axis that is in a move of the other kind, independent or interpolated?",
                "it is answered as usual and does nothing", "looks before it sends one, and says that the axis moves");
        enable_loss: BoardStop = BoardStop::AtOnce, STOP,
            (107, "How do axes stop when ENABLE is lost?",
                "on their ramps", "sees them stop");
        enable_loss_keeps_segments: bool = false, FLAG,
            (107, "Are segments that wait then forgotten?",
                "carried out after unlocking", "empties the buffer before it unlocks");
        limit_stop: BoardStop = BoardStop::AtOnce, STOP,
            (0, "How does an axis stop that runs onto its limit switch?",
                "on its ramp", "sees it stop");
        reversal_gap_ns: i64 = 0, TIME_NS,
            (0, "How long is no motion shown when a move reverses?",
                "some time, before firmware 5.31", "looks several times");
        home_one_by_one: bool = false, FLAG,
            (0, "Does command 71 home its axes one by one?",
                "X first, then Y and so on", "waits for the end of all");
        baud_code: BaudCode = BaudCode::Raw, BAUD,
            (111, "How does parameter 101 say the speed?",
                "hundreds of b/s, an index", "reads and writes it so");
        line_at_restart: bool = true, FLAG,
            (0, "When do parameters 101 to 103 count?",
                "at once", "speaks as its own options say");
        output_code: OutputCode = OutputCode::Mask, Choice(&[("mask", OutputCode::Mask), ("number", OutputCode::Number)]),
            (0, "What do parameters 87, 92, 93 and 94 hold?",
                "the number of an output", "hands the number on");
        eeprom_write_ns: i64 = 5_000_000, TIME_NS,
            (0, "How long does writing a register to the EEPROM take?",
                "any time", "waits longer");
        eeprom_refuses: bool = true, FLAG,
            (0, "Is a write to a broken EEPROM refused?",
                "accepted, and B15 tells", "looks at both");
        exceptions_address: u8 = 2, CODE,
            (113, "With what is a word outside a recipe refused?",
                "any codes", "says the code");
        exceptions_value: u8 = 3, CODE,
            (117, "With what is an impossible value refused?",
                "any codes", "says the code");
        exceptions_failure: u8 = 4, CODE,
            (97, "With what is a segment for a full buffer refused?",
                "any codes", "tells an EEPROM failure by its code, others as they are");
    }
    others {
        "BoardOptions.address" = "1",
            (7, "Which address has a board that nobody has set?",
                "1 to 247", "InterpCncOptions.address");
        "BoardOptions.line" = "Line { baud: 115200, parity: None }",
            (7, "At which speed and parity?",
                "4800 to 256000 b/s, even, odd", "InterpCncOptions.line");
        "InterpCncOptions.address" = "1",
            (7, "Which address does the client speak to?",
                "1 to 247", "speaks to it");
        "InterpCncOptions.line" = "Line { baud: 115200, parity: None }",
            (7, "At which speed and parity does the driver speak?",
                "4800 to 256000 b/s, even, odd", "opens the port so");
    }
}

impl Assumptions {
    /// Silence that ends a frame on a line.
    pub fn silence_on(&self, line: Line) -> Duration {
        self.silence.unwrap_or_else(|| line.silence())
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
