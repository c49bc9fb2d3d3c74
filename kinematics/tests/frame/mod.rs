//! Tests of work frames: poses, motions and jerks in both directions.

mod cuboid;
mod unit_vectors;

use crate::tests::{differences, seeded};
use crate::{Pose, ToolJerk, ToolMotion, WorkFrame};
use nalgebra::{Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

fn direction_of(frame: &WorkFrame, direction: f64) -> f64 {
    frame.pose_to_machine(&Pose { position: Point3::origin(), direction }).direction
}

#[test]
fn the_identity_changes_nothing() {
    let frame = WorkFrame::default();
    let pose = Pose { position: Point3::new(1.0, -2.0, 3.0), direction: 40.0 };
    assert_eq!(frame.pose_to_machine(&pose), pose);
    assert_eq!(frame, WorkFrame::identity());
    assert!((frame.machine_from_work().translation.vector).norm() == 0.0);
}

#[test]
fn a_quarter_turn_and_a_shift() {
    let frame = WorkFrame::new(Vector3::new(10.0, 20.0, 30.0), 0.0, 0.0, FRAC_PI_2);
    let mut motion =
        ToolMotion::at_rest(Pose { position: Point3::new(1.0, 2.0, 3.0), direction: 7.0 });
    motion.velocity = Vector3::x();
    motion.acceleration = Vector3::y();
    motion.direction_velocity = 0.5;
    motion.direction_acceleration = -0.25;
    let found = frame.motion_to_machine(&motion);
    assert!((found.pose.position - Point3::new(8.0, 21.0, 33.0)).norm() < 1e-14, "{found:?}");
    assert!((found.velocity - Vector3::y()).norm() < 1e-15, "{found:?}");
    assert!((found.acceleration + Vector3::x()).norm() < 1e-15, "{found:?}");
    assert!((found.pose.direction - (7.0 + FRAC_PI_2)).abs() < 1e-15, "{found:?}");
    assert_eq!((found.direction_velocity, found.direction_acceleration), (0.5, -0.25));
}

/// Turned over about x, then turned by the yaw: East stays at the yaw, North goes to the other side.
#[test]
fn a_frame_upside_down_reverses_directions() {
    let frame = WorkFrame::new(Vector3::zeros(), PI, 0.0, 0.4);
    for direction in [0.0, 1.0, -2.0, 5.0] {
        assert!((direction_of(&frame, direction) - (0.4 - direction)).abs() < 1e-15);
    }
}

/// Tilted by 60° about y, East looks half as long: its component along x halves, North's stays.
#[test]
fn a_tilted_frame_shows_directions_from_above() {
    let frame = WorkFrame::new(Vector3::zeros(), 0.0, PI / 3.0, 0.0);
    let expected = 1_f64.atan2(0.5);
    assert!((direction_of(&frame, PI / 4.0) - expected).abs() < 1e-15);
    assert!(direction_of(&frame, 0.0).abs() < 1e-15);
}

#[test]
fn a_direction_straight_down_keeps_the_turn() {
    let frame = WorkFrame::new(Vector3::zeros(), 0.0, FRAC_PI_2, 0.0);
    let mut motion = ToolMotion::at_rest(Pose { position: Point3::origin(), direction: 0.0 });
    motion.direction_velocity = 1.0;
    let found = frame.motion_to_machine(&motion);
    assert!(found.is_finite() && found.pose.direction.abs() <= PI, "{found:?}");
}

/// With either sign of the quaternion.
#[test]
fn placed_is_new() {
    let translation = Vector3::new(0.1, 0.2, 0.3);
    for [roll, pitch, yaw] in [[0.0, 0.0, 2.5], [0.0, 0.0, -3.0], [PI, 0.0, 1.0], [0.3, -0.5, 1.1]]
    {
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let expected = WorkFrame::new(translation, roll, pitch, yaw);
        for rotation in [rotation, UnitQuaternion::new_unchecked(-rotation.into_inner())] {
            let found = WorkFrame::placed(rotation, translation);
            for direction in [-7.0, 0.0, 1.0, 20.0] {
                let (found, expected) =
                    (direction_of(&found, direction), direction_of(&expected, direction));
                assert!((found - expected).abs() < 1e-14, "{found} {expected}");
            }
        }
    }
}

/// From above, a frame that is edge-on has two directions; on the way back they turn as the work does.
#[test]
fn a_frame_seen_edge_on_turns_on_the_way_back_as_the_work_does() {
    for [roll, pitch] in [[0.0, FRAC_PI_2], [0.0, -FRAC_PI_2], [FRAC_PI_2, 0.0], [-FRAC_PI_2, 0.3]]
    {
        let frame = WorkFrame::new(Vector3::zeros(), roll, pitch, 0.4);
        let [seen, further] = [9.0, 9.5].map(|direction| {
            frame.pose_to_work(&Pose { position: Point3::origin(), direction }).direction
        });
        assert!(((further - seen).abs() - 0.5).abs() < 1e-14, "{seen} {further}");
        assert!((seen.abs() - 9.0).abs() < 2.0 * PI, "{seen}");
    }
}

/// At a point of a frame tilted by 60° about y where all is known: seen (cos d/2, sin d), slope (1/2)/(cos²d/4 + sin²d).
#[test]
fn jerk_of_a_steady_turn_in_a_tilted_frame() {
    let frame = WorkFrame::new(Vector3::zeros(), 0.0, PI / 3.0, 0.0);
    // With g = 1/4 + 3/4·sin²d the slope is 1/(2g); at d = 0: g = 1/4, g′ = 0, g″ = 3/2, so it is 2, its second
    // derivative −g″/(2g²) = −12.
    let mut motion = ToolMotion::at_rest(Pose { position: Point3::origin(), direction: 0.0 });
    motion.direction_velocity = 0.5;
    let given = ToolJerk { linear: Vector3::y(), direction: 0.25 };
    let ToolJerk { linear, direction } = frame.jerk_to_machine(&motion, &given);
    assert!((linear - Vector3::y()).norm() < 1e-15, "{linear}");
    assert!((direction - (2.0 * 0.25 - 12.0 * 0.125)).abs() < 1e-14, "{direction}");
}

prop_compose! {
    fn tilted()(
        translation in prop::array::uniform3(-2.0..2.0),
        roll in -1.0..1.0, pitch in -1.0..1.0, yaw in -PI..PI, flip in any::<bool>(),
    ) -> WorkFrame {
        WorkFrame::new(translation.into(), if flip { roll + PI } else { roll }, pitch, yaw)
    }
}

prop_compose! {
    fn motions()(
        position in prop::array::uniform3(-2.0..2.0), direction in -20.0..20.0,
        velocity in prop::array::uniform3(-1.0..1.0), acceleration in prop::array::uniform3(-1.0..1.0),
        direction_velocity in -1.0..1.0, direction_acceleration in -1.0..1.0,
    ) -> ToolMotion {
        ToolMotion {
            pose: Pose { position: position.into(), direction },
            velocity: velocity.into(),
            acceleration: acceleration.into(),
            direction_velocity,
            direction_acceleration,
        }
    }
}

prop_compose! {
    fn frames()(
        translation in prop::array::uniform3(-2.0..2.0),
        angles in prop::array::uniform3(-PI..PI),
    ) -> WorkFrame {
        WorkFrame::new(translation.into(), angles[0], angles[1], angles[2])
    }
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn to_work_undoes_to_machine(frame in frames(), point in prop::array::uniform3(-2.0..2.0)) {
        let point = Point3::from(point);
        prop_assert!((frame.point_to_work(&frame.point_to_machine(&point)) - point).norm() < 1e-14);
    }

    #[test]
    fn the_direction_is_that_of_the_turned_vector(frame in frames(), direction in -20.0..20.0) {
        let seen = frame.vector_to_machine(&Vector3::new(f64::cos(direction), f64::sin(direction), 0.0));
        prop_assume!(seen.xy().norm() > 1e-3);
        let found = direction_of(&frame, direction);
        let expected = seen.xy().normalize();
        prop_assert!((found.cos() - expected.x).abs() < 1e-11 && (found.sin() - expected.y).abs() < 1e-11);
    }

    /// A whole turn of the tool is a whole turn, this way or that, and no step in between is a jump.
    #[test]
    fn directions_keep_their_turns(roll in -1.4..1.4, pitch in -1.4..1.4, flip in any::<bool>(), start in -20.0..20.0) {
        let roll = if flip { roll + PI } else { roll };
        let frame = WorkFrame::new(Vector3::zeros(), roll, pitch, 0.3);
        let mut last: f64 = direction_of(&frame, start);
        let first = last;
        for step in 1..=2000 {
            let next = direction_of(&frame, start + f64::from(step) * PI / 1000.0);
            prop_assert!((next - last).abs() < 0.2, "{last} {next}");
            last = next;
        }
        let turn = if flip { -2.0 * PI } else { 2.0 * PI };
        prop_assert!((last - first - turn).abs() < 1e-11, "{first} {last}");
    }


    /// Also in frames only turned about z, and in frames that are tilted almost to the edge.
    #[test]
    fn poses_come_back(
        tilt in prop_oneof![Just(0.0), -PI..PI, 1.5..1.57, -1.57..-1.5], about_y in any::<bool>(),
        yaw in -10.0..10.0, motion in motions(),
    ) {
        prop_assume!(tilt.cos().abs() > 1e-4);
        let (roll, pitch) = if about_y { (0.0, tilt) } else { (tilt, 0.0) };
        let frame = WorkFrame::new(Vector3::new(0.5, -0.25, 1.0), roll, pitch, yaw);
        let found = frame.pose_to_work(&frame.pose_to_machine(&motion.pose));
        prop_assert!((found.position - motion.pose.position).norm() < 1e-14);
        prop_assert!((found.direction - motion.pose.direction).abs() < 4e-14 / tilt.cos().abs(), "{found:?}");
    }

    /// Along a path of third degree, velocity, acceleration and jerk in the machine are the derivatives of what comes
    /// before them.
    #[test]
    fn jerk_is_the_derivative_of_the_acceleration(
        frame in tilted(), motion in motions(), jerk in prop::array::uniform3(-1.0..1.0), direction_jerk in -1.0..1.0,
    ) {
        let jerk = Vector3::from(jerk);
        let at = |t: f64| {
            let (half, sixth) = (t * t / 2.0, t * t * t / 6.0);
            frame.motion_to_machine(&ToolMotion {
                pose: Pose {
                    position: motion.pose.position + motion.velocity * t + motion.acceleration * half + jerk * sixth,
                    direction: motion.pose.direction
                        + motion.direction_velocity * t
                        + motion.direction_acceleration * half
                        + direction_jerk * sixth,
                },
                velocity: motion.velocity + motion.acceleration * t + jerk * half,
                acceleration: motion.acceleration + jerk * t,
                direction_velocity: motion.direction_velocity + motion.direction_acceleration * t + direction_jerk * half,
                direction_acceleration: motion.direction_acceleration + direction_jerk * t,
            })
        };
        let given = ToolJerk { linear: jerk, direction: direction_jerk };
        let ToolJerk { linear, direction } = frame.jerk_to_machine(&motion, &given);
        let numbers = |t: f64| {
            let at = at(t);
            let (p, v, a) = (at.pose.position, at.velocity, at.acceleration);
            [
                [p.x, p.y, p.z, at.pose.direction],
                [v.x, v.y, v.z, at.direction_velocity],
                [a.x, a.y, a.z, at.direction_acceleration],
            ]
        };
        let [_, velocity, acceleration] = numbers(0.0);
        let jerk = [linear.x, linear.y, linear.z, direction];
        for (order, found) in [velocity, acceleration, jerk].into_iter().enumerate() {
            let [first, ..] = differences(|t| numbers(t)[order], 4e-3);
            for (found, expected) in found.into_iter().zip(first) {
                let within = if order == 0 { 1e-10 } else { 1e-8 };
                prop_assert!((found - expected).abs() < within * found.abs().max(1.0), "{order}: {found} {expected}");
            }
        }
        // And the second of the one before that.
        let [_, second, _] = differences(|t| numbers(t)[1], 4e-3);
        for (found, expected) in jerk.into_iter().zip(second) {
            prop_assert!((found - expected).abs() < 1e-8 * found.abs().max(1.0), "{found} {expected}");
        }
        let there = frame.motion_to_machine(&motion).pose;
        prop_assert_eq!(there, frame.pose_to_machine(&motion.pose));
    }
}
