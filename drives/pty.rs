//! Pseudo-terminals: a serial port without hardware for an emulated device.

use std::{
    fs, io,
    os::unix::fs::symlink,
    path::{Path, PathBuf},
};

use serialport::{SerialPort, TTYPort};

use crate::EmulatorError;

/// The far end of a pseudo-terminal: where the driver, or any other program, opens the emulated device.
///
/// The slave side stays open here as long as the value lives: a master whose slave nobody holds reads EIO. It is
/// opened without a lock, so that others can open its path; both sides are raw.
#[derive(Debug)]
pub(crate) struct PseudoTerminal {
    path: PathBuf,
    link: Option<PathBuf>,
    _keeper: TTYPort,
}

impl PseudoTerminal {
    /// Opens a pair and gives the near end (master) with it. `link`, if any, becomes a symbolic link to the far end;
    /// one there that leads nowhere is replaced.
    pub(crate) fn open(link: Option<&Path>) -> Result<(TTYPort, Self), EmulatorError> {
        let terminal = |source: io::Error| EmulatorError::Terminal { source };
        // pair() gives (master, slave).
        let (master, keeper) = TTYPort::pair().map_err(|error| terminal(error.into()))?;
        let path = keeper
            .name()
            .map(PathBuf::from)
            .ok_or_else(|| terminal(io::ErrorKind::NotFound.into()))?;
        if let Some(link) = link {
            make_link(&path, link)?;
        }
        Ok((master, Self { path, link: link.map(Path::to_path_buf), _keeper: keeper }))
    }

    /// Path of the far end.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for PseudoTerminal {
    fn drop(&mut self) {
        // Another emulator may have taken the link over since.
        if let Some(link) = &self.link
            && fs::read_link(link).is_ok_and(|target| target == self.path)
        {
            // Nothing can be done about a link that does not go; it leads nowhere now.
            drop(fs::remove_file(link));
        }
    }
}

fn make_link(path: &Path, link: &Path) -> Result<(), EmulatorError> {
    let failed = |source| EmulatorError::Link { path: link.to_path_buf(), source };
    match fs::symlink_metadata(link) {
        // A link that leads nowhere was left behind by an emulator that could not clean up.
        Ok(metadata) if metadata.is_symlink() && fs::metadata(link).is_err() => {
            fs::remove_file(link).map_err(failed)?;
        }
        Ok(_) => return Err(EmulatorError::LinkTaken { path: link.to_path_buf() }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(failed(error)),
    }
    symlink(path, link).map_err(failed)
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};

    use super::*;

    #[test]
    fn bytes_pass_raw_and_the_slave_can_be_opened_again_and_again() {
        let (mut master, far) = PseudoTerminal::open(None).unwrap();
        for _ in 0..2 {
            let name = far.path().to_str().unwrap();
            let mut peer = TTYPort::open(&serialport::new(name, 115_200)).unwrap();
            // Bytes a terminal in its usual mode would translate, echo or take for signals.
            let bytes = [0x0D, 0x0A, 0x03, 0x04, 0x11, 0x13, 0x1A, 0xFF, 0x00];
            peer.write_all(&bytes).unwrap();
            let mut received = [0; 9];
            master.read_exact(&mut received).unwrap();
            assert_eq!(received, bytes);
            master.write_all(&bytes).unwrap();
            let mut received = [0; 9];
            peer.read_exact(&mut received).unwrap();
            assert_eq!(received, bytes);
        }
    }

    #[test]
    fn the_link_leads_to_the_slave_and_goes_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("board");
        let (_first, first) = PseudoTerminal::open(Some(&link)).unwrap();
        assert_eq!(fs::read_link(&link).unwrap(), first.path());
        // A second emulator does not take it away.
        let refused = PseudoTerminal::open(Some(&link));
        assert!(matches!(refused, Err(EmulatorError::LinkTaken { .. })));
        assert_eq!(fs::read_link(&link).unwrap(), first.path());
        drop(first);
        assert!(fs::symlink_metadata(&link).is_err());
        // What one leaves behind that could not clean up is replaced.
        symlink("/dev/pts/no such terminal", &link).unwrap();
        let (_third, third) = PseudoTerminal::open(Some(&link)).unwrap();
        assert_eq!(fs::read_link(&link).unwrap(), third.path());
    }

    #[test]
    fn a_file_in_the_place_of_the_link_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("board");
        fs::write(&link, "precious").unwrap();
        let refused = PseudoTerminal::open(Some(&link));
        assert!(matches!(refused, Err(EmulatorError::LinkTaken { .. })));
        assert_eq!(fs::read_to_string(&link).unwrap(), "precious");
    }
}
