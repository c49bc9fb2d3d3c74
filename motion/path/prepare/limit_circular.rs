//! Velocity limits on curves (`SMC_LimitCircularVelocities`, manual 6.2.8).

use crate::{ElementKind, PathElement, Shape};
use nalgebra::Vector3;

/// Pieces into which a curve is cut to look for its largest curvature.
const SAMPLES: u32 = 32;
/// Steps of the search between them; each narrows it to 0.62, which is enough for nine digits of a maximum.
const REFINEMENTS: u32 = 24;

/// Limits on the acceleration across the path. 0 switches a limit off; so does whatever is negative or no number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CircularLimits {
    /// Largest acceleration towards the centre of a curve, m/s² (`dMaxAcc`).
    pub acceleration: f64,
    /// Largest jump of that acceleration from one element to the next, m/s² (`dMaxAccJump`).
    pub acceleration_jump: f64,
}

/// Limits the velocity on curves and from one curvature to another (`SMC_LimitCircularVelocities`).
///
/// On an arc of radius r the feed is at most √(`acceleration` · r); on an ellipse or a spline r is the smallest radius
/// of curvature. From one element into the next, [`PathElement::end_velocity`] of the first is at most
/// √(`acceleration_jump` / |κ₂ − κ₁|), where κ is the curvature at the transition: positive counter-clockwise,
/// negative clockwise, 0 on a line. Radii are those of the curve in its plane, also on a helix, as in the manual; the
/// limits hold a fortiori in space. Where two curves lie in different planes, κ₂ − κ₁ is the difference of the vectors
/// κ · normal.
///
/// [`super::CheckVelocities`] comes after it and keeps the smaller of its own velocity and this one. One element is
/// held back.
#[derive(Debug)]
pub struct LimitCircularVelocities<I, E> {
    upstream: I,
    limits: CircularLimits,
    held: Option<PathElement>,
    /// What comes after the element just handed out.
    next: Option<Result<PathElement, E>>,
    ended: bool,
}

impl<I, E> LimitCircularVelocities<I, E>
where
    I: Iterator<Item = Result<PathElement, E>>,
{
    /// Limits the elements of `upstream`.
    pub fn new(upstream: I, limits: CircularLimits) -> Self {
        Self { upstream, limits, held: None, next: None, ended: false }
    }

    /// The element with the feed that its own curvature allows.
    fn limit(&self, mut element: PathElement) -> PathElement {
        let acceleration = self.limits.acceleration;
        if element.kind == ElementKind::Cut && acceleration > 0.0 {
            let curvature = largest_curvature(&element.shape);
            if curvature > 0.0 {
                element.feed = element.feed.min((acceleration / curvature).sqrt());
            }
        }
        element
    }

    /// Limits the velocity from `element` into `next`.
    fn limit_transition(&self, element: &mut PathElement, next: &PathElement) {
        let jump = self.limits.acceleration_jump;
        if jump > 0.0 && element.kind.is_motion() && next.kind.is_motion() {
            let before = curvature(&element.shape, element.shape.length());
            let change = (curvature(&next.shape, 0.0) - before).norm();
            if change > 0.0 {
                element.end_velocity = element.end_velocity.min((jump / change).sqrt());
            }
        }
    }
}

impl<I, E> Iterator for LimitCircularVelocities<I, E>
where
    I: Iterator<Item = Result<PathElement, E>>,
{
    type Item = Result<PathElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(next) = self.next.take() {
            return Some(next);
        }
        while !self.ended {
            match self.upstream.next() {
                Some(Ok(element)) => {
                    let next = self.limit(element);
                    if let Some(mut element) = self.held.take() {
                        self.limit_transition(&mut element, &next);
                        self.held = Some(next);
                        return Some(Ok(element));
                    }
                    self.held = Some(next);
                }
                Some(Err(error)) => match self.held.take() {
                    Some(element) => {
                        self.next = Some(Err(error));
                        return Some(Ok(element));
                    }
                    None => return Some(Err(error)),
                },
                None => self.ended = true,
            }
        }
        self.held.take().map(Ok)
    }
}

/// Normal of the plane in which a shape curves.
fn normal(shape: &Shape) -> Vector3<f64> {
    if let Shape::Arc(arc) = shape { arc.plane().normal() } else { Vector3::z() }
}

/// Curvature of the shape's projection onto its plane at path length `s`, 1/m, as a vector along the plane's normal:
/// κ = (p′ × p″) · n / |p′|³.
pub fn curvature(shape: &Shape, s: f64) -> Vector3<f64> {
    if let Shape::Line { .. } = shape {
        return Vector3::zeros();
    }
    let normal = normal(shape);
    let point = shape.at(s);
    let tangent = point.tangent - normal * point.tangent.dot(&normal);
    let speed = tangent.norm();
    if speed <= 0.0 {
        return Vector3::zeros();
    }
    normal * (tangent.cross(&point.curvature).dot(&normal) / speed.powi(3))
}

/// The largest curvature of the shape's projection onto its plane, 1/m.
fn largest_curvature(shape: &Shape) -> f64 {
    match shape {
        Shape::Line { .. } => 0.0,
        Shape::Arc(arc) => arc.radius().min(arc.end_radius()).recip(),
        _ => search(shape.length(), |s| curvature(shape, s).norm()),
    }
}

/// The largest value of `f` from 0 to `length`: the largest of samples, then a golden-section search around it.
fn search(length: f64, f: impl Fn(f64) -> f64) -> f64 {
    let step = length / f64::from(SAMPLES);
    let (mut best, mut largest) = (0.0, 0.0_f64);
    for sample in 0..=SAMPLES {
        let s = step * f64::from(sample);
        let value = f(s);
        if value > largest {
            (best, largest) = (s, value);
        }
    }
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = ((best - step).max(0.0), (best + step).min(length));
    for _ in 0..REFINEMENTS {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        let (at_left, at_right) = (f(left), f(right));
        largest = largest.max(at_left).max(at_right);
        if at_left > at_right {
            high = right;
        } else {
            low = left;
        }
    }
    largest
}
