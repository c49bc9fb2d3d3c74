//! Lock, ENABLE input and unlock input ("Commande 66 : Reset et Ré-armement").

use super::{Board, bench::input_bit};
use crate::{
    BoardStop,
    protocol::{parameters, registers::AxisMask},
};

/// Losing ENABLE counts after this long (firmware 5.27: "Filtrage entrée ENABLE (100ms sur toutes les cartes)").
pub(super) const ENABLE_FILTER_NS: i64 = 100_000_000;

impl Board {
    /// Opens or closes the ENABLE input.
    pub fn set_enable(&mut self, closed: bool) {
        self.enable_input = closed;
        self.settle();
    }

    /// Follows the ENABLE input and the emergency stop input, which acts like it; true if something happened.
    pub(super) fn check_enable(&mut self) -> bool {
        let stop = input_bit(self.memory.parameter(parameters::EMERGENCY_STOP_INPUT));
        let closed = self.memory.parameter(parameters::SPECIAL_POLARITY) & 1 == 1;
        let pressed = stop != 0 && (self.memory.inputs & stop != 0) != closed;
        if self.enable_input && !pressed {
            self.open_since_ns = None;
            if self.enabled {
                return false;
            }
            self.enabled = true;
            self.unlock_automatically();
            return true;
        }
        if !self.enabled {
            return false;
        }
        let since = *self.open_since_ns.get_or_insert(self.now_ns);
        if self.now_ns - since < ENABLE_FILTER_NS {
            return false;
        }
        self.open_since_ns = None;
        self.enabled = false;
        if !self.assumptions.enable_loss_keeps_segments {
            self.buffer.clear();
        }
        self.halt(self.assumptions.enable_loss);
        true
    }

    /// Parameter 88 = 0 with polarity NC: the condition for unlocking is always there.
    pub(super) fn unlock_automatically(&mut self) {
        let automatic = self.memory.parameter(parameters::UNLOCK_INPUT) == 0
            && self.memory.parameter(parameters::UNLOCK_POLARITY) == 1;
        if automatic {
            self.unlock();
        }
    }

    /// The unlock input may be among those that have changed.
    pub(super) fn unlock_by_input(&mut self, changed: u32) {
        let bit = input_bit(self.memory.parameter(parameters::UNLOCK_INPUT));
        let closed = self.memory.parameter(parameters::UNLOCK_POLARITY) == 1;
        if changed & bit != 0 && (self.memory.inputs & bit != 0) != closed {
            self.unlock();
        }
    }

    /// Stops every axis, empties the command buffer and locks.
    pub(super) fn lock(&mut self, stop: BoardStop) {
        self.buffer.clear();
        self.halt(stop);
    }

    /// Stops every axis and locks.
    fn halt(&mut self, stop: BoardStop) {
        let now = self.now_ns;
        self.abandon_homing(AxisMask::ALL);
        match stop {
            BoardStop::AtOnce => self.for_axes(AxisMask::ALL, |axis| axis.stop(now)),
            BoardStop::OnRamp => self.for_axes(AxisMask::ALL, |axis| axis.ramp_stop(now)),
        }
        self.locked = true;
        self.memory.reset_analog_outputs();
        self.switch_outputs(parameters::SET_WHEN_LOCKED, parameters::RESET_WHEN_LOCKED);
    }

    /// Unlocks if ENABLE is active.
    pub(super) fn unlock(&mut self) {
        if self.enabled && self.locked {
            self.locked = false;
            self.switch_outputs(parameters::SET_WHEN_UNLOCKED, parameters::RESET_WHEN_UNLOCKED);
        }
    }

    fn switch_outputs(&mut self, set: u16, reset: u16) {
        let named = |number| self.assumptions.output_code.outputs(self.memory.parameter(number));
        self.memory.outputs = (self.memory.outputs | named(set)) & !named(reset);
    }
}
