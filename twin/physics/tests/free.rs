//! Tests of conserved quantities: undriven machines keep energy and free momenta over 5 s.
//!
//! The expected values are computed here from the dimensions of the machines. `reference.rs` tests the SCARA with two
//! arms.

use std::f64::consts::TAU;

use nalgebra::Complex;
use twin_kinematics::Kinematics;
use twin_kinematics::tripod::Tripod;

use super::parallel::{rings, thin};
use super::*;

/// Relative difference.
const ALLOWED: f64 = 1e-9;

/// The state after 5 s, in which `constants` stay as they are at the start. These axes have other velocities then.
fn keeps<const A: usize, const N: usize>(
    model: &Model,
    gravity: Vector3<f64>,
    [position, velocity]: [[f64; A]; 2],
    constants: impl Fn(&JointState) -> [f64; N],
    (changing, change): (std::ops::Range<usize>, f64),
) -> AxisState {
    let first = motion([position, velocity, [0.0; A]]);
    let mut machine = moving(model, &[SLACK; A], gravity, &first);
    let start = constants(&machine.joints.axes);
    let mut changes = [0.0_f64; N];
    for _ in 0..5000 {
        machine.push([0.0; A], 1);
        let now = constants(&machine.joints.axes);
        changes = std::array::from_fn(|i| changes[i].max((now[i] / start[i] - 1.0).abs()));
    }
    println!("{}: {changes:?}", model.name);
    assert!(changes.iter().all(|change| *change <= ALLOWED), "{changes:?}");
    // They take from each other.
    let state = *machine.axis_state();
    let mut apart = changing.map(|axis| (state.velocity[axis] - velocity[axis]).abs());
    assert!(apart.all(|apart| apart > change), "{state:?}");
    state
}

/// Three arms in a plane, whose masses are off their middle lines, and a quill.
#[test]
fn a_scara_with_three_arms_keeps_energy_and_angular_momentum() {
    // Distance to the next joint (m), mass (kg), its place along and across (m), edges (m).
    let arms = [
        (0.25, 6.0, [0.11, 0.02], [0.25, 0.09]),
        (0.20, 3.0, [0.08, -0.03], [0.20, 0.07]),
        (0.00, 0.9, [0.06, 0.015], [0.12, 0.05]),
    ];
    let (quill, offset) = (1.2, [0.04, -0.01]);
    let mut from = 0.0;
    let [one, two, three] = arms.map(|(next, mass, [x, y], [along, across])| {
        let body = uniform_box(mass, [x, y, 0.03], [along, across, 0.05]);
        let origin = Isometry3::translation(std::mem::replace(&mut from, next), 0.0, 0.0);
        (JointKind::Revolute, Vector3::z(), origin, Some(body))
    });
    let [x, y] = offset;
    let body = uniform_box(quill, [x, y, 0.0], [0.03, 0.03, 0.3]);
    let slide = (JointKind::Prismatic, Vector3::z(), Isometry3::identity(), Some(body));
    let model = chain([one, two, three, slide]);

    let constants = |state: &JointState| {
        let (q, v) = (&state.position, &state.velocity);
        let (mut energy, mut momentum) = (0.5 * quill * v[3] * v[3], 0.0);
        // The joint in the plane of complex numbers, and how it moves.
        let (mut joint, mut moves) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
        let (mut angle, mut rate) = (0.0, 0.0);
        let mut add = |mass: f64, about: f64, place: Complex<f64>, way: Complex<f64>, rate: f64| {
            energy += 0.5 * mass * way.norm_sqr() + 0.5 * about * rate * rate;
            momentum += mass * (place.conj() * way).im + about * rate;
        };
        for (index, (next, mass, [x, y], [along, across])) in arms.into_iter().enumerate() {
            (angle, rate) = (angle + q[index], rate + v[index]);
            let turned = Complex::from_polar(1.0, angle);
            let turning = turned * Complex::new(0.0, rate);
            let center = Complex::new(x, y);
            let about = mass * (along * along + across * across) / 12.0;
            add(mass, about, joint + turned * center, moves + turning * center, rate);
            if index == 2 {
                let center = Complex::new(offset[0], offset[1]);
                let about = quill * 2.0 * 0.03 * 0.03 / 12.0;
                add(quill, about, joint + turned * center, moves + turning * center, rate);
            }
            (joint, moves) = (joint + turned * next, moves + turning * next);
        }
        [energy, momentum]
    };
    let start = [[0.0, 1.0, -0.5, 0.0], [3.0, -2.0, 5.0, 0.02]];
    let state = keeps(&model, Vector3::zeros(), start, constants, (0..3, 0.01));
    assert!(state.position[0].abs() > TAU, "{state:?}");
}

/// Three slides and something on an axle that is not balanced: energy, momentum along both slides, and that of the third.
#[test]
fn a_gantry_with_an_unbalanced_axle_keeps_energy_and_momentum() {
    let masses = [12.0, 5.0, 3.0, 2.0];
    let (aside, edges) = ([0.12, -0.05], [0.3, 0.1]);
    let body = |mass| Some(uniform_box(mass, [0.03, 0.02, 0.1], [0.3, 0.2, 0.1]));
    let turning = uniform_box(masses[3], [aside[0], aside[1], -0.1], [edges[0], edges[1], 0.05]);
    let lifted = |z| Isometry3::translation(0.0, 0.0, z);
    let model = chain([
        (JointKind::Prismatic, Vector3::x(), Isometry3::identity(), body(masses[0])),
        (JointKind::Prismatic, Vector3::y(), lifted(0.2), body(masses[1])),
        (JointKind::Prismatic, Vector3::z(), lifted(-0.1), body(masses[2])),
        (JointKind::Revolute, Vector3::z(), lifted(-0.2), Some(turning)),
    ]);
    let about = masses[3] * (edges[0] * edges[0] + edges[1] * edges[1]) / 12.0;
    let constants = |state: &JointState| {
        let (q, v) = (&state.position, &state.velocity);
        let way = Complex::from_polar(1.0, q[3])
            * Complex::new(aside[0], aside[1])
            * Complex::new(0.0, v[3]);
        let (x, y) = (v[0] + way.re, v[1] + way.im);
        let along = (masses[0] + masses[1] + masses[2]) * v[0] + masses[3] * x;
        let across = (masses[1] + masses[2]) * v[1] + masses[3] * y;
        let squares = masses[0] * v[0] * v[0]
            + masses[1] * (v[0] * v[0] + v[1] * v[1])
            + masses[2] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
            + masses[3] * (x * x + y * y + v[2] * v[2])
            + about * v[3] * v[3];
        [0.5 * squares, along, across, v[2]]
    };
    let start = [[0.0, 0.0, 0.0, 0.3], [0.2, -0.1, 0.05, 9.0]];
    let state = keeps(&model, Vector3::zeros(), start, constants, (0..2, 1e-3));
    assert!(state.position[3] > 3.0 * TAU, "{state:?}");
}

/// A tripod, whose platform falls sideways a little: energy, of rods that are lines from the carriages to the platform.
#[test]
fn a_tripod_keeps_its_energy() {
    let model = thin();
    let tripod = Tripod::new(rings(), [0.0; 3]).unwrap();
    let gravity = Vector3::new(0.003, -0.002, 0.0);
    let [carriage, rod, platform] = [1.5, 0.1, 1.0];
    let constants = |state: &JointState| {
        let heights = axis_vector(&state.position, 3);
        let place = Kinematics::forward(&tripod, &heights).unwrap().position.coords;
        // From the middles of the upper ends of each pair to those of the lower ones, 120° apart from 90° on.
        let pairs = [0.0, 1.0, 2.0].map(|third| {
            let (sin, cos) = (TAU / 4.0 + TAU / 3.0 * third).sin_cos();
            Vector3::new(cos, sin, 0.0)
        });
        let upper = [0, 1, 2].map(|axis| pairs[axis] * 0.25 + Vector3::z() * heights[axis]);
        let rods = [0, 1, 2].map(|axis| place + pairs[axis] * 0.05 - upper[axis]);
        assert!(rods.iter().all(|rod| (rod.norm() - 0.4).abs() < 1e-12), "{rods:?}");
        // No rod becomes longer: its ends have one speed along it.
        let [a, b, c] = rods.map(|rod| rod.transpose());
        let along = Matrix3::from_rows(&[a, b, c]);
        let speeds = Vector3::from_fn(|axis, _| rods[axis].z * state.velocity[axis]);
        let moves = along.try_inverse().unwrap() * speeds;
        let mut kinetic = 0.5 * platform * moves.norm_squared();
        let mut potential = -platform * gravity.dot(&place);
        for axis in 0..3 {
            let end = Vector3::z() * state.velocity[axis];
            kinetic += 0.5 * carriage * end.norm_squared();
            let squares = end.norm_squared() + end.dot(&moves) + moves.norm_squared();
            kinetic += 2.0 * 0.5 * rod * squares / 3.0;
            potential -= 2.0 * rod * gravity.dot(&(upper[axis] + rods[axis] * 0.5));
        }
        [kinetic + potential]
    };
    keeps(&model, gravity, [[0.35; 3], [0.02, -0.015, 0.01]], constants, (0..3, 1e-3));
}
