//! Axis couplings: slaves that follow masters by the gears and cams of the machine file while a program moves the tool.

use crate::tappets::{MasterPlace, Signal, TappetBits, Tracks};
use crate::{Axis, CamSelection, CoupledBy, Coupling, Machine};
use twin_cam::{CamCoupling, CamTable, CouplingError, StartMode};
use twin_kinematics::{AxisMotion, AxisSource, AxisVector, KinematicsError};
use twin_profile::State;

/// A slave that the program moves itself by less is left alone, mm or degrees: the transform rounds.
const UNMOVED: f64 = 1e-6;

/// Errors that leave a set-point without axis positions.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AxesError {
    /// The machine cannot bring the tool there.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// The program moves an axis that belongs to a master.
    #[error(
        "axis {axis} follows {master} by a {by} of the machine file, but the program moves it from {from:.3} to {to:.3} {unit}"
    )]
    Moved {
        /// The slave.
        axis: String,
        /// Its master.
        master: String,
        /// "gear" or "cam".
        by: &'static str,
        /// Its position at the beginning, `unit`.
        from: f64,
        /// Its position in the program, `unit`.
        to: f64,
        /// mm or deg.
        unit: &'static str,
    },
    /// The program begins with a slave where its master does not have it.
    #[error(
        "axis {axis} follows {master} by a cam of the machine file, which has it at {at:.3} {unit} where the program begins, not \
         at {from:.3} {unit}"
    )]
    Begins {
        /// The slave.
        axis: String,
        /// Its master.
        master: String,
        /// Its start position in the program, `unit`.
        from: f64,
        /// Its position on the cam then, `unit`.
        at: f64,
        /// mm or deg.
        unit: &'static str,
    },
    /// A cam that cannot be followed.
    #[error("axis {axis}: {source}")]
    Cam {
        /// The slave.
        axis: String,
        /// The error of the cam.
        source: CouplingError,
    },
}

impl Machine {
    /// Axis positions at the default start of programs, if the machine can reach it.
    pub fn start_axes(&self) -> Option<AxisVector> {
        AxisCouplings::at_rest(self, self.start_without_slaves()?).ok()
    }
}

/// The couplings of a machine under way.
#[derive(Clone, Debug)]
pub struct AxisCouplings<'m> {
    machine: &'m Machine,
    /// Default start positions of the axes without slaves; `None` if the start of the program is not checked.
    start: Option<AxisVector>,
    /// One per coupling, once there has been a set-point.
    running: Vec<Running>,
    /// True if any slave moves the tool.
    moves_tool: bool,
    tracks: Tracks,
    tappets: TappetBits,
    /// Positions of the masters of the couplings, in their units.
    masters: Vec<(usize, f64)>,
}

/// A coupling and where it has begun.
#[derive(Clone, Debug)]
struct Running {
    /// Of the slave, by the program.
    own: f64,
    master: f64,
    cam: Option<Box<CamCoupling>>,
    /// From where a rotary slave shows itself to where it is.
    shift: f64,
}

impl<'m> AxisCouplings<'m> {
    /// Couplings of `machine` before a program, which must start the slaves of cams on their cams.
    pub fn for_program(machine: &'m Machine) -> Self {
        let start =
            if machine.couplings.is_empty() { None } else { machine.start_without_slaves() };
        Self { start, ..Self::new(machine) }
    }

    /// Couplings of `machine`, before they begin.
    pub fn new(machine: &'m Machine) -> Self {
        let sources = machine.kinematics.sources();
        let moves_tool = machine.couplings.iter().any(|coupling| {
            !matches!(sources.get(coupling.axis), None | Some(AxisSource::Additional(_)))
        });
        let mut tracks = Tracks::default();
        for coupling in &machine.couplings {
            let CoupledBy::Cam(selection) = &coupling.by else { continue };
            let name = machine.axes.get(coupling.axis).map_or("", |axis| axis.name.as_str());
            for tappet in selection.table.cam.tappets() {
                // The machine file has been refused if there are too many.
                tracks.add(coupling.axis, name, tappet.group);
            }
        }
        Self {
            machine,
            start: None,
            running: Vec::new(),
            moves_tool,
            tracks,
            tappets: TappetBits::default(),
            masters: Vec::new(),
        }
    }

    /// True if the tool is elsewhere than the program says.
    pub fn moves_tool(&self) -> bool {
        self.moves_tool
    }

    /// Signals of the tappets, as of the last set-point.
    pub fn tappets(&self) -> TappetBits {
        self.tappets
    }

    /// The signals of the tappets.
    pub fn signals(&self) -> &[Signal] {
        self.tracks.signals()
    }

    /// Tappets that did not act because there were too many in a cycle.
    pub fn lost_tappets(&self) -> u64 {
        self.tracks.lost()
    }

    /// The couplings whose masters were on tappets at the first set-point, each with the tappet groups.
    pub fn stood_on_tappets(&self) -> impl Iterator<Item = (&'m Coupling, Vec<i16>)> {
        self.machine.couplings.iter().zip(&self.running).filter_map(|(coupling, running)| {
            let stood = running.cam.iter().flat_map(|cam| cam.stood_on());
            let groups: Vec<_> = stood.map(|tappet| tappet.group).collect();
            (!groups.is_empty()).then_some((coupling, groups))
        })
    }

    /// Position of the master that switched a signal last, as of the last set-point.
    pub fn tappet_master(&self, signal: usize) -> Option<MasterPlace> {
        let index = self.tracks.master(signal)?;
        let axis = self.machine.axes.get(index)?;
        let (_, position) = self.masters.iter().find(|(master, _)| *master == index)?;
        Some(MasterPlace { axis: axis.name.clone(), position: *position, unit: axis.unit() })
    }

    /// Puts the slaves where their masters have them at `time_ns`.
    ///
    /// # Errors
    /// If the program moves a slave itself, or its cam is not defined at the position of its master.
    pub fn apply(&mut self, axes: &mut AxisMotion, time_ns: i64) -> Result<(), AxesError> {
        self.masters.clear();
        let by_program = axes.position;
        for (index, coupling) in self.machine.couplings.iter().enumerate() {
            let Some((slave, master)) =
                self.machine.axes.get(coupling.axis).zip(self.machine.axes.get(coupling.master))
            else {
                continue;
            };
            let leads = state(axes, coupling.master, master);
            let own = state(axes, coupling.axis, slave);
            let failed = |source| AxesError::Cam { axis: slave.name.clone(), source };
            // As both show themselves: the cam knows their periods.
            let (shown_lead, shown) = (shown(leads, master), shown(own, slave));
            self.masters.push((coupling.master, shown_lead.position));
            let begins = index >= self.running.len();
            if begins {
                let cam = match &coupling.by {
                    CoupledBy::Gear(..) => None,
                    CoupledBy::Cam(selection) => {
                        let CamSelection { table, input, .. } = &**selection;
                        let table = CamTable {
                            master_period: period(master),
                            slave_period: period(slave),
                            ..table.clone()
                        };
                        let cam = CamCoupling::start(table, *input, &shown_lead, &shown, time_ns);
                        Some(Box::new(cam.map_err(failed)?))
                    }
                };
                let shift = own.position - shown.position;
                let (own, master) = (own.position, leads.position);
                self.running.push(Running { own, master, cam, shift });
            }
            let Some(running) = self.running.get_mut(index) else { continue };
            if (own.position - running.own).abs() > UNMOVED {
                return Err(AxesError::Moved {
                    axis: slave.name.clone(),
                    master: master.name.clone(),
                    by: coupling.name(),
                    from: running.own,
                    to: own.position,
                    unit: slave.unit(),
                });
            }
            let follows = match (&coupling.by, &mut running.cam) {
                (CoupledBy::Gear(numerator, denominator), _) => {
                    let ratio = f64::from(*numerator) / f64::from(*denominator);
                    State {
                        position: running.own + ratio * (leads.position - running.master),
                        velocity: ratio * leads.velocity,
                        acceleration: ratio * leads.acceleration,
                    }
                }
                (CoupledBy::Cam(_), Some(cam)) => {
                    if !begins {
                        cam.step(&shown_lead, time_ns).map_err(failed)?;
                    }
                    let pair = (coupling.axis, coupling.master);
                    self.tracks.take_all(pair, &cam.output().tappets, 0);
                    let slave = cam.output().slave;
                    State { position: slave.position + running.shift, ..slave }
                }
                (CoupledBy::Cam(_), None) => continue,
            };
            put(axes, coupling.axis, slave, follows);
            // What the program does not say of a slave is where the machine file has programs begin.
            if let Some(start) = self.start.as_ref().filter(|_| begins) {
                let said = of(&by_program, coupling.axis, slave);
                if (said - of(start, coupling.axis, slave)).abs() > UNMOVED {
                    begins_at(self.machine, coupling.axis, &by_program, &axes.position)?;
                }
            }
        }
        self.tappets = self.tracks.at(time_ns);
        Ok(())
    }

    /// Axis positions with slaves, while the axes rest at `axes`.
    ///
    /// # Errors
    /// [`AxesError`] if a cam has no place there for its slave.
    pub fn at_rest(machine: &Machine, axes: AxisVector) -> Result<AxisVector, AxesError> {
        let mut motion = AxisMotion::at_rest(axes);
        AxisCouplings::new(machine).apply(&mut motion, 0)?;
        Ok(motion.position)
    }
}

/// Checks that a slave that a program starts at `own` is on its cam, `coupled`. Gears and slaves with a ramp or
/// relative start may begin anywhere.
///
/// # Errors
/// [`AxesError::Begins`] if it is elsewhere.
pub fn begins_at(
    machine: &Machine,
    axis: usize,
    own: &AxisVector,
    coupled: &AxisVector,
) -> Result<(), AxesError> {
    let on_cam = |coupling: &&Coupling| {
        let CoupledBy::Cam(selection) = &coupling.by else { return false };
        let absolute = selection.input.start_mode == StartMode::Absolute;
        coupling.axis == axis && absolute && selection.table.slave_absolute
    };
    let Some(coupling) = machine.couplings.iter().find(on_cam) else { return Ok(()) };
    let axes = [axis, coupling.master].map(|index| machine.axes.get(index));
    let [Some(slave), Some(master)] = axes else { return Ok(()) };
    let [from, at] = [own, coupled].map(|values| of(values, axis, slave));
    let apart = period(slave).map_or(at - from, |period| {
        let way = at - from;
        way - period * (way / period).round()
    });
    if apart.abs() <= UNMOVED {
        return Ok(());
    }
    let (axis, master) = (slave.name.clone(), master.name.clone());
    Err(AxesError::Begins { axis, master, from, at, unit: slave.unit() })
}

/// The period of an axis, in its unit.
fn period(axis: &Axis) -> Option<f64> {
    axis.period.map(|period| axis.from_si(period))
}

/// An axis as it shows itself: within its period, if it has one.
fn shown(state: State, axis: &Axis) -> State {
    let position = period(axis).map_or(state.position, |period| state.position.rem_euclid(period));
    State { position, ..state }
}

/// Value of an axis, in its unit.
fn of(values: &AxisVector, index: usize, axis: &Axis) -> f64 {
    axis.from_si(values.get(index).copied().unwrap_or_default())
}

/// State of an axis, in its unit.
fn state(axes: &AxisMotion, index: usize, axis: &Axis) -> State {
    State {
        position: of(&axes.position, index, axis),
        velocity: of(&axes.velocity, index, axis),
        acceleration: of(&axes.acceleration, index, axis),
    }
}

fn put(axes: &mut AxisMotion, index: usize, axis: &Axis, state: State) {
    let State { position, velocity, acceleration } = state;
    for (values, value) in [
        (&mut axes.position, position),
        (&mut axes.velocity, velocity),
        (&mut axes.acceleration, acceleration),
    ] {
        if let Some(slot) = values.get_mut(index) {
            *slot = axis.to_si(value);
        }
    }
}
