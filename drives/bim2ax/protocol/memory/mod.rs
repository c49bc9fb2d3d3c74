//! The module as its host sees it: 256 bytes (manual 9.2.1).
//!
//! | offset | write | read |
//! |---|---|---|
//! | $00–$7F | 128 bytes of the selected page of 1 KiB of RAM | the same |
//! | $FD | bits 0 to 2: page | bit 0 clear: the module's software runs |
//! | $FF | | identifier $4E |
//!
//! Page 6 is what the module says, page 7 what the host says; the others are not used. A write at $7F with page 7
//! selected (RAM $3FF) interrupts the module. Of the three kinds of [`Memory`] here, [`MappedMemory`] is the real one.

mod file;
mod mapped;
mod master;
mod opened;
#[cfg(test)]
mod tests;
mod window;

use std::io;

pub use file::{MemoryFile, file_offset};
pub use mapped::MappedMemory;
pub(crate) use mapped::Mapping;
pub use master::Master;
pub use opened::OpenedMemory;
pub(crate) use window::Window;

/// Bytes of the window.
pub const WINDOW_LENGTH: u8 = 0x80;
/// Page the host writes.
pub const HOST_PAGE: u8 = 7;
/// Page the module writes.
pub const MODULE_PAGE: u8 = 6;
/// Offset of page register (written) and status (read).
pub const PAGE_REGISTER: u8 = 0xFD;
/// Status bit that is set until the module's software runs.
pub const NOT_RUNNING: u8 = 0x01;
/// Offset of the identifier.
pub const IDENTIFIER: u8 = 0xFF;
/// Identifier of the module.
pub const BIM2AX_BOCM: u8 = 0x4E;
/// Offset of the numbers of the zones to write and to read; on page 6, of the zone read.
pub const ZONES: u8 = 0x00;
/// Offset of the interrupt status; bit 0 makes an interrupt count.
pub const INTERRUPT_STATUS: u8 = 0x01;
/// Offset on page 7 of the four entries that name zones to write (from version 15).
pub const ENTRIES: u8 = 0x70;
/// Offset on page 6 of the receipt flags (from version 15).
pub const RECEIPTS: u8 = 0x70;
/// Receipt flag of the zone "Ordre UC".
pub const RECEIPT_ORDERS: u8 = 0x01;
/// Receipt flag of the zone "Paramètre".
pub const RECEIPT_PARAMETER: u8 = 0x08;
/// Offset whose writing on page 7 interrupts the module.
pub const INTERRUPT: u8 = 0x7F;

/// Bytes at offsets from the module's base, each read or written exactly once and in order.
///
/// Only one value accesses a module at a time: the page register cannot be read back.
pub trait Memory: Send {
    /// Reads the bytes from `offset` on.
    ///
    /// # Errors
    /// If the memory is gone, or the bytes do not all lie within 256.
    fn read(&mut self, offset: u8, bytes: &mut [u8]) -> io::Result<()>;

    /// Writes the bytes from `offset` on.
    ///
    /// # Errors
    /// As [`Self::read`].
    fn write(&mut self, offset: u8, bytes: &[u8]) -> io::Result<()>;
}

/// The offsets of `length` bytes from `offset` on.
pub(crate) fn offsets(offset: u8, length: usize) -> io::Result<impl Iterator<Item = u8>> {
    let last = length.checked_sub(1).and_then(|more| u8::try_from(more).ok());
    let last = last.and_then(|more| offset.checked_add(more));
    last.map(|last| offset..=last).ok_or_else(|| io::ErrorKind::InvalidInput.into())
}

/// Order of the bytes of a number. The manual does not say it; its notation and packing are those of a 68000, so
/// big-endian is assumed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ByteOrder {
    /// The most significant byte.
    #[default]
    Big,
    /// The least significant byte.
    Little,
}

impl ByteOrder {
    /// Two bytes of a number.
    pub fn word(self, bytes: [u8; 2]) -> u16 {
        match self {
            Self::Big => u16::from_be_bytes(bytes),
            Self::Little => u16::from_le_bytes(bytes),
        }
    }

    /// Four bytes of a number.
    pub fn long(self, bytes: [u8; 4]) -> u32 {
        match self {
            Self::Big => u32::from_be_bytes(bytes),
            Self::Little => u32::from_le_bytes(bytes),
        }
    }

    /// A number of 16 bits.
    pub fn word_bytes(self, value: u16) -> [u8; 2] {
        match self {
            Self::Big => value.to_be_bytes(),
            Self::Little => value.to_le_bytes(),
        }
    }

    /// A number of 32 bits.
    pub fn long_bytes(self, value: u32) -> [u8; 4] {
        match self {
            Self::Big => value.to_be_bytes(),
            Self::Little => value.to_le_bytes(),
        }
    }

    /// The order in which a module writes, by its four bytes "Messages carte" (page 6, $22 to $25) without
    /// changing anything: all their bits are in the lowest byte, where a declared axis sets one. None if no axis is
    /// declared or other bits are set.
    pub fn of_card_messages(bytes: [u8; 4]) -> Option<Self> {
        match bytes {
            [0, 0, 0, low] if low != 0 => Some(Self::Big),
            [low, 0, 0, 0] if low != 0 => Some(Self::Little),
            _ => None,
        }
    }
}
