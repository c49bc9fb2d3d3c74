//! Tests of loose bodies, belts, clamps and grippers: closed forms.

use nalgebra::{Translation3, UnitQuaternion};
use twin_urdf::{Solid, SolidShape};

use super::contact::{around, cuboid, solid};
use super::*;

/// A cube of `edge` m and `mass` kg with its middle at `place`.
fn cube(name: &str, mass: f64, edge: f64, place: [f64; 3]) -> Body {
    let solids = vec![solid(SolidShape::Box { size: Vector3::repeat(edge) }, [0.0; 3])];
    let [x, y, z] = place;
    Body {
        name: name.into(),
        inertial: solids[0].uniform(mass),
        solids,
        pose: Isometry3::translation(x, y, z),
        material: 0,
        restitution: 0.0,
        clamp: None,
    }
}

/// A table whose top is at z = 0.
fn table() -> (&'static str, Solid) {
    ("table", cuboid([-2.0, -2.0, -0.1], [2.0, 2.0, 0.0]))
}

/// Friction of `coefficient` between everything that is loose.
fn scene(bodies: Vec<Body>, coefficient: f64) -> Surroundings {
    Surroundings { bodies, frictions: vec![([0, 0], coefficient)], ..around([table()]) }
}

/// A gantry far above the table whose quill ends in a ball of 30 mm.
fn machine(surroundings: &Surroundings) -> PhysicsMachine {
    let model = super::contact::solid_gantry();
    let start = axes([0.0, 0.0, 0.3]);
    let drives = drives_of(&model, &start, |inertia| tuned(inertia, 40.0, 2000.0));
    let mut machine = started(&model, &drives, down(), &start);
    machine.insert_surroundings(surroundings).unwrap();
    machine
}

fn rest(machine: &mut PhysicsMachine, cycles: u32) {
    machine.hold([0.0, 0.0, 0.3], cycles);
}

fn place(machine: &PhysicsMachine, body: usize) -> Vector3<f64> {
    machine.body_poses()[body].translation.vector
}

/// A fall takes g·t²/2, and half a cycle more of its speed: rapier moves bodies with the speed at the end of a cycle.
#[test]
fn a_body_falls() {
    let mut machine = machine(&scene(vec![cube("cube", 0.5, 0.02, [0.3, 0.0, 3.0])], 0.3));
    rest(&mut machine, 500);
    let fallen = 3.0 - place(&machine, 0).z;
    let expected = 0.5 * G * 0.5 * (0.5 + 1e-3);
    assert!((fallen - expected).abs() < 1e-6, "{fallen} m, not {expected}");
}

/// On an incline of tan φ a body holds or slides as the coefficient of friction says.
#[test]
fn an_incline_holds_or_lets_slide() {
    let slope = 0.3_f64;
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), slope.atan());
    let ramp = Solid {
        shape: SolidShape::Box { size: Vector3::new(4.0, 1.0, 0.1) },
        origin: Isometry3::from_parts(Translation3::identity(), turn)
            * Isometry3::translation(0.0, 0.0, -0.05),
        color: [1.0; 4],
    };
    for (coefficient, slides) in [(0.31, false), (0.2, true)] {
        let mut cube = cube("cube", 0.5, 0.04, [0.0; 3]);
        cube.pose = Isometry3::from_parts(Translation3::identity(), turn)
            * Isometry3::translation(0.0, 0.0, 0.02);
        let mut ramp = around([("ramp", ramp.clone())]);
        ramp.frictions = vec![([0, 0], coefficient)];
        ramp.bodies = vec![cube];
        let mut machine = machine(&ramp);
        // It settles first.
        rest(&mut machine, 100);
        let from = place(&machine, 0);
        let speed = |machine: &mut PhysicsMachine| {
            let before = place(machine, 0);
            rest(machine, 1);
            (place(machine, 0) - before).norm() * 1e3
        };
        let begun = speed(&mut machine);
        rest(&mut machine, 399);
        let way = (place(&machine, 0) - from).norm();
        if slides {
            let gained = speed(&mut machine) - begun;
            let (sin, cos) = slope.atan().sin_cos();
            let expected = G * (sin - coefficient * cos) * 0.4;
            assert!((gained - expected).abs() < 2e-3 * expected, "{gained} m/s, not {expected}");
        } else {
            assert!(way < 1e-6, "{way} m");
        }
    }
}

/// A belt takes what lies on it to its speed, which takes v²/(2µg) of sliding.
#[test]
fn a_belt_carries() {
    let mut surroundings = scene(vec![cube("cube", 0.5, 0.04, [0.0, 0.3, 0.02])], 0.25);
    surroundings.obstacles[0].surface.velocity = Vector3::new(0.3, 0.0, 0.0);
    let mut machine = machine(&surroundings);
    rest(&mut machine, 1000);
    let before = place(&machine, 0);
    rest(&mut machine, 100);
    let speed = (place(&machine, 0) - before).x * 10.0;
    assert!((speed - 0.3).abs() < 1e-5, "{speed} m/s");
    let slip = 0.3 - before.x;
    let expected = 0.3 * 0.3 / (2.0 * 0.25 * G);
    assert!((slip - expected).abs() < 0.03 * expected, "{slip} m, not {expected}");
}

/// Five cubes on each other stay there.
#[test]
fn a_stack_stands() {
    let cubes =
        (0..5).map(|row| cube("cube", 0.2, 0.03, [0.2, 0.0, 0.015 + 0.03 * f64::from(row)]));
    let mut machine = machine(&scene(cubes.collect(), 0.3));
    rest(&mut machine, 3000);
    for row in 0..5_u32 {
        let at = place(&machine, row as usize);
        let expected = Vector3::new(0.2, 0.0, 0.015 + 0.03 * f64::from(row));
        assert!((at - expected).norm() < 5e-5, "{row}: {at:?}");
    }
}

/// The quill pushes a cube along the table: it slides with it, the axis feels µ·m·g, and the cube has moved.
#[test]
fn a_pushed_body_is_felt() {
    let mut surroundings = scene(vec![cube("cube", 4.0, 0.08, [0.15, 0.0, 0.04])], 0.5);
    surroundings.machine_material = 1;
    surroundings.frictions.push(([0, 1], 0.0));
    let mut machine = machine(&surroundings);
    // The middle of the ball is 50 mm ahead of the quill and 200 mm above: as high as the cube's.
    machine.hold([0.0, 0.0, 0.3], 10);
    let lower = |machine: &mut PhysicsMachine, from: [f64; 3], to: [f64; 3], cycles: u32| {
        for cycle in 1..=cycles {
            let part = f64::from(cycle) / f64::from(cycles);
            let mut position = from;
            for (value, to) in position.iter_mut().zip(to) {
                *value += (to - *value) * part;
            }
            machine.hold(position, 1);
        }
    };
    lower(&mut machine, [0.0, 0.0, 0.3], [0.0, 0.0, -0.16], 1500);
    assert!(machine.take_body_events().is_empty());
    lower(&mut machine, [0.0, 0.0, -0.16], [0.2, 0.0, -0.16], 2000);
    let state = *machine.axis_state();
    let expected = 0.5 * 4.0 * G;
    assert!((state.effort[0] - expected).abs() < 0.01 * expected, "{state:?}");
    // The ball ends 80 mm ahead of the axis.
    let at = place(&machine, 0);
    assert!((at.x - 0.04 - (state.position[0] + 0.08)).abs() < 1e-5, "{at:?} {state:?}");
    let events = machine.take_body_events();
    let moved = BodyEventKind::Moved { body: 0, by: Part::Link(3) };
    assert_eq!(events.iter().map(|event| event.kind).collect::<Vec<_>>(), [moved]);
    assert!(machine.take_collisions().is_empty());
}

/// The gantry with a gripper below its ball.
fn gripping(bodies: Vec<Body>, force: f64) -> PhysicsMachine {
    let mut surroundings = scene(bodies, 0.3);
    surroundings.grippers = vec![cup(force)];
    machine(&surroundings)
}

/// A gripper of `force` N below the ball of the quill.
fn cup(force: f64) -> Gripper {
    Gripper {
        name: "cup".into(),
        link: 3,
        point: Point3::new(0.0, 0.0, -0.03),
        direction: -Vector3::z_axis(),
        reach: 2e-3,
        force,
        moment: 10.0,
    }
}

/// A gripped body goes with the tool, its weight and its inertia are felt by the axes, and it is put down again.
#[test]
fn a_gripper_carries() {
    let part = cube("part", 1.0, 0.04, [0.05, 0.0, 0.02]);
    let mut machine = gripping(vec![part], 50.0);
    let go = |machine: &mut PhysicsMachine, z: [f64; 2], cycles: u32| {
        for cycle in 1..=cycles {
            let [part, ..] = soft_start(2.0, 1.0, f64::from(cycle) / f64::from(cycles));
            machine.hold([0.0, 0.0, z[0] + (z[1] - z[0]) * part], 1);
        }
    };
    machine.grip(0, true);
    assert_eq!(machine.take_body_events()[0].kind, BodyEventKind::Missed { gripper: 0 });
    // The ball ends 170 mm above the quill's place: 1 mm above the part.
    go(&mut machine, [0.3, -0.129], 2000);
    let alone = machine.hold([0.0, 0.0, -0.129], 1000).effort[2];
    machine.grip(0, true);
    assert_eq!(machine.take_body_events()[0].kind, BodyEventKind::Gripped { gripper: 0, body: 0 });
    go(&mut machine, [-0.129, 0.1], 2000);
    let carried = machine.hold([0.0, 0.0, 0.1], 2000);
    let [force, moment] = machine.gripper_load(0);
    assert!((force - G).abs() < 1e-6 && moment < 1e-4, "{force} N, {moment} Nm");
    assert!((carried.effort[2] - alone - G).abs() < 1e-3, "{carried:?} {alone}");
    let at = place(&machine, 0);
    assert!((at - Vector3::new(0.05, 0.0, 0.249)).norm() < 1e-6, "{at:?}");
    go(&mut machine, [0.1, -0.129], 2000);
    machine.hold([0.0, 0.0, -0.129], 200);
    machine.grip(0, false);
    go(&mut machine, [-0.129, 0.1], 1000);
    let at = place(&machine, 0);
    assert!((at - Vector3::new(0.05, 0.0, 0.02)).norm() < 2e-5, "{at:?}");
    let kinds: Vec<_> = machine.take_body_events().iter().map(|event| event.kind).collect();
    assert_eq!(kinds, [BodyEventKind::Released { gripper: 0, body: 0 }]);
}

/// Another tool is another set of shapes: bodies stay where they are, gripped or not, and clamps that have given way stay
/// open.
#[test]
fn bodies_outlast_a_change_of_tools() {
    let bodies = vec![
        cube("part", 1.0, 0.04, [0.05, 0.0, 0.449]),
        cube("other", 1.0, 0.04, [0.5, 0.0, 1.0]),
        Body { clamp: Some(5.0), ..cube("clamped", 1.0, 0.04, [1.0, 0.0, 1.0]) },
    ];
    let mut surroundings = scene(bodies, 0.3);
    surroundings.grippers = vec![cup(50.0)];
    let run = |changes: bool| {
        let mut machine = machine(&surroundings);
        machine.grip(0, true);
        rest(&mut machine, 100);
        if changes {
            machine.insert_surroundings(&surroundings).unwrap();
        }
        rest(&mut machine, 200);
        assert_eq!(machine.held_by(0), Some(0));
        let kinds: Vec<_> = machine.take_body_events().iter().map(|event| event.kind).collect();
        (machine.body_poses(), kinds)
    };
    let (changed, same) = (run(true), run(false));
    assert_eq!(changed.1, same.1);
    assert!(matches!(same.1[..], [_, BodyEventKind::ClampGaveWay { body: 2, .. }]), "{same:?}");
    for (one, other) in changed.0.iter().zip(&same.0) {
        assert!((one.translation.vector - other.translation.vector).norm() < 1e-9, "{changed:?}");
    }
}

/// A gripper of 20 N loses 1 kg at the acceleration at which m·√(g² + a²) is 20 N: 17.4 m/s² sideways.
#[test]
fn a_gripper_loses_what_is_too_heavy() {
    for (acceleration, lost) in [(17.0, false), (17.8, true)] {
        let mut machine = gripping(vec![cube("part", 1.0, 0.04, [0.05, 0.0, 0.449])], 20.0);
        machine.grip(0, true);
        for cycle in 1..=100 {
            // It sets in within 50 ms.
            let t = f64::from(cycle) * 1e-3;
            let [speed, change, _] = soft_start(acceleration, 0.05, t);
            let w = std::f64::consts::PI / 0.05;
            let rising = 0.25 * t * t - (1.0 - (w * t).cos()) / (2.0 * w * w);
            let settled = 0.25 * 0.05 * 0.05 - 1.0 / (w * w);
            let later = t - 0.05;
            let part =
                if later < 0.0 { rising } else { settled + 0.025 * later + 0.5 * later * later };
            let x = acceleration * part;
            let set = motion([[x, 0.0, 0.3], [speed, 0.0, 0.0], [change, 0.0, 0.0]]);
            machine.step(&set).unwrap();
        }
        let events = machine.take_body_events();
        let loss = events.iter().find_map(|event| match event.kind {
            BodyEventKind::Lost { cause, load, .. } => Some((cause, load[0])),
            _ => None,
        });
        assert_eq!(loss.is_some(), lost, "{acceleration} m/s²: {events:?}");
        if let Some((cause, force)) = loss {
            assert_eq!(cause, LossCause::Acceleration);
            assert!((20.0..20.7).contains(&force), "{force} N");
        }
    }
}

/// A clamp holds up to its force, and what falls off the table is dropped.
#[test]
fn a_clamp_gives_way_and_a_body_falls_off() {
    let clamped = Body { clamp: Some(60.0), ..cube("part", 1.0, 0.06, [0.15, 0.0, 0.03]) };
    let mut edge = scene(vec![clamped, cube("other", 0.1, 0.02, [1.995, 1.0, 0.01])], 0.3);
    edge.bodies[1].pose.translation.x = 2.02;
    let mut machine = machine(&edge);
    rest(&mut machine, 1000);
    let kinds = |machine: &mut PhysicsMachine| -> Vec<_> {
        machine.take_body_events().iter().map(|event| event.kind).collect()
    };
    assert_eq!(kinds(&mut machine), [BodyEventKind::Dropped { body: 1 }]);
    for cycle in 1..=1500 {
        machine.hold([0.0, 0.0, 0.3 - 0.45 * f64::from(cycle) / 1500.0], 1);
    }
    // The ball ends 80 mm ahead of the axis, and presses with the axis' stiffness: it meets the part at 40 mm.
    for cycle in 1..=1000 {
        machine.hold([0.0399 * f64::from(cycle) / 1000.0, 0.0, -0.15], 1);
    }
    for cycle in 1..=2000 {
        machine.hold([0.0399 + 1e-6 * f64::from(cycle), 0.0, -0.15], 1);
    }
    let found = kinds(&mut machine);
    let [BodyEventKind::ClampGaveWay { body: 0, force }, BodyEventKind::Moved { body: 0, .. }, ..] =
        found[..]
    else {
        panic!("{found:?}")
    };
    assert!(force > 60.0 && force < 80.0, "{force} N");
}

/// With loose bodies around it a machine that touches none moves as without them, to the bit; a copy goes on with the
/// same bits.
#[test]
fn bodies_that_are_not_touched_change_nothing() {
    let bodies =
        vec![cube("cube", 0.5, 0.02, [0.3, 0.0, 0.1]), cube("b", 0.5, 0.02, [0.3, 0.005, 0.2])];
    let run = |machine: &mut PhysicsMachine, cycles: std::ops::Range<u32>| {
        for cycle in cycles {
            let t = f64::from(cycle) * 1e-3;
            machine.hold([0.1 * t.sin(), 0.05 * t, 0.3], 1);
        }
        *machine.axis_state()
    };
    let mut with = machine(&scene(bodies, 0.3));
    let mut without = machine(&scene(Vec::new(), 0.3));
    assert_eq!(run(&mut with, 0..300), run(&mut without, 0..300));
    let mut copy = with.clone();
    let ends = [&mut with, &mut copy].map(|machine| {
        let state = run(machine, 300..900);
        (state, machine.body_poses())
    });
    assert_eq!(ends[0], ends[1]);
}

/// A tripod carries a body: its three motors give its weight, and when it moves the body's inertia; the body is where the
/// platform takes it.
#[test]
fn a_tripod_carries() {
    use twin_kinematics::Kinematics;
    use twin_kinematics::tripod::{Tripod, TripodDeviations};
    let model = super::parallel::generated(&TripodDeviations::default());
    let start = axes([0.35; 3]);
    let tip = model.tip_position(&start);
    let below = solid(SolidShape::Box { size: Vector3::repeat(0.02) }, [0.0; 3]);
    let part = Body {
        name: "part".into(),
        inertial: below.uniform(0.8),
        solids: vec![below],
        pose: Isometry3::translation(tip.x, tip.y, tip.z - 0.0115),
        material: 0,
        restitution: 0.0,
        clamp: None,
    };
    let gripper = Gripper {
        name: "cup".into(),
        link: model.tip.link,
        point: model.tip.point,
        direction: -Vector3::z_axis(),
        reach: 2e-3,
        force: 40.0,
        moment: 5.0,
    };
    let floor = Surroundings::floor(tip.z - 0.5);
    let surroundings =
        Surroundings { bodies: vec![part], grippers: vec![gripper], among_links: false, ..floor };
    let drives = drives_of(&model, &start, |inertia| tuned(inertia, 40.0, 2000.0));
    let run = |grip: bool| {
        let mut machine = started(&model, &drives, down(), &start);
        machine.insert_surroundings(&surroundings).unwrap();
        machine.grip(0, grip);
        let still: f64 = machine.hold([0.35; 3], 1500).effort.iter().sum();
        let mut efforts = [0.0; 3];
        for cycle in 1..=1000 {
            let [way, speed, change] = soft_start(0.2, 0.4, f64::from(cycle) * 1e-3);
            // The first tower alone: the platform moves sideways as well.
            let set = motion([[0.35 + way, 0.35, 0.35], [speed, 0.0, 0.0], [change, 0.0, 0.0]]);
            let state = machine.step(&set).unwrap();
            if cycle == 200 {
                efforts = [0, 1, 2].map(|axis| state.effort[axis]);
            }
        }
        (machine, still, efforts)
    };
    let (_, alone, without) = run(false);
    let (machine, carried, with) = run(true);
    assert!((carried - alone - 0.8 * G).abs() < 1e-4, "{carried} {alone}");
    let state = *machine.axis_state();
    let transform = Tripod::new(super::parallel::rings(), [0.0; 3]).unwrap();
    let moved = transform.forward(&state.position).unwrap().position
        - transform.forward(&start).unwrap().position;
    let at =
        machine.body_poses()[0].translation.vector - Vector3::new(tip.x, tip.y, tip.z - 0.0115);
    assert!(moved.norm() > 0.05 && (at - moved).norm() < 1e-6, "{at:?} {moved:?}");
    let more: Vec<_> = with.iter().zip(without).map(|(with, without)| with - without).collect();
    assert!(more.iter().sum::<f64>() > 0.8 * G, "{more:?}");
}

/// Random set-points among twenty bodies on a belt that are pushed, gripped, dropped and lost: everything stays finite and
/// slow, and none gains more energy than motors, belt and falls give.
#[test]
fn nothing_explodes_among_bodies() {
    use rand::{Rng, SeedableRng};
    let steps = if std::env::var_os("TWIN_PHYSICS_FULL").is_some() { 1_000_000 } else { 20_000 };
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let place = |index: u32| {
        let (row, column) = (f64::from(index / 5), f64::from(index % 5));
        [0.1 + 0.06 * row, -0.15 + 0.06 * column, 0.0201]
    };
    let bodies = (0..20).map(|index| cube("cube", 0.2, 0.04, place(index))).collect();
    let mut surroundings = scene(bodies, 0.3);
    surroundings.obstacles[0].surface.velocity = Vector3::new(0.05, 0.02, 0.0);
    surroundings.grippers = vec![Gripper { reach: 5e-3, moment: 3.0, ..cup(30.0) }];
    let mut machine = machine(&surroundings);
    let fresh = machine.clone();
    let (mut target, mut goal) = ([0.0, 0.0, 0.3], [0.0_f64; 3]);
    let (mut events, mut fastest) = (0, 0.0_f64);
    for step in 0..steps {
        if step % 5_000 == 4_999 {
            machine.clone_from(&fresh);
            target = [0.0, 0.0, 0.3];
        }
        if random.random_range(0.0..1.0) < 4e-3 {
            let ranges = [(-0.1, 0.4), (-0.3, 0.3), (-0.15, 0.05)];
            goal = ranges.map(|(low, high)| random.random_range(low..high));
        }
        for (target, goal) in target.iter_mut().zip(goal) {
            *target += f64::clamp(goal - *target, -8e-4, 8e-4);
        }
        if random.random_range(0.0..1.0) < 0.01 {
            machine.grip(0, random.random_range(0.0..1.0) < 0.7);
        }
        let before = machine.body_poses();
        let state = machine.step(&AxisMotion::at_rest(axes(target))).unwrap();
        assert!(state.position.is_finite() && state.velocity.is_finite(), "{state:?}");
        for (before, pose) in before.iter().zip(machine.body_poses()) {
            let way = (pose.translation.vector - before.translation.vector).norm();
            assert!(pose.translation.vector.norm() < 10.0, "{step}: {pose}");
            fastest = fastest.max(way * 1e3);
        }
        events += machine.take_body_events().len();
        machine.take_collisions();
    }
    println!("{steps} steps, {events} events, at most {fastest} m/s");
    assert!(events > 20 && fastest < 8.0, "{events} events, {fastest} m/s");
}

/// Round parts stay where they lie and stand.
#[test]
fn round_parts_lie_still() {
    let round = |name: &str, shape: SolidShape, turn: UnitQuaternion<f64>, place: [f64; 3]| {
        let mut body = cube(name, 0.2, 0.04, place);
        body.solids = vec![solid(shape, [0.0; 3])];
        body.inertial = body.solids[0].uniform(0.2);
        body.pose.rotation = turn;
        body
    };
    let lying = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    let rod = SolidShape::Cylinder { radius: 0.01, length: 0.08 };
    let pill = SolidShape::Capsule { radius: 0.01, length: 0.06 };
    let disc = SolidShape::Cylinder { radius: 0.03, length: 0.01 };
    let upright = UnitQuaternion::identity();
    let ball = SolidShape::Sphere { radius: 0.02 };
    let bodies = vec![
        round("rod", rod, lying, [0.2, 0.0, 0.01]),
        round("pill", pill, lying, [0.3, 0.0, 0.01]),
        round("disc", disc, upright, [0.4, 0.0, 0.005]),
        round("ball", ball, upright, [0.5, 0.0, 0.02]),
    ];
    let from: Vec<_> = bodies.iter().map(|body| body.pose.translation.vector).collect();
    let mut machine = machine(&scene(bodies, 0.3));
    rest(&mut machine, 5000);
    for (index, from) in from.iter().enumerate() {
        let at = place(&machine, index);
        assert!((at - from).norm() < 2e-6, "{index}: {at:?}, not {from:?}");
    }
}

/// An arm that turns faster and faster loses its part where m·√((ω²·r)² + (α·r)² + g²) is what the gripper holds.
#[test]
fn an_arm_flings_its_part_away() {
    let model = super::contact::arm();
    let start = axes([0.0, 0.4]);
    let tip = model.tip_position(&start);
    let mut surroundings = around([("table", cuboid([-2.0, -2.0, -1.1], [2.0, 2.0, -1.0]))]);
    surroundings.bodies = vec![cube("part", 0.5, 0.02, [tip.x, tip.y, tip.z - 0.011])];
    surroundings.grippers = vec![Gripper {
        name: "cup".into(),
        link: model.tip.link,
        point: model.tip.point,
        direction: -Vector3::z_axis(),
        reach: 2e-3,
        force: 15.0,
        moment: 10.0,
    }];
    let drives = drives_of(&model, &start, |inertia| tuned(inertia, 40.0, 500.0));
    let mut machine = started(&model, &drives, down(), &start);
    machine.insert_surroundings(&surroundings).unwrap();
    machine.grip(0, true);
    assert_eq!(machine.held_by(0), Some(0));
    let alpha = 8.0;
    let radius = tip.coords.xy().norm();
    let expected = {
        let across = (15.0_f64 / 0.5).powi(2) - G * G - (alpha * radius).powi(2);
        (across.sqrt() / radius).sqrt()
    };
    for cycle in 1..=2000 {
        // The acceleration sets in within 200 ms.
        let t = f64::from(cycle) * 1e-3;
        let rise = 0.2;
        let w = std::f64::consts::PI / rise;
        let (angle, speed, change) = if t < rise {
            let [half, part, _] = soft_start(alpha, rise, t);
            let angle = alpha * (0.25 * t * t - (1.0 - (w * t).cos()) / (2.0 * w * w));
            (angle, half, part)
        } else {
            let begun = alpha * (0.25 * rise * rise - 1.0 / (w * w));
            let late = t - rise;
            let speed = alpha * (0.5 * rise + late);
            (begun + alpha * (0.5 * rise * late + 0.5 * late * late), speed, alpha)
        };
        let set = motion([[angle, 0.4], [speed, 0.0], [change, 0.0]]);
        let state = machine.step(&set).unwrap();
        if machine.held_by(0).is_none() {
            let speed = state.velocity[0];
            assert!((speed - expected).abs() < 5e-3 * expected, "{speed} rad/s, not {expected}");
            return;
        }
    }
    panic!("{:?}", machine.gripper_load(0));
}

/// A body that is pushed and let go slides on for v²/(2µg).
#[test]
fn a_body_slides_to_a_stop() {
    let mut surroundings = scene(vec![cube("cube", 0.5, 0.08, [0.1301, 0.0, 0.04])], 0.4);
    surroundings.machine_material = 1;
    surroundings.frictions.push(([0, 1], 0.0));
    let mut machine = machine(&surroundings);
    for cycle in 1..=1500 {
        machine.hold([0.0, 0.0, 0.3 - 0.46 * f64::from(cycle) / 1500.0], 1);
    }
    // The ball ends 80 mm ahead of the axis; it pushes until 0.5 s.
    let speed = 0.5;
    let mut at_stop = None;
    for cycle in 1..=1500 {
        let t = f64::from(cycle) * 1e-3;
        let [way, velocity, change] = if t < 0.5 {
            soft_start(speed, 0.3, t)
        } else {
            // The axis turns back.
            let [back, velocity, change] = soft_start(-2.0 * speed, 0.02, (t - 0.5).min(0.02));
            let [way, ..] = soft_start(speed, 0.3, 0.5);
            [way + speed * (t - 0.5).min(0.02) + back, speed + velocity, change]
        };
        if t >= 0.52 {
            break;
        }
        machine
            .step(&motion([[way, 0.0, -0.16], [velocity, 0.0, 0.0], [change, 0.0, 0.0]]))
            .unwrap();
        if (0.4995..0.5005).contains(&t) {
            at_stop = Some(place(&machine, 0).x);
        }
    }
    let rest = *machine.axis_state();
    machine.hold([rest.position[0] - 0.02, 0.0, -0.16], 1000);
    let way = place(&machine, 0).x - at_stop.unwrap();
    let expected = speed * speed / (2.0 * 0.4 * G);
    assert!((way - expected).abs() < 0.02 * expected, "{way} m, not {expected}");
}

/// A light part between tool and table is pressed as hard as a heavy one: by what the motor gives and the quill weighs.
#[test]
fn a_light_part_is_pressed_as_hard_as_a_heavy_one() {
    for mass in [0.005, 0.07, 0.5, 5.0] {
        let mut machine = machine(&scene(vec![cube("part", mass, 0.04, [0.05, 0.0, 0.02])], 0.3));
        // The ball touches the part at −130 mm.
        for cycle in 1..=1000 {
            machine.hold([0.0, 0.0, 0.3 - 0.4299 * f64::from(cycle) / 1000.0], 1);
        }
        for cycle in 1..=2000 {
            machine.hold([0.0, 0.0, -0.1299 - 5e-7 * f64::from(cycle)], 1);
        }
        let state = *machine.axis_state();
        let contacts = machine.contacts();
        let pressed = contacts.iter().find(|one| one.parts == [Part::Link(3), Part::Body(0)]);
        let pressed = pressed.map_or(0.0, |contact| contact.force);
        let expected = 3.0 * G - state.effort[2];
        assert!(expected > 200.0, "{mass} kg: {state:?}");
        assert!((pressed - expected).abs() < 2e-3 * expected, "{mass} kg: {pressed}, {expected}");
        // 10 µm at 100 N.
        assert!((state.position[2] + 0.13).abs() < expected * 1e-7, "{mass} kg: {state:?}");
        assert!((place(&machine, 0).xy() - Vector3::new(0.05, 0.0, 0.0).xy()).norm() < 1e-4);
    }
}

/// The clamp of a light part is not weaker than that of a heavy one, and pushing it gives the axis no energy.
#[test]
fn a_clamp_holds_whatever_it_holds() {
    for mass in [0.01, 1.0] {
        let part = Body { clamp: Some(1e4), ..cube("part", mass, 0.06, [0.15, 0.0, 0.03]) };
        let mut machine = machine(&scene(vec![part], 0.3));
        for cycle in 1..=1000 {
            machine.hold([0.0, 0.0, 0.3 - 0.45 * f64::from(cycle) / 1000.0], 1);
        }
        for cycle in 1..=3000 {
            machine.hold([0.05_f64.min(2e-5 * f64::from(cycle)), 0.0, -0.15], 1);
        }
        let state = *machine.axis_state();
        // The ball ends 80 mm ahead of the axis, and the part begins at 120 mm.
        assert!((state.position[0] - 0.04).abs() < 1e-5, "{mass} kg: {state:?}");
        assert!(machine.take_body_events().is_empty(), "{mass} kg");
    }
}

/// A tool that is lifted off what it presses on keeps no effort of the contact: it moves as its motor says.
#[test]
fn a_contact_that_ends_leaves_nothing_behind() {
    let model = super::contact::solid_gantry();
    let start = axes([0.0, 0.0, -0.17]);
    let mut machine = started(&model, &[SLACK; 3], Vector3::zeros(), &start);
    machine.insert_surroundings(&around([table()])).unwrap();
    machine.push([0.0, 0.0, -90.0], 100);
    let pressing = *machine.axis_state();
    assert!(pressing.velocity[2].abs() < 1e-9, "{pressing:?}");
    let lifted = machine.push([0.0, 0.0, 90.0], 1);
    let expected = 90.0 / 3.0 * 1e-3;
    assert!((lifted.velocity[2] - expected).abs() < 0.02 * expected, "{lifted:?}");
}
