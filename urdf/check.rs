//! Validation of a model: names, order, finite numbers, positive masses and measures.

use crate::{Inertial, Joint, Model, Part, Solid, SolidShape, TIP_NAME, UrdfError};
use nalgebra::Isometry3;
use std::collections::HashSet;

impl Model {
    /// That links and joints are in the order that [`Model`] promises and have names of their own.
    pub(crate) fn check_tree(&self) -> Result<(), UrdfError> {
        if self.links.len() != self.joints.len() + 1 {
            return Err(UrdfError::Count { links: self.links.len(), joints: self.joints.len() });
        }
        for (index, joint) in self.joints.iter().enumerate() {
            if joint.child != index + 1 || joint.parent > index {
                return Err(UrdfError::Order { joint: joint.name.clone() });
            }
            if self.following(index).is_none() {
                return Err(UrdfError::MimicCircle { joint: joint.name.clone() });
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
            return Err(UrdfError::Twice { part: part(name.to_owned()) });
        }
    }
    Ok(())
}

fn is_finite(origin: &Isometry3<f64>) -> bool {
    origin.translation.vector.iter().chain(&origin.rotation.coords).all(|value| value.is_finite())
}

/// That every number of a joint is one.
pub(crate) fn check_joint(joint: &Joint) -> Result<(), UrdfError> {
    let details = &joint.details;
    let soft = details.safety.iter().flat_map(|safety| {
        safety.soft_limits.into_iter().chain([safety.k_position, safety.k_velocity])
    });
    let limits = joint.position_limits.iter().flatten();
    let limits = limits.chain(&joint.velocity_limit).chain(&joint.effort_limit);
    let finite = [
        ("its origin", is_finite(&joint.origin)),
        ("its axis", joint.axis.iter().all(|value| value.is_finite())),
        ("a limit", !limits.copied().any(f64::is_nan)),
        ("a limit", details.motion_limits.iter().flatten().all(|limit| limit.is_finite())),
        ("its damping", details.damping.is_finite()),
        ("its friction", details.friction.is_finite()),
        ("its safety controller", soft.into_iter().all(f64::is_finite)),
    ];
    let part = || Part::Joint(joint.name.clone());
    if let Some(&(what, _)) = finite.iter().find(|(_, finite)| !finite) {
        return Err(UrdfError::NotFinite { part: part(), what });
    }
    for (what, value) in [("its damping", details.damping), ("its friction", details.friction)] {
        if value < 0.0 {
            return Err(UrdfError::Negative { part: part(), what, value });
        }
    }
    Ok(())
}

pub(crate) fn check_solid(link: &str, solid: &Solid) -> Result<(), UrdfError> {
    let part = || Part::Link(link.to_owned());
    if !is_finite(&solid.origin) {
        return Err(UrdfError::NotFinite { part: part(), what: "the origin of a solid" });
    }
    if !solid.color.iter().all(|value| value.is_finite()) {
        return Err(UrdfError::NotFinite { part: part(), what: "a colour" });
    }
    check_measures(part, &solid.shape)
}

/// That every measure of `shape` is finite and above 0.
pub(crate) fn check_measures(part: impl Fn() -> Part, shape: &SolidShape) -> Result<(), UrdfError> {
    let measures = match shape {
        SolidShape::Box { size } => vec![
            ("an edge of a box", size.x),
            ("an edge of a box", size.y),
            ("an edge of a box", size.z),
        ],
        SolidShape::Cylinder { radius, length } => {
            vec![("the radius of a cylinder", *radius), ("the length of a cylinder", *length)]
        }
        SolidShape::Sphere { radius } => vec![("the radius of a sphere", *radius)],
        SolidShape::Capsule { radius, length } => {
            vec![("the radius of a capsule", *radius), ("the length of a capsule", *length)]
        }
        // One below 0 mirrors.
        SolidShape::Mesh { scale, .. } => vec![
            ("the scale of a mesh", scale.x.abs()),
            ("the scale of a mesh", scale.y.abs()),
            ("the scale of a mesh", scale.z.abs()),
        ],
    };
    for (what, value) in measures {
        if !value.is_finite() {
            return Err(UrdfError::NotFinite { part: part(), what });
        }
        if value <= 0.0 {
            return Err(UrdfError::NotPositive { part: part(), what, value });
        }
    }
    Ok(())
}

/// That `inertial` is finite, has mass and no negative principal moment.
pub(crate) fn check_inertial(link: &str, inertial: &Inertial) -> Result<(), UrdfError> {
    let part = || Part::Link(link.to_owned());
    let finite = [
        ("its mass", inertial.mass.is_finite()),
        ("its centre of mass", inertial.center.iter().all(|value| value.is_finite())),
        ("its inertia", inertial.inertia.iter().all(|value| value.is_finite())),
    ];
    if let Some(&(what, _)) = finite.iter().find(|(_, finite)| !finite) {
        return Err(UrdfError::NotFinite { part: part(), what });
    }
    if inertial.mass <= 0.0 {
        return Err(UrdfError::NotPositive {
            part: part(),
            what: "its mass",
            value: inertial.mass,
        });
    }
    let smallest = inertial.inertia.symmetric_eigenvalues().min();
    if smallest < -1e-12 * inertial.inertia.trace().abs() {
        return Err(UrdfError::NotPositive {
            part: part(),
            what: "a principal moment of inertia",
            value: smallest,
        });
    }
    Ok(())
}
