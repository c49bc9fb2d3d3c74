//! One master at a time.
//!
//! Two masters of a module would take each other's receipts and answers for their own. An emulator holds a lock on its
//! memory file itself, so masters keep each other out by one on a second file beside it, which is empty and stays. The
//! lock belongs to an open file: the system frees it when the program ends, however it does.

use std::{
    fs::{File, OpenOptions, TryLockError},
    io,
    path::{Path, PathBuf},
};

/// What the name of the second file ends with.
const ENDING: &str = ".master";

/// Others are kept out as long as this lives.
#[derive(Debug)]
pub struct Master {
    #[expect(dead_code, reason = "its lock is what counts")]
    lock: File,
}

impl Master {
    /// Of a memory file, whatever name leads to it.
    pub(super) fn of_file(path: &Path) -> io::Result<Self> {
        let beside = lock_file(&path.canonicalize()?);
        // Another user may have made it: a lock needs no right to write.
        let open = OpenOptions::new().write(true).create(true).truncate(false).open(&beside);
        let lock = open.or_else(|error| match error.kind() {
            io::ErrorKind::PermissionDenied => File::open(&beside),
            _ => Err(error),
        });
        let named = |error: io::Error| {
            let message = format!("{}, which keeps masters apart: {error}", beside.display());
            io::Error::new(error.kind(), message)
        };
        Self::locked(lock.map_err(named)?, path)
    }

    /// Of a device that is mapped.
    ///
    /// # Errors
    /// [`io::ErrorKind::ResourceBusy`] if another program is its master; or if it cannot be opened.
    pub fn of_device(path: &Path) -> io::Result<Self> {
        Self::locked(File::open(path)?, path)
    }

    fn locked(lock: File, path: &Path) -> io::Result<Self> {
        match lock.try_lock() {
            Ok(()) => Ok(Self { lock }),
            Err(TryLockError::WouldBlock) => {
                let message = format!(
                    "another program is the master of {}: end it first; \
                     `twin drive bim2ax … stop` gets through all the same",
                    path.display()
                );
                Err(io::Error::new(io::ErrorKind::ResourceBusy, message))
            }
            Err(TryLockError::Error(error)) => Err(error),
        }
    }
}

/// The file beside a memory file that its master has locked.
fn lock_file(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(ENDING);
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_memory_file_has_one_master_by_whatever_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("module");
        std::fs::write(&path, "").unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        let first = Master::of_file(&path).unwrap();
        for name in [&path, &link] {
            let refused = Master::of_file(name).unwrap_err();
            assert_eq!(refused.kind(), io::ErrorKind::ResourceBusy);
            let said = refused.to_string();
            assert!(
                said.contains(&name.display().to_string()) && said.contains("end it"),
                "{said}"
            );
        }
        drop(first);
        // What stays behind is a file, not a lock.
        assert!(lock_file(&path).exists());
        assert!(Master::of_file(&link).is_ok());
    }
}
