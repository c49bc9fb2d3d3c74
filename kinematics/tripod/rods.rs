//! Dimensions of a tripod as designed, its measured deviations, and the six rods that follow from them.

use crate::error::{DimensionError, all_finite};
use nalgebra::Point3;
use std::f64::consts::FRAC_PI_3;

/// A tripod as designed (`SMC_TRAFO_Tripod`). m and rad.
///
/// ```text
///   seen from above             seen from the side
///        B                       ▮ carriage
///      ╱   ╲  ring of radius     ╲  rod, `rod_length`
///     │  ◯──┼─ A   `outer_radius` ╲
///      ╲   ╱  (upper ends)         ▬▬ platform, ring of radius `inner_radius` (lower ends)
///        C
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TripodDimensions {
    /// Radius of the circle on which the lower rod ends are: `dInnerRadius`.
    pub inner_radius: f64,
    /// Radius of the circle on which the upper rod ends are: `dOuterRadius`.
    pub outer_radius: f64,
    /// Length of the rods between their joints: `dLength`.
    pub rod_length: f64,
    /// Distance of the two rods of a pair: `dDistance`.
    pub rod_distance: f64,
    /// Direction of carriage A from the middle, from +x: `dRotationOffset`. B is 120° further, C 240°.
    pub rotation: f64,
}

/// Deviations of a measured tripod from its design; each is added to the nominal value. m and rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TripodDeviations {
    /// Of the directions of the carriages.
    pub tower_angles: [f64; 3],
    /// Of the directions of the platform's rod pairs.
    pub platform_angles: [f64; 3],
    /// Of the radius on which the upper ends of a pair are.
    pub outer_radii: [f64; 3],
    /// Of the radius on which the lower ends of a pair are.
    pub inner_radii: [f64; 3],
    /// Of the distance of a pair's upper ends.
    pub outer_distances: [f64; 3],
    /// Of the distance of a pair's lower ends.
    pub inner_distances: [f64; 3],
    /// Of the rods' lengths: pair A (right, left seen from the middle), pair B, pair C.
    pub rod_lengths: [f64; 6],
}

impl TripodDeviations {
    /// True if the tripod is as designed.
    pub fn is_zero(&self) -> bool {
        *self == Self::default()
    }
}

/// One rod of a tripod and where it ends. m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rod {
    /// The carriage that moves it, 0 to 2.
    pub carriage: usize,
    /// Its end at the carriage, machine frame, with the carriage at height 0.
    pub upper: Point3<f64>,
    /// Its end at the platform, in the frame of the platform (x, y, z as the machine's with the platform level).
    pub lower: Point3<f64>,
    /// Between the joints.
    pub length: f64,
}

impl TripodDimensions {
    /// Direction of a carriage, 0 to 2.
    pub(super) fn angle(&self, carriage: usize) -> f64 {
        let third = match carriage {
            0 => 0.0,
            1 => 2.0,
            _ => 4.0,
        };
        self.rotation + third * FRAC_PI_3
    }

    /// Overhang: distance of the middle of a pair's upper ends beyond that of its lower ends, e in the manual, m.
    pub(super) fn overhang(&self) -> Result<f64, DimensionError> {
        self.check()?;
        let outer = chord_middle(self.outer_radius, self.rod_distance)?;
        Ok(outer - chord_middle(self.inner_radius, self.rod_distance)?)
    }

    fn check(&self) -> Result<(), DimensionError> {
        let Self { inner_radius, outer_radius, rod_length, rod_distance, rotation } = *self;
        all_finite(&[inner_radius, outer_radius, rod_length, rod_distance, rotation])?;
        if rod_length <= 0.0 {
            return Err(DimensionError::RodLength { rod: 0, length: rod_length });
        }
        Ok(())
    }

    /// The six rods of the tripod that differs from this one by `deviations`: of every pair first the one to the right, seen from the middle.
    ///
    /// # Errors
    /// [`DimensionError`], if they do not fit.
    pub fn rods(&self, deviations: &TripodDeviations) -> Result<[Rod; 6], DimensionError> {
        self.check()?;
        let mut rods =
            [Rod { carriage: 0, upper: Point3::origin(), lower: Point3::origin(), length: 0.0 }; 6];
        for (index, (rod, deviation)) in rods.iter_mut().zip(deviations.rod_lengths).enumerate() {
            let carriage = index / 2;
            let side = if index % 2 == 0 { -0.5 } else { 0.5 };
            let of = |values: [f64; 3]| values[carriage];
            let end = |radius: f64, distance: f64, turned: f64| {
                let (sin, cos) = (self.angle(carriage) + turned).sin_cos();
                let (out, along) = (chord_middle(radius, distance)?, side * distance);
                Ok(Point3::new(out * cos - along * sin, out * sin + along * cos, 0.0))
            };
            *rod = Rod {
                carriage,
                upper: end(
                    self.outer_radius + of(deviations.outer_radii),
                    self.rod_distance + of(deviations.outer_distances),
                    of(deviations.tower_angles),
                )?,
                lower: end(
                    self.inner_radius + of(deviations.inner_radii),
                    self.rod_distance + of(deviations.inner_distances),
                    of(deviations.platform_angles),
                )?,
                length: self.rod_length + deviation,
            };
            if rod.length <= 0.0 {
                return Err(DimensionError::RodLength { rod: index, length: rod.length });
            }
        }
        let values = rods.iter().flat_map(|rod| rod.upper.iter().chain(rod.lower.iter()));
        all_finite(values.chain(rods.iter().map(|rod| &rod.length)))?;
        Ok(rods)
    }
}

/// Distance of the middle of a chord of the length `distance` from the middle of a circle.
fn chord_middle(radius: f64, distance: f64) -> Result<f64, DimensionError> {
    let half = 0.5 * distance;
    if radius >= half.abs() {
        Ok(((radius - half) * (radius + half)).sqrt())
    } else {
        Err(DimensionError::Ring { radius, distance })
    }
}
