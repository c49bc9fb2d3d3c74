//! Bytes that have come and are not yet carried out.

use std::time::Duration;

use crate::ramp::whole_ns;

/// Longer than any request: what exceeds it is noise, which silence ends.
const MOST_BYTES: usize = 512;

/// Bytes that have come and are not yet carried out.
#[derive(Debug, Default)]
pub(super) struct Received {
    pub(super) bytes: Vec<u8>,
    /// Arrival of the first byte, ns.
    since_ns: i64,
    /// Arrival of the last byte, ns.
    until_ns: i64,
}

impl Received {
    pub(super) fn add(&mut self, bytes: &[u8], now_ns: i64) {
        if self.bytes.is_empty() {
            self.since_ns = now_ns;
        }
        self.until_ns = now_ns;
        let room = MOST_BYTES.saturating_sub(self.bytes.len());
        self.bytes.extend(bytes.iter().take(room));
    }

    /// When silence has ended what has come, ns.
    pub(super) fn silent_ns(&self, silence: Duration) -> i64 {
        self.until_ns.saturating_add(whole_ns(silence))
    }

    /// The first `length` bytes, or all, and when they came. What is left came with the last of them.
    pub(super) fn take(&mut self, length: usize) -> (Vec<u8>, i64, i64) {
        let rest = self.bytes.split_off(length.min(self.bytes.len()));
        let frame = std::mem::replace(&mut self.bytes, rest);
        let since_ns = std::mem::replace(&mut self.since_ns, self.until_ns);
        (frame, since_ns, self.until_ns)
    }
}
