//! Decoder options: units, positions, work offsets, tools, path mode.

use super::{Control, FlowLimits, ParameterFile, Surroundings, ToolTable};
use nalgebra::Isometry3;
use std::path::PathBuf;
use twin_path::ExtraPosition;

/// Units of length of a program or a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LengthUnit {
    /// G21.
    #[default]
    Millimetre,
    /// G20.
    Inch,
}

impl LengthUnit {
    /// `length` in m.
    pub(crate) fn to_metres(self, length: f64) -> f64 {
        match self {
            Self::Millimetre => length / 1e3,
            Self::Inch => length * 0.0254,
        }
    }

    /// `metres` in this unit.
    pub(crate) fn convert_metres(self, metres: f64) -> f64 {
        match self {
            Self::Millimetre => metres * 1e3,
            Self::Inch => metres / 0.0254,
        }
    }
}

/// Position of all axes, or an offset of all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Position {
    /// X, Y, Z, m.
    pub linear: [f64; 3],
    /// A, B, C, degrees.
    pub rotary: [f64; 3],
    /// U, V, W, m.
    pub parallel: [f64; 3],
}

impl Position {
    /// The position X, Y, Z, m, and P Q U V W ([`twin_path::EXTRA_AXES`]), degrees and mm. It gives C the position of
    /// U until the program moves U.
    pub fn new(linear: [f64; 3], [a, b, c, v, w]: ExtraPosition) -> Self {
        Self { linear, rotary: [a, b, c], parallel: [0.0, v * 1e-3, w * 1e-3] }
    }

    /// Position of the extra axes P Q U V W ([`twin_path::EXTRA_AXES`]): A, B, C or U, V, W, degrees and mm. One of C
    /// and U is 0: a program moves either of them.
    pub fn extra_axes(&self) -> ExtraPosition {
        let ([a, b, c], [u, v, w]) = (self.rotary, self.parallel.map(|length| length * 1e3));
        [a, b, c + u, v, w]
    }

    /// X, Y, Z, A, B, C, U, V, W, m and degrees.
    pub(super) fn axes(&self) -> [f64; 9] {
        let ([x, y, z], [a, b, c], [u, v, w]) = (self.linear, self.rotary, self.parallel);
        [x, y, z, a, b, c, u, v, w]
    }

    /// The position with these [`Self::axes`].
    pub(super) fn from_axes([x, y, z, a, b, c, u, v, w]: [f64; 9]) -> Self {
        Self { linear: [x, y, z], rotary: [a, b, c], parallel: [u, v, w] }
    }
}

/// Reference point of the positions of the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ToolReference {
    /// The controlled point: what the axes move, for which G43 lifts the path by the length of the tool. It never
    /// jumps.
    #[default]
    ControlPoint,
    /// The tip of the tool in force. It jumps ([`twin_path::ElementKind::Jump`]) where G43 and G49 change the length.
    Tip,
}

/// Path mode: exact path or blending (G61, G64). It has no effect on the path elements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PathMode {
    /// G61: exactly as programmed.
    ExactPath,
    /// G61.1: exactly as programmed, with a stop at the end of each move.
    ExactStop,
    /// G64: as fast as possible.
    #[default]
    Continuous,
    /// G64 P: as fast as possible within a tolerance.
    Tolerance {
        /// P: largest distance from the programmed path, m.
        path: f64,
        /// Q: tolerance within which short lines may be joined, m; LinuxCNC takes P if it is left out.
        naive_cam: Option<f64>,
    },
}

/// Options of a decoder: the values that LinuxCNC keeps in its parameter and machine files.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "options, each on or off")]
pub struct DecoderOptions {
    /// Position of the machine at the beginning, work frame.
    pub start: Position,
    /// Units until the first G20 or G21.
    pub units: LengthUnit,
    /// Velocity of rapids (G0), m/s.
    pub rapid_velocity: f64,
    /// Acceleration along the path, m/s². The language has no word for it.
    pub acceleration: f64,
    /// Deceleration along the path, m/s².
    pub deceleration: f64,
    /// The frame of the path (X, Y, Z) in the machine frame, m: the work frame. Its identity, the default, makes both
    /// the same. G53, G28 and G30 go to positions in the machine frame; all other positions are in the work frame.
    pub work_frame: Isometry3<f64>,
    /// Origins of the coordinate systems G54 to G59.3 in the work frame. The program begins in G54.
    pub work_offsets: [Position; 9],
    /// Target of G28, machine frame.
    pub g28: Position,
    /// Target of G30, machine frame.
    pub g30: Position,
    /// Parameters at the beginning, such as those of LinuxCNC's parameter file; they replace `work_offsets`, `g28` and
    /// `g30` where they are given. The program begins in the coordinate system of #5220, and with the offset of G92 if
    /// #5210 is not 0. Lengths are in `units`.
    pub parameters: ParameterFile,
    /// The tools. Without a table every tool has length zero, with a warning at G43.
    pub tools: Option<ToolTable>,
    /// Number of the tool in the spindle at the beginning, 0 = none.
    pub tool: u32,
    /// Tool offset in force at the beginning, until the first G43 or G49: LinuxCNC keeps it from program to program.
    pub tool_offset: Position,
    /// Reference point of the positions of the path.
    pub reference: ToolReference,
    /// Surroundings that a probe can touch (G38.2 to G38.5). Without them probing moves go to their ends, with a
    /// warning.
    pub surroundings: Option<Surroundings>,
    /// Waiting time behind a probing move, ns: for drives that follow late.
    pub probe_settle_ns: i64,
    /// Leaves out the blocks that begin with `/`. Their contents are not checked.
    pub skip_suppressed_blocks: bool,
    /// Folders in which the files of subroutines are searched for, in this order: `NAME.ngc` for `o<name> call`.
    pub subroutine_folders: Vec<PathBuf>,
    /// Limits of loops and calls.
    pub flow_limits: FlowLimits,
    /// The control that the program is meant for: what it refuses, leaves out or reads differently is a finding.
    pub control: Option<Control>,
    /// The control whose numbers the program has (G4, M98, G70 and G71, F with rotary axes), if it is another one.
    pub numbers_of: Option<Control>,
    /// Refuses what LinuxCNC refuses, also where shops run it on other controls.
    pub strict: bool,
    /// Moves that go nowhere are elements too, as in LinuxCNC's interpreter; else they are left out, as its planner
    /// does, but for probing moves, of which it says how they ended. The path stops at elements of length zero.
    pub keep_empty_moves: bool,
    /// Elements carry the speed S and the axes that their block names ([`twin_path::Details`]), for
    /// [`super::ProgramWriter`].
    pub keep_words: bool,
}

impl Default for DecoderOptions {
    /// LinuxCNC's defaults where there are any: all offsets zero. Rapids with 0.1 m/s, accelerations of 0.1 m/s².
    fn default() -> Self {
        Self {
            start: Position::default(),
            units: LengthUnit::default(),
            rapid_velocity: 0.1,
            acceleration: 0.1,
            deceleration: 0.1,
            work_frame: Isometry3::identity(),
            work_offsets: [Position::default(); 9],
            g28: Position::default(),
            g30: Position::default(),
            parameters: ParameterFile::default(),
            tools: None,
            tool: 0,
            tool_offset: Position::default(),
            reference: ToolReference::default(),
            surroundings: None,
            probe_settle_ns: 0,
            skip_suppressed_blocks: false,
            subroutine_folders: Vec::new(),
            flow_limits: FlowLimits::default(),
            control: None,
            numbers_of: None,
            strict: false,
            keep_empty_moves: true,
            keep_words: false,
        }
    }
}
