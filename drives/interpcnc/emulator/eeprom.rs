//! EEPROM of the emulated board: parameters, user memory and recipes, their image file, and write times.

use std::ops::RangeInclusive;

use super::{Board, map::RECIPE_REGISTERS};

/// Holding registers that are kept: parameters, user memory, recipe size and indices.
pub(super) const KEPT: RangeInclusive<u16> = 4352..=5636;
/// Start of every image, its last byte the version of the format.
const MAGIC: [u8; 8] = *b"ICNC EE\x01";

/// The EEPROM.
#[derive(Clone, Debug)]
pub(super) struct Eeprom {
    /// Kept registers and recipes as they survive.
    stored: Vec<u16>,
    /// When the writes under way have ended.
    busy_until_ns: Option<i64>,
    /// B15: the last write has failed.
    failed: bool,
    /// Writes fail.
    broken: bool,
    /// How often something was stored.
    generation: u64,
}

/// An image that no emulated board has made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadImage {
    /// It does not begin as images do.
    #[error("this is not an image of the EEPROM of an emulated InterpCNC board")]
    Kind,
    /// It is cut or too long.
    #[error("an image of {expected} bytes was expected, this one has {found}")]
    Length {
        /// Bytes of an image.
        expected: usize,
        /// Bytes of this one.
        found: usize,
    },
}

impl Eeprom {
    pub(super) fn new(stored: Vec<u16>) -> Self {
        Self { stored, busy_until_ns: None, failed: false, broken: false, generation: 0 }
    }

    /// B14.
    pub(super) fn busy(&self) -> bool {
        self.busy_until_ns.is_some()
    }

    /// B15.
    pub(super) fn failed(&self) -> bool {
        self.failed
    }

    pub(super) fn broken(&self) -> bool {
        self.broken
    }

    /// When the writes under way end.
    pub(super) fn due_ns(&self) -> Option<i64> {
        self.busy_until_ns
    }

    /// Power is gone: what was being written is lost.
    pub(super) fn power_cycle(&mut self) {
        self.busy_until_ns = None;
        self.failed = false;
    }

    pub(super) fn stored(&self) -> &[u16] {
        &self.stored
    }
}

/// The registers of an image.
pub(super) fn from_image(image: &[u8]) -> Result<Vec<u16>, BadImage> {
    let registers = image.strip_prefix(&MAGIC).ok_or(BadImage::Kind)?;
    let expected = MAGIC.len() + 2 * (KEPT.len() + RECIPE_REGISTERS);
    if image.len() != expected {
        return Err(BadImage::Length { expected, found: image.len() });
    }
    let pairs = registers.chunks_exact(2);
    Ok(pairs.filter_map(|pair| pair.try_into().ok().map(u16::from_be_bytes)).collect())
}

impl Board {
    /// The EEPROM's content: a heading, then parameters, user memory, recipe size and indices and recipes as registers
    /// with the high byte first.
    pub fn eeprom(&self) -> Vec<u8> {
        let mut image = MAGIC.to_vec();
        image.extend(self.eeprom.stored.iter().flat_map(|register| register.to_be_bytes()));
        image
    }

    /// Number of times that something has been stored since the first power-up.
    pub fn eeprom_generation(&self) -> u64 {
        self.eeprom.generation
    }

    /// End of the write under way, ns since power-up; none if there is none.
    pub fn eeprom_due_ns(&self) -> Option<i64> {
        self.eeprom.due_ns()
    }

    /// Makes writes to the EEPROM fail from now on, or no more.
    pub fn set_eeprom_broken(&mut self, broken: bool) {
        self.eeprom.broken = broken;
    }

    /// Kept registers have been written.
    pub(super) fn begin_store(&mut self, registers: i64) {
        let since = self.eeprom.busy_until_ns.unwrap_or(self.now_ns);
        let took = self.assumptions.eeprom_write_ns.max(0).saturating_mul(registers);
        self.eeprom.busy_until_ns = Some(since.saturating_add(took));
    }

    /// Writes that are due have ended; true if there were any.
    pub(super) fn end_store(&mut self) -> bool {
        if self.eeprom.busy_until_ns.is_none_or(|due_ns| due_ns > self.now_ns) {
            return false;
        }
        self.eeprom.busy_until_ns = None;
        self.eeprom.failed = self.eeprom.broken;
        if !self.eeprom.broken {
            self.eeprom.stored = self.memory.kept();
            self.eeprom.generation += 1;
        }
        true
    }
}
