//! A SCARA generated from its dimensions, written as URDF and read back, and compared with its transform.
//!
//! ```text
//! cargo run -p twin-urdf --example scara
//! ```

use nalgebra::Vector3;
use std::error::Error;
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::{AxisVector, Kinematics};
use twin_urdf::{MachineJoint, Model, ScaraDimensions};

/// Lengths of the arms, m.
const ARMS: [f64; 2] = [0.25, 0.2];
/// Flange to tool tip, m.
const TOOL: f64 = 0.06;

fn main() -> Result<(), Box<dyn Error>> {
    let half_turn = std::f64::consts::PI;
    let arm = |name: &str, axis| MachineJoint::new(name, axis, [-half_turn, half_turn]);
    let quill = MachineJoint::new("Z", 2, [0.0, 0.1]);
    let dimensions = ScaraDimensions {
        tool: Vector3::new(0.0, 0.0, -TOOL),
        ..ScaraDimensions::new("scara", [arm("A", 0), arm("B", 1)], Some(quill), ARMS)
    };
    let model = dimensions.model()?;
    let text = model.to_urdf()?;
    let read = Model::from_urdf(&text, &["A", "B", "Z"])?;
    println!("{}: {} links, {} joints", read.name, read.links.len(), read.joints.len());

    let scara = Scara2::new(ARMS, [0.0, 0.0], Elbow::Low)?;
    for [a, b, z] in [[0.0, 0.0, 0.0], [30.0, 60.0, 20.0], [-90.0, 45.0, 100.0]] {
        let [first, second, height] = [f64::to_radians(a), f64::to_radians(b), z * 1e-3];
        let tip = read.tip_position(&[first, second, height]);
        let [tip_x, tip_y, tip_z] = [tip.x, tip.y, tip.z].map(|at| at * 1e3);
        println!("A {a}°, B {b}°, Z {z} mm: tip at ({tip_x:.3}, {tip_y:.3}, {tip_z:.3}) mm");
        // The transform knows x and y of the same point; z is that of the flange less the tool.
        let pose = scara.forward(&AxisVector::from_values([first, second]))?;
        let expected = Vector3::new(pose.position.x, pose.position.y, height - TOOL);
        if (tip.coords - expected).norm() > 1e-9 {
            return Err(format!("tip at {tip} m instead of {expected} m").into());
        }
    }
    Ok(())
}
