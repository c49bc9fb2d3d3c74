//! Tests of motors and of the transmissions to their axes, in closed form.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Complex;

use super::elastic::{at_rest, machine, slide};
use super::*;

/// The function of time whose Laplace transform is `of`, at `t` > 0: Euler's sum of Abate and Whitt, *A unified framework for
/// numerically inverting Laplace transforms*, 2006.
fn in_time(of: impl Fn(Complex<f64>) -> Complex<f64>, t: f64) -> f64 {
    let terms = 16_i32;
    let binomial =
        |n: i32, k: i32| (1..=k).fold(1.0, |b, i| b * f64::from(n - k + i) / f64::from(i));
    let mut weights = vec![0.5];
    weights.extend((1..=terms).map(|_| 1.0));
    let mut tail = vec![2.0_f64.powi(-terms)];
    for k in 1..terms {
        let last = tail[tail.len() - 1];
        tail.push(last + 2.0_f64.powi(-terms) * binomial(terms, k));
    }
    weights.extend(tail.into_iter().rev());
    let real = f64::from(terms) * 10.0_f64.ln() / 3.0;
    let values = (0_i32..).zip(&weights).map(|(k, weight)| {
        let s = Complex::new(real, PI * f64::from(k)) / t;
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        sign * weight * of(s).re
    });
    let sum: f64 = values.sum();
    10.0_f64.powf(f64::from(terms) / 3.0) / t * sum
}

/// The inversion is what it says: a damped swing.
#[test]
fn transforms_are_inverted() {
    for t in [0.01, 0.1, 0.5, 1.3] {
        let value = in_time(|s| (s + 2.0).inv() * 3.0, t);
        assert!((value - 3.0 * f64::exp(-2.0 * t)).abs() < 1e-6, "{value} at {t}");
    }
}

/// A step of the position set-point against the transfer function of the whole cascade: position loop, velocity loop with
/// integral action, dead time of sampling (half a period) and calculation, current loop, mass and viscous friction.
#[test]
fn a_servos_step_response_is_that_of_its_transfer_function() {
    let (mass, viscous) = (5.0, 40.0);
    for (passes, delay, current_hz) in
        [(4, 0, f64::INFINITY), (4, 1, 600.0), (8, 2, 1000.0), (16, 1, 300.0), (2, 0, 800.0)]
    {
        let servo = ServoParameters {
            velocity_feed_forward: 0.0,
            effort_feed_forward: EffortFeedForward::None,
            current_bandwidth: TAU * current_hz,
            position_passes: passes,
            velocity_passes: passes,
            delay,
            ..ServoParameters::tuned(mass, 60.0, f64::INFINITY)
        };
        let period = 1e-3 / f64::from(passes);
        let lag = (f64::from(delay) + 0.5) * period;
        let (kv, gain, reset) = (servo.position_gain, servo.velocity_gain, servo.integral_time);
        let response = |s: Complex<f64>| {
            let controller = (s * reset).inv() * gain + gain;
            let current = if current_hz.is_finite() {
                (s / (TAU * current_hz) + 1.0).inv()
            } else {
                Complex::new(1.0, 0.0)
            };
            let plant = (s * mass + viscous).inv() * s.inv();
            let open = controller * (-s * lag).exp() * current * plant;
            open * kv / (open * (s + kv) + 1.0)
        };
        // The set-point takes a millisecond to get there: as 3φ² − 2φ³.
        let step = |s: Complex<f64>| {
            let t = s * 1e-3;
            let ramp = ((t - 2.0) + (t + 2.0) * (-t).exp()) * 6.0 / (t * t * t);
            ramp * s.inv()
        };
        let drive = AxisDriveParameters {
            friction: FrictionParameters::new(0.0, viscous),
            ..AxisDriveParameters::servo(servo)
        };
        let mut machine = machine(&slide(mass), drive);
        let (mut worst, mut most) = (0.0_f64, 0.0_f64);
        for cycle in 1..=150 {
            let position = machine.step(&at_rest(1e-3)).unwrap().position[0];
            let expected = 1e-3 * in_time(|s| response(s) * step(s), f64::from(cycle) * 1e-3);
            worst = worst.max((position - expected).abs());
            most = most.max(position);
        }
        println!("{passes} passes, delay {delay}, {current_hz} Hz: {:.3} %", worst * 1e5);
        assert!(worst <= 1e-5, "{worst} m with {passes} passes, delay {delay}, {current_hz} Hz");
        assert!(most > 0.999e-3, "{most}");
    }
}

/// 200 of them are 5 mm.
pub(super) const FULL_STEP: f64 = 25e-6;

/// A step motor on a slide: 200 full steps of 1/40 mm in 5 mm.
pub(super) fn stepper(pull_out: &[[f64; 2]]) -> AxisDriveParameters {
    AxisDriveParameters {
        motor: Motor::Stepper(StepperParameters {
            full_step: FULL_STEP,
            microsteps: 16,
            pull_out: EffortCurve::new(pull_out.to_vec()).unwrap(),
            detent: 0.0,
            damping_ratio: 0.2,
        }),
        ..AxisDriveParameters::SLACK
    }
}

/// Moves at `speed` after a soft start of 0.2 s; returns all steps lost.
fn lost_at(machine: &mut PhysicsMachine, speed: f64, cycles: u32) -> i64 {
    let mut lost = 0;
    for cycle in 1..=cycles {
        let [position, velocity, _] = soft_start(speed, 0.2, f64::from(cycle) * 1e-3);
        machine.step(&motion([[position], [velocity], [0.0]])).unwrap();
        lost += lost_in(machine);
    }
    lost
}

pub(super) fn lost_in(machine: &mut PhysicsMachine) -> i64 {
    let events = machine.take_events();
    let lost = events.iter().map(|event| match event.kind {
        EventKind::LostSteps(steps) => steps,
        _ => 0,
    });
    lost.sum()
}

/// Resting under a load, the rotor is behind the field by the angle whose sine is load over holding torque, and neither sags
/// nor jumps when enabled.
#[test]
fn a_step_motor_holds_by_its_load_angle() {
    let weight = 3.0 * G;
    for holding in [35.0, 60.0, 300.0] {
        let mut machine = machine(&lift(3.0), stepper(&[[0.0, holding]]));
        let state = machine.hold([0.0], 300);
        assert!(state.position[0].abs() < 1e-12, "{state:?}");
        let angle = (weight / holding).asin() / FRAC_PI_2;
        assert!((machine.load_angle(0).unwrap() - angle).abs() < 1e-9);
        assert!((state.effort[0] - weight).abs() < 1e-6, "{state:?}");
        let motor = machine.motor_state(0);
        assert_eq!((motor.effort, motor.power), (state.effort[0], state.power[0]));
        assert_eq!((motor.effort_limit, motor.warmth), (Some(holding), None));
        assert_eq!(motor.load_angle, machine.load_angle(0));
        assert!((motor.utilisation().unwrap() - weight / holding).abs() < 1e-6, "{motor:?}");
    }
}

/// What a motor can give is what is left at the speed it has; its power is the energy it gives, and less than 0 while it brakes.
#[test]
fn a_motor_has_less_to_give_at_speed() {
    let servo = ServoParameters {
        effort_curve: EffortCurve::new(vec![[0.0, 40.0], [1.0, 10.0]]).unwrap(),
        ..ServoParameters::tuned(2.0, 40.0, 30.0)
    };
    let mut machine = machine(&slide(2.0), AxisDriveParameters::servo(servo));
    let (mut energy, mut braked) = (0.0, false);
    for cycle in 1..=1000 {
        // 50 mm and back.
        let phase = TAU * f64::from(cycle) * 1e-3;
        let (sin, cos) = phase.sin_cos();
        let values = [1.0 - cos, TAU * sin, TAU * TAU * cos].map(|value| [0.025 * value]);
        machine.step(&motion(values)).unwrap();
        let state = machine.motor_state(0);
        energy += state.power * 1e-3;
        braked |= state.power < 0.0;
        let left = (40.0 - 30.0 * machine.axis_state().velocity[0].abs()).min(30.0);
        assert!((state.effort_limit.unwrap() - left).abs() < 1e-9, "{state:?}, not {left}");
        assert_eq!(state.utilisation(), Some(state.effort.abs() / left));
    }
    let load = machine.motor_load(0);
    assert!(braked && load.driving_energy > 1e-3, "{load:?}");
    let wanted = load.driving_energy - load.braking_energy;
    assert!((energy - wanted).abs() < 1e-12, "{energy} J, not {wanted} J");
}

/// Nothing is said of how much of nothing is given, nor of how much of what has no limit.
#[test]
fn without_a_limit_there_is_no_utilisation() {
    let of = |effort_limit| MotorState { effort: 3.0, effort_limit, ..MotorState::default() };
    assert_eq!(of(Some(4.0)).utilisation(), Some(0.75));
    assert_eq!(of(Some(0.0)).utilisation(), None);
    assert_eq!(of(None).utilisation(), None);
    let unlimited = super::tuned(2.0, 50.0, f64::INFINITY);
    assert_eq!(machine(&slide(2.0), unlimited).motor_state(0).effort_limit, None);
}

/// Microsteps: the rotor goes where the nearest microstep is.
#[test]
fn a_step_motor_goes_in_microsteps() {
    let mut machine = machine(&slide(3.0), stepper(&[[0.0, 200.0]]));
    let microstep = 25e-6 / 16.0;
    for (wanted, steps) in [(0.4, 0.0), (0.6, 1.0), (7.3, 7.0), (-3.6, -4.0)] {
        let position = machine.hold([wanted * microstep], 1500).position[0];
        assert!((position - steps * microstep).abs() < 1e-9, "{position} at {wanted}");
    }
}

/// At constant speed against friction: in step up to the pull-out torque at that speed, and not beyond.
#[test]
fn a_step_motor_falls_out_of_step_at_its_pull_out_torque() {
    let curve = [[0.0, 200.0], [0.05, 180.0], [0.2, 60.0]];
    for (speed, pull_out) in [(0.02, 192.0), (0.05, 180.0), (0.125, 120.0), (0.2, 60.0)] {
        for (part, falls) in [(0.97, false), (1.03, true)] {
            let drive = AxisDriveParameters {
                friction: FrictionParameters::new(part * pull_out, 0.0),
                ..stepper(&curve)
            };
            let mut machine = machine(&slide(1.0), drive);
            let lost = lost_at(&mut machine, speed, 600);
            assert_eq!(lost > 0, falls, "{lost} steps lost at {speed} m/s, {part}");
        }
    }
}

/// Accelerating a mass: in step as long as m·a stays below the pull-out torque, less what the start shakes.
#[test]
fn a_step_motor_accelerates_what_it_can_pull() {
    let accelerated = |acceleration: f64| {
        let mut machine = machine(&slide(10.0), stepper(&[[0.0, 100.0]]));
        let mut lost = 0;
        // Jerk over 0.1 s, then constant.
        for cycle in 1..=300 {
            let t = f64::from(cycle) * 1e-3;
            let jerk = acceleration / 0.1;
            let (a, v, x) = if t < 0.1 {
                (jerk * t, jerk * t * t / 2.0, jerk * t.powi(3) / 6.0)
            } else {
                let s = t - 0.1;
                let (v, x) = (jerk * 0.005, jerk * 1e-3 / 6.0);
                (acceleration, v + acceleration * s, x + v * s + acceleration * s * s / 2.0)
            };
            machine.step(&motion([[x], [v], [a]])).unwrap();
            lost += lost_in(&mut machine);
        }
        lost
    };
    assert_eq!(accelerated(9.7), 0);
    assert!(accelerated(10.3) > 0);
}

/// Against a jammed axis, all steps are lost that the field makes, in whole turns of the field.
#[test]
fn a_jammed_axis_loses_every_step() {
    let mut machine = machine(&slide(1.0), stepper(&[[0.0, 200.0]]));
    assert!(machine.fail(0, Fault::Jam));
    let mut lost = 0;
    for cycle in 1..=500 {
        machine.step(&at_rest(f64::from(cycle) * 20e-6)).unwrap();
        lost += lost_in(&mut machine);
    }
    // 10 mm are 400 full steps.
    assert_eq!(lost, 400);
    assert!(machine.axis_state().position[0].abs() < 1e-12, "{:?}", machine.axis_state());
    // Free again, the rotor is where a field is that has lost 400 full steps.
    machine.free(0);
    let state = machine.hold([0.01], 1000);
    assert!(state.position[0].abs() < 1e-9, "{state:?}");
    assert_eq!(lost_in(&mut machine), 0);
}

/// Pulses that never come: the axis stays behind by as many full steps.
#[test]
fn lost_pulses_shift_the_axis() {
    let mut machine = machine(&slide(1.0), stepper(&[[0.0, 200.0]]));
    assert!(machine.fail(0, Fault::LostSteps(12.0)));
    for cycle in 1..=2000 {
        machine.step(&at_rest(f64::from(cycle.min(1000)) * 1e-5)).unwrap();
    }
    let expected = 0.01 - 12.0 * 25e-6;
    assert!((machine.axis_state().position[0] - expected).abs() < 1e-9);
    assert_eq!(lost_in(&mut machine), 12);
}
