//! Canned cycles: G81, G82 and G83 as the moves LinuxCNC makes of them.
//!
//! ```text
//! initial level   where the tool was before the first cycle of a row
//! R               retract plane: clear of the work; with G91 counted from the initial level
//! bottom          Z in G17; with G91 counted from R
//! ```
//!
//! If the initial level is below R, the tool first goes up to R. Then for each repetition: a rapid in the plane (at
//! R, or at the height at hand if that is above), a rapid down to R, the hole, and a rapid up to R (G99) or to the
//! initial level if that is higher (G98).

use super::LengthUnit;
use super::block::{Block, Letter};
use super::error::{DecodeError, Problem};
use super::output::Output;
use super::state::State;
use super::word::Cycle;

/// The largest number of moves that one block with a canned cycle may lead to.
pub const MAX_CYCLE_MOVES: usize = 10_000;

/// Canned cycles in a row, in program units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Series {
    cycle: Cycle,
    /// Coordinate along the normal before the first of them.
    pub(super) initial: f64,
    retract: f64,
    bottom: f64,
    dwell: f64,
    peck: f64,
}

impl State {
    /// G81, G82 or G83.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    pub(super) fn drill(
        &mut self,
        cycle: Cycle,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let [first, second, normal] = self.axes();
        let height = |state: &Self| state.location.program[normal.index];
        let series = self.row(cycle, block, height(self), normal.letter)?;
        let repeats = block.whole(Letter::L, 1)?.unwrap_or(1);
        if self.inverse_time {
            return Err(DecodeError::InverseTimeCycle.into());
        }
        let (retract, bottom) = if self.relative {
            let retract = series.retract + series.initial;
            (retract, retract + series.bottom)
        } else {
            (series.retract, series.bottom)
        };
        if retract < bottom {
            return Err(DecodeError::RetractBelowBottom { retract, bottom }.into());
        }
        check_count(cycle, repeats, (retract - bottom) / series.peck)?;
        self.series = Some(series);

        if series.initial < retract {
            let up = self.with(&self.location, normal, retract)?;
            self.rapid(up, out);
        }
        let clear = if self.initial_level { series.initial.max(retract) } else { retract };
        for _ in 0..repeats {
            let level = if height(self) > retract { height(self) } else { clear };
            let mut above = self.location;
            for axis in [first, second] {
                let Some(word) = block.get(axis.letter) else { continue };
                let from = above.program[axis.index];
                above = self.with(&above, axis, if self.relative { from + word } else { word })?;
            }
            above = self.with(&above, normal, level)?;
            self.rapid(above, out);
            let at = |state: &Self, height| state.with(&above, normal, height);
            if height(self) != retract {
                self.rapid(at(self, retract)?, out);
            }
            if cycle == Cycle::Peck {
                let clearance = match self.units {
                    LengthUnit::Millimetre => 0.254,
                    LengthUnit::Inch => 0.010,
                };
                // Added up as LinuxCNC does: rounding decides whether there is a last, empty peck.
                let mut depth = retract - series.peck;
                while depth > bottom {
                    self.feed_to(at(self, depth)?, out)?;
                    self.rapid(at(self, retract)?, out);
                    self.rapid(at(self, depth + clearance)?, out);
                    depth -= series.peck;
                }
            }
            self.feed_to(at(self, bottom)?, out)?;
            if cycle == Cycle::DrillDwell {
                self.dwell(series.dwell, out)?;
            }
            self.rapid(at(self, clear)?, out);
        }
        Ok(())
    }

    /// The numbers of a cycle: those of `block` and, for the cycle that was in force already, the ones before.
    fn row(
        &self,
        cycle: Cycle,
        block: &Block,
        height: f64,
        normal: Letter,
    ) -> Result<Series, DecodeError> {
        let before = self.series.filter(|series| series.cycle == cycle);
        let number = cycle.number();
        let word = |letter: Letter, before: Option<f64>| {
            let missing = DecodeError::MissingCycleWord { cycle: number, letter: letter.as_char() };
            block.get(letter).or(before).ok_or(missing)
        };
        let mut series = Series {
            cycle,
            initial: self.series.map_or(height, |series| series.initial),
            retract: word(Letter::R, before.map(|series| series.retract))?,
            bottom: word(normal, before.map(|series| series.bottom))?,
            dwell: 0.0,
            peck: 0.0,
        };
        match cycle {
            Cycle::Drill => {}
            Cycle::DrillDwell => {
                series.dwell = word(Letter::P, before.map(|series| series.dwell))?;
                State::dwell_ns(series.dwell)?;
            }
            Cycle::Peck => {
                let peck = word(Letter::Q, before.map(|series| series.peck))?;
                if peck <= 0.0 {
                    return Err(DecodeError::NonPositivePeck(peck));
                }
                series.peck = peck;
            }
        }
        Ok(series)
    }
}

/// Checks that `repeats` holes of `pecks` pecks each are few enough.
fn check_count(cycle: Cycle, repeats: u32, pecks: f64) -> Result<(), DecodeError> {
    let limit = MAX_CYCLE_MOVES;
    let moves = if cycle == Cycle::Peck { 4.0 + 3.0 * pecks } else { 5.0 };
    #[expect(clippy::cast_precision_loss, reason = "it is small")]
    let max = limit as f64;
    if moves * f64::from(repeats) <= max { Ok(()) } else { Err(DecodeError::EndlessCycle(limit)) }
}
