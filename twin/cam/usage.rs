//! Use of a cam: master motion, offsets and scalings, and limits of the slave.

use twin_cam::{Factors, MasterMotion, SlaveLimits};
use twin_machine::cam_file::{CamFile, Coupling};

/// What the slave can do, u; infinite where there is no limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisLimits {
    /// Least and greatest position.
    pub(crate) position: [f64; 2],
    /// Velocity, acceleration and jerk.
    pub(crate) motion: SlaveLimits,
    /// The period of an axis that goes round.
    pub(crate) period: Option<f64>,
}

impl AxisLimits {
    pub(crate) const NONE: Self = Self {
        position: [f64::NEG_INFINITY, f64::INFINITY],
        motion: SlaveLimits::NONE,
        period: None,
    };
}

/// What a cam is checked with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CamUse {
    /// What the master does at most, in its own units.
    pub(crate) master: MasterMotion,
    pub(crate) coupling: Coupling,
    pub(crate) repeated: bool,
    /// What the slave can do.
    pub(crate) limits: AxisLimits,
    /// Where the master is when `MC_CamIn` starts, if that is known.
    pub(crate) start: Option<f64>,
}

impl CamUse {
    /// The period of the slave's axis, if it goes round: that of the machine's axis, or the cam file's. An axis with limits of its
    /// position does not go round, whatever the file says.
    pub(crate) fn slave_period(&self, file: &CamFile) -> Option<f64> {
        self.limits.period.or(file.period.filter(|_| !self.is_limited()))
    }

    /// Whether the slave's position is limited.
    pub(crate) fn is_limited(&self) -> bool {
        self.limits.position.iter().any(|limit| limit.is_finite())
    }

    /// How much the slave gains in every pass of a periodic cam, on the scale of the cam; none if it comes back, or
    /// is passed once.
    pub(crate) fn gain(&self, file: &CamFile) -> Option<f64> {
        let rise = file.cam.curve().rise();
        (self.repeated && rise != 0.0).then_some(rise)
    }

    /// The same motion with a `MasterOffset` that is nearest to another one: of a periodic cam it may be whole passes
    /// more or less, with what the slave gains in them in `SlaveOffset`.
    #[must_use]
    pub(crate) fn beside(&self, other: &Self, file: &CamFile) -> Self {
        let curve = file.cam.curve();
        let mut moved = *self;
        let input = &mut moved.coupling.input;
        let width = curve.end() - curve.start();
        let passes = ((input.master_offset - other.coupling.input.master_offset) / width).round();
        if self.repeated && passes != 0.0 && passes.is_finite() {
            input.master_offset -= passes * width;
            input.slave_offset += passes * curve.rise() * input.slave_scaling;
        }
        moved
    }

    pub(crate) fn factors(&self) -> Factors {
        let input = &self.coupling.input;
        Factors { master: input.master_scaling, slave: input.slave_scaling }
    }

    /// Where the master is when the cam is at `place` (of the pass that begins there).
    pub(crate) fn master_at(&self, place: f64) -> f64 {
        let input = &self.coupling.input;
        (place - input.master_offset) / input.master_scaling
    }

    /// Where the slave is when the cam says `y`.
    pub(crate) fn slave_at(&self, y: f64) -> f64 {
        let input = &self.coupling.input;
        y * input.slave_scaling + input.slave_offset
    }
}
