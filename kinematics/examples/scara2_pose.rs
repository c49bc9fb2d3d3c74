//! Pose of a SCARA with two arms: axis positions and axis velocities for a tool on a straight line.
//!
//! ```text
//! cargo run -p twin-kinematics --example scara2_pose
//! ```

use nalgebra::Vector3;
use std::error::Error;
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::{AxisVector, Kinematics, Pose, ToolMotion};

/// Lengths of the arms, m.
const ARMS: [f64; 2] = [0.3, 0.4];
/// Speed of the tool along y, m/s.
const SPEED: f64 = 0.1;

fn main() -> Result<(), Box<dyn Error>> {
    let scara = Scara2::new(ARMS, [0.0, 0.0], Elbow::Low)?;
    let [inner, outer] = scara.reach().map(|length| length * 1e3);
    println!("reach: {inner:.3} mm to {outer:.3} mm");
    close("inner edge, mm", inner, 100.0)?;
    close("outer edge, mm", outer, 700.0)?;

    // Arms and the line from the base to the tool make a right triangle of 300, 400 and 500 mm.
    let pose = Pose::at(0.3, 0.4, 0.0);
    let tool = ToolMotion { velocity: Vector3::new(0.0, SPEED, 0.0), ..ToolMotion::at_rest(pose) };
    let axes = scara.inverse_motion(&tool, &AxisVector::zeros(2))?;
    let [a, b] = *axes.position else { return Err("two axes expected".into()) };
    let [a_rate, b_rate] = *axes.velocity else { return Err("two axes expected".into()) };
    println!("tool at (300, 400) mm: A {:.3} degrees, B {:.3} degrees", degrees(a), degrees(b));
    let rates = [a_rate, b_rate].map(degrees);
    println!("tool at 100 mm/s along y: A {:.3} degrees/s, B {:.3} degrees/s", rates[0], rates[1]);
    close("A, rad", a, 0.0)?;
    close("B, rad", b, std::f64::consts::FRAC_PI_2)?;
    // The second arm points along y. It turns against the first, so that the tool keeps its x:
    // y' = L1 A' and x' = -L2 (A' + B') = 0.
    close("rate of A, rad/s", a_rate, SPEED / ARMS[0])?;
    close("rate of B, rad/s", b_rate, -SPEED / ARMS[0])?;

    let back = scara.forward(&axes.position)?;
    close("distance of the forward transform, m", (back.position - pose.position).norm(), 0.0)?;

    // Out of reach is an error with target and reach; the transform clamps nothing.
    let Err(error) = scara.inverse(&Pose::at(0.8, 0.0, 0.0), &axes.position) else {
        return Err("800 mm is out of reach, but the transform gives axes".into());
    };
    println!("tool at (800, 0) mm: {error}");
    Ok(())
}

/// Degrees for the terminal, without a sign on 0.
fn degrees(angle: f64) -> f64 {
    (angle.to_degrees() * 1e9).round() / 1e9 + 0.0
}

fn close(what: &str, actual: f64, expected: f64) -> Result<(), String> {
    if (actual - expected).abs() <= 1e-9 {
        return Ok(());
    }
    Err(format!("{what}: {actual} instead of {expected}"))
}
