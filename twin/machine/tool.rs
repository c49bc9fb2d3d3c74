//! `[tool]`: what the machine holds.

use super::section::Section;
use nalgebra::Vector3;

/// The tool of a machine.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tool {
    /// Its tip in the frame of the flange, z up, m.
    pub(super) tip: Vector3<f64>,
    /// kg.
    pub(super) mass: f64,
}

impl Tool {
    pub(super) fn read(root: &Section<'_>) -> Self {
        let section = root.section("tool");
        let length = section.number("length_mm", 0.0..=10_000.0).unwrap_or(0.0);
        let [x, y] = section.numbers::<2>("offset_mm", -10_000.0..=10_000.0).unwrap_or_default();
        let mass = section.number("mass_kg", 0.0..=1000.0).unwrap_or(0.0);
        section.finish();
        Self { tip: Vector3::new(x, y, -length) * 1e-3, mass }
    }
}
