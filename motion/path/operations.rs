//! Operations of the CNC editor on objects (manual 3.3, 6.3): cut, reverse, move, turn and scale.

use super::details::{Switch, Switches};
use super::marks::PAIRS;
use super::{Arc, AxisMask, Details, ExtraAxes, ExtraPosition, Marks, PathElement, Plane, Shape};
use crate::Place;
use nalgebra::{Point3, Rotation2, Vector2, Vector3};

/// A similarity: scaled, then turned about the origin's vertical axis, then moved. Extra axes are only moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    scale: f64,
    turn: Rotation2<f64>,
    translation: Vector3<f64>,
    /// Of P Q U V W, u.
    extra: ExtraPosition,
}

/// Reason why an operation is not possible on an element.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OperationError {
    /// Only arcs about a vertical axis can be turned about one.
    #[error("{0}: an arc in a vertical plane (G18, G19) cannot be rotated about Z")]
    UprightArc(Place),
    /// A factor that is not positive and finite.
    #[error("the factor is {0}; it must be above 0")]
    Factor(f64),
    /// A part beyond 0 to 1.
    #[error("the place to split at is {0}; it must lie between 0 and 1")]
    SplitPlace(f64),
    /// A probing move: two of them feel something else than one.
    #[error("{0}: a probing move cannot be split")]
    SplitProbe(Place),
}

impl Similarity {
    /// Changes nothing.
    fn identity() -> Self {
        let (turn, translation) = (Rotation2::identity(), Vector3::zeros());
        Self { scale: 1.0, turn, translation, extra: [0.0; 5] }
    }

    /// Moves by `translation`, m (`SMC_TRANSLATEQUEUE3D`).
    pub fn translation(translation: Vector3<f64>) -> Self {
        Self { translation, ..Self::identity() }
    }

    /// Turns by `angle` (rad, counter-clockwise) about the vertical axis through the origin (`SMC_ROTATEQUEUE2D`).
    pub fn rotation(angle: f64) -> Self {
        Self { turn: Rotation2::new(angle), ..Self::identity() }
    }

    /// Scales by `factor` about the origin (`SMC_SCALEQUEUE3D`).
    ///
    /// # Errors
    /// [`OperationError::Factor`].
    pub fn scaling(factor: f64) -> Result<Self, OperationError> {
        if factor > 0.0 && factor.is_finite() {
            Ok(Self { scale: factor, ..Self::identity() })
        } else {
            Err(OperationError::Factor(factor))
        }
    }

    /// The same, and the extra axes moved by `translation`, u (the editor moves a program by eight axes, manual 3.3). An
    /// axis that the program does not name stands there.
    #[must_use]
    pub fn with_extra_axes(self, translation: ExtraPosition) -> Self {
        Self { extra: translation, ..self }
    }

    /// This one, and then `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            scale: self.scale * next.scale,
            turn: next.turn * self.turn,
            translation: next.vector(&self.translation) * next.scale + next.translation,
            extra: sum(self.extra, next.extra),
        }
    }

    /// Image of a point.
    pub fn point(&self, point: &Point3<f64>) -> Point3<f64> {
        Point3::from(self.vector(&point.coords) * self.scale + self.translation)
    }

    /// Turned, neither moved nor scaled.
    fn vector(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        // Exactly the same where nothing is turned.
        if self.turn == Rotation2::identity() {
            return *vector;
        }
        let flat = self.turn * Vector2::new(vector.x, vector.y);
        Vector3::new(flat.x, flat.y, vector.z)
    }

    fn shape(&self, shape: &Shape) -> Option<Shape> {
        let point = |point: Point3<f64>| self.point(&point);
        let turn = |vector: Vector2<f64>| self.turn * vector;
        Some(match shape {
            Shape::Line { start, end } => Shape::Line { start: point(*start), end: point(*end) },
            Shape::Arc(arc) => {
                if arc.plane() != Plane::Xy && self.turn != Rotation2::identity() {
                    return None;
                }
                Shape::Arc(Arc::in_plane(
                    arc.plane(),
                    point(arc.start()),
                    point(arc.end()),
                    point(arc.center()),
                    arc.sweep(),
                ))
            }
            Shape::Ellipse(ellipse) => {
                Shape::Ellipse(Box::new(ellipse.mapped(&point, &turn, self.scale)))
            }
            Shape::Cubic(cubic) => Shape::Cubic(Box::new(cubic.mapped(&point, &turn, self.scale))),
        })
    }

    /// The element with its path mapped and its extra axes moved. Feed and accelerations stay (manual 6.3 names only the
    /// path).
    ///
    /// # Errors
    /// [`OperationError::UprightArc`].
    pub fn element(&self, element: &PathElement) -> Result<PathElement, OperationError> {
        let shape = self.shape(&element.shape).ok_or(OperationError::UprightArc(element.place))?;
        let mut mapped = PathElement { shape, ..element.clone() };
        if self.extra.iter().any(|by| *by != 0.0) {
            let details = mapped.details.get_or_insert_default();
            let ExtraAxes { start, end } = details.extra.unwrap_or_default();
            let extra = ExtraAxes { start: sum(start, self.extra), end: sum(end, self.extra) };
            details.extra = Some(extra);
        }
        Ok(mapped)
    }
}

/// Axis by axis.
fn sum(a: ExtraPosition, b: ExtraPosition) -> ExtraPosition {
    let mut sum = a;
    for (slot, b) in sum.iter_mut().zip(b) {
        *slot += b;
    }
    sum
}

impl Shape {
    /// The part between two path lengths, m, `from` ≤ `to`. At 0 and at the length its ends are start and end, bit for
    /// bit.
    #[must_use]
    pub fn section(&self, from: f64, to: f64) -> Self {
        let length = self.length();
        let [from, to] = [from, to].map(|s| s.clamp(0.0, length));
        let [start, end] = [from, to].map(|s| self.at(s).position);
        match self {
            Self::Line { .. } => Self::Line { start, end },
            Self::Arc(arc) => {
                let part = if length > 0.0 { (to - from) / length } else { 1.0 };
                Self::Arc(Arc::in_plane(arc.plane(), start, end, arc.center(), arc.sweep() * part))
            }
            Self::Ellipse(ellipse) => {
                Self::Ellipse(Box::new(ellipse.section([from, to], start, end)))
            }
            Self::Cubic(cubic) => Self::Cubic(Box::new(cubic.section([from, to], start, end))),
        }
    }

    /// From its end to its start.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match self {
            Self::Line { start, end } => Self::Line { start: *end, end: *start },
            Self::Arc(arc) => Self::Arc(Arc::in_plane(
                arc.plane(),
                arc.end(),
                arc.start(),
                arc.center(),
                -arc.sweep(),
            )),
            Self::Ellipse(ellipse) => Self::Ellipse(Box::new(ellipse.reversed())),
            Self::Cubic(cubic) => Self::Cubic(Box::new(cubic.reversed())),
        }
    }
}

impl PathElement {
    /// The part between two path lengths, m, `from` ≤ `to`, with the switches in it (those at both ends included).
    /// Start marks go with the start, end marks with the end.
    ///
    /// Extra axes are cut where they are; where they move with the S profile, each part has an S profile of its own.
    #[must_use]
    pub fn section(&self, from: f64, to: f64) -> Self {
        let length = self.length();
        if length <= 0.0 {
            return self.clone();
        }
        let [from, to] = [from, to].map(|s| s.clamp(0.0, length));
        let starts = Marks::STARTS;
        let marks = match (from <= 0.0, to >= length) {
            (true, true) => self.marks,
            (true, false) => Marks(self.marks.0 & starts.0),
            (false, true) => self.marks.without(starts),
            (false, false) => Marks::default(),
        };
        let along_shape = self.shape.length() > 0.0;
        let mut shape = if along_shape { self.shape.section(from, to) } else { self.shape.clone() };
        if along_shape && self.moves_z_smoothly() {
            shape = shape.with_heights(self.at(from).position.z, self.at(to).position.z);
        }
        let details = self.details.as_ref().map(|details| {
            let mut part = Details { switches: Switches::default(), ..(**details).clone() };
            part.extra = self
                .extra_at(from)
                .zip(self.extra_at(to))
                .map(|(start, end)| ExtraAxes { start: start.position, end: end.position });
            for switch in details.switches.as_slice() {
                let at = switch.at * length;
                if at >= from && at <= to {
                    let at = if to > from { (at - from) / (to - from) } else { 0.0 };
                    // As many as fitted before fit again.
                    let _fits = part.switches.add(Switch { at: at.clamp(0.0, 1.0), ..*switch });
                }
            }
            Box::new(part)
        });
        Self { shape, marks, details, ..self.clone() }
    }

    /// Cut in two at the part `at` (0 to 1) of its length (manual 3.3). A switch at the very cut goes with the first
    /// part.
    ///
    /// # Errors
    /// [`OperationError::SplitPlace`].
    pub fn split(&self, at: f64) -> Result<[Self; 2], OperationError> {
        if !(at > 0.0 && at < 1.0) {
            return Err(OperationError::SplitPlace(at));
        }
        let length = self.length();
        let first = self.section(0.0, at * length);
        let mut second = self.section(at * length, length);
        if let Some(details) = &mut second.details {
            let mut switches = Switches::default();
            for switch in details.switches.as_slice().iter().filter(|switch| switch.at > 0.0) {
                let _fits = switches.add(*switch);
            }
            details.switches = switches;
        }
        Ok([first, second])
    }

    /// From its end to its start. Switches stay where they are in space (manual 3.3) and do what they did. Its marks
    /// are left alone: what they mean backwards depends on the elements around it, see [`reversed`].
    #[must_use]
    pub fn reversed(&self) -> Self {
        let details = self.details.as_ref().map(|details| {
            let mut reversed = (**details).clone();
            reversed.extra =
                details.extra.map(|extra| ExtraAxes { start: extra.end, end: extra.start });
            reversed.switches = Switches::default();
            for switch in details.switches.as_slice().iter().rev() {
                let _fits = reversed.switches.add(Switch { at: 1.0 - switch.at, ..*switch });
            }
            Box::new(reversed)
        });
        Self { shape: self.shape.reversed(), details, ..self.clone() }
    }

    fn moves_z_smoothly(&self) -> bool {
        self.details.as_ref().is_some_and(|details| details.s_profile.contains(AxisMask::Z))
    }
}

impl Shape {
    /// The same in X and Y, from one height to another. Upright arcs keep theirs.
    pub(crate) fn with_heights(self, start_z: f64, end_z: f64) -> Self {
        if matches!(&self, Self::Arc(arc) if arc.plane() != Plane::Xy) {
            return self;
        }
        let at = |point: Point3<f64>, z: f64| Point3::new(point.x, point.y, z);
        let (start, end) = (at(self.start(), start_z), at(self.end(), end_z));
        self.with_ends(start, end)
    }

    /// The same between ends that in the plane of the curve lie elsewhere by no more than rounding.
    pub(crate) fn with_ends(self, start: Point3<f64>, end: Point3<f64>) -> Self {
        match self {
            Self::Line { .. } => Self::Line { start, end },
            Self::Arc(arc) => {
                Self::Arc(Arc::in_plane(arc.plane(), start, end, arc.center(), arc.sweep()))
            }
            Self::Ellipse(ellipse) => Self::Ellipse(Box::new(super::Ellipse::new(
                start,
                end,
                ellipse.center(),
                ellipse.major(),
                ellipse.minor(),
                ellipse.sweep(),
            ))),
            Self::Cubic(cubic) => {
                Self::Cubic(Box::new(super::Cubic::between(start, end, cubic.x(), cubic.y())))
            }
        }
    }
}

/// The whole path backwards (manual 3.3), held as a whole; [`super::queue::Backwards`] does it with a file in bounded
/// memory.
///
/// Correction to the left is to the right on the way back. Preparation that begins with an element ends behind it when
/// it is passed the other way: the marks are set anew from what is in force along each element.
pub fn reversed(path: &[PathElement]) -> Vec<PathElement> {
    let mut modes = Modes::default();
    let modes: Vec<_> = path.iter().map(|element| modes.along(element.marks)).collect();
    let mut backwards = Vec::with_capacity(path.len());
    let mut before = Marks::default();
    for (index, element) in path.iter().enumerate().rev() {
        let mode = |index: Option<usize>| index.and_then(|index| modes.get(index)).copied();
        let here = mode(Some(index)).unwrap_or_default();
        let after = mode(index.checked_sub(1)).unwrap_or_default();
        backwards.push(element.backwards(before, here, after));
        before = here;
    }
    backwards
}

impl PathElement {
    /// Reversed, with the marks of a path on which `here` was in force along it (as start marks), `before` along what
    /// comes before it on the way back, and `after` along what comes behind.
    pub(super) fn backwards(&self, before: Marks, here: Marks, after: Marks) -> Self {
        let [before, here, after] = [before, here, after].map(Marks::mirrored);
        let marks = here.without(before).with(here.without(after).endings());
        Self { marks, ..self.reversed() }
    }
}

/// Preparation in force along a path, as start marks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Modes(Marks);

impl Modes {
    /// Preparation in force along the next element, which has these marks.
    pub(super) fn along(&mut self, marks: Marks) -> Marks {
        for (starts, _) in PAIRS {
            let begun = Marks(marks.0 & starts.0);
            if begun != Marks::default() {
                self.0 = self.0.without(starts).with(begun);
            }
        }
        let here = self.0;
        for (starts, end) in PAIRS {
            if marks.contains(end) {
                self.0 = self.0.without(starts);
            }
        }
        here
    }
}
