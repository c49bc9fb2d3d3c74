//! Offset path of a contour: offset pieces, joined at the corners.

use super::super::piece::{self, POINT_EPS, Station};
use super::super::planar::{Crossing, Curve, Round, crossings, distance};
use super::super::{Notice, Notices};
use super::ToolRadiusOptions;
use super::gouge::GougeCheck;
use crate::{Details, ElementKind, Marks, PathElement, Shape, Switch};
use nalgebra::{Point2, Point3};
use std::collections::VecDeque;
use std::f64::consts::PI;

/// Directions that differ from a reversal by less than this are one, rad.
const REVERSAL: f64 = 1e-9;

/// Offsets that end no further than this apart at an inner corner meet, m: the rounding of programs in micrometres.
const SMALL_GAP: f64 = 1e-6;

/// Elements that are dropped are not reported where the tool comes as near as this to touching them, m: programs in
/// micrometres have corners of all kinds between short elements.
const UNTOUCHED: f64 = 2e-6;

/// No more than this is carried over from pieces that are dropped.
const MOST_WAITING: usize = 1024;

/// Items between two pieces of the path, in order: elements that do not move in X and Y, and errors.
pub(super) type Between<E> = VecDeque<Result<PathElement, E>>;

/// One piece of the path that may still be cut shorter.
#[derive(Debug)]
struct Track<E> {
    /// The piece of the program, a line or an arc; of a joint, what it needs of it.
    element: PathElement,
    /// The piece of the contour; a joint has none.
    contour: Option<Curve>,
    /// The whole offset piece.
    curve: Curve,
    /// The part of it that is left.
    from: f64,
    to: f64,
    role: Role,
    /// False where it is only there so that the path does not break: an arc turned inside out, or an inner corner
    /// whose neighbours do not meet. What lies around it should be cut off.
    sound: bool,
    between: Between<E>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// At the offset from a piece of the contour.
    Offset,
    /// Around a corner.
    Joint,
}

/// The offset path of one contour, from the mark where it begins to where it ends.
#[derive(Debug)]
pub(super) struct Offset<E> {
    /// Distance to the contour, m, positive to the left.
    distance: f64,
    look_ahead: usize,
    notices: Notices,
    check: GougeCheck,
    tracks: VecDeque<Track<E>>,
    /// End of the pieces handed out.
    at: Station,
    /// False where the set-point has jumped, or at the very beginning: then there is not a corner.
    joined: bool,
}

impl<E> Offset<E> {
    /// A path that begins where `first`, the first piece of the contour, has its offset; where that is.
    pub(super) fn new(
        distance: f64,
        options: &ToolRadiusOptions,
        notices: Notices,
        first: &PathElement,
        first_curve: &Curve,
    ) -> Self {
        let (curve, _) = first_curve.offset(distance);
        // Delay of the path behind the contour, in pieces.
        let windows =
            [options.gouge_window.saturating_add(options.look_ahead), options.gouge_window];
        let mut at = Station::start(first);
        (at.point.x, at.point.y) = (curve.start().x, curve.start().y);
        Self {
            distance,
            look_ahead: options.look_ahead,
            notices,
            check: GougeCheck::new(distance.abs(), options.gouge_tolerance, windows),
            tracks: VecDeque::new(),
            at,
            joined: false,
        }
    }

    /// End of the pieces handed out.
    pub(super) fn station(&self) -> Station {
        self.at
    }

    /// The next piece of the contour: `element` with the projection `contour`; `between` is done before it. What is
    /// finished goes to `ready`.
    pub(super) fn push(
        &mut self,
        element: PathElement,
        contour: &Curve,
        mut between: Between<E>,
        ready: &mut Between<E>,
    ) {
        if element.kind == ElementKind::Cut {
            self.check.contour(element.place, *contour, &self.notices);
        }
        let jumps = |item: &Result<PathElement, E>| matches!(item, Ok(element) if element.kind == ElementKind::Jump);
        let (curve, inside_out) = contour.offset(self.distance);
        if between.iter().any(jumps) {
            self.finish(ready);
            self.joined = false;
            self.place(&mut between, Some(&curve));
            ready.append(&mut between);
            self.at.point.x = curve.start().x;
            self.at.point.y = curve.start().y;
        }
        if self.joined {
            self.join(&element, contour.start(), &curve, inside_out);
        }
        self.joined = true;
        let (role, sound) = (Role::Offset, !inside_out);
        let contour = Some(*contour);
        self.add(Track { element, contour, curve, from: 0.0, to: 1.0, role, sound, between });
        self.settle(ready);
    }

    /// Hands out everything: the path goes no further, or nothing more is known of it.
    pub(super) fn finish(&mut self, ready: &mut Between<E>) {
        while let Some(track) = self.tracks.pop_front() {
            self.hand_out(track, ready);
        }
    }

    /// Makes the path go from its end to the start of `next`, the offset of the piece that begins at `corner`.
    fn join(&mut self, element: &PathElement, corner: Point2<f64>, next: &Curve, inside_out: bool) {
        let end = self.tracks.back().map_or(self.at.point.xy(), |last| last.curve.end());
        let start = next.start();
        if (start - end).norm() <= POINT_EPS {
            return;
        }
        let (before, after) = (end - corner, start - corner);
        let mut sweep = before.perp(&after).atan2(before.dot(&after));
        let reversal = sweep.abs() > PI - REVERSAL;
        let outer = reversal || sweep * self.distance < 0.0;
        if reversal {
            // Around the end, not through the contour.
            sweep = -sweep.abs().copysign(self.distance);
        } else if !outer && !inside_out && self.meet(next) {
            return;
        }
        // Both ends are a radius away from the corner.
        let arc = Curve::Arc(Round::new(end, start, corner, sweep));
        self.add(Track {
            element: joint_element(element),
            contour: None,
            curve: arc,
            from: 0.0,
            to: 1.0,
            role: Role::Joint,
            sound: outer,
            between: VecDeque::new(),
        });
    }

    /// True if the last piece meets `next`, and the next piece to be added will find it there.
    fn meet(&self, next: &Curve) -> bool {
        self.tracks.back().is_some_and(|last| last.sound && at_corner(last, next).is_some())
    }

    /// Adds a piece at the end; where the path before it is not sound, it takes the place of what lies behind the
    /// point where it meets a sound piece.
    fn add(&mut self, mut track: Track<E>) {
        if track.sound
            && let Some((index, crossing)) = self.meeting(&track)
        {
            self.cut_back(index, &mut track, crossing);
        }
        self.tracks.push_back(track);
    }

    /// The piece from which the path goes on into `next` before it ends. Where the path is not sound, that is the last
    /// piece before the unsound one that `next` meets where the tool does not come too near to what is left out, but
    /// not over positionings and moves along Z; else it is the neighbour, if `next` does not start at its end.
    fn meeting(&self, next: &Track<E>) -> Option<(usize, Crossing)> {
        self.meeting_behind(next).or_else(|| {
            let last = self.tracks.back().filter(|last| last.sound)?;
            let apart = (last.curve.end() - next.curve.start()).norm() > POINT_EPS;
            let crossing = if apart { at_corner(last, &next.curve) } else { None };
            Some((self.tracks.len() - 1, crossing?))
        })
    }

    fn meeting_behind(&self, next: &Track<E>) -> Option<(usize, Crossing)> {
        let unsound = self.tracks.iter().rposition(|track| !track.sound)?;
        let mut waiting = next.between.len();
        let mut wall = next.is_wall();
        for (index, earlier) in self.tracks.iter().enumerate().rev() {
            if wall || waiting > MOST_WAITING {
                return None;
            }
            if index < unsound && earlier.sound {
                let free = |crossing: &Crossing| {
                    let point = next.curve.at(crossing.v);
                    let here = Curve::Line { start: point, end: point };
                    let mut contours = self
                        .tracks
                        .range(index..)
                        .chain([next])
                        .filter_map(|track| track.contour.as_ref());
                    contours
                        .all(|contour| distance(&here, contour) >= self.distance.abs() - POINT_EPS)
                };
                if let Some(crossing) = nearest(earlier, &next.curve, free) {
                    return Some((index, crossing));
                }
            }
            wall = earlier.is_wall();
            waiting += earlier.between.len();
        }
        None
    }

    /// Lets the path go from the piece number `index` straight into `track`, where they cross.
    fn cut_back(&mut self, index: usize, track: &mut Track<E>, crossing: Crossing) {
        let mut between = Between::new();
        let mut ends = Marks::default();
        let corner = track.curve.at(crossing.v);
        let reach = self.distance.abs() + UNTOUCHED;
        for mut dropped in self.tracks.drain(index + 1..) {
            between.append(&mut dropped.between);
            if dropped.contour.is_some_and(|contour| is_far(&contour, &corner, reach)) {
                self.notices.add(too_narrow(&dropped.element, self.distance));
            }
            for switch in dropped.element.switches() {
                let switch = Switch { at: 0.0, ..*switch };
                piece::add_switch(&mut track.element, switch, dropped.element.place, &self.notices);
            }
            let end_marks = piece::end_marks(dropped.element.marks);
            ends = ends.with(end_marks);
            let begins = dropped.element.marks.without(end_marks);
            track.element.marks = track.element.marks.with(begins);
        }
        between.append(&mut track.between);
        track.between = between;
        track.from = crossing.v;
        if let Some(last) = self.tracks.back_mut() {
            last.to = crossing.u;
            last.element.marks = last.element.marks.with(ends);
        }
    }

    /// Hands out pieces that cannot change any more.
    fn settle(&mut self, ready: &mut Between<E>) {
        // The end of the last piece is not known before the next one.
        while self.tracks.len() > self.look_ahead.max(1) {
            let Some(track) = self.tracks.pop_front() else { return };
            self.hand_out(track, ready);
        }
    }

    fn hand_out(&mut self, mut track: Track<E>, ready: &mut Between<E>) {
        self.place(&mut track.between, None);
        ready.append(&mut track.between);
        let Track { mut element, curve, from, to, role, sound, .. } = track;
        let curve = curve.section(from, to);
        let curve = curve.with_ends(self.at.point.xy(), curve.end());
        let end = match role {
            Role::Joint => self.at,
            Role::Offset => Station::end(&element),
        };
        let end = Station {
            point: Point3::new(curve.end().x, curve.end().y, end.point.z),
            extra: end.extra.or(self.at.extra),
        };
        let plain = element.details.is_none() && element.marks == Marks::default();
        if plain && curve.length() <= 0.0 && self.at == end {
            return;
        }
        element.shape = curve.shape(self.at.point.z, end.point.z);
        piece::set_extra(&mut element, self.at.extra, end.extra);
        piece::trim_switches(&mut element, from, to);
        if role == Role::Offset && !sound {
            self.notices.add(too_narrow(&element, self.distance));
        }
        if element.kind == ElementKind::Cut {
            self.check.path(element.place, curve, &self.notices);
        }
        self.at = end;
        ready.push_back(Ok(element));
    }

    /// Puts what does not move in X and Y where the path is; a jump leads to the start of `next`, or where it leads if
    /// there is none. True if there is a jump.
    pub(super) fn place(&mut self, between: &mut Between<E>, next: Option<&Curve>) -> bool {
        let mut jumped = false;
        for element in between.iter_mut().flatten() {
            let (mut start, mut end) = (element.start(), element.end());
            (start.x, start.y) = (self.at.point.x, self.at.point.y);
            if element.kind == ElementKind::Jump {
                jumped = true;
                if let Some(next) = next {
                    (end.x, end.y) = (next.start().x, next.start().y);
                }
            } else {
                (end.x, end.y) = (start.x, start.y);
            }
            element.shape = Shape::Line { start, end };
            self.at = Station { point: end, extra: Station::end(element).extra.or(self.at.extra) };
        }
        jumped
    }
}

fn too_narrow(element: &PathElement, distance: f64) -> Notice {
    let mut radius = None;
    if let Shape::Arc(arc) = &element.shape {
        radius = Some(arc.radius()).filter(|radius| *radius <= distance.abs());
    }
    Notice::TooNarrow { place: element.place, radius, tool_radius: distance.abs() }
}

impl<E> Track<E> {
    /// True for a piece that the path is not cut across: it is not a cut, or the tool moves along Z before it.
    fn is_wall(&self) -> bool {
        let moves = |element: &PathElement| element.kind.is_motion() && element.length() > 0.0;
        self.element.kind != ElementKind::Cut || self.between.iter().flatten().any(moves)
    }
}

/// Crossing of the rest of `earlier` with `next`: of the valid crossings, the one that leaves most of both.
fn nearest<E>(
    earlier: &Track<E>,
    next: &Curve,
    will_do: impl Fn(&Crossing) -> bool,
) -> Option<Crossing> {
    let (length, next_length) = (earlier.curve.length(), next.length());
    let removed = |crossing: &Crossing| (1.0 - crossing.u) * length + crossing.v * next_length;
    crossings(&earlier.curve, next)
        .into_iter()
        .filter(|crossing| crossing.u >= earlier.from && crossing.u <= earlier.to)
        .filter(will_do)
        .min_by(|a, b| removed(a).total_cmp(&removed(b)))
}

/// Crossing of the rest of `last` with its neighbour `next` at an inner corner.
///
/// Numbers in micrometres turn tangents by some 1e-5, and arcs that grow by as much need not meet what they then should.
/// Half way across such a gap the two are as good as one.
fn at_corner<E>(last: &Track<E>, next: &Curve) -> Option<Crossing> {
    nearest(last, next, |_| true).or_else(|| {
        let half = 0.5 * (next.start() - last.curve.end()).norm();
        let (u, v) = (1.0 - half / last.curve.length(), half / next.length());
        let near = half <= 0.5 * SMALL_GAP
            && u > last.from
            && v < 1.0
            && (last.curve.at(u) - next.at(v)).norm() <= POINT_EPS;
        near.then_some(Crossing { u, v })
    })
}

/// True if some of the contour is further than `reach` from the point.
fn is_far(contour: &Curve, point: &Point2<f64>, reach: f64) -> bool {
    [0.0, 0.5, 1.0].iter().any(|u| (contour.at(*u) - point).norm() > reach)
}

/// Element of a joint at the start of `element`.
fn joint_element(element: &PathElement) -> PathElement {
    let start = Station::start(element);
    let shape = Shape::Line { start: start.point, end: start.point };
    let mut joint =
        PathElement { marks: Marks::default(), details: None, shape, ..element.clone() };
    if let Some(details) = &element.details
        && details.extra.is_some()
    {
        joint.details = Some(Box::new(Details::default()));
        piece::set_extra(&mut joint, start.extra, start.extra);
    }
    joint
}
