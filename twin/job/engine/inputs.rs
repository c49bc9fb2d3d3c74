//! Trigger inputs of probes.

use super::Moved;
use super::nanoseconds;
use crate::job::probe::{JobTrigger, When};
use twin_axis::Trigger;

/// The triggers of a job.
#[derive(Debug)]
pub(super) struct Inputs {
    when: Vec<When>,
    triggers: Vec<Trigger>,
    /// Where the axes were that they look at, a cycle ago.
    before: Vec<Option<f64>>,
}

impl Inputs {
    pub(super) fn new(triggers: &[JobTrigger]) -> Self {
        Self {
            when: triggers.iter().map(|trigger| trigger.when).collect(),
            triggers: vec![Trigger::of_program(); triggers.len()],
            before: vec![None; triggers.len()],
        }
    }

    pub(super) fn triggers(&mut self) -> &mut [Trigger] {
        &mut self.triggers
    }

    /// True if no trigger becomes TRUE by time alone from this time on.
    pub(super) fn are_over(&self, now_ns: i64) -> bool {
        !self.when.iter().any(|when| matches!(when, When::At(time) if nanoseconds(*time) >= now_ns))
    }

    /// Condition under which a trigger is TRUE.
    pub(super) fn when(&self, trigger: usize) -> Option<When> {
        self.when.get(trigger).copied()
    }

    /// Evaluates the triggers at the beginning of a cycle. Each is TRUE for the first cycle in which its condition
    /// holds.
    pub(super) fn observe(&mut self, begin_ns: i64, cycle_ns: i64, axes: &[Moved]) {
        for ((when, trigger), before) in
            self.when.iter().zip(&mut self.triggers).zip(&mut self.before)
        {
            trigger.input = match when {
                When::At(time) => {
                    (begin_ns - cycle_ns < nanoseconds(*time)) && nanoseconds(*time) <= begin_ns
                }
                When::Passes(axis, place) => axes.get(*axis).is_some_and(|moved| {
                    let now = moved.axis.act_position();
                    let short = |way: f64| match moved.axis.period() {
                        Some(period) => way - period * (way / period).round(),
                        None => way,
                    };
                    let from = before.replace(now).unwrap_or(now);
                    let (way, ahead) = (short(now - from), short(place - from));
                    // It has passed where it has come to, not where it comes from.
                    way * ahead > 0.0 && ahead.abs() <= way.abs()
                }),
            };
        }
    }
}
