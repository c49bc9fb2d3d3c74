//! The encoder of an axis: what it counts, how that is read, and what goes wrong with it.

use crate::protocol::bits::{definition, encoder_message};

/// Kind of encoder, as the inputs on terminals 2 and 13 tell it (2.2.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncoderKind {
    /// Neither input.
    Incremental,
    /// Terminal 2.
    Ssi,
    /// Terminal 13.
    EnDat,
}

/// An encoder on the shaft of an emulated axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "independent facts, each on or off")]
pub struct EncoderBench {
    /// Its kind; none if both inputs are on, as with no encoder.
    pub kind: Option<EncoderKind>,
    /// Points per turn: lines × 4 of an incremental encoder.
    pub points_per_turn: u32,
    /// µsteps of the shaft per turn.
    pub microsteps_per_turn: u32,
    /// It counts down where the shaft counts up.
    pub inverted: bool,
    /// Points that an absolute encoder shows with the shaft at 0.
    pub origin: i64,
    /// An absolute encoder's bits.
    pub bits: u8,
    /// An SSI encoder speaks Gray code.
    pub gray: bool,
    /// An SSI encoder sends parity.
    pub parity: bool,
    /// An incremental encoder has the complements of A and B.
    pub complemented: bool,
    /// It does not answer, or a channel is missing.
    pub disconnected: bool,
    /// An EnDat encoder's alarm bit.
    pub alarm: bool,
}

impl Default for EncoderBench {
    /// An incremental encoder of 2000 points on a motor of 200 µsteps per turn, as in the manual's examples (6.4.1).
    fn default() -> Self {
        Self {
            kind: Some(EncoderKind::Incremental),
            points_per_turn: 2000,
            microsteps_per_turn: 200,
            inverted: false,
            origin: 0,
            bits: 24,
            gray: false,
            parity: false,
            complemented: true,
            disconnected: false,
            alarm: false,
        }
    }
}

/// The encoder as the module reads it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Encoder {
    bench: Option<EncoderBench>,
    /// Recognised at RESET and declared.
    kind: Option<EncoderKind>,
    definition: u16,
    dividend: u16,
    divisor: u16,
    bits: u8,
    /// Added to what the encoder shows, points: parameter "décalage" of an absolute one, count of an incremental one.
    offset: i64,
    /// Latched until RESET.
    fault: bool,
}

impl Encoder {
    /// The encoder after RESET with the parameters $2C, $2E, $30, $34 and $36 (of axis 1).
    pub(crate) fn reset(
        bench: Option<EncoderBench>,
        dividend: u16,
        divisor: u16,
        offset: i32,
        bits: u8,
        definition: u16,
    ) -> Self {
        let declared = definition & definition::PRESENT != 0;
        let kind = bench.and_then(|bench| bench.kind).filter(|_| declared);
        let offset = if kind == Some(EncoderKind::Incremental) { 0 } else { offset.into() };
        let mut encoder =
            Self { bench, kind, definition, dividend, divisor, bits, offset, fault: false };
        encoder.watch();
        encoder
    }

    /// Changes the encoder itself. Its kind is only looked at on RESET.
    pub(crate) fn set_bench(&mut self, bench: Option<EncoderBench>) {
        self.bench = bench;
        self.watch();
    }

    /// The kind recognised and declared.
    pub(crate) fn kind(&self) -> Option<EncoderKind> {
        self.kind
    }

    /// Latches a fault that can be seen.
    fn watch(&mut self) {
        let Some(kind) = self.kind else { return };
        let Some(bench) = &self.bench else {
            self.fault = true;
            return;
        };
        let single_ended = self.definition & definition::SINGLE_ENDED != 0;
        let parity = self.definition & definition::PARITY != 0;
        self.fault |= bench.disconnected
            || kind == EncoderKind::Incremental && !bench.complemented && !single_ended
            || kind == EncoderKind::Ssi && bench.parity != parity;
    }

    /// Points that the encoder shows, before the offset.
    fn shown(&self, shaft: i64) -> i64 {
        let Some(bench) = &self.bench else { return 0 };
        let turn = i64::from(bench.microsteps_per_turn.max(1));
        let counted = (shaft * i64::from(bench.points_per_turn)).div_euclid(turn);
        let counted = if bench.inverted { -counted } else { counted };
        let shown = match self.kind {
            Some(EncoderKind::Ssi | EncoderKind::EnDat) => self.absolute(bench, counted),
            _ => counted,
        };
        if self.definition & definition::INVERT != 0 { -shown } else { shown }
    }

    /// What an absolute encoder sends, as the module understands it: as many bits as both have.
    fn absolute(&self, bench: &EncoderBench, counted: i64) -> i64 {
        let mask = |bits: u8| (1_i64 << bits.min(32)) - 1;
        let value = (counted + bench.origin) & mask(bench.bits);
        let sent = if bench.gray { value ^ (value >> 1) } else { value };
        let mut read = sent & mask(self.bits);
        if self.kind == Some(EncoderKind::Ssi) && self.definition & definition::GRAY != 0 {
            for shift in [16, 8, 4, 2, 1] {
                read ^= read >> shift;
            }
        }
        read
    }

    /// Position in points (zone 3), offset included; 0 without an encoder.
    pub(crate) fn points(&self, shaft: i64) -> i32 {
        if self.kind.is_none() {
            return 0;
        }
        super::saturated(self.shown(shaft) + self.offset)
    }

    /// Position in steps (zone 4): points · dividend / divisor; none without a sound encoder or with divisor 0.
    pub(crate) fn steps(&self, shaft: i64) -> Option<i32> {
        if self.kind.is_none() || self.fault || self.divisor == 0 {
            return None;
        }
        let points = i64::from(self.points(shaft));
        Some(super::saturated(points * i64::from(self.dividend) / i64::from(self.divisor)))
    }

    /// Declares the present position, points.
    pub(crate) fn set_points(&mut self, shaft: i64, points: i64) {
        if self.kind.is_some() {
            self.offset = points - self.shown(shaft);
        }
    }

    /// Declares the present position, steps.
    pub(crate) fn set_steps(&mut self, shaft: i64, steps: i32) {
        if self.dividend != 0 {
            let points = i64::from(steps) * i64::from(self.divisor) / i64::from(self.dividend);
            self.set_points(shaft, points);
        }
    }

    /// The end of homing clears an incremental encoder (5.1).
    pub(crate) fn home(&mut self, shaft: i64) {
        if self.kind == Some(EncoderKind::Incremental) {
            self.set_points(shaft, 0);
        }
    }

    /// The offset of an absolute encoder, parameter $30 or $31.
    pub(crate) fn offset(&self) -> i32 {
        super::saturated(self.offset)
    }

    /// True if homing looks for the index.
    pub(crate) fn homes_on_index(&self) -> bool {
        self.kind == Some(EncoderKind::Incremental)
            && self.definition & definition::HOME_ON_INDEX != 0
    }

    /// The next whole µstep of the shaft beyond `shaft` at which the index comes: once per turn, at 0.
    pub(crate) fn next_index(&self, shaft: i64, sense: i64) -> Option<i64> {
        let bench = self.bench.filter(|_| self.homes_on_index() && !self.fault)?;
        let turn = i64::from(bench.microsteps_per_turn.max(1));
        let below = shaft.div_euclid(turn) * turn;
        Some(match (sense > 0, below == shaft) {
            (true, _) => below + turn,
            (false, true) => below - turn,
            (false, false) => below,
        })
    }

    /// "Message codeur", but for the bits of plug and corrections. Divisor 0 shows without an encoder, too (2.2.4).
    pub(crate) fn messages(&self) -> u16 {
        let kind_bit = match self.kind {
            Some(EncoderKind::Incremental) => encoder_message::INCREMENTAL,
            Some(EncoderKind::Ssi) => encoder_message::SSI,
            Some(EncoderKind::EnDat) => encoder_message::ENDAT,
            None => 0,
        };
        let alarm =
            self.kind == Some(EncoderKind::EnDat) && self.bench.is_some_and(|bench| bench.alarm);
        let bits = [
            (kind_bit, true),
            (encoder_message::DIVISOR_ZERO, self.divisor == 0),
            (encoder_message::FAULT, self.fault),
            (encoder_message::ALARM, alarm),
        ];
        bits.into_iter().filter(|(_, set)| *set).fold(0, |word, (bit, _)| word | bit)
    }
}
