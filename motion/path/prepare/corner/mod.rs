//! Corner blending: replaces corners by curves that need no stop: [`SmoothPath`] and [`RoundPath`].

mod round;
mod smooth;

pub use round::{RoundPath, Rounding};
pub use smooth::{SmoothPath, Smoothing};

use super::piece::{self, ANGLE_EPS, POINT_EPS, Station, flat};
use super::{Notice, Notices, Stage};
use crate::Place;
use crate::units::mm;
use crate::{ElementKind, Marks, PathElement, Plane, Shape, Switch};
use nalgebra::Vector2;
use std::collections::VecDeque;

/// Elements without a path, and errors, that are carried from before a corner to behind it; with more of them in a row
/// the corner stays.
const MOST_BETWEEN: usize = 64;

/// Style of a corner replacement: the difference between smoothing and rounding.
pub trait CornerStyle {
    /// The mark with which it begins.
    const BEGIN: Marks;

    /// Its name in notices.
    const STAGE: Stage;

    /// Turns up to this stay as they are, rad (`dAngleTol`).
    fn angle_tolerance(&self) -> f64;

    /// The distance from the corner at which the elements are cut, m, where the program says `programmed` (D).
    fn distance(&self, programmed: f64) -> f64;

    /// True if it can end or begin on this shape.
    fn joins(&self, shape: &Shape) -> bool;

    /// The shape in place of `corner`; none if there is no sensible one.
    fn shape(&self, corner: &Corner) -> Option<Shape>;
}

/// A corner, cut open.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Point at which the first element is cut off.
    start: nalgebra::Point3<f64>,
    /// Point from which the second one goes on.
    end: nalgebra::Point3<f64>,
    /// Unit direction in X and Y of the first at its cut.
    start_direction: Vector2<f64>,
    /// Unit direction in X and Y of the second at its cut.
    end_direction: Vector2<f64>,
    /// Distance of the two cuts from the corner in X and Y, m.
    distance: f64,
}

/// Reason why a corner cannot be replaced.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CornerError {
    /// The distance from the corner (D, or the adapter's own together with it) is negative or no number.
    #[error("{place}: corners cannot be cut {} mm before them", mm(*distance))]
    Distance {
        /// The block of the element before the corner.
        place: Place,
        /// The distance, m.
        distance: f64,
    },
}

impl CornerError {
    /// The block it is about.
    pub const fn place(&self) -> Place {
        match self {
            Self::Distance { place, .. } => *place,
        }
    }
}

/// The stream adapter behind [`SmoothPath`] and [`RoundPath`].
///
/// The path is cut in X and Y; Z and the extra axes go on linearly from the one cut to the other. The inserted element
/// has the smaller limits of its neighbours and belongs to the block of the first. Untouched stay: turns within the
/// angle tolerance, neighbours of rapids and jumps, elements that do not move in X or Y, and those curving in another
/// plane. No more than half of an element is ever cut off at either of its ends. A distance of 0 leaves the corners of
/// its section and gives [`Notice::NoRadius`] once.
///
/// Between the two elements of a corner may be M functions, dwells and elements of length zero: they move behind the
/// corner, to where the second element now begins. Switches on the parts cut off move onto the inserted element, those
/// of the first into its first half, those of the second into its second half.
///
/// One element is held back, with what stands between it and the next (at most 64 elements without a path or errors;
/// more keep their corner).
#[derive(Debug)]
pub struct Corners<I, E, S> {
    upstream: I,
    style: S,
    notices: Notices,
    active: bool,
    /// This section has no distance, which has been reported.
    without_distance: bool,
    held: Option<Held>,
    /// What stands between the held element and the next.
    between: VecDeque<Result<PathElement, E>>,
    ready: VecDeque<Result<PathElement, E>>,
    ended: bool,
}

/// An element whose end may still be cut off.
#[derive(Debug)]
struct Held {
    element: PathElement,
    /// How much of its start is cut off, m of path length.
    from: f64,
}

impl Held {
    fn finish(self) -> PathElement {
        if self.from <= 0.0 {
            return self.element;
        }
        let length = self.element.shape.length();
        piece::section(&self.element, self.from, length)
    }
}

impl<I, E, S> Corners<I, E, S>
where
    I: Iterator<Item = Result<PathElement, E>>,
    E: From<CornerError>,
    S: CornerStyle,
{
    /// Replaces corners of `upstream` by `style`; lost switches are reported to `notices`.
    pub fn new(upstream: I, style: S, notices: Notices) -> Self {
        Self {
            upstream,
            style,
            notices,
            active: false,
            without_distance: false,
            held: None,
            between: VecDeque::new(),
            ready: VecDeque::new(),
            ended: false,
        }
    }

    /// Hands on what is held, corners as they are.
    fn flush(&mut self) {
        self.ready.extend(self.held.take().map(|held| Ok(held.finish())));
        self.ready.append(&mut self.between);
    }

    fn take(&mut self, item: Result<PathElement, E>) {
        let mut element = match item {
            Ok(element) => element,
            Err(error) => return self.carry(Err(error)),
        };
        if element.marks.contains(S::BEGIN) {
            self.active = true;
            self.without_distance = false;
        }
        let ends = self.active && element.marks.contains(Marks::CORNERS_END);
        if self.active {
            element.marks = element.marks.without(S::BEGIN).without(if ends {
                Marks::CORNERS_END
            } else {
                Marks::default()
            });
        }
        let stays = matches!(element.kind, ElementKind::Jump | ElementKind::Probe { .. });
        if element.length() <= 0.0 && !stays {
            if ends {
                self.active = false;
                self.flush();
            }
            return self.carry(Ok(element));
        }
        let from = self.corner(&element);
        let element = Held { element, from };
        self.active &= !ends;
        if self.active && element.element.kind == ElementKind::Cut {
            self.held = Some(element);
        } else {
            self.ready.push_back(Ok(element.finish()));
        }
    }

    /// Takes what has no path.
    fn carry(&mut self, item: Result<PathElement, E>) {
        if self.between.len() >= MOST_BETWEEN {
            self.flush();
        }
        if self.held.is_some() {
            self.between.push_back(item);
        } else {
            self.ready.push_back(item);
        }
    }

    /// Hands on the held element and what follows up to the beginning of `next`, with the corner replaced if it shall
    /// be; how much of `next` is cut off by that, m of path length.
    fn corner(&mut self, next: &PathElement) -> f64 {
        let Some(held) = self.held.take() else { return 0.0 };
        let cut = match self.cut(&held.element, next) {
            Ok(cut) => cut,
            Err(error) => {
                self.held = Some(held);
                self.flush();
                self.ready.push_back(Err(E::from(error)));
                return 0.0;
            }
        };
        let Some(Cut { to, from, inserted }) = cut else {
            self.held = Some(held);
            self.flush();
            return 0.0;
        };
        let mut inserted = self.hand_over(inserted, &held.element, next, [to, from]);
        let behind = Station::at(next, from);
        if to - held.from > POINT_EPS {
            self.ready.push_back(Ok(piece::section(&held.element, held.from, to)));
        } else {
            // Nothing is left between two corners but rounding, and at nothing the path would stop.
            self.take_over(&mut inserted, &held, to);
        }
        self.ready.push_back(Ok(inserted));
        for mut item in self.between.drain(..) {
            if let Ok(element) = &mut item {
                piece::relocate(element, &behind);
            }
            self.ready.push_back(item);
        }
        from
    }

    /// Lets the inserted element begin where the one before it ends, with the marks and switches of what lay between.
    fn take_over(&self, inserted: &mut PathElement, held: &Held, to: f64) {
        let start = Station::at(&held.element, held.from);
        let end = inserted.end();
        inserted.shape = inserted.shape.clone().with_ends(start.point, end);
        if inserted.extra().is_some() {
            piece::set_start_extra(inserted, start.extra);
        }
        inserted.marks = inserted.marks.with(held.element.marks);
        for switch in piece::part_of_switches(&held.element, held.from, to, held.from, to) {
            let switch = Switch { at: 0.0, ..switch };
            piece::add_switch(inserted, switch, held.element.place, &self.notices);
        }
    }

    /// Cuts at the corner between two elements, and its replacement; none if the corner stays.
    fn cut(&mut self, first: &PathElement, next: &PathElement) -> Result<Option<Cut>, CornerError> {
        let on_plane =
            |shape: &Shape| !matches!(shape, Shape::Arc(arc) if arc.plane() != Plane::Xy);
        let fits = |element: &PathElement| {
            element.kind == ElementKind::Cut
                && self.style.joins(&element.shape)
                && on_plane(&element.shape)
        };
        if !fits(first) || !fits(next) {
            return Ok(None);
        }
        let lengths = [first.shape.length(), next.shape.length()];
        let Some(turn) = turn(&first.shape, lengths[0], &next.shape, 0.0) else {
            return Ok(None);
        };
        if turn <= self.style.angle_tolerance() + ANGLE_EPS {
            return Ok(None);
        }
        let distance = self.style.distance(first.tool_radius);
        if distance.is_nan() || distance < 0.0 {
            return Err(CornerError::Distance { place: first.place, distance });
        }
        if distance == 0.0 && !std::mem::replace(&mut self.without_distance, true) {
            self.notices.add(Notice::NoRadius { place: first.place, stage: S::STAGE });
        }
        let back = Arm { shape: &first.shape, length: lengths[0], backwards: true };
        let forth = Arm { shape: &next.shape, length: lengths[1], backwards: false };
        let distance = distance.min(back.reach()).min(forth.reach());
        if distance <= POINT_EPS {
            return Ok(None);
        }
        let (to, from) = (lengths[0] - back.length_to(distance), forth.length_to(distance));
        let (start, end) = (Station::at(first, to), Station::at(next, from));
        let (Some(start_direction), Some(end_direction)) =
            (direction(&first.shape, to), direction(&next.shape, from))
        else {
            return Ok(None);
        };
        let corner =
            Corner { start: start.point, end: end.point, start_direction, end_direction, distance };
        let Some(shape) = self.style.shape(&corner) else { return Ok(None) };
        let inserted = piece::between(first, next, shape, [&start, &end]);
        Ok(Some(Cut { to, from, inserted }))
    }

    /// Gives the inserted element the switches of the parts cut off.
    fn hand_over(
        &self,
        mut inserted: PathElement,
        first: &PathElement,
        next: &PathElement,
        [to, from]: [f64; 2],
    ) -> PathElement {
        let length = first.shape.length();
        for switch in piece::part_of_switches(first, to, length, to, length) {
            let switch = Switch { at: 0.5 * switch.at, ..switch };
            piece::add_switch(&mut inserted, switch, first.place, &self.notices);
        }
        for switch in piece::part_of_switches(next, 0.0, from, 0.0, from) {
            let switch = Switch { at: 0.5 + 0.5 * switch.at, ..switch };
            piece::add_switch(&mut inserted, switch, next.place, &self.notices);
        }
        inserted
    }
}

impl<I, E, S> Iterator for Corners<I, E, S>
where
    I: Iterator<Item = Result<PathElement, E>>,
    E: From<CornerError>,
    S: CornerStyle,
{
    type Item = Result<PathElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(item) = self.ready.pop_front() {
                return Some(item);
            }
            if self.ended {
                return None;
            }
            if let Some(item) = self.upstream.next() {
                self.take(item);
            } else {
                self.ended = true;
                self.flush();
            }
        }
    }
}

/// A corner cut open: path length at which the first element ends and the second begins, and what comes between.
#[derive(Debug)]
struct Cut {
    to: f64,
    from: f64,
    inserted: PathElement,
}

/// One of the two elements of a corner, seen from the corner.
#[derive(Clone, Copy, Debug)]
struct Arm<'a> {
    shape: &'a Shape,
    length: f64,
    backwards: bool,
}

impl Arm<'_> {
    /// Distance in X and Y from the corner at path length `s` from it.
    fn distance(&self, s: f64) -> f64 {
        let (corner, point) = if self.backwards {
            (self.shape.end(), self.shape.at(self.length - s).position)
        } else {
            (self.shape.start(), self.shape.at(s).position)
        };
        flat(&(point - corner)).norm()
    }

    /// The largest distance at which it may be cut: that of its middle.
    fn reach(&self) -> f64 {
        self.distance(0.5 * self.length)
    }

    /// Path length from the corner at which the path first has this distance from it.
    fn length_to(&self, distance: f64) -> f64 {
        if let Shape::Line { start, end } = self.shape {
            return distance * self.length / flat(&(end - start)).norm();
        }
        // On an arc the distance grows up to half a turn, which is more than half of any arc; on a spline that comes
        // back this finds one of the places.
        let (mut low, mut high) = (0.0_f64, 0.5 * self.length);
        if self.distance(high) <= distance {
            return high;
        }
        loop {
            let middle = low.midpoint(high);
            if middle <= low || middle >= high {
                return middle;
            }
            if self.distance(middle) < distance {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
}

/// Unit direction in X and Y at path length `s`; none where the path does not move there.
fn direction(shape: &Shape, s: f64) -> Option<Vector2<f64>> {
    flat(&shape.at(s).tangent).try_normalize(f64::EPSILON)
}

/// Angle in X and Y between two directions, rad, 0 to π.
fn turn(first: &Shape, s: f64, next: &Shape, t: f64) -> Option<f64> {
    let (a, b) = (direction(first, s)?, direction(next, t)?);
    Some(2.0 * (a - b).norm().atan2((a + b).norm()))
}
