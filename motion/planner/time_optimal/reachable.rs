//! Reachability analysis: the fastest profile with limited acceleration in two passes over the cells.
//!
//! The acceleration is constant in a cell, so that b is linear in it, and limits hold at both of its ends. The backward
//! pass gives every node the largest b from which the rest of the path is still feasible; the forward pass takes the
//! largest b within that (Pham and Pham, "A new approach to time-optimal path parameterization based on reachability
//! analysis", IEEE T-RO 34(3), 2018). Rest is always allowed (b = 0, a = 0), so the sets are intervals from 0.
//!
//! A step is a linear program in the b at both ends of a cell. Mostly its optimum is at the largest possible b at the
//! far end, which one test of every row proves (`Reach`); `Plane` solves the rest.

use super::bound::Row;
use super::grid::Grid;
use super::plane::{NOTHING, Plane};
use std::ops::Range;

/// Largest b at the nodes of `cells` such that the limits hold in every cell, from `start` (at most) to `end` (at most).
///
/// The result has one value per node of `cells`. It starts lower than `start` where the path ahead asks for it.
pub fn fastest(grid: &Grid, cells: Range<usize>, start: f64, end: f64) -> Vec<f64> {
    let mut b = controllable(grid, cells.clone(), end);
    if let Some(first) = b.first_mut() {
        *first = first.min(start);
    }
    pass(grid, cells, Pass::Forwards, &mut b);
    b
}

/// The largest b at every node of `cells` from which the end can be met with at most `end`.
pub(super) fn controllable(grid: &Grid, cells: Range<usize>, end: f64) -> Vec<f64> {
    let mut b: Vec<f64> = match grid.caps().get(cells.start..=cells.end) {
        Some(caps) => caps.iter().map(|cap| cap.v2).collect(),
        None => vec![0.0; cells.len() + 1],
    };
    if let Some(last) = b.last_mut() {
        *last = last.min(end);
    }
    pass(grid, cells, Pass::Backwards, &mut b);
    b
}

/// The smallest b at every node of `cells` that braking can bring about from `start`, and where the path then rests: that node's
/// cell and the part of its length. From there on b is 0.
pub(super) fn slowest(
    grid: &Grid,
    cells: Range<usize>,
    start: f64,
) -> (Vec<f64>, Option<(usize, f64)>) {
    let mut most = controllable(grid, cells.clone(), f64::INFINITY).into_iter().skip(1);
    let mut result = vec![start];
    let mut rest = None;
    let mut plane = Plane::default();
    let mut here = start;
    for cell in cells {
        let most = most.next().unwrap_or_default();
        if rest.is_none() {
            plane.set(grid, cell);
            let next = plane.least_after(here);
            if next <= 0.0 {
                rest = Some((cell, here / (here - next)));
            }
            here = next.clamp(0.0, most);
        }
        result.push(here);
    }
    (result, rest)
}

/// Time for cells between nodes with these b, s.
pub fn duration(grid: &Grid, cells: Range<usize>, b: &[f64]) -> f64 {
    let pairs = b.windows(2).zip(cells);
    pairs
        .map(|(pair, cell)| match pair {
            [from, to] => 2.0 * grid.length(cell) / (from.sqrt() + to.sqrt()),
            _ => 0.0,
        })
        .sum()
}

/// One way through the cells, lowering b at one node after the other to what the limits of a cell make of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    /// To what goes with some b at the end, up to that which is there.
    Backwards,
    /// To what goes with b at the start as it is: it has to hold what can be met later.
    Forwards,
}

/// A pass with the number of axes known to the compiler, which makes it three times as fast.
fn pass(grid: &Grid, cells: Range<usize>, pass: Pass, b: &mut [f64]) {
    let through = match grid.limits().len() {
        1 => through::<1>,
        2 => through::<2>,
        3 => through::<3>,
        4 => through::<4>,
        5 => through::<5>,
        6 => through::<6>,
        7 => through::<7>,
        8 => through::<8>,
        _ => through::<0>,
    };
    through(grid, cells, pass, b);
}

fn through<const AXES: usize>(grid: &Grid, cells: Range<usize>, pass: Pass, b: &mut [f64]) {
    let mut step = Step { grid, plane: Plane::default() };
    match pass {
        Pass::Backwards => {
            let mut iter = b.iter_mut().rev();
            let Some(mut next) = iter.next().copied() else { return };
            for (cell, slot) in cells.rev().zip(iter) {
                next = step.before::<AXES>(cell, *slot, next);
                *slot = next;
            }
        }
        Pass::Forwards => {
            let mut iter = b.iter_mut();
            let Some(mut here) = iter.next().copied() else { return };
            for (cell, slot) in cells.zip(iter) {
                here = step.after::<AXES>(cell, here, *slot);
                *slot = here;
            }
        }
    }
}

/// Takes one cell after the other. `AXES` is the number of axes of the grid, or 0.
#[derive(Debug)]
struct Step<'g> {
    grid: &'g Grid,
    plane: Plane,
}

impl Step<'_> {
    /// The largest b within `cap` at the start of the cell that goes with some b from 0 to `next` at its end.
    #[inline]
    fn before<const AXES: usize>(&mut self, cell: usize, cap: f64, next: f64) -> f64 {
        let reach = Reach::of::<AXES, false>(self.grid, cell, next);
        reach.and_then(|reach| reach.largest(cap)).unwrap_or_else(|| {
            self.plane.set(self.grid, cell);
            self.plane.largest_before(cap, next)
        })
    }

    /// The largest b within `cap` at the end of the cell that goes with this one at its start.
    #[inline]
    fn after<const AXES: usize>(&mut self, cell: usize, here: f64, cap: f64) -> f64 {
        if let Some(reach) = Reach::of::<AXES, true>(self.grid, cell, here) {
            // By rounding the two bounds may cross.
            return reach.high.max(reach.low).min(cap);
        }
        self.plane.set(self.grid, cell);
        self.plane.largest_after(here, cap)
    }
}

/// Bound of the rows of a cell on the b at one of its ends, for a given b at the other.
#[derive(Clone, Copy, Debug)]
struct Reach {
    low: f64,
    high: f64,
    /// The part of `high` that would be larger if less were given.
    falling: f64,
    /// The given one, as part of what rows allow that say nothing else.
    given: f64,
}

impl Reach {
    /// With `ONWARDS` the start of the cell is given, else its end. `None` where limits exist that are not rows.
    #[inline]
    fn of<const AXES: usize, const ONWARDS: bool>(
        grid: &Grid,
        cell: usize,
        given: f64,
    ) -> Option<Self> {
        let ends = grid.cell_rows(cell)?;
        let slope = 0.5 / grid.length(cell);
        let mut reach = Self { low: 0.0, high: f64::INFINITY, falling: f64::INFINITY, given: 0.0 };
        for (end, (axes, further)) in ends.into_iter().enumerate() {
            // (Own, other) coefficient.
            let turned = |row: &Row| {
                let with = row.a * slope;
                let [p, r] = if end == 0 { [row.b - with, with] } else { [-with, row.b + with] };
                if ONWARDS { [r, p] } else { [p, r] }
            };
            if AXES > 0 {
                // A known number of rows, all of them at once.
                for row in axes.first_chunk::<AXES>()? {
                    reach.strip(turned(row), given);
                }
            } else {
                for row in axes {
                    reach.strip(turned(row), given);
                }
            }
            for row in further {
                reach.half(turned(row), given);
            }
        }
        reach.given *= given;
        Some(reach)
    }

    /// |own·x + other·`given`| ≤ 1.
    #[inline]
    fn strip(&mut self, [own, other]: [f64; 2], given: f64) {
        let says = own.abs() > NOTHING * other.abs();
        let inverse = 1.0 / own;
        let ratio = if says { other * inverse } else { 0.0 };
        let half = if says { inverse.abs() } else { f64::INFINITY };
        let alone = if says { 0.0 } else { other.abs() };
        let middle = -ratio * given;
        let (top, bottom) = (middle + half, middle - half);
        let falling = if ratio > 0.0 { top } else { f64::INFINITY };
        self.high = if top < self.high { top } else { self.high };
        self.low = if bottom > self.low { bottom } else { self.low };
        self.falling = if falling < self.falling { falling } else { self.falling };
        self.given = if alone > self.given { alone } else { self.given };
    }

    /// own·x + other·`given` ≤ 1.
    #[inline]
    fn half(&mut self, [own, other]: [f64; 2], given: f64) {
        if own.abs() <= NOTHING * other.abs() {
            self.given = self.given.max(other);
            return;
        }
        let at = (1.0 - other * given) / own;
        if own < 0.0 {
            self.low = self.low.max(at);
            return;
        }
        self.high = self.high.min(at);
        if other > 0.0 {
            self.falling = self.falling.min(at);
        }
    }

    /// The largest b within `cap` that goes with some b up to the given one at the other end, if that is the one that goes
    /// with all of it: then the bound that counts is the cap, or one that would not be larger if less were given. Bounds are
    /// concave in what is given, so that this holds for all that is less.
    #[inline]
    fn largest(&self, cap: f64) -> Option<f64> {
        let most = if cap < self.high { cap } else { self.high };
        let proved = self.low <= most && self.given <= 1.0 && (most < self.falling || cap <= most);
        // Not where it is not a number.
        (proved && most.is_finite()).then_some(most)
    }
}
