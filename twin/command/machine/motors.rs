//! Motors, transmissions and payload of the simulated machine as a table.

use crate::command::show;
use comfy_table::{Cell, CellAlignment};
use std::io::{self, Write};
use twin_machine::{Axis, FeedForward, Machine, SimulatedMotor};
use twin_number::significant;

/// Writes the table of motors and transmissions, and the payload.
pub(super) fn write(out: &mut impl Write, machine: &Machine) -> io::Result<()> {
    let mut table = show::table();
    table.set_header(["axis", "motor", "gives at most", "friction", "inertia", "between"]);
    for axis in &machine.axes {
        let row = [
            axis.name.clone(),
            motor(axis),
            most(axis),
            friction(axis),
            inertia(axis),
            between(axis),
        ];
        table.add_row(row.into_iter().enumerate().map(|(column, text)| {
            let right = (2..5).contains(&column);
            let side = if right { CellAlignment::Right } else { CellAlignment::Left };
            Cell::new(text).set_alignment(side)
        }));
    }
    writeln!(out, "{table}")?;
    match &machine.payload {
        Some(payload) => {
            let [x, y, z] = [payload.center.x, payload.center.y, payload.center.z];
            let [x, y, z] = [x, y, z].map(|value| significant(value * 1e3, 6));
            let mass = significant(payload.mass, 6);
            writeln!(out, "payload: {mass} kg at ({x}, {y}, {z}) mm from the flange")?;
        }
        None => writeln!(out, "payload: none")?,
    }
    for hint in &machine.hints {
        writeln!(out, "warning: {hint}")?;
    }
    Ok(())
}

fn motor(axis: &Axis) -> String {
    match &axis.simulated.motor {
        SimulatedMotor::Servo(servo) => {
            let forward = match servo.effort_feed_forward {
                FeedForward::None => "none",
                FeedForward::Inertia => "inertia",
                FeedForward::Dynamics => "dynamics",
            };
            let bandwidth = significant(axis.simulated.bandwidth_hz, 4);
            format!("servo, {bandwidth} Hz, feed-forward: {forward}")
        }
        SimulatedMotor::Stepper(stepper) => {
            let step = significant(axis.from_si(stepper.full_step), 4);
            format!(
                "step motor, {step} {} per full step, {} microsteps",
                axis.unit(),
                stepper.microsteps
            )
        }
    }
}

/// Up to its largest velocity.
fn most(axis: &Axis) -> String {
    let unit = axis.kind.effort_unit();
    axis.effort_limit()
        .map_or("unlimited".to_owned(), |limit| format!("{} {unit}", significant(limit, 5)))
}

fn friction(axis: &Axis) -> String {
    let unit = axis.kind.effort_unit();
    let (dry, viscous) = (axis.simulated.dry_friction(), axis.simulated.viscous_friction());
    if dry <= 0.0 && viscous <= 0.0 {
        return "–".to_owned();
    }
    let at_most = dry + viscous * axis.max_velocity;
    format!("{} … {} {unit}", significant(dry, 4), significant(at_most, 4))
}

/// Of rotor and gear, at the axis.
fn inertia(axis: &Axis) -> String {
    let unit = match axis.kind {
        twin_machine::axis_kind::AxisKind::Rotary => "kg·m²",
        twin_machine::axis_kind::AxisKind::Linear => "kg",
    };
    if axis.simulated.armature <= 0.0 {
        return "–".to_owned();
    }
    format!("{} {unit}", significant(axis.simulated.armature, 4))
}

fn between(axis: &Axis) -> String {
    let simulated = &axis.simulated;
    let mut parts = Vec::new();
    if let Some(elastic) = simulated.transmission {
        let unit = axis.unit();
        let effort = axis.kind.effort_unit();
        let stiffness = significant(elastic.stiffness * axis.kind.scale(), 4);
        parts.push(format!("gives way, {stiffness} {effort}/{unit}"));
        if elastic.backlash > 0.0 {
            parts.push(format!(
                "backlash {} {unit}",
                significant(axis.from_si(elastic.backlash), 4)
            ));
        }
    }
    if simulated.brake.is_some() {
        parts.push("brake".to_owned());
    }
    if parts.is_empty() { "rigid".to_owned() } else { parts.join(", ") }
}
