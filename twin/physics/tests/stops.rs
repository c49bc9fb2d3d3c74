//! Tests of event detection within a step: breakaway, rest, and teeth with backlash.
//!
//! The references are closed forms, and an integration that knows the events only as conditions. None of the events is
//! at the end of a step.

use super::elastic::{slide, spring};
use super::*;

/// Masses of a motor and of what it drives, kg.
const MASSES: [f64; 2] = [2.0, 3.0];

fn machine(drive: AxisDriveParameters) -> PhysicsMachine {
    let [motor, load] = MASSES;
    let drive = AxisDriveParameters { armature: motor, ..drive };
    started(&slide(load), &[drive], down(), &axes([0.0]))
}

/// A motor winds its spring up against an axis that sticks: force·(1 − cos ωt), until that is what friction holds. From there on two
/// masses swing about their centre of mass, and friction pushes the one.
#[test]
fn an_axis_breaks_away_when_friction_is_used_up() {
    let ([motor, load], stiffness) = (MASSES, 1.5e5);
    let (force, friction) = (20.0, 13.0);
    let drive = AxisDriveParameters {
        friction: FrictionParameters::new(friction, 0.0),
        transmission: Some(spring(stiffness, 0.0, 0.0)),
        ..SLACK
    };
    let mut machine = machine(drive);
    let alone = f64::sqrt(stiffness / motor);
    let begin = (1.0 - friction / force).acos() / alone;
    let (twist, speed) = (friction / stiffness, force / (motor * alone) * (alone * begin).sin());

    let (whole, reduced) = (motor + load, motor * load / (motor + load));
    let w = f64::sqrt(stiffness / reduced);
    let rest = (force / motor + friction / load) / (w * w);
    let expected = |t: f64| {
        if t < begin {
            return [0.0, 0.0];
        }
        let (sin, cos) = (w * (t - begin)).sin_cos();
        let twisted = rest + (twist - rest) * cos + speed / w * sin;
        let twisting = (rest - twist) * w * sin + speed * cos;
        let since = t - begin;
        let center =
            (motor * (twist + speed * since) + (force - friction) * 0.5 * since * since) / whole;
        let faster = (motor * speed + (force - friction) * since) / whole;
        [center - motor / whole * twisted, faster - motor / whole * twisting]
    };
    let mut moved = 0;
    for cycle in 1..=15 {
        let state = machine.step_with_efforts(&axes([force])).unwrap();
        let [position, velocity] = expected(f64::from(cycle) * 1e-3);
        assert!(velocity >= 0.0, "it stops within {cycle} ms, for which this form is not made");
        let error = state.position[0] - position;
        assert!(error.abs() < 1e-10, "{error} m after {cycle} ms");
        assert!((state.velocity[0] - velocity).abs() < 1e-7, "{state:?}, not {velocity}");
        moved += i32::from(velocity > 0.0);
    }
    assert!((5..15).contains(&moved), "{moved}");
}

/// Where something breaks away, stops or meets is found at any step length: only their fourth power remains.
#[test]
fn shorter_steps_are_better_by_their_fourth_power() {
    let run = |longest: f64| {
        let servo = ServoParameters {
            current_bandwidth: 5e3,
            delay: 1,
            ..ServoParameters::tuned(5.0, 30.0, f64::INFINITY)
        };
        let drive = AxisDriveParameters {
            friction: FrictionParameters {
                breakaway: 14.0,
                stribeck_velocity: 0.02,
                ..FrictionParameters::new(10.0, 5.0)
            },
            motor_friction: FrictionParameters::new(4.0, 2.0),
            transmission: Some(spring(3e5, 60.0, 20e-6)),
            ..AxisDriveParameters::servo(servo)
        };
        let mut machine = machine(drive).with_steps_of(longest);
        let w = 40.0;
        let positions = (1..=500).map(|cycle| {
            let (sin, cos) = (w * f64::from(cycle) * 1e-3).sin_cos();
            let set = [1.0 - cos, w * sin, w * w * cos].map(|value| [1e-3 * value]);
            machine.step(&motion(set)).unwrap().position[0]
        });
        positions.collect::<Vec<_>>()
    };
    let exact = run(2e-6);
    let errors = [125e-6, 62.5e-6, 31.25e-6].map(|longest| {
        let pairs = run(longest).into_iter().zip(&exact);
        pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
    });
    assert!(errors[0] < 5e-9 && errors[0] > 1e-13, "{errors:?}");
    // 16 each, up to terms of higher order.
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 10.0, "{errors:?}");
    }
}

/// Teeth under damping that pull apart let go before the spring is slack, and meet again: against an integration in steps of 0.2 µs of
/// the law as it is written.
#[test]
fn teeth_part_and_meet_where_they_do() {
    let [motor, load] = MASSES;
    let (stiffness, damping, play) = (1e6, 900.0, 20e-6);
    // Pushed to and fro; each change at a whole millisecond.
    let force = |cycle: i32| if cycle / 40 % 2 == 0 { 5.0 } else { -7.0 };
    let passed = |twist: f64, rate: f64| {
        let wound = (twist.abs() - 0.5 * play).max(0.0);
        let there = (wound / (0.1 * play)).min(1.0);
        (stiffness * wound + damping * there * rate * twist.signum()).max(0.0) * twist.signum()
    };
    let slope = |[x, v, y, u]: [f64; 4], force: f64| {
        let passed = passed(x - y, v - u);
        [v, (force - passed) / motor, u, passed / load]
    };
    let steps = 5_000;
    let h = 1e-3 / f64::from(steps);
    let step = |state: [f64; 4], force: f64| {
        let add = |slope: [f64; 4], h: f64| {
            let mut sum = state;
            sum.iter_mut().zip(slope).for_each(|(sum, slope)| *sum += h * slope);
            sum
        };
        let one = slope(state, force);
        let two = slope(add(one, 0.5 * h), force);
        let three = slope(add(two, 0.5 * h), force);
        let four = slope(add(three, h), force);
        let mean = |i: usize| (one[i] + 2.0 * (two[i] + three[i]) + four[i]) / 6.0;
        add([mean(0), mean(1), mean(2), mean(3)], h)
    };

    let drive =
        AxisDriveParameters { transmission: Some(spring(stiffness, damping, play)), ..SLACK };
    let mut machine = machine(drive);
    let (mut state, mut let_go, mut worst) = ([0.0; 4], 0, 0.0_f64);
    for cycle in 0..200 {
        let [force, mut pushing] = [force(cycle), 0.0];
        for _ in 0..steps {
            state = step(state, force);
            let twist = state[0] - state[2];
            let now = passed(twist, state[1] - state[3]);
            if pushing != 0.0 && now == 0.0 && twist.abs() > 0.5 * play {
                let_go += 1;
            }
            pushing = now;
        }
        let found = machine.step_with_efforts(&axes([force])).unwrap();
        worst = worst.max((found.position[0] - state[2]).abs());
    }
    assert!(let_go >= 3, "{let_go}");
    assert!(worst < 1e-10, "{worst} m");
}

/// An axis that is held takes no energy from those that turn it about, however they pull at it, and does not move by a bit.
#[test]
fn a_held_axis_takes_no_energy() {
    let model = crooked();
    for jammed in 0..3 {
        let start = axes([0.3, 0.1, -0.5]);
        let mut machine = started(&model, &[SLACK; 3], down(), &start);
        let mut moving = [1.0, -0.4, 3.0];
        moving[jammed] = 0.0;
        machine.start_moving(&axes(moving));
        assert!(machine.fail(jammed, Fault::Jam));
        let before = machine.energy(&model);
        let state = machine.push([0.0; 3], 500);
        let after = machine.energy(&model);
        assert!((after - before).abs() < 1e-8 * before.abs(), "{jammed}: {before} J, {after} J");
        for axis in 0..3 {
            let still = state.position[axis].to_bits() == start[axis].to_bits();
            assert_eq!(still, axis == jammed, "{jammed}: {state:?}");
        }
    }
}
