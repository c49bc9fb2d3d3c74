//! Tests of springs, backlash, friction, brakes, encoders and motor overload, in closed form.

use std::f64::consts::TAU;

use super::*;

/// A mass on a level slide.
pub(super) fn slide(mass: f64) -> Model {
    let cube = uniform_box(mass, [0.0; 3], [0.1; 3]);
    chain([(JointKind::Prismatic, Vector3::x(), Isometry3::identity(), Some(cube))])
}

pub(super) fn machine(model: &Model, drive: AxisDriveParameters) -> PhysicsMachine {
    started(model, &[drive], down(), &axes([0.0]))
}

pub(super) fn at_rest(position: f64) -> AxisMotion {
    AxisMotion::at_rest(axes([position]))
}

pub(super) fn spring(stiffness: f64, damping: f64, backlash: f64) -> ElasticTransmission {
    ElasticTransmission { stiffness, damping, backlash }
}

/// Two masses on a spring, one of them pushed: the centre of mass goes as Newton says, and the masses swing about it with the
/// frequency of the reduced mass.
#[test]
fn two_masses_on_a_spring_swing() {
    let (motor, load, stiffness, force) = (2.0_f64, 6.0, 1e5_f64, 50.0);
    let drive = AxisDriveParameters {
        armature: motor,
        transmission: Some(spring(stiffness, 0.0, 0.0)),
        ..SLACK
    };
    let mut machine = machine(&slide(load), drive);
    let reduced = motor * load / (motor + load);
    let w = (stiffness / reduced).sqrt();
    for cycle in 1..=200 {
        let state = machine.step_with_efforts(&axes([force])).unwrap();
        let t = f64::from(cycle) * 1e-3;
        let center = force / (motor + load) * t * t / 2.0;
        // The spring pulls the load with m·F/(M+m) on the mean, twice that at the most.
        let twist = force / motor / (w * w) * (1.0 - (w * t).cos());
        let expected = center - motor / (motor + load) * twist;
        assert!((state.position[0] - expected).abs() < 1e-8, "{state:?} at {t}, not {expected}");
        let ahead = machine.motor_position()[0] - state.position[0];
        assert!((ahead - twist).abs() < 1e-8, "{ahead} is not {twist} at {t}");
    }
}

/// What holds a load winds the spring up before it is homed: nothing sags; more load is felt by the stiffness.
#[test]
fn a_spring_is_wound_up_by_what_it_carries() {
    let servo = ServoParameters::tuned(5.0, 40.0, f64::INFINITY);
    let drive = AxisDriveParameters {
        armature: 2.0,
        transmission: Some(spring(2e5, 60.0, 30e-6)),
        ..AxisDriveParameters::servo(servo)
    };
    let mut machine = machine(&lift(3.0), drive);
    for _ in 0..500 {
        let state = machine.step(&at_rest(0.0)).unwrap();
        assert!(state.position[0].abs() < 1e-12, "{state:?}");
        assert!((state.effort[0] - 3.0 * G).abs() < 1e-9, "{state:?}");
    }
}

/// With an encoder on the motor an axis that friction holds stays behind by half the play in either direction, and by what the
/// friction winds the spring up; with one on the axis it does not.
#[test]
fn play_shows_at_reversal() {
    let (stiffness, friction, play) = (4e5, 20.0, 50e-6);
    let reached = |side| {
        let servo = ServoParameters {
            encoder: EncoderParameters { side, resolution: 0.0 },
            integral_time: 0.05,
            ..ServoParameters::tuned(5.0, 30.0, f64::INFINITY)
        };
        let drive = AxisDriveParameters {
            armature: 2.0,
            friction: FrictionParameters::new(friction, 0.0),
            transmission: Some(spring(stiffness, 200.0, play)),
            ..AxisDriveParameters::servo(servo)
        };
        let mut machine = machine(&slide(3.0), drive);
        let mut ends = Vec::new();
        for (from, to) in [(0.0, 0.01), (0.01, 0.005)] {
            for cycle in 1..=3000 {
                let part: f64 = (f64::from(cycle) / 1000.0_f64).min(1.0);
                let smooth = part * part * (3.0 - 2.0 * part);
                machine.step(&at_rest(from + (to - from) * smooth)).unwrap();
            }
            ends.push(machine.axis_state().position[0] - to);
        }
        ends
    };
    let motor = reached(EncoderSide::Motor);
    // At rest friction may hold less than it does while the axis slides: between no wind-up and all of it.
    for (error, sign) in motor.iter().zip([-1.0, 1.0]) {
        let behind = error * sign;
        let most = play / 2.0 + friction / stiffness;
        assert!((play / 2.0 - 1e-6..most + 1e-6).contains(&behind), "{motor:?}");
    }
}

/// Below its breakaway friction nothing moves, above it goes; moving at a constant force it takes the velocity at which Stribeck's
/// curve and viscous friction make up for it.
#[test]
fn stribecks_curve_is_followed() {
    let friction = FrictionParameters {
        breakaway: 16.0,
        stribeck_velocity: 0.02,
        ..FrictionParameters::new(10.0, 100.0)
    };
    let drive = AxisDriveParameters { friction, ..SLACK };
    let mut machine = machine(&slide(1.0), drive);
    assert!(machine.push([15.9], 200).position[0].abs() < 1e-14);
    for force in [16.3, 20.0] {
        let velocity = machine.push([force], 2000).velocity[0];
        // f(v) = force, by bisection where the curve rises again.
        let curve = |v: f64| 10.0 + 6.0 * (-(v / 0.02) * (v / 0.02)).exp() + 100.0 * v;
        let (mut low, mut high) = (0.03, 1.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if curve(middle) < force { low = middle } else { high = middle }
        }
        assert!((velocity - low).abs() < 1e-9, "{velocity} at {force} N, not {low}");
    }
}

/// Without power a lift falls freely until the brake closes, and stops as its friction says.
#[test]
fn a_brake_catches_a_lift() {
    let weight = 3.0 * G;
    let drive = AxisDriveParameters {
        brake: Some(BrakeParameters { effort: 3.0 * weight, closing_time: 0.05 }),
        ..super::tuned(3.0, 50.0, f64::INFINITY)
    };
    let mut machine = machine(&lift(3.0), drive);
    machine.step(&at_rest(0.0)).unwrap();
    assert!(machine.fail(0, Fault::PowerLoss));
    let begun = machine.take_events();
    assert_eq!(begun[0].kind, EventKind::Failed(Fault::PowerLoss));
    let mut closed = None;
    for cycle in 0..500 {
        machine.step(&at_rest(0.0)).unwrap();
        for event in machine.take_events() {
            assert_eq!(event.kind, EventKind::BrakeClosed);
            closed = Some(cycle);
        }
    }
    assert_eq!(closed, Some(49));
    // ½·g·t² down, and half as far again: the brake slows it down twice as fast as it fell.
    let fallen = 0.5 * G * 0.05_f64.powi(2) * 1.5;
    let state = machine.axis_state();
    assert!((state.position[0] + fallen).abs() < 1e-6, "{state:?}, not {fallen}");
    assert!(state.velocity[0].abs() < 1e-12, "{state:?}");
}

/// An encoder measures whole increments: an axis comes to rest within one, and a coarser one makes the drive work more.
#[test]
fn increments_are_what_the_drive_knows() {
    for resolution in [1e-6, 10e-6] {
        let servo = ServoParameters {
            encoder: EncoderParameters { side: EncoderSide::Motor, resolution },
            ..ServoParameters::tuned(3.0, 40.0, f64::INFINITY)
        };
        let drive = AxisDriveParameters {
            friction: FrictionParameters::new(1.0, 20.0),
            ..AxisDriveParameters::servo(servo)
        };
        let state = machine(&slide(3.0), drive).hold([1.2345e-3], 2000);
        let error = state.position[0] - 1.2345e-3;
        assert!(error.abs() <= 1.5 * resolution, "{error} at {resolution}");
        assert!(error.abs() > 1e-9, "no encoder is that good: {error}");
    }
}

/// A motor with twice its continuous effort is too warm after τ·ln(4/3); what it has given adds up.
#[test]
fn overload_and_loads_add_up() {
    let drive = AxisDriveParameters {
        overload: Some(OverloadParameters { continuous_effort: 10.0, time_constant: 2.0 }),
        friction: FrictionParameters::new(0.0, 50.0),
        ..super::tuned(2.0, 50.0, 20.0)
    };
    let mut machine = machine(&slide(2.0), drive);
    let mut warned = Vec::new();
    for cycle in 1..=1500 {
        // So far ahead that the drive gives all it can.
        machine.step(&at_rest(100.0)).unwrap();
        let events = machine.take_events();
        warned.extend(events.iter().map(|event| (cycle, event.kind)));
    }
    let expected = 2.0 * f64::ln(4.0 / 3.0) * 1e3;
    let [(cycle, EventKind::Overload)] = warned[..] else { panic!("{warned:?}") };
    assert!((f64::from(cycle) - expected).abs() <= 2.0, "{cycle} ms, not {expected}");
    let load = machine.motor_load(0);
    assert!((load.peak_effort - 20.0).abs() < 1e-9 && (load.rms_effort - 20.0).abs() < 0.2);
    // 20 N at the velocity at which friction takes all of it.
    let velocity = 20.0 / 50.0;
    assert!((load.peak_power - 20.0 * velocity).abs() < 1e-3, "{load:?}");
    let way = machine.axis_state().position[0];
    assert!((load.driving_energy - 20.0 * way).abs() < 1e-3 * load.driving_energy, "{load:?}");
    assert!((load.peak_warmth.unwrap() - 4.0 * (1.0 - f64::exp(-0.75))).abs() < 0.01, "{load:?}");
    // The same of the last cycle alone.
    let state = machine.motor_state(0);
    assert!((state.effort - 20.0).abs() < 1e-9, "{state:?}");
    assert!((state.power - 20.0 * velocity).abs() < 1e-3, "{state:?}");
    assert_eq!((state.effort_limit, state.utilisation()), (Some(20.0), Some(1.0)), "{state:?}");
    assert_eq!((state.warmth, state.load_angle), (load.peak_warmth, None), "{state:?}");
    assert_eq!(machine.motor_state(1), MotorState::default());
}

/// Switches tell where the axis is.
#[test]
fn switches_are_hit() {
    let drive = AxisDriveParameters {
        switches: SwitchParameters {
            lower: Some(-0.01),
            upper: Some(0.02),
            home: Some([0.0, 0.005]),
        },
        ..super::tuned(2.0, 50.0, f64::INFINITY)
    };
    let mut machine = machine(&slide(2.0), drive);
    assert_eq!(machine.switches(0), SwitchStates { home: true, ..SwitchStates::default() });
    for cycle in 1..=300 {
        machine.step(&at_rest(f64::from(cycle) * 1e-4)).unwrap();
    }
    assert_eq!(machine.switches(0), SwitchStates { upper: true, ..SwitchStates::default() });
    let events = machine.take_events();
    let found: Vec<_> = events.iter().map(|event| (event.axis, event.kind)).collect();
    assert_eq!(found, [(0, EventKind::LimitSwitch(Side::Upper))]);
}

/// A switch that is on from the start, where the axis is and not where the motor is ahead of it, is not hit.
#[test]
fn switches_are_along_the_axis() {
    let drive = AxisDriveParameters {
        armature: 2.0,
        transmission: Some(spring(2e5, 60.0, 30e-6)),
        switches: SwitchParameters { lower: Some(1e-6), ..SwitchParameters::default() },
        ..super::tuned(5.0, 40.0, f64::INFINITY)
    };
    let mut machine = machine(&lift(3.0), drive);
    assert!(machine.switches(0).lower);
    machine.step(&at_rest(0.0)).unwrap();
    assert_eq!(machine.take_events(), []);
}

/// A loose belt swings more slowly: by the root of its stiffness.
#[test]
fn a_loose_belt_is_softer() {
    let (motor, load) = (2.0_f64, 6.0);
    let drive =
        AxisDriveParameters { armature: motor, transmission: Some(spring(1e5, 0.0, 0.0)), ..SLACK };
    let mut machine = machine(&slide(load), drive);
    assert!(machine.fail(0, Fault::LooseBelt { stiffness: 0.25, backlash: 0.0 }));
    let period = TAU / (0.25 * 1e5 * (motor + load) / (motor * load)).sqrt();
    let mut most = (0, 0.0);
    for cycle in (1..).take_while(|cycle| f64::from(*cycle) * 1e-3 <= period) {
        let state = machine.step_with_efforts(&axes([50.0])).unwrap();
        let twist = machine.motor_position()[0] - state.position[0];
        if twist > most.1 {
            most = (cycle, twist);
        }
    }
    assert!((f64::from(most.0) - period * 500.0).abs() <= 1.0, "{most:?}, {period}");
    // Seen once per millisecond.
    assert!((most.1 - 2.0 * 50.0 / motor * 1.5 / (0.25 * 1e5)).abs() < 3.2e-6, "{most:?}");
    // A rigid axis has nothing to loosen, and a servo no steps to lose.
    let mut rigid = self::machine(&slide(1.0), SLACK);
    assert!(!rigid.fail(0, Fault::LooseBelt { stiffness: 0.5, backlash: 0.0 }));
    assert!(!rigid.fail(0, Fault::LostSteps(4.0)));
    assert!(!rigid.fail(1, Fault::Jam));
}

/// Noise is what its seed makes it: the same twice, another with another seed, as strong as asked for, and none where none is.
#[test]
fn noise_is_reproducible() {
    let noise = NoiseParameters { position: 2e-6, effort: 3.0 };
    let run = |seed, noise| {
        let drive = AxisDriveParameters { noise, ..super::tuned(2.0, 30.0, f64::INFINITY) };
        let mut machine = machine(&slide(2.0), drive).with_seed(seed);
        let mut sum = 0.0;
        for _ in 0..2000 {
            let state = machine.step(&at_rest(0.0)).unwrap();
            sum += state.position[0] * state.position[0];
        }
        (machine.axis_state().position[0].to_bits(), (sum / 2000.0_f64).sqrt())
    };
    let (one, spread) = run(1, noise);
    assert_eq!(run(1, noise).0, one);
    assert_ne!(run(2, noise).0, one);
    assert!((1e-7..1e-4).contains(&spread), "{spread}");
    assert!(run(1, NoiseParameters::default()).1 < 1e-15);
    // White forces alone on a free mass: after n cycles of T its velocity has the variance n·(F·T/m)².
    let free = |seed| {
        let drive =
            AxisDriveParameters { noise: NoiseParameters { position: 0.0, effort: 3.0 }, ..SLACK };
        machine(&slide(2.0), drive).with_seed(seed).hold([0.0], 100).velocity[0]
    };
    let variance = (0..400).map(|seed| free(seed).powi(2)).sum::<f64>() / 400.0;
    let expected = 100.0 * (3.0 * 1e-3 / 2.0_f64).powi(2);
    // Of 400 squares of normal numbers the mean is within 5·√(2/400) of what it should be.
    assert!((variance / expected - 1.0).abs() < 0.36, "{variance}, not {expected}");
}
