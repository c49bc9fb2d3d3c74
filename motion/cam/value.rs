//! Tappet value: the bit of a tappet group of a coupling (`SMC_GetTappetValue`, manual 5.5).

use super::bit::TappetBit;
use super::coupling::TappetData;

/// Follows the bit of one group from cycle to cycle.
#[doc(alias = "SMC_GetTappetValue")]
#[derive(Clone, Debug)]
pub struct TappetValue {
    group: i16,
    initial: bool,
    reset_at_restart: bool,
    bit: TappetBit,
}

impl TappetValue {
    /// The bit of `group` (`iID`), which is `initial` (`bInitValue`) until a tappet acts, and again after every start of
    /// the coupling if `reset_at_restart` (`bSetInitValueAtReset`).
    pub fn new(group: i16, initial: bool, reset_at_restart: bool) -> Self {
        Self { group, initial, reset_at_restart, bit: TappetBit::new(initial) }
    }

    /// A cycle, with what the coupling gave in it: the bit (`bTappet`).
    pub fn step(&mut self, tappets: &TappetData) -> bool {
        if tappets.restarted && self.reset_at_restart {
            self.bit.reset(self.initial);
        }
        for trigger in tappets.triggers().filter(|trigger| trigger.group == self.group) {
            self.bit.take(trigger);
        }
        self.bit.at(tappets.now_ns)
    }

    /// The bit as it was last.
    pub fn value(&self) -> bool {
        self.bit.value()
    }
}
