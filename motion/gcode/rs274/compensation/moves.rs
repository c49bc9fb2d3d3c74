//! Compensated moves: entry, contour and corners.

use super::Cutter;
use super::corner::{
    Circle, Corner, Frame, arc_to_arc, arc_to_line, left, line_to_arc, line_to_line, right, sweep,
};
use super::queue::{Curve, Move};
use crate::rs274::block::{Block, Letter};
use crate::rs274::error::{DecodeError, Problem};
use crate::rs274::offsets::Location;
use crate::rs274::options::Position;
use crate::rs274::output::Output;
use crate::rs274::state::State;
use crate::rs274::word::Motion;
use nalgebra::{Point3, Vector2};
use twin_path::{ElementKind, Shape};

/// Points that are nearer to each other, m, are the same.
const SAME_POINT: f64 = 1e-12;

/// Cosine of the angle at the start of an entry arc below which it has no centre.
const NO_CENTER: f64 = 1e-6;

/// A move as it is programmed, in the frame.
#[derive(Clone, Copy, Debug)]
struct Programmed {
    kind: ElementKind,
    feed: f64,
    start: Vector2<f64>,
    /// Of the start, along the normal, m.
    start_height: f64,
    end: Vector2<f64>,
    height: f64,
    /// As programmed.
    axes: Position,
}

/// An arc as it is programmed, in the frame.
#[derive(Clone, Copy, Debug)]
struct Round {
    center: Vector2<f64>,
    /// Turns that are begun, positive to the left.
    turns: f64,
}

impl Programmed {
    fn with(&self, curve: Curve, end: Vector2<f64>) -> Move {
        let Self { kind, feed, height, axes, .. } = *self;
        Move { kind, feed, curve, end, height, axes }
    }
}

impl State {
    /// G0 and G1 next to the contour.
    pub(in crate::rs274) fn compensate_line(
        &mut self,
        motion: Motion,
        block: &Block,
        to: Location,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let Some(cutter) = self.compensation.cutter else { return Ok(()) };
        let shape = self.programmed_line(&to);
        let (kind, feed) = if motion == Motion::Rapid {
            (ElementKind::Rapid, self.rapid_velocity)
        } else {
            let Some(feed) = self.compensated_feed(&shape, &to, block, out)? else {
                return Ok(());
            };
            (ElementKind::Cut, feed)
        };
        let line = self.begin(cutter.frame, kind, feed, to);
        match cutter.center {
            None => self.enter_line(cutter, &line, out),
            Some(center) => self.follow(cutter, center, &line, None, out),
        }
    }

    /// The line from the programmed end of the last move to `to`.
    pub(in crate::rs274) fn programmed_line(&self, to: &Location) -> Shape {
        Shape::Line {
            start: Point3::from(self.location.machine.linear),
            end: Point3::from(to.machine.linear),
        }
    }

    /// G2 and G3 next to the contour.
    pub(in crate::rs274) fn compensate_arc(
        &mut self,
        shape: &Shape,
        block: &Block,
        to: Location,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let (Some(cutter), Shape::Arc(arc)) = (self.compensation.cutter, shape) else {
            return Ok(());
        };
        let Some(feed) = self.compensated_feed(shape, &to, block, out)? else { return Ok(()) };
        let side = cutter.frame.side * arc.sweep().signum();
        let turns = block.whole(Letter::P, 1)?.unwrap_or(1);
        let (center, _) = cutter.frame.flat(arc.center().into());
        let round = Round { center, turns: side * f64::from(turns) };
        let line = self.begin(cutter.frame, ElementKind::Cut, feed, to);
        match cutter.center {
            None => self.enter_arc(cutter, &line, round, out),
            Some(center) => self.follow(cutter, center, &line, Some(round), out),
        }
    }

    /// A move that cannot be compensated: the next one is an entry move again.
    pub(in crate::rs274) fn interrupt_compensation(&mut self, out: &mut Output) {
        self.release(out);
        self.compensation.tool = None;
        if let Some(cutter) = &mut self.compensation.cutter {
            cutter.center = None;
        }
    }

    /// The feed along the programmed `shape`, as LinuxCNC calculates it in inverse time too.
    fn compensated_feed(
        &mut self,
        shape: &Shape,
        to: &Location,
        block: &Block,
        out: &mut Output,
    ) -> Result<Option<f64>, Problem> {
        let feed = self.feed_for(shape, to, block.get(Letter::F));
        if !matches!(feed, Ok(Some(_))) {
            self.interrupt_compensation(out);
        }
        feed
    }

    /// Goes to `to` as far as the program is concerned; the move from here, in the frame.
    fn begin(&mut self, frame: Frame, kind: ElementKind, feed: f64, to: Location) -> Programmed {
        let from = std::mem::replace(&mut self.location, to).machine;
        self.compensation.tool.get_or_insert(from);
        let (start, start_height) = frame.flat(from.linear);
        let (end, height) = frame.flat(to.machine.linear);
        Programmed { kind, feed, start, start_height, end, height, axes: to.machine }
    }

    /// Appends a move to the queue; the tool's centre is at its end.
    fn append(&mut self, next: Move, out: &Output) {
        self.compensation.queue.push(out.place, next, self.speed);
        if let Some(cutter) = &mut self.compensation.cutter {
            cutter.center = Some(next.end);
        }
    }

    fn enter_line(
        &mut self,
        cutter: Cutter,
        line: &Programmed,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let along = line.end - line.start;
        self.check_entry(cutter, along.norm(), out)?;
        let aside = left(along.normalize());
        self.compensation.queue.start = Some(line.start);
        // LinuxCNC's direction of the entry move, which is compared with that from its start to the first corner.
        let curve = Curve::Line { direction: aside };
        self.append(line.with(curve, line.end + aside * cutter.radius), out);
        Ok(())
    }

    fn check_entry(
        &mut self,
        cutter: Cutter,
        length: f64,
        out: &mut Output,
    ) -> Result<(), DecodeError> {
        if length > cutter.radius + SAME_POINT {
            return Ok(());
        }
        self.interrupt_compensation(out);
        Err(DecodeError::CompensationEntry {
            length_mm: length * 1e3,
            radius_mm: cutter.radius * 1e3,
        })
    }

    /// The arc from the start to the point next to its end, tangent there to the programmed one.
    fn enter_arc(
        &mut self,
        cutter: Cutter,
        line: &Programmed,
        arc: Round,
        out: &mut Output,
    ) -> Result<(), Problem> {
        self.check_entry(cutter, (line.end - line.start).norm(), out)?;
        let inward = arc.center - line.end;
        self.check_radius(cutter, arc, (arc.center - line.start).norm(), out)?;
        let end = line.end + inward.normalize() * (arc.turns.signum() * cutter.radius);
        let (chord, to_center) = (line.start - end, (arc.center - end).normalize());
        let cosine = to_center.dot(&chord.normalize());
        if cosine.is_nan() || cosine.abs() < NO_CENTER {
            return Err(self.too_tight(cutter, inward.norm(), out).into());
        }
        let center = end + to_center * (chord.norm() / (2.0 * cosine));
        if cutter.shift.iter().any(|shift| *shift != 0.0) {
            // A lathe tool first moves its centre to where the arc begins.
            let aside = line.with(Curve::Line { direction: Vector2::zeros() }, line.start);
            self.append(Move { height: line.start_height, ..aside }, out);
            self.compensation.queue.start = Some(line.start);
        }
        let programmed = Some(sweep(line.start, center, arc.turns, end));
        self.append(line.with(Curve::Arc { center, turns: arc.turns, programmed }, end), out);
        Ok(())
    }

    /// Checks that the tool is smaller than an arc in which it is.
    fn check_radius(
        &mut self,
        cutter: Cutter,
        arc: Round,
        radius: f64,
        out: &mut Output,
    ) -> Result<(), DecodeError> {
        if arc.turns > 0.0 && radius <= cutter.radius + SAME_POINT {
            return Err(self.too_tight(cutter, radius, out));
        }
        Ok(())
    }

    fn too_tight(&mut self, cutter: Cutter, radius: f64, out: &mut Output) -> DecodeError {
        self.interrupt_compensation(out);
        DecodeError::CompensationRadius { arc_mm: radius * 1e3, radius_mm: cutter.radius * 1e3 }
    }

    /// Goes on next to the contour from `center`: straight, or along `arc`.
    fn follow(
        &mut self,
        cutter: Cutter,
        center: Vector2<f64>,
        line: &Programmed,
        arc: Option<Round>,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let way = line.end - line.start;
        // The direction in which the move begins, its curve and circle, and where the tool's centre is at its end.
        let (along, curve, circle, end) = match arc {
            Some(arc) => {
                let (side, inward) = (arc.turns.signum(), arc.center - line.end);
                let radius = inward.norm();
                self.check_radius(cutter, arc, radius, out)?;
                let along = right((arc.center - line.start).normalize() * side);
                let offset = side * cutter.radius;
                let circle = Circle { center: arc.center, radius: radius - offset, side };
                let programmed = Some(sweep(line.start, arc.center, arc.turns, line.end));
                let curve = Curve::Arc { center: arc.center, turns: arc.turns, programmed };
                (along, curve, Some(circle), line.end + inward / radius * offset)
            }
            None if way.norm() <= SAME_POINT => {
                let curve = Curve::Line { direction: Vector2::zeros() };
                self.append(line.with(curve, center), out);
                return Ok(());
            }
            None => {
                let along = way.normalize();
                let end = line.end + left(along) * cutter.radius;
                (along, Curve::Line { direction: way }, None, end)
            }
        };
        let before = right((center - line.start).normalize());
        let last = self.compensation.queue.front().and_then(|(_, last)| last.circle());
        let waits = self.compensation.queue.len() > 0;
        let around = circle.or(last.filter(|_| waits)).is_some_and(|arc| arc.side < 0.0);
        let corner = Corner::between(before, along, around);
        let result = match corner {
            Corner::Inner(turn) => {
                let meeting = match (last, circle) {
                    (Some(last), Some(circle)) => arc_to_arc(last, circle),
                    (Some(last), None) => arc_to_line(last, line.start, along, cutter.radius),
                    (None, Some(circle)) => line_to_arc(before, along, circle, cutter.radius),
                    (None, None) => Some(line_to_line(center, before, turn, cutter.radius)),
                };
                self.cut_off(cutter, meeting, out)
            }
            Corner::Outer => {
                // LinuxCNC does not check the move before an arc.
                let checked = arc.map_or_else(|| self.end_waiting_at(center, out), |_| Ok(()));
                self.go_around(line, center, line.start + left(along) * cutter.radius, out);
                checked
            }
            Corner::Tangent => {
                self.start_at(center, out);
                Ok(())
            }
        };
        if result.is_err() && corner != Corner::Outer {
            self.start_at(center, out);
        }
        self.append(line.with(curve, end), out);
        result
    }

    /// Does the moves that wait; the next one begins at `center`.
    fn start_at(&mut self, center: Vector2<f64>, out: &mut Output) {
        self.release(out);
        self.compensation.queue.start = Some(center);
    }

    /// Ends the moves that wait where they meet the next one, at an inner corner.
    fn cut_off(
        &mut self,
        cutter: Cutter,
        meeting: Option<Vector2<f64>>,
        out: &mut Output,
    ) -> Result<(), Problem> {
        if let Some(meeting) = meeting {
            return self.end_waiting_at(meeting, out);
        }
        let front = self.compensation.queue.front();
        front.map_or(Ok(()), |(other, _)| {
            let radius_mm = cutter.radius * 1e3;
            Err(DecodeError::CompensationGouge { other, radius_mm }.into())
        })
    }

    /// Goes around an outer corner to `target`, in the height of the start: by an arc, of a rapid straight.
    fn go_around(
        &mut self,
        line: &Programmed,
        center: Vector2<f64>,
        target: Vector2<f64>,
        out: &mut Output,
    ) {
        let curve = if line.kind == ElementKind::Rapid {
            Curve::Line { direction: Vector2::zeros() }
        } else {
            Curve::Arc { center: line.start, turns: -1.0, programmed: None }
        };
        self.start_at(center, out);
        let around = Move { height: line.start_height, ..line.with(curve, target) };
        self.append(around, out);
        self.start_at(target, out);
    }
}

impl Move {
    /// The circle on which it is, if it is an arc.
    fn circle(&self) -> Option<Circle> {
        let Curve::Arc { center, turns, .. } = self.curve else { return None };
        Some(Circle { center, radius: (center - self.end).norm(), side: turns.signum() })
    }
}
