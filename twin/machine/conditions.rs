//! `[program]` and `[rs274]`: what programs find when they begin.

use super::section::Section;
use std::fs::File;
use std::path::Path;
use twin_motion::path::ExtraPosition;
use twin_motion::rs274::{self, LengthUnit, Position, ToolTable, ToolTableError};

/// Turns of the path up to this angle are passed without a stop unless the machine file says otherwise, rad.
const ANGLE_TOLERANCE: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Velocity of rapids in RS274 unless the machine file says otherwise, m/s.
const RAPID_VELOCITY: f64 = 0.1;

/// Acceleration along the path in RS274 unless the machine file says otherwise, m/s².
const ACCELERATION: f64 = 1.0;

/// Keys of the coordinate systems.
const SYSTEMS: [&str; 9] = ["g54", "g55", "g56", "g57", "g58", "g59", "g59_1", "g59_2", "g59_3"];

/// What programs find when they begin.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramConditions {
    /// Where a program starts that does not say so itself (G92), work frame, m.
    pub start: [f64; 3],
    /// And the additional axes P Q U V W, u.
    pub start_additional: ExtraPosition,
    /// Turns of the path up to this angle are passed without a stop, rad.
    pub angle_tolerance: f64,
    /// What an RS274 program finds, in the work frame; its start is that above.
    pub rs274: rs274::DecoderOptions,
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
            angle_tolerance: ANGLE_TOLERANCE,
            rs274,
        }
    }
}

/// Reads both sections; `file` is the machine file.
pub(super) fn read(root: &Section<'_>, file: &Path) -> ProgramConditions {
    let defaults = ProgramConditions::default();
    let program = root.section("program");
    let start = program.numbers::<3>("start_mm", -1e5..=1e5).unwrap_or_default();
    let start_additional =
        program.numbers::<5>("start_additional", -1e6..=1e6).unwrap_or(defaults.start_additional);
    let angle_tolerance = program
        .number("angle_tolerance_deg", 0.0..=180.0)
        .map_or(defaults.angle_tolerance, f64::to_radians);
    program.finish();

    let start = start.map(|value| value * 1e-3);
    let [a, b, c, _, _] = start_additional;
    let rs274 = rs274::DecoderOptions {
        start: Position { linear: start, rotary: [a, b, c] },
        ..read_rs274(&root.section("rs274"), file, defaults.rs274)
    };
    ProgramConditions { start, start_additional, angle_tolerance, rs274 }
}

fn read_rs274(
    section: &Section<'_>,
    file: &Path,
    defaults: rs274::DecoderOptions,
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
    let acceleration = acceleration.unwrap_or(defaults.acceleration);
    let offsets = section.section("work_offsets_mm");
    let work_offsets = SYSTEMS.map(|system| place(&offsets, system));
    offsets.finish();
    let tools = section.text("tool_table").and_then(|name| {
        let path = file.parent().unwrap_or_else(|| Path::new("")).join(name);
        let table = File::open(&path)
            .map_err(ToolTableError::Io)
            .and_then(|table| ToolTable::read(table, units));
        if let Err(error) = &table {
            section.complain_at("tool_table", said(&path, error));
        }
        table.ok()
    });
    let tool = section.integer("tool", 0..=99_999).unwrap_or(0);
    let options = rs274::DecoderOptions {
        units,
        rapid_velocity: metres("rapid_velocity_mm_per_s", 1e-3..=1e6)
            .unwrap_or(defaults.rapid_velocity),
        acceleration,
        deceleration: metres("deceleration_mm_per_s2", 1e-3..=1e8).unwrap_or(acceleration),
        work_offsets,
        g28: place(section, "g28_mm"),
        g30: place(section, "g30_mm"),
        tools,
        tool: u32::try_from(tool).unwrap_or(0),
        ..defaults
    };
    section.check_unknown();
    options
}

/// What is wrong with a tool table, with its file and the reason behind.
pub(crate) fn said(path: &Path, error: &ToolTableError) -> String {
    match error {
        ToolTableError::Io(source) => format!("{}: {source}", path.display()),
        error => format!("{}: {error}", path.display()),
    }
}
