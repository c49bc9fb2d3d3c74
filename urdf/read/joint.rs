//! Reader of joints: kind, axis, limits, and mimicked joint.

use super::Reader;
use super::document::{At, Element};
use crate::check::{check_finite, check_not_negative, check_safety};
use crate::{
    Calibration, Joint, JointDetails, JointDrive, JointKind, Model, Part, SafetyController,
    UrdfError,
};
use nalgebra::{Unit, Vector3};

/// The line of an element of a joint; of the joint, if it has none.
fn line(joint: Element<'_>, element: &str) -> u32 {
    joint.child(element).unwrap_or(joint).line()
}

impl Reader<'_> {
    /// A joint that is not yet said what moves it.
    pub(super) fn joint(
        &mut self,
        joint: Element<'_>,
        links: [usize; 2],
        limits_are_optional: bool,
    ) -> At<Joint> {
        let name = joint.name();
        let part = Part::Joint(name.to_owned());
        let unsupported = |what| {
            let error = UrdfError::Unsupported { part: part.clone(), what };
            Err((joint.line(), error))
        };
        let written = joint.text("type").unwrap_or_default();
        let kind = match written {
            "revolute" | "continuous" => JointKind::Revolute,
            "prismatic" => JointKind::Prismatic,
            "floating" => return unsupported("a floating joint"),
            "planar" => return unsupported("a planar joint"),
            "spherical" => return unsupported("a spherical joint"),
            _ => JointKind::Fixed,
        };
        let origin = self.pose(&part, joint, line(joint, "origin"))?;
        let axis = read_axis(joint, kind).map_err(|error| (line(joint, "axis"), error))?;
        let mut read = Joint::new(name, kind, links, origin, axis, JointDrive::Fixed);
        read.details = read_details(joint)?;
        if kind != JointKind::Fixed {
            read_limits(joint, &mut read, limits_are_optional)
                .map_err(|error| (line(joint, "limit"), error))?;
        }
        Ok(read)
    }
}

/// Says of the joints of `model` that mimic others whom they mimic; `of_text` are the same in the text.
pub(super) fn mimic(model: &mut Model, robot: Element<'_>, of_text: &[Element<'_>]) -> At<()> {
    for (number, element) in of_text.iter().enumerate() {
        let Some(mimic) = element.child("mimic") else { continue };
        let (joint, leader) = (element.name().to_owned(), mimic.text("joint").unwrap_or_default());
        let refuse = |error| Err((mimic.line(), error));
        let moves = |number: usize| {
            model.joints.get(number).is_some_and(|joint| joint.kind != JointKind::Fixed)
        };
        let found = model.joints.iter().position(|other| other.name == leader);
        // The joint of the link that marks the tool tip is none of the model's; it is fixed.
        let known = robot.children("joint").any(|other| other.name() == leader);
        let Some(found) = found.filter(|found| moves(number) && moves(*found)) else {
            let leader = leader.to_owned();
            return refuse(if known {
                UrdfError::MimicFixed { joint, leader }
            } else {
                UrdfError::NoLeader { joint, leader }
            });
        };
        let multiplier = mimic.number("multiplier").unwrap_or(1.0);
        let offset = mimic.number("offset").unwrap_or(0.0);
        check_finite(&Part::Joint(joint), "what it mimics with", [&multiplier, &offset])
            .map_err(|error| (mimic.line(), error))?;
        if let Some(joint) = model.joints.get_mut(number) {
            joint.drive = JointDrive::Mimic { joint: found, multiplier, offset };
        }
    }
    for (number, element) in of_text.iter().enumerate() {
        if model.following(number).is_none() {
            let error = UrdfError::MimicCircle(element.name().to_owned());
            return Err((line(*element, "mimic"), error));
        }
    }
    Ok(())
}

fn read_axis(joint: Element<'_>, kind: JointKind) -> Result<Unit<Vector3<f64>>, UrdfError> {
    let written = joint.child("axis").and_then(|axis| axis.numbers("xyz"));
    let axis = written.map_or_else(Vector3::x, Vector3::from);
    check_finite(&Part::Joint(joint.name().to_owned()), "its axis", axis.iter())?;
    // A direction that has length 1 already is kept to the last digit.
    if (axis.norm() - 1.0).abs() <= 4.0 * f64::EPSILON {
        return Ok(Unit::new_unchecked(axis));
    }
    let unit = Unit::try_new(axis, 0.0).filter(|unit| (unit.norm() - 1.0).abs() < 1e-9);
    match unit {
        Some(direction) => Ok(direction),
        None if kind == JointKind::Fixed => Ok(Vector3::x_axis()),
        None => Err(UrdfError::NoDirection(joint.name().to_owned())),
    }
}

/// Everything of a joint that its motion does not follow from.
fn read_details(joint: Element<'_>) -> At<JointDetails> {
    let part = Part::Joint(joint.name().to_owned());
    let mut details = JointDetails::default();
    if let Some(dynamics) = joint.child("dynamics") {
        for (what, attribute, value) in [
            ("its damping", "damping", &mut details.damping),
            ("its friction", "friction", &mut details.friction),
        ] {
            *value = dynamics.number(attribute).unwrap_or_default();
            check_not_negative(&part, what, *value).map_err(|error| (dynamics.line(), error))?;
        }
    }
    if let Some(safety) = joint.child("safety_controller") {
        let number = |attribute: &str| safety.number(attribute).unwrap_or_default();
        let read = SafetyController {
            soft_limits: ["soft_lower_limit", "soft_upper_limit"].map(number),
            k_position: number("k_position"),
            k_velocity: number("k_velocity"),
        };
        let [lower, upper] = read.soft_limits;
        let in_order = if lower > upper {
            Err(UrdfError::Limits { joint: joint.name().to_owned(), lower, upper })
        } else {
            Ok(())
        };
        let checked = check_safety(&part, &read).and(in_order);
        checked.map_err(|error| (safety.line(), error))?;
        details.safety = Some(read);
    }
    if let Some(calibration) = joint.child("calibration") {
        let [rising, falling] = ["rising", "falling"].map(|edge| calibration.number(edge));
        let edges = rising.iter().chain(&falling);
        check_finite(&part, "its calibration", edges)
            .map_err(|error| (calibration.line(), error))?;
        details.calibration = Some(Calibration { rising, falling });
    }
    Ok(details)
}

fn read_limits(
    joint: Element<'_>,
    read: &mut Joint,
    limits_are_optional: bool,
) -> Result<(), UrdfError> {
    let limit = joint.child("limit");
    let part = || Part::Joint(joint.name().to_owned());
    let written = |attribute: &str| limit.and_then(|limit| limit.number(attribute));
    // Since 1.2 what a <limit> does not say is no limit.
    let none = if limits_are_optional && limit.is_some() { f64::INFINITY } else { 0.0 };
    let number = |attribute: &str, absent: f64| written(attribute).unwrap_or(absent);
    let (lower, upper) = (number("lower", -none), number("upper", none));
    let [velocity, effort] = ["velocity", "effort"].map(|attribute| number(attribute, none));
    let since_1_2 = |attribute: &str| written(attribute).filter(|_| limits_are_optional);
    let acceleration = since_1_2("acceleration");
    let motion = [acceleration, since_1_2("deceleration").or(acceleration), since_1_2("jerk")];
    let all = [lower, upper, velocity, effort];
    if all.iter().chain(motion.iter().flatten()).any(|value| value.is_nan()) {
        return Err(UrdfError::NotFinite { part: part(), what: "a limit" });
    }
    let others = motion.into_iter().flatten().map(|value| ("a limit of its motion", value));
    for (what, value) in
        [("its velocity limit", velocity), ("its effort limit", effort)].into_iter().chain(others)
    {
        if value < 0.0 {
            return Err(UrdfError::Negative { part: part(), what, value });
        }
    }
    let given =
        |value: f64| (value.is_finite() && (limits_are_optional || value != 0.0)).then_some(value);
    read.velocity_limit = given(velocity);
    read.effort_limit = given(effort);
    read.details.motion_limits = motion.map(|value| value.filter(|value| value.is_finite()));
    if joint.text("type") == Some("continuous") {
        return Ok(());
    }
    if !limits_are_optional && lower == 0.0 && upper == 0.0 {
        return Err(UrdfError::NoLimits(joint.name().to_owned()));
    }
    if lower > upper {
        return Err(UrdfError::Limits { joint: joint.name().to_owned(), lower, upper });
    }
    if lower.is_finite() || upper.is_finite() {
        read.position_limits = Some([lower, upper]);
    }
    Ok(())
}
