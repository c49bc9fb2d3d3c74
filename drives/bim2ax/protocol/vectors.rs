//! The 29 exchanges of the digest of the manual's examples, byte by byte (big-endian), and a way to play and to record
//! them.
//!
//! `offset←bytes` is written, `offset→bytes` is read. They were packed by a program of its own from the figures in the
//! manual, not by this crate.

use std::{
    io,
    sync::{Arc, Mutex},
};

use super::memory::Memory;

/// Number, what it is, accesses.
pub(crate) const VECTORS: [(usize, &str, &str); 29] = [
    (
        1,
        "read zone 1 (Acquittement)",
        "FD←07 ; 00←F1 ; 01←01 ; 70..73←00 00 00 00 ; 7F←01 ; FD←06 ; 00→01 ; 0E..19→",
    ),
    (
        2,
        "4.2.1 read param $0A",
        "FD←07 ; 00←32 ; 26..31←20 00 00 0A 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        3,
        "… page 6 zone 2 reply, value $07D0 (messages carte $06 = both axes present: C)",
        "1A..25→20 00 00 0A 00 00 07 D0 00 00 00 06",
    ),
    (
        4,
        "4.2.1 write param $06 := $C8",
        "FD←07 ; 00←32 ; 26..31←10 00 00 06 00 00 00 C8 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        5,
        "5.1.1 homing axis 2",
        "FD←07 ; 00←01 ; 02..0D←00 00 00 01 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (6, "… zone 0 while homing (positions 0)", "02..0D→00 00 00 00 00 00 00 00 00 00 00 20"),
    (7, "… zone 0 when done", "02..0D→00 00 00 00 00 00 00 00 00 00 00 10"),
    (
        8,
        "5.2.1 manual + axis 2",
        "FD←07 ; 00←01 ; 02..0D←00 00 00 10 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (9, "… stop", "FD←07 ; 00←01 ; 02..0D←00 00 00 00 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01"),
    (
        10,
        "5.3.1 to + limit, axis 1",
        "FD←07 ; 00←01 ; 02..0D←00 40 00 00 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        11,
        "6.1.1 reference position 5, axis 2",
        "FD←07 ; 00←01 ; 02..0D←00 00 00 02 00 00 00 00 00 00 00 05 ; 01←01 ; 7F←01",
    ),
    (12, "… zone 1 at end", "0E..19→00 00 00 00 00 00 00 00 00 00 00 05"),
    (
        13,
        "6.2.1 zero axis 2",
        "FD←07 ; 00←01 ; 02..0D←00 00 00 02 00 00 00 00 00 00 00 10 ; 01←01 ; 7F←01",
    ),
    (
        14,
        "6.3.1 recall last position, axis 2",
        "FD←07 ; 00←01 ; 02..0D←00 00 00 02 00 00 00 00 00 00 00 20 ; 01←01 ; 7F←01",
    ),
    (
        15,
        "preset axis 1 := 12345 — first Position 1",
        "FD←07 ; 00←10 ; 0E..19←00 00 30 39 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        16,
        "… then order (bloc bits 5+7 = $A0)",
        "FD←07 ; 00←01 ; 02..0D←00 02 00 00 00 00 00 A0 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        17,
        "6.4.1 absolute 2000 axis 2 — first Position 2",
        "FD←07 ; 00←20 ; 1A..25←00 00 07 D0 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        18,
        "… then order",
        "FD←07 ; 00←01 ; 02..0D←00 00 00 02 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        19,
        "6.4.1 relative 400 @200, axis 2 — Position 2 ($01F4 legacy acceleration omitted)",
        "FD←07 ; 00←20 ; 1A..25←00 00 01 90 00 C8 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        20,
        "… order, corrected $140 (printed $340)",
        "FD←07 ; 00←01 ; 02..0D←00 00 00 02 00 00 00 00 00 00 01 40 ; 01←01 ; 7F←01",
    ),
    (
        21,
        "6.4.1 both axes — Position 1",
        "FD←07 ; 00←10 ; 0E..19←00 00 01 90 00 C8 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        22,
        "… Position 2",
        "FD←07 ; 00←20 ; 1A..25←00 00 03 20 00 64 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (23, "… order", "FD←07 ; 00←01 ; 02..0D←00 02 00 02 00 00 01 40 00 00 01 40 ; 01←01 ; 7F←01"),
    (
        24,
        "9.2.3.2 zones 2 then 0 in one interrupt (≥ v15), data = absolute 2000 axis 2",
        "FD←07 ; 00←F0 ; 1A..25←00 00 07 D0 00 00 00 00 00 00 00 00 ; 02..0D←00 00 00 02 00 00 00 00 00 00 00 00 ; 70..73←72 70 00 00 ; 01←01 ; 7F←01",
    ),
    (25, "9.2.4 receipt flag for Ordre UC", "FD←06 ; 70←01"),
    (
        26,
        "hard stop both axes",
        "FD←07 ; 00←01 ; 02..0D←01 00 01 00 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        27,
        "RESET $8000",
        "FD←07 ; 00←32 ; 26..31←80 00 00 00 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        28,
        "2.2.6 read plug 2",
        "FD←07 ; 00←32 ; 26..31←40 00 00 02 00 00 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
    (
        29,
        "negative target −4194303, axis 1",
        "FD←07 ; 00←10 ; 0E..19←FF C0 00 01 FF FF 00 00 00 00 00 00 ; 01←01 ; 7F←01",
    ),
];

/// Accesses of a vector as they are recorded.
pub(crate) fn vector(number: usize) -> Vec<String> {
    let (_, _, accesses) = VECTORS[number - 1];
    accesses.split(" ; ").map(str::to_owned).collect()
}

/// Bytes of the only access of a vector.
pub(crate) fn answer(number: usize) -> Vec<u8> {
    let accesses = vector(number);
    let (_, bytes) = accesses.first().unwrap().split_once('→').unwrap();
    hexadecimal(bytes)
}

fn hexadecimal(text: &str) -> Vec<u8> {
    text.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

/// Plays what a vector writes.
pub(crate) fn play(number: usize, memory: &mut dyn Memory) {
    for access in vector(number) {
        if let Some((place, bytes)) = access.split_once('←') {
            let offset = u8::from_str_radix(&place[..2], 16).unwrap();
            memory.write(offset, &hexadecimal(bytes)).unwrap();
        }
    }
}

/// Accesses so far, in the notation of the vectors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Log(Arc<Mutex<Vec<String>>>);

impl Log {
    fn note(&self, offset: u8, arrow: char, bytes: &[u8]) {
        let place = if bytes.len() == 1 {
            format!("{offset:02X}")
        } else {
            format!("{offset:02X}..{:02X}", usize::from(offset) + bytes.len() - 1)
        };
        let bytes: Vec<String> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
        self.0.lock().unwrap().push(format!("{place}{arrow}{}", bytes.join(" ")));
    }

    /// Takes what has been recorded.
    pub(crate) fn take(&self) -> Vec<String> {
        std::mem::take(&mut self.0.lock().unwrap())
    }
}

/// A memory whose accesses are recorded.
pub(crate) struct Recorded<M>(pub(crate) M, pub(crate) Log);

impl<M: Memory> Memory for Recorded<M> {
    fn read(&mut self, offset: u8, bytes: &mut [u8]) -> io::Result<()> {
        self.0.read(offset, bytes)?;
        self.1.note(offset, '→', bytes);
        Ok(())
    }

    fn write(&mut self, offset: u8, bytes: &[u8]) -> io::Result<()> {
        self.1.note(offset, '←', bytes);
        self.0.write(offset, bytes)
    }
}
