//! Saved modal state (M70 to M73), override switches (M48 to M53), and the words that restore them.
//!
//! Each subroutine, and the program itself, has one place for a saved state. Saved are units, feed mode and F, S, plane,
//! distance modes, coordinate system, tool length offset, cutter radius compensation, whether G92 applies, path control,
//! retract mode, spindle, coolant and overrides; motion, tool, positions and offsets are not.

use super::block::{Block, Letter};
use super::error::{DecodeError, Problem};
use super::options::PathMode;
use super::output::Output;
use super::spindle::SurfaceSpeed;
use super::state::{Feed, State};
use super::word::{Compensate, GWords, MWords, OneShot, ToolLength};

/// Switches of the machine that the program may turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "four switches")]
pub(super) struct Overrides {
    /// Feed override (M48, M49, M50).
    pub(super) feed: bool,
    /// Spindle override (M48, M49, M51).
    pub(super) spindle: bool,
    /// Adaptive feed (M52).
    pub(super) adaptive: bool,
    /// Feed hold (M53).
    pub(super) hold: bool,
}

impl Default for Overrides {
    fn default() -> Self {
        Self { feed: true, spindle: true, adaptive: false, hold: true }
    }
}

/// Modal state of a moment.
#[derive(Clone, Debug)]
pub(super) struct Modes {
    /// The word in force of each group that is restored.
    words: GWords,
    path_mode: PathMode,
    feed: Option<Feed>,
    feed_word: f64,
    speed: Option<f64>,
    spindle: Option<u16>,
    surface_speed: Option<SurfaceSpeed>,
    diameters: bool,
    coolant: [bool; 2],
    overrides: Overrides,
}

/// Place of a subroutine for a saved state.
#[derive(Clone, Debug, Default)]
pub(super) struct Saved {
    modes: Option<Modes>,
    /// Restored when the subroutine ends (M73).
    on_return: bool,
}

impl State {
    /// The current modal state.
    pub(super) fn save_modes(&self) -> Modes {
        Modes {
            words: GWords {
                plane: Some(self.plane),
                parallel_plane: Some(self.parallel_plane),
                units: Some(self.units),
                compensation: Some(self.compensation_word()),
                g92_switch: Some(self.g92_word()),
                tool_length: Some(self.tool_length()),
                system: Some(self.offsets.system()),
                relative: Some(self.relative),
                absolute_centers: Some(self.absolute_centers),
                feed_mode: Some(self.feed_mode),
                initial_level: Some(self.initial_level),
                ..GWords::default()
            },
            path_mode: self.path_mode,
            feed: self.feed,
            feed_word: self.feed_word,
            speed: self.speed,
            spindle: self.spindle,
            surface_speed: self.surface_speed,
            diameters: self.diameters,
            coolant: self.coolant,
            overrides: self.overrides,
        }
    }

    /// G40, or G41 or G42 with the tool in the spindle.
    fn compensation_word(&self) -> Compensate {
        let left = self.compensation_number() < 420.0;
        if self.compensation_is_on() { Compensate::Tool { left } } else { Compensate::Off }
    }

    fn g92_word(&self) -> OneShot {
        let applies = self.offsets.parameter(5210).is_some_and(|applies| applies > 0.0);
        if applies { OneShot::RestoreOffset } else { OneShot::SuspendOffset }
    }

    fn tool_length(&self) -> ToolLength {
        if self.offsets.has_tool_length() { ToolLength::Table } else { ToolLength::Off }
    }

    /// Executes the words that lead back to `saved`; those that do something even if they are in force are left out then.
    ///
    /// # Errors
    /// Those of the words.
    pub(super) fn restore_modes(&mut self, saved: &Modes, out: &mut Output) -> Result<(), Problem> {
        let (to, now) = (saved.words, self.save_modes().words);
        let g = GWords {
            compensation: changed(to.compensation, now.compensation),
            g92_switch: changed(to.g92_switch, now.g92_switch),
            tool_length: changed(to.tool_length, now.tool_length),
            system: changed(to.system, now.system),
            feed_mode: changed(to.feed_mode, now.feed_mode),
            initial_level: changed(to.initial_level, now.initial_level),
            ..to
        };
        (self.speed, self.surface_speed) = (saved.speed, saved.surface_speed);
        self.diameters = saved.diameters;
        let spindle = changed(Some(saved.spindle), Some(self.spindle));
        let m = MWords { spindle: spindle.map(|m| m.unwrap_or(5)), ..MWords::default() };
        let mut block = Block::default();
        (block.g, block.m) = (g, m);
        self.execute(&block, out)?;
        (self.feed, self.feed_word) = (saved.feed, saved.feed_word);
        (self.path_mode, self.overrides) = (saved.path_mode, saved.overrides);
        if self.coolant.iter().zip(saved.coolant).any(|(now, then)| *now && !then) {
            self.set_coolant(9, out);
        }
        for ((then, now), m) in saved.coolant.into_iter().zip(self.coolant).zip(7..) {
            if then && !now {
                self.set_coolant(m, out);
            }
        }
        Ok(())
    }

    /// M70 to M73.
    ///
    /// # Errors
    /// [`DecodeError::NoSavedModes`], [`DecodeError::WordsWithRestore`] and those of the restored words.
    pub(super) fn keep_modes(&mut self, block: &Block, out: &mut Output) -> Result<(), Problem> {
        let Some(number) = block.m.modes else { return Ok(()) };
        let depth = self.parameters.depth();
        if number == 72 && !block.is_single_m() {
            return Err(DecodeError::WordsWithRestore.into());
        }
        match number {
            70 | 73 => {
                let saved = Saved { modes: Some(self.save_modes()), on_return: number == 73 };
                self.saved.resize_with(depth, Saved::default);
                self.saved.push(saved);
            }
            71 => self.saved.truncate(depth),
            _ => {
                let modes = self.saved.get(depth).and_then(|saved| saved.modes.clone());
                self.restore_modes(&modes.ok_or(DecodeError::NoSavedModes)?, out)?;
            }
        }
        Ok(())
    }

    /// Restores the state that M73 has saved in the subroutine that ends, before its parameters are left.
    ///
    /// # Errors
    /// Those of the restored words.
    pub(super) fn return_modes(&mut self, out: &mut Output) -> Result<(), Problem> {
        let depth = self.parameters.depth();
        let saved = self.saved.get_mut(depth).map(std::mem::take).filter(|saved| saved.on_return);
        self.saved.truncate(depth);
        match saved.and_then(|saved| saved.modes) {
            Some(modes) => self.restore_modes(&modes, out),
            None => Ok(()),
        }
    }

    /// M48 to M53: P0 switches off, any other P and none switch on.
    pub(super) fn set_overrides(&mut self, block: &Block) {
        let on = block.get(Letter::P).is_none_or(|p| p != 0.0);
        let overrides = &mut self.overrides;
        match block.m.overrides {
            Some(48) => (overrides.feed, overrides.spindle) = (true, true),
            Some(49) => (overrides.feed, overrides.spindle) = (false, false),
            Some(50) => overrides.feed = on,
            Some(51) => overrides.spindle = on,
            Some(52) => overrides.adaptive = on,
            Some(53) => overrides.hold = on,
            _ => {}
        }
    }

    /// M7 to M9.
    pub(super) fn set_coolant(&mut self, number: u16, out: &mut Output) {
        match number {
            7 => self.coolant[0] = true,
            8 => self.coolant[1] = true,
            _ => self.coolant = [false; 2],
        }
        self.m_function(number, None, out);
    }
}

/// The saved word of a group, unless it is in force.
fn changed<T: Copy + PartialEq>(saved: Option<T>, now: Option<T>) -> Option<T> {
    saved.filter(|_| saved != now)
}
