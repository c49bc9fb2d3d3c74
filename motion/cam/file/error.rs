//! What goes wrong with `*.CAM` files.

use super::super::error::CamError;
use std::io;

/// Why a file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum CamReadError {
    /// The file could not be read.
    #[error("byte {offset}: {source}")]
    Io {
        /// Where.
        offset: u64,
        /// Why.
        source: io::Error,
    },
    /// It does not begin as a cam does.
    #[error("byte {offset}: this is no cam file")]
    NotACam {
        /// The first byte that is wrong.
        offset: u64,
    },
    /// It is of another version.
    #[error(
        "version {}.{} of cam files is not known, 1.0 and 1.3 are (error 2203)",
        .version & 0xff, .version >> 8
    )]
    Version {
        /// Its version.
        version: u16,
    },
    /// It has been compiled in a way that is none of the manual's (4.7): not as polynomial (3), equidistant (1) or pairs (2).
    #[error("byte {offset}: {value} is no type of cams (error 2202)")]
    CompileType {
        /// Where.
        offset: u64,
        /// Its `byType`.
        value: u8,
    },
    /// It ends too early.
    #[error("byte {offset}: the file ends within the cam (error 2204)")]
    Truncated {
        /// Where it ends.
        offset: u64,
    },
    /// A checksum is wrong: the file has been damaged.
    #[error("byte {offset}: the checksum is wrong")]
    Checksum {
        /// Where the checksum stands.
        offset: u64,
    },
    /// Something follows the end.
    #[error("byte {offset}: something follows the end of the cam")]
    Trailing {
        /// Where.
        offset: u64,
    },
    /// A number has no meaning here.
    #[error("byte {offset}: {value} is no {field}")]
    Unknown {
        /// Where.
        offset: u64,
        /// What it should be.
        field: &'static str,
        /// What it is.
        value: u64,
    },
    /// A number that cannot be stands before this place.
    #[error("byte {offset}: before it {value} stands as {field}")]
    NoNumber {
        /// Behind it.
        offset: u64,
        /// What it should be.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// The elements make another curve than the cam's points.
    #[error("byte {offset}: the elements before it are not those of the cam")]
    OtherElements {
        /// Where what stands beside the cam ends.
        offset: u64,
    },
    /// There is more than a cam may have.
    #[error("byte {offset}: {value} {field} are more than {limit} (error 2201)")]
    TooMany {
        /// Where.
        offset: u64,
        /// Of what.
        field: &'static str,
        /// How many.
        value: u64,
        /// The most there may be.
        limit: u64,
    },
    /// What it describes is no cam.
    #[error(transparent)]
    Cam(#[from] CamError),
}

impl CamReadError {
    /// The manual's number (`SMC_ReadCAM`, 9.3); none for what it has no number for.
    pub const fn number(&self) -> Option<u16> {
        match self {
            Self::TooMany { .. } => Some(2201),
            Self::CompileType { .. } => Some(2202),
            Self::Version { .. } => Some(2203),
            Self::Truncated { .. } => Some(2204),
            Self::Io { .. }
            | Self::NotACam { .. }
            | Self::Checksum { .. }
            | Self::Trailing { .. }
            | Self::Unknown { .. }
            | Self::NoNumber { .. }
            | Self::OtherElements { .. }
            | Self::Cam(_) => None,
        }
    }
}

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum CamWriteError {
    /// The file could not be written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// There is more than a file may have.
    #[error("{value} {field} are more than {limit}")]
    TooMany {
        /// Of what.
        field: &'static str,
        /// How many.
        value: usize,
        /// The most there may be.
        limit: usize,
    },
}
