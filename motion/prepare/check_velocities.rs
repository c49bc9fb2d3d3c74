//! Velocities at the transitions between elements (`SMC_CheckVelocities`, manual 3.2 and 6.2.7).

use crate::Place;
use crate::path::{ElementKind, PathElement};
use nalgebra::SVector;
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
/// element of length zero, at M functions and dwells, at the end of the path and before an error; else the smallest of
/// the two programmed velocities and the element's own [`PathElement::end_velocity`], which
/// [`super::LimitCircularVelocities`] sets. Whether the velocity can be reached within the accelerations is for
/// [`crate::interpolate::LookAhead`] to say.
///
/// The turn is measured in space. Where only extra axes move it is measured between their directions, and between such
/// an element and a motion in X, Y or Z the path stops: the two velocities have different units. It also stops at an
/// element that begins or ends at rest because Z alone moves and does so with the S profile.
///
/// One element is held back, since its end depends on the next.
#[derive(Debug)]
pub struct CheckVelocities<I, E> {
    upstream: I,
    angle_tolerance: f64,
    /// The newest element, its end velocity not yet set.
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
    angle_tolerance: f64,
) -> f64 {
    let cuts = |element: &CheckedElement| element.kind == ElementKind::Cut && element.has_path();
    if !cuts(element) || !cuts(next) {
        return 0.0;
    }
    let in_space = |element: &CheckedElement| element.shape.length() > 0.0;
    let turn = match (in_space(element), in_space(next)) {
        (true, true) => angle_between(&element.end_tangent(), &next.start_tangent()),
        (false, false) => angle_between(&extra_direction(element), &extra_direction(next)),
        _ => None,
    };
    match turn {
        Some(turn) if turn <= angle_tolerance + ANGLE_EPS => {
            element.end_velocity.min(element.feed).min(next.feed)
        }
        _ => 0.0,
    }
}

/// How the extra axes of an element move, u.
fn extra_direction(element: &PathElement) -> SVector<f64, 5> {
    element
        .extra()
        .map_or_else(SVector::zeros, |extra| SVector::from(extra.end) - SVector::from(extra.start))
}

/// Angle between two directions, rad, 0 to π; none if one of them is zero. The arc tangent of difference and sum of
/// the unit vectors keeps its digits at 0 and π, where the arc cosine of the dot product loses half of them.
fn angle_between<const N: usize>(a: &SVector<f64, N>, b: &SVector<f64, N>) -> Option<f64> {
    let (a, b) = (a.try_normalize(0.0)?, b.try_normalize(0.0)?);
    Some(2.0 * (a - b).norm().atan2((a + b).norm()))
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
        let limit = element.end_velocity;
        if limit.is_nan() || limit < 0.0 {
            return Err(CheckError::EndVelocity { place, value: limit });
        }
        Ok(Self { element, length })
    }

    /// The same with a stop at its end.
    fn stopping(mut self) -> Self {
        self.element.end_velocity = 0.0;
        self
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
    /// The velocity at the end is negative or no number.
    #[error("{place}: the velocity at the end is {value} m/s, it must not be negative")]
    EndVelocity {
        /// The element's block.
        place: Place,
        /// The velocity, m/s.
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
