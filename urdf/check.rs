//! Validation of a model: names, order, finite numbers, positive masses and measures.

use crate::{
    Inertial, Joint, Model, Part, SafetyController, Solid, SolidShape, TIP_NAME, UrdfError,
};
use nalgebra::{Isometry3, Vector3};
use std::collections::HashSet;

impl Model {
    /// That links and joints are in the order that [`Model`] promises and have names of their own.
    pub(crate) fn check_tree(&self) -> Result<(), UrdfError> {
        if self.links.len() != self.joints.len() + 1 {
            return Err(UrdfError::Count { links: self.links.len(), joints: self.joints.len() });
        }
        for (index, joint) in self.joints.iter().enumerate() {
            if joint.child != index + 1 || joint.parent > index {
                return Err(UrdfError::Order(joint.name.clone()));
            }
            if self.following(index).is_none() {
                return Err(UrdfError::MimicCircle(joint.name.clone()));
            }
        }
        if self.tip.link >= self.links.len() {
            return Err(UrdfError::NoTip);
        }
        check_names(
            self.links.iter().map(|link| link.name.as_str()).chain([TIP_NAME]),
            Part::Link,
        )?;
        check_names(
            self.joints.iter().map(|joint| joint.name.as_str()).chain([TIP_NAME]),
            Part::Joint,
        )
    }
}

fn check_names<'a>(
    names: impl Iterator<Item = &'a str>,
    part: impl Fn(String) -> Part,
) -> Result<(), UrdfError> {
    let mut known = HashSet::new();
    for name in names {
        if name.is_empty() {
            return Err(UrdfError::NoName);
        }
        if !known.insert(name) {
            return Err(UrdfError::Twice(part(name.to_owned())));
        }
    }
    Ok(())
}

/// That `values` are finite.
pub(crate) fn check_finite<'v>(
    part: &Part,
    what: &'static str,
    values: impl IntoIterator<Item = &'v f64>,
) -> Result<(), UrdfError> {
    if values.into_iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    Err(UrdfError::NotFinite { part: part.clone(), what })
}

/// That `value` is finite and not below 0.
pub(crate) fn check_not_negative(
    part: &Part,
    what: &'static str,
    value: f64,
) -> Result<(), UrdfError> {
    check_finite(part, what, [&value])?;
    if value < 0.0 {
        return Err(UrdfError::Negative { part: part.clone(), what, value });
    }
    Ok(())
}

/// That `value` is finite and above 0.
fn check_positive(part: &Part, what: &'static str, value: f64) -> Result<(), UrdfError> {
    check_finite(part, what, [&value])?;
    if value <= 0.0 {
        return Err(UrdfError::NotPositive { part: part.clone(), what, value });
    }
    Ok(())
}

fn check_origin(part: &Part, what: &'static str, origin: &Isometry3<f64>) -> Result<(), UrdfError> {
    check_finite(part, what, origin.translation.vector.iter().chain(&origin.rotation.coords))
}

/// That every number of a joint is one.
pub(crate) fn check_joint(joint: &Joint) -> Result<(), UrdfError> {
    let (details, part) = (&joint.details, Part::Joint(joint.name.clone()));
    check_origin(&part, "its origin", &joint.origin)?;
    check_finite(&part, "its axis", joint.axis.iter())?;
    let limits = joint.position_limits.iter().flatten();
    if limits.chain(&joint.velocity_limit).chain(&joint.effort_limit).any(|limit| limit.is_nan()) {
        return Err(UrdfError::NotFinite { part, what: "a limit" });
    }
    check_finite(&part, "a limit", details.motion_limits.iter().flatten())?;
    check_not_negative(&part, "its damping", details.damping)?;
    check_not_negative(&part, "its friction", details.friction)?;
    details.safety.iter().try_for_each(|safety| check_safety(&part, safety))
}

/// That every number of a safety controller is one.
pub(crate) fn check_safety(part: &Part, safety: &SafetyController) -> Result<(), UrdfError> {
    let factors = [&safety.k_position, &safety.k_velocity];
    check_finite(part, "its safety controller", safety.soft_limits.iter().chain(factors))
}

pub(crate) fn check_solid(link: &str, solid: &Solid) -> Result<(), UrdfError> {
    let part = Part::Link(link.to_owned());
    check_origin(&part, "the origin of a solid", &solid.origin)?;
    check_finite(&part, "a colour", &solid.color)?;
    check_measures(&part, &solid.shape)
}

/// That every measure of `shape` is finite and above 0.
pub(crate) fn check_measures(part: &Part, shape: &SolidShape) -> Result<(), UrdfError> {
    let edges = |what: &'static str, size: &Vector3<f64>| -> Vec<_> {
        size.iter().map(|edge| (what, *edge)).collect()
    };
    let measures = match shape {
        SolidShape::Box { size } => edges("an edge of a box", size),
        SolidShape::Cylinder { radius, length } => {
            vec![("the radius of a cylinder", *radius), ("the length of a cylinder", *length)]
        }
        SolidShape::Sphere { radius } => vec![("the radius of a sphere", *radius)],
        SolidShape::Capsule { radius, length } => {
            vec![("the radius of a capsule", *radius), ("the length of a capsule", *length)]
        }
        // One below 0 mirrors.
        SolidShape::Mesh { scale, .. } => edges("the scale of a mesh", &scale.abs()),
    };
    measures.into_iter().try_for_each(|(what, value)| check_positive(part, what, value))
}

/// That `inertial` is finite, has mass and no negative principal moment.
pub(crate) fn check_inertial(link: &str, inertial: &Inertial) -> Result<(), UrdfError> {
    let part = Part::Link(link.to_owned());
    check_finite(&part, "its mass", [&inertial.mass])?;
    check_finite(&part, "its centre of mass", inertial.center.iter())?;
    check_finite(&part, "its inertia", inertial.inertia.iter())?;
    check_positive(&part, "its mass", inertial.mass)?;
    let value = inertial.inertia.symmetric_eigenvalues().min();
    if value < -1e-12 * inertial.inertia.trace().abs() {
        let what = "a principal moment of inertia";
        return Err(UrdfError::NotPositive { part, what, value });
    }
    Ok(())
}
