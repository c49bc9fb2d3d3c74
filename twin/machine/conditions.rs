//! `[program]` and `[rs274]`: initial conditions of programs.

use crate::approach::{self, ApproachRule};
use crate::axis_pace::{ACCELERATION, Along, AxisPace, RAPID_VELOCITY};
use crate::section::Section;
use crate::text::Text;
use crate::tool_table;
use std::path::Path;
use std::sync::Arc;
use twin_gcode::rs274::{self, Control, LengthUnit, ParameterFile, ParameterFileError, Position};
use twin_path::ExtraPosition;
use twin_path::prepare::{CircularLimits, Preparation, Rounding, Smoothing, ToolRadiusOptions};

/// Turns of the path up to this angle are passed without a stop unless the machine file says otherwise, rad.
const ANGLE_TOLERANCE: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Gouge tolerance, m: programs in micrometres round by as much.
const GOUGE_TOLERANCE: f64 = 1e-6;

/// Keys of the coordinate systems.
const SYSTEMS: [&str; 9] = ["g54", "g55", "g56", "g57", "g58", "g59", "g59_1", "g59_2", "g59_3"];

/// Initial conditions of programs.
#[derive(Clone, Debug)]
pub struct ProgramConditions {
    /// Default start of programs that do not give one (G92), work frame, m.
    pub start: [f64; 3],
    /// And the additional axes P Q U V W, u.
    pub start_additional: ExtraPosition,
    /// The way of the drives to the start.
    pub approach: ApproachRule,
    /// Turns of the path up to this angle are passed without a stop, rad.
    pub angle_tolerance: f64,
    /// True if there are stops at all: rapids, sharper turns, M functions and dwells. Only comparisons do without.
    pub stops: bool,
    /// Further inputs of preparation.
    pub preparation: PreparationInputs,
    /// Initial conditions of an RS274 program, in the work frame but for G28 and G30; its start is that above.
    pub rs274: rs274::DecoderOptions,
    /// Limits of the axes for what an RS274 program leaves open; none without a machine.
    pub pace: Option<(Arc<AxisPace>, Along)>,
}

/// Inputs of the manual's preparation blocks (6.2.3 to 6.2.8); 0 or none by default, except the gouge tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparationInputs {
    /// Added to D where the tool radius is corrected, m (`SMC_ToolCorr.dToolRadius`).
    pub tool_radius: f64,
    /// Tolerance of gouges, m: the tool may come nearer to the contour than its radius by this distance.
    pub gouge_tolerance: f64,
    /// Added to D where corners are smoothed, m (`SMC_SmoothPath.dEdgeDistance`).
    pub edge_distance: f64,
    /// In place of D where corners are rounded, m; 0: D (`SMC_RoundPath.dRadius`).
    pub rounding_distance: f64,
    /// Turns up to this angle are neither smoothed nor rounded, rad.
    pub corner_angle_tolerance: f64,
    /// Limits on curves (`SMC_LimitCircularVelocities`).
    pub circular: Option<CircularLimits>,
}

impl Default for PreparationInputs {
    fn default() -> Self {
        Self {
            tool_radius: 0.0,
            gouge_tolerance: GOUGE_TOLERANCE,
            edge_distance: 0.0,
            rounding_distance: 0.0,
            corner_angle_tolerance: 0.0,
            circular: None,
        }
    }
}

impl PreparationInputs {
    /// `preparation`, as requested by a program, with these inputs.
    pub fn complete(&self, preparation: Preparation) -> Preparation {
        Preparation {
            tool_radius: preparation.tool_radius.map(|options| ToolRadiusOptions {
                radius: self.tool_radius,
                gouge_tolerance: self.gouge_tolerance,
                ..options
            }),
            smoothing: preparation.smoothing.map(|_| Smoothing {
                edge_distance: self.edge_distance,
                angle_tolerance: self.corner_angle_tolerance,
            }),
            rounding: preparation.rounding.map(|_| Rounding {
                distance: self.rounding_distance,
                angle_tolerance: self.corner_angle_tolerance,
            }),
            circular: self.circular,
            ..preparation
        }
    }
}

impl Default for ProgramConditions {
    fn default() -> Self {
        let rs274 = rs274::DecoderOptions {
            rapid_velocity: RAPID_VELOCITY,
            acceleration: ACCELERATION,
            deceleration: ACCELERATION,
            ..rs274::DecoderOptions::default()
        };
        Self {
            start: [0.0; 3],
            start_additional: ExtraPosition::default(),
            approach: ApproachRule::default(),
            angle_tolerance: ANGLE_TOLERANCE,
            stops: true,
            preparation: PreparationInputs::default(),
            rs274,
            pace: None,
        }
    }
}

/// Time that a machine with drives waits behind probing moves, s, until drives that go from point to point arrive.
const PROBE_SETTLE_S: f64 = 0.5;

/// Reads both sections; `file` is the machine file, which may name drives.
pub(super) fn read(root: &Section<'_>, file: &Path, has_drives: bool) -> ProgramConditions {
    let defaults = ProgramConditions::default();
    let program = root.section("program");
    let start = program.numbers::<3>("start_mm", -1e5..=1e5).unwrap_or_default();
    let start_additional =
        program.numbers::<5>("start_additional", -1e6..=1e6).unwrap_or(defaults.start_additional);
    let angle_tolerance = program
        .number("angle_tolerance_deg", 0.0..=180.0)
        .map_or(defaults.angle_tolerance, f64::to_radians);
    let approach = approach::read(&program);
    program.finish();

    let start = start.map(|value| value * 1e-3);
    let rs274 = rs274::DecoderOptions {
        start: Position::new(start, start_additional),
        ..read_rs274(&root.section("rs274"), file, has_drives, &defaults.rs274)
    };
    let preparation = read_preparation(&root.section("preparation"));
    ProgramConditions {
        start,
        start_additional,
        approach,
        angle_tolerance,
        preparation,
        rs274,
        ..defaults
    }
}

fn read_preparation(section: &Section<'_>) -> PreparationInputs {
    let metres = |key, range| section.number(key, range).map(|value| value * 1e-3);
    let acceleration = metres("max_circular_acceleration_mm_per_s2", 1e-3..=1e8);
    let jump = metres("max_circular_acceleration_jump_mm_per_s2", 1e-3..=1e8);
    let circular = (acceleration.is_some() || jump.is_some()).then(|| CircularLimits {
        acceleration: acceleration.unwrap_or(f64::INFINITY),
        acceleration_jump: jump.unwrap_or(f64::INFINITY),
    });
    let inputs = PreparationInputs {
        tool_radius: metres("tool_radius_mm", 0.0..=1000.0).unwrap_or(0.0),
        gouge_tolerance: metres("gouge_tolerance_mm", 0.0..=10.0).unwrap_or(GOUGE_TOLERANCE),
        edge_distance: metres("edge_distance_mm", 0.0..=1000.0).unwrap_or(0.0),
        rounding_distance: metres("rounding_distance_mm", 0.0..=1000.0).unwrap_or(0.0),
        corner_angle_tolerance: section
            .number("corner_angle_tolerance_deg", 0.0..=180.0)
            .unwrap_or(0.0)
            .to_radians(),
        circular,
    };
    section.check_unknown();
    inputs
}

fn read_rs274(
    section: &Section<'_>,
    file: &Path,
    has_drives: bool,
    defaults: &rs274::DecoderOptions,
) -> rs274::DecoderOptions {
    let units = section
        .choice("unit", &[("mm", LengthUnit::Millimetre), ("inch", LengthUnit::Inch)])
        .unwrap_or_default();
    let metres = |key, range| section.number(key, range).map(|value| value * 1e-3);
    let place = |section: &Section<'_>, key| {
        let linear = section.numbers::<3>(key, -1e5..=1e5).unwrap_or_default();
        Position { linear: linear.map(|value| value * 1e-3), ..Position::default() }
    };
    let acceleration = metres("acceleration_mm_per_s2", 1e-3..=1e8);
    // The axes limit them anyway.
    let acceleration = acceleration.unwrap_or(f64::INFINITY);
    let offsets = section.section("work_offsets_mm");
    let work_offsets = SYSTEMS.map(|system| place(&offsets, system));
    offsets.finish();
    let tools = tool_table::read(section, file, units);
    let parameters = section.text("parameter_file").and_then(|name| {
        let path = file.parent().unwrap_or_else(|| Path::new("")).join(name);
        let read = Text::open(&path).map_err(ParameterFileError::Io).and_then(ParameterFile::read);
        if let Err(error) = &read {
            let reason = match error {
                ParameterFileError::Io(source) => source.to_string(),
                error => error.to_string(),
            };
            section.complain_at("parameter_file", format!("{}: {reason}", path.display()));
        }
        read.ok()
    });
    let controls = Control::ALL.map(|control| (control.name(), control));
    let tool = section.integer("tool", 0..=99_999).unwrap_or(0);
    let settle = section.number("probe_settle_s", 0.0..=60.0);
    let settle = settle.unwrap_or(if has_drives { PROBE_SETTLE_S } else { 0.0 });
    #[expect(clippy::cast_possible_truncation, reason = "at most a minute")]
    let probe_settle_ns = (settle * 1e9) as i64;
    let options = rs274::DecoderOptions {
        units,
        rapid_velocity: metres("rapid_velocity_mm_per_s", 1e-3..=1e6).unwrap_or(f64::INFINITY),
        acceleration,
        deceleration: metres("deceleration_mm_per_s2", 1e-3..=1e8).unwrap_or(acceleration),
        work_offsets,
        g28: place(section, "g28_mm"),
        g30: place(section, "g30_mm"),
        tools,
        parameters: parameters.unwrap_or_default(),
        tool: u32::try_from(tool).unwrap_or(0),
        control: section.choice("control", &controls),
        probe_settle_ns,
        ..defaults.clone()
    };
    section.check_unknown();
    options
}
