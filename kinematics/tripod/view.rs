//! The normalised outputs of the manual's `SMC_TRAFOF_Tripod`, which its visualisation template shows
//! (`SMC_VISU_Tripod`; SoftMotion manual 8.2.6).

use super::rods::{TripodDeviations, TripodDimensions};
use nalgebra::{Point3, Vector3};

/// The outputs for a tripod, seen from above. Lengths are parts of the outer radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TripodView {
    /// The tool: `dnx`, `dny`.
    pub tool: [f64; 2],
    /// Inner by outer radius: `dRatioInnerOuter`.
    pub ratio: f64,
    /// The lower rod ends: `adnxi`, `adnyi`.
    pub inner: [[f64; 2]; 6],
    /// The upper rod ends: `adnxo`, `adnyo`.
    pub outer: [[f64; 2]; 6],
}

impl TripodView {
    pub(super) fn new(
        dimensions: &TripodDimensions,
        platform: &Vector3<f64>,
        tool: &Vector3<f64>,
    ) -> Self {
        let normal = |point: Vector3<f64>| {
            [point.x / dimensions.outer_radius, point.y / dimensions.outer_radius]
        };
        // Dimensions of which a tripod was made have rods.
        let rods = dimensions.rods(&TripodDeviations::default()).ok();
        let ends = |of: fn(&super::Rod) -> Point3<f64>, shift: Vector3<f64>| {
            rods.map_or([[f64::NAN; 2]; 6], |rods| rods.map(|rod| normal(of(&rod).coords + shift)))
        };
        Self {
            tool: normal(*tool),
            ratio: dimensions.inner_radius / dimensions.outer_radius,
            inner: ends(|rod| rod.lower, *platform),
            outer: ends(|rod| rod.upper, Vector3::zeros()),
        }
    }
}
