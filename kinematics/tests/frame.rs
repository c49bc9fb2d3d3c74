use super::{differences, seeded};
use crate::{Pose, ToolMotion, WorkFrame};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Columns of the matrix of SoftMotion vector `trafo-rpy`: roll 0.3, pitch −0.5, yaw 1.1.
const COLUMNS: [[f64; 3]; 3] = [
    [0.398_068_046_304_194_73, 0.782_108_038_218_270_4, 0.479_425_538_604_203],
    [-0.915_668_379_102_278_8, 0.307_070_725_949_722_5, 0.259_343_380_052_230_8],
    [0.055_616_994_019_516_14, -0.542_231_118_453_265_3, 0.838_386_643_594_203_6],
];

fn direction_of(frame: &WorkFrame, direction: f64) -> f64 {
    frame.pose_to_machine(&Pose { position: Point3::origin(), direction }).direction
}

#[test]
fn trafo_rpy() {
    let frame = WorkFrame::new(Vector3::zeros(), 0.3, -0.5, 1.1);
    for (axis, column) in [Vector3::x(), Vector3::y(), Vector3::z()].iter().zip(COLUMNS) {
        assert!((frame.vector_to_machine(axis) - Vector3::from(column)).norm() < 1e-15);
    }
}

/// The manual's call takes the old origin in the new frame, (1, 2, 3): so the work frame stands at −R·(1, 2, 3).
#[test]
fn trafo_coord3d() {
    let old_origin = Vector3::new(1.0, 2.0, 3.0);
    let turned = WorkFrame::new(Vector3::zeros(), 0.3, -0.5, 1.1);
    let frame = WorkFrame::new(-turned.vector_to_machine(&old_origin), 0.3, -0.5, 1.1);
    let found = frame.point_to_work(&Point3::new(10.0, 20.0, 30.0));
    let expected = Point3::new(35.005_607_386, 6.765_032_13, 17.863_146_879);
    assert!((found - expected).norm() < 2e-9, "{found}");
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

    #[test]
    fn rates_of_the_direction_are_its_derivatives(
        roll in -1.0..1.0, pitch in -1.0..1.0, flip in any::<bool>(), direction in -5.0..5.0,
        velocity in -1.0..1.0, acceleration in -1.0..1.0,
    ) {
        let roll = if flip { roll + PI } else { roll };
        let frame = WorkFrame::new(Vector3::zeros(), roll, pitch, -0.7);
        let mut motion = ToolMotion::at_rest(Pose { position: Point3::origin(), direction });
        motion.direction_velocity = velocity;
        motion.direction_acceleration = acceleration;
        let found = frame.motion_to_machine(&motion);
        let at = |t: f64| [direction_of(&frame, direction + velocity * t + acceleration * t * t / 2.0)];
        let ([first], [second]) = differences(at, 2e-3);
        prop_assert!((found.direction_velocity - first).abs() < 1e-10, "{found:?} {first}");
        prop_assert!((found.direction_acceleration - second).abs() < 1e-7, "{found:?} {second}");
    }
}
