//! Splines: G5 (cubic), G5.1 (quadratic), and G5.2 to G5.3 (NURBS), all in X and Y.
//!
//! ```text
//! G5 X Y I J P Q     control points: start, start + (I, J), end + (P, Q), end;
//!                    without I and J the direction is that of the G5 before: (I, J) = −(P, Q) of it
//! G5.1 X Y I J       control points: start, start + (I, J), end
//! G5.2 P L           begins with the start and its weight P; L is the order, from 4 on: degree + 1, else 3
//! X Y P              the next control point and its weight
//! G5.3               ends with the last one; knots at 0, 1, 2, …, the first and last of them repeated
//! ```
//!
//! The path is made of cubics ([`Shape::Cubic`]). They are the curve itself if its weights are the same and its order is
//! at most 4, and within [`TOLERANCE`] of it with its directions otherwise.

use super::block::{Block, Letter, Letters};
use super::error::{DecodeError, Problem};
use super::offsets::Location;
use super::output::Output;
use super::state::State;
use super::travel::Axis;
use super::word::{Motion, Spline};
use nalgebra::Point3;
use twin_path::{BSpline, Cubic, ElementKind, Plane, Shape};

/// Distance of the path from rational curves and those of a higher order, m.
pub const TOLERANCE: f64 = 1e-9;

/// The largest number of control points of one curve.
pub const MAX_CONTROL_POINTS: usize = 1000;

/// Weights are at most this, and at least 1 by it.
const MAX_WEIGHT: f64 = 1e6;

/// The order if L does not say another.
const ORDER: usize = 3;

/// The largest order.
const MAX_ORDER: f64 = 26.0;

/// A curve between G5.2 and G5.3.
#[derive(Clone, Debug)]
pub(super) struct Nurbs {
    order: usize,
    /// Control points in the machine frame (m), and their weights.
    points: Vec<(Point3<f64>, f64)>,
}

impl Spline {
    /// The words that it takes next to those of every block.
    pub(super) fn words(self) -> Letters {
        const PLANE: Letters = Letters::of("XY");
        const START: Letters = Letters::of("IJ");
        match self {
            Self::Cubic => PLANE.with(START).with(Letters::POLAR).with(Letters::of("PQ")),
            Self::Quadratic => PLANE.with(START).with(Letters::POLAR),
            Self::Nurbs => PLANE.with(Letters::of("PL")),
        }
    }
}

impl State {
    /// G5, G5.1 and the blocks of G5.2.
    pub(super) fn follow_spline(
        &mut self,
        spline: Spline,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        if spline == Spline::Nurbs {
            return self.add_control_point(block);
        }
        self.check_exit(false)?;
        let to = self.target(block, self.relative)?;
        match self.control_points(spline, block, &to) {
            Ok(points) => {
                let points: Vec<_> = points.into_iter().map(|point| (point, 1.0)).collect();
                let spline = BSpline::clamped(points.len() - 1, &points);
                self.cut_cubics(spline, to, block.get(Letter::F), out)
            }
            Err(problem) => {
                // The blocks after it continue where it was to end.
                self.location = to;
                Err(problem)
            }
        }
    }

    /// Control points of G5 and G5.1.
    fn control_points(
        &mut self,
        spline: Spline,
        block: &Block,
        to: &Location,
    ) -> Result<Vec<Point3<f64>>, Problem> {
        if self.plane != Plane::Xy || self.parallel_plane {
            return Err(DecodeError::SplineOutsideXy.into());
        }
        let from = self.location;
        let start = match pair(spline, block, [Letter::I, Letter::J])? {
            Some(offset) => offset,
            None if spline == Spline::Cubic => self.spline_start,
            None => return Err(incomplete(spline, [Letter::I, Letter::J])),
        };
        let mut points = vec![Point3::from(from.machine.linear), self.offset_from(&from, start)?];
        if spline == Spline::Cubic {
            let letters = [Letter::P, Letter::Q];
            let [p, q] = pair(spline, block, letters)?.ok_or(incomplete(spline, letters))?;
            points.push(self.offset_from(to, [p, q])?);
            self.spline_start = [-p, -q];
        }
        points.push(Point3::from(to.machine.linear));
        Ok(points)
    }

    /// The point that is away from `at` by `offset` in X and Y, in units of the program.
    fn offset_from(&self, at: &Location, [x, y]: [f64; 2]) -> Result<Point3<f64>, Problem> {
        let [at_x, at_y, ..] = at.program;
        let along = self.with(at, Axis::X, at_x + x)?;
        Ok(Point3::from(self.with(&along, Axis::Y, at_y + y)?.machine.linear))
    }

    /// A block of G5.2.
    fn add_control_point(&mut self, block: &Block) -> Result<(), Problem> {
        let start = Point3::from(self.location.machine.linear);
        let corner = pair(Spline::Nurbs, block, [Letter::X, Letter::Y])?;
        let weight = block.get(Letter::P);
        if let Some(value) = weight {
            block.within(Letter::P, value, [1.0 / MAX_WEIGHT, MAX_WEIGHT], "")?;
        }
        if self.nurbs.is_some() && corner.is_none() && weight.is_some() {
            return Err(block.at(Letter::P, DecodeError::WeightOfStart));
        }
        if weight.is_none() && (self.nurbs.is_some() || corner.is_some()) {
            return Err(DecodeError::missing("each control point of G5.2", "its weight P").into());
        }
        Self::in_range(block, Letter::L, MAX_ORDER)?;
        let order = block.whole(Letter::L, 0)?.unwrap_or(0);
        let next = match corner {
            Some(_) => Some(Point3::from(self.target(block, self.relative)?.machine.linear)),
            None => None,
        };
        let first = corner.map_or(weight, |_| None).unwrap_or(1.0);
        let begun = Nurbs { order: ORDER, points: vec![(start, first)] };
        let nurbs = self.nurbs.get_or_insert(begun);
        nurbs.order = usize::try_from(order).ok().filter(|it| *it > ORDER).unwrap_or(nurbs.order);
        if nurbs.points.len() >= MAX_CONTROL_POINTS {
            return Err(DecodeError::ManyControlPoints(MAX_CONTROL_POINTS).into());
        }
        nurbs.points.extend(next.zip(weight));
        Ok(())
    }

    /// G5.3.
    pub(super) fn end_nurbs(&mut self, block: &Block, out: &mut Output) -> Result<(), Problem> {
        self.motion = Motion::Off;
        self.check_exit(false)?;
        let Nurbs { order, points } = self.nurbs.take().ok_or(DecodeError::NurbsNotBegun)?;
        let count = points.len();
        let few = DecodeError::FewControlPoints { order, count };
        let (last, _) = points.last().filter(|_| count >= order).ok_or(few)?;
        let start = Point3::from(self.location.machine.linear);
        if points.first().is_none_or(|(first, _)| *first != start) {
            return Err(DecodeError::NurbsLeft.into());
        }
        let (to, f) = (self.location_at(last), block.get(Letter::F));
        let spline = BSpline::clamped(order - 1, &points);
        self.cut_cubics(spline, to, f, out)
    }

    /// Goes along `spline` to `to`, its end.
    fn cut_cubics(
        &mut self,
        spline: Option<BSpline>,
        to: Location,
        f: Option<f64>,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let [start, end] = [&self.location, &to].map(|at| Point3::from(at.machine.linear));
        let cubics = spline.map_or(Vec::new(), |spline| spline.cubics(start, end, TOLERANCE));
        // F of inverse time is that of the whole curve: the feed is that of a line as long.
        let length = cubics.iter().map(Cubic::length).sum();
        let line = Shape::Line { start: Point3::origin(), end: Point3::new(length, 0.0, 0.0) };
        let Some(feed) = self.feed_for(&line, &to, f)? else { return Ok(()) };
        let count = cubics.len();
        for (number, cubic) in (1..).zip(cubics) {
            let end = if number == count { to } else { self.location_at(&cubic.end()) };
            self.go(ElementKind::Cut, Shape::Cubic(Box::new(cubic)), feed, end, out);
        }
        Ok(())
    }

    /// The location whose X and Y in the machine frame are those of `point`.
    fn location_at(&self, point: &Point3<f64>) -> Location {
        let mut machine = self.location.machine;
        [machine.linear[0], machine.linear[1]] = [point.x, point.y];
        let mut to = Location::new(machine, &self.offsets, self.units);
        // What does not change stays, bit for bit.
        to.program[2..].copy_from_slice(&self.location.program[2..]);
        to
    }
}

/// The numbers of two words that belong together; none if both are missing.
fn pair(spline: Spline, block: &Block, letters: [Letter; 2]) -> Result<Option<[f64; 2]>, Problem> {
    match letters.map(|letter| block.get(letter)) {
        [Some(first), Some(second)] => Ok(Some([first, second])),
        [None, None] => Ok(None),
        _ => Err(incomplete(spline, letters)),
    }
}

fn incomplete(spline: Spline, letters: [Letter; 2]) -> Problem {
    let [first, second] = letters.map(Letter::as_char);
    DecodeError::IncompleteSpline { number: spline.number(), first, second }.into()
}
