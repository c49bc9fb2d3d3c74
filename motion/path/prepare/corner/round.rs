//! Corner rounding by arcs (`SMC_RoundPath`, manual 6.2.6).

use super::{Corner, CornerStyle, Corners, Stage};
use crate::{Arc, Marks, Shape};
use nalgebra::{Point3, Vector2};
use std::f64::consts::PI;

/// Arcs of a larger sweep than this are no rounding of a corner: the path turns back on itself.
const LARGEST_TURN: f64 = PI - 1e-6;

/// Replaces corners between lines by arcs between [`Marks::ROUNDING`] (G52) and [`Marks::CORNERS_END`] (G50)
/// (`SMC_RoundPath`).
///
/// Both lines are cut at the distance `distance` from the corner, or at D of the first where that is 0, and an arc
/// tangent to both joins them; its radius is `distance` / tan(φ/2) where the path turns by φ. See [`Corners`] for what
/// happens to everything else.
pub type RoundPath<I, E> = Corners<I, E, Rounding>;

/// Corner style of [`RoundPath`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounding {
    /// Distance from the corner at which lines are cut, m; 0 takes D of the first line (`dRadius`).
    pub distance: f64,
    /// Turns up to this stay as they are, rad (`dAngleTol`).
    pub angle_tolerance: f64,
}

impl CornerStyle for Rounding {
    const BEGIN: Marks = Marks::ROUNDING;
    const STAGE: Stage = Stage::Rounding;

    fn angle_tolerance(&self) -> f64 {
        self.angle_tolerance
    }

    fn distance(&self, programmed: f64) -> f64 {
        if self.distance == 0.0 { programmed } else { self.distance }
    }

    fn joins(&self, shape: &Shape) -> bool {
        matches!(shape, Shape::Line { .. })
    }

    fn shape(&self, corner: &Corner) -> Option<Shape> {
        let (a, b) = (corner.start_direction, corner.end_direction);
        let turn = a.perp(&b).atan2(a.dot(&b));
        if turn.abs() > LARGEST_TURN {
            return None;
        }
        // Positive with the centre on the left.
        let radius = corner.distance / (0.5 * turn).tan();
        let left = Vector2::new(-a.y, a.x);
        let center = corner.start.xy() + left * radius;
        let center = Point3::new(center.x, center.y, corner.start.z);
        Some(Shape::Arc(Arc::new(corner.start, corner.end, center, turn)))
    }
}
