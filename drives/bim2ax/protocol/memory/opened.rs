//! Memory of a module by its path: an emulator's file, or a device that is mapped.

use std::{fmt, io, path::Path};

use super::{MappedMemory, Master, Memory, MemoryFile};

/// An opened memory of a module.
pub struct OpenedMemory {
    memory: Box<dyn Memory>,
    /// Lock of a device; a memory file holds its own.
    #[expect(dead_code, reason = "its lock is what counts")]
    master: Option<Master>,
    shared: bool,
}

impl fmt::Debug for OpenedMemory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OpenedMemory").field("shared", &self.shared).finish_non_exhaustive()
    }
}

impl OpenedMemory {
    /// The memory at a path, locked against other masters. `map_offset` is that of the module in a device that is mapped;
    /// none is a memory file.
    ///
    /// # Errors
    /// If it cannot be opened; [`io::ErrorKind::ResourceBusy`] if another program is its master.
    pub fn alone(path: &Path, map_offset: Option<u64>) -> io::Result<Self> {
        let (memory, master): (Box<dyn Memory>, _) = match map_offset {
            None => (Box::new(MemoryFile::open(path)?), None),
            Some(start) => {
                let memory = MappedMemory::open(path, start)?;
                (Box::new(memory), Some(Master::of_device(path, start)?))
            }
        };
        Ok(Self { memory, master, shared: false })
    }

    /// As [`Self::alone`], also if another program is the master: for a stop, which has to get through.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn shared(path: &Path, map_offset: Option<u64>) -> io::Result<Self> {
        match Self::alone(path, map_offset) {
            Err(error) if error.kind() == io::ErrorKind::ResourceBusy => {
                let memory: Box<dyn Memory> = match map_offset {
                    None => Box::new(MemoryFile::shared(path)?),
                    Some(start) => Box::new(MappedMemory::open(path, start)?),
                };
                Ok(Self { memory, master: None, shared: true })
            }
            opened => opened,
        }
    }

    /// True if another program is the master of the module.
    pub fn has_other_master(&self) -> bool {
        self.shared
    }
}

impl Memory for OpenedMemory {
    fn read(&mut self, offset: u8, bytes: &mut [u8]) -> io::Result<()> {
        self.memory.read(offset, bytes)
    }

    fn write(&mut self, offset: u8, bytes: &[u8]) -> io::Result<()> {
        self.memory.write(offset, bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::ErrorKind;

    #[test]
    fn a_module_of_a_device_has_one_master() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("device");
        std::fs::write(&path, [0; 512]).unwrap();
        let first = OpenedMemory::alone(&path, Some(256)).unwrap();
        // Two on one device are two modules, as in `/dev/mem`.
        let other = OpenedMemory::alone(&path, Some(0)).unwrap();
        // The same, and one that would lie across both.
        for start in [256, 0, 128] {
            let refused = OpenedMemory::alone(&path, Some(start)).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::ResourceBusy, "{start}");
        }
        let stop = OpenedMemory::shared(&path, Some(256)).unwrap();
        assert!(stop.has_other_master(), "a stop gets through");
        drop(first);
        assert!(!OpenedMemory::shared(&path, Some(256)).unwrap().has_other_master());
        assert!(OpenedMemory::alone(&path, Some(256)).is_ok());
        assert!(OpenedMemory::shared(&path, Some(0)).unwrap().has_other_master());
        drop(other);
        assert!(OpenedMemory::alone(&path, Some(128)).is_ok());
    }
}
