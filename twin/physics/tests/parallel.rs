//! Tests of efforts of machines with coupled axes: an H belt in closed form, a tripod against a peer's derivation and
//! against the energy of its links.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use twin_kinematics::tripod::{TripodDeviations, TripodDimensions as Rings};
use twin_kinematics::{Kinematics, Pose, ToolMotion, tripod::Tripod};
use twin_urdf::{GantryDimensions, HBelt, JointPositions, MachineJoint, TripodDimensions};

use super::along_path::FREE;
use super::*;

/// Half the distance of two rods.
const HALF: f64 = 0.03;

/// The reference's: the middles of rod pairs on circles of 0.25 m and 0.05 m.
pub(super) fn rings() -> Rings {
    Rings {
        inner_radius: HALF.hypot(0.05),
        outer_radius: HALF.hypot(0.25),
        rod_length: 0.4,
        rod_distance: 2.0 * HALF,
        rotation: FRAC_PI_2,
    }
}

pub(super) fn generated(deviations: &TripodDeviations) -> Model {
    let rods = rings().rods(deviations).unwrap();
    let joints = [0, 1, 2].map(|axis| MachineJoint::new(["A", "B", "C"][axis], axis, [0.25, 0.45]));
    let dimensions = TripodDimensions {
        carriage_mass: Some(1.5),
        rod_mass: Some(0.1),
        platform_mass: Some(1.0),
        ..TripodDimensions::new("tripod", joints, rods)
    };
    dimensions.model().unwrap()
}

/// x and y (rows) by both motors of a belt: bridge, carriage and quill of 4, 1.5 and 1 kg.
pub(super) fn h_gantry(factors: [[f64; 2]; 2]) -> Model {
    let motor = |name: &str, axis| MachineJoint::new(name, axis, [-0.7, 0.7]);
    let belt = HBelt { factors, ..HBelt::new([motor("A", 0), motor("B", 1)]) };
    let dimensions = GantryDimensions {
        bridge_mass: Some(4.0),
        carriage_mass: Some(1.5),
        quill_mass: Some(1.0),
        ..GantryDimensions::h_belt("belt", belt, Some(motor("Z", 2)))
    };
    dimensions.model().unwrap()
}

/// The reference's: rods are lines.
pub(super) fn thin() -> Model {
    let mut model = generated(&TripodDeviations::default());
    for link in model.links.iter_mut().filter(|link| link.name.starts_with("rod")) {
        if link.inertial.is_some() {
            let across = 0.1 * 0.4 * 0.4 / 12.0;
            let inertia = Matrix3::from_diagonal(&Vector3::new(across, across, 0.0));
            link.inertial =
                Some(Inertial { mass: 0.1, center: Point3::new(0.0, 0.0, -0.2), inertia });
        }
    }
    model
}

/// The axes on the reference's circle of 60 mm at 0.3 m/s, z = 0.01·sin(2t).
pub(super) fn circle(t: f64) -> AxisMotion {
    let ((s5, c5), (s2, c2)) = ((5.0 * t).sin_cos(), (2.0 * t).sin_cos());
    let tool = ToolMotion {
        pose: Pose { position: Point3::new(0.06 * c5, 0.06 * s5, 0.01 * s2), direction: 0.0 },
        velocity: Vector3::new(-0.3 * s5, 0.3 * c5, 0.02 * c2),
        acceleration: Vector3::new(-1.5 * c5, -1.5 * s5, -0.04 * s2),
        direction_velocity: 0.0,
        direction_acceleration: 0.0,
    };
    let tripod = Tripod::new(rings(), [0.0; 3]).unwrap();
    Kinematics::inverse_motion(&tripod, &tool, &axes([0.0; 3])).unwrap()
}

/// The rows of a file of `reference/`, if it is there (`TWIN_SHARED` or next to the workspace).
pub(super) fn rows_of<const N: usize>(name: &str, columns: [&str; N]) -> Option<Vec<[f64; N]>> {
    let neighbour = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let shared = std::env::var_os("TWIN_SHARED").map_or(neighbour, PathBuf::from);
    let Ok(mut file) = csv::Reader::from_path(shared.join("reference").join(name)) else {
        println!("skipped: no {name} (TWIN_SHARED, ../shared)");
        return None;
    };
    let header = file.headers().unwrap().clone();
    let columns = columns.map(|name| header.iter().position(|column| column == name).unwrap());
    let rows = file.records().map(|row| {
        let row = row.unwrap();
        columns.map(|column| row[column].parse().unwrap())
    });
    Some(rows.collect())
}

/// With time in the place of the path parameter.
fn in_time(dynamics: &mut PathDynamics, motion: &AxisMotion) -> JointVector {
    let AxisMotion { position, velocity, acceleration } = motion;
    let torque = dynamics.at(position, velocity, acceleration).unwrap();
    joint_vector(torque.axes().iter().map(|axis| axis.effort(0.0, 1.0)))
}

#[test]
fn all_forces_on_the_circle_are_those_of_the_peer() {
    let columns = ["t_s", "f_ff1", "f_ff2", "f_ff3"];
    let Some(rows) = rows_of("tripod_circle.csv", columns) else { return };
    let mut dynamics = PathDynamics::new(&thin(), &[FREE; 3], down()).unwrap();
    let mut worst = [0.0_f64; 2];
    for [t, forces @ ..] in &rows {
        for (worst, ahead) in worst.iter_mut().zip([0.0, 0.5e-3]) {
            let found = in_time(&mut dynamics, &circle(t + ahead));
            *worst = worst.max((found - joints(*forces)).amax());
        }
    }
    println!("{} rows, at most {worst:?} N apart, without and with half a step ahead", rows.len());
    assert!(rows.len() >= 2000 && worst.into_iter().fold(f64::INFINITY, f64::min) < 1e-9);
}

/// Kinetic and potential energy of all links, from where the model has them: velocities by differences of places, and rods,
/// which do not spin, by those of their directions.
fn energy(model: &Model, path: &dyn Fn(f64) -> [f64; 3], t: f64) -> f64 {
    const H: f64 = 2e-4;
    let poses = |t: f64| {
        let mut joints = JointPositions::at_rest(model);
        joints.follow(model, &path(t)).unwrap();
        let mut poses = vec![Isometry3::identity(); model.links.len()];
        model.link_poses_at(joints.values(), &mut poses);
        poses
    };
    let [a, b, here, c, d] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|step| poses(t + step * H));
    let mut sum = 0.0;
    for (index, link) in model.links.iter().enumerate() {
        let Some(Inertial { mass, center, inertia }) = link.inertial else { continue };
        let rate = |of: &dyn Fn(&Isometry3<f64>) -> Vector3<f64>| {
            let [a, b, c, d] = [&a, &b, &c, &d].map(|poses| of(&poses[index]));
            ((c - b) * 8.0 - (d - a)) / (12.0 * H)
        };
        let velocity = rate(&|pose| (pose * center).coords);
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()]
            .map(|axis| (rate(&|pose| pose.rotation * axis), here[index].rotation * axis));
        let turning = if link.name.starts_with("rod") {
            0.5 * inertia.m11 * z.0.norm_squared()
        } else {
            // ω from ẋ·y, ẏ·z and ż·x, in the frame of the link.
            let omega = Vector3::new(y.0.dot(&z.1), z.0.dot(&x.1), x.0.dot(&y.1));
            0.5 * omega.dot(&(inertia * omega))
        };
        let height = (here[index] * center).z;
        sum += 0.5 * mass * velocity.norm_squared() + turning + mass * G * height;
    }
    sum
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    /// The power of all motors is the growth of the energy of all links, by differences over time, on tripods whose platform
    /// tilts on its way as well.
    #[test]
    fn power_becomes_energy(
        made in prop_oneof![Just(0.0), Just(1.0)],
        deviations in prop::array::uniform6(-2e-3..2e-3_f64),
        turned in prop::array::uniform3(-0.02..0.02_f64),
        position in prop::array::uniform3(0.32..0.38_f64),
        first in prop::array::uniform3(-0.5..0.5_f64),
        second in prop::array::uniform3(-1.0..1.0_f64),
        speed in 0.1..2.0_f64,
        acceleration in -5.0..5.0_f64,
    ) {
        let [a, b, c, ..] = deviations;
        let model = generated(&TripodDeviations {
            rod_lengths: deviations.map(|deviation| made * deviation),
            tower_angles: turned.map(|angle| made * angle),
            inner_distances: [a, b, c].map(|deviation| made * deviation),
            ..TripodDeviations::default()
        });
        let mut dynamics = PathDynamics::new(&model, &[FREE; 3], down()).unwrap();
        let torque = dynamics.at(&axes(position), &axes(first), &axes(second)).unwrap();
        let power: f64 = torque.axes().iter().zip(first)
            .map(|(axis, first)| axis.effort(acceleration, speed) * first * speed).sum();
        let path = |t: f64| {
            let s = t * (speed + 0.5 * t * acceleration);
            let mut at = position;
            for ((at, first), second) in at.iter_mut().zip(first).zip(second) {
                *at += (first + second * (0.5 * s)) * s;
            }
            at
        };
        let dt = 1e-3;
        let energy = |t: f64| energy(&model, &path, t);
        let growth = (8.0 * (energy(dt) - energy(-dt)) - (energy(2.0 * dt) - energy(-2.0 * dt))) / (12.0 * dt);
        prop_assert!((power - growth).abs() < 1e-6 * growth.abs().max(10.0), "{power} W, {growth} W");
    }

    /// x moves bridge, carriage and quill, y the last two; each motor feels half of both, and its own rotor.
    #[test]
    fn a_belt_shares_the_forces(
        layout in 0..4_usize,
        position in prop::array::uniform3(-0.1..0.1_f64),
        first in prop::array::uniform3(-2.0..2.0_f64),
        second in prop::array::uniform3(-5.0..5.0_f64),
        rotors in prop::array::uniform3(0.0..3.0_f64),
        motion in (-3.0..3.0_f64, 0.0..2.0_f64),
    ) {
        // x and y by A and B.
        let factors = [
            [[0.5, -0.5], [0.5, 0.5]],
            [[0.5, 0.5], [0.5, -0.5]],
            [[-0.5, 0.5], [0.5, 0.5]],
            [[0.5, 0.5], [-0.5, 0.5]],
        ][layout];
        let loads = rotors.map(|armature| AxisLoad { armature, ..FREE });
        let mut dynamics = PathDynamics::new(&h_gantry(factors), &loads, down()).unwrap();
        let torque = dynamics.at(&axes(position), &axes(first), &axes(second)).unwrap();
        let (s2, v) = motion;
        let change = |axis: usize| first[axis] * s2 + second[axis] * v * v;
        // Newton, in x and y.
        let [x, y] = factors.map(|[a, b]| a * change(0) + b * change(1));
        let forces = [6.5 * x, 2.5 * y];
        for (axis, found) in torque.axes().iter().enumerate() {
            let load = match axis {
                0 | 1 => factors[0][axis] * forces[0] + factors[1][axis] * forces[1],
                _ => 1.0 * (change(2) + G),
            };
            let expected = load + rotors[axis] * change(axis);
            let effort = found.effort(s2, v);
            prop_assert!((effort - expected).abs() < 1e-10, "{axis}: {effort} N, {expected} N");
        }
    }
}

/// A table on an axis of its own feels nothing of the tripod, and the tripod nothing of it.
#[test]
fn an_additional_axis_is_beside_the_tripod() {
    let bare = thin();
    let mut model = bare.clone();
    model.add_additional_axis(&MachineJoint::new("P", 3, [-1.0, 1.0]), false, 0);
    let motion = circle(0.3);
    let mut alone = PathDynamics::new(&bare, &[FREE; 3], down()).unwrap();
    let mut both = PathDynamics::new(&model, &[FREE; 4], down()).unwrap();
    let with = |values: &AxisVector, further: f64| {
        AxisVector::from_values(values.iter().copied().chain([further]))
    };
    let AxisMotion { position, velocity, acceleration } = &motion;
    let torque =
        both.at(&with(position, 0.1), &with(velocity, 0.2), &with(acceleration, -3.0)).unwrap();
    let tripod = in_time(&mut alone, &motion);
    for (axis, found) in torque.axes().iter().enumerate() {
        // 1 kg.
        let expected = if axis < 3 { tripod[axis] } else { -3.0 };
        assert!((found.effort(0.0, 1.0) - expected).abs() < 1e-12, "{axis}");
    }
}

/// At rest with the platform in the middle every motor carries its carriage and a third of the rest.
#[test]
fn a_tripod_carries_itself() {
    let mut dynamics = PathDynamics::new(&thin(), &[FREE; 3], down()).unwrap();
    let zero = axes([0.0; 3]);
    let torque = dynamics.at(&axes([0.35; 3]), &zero, &zero).unwrap();
    for axis in torque.axes() {
        assert!((axis.weight - G * (1.5 + (1.0 + 0.6) / 3.0)).abs() < 1e-12, "{axis:?}");
        assert!(axis.inertia.abs() < 1e-15 && axis.centrifugal.abs() < 1e-15);
    }
    let error = dynamics.at(&axes([0.0, 0.0, 2.0]), &zero, &zero).unwrap_err();
    assert_eq!(error, PhysicsError::Apart);
}

#[test]
fn what_is_no_tripod_is_said() {
    let found = |model: &Model| PathDynamics::new(model, &[FREE; 3], down()).map(|_| ());
    let model = thin();
    assert_eq!(found(&model), Ok(()));
    let unknown = Err(PhysicsError::UnknownMechanism(5));
    let changed = |change: &dyn Fn(&mut Model)| {
        let mut model = model.clone();
        change(&mut model);
        found(&model)
    };
    let link = |name| model.links.iter().position(|link| link.name == name).unwrap();
    let (cross, rod) = (link("rod2_swing"), link("rod3"));
    let of_rod = |change: &dyn Fn(&mut Inertial)| {
        changed(&|model| change(model.links[rod].inertial.as_mut().unwrap()))
    };
    let heavy = Some(uniform_box(0.1, [0.0; 3], [0.01; 3]));
    assert_eq!(changed(&|model| model.joints[0].axis = Vector3::x_axis()), unknown);
    assert_eq!(changed(&|model| model.links[cross].inertial = heavy), unknown);
    assert_eq!(changed(&|model| model.loops[2].links[1] = 1), unknown);
    let fewer = changed(&|model| model.loops.truncate(4));
    assert_eq!(fewer, Err(PhysicsError::UnknownMechanism(4)));
    assert_eq!(of_rod(&|rod| rod.center.x = 1e-3), Err(PhysicsError::UnevenRod(rod)));
    assert_eq!(of_rod(&|rod| rod.inertia.m11 *= 1.01), Err(PhysicsError::UnevenRod(rod)));
}

/// With a rod longer by a nanometre the platform is found in another way, and the forces are nearly the same.
#[test]
fn level_and_tilting_platforms_are_one_machine() {
    let mut deviations = TripodDeviations::default();
    deviations.rod_lengths[3] = 1e-9;
    let models = [TripodDeviations::default(), deviations].map(|deviations| generated(&deviations));
    let AxisMotion { position, velocity, acceleration } = circle(0.2);
    let found = models.map(|model| {
        let mut dynamics = PathDynamics::new(&model, &[FREE; 3], down()).unwrap();
        dynamics.at(&position, &velocity, &acceleration).unwrap()
    });
    let [level, tilting] = found;
    for (one, other) in level.axes().iter().zip(tilting.axes()) {
        let difference = one.effort(0.5, 1.2) - other.effort(0.5, 1.2);
        assert!(difference != 0.0 && difference.abs() < 1e-5, "{difference} N");
    }
}
