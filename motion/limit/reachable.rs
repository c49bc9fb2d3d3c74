//! The fastest profile with limited acceleration in two passes over the cells: reachability analysis.
//!
//! The acceleration is constant in a cell, so that b is linear in it, and limits hold at both of its ends. Backwards,
//! every node gets the largest b from which the rest of the path can still be met; forwards, the largest b within that
//! is taken (Pham and Pham, "A new approach to time-optimal path parameterization based on reachability analysis", IEEE
//! T-RO 34(3), 2018). Standing still is always allowed (b = 0, a = 0), so the sets are intervals from 0.

use super::grid::{Disc, End, Grid, Row};
use std::ops::Range;

/// Stands for infinity where products with it must stay numbers.
const HUGE: f64 = 1e280;

/// Largest b at the nodes of `cells` such that the limits hold in every cell, from `start` (at most) to `end` (at most).
///
/// The result has one value per node of `cells`. It starts lower than `start` where the path ahead asks for it.
pub fn fastest(grid: &Grid, cells: Range<usize>, start: f64, end: f64) -> Vec<f64> {
    let mut controllable = controllable(grid, cells.clone(), end);
    if let Some(first) = controllable.first_mut() {
        *first = first.min(start);
    }
    forward(grid, cells, &mut controllable);
    controllable
}

/// The largest b at every node of `cells` from which the end can be met with at most `end`.
pub(super) fn controllable(grid: &Grid, cells: Range<usize>, end: f64) -> Vec<f64> {
    let caps = grid.caps();
    let cap = |node: usize| caps.get(node).map_or(0.0, |cap| cap.v2);
    let mut result = vec![0.0; cells.len() + 1];
    let mut next = end.min(cap(cells.end));
    let mut plane = Plane::default();
    let mut slots = result.iter_mut().rev();
    if let Some(slot) = slots.next() {
        *slot = next;
    }
    for (cell, slot) in cells.rev().zip(slots) {
        plane.set(grid, cell);
        next = plane.largest_before(cap(cell), next);
        *slot = next;
    }
    result
}

/// Upper bounds on b at every node of `cells`, for any profile from `start` (exactly) to `end` (at most): what can be reached
/// from the start, and from where the end can be met.
pub(super) fn bounds(grid: &Grid, cells: Range<usize>, start: f64, end: f64) -> Vec<f64> {
    let mut result = controllable(grid, cells.clone(), end);
    let mut plane = Plane::default();
    let mut iter = result.iter_mut();
    let Some(first) = iter.next() else { return result };
    *first = first.min(start);
    let mut here = *first;
    for (cell, next) in cells.zip(iter) {
        plane.set(grid, cell);
        plane.swap();
        here = plane.largest_before(*next, here);
        *next = here;
    }
    result
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

/// Lowers `b`, which holds what can be met later, to what can be reached from its first value.
fn forward(grid: &Grid, cells: Range<usize>, b: &mut [f64]) {
    let mut plane = Plane::default();
    let mut iter = b.iter_mut();
    let Some(mut here) = iter.next().copied() else { return };
    for (cell, next) in cells.zip(iter) {
        plane.set(grid, cell);
        here = plane.largest_after(here, *next);
        *next = here;
    }
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

/// The limits of one cell as half planes p·x + r·y ≤ 1 in the b at its start (x) and its end (y).
#[derive(Debug, Default)]
struct Plane {
    /// Hold with both signs.
    strips: Vec<[f64; 2]>,
    /// Hold as they are.
    halves: Vec<[f64; 2]>,
    /// |P·x + R·y| ≤ 1.
    discs: Vec<[[f64; 3]; 2]>,
}

impl Plane {
    #[inline]
    fn set(&mut self, grid: &Grid, cell: usize) {
        self.strips.clear();
        self.halves.clear();
        self.discs.clear();
        let slope = 0.5 / grid.length(cell);
        for end in End::BOTH {
            let (axes, further) = grid.rows(cell, end);
            let turn = |row: &Row| {
                let r = row.a * slope;
                match end {
                    End::Start => [row.b - r, r],
                    End::Finish => [-r, row.b + r],
                }
            };
            self.strips.extend(axes.iter().map(turn));
            self.halves.extend(further.iter().map(turn));
            self.discs.extend(grid.disc(cell, end).map(|disc| turn_disc(disc, slope, end)));
        }
    }

    /// Start and end in each other's place.
    fn swap(&mut self) {
        for pair in self.strips.iter_mut().chain(&mut self.halves) {
            pair.swap(0, 1);
        }
        for disc in &mut self.discs {
            disc.swap(0, 1);
        }
    }

    /// The largest y within `cap` that goes with x.
    #[inline]
    fn largest_after(&self, x: f64, cap: f64) -> f64 {
        // By rounding the two bounds may cross.
        let Span { low, high } = self.span(x, cap);
        high.at.max(low.at).min(cap)
    }

    /// The smallest y that goes with x, below 0 where the path comes to rest before.
    fn least_after(&self, x: f64) -> f64 {
        self.span_from(x, -HUGE, f64::INFINITY).low.at.max(-HUGE)
    }

    /// The largest x within `cap` that goes with some y from 0 to `next`.
    fn largest_before(&self, cap: f64, next: f64) -> f64 {
        let mut x = cap.min(self.alone());
        // Every round leaves at least one half plane behind; a handful is usual.
        for _ in 0..64 {
            let Span { low, high } = self.span(x, next);
            if low.at <= high.at {
                break;
            }
            // Where the two bounds meet: low = (1 − pₗ·x)/rₗ = (1 − pₕ·x)/rₕ = high.
            let ([pl, rl], [ph, rh]) = (low.row, high.row);
            let (top, bottom) = (rh - rl, pl * rh - ph * rl);
            let meet = top / bottom;
            if !(meet < x && meet >= 0.0) {
                // Rounding: they meet at x, but for the last digits.
                x = if meet >= 0.0 { x.min(meet) } else { 0.0 };
                break;
            }
            x = meet;
        }
        x.max(0.0)
    }

    /// The largest x as far as half planes go that y has no part in.
    fn alone(&self) -> f64 {
        let strips =
            self.strips.iter().filter(|[p, r]| r.abs() <= 1e-12 * p.abs()).map(|[p, _]| p.abs());
        let halves =
            self.halves.iter().filter(|[p, r]| r.abs() <= 1e-12 * p.abs()).map(|[p, _]| *p);
        let discs = self.discs.iter().map(disc_alone);
        1.0 / strips.chain(halves).chain(discs).fold(0.0, f64::max)
    }

    /// The y that go with x, from 0 to `cap` at most.
    #[inline]
    fn span(&self, x: f64, cap: f64) -> Span {
        self.span_from(x, 0.0, cap)
    }

    /// The same from `least` on.
    #[inline]
    fn span_from(&self, x: f64, least: f64, cap: f64) -> Span {
        // 0 ≤ y as a row is y ≥ −1/HUGE, and y ≤ cap may have to be y ≤ 1/HUGE.
        let mut low = Bound { at: least, row: [0.0, -HUGE] };
        let mut high = Bound { at: cap, row: [0.0, (1.0 / cap).min(HUGE)] };
        for &[p, r] in &self.strips {
            if r.abs() <= 1e-12 * p.abs() {
                continue;
            }
            let half = 1.0 / r;
            let (middle, half, p, r) =
                if r > 0.0 { (-p * x * half, half, p, r) } else { (-p * x * half, -half, -p, -r) };
            if middle + half < high.at {
                high = Bound { at: middle + half, row: [p, r] };
            }
            if middle - half > low.at {
                low = Bound { at: middle - half, row: [-p, -r] };
            }
        }
        for &[p, r] in &self.halves {
            let at = (1.0 - p * x) / r;
            if r > 0.0 && at < high.at {
                high = Bound { at, row: [p, r] };
            } else if r < 0.0 && at > low.at {
                low = Bound { at, row: [p, r] };
            }
        }
        for disc in &self.discs {
            disc_span(disc, x, &mut low, &mut high);
        }
        Span { low, high }
    }
}

/// A bound on y, and the half plane that gives it.
#[derive(Clone, Copy, Debug)]
struct Bound {
    at: f64,
    row: [f64; 2],
}

#[derive(Clone, Copy, Debug)]
struct Span {
    low: Bound,
    high: Bound,
}

fn turn_disc(disc: &Disc, slope: f64, end: End) -> [[f64; 3]; 2] {
    let r = disc.a.map(|a| a * slope);
    let mut with = disc.b;
    let mut without = r;
    for ((with, without), r) in with.iter_mut().zip(&mut without).zip(r) {
        *without = -r;
        *with += r;
    }
    match end {
        // At the start it is x that goes with p″.
        End::Start => {
            let mut p = disc.b;
            for (p, r) in p.iter_mut().zip(r) {
                *p -= r;
            }
            [p, r]
        }
        End::Finish => [without, with],
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// 1 / the largest x for which |P·x + R·y| ≤ 1 holds for any y.
fn disc_alone([p, r]: &[[f64; 3]; 2]) -> f64 {
    let (pp, pr, rr) = (dot(p, p), dot(p, r), dot(r, r));
    let off = if rr > 0.0 { pp - pr * pr / rr } else { pp };
    off.max(0.0).sqrt()
}

/// Narrows the y that go with x to those in the disc. The half planes are its tangents there.
fn disc_span([p, r]: &[[f64; 3]; 2], x: f64, low: &mut Bound, high: &mut Bound) {
    let (pp, pr, rr) = (dot(p, p), dot(p, r), dot(r, r));
    if rr <= 0.0 {
        return;
    }
    let middle = -pr * x / rr;
    let half = ((pr * pr - rr * pp).mul_add(x * x, rr).max(0.0)).sqrt() / rr;
    // The tangent at (x, y): (pp·x + pr·y)·x' + (pr·x + rr·y)·y' ≤ 1.
    let tangent = |y: f64| [pp * x + pr * y, pr * x + rr * y];
    if middle + half < high.at {
        *high = Bound { at: middle + half, row: tangent(middle + half) };
    }
    if middle - half > low.at {
        *low = Bound { at: middle - half, row: tangent(middle - half) };
    }
}
