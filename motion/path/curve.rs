//! Arc-length parametrisation of planar curves: the common part of ellipses and cubics.

use super::PathPoint;
use nalgebra::{Complex, Point2, Point3, Vector2, Vector3};
use std::fmt;

/// Points and weights of ten-point Gauss–Legendre quadrature on −1 to 1; the other half mirrors them.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// Lengths of panels are exact to this part of the whole length.
const PRECISION: f64 = 1e-14;

/// Largest number of halvings of a panel. Cusps, where the speed has a corner, are met after this number of halvings with a
/// panel that no longer counts.
const MAX_DEPTH: u32 = 24;

/// Shortest length, m: the squares of such speeds have lost their digits, and no number of
/// panels would find them again.
const SMALLEST: f64 = 1e-100;

/// No curve gets more panels: beyond that it is rounding that is divided.
const MOST_PANELS: usize = 1 << 12;

/// A curve in X and Y over a parameter t from 0 to 1.
pub(super) trait Planar {
    /// Position (m), first and second derivative with respect to t.
    fn at(&self, t: f64) -> (Point2<f64>, Vector2<f64>, Vector2<f64>);

    /// Third derivative with respect to t, m.
    fn third(&self, t: f64) -> Vector2<f64>;

    /// Fourth derivative with respect to t, m.
    fn fourth(&self, t: f64) -> Vector2<f64>;

    /// Radius of complex numbers about `t` within which the first derivative changes by no more than [`CHANGE`] of its size
    /// `first`, where `second` is that of the second.
    fn room(&self, t: f64, first: f64, second: f64) -> f64;

    /// Speed with respect to t, m.
    fn speed(&self, t: f64) -> f64 {
        self.at(t).1.norm()
    }
}

/// A planar curve with Z linear in the path length (manual 3.1 and 6.2.9), travelled by length.
#[derive(Clone, PartialEq)]
pub(super) struct Curve<P> {
    pub(super) form: P,
    start: Point3<f64>,
    end: Point3<f64>,
    /// Parameter and planar length at the panels' ends.
    panels: Box<[Knot]>,
    /// Length in X and Y.
    planar: f64,
    length: f64,
}

#[derive(Clone, Copy, PartialEq)]
struct Knot {
    t: f64,
    /// Planar length from the start.
    length: f64,
    speed: f64,
}

impl<P: fmt::Debug> fmt::Debug for Curve<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { form, start, end, length, .. } = self;
        f.debug_struct("Curve")
            .field("form", form)
            .field("start", start)
            .field("end", end)
            .field("length", length)
            .finish_non_exhaustive()
    }
}

impl<P: Planar> Curve<P> {
    /// `form` from `start` to `end` (m), where it begins and ends but for rounding.
    pub(super) fn new(form: P, start: Point3<f64>, end: Point3<f64>) -> Self {
        let whole = integral(&form, 0.0, 1.0);
        let mut panels = vec![Knot { t: 0.0, length: 0.0, speed: form.speed(0.0) }];
        let tolerance = PRECISION * whole.max(SMALLEST);
        divide(&form, 0.0, 1.0, whole, tolerance, MAX_DEPTH, &mut panels);
        let planar = panels.last().map_or(0.0, |knot| knot.length);
        Self {
            form,
            start,
            end,
            panels: panels.into_boxed_slice(),
            planar,
            length: planar.hypot(end.z - start.z),
        }
    }

    pub(super) fn start(&self) -> Point3<f64> {
        self.start
    }

    pub(super) fn end(&self) -> Point3<f64> {
        self.end
    }

    pub(super) fn length(&self) -> f64 {
        self.length
    }

    /// Position and derivatives at `s` m from the start.
    pub(super) fn at(&self, s: f64) -> PathPoint {
        if self.length <= 0.0 {
            return PathPoint::resting(self.end);
        }
        let (level, slope) = (self.planar / self.length, (self.end.z - self.start.z) / self.length);
        let t = self.parameter(s);
        let (position, first, second) = self.form.at(t);
        let [direction, bend, bend_rate] = frame(&self.form, t, first, second);
        let height = self.start.z + slope * s;
        let position = if s <= 0.0 {
            self.start
        } else if s >= self.length {
            self.end
        } else {
            Point3::new(position.x, position.y, height)
        };
        let tangent = direction * level;
        let curvature = bend * (level * level);
        let curvature_rate = bend_rate * (level * level * level);
        PathPoint {
            position,
            tangent: Vector3::new(tangent.x, tangent.y, slope),
            curvature: Vector3::new(curvature.x, curvature.y, 0.0),
            curvature_rate: Vector3::new(curvature_rate.x, curvature_rate.y, 0.0),
        }
    }

    /// The fourth derivative of X and Y at `s` m from the start, 1/m³.
    ///
    /// With the direction θ, the curvature κ = dθ/ds and its derivatives by planar length that of the position is
    /// (κ″ − κ³) across the path and −3·κ·κ′ along it. The derivatives of the logarithm of p′ = v·e^{iθ} by t are
    /// v̇/v + i·θ̇ and so on, and κ = θ̇/v.
    pub(super) fn fourth(&self, s: f64) -> Vector2<f64> {
        if self.length <= 0.0 {
            return Vector2::zeros();
        }
        let level = self.planar / self.length;
        let t = self.parameter(s);
        let (_, first, second) = self.form.at(t);
        let speed = first.norm();
        if !stands(speed, &second) {
            let along = first / speed;
            let across = Vector2::new(-along.y, along.x);
            let part = |vector: Vector2<f64>| {
                Complex::new(along.dot(&vector), across.dot(&vector)) / speed
            };
            let [second, third, fourth] =
                [second, self.form.third(t), self.form.fourth(t)].map(part);
            let log_second = third - second * second;
            let log_third = fourth - third * second * 3.0 + second * second * second * 2.0;
            let (stretch, turn) = (second.re, second.im);
            let bend = turn / speed;
            let bend_rate = (log_second.im - turn * stretch) / speed / speed;
            let bend_second = (log_third.im - 3.0 * log_second.im * stretch - turn * log_second.re
                + 2.0 * turn * stretch * stretch)
                / speed
                / speed
                / speed;
            let planar =
                across * (bend_second - bend * bend * bend) - along * (3.0 * bend * bend_rate);
            return planar * level.powi(4);
        }
        Vector2::zeros()
    }

    /// The parameter at `s` m from the start.
    pub(super) fn parameter(&self, s: f64) -> f64 {
        if s <= 0.0 || self.length <= 0.0 {
            return 0.0;
        }
        if s >= self.length {
            return 1.0;
        }
        let wanted = s * (self.planar / self.length);
        let next = self.panels.partition_point(|knot| knot.length <= wanted);
        let (Some(from), Some(to)) =
            (self.panels.get(next.saturating_sub(1)), self.panels.get(next))
        else {
            return if next == 0 { 0.0 } else { 1.0 };
        };
        let (mut low, mut high) = (from.t, to.t);
        let mut t = guess(from, to, wanted);
        for _ in 0..32 {
            let beyond = from.length + integral(&self.form, from.t, t) - wanted;
            if beyond > 0.0 {
                high = t;
            } else {
                low = t;
            }
            let step = beyond / self.form.speed(t);
            // Quadratic convergence: the remaining error after a step this small is far below a picometre.
            if beyond.abs() <= 4.0 * PRECISION * self.planar {
                break;
            }
            let newton = t - step;
            t = if newton > low && newton < high { newton } else { low.midpoint(high) };
            if high - low <= f64::EPSILON {
                break;
            }
        }
        t
    }
}

/// A first guess between two knots: the cubic t(length) with the slopes 1/speed, where that is monotonic.
fn guess(from: &Knot, to: &Knot, wanted: f64) -> f64 {
    let (width, length) = (to.t - from.t, to.length - from.length);
    let w = ((wanted - from.length) / length).clamp(0.0, 1.0);
    let [start, end] = [from, to].map(|knot| length / (knot.speed * width));
    let linear = from.t + width * w;
    if !(start < 3.0 && end < 3.0) {
        return linear;
    }
    let bend = 3.0 - 2.0 * start - end;
    let twist = start + end - 2.0;
    (from.t + width * w * (start + w * (bend + w * twist))).clamp(from.t, to.t)
}

/// Direction, planar curvature vector and its derivative by planar length at `t`: the first three derivatives of the
/// position. At a cusp, where the speed is zero, the direction is that of a point close by, and the curvature is zero.
///
/// With v = |p′|, T = p′/v and ⊥ for what is at a right angle to T, the curvature is b = p″⊥/v². Its derivative follows
/// from T′ = v·b and v′ = T·p″: p‴⊥/v³ − 3·b·(T·p″)/v² − |b|²·T.
fn frame<P: Planar>(
    form: &P,
    t: f64,
    first: Vector2<f64>,
    second: Vector2<f64>,
) -> [Vector2<f64>; 3] {
    let speed = first.norm();
    if !stands(speed, &second) {
        let direction = first / speed;
        let across = |vector: Vector2<f64>| vector - direction * direction.dot(&vector);
        let bend = across(second) / (speed * speed);
        // Divided by the speed step by step: its cube is the first to be too small for a number.
        let bend_rate = across(form.third(t)) / (speed * speed) / speed
            - bend * (3.0 * (direction.dot(&second) / speed) / speed)
            - direction * bend.norm_squared();
        return [direction, bend, bend_rate];
    }
    let close_by = if t < 0.5 { t + 1e-6 } else { t - 1e-6 };
    let direction = form.at(close_by).1.try_normalize(0.0).unwrap_or_default();
    [direction, Vector2::zeros(), Vector2::zeros()]
}

/// True if a curve is not at a cusp where it has this speed and second derivative by its parameter, m.
fn stands(speed: f64, second: &Vector2<f64>) -> bool {
    !(speed > 1e-9 * second.norm() && speed > 0.0)
}

/// Length of `form` between two parameters, by one panel.
fn integral<P: Planar>(form: &P, from: f64, to: f64) -> f64 {
    let (middle, half) = (from.midpoint(to), 0.5 * (to - from));
    let pair = |(x, weight): &(f64, f64)| {
        weight * (form.speed(middle - half * x) + form.speed(middle + half * x))
    };
    half * GAUSS.iter().map(pair).sum::<f64>()
}

/// Appends the ends of panels between two parameters, `whole` long by one panel, that are exact to `tolerance`.
fn divide<P: Planar>(
    form: &P,
    from: f64,
    to: f64,
    whole: f64,
    tolerance: f64,
    depth: u32,
    panels: &mut Vec<Knot>,
) {
    let middle = from.midpoint(to);
    let (left, right) = (integral(form, from, middle), integral(form, middle, to));
    // At least four panels, for the first guess.
    let coarse = depth + 2 > MAX_DEPTH;
    let divisible = depth > 0 && panels.len() < MOST_PANELS;
    if (coarse || (left + right - whole).abs() > tolerance) && divisible {
        divide(form, from, middle, left, tolerance, depth - 1, panels);
        divide(form, middle, to, right, tolerance, depth - 1, panels);
    } else {
        for (t, length) in [(middle, left), (to, right)] {
            let before = panels.last().map_or(0.0, |knot| knot.length);
            panels.push(Knot { t, length: before + length, speed: form.speed(t) });
        }
    }
}

/// The x above 0 at which a·x + b·x² = c, none of them negative; infinite if there is none.
pub(super) fn first_root(a: f64, b: f64, c: f64) -> f64 {
    2.0 * c / (a + (a * a + 4.0 * b * c).sqrt())
}

/// Part of the speed by which that of a curve may change within a disc of its parameter.
pub(super) const CHANGE: f64 = 0.26;

impl<P: Planar> Curve<P> {
    /// Radius and bend about `s` m from the start.
    ///
    /// Where the derivative p′ by the parameter changes by no more than 0.26·|p′|, its square, and with it that of the
    /// speed, changes by no more than 0.6 of it. Then a disc of path lengths 0.63·|p′| as wide lies within that of the
    /// parameter, on which the derivative by path length is at most 2. On half of it, by Cauchy, the second is at most four
    /// by the radius.
    pub(super) fn disc(&self, s: f64) -> [f64; 2] {
        let t = self.parameter(s);
        let (_, first, second) = self.form.at(t);
        let planar = 0.63 * first.norm() * self.form.room(t, first.norm(), second.norm());
        let level = self.planar / self.length();
        let radius = 0.5 * planar / level;
        let bend = 4.0 / planar * level * level;
        if radius.is_finite() && bend.is_finite() { [radius, bend] } else { [0.0; 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight with a speed of 1 + t², scaled.
    struct Scaled(f64);

    impl Planar for Scaled {
        fn room(&self, _: f64, _: f64, _: f64) -> f64 {
            0.0
        }

        fn at(&self, t: f64) -> (Point2<f64>, Vector2<f64>, Vector2<f64>) {
            let along = |value: f64| Vector2::new(0.6, 0.8) * (value * self.0);
            (along(t + t.powi(3) / 3.0).into(), along(1.0 + t * t), along(2.0 * t))
        }

        fn third(&self, _: f64) -> Vector2<f64> {
            Vector2::new(0.6, 0.8) * (2.0 * self.0)
        }

        fn fourth(&self, _: f64) -> Vector2<f64> {
            Vector2::zeros()
        }
    }

    /// Speeds whose squares are subnormal do not need millions of panels.
    #[test]
    fn curves_of_no_length_have_few_panels() {
        for scale in [1.0, 1e-20, 1e-158, 1e-161, 1e-300, 1e-310, 0.0] {
            let curve = Curve::new(Scaled(scale), Point3::origin(), Point3::origin());
            assert!(curve.panels.len() < 100, "{scale:e}: {} panels", curve.panels.len());
        }
    }
}
