//! Joints: steps of the derivatives where two elements meet.

use super::blend::resting;
use super::{BlendedPoint, Order};
use nalgebra::SVector;
use twin_path::prepare::CheckedElement;
use twin_path::{ExtraPoint, Shape};

/// Derivatives that differ by no more than this part of them are the same.
const SAME: f64 = 1e-9;
/// Number of roundings of the coordinates in a derivative.
const ROUNDINGS: f64 = 8.0;
/// Elements meet that are no further apart, m.
const MEETING: f64 = 1e-9;
/// A blend is nowhere slower than this part of the original path at the same parameter speed.
pub(super) const SLOWEST: f64 = 0.1;

/// Remaining steps at the end of an element of the course: zero if there are none, or only by rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Joint {
    /// The course must stop here: the path does, nothing follows, the elements do not meet, or the path folds back.
    pub stop: bool,
    /// By how much the direction turns, rad, 0 to π; that of the extra axes where only those move.
    pub angle: f64,
    /// Length of the step of the first derivative in space: 2·sin(angle/2), but where Z moves with the S profile.
    pub tangent_jump: f64,
    /// Length of the step of the second derivative in space, 1/m.
    pub curvature_jump: f64,
    /// Length of the step of the third derivative in space, 1/m²; 0 but with [`Order::Jerk`].
    pub curvature_rate_jump: f64,
    /// The largest step of the first derivative of an extra axis, u/m.
    pub extra_slope_jump: f64,
    /// The largest step of the second derivative of an extra axis, u/m².
    pub extra_curvature_jump: f64,
}

impl Joint {
    /// A joint at a stop of the path: the steps do not matter.
    pub(super) const STOP: Self = Self {
        stop: true,
        angle: 0.0,
        tangent_jump: 0.0,
        curvature_jump: 0.0,
        curvature_rate_jump: 0.0,
        extra_slope_jump: 0.0,
        extra_curvature_jump: 0.0,
    };
}

/// The two sides of a joint of elements that both have a length, and what counts as a step between them.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    pub(super) before: BlendedPoint,
    pub(super) after: BlendedPoint,
    joint: Joint,
    /// Whether each derivative (first, second, third) of space and (first, second) of the extra axes has a step that is not
    /// rounding. The third is looked at with [`Order::Jerk`].
    space: [bool; 3],
    extra: [bool; 2],
    apart: bool,
    folds: bool,
    /// Uncertainty of positions near the joint, m: by rounding, and by the gap between the elements.
    pub(super) blur: f64,
}

impl Steps {
    pub(super) fn between(from: &CheckedElement, to: &CheckedElement, order: Order) -> Self {
        let mut before = BlendedPoint::of(from, from.path_length());
        let mut after = BlendedPoint::of(to, 0.0);
        before.extra = before.extra.or(after.extra.map(resting));
        after.extra = after.extra.or(before.extra.map(resting));
        let shorter = from.path_length().min(to.path_length());

        let near = ROUNDINGS
            * f64::EPSILON
            * before.position.coords.amax().max(reckoned_with(from)).max(reckoned_with(to));
        let far_ends = from.start().coords.amax().max(to.end().coords.amax());
        let rounding = near.max(ROUNDINGS * f64::EPSILON * far_ends);
        let gap = (after.position - before.position).norm();
        let tangent_jump = (after.first - before.first).norm();
        let curvature_jump = (after.second - before.second).norm();
        let speed = before.first.norm().max(after.first.norm());
        let bend = before.second.norm().max(after.second.norm());
        let bend_rate = before.third.norm().max(after.third.norm());
        let curvature_rate_jump = (after.third - before.third).norm();
        let space = [
            tangent_jump > SAME * speed + rounding / shorter,
            curvature_jump > SAME * (bend + speed / shorter) + rounding / shorter / shorter,
            order == Order::Jerk
                && curvature_rate_jump
                    > SAME * (bend_rate + (bend + speed / shorter) / shorter)
                        + rounding / shorter / shorter / shorter,
        ];

        let [a, b] = [&before, &after].map(|side| side.extra.unwrap_or_default());
        let largest = |derivative: fn(&ExtraPoint) -> [f64; 5]| {
            SVector::from(derivative(&a)).amax().max(SVector::from(derivative(&b)).amax())
        };
        let step = |derivative: fn(&ExtraPoint) -> [f64; 5]| {
            (SVector::from(derivative(&b)) - SVector::from(derivative(&a))).amax()
        };
        let extra_slope_jump = step(|side| side.first);
        let extra_curvature_jump = step(|side| side.second);
        let far = largest(|side| side.position);
        let slope = largest(|side| side.first);
        let rounding_u = ROUNDINGS * f64::EPSILON * (far + slope * shorter);
        let extra = [
            extra_slope_jump > SAME * slope + rounding_u / shorter,
            extra_curvature_jump
                > SAME * (largest(|side| side.second) + slope / shorter)
                    + rounding_u / shorter / shorter,
        ];

        let in_space = from.shape.length() > 0.0 || to.shape.length() > 0.0;
        let angle = if in_space {
            angle(&before.first, &after.first)
        } else {
            angle(&SVector::from(a.first), &SVector::from(b.first))
        };
        let kept = |step: bool, size: f64| if step { size } else { 0.0 };
        let joint = Joint {
            stop: false,
            angle: kept(space[0] || extra[0], angle),
            tangent_jump: kept(space[0], tangent_jump),
            curvature_jump: kept(space[1], curvature_jump),
            curvature_rate_jump: kept(space[2], curvature_rate_jump),
            extra_slope_jump: kept(extra[0], extra_slope_jump),
            extra_curvature_jump: kept(extra[1], extra_curvature_jump),
        };
        Self {
            before,
            after,
            joint,
            space,
            extra,
            apart: gap > MEETING + near || step(|side| side.position) > SAME * far.max(1.0),
            folds: (0.5 * angle).cos() < SLOWEST,
            blur: near.max(gap),
        }
    }

    /// The steps as a joint.
    pub(super) fn joint(&self) -> Joint {
        self.joint
    }

    /// True if the elements do not meet.
    pub(super) fn apart(&self) -> bool {
        self.apart
    }

    /// True if the path nearly reverses.
    pub(super) fn folds(&self) -> bool {
        self.folds
    }

    /// True if there is a step that is to be blended.
    pub(super) fn to_blend(&self, order: Order) -> bool {
        let derivatives = match order {
            Order::Velocity => 1,
            Order::Acceleration => 2,
            Order::Jerk => 3,
        };
        let extra = self.extra.into_iter().chain(std::iter::once(false));
        self.space.iter().zip(extra).take(derivatives).any(|(space, extra)| *space || extra)
    }

    /// True if an extra axis has a step of any kind.
    pub(super) fn extra_step(&self) -> bool {
        self.extra.contains(&true)
    }
}

/// The largest number that goes into a position of a curve, m; 0 for a line, whose start and end are given.
fn reckoned_with(element: &CheckedElement) -> f64 {
    match &element.shape {
        Shape::Line { .. } => 0.0,
        Shape::Arc(arc) => arc.center().coords.amax() + arc.radius().max(arc.end_radius()),
        Shape::Ellipse(ellipse) => {
            ellipse.center().coords.amax() + ellipse.major().norm().max(ellipse.minor().abs())
        }
        Shape::Cubic(cubic) => cubic.start().coords.amax().max(cubic.end().coords.amax()),
    }
}

/// Angle between two directions, rad; 0 if there is none. From difference and sum of the unit vectors, which keep their
/// digits at 0 and π.
fn angle<const N: usize>(a: &SVector<f64, N>, b: &SVector<f64, N>) -> f64 {
    let (Some(a), Some(b)) = (a.try_normalize(0.0), b.try_normalize(0.0)) else { return 0.0 };
    2.0 * (a - b).norm().atan2((a + b).norm())
}
