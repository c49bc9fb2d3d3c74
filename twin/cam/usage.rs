//! How a cam is used: what its master does, offsets and scalings, and what its slave can do.

use super::{AxisScale, Coupling};
use crate::machine::{Axis, AxisKind};
use twin_motion::cam::{Factors, MasterMotion, SlaveLimits};

/// What the slave can do, u; infinite where there is no limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Least and greatest position.
    pub position: [f64; 2],
    /// Velocity, acceleration and jerk.
    pub motion: SlaveLimits,
    /// The period of an axis that goes round.
    pub period: Option<f64>,
}

impl AxisLimits {
    /// Nothing is limited.
    pub const NONE: Self = Self {
        position: [f64::NEG_INFINITY, f64::INFINITY],
        motion: SlaveLimits::NONE,
        period: None,
    };

    /// Those of an axis of a machine, in degrees or mm.
    pub fn of(axis: &Axis) -> Self {
        Self {
            position: if axis.limited {
                axis.position_limits.map(|limit| axis.from_si(limit))
            } else {
                Self::NONE.position
            },
            motion: SlaveLimits {
                velocity: axis.from_si(axis.max_velocity),
                acceleration: axis.from_si(axis.max_acceleration),
                jerk: axis.max_jerk.map_or(f64::INFINITY, |jerk| axis.from_si(jerk)),
            },
            period: axis.period.map(|period| axis.from_si(period)),
        }
    }
}

/// Whether a scale that names its unit fits an axis.
pub fn unit_fits(scale: &AxisScale, kind: AxisKind) -> bool {
    let known: &[&str] = match kind {
        AxisKind::Rotary => &["deg", "°", "degree", "degrees"],
        AxisKind::Linear => &["mm"],
    };
    scale.unit.is_empty() || known.contains(&scale.unit.trim())
}

/// What a cam is checked with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamUse {
    /// What the master does at most, in its own units.
    pub master: MasterMotion,
    /// Offsets and scalings.
    pub coupling: Coupling,
    /// Whether the cam is put end to end.
    pub repeated: bool,
    /// What the slave can do.
    pub limits: AxisLimits,
    /// Where the master is when `MC_CamIn` starts, if that is known.
    pub start: Option<f64>,
}

impl CamUse {
    /// Factors of master and slave.
    pub fn factors(&self) -> Factors {
        let input = &self.coupling.input;
        Factors { master: input.master_scaling, slave: input.slave_scaling }
    }

    /// Where the master is when the cam is at `place` (of the pass that begins there).
    pub fn master_at(&self, place: f64) -> f64 {
        let input = &self.coupling.input;
        (place - input.master_offset) / input.master_scaling
    }

    /// Where the slave is when the cam says `y`.
    pub fn slave_at(&self, y: f64) -> f64 {
        let input = &self.coupling.input;
        y * input.slave_scaling + input.slave_offset
    }
}
