//! Check of the path at which a port is expected, as the errors of the operating system explain little.

use std::{
    fs, io,
    os::unix::fs::FileTypeExt,
    path::{Path, PathBuf},
};

use tokio_serial::{SerialPortBuilder, SerialPortBuilderExt, SerialStream};

/// Bytes of a memory file, in which an emulated module on a bus lives.
pub const FILE_LENGTH: usize = 0x405;

/// Kind of a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// A serial line.
    Serial,
    /// The memory file of an emulated module.
    Memory,
    /// A device whose memory is mapped.
    Mapped,
}

/// Something else than a port that could be spoken on.
#[derive(Debug, thiserror::Error)]
enum WrongPort {
    #[error("it is {found}; wanted is {}", wanted.described())]
    Other { found: String, wanted: Port },
    #[error("the link leads to {}, which does not exist: has its emulator ended?", target.display())]
    DeadLink { target: PathBuf },
}

impl Port {
    fn described(self) -> String {
        match self {
            Self::Serial => {
                "a serial port, like /dev/ttyUSB0, or the pseudo-terminal of an emulated device"
                    .to_owned()
            }
            Self::Memory => format!(
                "the memory file of an emulated module ({FILE_LENGTH} bytes); a device like /dev/uio0 also needs the offset to map (--map, or `map_offset`)"
            ),
            Self::Mapped => "a device whose memory can be mapped, like /dev/uio0".to_owned(),
        }
    }

    /// Checks the kind of file at a path, without opening it. A missing file is left to the operating system to name.
    ///
    /// # Errors
    /// If it can be no such port.
    pub fn check(self, path: &Path) -> io::Result<()> {
        let wrong = |found: &str| {
            let found = found.to_owned();
            Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                WrongPort::Other { found, wanted: self },
            ))
        };
        let Ok(metadata) = fs::metadata(path) else {
            return match fs::read_link(path) {
                Ok(target) => {
                    Err(io::Error::new(io::ErrorKind::NotConnected, WrongPort::DeadLink { target }))
                }
                Err(_) => Ok(()),
            };
        };
        let (kind, bytes) = (metadata.file_type(), metadata.len());
        if kind.is_dir() {
            wrong("a folder")
        } else if kind.is_socket() {
            wrong("a socket, as emulators are controlled by")
        } else if kind.is_fifo() {
            wrong("a pipe")
        } else if kind.is_block_device() {
            wrong("a disk")
        } else if kind.is_char_device() && self == Self::Memory {
            wrong("a serial port or another device")
        } else if kind.is_file() && self == Self::Serial {
            let memory = usize::try_from(bytes) == Ok(FILE_LENGTH);
            let as_memory = if memory { ", as the memory of an emulated BIM2AX is" } else { "" };
            wrong(&format!("a file of {bytes} bytes{as_memory}"))
        } else if kind.is_file()
            && self == Self::Memory
            && usize::try_from(bytes) != Ok(FILE_LENGTH)
        {
            wrong(&format!("a file of {bytes} bytes"))
        } else {
            Ok(())
        }
    }

    /// Says what is wrong with a serial port that could not be opened: a device like /dev/null is no terminal, which only
    /// shows when its speed is to be set.
    fn explain(error: serialport::Error) -> io::Error {
        // Locked, or kept for one by TIOCEXCL.
        if ["exclusive lock", "busy"].iter().any(|word| error.description.contains(word)) {
            return io::Error::new(io::ErrorKind::ResourceBusy, "another program has the port");
        }
        let no_terminal =
            ["typewriter", "ioctl"].iter().any(|word| error.description.contains(word));
        if no_terminal {
            let found = "a device, but no terminal".to_owned();
            let wrong = WrongPort::Other { found, wanted: Self::Serial };
            return io::Error::new(io::ErrorKind::InvalidInput, wrong);
        }
        error.into()
    }
}

/// Opens a serial port, which is at `path`.
///
/// # Errors
/// If there is none, or it is in use.
pub fn open_serial(path: &str, port: SerialPortBuilder) -> io::Result<SerialStream> {
    Port::Serial.check(Path::new(path))?;
    port.open_native_async().map_err(Port::explain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::{fs::symlink, net::UnixListener};

    #[test]
    fn what_is_no_port_is_named_with_what_is_wanted() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("short"), "mine").unwrap();
        fs::write(path("long"), [b'x'; FILE_LENGTH + 1]).unwrap();
        fs::write(path("memory"), [0; FILE_LENGTH]).unwrap();
        let _socket = UnixListener::bind(path("socket")).unwrap();
        symlink("/dev/pts/no such terminal", path("link")).unwrap();
        let said = |port: Port, name: &str| port.check(&path(name)).unwrap_err().to_string();
        for port in [Port::Serial, Port::Memory, Port::Mapped] {
            assert!(said(port, "").contains("it is a folder; wanted is "), "{port:?}");
            assert!(said(port, "socket").contains("a socket"), "{port:?}");
            assert!(said(port, "link").contains("/dev/pts/no such terminal"), "{port:?}");
            port.check(&path("nothing")).unwrap();
        }
        assert!(said(Port::Serial, "memory").contains("the memory of an emulated BIM2AX"));
        assert!(said(Port::Serial, "short").contains("a file of 4 bytes; wanted is a serial port"));
        assert!(said(Port::Memory, "short").contains("(1029 bytes)"));
        assert!(said(Port::Memory, "long").contains("a file of 1030 bytes"));
        Port::Memory.check(&path("memory")).unwrap();
        let device = Path::new("/dev/null");
        assert!(Port::Memory.check(device).unwrap_err().to_string().contains("offset to map"));
        Port::Serial.check(device).unwrap();
        let opened = serialport::TTYPort::open(&serialport::new("/dev/null", 9600)).unwrap_err();
        assert!(Port::explain(opened).to_string().contains("a device, but no terminal"));
    }
}
