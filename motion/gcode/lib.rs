//! CNC programs in both dialects, to path elements and back.
//!
//! [`din66025::Decoder`] and [`rs274::Decoder`] are iterators from bytes to [`twin_path::PathElement`]. Memory is bounded
//! by a block, never by the length of the program. Millimetres become metres here and nowhere else.

pub mod decode;
pub mod din66025;
pub mod info;
mod number;
pub mod refeed;
pub mod rs274;
