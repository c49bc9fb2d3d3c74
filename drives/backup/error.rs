//! Errors of parameter backups: faults in a backup file, and failures while restoring it.

use std::io;

use crate::{DriveError, ParameterId, Values};

/// A file of parameters that cannot be written, read or put back.
#[derive(Debug, thiserror::Error)]
pub enum BackupError {
    /// The file cannot be written (`SMC_WDPF_CANNOT_CREATE_FILE`).
    #[error("{file}: cannot be written: {source}")]
    Write {
        /// Name of the file.
        file: String,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The file cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// Name of the file.
        file: String,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The device does not report its parameters (`SMC_WDPF_ERROR_WHEN_READING_PARAMS`).
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// The device does not list its parameters (`SMC_WDPF_TIMEOUT_PREPARING_LIST` if it does not answer).
    #[error(transparent)]
    List(DriveError),
    /// Lines are wrong, all of those that are.
    #[error("{}", lines(.0))]
    Lines(Vec<LineError>),
}

fn lines(errors: &[LineError]) -> String {
    let texts: Vec<_> = errors.iter().map(ToString::to_string).collect();
    texts.join("\n")
}

impl BackupError {
    /// Number of the manual's `SMC_Error`; `None` where it has none.
    pub fn number(&self) -> Option<u16> {
        match self {
            Self::Write { .. } => Some(3002),
            Self::List(DriveError::Timeout { .. }) => Some(3004),
            Self::Drive(_) | Self::List(_) => Some(3003),
            Self::Read { .. } | Self::Lines(_) => None,
        }
    }
}

/// A line that is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}: {fault}")]
pub struct LineError {
    /// Name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: u32,
    /// The fault.
    pub fault: LineFault,
}

/// Fault of a line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LineFault {
    /// No such file begins like this.
    #[error("this is not a file of drive parameters")]
    Unknown,
    /// A later version, or none.
    #[error("version {found:?} is not known (1)")]
    Version {
        /// Name that the file gives.
        found: String,
    },
    /// Something is missing.
    #[error("{what} is missing")]
    Missing {
        /// Missing part.
        what: &'static str,
    },
    /// A word is not a number, or one that does not fit.
    #[error("{what}: {word:?} is not a whole number from {low} to {high}")]
    Number {
        /// Expected form.
        what: &'static str,
        /// Text of the file.
        word: String,
        /// Smallest.
        low: i64,
        /// Largest.
        high: i64,
    },
    /// There is more than should be there.
    #[error("{word:?} is not expected here")]
    Unexpected {
        /// Text of the file.
        word: String,
    },
    /// The parameters of another family.
    #[error("these are parameters of {found}, the device is {expected}")]
    Family {
        /// Family of the file.
        found: String,
        /// Family of the device.
        expected: String,
    },
    /// The device has no such parameter.
    #[error("the device has no {id}")]
    NoParameter {
        /// Number of the parameter.
        id: ParameterId,
    },
    /// The same parameter is given before.
    #[error("{id} is given in line {first} already")]
    Twice {
        /// Number of the parameter.
        id: ParameterId,
        /// First line that gives it.
        first: u32,
    },
    /// The parameter cannot have this value.
    #[error("{id} ({name}) = {value} is impossible ({values})")]
    Value {
        /// Number of the parameter.
        id: ParameterId,
        /// Name that the device gives it.
        name: String,
        /// The value.
        value: i64,
        /// Values that it takes.
        values: Values,
    },
}

/// Error that ends a restore. Values that were written before stay written.
#[derive(Debug, thiserror::Error)]
pub enum RestoreError {
    /// The device refuses a parameter or does not answer.
    #[error("{id} ({name}) = {value}: {source}; {written} of {all} changes have been made")]
    Write {
        /// Number of the parameter.
        id: ParameterId,
        /// Name that the device gives it.
        name: String,
        /// The value.
        value: i64,
        /// Changes made before.
        written: usize,
        /// Changes that were to be made.
        all: usize,
        /// Error of the device.
        source: Box<DriveError>,
    },
    /// A parameter does not say what was written, once all have been.
    #[error("{id} ({name}) reads {found} after {value} was written")]
    Differs {
        /// Number of the parameter.
        id: ParameterId,
        /// Name that the device gives it.
        name: String,
        /// Written.
        value: i64,
        /// Read back.
        found: i64,
    },
    /// The device cannot be read back, or does not keep its parameters.
    #[error(transparent)]
    Drive(#[from] DriveError),
}
