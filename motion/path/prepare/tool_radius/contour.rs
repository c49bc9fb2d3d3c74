//! Contour elements of a path, as lines and arcs.

use super::super::piece::{self, POINT_EPS, Station};
use super::super::planar::{self, Curve, Fit};
use crate::{AxisMask, ElementKind, Marks, PathElement, Shape};

/// True if the element moves in X or Y.
pub(super) fn has_way(element: &PathElement) -> bool {
    element.kind.is_motion()
        && match Curve::of(&element.shape) {
            Some(curve) => curve.length() > POINT_EPS,
            None => element.shape.length() > POINT_EPS,
        }
}

/// True if the element can be done wherever the path is in X and Y. A probing move and a jump are where they are.
pub(super) fn stands(element: &PathElement) -> bool {
    !matches!(element.kind, ElementKind::Jump | ElementKind::Probe { .. }) && !has_way(element)
}

/// True if the element can be led to an offset: it is a positioning, and not along Z alone.
pub(super) fn is_positioning(element: &PathElement) -> bool {
    element.kind == ElementKind::Rapid
        && matches!(element.shape, Shape::Line { .. })
        && (has_way(element) || element.shape.length() <= POINT_EPS)
}

/// The element as lines and arcs. Axes that move with the S profile have its values where the pieces meet and go
/// linearly between them.
pub(super) fn simple_pieces(element: &PathElement, tolerance: f64) -> Vec<(PathElement, Curve)> {
    let fits = planar::fit(&element.shape, tolerance);
    let count = fits.len();
    let ends = piece::end_marks(element.marks);
    fits.into_iter()
        .enumerate()
        .map(|(index, Fit { curve, from, to })| {
            let mut piece = piece::part(element, from, to);
            let (start, end) = (Station::at(element, from), Station::at(element, to));
            piece.shape = curve.shape(start.point.z, end.point.z);
            if let Some(details) = &mut piece.details {
                details.s_profile = AxisMask::default();
            }
            let mut marks = Marks::default();
            if index == 0 {
                marks = marks.with(element.marks.without(ends));
            }
            if index + 1 == count {
                marks = marks.with(ends);
            }
            piece.marks = marks;
            (piece, curve)
        })
        .collect()
}
