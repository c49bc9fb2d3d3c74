//! Modbus RTU frames as a slave sees them: check sum, lengths, exceptions.
//!
//! Source: "MODBUS over serial line specification" 1.02 (frame, check sum) and the board's manual, "Traitement des
//! erreurs et diagnostique" (what is answered and what is not).

use crate::Assumptions;

/// Length of the request that starts with these bytes, as far as they tell. `None` for functions whose length the
/// board does not know; silence ends those.
pub(super) fn request_length(bytes: &[u8]) -> Option<usize> {
    match bytes {
        [_, 1..=6, ..] => Some(8),
        [_, 15 | 16, _, _, _, _, count, ..] => Some(9 + usize::from(*count)),
        _ => None,
    }
}

/// Why a request is not carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It cannot be decoded: no answer.
    Silence,
    /// 1, "code de fonction invalide".
    Function,
    /// 2, "Adresse incorrecte".
    Address,
    /// 3, "Nombre d'adresses ou valeur incorrecte".
    Value,
    /// 4, "Erreur non déterminée".
    Failure,
    /// Locked, where that is said at all.
    Locked,
}

impl Refusal {
    /// The code of the answer, if there is one.
    pub(super) fn code(self, assumed: &Assumptions) -> Option<u8> {
        match self {
            Self::Silence => None,
            Self::Function => Some(1),
            Self::Address => Some(assumed.exceptions_address),
            Self::Value => Some(assumed.exceptions_value),
            Self::Failure => Some(assumed.exceptions_failure),
            Self::Locked => assumed.locked_exception,
        }
    }
}

/// One request, decoded; counts are checked against the protocol's limits, addresses not yet against the board's map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Request {
    /// 1.
    ReadCoils(Block),
    /// 2.
    ReadInputs(Block),
    /// 3.
    ReadHolding(Block),
    /// 4.
    ReadRegisters(Block),
    /// 5 and 15.
    WriteCoils(u16, Vec<bool>),
    /// 6 and 16.
    WriteHolding(u16, Vec<u16>),
}

/// Addresses of a read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) start: u16,
    pub(super) count: u16,
}

impl Block {
    /// The addresses, none of which exceeds 65535.
    pub(super) fn addresses(self) -> Result<std::ops::Range<u16>, Refusal> {
        let end = self.start.checked_add(self.count).ok_or(Refusal::Address)?;
        Ok(self.start..end)
    }
}

impl Request {
    /// Decodes function and data.
    pub(super) fn decode(function: u8, data: &[u8]) -> Result<Self, Refusal> {
        let word = |high: u8, low: u8| u16::from_be_bytes([high, low]);
        match (function, data) {
            (1..=4, &[a, b, c, d]) => {
                let block = Block { start: word(a, b), count: word(c, d) };
                let most = if function <= 2 { 2000 } else { 125 };
                if block.count == 0 || block.count > most {
                    return Err(Refusal::Value);
                }
                Ok(match function {
                    1 => Self::ReadCoils(block),
                    2 => Self::ReadInputs(block),
                    3 => Self::ReadHolding(block),
                    _ => Self::ReadRegisters(block),
                })
            }
            (5, &[a, b, c, d]) => match word(c, d) {
                0xFF00 => Ok(Self::WriteCoils(word(a, b), vec![true])),
                0x0000 => Ok(Self::WriteCoils(word(a, b), vec![false])),
                _ => Err(Refusal::Value),
            },
            (6, &[a, b, c, d]) => Ok(Self::WriteHolding(word(a, b), vec![word(c, d)])),
            (15, &[a, b, c, d, bytes, ref bits @ ..]) => {
                let count = word(c, d);
                let fits = (1..=1968).contains(&count)
                    && usize::from(bytes) == usize::from(count.div_ceil(8))
                    && bits.len() == usize::from(bytes);
                if !fits {
                    return Err(Refusal::Value);
                }
                let all = bits.iter().flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1 == 1));
                Ok(Self::WriteCoils(word(a, b), all.take(count.into()).collect()))
            }
            (16, &[a, b, c, d, bytes, ref values @ ..]) => {
                let count = word(c, d);
                let fits = (1..=123).contains(&count)
                    && u16::from(bytes) == 2 * count
                    && values.len() == usize::from(bytes);
                if !fits {
                    return Err(Refusal::Value);
                }
                let words = values
                    .chunks_exact(2)
                    .filter_map(|pair| pair.try_into().ok().map(u16::from_be_bytes));
                Ok(Self::WriteHolding(word(a, b), words.collect()))
            }
            (1..=6 | 15 | 16, _) => Err(Refusal::Silence),
            _ => Err(Refusal::Function),
        }
    }
}

/// Answer data of a bit read: byte count, bits with the lowest address in bit 0 of the first byte.
pub(super) fn bits_answer(bits: &[bool]) -> Vec<u8> {
    let bytes = bits.chunks(8).map(|eight| {
        eight.iter().enumerate().fold(0, |byte, (place, bit)| byte | u8::from(*bit) << place)
    });
    counted(bytes.collect())
}

/// Answer data of a register read: byte count, registers high byte first.
pub(super) fn registers_answer(registers: &[u16]) -> Vec<u8> {
    counted(registers.iter().flat_map(|register| register.to_be_bytes()).collect())
}

fn counted(mut bytes: Vec<u8>) -> Vec<u8> {
    // At most 250 (reads are limited to 125 registers or 2000 bits).
    bytes.insert(0, u8::try_from(bytes.len()).unwrap_or(u8::MAX));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_known_once_the_byte_count_is() {
        assert_eq!(request_length(&[1, 4]), Some(8));
        assert_eq!(request_length(&[1, 16, 0x10, 0, 0, 2]), None);
        assert_eq!(request_length(&[1, 16, 0x10, 0, 0, 2, 4]), Some(13));
        assert_eq!(request_length(&[1, 0x17, 0, 0]), None);
    }

    #[test]
    fn impossible_counts_and_values_are_refused() {
        let decode = Request::decode;
        assert_eq!(decode(4, &[4, 0, 0, 0]), Err(Refusal::Value));
        assert_eq!(decode(4, &[4, 0, 0, 126]), Err(Refusal::Value));
        assert_eq!(decode(1, &[1, 0, 0x07, 0xD1]), Err(Refusal::Value));
        assert_eq!(decode(5, &[1, 0, 0x00, 0xFF]), Err(Refusal::Value));
        assert_eq!(decode(15, &[1, 0, 0, 12, 1, 0xA5]), Err(Refusal::Value));
        assert_eq!(decode(16, &[0x10, 0, 0, 2, 4, 0, 66]), Err(Refusal::Value));
        assert_eq!(decode(16, &[0x10, 0, 0, 2, 2, 0, 66]), Err(Refusal::Value));
        assert_eq!(decode(0x17, &[]), Err(Refusal::Function));
        assert_eq!(decode(8, &[0, 0, 0, 0]), Err(Refusal::Function));
        assert_eq!(decode(3, &[0x10, 0, 0]), Err(Refusal::Silence));
        assert_eq!(decode(16, &[0x10, 0, 0, 1]), Err(Refusal::Silence));
    }

    #[test]
    fn bits_are_packed_from_the_lowest() {
        assert_eq!(
            bits_answer(&[true, false, true, false, false, false, false, false, true]),
            [2, 0b101, 1]
        );
        assert_eq!(
            Request::decode(15, &[1, 0, 0, 9, 2, 0b101, 1]),
            Ok(Request::WriteCoils(
                256,
                vec![true, false, true, false, false, false, false, false, true]
            ))
        );
    }
}
