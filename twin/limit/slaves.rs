//! Slaves in gears and on cams in time-optimal planning, so that their limits hold, too.
//!
//! Along a path, a slave is a known function of its master. With the master at m(s), a slave on a cam is at f(m), with
//! f′m′, f″m′² + f′m″ and f‴m′³ + 3f″m′m″ + f′m‴. Ramp-ins onto a cam are left out. The offset of a cam that depends on
//! the start position of its master or slave follows from the start position of programs.

use std::sync::Arc;
use twin_cam::{Cam, CamInput, Derivatives, StartMode};
use twin_kinematics::AxisVector;
use twin_machine::{Axis, CamSelection, CoupledBy, Machine};
use twin_planner::time_optimal::{AxisPoint, Rates};

/// The couplings of a machine file along a path.
#[derive(Clone, Debug)]
pub(super) struct Slaves {
    /// Masters before their slaves.
    links: Vec<Link>,
    /// Where the axes are by the program alone when programs start, and with their slaves.
    own: AxisVector,
    start: AxisVector,
}

#[derive(Clone, Debug)]
struct Link {
    slave: usize,
    master: usize,
    by: By,
}

#[derive(Clone, Debug)]
enum By {
    /// Way of the slave per way of the master, both in SI.
    Gear(f64),
    Cam(Box<OnCam>),
}

/// A slave on a cam, whose numbers are in the units of the axes.
#[derive(Clone, Debug)]
struct OnCam {
    cam: Arc<Cam>,
    periodic: bool,
    input: CamInput,
    /// Added to the master's position before it is scaled, and to the slave's at the end.
    shifts: [f64; 2],
    /// What a unit of master and slave is in SI.
    units: [f64; 2],
}

impl OnCam {
    fn new(selection: &CamSelection, [master, slave]: [&Axis; 2], [lead, own]: [f64; 2]) -> Self {
        let CamSelection { table, input, .. } = selection;
        let shown = |axis: &Axis, value: f64| {
            let value = axis.from_si(value);
            axis.period.map_or(value, |period| value.rem_euclid(axis.from_si(period)))
        };
        let turns = [(master, lead), (slave, own)]
            .map(|(axis, value)| axis.from_si(value) - shown(axis, value));
        let relative = input.start_mode == StartMode::Relative || !table.slave_absolute;
        let zero = if table.master_absolute { 0.0 } else { shown(master, lead) };
        let rest = if relative { shown(slave, own) } else { 0.0 };
        Self {
            cam: Arc::clone(&table.cam),
            periodic: table.periodic,
            input: *input,
            shifts: [-turns[0] - zero, turns[1] + rest],
            units: [master.to_si(1.0), slave.to_si(1.0)],
        }
    }

    /// The slave's position and its derivatives by the master's, in SI, where the master is at `lead`.
    fn at(&self, lead: f64) -> [f64; 4] {
        let CamInput { master_offset, master_scaling, slave_offset, slave_scaling, .. } =
            self.input;
        let ([before, behind], [master, slave]) = (self.shifts, self.units);
        let x = (lead / master + before) * master_scaling + master_offset;
        let curve = self.cam.curve();
        let Derivatives { position, velocity, acceleration, jerk } =
            if self.periodic { curve.repeated(x) } else { curve.at(x) };
        let (out, along) = (slave_scaling * slave, master_scaling / master);
        [
            out * position + (slave_offset + behind) * slave,
            out * velocity * along,
            out * acceleration * along.powi(2),
            out * jerk * along.powi(3),
        ]
    }
}

impl Slaves {
    /// Slaves of `machine`.
    pub(super) fn of(machine: &Machine) -> Self {
        let own = if machine.couplings.is_empty() { None } else { machine.start_without_slaves() };
        let own = own.unwrap_or_else(|| machine.middle());
        let mut slaves = Self { links: Vec::new(), own, start: own };
        for coupling in &machine.couplings {
            let axes = [coupling.master, coupling.axis].map(|index| machine.axes.get(index));
            let [Some(master), Some(slave)] = axes else { continue };
            let by = match &coupling.by {
                CoupledBy::Gear(numerator, denominator) => {
                    let ratio = f64::from(*numerator) / f64::from(*denominator);
                    By::Gear(ratio * slave.to_si(1.0) / master.to_si(1.0))
                }
                CoupledBy::Cam(selection) => {
                    let places = [at(&slaves.start, coupling.master), at(&own, coupling.axis)];
                    By::Cam(Box::new(OnCam::new(selection, [master, slave], places)))
                }
            };
            slaves.links.push(Link { slave: coupling.axis, master: coupling.master, by });
            slaves.start = slaves.with(&own);
        }
        slaves
    }

    /// True if no axis is a slave.
    pub(super) fn is_empty(&self) -> bool {
        self.links.is_empty()
    }

    /// Positions of the axes by the program alone, near `near`, which includes the motion of slaves.
    pub(super) fn without(&self, near: &AxisVector) -> AxisVector {
        let mut own = *near;
        for Link { slave, master, by } in &self.links {
            let alone = match by {
                // Of the master with its own coupling, if it has one.
                By::Gear(ratio) => {
                    at(near, *slave) - ratio * (at(near, *master) - at(&self.start, *master))
                }
                // The program leaves it where it is.
                By::Cam(_) => at(&self.own, *slave),
            };
            put(&mut own, *slave, alone);
        }
        own
    }

    /// Positions of the axes with their slaves, which are at `own` by the program alone.
    pub(super) fn with(&self, own: &AxisVector) -> AxisVector {
        let mut all = *own;
        for Link { slave, master, by } in &self.links {
            let lead = at(&all, *master);
            let follows = match by {
                By::Gear(ratio) => at(own, *slave) + ratio * (lead - at(&self.start, *master)),
                By::Cam(cam) => cam.at(lead)[0],
            };
            put(&mut all, *slave, follows);
        }
        all
    }

    /// Moves the slaves with their masters.
    pub(super) fn lead(&self, point: &mut AxisPoint) {
        point.position = self.with(&point.position);
        for Link { slave, master, by } in &self.links {
            let Rates { first, second, third } = &mut point.rates;
            let [v, a, j] = [&*first, &*second, &*third].map(|rates| at(rates, *master));
            match by {
                By::Gear(ratio) => {
                    for (rates, rate) in [(first, v), (second, a), (third, j)] {
                        let sum = at(rates, *slave) + ratio * rate;
                        put(rates, *slave, sum);
                    }
                }
                By::Cam(cam) => {
                    let [_, one, two, three] = cam.at(at(&point.position, *master));
                    put(first, *slave, one * v);
                    put(second, *slave, two * v * v + one * a);
                    put(third, *slave, three * v.powi(3) + 3.0 * two * v * a + one * j);
                }
            }
        }
    }
}

fn at(values: &AxisVector, index: usize) -> f64 {
    values.get(index).copied().unwrap_or_default()
}

fn put(values: &mut AxisVector, index: usize, value: f64) {
    if let Some(slot) = values.get_mut(index) {
        *slot = value;
    }
}
