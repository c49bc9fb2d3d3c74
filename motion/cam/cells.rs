//! Piece lookup of a curve: finds the piece of a master position in constant time without data-dependent branches.
//!
//! Each of the equal cells stores the number of pieces that begin before it. The cell of a master is a monotone
//! function of its position, in floating-point numbers too: a piece that begins in an earlier cell begins before the
//! master, one in a later cell behind it. So only the pieces that begin in the master's own cell need a comparison, and
//! nothing depends on rounding.

/// The fewest cells a curve may have for its pieces.
const CELLS_PER_PIECE: usize = 8;

/// Number of cells that a curve may always have, however few its pieces: 16 kB.
const CELLS: usize = 4096;

/// The begins of pieces, found by cells.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cells {
    start: f64,
    per_unit: f64,
    /// For each cell the last piece that begins before it, or the first one.
    first: Box<[u32]>,
    /// Where pieces begin, and behind them as many infinities as a search may look at.
    begins: Box<[f64]>,
    /// The first step of the search through a cell, a power of two; 0 if no cell has to be searched.
    step: usize,
}

impl Cells {
    /// For pieces that begin at `begins`, ascending, the last one of which ends at `end`.
    pub(super) fn new(begins: &[f64], end: f64) -> Self {
        let start = begins.first().copied().unwrap_or_default();
        let ends = begins.iter().skip(1).chain([&end]);
        let least = begins.iter().zip(ends).map(|(begin, end)| end - begin);
        let least = least.fold(f64::INFINITY, f64::min);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates, and is limited at once"
        )]
        let wanted = ((end - start) / least).ceil() as usize;
        let pieces = begins.len().max(1);
        let count = wanted.clamp(pieces, (CELLS_PER_PIECE * pieces).max(CELLS));
        #[expect(clippy::cast_precision_loss, reason = "2^27 at most")]
        let per_unit = count as f64 / (end - start);
        let mut cells =
            Self { start, per_unit, first: vec![0; count].into(), begins: Box::default(), step: 0 };
        let (mut most, mut here, mut last) = (0_usize, 0_usize, usize::MAX);
        for (index, begin) in begins.iter().enumerate().skip(1) {
            let cell = cells.cell(*begin);
            here = if cell == last { here + 1 } else { 1 };
            (most, last) = (most.max(here), cell);
            if let (Some(slot), Ok(index)) = (cells.first.get_mut(cell + 1), u32::try_from(index)) {
                *slot = index;
            }
        }
        // What no piece begins in goes on with what began before.
        let mut before = 0;
        for slot in &mut cells.first {
            before = before.max(*slot);
            *slot = before;
        }
        cells.step = if most == 0 { 0 } else { (most + 1).next_power_of_two() / 2 };
        let beyond = std::iter::repeat_n(f64::INFINITY, 2 * cells.step + 1);
        cells.begins = begins.iter().copied().chain(beyond).collect();
        cells
    }

    #[inline]
    fn cell(&self, master: f64) -> usize {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates, and stays monotone"
        )]
        let cell = ((master - self.start) * self.per_unit) as usize;
        cell.min(self.first.len().saturating_sub(1))
    }

    /// The last piece that begins at `master` or before it; the first one if there is none.
    #[inline]
    pub(super) fn piece(&self, master: f64) -> usize {
        let mut index = self.first.get(self.cell(master)).map_or(0, |first| *first as usize);
        let mut step = self.step;
        while step > 0 {
            let begins = self.begins.get(index + step).copied().unwrap_or(f64::INFINITY);
            // Counts instead of branching: masters come in any order.
            index += step * usize::from(begins <= master);
            step /= 2;
        }
        index
    }
}

#[cfg(test)]
mod tests {
    use super::Cells;
    use proptest::prelude::*;

    proptest! {
        /// The piece that counting finds, on the begins, a rounding off them and anywhere, however uneven pieces are and
        /// wherever on the axis they lie.
        #[test]
        fn the_piece_is_the_one_that_counting_finds(
            widths in prop::collection::vec(prop_oneof![1e-9..1e-6_f64, 1e-3..1.0_f64, 1.0..1e3_f64], 1..60),
            start in prop_oneof![Just(0.0), -1e3..1e3_f64, -1e12..1e12_f64],
            shares in prop::collection::vec(-0.1..1.1_f64, 50),
        ) {
            let mut begins = vec![start];
            for width in widths {
                let before = begins[begins.len() - 1];
                if before + width > before {
                    begins.push(before + width);
                }
            }
            prop_assume!(begins.len() > 1);
            let end = begins.pop().expect("two at least");
            let cells = Cells::new(&begins, end);
            let anywhere = shares.iter().map(|share| start + share * (end - start));
            let near = begins.iter().chain([&end]).flat_map(|at| [at.next_down(), *at, at.next_up()]);
            for master in anywhere.chain(near).collect::<Vec<_>>() {
                let counted = begins.partition_point(|begin| *begin <= master).max(1) - 1;
                prop_assert_eq!(cells.piece(master), counted, "{} of {:?}", master, begins);
            }
        }
    }
}
