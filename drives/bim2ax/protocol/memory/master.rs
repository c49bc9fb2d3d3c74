//! One master at a time.
//!
//! Two masters of a module would take each other's receipts and answers for their own. An emulator holds a lock on its
//! memory file itself, so masters keep each other out by one on a second file next to it, which is empty and stays. The
//! lock belongs to an open file: the system frees it when the program ends, however it does. Several modules may be mapped
//! from one device (`/dev/mem`): of a device the bytes of the module are locked, by an open file description (fcntl,
//! `F_OFD_SETLK`).

use std::{
    fs::{File, OpenOptions, TryLockError},
    io,
    path::{Path, PathBuf},
};

use nix::{
    errno::Errno,
    fcntl::{FcntlArg, fcntl},
    libc,
};

use super::mapped::MODULE_LENGTH;

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
        let lock_path = lock_file(&path.canonicalize()?);
        // Another user may have made it: a lock needs no right to write.
        let open = OpenOptions::new().write(true).create(true).truncate(false).open(&lock_path);
        let lock = open.or_else(|error| match error.kind() {
            io::ErrorKind::PermissionDenied => File::open(&lock_path),
            _ => Err(error),
        });
        let named = |error: io::Error| {
            let message = format!("{}, which keeps masters apart: {error}", lock_path.display());
            io::Error::new(error.kind(), message)
        };
        Self::locked(lock.map_err(named)?, path)
    }

    /// Of the module whose base is `start` bytes into a device that is mapped.
    ///
    /// # Errors
    /// [`io::ErrorKind::ResourceBusy`] if it has another master, in this program or another one; or if it cannot be opened
    /// for reading and writing.
    pub fn of_device(path: &Path, start: u64) -> io::Result<Self> {
        let lock = OpenOptions::new().read(true).write(true).open(path)?;
        let beyond = |_| io::Error::from(io::ErrorKind::InvalidInput);
        let module = libc::flock {
            l_type: libc::c_short::try_from(libc::F_WRLCK).map_err(beyond)?,
            l_whence: libc::c_short::try_from(libc::SEEK_SET).map_err(beyond)?,
            l_start: libc::off_t::try_from(start).map_err(beyond)?,
            l_len: libc::off_t::try_from(MODULE_LENGTH).map_err(beyond)?,
            // Demanded by the call.
            l_pid: 0,
        };
        match fcntl(&lock, FcntlArg::F_OFD_SETLK(&module)) {
            Ok(_) => Ok(Self { lock }),
            Err(Errno::EAGAIN | Errno::EACCES) => Err(taken(path)),
            Err(error) => Err(error.into()),
        }
    }

    fn locked(lock: File, path: &Path) -> io::Result<Self> {
        match lock.try_lock() {
            Ok(()) => Ok(Self { lock }),
            Err(TryLockError::WouldBlock) => Err(taken(path)),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }
}

fn taken(path: &Path) -> io::Error {
    let message = format!(
        "another program is the master of {}: end it first; \
         `twin drive bim2ax … stop` gets through all the same",
        path.display()
    );
    io::Error::new(io::ErrorKind::ResourceBusy, message)
}

/// The file next to a memory file that its master has locked.
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
