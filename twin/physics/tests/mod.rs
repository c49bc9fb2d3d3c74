//! Tests of the simulated machine: machines built by hand, closed forms, and peers' numbers.

mod along_path;
mod closed_forms;
mod contact;
mod copies;
mod coupled;
mod drives;
mod elastic;
mod elastic_machines;
mod free;
mod loose;
mod mimic;
mod motors;
mod multibody;
mod parallel;
mod pull_out;
mod rapier;
mod reference;
mod scara;
mod stops;
mod unfolded;

use nalgebra::{Isometry3, Matrix3, Point3, Unit, Vector3};
use twin_kinematics::{AxisMotion, MAX_AXES};
use twin_urdf::{Inertial, Joint, JointDrive, JointKind, Link, Loop, Tip};

use super::*;
use crate::dynamics::Dynamics;
use crate::state::JointState;
use multibody::RapierAlone;
use unfolded::Unfolded;

/// One cycle, ns.
const CYCLE_NS: i64 = 1_000_000;

/// m/s².
const G: f64 = 9.81;

fn down() -> Vector3<f64> {
    Vector3::new(0.0, 0.0, -G)
}

fn axes<const N: usize>(values: [f64; N]) -> AxisVector {
    AxisVector::from_values(values)
}

fn joints<const N: usize>(values: [f64; N]) -> JointVector {
    joint_vector(values.into_iter())
}

/// A machine at rest at `start`.
fn started(
    model: &Model,
    drives: &[AxisDriveParameters],
    gravity: Vector3<f64>,
    start: &AxisVector,
) -> PhysicsMachine {
    PhysicsMachine::new(model, drives, gravity, start, CYCLE_NS).unwrap()
}

/// A machine that begins with `first`.
fn moving(
    model: &Model,
    drives: &[AxisDriveParameters],
    gravity: Vector3<f64>,
    first: &AxisMotion,
) -> PhysicsMachine {
    let mut machine = started(model, drives, gravity, &first.position);
    machine.start_moving(&first.velocity);
    machine
}

/// Drives made of the inertia of each axis at `start`.
fn drives_of(
    model: &Model,
    start: &AxisVector,
    drive: impl Fn(f64) -> AxisDriveParameters,
) -> Vec<AxisDriveParameters> {
    axis_inertia(model, start).unwrap().iter().map(|inertia| drive(*inertia)).collect()
}

/// A set-point by position, velocity and acceleration.
fn motion<const N: usize>(values: [[f64; N]; 3]) -> AxisMotion {
    let [position, velocity, acceleration] = values.map(axes);
    AxisMotion { position, velocity, acceleration }
}

/// Position, velocity and acceleration `t` s after a start that takes `rise` s to reach `speed`, as sin².
fn soft_start(speed: f64, rise: f64, t: f64) -> [f64; 3] {
    let w = std::f64::consts::PI / rise;
    if t >= rise {
        return [speed * (t - 0.5 * rise), speed, 0.0];
    }
    let (sin, cos) = (w * t).sin_cos();
    [0.5 * speed * (t - sin / w), 0.5 * speed * (1.0 - cos), 0.5 * speed * w * sin]
}

/// The efforts (N or Nm) that hold `model` at `position`.
fn holding_effort(model: &Model, position: &AxisVector) -> AxisVector {
    let rotors = vec![0.0; position.len()];
    motion_effort(model, down(), &rotors, &AxisMotion::at_rest(*position)).unwrap()
}

/// A drive without an effort of its own.
const SLACK: AxisDriveParameters = AxisDriveParameters::SLACK;

/// A servo drive tuned by rule.
fn tuned(inertia: f64, bandwidth_hz: f64, effort_limit: f64) -> AxisDriveParameters {
    AxisDriveParameters::servo(ServoParameters::tuned(inertia, bandwidth_hz, effort_limit))
}

/// A drive without an effort of its own, on an axis with friction.
fn rough(coulomb: f64, viscous: f64) -> AxisDriveParameters {
    AxisDriveParameters { friction: FrictionParameters::new(coulomb, viscous), ..SLACK }
}

/// A uniform box of `mass` kg with edges `size` m: the closed form of its inertia.
fn uniform_box(mass: f64, center: [f64; 3], size: [f64; 3]) -> Inertial {
    let [x, y, z] = size.map(|edge| edge * edge);
    let inertia = Matrix3::from_diagonal(&Vector3::new(y + z, x + z, x + y)) * (mass / 12.0);
    Inertial { mass, center: Point3::from(center), inertia }
}

/// A link and the joint that moves it: kind, direction, place on the parent, mass.
type ChainLink = (JointKind, Vector3<f64>, Isometry3<f64>, Option<Inertial>);

/// A chain of links behind the base, joint `i` moved by machine axis `i`; the tip at the origin of the last link.
fn chain<const N: usize>(links: [ChainLink; N]) -> Model {
    let link = |name: String, inertial| Link::new(name, inertial, Vec::new());
    let mut model = Model {
        name: "chain".into(),
        links: vec![link("base".into(), None)],
        joints: Vec::new(),
        loops: Vec::new(),
        tip: Tip { link: N, point: Point3::origin() },
    };
    let mut axis_count = 0;
    for (index, (kind, axis, origin, inertial)) in links.into_iter().enumerate() {
        let moves = kind != JointKind::Fixed;
        let drive = if moves { JointDrive::Axis(axis_count) } else { JointDrive::Fixed };
        axis_count += usize::from(moves);
        model.links.push(link(format!("link{index}"), inertial));
        let (name, axis) = (format!("joint{index}"), Unit::new_normalize(axis));
        model.joints.push(Joint::new(name, kind, [index, index + 1], origin, axis, drive));
    }
    model
}

/// A mass on a vertical slide.
fn lift(mass: f64) -> Model {
    let cube = uniform_box(mass, [0.02, -0.01, 0.05], [0.1, 0.1, 0.1]);
    chain([(JointKind::Prismatic, Vector3::z(), Isometry3::identity(), Some(cube))])
}

/// Three slides x, y, z, with masses.
fn gantry() -> Model {
    let body = |mass| Some(uniform_box(mass, [0.0, 0.0, 0.1], [0.3, 0.2, 0.1]));
    chain([
        (JointKind::Prismatic, Vector3::x(), Isometry3::identity(), body(12.0)),
        (JointKind::Prismatic, Vector3::y(), Isometry3::translation(0.0, 0.0, 0.2), body(5.0)),
        (JointKind::Prismatic, Vector3::z(), Isometry3::translation(0.05, 0.0, 0.0), body(3.0)),
    ])
}

/// A chain in which nothing is aligned: turned frames, an axis of −z, a fixed and a massless link.
fn crooked() -> Model {
    let turned = |x, y, z, roll, pitch, yaw| {
        Isometry3::from_parts(
            nalgebra::Translation3::new(x, y, z),
            nalgebra::UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        )
    };
    chain([
        (
            JointKind::Revolute,
            Vector3::new(0.2, -0.4, 1.0),
            turned(0.1, 0.2, 0.3, 0.4, -0.3, 0.8),
            Some(uniform_box(6.0, [0.2, 0.03, -0.05], [0.4, 0.1, 0.08])),
        ),
        (
            JointKind::Prismatic,
            Vector3::new(0.7, 0.3, -0.2),
            turned(0.35, -0.1, 0.05, -0.7, 0.2, 0.1),
            Some(uniform_box(3.0, [0.02, 0.1, 0.0], [0.2, 0.3, 0.05])),
        ),
        (JointKind::Fixed, Vector3::x(), turned(0.0, 0.15, 0.02, 0.3, 0.3, -1.2), None),
        (
            JointKind::Revolute,
            -Vector3::z(),
            turned(0.05, 0.02, 0.1, 1.1, 0.0, 0.4),
            Some(uniform_box(1.5, [0.05, 0.0, 0.04], [0.1, 0.04, 0.15])),
        ),
    ])
}

impl PhysicsMachine {
    /// Kinetic and potential energy of the links of `model`, J, without rotors.
    fn energy(&self, model: &Model) -> f64 {
        let JointState { position, velocity } = &self.joints.axes;
        Unfolded::new(model, self.drives.len(), down(), JointVector::zeros())
            .energy(position, velocity)
    }

    /// Makes the machine move, as if it had been moving before.
    fn start_moving(&mut self, velocity: &AxisVector) {
        let joints = joint_vector(velocity.iter().copied());
        self.joints.axes.velocity = joints;
        self.joints.motors.velocity = joints;
        self.setpoint.velocity = *velocity;
    }

    /// `cycles` with the axes sent to `position`.
    fn hold<const N: usize>(&mut self, position: [f64; N], cycles: u32) -> AxisState {
        let rest = AxisMotion::at_rest(axes(position));
        for _ in 0..cycles {
            self.step(&rest).unwrap();
        }
        *self.axis_state()
    }

    /// `cycles` with `effort`.
    fn push<const N: usize>(&mut self, effort: [f64; N], cycles: u32) -> AxisState {
        let effort = axes(effort);
        for _ in 0..cycles {
            self.step_with_efforts(&effort).unwrap();
        }
        *self.axis_state()
    }
}
