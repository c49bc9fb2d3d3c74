//! Unwrapping of axis positions that jump back at the end of a period.

/// Follows the positions of an axis over the ends of its period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unwrap {
    period: Option<f64>,
    last: f64,
    whole: f64,
}

impl Unwrap {
    /// Begins at `position`. Without a period, or with one that is none, positions stay what they are.
    pub(super) fn new(period: Option<f64>, position: f64) -> Self {
        let period = period.filter(|period| period.is_finite() && *period > 0.0);
        Self { period, last: position, whole: position }
    }

    /// The next position: the nearest one to the last of all that are whole periods apart.
    pub(super) fn follow(&mut self, position: f64) -> f64 {
        let by = position - self.last;
        self.last = position;
        match self.period {
            None => self.whole = position,
            Some(period) => self.whole += by - (by / period).round() * period,
        }
        self.whole
    }
}
