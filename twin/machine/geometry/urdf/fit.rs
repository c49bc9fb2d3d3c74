//! Dimensions that would make the transform fit a URDF.

use super::agree::{Difference, largest, rounded};
use super::{Given, Source};
use crate::geometry::design::Design;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;
use twin_kinematics::{Kinematics, MachineAxes};
use twin_urdf::Model;

/// An angle this near to a multiple of a right angle was probably meant to be it, rad.
const NEARLY_RIGHT: f64 = 5e-3;

/// Dimensions and the place of the base, with the keys that say them.
struct Candidate {
    design: Design,
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
    let old = source.base.translation.vector;
    let mut keys = Vec::new();
    let mut say = |key: &str, values: &[f64], before: &[f64]| {
        let same = values.iter().zip(before).all(|(one, other)| (one - other).abs() < 1e-6);
        if !same {
            let values: Vec<_> = values.iter().map(ToString::to_string).collect();
            keys.push(format!("{key} = [{}]", values.join(", ")));
        }
    };
    let (design, shift) = match given.design {
        Design::Scara { arms, offsets, elbow, has_hand } => {
            let [a, b] = [joint("A")?, joint("B")?];
            let wrist = if *has_hand { joint("C")? } else { flange };
            let count = if *has_hand { 3 } else { 2 };
            let legs = [b - a, wrist - b, flange - wrist].map(|leg| leg.xy());
            let lengths = legs.map(|leg| rounded(leg.norm() * 1e3));
            let mut before = 0.0;
            let directions = legs.map(|leg| {
                // A leg of no length goes on as the one before.
                let direction = if leg.norm() > 1e-9 { leg.y.atan2(leg.x) } else { before };
                let turn = direction - before;
                before = direction;
                let turn = (0.0 - turn).to_degrees();
                rounded(turn - 360.0 * (turn / 360.0).round())
            });
            let shift = -Vector3::new(a.x, a.y, flange.z);
            let to_mm = |values: &[f64]| values.iter().map(|value| value * 1e3).collect::<Vec<_>>();
            let to_deg =
                |values: &[f64]| values.iter().map(|value| value.to_degrees()).collect::<Vec<_>>();
            say("arm_lengths_mm", lengths.get(..count)?, &to_mm(arms));
            // A hand of no length turns the tool from where it is.
            let offsets_deg = if *has_hand && lengths[2] < 1e-6 {
                [directions[0], directions[1], rounded(offsets[2].to_degrees())]
            } else {
                directions
            };
            say("offsets_deg", offsets_deg.get(..count)?, &to_deg(offsets));
            let arms = lengths.map(|length| length * 1e-3);
            let offsets = offsets_deg.map(f64::to_radians);
            (Design::Scara { arms, offsets, elbow: *elbow, has_hand: *has_hand }, shift)
        }
        Design::Gantry { offsets, has_z, rotary, beside, belt } => {
            let count = if *has_z { 3 } else { 2 };
            let [x, y, z] = [flange.x, flange.y, flange.z].map(|value| rounded(0.0 - value * 1e3));
            let found = [x, y, if *has_z { z } else { 0.0 }];
            let before = offsets.map(|offset| offset * 1e3);
            say("offsets_mm", found.get(..count)?, before.get(..count)?);
            let shift = if *has_z { Vector3::zeros() } else { -Vector3::z() * flange.z };
            let (rotary, beside, belt) = (*rotary, *beside, *belt);
            let offsets = found.map(|offset| offset * 1e-3);
            (Design::Gantry { offsets, has_z: *has_z, rotary, beside, belt }, shift)
        }
        Design::Tripod { .. } => return None,
    };
    let base = (old + shift).map(|value| rounded(value * 1e3));
    say("base_mm", &[base.x, base.y, base.z], &[old.x * 1e3, old.y * 1e3, old.z * 1e3]);
    let shift = base * 1e-3 - old;
    Some(Candidate { design, shift, keys })
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
