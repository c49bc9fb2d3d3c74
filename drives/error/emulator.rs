//! Emulators that do not start.

use std::{io, path::PathBuf};

/// An emulator that cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum EmulatorError {
    /// No pseudo-terminal.
    #[error("cannot open a pseudo-terminal: {source}")]
    Terminal {
        /// Error of the operating system.
        source: io::Error,
    },
    /// The path for the link is taken by something else, or by a link to a terminal that is in use.
    #[error("{} is in use; remove it or choose another path", path.display())]
    LinkTaken {
        /// The path.
        path: PathBuf,
    },
    /// The link cannot be made.
    #[error("cannot link {}: {source}", path.display())]
    Link {
        /// The path.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A file that the emulated device lives in cannot be made, read, written or mapped.
    #[error("{}: {source}", path.display())]
    File {
        /// The path.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The thread that serves the emulated device cannot be started.
    #[error("cannot start the emulator's thread: {source}")]
    Thread {
        /// Error of the operating system.
        source: io::Error,
    },
    /// The emulator has ended.
    #[error("the emulator has ended")]
    Ended,
}
