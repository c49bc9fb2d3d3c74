//! Input of a scene: program, obstacles, axes, path pieces, and one frame per instant.

use nalgebra::{Isometry3, Point3};
use twin_urdf::Solid;

/// The program being run.
#[derive(Clone, Copy, Debug)]
pub struct Program<'a> {
    /// Name of its file.
    pub name: &'a str,
    /// Its text; the lines around the current one are shown next to the machine.
    pub text: &'a str,
}

/// Something around the machine that stays where it is.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle<'a> {
    /// Its name in the machine file.
    pub name: &'a str,
    /// Its solids, machine frame, m. A transparent one has a colour with alpha below 1.
    pub solids: &'a [Solid],
}

/// A loose body, which the machine may move.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    /// Its name in the machine file.
    pub name: &'a str,
    /// Its solids in its own frame, m.
    pub solids: &'a [Solid],
    /// Its pose at the start, machine frame.
    pub pose: Isometry3<f64>,
}

/// An axis of the machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Its name in the machine file.
    pub name: String,
    /// Unit of its error.
    pub unit: AxisUnit,
}

/// Kind of an axis position; decides the unit in which its error is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisUnit {
    /// rad, shown in degrees.
    Rotary,
    /// m, shown in mm.
    Linear,
}

/// Kind of a piece of the programmed path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// A cutting move (G1, G2, G3, ...).
    Cut,
    /// A positioning move (G0).
    Rapid,
    /// A probing move (G38).
    Probe,
    /// Prepared path: shown next to the programmed moves if it differs.
    Prepared,
}

/// A piece of the programmed path, or of what preparation has made of it.
#[derive(Clone, Debug, PartialEq)]
pub struct PathStrip {
    /// Cutting, positioning or probing.
    pub kind: MoveKind,
    /// A polyline of tool positions in the machine frame, m.
    pub points: Vec<Point3<f64>>,
}

/// One instant of the run.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Since the start of the program, ns.
    pub time_ns: i64,
    /// Line of the program file, from 1.
    pub line: u32,
    /// Set-point of the tool in the machine frame, m.
    pub setpoint: Point3<f64>,
    /// Speed of the set-point along the path, m/s.
    pub path_speed: f64,
    /// The feed that the program asks for here, m/s; `None` during rapids and dwells.
    pub programmed_speed: Option<f64>,
    /// Poses of the links of the twin in the machine frame, in the order of the model.
    pub link_poses: &'a [Isometry3<f64>],
    /// Poses of the loose bodies in the machine frame, in the order of [`Setup::bodies`](crate::Setup::bodies); empty if
    /// they are not known for this instant.
    pub body_poses: &'a [Isometry3<f64>],
    /// The twin against the set-point.
    pub twin: Deviation<'a>,
    /// States of the twin's motors, in the order of the axes; empty if they are not known for this instant.
    pub motors: &'a [MotorFrame],
    /// Clearance of the twin; `None` if it is not measured. Shown if [`Setup::clearance`](crate::Setup::clearance) is
    /// set.
    pub clearance: Option<ClearanceFrame<'a>>,
    /// Feedback from the drives, if there are any and they have answered for this instant.
    pub drives: Option<DrivesFrame<'a>>,
}

/// Clearance: the two parts nearest to each other, and their distance.
#[derive(Clone, Copy, Debug)]
pub struct ClearanceFrame<'a> {
    /// m; below 0 they are as deep in each other.
    pub distance: f64,
    /// Their names.
    pub parts: [&'a str; 2],
    /// The nearest point of each, machine frame, m.
    pub points: [Point3<f64>; 2],
}

/// State of a motor; efforts at the axis (behind the gear).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorFrame {
    /// Force or torque, N (of linear axes) or Nm (of rotary ones).
    pub effort: f64,
    /// The largest it could give at its speed, N or Nm, either way; `None` if that is not known.
    pub effort_limit: Option<f64>,
    /// Mechanical power, W; less than 0 while it brakes.
    pub power: f64,
    /// Effort as a part of the available effort, shown in %: 1 is all. `None` if that is not known.
    pub utilisation: Option<f64>,
    /// Smoothed losses of its winding (I²t), shown in %: 1 is the continuous limit. `None` if that is not known.
    pub warmth: Option<f64>,
    /// Load angle of a step motor, from its field to its rotor, full steps; `None` for other motors.
    pub load_angle: Option<f64>,
}

/// Deviation from the set-point.
#[derive(Clone, Copy, Debug)]
pub struct Deviation<'a> {
    /// Its tool position in the machine frame, m.
    pub tool: Point3<f64>,
    /// Distance of that from the set-point, m.
    pub tool_error: f64,
    /// Axis positions minus the axis set-points, in the order of the axes; rad or m.
    pub axis_errors: &'a [f64],
}

/// Feedback from the drives.
#[derive(Clone, Copy, Debug)]
pub struct DrivesFrame<'a> {
    /// The drives against the set-point.
    pub deviation: Deviation<'a>,
    /// Distance between the tool positions of drives and twin, m.
    pub tool_error_to_twin: f64,
}
