//! Programs with cycle times of LinuxCNC's planner (`tests/data/linuxcnc_planner`).

use crate::differences::Peak;
use std::fs;
use std::path::PathBuf;
use twin_gcode::decode::{Failure, Item};
use twin_gcode::rs274::{Decoder, DecoderOptions, PathMode};
use twin_path::PathElement;
use twin_path::prepare::{CheckError, CheckVelocities, CheckedElement};

/// Velocity and acceleration limit of every axis there, m/s and m/s².
pub const VELOCITY: f64 = 0.2;
pub const ACCELERATION: f64 = 1.0;
/// Jerk limit of every axis here, m/s³: 50,000 mm/s³.
pub const JERK: f64 = 50.0;
/// Turns of the path up to so much are passed without a stop.
pub const ANGLE_TOLERANCE_DEG: f64 = 2.0;

/// An acceleration along the path that is far more than what the axes give: they alone limit it, m/s².
pub const UNLIMITED: f64 = 1e4;

/// A program and what LinuxCNC made of it.
#[derive(Clone, Debug)]
pub struct Program {
    pub name: String,
    pub text: Vec<u8>,
    /// s.
    pub duration: f64,
    /// m.
    pub length: f64,
    /// Of any axis; the velocity is that of the tool.
    pub peak: Peak,
}

/// Path of a program as a planner takes it.
#[derive(Clone, Debug)]
pub struct Checked {
    pub elements: Vec<CheckedElement>,
    pub mode: PathMode,
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/linuxcnc_planner")
}

/// All of them, as `summary.csv` lists them.
pub fn all() -> Vec<Program> {
    let summary = fs::read_to_string(folder().join("summary.csv")).expect("the summary");
    let mut lines = summary.lines();
    assert_eq!(
        lines.next(),
        Some(
            "program,duration_s,path_mm,max_tool_velocity_mm_per_s,max_axis_acceleration_mm_per_s2,\
             max_tool_acceleration_mm_per_s2,max_axis_jerk_mm_per_s3"
        )
    );
    let programs = lines.map(|line| {
        let mut fields = line.split(',');
        let name = fields.next().expect("a name").to_owned();
        let numbers: Vec<f64> = fields.map(|field| field.parse().expect("a number")).collect();
        let &[duration, length, velocity, acceleration, _, jerk] = numbers.as_slice() else {
            panic!("seven columns: {line}");
        };
        let text = fs::read(folder().join(format!("{name}.ngc"))).expect("the program");
        let peak = Peak {
            velocity: velocity * 1e-3,
            acceleration: acceleration * 1e-3,
            jerk: jerk * 1e-3,
        };
        Program { name, text, duration, length: length * 1e-3, peak }
    });
    programs.collect()
}

impl Program {
    /// Decoded, with the velocities at its transitions and this acceleration along the path, m/s². On the exact path
    /// turns of more than [`ANGLE_TOLERANCE_DEG`] are stops; else they are there to be blended.
    pub fn checked(&self, acceleration: f64) -> Checked {
        let tolerance = if self.is_exact() { ANGLE_TOLERANCE_DEG } else { 180.0 };
        self.checked_within(acceleration, tolerance.to_radians())
    }

    /// The same with stops at turns of more than `angle_tolerance`, rad.
    pub fn checked_within(&self, acceleration: f64, angle_tolerance: f64) -> Checked {
        let options = DecoderOptions {
            acceleration,
            deceleration: acceleration,
            ..DecoderOptions::default()
        };
        let mut decoder = Decoder::new(self.text.as_slice(), options);
        let elements: Vec<PathElement> = decoder
            .by_ref()
            .map(|item| match item {
                Ok(Item::Element(element)) => element,
                Ok(Item::Warning(warning)) => panic!("{}: {warning}", self.name),
                Err(Failure::Diagnostic(error)) => panic!("{}: {error}", self.name),
                Err(Failure::Io(error)) => panic!("{}: {error}", self.name),
            })
            .collect();
        let mode = decoder.path_mode();
        let elements = elements.into_iter().map(Ok::<_, CheckError>);
        let elements = CheckVelocities::new(elements, angle_tolerance);
        Checked { elements: elements.collect::<Result<_, _>>().expect("a path"), mode }
    }

    /// True if LinuxCNC had to follow the path exactly.
    pub fn is_exact(&self) -> bool {
        self.name.ends_with("_g61")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is decoded is what LinuxCNC travelled: with the exact path as long, blended hardly shorter; feed and mode
    /// are those of the first lines.
    #[test]
    fn programs_are_those_that_linuxcnc_ran() {
        let programs = all();
        assert_eq!(programs.len(), 9);
        for program in &programs {
            let Checked { elements, mode } = program.checked(UNLIMITED);
            let length: f64 = elements.iter().map(CheckedElement::path_length).sum();
            if program.is_exact() {
                assert_eq!(mode, PathMode::ExactPath, "{}", program.name);
                assert!((length - program.length).abs() < 1e-5, "{}: {length} m", program.name);
            } else {
                let PathMode::Tolerance { path, .. } = mode else { panic!("{mode:?}") };
                assert!((path - 5e-5).abs() < 1e-12, "{}: {path} m", program.name);
                let shorter = 1.0 - program.length / length;
                assert!((0.0..0.02).contains(&shorter), "{}: {length} m", program.name);
            }
            for element in elements.iter().filter(|element| element.has_path()) {
                assert!(
                    (element.feed - 0.1).abs() < 1e-12,
                    "{}: {} m/s",
                    program.name,
                    element.feed
                );
            }
            // No feed is faster than that all the way.
            assert!(program.duration > program.length / 0.1, "{}", program.name);
        }
    }

    /// Corners of the square and of the zigzag stop the path, and the chords of the spiral, which turn by 6°; those of
    /// the circle, which turn by 1°, do not. Of the seven arcs and lines three meet at corners, and one is the last.
    #[test]
    fn stops_are_where_the_tangent_turns() {
        for program in all() {
            let tolerance = ANGLE_TOLERANCE_DEG.to_radians();
            let elements = program.checked_within(UNLIMITED, tolerance).elements;
            let stops = elements.iter().filter(|element| element.end_velocity == 0.0).count();
            let moves = elements.iter().filter(|element| element.has_path()).count();
            let expected = match program.name.trim_end_matches("_g61").trim_end_matches("_g64") {
                "square" | "zigzag" | "spiral" => moves,
                "circle_segments" => 1,
                "arcs" => 4,
                name => panic!("{name}"),
            };
            assert_eq!(stops, expected, "{} with {moves} moves", program.name);
        }
    }
}
