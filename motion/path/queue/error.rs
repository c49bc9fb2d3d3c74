//! Errors of queue files.

use super::{MAX_BLOCK_BYTES, VERSION};
use crate::Place;
use std::io;

/// Error of reading a queue file. `offset` is the byte of the file at which it was found.
#[derive(Debug, thiserror::Error)]
pub enum QueueReadError {
    /// Reading fails.
    #[error("byte {offset}: the queue cannot be read")]
    Io {
        /// Bytes read before.
        offset: u64,
        /// Error of the reader.
        #[source]
        source: io::Error,
    },
    /// The file begins with something else.
    #[error("byte {0}: this is not a queue file")]
    NotAQueue(u64),
    /// Another version of the layout.
    #[error("byte {offset}: the queue has version {version}; version {VERSION} can be read")]
    Version {
        /// Offset of the version.
        offset: u64,
        /// The file's version.
        version: u16,
    },
    /// The file ends before its end record is complete.
    #[error("byte {0}: the queue ends in the middle, its end record is missing")]
    Truncated(u64),
    /// Something follows the end record.
    #[error("byte {0}: something follows the end of the queue")]
    Trailing(u64),
    /// Neither a block nor the end begins where one must.
    #[error("byte {offset}: {tag:#04x} begins neither a block nor the end record")]
    Tag {
        /// Its offset in the file, bytes.
        offset: u64,
        /// The byte that is there.
        tag: u8,
    },
    /// A block that is empty or too long.
    #[error("byte {offset}: a block of {length} bytes; it must have 1 to {MAX_BLOCK_BYTES}")]
    BlockLength {
        /// Offset of the length.
        offset: u64,
        /// The length.
        length: u32,
    },
    /// The data read differ from the data written.
    #[error("byte {0}: the checksum is wrong, the queue is damaged before here")]
    Checksum(u64),
    /// The end record counts other elements than there were.
    #[error("byte {offset}: the queue says it has {expected} elements, it has {found}")]
    Count {
        /// Offset of the count.
        offset: u64,
        /// Number in the end record.
        expected: u64,
        /// Number read.
        found: u64,
    },
    /// The checksums are right and the content makes no sense all the same: another program wrote it.
    #[error("byte {offset}: {error}")]
    Content {
        /// Its offset in the file, bytes.
        offset: u64,
        /// The error.
        error: ContentError,
    },
}

/// A field of an element, or of the header, that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ContentError {
    /// The block ends within an element.
    #[error("the block ends within an element")]
    Incomplete,
    /// A number without a meaning.
    #[error("{value} is not a valid {field}")]
    Unknown {
        /// The field.
        field: &'static str,
        /// The value found.
        value: u8,
    },
    /// A coordinate, angle or limit that is not finite.
    #[error("a number of an element is {0}, not a finite one")]
    NotFinite(f64),
    /// An ellipse that goes around more often than once.
    #[error("an ellipse turns by {0} rad; it can go around once")]
    Turns(f64),
}

/// Error of writing a queue file.
#[derive(Debug, thiserror::Error)]
pub enum QueueWriteError {
    /// Writing fails.
    #[error("the queue cannot be written")]
    Io(#[from] io::Error),
    /// An element that no reader would take. The queue is as if it had not been given.
    #[error("{place}: {error}")]
    Content {
        /// The element's block.
        place: Place,
        /// The error.
        error: ContentError,
    },
}
