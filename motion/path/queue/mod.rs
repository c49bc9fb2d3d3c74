//! Queue files: path elements of `SMC_OUTQUEUE` on disk, read piece by piece (`SMC_ReadNCQueue`, manual 6.5 and 10.2).
//!
//! The manual does not define the layout, so this is our own. Numbers are little-endian, lengths in bytes,
//! floating-point numbers IEEE 754 doubles in SI units, bit for bit.
//!
//! ```text
//! header     16  8 magic · u16 version · u8 generator · u8 zero · u32 CRC-32 of these 12
//! block       9+ u8 'B' · u32 length of the payload, 1 to 65,536 · payload: whole elements, one after the other ·
//!                u32 CRC-32 of number of the block (u64, from 0), tag, length and payload
//! end        17  u8 'E' · u64 number of elements · u32 CRC-32 of all payloads · u32 CRC-32 of these 13
//! ```
//!
//! The end record comes exactly once and nothing follows it. So a truncated file, a file with one byte more or less,
//! and a file with a lost, doubled or moved block are detected, and an element is returned only after its checksum has
//! been verified. Reading and writing hold one block at a time.

mod backwards;
mod error;
mod reader;
mod record;
#[cfg(test)]
mod tests;
mod writer;

pub use backwards::Backwards;
pub use error::{ContentError, QueueReadError, QueueWriteError};
pub use reader::QueueReader;
pub use writer::QueueWriter;

/// The version of the layout.
pub(crate) const VERSION: u16 = 1;

/// The largest payload of a block, bytes.
pub const MAX_BLOCK_BYTES: usize = 1 << 16;

/// The first bytes of a file. One is not text and the line ends are of both kinds, so that a file that was taken for
/// text on its way is found out at once.
const MAGIC: [u8; 8] = *b"\x95TWQ\r\n\x1a\n";
const HEADER_BYTES: usize = 16;
const BLOCK: u8 = b'B';
const END: u8 = b'E';

/// Stage that generated the elements of a queue (`SMC_OUTQUEUE.byGenerator`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Generator {
    /// The decoder.
    Decoder,
    /// Loop avoidance.
    AvoidLoop,
    /// Limits of circular velocities.
    LimitCircularVelocities,
    /// Rounding.
    RoundPath,
    /// Smoothing.
    SmoothPath,
    /// Tool radius correction.
    ToolCorrection,
    /// Rotation.
    Rotate,
    /// Scaling.
    Scale,
    /// Translation.
    Translate,
    /// The check of velocities: what the interpolator wants.
    CheckVelocities,
    /// The editor: a path compiled ahead, checked velocities included.
    Editor,
}

impl Generator {
    const ALL: [Self; 11] = [
        Self::Decoder,
        Self::AvoidLoop,
        Self::LimitCircularVelocities,
        Self::RoundPath,
        Self::SmoothPath,
        Self::ToolCorrection,
        Self::Rotate,
        Self::Scale,
        Self::Translate,
        Self::CheckVelocities,
        Self::Editor,
    ];

    /// The manual's number.
    pub const fn number(self) -> u8 {
        match self {
            Self::Decoder => 1,
            Self::AvoidLoop => 10,
            Self::LimitCircularVelocities => 11,
            Self::RoundPath => 12,
            Self::SmoothPath => 13,
            Self::ToolCorrection => 14,
            Self::Rotate => 30,
            Self::Scale => 31,
            Self::Translate => 32,
            Self::CheckVelocities => 254,
            Self::Editor => 255,
        }
    }

    /// The generator of that number.
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|generator| generator.number() == number)
    }

    /// True if an interpolator takes the queue as it is (else it is error 1006, `SMC_INT_NO_CHECKVELOCITIES`): the
    /// velocities at its transitions have been set.
    pub const fn is_checked(self) -> bool {
        matches!(self, Self::CheckVelocities | Self::Editor)
    }
}
