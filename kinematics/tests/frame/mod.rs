//! Tests of work frames: poses, motions and jerks in both directions.

mod cuboid;
mod unit_vectors;

use crate::tests::{differences, seeded};
use crate::{Pose, ToolJerk, ToolMotion, WorkFrame};
use nalgebra::{Point3, UnitQuaternion, Vector3, Vector4};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// At the origin.
fn towards(direction: f64) -> Pose {
    Pose { position: Point3::origin(), direction }
}

fn direction_of(frame: &WorkFrame, direction: f64) -> f64 {
    frame.pose_to_machine(&towards(direction)).direction
}

/// Place, velocity and acceleration, each as x, y, z and direction.
fn rows(motion: &ToolMotion) -> [Vector4<f64>; 3] {
    [
        motion.pose.position.coords.push(motion.pose.direction),
        motion.velocity.push(motion.direction_velocity),
        motion.acceleration.push(motion.direction_acceleration),
    ]
}

fn motion_of([place, velocity, acceleration]: [Vector4<f64>; 3]) -> ToolMotion {
    ToolMotion {
        pose: Pose { position: place.xyz().into(), direction: place.w },
        velocity: velocity.xyz(),
        acceleration: acceleration.xyz(),
        direction_velocity: velocity.w,
        direction_acceleration: acceleration.w,
    }
}

fn turned(roll: f64, pitch: f64, yaw: f64) -> WorkFrame {
    WorkFrame::new(Vector3::zeros(), roll, pitch, yaw)
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
    let motion = [[1.0, 2.0, 3.0, 7.0], [1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, -0.25]];
    let found = frame.motion_to_machine(&motion_of(motion.map(Vector4::from)));
    assert!((found.pose.position - Point3::new(8.0, 21.0, 33.0)).norm() < 1e-14, "{found:?}");
    assert!((found.velocity - Vector3::y()).norm() < 1e-15, "{found:?}");
    assert!((found.acceleration + Vector3::x()).norm() < 1e-15, "{found:?}");
    assert!((found.pose.direction - (7.0 + FRAC_PI_2)).abs() < 1e-15, "{found:?}");
    assert_eq!((found.direction_velocity, found.direction_acceleration), (0.5, -0.25));
}

/// Turned over about x, then by the yaw, North goes to the other side; tilted by 60° about y, East looks half as long.
#[test]
fn directions_are_seen_from_above() {
    let (over, tilted) = (turned(PI, 0.0, 0.4), turned(0.0, PI / 3.0, 0.0));
    let reversed = [0.0, 1.0, -2.0, 5.0].map(|direction| (&over, direction, 0.4 - direction));
    let shown = [(&tilted, PI / 4.0, 1_f64.atan2(0.5)), (&tilted, 0.0, 0.0)];
    for (frame, direction, expected) in reversed.into_iter().chain(shown) {
        let found = direction_of(frame, direction);
        assert!((found - expected).abs() < 1e-15, "{direction} in {frame:?}: {found}");
    }
}

#[test]
fn a_direction_straight_down_keeps_the_turn() {
    let motion = ToolMotion { direction_velocity: 1.0, ..ToolMotion::at_rest(towards(0.0)) };
    let found = turned(0.0, FRAC_PI_2, 0.0).motion_to_machine(&motion);
    assert!(found.is_finite() && found.pose.direction.abs() <= PI, "{found:?}");
}

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
                let [found, expected] = [&found, &expected].map(|it| direction_of(it, direction));
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
        let frame = turned(roll, pitch, 0.4);
        let [seen, further] = [9.0, 9.5].map(|at| frame.pose_to_work(&towards(at)).direction);
        assert!(((further - seen).abs() - 0.5).abs() < 1e-14, "{seen} {further}");
        assert!((seen.abs() - 9.0).abs() < 2.0 * PI, "{seen}");
    }
}

/// At a point of a frame tilted by 60° about y where all is known: seen (cos d/2, sin d), slope (1/2)/(cos²d/4 + sin²d).
#[test]
fn jerk_of_a_steady_turn_in_a_tilted_frame() {
    let frame = turned(0.0, PI / 3.0, 0.0);
    // With g = 1/4 + 3/4·sin²d the slope is 1/(2g); at d = 0: g = 1/4, g′ = 0, g″ = 3/2, so it is 2, its second
    // derivative −g″/(2g²) = −12.
    let motion = ToolMotion { direction_velocity: 0.5, ..ToolMotion::at_rest(towards(0.0)) };
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
        place in [-2.0..2.0, -2.0..2.0, -2.0..2.0, -20.0..20.0],
        velocity in prop::array::uniform4(-1.0..1.0), acceleration in prop::array::uniform4(-1.0..1.0),
    ) -> ToolMotion {
        motion_of([place, velocity, acceleration].map(Vector4::from))
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
        let frame = turned(roll, pitch, 0.3);
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

    /// Along a path of third degree each of velocity, acceleration and jerk is the derivative of the one before.
    #[test]
    fn jerk_is_the_derivative_of_the_acceleration(
        frame in tilted(), motion in motions(), jerk in prop::array::uniform3(-1.0..1.0), direction_jerk in -1.0..1.0,
    ) {
        let given = ToolJerk { linear: jerk.into(), direction: direction_jerk };
        let ToolJerk { linear, direction } = frame.jerk_to_machine(&motion, &given);
        let ([p, v, a], j) = (rows(&motion), given.linear.push(direction_jerk));
        let at = |t: f64| {
            let (half, sixth) = (t * t / 2.0, t * t * t / 6.0);
            let moved = [p + v * t + a * half + j * sixth, v + a * t + j * half, a + j * t];
            rows(&frame.motion_to_machine(&motion_of(moved)))
        };
        let [_, velocity, acceleration] = at(0.0);
        let jerk = linear.push(direction);
        for (order, found) in [velocity, acceleration, jerk].into_iter().enumerate() {
            let [first, ..] = differences(|t| <[f64; 4]>::from(at(t)[order]), 4e-3);
            for (found, expected) in found.iter().zip(first) {
                let within = if order == 0 { 1e-10 } else { 1e-8 };
                prop_assert!((found - expected).abs() < within * found.abs().max(1.0), "{order}: {found} {expected}");
            }
        }
        // And the second of the one before that.
        let [_, second, _] = differences(|t| <[f64; 4]>::from(at(t)[1]), 4e-3);
        for (found, expected) in jerk.iter().zip(second) {
            prop_assert!((found - expected).abs() < 1e-8 * found.abs().max(1.0), "{found} {expected}");
        }
        let there = frame.motion_to_machine(&motion).pose;
        prop_assert_eq!(there, frame.pose_to_machine(&motion.pose));
    }
}
