//! Frames: command and answer as bytes.
//!
//! Source: "Format des messages".

use crate::{Command, RejectCode, Status};

/// Length of an answer with four bytes of data.
pub const ANSWER_BYTES: usize = 9;
/// First bytes of commands are below this (the three upper bits of ADR are 0).
pub const FIRST_BITS: u8 = 0x20;

/// Length of the data of an answer: the column RR of the table of commands, which the manual does not explain.
///
/// The manual draws answers of nine bytes and all entries of RR are 0, but the check sum of an answer goes over
/// `RSP_DAT_LEN` bytes of data, as that of a command over `CMD_DAT_LEN` = 4·2^EE.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnswerLength {
    /// RR is the exponent of the answer, `RSP_DAT_LEN` = 4·2^RR: four bytes.
    Four,
    /// RR is none, and the answer has as many bytes of data as its command, 4·2^EE: what is drawn comes first, zeros
    /// follow up to TAG.
    AsCommand,
}

/// XOR of bytes; that of a whole frame is 0.
pub fn check_sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

/// The frame of a command to `address` (0: all devices).
pub fn encode(address: u8, command: &Command) -> Vec<u8> {
    seal([vec![address, command.code()], command.data()].concat())
}

/// A frame with its check sum.
pub(crate) fn seal(mut frame: Vec<u8>) -> Vec<u8> {
    frame.push(check_sum(&frame));
    frame
}

/// Length of the command that begins with these bytes: 3 + 4·2^EE; `None` before CMD is there.
pub fn command_length(bytes: &[u8]) -> Option<usize> {
    bytes.get(1).map(|code| 3 + (4 << (code >> 6)))
}

/// Length of the answer to the command that begins with these bytes.
pub(crate) fn answer_length(command: &[u8], assumed: AnswerLength) -> usize {
    match assumed {
        AnswerLength::Four => ANSWER_BYTES,
        // STA and TAG instead of ADR and CMD.
        AnswerLength::AsCommand => {
            command_length(command).map_or(ANSWER_BYTES, |length| length + 2)
        }
    }
}

/// Address and command of a frame, and what a device refuses it for; `None` if length, check sum or address are those
/// of no command.
pub fn decode(frame: &[u8]) -> Option<(u8, Result<Command, RejectCode>)> {
    let right = command_length(frame) == Some(frame.len()) && check_sum(frame) == 0;
    let [address, code, data @ .., _] = frame else { return None };
    (right && *address < FIRST_BITS).then(|| (*address, Command::decode(*code, data)))
}

/// Whether a command has data of a length that does not belong to its code.
pub(crate) fn has_wrong_length(frame: &[u8]) -> bool {
    let [_, code, data @ .., _] = frame else { return false };
    Command::lengths(*code).is_some_and(|lengths| !lengths.contains(&data.len()))
}

/// An answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    /// STA.
    pub status: Status,
    /// DAT.
    pub data: [u8; 4],
    /// TAG.
    pub tag: u16,
}

impl Answer {
    /// DAT as a signed number: a position, a variable.
    pub fn number(&self) -> i32 {
        i32::from_le_bytes(self.data)
    }

    /// DAT as two words, LSW and MSW: saved and working value of a parameter.
    pub fn words(&self) -> (u16, u16) {
        let [a, b, c, d] = self.data;
        (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]))
    }

    /// The frame.
    pub fn encode(&self) -> [u8; ANSWER_BYTES] {
        let ([s0, s1], [t0, t1]) = (self.status.0.to_le_bytes(), self.tag.to_le_bytes());
        let [b0, b1, b2, b3] = self.data;
        let sum = check_sum(&[s0, s1, b0, b1, b2, b3, t0, t1]);
        [s0, s1, b0, b1, b2, b3, t0, t1, sum]
    }

    /// The frame with zeros behind the data, `length` bytes in all. They leave the check sum as it is.
    pub(crate) fn encode_in(self, length: usize) -> Vec<u8> {
        let mut frame = self.encode().to_vec();
        let zeros = length.saturating_sub(ANSWER_BYTES);
        frame.splice(6..6, std::iter::repeat_n(0, zeros));
        frame
    }

    /// The answer in nine bytes or more, whose further data say nothing; `None` as [`Self::decode`].
    pub(crate) fn decode_in(frame: &[u8]) -> Option<Self> {
        let [s0, s1, b0, b1, b2, b3, .., t0, t1, _] = *frame else { return None };
        let status = Status(u16::from_le_bytes([s0, s1]));
        let right = check_sum(frame) == 0 && status.is_response();
        right.then_some(Self { status, data: [b0, b1, b2, b3], tag: u16::from_le_bytes([t0, t1]) })
    }

    /// The answer in nine bytes; `None` if their check sum is wrong or the first byte is not that of an answer.
    pub fn decode(frame: &[u8; ANSWER_BYTES]) -> Option<Self> {
        Self::decode_in(frame)
    }
}

#[cfg(test)]
pub(crate) mod tests;
