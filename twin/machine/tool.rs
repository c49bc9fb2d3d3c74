//! `[tool]`: tip, mass and shape of the tool.

use crate::Machine;
use crate::section::Section;
use nalgebra::{Isometry3, Vector3};
use std::borrow::Cow;
use std::ops::RangeInclusive;
use twin_gcode::rs274;
use twin_physics::{ClearanceScan, Part, PhysicsError, Surroundings};
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
    /// The file has a tool table, whose tools have lengths of their own.
    pub(super) has_table: bool,
}

impl Tool {
    /// m, if it is known.
    pub(super) fn radius(&self) -> Option<f64> {
        self.shape.diameter.map(|diameter| 0.5 * diameter)
    }

    pub(super) fn read(root: &Section<'_>, has_table: bool) -> Self {
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
        Self { tip: Vector3::new(x, y, -length) * 1e-3, mass, shape, has_table }
    }
}

/// Place of the tools of a tool table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mount {
    /// The flange in the link where the tip is, m.
    pub(super) flange: Isometry3<f64>,
    /// As [`Tool::tip`] of the machine file.
    pub(super) tip: Vector3<f64>,
    /// Diameter of the tool of the machine file, m, if it is known.
    pub(super) diameter: Option<f64>,
    /// True if link 0 has a generated table just below the lowest place of that tip.
    pub(super) has_table: bool,
}

/// Bodies of a machine with any tool of a tool table in its spindle.
#[derive(Clone, Debug)]
pub struct SpindleBodies {
    /// Links with the tool of the machine file.
    model: Model,
    surroundings: Surroundings,
    axis_count: usize,
    mount: Mount,
}

impl SpindleBodies {
    /// Bodies of the links and surroundings with `tool` in the spindle; those of the machine file without a tool, or with one that leaves
    /// them as they are ([`Self::changes_with`]).
    pub fn with(&self, tool: Option<&rs274::Tool>) -> (Cow<'_, Model>, Cow<'_, Surroundings>) {
        match tool.and_then(|tool| self.holding(tool)) {
            Some((model, surroundings)) => (Cow::Owned(model), Cow::Owned(surroundings)),
            None => (Cow::Borrowed(&self.model), Cow::Borrowed(&self.surroundings)),
        }
    }

    /// True if `tool` gives the spindle another body than the tool of the machine file.
    pub fn changes_with(&self, tool: Option<&rs274::Tool>) -> bool {
        tool.and_then(|tool| self.tip_and_diameter(tool)).is_some()
    }

    /// Scan of all pairs that must not touch, with `tool` in the spindle.
    ///
    /// # Errors
    /// [`PhysicsError`].
    pub fn scan(&self, tool: Option<&rs274::Tool>) -> Result<ClearanceScan, PhysicsError> {
        let (model, surroundings) = self.with(tool);
        ClearanceScan::new(&model, self.axis_count, &surroundings)
    }

    /// The same, and the tool and the stock, for motion that must not cut.
    ///
    /// # Errors
    /// [`PhysicsError`].
    pub fn scan_without_cuts(
        &self,
        tool: Option<&rs274::Tool>,
    ) -> Result<ClearanceScan, PhysicsError> {
        let (model, surroundings) = self.with(tool);
        ClearanceScan::without_cuts(&model, self.axis_count, &surroundings)
    }

    /// Scan of `tool` alone among all obstacles: what it can probe.
    ///
    /// # Errors
    /// [`PhysicsError`].
    pub fn probe_scan(&self, tool: Option<&rs274::Tool>) -> Result<ClearanceScan, PhysicsError> {
        let (model, surroundings) = self.with(tool);
        ClearanceScan::of_tool(&model, self.axis_count, &surroundings)
    }

    /// Tip in the frame of the flange (m) and diameter (m, if it is known) of the body of `tool`; `None` if it is that of the machine file,
    /// or if that one is not round.
    fn tip_and_diameter(&self, tool: &rs274::Tool) -> Option<(Vector3<f64>, Option<f64>)> {
        let before = self.mount.tip;
        let mut tip = before - Vector3::from(tool.offset);
        if tip.z >= 0.0 {
            // It would end above the flange: its length counts from somewhere else.
            tip = before;
        }
        let diameter = Some(tool.diameter.abs()).filter(|diameter| *diameter > 0.0);
        let is_round = before.z >= 0.0 || self.model.tool_diameter().is_some();
        let changes = is_round && tip.z < 0.0 && (tip != before || diameter.is_some());
        changes.then_some((tip, diameter.or(self.mount.diameter)))
    }

    /// Links and surroundings with `tool`: a round body from the flange to its tip, which is below the controlled point by the tool's offset.
    fn holding(&self, tool: &rs274::Tool) -> Option<(Model, Surroundings)> {
        let (tip, diameter) = self.tip_and_diameter(tool)?;
        let Mount { flange, tip: before, has_table, .. } = self.mount;
        let mut model = self.model.clone();
        model.change_tool(&flange, &tip, diameter);
        let mut surroundings = Surroundings { has_tool: true, ..self.surroundings.clone() };
        if has_table && tip.z < before.z {
            // The table is a picture, which the machine has only as low as it is needed.
            surroundings.left_out.push([Part::Tool, Part::Link(0)]);
        }
        Some((model, surroundings))
    }
}

impl Machine {
    /// Its bodies with any tool in the spindle; `None` without a collision check in the file.
    pub fn spindle_bodies(&self) -> Option<SpindleBodies> {
        Some(SpindleBodies {
            model: self.model.clone(),
            surroundings: self.collision.as_ref()?.surroundings.clone(),
            axis_count: self.axes.len(),
            mount: self.mount,
        })
    }
}
