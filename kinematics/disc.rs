//! Discs of a path parameter on which the axes of a machine are analytic, with bounds of their change.
//!
//! A tool path is a map from a parameter (path length, or time) to the tool. Near one of its points it goes on into complex
//! parameters, and so do the axes, as far as no edge of the reach comes near. By Cauchy's estimate, axes that change by at
//! most B within the radius ρ have derivatives of at most k!·B/ρᵏ there: an exact bound of what lies between two points.

use crate::{AxisVector, Pose};
use nalgebra::{Vector2, Vector3};

/// A tool path about one of its points: each coordinate of p(s + σ) − p(s) − p′·σ is at most ½·bend·|σ|² for complex
/// |σ| ≤ radius, and so is the direction of the tool. Machine frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolDisc {
    /// The tool at the point.
    pub pose: Pose,
    /// p′, m per unit of the parameter.
    pub rate: Vector3<f64>,
    /// m per square of the parameter.
    pub bend: Vector3<f64>,
    /// Of the direction, rad per unit of the parameter.
    pub turn_rate: f64,
    /// Of the direction, rad per square of the parameter.
    pub turn_bend: f64,
    /// Largest |σ|; it may be infinite.
    pub radius: f64,
}

impl ToolDisc {
    /// True if the tool moves along a straight line, evenly, and turns evenly.
    pub(crate) fn is_even(&self) -> bool {
        self.bend == Vector3::zeros() && self.turn_bend <= 0.0
    }

    /// True if it only rises or falls, evenly, seen from above at rest.
    pub(crate) fn is_upright(&self) -> bool {
        self.is_even() && self.rate.xy() == Vector2::zeros() && self.turn_rate == 0.0
    }

    /// Largest motion of each coordinate of the tip within |σ| ≤ `radius`, m.
    pub fn way(&self, radius: f64) -> Vector3<f64> {
        (self.rate.abs() + self.bend * (0.5 * radius)) * radius
    }

    /// Largest turn of the tool within |σ| ≤ `radius`, rad.
    pub fn turn(&self, radius: f64) -> f64 {
        (self.turn_rate.abs() + 0.5 * self.turn_bend * radius) * radius
    }

    /// The largest radius up to [`Self::radius`] within which the tool turns by at most one radian.
    pub(crate) fn little_turn(&self) -> f64 {
        self.radius.min(first_root(self.turn_rate.abs(), 0.5 * self.turn_bend, 1.0))
    }
}

/// A disc on which axes are analytic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisDisc {
    /// Largest |σ|; 0 at the edge of the reach.
    pub radius: f64,
    /// Largest change of each axis within it, m or rad.
    pub change: AxisVector,
    /// True if all axes move as evenly as the parameter.
    pub is_even: bool,
}

/// The x above 0 at which a·x + b·x² = c, none of them negative; infinite if there is none.
pub(crate) fn first_root(a: f64, b: f64, c: f64) -> f64 {
    2.0 * c / (a + (a * a + 4.0 * b * c).sqrt())
}

/// A quadratic form |u|² of a part u of the tool path that the axes have under a root, like the distance of the wrist from
/// the first axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square {
    /// |u|.
    pub(crate) size: f64,
    /// |u·u′|.
    pub(crate) along: f64,
    /// |u′|.
    pub(crate) rate: f64,
    /// As [`ToolDisc::bend`], of u.
    pub(crate) bend: f64,
}

impl Square {
    /// Largest motion of u within `radius`.
    pub(crate) fn way(&self, radius: f64) -> f64 {
        (self.rate + 0.5 * self.bend * radius) * radius
    }

    /// Largest change of |u|² within `radius`.
    pub(crate) fn change(&self, radius: f64) -> f64 {
        let way = self.way(radius);
        (2.0 * self.along + self.size * self.bend * radius) * radius + way * way
    }

    /// The largest radius, or nearly, up to `most` within which |u|² changes by no more than `room`.
    pub(crate) fn radius(&self, room: f64, most: f64) -> f64 {
        if room <= 0.0 || room.is_nan() {
            return 0.0;
        }
        let square = self.size * self.bend + self.rate * self.rate;
        let mut radius = most.min(first_root(2.0 * self.along, square, room));
        while self.change(radius) > room {
            radius *= 0.9;
        }
        radius
    }
}

#[cfg(test)]
mod tests {
    use super::first_root;

    #[test]
    fn roots_solve_their_equation() {
        for [a, b, c] in [[2.0, 3.0, 5.0], [0.0, 4.0, 1.0], [1e-9, 1.0, 1e-20], [1e3, 1e-12, 7.0]] {
            let x = first_root(a, b, c);
            assert!(((a + b * x) * x / c - 1.0).abs() < 1e-12, "{a} {b} {c}");
        }
        assert!(first_root(0.0, 0.0, 1.0).is_infinite());
    }
}
