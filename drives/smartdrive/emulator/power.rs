//! Supply, faults and alarms, and what switches the power off.

use super::{Device, Mode, Phase};
use crate::{Alarms, TrajectoryFlags};

impl Device {
    /// Sets the supply, V. Too much or too little is an alarm; much too little stops the CPU, which boots when the
    /// supply is back.
    pub fn set_supply(&mut self, volts: u16) {
        let was_dead = self.supply_v < self.options.brown_out_v;
        self.supply_v = volts;
        if volts < self.options.brown_out_v {
            self.power_off(TrajectoryFlags::NONE);
            self.phase = Phase::Dead;
        } else if was_dead {
            self.boot();
        }
        self.set_fault(Alarms::UNDERVOLTAGE, volts < self.options.undervoltage_v);
        self.set_fault(Alarms::OVERVOLTAGE, volts > self.options.overvoltage_v);
    }

    /// The cause of alarms is there, or is gone; the alarms themselves go when a mode is chosen.
    pub fn set_fault(&mut self, alarms: Alarms, present: bool) {
        self.faults = if present { self.faults.union(alarms) } else { self.faults.without(alarms) };
        if present && matches!(self.phase, Phase::Running | Phase::Changing { .. }) {
            self.raise(alarms);
        }
    }

    /// The rotor is blocked for a moment: a motion ends where it is.
    pub fn stall(&mut self) {
        if self.generator.in_motion(self.now_ns) {
            self.homing = None;
            self.generator.freeze(self.now_ns, TrajectoryFlags::STALLED);
            if self.options.stall_is_alarm {
                self.raise(Alarms::STALL);
            }
        }
    }

    pub(super) fn raise(&mut self, alarms: Alarms) {
        self.alarms = self.alarms.union(alarms);
        self.power_off(TrajectoryFlags::NONE);
        self.mode = Mode::Off;
        self.phase = Phase::Running;
    }

    /// Whatever moves rests where it is.
    pub(super) fn power_off(&mut self, because: TrajectoryFlags) {
        self.homing = None;
        self.generator.freeze(self.now_ns, because);
    }

    /// RESET, or the supply is back.
    pub(super) fn boot(&mut self) {
        self.power_off(TrajectoryFlags::NONE);
        self.phase = Phase::Booting { until_ns: self.after(self.options.boot) };
    }

    pub(super) fn start_up(&mut self) {
        self.memory.load(false);
        self.alarms = Alarms::default();
        self.conditions = 0;
        self.phase = Phase::Running;
        self.encoder_zeros = [self.mechanical(); 2];
        let outputs = 0..3;
        outputs.for_each(|place| self.pins.set_output(place, false));
        self.activate(self.options.configured_mode);
    }
}
