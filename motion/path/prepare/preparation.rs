//! Preparation: all adapters in the manual's order.

use super::{
    AvoidLoops, CheckError, CheckVelocities, CircularLimits, CornerError, DEFAULT_LOOP_WINDOW,
    LimitCircularVelocities, Notices, RoundPath, Rounding, SmoothPath, Smoothing, ToolRadius,
    ToolRadiusError, ToolRadiusOptions,
};
use crate::{Marks, PathElement};
use std::num::NonZeroUsize;

/// Adapters that a path goes through: each `None` leaves its stage out.
///
/// The order is that of the manual's sections 6.2.3 to 6.2.8: [`ToolRadius`], [`AvoidLoops`], [`SmoothPath`] or
/// [`RoundPath`], [`LimitCircularVelocities`]; then comes [`CheckVelocities`] (6.2.7, "directly before the
/// interpolator"). Tool radius correction, smoothing and rounding cannot be combined (manual 3.4), since they share
/// D, but may follow one another in sections of their own: [`super::Sections`] finds those that overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Preparation {
    /// Tool radius correction (G40 to G42).
    pub tool_radius: Option<ToolRadiusOptions>,
    /// Loop avoidance (G60, G61) among this number of elements, see [`DEFAULT_LOOP_WINDOW`].
    pub loops: Option<NonZeroUsize>,
    /// Smoothing (G50, G51).
    pub smoothing: Option<Smoothing>,
    /// Rounding (G50, G52).
    pub rounding: Option<Rounding>,
    /// Limits on curves.
    pub circular: Option<CircularLimits>,
}

/// A stage of preparation that D belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Tool radius correction.
    ToolRadius,
    /// Smoothing of corners by splines.
    Smoothing,
    /// Rounding of corners by arcs.
    Rounding,
}

impl std::fmt::Display for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::ToolRadius => "tool radius correction",
            Self::Smoothing => "smoothing",
            Self::Rounding => "rounding",
        })
    }
}

/// Two stages that are active at the same time, which cannot be combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{first} and {second} cannot be combined: D belongs to either")]
pub struct Incompatible {
    /// The one.
    pub first: Stage,
    /// The other.
    pub second: Stage,
}

/// A stage that may be left out.
#[derive(Debug)]
pub enum Optional<I, A> {
    /// It is left out.
    Without(I),
    /// It is there.
    With(A),
}

impl<I, A, T> Iterator for Optional<I, A>
where
    I: Iterator<Item = T>,
    A: Iterator<Item = T>,
{
    type Item = T;

    fn next(&mut self) -> Option<T> {
        match self {
            Self::Without(upstream) => upstream.next(),
            Self::With(stage) => stage.next(),
        }
    }
}

type Corrected<I, E> = Optional<I, ToolRadius<I, E>>;
type Unlooped<I, E> = Optional<Corrected<I, E>, AvoidLoops<Corrected<I, E>, E>>;
type Smoothed<I, E> = Optional<Unlooped<I, E>, SmoothPath<Unlooped<I, E>, E>>;
type Rounded<I, E> = Optional<Smoothed<I, E>, RoundPath<Smoothed<I, E>, E>>;

/// The path behind all adapters that change it: what [`Preparation::apply`] makes of the elements of `I`.
pub type PreparedPath<I, E> = Optional<Rounded<I, E>, LimitCircularVelocities<Rounded<I, E>, E>>;

impl Preparation {
    /// Preparation for a program with these marks (of all its elements together), with the adapters' defaults: D gives
    /// all radii and distances, and curves have no limits.
    pub fn for_marks(marks: Marks) -> Self {
        let any = |of: Marks| marks.0 & of.0 != 0;
        let correction = Marks::CORRECTION_LEFT.with(Marks::CORRECTION_RIGHT);
        Self {
            tool_radius: any(correction).then(ToolRadiusOptions::default),
            loops: any(Marks::LOOPS).then_some(DEFAULT_LOOP_WINDOW),
            smoothing: any(Marks::SMOOTHING).then(Smoothing::default),
            rounding: any(Marks::ROUNDING).then(Rounding::default),
            circular: None,
        }
    }

    /// The path of `upstream` through the stages; what they notice goes to `notices`.
    pub fn apply<I, E>(&self, upstream: I, notices: &Notices) -> PreparedPath<I, E>
    where
        I: Iterator<Item = Result<PathElement, E>>,
        E: From<ToolRadiusError> + From<CornerError>,
    {
        let path = match self.tool_radius {
            None => Optional::Without(upstream),
            Some(options) => Optional::With(ToolRadius::new(upstream, options, notices.clone())),
        };
        let path = match self.loops {
            None => Optional::Without(path),
            Some(window) => Optional::With(AvoidLoops::with_window(path, window, notices.clone())),
        };
        let path = match self.smoothing {
            None => Optional::Without(path),
            Some(style) => Optional::With(SmoothPath::new(path, style, notices.clone())),
        };
        let path = match self.rounding {
            None => Optional::Without(path),
            Some(style) => Optional::With(RoundPath::new(path, style, notices.clone())),
        };
        match self.circular {
            None => Optional::Without(path),
            Some(limits) => Optional::With(LimitCircularVelocities::new(path, limits)),
        }
    }

    /// The same, then checked for the interpolator; turns of up to `angle_tolerance`, rad, are passed without a stop.
    pub fn check<I, E>(
        &self,
        upstream: I,
        angle_tolerance: f64,
        notices: &Notices,
    ) -> CheckVelocities<PreparedPath<I, E>, E>
    where
        I: Iterator<Item = Result<PathElement, E>>,
        E: From<ToolRadiusError> + From<CornerError> + From<CheckError>,
    {
        CheckVelocities::new(self.apply(upstream, notices), angle_tolerance)
    }
}
