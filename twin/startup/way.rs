//! Check of the way to the start of a program, and the commands that move the axes by hand where none is clear.

use super::{Check, Verdict, home_by_hand};
use crate::approach::{Approach, ApproachError};
use crate::repair_commands;
use twin_gcode::rs274::Tool;
use twin_kinematics::AxisVector;
use twin_machine::Machine;
use twin_number::fixed;

/// Part of its largest velocity at which an axis is moved by hand.
const BY_HAND: f64 = 0.05;

/// The way of the drives from `from` to the `start` of the program (m or rad), at no more than `factor` times the largest
/// velocity of each axis, with `tool` of a tool table in the spindle.
///
/// # Errors
/// A failed check, with what can be done: commands for `real` drives, keys of the machine file.
pub fn plan_way(
    machine: &Machine,
    tool: Option<&Tool>,
    [from, start]: [&AxisVector; 2],
    factor: f64,
    real: bool,
) -> Result<Approach, Check> {
    Approach::plan(machine, tool, [from, start], factor).map_err(|error| {
        let inside = matches!(error, ApproachError::Inside { .. });
        let mut help = Vec::new();
        if real {
            help.push(if inside {
                "free it by hand; these go by 10 mm or 10°, with a minus sign back:".to_owned()
            } else {
                "move the axes there by hand, in an order that is clear:".to_owned()
            });
            let moves = (0..machine.axes.len()).rev();
            help.extend(moves.filter_map(|axis| {
                let to = if inside { None } else { start.get(axis).copied() };
                repair_commands::move_by_hand(machine, axis, to, BY_HAND)
            }));
        } else {
            help.push("emulated drives are switched on with every axis at 0".to_owned());
        }
        if !inside {
            let file = machine.path.display();
            help.push(format!("or change `approach` or `safe_z_mm` of [program] in {file}"));
        }
        let message = format!("no way to the start of the program is clear: {error}");
        Check { verdict: Verdict::Failed, message, help }
    })
}

/// The way in words: duration, least clearance, and a line for each of its steps.
pub fn describe_way(machine: &Machine, way: &Approach) -> Check {
    let duration = fixed(way.duration(), 1);
    let message = format!("way to the start: {duration} s, {}", clearance(machine, way));
    Check { verdict: Verdict::Passed, message, help: way.described(machine).collect() }
}

fn clearance(machine: &Machine, way: &Approach) -> String {
    let Some(([part, other], distance)) = way.nearest_names(machine) else {
        let file = machine.path.display();
        return format!("not checked for collisions, as {file} has no [[obstacles]]");
    };
    let distance = fixed(distance.max(0.0) * 1e3, 1);
    format!("least clearance {distance} mm, between {part} and {other}")
}

/// The way of the axes `to_home` to their zeros, one after the other, from where they are counted to be (m or rad); `axes` is
/// then where they will be. It can only be checked where the counters say something: a device whose axes all count 0 has
/// perhaps just been switched on. `tool` of a tool table is in the spindle.
pub fn homing_way(
    machine: &Machine,
    tool: Option<&Tool>,
    axes: &mut AxisVector,
    to_home: &[usize],
) -> Check {
    let names = to_home.iter().filter_map(|index| machine.axes.get(*index));
    let names: Vec<_> = names.map(|axis| axis.name.as_str()).collect();
    let names = names.join(", ");
    let from = *axes;
    for index in to_home {
        if let Some(position) = axes.get_mut(*index) {
            *position = 0.0;
        }
    }
    if from.iter().all(|position| *position == 0.0) {
        let message = format!(
            "homing {names}: the positions of the axes are not known before; check that their paths are free"
        );
        return Check { verdict: Verdict::Note, message, help: Vec::new() };
    }
    match Approach::homing(machine, tool, &from, to_home) {
        Ok(way) => {
            let clearance = clearance(machine, &way);
            let message = format!("homing {names}, if the axes are where they count: {clearance}");
            Check { verdict: Verdict::Note, message, help: Vec::new() }
        }
        Err(error) => {
            let axes = to_home.iter().filter_map(|index| machine.axes.get(*index));
            let by_hand = axes.filter_map(|axis| home_by_hand(machine, axis));
            let help = std::iter::once("if its way is free, home it by hand:".to_owned());
            let message = format!("homing {names}: {error}");
            Check { verdict: Verdict::Failed, message, help: help.chain(by_hand).collect() }
        }
    }
}
