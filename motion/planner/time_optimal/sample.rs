//! Sampling: elements of the blended path as cells with their limits.

use super::axis_path::{AxisPath, AxisPoint};
use super::bound::{Cap, CapSource, Disc, Row};
use super::cell::{ALONG, Cell, Sample};
use super::drag::DragRow;
use super::feeds::Feeds;
use super::grid::{CellEnd, Grid};
use super::options::LimitOptions;
use super::rows::LEAST_TIME;
use crate::blended_path::{BlendedElement, Transition};
use nalgebra::Vector3;
use std::ops::Range;
use std::sync::Arc;
use twin_kinematics::{AxisVector, KinematicsError};
use twin_path::ElementKind;
use twin_path::prepare::CircularLimits;

/// Least number of cells of a span between breaks; a blend bends all the way and has more.
const LEAST: u32 = 2;
const LEAST_OF_BLEND: u32 = 3;
/// A span between two blends that is shorter than this part of them is one cell.
const LITTLE: f64 = 0.3;
/// And so is one that takes no longer than this, s, at its feed: in shorter cells rounding would drown their jerks.
const SHORTEST: f64 = 3.0 * LEAST_TIME;
/// Rates half-way through a cell may differ from the mean of those at its ends by this part of the largest.
const SMOOTH: [f64; 2] = [0.02, 0.1];
/// Between two blends there is nothing if it is shorter than this part of them.
const SLIVER: f64 = 0.05;
/// A cell is halved at most so often for that.
const DEPTH: u32 = 10;
/// Derivatives are those inside the cell: taken this part of its length from its ends.
const INSIDE: f64 = 1e-9;
/// Places within this part of the length from the end of an element are at its end.
const NEAR: f64 = 1e-8;
/// Places on an element nearer to each other than this part of its length are one.
pub(super) const SAME_PLACE: f64 = 1e-12;
/// Velocities may step by what the acceleration limit changes them in this time, s, where a joint is not rounded; so
/// may accelerations by what the jerk limit does.
const STEP_TIME: f64 = 1e-3;

/// Turns elements into cells on a machine.
#[derive(Debug)]
pub(super) struct Sampler<A> {
    axes: A,
    options: LimitOptions,
    /// Programmed velocities under the override.
    pub(super) feeds: Feeds,
}

impl<A: AxisPath> Sampler<A> {
    pub(super) fn new(axes: A, options: LimitOptions) -> Self {
        Self { axes, options, feeds: Feeds::default() }
    }

    pub(super) fn axes(&self) -> &A {
        &self.axes
    }

    /// The cells of a part of `element`, as few as its geometry asks for.
    pub(super) fn cells(
        &self,
        element: &Arc<BlendedElement>,
        part: Range<f64>,
        near: &AxisVector,
        cells: &mut Vec<Cell>,
    ) -> Result<(), KinematicsError> {
        let head = element.head().map_or(0.0, |blend| blend.half_width());
        let tail = element.length() - element.tail().map_or(0.0, |blend| blend.half_width());
        let mut near = *near;
        let mut last = part.start;
        // What is left between two blends that nearly meet is not worth a cell.
        let sliver = tail - head < SLIVER * head.min(element.length() - tail);
        let left_out = |at: f64| sliver && at > head && at >= tail && at < element.length();
        // A break that the part begins or ends at, but for rounding, is not one within it.
        let near_by = SAME_PLACE * element.length();
        let within = |at: f64| at > part.start + near_by || at >= part.end;
        for to in element.breaks().filter(|at| within(*at) && !left_out(*at)) {
            let to = if to > part.end - near_by { part.end } else { to };
            if to <= last {
                break;
            }
            let middle = last.midpoint(to);
            let least = if to - last < SHORTEST * element.feed() {
                1
            } else if middle < head || middle > tail {
                LEAST_OF_BLEND
            } else if to - last < LITTLE * head.min(element.length() - tail) {
                1
            } else {
                LEAST
            };
            let is_even = last >= head && to <= tail && self.is_even(element, last, &near);
            let least = if is_even { 1 } else { least };
            let step = (to - last) / f64::from(least);
            for index in 0..least {
                let begin = last + step * f64::from(index);
                let end = if index + 1 == least { to } else { last + step * f64::from(index + 1) };
                let cell = Cell { is_even, ..self.ends(element, begin..end, &near)? };
                near = cell.end.position;
                self.halve(cell, DEPTH, cells)?;
            }
            last = to;
        }
        Ok(())
    }

    /// True if all axes move evenly from `s` of `element` on, as far as it is neither blended nor slowed.
    fn is_even(&self, element: &BlendedElement, s: f64, near: &AxisVector) -> bool {
        let even = |point: AxisPoint| {
            let disc = self.axes.disc(element, s, &point);
            disc.is_some_and(|disc| disc.is_even)
        };
        self.axes.further_rows() == 0
            && !self.feeds.brakes_on(element)
            && self.axes.axes(element, s, near).is_ok_and(even)
    }

    /// A part of `element` as one cell.
    pub(super) fn cell(
        &self,
        element: &Arc<BlendedElement>,
        part: Range<f64>,
        near: &AxisVector,
    ) -> Result<Cell, KinematicsError> {
        let mut cell = self.ends(element, part, near)?;
        self.look_half_way(&mut cell)?;
        Ok(cell)
    }

    /// The same, with nothing known half-way.
    fn ends(
        &self,
        element: &Arc<BlendedElement>,
        Range { start: from, end: to }: Range<f64>,
        near: &AxisVector,
    ) -> Result<Cell, KinematicsError> {
        let inside = INSIDE * (to - from);
        let start = Arc::new(self.sample(element, from + inside, near)?);
        let end = Arc::new(self.sample(element, to - inside, &start.position)?);
        let middle = Arc::clone(&start);
        let element = Arc::clone(element);
        let joint = Cap::NONE;
        let tight = [1.0; 3];
        let (dense, is_even) = (false, false);
        Ok(Cell { element, from, to, start, end, middle, joint, tight, dense, is_even })
    }

    /// Adds `cell`, in halves if its ends do not tell enough of it.
    fn halve(
        &self,
        mut cell: Cell,
        depth: u32,
        cells: &mut Vec<Cell>,
    ) -> Result<(), KinematicsError> {
        self.look_half_way(&mut cell)?;
        if depth == 0 || is_smooth(&cell) {
            cells.push(cell);
            return Ok(());
        }
        for half in self.cut(&cell, &[0.5])? {
            self.halve(half, depth - 1, cells)?;
        }
        Ok(())
    }

    fn look_half_way(&self, cell: &mut Cell) -> Result<(), KinematicsError> {
        if cell.is_even {
            cell.middle = Arc::clone(&cell.start);
            return Ok(());
        }
        let at = cell.from.midpoint(cell.to);
        cell.middle = Arc::new(self.sample(&cell.element, at, &cell.start.position)?);
        Ok(())
    }

    /// `cell` cut at these parts of its length.
    pub(super) fn parts(&self, cell: &Cell, at: &[f64]) -> Result<Vec<Cell>, KinematicsError> {
        let mut parts = self.cut(cell, at)?;
        if parts.len() > 1 {
            for part in &mut parts {
                self.look_half_way(part)?;
            }
        }
        Ok(parts)
    }

    /// As [`Self::parts`], with nothing known half-way.
    fn cut(&self, cell: &Cell, at: &[f64]) -> Result<Vec<Cell>, KinematicsError> {
        let mut parts = Vec::with_capacity(at.len() + 1);
        let length = cell.length();
        let mut rest = cell.clone();
        for part in at {
            let cut = cell.from + part * length;
            if cut <= rest.from || cut >= rest.to {
                continue;
            }
            let sample = if cell.is_even {
                cell.between(*part)
            } else {
                self.sample(&cell.element, cut, &rest.start.position)?
            };
            let sample = Arc::new(sample);
            let first =
                Cell { to: cut, end: Arc::clone(&sample), joint: Cap::NONE, ..rest.clone() };
            rest = Cell { from: cut, start: sample, ..rest };
            parts.push(first);
        }
        parts.push(rest);
        Ok(parts)
    }

    /// Sample at `s` of `element`.
    pub(super) fn sample(
        &self,
        element: &BlendedElement,
        s: f64,
        near: &AxisVector,
    ) -> Result<Sample, KinematicsError> {
        let AxisPoint { position, rates } = self.axes.axes(element, s, near)?;
        let point = element.at(s);
        let LimitOptions { feed, path_acceleration, tool_acceleration, .. } = self.options;
        let speed = point.first.norm();
        // Where only extra axes move the parameter itself is the way.
        let (scale, bend) =
            if speed > 0.0 { (speed, point.first.dot(&point.second) / speed) } else { (1.0, 0.0) };
        // The program says nothing of how fast the tool turns at rest.
        let [feed, path_acceleration] =
            [feed, path_acceleration].map(|limited| limited && !element.is_turn());
        let cap = if feed {
            let v2 = self.feeds.bound(element, s, (element.feed() / scale).powi(2));
            Cap { v2, source: CapSource::Feed }
        } else {
            Cap::NONE
        };
        let cap = cap.min(self.on_curve(element, s));
        let transition = self.transition(element, s);
        let mut along = [Row::default(); ALONG];
        if path_acceleration {
            let limits = [element.acceleration(), -element.deceleration()];
            for (row, limit) in along.iter_mut().zip(limits) {
                *row = Row { a: scale / limit, b: bend / limit };
            }
        }
        let mut further = vec![DragRow::default(); self.axes.further_rows()];
        let mut reference = f64::INFINITY;
        if !further.is_empty() {
            // The largest velocity that is possible here.
            let limits = self.axes.limits().iter().zip(rates.first.iter());
            let axes = limits.map(|(limits, first)| limits.velocity / first.abs());
            reference = axes.fold(cap.v2.sqrt(), f64::min);
        }
        let cap = cap.min(self.axes.further(&AxisPoint { position, rates }, &mut further));
        let disc = tool_acceleration.map(|limit| {
            let part = |v: &Vector3<f64>| (v / limit).into();
            Disc { a: part(&point.first), b: part(&point.second) }
        });
        Ok(Sample { position, rates, cap, transition, along, further, reference, disc })
    }

    /// The bound of the acceleration towards the centre of a curve: that of the programmed path, also where it is rounded.
    fn on_curve(&self, element: &BlendedElement, s: f64) -> Cap {
        let CircularLimits { acceleration, .. } = self.options.centripetal;
        if acceleration > 0.0 && element.element().kind == ElementKind::Cut {
            Cap { v2: acceleration / element.curvature(s), source: CapSource::Centripetal }
        } else {
            Cap::NONE
        }
    }

    /// Bound at a joint of two elements, if it is at `s`.
    fn transition(&self, element: &BlendedElement, s: f64) -> Cap {
        let [head, tail] = element.transitions();
        let near = NEAR * element.length();
        let Transition { curvature_jump, velocity } = if s <= near {
            head
        } else if s >= element.length() - near {
            tail
        } else {
            return Cap::NONE;
        };
        let limit = self.options.centripetal.acceleration_jump;
        let mut cap = Cap::NONE;
        if limit > 0.0 {
            cap = cap.min(Cap { v2: limit / curvature_jump, source: CapSource::Centripetal });
        }
        if self.options.feed {
            let v2 = self.feeds.bound(element, s, velocity * velocity);
            cap = cap.min(Cap { v2, source: CapSource::EndVelocity });
        }
        cap
    }

    /// The bound at a joint between `before` and `after`, for what of a step is left there.
    pub(super) fn joint(&self, before: &Sample, after: &Sample) -> Cap {
        let (from, to) = (&before.rates, &after.rates);
        let values =
            from.first.iter().zip(to.first.iter()).zip(from.second.iter().zip(to.second.iter()));
        let mut v2 = f64::INFINITY;
        for (((f1, t1), (f2, t2)), limits) in values.zip(self.axes.limits()) {
            let turn = (t1 - f1).abs();
            // What is left where derivatives are taken a little inside.
            if turn > 1e-6 * f1.abs().max(t1.abs()) {
                v2 = v2.min((limits.smallest_acceleration() * STEP_TIME / turn).powi(2));
            }
            let bend = (t2 - f2).abs();
            if let Some(jerk) = limits.jerk
                && bend > 1e-6 * f2.abs().max(t2.abs())
            {
                v2 = v2.min(jerk * STEP_TIME / bend);
            }
        }
        Cap { v2, source: CapSource::Joint }.min(before.transition).min(after.transition)
    }
}

/// True if the rates in the middle are near the mean of those at the ends.
fn is_smooth(cell: &Cell) -> bool {
    let middle = &cell.middle.rates;
    let near = |from: &AxisVector, middle: &AxisVector, to: &AxisVector, part: f64, least: f64| {
        let values = from.iter().zip(middle.iter()).zip(to.iter());
        let size = values.clone().map(|((f, m), t)| f.abs().max(m.abs()).max(t.abs()));
        let size = size.fold(least, f64::max);
        values.into_iter().all(|((f, m), t)| (m - f.midpoint(*t)).abs() <= part * size)
    };
    let (start, end) = (&cell.start.rates, &cell.end.rates);
    let largest =
        start.first.iter().chain(end.first.iter()).fold(0.0, |most: f64, v| most.max(v.abs()));
    // A second derivative that turns the first by little over the cell does not matter.
    near(&start.first, &middle.first, &end.first, SMOOTH[0], 0.0)
        && near(
            &start.second,
            &middle.second,
            &end.second,
            SMOOTH[1],
            SMOOTH[0] * largest / cell.length(),
        )
}

/// The grid of `cells`.
pub(super) fn grid<A: AxisPath>(sampler: &Sampler<A>, cells: &[Cell]) -> Grid {
    let extra = ALONG + sampler.axes.further_rows();
    let mut grid = Grid::new(sampler.axes.limits().to_vec(), extra, 0.0);
    let (mut of_start, mut of_end) = (Vec::new(), Vec::new());
    for cell in cells {
        cell.start.put_rows(&mut of_start);
        cell.end.put_rows(&mut of_end);
        let end = |sample: &Sample, rows| CellEnd {
            rates: sample.rates,
            cap: sample.cap,
            rows,
            disc: sample.disc,
        };
        let (start, end) = (end(&cell.start, of_start.as_slice()), end(&cell.end, &of_end));
        grid.push(cell.length(), &start, &end);
        grid.bend_last(&cell.middle.rates);
        let [.., velocity] = cell.tight;
        grid.cap_last(Cap { v2: cell.joint.v2 / (velocity * velocity), ..cell.joint });
        grid.tighten_last(cell.tight);
        if cell.dense {
            grid.make_last_dense();
        }
    }
    grid
}
