//! Cubic curves: pieces of splines (G5), parabolas (G6), and smoothed corners.

use super::PathPoint;
use super::curve::{CHANGE, Curve, Planar, first_root};
use nalgebra::{Point2, Point3, Vector2};

/// A cubic in X and Y over a parameter t from 0 to 1, with Z linear in the path length: the manual's `SPLINE`.
#[derive(Clone, Debug, PartialEq)]
pub struct Cubic {
    curve: Curve<Form>,
}

/// `x = x₀ + x₁·t + x₂·t² + x₃·t³`, y alike.
#[derive(Clone, Debug, PartialEq)]
struct Form {
    x: [f64; 4],
    y: [f64; 4],
}

impl Planar for Form {
    fn at(&self, t: f64) -> (Point2<f64>, Vector2<f64>, Vector2<f64>) {
        let value = |[a, b, c, d]: [f64; 4]| a + t * (b + t * (c + t * d));
        let first = |[_, b, c, d]: [f64; 4]| b + t * (2.0 * c + t * (3.0 * d));
        let second = |[_, _, c, d]: [f64; 4]| 2.0 * c + t * (6.0 * d);
        (
            Point2::new(value(self.x), value(self.y)),
            Vector2::new(first(self.x), first(self.y)),
            Vector2::new(second(self.x), second(self.y)),
        )
    }

    fn third(&self, _: f64) -> Vector2<f64> {
        let ([_, _, _, x], [_, _, _, y]) = (self.x, self.y);
        Vector2::new(6.0 * x, 6.0 * y)
    }

    fn fourth(&self, _: f64) -> Vector2<f64> {
        Vector2::zeros()
    }

    fn room(&self, t: f64, first: f64, second: f64) -> f64 {
        first_root(second, 0.5 * self.third(t).norm(), CHANGE * first)
    }
}

impl Cubic {
    /// The curve with the coefficients `x` and `y` (`dP1` to `dP4` and `dP5` to `dP8`, m, of t⁰ to t³) and the heights
    /// `start_z` and `end_z`.
    pub fn new(x: [f64; 4], y: [f64; 4], start_z: f64, end_z: f64) -> Self {
        let sum = |[a, b, c, d]: [f64; 4]| a + (b + (c + d));
        let start = Point3::new(x[0], y[0], start_z);
        Self::between(start, Point3::new(sum(x), sum(y), end_z), x, y)
    }

    /// With its ends as given: the sums of the coefficients differ by rounding.
    pub(super) fn between(start: Point3<f64>, end: Point3<f64>, x: [f64; 4], y: [f64; 4]) -> Self {
        Self { curve: Curve::new(Form { x, y }, start, end) }
    }

    /// The cubic from `start` to `end` (m) with these derivatives with respect to t at its ends (m): Hermite's form.
    pub fn hermite(
        start: Point3<f64>,
        end: Point3<f64>,
        start_tangent: Vector2<f64>,
        end_tangent: Vector2<f64>,
    ) -> Self {
        let coefficients = |p0: f64, p1: f64, m0: f64, m1: f64| {
            [p0, m0, 3.0 * (p1 - p0) - 2.0 * m0 - m1, 2.0 * (p0 - p1) + m0 + m1]
        };
        let x = coefficients(start.x, end.x, start_tangent.x, end_tangent.x);
        let y = coefficients(start.y, end.y, start_tangent.y, end_tangent.y);
        Self::between(start, end, x, y)
    }

    /// The parabola from `start` to `end` (m) whose tangents there meet at `control` (G6, manual 3.2: I and J): the
    /// quadratic Bézier curve of the three.
    pub fn parabola(start: Point3<f64>, control: Point2<f64>, end: Point3<f64>) -> Self {
        let coefficients =
            |p0: f64, p1: f64, p2: f64| [p0, 2.0 * (p1 - p0), p0 - 2.0 * p1 + p2, 0.0];
        let x = coefficients(start.x, control.x, end.x);
        let y = coefficients(start.y, control.y, end.y);
        Self::between(start, end, x, y)
    }

    /// Coefficients of X, m (`dP1` to `dP4`).
    pub fn x(&self) -> [f64; 4] {
        self.curve.form.x
    }

    /// Coefficients of Y, m (`dP5` to `dP8`).
    pub fn y(&self) -> [f64; 4] {
        self.curve.form.y
    }

    /// True if the cubic term is zero: a parabola.
    pub fn is_parabola(&self) -> bool {
        self.x()[3] == 0.0 && self.y()[3] == 0.0
    }

    /// Start, m.
    pub fn start(&self) -> Point3<f64> {
        self.curve.start()
    }

    /// End, m.
    pub fn end(&self) -> Point3<f64> {
        self.curve.end()
    }

    /// Path length, m.
    pub fn length(&self) -> f64 {
        self.curve.length()
    }

    pub(super) fn at(&self, s: f64) -> PathPoint {
        self.curve.at(s)
    }

    pub(super) fn fourth(&self, s: f64) -> Vector2<f64> {
        self.curve.fourth(s)
    }

    pub(super) fn disc(&self, s: f64) -> [f64; 2] {
        self.curve.disc(s)
    }

    /// The part between two path lengths, from `start` to `end`.
    pub(super) fn section(&self, range: [f64; 2], start: Point3<f64>, end: Point3<f64>) -> Self {
        let [from, to] = range.map(|s| self.curve.parameter(s));
        let width = to - from;
        // The polynomial about `from`, over a parameter `width` times as fast.
        let shifted = |[a, b, c, d]: [f64; 4]| {
            let t = from;
            [
                a + t * (b + t * (c + t * d)),
                (b + t * (2.0 * c + t * 3.0 * d)) * width,
                (c + 3.0 * d * t) * width * width,
                d * width * width * width,
            ]
        };
        Self::between(start, end, shifted(self.x()), shifted(self.y()))
    }

    pub(super) fn reversed(&self) -> Self {
        let backwards =
            |[a, b, c, d]: [f64; 4]| [a + b + c + d, -(b + 2.0 * c + 3.0 * d), c + 3.0 * d, -d];
        Self::between(self.end(), self.start(), backwards(self.x()), backwards(self.y()))
    }

    /// Every point moved by `map`, an affine map whose linear part is `turn` times `scale`.
    pub(super) fn mapped(
        &self,
        map: &dyn Fn(Point3<f64>) -> Point3<f64>,
        turn: &dyn Fn(Vector2<f64>) -> Vector2<f64>,
        scale: f64,
    ) -> Self {
        let (x, y) = (self.x(), self.y());
        let origin = map(Point3::new(x[0], y[0], 0.0));
        let mut turned = [[origin.x, 0.0, 0.0, 0.0], [origin.y, 0.0, 0.0, 0.0]];
        for ((x, y), power) in x.iter().zip(&y).zip(0..).skip(1) {
            let vector = turn(Vector2::new(*x, *y)) * scale;
            for (row, value) in turned.iter_mut().zip([vector.x, vector.y]) {
                if let Some(slot) = row.get_mut::<usize>(power) {
                    *slot = value;
                }
            }
        }
        let [x, y] = turned;
        Self::between(map(self.start()), map(self.end()), x, y)
    }
}

/// The derivative at an inner point of a cardinal spline (G5, manual 3.2.6): half the way from the point before to the
/// point after.
pub fn cardinal_tangent(previous: Point2<f64>, next: Point2<f64>) -> Vector2<f64> {
    (next - previous) / 2.0
}

/// The derivative at an end of a spline, where the path goes on in (or comes from) `direction`, or on its own chord if
/// it does neither: as long as the chord.
pub fn end_tangent(chord: Vector2<f64>, direction: Option<Vector2<f64>>) -> Vector2<f64> {
    direction
        .and_then(|direction| direction.try_normalize(0.0))
        .map_or(chord, |direction| direction * chord.norm())
}
