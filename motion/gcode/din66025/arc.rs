//! Arcs of G2 and G3 from centre or radius (manual 3.2.4).

use super::error::DecodeError;
use nalgebra::{Point2, Point3, Vector2};
use std::f64::consts::TAU;
use twin_path::Arc;

/// Largest difference of the distances of start and end from the centre, m. The manual wants them equal and gives no
/// number; programs with three decimals are off by up to 3 µm.
const RADIUS_TOLERANCE: f64 = 5e-6;

/// Start and end closer than this are the same point, m (manual 6.4, `g_fSMC_CNC_EPS_RELUCTANT`).
const SAME_POINT: f64 = 1e-9;

/// A radius this little above half the chord means a semicircle: the difference is that of decimal and binary
/// numbers, m.
const SEMICIRCLE: f64 = 1e-15;

/// The arc from `start` to `end` with `radius` (m): of the two possible ones the smaller, at most a semicircle.
///
/// # Errors
/// [`DecodeError::RadiusTooSmall`] and [`DecodeError::RadiusWithoutChord`].
pub(super) fn by_radius(
    start: Point3<f64>,
    end: Point3<f64>,
    radius: f64,
    clockwise: bool,
) -> Result<Arc, DecodeError> {
    let chord = (end - start).xy();
    let half = chord.norm() / 2.0;
    if 2.0 * half <= SAME_POINT {
        return Err(DecodeError::RadiusWithoutChord { radius_mm: shown(radius) });
    }
    if radius < half - RADIUS_TOLERANCE {
        return Err(DecodeError::RadiusTooSmall {
            radius_mm: shown(radius),
            half_chord_mm: shown(half),
        });
    }
    // From the middle of the chord to the centre; nothing if rounding made the radius of a semicircle too small.
    let excess = if radius - half > SEMICIRCLE { radius - half } else { 0.0 };
    let height = (excess * (radius + half)).sqrt();
    let left = Vector2::new(-chord.y, chord.x) / (2.0 * half);
    let side = if clockwise { -1.0 } else { 1.0 };
    let center = nalgebra::center(&start.xy(), &end.xy()) + left * (side * height);
    let sweep = side * 2.0 * half.atan2(height);
    Ok(Arc::new(start, end, at_height(center, start.z), sweep))
}

/// The arc from `start` to `end` about `center` (m), of any angle; a full circle if start and end are the same point.
///
/// # Errors
/// [`DecodeError::CenterMismatch`] and [`DecodeError::CenterAtStart`].
pub(super) fn about_center(
    start: Point3<f64>,
    end: Point3<f64>,
    center: Point2<f64>,
    clockwise: bool,
) -> Result<Arc, DecodeError> {
    let (from, to) = (start.xy() - center, end.xy() - center);
    let (start_radius, end_radius) = (from.norm(), to.norm());
    // A deviation of a tenth of the radius is not rounding, however small.
    let tolerance = RADIUS_TOLERANCE.min(0.1 * start_radius);
    if start_radius <= SAME_POINT {
        return Err(DecodeError::CenterAtStart);
    }
    if (start_radius - end_radius).abs() > tolerance {
        return Err(DecodeError::CenterMismatch {
            start_radius_mm: shown(start_radius),
            end_radius_mm: shown(end_radius),
        });
    }
    let chord = (end - start).xy();
    let turn = if clockwise { -TAU } else { TAU };
    let sweep = if chord.norm() <= SAME_POINT {
        turn
    } else {
        // The cross product with the chord equals that with `to` and keeps its digits on short arcs.
        let angle = from.perp(&chord).atan2(from.dot(&to));
        if angle * turn > 0.0 { angle } else { angle + turn }
    };
    Ok(Arc::new(start, end, at_height(center, start.z), sweep))
}

/// Metres as mm for a message, to the nanometre.
fn shown(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e6
}

fn at_height(point: Point2<f64>, z: f64) -> Point3<f64> {
    Point3::new(point.x, point.y, z)
}
