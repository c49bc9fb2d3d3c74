//! Deviation of a blend from the path.

use super::{Blend, BlendedPoint};
use nalgebra::{SVector, Vector3};
use twin_path::ExtraPoint;

/// Over each of them the first derivative of the original path changes by no more than this, so that a cubic between
/// their ends says what is inside.
const BEND: f64 = 0.3;

/// With the extra axes where they are at the joint, if the element does not know them.
pub(super) fn completed(mut point: BlendedPoint, joint: &BlendedPoint) -> BlendedPoint {
    point.extra = point.extra.or(joint.extra);
    point
}

/// Compares blend and path.
pub(super) struct Check<'a> {
    pub(super) blend: &'a Blend,
    pub(super) tolerance: f64,
    pub(super) extra_tolerance: f64,
    /// Largest so far, as a part of the tolerance.
    pub(super) deviation: f64,
    /// Lowest speed of the blend and of the path so far, in space or else of the extra axes.
    pub(super) slowest: [f64; 2],
    pub(super) coarse: bool,
}

/// Deviation and its derivative, in space and of the extra axes, and the derivative of the path.
struct Deviation {
    way: f64,
    space: [Vector3<f64>; 2],
    extra: [SVector<f64, 5>; 2],
    original: Vector3<f64>,
}

impl Check<'_> {
    /// Goes along the points of the path on one side of the joint.
    pub(super) fn side(&mut self, points: impl Iterator<Item = (f64, BlendedPoint)>) {
        let mut last: Option<Deviation> = None;
        for (way, point) in points {
            let here = self.deviation(way, &point);
            if let Some(last) = &last {
                self.interval(last, &here);
            }
            last = Some(here);
        }
    }

    fn deviation(&mut self, way: f64, point: &BlendedPoint) -> Deviation {
        let blended = self.blend.at(way);
        let [new, old] = [blended.extra, point.extra].map(Option::<ExtraPoint>::unwrap_or_default);
        let speeds = if point.first == Vector3::zeros() && blended.first == Vector3::zeros() {
            [new, old].map(|extra| SVector::from(extra.first).norm())
        } else {
            [blended.first.norm(), point.first.norm()]
        };
        for (slowest, speed) in self.slowest.iter_mut().zip(speeds) {
            *slowest = slowest.min(speed);
        }
        Deviation {
            way,
            space: [blended.position - point.position, blended.first - point.first],
            extra: [
                SVector::from(new.position) - SVector::from(old.position),
                SVector::from(new.first) - SVector::from(old.first),
            ],
            original: point.first,
        }
    }

    /// Bounds the deviation between two points by the Bézier points of the cubic that has its values and derivatives:
    /// no point of the cubic is outside of their hull.
    fn interval(&mut self, from: &Deviation, to: &Deviation) {
        let third = (to.way - from.way) / 3.0;
        let space = hull(from.space, to.space, third).map(|point| point.norm() / self.tolerance);
        let extra = hull(from.extra, to.extra, third).map(|u| u.amax() / self.extra_tolerance);
        for part in space.into_iter().chain(extra) {
            // Zero divided by a tolerance of zero is no deviation; of what is not a number the blend is rid already.
            if part > self.deviation {
                self.deviation = part;
            }
        }
        self.coarse |= (to.original - from.original).norm() > BEND;
    }
}

fn hull<const N: usize>(
    from: [SVector<f64, N>; 2],
    to: [SVector<f64, N>; 2],
    third: f64,
) -> [SVector<f64, N>; 4] {
    let ([from, leaving], [to, arriving]) = (from, to);
    [from, from + leaving * third, to - arriving * third, to]
}
