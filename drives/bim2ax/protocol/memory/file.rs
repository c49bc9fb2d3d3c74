//! A plain file in the place of the module's bus, so that module and host can be two processes.
//!
//! A file has neither page register nor interrupts, so it shows what is behind them, all in one:
//!
//! | offset | written by | what |
//! |---|---|---|
//! | $000–$3FF | both | the RAM: page p at p · $80; page 6 is the module's, page 7 the host's |
//! | $400 | module | status as $FD reads it: bit 0 clear when the software runs |
//! | $401 | module | identifier $4E |
//! | $402 | host | page register as last written |
//! | $403 | host | number of interrupts so far, modulo 256: one more after every write at $3FF |
//! | $404 | module | number of interrupts served so far, modulo 256 |
//!
//! The module looks at $403 every few tenths of a millisecond and serves an interrupt when it has changed; two
//! between two looks are one, as they are on the bus. Bytes are written and read one by one: a host completes what
//! it writes before it raises $403, a module completes page 6 before it raises $404.

use std::{fs::OpenOptions, io, path::Path};

use twin_drives::{Port, port::FILE_LENGTH};

use super::{
    HOST_PAGE, IDENTIFIER, INTERRUPT, Mapping, Master, Memory, PAGE_REGISTER, WINDOW_LENGTH,
    offsets,
};

/// Offsets in the file beyond the RAM.
pub mod file_offset {
    /// Status.
    pub const STATUS: usize = 0x400;
    /// Identifier.
    pub const IDENTIFIER: usize = 0x401;
    /// Page register.
    pub const PAGE: usize = 0x402;
    /// Interrupts so far.
    pub const INTERRUPTS: usize = 0x403;
    /// Interrupts served so far.
    pub const SERVED: usize = 0x404;
}

/// The host's side of a memory file: behaves like the module's 256 bytes.
#[derive(Debug)]
pub struct MemoryFile {
    mapping: Mapping,
    page: u8,
    /// None if it is open next to the master.
    #[expect(dead_code, reason = "kept for as long as this lives")]
    master: Option<Master>,
}

impl MemoryFile {
    /// Opens the file that an emulator serves, as its only master.
    ///
    /// # Errors
    /// If it cannot be opened for reading and writing, or is too short; [`io::ErrorKind::ResourceBusy`] if it has another
    /// master, in this program or another one.
    pub fn open(path: &Path) -> io::Result<Self> {
        let shared = Self::shared(path)?;
        Ok(Self { master: Some(Master::of_file(path)?), ..shared })
    }

    /// Opens it whoever is its master: for a stop, which has to get through. Each of the two may miss what the module says
    /// to it and has to ask again.
    ///
    /// # Errors
    /// If it cannot be opened for reading and writing, or is too short.
    pub fn shared(path: &Path) -> io::Result<Self> {
        Port::Memory.check(path)?;
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        let mapping = Mapping::new(file, 0, FILE_LENGTH)?;
        let page = mapping.load(file_offset::PAGE)? & 7;
        Ok(Self { mapping, page, master: None })
    }

    /// Place of an offset of the window.
    fn ram(&self, offset: u8) -> usize {
        usize::from(self.page) * usize::from(WINDOW_LENGTH) + usize::from(offset)
    }
}

impl Memory for MemoryFile {
    fn read(&mut self, offset: u8, bytes: &mut [u8]) -> io::Result<()> {
        for (offset, byte) in offsets(offset, bytes.len())?.zip(bytes) {
            *byte = match offset {
                0..WINDOW_LENGTH => self.mapping.load(self.ram(offset))?,
                PAGE_REGISTER => self.mapping.load(file_offset::STATUS)?,
                IDENTIFIER => self.mapping.load(file_offset::IDENTIFIER)?,
                _ => 0xFF,
            };
        }
        Ok(())
    }

    fn write(&mut self, offset: u8, bytes: &[u8]) -> io::Result<()> {
        for (offset, byte) in offsets(offset, bytes.len())?.zip(bytes) {
            match offset {
                0..WINDOW_LENGTH => self.mapping.store(self.ram(offset), *byte)?,
                PAGE_REGISTER => {
                    self.page = byte & 7;
                    self.mapping.store(file_offset::PAGE, self.page)?;
                }
                _ => {}
            }
            if offset == INTERRUPT && self.page == HOST_PAGE {
                let so_far = self.mapping.load(file_offset::INTERRUPTS)?;
                self.mapping.store(file_offset::INTERRUPTS, so_far.wrapping_add(1))?;
            }
        }
        Ok(())
    }
}
