//! Tests of the whole machine against the peers' files at every millisecond, and against conserved quantities.
//!
//! `scara.rs` has some rows of the files as facts. This file tests all rows, if the files are present (`TWIN_SHARED` or
//! next to the workspace).

use std::f64::consts::TAU;

use twin_kinematics::tripod::TripodDeviations;

use super::parallel::{circle, generated, rows_of};
use super::scara::{free_motion, scara, tip};
use super::*;

/// What the issue allows at the tip, m.
const NANOMETRE: f64 = 1e-9;

/// The SCARA of the files as one row has it.
fn machine(gravity: Vector3<f64>, position: JointVector, velocity: JointVector) -> PhysicsMachine {
    let [position, velocity] = [position, velocity].map(|values| axis_vector(&values, 3));
    let first = AxisMotion { velocity, ..AxisMotion::at_rest(position) };
    moving(&scara(), &[SLACK; 3], gravity, &first)
}

/// How far the tip is from where the peer has it, by the axes and by rapier's bodies, m.
fn off(machine: &PhysicsMachine, peer: &JointVector) -> f64 {
    // The flange of the last link is 120 mm above the tip.
    let bodies = machine.link_poses()[3] * Point3::new(0.0, 0.0, -0.12);
    let expected = tip(peer);
    let by_axes = (tip(&machine.joints.axes.position) - expected).norm();
    by_axes.max((bodies.coords - expected).norm())
}

/// Under the peer's controller, and with its efforts alone, where nothing corrects what goes wrong and errors add up for 5 s.
#[test]
fn the_tip_is_where_the_peers_is() {
    let columns = [
        "q_set1", "q_set2", "q_set3", "v_set1", "v_set2", "v_set3", "tau_ff1", "tau_ff2",
        "tau_ff3", "q1", "q2", "q3", "v1", "v2", "v3", "tau1", "tau2", "tau3",
    ];
    let Some(rows) = rows_of("scara_circle.csv", columns) else { return };
    let vectors =
        |row: &[f64; 18]| [0, 3, 6, 9, 12, 15].map(|i| joints([row[i], row[i + 1], row[i + 2]]));
    let [.., position, velocity, _] = vectors(&rows[0]);
    let w = TAU * 15.0;
    let [kp, kd] = [w * w, 2.0 * w].map(|factor| joints([2.0, 0.3, 2.0]) * factor);
    for controlled in [true, false] {
        let mut machine = machine(down(), position, velocity);
        let mut worst = 0.0_f64;
        for row in &rows {
            let [q_set, v_set, ahead, q, _, replayed] = vectors(row);
            worst = worst.max(off(&machine, &q));
            let JointState { position, velocity } = machine.joints.axes;
            let correction =
                kp.component_mul(&(q_set - position)) + kd.component_mul(&(v_set - velocity));
            let effort = if controlled { ahead + correction } else { replayed };
            machine.step_with_efforts(&axis_vector(&effort, 3)).unwrap();
        }
        assert!(rows.len() > 5000 && worst <= NANOMETRE, "controlled {controlled}: {worst} m");
    }
}

/// Kinetic energy (J) and angular momentum about z (kg·m²/s) of the SCARA, link by link from its dimensions: each centre of mass
/// at r turns the links with ω about their own, E = Σ ½·m·|ṙ|² + ½·I·ω², L = Σ m·(r × ṙ) + I·ω.
fn constants(state: &JointState) -> [f64; 2] {
    let (q, v) = (&state.position, &state.velocity);
    let directions = [q[0], q[0] + q[1]].map(|angle| [angle.cos(), angle.sin()]);
    let turning = [v[0], v[0] + v[1], v[0] + v[1]];
    let about = |mass: f64, [x, y]: [f64; 2]| mass * (x * x + y * y) / 12.0;
    // Mass, parts of the way along both arms (m), inertia about the centre of mass.
    let links = [
        (8.0, [0.2, 0.0], about(8.0, [0.4, 0.1])),
        (4.0, [0.4, 0.15], about(4.0, [0.3, 0.08])),
        (2.0, [0.4, 0.3], about(2.0, [0.04, 0.04])),
    ];
    let mut sums = [0.0; 2];
    for ((mass, parts, inertia), turning) in links.into_iter().zip(turning) {
        let (mut place, mut velocity) = ([0.0; 2], [0.0; 2]);
        for (arm, part) in parts.into_iter().enumerate() {
            let [cos, sin] = directions[arm];
            let rate = [v[0], v[0] + v[1]][arm];
            place = [place[0] + part * cos, place[1] + part * sin];
            velocity = [velocity[0] - part * sin * rate, velocity[1] + part * cos * rate];
        }
        let [vx, vy] = velocity;
        sums[0] += 0.5 * mass * (vx * vx + vy * vy) + 0.5 * inertia * turning * turning;
        sums[1] += mass * (place[0] * vy - place[1] * vx) + inertia * turning;
    }
    sums[0] += 0.5 * 2.0 * v[2] * v[2];
    sums
}

/// 5 s without efforts and gravity: energy and angular momentum stay, and the axes are where the peer's are, the tip in every row
/// of its file, if that is there.
#[test]
fn free_motion_keeps_energy_and_angular_momentum() {
    let mut machine = machine(Vector3::zeros(), joints([0.0, 1.0, 0.0]), joints([3.0, -2.0, 0.0]));
    let start = constants(&machine.joints.axes);
    // By hand with ω = 3 and 1: L = (I₁ + m₁·0.2²)·3 + I₂ + I₃ + Σ m·(r × ṙ) of the others.
    let along = 4.0 * 0.15 + 2.0 * 0.3;
    let expected = 3.0 * (8.0 * 0.17 / 12.0 + 8.0 * 0.04)
        + 4.0 * (0.09 + 0.0064) / 12.0
        + 2.0 * 0.0032 / 12.0
        + 3.0 * 6.0 * 0.16
        + along * 0.4 * f64::cos(1.0) * (3.0 + 1.0)
        + 4.0 * 0.15 * 0.15
        + 2.0 * 0.09;
    assert!((start[1] - expected).abs() < 1e-12, "{start:?}, not {expected}");
    let rows = rows_of("scara_free.csv", ["q1", "q2", "q3"]);
    let mut facts = free_motion().into_iter().peekable();
    let (mut worst, mut changed) = (0.0_f64, [0.0_f64; 2]);
    for cycle in 0..=5000_u16 {
        let JointState { position, velocity } = machine.joints.axes;
        if let Some([_, a, b, c, d]) = facts.next_if(|[at, ..]| *at <= f64::from(cycle)) {
            let error = [position - joints([a, b, 0.0]), velocity - joints([c, d, 0.0])];
            let [q, v] = error.map(|error| error.amax());
            assert!(q < 1e-9 && v < 1e-8, "cycle {cycle}: {q} rad, {v} rad/s off");
        }
        if let Some(rows) = &rows {
            worst = worst.max(off(&machine, &joints(rows[usize::from(cycle)])));
        }
        let now = constants(&machine.joints.axes);
        changed = [0, 1].map(|i| changed[i].max((now[i] / start[i] - 1.0).abs()));
        machine.step_with_efforts(&axes([0.0; 3])).unwrap();
    }
    assert_eq!(facts.next(), None);
    let turned = machine.joints.axes.position[0];
    assert!(turned > TAU, "{turned} rad");
    assert!(changed[0] <= 1e-10 && changed[1] <= 1e-9, "{changed:?}");
    assert!(worst <= NANOMETRE, "{worst} m");
}

/// Points that loops make one are one in rapier's bodies, on a level platform and on one that tilts because a rod is longer.
#[test]
fn the_loops_of_a_tripod_stay_closed_in_rapiers_bodies() {
    let mut longer = TripodDeviations::default();
    longer.rod_lengths[1] = 0.4e-3;
    for deviations in [TripodDeviations::default(), longer] {
        let model = generated(&deviations);
        let start = circle(0.0);
        let drives =
            drives_of(&model, &start.position, |inertia| tuned(inertia, 50.0, f64::INFINITY));
        let mut machine = moving(&model, &drives, down(), &start);
        let first = machine.link_poses()[model.tip.link];
        let (mut open, mut way, mut tilt) = (0.0_f64, 0.0_f64, 0.0_f64);
        for cycle in 1..=2000 {
            machine.step(&circle(f64::from(cycle) * 1e-3)).unwrap();
            let poses = machine.link_poses();
            for closed in &model.loops {
                let [one, other] = [0, 1].map(|end| poses[closed.links[end]] * closed.points[end]);
                open = open.max((one - other).norm());
            }
            let platform = poses[model.tip.link];
            way = way.max((platform.translation.vector - first.translation.vector).norm());
            tilt = tilt.max(platform.rotation.angle());
        }
        assert_eq!(model.loops.len(), 5);
        assert!(open <= 1e-12, "{open} m");
        let tilts = deviations != TripodDeviations::default();
        assert!(way > 0.1 && (tilt > 1e-4) == tilts, "{way} m, {tilt} rad");
    }
}
