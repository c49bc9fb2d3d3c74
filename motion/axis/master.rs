//! Master of a coupling: the motion of the axis that another one follows.

use super::Axis;

/// Motion of a master (manual 5.4): by its set values if its `bRegulatorOn` is TRUE, else by its actual ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Master {
    /// Position, u; of a rotary master in [0, period).
    pub position: f64,
    /// Velocity, u/s.
    pub velocity: f64,
    /// Acceleration, u/s².
    pub acceleration: f64,
    /// Period of a rotary master, u.
    pub period: Option<f64>,
    /// Part of its position that comes from moving its zero, u: no motion.
    pub zero: f64,
    /// Its position when the cycle began at rest, u, if a block has moved it since; with the present zero.
    pub stood: Option<f64>,
}

impl Master {
    /// Motion of `axis` in this cycle, as far as its blocks have been called.
    #[must_use]
    pub fn of(axis: &Axis) -> Self {
        let values = &axis.values;
        let [position, velocity, acceleration] = if values.regulator_on {
            [values.set_position, values.set_velocity, values.set_acceleration]
        } else {
            [values.act_position, values.act_velocity, values.act_acceleration]
        };
        let stood =
            values.regulator_on && values.moved_in_this_cycle && values.save_velocity == 0.0;
        let (period, zero) = (axis.period(), axis.zero);
        let stood = stood.then_some(values.save_position);
        Self { position, velocity, acceleration, period, zero, stood }
    }

    /// Distance since `before`, u: the short way round. Moving its zero (`MC_SetPosition`, a reference) is not a motion.
    #[must_use]
    pub fn travel_since(&self, before: &Self) -> f64 {
        let way = self.position - before.position - (self.zero - before.zero);
        self.period.map_or(way, |period| way - period * (way / period).round())
    }
}
