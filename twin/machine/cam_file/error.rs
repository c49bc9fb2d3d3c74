//! Errors of cam files.

use crate::section::MachineFileError;
use std::io;
use std::path::{Path, PathBuf};
use twin_cam::CamError;
use twin_cam::file::AsciiError;

/// Errors of reading and writing cam files.
#[derive(Debug, thiserror::Error)]
pub enum CamFileError {
    /// The ending is not that of a form of cams.
    #[error(
        "{}: cams are read and written as .toml, .csv or .asc (ASCII table of SoftMotion){}",
        .0.display(), instead(.0)
    )]
    Ending(PathBuf),
    /// The file cannot be read: `SMC_RCAM_FILE_DOESNT_EXIST` of `SMC_ReadCAM` (manual 9.3).
    #[error("cannot read cam {}: {source} (error 2200)", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A recorded run cannot be read.
    #[error("cannot read run {}: {source}", path.display())]
    ReadRun {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A TOML file is invalid.
    #[error(transparent)]
    Toml(#[from] MachineFileError),
    /// A table as text is invalid.
    #[error("{}: {source}", path.display())]
    Ascii {
        /// The file.
        path: PathBuf,
        /// The cause, with its line.
        source: AsciiError,
    },
    /// A CSV table is invalid.
    #[error("{}: line {line}: {message}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Column, value and what it should be.
        message: String,
    },
    /// The content of the file is not a cam.
    #[error("{}: {source}", path.display())]
    Cam {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: CamError,
    },
    /// Tappets without a curve are to be written as a table.
    #[error("{}: tappets alone have no positions; write them as .toml", .0.display())]
    TappetsOnly(PathBuf),
}

/// Advice for a cam in a form that is not supported.
fn instead(path: &Path) -> &'static str {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("cam") => "; export a binary .cam file as ASCII table from the program that wrote it",
        Some("txt") => {
            "; rename a table of lines `master;slave` to .asc, write other cams as .toml"
        }
        _ => "",
    }
}
