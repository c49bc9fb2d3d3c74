//! What a scene is told.

use nalgebra::{Isometry3, Point3};
use twin_urdf::Solid;

/// The program being run.
#[derive(Clone, Copy, Debug)]
pub struct Program<'a> {
    /// Name of its file.
    pub name: &'a str,
    /// Its text; the lines around the current one are shown beside the machine.
    pub text: &'a str,
}

/// Something around the machine that stays where it is.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle<'a> {
    /// Its name in the machine file.
    pub name: &'a str,
    /// What it is made of, machine frame, m. What is seen through has a colour that says so.
    pub solids: &'a [Solid],
}

/// An axis of the machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Its name in the machine file.
    pub name: String,
    /// What its error is measured in.
    pub unit: AxisUnit,
}

/// What the position of an axis is; decides the unit in which its error is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisUnit {
    /// rad, shown in degrees.
    Rotary,
    /// m, shown in mm.
    Linear,
}

/// What a piece of the programmed path is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// A cutting move (G1, G2, G3, ...).
    Cut,
    /// A positioning move (G0).
    Rapid,
    /// A probing move (G38).
    Probe,
    /// What preparation has made of the moves: shown beside them where they differ.
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
    /// Where the tool should be: set-point in the machine frame, m.
    pub setpoint: Point3<f64>,
    /// Speed of the set-point along the path, m/s.
    pub path_speed: f64,
    /// The feed that the program asks for here, m/s; `None` during rapids and dwells.
    pub programmed_speed: Option<f64>,
    /// Poses of the links of the twin in the machine frame, in the order of the model.
    pub link_poses: &'a [Isometry3<f64>],
    /// The twin against the set-point.
    pub twin: Deviation<'a>,
    /// What the motors of the twin do, in the order of the axes; none where that is not known for this instant.
    pub motors: &'a [MotorFrame],
    /// How near the twin is to what it must not touch; `None` where that is not measured. Shown if the scene was told of it.
    pub clearance: Option<ClearanceFrame<'a>>,
    /// What came back from the drives, if there are any and they have answered for this instant.
    pub drives: Option<DrivesFrame<'a>>,
}

/// How near the two parts are that are nearest to each other.
#[derive(Clone, Copy, Debug)]
pub struct ClearanceFrame<'a> {
    /// m; below 0 they are as deep in each other.
    pub distance: f64,
    /// What they are called.
    pub parts: [&'a str; 2],
    /// The nearest point of each, machine frame, m.
    pub points: [Point3<f64>; 2],
}

/// What a motor does; efforts at the axis (behind the gear).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorFrame {
    /// Force or torque, N (of linear axes) or Nm (of rotary ones).
    pub effort: f64,
    /// The largest it could give at its speed, N or Nm, either way; `None` if that is not known.
    pub effort_limit: Option<f64>,
    /// Mechanical power, W; less than 0 while it brakes.
    pub power: f64,
    /// How much of what it could give it gives, shown in %: 1 is all. `None` if that is not known.
    pub utilisation: Option<f64>,
    /// Smoothed losses of its winding (I²t), shown in %: 1 is what it bears for ever. `None` if that is not known.
    pub warmth: Option<f64>,
    /// How far the field of a step motor is ahead of its rotor, full steps; `None` of other motors.
    pub load_angle: Option<f64>,
}

/// How far something is from the set-point.
#[derive(Clone, Copy, Debug)]
pub struct Deviation<'a> {
    /// Where it has the tool, in the machine frame, m.
    pub tool: Point3<f64>,
    /// Distance of that from the set-point, m.
    pub tool_error: f64,
    /// Axis positions minus the axis set-points, in the order of the axes; rad or m.
    pub axis_errors: &'a [f64],
}

/// What came back from the drives.
#[derive(Clone, Copy, Debug)]
pub struct DrivesFrame<'a> {
    /// The drives against the set-point.
    pub deviation: Deviation<'a>,
    /// Distance between the tool positions of drives and twin, m.
    pub tool_error_to_twin: f64,
}
