//! Corner smoothing by splines (`SMC_SmoothPath`, manual 6.2.5).

use super::{Corner, CornerStyle, Corners, Stage};
use crate::{Cubic, Marks, Shape};

/// Replaces corners between [`Marks::SMOOTHING`] (G51) and [`Marks::CORNERS_END`] (G50) by splines
/// (`SMC_SmoothPath`).
///
/// A circle about the corner, of radius `edge_distance` + D of the first element, cuts both elements; a cubic spline
/// with their directions at the cuts joins them. At either end it is a chord long (the derivative by its parameter from
/// 0 to 1). See [`Corners`] for what happens to everything else.
pub type SmoothPath<I, E> = Corners<I, E, Smoothing>;

/// Corner style of [`SmoothPath`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Smoothing {
    /// Distance from the corner at which elements are cut, m; D of the first element is added (`dEdgeDistance`).
    pub edge_distance: f64,
    /// Turns up to this stay as they are, rad (`dAngleTol`).
    pub angle_tolerance: f64,
}

impl CornerStyle for Smoothing {
    const BEGIN: Marks = Marks::SMOOTHING;
    const STAGE: Stage = Stage::Smoothing;

    fn angle_tolerance(&self) -> f64 {
        self.angle_tolerance
    }

    fn distance(&self, programmed: f64) -> f64 {
        self.edge_distance + programmed
    }

    fn joins(&self, _shape: &Shape) -> bool {
        true
    }

    fn shape(&self, corner: &Corner) -> Option<Shape> {
        let chord = (corner.end - corner.start).xy().norm();
        // A path that turns back on itself leaves nothing to join.
        (chord > super::POINT_EPS).then(|| {
            Shape::Cubic(Box::new(Cubic::hermite(
                corner.start,
                corner.end,
                corner.start_direction * chord,
                corner.end_direction * chord,
            )))
        })
    }
}
