//! Tests of copies of machines, and of machines under random inputs and faults.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use twin_urdf::SolidShape;

use super::contact::{around, cuboid, solid, solid_gantry};
use super::*;

/// Motors of every kind, with noise, on a gantry.
fn motors() -> [AxisDriveParameters; 3] {
    let spring = ElasticTransmission::damped(2e6, 0.05, 1e-5, 8.0, 20.0);
    let noise = NoiseParameters { position: 1e-7, effort: 0.5 };
    [
        AxisDriveParameters {
            armature: 8.0,
            transmission: Some(spring),
            friction: FrictionParameters {
                breakaway: 12.0,
                stribeck_velocity: 2e-3,
                ..FrictionParameters::new(8.0, 20.0)
            },
            motor_friction: FrictionParameters::new(2.0, 1.0),
            overload: Some(OverloadParameters { continuous_effort: 100.0, time_constant: 1.0 }),
            noise,
            ..AxisDriveParameters::servo(ServoParameters {
                current_bandwidth: 5000.0,
                delay: 1,
                encoder: EncoderParameters { side: EncoderSide::Axis, resolution: 1e-6 },
                ..ServoParameters::tuned(28.0, 30.0, 800.0)
            })
        },
        AxisDriveParameters {
            friction: FrictionParameters::new(5.0, 10.0),
            noise,
            ..super::tuned(8.0, 40.0, 300.0)
        },
        AxisDriveParameters {
            armature: 40.0,
            friction: FrictionParameters::new(4.0, 20.0),
            brake: Some(BrakeParameters { effort: 300.0, closing_time: 0.03 }),
            motor: Motor::Stepper(StepperParameters {
                full_step: 25e-6,
                microsteps: 16,
                pull_out: EffortCurve::new(vec![[0.0, 500.0], [0.1, 200.0]]).unwrap(),
                detent: 20.0,
                damping_ratio: 0.1,
            }),
            ..SLACK
        },
    ]
}

/// Among things that it runs into.
fn machine(surroundings: &Surroundings) -> PhysicsMachine {
    let model = solid_gantry();
    let machine = PhysicsMachine::new(&model, &motors(), down(), &axes([0.0; 3]), CYCLE_NS);
    let mut machine = machine.unwrap().with_seed(3);
    machine.insert_surroundings(surroundings).unwrap();
    machine
}

/// A plate that the ball runs into after 90 mm.
fn plate() -> Surroundings {
    around([("plate", cuboid([0.12, -0.5, 0.0], [0.125, 0.5, 0.5]))])
}

/// Back and forth.
fn course(cycle: u32) -> AxisMotion {
    let t = f64::from(cycle) * 1e-3;
    let (sin, cos) = (3.0 * t).sin_cos();
    motion([sin, 3.0 * cos, -9.0 * sin].map(|value| [0.05, 0.1, 0.01].map(|half| half * value)))
}

pub(super) fn bits(machine: &mut PhysicsMachine) -> (Vec<u64>, String) {
    let state = machine.axis_state();
    let values = state.position.iter().chain(state.velocity.iter()).chain(state.effort.iter());
    let values: Vec<_> = values.map(|value| value.to_bits()).collect();
    let blows = machine.take_collisions();
    let contacts = format!("{:?}{blows:?}", machine.contacts());
    (values, format!("{:?}{:?}{contacts}", machine.link_poses(), machine.take_events()))
}

#[test]
fn a_copy_goes_on_with_the_same_bits() {
    let pressed = || {
        let mut machine = machine(&plate());
        for cycle in 1..=400 {
            machine.step(&course(cycle)).unwrap();
            if cycle == 300 {
                assert!(machine.fail(0, Fault::LooseBelt { stiffness: 0.3, backlash: 1e-5 }));
            }
        }
        assert!(!machine.take_collisions().is_empty());
        assert!(!machine.contacts().is_empty(), "pressed against the plate");
        machine
    };
    let mut one = pressed();
    let copy = one.clone();
    assert_eq!(copy.axis_state().time_ns, 400 * CYCLE_NS);
    let go_on = |machine: &mut PhysicsMachine| {
        for cycle in 401..=800 {
            machine.step(&course(cycle)).unwrap();
        }
        bits(machine)
    };
    let first = go_on(&mut one);
    // Back again, in the machine itself and in another one.
    one.clone_from(&copy);
    assert_eq!(one.axis_state().time_ns, 400 * CYCLE_NS);
    let mut other = machine(&plate());
    other.clone_from(&copy);
    // All over again.
    for machine in [&mut one, &mut other, &mut pressed()] {
        assert_eq!(go_on(machine), first);
    }
}

/// Cycles in which nothing can touch may be left out of rapier's steps: the results have the same bits, through blows and
/// after them.
#[test]
fn steps_that_are_left_out_change_no_bit() {
    let [all, some] = [true, false].map(|every| {
        let mut machine = machine(&plate());
        if every {
            machine = machine.with_every_step();
        }
        let mut blows = 0;
        for cycle in 1..=1500 {
            machine.step(&course(cycle)).unwrap();
            blows += usize::from(!machine.contacts().is_empty());
        }
        (bits(&mut machine), blows)
    });
    assert_eq!(all, some);
    assert!((20..1400).contains(&all.1), "{} cycles with contact", all.1);
}

/// Random set-points, some of them jumps, and every fault at any time: everything stays finite, and no faster than what the
/// motors and a fall can make of it.
#[test]
fn nothing_explodes() {
    let steps = if std::env::var_os("TWIN_PHYSICS_FULL").is_some() { 1_000_000 } else { 30_000 };
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let uniform =
        |random: &mut ChaCha8Rng, low: f64, high: f64| -> f64 { random.random_range(low..high) };
    let surroundings = around([
        ("plate", cuboid([0.3, -0.6, -0.5], [0.305, 0.6, 1.0])),
        ("post", cuboid([-0.3, 0.1, -0.5], [-0.25, 0.15, 0.5])),
        ("ball", solid(SolidShape::Sphere { radius: 0.1 }, [0.0, -0.3, 0.2])),
        ("floor", cuboid([-5.0, -5.0, -1.0], [5.0, 5.0, -0.1])),
    ]);
    let mut machine = machine(&surroundings);
    let fresh = machine.clone();
    let (mut target, mut most, mut faults, mut blows) = ([0.0; 3], 0.0_f64, 0, 0);
    for cycle in 0..steps {
        if cycle % 5_000 == 4_999 {
            machine.clone_from(&fresh);
            target = [0.0; 3];
        }
        for target in &mut target {
            *target += if uniform(&mut random, 0.0, 1.0) < 0.001 {
                uniform(&mut random, -0.1, 0.1)
            } else {
                uniform(&mut random, -1e-4, 1e-4)
            };
            *target = target.clamp(-0.5, 0.5);
        }
        if uniform(&mut random, 0.0, 1.0) < 0.002 {
            let axis = random.random_range(0..3);
            let fault = match random.random_range(0..4) {
                0 => Fault::Jam,
                1 => Fault::LostSteps(uniform(&mut random, 1.0, 50.0)),
                2 => Fault::LooseBelt {
                    stiffness: uniform(&mut random, 0.1, 1.0),
                    backlash: uniform(&mut random, 0.0, 1e-4),
                },
                _ => Fault::PowerLoss,
            };
            faults += u32::from(machine.fail(axis, fault));
            machine.free(random.random_range(0..3));
        }
        let state = machine.step(&AxisMotion::at_rest(axes(target))).unwrap();
        assert!(state.position.is_finite() && state.velocity.is_finite(), "{state:?}");
        most = state.velocity.iter().fold(most, |most, velocity| most.max(velocity.abs()));
        machine.take_events();
        blows += machine.take_collisions().len();
        let [x, y, z] = [0.05 + state.position[0], state.position[1], 0.2 + state.position[2]];
        // Not through the plate, nor far into the ball.
        assert!(x + 0.03 < 0.3025 && z > -0.0725, "{state:?}");
        assert!((x * x + (y + 0.3).powi(2) + (z - 0.2).powi(2)).sqrt() > 0.127, "{state:?}");
    }
    println!("{steps} steps, {faults} faults, {blows} blows, at most {most} m/s");
    assert!(faults > 20 && blows > 20, "{faults} faults, {blows} blows");
    // 800 N on 28 kg for the way of a metre, or a fall of 5 s.
    assert!(most < 50.0, "{most} m/s");
}
