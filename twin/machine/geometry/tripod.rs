//! Tripods: carriages on vertical rails, with rods to a platform.

use super::design::{
    ANGLE_DEG, AtZero, DEG, DEVIATION_DEG, DEVIATION_MM, Design, Fit, Kind, LENGTH_MM, MM, Mounted,
    OFFSET_MM, Sections, added, length, mass,
};
use crate::axis_kind::AxisKind::Linear;
use twin_kinematics::tripod::{CalibratedTripod, TripodDeviations, TripodDimensions};
use twin_kinematics::{DimensionError, Kinematics, tripod};
use twin_urdf::Model;

pub(super) const KINDS: &[Kind] = &[Kind {
    name: "tripod",
    outputs: &[("A", Linear), ("B", Linear), ("C", Linear)],
    moves_z: true,
    has_table: true,
    turns_tool: false,
    beyond_urdf: Some("the rods of a tripod go round in loops"),
    read,
}];

#[derive(Debug)]
struct Tripod {
    dimensions: TripodDimensions,
    deviations: TripodDeviations,
    offsets: [f64; 3],
    /// Masses and sizes, as far as the file says.
    sizes: twin_urdf::TripodDimensions,
}

fn read(sections: &Sections<'_>) -> Option<Box<dyn Design>> {
    let Sections { nominal, deviations: measured, body } = sections;
    let inner_radius = nominal.required_number("inner_radius_mm", LENGTH_MM);
    let outer_radius = nominal.required_number("outer_radius_mm", LENGTH_MM);
    let rod_length = nominal.required_number("rod_length_mm", LENGTH_MM);
    let rod_distance = nominal.required_number("rod_distance_mm", LENGTH_MM);
    let rotation = nominal.number("rotation_deg", ANGLE_DEG).unwrap_or_default();
    let offsets = nominal.numbers::<3>("offsets_mm", OFFSET_MM).unwrap_or_default();
    let angles = |key| added([0.0; 3], measured.numbers(key, DEVIATION_DEG), DEG);
    let lengths = |key| added([0.0; 3], measured.numbers(key, DEVIATION_MM), MM);
    let deviations = TripodDeviations {
        tower_angles: angles("tower_angles_deg"),
        platform_angles: angles("platform_angles_deg"),
        outer_radii: lengths("outer_radii_mm"),
        inner_radii: lengths("inner_radii_mm"),
        outer_distances: lengths("outer_distances_mm"),
        inner_distances: lengths("inner_distances_mm"),
        rod_lengths: added([0.0; 6], measured.numbers("rod_lengths_mm", DEVIATION_MM), MM),
    };
    let measured_offsets = measured.numbers::<3>("offsets_mm", DEVIATION_MM);
    let sizes = body.map(|body| twin_urdf::TripodDimensions {
        carriage_mass: mass(body, "carriage_mass_kg"),
        rod_mass: mass(body, "rod_mass_kg"),
        rod_radius: length(body, "rod_diameter_mm").map(|diameter| diameter / 2.0),
        platform_mass: mass(body, "platform_mass_kg"),
        ..twin_urdf::TripodDimensions::default()
    });
    Some(Box::new(Tripod {
        dimensions: TripodDimensions {
            inner_radius: inner_radius? * MM,
            outer_radius: outer_radius? * MM,
            rod_length: rod_length? * MM,
            rod_distance: rod_distance? * MM,
            rotation: rotation * DEG,
        },
        deviations,
        offsets: added(offsets, measured_offsets, MM),
        sizes: sizes.unwrap_or_default(),
    }))
}

impl Design for Tripod {
    fn transform(&self) -> Result<Box<dyn Kinematics>, DimensionError> {
        let Self { dimensions, deviations, offsets, .. } = self;
        Ok(if deviations.is_zero() {
            Box::new(tripod::Tripod::new(*dimensions, *offsets)?)
        } else {
            Box::new(CalibratedTripod::new(dimensions.rods(deviations)?, *offsets)?)
        })
    }

    fn model(&self, mounted: &Mounted<'_>) -> Option<Result<Model, twin_urdf::DimensionError>> {
        let Mounted { name, joint, tool } = mounted;
        let dimensions = twin_urdf::TripodDimensions {
            name: (*name).to_owned(),
            joints: [joint("A")?, joint("B")?, joint("C")?],
            // A tripod whose rods do not fit has been refused as a transform.
            rods: self.dimensions.rods(&self.deviations).ok()?,
            offsets: self.offsets,
            tool: tool.tip,
            tool_mass: tool.mass,
            tool_radius: tool.radius(),
            ..self.sizes.clone()
        };
        Some(dimensions.model())
    }

    fn fit(&self, _urdf: &AtZero<'_>) -> Option<Fit> {
        None
    }
}
