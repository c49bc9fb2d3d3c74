//! Test rig: an axis with its virtual drive and power on.

use crate::{Axis, AxisConfig, MoveSuperImposed, Power, SuperImposed, VirtualDrive};

/// Cycle of the tests, s.
pub(super) const CYCLE: f64 = 0.01;

pub(super) struct Rig {
    pub(super) axis: Axis,
    pub(super) drive: VirtualDrive,
    /// Input of `MC_Power`.
    pub(super) power: Power,
}

impl Rig {
    /// With this configuration but the cycle, powered and at a standstill at 0.
    pub(super) fn new(config: AxisConfig) -> Self {
        let axis = Axis::new(AxisConfig { cycle: CYCLE, ..config });
        let power = Power { regulator_on: true, drive_start: true };
        let mut rig = Self { axis, drive: VirtualDrive::new(0.0), power };
        for _ in 0..2 {
            rig.cycle(|_| ());
        }
        rig
    }

    /// One cycle with these blocks.
    pub(super) fn cycle<T>(&mut self, blocks: impl FnOnce(&mut Axis) -> T) -> T {
        self.axis.begin_cycle(&self.drive.feedback());
        self.power.call(true, &mut self.axis);
        let shown = blocks(&mut self.axis);
        self.drive.follow(&self.axis.end_cycle());
        shown
    }

    /// Cycles until `blocks` says so; how many that were.
    pub(super) fn until(&mut self, mut blocks: impl FnMut(&mut Axis) -> bool) -> u32 {
        for count in 1..100_000 {
            if self.cycle(&mut blocks) {
                return count;
            }
        }
        panic!("it does not come to an end");
    }
}

/// Linear, 100 u/s, 100 u/s².
pub(super) fn linear() -> Rig {
    Rig::new(AxisConfig::default())
}

/// Rotary with a period of 360 u.
pub(super) fn rotary() -> Rig {
    use crate::Movement;
    Rig::new(AxisConfig { movement: Movement::Rotary { period: 360.0 }, ..AxisConfig::default() })
}

/// A distance on top of the motion there is.
pub(super) fn on_top(
    distance: f64,
    velocity_diff: f64,
    acceleration: f64,
    deceleration: f64,
) -> SuperImposed {
    SuperImposed::new(MoveSuperImposed { distance, velocity_diff, acceleration, deceleration })
}
