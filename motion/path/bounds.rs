//! Bounding box of a path.

use super::{Arc, Cubic, Ellipse, Shape};
use nalgebra::{Point2, Point3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A box with sides along the axes, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: Point3<f64>,
    /// The corner with the largest coordinates.
    pub max: Point3<f64>,
}

impl Bounds {
    /// Nothing but `point`.
    pub(crate) fn of_point(point: Point3<f64>) -> Self {
        Self { min: point, max: point }
    }

    /// With `point`.
    #[must_use]
    pub(crate) fn with_point(self, point: Point3<f64>) -> Self {
        Self {
            min: Point3::from(self.min.coords.inf(&point.coords)),
            max: Point3::from(self.max.coords.sup(&point.coords)),
        }
    }

    /// With all of `other`.
    #[must_use]
    pub fn with(self, other: &Self) -> Self {
        self.with_point(other.min).with_point(other.max)
    }

    /// Lengths of the sides, m.
    pub fn size(&self) -> [f64; 3] {
        (self.max - self.min).into()
    }
}

impl Shape {
    /// The smallest box around it, but for rounding. (Where an arc's radius grows by the rounding of a program, the
    /// box may be off by a part of that.)
    pub fn bounds(&self) -> Bounds {
        let ends = Bounds::of_point(self.start()).with_point(self.end());
        match self {
            Self::Line { .. } => ends,
            Self::Arc(arc) => of_arc(arc, ends),
            Self::Ellipse(ellipse) => of_ellipse(ellipse, ends),
            Self::Cubic(cubic) => of_cubic(cubic, ends),
        }
    }
}

/// The angles `first` + k·`step` that an arc from `start` over `sweep` passes, as parts of the sweep. A turn's worth is
/// enough.
fn passed(first: f64, step: f64, start: f64, sweep: f64) -> impl Iterator<Item = f64> {
    let begin = if sweep < 0.0 { start + sweep } else { start };
    let lowest = begin + (first - begin).rem_euclid(step);
    (0..4_u8)
        .map(move |k| lowest + f64::from(k) * step)
        .take_while(move |angle| *angle <= begin + sweep.abs())
        .map(move |angle| (angle - start) / sweep)
        .filter(|part| (0.0..=1.0).contains(part))
}

fn of_arc(arc: &Arc, ends: Bounds) -> Bounds {
    passed(0.0, FRAC_PI_2, arc.start_angle(), arc.sweep())
        .fold(ends, |bounds, part| bounds.with_point(arc.at(part * arc.length()).position))
        // The extremes of the angle say nothing about the height.
        .within(arc.plane().normal().iamax(), &ends)
}

fn of_ellipse(ellipse: &Ellipse, ends: Bounds) -> Bounds {
    let (major, start) = (ellipse.major(), ellipse.start_angle());
    let Some(side) = nalgebra::Vector2::new(-major.y, major.x).try_normalize(0.0) else {
        return ends;
    };
    let minor = side * ellipse.minor();
    let point = |angle: f64| major * angle.cos() + minor * angle.sin();
    let size = |at: Point3<f64>, angle: f64| {
        let reach = point(angle).norm();
        if reach > 0.0 { (at.xy() - ellipse.center()).norm() / reach } else { 0.0 }
    };
    let (from, to) = (size(ellipse.start(), start), size(ellipse.end(), start + ellipse.sweep()));
    let mut bounds = ends;
    for extreme in [minor.x.atan2(major.x), minor.y.atan2(major.y)] {
        for part in passed(extreme, PI, start, ellipse.sweep()) {
            let size = from + part * (to - from);
            let at = ellipse.center() + point(start + part * ellipse.sweep()) * size;
            bounds = bounds.with_point(at_height(at, &ends));
        }
    }
    bounds
}

fn of_cubic(cubic: &Cubic, ends: Bounds) -> Bounds {
    let value = |[a, b, c, d]: [f64; 4], t: f64| a + t * (b + t * (c + t * d));
    let mut bounds = ends;
    for coefficients in [cubic.x(), cubic.y()] {
        let [_, b, c, d] = coefficients;
        for t in roots(b, 2.0 * c, 3.0 * d) {
            if (0.0..=1.0).contains(&t) {
                let at = Point2::new(value(cubic.x(), t), value(cubic.y(), t));
                bounds = bounds.with_point(at_height(at, &ends));
            }
        }
    }
    bounds
}

/// Zeros of a + b·t + c·t²; NaN where there are none.
fn roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    // Without the loss of digits of the school formula.
    let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    [q / c, a / q]
}

fn at_height(at: Point2<f64>, ends: &Bounds) -> Point3<f64> {
    Point3::new(at.x, at.y, ends.min.z)
}

impl Bounds {
    /// With the extent along one axis taken from `other`.
    fn within(mut self, axis: usize, other: &Self) -> Self {
        for (to, from) in [(&mut self.min, &other.min), (&mut self.max, &other.max)] {
            if let (Some(to), Some(from)) = (to.coords.get_mut(axis), from.coords.get(axis)) {
                *to = *from;
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Plane;
    use nalgebra::Vector2;
    use proptest::prelude::*;

    fn assert_box(shape: &Shape, min: [f64; 3], max: [f64; 3]) {
        let bounds = shape.bounds();
        let off =
            (bounds.min - Point3::from(min)).amax().max((bounds.max - Point3::from(max)).amax());
        assert!(off < 1e-12, "{bounds:?}");
    }

    #[test]
    fn boxes_of_known_shapes() {
        let at = Point3::<f64>::new;
        // Three quarters of a circle of radius 2, from the bottom to the left.
        let arc = Arc::new(at(0.0, -2.0, 1.0), at(-2.0, 0.0, 3.0), Point3::origin(), 1.5 * PI);
        assert_box(&Shape::Arc(arc), [-2.0, -2.0, 1.0], [2.0, 2.0, 3.0]);
        // Half of one, clockwise over the top; in Z and X the top is at large X.
        let start = at(0.0, 5.0, 1.0);
        let arc = Arc::in_plane(Plane::Zx, start, at(0.0, 5.0, -1.0), at(0.0, 5.0, 0.0), PI);
        assert_box(&Shape::Arc(arc), [0.0, 5.0, -1.0], [1.0, 5.0, 1.0]);
        let half = Ellipse::new(
            at(3.0, 0.0, 0.0),
            at(-3.0, 0.0, 0.0),
            Point2::origin(),
            Vector2::new(3.0, 0.0),
            1.0,
            -PI,
        );
        assert_box(&Shape::Ellipse(Box::new(half)), [-3.0, -1.0, 0.0], [3.0, 0.0, 0.0]);
        // A whole ellipse at 45°: half the side of its box is √((a² + b²)/2).
        let diagonal = Vector2::new(3.0, 3.0) / 2_f64.sqrt();
        let start = Point3::new(diagonal.x, diagonal.y, 0.0);
        let whole = Ellipse::new(start, start, Point2::origin(), diagonal, 1.0, 2.0 * PI);
        let side = 5_f64.sqrt();
        assert_box(&Shape::Ellipse(Box::new(whole)), [-side, -side, 0.0], [side, side, 0.0]);
        // Vector `cnc-parabola`: the vertex is half way up to the control point.
        let parabola =
            Cubic::parabola(at(0.0, 0.0, 0.0), Point2::new(50.0, 100.0), at(100.0, 0.0, 1.0));
        assert_box(&Shape::Cubic(Box::new(parabola)), [0.0; 3], [100.0, 50.0, 1.0]);
    }

    proptest! {
        /// Every point is inside, and every side is touched.
        #[test]
        fn boxes_fit(x in prop::array::uniform4(-1.0..1.0), y in prop::array::uniform4(-1.0..1.0), start in -PI..PI, sweep in -6.2..6.2, turn in -PI..PI, minor in 0.1..2.0) {
            let major = Vector2::new(turn.cos(), turn.sin());
            let side = Vector2::new(-turn.sin(), turn.cos()) * minor;
            let on = |angle: f64| {
                let at: Vector2<f64> = major * f64::cos(angle) + side * f64::sin(angle);
                Point3::new(at.x, at.y, 0.0)
            };
            let ellipse = Ellipse::new(on(start), on(start + sweep), Point2::origin(), major, minor, sweep);
            let circle = |angle: f64| Point3::new(f64::cos(angle), f64::sin(angle), 0.0);
            let arc = Arc::new(circle(start), circle(start + sweep), Point3::origin(), sweep);
            for shape in [
                Shape::Cubic(Box::new(Cubic::new(x, y, 0.0, 0.5))),
                Shape::Ellipse(Box::new(ellipse)),
                Shape::Arc(arc),
            ] {
                let bounds = shape.bounds();
                let samples = (0..=2000).map(|i| shape.at(shape.length() * f64::from(i) / 2000.0).position);
                let sampled = samples.fold(Bounds::of_point(shape.start()), Bounds::with_point);
                // Between two samples the path gets no further away than they are apart.
                let apart = shape.length() / 2000.0;
                prop_assert!((bounds.min - sampled.min).amax() <= apart, "{bounds:?} {sampled:?}");
                prop_assert!((bounds.max - sampled.max).amax() <= apart, "{bounds:?} {sampled:?}");
                let joint = bounds.with(&sampled);
                prop_assert!((joint.min - bounds.min).amax() < 1e-12 && (joint.max - bounds.max).amax() < 1e-12);
            }
        }
    }
}
