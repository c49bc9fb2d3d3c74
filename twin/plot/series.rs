//! Curves and stretches of any length in the room of a page.
//!
//! Each column of the picture keeps the first, lowest, highest and last point: the same picture (M4: Jugel and
//! others, VLDB 2014).

use super::Point;

/// Columns that are kept: two for each pixel.
pub(super) const COLUMNS: f64 = 1720.0;
/// Points and stretches that are kept before they are thinned out.
const MOST: usize = 10_000;

/// A curve that is recorded point by point; a value that is not a number is a gap.
#[derive(Clone, Debug, Default)]
pub struct Series(Vec<Point>);

impl Series {
    /// Adds a point at or behind the last one.
    pub fn push(&mut self, across: f64, value: Option<f64>) {
        let value = value.filter(|value| value.is_finite()).unwrap_or(f64::NAN);
        if value.is_nan() && self.0.last().is_none_or(|last| last.1.is_nan()) {
            return;
        }
        self.0.push((across, value));
        if self.0.len() > MOST
            && let [first, .., last] = self.0.as_slice()
        {
            self.0 = thinned(&self.0, [first.0, last.0]);
        }
    }

    /// Its points.
    pub fn points(&self) -> &[Point] {
        &self.0
    }
}

/// The visible points of a line between two places across.
pub(super) fn thinned(line: &[Point], [from, to]: [f64; 2]) -> Vec<Point> {
    let column = |point: &Point| ((point.0 - from) / (to - from) * COLUMNS).floor();
    let mut kept = Vec::with_capacity(line.len().min(MOST));
    for run in line.chunk_by(|one, other| column(one).to_bits() == column(other).to_bits()) {
        if run.len() <= 4 {
            kept.extend(run);
            continue;
        }
        let finite = || run.iter().enumerate().filter(|(_, point)| !point.1.is_nan());
        let by = |one: &(usize, &Point), other: &(usize, &Point)| one.1.1.total_cmp(&other.1.1);
        let gap = run.iter().enumerate().find(|(_, point)| point.1.is_nan());
        let chosen =
            [finite().next(), finite().min_by(by), finite().max_by(by), finite().next_back(), gap];
        let mut chosen: Vec<_> = chosen.into_iter().flatten().collect();
        chosen.sort_unstable_by_key(|(index, _)| *index);
        chosen.dedup_by_key(|(index, _)| *index);
        kept.extend(chosen.into_iter().map(|(_, point)| *point));
    }
    kept
}

/// Stretches on which something stays the same, one behind the other.
#[derive(Clone, Debug)]
pub struct Stretches<T> {
    begin: f64,
    /// End of each stretch, and its value.
    ends: Vec<(f64, T)>,
}

impl<T> Default for Stretches<T> {
    fn default() -> Self {
        Self { begin: 0.0, ends: Vec::new() }
    }
}

impl<T: Copy + PartialEq> Stretches<T> {
    /// Adds what holds from the last place to this one.
    pub fn push(&mut self, to: f64, value: T) {
        match self.ends.last_mut() {
            Some((end, last)) if *last == value => *end = to,
            Some(_) => self.ends.push((to, value)),
            None => {
                self.begin = to;
                self.ends.push((to, value));
            }
        }
        if self.ends.len() > MOST {
            self.thin();
        }
    }

    /// Of the stretches that end in a column of the picture the longest is kept.
    fn thin(&mut self) {
        let mut thin = Self { begin: self.begin, ends: Vec::new() };
        let span = self.ends.last().map_or(0.0, |last| last.0 - self.begin);
        let column = |end: f64| ((end - self.begin) / span * COLUMNS).floor().to_bits();
        let all: Vec<_> = self.iter().collect();
        for run in all.chunk_by(|one, other| column(one.1) == column(other.1)) {
            let by = |one: &&(f64, f64, T), other: &&(f64, f64, T)| {
                (one.1 - one.0).total_cmp(&(other.1 - other.0))
            };
            if let (Some(longest), Some(last)) = (run.iter().max_by(by), run.last()) {
                thin.push(last.1, longest.2);
            }
        }
        // The first of them began at the begin of all.
        thin.begin = self.begin;
        *self = thin;
    }

    /// Begin, end and value of each.
    pub fn iter(&self) -> impl Iterator<Item = (f64, f64, T)> {
        let begins = std::iter::once(self.begin).chain(self.ends.iter().map(|(end, _)| *end));
        begins.zip(&self.ends).map(|(begin, (end, value))| (begin, *end, *value))
    }
}
