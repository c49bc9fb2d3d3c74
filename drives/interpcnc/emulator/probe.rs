//! Command 40: an axis moves until an input changes.
//!
//! Beyond the manual: B13 is also set for arguments without sense and for an input that has the awaited level already
//! (published vendor sources), which leave a search that is under way alone, and when something else ends the move; the
//! axis shows as moving independently meanwhile. There is one search at a time: that of another axis ends on its ramp.

use super::{Board, bench::input_bit, motion::Axis};
use crate::{MoveProfile, protocol::registers::BoardAxis};

/// The last probing move.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Probe {
    under_way: Option<Search>,
    /// B13.
    failed: bool,
    /// Counter at the edge of the input, registers 1044 and 1045.
    position: i32,
}

/// A move under way.
#[derive(Clone, Copy, Debug)]
struct Search {
    axis: BoardAxis,
    /// Bit of the input.
    input: u32,
    /// The level that ends the move.
    level: bool,
    found: bool,
}

/// Arguments of command 40.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProbeCommand {
    pub(super) axis: BoardAxis,
    pub(super) positive: bool,
    pub(super) input: u16,
    pub(super) level: u16,
    pub(super) max_stroke: i32,
    /// Its target does not count.
    pub(super) profile: MoveProfile,
}

impl Probe {
    /// B12.
    pub(super) fn in_progress(&self) -> bool {
        self.under_way.is_some()
    }

    /// B13.
    pub(super) fn failed(&self) -> bool {
        self.failed
    }

    pub(super) fn clear_failure(&mut self) {
        self.failed = false;
    }

    /// Power is gone.
    pub(super) fn power_cycle(&mut self) {
        *self = Self::default();
    }

    /// Counter at the edge of the input.
    pub(super) fn position(&self) -> i32 {
        self.position
    }
}

impl Board {
    /// Starts a probing move on an unlocked board.
    pub(super) fn start_probe(&mut self, command: &ProbeCommand) {
        let ProbeCommand { axis, positive, input, level, max_stroke, profile } = *command;
        self.probe.failed = false;
        let bit = input_bit(input.into());
        if bit == 0 || level > 1 || max_stroke <= 0 {
            self.probe.failed = true;
            return;
        }
        let level = level == 1;
        if (self.memory.inputs & bit != 0) == level {
            self.probe.failed = true;
            return;
        }
        let now = self.now_ns;
        let stroke = if positive { max_stroke } else { -max_stroke };
        let from = self.axes.get(axis.index()).map_or(0, |axis| axis.counter(now));
        let Some(target) = from.checked_add(stroke) else {
            self.probe.failed = true;
            return;
        };
        // One search at a time: that of another axis ends on its ramp.
        if let Some(other) = self.probe.under_way.take().filter(|other| other.axis != axis) {
            self.for_axes(other.axis.mask(), |axis| axis.ramp_stop(now));
        }
        self.abandon_homing(axis.mask());
        self.for_axes(axis.mask(), |axis| axis.start(now, &MoveProfile { target, ..profile }));
        self.probe.under_way = Some(Search { axis, input: bit, level, found: false });
    }

    /// An input has changed: at the edge the counter is latched, then the axis brakes.
    pub(super) fn probe_input(&mut self) {
        let now = self.now_ns;
        let inputs = self.memory.inputs;
        let Some(search) = &mut self.probe.under_way else { return };
        if search.found || (inputs & search.input != 0) != search.level {
            return;
        }
        search.found = true;
        let axis = search.axis;
        if let Some(axis) = self.axes.get(axis.index()) {
            self.probe.position = axis.counter(now);
        }
        self.for_axes(axis.mask(), |axis| axis.ramp_stop(now));
    }

    /// A probing move has ended when its axis rests.
    pub(super) fn end_probe(&mut self) {
        let Some(search) = self.probe.under_way else { return };
        let moves = |axis: &Axis| axis.moving(self.now_ns);
        if !self.axes.get(search.axis.index()).is_some_and(moves) {
            self.probe.failed |= !search.found;
            self.probe.under_way = None;
        }
    }

    /// Something else moves the axis from now on.
    pub(super) fn abandon_probe(&mut self, axis: BoardAxis) {
        if let Some(search) = self.probe.under_way.filter(|search| search.axis == axis) {
            self.probe.failed |= !search.found;
            self.probe.under_way = None;
        }
    }
}
