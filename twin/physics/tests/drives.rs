//! Tests of drives on the machine, and of errors for machines that cannot be simulated.

use super::*;
use crate::drive::MotorAtWork;

/// Drives for a gantry, tuned by rule.
fn tuned(limit: f64) -> [ServoParameters; 3] {
    [20.0, 8.0, 3.0]
        .map(|mass| ServoParameters::tuned(mass, ServoParameters::DEFAULT_BANDWIDTH_HZ, limit))
}

fn machine(drives: &[ServoParameters]) -> PhysicsMachine {
    let drives: Vec<_> = drives.iter().cloned().map(AxisDriveParameters::servo).collect();
    started(&gantry(), &drives, down(), &axes([0.1, 0.2, 0.3]))
}

/// A vertical axis neither sags nor jumps when the drives are enabled, and its drive carries the weight.
#[test]
fn enabled_drives_hold_the_machine() {
    let with_dynamics = tuned(500.0).map(|drive| ServoParameters {
        effort_feed_forward: EffortFeedForward::Dynamics(0.7),
        ..drive
    });
    let without_integral =
        tuned(500.0).map(|drive| ServoParameters { integral_time: f64::INFINITY, ..drive });
    for drives in [tuned(500.0), with_dynamics, without_integral] {
        let mut machine = machine(&drives);
        let rest = AxisMotion::at_rest(axes([0.1, 0.2, 0.3]));
        for _ in 0..500 {
            let state = machine.step(&rest).unwrap();
            assert!((state.position[2] - 0.3).abs() < 1e-12, "{state:?}");
            assert!((state.effort[2] - 3.0 * G).abs() < 1e-9, "{state:?}");
            assert!(state.effort[0].abs() < 1e-9, "{state:?}");
        }
    }
}

/// A step of the position set-point: towards it at once, and there in the end, without a lasting error.
#[test]
fn a_step_is_followed() {
    let mut machine = machine(&tuned(500.0));
    let target = [0.101, 0.199, 0.302];
    let state = machine.hold(target, 5);
    let [x, y, z] = [0, 1, 2].map(|axis| state.velocity[axis]);
    assert!(x > 0.0 && y < 0.0 && z > 0.0, "{state:?}");
    let state = machine.hold(target, 1000);
    for (position, target) in state.position.iter().zip(target) {
        assert!((position - target).abs() < 1e-9, "{state:?}");
    }
}

/// Only what the drive can push: 50 N on 20 kg is 2.5 m/s² however far the set-point is.
#[test]
fn the_effort_limit_is_kept() {
    let mut machine = machine(&tuned(50.0));
    let target = AxisMotion::at_rest(axes([0.6, 0.2, 0.3]));
    for cycle in 1..=100 {
        let state = machine.step(&target).unwrap();
        assert!(state.effort.iter().all(|effort| effort.abs() <= 50.0), "{state:?}");
        if cycle > 1 {
            assert!(state.saturated[0] && !state.saturated[1], "{state:?}");
        }
    }
    let state = *machine.axis_state();
    let t = 0.1;
    assert!((state.position[0] - (0.1 + 0.5 * 2.5 * t * t)).abs() < 1e-4, "{state:?}");
    assert!((state.velocity[0] - 2.5 * t).abs() < 5e-3, "{state:?}");
}

/// Waiting at its limit does not wind the integral up: a lift whose drive cannot carry it sinks, and when the drive
/// can again it comes back without shooting past.
#[test]
fn the_integral_does_not_wind_up() {
    let drive = super::tuned(3.0, 50.0, 32.0);
    let mut machine = started(&lift(3.0), &[drive], down(), &axes([0.0]));
    let rest = AxisMotion::at_rest(axes([0.0]));
    let limit = |machine: &mut PhysicsMachine, limit: f64| {
        let MotorAtWork::Servo(servo) = &mut machine.drives[0].motor else { panic!("a servo") };
        servo.parameters.effort_limit = limit;
    };
    // It weighs 29.4 N.
    limit(&mut machine, 17.0);
    for _ in 0..60 {
        assert!(machine.step(&rest).unwrap().saturated[0]);
    }
    assert!(machine.axis_state().position[0] < -5e-4, "{:?}", machine.axis_state());
    limit(&mut machine, 320.0);
    let mut highest = f64::NEG_INFINITY;
    for _ in 0..1000 {
        highest = highest.max(machine.step(&rest).unwrap().position[0]);
    }
    assert!(machine.axis_state().position[0].abs() < 1e-9);
    assert!(highest < 1e-6, "{highest}");
}

/// With velocity and inertia fed forward a decoupled axis follows a smooth motion within micrometres; without, it
/// follows v/Kv behind.
#[test]
fn the_following_error_is_that_of_the_loop() {
    let lagging = tuned(500.0).map(|drive| ServoParameters {
        velocity_feed_forward: 0.0,
        effort_feed_forward: EffortFeedForward::None,
        integral_time: f64::INFINITY,
        ..drive
    });
    let mut good = machine(&tuned(500.0));
    let mut lag = machine(&lagging);
    // 0.2 m/s, reached with sin² in 0.2 s.
    let speed = 0.2;
    let motion = |t: f64| {
        let [position, velocity, acceleration] = soft_start(speed, 0.2, t);
        motion([[0.1 + position, 0.2, 0.3], [velocity, 0.0, 0.0], [acceleration, 0.0, 0.0]])
    };
    let mut worst = 0.0_f64;
    for cycle in 1..=1000 {
        let target = motion(f64::from(cycle) * 1e-3);
        let state = good.step(&target).unwrap();
        worst = worst.max((state.position[0] - target.position[0]).abs());
        lag.step(&target).unwrap();
    }
    assert!(worst < 1e-6, "{worst} m");
    let behind = lag.setpoint().position[0] - lag.axis_state().position[0];
    assert!((behind - speed / lagging[0].position_gain).abs() < 1e-6, "{behind}");
}

/// A change of a model.
type Change<'a> = &'a dyn Fn(&mut Model);

#[test]
fn what_cannot_be_simulated_is_refused() {
    let build = |model: &Model, drives: &[AxisDriveParameters], initial: &AxisVector, cycle_ns| {
        PhysicsMachine::new(model, drives, down(), initial, cycle_ns).map(drop)
    };
    let too_much = ServoParameters { velocity_feed_forward: 1.5, ..ServoParameters::SLACK };
    let wrong = AxisDriveParameters::servo(too_much);
    let parameter = "velocity_feed_forward";
    let out_of_range = PhysicsError::DriveParameter { axis: 1, parameter, value: 1.5 };
    let too_few = PhysicsError::AxisCount { given: 2, expected: 3 };
    for (drives, initial, cycle_ns, error) in [
        (vec![SLACK; 3], axes([0.0; 3]), 0, PhysicsError::CycleTime(0)),
        (Vec::new(), axes([]), CYCLE_NS, PhysicsError::AxisNumber(0)),
        (vec![SLACK; 2], axes([0.0; 2]), CYCLE_NS, PhysicsError::JointAxis(2)),
        (vec![SLACK; 4], axes([0.0; 4]), CYCLE_NS, PhysicsError::AxisWithoutJoint(3)),
        (vec![SLACK; 3], axes([0.0; 2]), CYCLE_NS, too_few),
        (vec![SLACK, wrong, SLACK], axes([0.0; 3]), CYCLE_NS, out_of_range),
        (vec![SLACK; 3], axes([0.0, f64::NAN, 0.0]), CYCLE_NS, PhysicsError::Input(0)),
    ] {
        assert_eq!(build(&gantry(), &drives, &initial, cycle_ns), Err(error));
    }

    let belt = |model: &mut Model| {
        model.joints[1].drive = JointDrive::Combination(vec![(0, 0.5), (1, 0.5)]);
    };
    let weightless = |model: &mut Model| model.links[3].inertial = None;
    let mass = |link: usize, mass: f64| {
        move |model: &mut Model| model.links[link].inertial.as_mut().unwrap().mass = mass
    };
    let endless = f64::INFINITY;
    let changes: [(Change<'_>, _); 10] = [
        (&|_| (), Ok(())),
        (
            &|model| model.joints[2].drive = JointDrive::Axis(1),
            Err(PhysicsError::AxisMovesTwoJoints { joint: 2, axis: 1 }),
        ),
        (&belt, Ok(())),
        // Two joints that move as one, and a motor that moves none of its own.
        (
            &|model| {
                belt(model);
                model.joints[0].drive = JointDrive::Combination(vec![(0, 1.0), (1, 1.0)]);
            },
            Err(PhysicsError::CoupledJoint(0)),
        ),
        (
            &|model| model.joints[2].drive = JointDrive::Passive { rest: 0.0 },
            Err(PhysicsError::CoupledJoint(2)),
        ),
        (
            &|model| model.loops.push(Loop { links: [1, 3], points: [Point3::origin(); 2] }),
            Err(PhysicsError::UnknownMechanism(1)),
        ),
        (
            &|model| model.joints[1].parent = 2,
            Err(PhysicsError::NotATree { joint: 1, parent: 2, child: 2 }),
        ),
        (&weightless, Err(PhysicsError::NoInertia { axis: 2, inertia: 0.0 })),
        (&mass(1, -1.0), Err(PhysicsError::MassProperties { link: 1, mass: -1.0 })),
        (&mass(2, endless), Err(PhysicsError::MassProperties { link: 2, mass: endless })),
    ];
    for (change, expected) in changes {
        let mut model = gantry();
        change(&mut model);
        assert_eq!(build(&model, &[SLACK; 3], &axes([0.0; 3]), CYCLE_NS), expected);
    }
    let mut model = gantry();
    weightless(&mut model);
    let rotor = AxisDriveParameters { armature: 0.1, ..SLACK };
    assert_eq!(build(&model, &[SLACK, SLACK, rotor], &axes([0.0; 3]), CYCLE_NS), Ok(()));
}

#[test]
fn a_loop_that_is_unstable_is_reported() {
    let wild = tuned(f64::INFINITY).map(|drive| ServoParameters {
        velocity_gain: 1e9,
        position_gain: 1e4,
        ..drive
    });
    let mut machine = machine(&wild);
    let target = AxisMotion::at_rest(axes([0.2, 0.2, 0.3]));
    let failed = (0..2000).find_map(|_| machine.step(&target).err());
    assert!(matches!(failed, Some(PhysicsError::Diverged(_))), "{failed:?}");
}
