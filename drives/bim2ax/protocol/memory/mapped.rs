//! Memory of the machine itself, mapped: a card on its bus.

use std::{
    fs::{File, OpenOptions},
    io,
    path::Path,
    sync::atomic::Ordering,
};

use vm_memory::{Bytes, FileOffset, MmapRegion, VolatileMemory, mmap::MmapRegionError};

use super::{Memory, offsets};
use twin_drives::Port;

/// Offsets of mappings are multiples of this, whatever pages the machine has: the maps of a UIO device are numbered
/// in such steps on machines with small pages.
const PAGE: u64 = 4096;
/// Bytes of a module.
pub(super) const MODULE_LENGTH: usize = 0x100;

/// A stretch of a file or device, mapped and shared.
#[derive(Debug)]
pub(crate) struct Mapping {
    region: MmapRegion,
    base: usize,
}

impl Mapping {
    /// Maps `length` bytes of a file or device from `start` on.
    pub(crate) fn new(file: File, start: u64, length: usize) -> io::Result<Self> {
        let metadata = file.metadata()?;
        let past = || io::Error::from(io::ErrorKind::UnexpectedEof);
        let size = u64::try_from(length).ok().and_then(|length| start.checked_add(length));
        let end = size.ok_or_else(past)?;
        // Beyond the end of a file there is nothing to map; devices have no length.
        if metadata.is_file() && metadata.len() < end {
            return Err(past());
        }
        let base = usize::try_from(start % PAGE).map_err(|_beyond| past())?;
        let offset = FileOffset::new(file, start - start % PAGE);
        let region = MmapRegion::from_file(offset, base + length).map_err(|error| match error {
            MmapRegionError::Mmap(source) => source,
            other => io::Error::new(io::ErrorKind::InvalidInput, other),
        })?;
        Ok(Self { region, base })
    }

    /// Reads one byte.
    pub(crate) fn load(&self, at: usize) -> io::Result<u8> {
        let slice = self.region.as_volatile_slice();
        slice.load(self.base + at, Ordering::SeqCst).map_err(beyond)
    }

    /// Writes one byte.
    pub(crate) fn store(&self, at: usize, byte: u8) -> io::Result<()> {
        let slice = self.region.as_volatile_slice();
        slice.store(byte, self.base + at, Ordering::SeqCst).map_err(beyond)
    }
}

fn beyond(error: vm_memory::VolatileMemoryError) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, error)
}

/// A module whose 256 bytes are mapped: of a UIO device (`/dev/uio0`, first map at 0), of physical memory
/// (`/dev/mem` from its bus address), of a PCI resource (`/sys/bus/pci/devices/…/resource0`).
///
/// Every byte is one access of eight bits, in the order of the program. A plain file must not be made shorter while
/// it is mapped: the system ends a process that touches what is gone.
#[derive(Debug)]
pub struct MappedMemory {
    mapping: Mapping,
}

impl MappedMemory {
    /// Maps the module whose base is `start` bytes into a device or file.
    ///
    /// # Errors
    /// If it cannot be opened for reading and writing, cannot be mapped, or is a file that ends before the module.
    pub fn open(path: &Path, start: u64) -> io::Result<Self> {
        Port::Mapped.check(path)?;
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        Ok(Self { mapping: Mapping::new(file, start, MODULE_LENGTH)? })
    }
}

impl Memory for MappedMemory {
    fn read(&mut self, offset: u8, bytes: &mut [u8]) -> io::Result<()> {
        for (at, byte) in offsets(offset, bytes.len())?.zip(bytes) {
            *byte = self.mapping.load(at.into())?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u8, bytes: &[u8]) -> io::Result<()> {
        offsets(offset, bytes.len())?
            .zip(bytes)
            .try_for_each(|(at, byte)| self.mapping.store(at.into(), *byte))
    }
}
