//! The answer among the bytes that come.

use crate::protocol::frame::{Answer, FIRST_BITS};
use twin_drives::ProtocolFault;

/// Looks for the answer among the bytes that come.
pub(crate) struct Search<'a> {
    /// The command, which an adapter may echo.
    command: &'a [u8],
    address: u8,
    /// Bytes of the answer.
    pub(crate) length: usize,
    bytes: Vec<u8>,
    /// The echo has come and gone.
    echoed: bool,
    garbled: bool,
    foreign: bool,
    /// Bytes thrown away as noise.
    skipped: usize,
}

impl<'a> Search<'a> {
    pub(crate) fn new(command: &'a [u8], address: u8, length: usize) -> Self {
        Self {
            command,
            address,
            length,
            bytes: Vec::new(),
            echoed: false,
            garbled: false,
            foreign: false,
            skipped: 0,
        }
    }

    /// Takes more bytes; the answer, if it is among them.
    ///
    /// The first byte of a command is below 20h, that of an answer 80h at least. What begins as the command did is its
    /// echo; whatever else begins below 80h is noise, and so is what is as long as an answer and that of nobody.
    pub(crate) fn take(&mut self, more: &[u8]) -> Option<Answer> {
        self.bytes.extend(more);
        loop {
            let first = *self.bytes.first()?;
            let starts = |bytes: &[u8]| {
                bytes.iter().zip(self.command).all(|(byte, expected)| byte == expected)
            };
            if first < FIRST_BITS && !self.echoed && starts(&self.bytes) {
                if self.bytes.len() < self.command.len() {
                    return None;
                }
                self.bytes.drain(..self.command.len());
                self.echoed = true;
                continue;
            }
            if first < 0x80 {
                self.bytes.remove(0);
                self.skipped += 1;
                self.garbled = true;
                continue;
            }
            let frame = self.bytes.get(..self.length)?;
            match Answer::decode_in(frame) {
                Some(answer)
                    if answer.status.address() == self.address
                        && self.bytes.len() == self.length =>
                {
                    self.bytes.clear();
                    return Some(answer);
                }
                // Nothing follows an answer: the XOR of nine bytes out of one that comes twice, or of a beginning and
                // the answer it was repeated in, is 0 as well.
                other => {
                    self.bytes.remove(0);
                    self.skipped += 1;
                    let foreign =
                        other.is_some_and(|answer| answer.status.address() != self.address);
                    self.foreign |= foreign;
                    self.garbled |= !foreign;
                }
            }
        }
    }

    /// Whether as many bytes as an answer has have come that are none, of this drive or another.
    pub(crate) fn is_spoilt(&self) -> bool {
        // What begins as the command did may become its echo.
        let echoes = self.bytes.first().is_some_and(|first| *first < FIRST_BITS);
        !self.foreign && !echoes && self.skipped + self.bytes.len() >= self.length
    }

    /// Whether bytes came that belong to nothing.
    pub(crate) fn is_noisy(&self) -> bool {
        self.garbled || self.foreign || !self.bytes.is_empty()
    }

    /// Whether an answer may have been among what belongs to nothing.
    pub(crate) fn hides_answers(&self) -> bool {
        self.skipped >= self.length
    }

    /// What is wrong with what has come instead of an answer.
    pub(crate) fn fault(&self) -> Option<ProtocolFault> {
        if self.foreign {
            Some(ProtocolFault::Station)
        } else if self.garbled || !self.bytes.is_empty() {
            Some(ProtocolFault::Garbled)
        } else {
            None
        }
    }
}
