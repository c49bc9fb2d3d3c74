//! Zones of twelve bytes that host and module exchange (manual 2, 9.1).

use super::memory::ByteOrder;
use crate::{AXES, ModuleAxis};

/// Bytes of a zone.
pub const ZONE_LENGTH: usize = 12;
/// A zone as it lies in the memory.
pub type ZoneBytes = [u8; ZONE_LENGTH];

/// Zones that the host writes, page 7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteZone {
    /// Orders for both axes.
    Orders = 0,
    /// Target and speed of axis 1.
    Position1 = 1,
    /// Target and speed of axis 2.
    Position2 = 2,
    /// Parameters.
    Parameter = 3,
}

impl WriteZone {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 4] = [Self::Orders, Self::Position1, Self::Position2, Self::Parameter];

    /// Number of the zone.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// The zone of a number.
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// The zone of an axis' target and speed.
    pub fn of_axis(axis: ModuleAxis) -> Self {
        match axis {
            ModuleAxis::One => Self::Position1,
            ModuleAxis::Two => Self::Position2,
        }
    }

    /// Offset of its first byte on page 7.
    pub fn offset(self) -> u8 {
        0x02 + 12 * self.number()
    }

    /// Name in the manual.
    pub fn name(self) -> &'static str {
        match self {
            Self::Orders => "Ordre UC",
            Self::Position1 => "Position 1",
            Self::Position2 => "Position 2",
            Self::Parameter => "Paramètre",
        }
    }
}

/// Zones that the module writes, page 6.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadZone {
    /// Theoretical positions and axis messages.
    Positions = 0,
    /// Acknowledgements.
    Acknowledgements = 1,
    /// Answers to parameter orders, card messages.
    Parameter = 2,
    /// Encoder positions in points.
    EncoderPoints = 3,
    /// Encoder positions in steps.
    EncoderSteps = 4,
    /// Plugs.
    Plugs = 5,
}

impl ReadZone {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 6] = [
        Self::Positions,
        Self::Acknowledgements,
        Self::Parameter,
        Self::EncoderPoints,
        Self::EncoderSteps,
        Self::Plugs,
    ];

    /// Number of the zone.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// The zone of a number.
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Offset of its first byte on page 6.
    pub fn offset(self) -> u8 {
        0x02 + 12 * self.number()
    }

    /// Name in the manual.
    pub fn name(self) -> &'static str {
        match self {
            Self::Positions => "Position",
            Self::Acknowledgements => "Acquittement",
            Self::Parameter => "Paramètre",
            Self::EncoderPoints => "Codeur en points",
            Self::EncoderSteps => "Codeur en pas",
            Self::Plugs => "Bouchons",
        }
    }
}

/// Two words and two longs, the shape of zone "Ordre UC" and of its acknowledgement.
fn words_longs(bytes: &ZoneBytes, order: ByteOrder) -> ([u16; AXES], [u32; AXES]) {
    let [a, b, c, d, e, f, g, h, i, j, k, l] = *bytes;
    ([order.word([a, b]), order.word([c, d])], [order.long([e, f, g, h]), order.long([i, j, k, l])])
}

fn from_words_longs(words: [u16; AXES], longs: [u32; AXES], order: ByteOrder) -> ZoneBytes {
    let ([[a, b], [c, d]], [[e, f, g, h], [i, j, k, l]]) =
        (words.map(|word| order.word_bytes(word)), longs.map(|long| order.long_bytes(long)));
    [a, b, c, d, e, f, g, h, i, j, k, l]
}

/// Two longs and two words, the shape of the zones with positions.
fn longs_words(bytes: &ZoneBytes, order: ByteOrder) -> ([u32; AXES], [u16; AXES]) {
    let [a, b, c, d, e, f, g, h, i, j, k, l] = *bytes;
    ([order.long([a, b, c, d]), order.long([e, f, g, h])], [order.word([i, j]), order.word([k, l])])
}

fn from_longs_words(longs: [u32; AXES], words: [u16; AXES], order: ByteOrder) -> ZoneBytes {
    let ([[a, b, c, d], [e, f, g, h]], [[i, j], [k, l]]) =
        (longs.map(|long| order.long_bytes(long)), words.map(|word| order.word_bytes(word)));
    [a, b, c, d, e, f, g, h, i, j, k, l]
}

/// Zone "Ordre UC" of the host, and zone "Acquittement" of the module (2.1.1, 2.2.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Orders {
    /// Orders UC of axes 1 and 2: [`super::bits::uc`].
    pub uc: [u16; AXES],
    /// Orders bloc: [`super::bits::bloc`].
    pub bloc: [u32; AXES],
}

impl Orders {
    /// As it lies in the memory.
    pub fn encode(&self, order: ByteOrder) -> ZoneBytes {
        from_words_longs(self.uc, self.bloc, order)
    }

    /// From the memory.
    pub fn decode(bytes: &ZoneBytes, order: ByteOrder) -> Self {
        let (uc, bloc) = words_longs(bytes, order);
        Self { uc, bloc }
    }
}

/// Zone "Position 1" or "Position 2" (2.1.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Target {
    /// "Cote à atteindre", µsteps, ±4194303.
    pub position: i32,
    /// "Vitesse programmée", unit of the drive mode.
    pub speed: u16,
}

impl Target {
    /// As it lies in the memory.
    pub fn encode(&self, order: ByteOrder) -> ZoneBytes {
        let [a, b, c, d] = order.long_bytes(self.position.cast_unsigned());
        let [e, f] = order.word_bytes(self.speed);
        [a, b, c, d, e, f, 0, 0, 0, 0, 0, 0]
    }

    /// From the memory.
    pub fn decode(bytes: &ZoneBytes, order: ByteOrder) -> Self {
        let [a, b, c, d, e, f, ..] = *bytes;
        Self { position: order.long([a, b, c, d]).cast_signed(), speed: order.word([e, f]) }
    }
}

/// Zone "Paramètre": what the host asks for and what the module answers (2.1.3, 2.2.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ParameterExchange {
    /// Parameter order: [`super::parameter::order`].
    pub order: u16,
    /// Number of the parameter, or plugs.
    pub number: u16,
    /// Value.
    pub value: u32,
    /// Answer only: [`super::bits::card`].
    pub messages: u32,
}

impl ParameterExchange {
    /// As it lies in the memory.
    pub fn encode(&self, order: ByteOrder) -> ZoneBytes {
        from_words_longs([self.order, self.number], [self.value, self.messages], order)
    }

    /// From the memory.
    pub fn decode(bytes: &ZoneBytes, byte_order: ByteOrder) -> Self {
        let ([order, number], [value, messages]) = words_longs(bytes, byte_order);
        Self { order, number, value, messages }
    }
}

/// Zones "Position", "Codeur en points" and "Codeur en pas" of the module (2.2.1, 2.2.4, 2.2.5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Positions {
    /// Positions of axes 1 and 2: µsteps, or points of the encoder.
    pub positions: [i32; AXES],
    /// [`super::bits::message`] or [`super::bits::encoder_message`].
    pub messages: [u16; AXES],
}

impl Positions {
    /// As it lies in the memory.
    pub fn encode(&self, order: ByteOrder) -> ZoneBytes {
        from_longs_words(self.positions.map(i32::cast_unsigned), self.messages, order)
    }

    /// From the memory.
    pub fn decode(bytes: &ZoneBytes, order: ByteOrder) -> Self {
        let (positions, messages) = longs_words(bytes, order);
        Self { positions: positions.map(u32::cast_signed), messages }
    }
}

/// Zone "Bouchons" of the module (2.2.6). Plug 2 is at $42; the manual's $40 overlaps plug 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plugs {
    /// Values of plugs 1 and 2; none if absent or badly programmed ($FFFFFFFF).
    pub values: [Option<u32>; AXES],
}

impl Plugs {
    /// As it lies in the memory.
    pub fn encode(&self, order: ByteOrder) -> ZoneBytes {
        from_longs_words(self.values.map(|value| value.unwrap_or(u32::MAX)), [0; AXES], order)
    }

    /// From the memory.
    pub fn decode(bytes: &ZoneBytes, order: ByteOrder) -> Self {
        let (values, _) = longs_words(bytes, order);
        Self { values: values.map(|value| (value != u32::MAX).then_some(value)) }
    }
}
