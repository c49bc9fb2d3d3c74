//! Assumptions about the board where manual and published sources are silent.
//!
//! Paragraphs are those of the digest that the tests list (`drives/tests/assumptions.rs`).

use std::time::Duration;

use crate::{protocol::line::Line, protocol::parameters};
use twin_drives::assumptions::{Choice, FLAG, Microseconds, Number, OrNone, assumptions};

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

const BAUD: Choice<BaudCode> =
    Choice(&[("raw", BaudCode::Raw), ("hundreds", BaudCode::Hundreds), ("index", BaudCode::Index)]);
const CODE: Number<u8> = Number(1..=255, "(code)");
const TIME_NS: Number<i64> = Number(0..=10_000_000_000, "ns");

assumptions! {
    /// Assumptions where the manual is silent. The emulated device behaves by them, and the client expects them where it
    /// matters to it.
    pub struct Assumptions {
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
        enable_loss_keeps_segments: bool = false, FLAG,
            (107, "Are segments that wait then forgotten?",
                "carried out after unlocking", "empties the buffer before it unlocks");
        baud_code: BaudCode = BaudCode::Raw, BAUD,
            (111, "How does parameter 101 say the speed?",
                "hundreds of b/s, an index", "reads and writes it so");
        line_at_restart: bool = true, FLAG,
            (0, "When do parameters 101 to 103 count?",
                "at once", "speaks as its own options say");
        eeprom_write_ns: i64 = 5_000_000, TIME_NS,
            (0, "How long does writing a register to the EEPROM take?",
                "any time", "waits longer");
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
}
