//! Motion: from a CNC program to time-stamped set-points; single axes and cams.
//!
//! One type per stage, each stage an iterator over the one before it, so that memory is bounded by the look-ahead
//! window and never by the length of the program:
//! [`din66025::Decoder`] or [`rs274::Decoder`] → [`path::PathElement`] → [`prepare`] → [`interpolate::Interpolator`] →
//! [`interpolate::ToolSetpoint`].
//!
//! Inside, lengths are metres and times seconds; millimetres become metres once, in the decoder.

pub mod axis;
pub mod cam;
pub mod decode;
pub mod din66025;
pub mod dxf;
pub mod info;
pub mod interpolate;
pub mod limit;
pub mod path;
pub mod prepare;
pub mod profile;
pub mod refeed;
pub mod rs274;

mod number;
mod place;
mod short;

pub use place::Place;
