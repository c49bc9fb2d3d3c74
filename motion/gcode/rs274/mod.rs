//! RS274/NGC dialect, the language of CAM output: decodes program text to path elements as LinuxCNC's interpreter does.
//!
//! ```text
//! %                                   optional; then a second % or M2/M30 ends the program
//! N10 G21 G90 G54 (comment)           any number of words in any order, at most one G word of each modal group
//! G0X0Y0Z5 ; comment
//! G1 Z-1 F200                         F per minute
//! X10.5 Y-3                           G1 goes on
//! ```
//!
//! Within a line the order of words does not matter; they act in LinuxCNC's order: feed mode, F, speed mode, S, T, M62
//! to M68, M6 or M61, M3 to M5 and M19, M70 to M73, M7 to M9, M48 to M53, M100 to M199, G4, plane, units, diameters,
//! G40, tool length, coordinate system, path mode, distance modes, retract mode, G10, G28, G30, G52 and G92, G92.1 to
//! G92.3, motion, stop. Hence F in a line with G20 or G21 is in the units of the line before.
//!
//! Understood: G0 to G3 (I J K or R, P turns) in G17 to G19.1, G4 to G5.3, G7, G8, G10 (L0, L1, L2, L10, L11, L20), G20,
//! G21, G28, G28.1, G30, G30.1, G33, G33.1, G38.2 to G38.5, G40 to G42.1, G43 to G43.2, G49, G52 to G59.3, G61, G61.1,
//! G64, G73, G74, G76, G80 to G89, G90, G91, G90.1, G91.1, G92 to G92.3, G93 to G99, M0 to M9, M19, M30, M48 to M53,
//! M60 to M68, M70 to M73, M98 to M199, F, S, T, D, E, H, N, `$`, A B C for rotary axes (as the extra axes P Q U, in
//! degrees), U V W (as those of these names, in mm; a program moves either C or U). Every other word is an error that names it ([`DecodeError::rule`](crate::decode::TextError::rule) is
//! [`UnsupportedWord`](crate::decode::Rule::UnsupportedWord)); nothing is skipped but comments.
//!
//! Values are numbers, parameters (`#1`, `#<name>`), functions and expressions in brackets; see `expression.rs` and
//! `parameters.rs`. O words are loops, conditions and subroutines, also in files of
//! [`DecoderOptions::subroutine_folders`], and M98 calls subroutines that end with M99; see `flow/mod.rs`. Loops without end
//! are errors ([`FlowLimits`]). Lines that may be executed again are kept in memory, those of other programs are not.
//! Messages (MSG, DEBUG, PRINT, ...) are notes with their text and are not carried out. Elements of a subroutine file
//! have its line, and that of the call ([`Place::within`](twin_path::Place::within)).
//!
//! M words: M0, M1, M3 to M9, M19, M60 and M61 are elements at which the path waits
//! ([`ElementKind::MFunction`](twin_path::ElementKind::MFunction)), so that a spindle has its speed and coolant flows
//! before the tool cuts; M3 and M4 carry the speed S as their parameter K, M6 and M61 the tool's number, M19 its angle R in
//! degrees (and its direction P as L). M2 and M30 end the program; spindle and coolant that are on stop there (M5, M9),
//! the spindle also before M6. S alone, T alone, G61 and G64 change no path; see [`Decoder::spindle_speed`],
//! [`Decoder::tool`] and [`Decoder::path_mode`].
//!
//! Spindle: feeds per revolution (G95, G33, G33.1, G76) become feeds along the path for the speed S, whether or not the
//! spindle is at that speed; the angle of the spindle is not part of the path. With G96 the speed follows from the
//! radius X: a cut has the lower speed of its two ends, M3 and M4 have that of the place. Canned cycles and G33.1 stop
//! and turn the spindle with M3, M4, M5 and M19.
//!
//! M62 to M68 and M100 to M199 are such elements as well, with their words as parameters (`input_output.rs`): the path
//! stops there, also at M62, M63 and M67, which LinuxCNC carries out in motion. M70 to M73 save and restore modes, and
//! M48 to M53 set switches that only parameters show (`modes.rs`). Splines (G5 to G5.3) are cubics; see `spline.rs`.
//!
//! Probing moves (G38.2 to G38.5, [`ElementKind::Probe`](twin_path::ElementKind::Probe)) end where the probe trips,
//! as computed from the [`Surroundings`]; the program goes on from there. A probe that does not trip where it must
//! (G38.2, G38.4), or that has tripped before it moves, is an error, as in LinuxCNC's motion controller. The path stops
//! at that point; the overshoot of a machine until it is at rest, v² / 2a, is left out. Without surroundings the path
//! goes to the programmed end, with a warning.
//!
//! Differences from LinuxCNC 2.9, whose rules apply otherwise (its documentation, and its interpreter run over
//! `tests/linuxcnc.rs`, random programs and a corpus of CAM output):
//! - What shops run on other controls is read with a warning ([`Leniency`]). K0 (J0, I0) along the normal of an arc's
//!   plane has no effect. [`DecoderOptions::strict`] refuses all of this.
//! - A compensated move that waits for the next one is done at the end of the file too, and at a second %. LinuxCNC leaves
//!   it out there.
//! - Limits: lines may have [`MAX_LINE_BYTES`] instead of 253, one canned cycle block and G76 make at most
//!   [`MAX_CYCLE_MOVES`], a NURBS has at most [`MAX_CONTROL_POINTS`], and loops and calls end ([`FlowLimits`]).
//! - Motions that would never end are errors: pitches that are not above 0, feeds per revolution without a speed (which
//!   LinuxCNC checks for G1 to G3 only), F0 in inverse time, for which LinuxCNC takes 0.1 units per minute.
//! - G88, which LinuxCNC's documentation leaves undefined, leaves the hole with a rapid behind its stop M0. In LinuxCNC
//!   the next rapid begins at the bottom.
//! - Arcs in G18 and G19 in a rotated coordinate system (G10 L2 R) are errors: no plane of a path contains them.
//! - Programs that name both C and U are errors, and so is a spindle `$` other than 0 and -1: both letters are one axis,
//!   and the machine has one spindle.
//! - A NURBS needs weights above 0 also in its first block, takes no Z A B C U V W, and must end with G5.3 before another motion
//!   and before the end of the program; LinuxCNC leaves out such words and curves. Its control points stay where they are
//!   when units or offsets change before G5.3.
//! - Where the interpreter contradicts its documentation, the documentation counts:
//!   - `continue` and `break` end a pass and a loop. The interpreter's `break` of a `while` loop also ends the next `do`
//!     loop, and a `break` that is passed over between `continue` and the end of its `do` loop counts.
//!   - A block in inverse time (G93) takes the time that its F says, also a probing move and a curve. The interpreter's
//!     lowest feed makes short moves faster, and it probes and follows curves with the feed in force before.
//!   - Arcs are full circles if start and end are the same, to 1 µm. The interpreter makes full circles of flat arcs.
//!   - G74 and G84 tap along the normal of G18 and G19 too. The interpreter mixes up their axes.
//!   - I, J and K of G76 are diameters or radii. The interpreter halves or doubles them once more behind G7 or G8.
//!   - M19 without R and P turns the spindle to 0°, G33.1 moves X, Y and Z, and M67 and M68 need Q. The interpreter leaves
//!     out M19 and rotary words of G33.1, and sets outputs without Q to -1.
//!   - Axes that a block does not name stay. The interpreter moves them when G10 has rotated a system while G92 is in
//!     force, and behind a program that sets #5210 to #5219.
//!   - P of G10 is a whole number. The interpreter truncates fractions of 0.5 and more.
//!   - M72 and M73 restore F and S as they were. The interpreter rounds them, and leaves out words next to M72, which are
//!     an error here.

#![allow(
    clippy::indexing_slicing,
    reason = "arrays of the coordinates of axes and nine coordinate systems, indexed by values of these types"
)]

mod arc;
mod block;
mod compensation;
mod control;
mod cycle;
mod decoder;
mod error;
mod expression;
mod flow;
mod input_output;
mod leniency;
mod lexer;
mod message;
mod modes;
mod offsets;
mod options;
mod output;
mod parameter_file;
mod parameters;
mod probe;
mod refeed;
mod settings;
mod source;
mod spindle;
mod spline;
mod state;
#[cfg(test)]
mod tests;
mod thread;
mod tool_table;
mod travel;
mod word;
mod work_frame;
mod write;

pub use control::{CONTROL_WORDS, Cell, Control, ControlFinding, ControlWord, Reading};
pub use cycle::MAX_CYCLE_MOVES;
pub use decoder::{Decoder, MAX_LINE_BYTES};
pub use error::{DecodeError, Diagnostic, Failure, Item};
pub use expression::ExpressionError;
pub use flow::{FlowError, FlowLimits};
pub use leniency::Leniency;
pub use message::Message;
pub use options::{DecoderOptions, LengthUnit, PathMode, Position, ToolReference};
pub use parameter_file::{ParameterFile, ParameterFileError};
pub use parameters::ParameterError;
pub use probe::{ProbePath, ProbeTarget, Surroundings};
pub use refeed::{refeed, refeed_repeated};
pub use settings::OffsetError;
pub use spline::{MAX_CONTROL_POINTS, TOLERANCE as SPLINE_TOLERANCE};
pub use tool_table::{Tool, ToolTable, ToolTableError};
pub use write::{ProgramWriter, WriteError, WriteOptions};
