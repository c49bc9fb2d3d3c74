//! `[tool]`: tip, mass and shape of the tool.

use crate::section::Section;
use nalgebra::Vector3;
use std::ops::RangeInclusive;
use twin_urdf::ToolShape;

/// Of bodies, mm.
const SIZE_MM: RangeInclusive<f64> = 1e-3..=10_000.0;

/// The tool of a machine.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tool {
    /// Its tip in the frame of the flange, z up, m.
    pub(super) tip: Vector3<f64>,
    /// kg.
    pub(super) mass: f64,
    /// Its shape.
    pub(super) shape: ToolShape,
}

impl Tool {
    /// m, if it is known.
    pub(super) fn radius(&self) -> Option<f64> {
        self.shape.diameter.map(|diameter| 0.5 * diameter)
    }

    pub(super) fn read(root: &Section<'_>) -> Self {
        let section = root.section("tool");
        let length = section.number("length_mm", 0.0..=10_000.0).unwrap_or(0.0);
        let [x, y] = section.numbers::<2>("offset_mm", -10_000.0..=10_000.0).unwrap_or_default();
        let mass = section.number("mass_kg", 0.0..=1000.0).unwrap_or(0.0);
        let diameter = section.number("diameter_mm", SIZE_MM);
        let holder = ["holder_diameter_mm", "holder_length_mm"];
        let given = holder.map(|key| section.has(key));
        let [holder_diameter, holder_length] = if given == [false; 2] {
            [None; 2]
        } else {
            holder.map(|key| section.required_number(key, SIZE_MM))
        };
        if let Some(holder) = holder_length.filter(|holder| *holder > length && length > 0.0) {
            let message = format!("the holder is {holder} mm long, the tool with it {length} mm");
            section.complain_at("holder_length_mm", message);
        }
        section.finish();
        let shape = ToolShape {
            diameter: diameter.map(|value| value * 1e-3),
            holder: holder_diameter.zip(holder_length).map(|(a, b)| [a * 1e-3, b * 1e-3]),
        };
        Self { tip: Vector3::new(x, y, -length) * 1e-3, mass, shape }
    }
}
