//! Values of a scaling and an offset that are allowed together.
//!
//! Everything that is asked of the two is linear in them. So the offset is eliminated (Fourier and Motzkin): what is left
//! says exactly how large the scaling may be, and which two demands say so.

use super::Bound;

/// `scaling` · a + `offset` · b ≤ `most`.
#[derive(Clone, Copy, Debug)]
struct Row {
    scaling: f64,
    offset: f64,
    most: f64,
    bound: Bound,
}

/// The least or the greatest value, and what it is held by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::cam::tune) struct End {
    pub(in crate::cam::tune) value: f64,
    pub(in crate::cam::tune) by: [Option<Bound>; 2],
}

/// Pairs of scaling and offset.
#[derive(Clone, Debug, Default)]
pub(in crate::cam::tune) struct Region {
    rows: Vec<Row>,
}

/// Of what is added up, this part is rounding.
const ROUNDING: f64 = 1e-13;

impl Region {
    /// Demands that `scaling` · a + `offset` · b lies between two values, infinite where it may be anything.
    pub(in crate::cam::tune) fn between(
        &mut self,
        [scaling, offset]: [f64; 2],
        ends: [(f64, Bound); 2],
    ) -> &mut Self {
        let [(low, below), (high, above)] = ends;
        if high < f64::INFINITY {
            self.rows.push(Row { scaling, offset, most: high, bound: above });
        }
        if low > f64::NEG_INFINITY {
            let (scaling, offset) = (-scaling, -offset);
            self.rows.push(Row { scaling, offset, most: -low, bound: below });
        }
        self
    }

    /// Every demand: `scaling` and `offset`, what their sum is at most, and what demands it.
    pub(in crate::cam::tune) fn demands(&self) -> impl Iterator<Item = ([f64; 2], f64, Bound)> {
        self.rows.iter().map(|row| ([row.scaling, row.offset], row.most, row.bound))
    }

    /// Least and greatest scaling with which there is an offset; the least is above the greatest if there is none.
    pub(in crate::cam::tune) fn scalings(&self) -> [End; 2] {
        let alone = |row: &Row| row.offset == 0.0;
        let mut ends = Ends::new();
        for row in self.rows.iter().filter(|row| alone(row)) {
            ends.take(row.scaling, row.most, row.most.abs(), [Some(row.bound), None]);
        }
        for upper in self.rows.iter().filter(|row| row.offset > 0.0) {
            for lower in self.rows.iter().filter(|row| row.offset < 0.0) {
                // Each by what makes the offsets cancel.
                let (one, other) = (-lower.offset, upper.offset);
                let terms = [upper.scaling * one, lower.scaling * other];
                let by = terms[0] + terms[1];
                let size = terms[0].abs() + terms[1].abs();
                let by = if by.abs() <= ROUNDING * size { 0.0 } else { by };
                let sides = [upper.most * one, lower.most * other];
                let size = sides[0].abs() + sides[1].abs();
                ends.take(by, sides[0] + sides[1], size, [Some(upper.bound), Some(lower.bound)]);
            }
        }
        ends.found
    }

    /// Least and greatest offset with a scaling.
    pub(in crate::cam::tune) fn offsets(&self, scaling: f64) -> [End; 2] {
        let mut ends = Ends::new();
        for row in self.rows.iter().filter(|row| row.offset != 0.0) {
            let term = row.scaling * scaling;
            let size = row.most.abs() + term.abs();
            ends.take(row.offset, row.most - term, size, [Some(row.bound), None]);
        }
        ends.found
    }
}

struct Ends {
    found: [End; 2],
}

impl Ends {
    fn new() -> Self {
        Self { found: [f64::NEG_INFINITY, f64::INFINITY].map(|value| End { value, by: [None; 2] }) }
    }

    /// value · `by` ≤ `most`, which is a sum of terms as large as `size`.
    fn take(&mut self, by: f64, most: f64, size: f64, bounds: [Option<Bound>; 2]) {
        let [least, greatest] = &mut self.found;
        let end = End { value: most / by, by: bounds };
        if by > 0.0 {
            if end.value < greatest.value {
                *greatest = end;
            }
        } else if by < 0.0 {
            if end.value > least.value {
                *least = end;
            }
        } else if most < -ROUNDING * size {
            // Whatever the value.
            *least = End { value: f64::INFINITY, by: bounds };
            *greatest = End { value: f64::NEG_INFINITY, by: bounds };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Bound, Region};

    /// A tappet at 50 and one at 200 may move by 2 either way: 50 = m·s + o with |m − 50| ≤ 2 and 200 = m·s + o with |m − 200| ≤
    /// 2. Over 150 the master goes 154 at most and 146 at least, so that the scaling lies between 150/154 and 150/146.
    #[test]
    fn two_tappets_hold_a_scaling() {
        let mut region = Region::default();
        for place in [50.0, 200.0] {
            let bound = Bound::Tappet { place };
            region.between([place + 2.0, 1.0], [(place, bound), (f64::INFINITY, bound)]);
            region.between([place - 2.0, 1.0], [(f64::NEG_INFINITY, bound), (place, bound)]);
        }
        let [least, greatest] = region.scalings();
        assert!((least.value - 150.0 / 154.0).abs() < 1e-12, "{least:?}");
        assert!((greatest.value - 150.0 / 146.0).abs() < 1e-12, "{greatest:?}");
        assert!(least.by.iter().flatten().count() == 2, "{least:?}");
        // There the offset is one: 50 = 48·s + o.
        let [low, high] = region.offsets(least.value);
        let offset = 50.0 - 48.0 * 150.0 / 154.0;
        assert!((low.value - offset).abs() < 1e-9 && (high.value - offset).abs() < 1e-9);
    }

    #[test]
    fn what_contradicts_leaves_nothing() {
        let mut region = Region::default();
        let bound = Bound::Stroke;
        region.between([0.0, 1.0], [(3.0, bound), (4.0, bound)]);
        region.between([0.0, 1.0], [(5.0, Bound::Given), (6.0, bound)]);
        let [least, greatest] = region.scalings();
        assert!(least.value > greatest.value, "{least:?} {greatest:?}");
        assert!(least.by.contains(&Some(Bound::Given)), "{least:?}");
    }
}
