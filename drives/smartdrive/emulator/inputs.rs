//! Inputs and outputs, and the edges that are caught.
//!
//! Source: "IOUPDATE". The bits are 7 LIMN, 6 LIMP, 5 OFF, 4 DIR, 3 GO, 2 LED, 1 BRK, 0 RDY; the last three are
//! outputs, which are shown among the inputs. Edges of outputs are not caught (assumed).

use crate::{BothBits, IoUpdate};

/// A level counts for the captures when it has lasted longer than this (100 µs).
pub(super) const CAPTURE_NS: i64 = 100_000;
/// Bits of the outputs.
const OUTPUTS: u8 = 0b111;

/// An input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// GO; also GOP, START.
    Go,
    /// DIR; also GON.
    Dir,
    /// OFF.
    Off,
    /// Limit switch in the positive direction.
    LimP,
    /// Limit switch in the negative direction.
    LimN,
}

impl Input {
    /// All of them, from bit 3 up.
    pub const ALL: [Self; 5] = [Self::Go, Self::Dir, Self::Off, Self::LimP, Self::LimN];

    /// Mask in the bits of IOUPDATE.
    pub fn mask(self) -> u8 {
        match self {
            Self::Go => 1 << 3,
            Self::Dir => 1 << 4,
            Self::Off => 1 << 5,
            Self::LimP => 1 << 6,
            Self::LimN => 1 << 7,
        }
    }
}

/// Levels and captures.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pins {
    /// Levels of the inputs.
    inputs: u8,
    /// Levels of the outputs.
    outputs: u8,
    /// Levels that have lasted.
    stable: u8,
    /// When each input changed last, ns; from bit 3 up.
    since_ns: [i64; 5],
    active: u8,
    reverse: u8,
}

impl Pins {
    /// Inputs and outputs.
    pub(super) fn levels(&self) -> u8 {
        self.inputs | self.outputs
    }

    pub(super) fn is_active(&self, input: Input) -> bool {
        self.inputs & input.mask() != 0
    }

    /// Whether a level has yet to last.
    pub(super) fn is_settling(&self) -> bool {
        self.inputs != self.stable
    }

    /// An input has a level from now on; true if that is news.
    pub(super) fn set_input(&mut self, now_ns: i64, input: Input, level: bool) -> bool {
        self.settle(now_ns);
        let before = self.inputs;
        self.inputs = if level { before | input.mask() } else { before & !input.mask() };
        for (since, known) in self.since_ns.iter_mut().zip(Input::ALL) {
            if known == input && before != self.inputs {
                *since = now_ns;
            }
        }
        before != self.inputs
    }

    /// Catches the edges to levels that have lasted.
    pub(super) fn settle(&mut self, now_ns: i64) {
        for (since, input) in self.since_ns.iter().zip(Input::ALL) {
            let mask = input.mask();
            if (self.inputs ^ self.stable) & mask != 0 && now_ns - since > CAPTURE_NS {
                self.stable ^= mask;
                if self.stable & mask != 0 {
                    self.active |= mask;
                } else {
                    self.reverse |= mask;
                }
            }
        }
    }

    /// IOUPDATE: levels after switching the outputs, and captures as they were before those asked for are cleared, so
    /// that none is lost unseen.
    pub(super) fn update(&mut self, update: IoUpdate, both: BothBits) -> [u8; 4] {
        let unclear = update.set & update.clear;
        let (set, clear) = (update.set & !unclear, update.clear & !unclear);
        let (set, clear) = match both {
            BothBits::Unchanged => (set, clear),
            BothBits::Set => (update.set, clear),
            BothBits::Clear => (set, update.clear),
        };
        self.outputs |= set & OUTPUTS;
        self.outputs &= !clear;
        let answer = [self.levels(), 0, self.active, self.reverse];
        self.active &= !update.clear_active;
        self.reverse &= !update.clear_reverse;
        answer
    }

    /// Switches output 0 RDY, 1 BRK or 2 LED.
    pub(super) fn set_output(&mut self, place: u16, on: bool) {
        let mask = 1_u8.checked_shl(place.into()).unwrap_or(0) & OUTPUTS;
        self.outputs = if on { self.outputs | mask } else { self.outputs & !mask };
    }

    /// Whether output 0 RDY, 1 BRK or 2 LED is on.
    pub(super) fn output(&self, place: u16) -> bool {
        self.outputs.checked_shr(place.into()).unwrap_or(0) & 1 == 1
    }

    /// Variables 136 to 155: `place` 0 to 19, four of each input.
    pub(super) fn variable(&self, place: u16) -> bool {
        let mask = Input::ALL.get(usize::from(place / 4)).map_or(0, |input| input.mask());
        let bits = match place % 4 {
            0 => self.inputs,
            1 => self.active | self.reverse,
            2 => self.active,
            _ => self.reverse,
        };
        bits & mask != 0
    }
}
