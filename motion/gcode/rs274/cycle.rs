//! Canned cycles: G73, G74 and G81 to G89 as the moves LinuxCNC makes of them.
//!
//! ```text
//! initial level   where the tool was before the first cycle of a row
//! R               retract plane: clear of the work; with G91 counted from the initial level
//! bottom          Z in G17; with G91 counted from R
//! clear level     R (G99), or the initial level if that is higher (G98)
//! ```
//!
//! Words may be left out where the same cycle is in force. Their numbers, also that of the initial level, hold in the
//! units of the block: after G20 they are inches, as in LinuxCNC.
//!
//! If the initial level is below R, the tool first goes up to R. Then for each repetition: a rapid in the plane (at
//! R, or at the current height if that is above), a rapid down to R, and the [`steps`] of the cycle.

use super::LengthUnit;
use super::block::{Block, Letter, Letters};
use super::error::{DecodeError, Problem};
use super::output::Output;
use super::state::State;
use super::travel::Axis;
use super::word::{Cycle, FeedMode, Motion};

/// The largest number of moves that one block with a canned cycle may lead to.
pub const MAX_CYCLE_MOVES: usize = 10_000;

/// Canned cycles in a row: the words that hold until another number takes their place, in program units.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Series {
    /// The cycle in force, whose words may be left out.
    pub(super) cycle: Option<Cycle>,
    /// Coordinate along the normal before the first of the row.
    pub(super) initial: Option<f64>,
    retract: f64,
    bottom: f64,
    dwell: f64,
    peck: f64,
    /// I, J and K of G87.
    center: [f64; 3],
}

/// A height of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Level {
    Bottom,
    /// Top of the bore of G87.
    Middle,
    Retract,
    Clear,
}

/// A part of a cycle at one hole.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Feed(Level),
    Rapid(Level),
    /// Feeds by Q until the bottom is less than Q away, each with a rapid back: to R and down again, or a little up.
    Peck {
        to_retract: bool,
    },
    /// Rapid in the plane: away from the hole by the offset of G87, or back to it.
    Aside(bool),
    Dwell,
    /// The spindle stops.
    Stop,
    /// The spindle stops at angle 0.
    Orient,
    /// The spindle turns as before the cycle.
    Start,
    /// The spindle turns the other way.
    Reverse,
    /// M0.
    Pause,
}

/// The steps of a cycle from R to the clear level.
fn steps(cycle: Cycle) -> &'static [Step] {
    use Level::{Bottom, Clear, Middle, Retract};
    use Step::{Aside, Dwell, Feed, Orient, Pause, Peck, Rapid, Reverse, Start, Stop};
    match cycle.0 {
        73 => &[Peck { to_retract: false }, Feed(Bottom), Rapid(Clear)],
        74 | 84 => &[Feed(Bottom), Stop, Reverse, Dwell, Feed(Clear), Stop, Start],
        82 => &[Feed(Bottom), Dwell, Rapid(Clear)],
        83 => &[Peck { to_retract: true }, Feed(Bottom), Rapid(Clear)],
        85 => &[Feed(Bottom), Feed(Retract), Rapid(Clear)],
        86 => &[Feed(Bottom), Dwell, Stop, Rapid(Clear), Start],
        87 => &[
            Aside(true),
            Stop,
            Orient,
            Rapid(Bottom),
            Aside(false),
            Start,
            Feed(Middle),
            Feed(Bottom),
            Stop,
            Orient,
            Aside(true),
            Rapid(Clear),
            Aside(false),
            Start,
        ],
        88 => &[Feed(Bottom), Dwell, Stop, Pause, Start, Rapid(Clear)],
        89 => &[Feed(Bottom), Dwell, Feed(Clear)],
        _ => &[Feed(Bottom), Rapid(Clear)],
    }
}

impl Cycle {
    fn has(self, step: Step) -> bool {
        steps(self).contains(&step)
    }

    fn pecks(self) -> bool {
        matches!(self.0, 73 | 83)
    }

    /// Tapping with a floating chuck.
    pub(super) fn taps(self) -> bool {
        self.has(Step::Reverse)
    }

    /// The words of the cycle other than those of axes.
    pub(super) fn words(self) -> Letters {
        let mut words = Letters::of("R");
        let mut takes = |is_so: bool, letters: &str| {
            if is_so {
                words = words.with(Letters::of(letters));
            }
        };
        // LinuxCNC's tables of words leave out G74.
        takes(self.0 != 74, "L");
        takes(self.has(Step::Dwell), "P");
        takes(self.pecks(), "Q");
        takes(self.has(Step::Aside(true)), "IJK");
        words
    }

    /// M3 and M4 with which the spindle may turn; none if it may be off.
    fn spindle(self) -> &'static [u16] {
        match self.0 {
            74 => &[4],
            84 => &[3],
            _ if self.has(Step::Stop) => &[3, 4],
            _ => &[],
        }
    }
}

/// Heights and place of a hole in program units.
struct Hole {
    axes: [Axis; 3],
    series: Series,
    /// First and second coordinate in the plane.
    at: [f64; 2],
    retract: f64,
    bottom: f64,
    middle: f64,
    clear: f64,
    /// M3 or M4 before the cycle.
    spindle: Option<u16>,
}

impl Hole {
    fn height(&self, level: Level) -> f64 {
        match level {
            Level::Bottom => self.bottom,
            Level::Middle => self.middle,
            Level::Retract => self.retract,
            Level::Clear => self.clear,
        }
    }
}

impl State {
    /// G73, G74 and G81 to G89.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    pub(super) fn run_cycle(
        &mut self,
        cycle: Cycle,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let axes = self.axes();
        let [first, second, normal] = axes;
        let height = |state: &Self| state.location.program[normal.index];
        let series = self.row(cycle, block, axes)?;
        let repeats = block.whole(Letter::L, 1)?.unwrap_or(1);
        if self.feed_mode == FeedMode::InverseTime {
            return Err(DecodeError::InverseTimeCycle.into());
        }
        if !cycle.spindle().is_empty() {
            self.check_spindle(Motion::Cycle(cycle), cycle.spindle())?;
        }
        let initial = series.initial.unwrap_or_else(|| height(self));
        let (mut retract, mut bottom) = (series.retract, series.bottom);
        let mut middle = series.center[normal.index % 3];
        if self.relative {
            retract += initial;
            bottom += retract;
            middle += bottom;
        }
        if retract < bottom {
            return Err(DecodeError::RetractBelowBottom { retract, bottom }.into());
        }
        let pecks = if cycle.pecks() { (retract - bottom) / series.peck } else { 0.0 };
        check_count(cycle, repeats, pecks)?;
        self.series = Series { initial: Some(initial), ..series };

        if initial < retract {
            let up = self.with(&self.location, normal, retract)?;
            // The other coordinates come next.
            let words = self.words;
            self.words.named = std::array::from_fn(|axis| axis == normal.index);
            self.rapid(up, out);
            self.words = words;
        }
        let clear = if self.initial_level { initial.max(retract) } else { retract };
        let at = [first, second].map(|axis| self.location.program[axis.index]);
        let spindle = self.spindle;
        let mut hole = Hole { axes, series, at, retract, bottom, middle, clear, spindle };
        for _ in 0..repeats {
            let level = if height(self) > retract { height(self) } else { clear };
            for (at, axis) in hole.at.iter_mut().zip([first, second]) {
                let Some(word) = block.get(axis.letter) else { continue };
                *at = if self.relative { *at + word } else { word };
            }
            let mut above = self.with(&self.location, first, hole.at[0])?;
            above = self.with(&above, second, hole.at[1])?;
            above = self.with(&above, normal, level)?;
            self.rapid(above, out);
            if height(self) != retract {
                self.rapid(self.with(&above, normal, retract)?, out);
            }
            for step in steps(cycle) {
                self.run_step(*step, &hole, out)?;
            }
        }
        Ok(())
    }

    fn run_step(&mut self, step: Step, hole: &Hole, out: &mut Output) -> Result<(), Problem> {
        let [first, second, normal] = hole.axes;
        let at = |state: &Self, height| state.with(&state.location, normal, height);
        match step {
            Step::Feed(level) => self.feed_to(at(self, hole.height(level))?, out)?,
            Step::Rapid(level) => self.rapid(at(self, hole.height(level))?, out),
            Step::Peck { to_retract } => {
                let clearance = match self.units {
                    LengthUnit::Millimetre => 0.254,
                    LengthUnit::Inch => 0.010,
                };
                // Added up as LinuxCNC does: rounding decides whether there is a last, empty peck.
                let mut depth = hole.retract - hole.series.peck;
                while depth > hole.bottom {
                    self.feed_to(at(self, depth)?, out)?;
                    if to_retract {
                        self.rapid(at(self, hole.retract)?, out);
                    }
                    self.rapid(at(self, depth + clearance)?, out);
                    depth -= hole.series.peck;
                }
            }
            Step::Aside(away) => {
                let mut to = self.location;
                for (axis, at) in [first, second].into_iter().zip(hole.at) {
                    let offset = if away { hole.series.center[axis.index % 3] } else { 0.0 };
                    to = self.with(&to, axis, at + offset)?;
                }
                self.rapid(to, out);
            }
            Step::Dwell => self.dwell(hole.series.dwell, out)?,
            Step::Stop => self.stop_spindle(out),
            Step::Orient => self.orient_spindle(0.0, None, out),
            Step::Start | Step::Reverse => {
                if let Some(number) = hole.spindle {
                    let turned = if step == Step::Reverse { 7 - number } else { number };
                    self.start_spindle(turned, 1.0, out);
                }
            }
            Step::Pause => self.m_function(0, None, out),
        }
        Ok(())
    }

    /// The numbers of a cycle: those of `block` and, for the cycle that was in force already, the ones before.
    fn row(&self, cycle: Cycle, block: &Block, axes: [Axis; 3]) -> Result<Series, Problem> {
        let mut series = self.series;
        let motion = Motion::Cycle(cycle).number();
        let goes_on = series.cycle == Some(cycle);
        let word = |letter: Letter, before: &mut f64, optional: bool| {
            match block.get(letter) {
                Some(value) => *before = value,
                None if goes_on || optional => {}
                None => return Err(DecodeError::missing(format!("G{motion}"), letter.as_char())),
            }
            Ok(())
        };
        series.cycle = Some(cycle);
        word(Letter::R, &mut series.retract, false)?;
        word(axes[2].letter, &mut series.bottom, false)?;
        if cycle.has(Step::Dwell) {
            // As in LinuxCNC P of tapping may be that of any cycle before.
            word(Letter::P, &mut series.dwell, cycle.taps())?;
            Self::dwell_ns(series.dwell)?;
        }
        if cycle.pecks() {
            word(Letter::Q, &mut series.peck, false)?;
            block.check_above(&format!("G{motion}"), Letter::Q, series.peck, 0.0)?;
        }
        if cycle.has(Step::Aside(true)) {
            for (letter, before) in Letter::CENTER.into_iter().zip(&mut series.center) {
                word(letter, before, false)?;
            }
        }
        Ok(series)
    }
}

/// Checks that `repeats` holes of `pecks` pecks each are few enough.
fn check_count(cycle: Cycle, repeats: u32, pecks: f64) -> Result<(), DecodeError> {
    let limit = MAX_CYCLE_MOVES;
    #[expect(clippy::cast_precision_loss, reason = "they are small")]
    let (max, steps) = (limit as f64, steps(cycle).len() as f64);
    let moves = 3.0 + steps + 3.0 * pecks;
    if moves * f64::from(repeats) <= max { Ok(()) } else { Err(DecodeError::EndlessCycle(limit)) }
}
