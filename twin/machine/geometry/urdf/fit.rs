//! Dimensions that would make the transform fit a URDF.

use super::agree::{Difference, largest};
use super::{Given, Source};
use crate::geometry::design::{AtZero, Design, FittedKey};
use crate::geometry::rounded;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;
use twin_kinematics::{Kinematics, MachineAxes};
use twin_urdf::Model;

/// An angle this near to a multiple of a right angle was probably meant to be it, rad.
const NEARLY_RIGHT: f64 = 5e-3;

/// Dimensions and the place of the base, with the keys that say them.
struct Candidate {
    design: Box<dyn Design>,
    /// Shift of the base, m.
    shift: Vector3<f64>,
    keys: Vec<String>,
}

/// Hint on a difference, as far as one can be given.
pub(super) fn advice(
    source: &Source,
    given: &Given<'_>,
    model: &Model,
    worst: &Difference,
) -> Option<String> {
    let candidate = candidate(source, given, model)?;
    let left = difference(given, model, &candidate)?;
    let keys = candidate.keys.join(", ");
    if left <= source.tolerance && !candidate.keys.is_empty() {
        return Some(format!("these dimensions would fit: {keys}"));
    }
    let mut advice = Vec::new();
    if left < 0.5 * worst.length && !candidate.keys.is_empty() {
        advice.push(format!("with {keys} there would still be {} mm", rounded(left * 1e3)));
    }
    let angles: Vec<_> = model
        .joints
        .iter()
        .filter_map(|joint| {
            let off = off_right_angle(&joint.origin.rotation)?;
            let off = rounded(off.to_degrees());
            Some(format!("joint {} is {off}° off a right angle", joint.name))
        })
        .collect();
    if !angles.is_empty() {
        advice.push(format!(
            "{}: if that is rounding, `right_angle_tolerance_deg` takes it as meant",
            angles.join(", ")
        ));
    }
    advice.push("`joint_sense` and `joint_offset` of [[axes]] and `base_mm` put joints where the transform has them; \
                 `tolerance_mm` allows more".to_owned());
    Some(advice.join("; "))
}

/// Angle of a rotation from the nearest one by right angles, if it is small but not 0.
fn off_right_angle(rotation: &UnitQuaternion<f64>) -> Option<f64> {
    let (roll, pitch, yaw) = rotation.euler_angles();
    let right = |angle: f64| (angle / FRAC_PI_2).round() * FRAC_PI_2;
    let nearest = Rotation3::from_euler_angles(right(roll), right(pitch), right(yaw));
    let off = rotation.angle_to(&UnitQuaternion::from_rotation_matrix(&nearest));
    (off > 1e-6 && off < NEARLY_RIGHT).then_some(off)
}

/// The dimensions that the joints have with every axis at 0.
fn candidate(source: &Source, given: &Given<'_>, model: &Model) -> Option<Candidate> {
    let zero = vec![0.0; given.axes.len()];
    let poses = model.link_poses(&zero);
    // Of the joint that an axis moves, and the flange.
    let joint = |role: &str| -> Option<Point3<f64>> {
        let index = given.axes.iter().position(|entry| entry.role == role)?;
        let joint = model.joints.iter().find(|joint| joint.drive.axis() == Some(index))?;
        Some(poses.get(joint.child)?.translation.vector.into())
    };
    let flange = Point3::from(poses.get(model.tip.link)?.translation.vector);
    let fit = given.design.fit(&AtZero { joint: &joint, flange })?;
    let old = source.base.translation.vector;
    let base = (old + fit.shift).map(|value| rounded(value * 1e3));
    let moved = FittedKey {
        key: "base_mm",
        fitting: base.as_slice().to_vec(),
        present: (old * 1e3).as_slice().to_vec(),
    };
    let differs = |key: &FittedKey| {
        let mut pairs = key.fitting.iter().zip(&key.present);
        pairs.any(|(fitting, present)| (fitting - present).abs() >= 1e-6)
    };
    let keys = fit.keys.into_iter().chain([moved]).filter(differs).map(|key| {
        let values: Vec<_> = key.fitting.iter().map(ToString::to_string).collect();
        format!("{} = [{}]", key.key, values.join(", "))
    });
    let keys = keys.collect();
    Some(Candidate { design: fit.design, shift: base * 1e-3 - old, keys })
}

/// Remaining difference, m.
fn difference(given: &Given<'_>, model: &Model, candidate: &Candidate) -> Option<f64> {
    let transform = candidate.design.transform().ok()?;
    let machine = MachineAxes::new(transform, given.sources.clone(), given.tool.tip).ok()?;
    let moved =
        Isometry3::from_parts(Translation3::from(candidate.shift), UnitQuaternion::identity());
    let worst = largest(given.axes, |axes| {
        Some((machine.forward(axes).ok()?.position, moved * model.tip_position(axes)))
    });
    worst.map(|worst| worst.length)
}
