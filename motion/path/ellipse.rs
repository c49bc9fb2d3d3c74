//! Elliptic arcs (G8, G9).

use super::PathPoint;
use super::curve::{CHANGE, Curve, Planar, first_root};
use nalgebra::{Point2, Point3, Vector2};
use std::f64::consts::{E, TAU};

/// Tolerance of the end of an ellipse that is given by its ratio, as a part of its size. Programs with three decimals
/// need it.
const FIT_TOLERANCE: f64 = 1e-4;
/// Below this part the two equations of start and end say the same, and the ratio R is needed.
const AMBIGUOUS: f64 = 1e-6;

/// An arc of an ellipse in X and Y with Z linear in the path length: the manual's `ELLCLW` and `ELLCCLW`.
///
/// As with [`super::Arc`] start and end are kept as programmed; where they are not exactly on the ellipse, it grows
/// linearly with the angle from the one to the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Ellipse {
    curve: Curve<Form>,
}

/// `center + (size + growth·t)·(major·cos θ + minor·sin θ)`, θ = start angle + t·sweep.
#[derive(Clone, Debug, PartialEq)]
struct Form {
    center: Point2<f64>,
    major: Vector2<f64>,
    minor: Vector2<f64>,
    /// Length of `minor` as given: that of the vector differs by rounding.
    minor_length: f64,
    start_angle: f64,
    sweep: f64,
    size: f64,
    growth: f64,
}

impl Planar for Form {
    fn at(&self, t: f64) -> (Point2<f64>, Vector2<f64>, Vector2<f64>) {
        let (sin, cos) = (self.start_angle + t * self.sweep).sin_cos();
        let outward = self.major * cos + self.minor * sin;
        let around = (self.minor * cos - self.major * sin) * self.sweep;
        let size = self.size + t * self.growth;
        (
            self.center + outward * size,
            around * size + outward * self.growth,
            around * (2.0 * self.growth) - outward * (size * self.sweep * self.sweep),
        )
    }

    fn third(&self, t: f64) -> Vector2<f64> {
        let (sin, cos) = (self.start_angle + t * self.sweep).sin_cos();
        let outward = self.major * cos + self.minor * sin;
        let around = (self.minor * cos - self.major * sin) * self.sweep;
        let size = self.size + t * self.growth;
        (around * size + outward * (3.0 * self.growth)) * (-self.sweep * self.sweep)
    }

    fn room(&self, _: f64, first: f64, second: f64) -> f64 {
        let Self { major, minor, sweep, size, growth, .. } = self;
        let turn = sweep.abs();
        // Within one radian about the place nothing grows by more than e.
        let around = (major.norm() + minor.norm()) * turn * turn;
        let third = E * around * ((size + 2.0 * growth.abs()) * turn + 3.0 * growth.abs());
        first_root(second, 0.5 * third, CHANGE * first).min(1.0 / turn)
    }

    fn fourth(&self, t: f64) -> Vector2<f64> {
        let (sin, cos) = (self.start_angle + t * self.sweep).sin_cos();
        let outward = self.major * cos + self.minor * sin;
        let around = (self.minor * cos - self.major * sin) * self.sweep;
        let size = self.size + t * self.growth;
        let square = self.sweep * self.sweep;
        (outward * (size * square) - around * (4.0 * self.growth)) * square
    }
}

/// Reason why no ellipse fits the words of a block (manual 3.2.5).
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum EllipseError {
    /// No ellipse about the centre with axes in that direction passes through start and end.
    #[error("no ellipse with this centre and direction passes through start and end")]
    NoEllipse,
    /// Neither start and end nor R determine the ratio of the axes.
    #[error(
        "start and end leave the axes of the ellipse open: R, above 0 and at most 1, is needed"
    )]
    RatioNeeded,
    /// The ellipse of ratio R through the start misses the end.
    #[error("the ellipse of ratio R through the start misses the end")]
    EndMissed,
}

impl Ellipse {
    /// The arc from `start` to `end` (m) about `center`, turning by the eccentric angle `sweep` (rad, positive
    /// counter-clockwise), of the ellipse with the main half axis `major` (m, as a vector) and the other half axis
    /// `minor` (m) at a right angle to its left.
    ///
    /// The caller answers for `sweep` leading from start to end, and for both lying on the ellipse but for rounding.
    pub fn new(
        start: Point3<f64>,
        end: Point3<f64>,
        center: Point2<f64>,
        major: Vector2<f64>,
        minor: f64,
        sweep: f64,
    ) -> Self {
        let side = Vector2::new(-major.y, major.x).try_normalize(0.0).unwrap_or_default() * minor;
        let eccentric = |point: Point3<f64>| {
            let from = point.xy() - center;
            let part = |axis: Vector2<f64>| {
                let square = axis.norm_squared();
                if square > 0.0 { from.dot(&axis) / square } else { 0.0 }
            };
            Vector2::new(part(major), part(side))
        };
        let (from, to) = (eccentric(start), eccentric(end));
        let size = from.norm();
        let form = Form {
            center,
            major,
            minor: side,
            minor_length: minor,
            start_angle: from.y.atan2(from.x),
            sweep,
            size,
            growth: to.norm() - size,
        };
        Self { curve: Curve::new(form, start, end) }
    }

    /// The arc that the words of a block describe (manual 3.2.5): from `start` to `end` about `center`, with an axis
    /// in `direction` (rad, 0 = +x, counter-clockwise; K), in the sense asked for; a whole ellipse if start and end
    /// are the same. Where start and end leave the axes open, `ratio` (R) is that of the other axis to the one in
    /// `direction`.
    ///
    /// # Errors
    /// [`EllipseError`]; the manual then wants a straight line.
    pub fn through(
        start: Point3<f64>,
        end: Point3<f64>,
        center: Point2<f64>,
        direction: f64,
        ratio: Option<f64>,
        clockwise: bool,
    ) -> Result<Self, EllipseError> {
        let (sin, cos) = direction.sin_cos();
        let (along, left) = (Vector2::new(cos, sin), Vector2::new(-sin, cos));
        let local = |point: Point3<f64>| {
            let from = point.xy() - center;
            Vector2::new(from.dot(&along), from.dot(&left))
        };
        let (from, to) = (local(start), local(end));
        let (major, minor) = axes(from, to, ratio)?;
        let eccentric = |at: Vector2<f64>| (at.y / minor).atan2(at.x / major);
        let turn = if clockwise { -TAU } else { TAU };
        let same = (from - to).norm() <= 1e-9;
        let angle = (eccentric(to) - eccentric(from)).rem_euclid(TAU);
        let sweep = match (same, clockwise) {
            (true, _) => turn,
            (false, false) => angle,
            (false, true) => angle - TAU,
        };
        Ok(Self::new(start, end, center, along * major, minor, sweep))
    }

    /// Start, m.
    pub fn start(&self) -> Point3<f64> {
        self.curve.start()
    }

    /// End, m.
    pub fn end(&self) -> Point3<f64> {
        self.curve.end()
    }

    /// Centre, m (`dP1`, `dP2`).
    pub fn center(&self) -> Point2<f64> {
        self.curve.form.center
    }

    /// Main half axis as a vector, m (`dP3`, `dP4`; its length is `dP5`).
    pub fn major(&self) -> Vector2<f64> {
        self.curve.form.major
    }

    /// The other half axis, m (`dP6`).
    pub fn minor(&self) -> f64 {
        self.curve.form.minor_length
    }

    /// Eccentric angle of the start, rad, from the main axis, counter-clockwise (`dT1`).
    pub fn start_angle(&self) -> f64 {
        self.curve.form.start_angle
    }

    /// Eccentric angle swept, rad, positive counter-clockwise (G9). The manual's `dT2` has the opposite sign.
    pub fn sweep(&self) -> f64 {
        self.curve.form.sweep
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
        let Form { center, major, sweep, .. } = self.curve.form;
        Self::new(start, end, center, major, self.minor(), sweep * (to - from))
    }

    pub(super) fn reversed(&self) -> Self {
        let Form { center, major, sweep, .. } = self.curve.form;
        Self::new(self.end(), self.start(), center, major, self.minor(), -sweep)
    }

    /// Every point moved by `map`, which must be a similarity that turns `turn` and scales `scale`.
    pub(super) fn mapped(
        &self,
        map: &dyn Fn(Point3<f64>) -> Point3<f64>,
        turn: &dyn Fn(Vector2<f64>) -> Vector2<f64>,
        scale: f64,
    ) -> Self {
        let Form { center, major, sweep, .. } = self.curve.form;
        let center = map(Point3::new(center.x, center.y, 0.0)).xy();
        let minor = self.minor() * scale;
        Self::new(map(self.start()), map(self.end()), center, turn(major) * scale, minor, sweep)
    }
}

/// Half axes along and across, m, of the ellipse through two points given in its own axes.
fn axes(
    from: Vector2<f64>,
    to: Vector2<f64>,
    ratio: Option<f64>,
) -> Result<(f64, f64), EllipseError> {
    let squares = |at: Vector2<f64>| (at.x * at.x, at.y * at.y);
    let ((u1, v1), (u2, v2)) = (squares(from), squares(to));
    let determinant = u1 * v2 - u2 * v1;
    let size = (u1 + v1) * (u2 + v2);
    let positive = |value: f64| (value > 0.0 && value.is_finite()).then_some(value);
    if determinant.abs() > AMBIGUOUS * size {
        // u²·A + v²·B = 1 twice, A = 1/a², B = 1/b².
        let (a, b) = ((v2 - v1) / determinant, (u1 - u2) / determinant);
        return positive(a)
            .zip(positive(b))
            .map(|(a, b)| (a.sqrt().recip(), b.sqrt().recip()))
            .ok_or(EllipseError::NoEllipse);
    }
    let ratio =
        ratio.filter(|ratio| *ratio > 0.0 && *ratio <= 1.0).ok_or(EllipseError::RatioNeeded)?;
    let major = positive((u1 + v1 / (ratio * ratio)).sqrt()).ok_or(EllipseError::NoEllipse)?;
    let minor = ratio * major;
    let at_end = (u2 / (major * major) + v2 / (minor * minor)).sqrt();
    if (at_end - 1.0).abs() > FIT_TOLERANCE {
        return Err(EllipseError::EndMissed);
    }
    Ok((major, minor))
}
