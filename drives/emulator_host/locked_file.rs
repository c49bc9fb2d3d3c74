//! Locked state files of emulated devices, which outlast the emulator.

use std::{
    error::Error,
    fs::{self, File, OpenOptions, TryLockError},
    io,
    path::{Path, PathBuf},
};

use crate::EmulatorError;
use twin_files::limited_read;

/// Most bytes of a memory image: many times what any device has.
const MOST_IMAGE: u64 = 1 << 20;

/// A file in which one emulated device alone keeps things, as long as this lives.
///
/// The file is replaced when something is stored, so what is locked is an empty one next to it, `….lock`, which stays: unless
/// the file turns out to be none of a device.
#[derive(Debug)]
pub struct LockedFile {
    #[expect(dead_code, reason = "its lock is what counts")]
    lock: File,
    /// The empty file, as long as it is not to stay.
    made: Option<PathBuf>,
}

impl LockedFile {
    /// Of a file that need not be there yet, whatever name leads to it.
    ///
    /// # Errors
    /// [`EmulatorError::File`]: another emulator keeps things in it, or it cannot be locked.
    pub fn lock(path: &Path) -> Result<Self, EmulatorError> {
        Self::locked(path)
            .map_err(|source| EmulatorError::File { path: path.to_path_buf(), source })
    }

    /// The device keeps its things there.
    pub fn keep(&mut self) {
        self.made = None;
    }

    fn locked(path: &Path) -> io::Result<Self> {
        let real = path.canonicalize().unwrap_or_else(|_new| path.to_path_buf());
        let mut name = real.file_name().unwrap_or_default().to_owned();
        name.push(".lock");
        let lock_path = real.with_file_name(name);
        let mut options = OpenOptions::new();
        let (lock, made) = match options.write(true).create_new(true).open(&lock_path) {
            Ok(lock) => (lock, Some(lock_path)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => (
                OpenOptions::new().write(true).create(true).truncate(false).open(&lock_path)?,
                None,
            ),
            Err(error) => return Err(error),
        };
        match lock.try_lock() {
            Ok(()) => Ok(Self { lock, made }),
            Err(TryLockError::WouldBlock) => Err(io::Error::new(
                io::ErrorKind::ResourceBusy,
                "another emulator keeps its parameters in it: each device has a file of its own",
            )),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }
}

impl Drop for LockedFile {
    fn drop(&mut self) {
        if let Some(made) = &self.made {
            // One that cannot be removed is as empty as before.
            fs::remove_file(made).unwrap_or_default();
        }
    }
}

/// Device whose memory is in a file; none while the file does not exist.
///
/// # Errors
/// [`EmulatorError::File`]: the file cannot be read, or `decode` takes its content for something else.
pub fn restored<D, E: Into<Box<dyn Error + Send + Sync>>>(
    path: &Path,
    decode: impl FnOnce(&[u8]) -> Result<D, E>,
) -> Result<Option<D>, EmulatorError> {
    let failed = |source| EmulatorError::File { path: path.to_path_buf(), source };
    match limited_read::read_binary(path, MOST_IMAGE) {
        Ok(image) => {
            let wrong = |why| failed(io::Error::new(io::ErrorKind::InvalidData, why));
            decode(&image).map(Some).map_err(wrong)
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(failed(error)),
    }
}

/// Replaces a file as a whole: whoever is killed meanwhile leaves the old or the new one.
///
/// # Errors
/// If it cannot be written next to the old one, or not take its place.
pub fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    let new = path.with_file_name(name);
    fs::write(&new, content)?;
    fs::rename(&new, path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_one_keeper_by_whatever_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("eeprom");
        let mut first = LockedFile::lock(&path).unwrap();
        first.keep();
        assert!(LockedFile::lock(&path).is_err(), "also before it is there");
        replace(&path, b"stored").unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        for name in [&path, &link] {
            let said = LockedFile::lock(name).unwrap_err().to_string();
            let named = said.starts_with(&name.display().to_string());
            assert!(named && said.contains("another emulator"), "{said}");
        }
        drop(first);
        assert!(LockedFile::lock(&link).is_ok());
        assert!(folder.path().join("eeprom.lock").exists(), "another may wait for it");
    }

    #[test]
    fn a_file_that_is_none_of_a_device_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("letter.txt");
        fs::write(&path, "dear all").unwrap();
        let lock_path = folder.path().join("letter.txt.lock");
        let lock = LockedFile::lock(&path).unwrap();
        assert!(lock_path.exists());
        drop(lock);
        assert!(!lock_path.exists());
    }
}
