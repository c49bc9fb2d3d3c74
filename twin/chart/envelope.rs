//! Curves of any length in the room of a page: of each column first, last, lowest and highest point, which draw the same
//! picture as all of them (M4: Jugel and others, VLDB 2014). When the columns do not suffice they become twice as wide.

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct At {
    pub(crate) time_ns: i64,
    pub(crate) value: f64,
}

/// What is kept of a curve within a column.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strand {
    first: At,
    low: At,
    high: At,
    last: At,
}

impl Strand {
    fn new(at: At) -> Self {
        Self { first: at, low: at, high: at, last: at }
    }

    /// Adds what comes behind it.
    fn include(&mut self, next: &Self) {
        if next.low.value < self.low.value {
            self.low = next.low;
        }
        if next.high.value > self.high.value {
            self.high = next.high;
        }
        self.last = next.last;
    }

    /// Its points in the order of time.
    fn points(&self) -> [At; 4] {
        let mut points = [self.first, self.low, self.high, self.last];
        points.sort_by_key(|at| at.time_ns);
        points
    }
}

/// What happens within a column.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    index: i64,
    pub(crate) begin_ns: i64,
    pub(crate) end_ns: i64,
    strands: Vec<Option<Strand>>,
    /// First and last line of the program.
    pub(crate) lines: [u32; 2],
    /// For how long each kind of limit holds the path back, ns.
    held_ns: Vec<i64>,
}

impl Column {
    fn include(&mut self, next: Self) {
        self.end_ns = next.end_ns;
        for (strand, next) in self.strands.iter_mut().zip(next.strands) {
            match (strand, next) {
                (Some(strand), Some(next)) => strand.include(&next),
                (slot, next) => *slot = slot.or(next),
            }
        }
        self.lines = [self.lines[0], next.lines[1]];
        for (sum, next) in self.held_ns.iter_mut().zip(next.held_ns) {
            *sum += next;
        }
    }

    /// Whether a curve has a value here.
    pub(crate) fn has(&self, curve: usize) -> bool {
        self.strands.get(curve).is_some_and(Option::is_some)
    }

    /// The kind of limit that holds the path back for most of the time, if any.
    pub(crate) fn most_held(&self) -> Option<usize> {
        let most = self.held_ns.iter().enumerate().rev().max_by_key(|(_, held_ns)| **held_ns)?;
        (*most.1 > 0).then_some(most.0)
    }
}

/// A sample as the envelope takes it.
#[derive(Clone, Debug)]
pub(crate) struct Input<'a> {
    pub(crate) time_ns: i64,
    pub(crate) line: u32,
    /// Of each curve; none where it has no value.
    pub(crate) values: &'a [Option<f64>],
    /// The kind of limit that has held the path back since the sample before.
    pub(crate) held: Option<usize>,
}

/// All curves.
#[derive(Clone, Debug)]
pub(crate) struct Envelope {
    kinds: usize,
    most: usize,
    width_ns: i64,
    begin_ns: i64,
    columns: Vec<Column>,
}

impl Envelope {
    /// With at most `most` columns, and at least half as many once there are enough samples, and `kinds` kinds of limits.
    pub(crate) fn new(most: usize, kinds: usize) -> Self {
        Self { kinds, most: most.max(2), width_ns: 1, begin_ns: 0, columns: Vec::new() }
    }

    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// When the first and the last sample were, ns.
    pub(crate) fn span_ns(&self) -> Option<[i64; 2]> {
        Some([self.columns.first()?.begin_ns, self.columns.last()?.end_ns])
    }

    /// Adds a sample, at or behind the time of the last.
    pub(crate) fn include(&mut self, input: &Input<'_>) {
        let time_ns =
            self.columns.last().map_or(input.time_ns, |last| input.time_ns.max(last.end_ns));
        if self.columns.is_empty() {
            self.begin_ns = time_ns;
        }
        let since_ns = time_ns.saturating_sub(self.begin_ns);
        let most = i64::try_from(self.most).unwrap_or(i64::MAX);
        while since_ns / self.width_ns >= most {
            self.widen();
        }
        let elapsed_ns = self.columns.last().map_or(0, |last| time_ns.saturating_sub(last.end_ns));
        let mut held_ns = vec![0; self.kinds];
        if let Some(slot) = input.held.and_then(|kind| held_ns.get_mut(kind)) {
            *slot = elapsed_ns;
        }
        let strand = |value: &Option<f64>| {
            let value = value.filter(|value| value.is_finite())?;
            Some(Strand::new(At { time_ns, value }))
        };
        let column = Column {
            index: since_ns / self.width_ns,
            begin_ns: time_ns,
            end_ns: time_ns,
            strands: input.values.iter().map(strand).collect(),
            lines: [input.line; 2],
            held_ns,
        };
        match self.columns.last_mut() {
            Some(last) if last.index == column.index => last.include(column),
            _ => self.columns.push(column),
        }
    }

    fn widen(&mut self) {
        self.width_ns = self.width_ns.saturating_mul(2);
        let mut wide: Vec<Column> = Vec::with_capacity(self.columns.len() / 2 + 1);
        for mut column in self.columns.drain(..) {
            column.index /= 2;
            match wide.last_mut() {
                Some(last) if last.index == column.index => last.include(column),
                _ => wide.push(column),
            }
        }
        self.columns = wide;
    }

    /// The points of a curve, in pieces where it has no value in between.
    pub(crate) fn curve(&self, number: usize) -> Vec<Vec<At>> {
        let mut pieces = vec![Vec::new()];
        for column in &self.columns {
            match (column.strands.get(number).copied().flatten(), pieces.last_mut()) {
                (Some(strand), Some(piece)) => {
                    for at in strand.points() {
                        if piece.last() != Some(&at) {
                            piece.push(at);
                        }
                    }
                }
                (None, Some(piece)) if !piece.is_empty() => pieces.push(Vec::new()),
                _ => {}
            }
        }
        pieces.retain(|piece| !piece.is_empty());
        pieces
    }

    /// Lowest and highest value of a curve.
    pub(crate) fn range(&self, number: usize) -> Option<[f64; 2]> {
        let strands = self.columns.iter().filter_map(|column| *column.strands.get(number)?);
        strands.fold(None, |range, strand| {
            let [low, high] = range.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
            Some([low.min(strand.low.value), high.max(strand.high.value)])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn envelope(most: usize, samples: &[(i64, f64)]) -> Envelope {
        let mut envelope = Envelope::new(most, 2);
        for (number, (time_ns, value)) in (0..).zip(samples) {
            let held = Some(usize::from(number % 3 == 0));
            let values = [Some(*value), None];
            envelope.include(&Input { time_ns: *time_ns, line: number, values: &values, held });
        }
        envelope
    }

    proptest! {
        /// Whatever the rate of the samples: within its room, nothing lower or higher is lost, and the points kept are
        /// samples, in order.
        #[test]
        fn extremes_are_kept(
            steps in prop::collection::vec((prop_oneof![0..5_i64, 0..1_000_000_i64, 0..1_000_000_000_000_i64], -1.0..1.0_f64), 1..400),
            most in 2..40_usize,
        ) {
            let mut time_ns = 7;
            let samples: Vec<_> = steps.iter().map(|(step, value)| {
                time_ns += step;
                (time_ns, *value)
            }).collect();
            let envelope = envelope(most, &samples);
            prop_assert!(envelope.columns().len() <= most);
            let values = samples.iter().map(|(_, value)| *value);
            let extremes = [values.clone().fold(1.0, f64::min), values.fold(-1.0, f64::max)];
            prop_assert_eq!(envelope.range(0), Some(extremes));
            let curve = envelope.curve(0);
            prop_assert_eq!(curve.len(), 1);
            for at in &curve[0] {
                prop_assert!(samples.contains(&(at.time_ns, at.value)));
            }
            prop_assert!(curve[0].is_sorted_by_key(|at| at.time_ns));
            prop_assert_eq!(curve[0][0].time_ns, samples[0].0);
            prop_assert_eq!(envelope.span_ns(), Some([samples[0].0, samples.last().unwrap().0]));
            // Each column has the extremes of its samples.
            for column in envelope.columns() {
                let inside = samples.iter().filter(|(time, _)| (column.begin_ns..=column.end_ns).contains(time));
                let strand = column.strands[0].unwrap();
                for (_, value) in inside {
                    prop_assert!(strand.low.value <= *value && *value <= strand.high.value);
                }
            }
            let held: i64 = envelope.columns().iter().flat_map(|column| &column.held_ns).sum();
            prop_assert_eq!(held, samples.last().unwrap().0 - samples[0].0);
            prop_assert!(envelope.curve(1).is_empty() && envelope.range(1).is_none());
        }
    }

    /// Hours at 1 kHz: a column is no wider than twice what it must be.
    #[test]
    fn long_programs_fill_the_page() {
        let mut envelope = Envelope::new(1800, 0);
        for number in 0..3_000_000_i32 {
            let value = if number == 1_234_567 { 5.0 } else { f64::from(number % 10) * 0.1 };
            let time_ns = i64::from(number) * 1_000_000;
            envelope.include(&Input { time_ns, line: 1, values: &[Some(value)], held: None });
        }
        assert!((900..=1800).contains(&envelope.columns().len()));
        let spike = envelope.curve(0).concat().into_iter().find(|at| at.value > 4.0).unwrap();
        assert_eq!(spike.time_ns, 1_234_567 * 1_000_000);
    }
}
