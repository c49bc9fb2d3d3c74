//! Continuation of a path into complex path lengths about one of its points, for bounds of what lies between points.

use super::{AxisMask, ExtraPosition, PathElement, Shape};
use nalgebra::Vector3;
use std::f64::consts::E;

/// A path about one of its points: each coordinate of p(s + σ) − p(s) − p′·σ is at most ½·bend·|σ|² for complex
/// |σ| ≤ radius, and so are the extra axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathDisc {
    /// Largest |σ|, m; it may be infinite.
    pub radius: f64,
    /// 1/m.
    pub bend: Vector3<f64>,
    /// Of the extra axes, u/m².
    pub extra_bend: ExtraPosition,
}

impl PathDisc {
    /// Of a straight line.
    pub const STRAIGHT: Self =
        Self { radius: f64::INFINITY, bend: Vector3::new(0.0, 0.0, 0.0), extra_bend: [0.0; 5] };
}

/// Second derivative of the S profile by parts of the length, at up to two lengths from its start, at most:
/// 60·u + 180·u² + 120·u³.
const S_PROFILE: f64 = 1_800.0;

impl PathElement {
    /// Disc about `s` (m) of complex path lengths on which the element is analytic.
    pub fn disc(&self, s: f64) -> PathDisc {
        let (radius, bend) = self.shape.disc(s);
        let mut disc = PathDisc { radius, bend, ..PathDisc::STRAIGHT };
        let Some(details) = self.details.as_ref().filter(|details| details.s_profile.0 != 0) else {
            return disc;
        };
        let length = self.length();
        disc.radius = disc.radius.min(length);
        let bend = |change: f64| S_PROFILE * change.abs() / (length * length);
        if details.s_profile.contains(AxisMask::Z) {
            disc.bend.z += bend(self.end().z - self.start().z);
        }
        if let Some(extra) = details.extra {
            let ends = extra.start.iter().zip(extra.end);
            for (index, (slot, (start, end))) in disc.extra_bend.iter_mut().zip(ends).enumerate() {
                if details.s_profile.contains(AxisMask::extra(index)) {
                    *slot = bend(end - start);
                }
            }
        }
        disc
    }
}

impl Shape {
    /// Radius and bend about `s` m from the start, as [`PathDisc`].
    fn disc(&self, s: f64) -> (f64, Vector3<f64>) {
        let level = |[radius, bend]: [f64; 2]| (radius, Vector3::new(bend, bend, 0.0));
        match self {
            Self::Line { .. } => (f64::INFINITY, Vector3::zeros()),
            Self::Arc(arc) => {
                // Within one radian e^z − 1 − z is at most ½·e·z².
                let turn = (arc.sweep() / arc.length()).abs();
                let widening = ((arc.end_radius() - arc.radius()) / arc.length()).abs();
                let largest = arc.radius().max(arc.end_radius()) + widening / turn;
                let bend = E * (largest * turn + 2.0 * widening) * turn;
                let radius = if bend.is_finite() { 1.0 / turn } else { 0.0 };
                (radius, Vector3::from(arc.plane().join([bend, bend, 0.0])))
            }
            Self::Ellipse(ellipse) => level(ellipse.disc(s)),
            Self::Cubic(cubic) => level(cubic.disc(s)),
        }
    }
}
