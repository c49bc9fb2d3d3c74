//! Tests of simulated machines with coupled axes: H belts in closed form, a tripod against a peer's states.
//!
//! Transform, model and rapier's bodies agree in every pose.

use proptest::prelude::*;
use twin_kinematics::Kinematics;
use twin_kinematics::gantry::{BeltLayout, GantryH2};
use twin_kinematics::tripod::Tripod;

use super::parallel::{circle, h_gantry, rings, rows_of, thin};
use super::*;

/// The tip of the tool as rapier's bodies have it.
fn tip_of_bodies(machine: &PhysicsMachine, model: &Model) -> Point3<f64> {
    machine.link_poses()[model.tip.link] * model.tip.point
}

/// The peer's forces from its own feed-forward and controller, each held for a millisecond, on the whole machine.
#[test]
fn a_tripod_under_a_controller_moves_as_the_peer_does() {
    let columns = [
        "t_s", "x", "y", "z", "f_ff1", "f_ff2", "f_ff3", "q_set1", "q_set2", "q_set3", "v_set1",
        "v_set2", "v_set3",
    ];
    let Some(rows) = rows_of("tripod_circle.csv", columns) else { return };
    let model = thin();
    let start = circle(0.0);
    let mut machine = moving(&model, &[SLACK; 3], down(), &start);
    let tripod = Tripod::new(rings(), [0.0; 3]).unwrap();
    let w = std::f64::consts::TAU * 15.0;
    let (kp, kd) = (2.5 * w * w, 5.0 * w);
    let (mut worst, mut apart) = (0.0_f64, 0.0_f64);
    // The peer measures from the rod ends of the platform.
    let tip = model.tip_position(&start.position);
    let [_, x, y, z, ..] = rows[0];
    let to_tip = tip - Point3::new(x, y, z);
    for [_, x, y, z, f1, f2, f3, q1, q2, q3, v1, v2, v3] in &rows {
        let (q, v) = (machine.joints.axes.position, machine.joints.axes.velocity);
        let place = Kinematics::forward(&tripod, &axis_vector(&q, 3)).unwrap().position;
        worst = worst.max((place - Point3::new(*x, *y, *z)).norm());
        let bodies = tip_of_bodies(&machine, &model);
        apart = apart.max((bodies - (place + to_tip)).norm());
        apart = apart.max((bodies - model.tip_position(&axis_vector(&q, 3))).norm());
        let force = joints([*f1, *f2, *f3])
            + (joints([*q1, *q2, *q3]) - q) * kp
            + (joints([*v1, *v2, *v3]) - v) * kd;
        machine.step_with_efforts(&axis_vector(&force, 3)).unwrap();
    }
    println!("{} rows, at most {worst:e} m from the peer, bodies {apart:e} m apart", rows.len());
    assert!(rows.len() >= 2000 && worst <= 1e-9, "{worst} m");
    assert!(apart <= 1e-10, "{apart} m");
}

proptest! {
    /// Both motors of an H belt with forces that are constant: bridge and carriage are thrown, and each motor feels half of
    /// both and its own rotor. Closed form: the two motors' equations with constant coefficients.
    #[test]
    fn an_h_belt_is_thrown_as_newton_says(
        forces in prop::array::uniform2(-5.0..5.0_f64),
        rotors in prop::array::uniform2(0.0..3.0_f64),
        coordinates_exchanged in any::<bool>(),
        drives_exchanged in any::<bool>(),
    ) {
        let layout = BeltLayout { coordinates_exchanged, drives_exchanged };
        let by_drives = layout.coordinates_by_drives();
        let factors = [0, 1].map(|row| [0, 1].map(|column| by_drives[(row, column)]));
        let model = h_gantry(factors);
        let drives = [rotors[0], rotors[1], 0.0].map(|armature| AxisDriveParameters { armature, ..SLACK });
        let mut machine = started(&model, &drives, down(), &axes([0.0; 3]));
        let transform = GantryH2::new([0.0; 2], layout).unwrap();
        let effort = axes([forces[0], forces[1], G]);
        let origin = model.tip_position(&[0.0; 3]);
        let there = Kinematics::forward(&transform, &axes([0.0; 2])).unwrap().position;
        for _ in 0..100 {
            let state = machine.step_with_efforts(&effort).unwrap();
            let [a, b, _] = [0, 1, 2].map(|axis| state.position.get(axis).copied().unwrap());
            let place = Kinematics::forward(&transform, &axes([a, b])).unwrap().position - there;
            let tip = tip_of_bodies(&machine, &model);
            prop_assert!((tip - origin - place).norm() < 1e-10);
            prop_assert!((tip - model.tip_position(&state.position)).norm() < 1e-10);
        }
        let [[xa, xb], [ya, yb]] = factors;
        let (bridge, carriage) = (6.5, 2.5);
        let m = [
            [bridge * xa * xa + carriage * ya * ya + rotors[0], bridge * xa * xb + carriage * ya * yb],
            [bridge * xa * xb + carriage * ya * yb, bridge * xb * xb + carriage * yb * yb + rotors[1]],
        ];
        let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
        let accelerations = [
            (m[1][1] * forces[0] - m[0][1] * forces[1]) / determinant,
            (m[0][0] * forces[1] - m[1][0] * forces[0]) / determinant,
        ];
        let state = machine.axis_state();
        for (axis, acceleration) in accelerations.into_iter().enumerate() {
            let expected = 0.5 * acceleration * 0.01;
            let found = state.position.get(axis).copied().unwrap();
            prop_assert!((found - expected).abs() < 1e-12, "{axis}: {found} m, not {expected} m");
        }
    }
}
