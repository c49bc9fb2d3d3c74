//! M functions: the outputs they switch, and their acknowledgement (`SMC_Interpolator.bAcknM`, manual 6.2.9).

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;
use std::time::Duration;
use twin_machine::Machine;
use twin_path::MParameters;
use twin_path::Place;
use twin_planner::controller::ToolSetpoint;
use twin_planner::time_optimal::MTimes;

/// Acknowledgement of M functions that the machine file does not define.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Acknowledge {
    /// Nobody needs to: it takes one cycle.
    #[default]
    Auto,
    /// It takes so long, ns.
    After(i64),
    /// The user.
    Prompt,
}

/// No M function takes longer than this.
const LONGEST: Duration = Duration::from_hours(1);

/// What is neither `auto` nor `prompt` nor a duration.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "expected auto, prompt, or how long every M function takes, like 500ms or 2s, up to an hour"
)]
pub struct AcknowledgeError;

impl FromStr for Acknowledge {
    type Err = AcknowledgeError;

    fn from_str(text: &str) -> Result<Self, AcknowledgeError> {
        match text {
            "auto" => Ok(Self::Auto),
            "prompt" => Ok(Self::Prompt),
            _ => {
                let duration = humantime::parse_duration(text).ok();
                let duration = duration.filter(|time| *time <= LONGEST);
                let time_ns = duration.and_then(|time| i64::try_from(time.as_nanos()).ok());
                time_ns.map(Self::After).ok_or(AcknowledgeError)
            }
        }
    }
}

/// Acknowledgement rules of M functions while a program is read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Acknowledgement {
    otherwise: Wait,
    of: BTreeMap<u16, Wait>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wait {
    /// Over after so long, ns.
    Time(i64),
    /// Whoever reads the program says when.
    Acknowledged,
}

impl Default for Wait {
    fn default() -> Self {
        Self::Time(0)
    }
}

impl Acknowledgement {
    /// Rules for a check: M functions of the machine file take their time, and those that the user would acknowledge
    /// take none.
    pub fn for_check(machine: &Machine, acknowledge: Acknowledge) -> Self {
        let otherwise = match acknowledge {
            Acknowledge::Auto | Acknowledge::Prompt => Wait::default(),
            Acknowledge::After(time_ns) => Wait::Time(time_ns),
        };
        let functions = machine.m_functions.iter();
        let of = functions.map(|function| (function.number, Wait::Time(function.time_ns)));
        Self { otherwise, of: of.collect() }
    }

    /// For a run, with drives that have `outputs` or without.
    pub fn for_run(machine: &Machine, acknowledge: Acknowledge, outputs: bool) -> Self {
        let mut all = Self::for_check(machine, acknowledge);
        if acknowledge == Acknowledge::Prompt {
            all.otherwise = Wait::Acknowledged;
        }
        if outputs {
            all.of.values_mut().for_each(|wait| *wait = Wait::Acknowledged);
        }
        all
    }

    /// Durations of M functions; those that the user acknowledges take no time.
    pub(crate) fn times(&self) -> MTimes {
        let time = |wait: &Wait| match wait {
            Wait::Time(time_ns) => *time_ns,
            Wait::Acknowledged => 0,
        };
        MTimes {
            of: self.of.iter().map(|(number, wait)| (*number, time(wait))).collect(),
            otherwise: time(&self.otherwise),
        }
    }

    fn of(&self, number: u16) -> Wait {
        self.of.get(&number).copied().unwrap_or(self.otherwise)
    }
}

/// An M function at which the path waits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MCall {
    /// Number of M functions before it, in execution order.
    pub index: u64,
    /// Its number.
    pub number: u16,
    /// Its block.
    pub place: Place,
    /// Since when, ns since the start of the program.
    pub since_ns: i64,
    /// Its words K, L and O (`SMC_GetMParameters`, manual 6.2.10).
    pub parameters: MParameters,
}

impl fmt::Display for MCall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "M{}", self.number)?;
        let MParameters { k, l, o } = &self.parameters;
        for (letter, value) in [('K', k), ('L', l)] {
            if let Some(value) = value {
                write!(f, " {letter}{value}")?;
            }
        }
        if let Some(values) = o {
            let values: Vec<_> = values.iter().map(f64::to_string).collect();
            write!(f, " with dP1 to dP8 = {}", values.join(", "))?;
        }
        Ok(())
    }
}

/// More M functions than these are counted, not kept.
const MOST_CALLS: usize = 10_000;

/// The M functions along a program.
#[derive(Clone, Debug, Default)]
pub struct MCalls {
    first: Vec<MCall>,
    count: u64,
}

impl MCalls {
    /// The first 10,000, in the order in which the path waits at them.
    pub fn first(&self) -> &[MCall] {
        &self.first
    }

    /// Number of calls that were not kept.
    pub fn left_out(&self) -> u64 {
        let kept = u64::try_from(self.first.len()).unwrap_or(u64::MAX);
        self.count.saturating_sub(kept)
    }

    /// Observes the M function at which the path waits.
    pub(crate) fn observe(&mut self, call: &MCall) {
        if call.index < self.count {
            return;
        }
        self.count = call.index + 1;
        if self.first.len() < MOST_CALLS {
            self.first.push(*call);
        }
    }
}

/// Waits for M functions to be acknowledged.
#[derive(Debug, Default)]
pub(crate) struct Waiting {
    rules: Acknowledgement,
    call: Option<MCall>,
    acknowledged: bool,
    count: u64,
}

impl Waiting {
    pub(crate) fn new(rules: Acknowledgement) -> Self {
        Self { rules, ..Self::default() }
    }

    /// The M function at which the path waits.
    pub(crate) fn call(&self) -> Option<MCall> {
        self.call
    }

    /// True if the path goes on only when [`Self::acknowledge`] is called.
    pub(crate) fn for_word(&self) -> bool {
        !self.acknowledged
            && self.call.is_some_and(|call| self.rules.of(call.number) == Wait::Acknowledged)
    }

    /// The M function is done.
    pub(crate) fn acknowledge(&mut self) {
        self.acknowledged = true;
    }

    /// True if the M function of the last set-point, at `now_ns`, is done at the next.
    pub(crate) fn is_over(&self, now_ns: i64) -> bool {
        self.call.is_some_and(|call| match self.rules.of(call.number) {
            Wait::Time(time_ns) => now_ns.saturating_sub(call.since_ns) >= time_ns,
            Wait::Acknowledged => self.acknowledged,
        })
    }

    /// Observes the next set-point, after due acknowledgements.
    pub(crate) fn observe(&mut self, was_over: bool, tool: &ToolSetpoint) {
        let ToolSetpoint { m_function, m_parameters, place, time_ns, .. } = *tool;
        if was_over || m_function.is_none() {
            self.call = None;
        }
        let Some(number) = m_function else { return };
        if self.call.is_none() {
            self.call = Some(MCall {
                index: self.count,
                number,
                place,
                since_ns: time_ns,
                parameters: m_parameters,
            });
            self.acknowledged = false;
            self.count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_acknowledges() {
        for (text, expected) in [
            ("auto", Acknowledge::Auto),
            ("prompt", Acknowledge::Prompt),
            ("500ms", Acknowledge::After(500_000_000)),
            ("2s", Acknowledge::After(2_000_000_000)),
            ("1m 30s", Acknowledge::After(90_000_000_000)),
            ("0s", Acknowledge::After(0)),
        ] {
            assert_eq!(text.parse(), Ok(expected), "{text}");
        }
        for text in ["", "5", "-1s", "automatic", "1e99s", "99999999999years", "61m"] {
            assert_eq!(text.parse::<Acknowledge>(), Err(AcknowledgeError), "{text}");
        }
    }

    /// K and L are there while the function waits (manual 3.2.2, 6.2.10), and the parameter set of O.
    #[test]
    fn parameters_are_named() {
        let mut waiting = Waiting::new(Acknowledgement::default());
        let o = Some([1.0, 2.5, 0.0, 0.0, 0.0, 0.0, 0.0, -8.0]);
        for (k, l, o, said) in [
            (None, None, None, "M13"),
            (Some(2.5), Some(-7.0), None, "M13 K2.5 L-7"),
            (None, Some(3.0), o, "M13 L3 with dP1 to dP8 = 1, 2.5, 0, 0, 0, 0, 0, -8"),
        ] {
            let m_parameters = MParameters { k, l, o };
            let tool =
                ToolSetpoint { m_function: Some(13), m_parameters, ..ToolSetpoint::default() };
            waiting.observe(true, &tool);
            assert_eq!(waiting.call().unwrap().to_string(), said);
        }
    }

    #[test]
    fn waiting_goes_by_number() {
        let rules = Acknowledgement {
            otherwise: Wait::Time(0),
            of: [(3, Wait::Time(2)), (6, Wait::Acknowledged)].into(),
        };
        let mut waiting = Waiting::new(rules);
        let see = |waiting: &mut Waiting, was_over, m_function, time_ns| {
            let tool = ToolSetpoint { m_function, time_ns, ..ToolSetpoint::default() };
            waiting.observe(was_over, &tool);
        };
        assert!(!waiting.is_over(0));
        see(&mut waiting, false, Some(5), 10);
        assert!(waiting.is_over(10), "otherwise at once");
        // The next one follows without a set-point in between.
        see(&mut waiting, true, Some(3), 11);
        assert_eq!(waiting.call().map(|call| (call.index, call.number)), Some((1, 3)));
        assert!(!waiting.is_over(12) && waiting.is_over(13));
        see(&mut waiting, true, Some(6), 14);
        assert!(waiting.for_word() && !waiting.is_over(i64::MAX));
        see(&mut waiting, false, Some(6), 15);
        assert_eq!(waiting.call().map(|call| call.since_ns), Some(14));
        waiting.acknowledge();
        assert!(!waiting.for_word() && waiting.is_over(15));
        see(&mut waiting, true, Some(6), 16);
        assert!(waiting.for_word(), "the same again waits again");
        see(&mut waiting, false, None, 17);
        assert_eq!(waiting.call(), None);
    }
}
