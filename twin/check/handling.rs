//! Findings about loose bodies and grippers: parts that are moved, lost or dropped, clamps that give way, missed grips.

use crate::finding::{Finding, Rule};
use crate::plant::BodyHappening;
use twin_machine::Machine;
use twin_number::{apart, seconds};
use twin_physics::{BodyEventKind, Gripper, LossCause, Part};

/// Finding about an event of a body or a gripper; `None` if it went as meant.
pub(super) fn finding(machine: &Machine, happening: &BodyHappening) -> Option<Finding> {
    let BodyHappening { place, time_ns, kind, distance } = *happening;
    let around = &machine.collision.as_ref()?.surroundings;
    let part = |body| machine.part_name(Part::Body(body));
    let at = format!("at {:.3} s in the simulated machine", seconds(time_ns));
    let error = |rule, message: String, hint: &str| Finding {
        hint: Some(hint.to_owned()),
        ..Finding::error(rule, place, message)
    };
    Some(match kind {
        BodyEventKind::Gripped { .. } | BodyEventKind::Released { .. } => return None,
        BodyEventKind::Moved { body, by } => error(
            Rule::PartMoved,
            format!("{} pushed {} from its place {at}", machine.part_name(by), part(body)),
            "lift the tool over the part, or hold the part with a clamp (clamp_n)",
        ),
        BodyEventKind::Dropped { body } => error(
            Rule::Dropped,
            format!("{} fell below everything that could carry it, {at}", part(body)),
            "put the part down on something, or move what carries it",
        ),
        BodyEventKind::ClampGaveWay { body, force } => {
            let limit = around.bodies.get(body)?.clamp?;
            let [force_text, limit_text] = apart(force, limit);
            let message = format!(
                "the clamp of {} gave way {at}: {force_text} N is above its {limit_text} N",
                part(body)
            );
            error(
                Rule::ClampOverloaded,
                message,
                "go slower there, or take a clamp that holds more",
            )
            .with_value(force, limit, "N")
        }
        BodyEventKind::Lost { gripper, body, cause, load } => {
            let gripper = around.grippers.get(gripper)?;
            let (value, limit, unit) = load_of(gripper, load);
            let [value_text, limit_text] = apart(value, limit);
            let (why, hint) = match cause {
                LossCause::Acceleration => (
                    "its weight and acceleration",
                    "accelerate less there, or take a gripper that holds more; the drives add to the acceleration of the plan",
                ),
                LossCause::Collision => (
                    "it touched something",
                    "keep the part clear of what it touches, or go slower there",
                ),
            };
            let message = format!(
                "gripper {} lost {} {at} ({why}): {value_text} {unit} is above its {limit_text} {unit}",
                gripper.name,
                part(body)
            );
            error(Rule::PartLost, message, hint).with_value(value, limit, unit)
        }
        BodyEventKind::Missed { gripper } => {
            let gripper = around.grippers.get(gripper)?;
            let reach = gripper.reach * 1e3;
            let hint = "correct the position of the line or of the part, or let the gripper reach farther (reach_mm)";
            // Another gripper, or a clamp, may hold what is in its reach.
            let distance = distance.map(|distance| distance * 1e3).filter(|value| *value > reach);
            let Some(distance) = distance else {
                let message = format!("gripper {} closed {at} on no free part", gripper.name);
                return Some(error(Rule::GripMissed, message, hint));
            };
            let [is, most] = apart(distance, reach);
            let message = format!(
                "gripper {} closed {at} on no part: the nearest is {is} mm away, its reach is {most} mm",
                gripper.name
            );
            error(Rule::GripMissed, message, hint).with_value(distance, reach, "mm")
        }
    })
}

/// The load that is above its limit most: value, limit and unit.
fn load_of(gripper: &Gripper, [force, moment]: [f64; 2]) -> (f64, f64, &'static str) {
    if moment / gripper.moment > force / gripper.force {
        (moment, gripper.moment, "Nm")
    } else {
        (force, gripper.force, "N")
    }
}
