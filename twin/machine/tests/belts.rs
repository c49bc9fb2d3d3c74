//! Tests of H gantries against equations of motion of their belt: unequal rotors, elastic belts, gravity in any
//! direction.
//!
//! Motors A and B on pulleys of radius r pull the belt. With A = x + y and B = x − y, their belt forces F and G move
//! the bridge (M, with all that it carries) and the carriage (m). At the belt of each motor, position s, a rigid belt
//! transmits the torque τ less rotor J and friction c. An elastic belt transmits the force of its spring k and damper
//! d, while the motor, at p along the belt, moves independently:
//!
//! ```text
//! M·x″ = F + G + M·gx,    m·y″ = F − G + m·gy
//! rigid:   F = τ/r − J/r²·s″ − c·s′
//! elastic: F = k·(p − s) + d·(p′ − s′) − c·s′,    J/r²·p″ = τ/r − k·(p − s) − d·(p′ − s′)
//! ```

use super::{edited, load};
use crate::Machine;
use std::f64::consts::TAU;
use twin_kinematics::{AxisMotion, AxisVector, Kinematics};
use twin_physics::{PhysicsMachine, axis_inertia};

const SHIPPED: &str = include_str!("../../../machines/gantry_h2.toml");

/// Bridge, carriage, quill and tool of the shipped file, kg: what moves along x, along y and along z.
const MASSES: [f64; 3] = [4.0 + 1.5 + 1.0 + 0.2, 1.5 + 1.0 + 0.2, 1.0 + 0.2];
/// Of the pulleys: 40 mm in a turn.
const RADIUS: f64 = 0.04 / TAU;
/// Of the rotors, kg·m².
const ROTORS: [f64; 2] = [3e-5, 9e-5];
/// N·s/m.
const VISCOUS: [f64; 2] = [10.0, 25.0];
/// N/m.
const STIFFNESS: [f64; 2] = [1.5e5, 2.5e5];
const DAMPING_RATIO: f64 = 0.08;
/// As on a tilted machine, m/s².
const GRAVITY: [f64; 3] = [1.2, -2.5, -9.3];

/// The shipped file with its motors as above, everything said at their shafts, and the belt rigid or not.
fn text(elastic: bool) -> String {
    let mut text = SHIPPED.to_owned();
    for motor in 0..2 {
        let belt = if elastic {
            let stiffness = STIFFNESS[motor] * 1e-3;
            format!("stiffness_n_per_mm = {stiffness:?}\ndamping_ratio = {DAMPING_RATIO:?}\n")
        } else {
            String::new()
        };
        let physics = format!(
            "max_force_n = 251.0\nviscous_friction_n_s_per_m = {:?}\n[axes.physics.transmission]\npitch_mm = 40.0\n{belt}\
             [axes.physics.servo]\nrotor_inertia_kg_m2 = {:?}\n",
            VISCOUS[motor], ROTORS[motor]
        );
        let shipped = "max_force_n = 250.0\ncoulomb_friction_n = 6.0\nviscous_friction_n_s_per_m = 10.0\nrotor_inertia_kg = 1.0\n";
        text = edited(&text, shipped, &physics);
    }
    let [x, y, z] = GRAVITY;
    let gravity = format!("[environment]\ngravity_m_per_s2 = [{x:?}, {y:?}, {z:?}]\n[program]\n");
    let text = edited(&text, "coulomb_friction_n = 5.0\nviscous_friction_n_s_per_m = 20.0\n", "");
    edited(&text, "[program]\n", &gravity)
}

/// The forces on the belt that hold it against gravity, N.
fn holding() -> [f64; 2] {
    let [along_x, along_y] = [0, 1].map(|way| -MASSES[way] * GRAVITY[way]);
    [0.5 * (along_x + along_y), 0.5 * (along_x - along_y)]
}

/// Forces of the motors in the cycle that begins at `t`, N: those that hold the machine, and others that swing.
fn forces(t: f64) -> [f64; 2] {
    let [a, b] = holding();
    [a + 25.0 * (9.0 * t).cos(), b - 18.0 * (14.0 * t).cos()]
}

/// Positions and velocities: the machine along x and y, and its motors along the belt.
type State = [[f64; 4]; 2];

/// The accelerations of the equations above.
fn accelerations(elastic: bool, [p, v]: &State, forces: [f64; 2]) -> [f64; 4] {
    let [bridge, carriage, _] = MASSES;
    let pulls = [bridge * GRAVITY[0], carriage * GRAVITY[1]];
    let motors = ROTORS.map(|rotor| rotor / (RADIUS * RADIUS));
    let of = |values: &[f64; 4]| [values[0] + values[1], values[0] - values[1]];
    let (belt, rates) = (of(p), of(v));
    let friction = [0, 1].map(|i| VISCOUS[i] * rates[i]);
    if elastic {
        let springs = [0, 1].map(|i| {
            // Against the belt at rest at the other motor, each feels a quarter of both masses.
            let moved = 0.25 * (bridge + carriage);
            let reduced = motors[i] * moved / (motors[i] + moved);
            let damping = 2.0 * DAMPING_RATIO * (STIFFNESS[i] * reduced).sqrt();
            STIFFNESS[i] * (p[2 + i] - belt[i]) + damping * (v[2 + i] - rates[i])
        });
        let [a, b] = [springs[0] - friction[0], springs[1] - friction[1]];
        return [
            (a + b + pulls[0]) / bridge,
            (a - b + pulls[1]) / carriage,
            (forces[0] - springs[0]) / motors[0],
            (forces[1] - springs[1]) / motors[1],
        ];
    }
    // Rotors that go with the belt: two equations, solved by Cramer's rule.
    let [a, b] = [forces[0] - friction[0], forces[1] - friction[1]];
    let (sum, difference) = (motors[0] + motors[1], motors[0] - motors[1]);
    let (right_x, right_y) = (a + b + pulls[0], a - b + pulls[1]);
    let determinant = (bridge + sum) * (carriage + sum) - difference * difference;
    let x = (right_x * (carriage + sum) - difference * right_y) / determinant;
    let y = ((bridge + sum) * right_y - difference * right_x) / determinant;
    [x, y, x + y, x - y]
}

/// A millisecond in steps of 5 µs: Runge and Kutta's.
fn advance(elastic: bool, state: &mut State, forces: [f64; 2]) {
    let dt = 5e-6;
    let ahead = |[p, v]: &State, [dp, dv]: &State, by: f64| {
        let moved =
            |values: &[f64; 4], rates: &[f64; 4]| [0, 1, 2, 3].map(|i| values[i] + by * rates[i]);
        [moved(p, dp), moved(v, dv)]
    };
    let slope = |state: &State| [state[1], accelerations(elastic, state, forces)];
    for _ in 0..200 {
        let first = slope(state);
        let second = slope(&ahead(state, &first, 0.5 * dt));
        let third = slope(&ahead(state, &second, 0.5 * dt));
        let fourth = slope(&ahead(state, &third, dt));
        for (part, slope) in [(1.0, first), (2.0, second), (2.0, third), (1.0, fourth)] {
            *state = ahead(state, &slope, part * dt / 6.0);
        }
    }
}

/// A machine of the file at its zero, with the drives that it has.
fn physics(machine: &Machine) -> PhysicsMachine {
    let start = AxisVector::zeros(3);
    let inertia = axis_inertia(&machine.model, &start).unwrap();
    let drives: Vec<_> = machine
        .axes
        .iter()
        .zip(inertia.iter())
        .map(|(axis, inertia)| axis.simulated.drive(*inertia))
        .collect();
    PhysicsMachine::new(&machine.model, &drives, machine.gravity, &start, machine.cycle_ns).unwrap()
}

/// Motors that pull for half a second: the machine goes where its equations lead.
#[test]
fn a_belt_moves_as_its_equations_say() {
    for (elastic, allowed) in [(false, 1e-12), (true, 1e-9)] {
        let machine = load(&text(elastic));
        let mut physics = physics(&machine);
        let mut state = [[0.0; 4]; 2];
        if elastic {
            // Wound up by what they hold.
            [state[0][2], state[0][3]] = [0, 1].map(|i| holding()[i] / STIFFNESS[i]);
        }
        let mut alike = state;
        let first = machine.kinematics.forward(&AxisVector::zeros(3)).unwrap().position;
        let (mut worst, mut way, mut apart) = (0.0_f64, 0.0_f64, 0.0_f64);
        for cycle in 0..500 {
            let [a, b] = forces(f64::from(cycle) * 1e-3);
            let effort = AxisVector::from_values([a, b, -MASSES[2] * GRAVITY[2]]);
            let axes = physics.step_with_efforts(&effort).unwrap().position;
            advance(elastic, &mut state, [a, b]);
            // As if the motors had changed places.
            advance(elastic, &mut alike, [b, a]);
            let [[x, y, ..], _] = state;
            let errors = [axes[0] - (x + y), axes[1] - (x - y), axes[2]];
            worst = errors.into_iter().fold(worst, |worst, error| worst.max(error.abs()));
            let tip = machine.kinematics.forward(&axes).unwrap().position;
            let tip_by_equations = first + nalgebra::Vector3::new(x, y, 0.0);
            worst = worst.max((tip - tip_by_equations).norm());
            let bodies = physics.link_poses()[machine.model.tip.link] * machine.model.tip.point;
            assert!((bodies - tip).norm() < 1e-10, "{bodies} {tip}");
            way = way.max(x.abs()).max(y.abs());
            apart = apart.max((alike[0][0] - x).abs());
        }
        println!("elastic {elastic}: at most {worst:e} m apart, {way} m there and back");
        assert!(worst <= allowed, "elastic {elastic}: {worst} m");
        assert!(way > 0.01 && apart > 1e-4, "{way} m, {apart} m");
    }
}

/// The drives of the file hold the machine against gravity, whichever way it pulls, and take the tool where it is sent.
#[test]
fn drives_hold_and_move_it() {
    for elastic in [false, true] {
        let machine = load(&text(elastic));
        let start = AxisVector::zeros(3);
        let mut physics = machine.physics(&start).unwrap();
        let [a, b] = holding();
        for _ in 0..300 {
            let state = physics.step(&AxisMotion::at_rest(start)).unwrap();
            assert!(state.position.iter().all(|position| position.abs() < 1e-10), "{state:?}");
            for (found, expected) in state.effort.iter().zip([a, b, -MASSES[2] * GRAVITY[2]]) {
                assert!((found - expected).abs() < 1e-6, "{state:?}, not {expected} N");
            }
        }
        // 50 mm along x and 30 mm along −y within half a second, at rest at both ends.
        let (from, to) = ([0.0, 0.0, 0.0], [0.02, 0.08, 0.01]);
        let mut farthest = 0.0_f64;
        for cycle in 1..=1000 {
            let t = f64::from(cycle).min(500.0) / 500.0;
            let [s, v, acceleration] = [
                t * t * t * (10.0 - 15.0 * t + 6.0 * t * t),
                30.0 * t * t * (1.0 - t) * (1.0 - t) / 0.5,
                60.0 * t * (1.0 - t) * (1.0 - 2.0 * t) / 0.25,
            ];
            let along =
                |part: f64| AxisVector::from_values([0, 1, 2].map(|i| (to[i] - from[i]) * part));
            let (position, velocity, acceleration) = (along(s), along(v), along(acceleration));
            let state = physics.step(&AxisMotion { position, velocity, acceleration }).unwrap();
            for (found, expected) in state.position.iter().zip(position.iter()) {
                farthest = farthest.max((found - expected).abs());
            }
        }
        let state = physics.axis_state();
        let tool = machine.kinematics.forward(&state.position).unwrap().position;
        let sent = machine.kinematics.forward(&AxisVector::from_values(to)).unwrap().position;
        assert!((tool - sent).norm() < 1e-6, "elastic {elastic}: {tool} {sent}");
        // The limit of the file on the way.
        assert!(farthest < 0.5e-3 && farthest > 1e-7, "elastic {elastic}: {farthest} m");
        println!("elastic {elastic}: {farthest} m behind at most");
        let moved = machine.kinematics.forward(&start).unwrap().position - tool;
        assert!((moved.x + 0.05).abs() < 1e-6 && (moved.y - 0.03).abs() < 1e-6, "{moved}");
    }
}
