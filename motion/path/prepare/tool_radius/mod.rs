//! Tool radius correction (`SMC_ToolCorr`, manual 6.2.3).

mod contour;
mod error;
mod gouge;
mod offset;

pub use error::{Side, ToolRadiusError};

use self::contour::{has_way, is_positioning, simple_pieces, stands};
use self::offset::{Between, Offset};
use super::piece::{self, Station};
use super::planar::Curve;
use super::{Notice, Notices, Stage};
use crate::{ElementKind, Marks, PathElement, Plane, Shape};
use std::collections::VecDeque;

/// Elements without a path, and errors, that wait for the next piece of the contour; with more of them in a row the
/// corner there is passed without cutting it.
const MOST_BETWEEN: usize = 64;

/// Options of [`ToolRadius`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolRadiusOptions {
    /// Radius added to D, m (`dToolRadius`).
    pub radius: f64,
    /// Ellipses and splines become arcs that are nowhere further than this from them, m.
    pub tolerance: f64,
    /// Pieces held back to find where the path goes on past elements the tool does not fit into.
    pub look_ahead: usize,
    /// Pieces of contour and path that are compared with each other to find gouges.
    pub gouge_window: usize,
    /// Gouge tolerance: the tool may come nearer to the contour than its radius by this, m.
    pub gouge_tolerance: f64,
}

impl Default for ToolRadiusOptions {
    fn default() -> Self {
        Self {
            radius: 0.0,
            tolerance: 1e-6,
            look_ahead: 128,
            gouge_window: 64,
            gouge_tolerance: 1e-9,
        }
    }
}

/// Moves the path to the left or right by the tool's radius (`SMC_ToolCorr`), from an element marked
/// [`Marks::CORRECTION_LEFT`] (G41) or [`Marks::CORRECTION_RIGHT`] (G42) to one marked [`Marks::CORRECTION_END`]
/// (G40).
///
/// The radius is D of the elements plus [`ToolRadiusOptions::radius`]. In X and Y:
///
/// - lines are shifted, arcs change their radius, ellipses and splines become arcs first (biarcs, tangent to each
///   other) within [`ToolRadiusOptions::tolerance`];
/// - at an inner corner both offsets end where they meet, around an outer one the tool goes in an arc;
/// - at the beginning a positioning (G0) leads from the path to its offset, or a positioning that comes just before is
///   led there itself; at the end likewise back to the path, or a positioning that comes just after starts from the
///   offset. What has no way in X and Y (along Z alone, M functions, dwells) directly before or behind a contour is
///   done at the offset from it, so that the tool neither comes down nor goes up on the contour itself.
///
/// Z and the extra axes of an element go on from its start to its end, however much shorter or longer its offset is;
/// around outer corners they rest. M functions, dwells, elements of length zero or along Z alone, with their switches,
/// are done behind the corner. Behind a jump (G92) the offset from the contour begins anew.
///
/// # Where the tool does not fit
///
/// An arc whose radius is smaller than the tool's vanishes, an element too short between two inner corners reverses.
/// Within [`ToolRadiusOptions::look_ahead`] pieces the path is cut where the offsets before and behind meet, what lies
/// between is dropped ([`super::Notice::TooNarrow`], unless the tool all but touches it), its M functions and dwells are done there, its switches as far
/// as there is room. Where nothing meets, the offset stays as it is, with arcs about the corners (and inside-out arcs)
/// so that it does not break: as in the manual, the path then crosses itself, and [`super::AvoidLoops`] can cut the
/// loop off. Wherever the tool so comes nearer than its radius to a piece of the contour, within
/// [`ToolRadiusOptions::gouge_window`] pieces or at the first piece of a contour, [`super::Notice::Gouge`] reports it.
/// Positionings are not looked at. Both notices are the rule `compensation-gouge`. A contour with a radius of 0 stays as
/// it is and gets [`super::Notice::NoRadius`].
///
/// # Errors
///
/// [`ToolRadiusError`], a probing move included; the correction ends before the element in question, which and all that follow pass as they
/// are up to the next mark.
#[derive(Debug)]
pub struct ToolRadius<I, E> {
    upstream: I,
    options: ToolRadiusOptions,
    notices: Notices,
    state: State<E>,
    /// Between the contours: what may have to lead to the next offset, or back from the last.
    pending: Pending,
    /// What comes behind that without a way in X and Y: it is done at the offset from the contour, if one follows or has ended.
    standing: VecDeque<PathElement>,
    /// What waits for the next piece of the contour.
    between: Between<E>,
    ready: Between<E>,
    ended: bool,
}

#[derive(Debug)]
enum State<E> {
    /// `TC_ORIG`.
    Off,
    /// The mark has come, the first piece of the contour has not.
    Begun(Side),
    /// `TC_LEFT`, `TC_RIGHT`.
    On(Box<Active<E>>),
    /// As [`State::On`] with a radius of 0: the path is its own offset.
    Idle(Side),
}

#[derive(Debug)]
struct Active<E> {
    side: Side,
    radius: f64,
    offset: Offset<E>,
    /// The last piece of the contour, without its details.
    last: PathElement,
}

#[derive(Debug)]
enum Pending {
    Nothing,
    /// A positioning that may be led to an offset.
    Positioning(Box<PathElement>),
    /// The path is at the offset from the end of the contour, whose last piece this is.
    Ended(Box<PathElement>, Station),
}

impl<I, E> ToolRadius<I, E>
where
    I: Iterator<Item = Result<PathElement, E>>,
    E: From<ToolRadiusError>,
{
    /// Corrects the elements of `upstream`; places where the tool does not fit are reported to `notices`.
    pub fn new(upstream: I, options: ToolRadiusOptions, notices: Notices) -> Self {
        Self {
            upstream,
            options,
            notices,
            state: State::Off,
            pending: Pending::Nothing,
            standing: VecDeque::new(),
            between: VecDeque::new(),
            ready: VecDeque::new(),
            ended: false,
        }
    }

    fn take(&mut self, item: Result<PathElement, E>) {
        let mut element = match item {
            Ok(element) => element,
            Err(error) => return self.carry(Err(error)),
        };
        if let Some(to) = Side::of(element.marks) {
            match self.side() {
                None => self.state = State::Begun(to),
                Some(from) if from == to => {}
                Some(from) => {
                    let place = element.place;
                    self.fail(ToolRadiusError::SideChange { place, from, to });
                }
            }
        }
        let ends = element.marks.contains(Marks::CORRECTION_END);
        if self.side().is_some() {
            element.marks = element
                .marks
                .without(Marks::CORRECTION_LEFT)
                .without(Marks::CORRECTION_RIGHT)
                .without(Marks::CORRECTION_END);
            if matches!(element.kind, ElementKind::Probe { .. }) {
                let place = element.place;
                self.refuse(element, ToolRadiusError::Probe(place));
            } else if has_way(&element) {
                self.piece(element);
            } else {
                self.carry(Ok(element));
            }
        } else {
            self.carry(Ok(element));
        }
        if ends {
            self.end();
        }
    }

    /// Side of the tool at the element taken in last (`iStatus`: `TC_LEFT`, `TC_RIGHT`); none where the path is not
    /// corrected (`TC_ORIG`).
    pub fn side(&self) -> Option<Side> {
        match &self.state {
            State::Off => None,
            State::Begun(side) | State::Idle(side) => Some(*side),
            State::On(active) => Some(active.side),
        }
    }

    /// Takes an element that is not a piece of a contour.
    fn carry(&mut self, item: Result<PathElement, E>) {
        match &mut self.state {
            State::On(active) => {
                if self.between.len() >= MOST_BETWEEN {
                    active.offset.finish(&mut self.ready);
                    active.offset.place(&mut self.between, None);
                    self.ready.append(&mut self.between);
                }
                self.between.push_back(item);
            }
            State::Idle(_) => self.ready.push_back(item),
            State::Off | State::Begun(_) => match item {
                Ok(element) if is_positioning(&element) => {
                    self.hold(element);
                }
                Ok(element) if stands(&element) => {
                    if self.standing.len() >= MOST_BETWEEN {
                        self.release();
                    }
                    self.standing.push_back(element);
                }
                item => {
                    self.release();
                    self.ready.push_back(item);
                }
            },
        }
    }

    /// Holds a positioning that may have to lead to an offset; after a contour it starts at the offset from its end.
    fn hold(&mut self, mut positioning: PathElement) {
        match std::mem::replace(&mut self.pending, Pending::Nothing) {
            Pending::Ended(_, at) if has_way(&positioning) => {
                self.stand(at);
                if let Shape::Line { start, .. } = &mut positioning.shape {
                    (start.x, start.y) = (at.point.x, at.point.y);
                }
            }
            pending => {
                self.pending = pending;
                self.release();
            }
        }
        self.pending = Pending::Positioning(Box::new(positioning));
    }

    /// Hands on the pending element: no offset follows.
    fn release(&mut self) {
        match std::mem::replace(&mut self.pending, Pending::Nothing) {
            Pending::Nothing => {}
            Pending::Positioning(element) => self.ready.push_back(Ok(*element)),
            Pending::Ended(last, at) => {
                let at = self.stand(at);
                let end = last.end();
                self.ramp(&last, at, [end.x, end.y]);
            }
        }
        self.ready.extend(self.standing.drain(..).map(Ok));
    }

    /// Executes an element without motion in X and Y at `at`; returns the position of the tool afterwards.
    fn stand(&mut self, mut at: Station) -> Station {
        for mut element in self.standing.drain(..) {
            if let Shape::Line { start, end } = &mut element.shape {
                for point in [start, end] {
                    (point.x, point.y) = (at.point.x, at.point.y);
                }
            }
            let end = Station::end(&element);
            at = Station { point: end.point, extra: end.extra.or(at.extra) };
            self.ready.push_back(Ok(element));
        }
        at
    }

    /// A positioning in X and Y from `from` to `to`.
    fn ramp(&mut self, like: &PathElement, from: Station, [x, y]: [f64; 2]) {
        let mut end = from.point;
        (end.x, end.y) = (x, y);
        let shape = Shape::Line { start: from.point, end };
        let to = Station { point: end, ..from };
        let mut ramp = piece::between(like, like, shape, [&from, &to]);
        ramp.kind = ElementKind::Rapid;
        self.ready.push_back(Ok(ramp));
    }

    /// Takes a piece of a contour.
    fn piece(&mut self, element: PathElement) {
        let place = element.place;
        let radius = element.tool_radius + self.options.radius;
        if !(radius >= 0.0 && radius.is_finite()) {
            return self.refuse(element, ToolRadiusError::Radius { place, radius });
        }
        if matches!(&element.shape, Shape::Arc(arc) if arc.plane() != Plane::Xy) {
            return self.refuse(element, ToolRadiusError::Plane(place));
        }
        let before = match &self.state {
            State::On(active) => Some(active.radius),
            State::Idle(_) => Some(0.0),
            State::Begun(_) | State::Off => None,
        };
        // The same number gives the same radius.
        if let Some(from) = before.filter(|before| before.to_bits() != radius.to_bits()) {
            let error = ToolRadiusError::RadiusChange { place, from, to: radius };
            return self.refuse(element, error);
        }
        if radius == 0.0 {
            if let State::Begun(side) = self.state {
                self.state = State::Idle(side);
                self.notices.add(Notice::NoRadius { place, stage: Stage::ToolRadius });
            }
            self.release();
            self.ready.push_back(Ok(element));
            return;
        }
        if let Some(curve) = Curve::of(&element.shape) {
            return self.push(element, &curve, radius);
        }
        for (element, curve) in simple_pieces(&element, self.options.tolerance) {
            self.push(element, &curve, radius);
        }
    }

    /// Takes a line or an arc of a contour.
    fn push(&mut self, element: PathElement, contour: &Curve, radius: f64) {
        if let State::Begun(side) = self.state {
            let distance = side.sign() * radius;
            let notices = self.notices.clone();
            let offset = Offset::new(distance, &self.options, notices, &element, contour);
            self.lead_in(&element, offset.station());
            let last = PathElement { details: None, ..element.clone() };
            self.state = State::On(Box::new(Active { side, radius, offset, last }));
        }
        if let State::On(active) = &mut self.state {
            active.last = PathElement { details: None, ..element.clone() };
            let between = std::mem::take(&mut self.between);
            active.offset.push(element, contour, between, &mut self.ready);
        }
    }

    /// Makes the path go to the beginning of an offset.
    fn lead_in(&mut self, first: &PathElement, to: Station) {
        let xy = [to.point.x, to.point.y];
        match std::mem::replace(&mut self.pending, Pending::Nothing) {
            Pending::Nothing => {
                let from = self.standing.front().unwrap_or(first);
                let from = Station::start(from);
                self.ramp(first, from, xy);
            }
            Pending::Ended(_, at) => {
                let at = self.stand(at);
                self.ramp(first, at, xy);
            }
            Pending::Positioning(mut positioning) => {
                if let Shape::Line { end, .. } = &mut positioning.shape {
                    [end.x, end.y] = xy;
                }
                self.ready.push_back(Ok(*positioning));
            }
        }
        self.stand(to);
    }

    /// The contour has ended.
    fn end(&mut self) {
        if let State::On(mut active) = std::mem::replace(&mut self.state, State::Off) {
            active.offset.finish(&mut self.ready);
            let jumped = active.offset.place(&mut self.between, None);
            self.ready.append(&mut self.between);
            if !jumped {
                self.pending = Pending::Ended(Box::new(active.last), active.offset.station());
            }
        }
    }

    fn refuse(&mut self, element: PathElement, error: ToolRadiusError) {
        self.fail(error);
        self.carry(Ok(element));
    }

    /// Ends the correction, with an error behind it.
    fn fail(&mut self, error: ToolRadiusError) {
        self.end();
        self.release();
        self.state = State::Off;
        self.ready.push_back(Err(E::from(error)));
    }
}

impl<I, E> Iterator for ToolRadius<I, E>
where
    I: Iterator<Item = Result<PathElement, E>>,
    E: From<ToolRadiusError>,
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
                self.release();
                // Without an end mark the path ends at the offset from the contour.
                self.end();
            }
        }
    }
}
