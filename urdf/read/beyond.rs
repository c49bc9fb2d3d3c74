//! Reader of the `<twin>` element: axis couplings, passive joints and loops, which URDF itself cannot express; see
//! `write`.

use super::document::{At, Element};
use crate::check::check_finite;
use crate::{JointDrive, JointKind, Loop, Model, Part, UrdfError};

/// Adds it to `model`.
pub(super) fn add(model: &mut Model, robot: Element<'_>) -> At<()> {
    for element in robot.children("twin").flat_map(Element::all) {
        say(model, element).map_err(|error| (element.line(), error))?;
    }
    Ok(())
}

fn say(model: &mut Model, element: Element<'_>) -> Result<(), UrdfError> {
    let joint = element.text("joint").unwrap_or_default();
    let part = Part::Joint(joint.to_owned());
    let index = |element: Element<'_>| element.text("axis")?.parse().ok();
    match element.tag() {
        "drive" => {
            if let Some(axis) = index(element) {
                return drive(model, joint, JointDrive::Axis(axis));
            }
            let part_of = |part: Element<'_>| Some((index(part)?, part.number("factor")?));
            let parts: Vec<_> = element.children("part").filter_map(part_of).collect();
            check_finite(&part, "a factor", parts.iter().map(|(_, factor)| factor))?;
            drive(model, joint, JointDrive::Combination(parts))
        }
        "passive" => {
            let rest = element.number("rest").unwrap_or_default();
            check_finite(&part, "its rest", [&rest])?;
            drive(model, joint, JointDrive::Passive { rest })
        }
        "loop" => {
            let names = ["from", "to"].map(|end| element.text(end).unwrap_or_default());
            let [one, other] = names.map(|name| {
                let found = model.links.iter().position(|link| link.name == name);
                found.ok_or_else(|| UrdfError::NoLoopLink(name.to_owned()))
            });
            let points: Vec<[f64; 3]> =
                element.children("point").filter_map(|point| point.numbers("xyz")).collect();
            let [point, other_point] = points.as_slice() else {
                return Err(UrdfError::LoopPoints(points.len()));
            };
            let link = Part::Link(names[0].to_owned());
            check_finite(&link, "a point of a loop", point.iter().chain(other_point))?;
            let points = [*point, *other_point].map(Into::into);
            model.loops.push(Loop { links: [one?, other?], points });
            Ok(())
        }
        _ => Ok(()),
    }
}

fn drive(model: &mut Model, name: &str, drive: JointDrive) -> Result<(), UrdfError> {
    let refuse = || UrdfError::NoDrivenJoint(name.to_owned());
    let joint = model.joints.iter_mut().find(|joint| joint.name == name).ok_or_else(refuse)?;
    if joint.kind == JointKind::Fixed || matches!(joint.drive, JointDrive::Mimic { .. }) {
        return Err(refuse());
    }
    joint.drive = drive;
    Ok(())
}
