//! Tests of our equation of motion against rapier's bodies: two formulations of the same machine.

use twin_urdf::{MachineJoint, ScaraDimensions, SolidShape};

use super::contact::solid;
use super::*;

/// Largest distance between the links of two sets of poses, m.
fn distance(a: &[Isometry3<f64>], b: &[Isometry3<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    let offsets = [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
    let pairs =
        a.iter().zip(b).flat_map(|(a, b)| offsets.map(|point| (a * point - b * point).norm()));
    pairs.fold(0.0, f64::max)
}

#[test]
fn the_bodies_are_where_the_model_says() {
    for (model, start) in [(gantry(), axes([0.3, -0.2, 0.1])), (crooked(), axes([0.7, -0.1, 2.0]))]
    {
        let mut machine = started(&model, &[SLACK; 3], down(), &start);
        let links = Unfolded::new(&model, 3, down(), JointVector::zeros());
        assert!(distance(&machine.link_poses(), &model.link_poses(&start)) < 1e-14);
        let state = machine.push([5.0, 3.0, -0.2], 300);
        let mut ways = state.position.iter().zip(start.iter()).map(|(now, start)| now - start);
        assert!(ways.all(|way| way.abs() > 1e-3), "{state:?}");
        let poses = machine.link_poses();
        assert!(distance(&poses, &model.link_poses(&state.position)) < 1e-13);
        assert!(distance(&poses, &links.link_poses(&machine.joints.axes.position)) < 1e-13);
    }
}

/// A machine generated from its dimensions holds its place, follows its set-points, and its tool tip in
/// rapier is the model's.
#[test]
fn a_generated_scara_runs() {
    let joint = |name: &str, axis, limits| MachineJoint::new(name, axis, limits);
    // Axes in another order than joints.
    let arm_joints = [joint("A", 1, [-2.5, 2.5]), joint("B", 2, [-2.5, 2.5])];
    let mut dimensions =
        ScaraDimensions::new("scara", arm_joints, Some(joint("Z", 0, [-0.1, 0.1])), [0.25, 0.2]);
    dimensions.tool = Vector3::new(0.0, 0.0, -0.06);
    dimensions.tool_mass = 0.3;
    let model = dimensions.model().unwrap();

    let start = axes([0.02, 0.4, 1.0]);
    let inertia = axis_inertia(&model, &start).unwrap();
    let holding = holding_effort(&model, &start);
    assert!((holding[0] - inertia[0] * G).abs() < 1e-9, "the quill carries itself: {holding:?}");
    assert!(holding[1].abs() < 1e-12 && holding[2].abs() < 1e-12, "{holding:?}");

    let drives = drives_of(&model, &start, |inertia| tuned(inertia, 50.0, 200.0));
    let mut machine = started(&model, &drives, down(), &start);
    let target = axes([0.021, 0.39, 1.02]);
    machine.hold([0.021, 0.39, 1.02], 1000);
    let tip = machine.link_poses()[model.tip.link] * model.tip.point;
    assert!((tip - model.tip_position(&target)).norm() < 1e-9, "{tip}");
    assert!((tip - model.tip_position(&start)).norm() > 1e-3, "{tip}");
}

/// Given the bias efforts, rapier leaves the velocity it was given alone: no friction, damping or drift of its own,
/// and mass properties that are ours.
#[test]
fn rapier_adds_nothing_to_free_motion() {
    let model = crooked();
    let start = joints([0.7, -0.1, 2.0]);
    let velocity = joints([1.5, -0.8, 4.0]);
    let mut dynamics = Dynamics::new(&model, 3, down(), JointVector::zeros()).unwrap();
    let zero = JointVector::zeros();
    let mut world = RapierAlone::new(&model, (&zero, &start), (1e-3, 1));
    world.set_velocity(&velocity);
    world.apply_effort(&dynamics.inverse_dynamics(&start, &velocity, &JointVector::zeros()));
    world.step();
    let (position, kept) = world.motion();
    assert!((kept - velocity).amax() < 1e-13, "{kept}");
    assert!((position - (start + velocity * 1e-3)).amax() < 1e-15, "{position}");
}

/// Left to itself, rapier converges to our solution linearly with its solver iterations: four times as many, a
/// quarter of the difference.
#[test]
fn rapier_alone_converges_to_the_same_motion() {
    let model = crooked();
    let start = axes([0.7, -0.1, 2.0]);
    let armature = joints([0.1, 0.5, 0.02]);
    let effort = joints([6.0, 25.0, -0.2]);
    let drives = [0.1, 0.5, 0.02].map(|armature| AxisDriveParameters { armature, ..SLACK });
    let mut machine = started(&model, &drives, down(), &start);
    machine.push([6.0, 25.0, -0.2], 200);
    let errors = [1, 4, 16, 64].map(|iterations| {
        let start = joint_vector(start.iter().copied());
        let mut world = RapierAlone::new(&model, (&armature, &start), (1e-3, iterations));
        for _ in 0..200 {
            world.apply_effort(&effort);
            world.step();
        }
        (world.motion().0 - machine.joints.axes.position).amax()
    });
    for pair in errors.windows(2) {
        assert!((3.0..5.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    assert!(errors[3] < 1e-4, "{errors:?}");
    assert!((machine.axis_state().position[0] - start[0]).abs() > 0.01);
}

/// A slide falls as if there were no ground until it is nearer than rapier looks ahead (2 mm); then it stands on it, and it can be lifted
/// off again, exactly.
#[test]
fn a_slide_falls_to_the_ground_and_no_further() {
    let mut model = lift(3.0);
    let cube = SolidShape::Box { size: Vector3::repeat(0.1) };
    model.links[1].solids.push(solid(cube, [0.02, -0.01, 0.05]));
    let mut machine = started(&model, &[SLACK], down(), &axes([0.1]));
    machine.insert_surroundings(&Surroundings::floor(0.0)).unwrap();
    let mut stood = 0;
    for cycle in 1..=1000 {
        let state = machine.step_with_efforts(&axes([0.0])).unwrap();
        let t = f64::from(cycle) * 1e-3;
        let free = 0.1 - 0.5 * G * t * t;
        if free > 0.005 {
            assert!((state.position[0] - free).abs() < 1e-12, "{t} s: {state:?}");
        }
        assert!(state.position[0] > -2e-3, "{t} s: {state:?}");
        stood += u32::from(state.position[0].abs() < 2e-3);
    }
    let state = *machine.axis_state();
    assert!(stood > 800 && state.position[0].abs() < 1e-4, "{stood} cycles, {state:?}");
    // 2 m/s² upwards.
    let lifting = [3.0 * (G + 2.0)];
    let off = machine.push(lifting, 100);
    assert!(off.position[0] > 5e-3, "{off:?}");
    let state = machine.push(lifting, 200);
    let expected = off.position[0] + off.velocity[0] * 0.2 + 0.5 * 2.0 * 0.2 * 0.2;
    assert!((state.position[0] - expected).abs() < 1e-12, "{state:?}, not {expected} m");
}

/// What is far from everything moves as if it could touch nothing, to the bit.
#[test]
fn solids_that_touch_nothing_change_nothing() {
    let mut model = crooked();
    for link in &mut model.links {
        link.solids.push(solid(SolidShape::Sphere { radius: 0.02 }, [0.0; 3]));
    }
    let [with, without] = [true, false].map(|solids| {
        let mut machine = started(&model, &[SLACK; 3], down(), &axes([0.7, -0.1, 2.0]));
        if solids {
            machine.insert_surroundings(&Surroundings::floor(-20.0)).unwrap();
        }
        machine.push([5.0, 3.0, -0.2], 300)
    });
    assert_eq!(with, without);
    assert!((with.position[0] - 0.7).abs() > 0.01, "{with:?}");
}

#[test]
fn two_runs_give_the_same_bits() {
    let run = || {
        let drives = [1.0; 3].map(|inertia| AxisDriveParameters {
            friction: FrictionParameters::new(0.3, 0.5),
            armature: 0.05,
            ..tuned(inertia, 40.0, 30.0)
        });
        let mut machine = started(&crooked(), &drives, down(), &axes([0.0; 3]));
        for cycle in 0..500 {
            let t = f64::from(cycle) * 1e-3;
            let position = [0.3 * t, 0.1 * t * t, -0.2 * t];
            let set = motion([position, [0.3, 0.2 * t, -0.2], [0.0, 0.2, 0.0]]);
            machine.step(&set).unwrap();
        }
        let state = *machine.axis_state();
        assert!((state.position[0] - 0.15).abs() < 0.02, "{state:?}");
        super::copies::bits(&mut machine)
    };
    assert_eq!(run(), run());
}
