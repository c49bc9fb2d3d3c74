//! Cams in files: `*.CAM` (`SMC_ReadCAM`, `SMC_WriteCAM`, manual 4.4.3 and 10.3), tables of positions as text, and cams
//! written by hand.
//!
//! The manual does not say what is in a `*.CAM` file, so this is our own layout. Numbers are little-endian, floating-point
//! numbers IEEE 754 doubles, bit for bit as they were; the name is its length in bytes (u32) and UTF-8.
//!
//! ```text
//! header   20  8 magic · u16 version · u8 byType · u8 flags (1 periodic) · u32 length of the payload · u32 CRC-32 of these 16
//! payload      name · per type what follows · u32 number of tappets · tappets
//!   type 3     u32 number of points · per point X, Y, V, A
//!   type 1     u8 byVarType · u8 interpolation · start · end · slave scale (4 numbers) · u32 number of values · values
//!   type 2     u8 byVarType · u8 interpolation · master scale · slave scale · u32 number of pairs · pairs
//!   tappet     i16 group · u8 passage · u8 action · master · i64 delay ns · i64 duration ns
//! end       4  u32 CRC-32 of the payload
//! ```
//!
//! Nothing follows. So a file that is cut anywhere, has one byte more or less, or one bit changed, is told from a whole
//! one, and nothing is read from it.

mod ascii;
mod binary;
mod error;
mod text;
mod text_writer;

pub use ascii::{AsciiError, MAX_LINES, read_ascii, read_knots, reduce, write_ascii};
pub use binary::{VERSION, read, write};
pub use error::{CamReadError, CamWriteError};
pub use text::{TextError, read_text};
pub use text_writer::write_text;

/// The most points a file may have (`gc_SMC_FILE_MAXCAMEL`).
pub const MAX_ELEMENTS: u32 = 1 << 20;

/// The most tappets a file may have (`gc_SMC_FILE_MAXCAMTAP`).
pub const MAX_TAPPETS: u32 = 1 << 16;
