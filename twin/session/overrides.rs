//! Override changes and feed hold during a run, and the time at which the path follows each.

use crate::planning::Planning;
use crate::setpoint_source::{LEAST_OVERRIDE, MOST_OVERRIDE};
use std::collections::VecDeque;
use std::str::FromStr;
use std::time::Duration;

/// An override from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverrideAt {
    /// Time of the request, ns since the start of the program.
    pub time_ns: i64,
    /// Factor on all programmed velocities; 0 is a feed hold.
    pub factor: f64,
}

/// Errors of overrides at a time.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is not a time with an override, like 2s=50 or 500ms=0; overrides go from 1 % to 200 %, and 0 is a feed hold"
)]
pub struct OverrideAtError(String);

impl FromStr for OverrideAt {
    type Err = OverrideAtError;

    fn from_str(text: &str) -> Result<Self, OverrideAtError> {
        let wrong = || OverrideAtError(text.to_owned());
        let (time, factor) = text.split_once('=').ok_or_else(wrong)?;
        let time: Option<Duration> = humantime::parse_duration(time.trim()).ok();
        let time_ns =
            time.and_then(|time| i64::try_from(time.as_nanos()).ok()).ok_or_else(wrong)?;
        let factor = override_factor(factor.trim()).ok_or_else(wrong)?;
        if factor != 0.0 && !(LEAST_OVERRIDE..=MOST_OVERRIDE).contains(&factor) {
            return Err(wrong());
        }
        Ok(Self { time_ns, factor })
    }
}

/// The factor of an override in percent, with or without its sign.
pub fn override_factor(text: &str) -> Option<f64> {
    let percent = text.strip_suffix('%').unwrap_or(text);
    percent.trim_end().parse::<f64>().ok().map(|percent| percent / 100.0)
}

/// A change of the override during a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverrideChange {
    /// The request.
    pub asked: OverrideAt,
    /// Time from which the path has followed it, ns since the start of the program; before, it goes on as planned. None
    /// if it never did: the program was over, or there was another request first.
    pub follows_ns: Option<i64>,
}

/// Override requests and their effects.
#[derive(Debug)]
pub(super) struct Overrides {
    schedule: VecDeque<OverrideAt>,
    changes: Vec<OverrideChange>,
}

impl Overrides {
    /// Override requests that start with this schedule, in order.
    pub(super) fn new(schedule: &[OverrideAt]) -> Self {
        let mut schedule = schedule.to_vec();
        schedule.sort_by_key(|change| change.time_ns);
        Self { schedule: schedule.into(), changes: Vec::new() }
    }

    /// Applies the scheduled requests that are due before the set-point at `time_ns` to `items`.
    pub(super) fn apply_due(&mut self, time_ns: i64, items: &mut Planning<'_>) {
        while let Some(due) = self.schedule.pop_front_if(|next| next.time_ns <= time_ns) {
            self.ask(due, items);
        }
    }

    /// Asks `items` for an override.
    pub(super) fn ask(&mut self, asked: OverrideAt, items: &mut Planning<'_>) {
        items.set_override(asked.factor);
        self.changes.push(OverrideChange { asked, follows_ns: None });
    }

    /// Observes a set-point of `items`, and records the time from which the path follows.
    pub(super) fn observe(&mut self, time_ns: i64, items: &Planning<'_>) {
        if let Some(last) = self.changes.last_mut()
            && last.follows_ns.is_none()
            && items.follows_override()
        {
            last.follows_ns = Some(time_ns);
        }
    }

    /// All changes that were requested.
    pub(super) fn into_changes(self) -> Vec<OverrideChange> {
        self.changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overrides_at_times() {
        for (text, time_ns, factor) in [
            ("2s=50", 2_000_000_000, 0.5),
            ("2s=50%", 2_000_000_000, 0.5),
            ("0s = 200 %", 0, 2.0),
            ("1500ms=0", 1_500_000_000, 0.0),
            ("1m 1s=100", 61_000_000_000, 1.0),
        ] {
            assert_eq!(text.parse(), Ok(OverrideAt { time_ns, factor }), "{text}");
        }
        for text in
            ["", "2s", "2=100", "2s=", "2s=x", "2s=NaN", "2s=-1", "2s=0.5", "2s=201", "2s=201%"]
        {
            assert_eq!(text.parse::<OverrideAt>(), Err(OverrideAtError(text.to_owned())));
        }
    }
}
