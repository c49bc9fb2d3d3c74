//! A machine file: limits of its axes, and its reach.
//!
//! ```text
//! cargo run -p twin-machine --example limits_and_reach -- machines/scara2.toml
//! ```
//!
//! Without an argument it reads `machines/scara2.toml` of the workspace.

use std::error::Error;
use std::path::{Path, PathBuf};
use twin_kinematics::{AxisVector, Kinematics, Pose};
use twin_machine::Machine;

fn main() -> Result<(), Box<dyn Error>> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machines/scara2.toml");
    let given = std::env::args_os().nth(1).map(PathBuf::from);
    let machine = Machine::load(&given.clone().unwrap_or_else(default))?;
    println!("{} ({}), {:.3} kg move", machine.name, machine.kind, machine.moving_mass());
    for axis in &machine.axes {
        let unit = axis.unit();
        let [low, high] = axis.position_limits.map(|limit| axis.from_si(limit));
        println!(
            "{}: {low:.1} to {high:.1} {unit}, {:.1} {unit}/s, {:.1} {unit}/s²",
            axis.name,
            axis.from_si(axis.max_velocity),
            axis.from_si(axis.max_acceleration)
        );
    }

    // Distance along +x up to which the transform has an answer, by bisection.
    let height = machine.rest_height();
    let near = AxisVector::zeros(machine.axes.len());
    let reaches = |x| machine.kinematics.inverse(&Pose::at(x, 0.0, height), &near).is_ok();
    let (mut inside, mut outside) = (machine.start_pose().position.x, 100.0);
    if !reaches(inside) || reaches(outside) {
        println!("its transform has no edge along +x");
        return Ok(());
    }
    while outside - inside > 1e-9 {
        let middle = f64::midpoint(inside, outside);
        *(if reaches(middle) { &mut inside } else { &mut outside }) = middle;
    }
    println!("reach along +x: {:.3} mm", inside * 1e3);
    // Arms of 250 mm and 200 mm.
    if given.is_none() && (inside - 0.45).abs() > 1e-8 {
        return Err(format!("reach of {inside} m instead of 0.45 m").into());
    }
    Ok(())
}
