//! Limits of one cell in the plane of the b at its two ends: half planes and discs, exact and robust.

use super::bound::{Constraint, Disc, Row, number};
use super::grid::{End, Grid};

/// Replaces infinity where products with it must stay numbers.
const HUGE: f64 = 1e280;
/// Bounds that cross by less than this part of them do so by rounding.
const CROSSED: f64 = 1e-9;
/// A bound on x, or y = 0, counts where x is as near to it as this, in parts of x.
const HELD: f64 = 1e-6;
/// A coefficient that is less than so much of the other one of its row says nothing about its b.
pub(super) const NOTHING: f64 = 1e-12;

/// The limits of one cell as half planes p·x + r·y ≤ 1 in the b at its start (x) and its end (y).
#[derive(Debug, Default)]
pub(super) struct Plane {
    /// Hold with both signs.
    strips: Vec<[f64; 2]>,
    /// Hold as they are.
    halves: Vec<[f64; 2]>,
    /// |P·x + R·y| ≤ 1.
    discs: Vec<[[f64; 3]; 2]>,
}

impl Plane {
    #[inline]
    pub(super) fn set(&mut self, grid: &Grid, cell: usize) {
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

    /// The largest y within `cap` that goes with x.
    #[inline]
    pub(super) fn largest_after(&self, x: f64, cap: f64) -> f64 {
        // By rounding the two bounds may cross.
        let Span { low, high } = self.span(x, cap);
        high.at.max(low.at).min(cap)
    }

    /// The smallest y that goes with x, below 0 where the path comes to rest before.
    pub(super) fn least_after(&self, x: f64) -> f64 {
        self.span_from(x, -HUGE, f64::INFINITY).low.at.max(-HUGE)
    }

    /// The largest x within `cap` that goes with some y from 0 to `next`.
    pub(super) fn largest_before(&self, cap: f64, next: f64) -> f64 {
        let mut x = cap.min(self.alone());
        // Every round leaves at least one half plane behind; a handful is usual.
        for _ in 0..128 {
            let Span { low, high } = self.span(x, next);
            if low.at <= high.at {
                break;
            }
            // Where the two bounds meet: low = (1 − pₗ·x)/rₗ = (1 − pₕ·x)/rₕ = high.
            let ([pl, rl], [ph, rh]) = (low.row, high.row);
            let (top, bottom) = (rh - rl, pl * rh - ph * rl);
            let meet = top / bottom;
            if !(meet < x && meet >= 0.0) {
                if meet >= 0.0 && low.at - high.at > CROSSED * low.at.abs().max(high.at.abs()) {
                    // The edge of a disc, where its tangent does not tell how far it is to the other limits.
                    x *= 1.0 - CROSSED;
                    continue;
                }
                // Rounding: they meet at x, but for the last digits.
                x = if meet >= 0.0 { x.min(meet) } else { 0.0 };
                break;
            }
            x = meet;
        }
        x.max(0.0)
    }

    /// The bound on y within `cap` that counts in [`Self::largest_after`].
    pub(super) fn bound_after(&self, x: f64, cap: f64) -> Bound {
        self.span(x, cap).high
    }

    /// The two bounds on y that meet where x is [`Self::largest_before`]; if that is a bound on x alone, it and none.
    pub(super) fn bounds_before(&self, x: f64, next: f64) -> [Bound; 2] {
        if let Some((p, source)) = self.alones().find(|(p, _)| p * x >= 1.0 - HELD) {
            let none = Bound { at: next, row: [0.0, 1.0], source: Source::Given };
            return [Bound { at: next, row: [p, 0.0], source }, none];
        }
        let Span { low, high } = self.span_from(x, -HELD * x, next);
        [low, high]
    }

    /// The limit that a bound comes from.
    pub(super) fn constraint(&self, grid: &Grid, source: Source) -> Option<Constraint> {
        match source {
            Source::Given => None,
            Source::Strip(index) => {
                Some(Constraint::AxisAcceleration(number(index % grid.limits().len().max(1))))
            }
            Source::Half(index) => Some(grid.further(index % (self.halves.len() / 2).max(1))),
            Source::Disc => Some(Constraint::ToolAcceleration),
        }
    }

    /// The largest x as far as half planes go that y has no part in.
    fn alone(&self) -> f64 {
        1.0 / self.alones().map(|(p, _)| p).fold(0.0, f64::max)
    }

    /// p of the half planes that y has no part in.
    fn alones(&self) -> impl Iterator<Item = (f64, Source)> {
        let alone = |[p, r]: &[f64; 2]| r.abs() <= NOTHING * p.abs();
        let strips = self.strips.iter().enumerate().filter(move |(_, row)| alone(row));
        let halves = self.halves.iter().enumerate().filter(move |(_, row)| alone(row));
        strips
            .map(|(index, [p, _])| (p.abs(), Source::Strip(index)))
            .chain(halves.map(|(index, [p, _])| (*p, Source::Half(index))))
            .chain(self.discs.iter().map(|disc| (disc_alone(disc), Source::Disc)))
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
        let source = Source::Given;
        let mut low = Bound { at: least, row: [0.0, -HUGE], source };
        let mut high = Bound { at: cap, row: [0.0, (1.0 / cap).min(HUGE)], source };
        for (index, &[p, r]) in self.strips.iter().enumerate() {
            let source = Source::Strip(index);
            if r.abs() <= NOTHING * p.abs() {
                continue;
            }
            let half = 1.0 / r;
            let (middle, half, p, r) =
                if r > 0.0 { (-p * x * half, half, p, r) } else { (-p * x * half, -half, -p, -r) };
            if middle + half < high.at {
                high = Bound { at: middle + half, row: [p, r], source };
            }
            if middle - half > low.at {
                low = Bound { at: middle - half, row: [-p, -r], source };
            }
        }
        for (index, &[p, r]) in self.halves.iter().enumerate() {
            let source = Source::Half(index);
            let at = (1.0 - p * x) / r;
            if r > 0.0 && at < high.at {
                high = Bound { at, row: [p, r], source };
            } else if r < 0.0 && at > low.at {
                low = Bound { at, row: [p, r], source };
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
pub(super) struct Bound {
    at: f64,
    pub(super) row: [f64; 2],
    pub(super) source: Source,
}

/// Source of a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// The bound is given.
    Given,
    /// The strip of this number.
    Strip(usize),
    /// The half plane of this number.
    Half(usize),
    /// A disc.
    Disc,
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

/// |P × R|: pp·rr − pr² without what is lost where both are large.
fn across([p, r]: &[[f64; 3]; 2]) -> f64 {
    let cross = [p[1] * r[2] - p[2] * r[1], p[2] * r[0] - p[0] * r[2], p[0] * r[1] - p[1] * r[0]];
    dot(&cross, &cross).sqrt()
}

/// 1 / the largest x for which |P·x + R·y| ≤ 1 holds for any y.
fn disc_alone(disc: &[[f64; 3]; 2]) -> f64 {
    let [p, r] = disc;
    let rr = dot(r, r);
    if rr > 0.0 { across(disc) / rr.sqrt() } else { dot(p, p).sqrt() }
}

/// Narrows the y that go with x to those in the disc. The half planes are its tangents there.
fn disc_span(disc: &[[f64; 3]; 2], x: f64, low: &mut Bound, high: &mut Bound) {
    let [p, r] = disc;
    let (pr, rr) = (dot(p, r), dot(r, r));
    if rr <= 0.0 {
        return;
    }
    let middle = -pr * x / rr;
    let off = across(disc) * x;
    let half = (rr - off * off).max(0.0).sqrt() / rr;
    // The tangent at (x, y): v·P·x' + v·R·y' ≤ |v| with v = P·x + R·y, which rounding may make longer than 1.
    let tangent = |y: f64| {
        let v = [p[0] * x + r[0] * y, p[1] * x + r[1] * y, p[2] * x + r[2] * y];
        let length = dot(&v, &v).sqrt();
        let scale = if length > 0.0 { 1.0 / length } else { 1.0 };
        [dot(&v, p) * scale, dot(&v, r) * scale]
    };
    if middle + half < high.at {
        *high = Bound { at: middle + half, row: tangent(middle + half), source: Source::Disc };
    }
    if middle - half > low.at {
        *low = Bound { at: middle - half, row: tangent(middle - half), source: Source::Disc };
    }
}
