//! Inputs of the interpolator that change at times of the program, and positions of a workpiece that the path follows (manual
//! 6.2.9, 6.6).

use std::ops::RangeInclusive;
use std::str::FromStr;
use std::sync::Arc;
use twin_planner::controller::{Inputs, IpoError, Override, XDirection};

/// An input of the interpolator that changes at a time of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputAt {
    /// Since the start of the program, ns.
    pub time_ns: i64,
    /// The input and its new value.
    pub change: InputChange,
}

/// A new value of an input (manual 6.2.9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InputChange {
    /// `dOverride`, with the sign that `SMC_Interpolator2Dir` gives it.
    Override(f64),
    /// `bSlow_Stop`.
    SlowStop(bool),
    /// `bEmergency_Stop`.
    EmergencyStop(bool),
    /// `bWaitAtNextStop`.
    WaitAtNextStop(bool),
    /// `bSingleStep`.
    SingleStep(bool),
    /// `bAbort`.
    Abort(bool),
}

impl InputChange {
    /// Applies it to `inputs`.
    ///
    /// # Errors
    /// If it is an override that moves nothing.
    pub fn apply(self, inputs: &mut Inputs) -> Result<(), IpoError> {
        match self {
            Self::Override(factor) => inputs.override_factor = Override::new(factor)?,
            Self::SlowStop(on) => inputs.slow_stop = on,
            Self::EmergencyStop(on) => inputs.emergency_stop = on,
            Self::WaitAtNextStop(on) => inputs.wait_at_next_stop = on,
            Self::SingleStep(on) => inputs.single_step = on,
            Self::Abort(on) => inputs.abort = on,
        }
        Ok(())
    }
}

/// Single step and waiting at the next stop, as the user switches them during a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    /// The path rests for a cycle at the end of every element (`bSingleStep`).
    pub single_step: bool,
    /// The path waits at the next element end where it is at rest anyway (`bWaitAtNextStop`).
    pub wait_at_next_stop: bool,
}

/// Longest time of a change, s: a day.
const LATEST: f64 = 86_400.0;

/// Largest override that may be asked for, percent.
const MOST_OVERRIDE: f64 = 1e5;

/// Error of an input change (`--at TIME:INPUT=VALUE`).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InputAtError {
    /// Its form.
    #[error("expected TIME:INPUT=VALUE, like 1.5:override=50 or 2:slow-stop=on")]
    Form,
    /// One of its numbers.
    #[error("{0}")]
    Number(String),
}

impl FromStr for InputAt {
    type Err = InputAtError;

    fn from_str(text: &str) -> Result<Self, InputAtError> {
        let (time, change) = text.split_once(':').ok_or(InputAtError::Form)?;
        let (input, value) = change.split_once('=').ok_or(InputAtError::Form)?;
        let time = within(time, 0.0..=LATEST)?;
        let switch = match value {
            "on" => Some(true),
            "off" => Some(false),
            _ => None,
        };
        let change = match (input, switch) {
            ("override", None) => {
                let percent = within(value, -MOST_OVERRIDE..=MOST_OVERRIDE)?;
                InputChange::Override(percent / 100.0)
            }
            ("slow-stop", Some(on)) => InputChange::SlowStop(on),
            ("emergency-stop", Some(on)) => InputChange::EmergencyStop(on),
            ("wait-at-next-stop", Some(on)) => InputChange::WaitAtNextStop(on),
            ("single-step", Some(on)) => InputChange::SingleStep(on),
            ("abort", Some(on)) => InputChange::Abort(on),
            _ => return Err(InputAtError::Form),
        };
        #[expect(clippy::cast_possible_truncation, reason = "a day at most")]
        let time_ns = (time * 1e9).round() as i64;
        Ok(Self { time_ns, change })
    }
}

fn within(text: &str, range: RangeInclusive<f64>) -> Result<f64, InputAtError> {
    let number: f64 = text
        .trim()
        .parse()
        .ok()
        .ok_or_else(|| InputAtError::Number(format!("`{text}` is not a number")))?;
    if range.contains(&number) {
        return Ok(number);
    }
    let (least, most) = range.into_inner();
    Err(InputAtError::Number(format!("{number} is not between {least} and {most}")))
}

/// A workpiece that something else moves along X (`SMC_XInterpolator`, manual 6.6).
#[derive(Clone, Debug, PartialEq)]
pub struct Workpiece {
    /// Measured position in every cycle, m.
    pub positions: Arc<[f64]>,
    /// Position at which its zero lies at that of the path, m (`dXOffset`).
    pub offset: f64,
    /// Direction in which it moves (`eDirection`).
    pub direction: XDirection,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_read() {
        for (text, time_ns, change) in [
            ("1.5:override=50", 1_500_000_000, InputChange::Override(0.5)),
            ("2:single-step=on", 2_000_000_000, InputChange::SingleStep(true)),
            ("0:wait-at-next-stop=off", 0, InputChange::WaitAtNextStop(false)),
        ] {
            assert_eq!(text.parse(), Ok(InputAt { time_ns, change }), "{text}");
        }
        for text in ["", "1.5", "1.5:override", "1:override=on", "1:single-step=1", "1:feed=on"] {
            assert_eq!(text.parse::<InputAt>(), Err(InputAtError::Form), "{text}");
        }
        assert!(matches!("-1:abort=on".parse::<InputAt>(), Err(InputAtError::Number(_))));
    }
}
