//! Bit of a tappet group (`SMC_GetTappetValue`, manual 4.4.2 and 5.5).

use super::passage::Trigger;
use super::tappet::Action;

/// Pulses of one group that may wait at a time: those that come beyond are dropped.
const MAX_PULSES: usize = 256;

/// A bit that tappets switch, off at first.
///
/// Every tappet acts at the time at which the master passed it; a timed one switches on a delay later and off a duration
/// after that. The last one that acted says what the bit is, but a timed one that ends does not switch off what another
/// timed one holds. A pulse shorter than a cycle is shown for one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TappetBit {
    value: bool,
    pulses: Vec<Pulse>,
    /// Counts the cycles in which it was asked for.
    cycle: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Pulse {
    on_ns: i64,
    off_ns: i64,
    /// The cycle in which it has begun.
    begun: Option<u64>,
}

impl TappetBit {
    /// Its value.
    pub fn value(&self) -> bool {
        self.value
    }

    /// A tappet acts.
    pub fn take(&mut self, trigger: &Trigger) {
        self.run_until(trigger.time_ns);
        match trigger.action {
            Action::On => self.value = true,
            Action::Off => self.value = false,
            Action::Invert => self.value = !self.value,
            Action::Timed { delay_ns, duration_ns } => {
                let on_ns = trigger.time_ns.saturating_add(delay_ns);
                let off_ns = on_ns.saturating_add(duration_ns);
                if self.pulses.len() < MAX_PULSES {
                    self.pulses.push(Pulse { on_ns, off_ns, begun: None });
                }
            }
        }
    }

    /// Value at the end of a cycle whose triggers it has taken.
    pub fn at(&mut self, now_ns: i64) -> bool {
        self.run_until(now_ns);
        self.cycle = self.cycle.wrapping_add(1);
        self.value
    }

    /// Lets pulses begin and end up to a time, in the order of their edges. What has begun in this cycle ends in a later
    /// one, so that it is seen.
    fn run_until(&mut self, now_ns: i64) {
        let cycle = self.cycle;
        let edge = |pulse: &Pulse| match pulse.begun {
            None => Some(pulse.on_ns),
            Some(begun) if begun != cycle => Some(pulse.off_ns),
            Some(_) => None,
        };
        loop {
            let edges = self.pulses.iter().enumerate();
            let next = edges.filter_map(|(index, pulse)| Some((edge(pulse)?, index))).min();
            let Some((_, index)) = next.filter(|(at, _)| *at <= now_ns) else { return };
            match self.pulses.get_mut(index) {
                Some(pulse) if pulse.begun.is_none() => {
                    pulse.begun = Some(cycle);
                    self.value = true;
                }
                _ => {
                    self.pulses.remove(index);
                    if !self.pulses.iter().any(|pulse| pulse.begun.is_some()) {
                        self.value = false;
                    }
                }
            }
        }
    }
}
