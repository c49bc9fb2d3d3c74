//! Tests of the reference SCARA against pinocchio 4.1 (articulated-body algorithm, RK4 with 100 µs).
//!
//! Halving that step moves pinocchio's tip by 3e-15 m. `scara_*.csv` has rows of its two runs, copied as facts.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use twin_kinematics::Transform;
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::transform::Motion;

use super::*;

/// Two revolute axes about +z, 0.4 m and 0.3 m apart, and a slide along +z; masses of uniform boxes.
pub(super) fn scara() -> Model {
    chain([
        (
            JointKind::Revolute,
            Vector3::z(),
            Isometry3::identity(),
            Some(uniform_box(8.0, [0.2, 0.0, 0.0], [0.4, 0.1, 0.08])),
        ),
        (
            JointKind::Revolute,
            Vector3::z(),
            Isometry3::translation(0.4, 0.0, 0.0),
            Some(uniform_box(4.0, [0.15, 0.0, 0.0], [0.3, 0.08, 0.06])),
        ),
        (
            JointKind::Prismatic,
            Vector3::z(),
            Isometry3::translation(0.3, 0.0, 0.0),
            Some(uniform_box(2.0, [0.0, 0.0, -0.02], [0.04, 0.04, 0.2])),
        ),
    ])
}

fn transform() -> Scara2 {
    Scara2::new([0.4, 0.3], [0.0; 2], Elbow::Low).unwrap()
}

/// Joint motion on a circle of 0.1 m about (0.45, 0) at 0.5 m/s, z = 0.02·sin(2πt).
pub(super) fn circle(t: f64) -> [JointVector; 3] {
    let ((sin, cos), (up, along)) = ((5.0 * t).sin_cos(), (TAU * t).sin_cos());
    let tool = Motion {
        position: Vector2::new(0.45 + 0.1 * cos, 0.1 * sin),
        velocity: Vector2::new(-0.5 * sin, 0.5 * cos),
        acceleration: Vector2::new(-2.5 * cos, -2.5 * sin),
    };
    let arms = transform().axis_motion(&tool, &Vector2::zeros()).unwrap();
    [
        (arms.position, 0.02 * up),
        (arms.velocity, 0.02 * TAU * along),
        (arms.acceleration, -0.02 * TAU * TAU * up),
    ]
    .map(|(arms, z)| joints([arms.x, arms.y, z]))
}

pub(super) fn tip(q: &JointVector) -> Vector3<f64> {
    transform().to_tool(&q.fixed_rows::<2>(0).into()).unwrap().push(q[2] - 0.12)
}

/// Rows of a file next to this one.
fn rows<const N: usize>(text: &str) -> Vec<[f64; N]> {
    let mut file = csv::Reader::from_reader(text.as_bytes());
    let row = |row: csv::StringRecord| std::array::from_fn(|column| row[column].parse().unwrap());
    file.records().map(|record| row(record.unwrap())).collect()
}

/// Cycle, `tau_ff` of that cycle: inverse dynamics half a cycle ahead.
pub(super) fn feed_forwards() -> Vec<[f64; 4]> {
    rows(include_str!("scara_feed_forward.csv"))
}

/// Cycle, q, v without torque and gravity from q = (0, 1, 0), v = (3, −2, 0).
pub(super) fn free_motion() -> Vec<[f64; 5]> {
    rows(include_str!("scara_free.csv"))
}

/// `tau_ff` of cycle `k`.
fn feed_forward(dynamics: &mut Dynamics, cycle: f64) -> JointVector {
    let [q, v, a] = circle((cycle + 0.5) * 1e-3);
    dynamics.inverse_dynamics(&q, &v, &a)
}

#[test]
fn inverse_dynamics_is_pinocchios() {
    let mut dynamics = Dynamics::new(&scara(), 3, down(), JointVector::zeros()).unwrap();
    for [cycle, expected @ ..] in feed_forwards() {
        let effort = feed_forward(&mut dynamics, cycle);
        let error = (effort - joints(expected)).amax();
        assert!(error < 1e-13, "cycle {cycle}: {effort} is not {expected:?}");
    }
}

/// Under the controller of the reference (held over each cycle) the machine does what pinocchio's does: within a
/// picometre after 5 s.
#[test]
fn the_closed_loop_is_pinocchios() {
    let mut dynamics = Dynamics::new(&scara(), 3, down(), JointVector::zeros()).unwrap();
    let mut machine = moving(&scara(), &[SLACK; 3], down(), &motion_at(0.0));

    let w = TAU * 15.0;
    let kp = joints([2.0, 0.3, 2.0]) * (w * w);
    let kd = joints([2.0, 0.3, 2.0]) * (2.0 * w);
    let mut rows = rows::<7>(include_str!("scara_circle.csv")).into_iter().peekable();
    let mut worst = 0.0_f64;
    for cycle in (0..5000).map(f64::from) {
        let [q, v, _] = circle(cycle * 1e-3);
        let JointState { position, velocity } = machine.joints.axes;
        let effort = feed_forward(&mut dynamics, cycle)
            + kp.component_mul(&(q - position))
            + kd.component_mul(&(v - velocity));
        machine.step_with_efforts(&axis_vector(&effort, 3)).unwrap();
        let JointState { position, velocity } = machine.joints.axes;
        if let Some([_, a, b, z, v @ ..]) = rows.next_if(|[at, ..]| *at <= cycle + 1.0) {
            worst = worst.max((tip(&position) - tip(&joints([a, b, z]))).norm());
            assert!((velocity - joints(v)).amax() < 1e-10, "cycle {cycle}");
        }
    }
    assert_eq!(rows.next(), None);
    assert!(worst < 1e-12, "the tip is {worst} m off");
    // It went somewhere: the circle is 5 / (2π/5) ≈ 4 turns.
    assert!((tip(&machine.joints.axes.position) - tip(&circle(0.0)[0])).norm() > 0.005);
}

/// The circle for drives.
pub(super) fn motion_at(t: f64) -> AxisMotion {
    let [position, velocity, acceleration] = circle(t).map(|values| axis_vector(&values, 3));
    AxisMotion { position, velocity, acceleration }
}

/// The largest distance of the tip from the circle, m, of drives with `limits` (N or Nm) that `servo` makes of the inertia of
/// an axis at the start, between 0.5 s and 2 s.
fn off_the_circle(limits: [f64; 3], servo: impl Fn(f64, f64) -> ServoParameters) -> f64 {
    let (model, start) = (scara(), motion_at(0.0));
    let inertia = axis_inertia(&model, &start.position).unwrap();
    let drives =
        [0, 1, 2].map(|axis| AxisDriveParameters::servo(servo(inertia[axis], limits[axis])));
    let mut machine = moving(&model, &drives, down(), &start);
    machine.setpoint.acceleration = start.acceleration;
    let mut worst = 0.0_f64;
    for cycle in 1..=2000 {
        let set = motion_at(f64::from(cycle) * 1e-3);
        let state = machine.step(&set).unwrap();
        assert!(state.effort.iter().zip(limits).all(|(effort, limit)| effort.abs() <= limit));
        assert_eq!(state.saturated, [false; MAX_AXES]);
        if cycle > 500 {
            let [found, set] = [&state.position, &set.position]
                .map(|axes| tip(&joint_vector(axes.iter().copied())));
            worst = worst.max((found - set).norm());
        }
    }
    worst
}

/// The drives themselves, tuned by rule for one pose, keep the tip near the circle. Coupling of the arms is a disturbance to
/// drives that know one inertia each: not zero, but small.
#[test]
fn the_drives_follow_the_circle() {
    let tuned = |inertia, limit| {
        ServoParameters::tuned(inertia, ServoParameters::DEFAULT_BANDWIDTH_HZ, limit)
    };
    let worst = off_the_circle([60.0, 30.0, 80.0], tuned);
    assert!(worst < 1e-3, "{worst} m");
    assert!(worst > 1e-7, "no real drive is that good: {worst} m");
}

/// Fed forward the machine's own dynamics, the drives have little left to do.
#[test]
fn dynamic_feed_forward_leaves_micrometres() {
    let worst = off_the_circle([100.0; 3], |inertia, limit| ServoParameters {
        effort_feed_forward: EffortFeedForward::Dynamics(1.0),
        ..ServoParameters::tuned(inertia, 50.0, limit)
    });
    assert!(worst < 0.1e-6, "{worst} m");
}
