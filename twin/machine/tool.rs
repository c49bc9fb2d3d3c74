//! `[tool]`: tip, mass and shape of the tool.

use crate::Machine;
use crate::section::Section;
use nalgebra::{Isometry3, Vector3};
use std::ops::RangeInclusive;
use twin_gcode::rs274;
use twin_physics::{Part, Surroundings};
use twin_urdf::{Model, ToolShape};

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

/// Place of the tools of a tool table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mount {
    /// The flange in the link where the tip is, m.
    pub(super) flange: Isometry3<f64>,
    /// As [`Tool::tip`] of the machine file.
    pub(super) tip: Vector3<f64>,
    /// True if link 0 has a generated table just below the lowest place of that tip.
    pub(super) has_table: bool,
}

impl Machine {
    /// Links and surroundings with `tool` of a tool table in the spindle: a round body from the flange to its tip, which is below the
    /// controlled point by the tool's offset. Without a diameter or length those of the machine file count. `None` if that leaves the tool
    /// as it is, or if that is not round.
    pub(super) fn with_tool(
        &self,
        tool: &rs274::Tool,
        surroundings: &Surroundings,
    ) -> Option<(Model, Surroundings)> {
        let Mount { flange, tip: before, has_table } = self.mount;
        let mut tip = before - Vector3::from(tool.offset);
        if tip.z >= 0.0 {
            // It would end above the flange: its length counts from somewhere else.
            tip = before;
        }
        let diameter = Some(tool.diameter.abs()).filter(|diameter| *diameter > 0.0);
        let is_round = before.z >= 0.0 || self.model.tool_diameter().is_some();
        if !is_round || tip.z >= 0.0 || (tip == before && diameter.is_none()) {
            return None;
        }
        let mut model = self.model.clone();
        model.change_tool(&flange, &tip, diameter);
        let mut surroundings = Surroundings { has_tool: true, ..surroundings.clone() };
        if has_table && tip.z < before.z {
            // The table is a picture, which the machine has only as low as it is needed.
            surroundings.left_out.push([Part::Tool, Part::Link(0)]);
        }
        Some((model, surroundings))
    }
}
