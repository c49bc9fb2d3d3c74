//! Corners in the plane: the tool's centre where two moves meet.
//!
//! The tool is to the left of both. `radius` is that of the tool, `center` a centre of an arc. An arc that turns to the
//! left has the tool inside.

use nalgebra::{Point3, Vector2, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use twin_path::Plane;

/// LinuxCNC's tolerance of corners, rad: moves whose directions differ by less meet without a corner.
const TANGENT: f64 = 0.05;

/// Components of a plane, mirrored if the tool is to the right of the contour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) plane: Plane,
    /// −1 if it is mirrored, else 1.
    pub(super) side: f64,
}

impl Default for Frame {
    fn default() -> Self {
        Self::new(Plane::Xy, true)
    }
}

impl Frame {
    pub(super) fn new(plane: Plane, left: bool) -> Self {
        Self { plane, side: if left { 1.0 } else { -1.0 } }
    }

    /// The components in the plane of a point of the machine frame, and its height along the normal, m.
    pub(super) fn flat(&self, point: [f64; 3]) -> (Vector2<f64>, f64) {
        let [first, second, height] = self.plane.split(&Vector3::from(point));
        (Vector2::new(first, self.side * second), height)
    }

    /// The inverse of [`Self::flat`].
    pub(super) fn point(&self, at: Vector2<f64>, height: f64) -> Point3<f64> {
        Point3::from(self.plane.join([at.x, self.side * at.y, height]))
    }
}

/// `vector` turned by a quarter to the left.
pub(super) fn left(vector: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-vector.y, vector.x)
}

/// `vector` turned by a quarter to the right.
pub(super) fn right(vector: Vector2<f64>) -> Vector2<f64> {
    -left(vector)
}

/// Angle of an arc from `start` to `end`, rad, positive to the left. `turns` is the number of turns that are begun,
/// with the sign of the angle.
pub(super) fn sweep(
    start: Vector2<f64>,
    center: Vector2<f64>,
    turns: f64,
    end: Vector2<f64>,
) -> f64 {
    let angle = |point: Vector2<f64>| (point.y - center.y).atan2(point.x - center.x);
    let side = turns.signum();
    let part = side * (angle(end) - angle(start));
    let part = if part <= 0.0 { part + TAU } else { part };
    side * (part + (turns.abs() - 1.0) * TAU)
}

/// Kind of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Corner {
    /// The tool does not reach it: the offset moves meet before. The angle is that of the right turn, rad.
    Inner(f64),
    /// The tool goes around it.
    Outer,
    /// None: the moves go on in one direction.
    Tangent,
}

impl Corner {
    /// The corner between a move that ends in the direction `before` and one that begins in `behind`, both of length 1.
    /// `back_is_inner`: a reversal of direction is an inner corner, because an arc with the tool outside is part of it.
    pub(super) fn between(before: Vector2<f64>, behind: Vector2<f64>, back_is_inner: bool) -> Self {
        // The right turn, −π/2 to 3π/2.
        let turn = -before.perp(&behind).atan2(before.dot(&behind));
        let turn = if turn < -FRAC_PI_2 { turn + TAU } else { turn };
        let back = if back_is_inner { PI - TANGENT } else { PI + TANGENT };
        if turn < -TANGENT || turn > back {
            Self::Inner(turn)
        } else if turn > TANGENT {
            Self::Outer
        } else {
            Self::Tangent
        }
    }
}

/// An arc that is met: its centre and the radius of the tool's path about it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    pub(super) center: Vector2<f64>,
    pub(super) radius: f64,
    /// The sign of its angle.
    pub(super) side: f64,
}

/// Corner of two lines: `end` is the tool's centre next to the corner, at the end of the first, whose direction is
/// `along`.
pub(super) fn line_to_line(
    end: Vector2<f64>,
    along: Vector2<f64>,
    turn: f64,
    radius: f64,
) -> Vector2<f64> {
    end - along * (radius / f64::midpoint(turn, PI).tan())
}

/// Corner of an arc and a line that begins in `corner` with the direction `along`. None if they do not meet.
pub(super) fn arc_to_line(
    arc: Circle,
    corner: Vector2<f64>,
    along: Vector2<f64>,
    radius: f64,
) -> Option<Vector2<f64>> {
    // LinuxCNC's distance of the corner from the centre. It differs where an entry arc turns about a point on the other
    // side of its end.
    let distance = arc.radius + arc.side * radius;
    let height = (arc.center - corner).normalize().dot(&left(along)) * distance - radius;
    let half = half_chord(arc.radius, height)?;
    Some(arc.center - left(along) * height - along * (arc.side * half))
}

/// Corner of a line with the direction `along` and an arc that begins in the direction `tangent`. None if they do not
/// meet.
pub(super) fn line_to_arc(
    along: Vector2<f64>,
    tangent: Vector2<f64>,
    arc: Circle,
    radius: f64,
) -> Option<Vector2<f64>> {
    // Of the centre above the line on which the tool moves.
    let programmed = arc.radius + arc.side * radius;
    let height = arc.side * programmed * along.dot(&tangent) - radius;
    let half = half_chord(arc.radius, height)?;
    Some(arc.center - left(along) * height + along * (arc.side * half))
}

/// Corner of two arcs. None if they do not meet.
pub(super) fn arc_to_arc(before: Circle, behind: Circle) -> Option<Vector2<f64>> {
    let between = behind.center - before.center;
    let distance = between.norm();
    if before.radius <= 0.0 || distance <= 0.0 {
        return None;
    }
    let part =
        (before.radius.powi(2) + distance.powi(2) - behind.radius.powi(2)) / (2.0 * distance);
    let half = half_chord(before.radius, part)?;
    let along = between / distance;
    Some(before.center + along * part + left(along) * (before.side * behind.side * half))
}

/// Half the chord of a circle at `height` from its centre; none beyond the circle.
fn half_chord(radius: f64, height: f64) -> Option<f64> {
    (height.abs() <= radius.abs()).then(|| ((radius - height) * (radius + height)).sqrt())
}
