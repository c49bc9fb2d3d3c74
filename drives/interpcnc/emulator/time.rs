//! Time step of the emulated board: advances from one event to the next.

use super::{Board, lock::ENABLE_FILTER_NS};

/// Consequences of one instant that are followed up: more than the command buffer has segments of no length.
const MOST_CONSEQUENCES: u32 = 100_000;

impl Board {
    /// Lets time pass.
    pub fn advance(&mut self, ns: i64) {
        let then = self.now_ns.saturating_add(ns.max(0));
        while let Some(due_ns) = self.next_event().filter(|due_ns| *due_ns <= then) {
            self.now_ns = due_ns;
            self.settle();
        }
        self.now_ns = then;
    }

    /// The next instant at which something happens that has consequences.
    fn next_event(&self) -> Option<i64> {
        let now = self.now_ns;
        let filter = self.open_since_ns.map(|since| since.saturating_add(ENABLE_FILTER_NS));
        let watched = !self.buffer.is_idle() || self.homings.any() || self.probe.in_progress();
        let ends = self.axes.iter().filter_map(|axis| axis.end_ns(now));
        let ends = ends.min().filter(|_| watched);
        // An axis that reverses may then move towards the switch it is on.
        let turns = self.axes.iter().filter(|axis| axis.moving(now) && axis.has_turn());
        let turns = turns.map(|axis| axis.turn_ns().saturating_add(1)).filter(|turn| *turn > now);
        [filter, self.eeprom.due_ns(), self.next_edge(), ends, turns.min()]
            .into_iter()
            .flatten()
            .filter(|due_ns| *due_ns > now)
            .min()
    }

    /// Draws the consequences of this instant.
    pub(super) fn settle(&mut self) {
        for _ in 0..MOST_CONSEQUENCES {
            let mut changed = self.end_store();
            changed |= self.refresh_inputs();
            changed |= self.check_enable();
            changed |= self.check_limits();
            changed |= self.step_homing();
            changed |= self.step_buffer();
            self.end_probe();
            if !changed {
                return;
            }
        }
    }

    /// Inputs as hands and cams make them now; true if any has changed.
    fn refresh_inputs(&mut self) -> bool {
        let levels = self.input_levels();
        let changed = levels ^ self.memory.inputs;
        if changed == 0 {
            return false;
        }
        self.memory.inputs = levels;
        self.unlock_by_input(changed);
        self.probe_input();
        true
    }
}
