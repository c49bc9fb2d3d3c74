//! CNC programs in both dialects, to path elements and back.
//!
//! [`din66025::Decoder`] and [`rs274::Decoder`] are iterators from bytes to [`twin_path::PathElement`]. Memory is bounded
//! by a block, never by the length of the program. Millimetres become metres here and nowhere else.
//!
//! ```
//! use std::io::Cursor;
//! use twin_gcode::din66025::{Decoder, DecoderOptions, Item};
//!
//! // A line of 100 mm and a quarter circle of radius 50 mm, at 100 mm/s.
//! let program = Cursor::new("% demo\nN10 G1 X100 Y0 F100 E1000 E-1000\nN20 G3 X150 Y50 I0 J50\n");
//! let mut lengths = Vec::new();
//! for item in Decoder::with_jumps(program, DecoderOptions::default()) {
//!     match item? {
//!         Item::Element(element) => {
//!             assert!((element.feed - 0.1).abs() < 1e-15, "m/s");
//!             lengths.push(element.length());
//!         }
//!         Item::Warning(warning) => println!("{warning}"),
//!     }
//! }
//! let [line, arc] = lengths[..] else { panic!("two elements expected") };
//! assert!((line - 0.1).abs() < 1e-12);
//! assert!((arc - 0.05 * std::f64::consts::FRAC_PI_2).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod decode;
pub mod din66025;
pub mod info;
mod lines;
mod number;
pub mod refeed;
pub mod rs274;
mod write_error;
