//! Rows of the convex program that the limits of a cell give.

use super::asked::Asked;
use super::bound::{CapSource, Constraint, JerkRow, Row, number};
use super::convex::{Cone, Origin, Program};
use super::grid::{End, Grid};
use std::ops::Range;

/// Cones, and rows of cells at rest, less active than this at the guess are left out.
const FAR: f64 = 0.5;
/// The least c, as a part of the smaller guess of b beside it.
const LEAST: f64 = 0.02;
/// Cells that take less time, s, are too short for a jerk: rounding would drown their coefficients.
pub(super) const LEAST_TIME: f64 = 2e-5;
/// Where the velocity varies within a cell, so does the jerk: at its ends it may be larger than in its middle, by this
/// part of the limit.
const AT_ENDS: f64 = 0.04;
/// An end of a cell at which b is less by more than this part is left alone.
const SLOWER: f64 = 0.3;
/// Where a row of a jerk limit is active, so much of it is the jerk: the rest is the tangent.
const JERK_SHARE: f64 = 2.0 / 3.0;

/// Quality of a guess.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Known {
    /// It does not solve the program yet.
    #[default]
    Rough,
    /// One of a program that is not quite this.
    Nearly,
    /// One of this program, up to what has changed since.
    Well,
}

/// Rows less active than this at the guess are left out at first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    /// Those of accelerations and of velocities between cells.
    other: f64,
    /// Those of velocities in cells.
    cap: f64,
    /// Those of jerks: without jerk they are active by a third.
    jerk: f64,
}

impl Screen {
    /// About a guess that is known so well.
    pub(super) fn about(known: Known) -> Self {
        let (other, cap, jerk) = match known {
            Known::Rough => (0.5, 0.2, 0.5),
            Known::Nearly => (0.5, 0.5, 0.75),
            Known::Well => (0.9, 0.5, 0.9),
        };
        Self { other, cap, jerk }
    }
}

/// b, a and γ around a cell as parts of the c of the cell before, of it and of the one after.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    pub(super) length: f64,
    pub(super) start: Place,
    pub(super) finish: Place,
    pub(super) gamma: [f64; 3],
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) b: [f64; 3],
    pub(super) a: [f64; 3],
}

impl Around {
    fn at(&self, end: End) -> Place {
        match end {
            End::Start => self.start,
            End::Finish => self.finish,
        }
    }

    /// In the middle of the cell.
    fn middle(&self) -> Place {
        let mut place = Place { b: [0.0, 0.5, 0.0], a: [0.0; 3] };
        for end in [&self.start, &self.finish] {
            for (slot, b) in place.b.iter_mut().zip(end.b) {
                *slot += 0.25 * b;
            }
            for (slot, a) in place.a.iter_mut().zip(end.a) {
                *slot += 0.5 * a;
            }
        }
        place
    }
}

impl Place {
    fn acceleration(&self, row: &Row) -> [f64; 3] {
        let mut line = [0.0; 3];
        for ((slot, a), b) in line.iter_mut().zip(self.a).zip(self.b) {
            *slot = row.a * a + row.b * b;
        }
        line
    }

    fn jerk(&self, row: &JerkRow, gamma: [f64; 3]) -> [f64; 3] {
        let mut line = [0.0; 3];
        for (((slot, a), b), gamma) in line.iter_mut().zip(self.a).zip(self.b).zip(gamma) {
            *slot = row.third * b + 3.0 * row.second * a + row.first * gamma;
        }
        line
    }
}

/// Writes rows around a cell in terms of the program's variables.
#[derive(Debug)]
pub(super) struct Writer<'s> {
    pub(super) program: &'s mut Program,
    /// Of the variables, and c at the guess: both per cell.
    pub(super) scale: &'s [f64],
    pub(super) middles: &'s [f64],
    /// b at the two ends of the cell.
    pub(super) guess: &'s [f64],
    /// Rows of the cell that are not left out.
    pub(super) asked: Asked,
    /// Cells whose c are variables; the others are given.
    pub(super) free: &'s Range<usize>,
    /// Rows left out at first.
    pub(super) screen: Screen,
    /// True if no row is left out that could count, but those of velocities.
    pub(super) all: bool,
    /// The cell.
    pub(super) index: usize,
}

impl Writer<'_> {
    fn origin(&self, constraint: Constraint, share: f64) -> Origin {
        Origin { cell: self.index, constraint, upper: true, share }
    }

    /// Σ `line`·c as entries, what is given of it, and its value at the guess.
    fn entries(&self, line: [f64; 3]) -> ([(usize, f64); 3], f64, f64) {
        let mut entries = [(0, 0.0); 3];
        let (mut sum, mut given) = (0.0, 0.0);
        for (offset, (slot, value)) in entries.iter_mut().zip(line).enumerate() {
            // The cell of this entry is index + offset − 1.
            let Some(cell) = (self.index + offset).checked_sub(1) else { continue };
            let at = |values: &[f64]| value * values.get(cell).copied().unwrap_or_default();
            sum += at(self.middles);
            if self.free.contains(&cell) {
                *slot = (cell - self.free.start, at(self.scale));
            } else {
                given += at(self.middles);
            }
        }
        (entries, given, sum)
    }

    /// Adds the row Σ `line`·c ≤ `right`; at first as a spare one if it is less active than `screen` at the guess.
    fn add(&mut self, line: [f64; 3], right: f64, screen: f64, origin: Origin) {
        let (entries, given, sum) = self.entries(line);
        if entries.iter().all(|(_, value)| *value == 0.0) {
            return;
        }
        let free = right - given;
        // Every right side is 1, where that is possible.
        let (scale, to) =
            if free > 1e-3 * right { (1.0 / free, 1.0) } else { (1.0 / right, free / right) };
        let entries = entries.map(|(index, value)| (index, value * scale));
        let most: f64 = entries.iter().map(|(_, value)| value.abs()).sum();
        let counts = most > 0.5 * to;
        if sum >= screen * right || self.asked.has(&origin) || self.all && counts {
            self.program.add_row(&entries, to, origin);
        } else if counts {
            self.program.add_spare(entries, to, origin);
        }
    }

    /// The bounds on the velocity: in the cell, and at its end where that is a joint with a bound of its own.
    pub(super) fn add_cap(&mut self, grid: &Grid, cell: usize) {
        let [from, to] = grid.cell_caps(cell);
        let here = 0.5 * (from.v2 + to.v2);
        let source = from.min(to).source;
        if here.is_finite() {
            let origin = self.origin(Constraint::Velocity(source), source.share());
            self.add([0.0, 1.0, 0.0], here, self.screen.cap, origin);
        }
    }

    /// b stays positive all through the cell, where the values at its ends alone do not see to it.
    pub(super) fn add_least(&mut self) {
        let ends = self.guess.iter().copied().fold(f64::INFINITY, f64::min);
        if let Some(variable) = self.index.checked_sub(self.free.start)
            && self.free.contains(&self.index)
            && let Some((c, scale)) = self.middles.get(self.index).zip(self.scale.get(self.index))
        {
            // Of the slower end: where the path slows down to next to nothing, c is not far from nothing as well.
            let least = LEAST * ends.min(*scale) / scale;
            let constraint = Constraint::Velocity(CapSource::Unconstrained);
            let origin = Origin { upper: false, ..self.origin(constraint, 0.0) };
            let entries = [(variable, -1.0), (0, 0.0), (0, 0.0)];
            if *c < 2.0 * least * scale {
                self.program.add_row(&entries, -least, origin);
            } else {
                self.program.add_spare(entries, -least, origin);
            }
        }
    }

    /// The limits of acceleration at an end of the cell, and the bound on the velocity at the node there.
    pub(super) fn add_accelerations(
        &mut self,
        grid: &Grid,
        cell: usize,
        end: End,
        around: &Around,
    ) {
        let place = around.at(end);
        if end == End::Finish
            && !self.all
            && let Some(cap) = grid.caps().get(cell + 1)
        {
            // Between cells of different limits it is the lower one that counts, which c alone does not keep.
            let beside = [grid.cell_caps(cell), grid.cell_caps(cell + 1)];
            let mean = beside.map(|[from, to]| 0.5 * (from.v2 + to.v2));
            if cap.v2 < mean[0].max(mean[1]) * (1.0 - 1e-6) {
                let origin = self.origin(Constraint::Velocity(cap.source), cap.source.share());
                self.add(place.b, cap.v2, self.screen.other, origin);
            }
        }
        let (axes, further) = grid.rows(cell, end);
        // Where the path is smooth the end of the cell before has said the same.
        let (said, said_further) = match end {
            End::Start if self.index > 0 => grid.rows(cell.wrapping_sub(1), End::Finish),
            _ => Default::default(),
        };
        for (axis, row) in axes.iter().enumerate() {
            if said.get(axis).is_some_and(|said| said.is_about(row)) {
                continue;
            }
            let origin = self.origin(Constraint::AxisAcceleration(number(axis)), 1.0);
            let line = place.acceleration(row);
            self.add(line, 1.0, self.screen.other, origin);
            self.add(line.map(|x| -x), 1.0, self.screen.other, Origin { upper: false, ..origin });
        }
        for (index, row) in further.iter().enumerate() {
            if said_further.get(index).is_some_and(|said| said.is_about(row)) {
                continue;
            }
            let origin = self.origin(grid.further(index), 1.0);
            self.add(place.acceleration(row), 1.0, self.screen.other, origin);
        }
        if let Some(disc) = grid.disc(cell, end) {
            let lines =
                disc.a.iter().zip(disc.b).map(|(a, b)| place.acceleration(&Row { a: *a, b }));
            let mut cone = Cone::default();
            let mut square = 0.0;
            for ((row, given), line) in cone.rows.iter_mut().zip(&mut cone.given).zip(lines) {
                let (entries, of_given, sum) = self.entries(line);
                (*row, *given) = (entries, of_given);
                square += sum * sum;
            }
            // Cones cost more than rows; one far from its limit at the guess is left out.
            let free = cone.rows.iter().flatten().any(|(_, value)| *value != 0.0);
            if free && square > FAR * FAR {
                let origin = self.origin(Constraint::ToolAcceleration, 1.0);
                self.program.add_cone(cone, origin);
            }
        }
    }

    /// The jerk limits in a cell that begins or ends at rest: |line·c|·√(b·c) ≤ 1 in the one c that counts, so that the true
    /// limit can be given.
    pub(super) fn add_rest(&mut self, grid: &Grid, cell: usize, around: &Around) {
        let h = around.length;
        for end in End::BOTH {
            let place = around.at(end);
            // b ∝ u^4/3.
            let gamma = place.b.map(|b| b * 2.0 / 9.0 / (h * h));
            for (axis, row) in grid.jerks(cell, end).iter().enumerate() {
                let line = place.jerk(row, gamma);
                for (offset, (line, b)) in line.into_iter().zip(place.b).enumerate() {
                    let Some(cell) = (self.index + offset).checked_sub(1) else { continue };
                    let jerk = line.abs() * b.max(0.0).sqrt();
                    if jerk > 0.0 && self.free.contains(&cell) {
                        let most = jerk.powf(-2.0 / 3.0);
                        let scale = self.scale.get(cell).copied().unwrap_or_default();
                        let entries = [(cell - self.free.start, scale / most), (0, 0.0), (0, 0.0)];
                        let constraint = Constraint::AxisJerk(number(axis));
                        let origin = self.origin(constraint, JERK_SHARE);
                        if scale > FAR * most {
                            self.program.add_row(&entries, 1.0, origin);
                        } else {
                            self.program.add_spare(entries, 1.0, origin);
                        }
                    }
                }
            }
        }
    }

    /// The jerk limits in the middle of the cell and, where the jerk is another there, at its ends.
    pub(super) fn add_jerks(&mut self, grid: &Grid, cell: usize, around: &Around) {
        let [from, to] = *self.guess else { return };
        let own = self.middles.get(self.index).copied().unwrap_or_default();
        let h = around.length;
        let guess = (0.5 * own + 0.25 * (from + to)).max(0.5 * from.min(to));
        // A cell that is over at once may change the acceleration by as much as one of the least time.
        let share = (h / guess.sqrt() / LEAST_TIME).min(1.0);
        let places = [
            (around.start, from, grid.jerks(cell, End::Start)),
            (around.middle(), guess, grid.middle_jerks(cell)),
            (around.finish, to, grid.jerks(cell, End::Finish)),
        ];
        let dense = grid.is_dense(cell);
        for (index, (place, b, rows)) in places.iter().enumerate() {
            // Near rest the tangent at the slower end would hold back what it is not about.
            let more = if index == 1 || dense { 0.0 } else { AT_ENDS };
            let least = if dense { 1.0 - SLOWER } else { 1.0 + AT_ENDS };
            if index != 1 && *b <= guess * least {
                continue;
            }
            let factor = share / (1.0 + more);
            for (axis, row) in rows.iter().enumerate() {
                let line = place.jerk(row, around.gamma).map(|x| x * factor);
                self.add_jerk(line, place.b, *b, (axis, true));
                self.add_jerk(line.map(|x| -x), place.b, *b, (axis, false));
            }
        }
    }

    /// Adds line·c·√(b·c) ≤ 1 with its tangent about b = `guess`.
    fn add_jerk(&mut self, line: [f64; 3], b: [f64; 3], guess: f64, (axis, upper): (usize, bool)) {
        let (of_line, of_b) = (guess.sqrt() / 1.5, 1.0 / (3.0 * guess));
        let origin = self.origin(Constraint::AxisJerk(number(axis)), JERK_SHARE);
        let origin = Origin { upper, ..origin };
        let mut entries = line.map(|x| of_line * x);
        for (entry, b) in entries.iter_mut().zip(b) {
            *entry += of_b * b;
        }
        self.add(entries, 1.0, self.screen.jerk, origin);
    }
}
