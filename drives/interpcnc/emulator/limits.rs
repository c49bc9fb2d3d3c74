//! Limit switches: parameters 104 to 123 name an input and its polarity for both ends of each axis; 0 means none.
//!
//! An active switch shows in B27 to B31. Assumed: an axis that moves towards its active switch is stopped (see
//! [`crate::Assumptions::limit_stop`]), and away from it moves freely; in an interpolated move all axes are
//! stopped and the command buffer is cleared. A switch that is also the home switch stops no homing.

use super::{Board, bench::input_bit};
use crate::{
    BoardStop,
    protocol::{
        parameters,
        registers::{AxisMask, BoardAxis},
    },
};

impl Board {
    /// Whether a limit switch is active.
    fn on_limit(&self, axis: BoardAxis, positive: bool) -> bool {
        let number = parameters::limit_input(axis, positive);
        let bit = input_bit(self.memory.parameter(number));
        let closed = self.memory.parameter(number + 1) == 1;
        bit != 0 && (self.memory.inputs & bit != 0) != closed
    }

    /// B27 to B31, X in bit 0.
    pub(super) fn limit_bits(&self) -> u32 {
        let active = |axis: &BoardAxis| self.on_limit(*axis, true) || self.on_limit(*axis, false);
        let active = BoardAxis::ALL.into_iter().filter(active);
        active.fold(0, |bits, axis| bits | u32::from(axis.mask().bits()))
    }

    /// Stops what moves towards an active switch; true if something happened.
    pub(super) fn check_limits(&mut self) -> bool {
        let now = self.now_ns;
        let mut changed = false;
        for name in BoardAxis::ALL {
            let Some(axis) = self.axes.get(name.index()) else { continue };
            if !axis.moving(now) || axis.is_braking() {
                continue;
            }
            let positive = axis.positive(now);
            let bit = input_bit(self.memory.parameter(parameters::limit_input(name, positive)));
            if !self.on_limit(name, positive) || self.homings.input_of(name) == bit {
                continue;
            }
            let mut stopped = name.mask();
            if axis.interpolating(now) {
                stopped = AxisMask::from_bits(self.axis_bits(|axis| axis.interpolating(now)));
                self.buffer.clear();
            }
            self.abandon_homing(name.mask());
            match self.assumptions.limit_stop {
                BoardStop::AtOnce => self.for_axes(stopped, |axis| axis.stop(now)),
                BoardStop::OnRamp => self.for_axes(stopped, |axis| axis.ramp_stop(now)),
            }
            changed = true;
        }
        changed
    }
}
