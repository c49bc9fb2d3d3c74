//! Tests of elastic drives with backlash and friction on machines of several kinds, against fine steps of the same
//! model: of a microsecond on the SCARA, of two on the others.

use std::f64::consts::TAU;

use twin_kinematics::Kinematics;
use twin_kinematics::tripod::{Tripod, TripodDeviations};

use super::parallel::{circle, generated, h_gantry, rings};
use super::*;

/// An elastic transmission of this stiffness and backlash between a motor and an axis of these inertias, with dry and viscous friction on
/// both sides, and a position loop of `bandwidth_hz`.
fn elastic(
    [motor, axis]: [f64; 2],
    [stiffness, backlash]: [f64; 2],
    friction: [[f64; 2]; 2],
    bandwidth_hz: f64,
) -> AxisDriveParameters {
    let [friction, motor_friction] =
        friction.map(|[dry, viscous]| FrictionParameters::new(dry, viscous));
    AxisDriveParameters {
        armature: motor,
        friction: FrictionParameters {
            breakaway: 1.3 * friction.coulomb,
            stribeck_velocity: 0.01,
            ..friction
        },
        motor_friction,
        transmission: Some(ElasticTransmission::damped(stiffness, 0.05, backlash, motor, axis)),
        ..AxisDriveParameters::servo(ServoParameters {
            current_bandwidth: TAU * 800.0,
            delay: 1,
            ..ServoParameters::tuned(motor + axis, bandwidth_hz, f64::INFINITY)
        })
    }
}

/// A motor that is a third of what the axis moves, behind a spring on which both swing 60 times a second.
fn swinging(inertia: f64) -> AxisDriveParameters {
    let (motor, axis) = (inertia / 3.0, inertia);
    let stiffness = (TAU * 60.0).powi(2) * motor * axis / (motor + axis);
    let friction = [[inertia; 2], [0.3 * inertia; 2]];
    elastic([motor, axis], [stiffness, 2e-5], friction, 10.0)
}

/// Tips of `model` in its own steps and in steps of `fine` s stay within `allowed` m, while it goes somewhere, and springs and play are
/// felt. Gives the distance from the set-point after the last cycle, m.
#[track_caller]
fn is_as_fine_steps(
    (model, drives): (&Model, &[AxisDriveParameters]),
    (cycles, fine, allowed): (u32, f64, f64),
    motion: impl Fn(f64) -> AxisMotion,
    tip: impl Fn(&AxisVector) -> Point3<f64>,
) -> f64 {
    let start = motion(0.0);
    let machine = moving(model, drives, down(), &start);
    let [own, fine] = [machine.clone(), machine.with_steps_of(fine)].map(|mut machine| {
        let tips = (1..=cycles).map(|cycle| {
            machine.step(&motion(f64::from(cycle) * 1e-3)).unwrap();
            tip(&machine.axis_state().position)
        });
        tips.collect::<Vec<_>>()
    });
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let first = tip(&start.position);
    let set = (1..).map(|cycle| tip(&motion(f64::from(cycle) * 1e-3).position));
    let behind: Vec<_> = fine.iter().zip(set).map(|(fine, set)| (fine - set).norm()).collect();
    let apart = most(&mut own.iter().zip(&fine).map(|(own, fine)| (own - fine).norm()));
    let following = most(&mut behind.iter().copied());
    let way = most(&mut fine.iter().map(|fine| (fine - first).norm()));
    println!("{apart:e} m apart, {following} m behind, over {way} m");
    assert!(apart <= allowed, "{apart} m");
    assert!(way > 0.05 && following > 1e-6, "{following} m, {way} m");
    *behind.last().unwrap()
}

/// On a machine of drives that swing.
#[track_caller]
fn swings_as_fine_steps(
    model: &Model,
    motion: impl Fn(f64) -> AxisMotion,
    tip: impl Fn(&AxisVector) -> Point3<f64>,
) {
    let drives = drives_of(model, &motion(0.0).position, swinging);
    is_as_fine_steps((model, &drives), (700, 2e-6, 0.02e-6), motion, tip);
}

/// A circle of 50 mm about a place, every axis of which turns about at some time.
fn round<const N: usize>(
    t: f64,
    of: impl Fn([f64; 3]) -> [f64; N],
    middle: [f64; N],
) -> AxisMotion {
    let (w, r) = (6.0, 0.05);
    let ((sin, cos), (up, along)) = ((w * t).sin_cos(), (2.0 * w * t).sin_cos());
    let h = 0.01;
    let mut position = of([r * cos, r * sin, h * up]);
    position.iter_mut().zip(middle).for_each(|(value, middle)| *value += middle);
    motion([
        position,
        of([-r * w * sin, r * w * cos, 2.0 * h * w * along]),
        of([-r * w * w * cos, -r * w * w * sin, -4.0 * h * w * w * up]),
    ])
}

#[test]
fn elastic_drives_of_a_gantry() {
    let motion = |t| round(t, |xyz| xyz, [0.1, 0.2, 0.3]);
    swings_as_fine_steps(&gantry(), motion, |axes| Point3::new(axes[0], axes[1], axes[2]));
}

/// Both motors at one belt, with springs of their own.
#[test]
fn elastic_drives_of_an_h_gantry() {
    // A = y + x, B = y − x.
    let model = h_gantry([[0.5, -0.5], [0.5, 0.5]]);
    let motion = |t| round(t, |[x, y, z]| [y + x, y - x, z], [0.0; 3]);
    swings_as_fine_steps(&model, motion, |axes| {
        Point3::new(0.5 * (axes[0] - axes[1]), 0.5 * (axes[0] + axes[1]), axes[2])
    });
}

#[test]
fn elastic_drives_of_a_tripod() {
    let tripod = Tripod::new(rings(), [0.0; 3]).unwrap();
    swings_as_fine_steps(&generated(&TripodDeviations::default()), circle, |axes| {
        Kinematics::forward(&tripod, axes).unwrap().position
    });
}

/// Gears of 100:1 and a belt, on the circle of the reference.
#[test]
fn elastic_drives_of_a_scara() {
    let model = scara::scara();
    let inertia = axis_inertia(&model, &scara::motion_at(0.0).position).unwrap();
    let drives = [(0.6, [2e4, 100e-6], 4.0), (0.2, [8e3, 100e-6], 2.0), (3.0, [1e6, 20e-6], 10.0)];
    let drives: Vec<_> = drives
        .into_iter()
        .zip(inertia.iter())
        .map(|((motor, spring, dry), inertia)| {
            let friction = [[dry, 0.5 * dry], [0.5 * dry, 0.2 * dry]];
            elastic([motor, *inertia], spring, friction, 30.0)
        })
        .collect();
    let tip = |axes: &AxisVector| Point3::from(scara::tip(&joint_vector(axes.iter().copied())));
    let behind = is_as_fine_steps((&model, &drives), (2000, 1e-6, 0.002e-6), scara::motion_at, tip);
    assert!(behind > 1e-6, "no such drive is that good");
}
