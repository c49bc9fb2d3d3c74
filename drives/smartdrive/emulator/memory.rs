//! The three copies of the parameters: factory, saved, working.

use crate::{
    Assumptions, RejectCode, StepsPerTurn,
    emulator::motion::Ceilings,
    protocol::parameters::{
        ACCELERATION_MAX, ADDRESS, DECELERATION_LIMIT, DECELERATION_MAX, Entry, FULL_STEPS,
        PARAMETER_WORDS, PARAMETERS, POSITION_MAX, POSITION_MIN, RELEASE, STEP_DIVISOR,
        VELOCITY_MAX, parameter_at,
    },
};

/// First bytes of an image of the flash memory, with the number of its format.
const MAGIC: &[u8; 8] = b"SMDRIVE1";

/// Words by index.
type Words = [u16; PARAMETER_WORDS];

/// Saved, working and factory value of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Copies {
    pub(super) saved: u16,
    pub(super) working: u16,
    pub(super) factory: u16,
}

/// The parameters.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    factory: Box<Words>,
    saved: Box<Words>,
    working: Box<Words>,
    /// As `working`, but 32-bit values change when their high word arrives.
    whole: Box<Words>,
    /// What the device goes by: `whole` as of the last time that it took effect.
    effective: Box<Words>,
    /// How often something was saved.
    saves: u64,
}

fn word(words: &Words, index: u16) -> u16 {
    words.get(usize::from(index)).copied().unwrap_or(0)
}

fn store(words: &mut Words, index: u16, value: u16) {
    if let Some(word) = words.get_mut(usize::from(index)) {
        *word = value;
    }
}

/// The value of an entry in a copy.
fn value(words: &Words, entry: &Entry) -> i64 {
    let high = if entry.kind.is_long() { word(words, entry.index + 1) } else { 0 };
    entry.value(u32::from(high) << 16 | u32::from(word(words, entry.index)))
}

impl Memory {
    /// As it leaves the factory, with these values of the emulator's choice.
    pub(super) fn new(address: u8, release: u16) -> Self {
        let mut factory = Box::new([0; PARAMETER_WORDS]);
        for entry in &PARAMETERS {
            let [a, b, c, d, ..] = entry.factory.to_le_bytes();
            store(&mut factory, entry.index, u16::from_le_bytes([a, b]));
            if entry.kind.is_long() {
                store(&mut factory, entry.index + 1, u16::from_le_bytes([c, d]));
            }
        }
        store(&mut factory, RELEASE, release);
        store(&mut factory, ADDRESS, address.into());
        let same = || factory.clone();
        let whole = same();
        Self { saved: same(), working: same(), whole, effective: same(), factory, saves: 0 }
    }

    /// The value the device goes by.
    pub(super) fn value(&self, index: u16) -> i64 {
        parameter_at(index).map_or(0, |(entry, _)| value(&self.effective, entry))
    }

    /// A value of one word.
    pub(super) fn word(&self, index: u16) -> u16 {
        word(&self.effective, index)
    }

    /// Saved, working and factory value at an index.
    pub(super) fn copies(&self, index: u16) -> Result<Copies, RejectCode> {
        parameter_at(index).ok_or(RejectCode::NotAvailable)?;
        let of = |words: &Words| word(words, index);
        Ok(Copies {
            saved: of(&self.saved),
            working: of(&self.working),
            factory: of(&self.factory),
        })
    }

    /// Changes a word; the copies, and whether the value is a whole one now: that of two words is when the high one is
    /// set, or with each of them. The device goes by it from [`Self::take_effect`] on.
    pub(super) fn set(
        &mut self,
        index: u16,
        new: u16,
        at_once: bool,
    ) -> Result<(Copies, bool), RejectCode> {
        let (entry, is_high) = parameter_at(index).ok_or(RejectCode::NotAvailable)?;
        if !entry.writable {
            return Err(RejectCode::BadParams);
        }
        let before = word(&self.working, index);
        store(&mut self.working, index, new);
        let is_whole = is_high || !entry.kind.is_long() || at_once;
        if is_whole && !entry.accepts(value(&self.working, entry)) {
            store(&mut self.working, index, before);
            return Err(RejectCode::BadParams);
        }
        if is_whole {
            for part in [entry.index, index] {
                let new = word(&self.working, part);
                store(&mut self.whole, part, new);
            }
        }
        Ok((self.copies(index)?, is_whole))
    }

    /// The device goes by what has been set.
    pub(super) fn take_effect(&mut self) {
        self.effective.clone_from(&self.whole);
    }

    /// SAVE.
    pub(super) fn save(&mut self) {
        self.saved.clone_from(&self.working);
        self.saves += 1;
    }

    /// How often something was saved.
    pub(super) fn saves(&self) -> u64 {
        self.saves
    }

    /// LOAD and reset.
    pub(super) fn load(&mut self, factory: bool) {
        self.working.clone_from(if factory { &self.factory } else { &self.saved });
        self.whole.clone_from(&self.working);
        self.take_effect();
    }

    /// What the generator goes by.
    pub(super) fn ceilings(&self, assumptions: &Assumptions) -> Ceilings {
        let turn = StepsPerTurn::new(self.word(FULL_STEPS), self.word(STEP_DIVISOR));
        let position = |index| i32::try_from(self.value(index)).unwrap_or(0);
        Ceilings {
            turn: turn.unwrap_or(StepsPerTurn::ONE),
            velocity: self.word(VELOCITY_MAX),
            acceleration: self.word(ACCELERATION_MAX),
            deceleration: self.word(DECELERATION_MAX),
            emergency: self.word(DECELERATION_LIMIT),
            positions: (position(POSITION_MIN), position(POSITION_MAX)),
            assumptions: *assumptions,
        }
    }

    /// The saved values as bytes: name and format, words low byte first, XOR of all.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let words = self.saved.iter().flat_map(|word| word.to_le_bytes());
        let mut bytes: Vec<u8> = MAGIC.iter().copied().chain(words).collect();
        bytes.push(bytes.iter().fold(0, |sum, byte| sum ^ byte));
        bytes
    }

    /// Takes saved values from [`Self::to_bytes`] and loads them; false, changing nothing, if they are not whole or a
    /// value is impossible.
    pub(super) fn restore(&mut self, bytes: &[u8]) -> bool {
        let whole = bytes.len() == MAGIC.len() + 2 * PARAMETER_WORDS + 1
            && bytes.starts_with(MAGIC)
            && bytes.iter().fold(0, |sum, byte| sum ^ byte) == 0;
        if !whole {
            return false;
        }
        let mut saved = self.factory.clone();
        let words = bytes.get(MAGIC.len()..).unwrap_or_default().chunks_exact(2);
        for (word, bytes) in saved.iter_mut().zip(words) {
            *word = bytes.try_into().map_or(0, u16::from_le_bytes);
        }
        let possible = PARAMETERS.iter().all(|entry| {
            let new = value(&saved, entry);
            if entry.writable { entry.accepts(new) } else { new == value(&self.factory, entry) }
        });
        if possible {
            self.saved = saved;
            self.load(false);
        }
        possible
    }
}
