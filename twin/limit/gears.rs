//! Slaves in gear, as feed limiting sees them: they move with their masters along the path, so that their limits hold, too.

use crate::machine::{CoupledBy, Machine};
use twin_kinematics::AxisVector;
use twin_motion::limit::{AxisPoint, Rates};

/// The gears of a machine file whose ratio along a path is known.
#[derive(Clone, Debug)]
pub(super) struct Gears {
    /// Masters before their slaves.
    gears: Vec<Gear>,
    /// Where programs start.
    start: AxisVector,
}

#[derive(Clone, Copy, Debug)]
struct Gear {
    slave: usize,
    master: usize,
    /// Way of the slave per way of the master, both in SI.
    ratio: f64,
}

impl Gears {
    /// Those of `machine`.
    pub(super) fn of(machine: &Machine) -> Self {
        let gear = |coupling: &crate::machine::Coupling| {
            let CoupledBy::Gear(numerator, denominator) = coupling.by else { return None };
            let slave = machine.axes.get(coupling.axis)?;
            let master = machine.axes.get(coupling.master)?;
            let ratio = f64::from(numerator) / f64::from(denominator);
            let ratio = ratio * slave.to_si(1.0) / master.to_si(1.0);
            Some(Gear { slave: coupling.axis, master: coupling.master, ratio })
        };
        let gears = machine.couplings.iter().filter_map(gear).collect::<Vec<_>>();
        let start = machine.start_axes().filter(|_| !gears.is_empty());
        Self { gears, start: start.unwrap_or_else(|| machine.middle()) }
    }

    /// Where the axes are by the program alone, of `near`, where they are with their slaves.
    pub(super) fn without(&self, near: &AxisVector) -> AxisVector {
        let mut own = *near;
        for gear in &self.gears {
            // Of the master with its own gear, if it has one.
            let way = gear.ratio * (at(near, gear.master) - at(&self.start, gear.master));
            add(&mut own, gear.slave, -way);
        }
        own
    }

    /// Where the axes are with their slaves, which are at `own` by the program alone.
    pub(super) fn with(&self, own: &AxisVector) -> AxisVector {
        let mut all = *own;
        for gear in &self.gears {
            let way = gear.ratio * (at(&all, gear.master) - at(&self.start, gear.master));
            add(&mut all, gear.slave, way);
        }
        all
    }

    /// Moves the slaves with their masters.
    pub(super) fn lead(&self, point: &mut AxisPoint) {
        point.position = self.with(&point.position);
        for gear in &self.gears {
            let Rates { first, second, third } = &mut point.rates;
            for rates in [first, second, third] {
                let rate = gear.ratio * at(rates, gear.master);
                add(rates, gear.slave, rate);
            }
        }
    }
}

fn at(values: &AxisVector, index: usize) -> f64 {
    values.get(index).copied().unwrap_or_default()
}

fn add(values: &mut AxisVector, index: usize, value: f64) {
    if let Some(slot) = values.get_mut(index) {
        *slot += value;
    }
}
