//! Fuzz target: frames and memory of each drive family. The first byte selects the family; the rest is decoded and
//! encoded again, and is what a master says to the emulated device. For the masters of serial lines it is the faults of
//! the answers to them.

#![no_main]

#[path = "wire/bim2ax.rs"]
mod bim2ax;
#[path = "wire/interpcnc.rs"]
mod interpcnc;
#[path = "wire/master.rs"]
mod master;
#[path = "wire/smartdrive.rs"]
mod smartdrive;

use libfuzzer_sys::{Corpus, fuzz_target};

/// Requests to one device at most.
const REQUESTS: usize = 200;

fuzz_target!(|bytes: &[u8]| -> Corpus {
    match bytes.split_first() {
        Some((b'i', bytes)) => interpcnc::check(bytes),
        Some((b's', bytes)) => smartdrive::check(bytes),
        Some((b'b', bytes)) => bim2ax::check(bytes),
        Some((b'I', faults)) => master::interpcnc(faults),
        Some((b'S', faults)) => master::smartdrive(faults),
        _ => return Corpus::Reject,
    }
    Corpus::Keep
});

/// Requests of `bytes`: pause before it in ms, length, and that many bytes.
fn requests(mut bytes: &[u8]) -> impl Iterator<Item = (i64, &[u8])> {
    let next = move || {
        let [pause, length, rest @ ..] = bytes else { return None };
        let (request, rest) = rest.split_at(rest.len().min(usize::from(*length)));
        bytes = rest;
        // 0 to 4 s.
        Some((i64::from(*pause).pow(2) * 62_500, request))
    };
    std::iter::from_fn(next).take(REQUESTS)
}
