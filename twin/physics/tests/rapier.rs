//! rapier's bodies against our own equation of motion: two formulations of the same machine.

use super::*;

/// Largest distance between the links of two sets of poses, m.
fn distance(a: &[Isometry3<f64>], b: &[Isometry3<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    let offsets = [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
    let pairs =
        a.iter().zip(b).flat_map(|(a, b)| offsets.map(|point| (a * point - b * point).norm()));
    pairs.fold(0.0, f64::max)
}

/// The poses written down once more, straight from the model.
fn model_poses(model: &Model, position: &AxisVector) -> Vec<Isometry3<f64>> {
    let mut poses = vec![Isometry3::identity()];
    for joint in &model.joints {
        let value = joint.machine_axis.map_or(0.0, |axis| position[axis]);
        let motion = match joint.kind {
            JointKind::Revolute => Isometry3::rotation(joint.axis.into_inner() * value),
            JointKind::Prismatic => {
                Isometry3::from(nalgebra::Translation3::from(joint.axis.into_inner() * value))
            }
            JointKind::Fixed => Isometry3::identity(),
        };
        poses.push(poses[joint.parent] * joint.origin * motion);
    }
    poses
}

#[test]
fn the_bodies_are_where_the_model_says() {
    for (model, start) in [(gantry(), axes([0.3, -0.2, 0.1])), (crooked(), axes([0.7, -0.1, 2.0]))]
    {
        let mut machine =
            PhysicsMachine::new(&model, &[SLACK; 3], down(), &start, CYCLE_NS).unwrap();
        assert!(distance(&machine.link_poses(), &model_poses(&model, &start)) < 1e-14);
        for _ in 0..300 {
            machine.step_with_efforts(&axes([5.0, 3.0, -0.2])).unwrap();
        }
        let state = *machine.axis_state();
        assert!(
            state.position.iter().zip(start.iter()).all(|(now, start)| (now - start).abs() > 1e-3),
            "{state:?}"
        );
        let poses = machine.link_poses();
        assert!(distance(&poses, &model_poses(&model, &state.position)) < 1e-13);
        assert!(distance(&poses, &machine.dynamics.link_poses(&machine.joints.position)) < 1e-13);
    }
}

/// Given the bias efforts, rapier leaves the velocity it was given alone: no friction, damping or drift of its own,
/// and mass properties that are ours.
#[test]
fn rapier_adds_nothing_to_free_motion() {
    let model = crooked();
    let start = joints([0.7, -0.1, 2.0]);
    let velocity = joints([1.5, -0.8, 4.0]);
    let mut dynamics = Dynamics::new(&model, 3, down(), JointVector::zeros()).unwrap();
    let mut world =
        RapierWorld::new(&model, down(), &JointVector::zeros(), &start, 1e-3, 1).unwrap();
    world.set_velocity(&velocity);
    world.apply_effort(&dynamics.inverse_dynamics(&start, &velocity, &JointVector::zeros()));
    world.step();
    let (position, kept) = world.joint_motion();
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
    let mut machine = PhysicsMachine::new(&model, &drives, down(), &start, CYCLE_NS).unwrap();
    for _ in 0..200 {
        machine.step_with_efforts(&axis_vector(&effort, 3)).unwrap();
    }
    let errors = [1, 4, 16, 64].map(|iterations| {
        let start = joint_vector(start.iter().copied());
        let mut world =
            RapierWorld::new(&model, down(), &armature, &start, 1e-3, iterations).unwrap();
        for _ in 0..200 {
            world.apply_effort(&effort);
            world.step();
        }
        (world.joint_motion().0 - machine.joints.position).amax()
    });
    for pair in errors.windows(2) {
        assert!((3.0..5.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    assert!(errors[3] < 1e-4, "{errors:?}");
    assert!((machine.axis_state().position[0] - start[0]).abs() > 0.01);
}

#[test]
fn two_runs_give_the_same_bits() {
    let run = || {
        let drives = [AxisDriveParameters {
            coulomb_friction: 0.3,
            viscous_friction: 0.5,
            armature: 0.05,
            ..AxisDriveParameters::tuned(1.0, 40.0, 30.0)
        }; 3];
        let mut machine =
            PhysicsMachine::new(&crooked(), &drives, down(), &axes([0.0; 3]), CYCLE_NS).unwrap();
        for cycle in 0..500 {
            let t = f64::from(cycle) * 1e-3;
            let position = axes([0.3 * t, 0.1 * t * t, -0.2 * t]);
            machine
                .step(&AxisMotion {
                    position,
                    velocity: axes([0.3, 0.2 * t, -0.2]),
                    acceleration: axes([0.0, 0.2, 0.0]),
                })
                .unwrap();
        }
        let state = *machine.axis_state();
        assert!((state.position[0] - 0.15).abs() < 0.02, "{state:?}");
        let bits =
            |values: &AxisVector| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        (
            bits(&state.position),
            bits(&state.velocity),
            bits(&state.effort),
            format!("{:?}", machine.link_poses()),
        )
    };
    assert_eq!(run(), run());
}
