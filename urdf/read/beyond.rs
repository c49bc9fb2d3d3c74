//! Reader of the `<twin>` element: axis couplings, passive joints and loops, which URDF itself cannot express; see
//! `write`.

use super::document::{At, Beyond, Places};
use crate::{JointDrive, JointKind, Loop, Model, Part, UrdfError};
use nalgebra::Point3;

/// Adds it to `model`.
pub(super) fn add(model: &mut Model, places: &Places) -> At<()> {
    for (line, beyond) in &places.beyond {
        say(model, beyond).map_err(|error| (*line, error))?;
    }
    Ok(())
}

fn say(model: &mut Model, beyond: &Beyond) -> Result<(), UrdfError> {
    match beyond {
        Beyond::Axis { joint, axis } => drive(model, joint, JointDrive::Axis(*axis)),
        Beyond::Combination { joint, parts } => {
            if !parts.iter().all(|(_, factor)| factor.is_finite()) {
                let part = Part::Joint(joint.clone());
                return Err(UrdfError::NotFinite { part, what: "a factor" });
            }
            drive(model, joint, JointDrive::Combination(parts.clone()))
        }
        Beyond::Passive { joint, rest } => {
            if !rest.is_finite() {
                let part = Part::Joint(joint.clone());
                return Err(UrdfError::NotFinite { part, what: "its rest" });
            }
            drive(model, joint, JointDrive::Passive { rest: *rest })
        }
        Beyond::Loop { links, points } => {
            let [one, other] = links.each_ref().map(|name| {
                let found = model.links.iter().position(|link| link.name == *name);
                found.ok_or_else(|| UrdfError::NoLoopLink(name.clone()))
            });
            let [point, other_point] = points.as_slice() else {
                return Err(UrdfError::LoopPoints(points.len()));
            };
            if !point.iter().chain(other_point).all(|value| value.is_finite()) {
                let [link, _] = links;
                let part = Part::Link(link.clone());
                return Err(UrdfError::NotFinite { part, what: "a point of a loop" });
            }
            let points = [Point3::from(*point), Point3::from(*other_point)];
            model.loops.push(Loop { links: [one?, other?], points });
            Ok(())
        }
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
