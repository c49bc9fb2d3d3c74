//! Tests of elastic drives with backlash and friction on machines of several kinds, against steps of two microseconds
//! of the same model.
//!
//! `elastic.rs` tests the SCARA, against steps of a microsecond.

use std::f64::consts::TAU;

use twin_kinematics::tripod::{Tripod, TripodDeviations};
use twin_kinematics::{Kinematics, Pose};

use super::parallel::{circle, generated, h_gantry, rings};
use super::*;

/// m.
const ALLOWED: f64 = 0.02e-6;

/// A motor that is a third of what the axis moves, behind a spring on which both swing 60 times a second.
fn elastic(inertia: f64) -> AxisDriveParameters {
    let (motor, axis) = (inertia / 3.0, inertia);
    let stiffness = (TAU * 60.0).powi(2) * motor * axis / (motor + axis);
    AxisDriveParameters {
        armature: motor,
        friction: FrictionParameters {
            breakaway: 1.3 * inertia,
            stribeck_velocity: 0.01,
            ..FrictionParameters::new(inertia, inertia)
        },
        motor_friction: FrictionParameters::new(0.3 * inertia, 0.3 * inertia),
        transmission: Some(ElasticTransmission::damped(stiffness, 0.05, 2e-5, motor, axis)),
        ..AxisDriveParameters::servo(ServoParameters {
            current_bandwidth: TAU * 800.0,
            delay: 1,
            ..ServoParameters::tuned(motor + axis, 10.0, f64::INFINITY)
        })
    }
}

/// The largest distance between the tips of `model` and of the same in steps of 2 µs, m; and how far either is from its set-points and
/// has gone.
fn apart(
    model: &Model,
    motion: impl Fn(f64) -> AxisMotion,
    tip: impl Fn(&AxisVector) -> Point3<f64>,
) -> [f64; 3] {
    let start = motion(0.0);
    let inertia = axis_inertia(model, &start.position).unwrap();
    let drives: Vec<_> = inertia.iter().map(|inertia| elastic(*inertia)).collect();
    let machine = started(model, &drives, down(), &start.position);
    let [own, fine] = [machine.clone(), machine.with_steps_of(2e-6)].map(|mut machine| {
        let moving = checked(&start.velocity, drives.len(), 0).unwrap();
        machine.start_moving(moving);
        let tips = (1..=700).map(|cycle| {
            machine.step(&motion(f64::from(cycle) * 1e-3)).unwrap();
            tip(&machine.axis_state().position)
        });
        tips.collect::<Vec<_>>()
    });
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let first = tip(&start.position);
    let set = (1..).map(|cycle| tip(&motion(f64::from(cycle) * 1e-3).position));
    [
        most(&mut own.iter().zip(&fine).map(|(own, fine)| (own - fine).norm())),
        most(&mut fine.iter().zip(set).map(|(fine, set)| (fine - set).norm())),
        most(&mut fine.iter().map(|fine| (fine - first).norm())),
    ]
}

#[track_caller]
fn is_good(name: &str, [apart, following, way]: [f64; 3]) {
    println!("{name}: {apart:e} m apart, {following} m behind, over {way} m");
    assert!(apart <= ALLOWED, "{name}: {apart} m");
    // It went somewhere, and springs and play were felt.
    assert!(way > 0.05 && following > 1e-6, "{name}: {following} m, {way} m");
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
    AxisMotion {
        position: axes(position),
        velocity: axes(of([-r * w * sin, r * w * cos, 2.0 * h * w * along])),
        acceleration: axes(of([-r * w * w * cos, -r * w * w * sin, -4.0 * h * w * w * up])),
    }
}

#[test]
fn elastic_drives_of_a_gantry() {
    let motion = |t| round(t, |xyz| xyz, [0.1, 0.2, 0.3]);
    is_good("gantry", apart(&gantry(), motion, |axes| Point3::new(axes[0], axes[1], axes[2])));
}

/// Both motors at one belt, with springs of their own.
#[test]
fn elastic_drives_of_an_h_gantry() {
    // A = y + x, B = y − x.
    let model = h_gantry([[0.5, -0.5], [0.5, 0.5]]);
    let motion = |t| round(t, |[x, y, z]| [y + x, y - x, z], [0.0; 3]);
    let tip = |axes: &AxisVector| {
        Point3::new(0.5 * (axes[0] - axes[1]), 0.5 * (axes[0] + axes[1]), axes[2])
    };
    is_good("H gantry", apart(&model, motion, tip));
}

#[test]
fn elastic_drives_of_a_tripod() {
    let model = generated(&TripodDeviations::default());
    let tripod = Tripod::new(rings(), [0.0; 3]).unwrap();
    let tip = |axes: &AxisVector| {
        let Pose { position, .. } = Kinematics::forward(&tripod, axes).unwrap();
        position
    };
    is_good("tripod", apart(&model, circle, tip));
}
