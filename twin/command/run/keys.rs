//! Override keys: keyboard control of the override and of the feed hold during a run.

use crate::program::inputs::Steps;
use crate::session::Answer;
use crate::setpoint_source::MOST_OVERRIDE;
use rustix::termios::{
    LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcsetattr,
};
use std::io::{self, IsTerminal, Read};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

/// What a key changes.
const STEP: f64 = 0.1;
/// What is known of keys that nobody has looked at yet.
const KEYS: usize = 64;

/// Help text of the keys.
pub(super) const HELP: &str = "keys: + and - change the override by 10 %, space holds the path and lets it go on, Ctrl-C stops it";

/// Help text of the further keys of the controller's own plan.
pub(super) const STEPS_HELP: &str =
    "keys: s switches single step on and off, n lets the path wait at the next stop and go on";

/// Keys of the terminal, one by one; Ctrl-C stays what it is. The terminal is as it was when this is dropped.
#[derive(Debug)]
pub(super) struct Keys {
    typed: Receiver<u8>,
    before: Termios,
    dial: Dial,
    /// Override that was reported last.
    asked: f64,
    steps: Steps,
    /// Steps that were reported last.
    shown: Steps,
    /// Enter was pressed since the last question.
    entered: bool,
}

impl Keys {
    /// Keys of standard input, with the present override; none if that is not a terminal.
    ///
    /// # Errors
    /// If the terminal refuses, or no thread can be had.
    pub(super) fn open(factor: f64) -> io::Result<Option<Self>> {
        let stdin = io::stdin();
        if !stdin.is_terminal() {
            return Ok(None);
        }
        let before = tcgetattr(&stdin)?;
        let mut single = before.clone();
        single.local_modes -= LocalModes::ICANON | LocalModes::ECHO;
        single.special_codes[SpecialCodeIndex::VMIN] = 1;
        single.special_codes[SpecialCodeIndex::VTIME] = 0;
        tcsetattr(&stdin, OptionalActions::Now, &single)?;
        let (sender, typed) = sync_channel(KEYS);
        let (steps, shown) = (Steps::default(), Steps::default());
        let keys = Self {
            typed,
            before,
            dial: Dial::new(factor),
            asked: factor,
            steps,
            shown,
            entered: false,
        };
        // It ends with the process: nothing can wake it while it waits for a key.
        std::thread::Builder::new().name("keys".to_owned()).spawn(move || {
            for key in io::stdin().lock().bytes() {
                let Ok(key) = key else { return };
                if sender.send(key).is_err() {
                    return;
                }
            }
        })?;
        Ok(Some(keys))
    }

    /// The override that the keys since the last call ask for, if they do.
    pub(super) fn new_override(&mut self) -> Option<f64> {
        while let Ok(key) = self.typed.try_recv() {
            self.take(key);
        }
        let factor = self.dial.factor();
        let before = std::mem::replace(&mut self.asked, factor);
        (factor.to_bits() != before.to_bits()).then_some(factor)
    }

    /// Single step and wait that the keys ask for, if they are not as in the last call.
    pub(super) fn new_steps(&mut self) -> Option<Steps> {
        while let Ok(key) = self.typed.try_recv() {
            self.take(key);
        }
        let before = std::mem::replace(&mut self.shown, self.steps);
        (self.steps != before).then_some(self.steps)
    }

    /// Discards what was typed before a question.
    pub(super) fn ask(&mut self) {
        self.entered = false;
    }

    /// The answer since the question: done if Enter was pressed.
    pub(super) fn answer(&mut self) -> Answer {
        if std::mem::take(&mut self.entered) {
            return Answer::Done;
        }
        match self.typed.try_recv() {
            Ok(key) => self.take(key),
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => return Answer::Nobody,
        }
        Answer::NotYet
    }

    fn take(&mut self, key: u8) {
        self.entered |= matches!(key, b'\n' | b'\r');
        self.dial.turn(key);
        switch(&mut self.steps, key);
    }
}

/// Changes the input of `key`.
fn switch(steps: &mut Steps, key: u8) {
    match key {
        b's' => steps.single_step = !steps.single_step,
        b'n' => steps.wait_at_next_stop = !steps.wait_at_next_stop,
        _ => {}
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        // A terminal that has gone needs nothing.
        tcsetattr(io::stdin(), OptionalActions::Now, &self.before).unwrap_or_default();
    }
}

/// The override as keys change it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Dial {
    factor: f64,
    held: bool,
}

impl Dial {
    fn new(factor: f64) -> Self {
        Self { factor, held: false }
    }

    /// 0 where the path is held.
    fn factor(self) -> f64 {
        if self.held { 0.0 } else { self.factor }
    }

    fn turn(&mut self, key: u8) {
        let tenths = (self.factor / STEP).round();
        match key {
            b'+' | b'=' => self.factor = ((tenths + 1.0) * STEP).min(MOST_OVERRIDE),
            b'-' | b'_' => self.factor = ((tenths - 1.0) * STEP).max(STEP),
            b' ' => self.held = !self.held,
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_switch_steps() {
        for (keys, single_step, wait_at_next_stop) in
            [("", false, false), ("s", true, false), ("+n x", false, true), ("sns", false, true)]
        {
            let mut steps = Steps::default();
            keys.bytes().for_each(|key| switch(&mut steps, key));
            assert_eq!(steps, Steps { single_step, wait_at_next_stop }, "{keys}");
        }
    }

    #[test]
    fn keys_turn_the_dial() {
        let turned = |factor: f64, keys: &str| {
            let mut dial = Dial::new(factor);
            keys.bytes().for_each(|key| dial.turn(key));
            dial.factor()
        };
        for (factor, keys, expected) in [
            (1.0, "", 1.0),
            (1.0, "---", 0.7),
            (1.0, "+", 1.1),
            (1.0, " ", 0.0),
            // While it is held it can be turned all the same.
            (1.0, " --", 0.0),
            (1.0, " -- ", 0.8),
            (1.0, "--------------", 0.1),
            (1.9, "+++", 2.0),
            (0.55, "-x\n", 0.5),
        ] {
            assert!((turned(factor, keys) - expected).abs() < 1e-9, "{keys}");
        }
    }
}
