//! What goes wrong with the files of cams.

use crate::section::MachineFileError;
use std::io;
use std::path::PathBuf;
use twin_motion::cam::CamError;
use twin_motion::cam::file::{AsciiError, CamReadError, CamWriteError, TextError};

/// Why a cam cannot be read from a file, or written to one.
#[derive(Debug, thiserror::Error)]
pub enum CamFileError {
    /// The ending says no format.
    #[error("{}: cams are read and written as .toml, .csv, .cam, .asc or .txt", path.display())]
    Ending {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be read: `SMC_RCAM_FILE_DOESNT_EXIST` (manual 9.3), as `SMC_ReadCAM` tells it.
    #[error("cannot read cam {}: {source} (error 2200)", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A recorded run cannot be read.
    #[error("cannot read run {}: {source}", path.display())]
    ReadRun {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A TOML file says something that is not right.
    #[error(transparent)]
    Toml(#[from] MachineFileError),
    /// A cam in lines of words does.
    #[error("{}: {source}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// What, with its line.
        source: TextError,
    },
    /// A table as text does.
    #[error("{}: {source}", path.display())]
    Ascii {
        /// The file.
        path: PathBuf,
        /// What, with its line.
        source: AsciiError,
    },
    /// A `.CAM` file does.
    #[error("{}: {source}", path.display())]
    Binary {
        /// The file.
        path: PathBuf,
        /// What, with its byte.
        source: CamReadError,
    },
    /// A table with commas has something else than it should.
    #[error("{}: line {line}: {message}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Which line, from 1.
        line: u64,
        /// Column, value and what it should be.
        message: String,
    },
    /// What the file says makes no cam.
    #[error("{}: {source}", path.display())]
    Cam {
        /// The file.
        path: PathBuf,
        /// Why.
        source: CamError,
    },
    /// A cam does not fit into a file.
    #[error("{}: {source}", path.display())]
    Large {
        /// The file.
        path: PathBuf,
        /// Why.
        source: CamWriteError,
    },
    /// A cam cannot be said in a format.
    #[error("{}: {message}", path.display())]
    Unsayable {
        /// The file.
        path: PathBuf,
        /// Why.
        message: &'static str,
    },
}
