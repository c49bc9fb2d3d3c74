//! Queue of compensated moves: the last move in the plane, whose end the next corner decides, and what comes behind it.

use super::corner::{Frame, sweep};
use crate::rs274::LengthUnit;
use crate::rs274::error::{DecodeError, Problem};
use crate::rs274::options::Position;
use crate::rs274::output::Output;
use crate::rs274::state::State;
use nalgebra::{Point3, Vector2, Vector3};
use std::f64::consts::TAU;
use twin_path::{Arc, ElementKind, MParameters, Place, Shape};

/// Arcs that turn by less than this, rad, between ends that are as near as [`SAME_POINT`] are full turns.
const SAME_ANGLE: f64 = 1e-6;

/// See [`SAME_ANGLE`], m.
const SAME_POINT: f64 = 1e-6;

/// Curve of a move in the plane. Points are in the frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum Curve {
    Line {
        /// Direction as it is programmed, of any length; zero where it must not matter.
        direction: Vector2<f64>,
    },
    Arc {
        center: Vector2<f64>,
        /// Turns that are begun, positive to the left.
        turns: f64,
        /// Angle as it is programmed, rad; none of an arc around a corner, whose end stays.
        programmed: Option<f64>,
    },
}

/// A move of the tool's centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    pub(super) kind: ElementKind,
    pub(super) feed: f64,
    pub(super) curve: Curve,
    /// In the frame, m.
    pub(super) end: Vector2<f64>,
    /// Along the normal of the plane, m.
    pub(super) height: f64,
    /// The programmed end, of which the extra axes count.
    pub(super) axes: Position,
}

#[derive(Clone, Copy, Debug)]
enum Item {
    /// With the speed S of its block.
    Move(Move, Option<f64>),
    /// A dwell or an M function.
    Wait(ElementKind, MParameters),
}

/// Moves that wait for the next corner, and what comes between them.
#[derive(Debug, Default)]
pub(super) struct Queue {
    frame: Frame,
    /// See [`super::Cutter`].
    shift: [f64; 3],
    /// Where the first of them begins, in the frame; none if that is not known or does not matter.
    pub(super) start: Option<Vector2<f64>>,
    /// The first of them, or of those before if none waits.
    last: Option<(Place, Move)>,
    items: Vec<(Place, Item)>,
}

impl Queue {
    pub(super) fn new(frame: Frame, shift: [f64; 3]) -> Self {
        Self { frame, shift, ..Self::default() }
    }

    pub(super) fn len(&self) -> usize {
        self.items.len()
    }

    /// The move that the next corner cuts off, and its block. Behind M0 it is the one that has ended there, by which
    /// LinuxCNC checks the corner, though it cannot cut it off any more.
    pub(super) fn front(&self) -> Option<(Place, Move)> {
        self.last
    }

    pub(super) fn push(&mut self, place: Place, next: Move, speed: Option<f64>) {
        if self.items.is_empty() {
            self.last = Some((place, next));
        }
        self.items.push((place, Item::Move(next, speed)));
    }

    /// Checks that all moves can end at `end` instead: several if the tool goes up and down in the corner.
    fn move_ends(
        &mut self,
        end: Vector2<f64>,
        radius: f64,
        units: LengthUnit,
    ) -> Result<(), DecodeError> {
        // LinuxCNC's, in program units and, of angles, rad.
        let largest_difference = units.to_metres(0.01);
        let largest_growth = match units {
            LengthUnit::Millimetre => 0.025_4,
            LengthUnit::Inch => 0.001,
        };
        for (place, item) in &mut self.items {
            let Item::Move(one, _) = item else { continue };
            let fits = match one.curve {
                Curve::Line { direction } => {
                    self.start.is_none_or(|start| direction.dot(&(end - start)) >= 0.0)
                }
                Curve::Arc { center, turns, programmed } => {
                    let difference = (one.end - center).norm() - (end - center).norm();
                    let grows = self.start.zip(programmed).is_some_and(|(start, programmed)| {
                        let now = sweep(start, center, turns, end);
                        now.abs() > programmed.abs() + largest_growth
                    });
                    difference.abs() <= largest_difference && !grows
                }
            };
            if !fits {
                return Err(DecodeError::CompensationGouge {
                    other: *place,
                    radius_mm: radius * 1e3,
                });
            }
            one.end = end;
        }
        Ok(())
    }
}

impl State {
    /// Keeps a dwell or an M function for later if moves wait that come before it; false if none do.
    pub(in crate::rs274) fn wait_for_corner(
        &mut self,
        kind: ElementKind,
        parameters: MParameters,
        out: &Output,
    ) -> bool {
        let waits = self.compensation.queue.len() > 0;
        if waits {
            self.compensation.queue.items.push((out.place, Item::Wait(kind, parameters)));
        }
        waits
    }

    /// Lets the moves that wait end at `end`, does them, and makes `end` the start of what comes next.
    ///
    /// # Errors
    /// [`DecodeError::CompensationGouge`]. The moves still wait then.
    pub(super) fn end_waiting_at(
        &mut self,
        end: Vector2<f64>,
        out: &mut Output,
    ) -> Result<(), Problem> {
        if self.compensation.queue.len() == 0 {
            return Ok(());
        }
        let radius = self.compensation.cutter.map_or(0.0, |cutter| cutter.radius);
        self.compensation.queue.move_ends(end, radius, self.units)?;
        self.release(out);
        self.compensation.queue.start = Some(end);
        Ok(())
    }

    /// Does the moves that wait.
    pub(in crate::rs274) fn release(&mut self, out: &mut Output) {
        self.compensation.queue.start = None;
        if self.compensation.queue.len() == 0 {
            return;
        }
        let (programmed, place, speed) = (self.location, out.place, self.speed);
        let mut items = std::mem::take(&mut self.compensation.queue.items);
        let (frame, shift) = (self.compensation.queue.frame, self.compensation.queue.shift);
        for (place, item) in items.drain(..) {
            out.place = place;
            let one = match item {
                Item::Move(one, speed) => {
                    self.speed = speed;
                    one
                }
                Item::Wait(kind, parameters) => {
                    self.stand(kind, parameters, out);
                    continue;
                }
            };
            let start = Point3::from(self.tool_position().linear);
            let shape = one.shape(start, frame, Vector3::from(shift));
            let mut to = programmed;
            to.machine = Position { linear: shape.end().into(), ..one.axes };
            self.go(one.kind, shape, one.feed, to, out);
            self.compensation.tool = Some(to.machine);
        }
        // Its memory serves the next ones.
        self.compensation.queue.items = items;
        (self.location, out.place, self.speed) = (programmed, place, speed);
    }
}

impl Move {
    /// The move from `start`, m.
    fn shape(&self, start: Point3<f64>, frame: Frame, shift: Vector3<f64>) -> Shape {
        let end = frame.point(self.end, self.height) + shift;
        let Curve::Arc { center, turns, .. } = self.curve else {
            return Shape::Line { start, end };
        };
        let (from, _) = frame.flat((start - shift).into());
        let mut angle = sweep(from, center, turns, self.end);
        // Rounding must not turn a full circle into none; one point is a full circle, whatever was programmed.
        let rest = angle.abs() - (turns.abs() - 1.0) * TAU;
        if rest < SAME_ANGLE && (self.end - from).norm() <= SAME_POINT {
            angle += turns.signum() * TAU;
        }
        let center = frame.point(center, self.height) + shift;
        Shape::Arc(Arc::in_plane(frame.plane, start, end, center, frame.side * angle))
    }
}
