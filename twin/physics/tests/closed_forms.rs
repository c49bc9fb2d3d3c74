//! Tests of motions that have a closed form.

use std::f64::consts::{PI, TAU};

use super::*;

fn run(machine: &mut PhysicsMachine, effort: &AxisVector, cycles: u32) -> AxisState {
    for _ in 0..cycles {
        machine.step_with_efforts(effort).unwrap();
    }
    *machine.axis_state()
}

#[test]
fn a_slide_without_effort_falls() {
    let mut machine = started(&lift(3.0), &[SLACK], down(), &axes([0.5]));
    let state = run(&mut machine, &axes([0.0]), 1000);
    assert!((state.position[0] - (0.5 - 0.5 * G)).abs() < 1e-12, "{state:?}");
    assert!((state.velocity[0] + G).abs() < 1e-12, "{state:?}");
    assert_eq!(state.time_ns, 1_000_000_000);
}

/// A rotor that turns with the slide adds to what is moved, not to what falls.
#[test]
fn a_rotor_makes_it_fall_slower() {
    let drive = AxisDriveParameters { armature: 2.0, ..SLACK };
    let mut machine = started(&lift(3.0), &[drive], down(), &axes([0.0]));
    let state = run(&mut machine, &axes([0.0]), 500);
    assert!((state.velocity[0] + 0.5 * G * 3.0 / 5.0).abs() < 1e-12, "{state:?}");
}

#[test]
fn the_effort_that_holds_a_slide_is_its_weight() {
    let holding = holding_effort(&lift(3.0), &axes([0.2]));
    assert!((holding[0] - 3.0 * G).abs() < 1e-12);
    let mut machine = started(&lift(3.0), &[SLACK], down(), &axes([0.2]));
    let state = run(&mut machine, &holding, 1000);
    assert!((state.position[0] - 0.2).abs() < 1e-14, "{state:?}");
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
    let model = chain([(
        JointKind::Prismatic,
        Vector3::x(),
        Isometry3::identity(),
        Some(uniform_box(2.0, [0.0; 3], [0.1; 3])),
    )]);
    let mut machine = started(&model, &[drive], down(), &axes([0.1]));
    let state = run(&mut machine, &axes([3.9]), 1000);
    assert!((state.position[0] - 0.1).abs() < 1e-14, "it creeps: {state:?}");
    // 10 N against 4 N for 0.5 s: 3 m/s², 0.375 m.
    let state = run(&mut machine, &axes([10.0]), 500);
    assert!((state.position[0] - 0.475).abs() < 1e-12, "{state:?}");
    assert!((state.velocity[0] - 1.5).abs() < 1e-12, "{state:?}");
    // 2 m/s² stop it after 0.75 s and 0.5625 m, and there it stays.
    let state = run(&mut machine, &axes([0.0]), 1000);
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
    let mut machine = started(&crooked(), &[drive.clone(), drive.clone(), drive], down(), &start);
    let state = run(&mut machine, &axes([0.0; 3]), 1000);
    for (now, start) in state.position.iter().zip(start.iter()) {
        assert!((now - start).abs() < 1e-12, "{state:?}");
    }
}

/// Viscous friction: velocity approaches F/c as 1 − exp(−c·t/m).
#[test]
fn viscous_friction_ends_the_acceleration() {
    let drive = rough(0.0, 30.0);
    let mut machine = started(&lift(2.0), &[drive], Vector3::zeros(), &axes([0.0]));
    let state = run(&mut machine, &axes([12.0]), 100);
    let expected = 12.0 / 30.0 * (1.0 - f64::exp(-30.0 * 0.1 / 2.0));
    assert!((state.velocity[0] - expected).abs() < 1e-11, "{state:?} is not {expected}");
}

/// Two slides at right angles: axes do not disturb each other, each accelerates what it carries.
#[test]
fn each_axis_of_a_gantry_moves_what_it_carries() {
    let mut machine = started(&gantry(), &[SLACK; 3], down(), &axes([0.0; 3]));
    let state = run(&mut machine, &axes([40.0, -16.0, 3.0 * (G + 1.0)]), 1000);
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
    machine.start_moving(joints([1.0, -0.4, PI]));
    let start = machine.energy(&model);
    let state = run(&mut machine, &axes([0.0; 3]), 1000);
    assert!((machine.energy(&model) - start).abs() < 1e-8 * start.abs());
    assert!((state.position[0] - 0.3).abs() > 0.1);
}
