//! Following error of a servo axis without feed-forward: v/Kv at constant velocity.
//!
//! ```text
//! cargo run -p twin-physics --example following_error
//! ```

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use std::error::Error;
use twin_kinematics::{AxisMotion, AxisVector};
use twin_physics::{AxisDriveParameters, EffortFeedForward, PhysicsMachine, ServoParameters};
use twin_urdf::{Inertial, Joint, JointDrive, JointKind, Link, Model, Tip};

/// Mass of the slide, kg.
const MASS: f64 = 10.0;
/// Velocity of the set-point, m/s.
const VELOCITY: f64 = 0.1;
/// Gain of the position loop, 1/s.
const KV: f64 = 50.0;
/// One cycle, ns and s.
const CYCLE_NS: i64 = 1_000_000;
const CYCLE: f64 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let model = slide();
    let servo = ServoParameters {
        position_gain: KV,
        velocity_feed_forward: 0.0,
        effort_feed_forward: EffortFeedForward::None,
        ..ServoParameters::tuned(MASS, 50.0, f64::INFINITY)
    };
    let drives = [AxisDriveParameters::servo(servo)];
    let start = AxisVector::zeros(1);
    let mut machine =
        PhysicsMachine::new(&model, &drives, Vector3::new(0.0, 0.0, -9.81), &start, CYCLE_NS)?;
    let mut error = 0.0;
    for cycle in 1_u32..=1000 {
        let time = f64::from(cycle) * CYCLE;
        let setpoint = AxisMotion {
            position: AxisVector::from_values([VELOCITY * time]),
            velocity: AxisVector::from_values([VELOCITY]),
            acceleration: AxisVector::zeros(1),
        };
        let state = machine.step(&setpoint)?;
        error = setpoint.position.iter().zip(&*state.position).map(|(to, at)| to - at).sum();
        if cycle.is_multiple_of(200) {
            println!("{time:.1} s: following error {:.4} mm", error * 1e3);
        }
    }
    let expected = VELOCITY / KV;
    println!("v/Kv = {:.4} mm", expected * 1e3);
    if (error - expected).abs() > 1e-6 {
        return Err(format!("{error} m instead of {expected} m").into());
    }
    Ok(())
}

/// A mass on a horizontal slide along x.
fn slide() -> Model {
    let inertia = Matrix3::identity() * 0.1;
    let body = Inertial { mass: MASS, center: Point3::origin(), inertia };
    let drive = JointDrive::Axis(0);
    let origin = Isometry3::identity();
    Model {
        name: "slide".to_owned(),
        links: vec![
            Link::new("base", None, Vec::new()),
            Link::new("slide", Some(body), Vec::new()),
        ],
        joints: vec![Joint::new(
            "X",
            JointKind::Prismatic,
            [0, 1],
            origin,
            Vector3::x_axis(),
            drive,
        )],
        loops: Vec::new(),
        tip: Tip { link: 1, point: Point3::origin() },
    }
}
