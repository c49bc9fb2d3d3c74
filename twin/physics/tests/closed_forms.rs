//! Tests of motions that have a closed form.

use std::f64::consts::{PI, TAU};

use super::elastic::slide;
use super::*;

#[test]
fn slides_move_as_newton_says() {
    let rotor = AxisDriveParameters { armature: 2.0, ..SLACK };
    // Velocity approaches F/c as 1 − exp(−c·t/m).
    let (rate, left) = (30.0 / 2.0, f64::exp(-30.0 * 0.1 / 2.0));
    let terminal = 12.0 / 30.0;
    let slowed = [terminal * (0.1 - (1.0 - left) / rate), terminal * (1.0 - left)];
    let holding = holding_effort(&lift(3.0), &axes([0.2]))[0];
    assert!((holding - 3.0 * G).abs() < 1e-12);
    // Mass, drive, gravity, start, effort; time in ms, position and velocity then.
    for (name, mass, drive, gravity, start, effort, time, expected, allowed) in [
        ("it falls", 3.0, SLACK, down(), 0.5, 0.0, 1000, [0.5 - 0.5 * G, -G], 1e-12),
        // A rotor that turns with the slide adds to what is moved, not to what falls.
        ("rotor", 3.0, rotor, down(), 0.0, 0.0, 500, [-0.075 * G, -0.3 * G], 1e-12),
        ("its weight holds it", 3.0, SLACK, down(), 0.2, holding, 1000, [0.2, 0.0], 1e-14),
        ("friction", 2.0, rough(0.0, 30.0), Vector3::zeros(), 0.0, 12.0, 100, slowed, 1e-11),
    ] {
        let mut machine = started(&lift(mass), &[drive], gravity, &axes([start]));
        let state = machine.push([effort], time);
        for (found, expected) in [state.position[0], state.velocity[0]].into_iter().zip(expected) {
            assert!((found - expected).abs() < allowed, "{name}: {state:?}, not {expected}");
        }
        assert_eq!(state.time_ns, i64::from(time) * CYCLE_NS, "{name}");
    }
}

/// A physical pendulum of large amplitude: its period is 2π·√(I/mgl) / agm(1, cos(θ₀/2)), its energy a constant.
#[test]
fn a_pendulum_swings_in_its_period() {
    let rod = uniform_box(2.0, [0.0, 0.0, -0.25], [0.04, 0.04, 0.5]);
    let model = chain([(
        JointKind::Revolute,
        Vector3::y(),
        Isometry3::translation(0.1, 0.2, 1.0),
        Some(rod),
    )]);
    let amplitude = 2.0_f64;
    let about_pivot = 2.0 * (0.04 * 0.04 + 0.5 * 0.5) / 12.0 + 2.0 * 0.25 * 0.25;
    let (mut arithmetic, mut geometric) = (1.0, (0.5 * amplitude).cos());
    for _ in 0..10 {
        (arithmetic, geometric) =
            (0.5 * (arithmetic + geometric), f64::sqrt(arithmetic * geometric));
    }
    let period = TAU * (about_pivot / (2.0 * G * 0.25)).sqrt() / arithmetic;

    assert!((axis_inertia(&model, &axes([0.3])).unwrap()[0] - about_pivot).abs() < 1e-14);
    let mut machine = started(&model, &[SLACK], down(), &axes([amplitude]));
    let start = machine.energy(&model);

    // It hangs straight down after a quarter, three quarters, five quarters ... of its period.
    let mut crossings = Vec::new();
    let mut before = *machine.axis_state();
    for _ in 0..10_000 {
        let now = machine.step_with_efforts(&axes([0.0])).unwrap();
        if before.position[0] * now.position[0] <= 0.0 {
            // Almost uniform motion within one cycle.
            let rest = now.position[0] / now.velocity[0];
            crossings.push(f64::from(u32::try_from(now.time_ns / 1000).unwrap()) * 1e-6 - rest);
        }
        before = now;
    }
    assert!(crossings.len() > 8);
    for (half_period, time) in (0_u32..).zip(crossings) {
        let expected = period * (0.25 + 0.5 * f64::from(half_period));
        assert!(
            (time - expected).abs() < 1e-8,
            "crossing {half_period} at {time} s instead of {expected} s"
        );
    }
    assert!(((machine.energy(&model) - start) / start).abs() < 1e-10);
}

#[test]
fn dry_friction_holds_and_brakes() {
    let drive = rough(4.0, 0.0);
    let mut machine = started(&slide(2.0), &[drive], down(), &axes([0.1]));
    let state = machine.push([3.9], 1000);
    assert!((state.position[0] - 0.1).abs() < 1e-14, "it creeps: {state:?}");
    // 10 N against 4 N for 0.5 s: 3 m/s², 0.375 m.
    let state = machine.push([10.0], 500);
    assert!((state.position[0] - 0.475).abs() < 1e-12, "{state:?}");
    assert!((state.velocity[0] - 1.5).abs() < 1e-12, "{state:?}");
    // 2 m/s² stop it after 0.75 s and 0.5625 m, and there it stays.
    let state = machine.push([0.0], 1000);
    assert!((state.position[0] - (0.475 + 0.5625)).abs() < 1e-9, "{state:?}");
    assert!(state.velocity[0].abs() < 1e-12, "{state:?}");
}

/// Axes that pull at each other stick together: nothing creeps, however long gravity works.
#[test]
fn coupled_axes_stick() {
    let drive = rough(60.0, 0.0);
    let start = axes([0.3, 0.1, -0.5]);
    let holding = holding_effort(&crooked(), &start);
    assert!(holding.iter().any(|effort| effort.abs() > 10.0), "{holding:?}");
    assert!(holding.iter().all(|effort| effort.abs() < 50.0), "{holding:?}");
    let mut machine = started(&crooked(), &[(); 3].map(|()| drive.clone()), down(), &start);
    let state = machine.push([0.0; 3], 1000);
    for (now, start) in state.position.iter().zip(start.iter()) {
        assert!((now - start).abs() < 1e-12, "{state:?}");
    }
}

/// Two slides at right angles: axes do not disturb each other, each accelerates what it carries.
#[test]
fn each_axis_of_a_gantry_moves_what_it_carries() {
    let mut machine = started(&gantry(), &[SLACK; 3], down(), &axes([0.0; 3]));
    let state = machine.push([40.0, -16.0, 3.0 * (G + 1.0)], 1000);
    let expected = [0.5 * 40.0 / 20.0, -0.5 * 16.0 / 8.0, 0.5];
    for (position, expected) in state.position.iter().zip(expected) {
        assert!((position - expected).abs() < 1e-12, "{state:?}");
    }
}

/// A falling, turning chain in which nothing is aligned keeps the sum of its kinetic and potential energy.
#[test]
fn a_crooked_chain_keeps_its_energy() {
    let model = crooked();
    let mut machine = started(&model, &[SLACK; 3], down(), &axes([0.3, 0.1, -0.5]));
    machine.start_moving(&axes([1.0, -0.4, PI]));
    let start = machine.energy(&model);
    let state = machine.push([0.0; 3], 1000);
    assert!((machine.energy(&model) - start).abs() < 1e-8 * start.abs());
    assert!((state.position[0] - 0.3).abs() > 0.1);
}
