//! Run observer of the command line: shows progress and passes on the user's input.

use super::axis_watch::AxisWatch;
use super::keys::{self, Keys};
use super::prompt::Prompt;
use crate::command::progress::ProgressLines;
use crate::hardware::Heard;
use crate::live_view::Picture;
use crate::m_function::MCall;
use crate::program::ProgramFile;
use crate::program::inputs::Steps;
use crate::session::{Answer, DriveSample, Observer, TwinCycle};
use indicatif::ProgressBar;
use twin_path::Place;

/// Shows a run while it goes on.
pub(super) struct Watcher<'a, 'm> {
    pub(super) picture: &'a mut Picture<'m>,
    pub(super) bar: &'a ProgressBar,
    pub(super) lines: ProgressLines,
    pub(super) axes: AxisWatch<'m>,
    pub(super) last_shown_ns: i64,
    /// Largest distance of the tool of the drives from its set-point since then, mm.
    pub(super) drive_error: Option<f64>,
    pub(super) samples: Heard,
    pub(super) prompt: Prompt,
    /// Override keys, on a terminal.
    pub(super) keys: Option<Keys>,
    /// True if the plan knows single step and waits: the controller's own.
    pub(super) stepping: bool,
}

/// Without them the run goes on.
pub(super) fn open_keys(program: &ProgramFile, stepping: bool) -> Option<Keys> {
    match Keys::open(program.settings().inputs.override_factor.factor()) {
        Ok(keys) => {
            if keys.is_some() {
                stderr!("{}", keys::HELP);
                if stepping {
                    stderr!("{}", keys::STEPS_HELP);
                }
            }
            keys
        }
        Err(error) => {
            stderr!("note: the terminal gives no single keys ({error}): the override stays");
            None
        }
    }
}

impl Observer for Watcher<'_, '_> {
    fn twin(&mut self, cycle: &TwinCycle<'_>) {
        self.picture.twin(cycle);
        self.axes.twin(cycle);
        let time_ns = cycle.setpoint.time_ns;
        if time_ns.saturating_sub(self.last_shown_ns) >= 100_000_000 {
            self.last_shown_ns = time_ns;
            let done = u64::try_from(time_ns / 1_000_000).unwrap_or(0);
            self.bar.set_position(done);
            self.lines.set(done, self.bar.length().unwrap_or(0));
            let error = (cycle.twin.tool - cycle.wanted.tool).norm() * 1e3;
            let drives = self.drive_error.take();
            let drives = drives.map_or(String::new(), |error| format!(", drives {error:.3} mm"));
            self.bar
                .set_message(format!("{}  twin {error:.3} mm off{drives}", cycle.setpoint.place));
        }
    }

    fn happened(&mut self, time_ns: i64, place: Place, what: &str) {
        self.picture.happened(time_ns, place.line, what);
    }

    fn m_function(&mut self, call: &MCall, asked: bool) {
        let place = call.place;
        if asked {
            self.bar.suspend(|| stderr!("{call} at {place}: press Enter when it is done"));
            if let Some(keys) = &mut self.keys {
                keys.ask();
            } else if let Err(error) = self.prompt.ask() {
                self.bar.suspend(|| stderr!("standard input cannot be read: {error}"));
            }
        }
        self.bar.set_message(format!("{place}  {call}"));
    }

    fn answer(&mut self) -> Answer {
        match &mut self.keys {
            Some(keys) => keys.answer(),
            None => self.prompt.answer(),
        }
    }

    fn new_override(&mut self) -> Option<f64> {
        let factor = self.keys.as_mut()?.new_override()?;
        let text = if factor > 0.0 {
            format!("override {:.0} %", factor * 100.0)
        } else {
            "the path is held".to_owned()
        };
        self.bar.suspend(|| stderr!("{text}"));
        Some(factor)
    }

    fn new_steps(&mut self) -> Option<Steps> {
        let steps = self.keys.as_mut()?.new_steps().filter(|_| self.stepping)?;
        let Steps { single_step, wait_at_next_stop } = steps;
        let on = |on: bool| if on { "on" } else { "off" };
        self.bar.suspend(|| {
            stderr!(
                "single step {}, wait at the next stop {}",
                on(single_step),
                on(wait_at_next_stop)
            );
        });
        Some(steps)
    }

    fn drives(&mut self, sample: &DriveSample<'_>) {
        self.samples.include(sample.time_ns);
        let error = (sample.drives.tool - sample.wanted.tool).norm() * 1e3;
        self.drive_error = Some(self.drive_error.map_or(error, |largest| largest.max(error)));
        self.picture.drives(sample);
        self.axes.drives(sample);
    }
}
