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
//! Version 1.0 ends the payload with the tappets. Version 1.3 goes on with what is known beside the cam ([`Beside`]):
//!
//! ```text
//! beside       u8 kind (1 cam, 2 tappets only) · u8 put end to end · scale of the master · scale of the slave · u8 1 and the
//!              period, or 0 · u8 1 and elements, or 0 · 9 numbers of the coupling · u8 start mode · u8 1 and 4 numbers, or 0
//!   scale      min · max · step · unit as the name
//!   elements   u32 number of them · per element u8 1 point and X, Y, V, A, or 2 line and X, Y of both ends
//!   coupling   MasterOffset, MasterScaling, SlaveOffset, SlaveScaling, VelocityDiff, Acceleration, Deceleration,
//!              TappetHysteresis, DeadTimeCompensation; the 4 are offsets and scalings that are wanted, master first
//! ```
//!
//! Nothing follows. So a file that is cut anywhere, has one byte more or less, or one bit changed, is told from a whole
//! one, and nothing is read from it.

mod ascii;
mod beside;
mod binary;
mod error;
mod text;
mod text_writer;

pub use ascii::{AsciiError, MAX_LINES, clean, read_ascii, read_knots, reduce, write_ascii};
pub use beside::Beside;
pub use binary::{VERSION, VERSION_BESIDE, read, read_beside, write, write_beside};
pub use error::{CamReadError, CamWriteError};
pub use text::{TextError, read_text};
pub use text_writer::write_text;

/// The most points a file may have (`gc_SMC_FILE_MAXCAMEL`).
pub const MAX_ELEMENTS: u32 = 1 << 20;

/// The most tappets a file may have (`gc_SMC_FILE_MAXCAMTAP`).
pub const MAX_TAPPETS: u32 = 1 << 16;
