//! Reader of joints: kind, axis, limits, and mimicked joint.

use super::Reader;
use super::document::{At, JointPlaces, OriginPlace, Places};
use crate::check::{check_finite, check_not_negative, check_safety};
use crate::{
    Calibration, Joint, JointDetails, JointDrive, JointKind, Model, Part, SafetyController,
    UrdfError,
};
use nalgebra::{Unit, Vector3};
use urdf_rs::JointType;

impl Reader<'_> {
    /// A joint that is not yet said what moves it.
    pub(super) fn joint(
        &mut self,
        joint: &urdf_rs::Joint,
        links: [usize; 2],
        places: Option<&JointPlaces>,
        limits_are_optional: bool,
    ) -> At<Joint> {
        let line = |element: &str| places.map_or(1, |places| places.of(element));
        let part = Part::Joint(joint.name.clone());
        let unsupported =
            |what| Err((line("joint"), UrdfError::Unsupported { part: part.clone(), what }));
        let kind = match joint.joint_type {
            JointType::Revolute | JointType::Continuous => JointKind::Revolute,
            JointType::Prismatic => JointKind::Prismatic,
            JointType::Fixed => JointKind::Fixed,
            JointType::Floating => return unsupported("a floating joint"),
            JointType::Planar => return unsupported("a planar joint"),
            JointType::Spherical => return unsupported("a spherical joint"),
        };
        let nowhere = OriginPlace { line: line("origin"), ..OriginPlace::default() };
        let place = places
            .map_or(nowhere, |places| OriginPlace { line: places.of("origin"), ..places.origin });
        let origin = self.pose(&part, &joint.origin, place)?;
        let axis = read_axis(joint, kind).map_err(|error| (line("axis"), error))?;
        let mut read = Joint::new(joint.name.clone(), kind, links, origin, axis, JointDrive::Fixed);
        read.details = read_details(joint, &line)?;
        if kind != JointKind::Fixed {
            read_limits(joint, &mut read, limits_are_optional)
                .map_err(|error| (line("limit"), error))?;
        }
        Ok(read)
    }
}

/// Says of the joints of `model` that mimic others whom they mimic; `of_text` are their places in the text.
pub(super) fn mimic(
    model: &mut Model,
    robot: &urdf_rs::Robot,
    of_text: &[usize],
    places: &Places,
) -> At<()> {
    let line =
        |index: usize| places.joints.get(index).map_or(places.robot, |joint| joint.of("mimic"));
    for (number, index) in of_text.iter().enumerate() {
        let Some(mimic) = robot.joints.get(*index).and_then(|joint| joint.mimic.as_ref()) else {
            continue;
        };
        let joint = model.joints.get(number).map(|joint| joint.name.clone()).unwrap_or_default();
        let leader = mimic.joint.clone();
        let moves = |number: usize| {
            model.joints.get(number).is_some_and(|joint| joint.kind != JointKind::Fixed)
        };
        let Some(found) = model.joints.iter().position(|other| other.name == leader) else {
            // The joint of the link that marks the tool tip is none of the model's; it is fixed.
            let known = robot.joints.iter().any(|other| other.name == leader);
            let error = if known {
                UrdfError::MimicFixed { joint, leader }
            } else {
                UrdfError::NoLeader { joint, leader }
            };
            return Err((line(*index), error));
        };
        if !moves(number) || !moves(found) {
            return Err((line(*index), UrdfError::MimicFixed { joint, leader }));
        }
        let (multiplier, offset) = (mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0));
        check_finite(&Part::Joint(joint), "what it mimics with", [&multiplier, &offset])
            .map_err(|error| (line(*index), error))?;
        if let Some(joint) = model.joints.get_mut(number) {
            joint.drive = JointDrive::Mimic { joint: found, multiplier, offset };
        }
    }
    for (number, index) in of_text.iter().enumerate() {
        if model.following(number).is_none() {
            let joint = model.joints.get(number).map(|joint| joint.name.clone());
            let error = UrdfError::MimicCircle(joint.unwrap_or_default());
            return Err((line(*index), error));
        }
    }
    Ok(())
}

fn read_axis(joint: &urdf_rs::Joint, kind: JointKind) -> Result<Unit<Vector3<f64>>, UrdfError> {
    let axis = Vector3::from(*joint.axis.xyz);
    check_finite(&Part::Joint(joint.name.clone()), "its axis", axis.iter())?;
    // A direction that has length 1 already is kept to the last digit.
    if (axis.norm() - 1.0).abs() <= 4.0 * f64::EPSILON {
        return Ok(Unit::new_unchecked(axis));
    }
    let unit = Unit::try_new(axis, 0.0).filter(|unit| (unit.norm() - 1.0).abs() < 1e-9);
    match unit {
        Some(direction) => Ok(direction),
        None if kind == JointKind::Fixed => Ok(Vector3::x_axis()),
        None => Err(UrdfError::NoDirection(joint.name.clone())),
    }
}

/// Everything of a joint that its motion does not follow from; `line` is that of an element.
fn read_details(joint: &urdf_rs::Joint, line: &impl Fn(&str) -> u32) -> At<JointDetails> {
    let part = Part::Joint(joint.name.clone());
    let at = |element: &'static str| move |error: UrdfError| (line(element), error);
    let mut details = JointDetails::default();
    if let Some(dynamics) = &joint.dynamics {
        check_not_negative(&part, "its damping", dynamics.damping).map_err(at("dynamics"))?;
        check_not_negative(&part, "its friction", dynamics.friction).map_err(at("dynamics"))?;
        (details.damping, details.friction) = (dynamics.damping, dynamics.friction);
    }
    if let Some(safety) = &joint.safety_controller {
        let read = SafetyController {
            soft_limits: [safety.soft_lower_limit, safety.soft_upper_limit],
            k_position: safety.k_position,
            k_velocity: safety.k_velocity,
        };
        check_safety(&part, &read).map_err(at("safety_controller"))?;
        let [lower, upper] = read.soft_limits;
        if lower > upper {
            let joint = joint.name.clone();
            return Err((line("safety_controller"), UrdfError::Limits { joint, lower, upper }));
        }
        details.safety = Some(read);
    }
    if let Some(calibration) = &joint.calibration {
        let read = Calibration { rising: calibration.rising, falling: calibration.falling };
        let edges = read.rising.iter().chain(&read.falling);
        check_finite(&part, "its calibration", edges).map_err(at("calibration"))?;
        details.calibration = Some(read);
    }
    if joint.joint_type != JointType::Fixed {
        let limit = &joint.limit;
        details.motion_limits = [limit.acceleration, limit.deceleration, limit.jerk]
            .map(|value| value.is_finite().then_some(value));
    }
    Ok(details)
}

fn read_limits(
    joint: &urdf_rs::Joint,
    read: &mut Joint,
    limits_are_optional: bool,
) -> Result<(), UrdfError> {
    let limit = &joint.limit;
    let part = || Part::Joint(joint.name.clone());
    let motion = [limit.acceleration, limit.deceleration, limit.jerk];
    let all = [limit.lower, limit.upper, limit.velocity, limit.effort];
    if all.iter().chain(&motion).any(|value| value.is_nan()) {
        return Err(UrdfError::NotFinite { part: part(), what: "a limit" });
    }
    for (what, value) in
        [("its velocity limit", limit.velocity), ("its effort limit", limit.effort)]
    {
        if value < 0.0 {
            return Err(UrdfError::Negative { part: part(), what, value });
        }
    }
    let given =
        |value: f64| (value.is_finite() && (limits_are_optional || value != 0.0)).then_some(value);
    read.velocity_limit = given(limit.velocity);
    read.effort_limit = given(limit.effort);
    if joint.joint_type == JointType::Continuous {
        return Ok(());
    }
    if !limits_are_optional && limit.lower == 0.0 && limit.upper == 0.0 {
        return Err(UrdfError::NoLimits(joint.name.clone()));
    }
    if limit.lower > limit.upper {
        let (joint, lower, upper) = (joint.name.clone(), limit.lower, limit.upper);
        return Err(UrdfError::Limits { joint, lower, upper });
    }
    if limit.lower.is_finite() || limit.upper.is_finite() {
        read.position_limits = Some([limit.lower, limit.upper]);
    }
    Ok(())
}
