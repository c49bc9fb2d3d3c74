//! Velocities at the transitions between elements (`SMC_CheckVelocities`, manual 3.2 and 6.2.7).

use crate::Place;
use crate::path::{ElementKind, PathElement};
use nalgebra::Vector3;
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
/// 0 where either element is a rapid (G0), where the path turns by more than the tolerance, at a jump (G92), at an
/// element of length zero, at the end of the path and before an error; else the smaller of the two programmed
/// velocities. Whether the velocity can be reached within the accelerations is for
/// [`crate::interpolate::LookAhead`] to say.
///
/// One element is held back, since its end depends on the next.
#[derive(Debug)]
pub struct CheckVelocities<I, E> {
    upstream: I,
    angle_tolerance: f64,
    held: Option<CheckedElement>,
    /// An error that comes after the element just handed out.
    failure: Option<E>,
    ended: bool,
}

impl<I, E> CheckVelocities<I, E>
where
    I: Iterator<Item = Result<PathElement, E>>,
    E: From<CheckError>,
{
    /// Checks the elements of `upstream`; turns of up to `angle_tolerance` (rad, the manual's `dAngleTol`) are
    /// passed without a stop.
    pub fn new(upstream: I, angle_tolerance: f64) -> Self {
        Self { upstream, angle_tolerance, held: None, failure: None, ended: false }
    }

    fn pull(&mut self) -> Option<Result<CheckedElement, E>> {
        match self.upstream.next()? {
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
                Some(Ok(next)) => {
                    if let Some(mut element) = self.held.replace(next) {
                        if let Some(next) = &self.held {
                            element.element.end_velocity =
                                transition_velocity(&element, next, self.angle_tolerance);
                        }
                        return Some(Ok(element));
                    }
                }
                Some(Err(error)) => match self.held.take() {
                    Some(element) => {
                        self.failure = Some(error);
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

/// The largest velocity from `element` into `next`, m/s.
fn transition_velocity(
    element: &CheckedElement,
    next: &CheckedElement,
    angle_tolerance: f64,
) -> f64 {
    let cuts = |element: &CheckedElement| element.kind == ElementKind::Cut && element.has_path();
    if !cuts(element) || !cuts(next) {
        return 0.0;
    }
    let turn = angle_between(element.end_tangent(), next.start_tangent());
    if turn <= angle_tolerance + ANGLE_EPS { element.feed.min(next.feed) } else { 0.0 }
}

/// Angle between two directions in space, rad, 0 to π. The arc tangent of cross and dot product keeps its digits at
/// 0 and π, where the arc cosine of the dot product loses half of them.
fn angle_between(a: Vector3<f64>, b: Vector3<f64>) -> f64 {
    a.cross(&b).norm().atan2(a.dot(&b))
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
}

impl CheckedElement {
    fn new(element: PathElement) -> Result<Self, CheckError> {
        let place = element.place;
        // A jump has no path, but it must lead somewhere too.
        let extent = element.shape.length();
        if !(0.0..=LARGEST).contains(&extent) {
            return Err(CheckError::Length { place, length: extent });
        }
        let length = element.length();
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
        Ok(Self { element: PathElement { end_velocity: 0.0, ..element }, length })
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

/// Why an element cannot be planned with.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CheckError {
    /// A limit is zero, negative or no number (`SMC_CV_ACC_DEC_VEL_NONPOSITIVE`, error 1100).
    #[error("{place}: {limit} is {value} {}, it must be positive and finite", limit.unit())]
    NonPositiveLimit {
        /// The element's block.
        place: Place,
        /// The limit concerned.
        limit: Limit,
        /// Its value in SI units.
        value: f64,
    },
    /// The length of the element is no finite number.
    #[error("{place}: the length of the path is {length} m, which cannot be travelled")]
    Length {
        /// The element's block.
        place: Place,
        /// Its length, m.
        length: f64,
    },
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
    /// SI unit of the limit's value.
    pub fn unit(self) -> &'static str {
        match self {
            Limit::Feed => "m/s",
            Limit::Acceleration | Limit::Deceleration => "m/s²",
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
