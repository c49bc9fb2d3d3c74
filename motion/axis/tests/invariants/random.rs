//! Reproducible random numbers.

use super::*;

/// The same in every run (splitmix64).
pub(in crate::tests) struct Random(pub(in crate::tests) u64);

impl Random {
    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut it = self.0;
        it = (it ^ (it >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        it = (it ^ (it >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        it ^ (it >> 31)
    }

    /// In [from, to).
    pub(in crate::tests) fn between(&mut self, from: f64, to: f64) -> f64 {
        let part = u32::try_from(self.next() >> 32).unwrap();
        from + (to - from) * f64::from(part) / (f64::from(u32::MAX) + 1.0)
    }

    /// One time in `count`.
    pub(super) fn one_in(&mut self, count: u64) -> bool {
        self.next().is_multiple_of(count)
    }

    /// One of some things.
    pub(super) fn one_of<T: Copy>(&mut self, things: &[T]) -> T {
        let count = u64::try_from(things.len()).unwrap();
        things[usize::try_from(self.next() % count).unwrap()]
    }

    pub(super) fn direction(&mut self) -> Direction {
        use Direction::{Current, Fastest, Negative, Positive, Shortest};
        self.one_of(&[Negative, Shortest, Positive, Current, Fastest])
    }
}
