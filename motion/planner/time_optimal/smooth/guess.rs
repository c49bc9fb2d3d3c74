//! Guess (linearisation point) of a window with limited jerk.

use super::pairs;
use crate::time_optimal::asked::Asked;
use crate::time_optimal::convex::Origin;
use crate::time_optimal::rows::Known;

/// The next guess is not below this part of the one before.
const FLOOR: f64 = 0.05;
/// Where b changes by more than this part, the tangents about it do, too: by the square of it.
const MOVED: f64 = 0.1;
/// With a row that was left out and is not kept those of so many cells before and behind are added; of twice as many each
/// time that there are such rows again.
const AROUND: usize = 3;
pub(super) const MOST_AROUND: usize = 48;

/// Linearisation point of a window.
#[derive(Clone, Debug, Default)]
pub(in crate::time_optimal) struct Guess {
    /// b at the nodes, positive at all inner ones.
    pub(in crate::time_optimal) b: Vec<f64>,
    /// c in the cells.
    pub(in crate::time_optimal) c: Vec<f64>,
    /// Rows that are to be in the program, whether or not they seem to count, per cell.
    pub(in crate::time_optimal) asked: Vec<Asked>,
    /// Its quality.
    pub(in crate::time_optimal) known: Known,
    /// Nodes at which the last solution was far from what it was about, so that the tangents there are not near the limits.
    pub(in crate::time_optimal) moved: Vec<usize>,
    /// Of how many cells around one whose row was left out and is not kept rows are added.
    pub(super) around: usize,
    /// Tolerance of the next solve, unless this is rough.
    pub(super) tolerance: f64,
}

impl Guess {
    /// Of b alone.
    pub(in crate::time_optimal) fn rough(b: Vec<f64>) -> Self {
        let c: Vec<f64> = pairs(&b).map(|(from, to)| from.midpoint(to)).collect();
        Self {
            asked: vec![Asked::default(); c.len()],
            b,
            c,
            known: Known::Rough,
            moved: Vec::new(),
            around: AROUND,
            tolerance: super::FINE,
        }
    }

    /// Motion in the cell `index` of the length `h`.
    pub(in crate::time_optimal) fn motion(&self, index: usize, h: f64) -> Option<CellMotion> {
        let (from, to, c) = (*self.b.get(index)?, *self.b.get(index + 1)?, *self.c.get(index)?);
        let gamma = (from - 2.0 * c + to) / (h * h);
        let middle = 0.5 * c + 0.25 * (from + to);
        let ends = [
            [from, (c - from) / h, gamma],
            [middle.max(0.5 * from.min(to)), 0.5 * (to - from) / h, gamma],
            [to, (to - c) / h, gamma],
        ];
        Some(CellMotion { duration: 2.0 * h / (from.sqrt() + to.sqrt()), ends })
    }

    /// Fitted to a grid on which the cell `index` is cut at these parts of its length.
    pub(in crate::time_optimal) fn cut(&mut self, index: usize, at: &[f64]) {
        let ends = (self.b.get(index), self.b.get(index + 1), self.c.get(index));
        let (Some(&from), Some(&to), Some(&c)) = ends else { return };
        // Of the parabola's three Bézier values between two places the middle one; at one place its value.
        let between = |u: f64, v: f64| {
            (1.0 - u) * (1.0 - v) * from + (u * (1.0 - v) + v * (1.0 - u)) * c + u * v * to
        };
        let least = FLOOR * from.max(to);
        let starts = std::iter::once(0.0).chain(at.iter().copied());
        let finishes = at.iter().copied().chain(std::iter::once(1.0));
        self.c.splice(index..=index, starts.zip(finishes).map(|(u, v)| between(u, v)));
        let inner = at.iter().map(|u| between(*u, *u).max(least));
        self.b.splice((index + 1)..=index, inner);
        let asked = self.asked.get(index).copied().unwrap_or_default();
        self.asked.splice(index..index, at.iter().map(|_| asked));
        for node in self.moved.iter_mut().filter(|node| **node > index) {
            *node += at.len();
        }
    }

    /// No row is left out any more: a solution about this keeps all limits, so that there is one about that as well.
    pub(in crate::time_optimal) fn ask_all(&mut self) {
        self.asked.fill(Asked::ALL);
    }

    /// True if one of the ends of the cell `index` has moved far.
    pub(in crate::time_optimal) fn has_moved(&self, index: usize) -> bool {
        let node = self.moved.partition_point(|node| *node < index);
        self.moved.get(node).is_some_and(|node| *node <= index + 1)
    }

    /// With the solution about it in its place, and `broken` rows to be kept from now on.
    pub(super) fn follow(&mut self, b: &[f64], c: &[f64], Broken(broken): &Broken) {
        // A profile that all but rests says little about the next.
        self.moved.clear();
        for (node, (guess, b)) in self.b.iter_mut().zip(b).enumerate() {
            let next = b.max(FLOOR * *guess);
            if (next - *guess).abs() > MOVED * *guess {
                self.moved.push(node);
            }
            *guess = next;
        }
        self.c.clear();
        self.c.extend_from_slice(c);
        self.known = match self.known {
            Known::Rough => Known::Nearly,
            Known::Nearly | Known::Well => Known::Well,
        };
        for origin in broken {
            // A solution that keeps the one row would yield to its likes in the cells around.
            let from = origin.cell.saturating_sub(self.around);
            for asked in self.asked.iter_mut().skip(from).take(2 * self.around + 1) {
                asked.add(origin);
            }
        }
        if !broken.is_empty() {
            self.around = (2 * self.around).min(MOST_AROUND);
        }
    }
}

/// About what happens in a cell.
#[derive(Clone, Copy, Debug)]
pub(in crate::time_optimal) struct CellMotion {
    /// s.
    pub(in crate::time_optimal) duration: f64,
    /// b, a and γ at its start, in its middle and at its end.
    pub(in crate::time_optimal) ends: [[f64; 3]; 3],
}

/// Rows that were left out and are not kept.
#[derive(Debug, Default)]
pub(in crate::time_optimal) struct Broken(pub(super) Vec<Origin>);

impl Broken {
    /// True if there are none.
    pub(in crate::time_optimal) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds others.
    pub(in crate::time_optimal) fn extend(&mut self, Self(other): Self) {
        self.0.extend(other);
        self.0.sort_by_key(|origin| origin.cell);
    }

    /// True if one of them is of this cell.
    pub(in crate::time_optimal) fn has(&self, cell: usize) -> bool {
        let near = self.0.partition_point(|origin| origin.cell < cell);
        self.0.get(near).is_some_and(|origin| origin.cell == cell)
    }
}
