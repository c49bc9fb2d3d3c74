//! `[payload]`: mass, centre and inertia of the payload at the tool; it has no shape.

use super::tool::Tool;
use crate::section::Section;
use nalgebra::{Matrix3, Point3, Vector3};
use std::ops::RangeInclusive;
use twin_urdf::Inertial;

/// kg.
const MASS_KG: RangeInclusive<f64> = 0.0..=100_000.0;
/// From the flange, mm.
const CENTER_MM: RangeInclusive<f64> = -10_000.0..=10_000.0;
/// kg·m².
const INERTIA: RangeInclusive<f64> = 0.0..=1e6;
/// A moment of inertia may be larger than the sum of the others by this part of it: numbers are rounded.
const ROUNDING: f64 = 1e-9;

/// Payload on the flange in its frame, z up; `None` if the file gives none, or an impossible one.
pub(super) fn read(root: &Section<'_>, tool: &Tool) -> Option<Inertial> {
    let given = root.has("payload");
    let section = root.section("payload");
    let mass = if given { section.required_number("mass_kg", MASS_KG) } else { None };
    let center = section.numbers::<3>("center_mm", CENTER_MM);
    let moments = section.numbers::<3>("inertia_kg_m2", INERTIA).unwrap_or_default();
    section.check_unknown();
    let largest = moments.into_iter().fold(0.0, f64::max);
    if 2.0 * largest > moments.into_iter().sum::<f64>() * (1.0 + ROUNDING) {
        let message = format!(
            "`inertia_kg_m2` has a moment of {largest}, more than both others together, as no body has"
        );
        section.complain_at("inertia_kg_m2", message);
        return None;
    }
    let center = center.map_or(tool.tip, |center| Vector3::from(center) * 1e-3);
    let inertia = Matrix3::from_diagonal(&Vector3::from(moments));
    let mass = mass.filter(|mass| *mass > 0.0)?;
    Some(Inertial { mass, center: Point3::from(center), inertia })
}
