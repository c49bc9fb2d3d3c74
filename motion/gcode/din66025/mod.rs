//! SoftMotion's DIN 66025 dialect (manual 3.2): decodes program text to path elements, `SMC_NCDecoder`.
//!
//! ```text
//! % name                              the first line
//! N10 G1 X100 Y100 F100 E100 E-200    one block per line: N word, at most one G word, then any others
//! ```
//!
//! Lengths are mm, velocities (F) mm/s, accelerations (E above zero, and below zero for decelerating) mm/s². Case,
//! leading zeros and blanks between words do not matter. `(…)` is a comment, `/` at the beginning marks a block that
//! may be suppressed.
//!
//! The words of a block act from right to left: every word but G stores its number, the leftmost of its letter last,
//! and then G reads them. F, E, D, S, the modes and the target are modal; I, J, K, L, M, O, R and H hold for one block.
//! Without a G word the last path command (G0 to G3, G5, G6, G8, G9) repeats, G1 at first.
//!
//! `$name$` in place of a number is a variable ([`Variables`]): its value is looked up when its line is decoded, and
//! G36 and G37 change it. G20 jumps to another block, so the same line may be decoded many times.
//!
//! Decisions where the manual is silent:
//! - A block without N word is executed; the first of a program gets a warning, since the manual requires the word.
//! - A second `%`, alone in its line, ends the program, as in other dialects; it gets a note, or a warning if lines
//!   follow, which are not read.
//! - A comment ends in its line, as the block does.
//! - A block without a coordinate (and, for an arc, without I, J or R) makes no path object: `N50 G1 F100` sets the
//!   motion and the feed. A block whose target is the present position makes an object of length zero.
//! - X, Y, Z, I, J, R in a block with G90, G91, G98 or G99 would act at some later motion; they are errors.
//! - G92 is absolute also under G91; coordinates it leaves out stay.
//! - An M function acts where its block has led the tool: after the block's motion.
//! - A switch needs its place (L or O) on its right in the same block; a switch beyond its object is an error.
//! - G20 looks for the first block of its number from the beginning of the program. A block that is suppressed can be a
//!   target; the next one is then executed.
//! - G41 and the like begin with the next object, G40 and the like end behind the last one; of two that exclude one
//!   another before any object the later counts.
//! - The sign of R has no meaning (and gets a warning): an arc by R is never larger than a semicircle.
//! - Start and end are on one circle if their distances from the centre differ by at most 5 µm, which numbers of
//!   three decimals need.
//! - An arc by R from a point to itself has no centre; like other impossible arcs it becomes a straight line.

mod arc;
mod block;
mod curve;
mod decoder;
mod emit;
mod error;
mod idle;
mod lexer;
mod output;
mod refeed;
mod scan;
mod state;
#[cfg(test)]
mod tests;
mod variables;
mod word;
mod write;

pub use decoder::{DEFAULT_JUMPS, Decoder, DecoderOptions, MAX_LINE_BYTES};
pub use error::{DecodeError, Diagnostic, Failure, Item};
pub use refeed::refeed;
pub use scan::marks_in;
pub use variables::Variables;
pub use write::{ProgramWriter, WriteError};

use crate::number;
