//! Elements of the blended path.

use super::turn::{BearingDisc, Held};
use super::{Bearing, Blend, Joint};
use nalgebra::{Point3, Vector2, Vector3};
use std::sync::Arc;
use twin_path::Place;
use twin_path::prepare::{CheckedElement, curvature};
use twin_path::{ElementKind, ExtraPoint, PathDisc, Shape};

/// Places nearer to each other than this part of the length are one.
pub(super) const SAME_PLACE: f64 = 1e-9;
/// The parameter of a turn, m per degree: as that of an additional axis.
const PER_DEGREE: f64 = 1e-3;

/// Transition of the programmed path from one element into the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// By how much its curvature steps, 1/m: [`twin_path::prepare::LimitCircularVelocities`] says how that is measured.
    pub curvature_jump: f64,
    /// Velocity limit of the element at its end, in addition to its feed and that of the next, m/s; infinite if none.
    pub velocity: f64,
}

impl Transition {
    /// Nothing that would have to be limited.
    const NONE: Self = Self { curvature_jump: 0.0, velocity: f64::INFINITY };
}

/// A path element with what replaces it at its ends.
///
/// The parameter s is the path length of the original element, 0 to [`Self::length`], everywhere. Where the tool turns with
/// the path there are also turns at rest, [`Self::is_turn`], which replace nothing: the original of such an element is the
/// place where the path rests.
#[derive(Clone, Debug, PartialEq)]
pub struct BlendedElement {
    element: CheckedElement,
    head: Option<Arc<Blend>>,
    tail: Option<Arc<Blend>>,
    joint: Joint,
    /// At its start and its end.
    transitions: [Transition; 2],
    /// Where the tool turns with the path.
    held: Option<Held>,
}

impl BlendedElement {
    /// As it is, with a stop at its end.
    pub(super) fn new(element: CheckedElement) -> Self {
        let transitions = [Transition::NONE; 2];
        Self { element, head: None, tail: None, joint: Joint::STOP, transitions, held: None }
    }

    /// As programmed, and not blended. If the tool turns with the path, with its direction; `heading` (rad) is the one to
    /// keep where the element has none.
    pub(crate) fn programmed(element: CheckedElement, heading: Option<f64>) -> Self {
        let held = heading.map(|heading| {
            let [along, _] = super::turn::directions(&element).unwrap_or([heading; 2]);
            Held { along, turn: 0.0 }
        });
        Self { held, ..Self::new(element) }
    }

    /// The direction of the path counts.
    pub(super) fn hold(&mut self, held: Held) {
        self.held = Some(held);
    }

    /// Ends in a stop.
    pub(super) fn stop(&mut self) {
        self.joint.stop = true;
    }

    /// True if the path rests here, and only its direction turns. The parameter is a thousandth of the angle in degrees
    /// then.
    pub fn is_turn(&self) -> bool {
        self.turned_by() != 0.0
    }

    fn turned_by(&self) -> f64 {
        self.held.map_or(0.0, |held| held.turn)
    }

    /// The direction of the path seen from above at `s`, where the course is at `point`; none unless
    /// [`BlendOptions::turning`](super::BlendOptions::turning). Where the path has none it stays as it was; before the
    /// first, it is the first.
    pub fn bearing(&self, s: f64, point: &BlendedPoint) -> Option<Bearing> {
        let Held { along, turn } = self.held?;
        if turn != 0.0 {
            let first = turn / self.length();
            return Some(Bearing { first, ..Bearing::resting(along + first * s) });
        }
        Some(Bearing::at(point, self.fourth(s)).unwrap_or(Bearing::resting(along)))
    }

    /// Begins with the second half of `blend`.
    pub(super) fn lead_in(&mut self, blend: Arc<Blend>) {
        self.head = Some(blend);
    }

    /// Ends with the first half of `blend`, without a step.
    pub(super) fn lead_out(&mut self, blend: Arc<Blend>) {
        self.tail = Some(blend);
        self.joint = Joint::default();
    }

    /// Ends as it is, with what `joint` says.
    pub(super) fn leave(&mut self, joint: Joint) {
        self.joint = joint;
    }

    /// The path goes on into `next` with `transition`.
    pub(super) fn pass_into(&mut self, next: &mut Self, transition: Transition) {
        self.transitions[1] = transition;
        next.transitions[0] = transition;
    }

    /// Transitions of the programmed path from the element before and into the next. They are empty at stops.
    pub fn transitions(&self) -> [Transition; 2] {
        self.transitions
    }

    /// Curvature of the programmed path in its plane at `s`, 1/m, not negative.
    pub fn curvature(&self, s: f64) -> f64 {
        curvature(&self.element.shape, s).norm()
    }

    /// The original element.
    pub fn element(&self) -> &CheckedElement {
        &self.element
    }

    /// The original element.
    pub fn into_element(self) -> CheckedElement {
        self.element
    }

    /// The blend at the joint with the element before, of which the second half is on this one.
    pub fn head(&self) -> Option<&Arc<Blend>> {
        self.head.as_ref()
    }

    /// The blend at the joint with the next element, of which the first half is on this one.
    pub fn tail(&self) -> Option<&Arc<Blend>> {
        self.tail.as_ref()
    }

    /// True if a blend replaces a part of it.
    pub fn is_blended(&self) -> bool {
        self.head.is_some() || self.tail.is_some()
    }

    /// True if the tool goes straight along all of it, at the velocity of the path.
    pub(crate) fn is_line(&self) -> bool {
        let is_line = matches!(self.element.shape, Shape::Line { .. });
        is_line && self.element.details.is_none() && !self.is_blended()
    }

    /// Remaining steps at the end of the element.
    pub fn joint(&self) -> Joint {
        self.joint
    }

    /// Length of the original path, m; 0 for elements without motion.
    pub fn length(&self) -> f64 {
        let turn = self.turned_by();
        if turn == 0.0 { self.element.path_length() } else { turn.abs().to_degrees() * PER_DEGREE }
    }

    /// End of the blend with the element before, m.
    pub(super) fn head_end(&self) -> f64 {
        self.head.as_ref().map_or(0.0, |blend| blend.half_width())
    }

    /// Begin of the blend with the next element, m.
    fn tail_start(&self) -> f64 {
        self.length() - self.tail.as_ref().map_or(0.0, |blend| blend.half_width())
    }

    /// Position and derivatives at `s`, m, 0 to [`Self::length`]; what is beyond counts as the end. Where the third
    /// derivative steps, at [`Self::breaks`], it is that of the blend.
    ///
    /// What has no length is where it ends, and its derivatives are zero.
    ///
    /// A blend costs about as much as an arc, a fifth of a cubic.
    pub fn at(&self, s: f64) -> BlendedPoint {
        let length = self.length();
        let s = s.max(0.0).min(length);
        match (&self.head, &self.tail) {
            (Some(blend), _) if s <= blend.half_width() => blend.at(s),
            (_, Some(blend)) if s >= self.tail_start() => blend.at(s - length),
            _ => BlendedPoint::of(&self.element, s),
        }
    }

    /// Disc about `s` (m) on which the path is analytic.
    pub fn disc(&self, s: f64) -> PathDisc {
        let length = self.length();
        match (&self.head, &self.tail) {
            (Some(blend), _) if s <= blend.half_width() => blend.disc(),
            (_, Some(blend)) if s >= self.tail_start() => blend.disc(),
            _ if self.is_turn() || !self.element.has_path() => PathDisc::STRAIGHT,
            _ => self.element.disc(s.clamp(0.0, length)),
        }
    }

    /// Disc about `s` (m) on which [`Self::bearing`] is analytic, where the path is at `point`.
    pub fn bearing_disc(&self, s: f64, point: &BlendedPoint) -> BearingDisc {
        let is_blended = (self.head.is_some() && s <= self.head_end())
            || (self.tail.is_some() && s >= self.tail_start());
        match &self.element.shape {
            _ if self.is_turn() || self.held.is_none() => BearingDisc::EVEN,
            _ if is_blended => BearingDisc::of_tangent(point, &self.disc(s)),
            Shape::Line { .. } => BearingDisc::EVEN,
            Shape::Arc(arc) => BearingDisc::of_arc(arc, point, &self.disc(s)),
            Shape::Ellipse(_) | Shape::Cubic(_) => BearingDisc::of_tangent(point, &self.disc(s)),
        }
    }

    /// The fourth derivative of X and Y at `s`.
    fn fourth(&self, s: f64) -> Vector2<f64> {
        let length = self.length();
        match (&self.head, &self.tail) {
            (Some(blend), _) if s <= blend.half_width() => blend.fourth(s),
            (_, Some(blend)) if s >= self.tail_start() => blend.fourth(s - length),
            _ => self.element.shape.fourth_at(s),
        }
    }

    /// Places where the third derivative may step, m, strictly increasing: 0, the end of the blend with the element
    /// before, the start of that with the next, and the length, as far as they exist.
    pub fn breaks(&self) -> impl Iterator<Item = f64> + use<> {
        let length = self.length();
        let apart = SAME_PLACE * length;
        let mut last = 0.0;
        let inner = [self.head_end(), self.tail_start()].into_iter().filter(move |at| {
            let new = *at - last > apart && length - *at > apart;
            if new {
                last = *at;
            }
            new
        });
        let end = (length > 0.0).then_some(length);
        std::iter::once(0.0).chain(inner).chain(end)
    }

    /// The block it comes from.
    pub fn place(&self) -> Place {
        self.element.place
    }

    /// Programmed velocity along the path (F), m/s.
    pub fn feed(&self) -> f64 {
        self.element.feed
    }

    /// Programmed acceleration along the path (E+), m/s², positive.
    pub fn acceleration(&self) -> f64 {
        self.element.acceleration
    }

    /// Programmed deceleration along the path (E−), m/s², positive.
    pub fn deceleration(&self) -> f64 {
        self.element.deceleration
    }

    /// Largest velocity with which the original path goes on into the next element, m/s.
    pub fn end_velocity(&self) -> f64 {
        self.element.end_velocity
    }

    /// True for positioning (G0).
    pub fn rapid(&self) -> bool {
        self.element.kind == ElementKind::Rapid
    }

    /// True if the course has to stop at the end of the element, because the path does or because no course leads on.
    pub fn stops_at_end(&self) -> bool {
        self.joint.stop
    }
}

/// Position and derivatives of the course by its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendedPoint {
    /// Position, m.
    pub position: Point3<f64>,
    /// First derivative: the unit tangent of the original path, no unit vector within a blend.
    pub first: Vector3<f64>,
    /// Second derivative, 1/m.
    pub second: Vector3<f64>,
    /// Third derivative, 1/m².
    pub third: Vector3<f64>,
    /// The extra axes with their derivatives, if the program has named any.
    pub extra: Option<ExtraPoint>,
}

impl BlendedPoint {
    /// That of the original path.
    pub(super) fn of(element: &CheckedElement, s: f64) -> Self {
        let extra = element.extra_at(s);
        if !element.has_path() {
            let zero = Vector3::zeros();
            return Self { position: element.end(), first: zero, second: zero, third: zero, extra };
        }
        let point = element.at(s);
        Self {
            position: point.position,
            first: point.tangent,
            second: point.curvature,
            third: point.curvature_rate,
            extra,
        }
    }
}
