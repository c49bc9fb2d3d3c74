//! Serial line of the board: speed, parity and the time that bytes take.

use std::{fmt, time::Duration};

/// Parity of the serial line; a board parameter (102).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Parity {
    /// No parity bit.
    #[default]
    None = 0,
    /// Even number of ones.
    Even = 1,
    /// Odd number of ones.
    Odd = 2,
}

impl fmt::Display for Parity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "no parity",
            Self::Even => "even parity",
            Self::Odd => "odd parity",
        })
    }
}

/// Serial line: 8 data bits and 1 stop bit always.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Bits per second; the firmware supports 4800 to 256000.
    pub baud: u32,
    /// Parity.
    pub parity: Parity,
}

impl Default for Line {
    /// 115200 baud without parity. The manual gives no defaults.
    fn default() -> Self {
        Self { baud: 115_200, parity: Parity::None }
    }
}

impl Line {
    /// Time that `bytes` take on the wire: 10 bits each, 11 with parity.
    pub fn duration(self, bytes: usize) -> Duration {
        let bits = if self.parity == Parity::None { 10 } else { 11 };
        let nanoseconds =
            u128::try_from(bytes).unwrap_or(u128::MAX).saturating_mul(bits * 1_000_000_000)
                / u128::from(self.baud.max(1));
        Duration::from_nanos(u64::try_from(nanoseconds).unwrap_or(u64::MAX))
    }

    /// Silence that ends a frame: 3.5 characters of 11 bits, and 1.75 ms from 19200 baud up ("MODBUS over serial
    /// line specification" 1.02, 2.5.1.1).
    pub fn silence(self) -> Duration {
        if self.baud >= 19_200 {
            Duration::from_micros(1750)
        } else {
            Duration::from_secs(77) / (2 * self.baud.max(1))
        }
    }
}

impl Parity {
    /// As parameter 102 says it: 0 none, 1 even, 2 odd (assumed).
    pub fn code(self) -> u32 {
        self as u32
    }

    /// Parity of a code of parameter 102.
    pub fn from_code(code: u32) -> Option<Self> {
        [Self::None, Self::Even, Self::Odd].into_iter().find(|parity| parity.code() == code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wire_times_are_those_of_the_line() {
        // drives-notes: 8N1 at 115200 baud is 86.8 µs per byte; with parity a byte has 11 bits.
        let line = Line::default();
        assert_eq!(line.duration(37).as_micros(), 3211);
        assert_eq!(
            Line { parity: Parity::Even, baud: 9600 }.duration(96),
            Duration::from_millis(110)
        );
        assert_eq!(line.silence(), Duration::from_micros(1750));
        // 3.5 characters of 11 bits at 9600 baud.
        assert_eq!(Line { baud: 9600, parity: Parity::None }.silence().as_micros(), 4010);
    }
}
