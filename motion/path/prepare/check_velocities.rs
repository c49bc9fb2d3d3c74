//! Transition velocities between elements (`SMC_CheckVelocities`, manual 3.2 and 6.2.7).

use crate::Place;
use crate::units::mm;
use crate::{Details, ElementKind, ExtraAxes, Marks, PathElement, Shape};
use nalgebra::SVector;
use std::f64::consts::PI;
use std::fmt;
use std::ops::Deref;

/// Angles are equal to within this, rad: two segments in line differ by rounding only, and a tolerance of 0 shall
/// not stop between them (the strict zero of manual 6.4, `g_fSMC_CNC_EPS`).
const ANGLE_EPS: f64 = 1e-9;

/// The largest limit or length that is taken for a number, in m/s, m/s² and m. Far beyond every machine; it keeps
/// squares and sums of products finite.
const LARGEST: f64 = 1e100;

/// Sets the velocity with which the path goes on from each element into the next (`SMC_CheckVelocities`).
///
/// 0 where either element is a rapid (G0) or a probing move (G38), where the path turns by more than the tolerance, at a jump (G92), at an
/// element of length zero, at M functions and dwells, at the end of the path and before an error; else the smallest of
/// the two programmed velocities and the element's own [`PathElement::end_velocity`], which
/// [`super::LimitCircularVelocities`] sets. Whether the velocity can be reached within the accelerations is for
/// the look-ahead of the planner to say.
///
/// The turn is measured in space. Where only extra axes move it is measured between their directions, and between such
/// an element and a motion in X, Y or Z the path stops: the two velocities have different units. It also stops at an
/// element that begins or ends at rest because Z alone moves and does so with the S profile.
///
/// One element is held back, since its end depends on the next.
#[derive(Debug)]
pub struct CheckVelocities<I, E> {
    upstream: I,
    turns: Turns,
    /// The newest element, its end velocity not yet set.
    held: Option<CheckedElement>,
    /// An error that comes after the element just handed out.
    failure: Option<E>,
    ended: bool,
    /// True if rapids, probing moves, M functions and dwells are stops.
    stops: bool,
}

impl<I, E> CheckVelocities<I, E>
where
    I: Iterator<Item = Result<PathElement, E>>,
    E: From<CheckError>,
{
    /// Checks the elements of `upstream`; turns of up to `angle_tolerance` (rad, the manual's `dAngleTol`) are
    /// passed without a stop.
    pub fn new(upstream: I, angle_tolerance: f64) -> Self {
        Self {
            upstream,
            turns: Turns::up_to(angle_tolerance),
            held: None,
            failure: None,
            ended: false,
            stops: true,
        }
    }

    /// The same with no stop that is not in the shape of the path: rapids and probing moves are passed like cuts, turns by any angle, M functions
    /// and dwells are left out. For comparison: what stops cost.
    #[must_use]
    pub fn without_stops(self) -> Self {
        Self { turns: Turns::up_to(PI), stops: false, ..self }
    }

    fn pull(&mut self) -> Option<Result<CheckedElement, E>> {
        let stops = self.stops;
        let counts = |element: &Result<PathElement, E>| {
            let waits = |element: &PathElement| {
                matches!(element.kind, ElementKind::MFunction { .. } | ElementKind::Dwell { .. })
            };
            stops || !element.as_ref().is_ok_and(waits)
        };
        match self.upstream.by_ref().find(counts)? {
            Ok(element) => Some(CheckedElement::new(element).map_err(E::from)),
            Err(error) => Some(Err(error)),
        }
    }
}

impl<I, E> Iterator for CheckVelocities<I, E>
where
    I: Iterator<Item = Result<PathElement, E>>,
    E: From<CheckError>,
{
    type Item = Result<CheckedElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(error) = self.failure.take() {
            return Some(Err(error));
        }
        while !self.ended {
            match self.pull() {
                Some(Ok(next)) => match &mut self.held {
                    Some(element) => {
                        element.element.end_velocity =
                            transition_velocity(element, &next, self.turns, self.stops);
                        return Some(Ok(std::mem::replace(element, next)));
                    }
                    None => self.held = Some(next),
                },
                Some(Err(error)) => match self.held.take() {
                    Some(element) => {
                        self.failure = Some(error);
                        return Some(Ok(element.stopping()));
                    }
                    None => return Some(Err(error)),
                },
                None => self.ended = true,
            }
        }
        self.held.take().map(|element| Ok(element.stopping()))
    }
}

/// The largest velocity from `element` into `next`, m/s.
fn transition_velocity(
    element: &CheckedElement,
    next: &CheckedElement,
    turns: Turns,
    stops: bool,
) -> f64 {
    let cuts = |element: &CheckedElement| {
        let passed = match element.kind {
            ElementKind::Cut => true,
            ElementKind::Rapid | ElementKind::Probe { .. } => !stops,
            ElementKind::Jump | ElementKind::MFunction { .. } | ElementKind::Dwell { .. } => false,
        };
        passed && element.has_path()
    };
    if !cuts(element) || !cuts(next) {
        return 0.0;
    }
    let passes = match (element.in_space, next.in_space) {
        (true, true) => turns.contain(&element.end_tangent(), &next.start_tangent()),
        (false, false) => turns.contain(&extra_direction(element), &extra_direction(next)),
        _ => false,
    };
    if passes { element.end_velocity.min(element.feed).min(next.feed) } else { 0.0 }
}

/// Motion of an element's extra axes, u.
fn extra_direction(element: &PathElement) -> SVector<f64, 5> {
    element
        .extra()
        .map_or_else(SVector::zeros, |extra| SVector::from(extra.end) - SVector::from(extra.start))
}

/// The turns that are passed without a stop: up to an angle, of whose half these are sine and cosine, squared.
#[derive(Clone, Copy, Debug)]
struct Turns {
    sine_2: f64,
    cosine_2: f64,
}

impl Turns {
    /// Up to `tolerance`, rad.
    fn up_to(tolerance: f64) -> Self {
        let largest = tolerance + ANGLE_EPS;
        if largest >= PI {
            // The cosine of its half is not quite 0.
            return Self { sine_2: 1.0, cosine_2: 0.0 };
        }
        let (sine, cosine) = (0.5 * largest).sin_cos();
        Self { sine_2: sine * sine.abs(), cosine_2: cosine * cosine }
    }

    /// True if the turn from one direction to another is one of them; not if one of the two is zero. The tangent of
    /// half the angle is that of difference and sum of the unit vectors, which keeps its digits at 0 and π, where the
    /// dot product loses half of them.
    fn contain<const N: usize>(self, a: &SVector<f64, N>, b: &SVector<f64, N>) -> bool {
        let (Some(a), Some(b)) = (a.try_normalize(0.0), b.try_normalize(0.0)) else { return false };
        (a - b).norm_squared() * self.cosine_2 <= (a + b).norm_squared() * self.sine_2
    }
}

/// A path element with limits that can be planned with and its transition velocity set: what [`CheckVelocities`]
/// lets through.
///
/// Feed, acceleration and deceleration are positive and finite wherever there is a path to travel, and
/// [`PathElement::end_velocity`] is at most the feed of this element and of the next.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedElement {
    element: PathElement,
    length: f64,
    /// It moves X, Y or Z.
    in_space: bool,
}

impl CheckedElement {
    fn new(element: PathElement) -> Result<Self, CheckError> {
        let place = element.place;
        // A jump has no path, but it must lead somewhere too.
        let extent = element.shape.length();
        if !(0.0..=LARGEST).contains(&extent) {
            return Err(CheckError::Length { place, length: extent });
        }
        let in_space = extent > 0.0;
        let length = if in_space && element.kind.is_motion() { extent } else { element.length() };
        let limits = [
            (Limit::Feed, element.feed),
            (Limit::Acceleration, element.acceleration),
            (Limit::Deceleration, element.deceleration),
        ];
        for (limit, value) in limits {
            // Without a path no limit is ever used, and a program may well set its position before its first F.
            if length > 0.0 && !(value > 0.0 && value <= LARGEST) {
                return Err(CheckError::NonPositiveLimit { place, limit, value });
            }
        }
        let limit = element.end_velocity;
        if limit.is_nan() || limit < 0.0 {
            return Err(CheckError::EndVelocity { place, value: limit });
        }
        Ok(Self { element, length, in_space })
    }

    /// The same with a stop at its end.
    fn stopping(mut self) -> Self {
        self.element.end_velocity = 0.0;
        self
    }

    /// Its start, as something without length at which the path rests.
    pub fn start_at_rest(&self) -> Self {
        let at = self.start();
        let mut element = PathElement {
            shape: Shape::Line { start: at, end: at },
            end_velocity: 0.0,
            marks: Marks::default(),
            details: None,
            ..self.element.clone()
        };
        if let Some(extra) = self.extra_at(0.0) {
            let extra = Some(ExtraAxes { start: extra.position, end: extra.position });
            element.details = Some(Box::new(Details { extra, ..Details::default() }));
        }
        Self { element, length: 0.0, in_space: false }
    }

    /// Cut in two where both parts have a length, m from its start; as it is if there is no such place.
    pub fn split(self, at: f64) -> (Self, Option<Self>) {
        let Ok([first, mut second]) = self.element.split(at / self.length) else {
            return (self, None);
        };
        second.end_velocity = self.element.end_velocity;
        let first = PathElement { end_velocity: first.feed, ..first };
        let [first, second] = [first, second].map(|element| {
            let length = element.length();
            Self { element, length, in_space: self.in_space }
        });
        (first, Some(second))
    }

    /// Length of the path to travel, m; 0 for a jump, which has none.
    pub fn path_length(&self) -> f64 {
        self.length
    }

    /// False for jumps and elements of length zero.
    pub fn has_path(&self) -> bool {
        self.length > 0.0
    }

    /// The element itself.
    pub fn into_element(self) -> PathElement {
        self.element
    }
}

impl Deref for CheckedElement {
    type Target = PathElement;

    fn deref(&self) -> &PathElement {
        &self.element
    }
}

/// Reason why an element cannot be planned.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CheckError {
    /// A limit is zero, negative or no number (`SMC_CV_ACC_DEC_VEL_NONPOSITIVE`, error 1100).
    #[error("{place}: {limit} is {} {}, it must be positive and finite", mm(*value), limit.unit())]
    NonPositiveLimit {
        /// The element's block.
        place: Place,
        /// The limit concerned.
        limit: Limit,
        /// Its value in SI units.
        value: f64,
    },
    /// The velocity at the end is negative or no number.
    #[error("{place}: the velocity at the end is {} mm/s, it must not be negative", mm(*value))]
    EndVelocity {
        /// The element's block.
        place: Place,
        /// The velocity, m/s.
        value: f64,
    },
    /// The length of the element is no finite number.
    #[error("{place}: the length of the path is {} mm, which cannot be travelled", mm(*length))]
    Length {
        /// The element's block.
        place: Place,
        /// Its length, m.
        length: f64,
    },
}

impl CheckError {
    /// The block it is about.
    pub const fn place(&self) -> Place {
        match self {
            Self::NonPositiveLimit { place, .. }
            | Self::EndVelocity { place, .. }
            | Self::Length { place, .. } => *place,
        }
    }
}

/// A programmed limit on the motion along the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Limit {
    /// Velocity (F), m/s.
    Feed,
    /// Acceleration (E+), m/s².
    Acceleration,
    /// Deceleration (E−), m/s².
    Deceleration,
}

impl Limit {
    /// Unit of the limit in programs and messages.
    pub fn unit(self) -> &'static str {
        match self {
            Limit::Feed => "mm/s",
            Limit::Acceleration | Limit::Deceleration => "mm/s²",
        }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Limit::Feed => "the velocity (F)",
            Limit::Acceleration => "the acceleration (E)",
            Limit::Deceleration => "the deceleration (E-)",
        })
    }
}
