//! Arcs of G2 and G3, with LinuxCNC's tolerances.

use super::LengthUnit;
use super::error::DecodeError;
use nalgebra::{Point3, Vector2};
use std::f64::consts::{SQRT_2, TAU};
use twin_path::{Arc, Plane};

/// Radii below this are zero, and R may be this much less than half the chord, m: 0.00005 inches.
const SMALL: f64 = 0.000_05 * 0.0254;

/// Largest difference of the radii at start and end as a part of the larger one, beyond [`spiral`].
const SPIRAL_RELATIVE: f64 = 1e-3;

/// Arcs about a centre that turn by less than this, rad, and whose ends are as near as [`SAME_POINT`], are full turns.
const SAME_ANGLE: f64 = 1e-6;

/// See [`SAME_ANGLE`], m.
const SAME_POINT: f64 = 1e-6;

/// Start and end of an arc by R closer than this are the same point, m.
const NO_CHORD: f64 = 1e-12;

/// Half a chord is the radius if it is this near to it, as part of it.
const SEMICIRCLE: f64 = 1e-12;

/// Largest difference of the radii at start and end, however small they are, m: the rounding of programs with two
/// decimals (mm) or three (inches). Hundred times as much is too much for any radius.
fn spiral(units: LengthUnit) -> f64 {
    SQRT_2
        * match units {
            LengthUnit::Millimetre => 2e-5,
            LengthUnit::Inch => 0.002 * 0.0254,
        }
}

/// An arc to be, but for what says where its centre is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    pub(super) plane: Plane,
    pub(super) start: Point3<f64>,
    pub(super) end: Point3<f64>,
    pub(super) clockwise: bool,
    /// Turns that are begun (P), at least 1.
    pub(super) turns: u32,
}

impl Ends {
    /// The components of `point` in the plane.
    fn in_plane(&self, point: &Point3<f64>) -> Vector2<f64> {
        let [first, second, _] = self.plane.split(&point.coords);
        Vector2::new(first, second)
    }

    fn side(&self) -> f64 {
        if self.clockwise { -1.0 } else { 1.0 }
    }

    fn arc(&self, center: Vector2<f64>, sweep: f64) -> Arc {
        let [_, _, height] = self.plane.split(&self.start.coords);
        let center = Point3::from(self.plane.join([center.x, center.y, height]));
        let more = self.side() * TAU * (f64::from(self.turns) - 1.0);
        Arc::in_plane(self.plane, self.start, self.end, center, sweep + more)
    }

    /// The arc of `radius`, m: the smaller one, or the larger one if it is negative.
    ///
    /// # Errors
    /// [`DecodeError::RadiusTooSmall`] and [`DecodeError::RadiusWithoutChord`].
    pub(super) fn by_radius(&self, radius: f64) -> Result<Arc, DecodeError> {
        let (start, end) = (self.in_plane(&self.start), self.in_plane(&self.end));
        let chord = end - start;
        let half = chord.norm() / 2.0;
        if half <= NO_CHORD / 2.0 {
            return Err(DecodeError::RadiusWithoutChord);
        }
        let size = radius.abs();
        if half - size > SMALL {
            return Err(DecodeError::RadiusTooSmall {
                radius_mm: size * 1e3,
                half_chord_mm: half * 1e3,
            });
        }
        // From the middle of the chord to the centre.
        let height = if half / size > 1.0 - SEMICIRCLE {
            0.0
        } else {
            ((size - half) * (size + half)).sqrt()
        };
        let large = radius < 0.0;
        let left = Vector2::new(-chord.y, chord.x) / (2.0 * half);
        let to_center = if large { -self.side() } else { self.side() };
        let center = (start + end) / 2.0 + left * (to_center * height);
        let smaller = 2.0 * half.atan2(height);
        let sweep = if large { TAU - smaller } else { smaller };
        Ok(self.arc(center, self.side() * sweep))
    }

    /// The arc about `center` (m; its component along the normal does not matter), of any angle; a full turn if start
    /// and end are the same point.
    ///
    /// # Errors
    /// [`DecodeError::ZeroRadius`] and [`DecodeError::CenterMismatch`].
    pub(super) fn about_center(
        &self,
        center: &Point3<f64>,
        units: LengthUnit,
    ) -> Result<Arc, DecodeError> {
        let (start, end) = (self.in_plane(&self.start), self.in_plane(&self.end));
        let center = self.in_plane(center);
        let (from, to) = (start - center, end - center);
        let radii = [from.norm(), to.norm()];
        let radii_mm = radii.map(|radius| radius * 1e3);
        let (smaller, larger) = (radii[0].min(radii[1]), radii[0].max(radii[1]));
        if smaller < SMALL {
            return Err(DecodeError::ZeroRadius(radii_mm));
        }
        let (difference, spiral) = (larger - smaller, spiral(units));
        if difference > 100.0 * spiral
            || (difference > spiral && difference > SPIRAL_RELATIVE * larger)
        {
            return Err(DecodeError::CenterMismatch(radii_mm));
        }
        // The cross product with the chord equals that with `to` and keeps its digits on short arcs.
        let chord = end - start;
        let angle = self.side() * from.perp(&chord).atan2(from.dot(&to));
        let same = angle.abs() <= SAME_ANGLE && chord.norm() <= SAME_POINT;
        let sweep = if same || angle <= 0.0 { angle + TAU } else { angle };
        Ok(self.arc(center, self.side() * sweep))
    }
}
