//! The RS485 line: speed, addresses and the time that bytes take.

use std::time::Duration;

/// Bits per second; the protocol knows no other speed ("Principes").
pub const BAUD: u32 = 115_200;
/// Addresses of drives ("Format des messages"); 0 speaks to all of them.
pub const ADDRESSES: std::ops::RangeInclusive<u8> = 1..=31;

/// Time that `bytes` take on the wire: 10 bits each, 8N1.
pub fn wire_time(bytes: usize) -> Duration {
    let bits = u64::try_from(bytes).unwrap_or(u64::MAX).saturating_mul(10);
    Duration::from_nanos(bits.saturating_mul(1_000_000_000) / u64::from(BAUD))
}

/// Instant at which a drive executes a command, between its last byte and the first of the answer. Not documented.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Execution {
    /// Somewhere between: the middle is never wrong by more than half of that time.
    #[default]
    Between,
    /// With its last byte.
    OnArrival,
    /// Just before it answers.
    BeforeAnswer,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wire_times_are_those_of_the_table() {
        // drives-notes: 86.8 µs per byte; GOTO v,a and its answer, 11 + 9 bytes, take 1.7 ms.
        assert_eq!(wire_time(1).as_nanos(), 86_805);
        assert_eq!(wire_time(20).as_micros(), 1736);
    }
}
