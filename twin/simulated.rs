//! The simulated machine as a plant.

use crate::machine::{FaultAt, FaultKind, FaultStart, Machine, Scenario, SimulationError};
use crate::physics::{
    Collision, Contact, EventKind, Fault, MotorState, PhysicsError, PhysicsEvent, PhysicsMachine,
    axis_inertia,
};
use crate::plant::{AxisFeedback, Blow, Happening, Plant, PlantRecord};
use crate::setpoint::AxisSetpoint;
use std::collections::BTreeMap;
use twin_kinematics::{AxisMotion, AxisVector};
use twin_motion::Place;

/// Happenings that are kept: what goes on in every line of a long program is told as well by its first thousand.
const MOST_HAPPENINGS: usize = 1000;

/// Cycles in which a blow has come to its largest force.
const STOPPING: u32 = 20;

/// Simulates one cycle per set-point, at once; what it gives back is where the axes are at the set-point's time.
#[derive(Debug)]
pub struct Simulated {
    physics: PhysicsMachine,
    begun: bool,
    arrived: Option<AxisFeedback>,
    /// In the last cycle.
    motors: Vec<MotorState>,
    happened: Happened,
    /// Faults that have not begun.
    faults: Vec<FaultAt>,
    /// Axes that are jammed until then, ns.
    jammed: Vec<(usize, i64)>,
}

/// What happened, by line, axis and kind.
#[derive(Debug, Default)]
struct Happened {
    kept: BTreeMap<(u32, usize, u8), Happening>,
    blows: Vec<Blow>,
    left_out: u64,
}

impl Simulated {
    /// The machine at rest at `start` (m or rad), its drives enabled.
    ///
    /// # Errors
    /// If the machine file describes no machine that physics can simulate.
    pub fn new(machine: &Machine, start: &AxisVector) -> Result<Self, SimulationError> {
        Self::built(machine, start).map_err(|error| SimulationError::of(machine, error))
    }

    fn built(machine: &Machine, start: &AxisVector) -> Result<Self, PhysicsError> {
        let inertia = axis_inertia(&machine.model, start)?;
        let drives: Vec<_> = machine
            .axes
            .iter()
            .zip(inertia.iter())
            .map(|(axis, inertia)| axis.simulated.drive(*inertia))
            .collect();
        let mut physics =
            PhysicsMachine::new(&machine.model, &drives, machine.gravity, start, machine.cycle_ns)?;
        if let Some(collision) = &machine.collision {
            physics.insert_surroundings(&collision.surroundings)?;
        }
        Ok(Self {
            physics,
            begun: false,
            arrived: None,
            motors: Vec::with_capacity(machine.axes.len()),
            happened: Happened::default(),
            faults: Vec::new(),
            jammed: Vec::new(),
        })
    }

    /// The same with faults to come, and the noise of a seed.
    #[must_use]
    pub fn in_scenario(self, scenario: &Scenario) -> Self {
        let physics = self.physics.with_seed(scenario.seed);
        Self { physics, faults: scenario.faults.clone(), ..self }
    }

    /// The machine itself.
    pub fn physics(&self) -> &PhysicsMachine {
        &self.physics
    }

    /// Notes what was run into at `place`, having let the machine come to a stop, and says what it was.
    fn run_into(&mut self, place: Place) -> Result<(), PhysicsError> {
        let collisions = self.physics.take_collisions();
        let mut blows: Vec<_> = collisions
            .iter()
            .map(|Collision { speed, contact: Contact { parts, force, .. }, .. }| Blow {
                place,
                parts: *parts,
                speed: *speed,
                force: *force,
            })
            .collect();
        let Some(first) = blows.first().map(|blow| blow.parts) else { return Ok(()) };
        // The drives hold where the machine is, as they do when they are told to stop at once.
        let stop = AxisMotion::at_rest(self.physics.axis_state().position);
        for _ in 0..STOPPING {
            if self.physics.step(&stop).is_err() {
                break;
            }
            for contact in self.physics.contacts() {
                for blow in blows.iter_mut().filter(|blow| blow.parts == contact.parts) {
                    blow.force = blow.force.max(contact.force);
                }
            }
        }
        let force = blows.iter().find(|blow| blow.parts == first).map_or(0.0, |blow| blow.force);
        self.happened.blows.extend(blows);
        Err(PhysicsError::Collision { parts: first, force })
    }
}

impl Simulated {
    /// Lets faults begin and end that are due at `setpoint`.
    fn fail(&mut self, setpoint: &AxisSetpoint) {
        let physics = &mut self.physics;
        self.jammed.retain(|(axis, until_ns)| {
            let lasts = setpoint.time_ns < *until_ns;
            if !lasts {
                physics.free(*axis);
            }
            lasts
        });
        let axes = physics.setpoint().position.len();
        let jammed = &mut self.jammed;
        self.faults.retain(|fault| {
            let due = match fault.start {
                FaultStart::Time(time_ns) => setpoint.time_ns >= time_ns,
                FaultStart::Line(line) => setpoint.place.line == line,
            };
            if !due {
                return true;
            }
            let kind = match fault.kind {
                FaultKind::Jam(_) => Fault::Jam,
                FaultKind::LostSteps(steps) => Fault::LostSteps(steps),
                FaultKind::LooseBelt { stiffness, backlash } => {
                    Fault::LooseBelt { stiffness, backlash }
                }
                FaultKind::PowerLoss => Fault::PowerLoss,
            };
            for axis in fault.axis.map_or(0..axes, |axis| axis..axis.saturating_add(1)) {
                physics.fail(axis, kind);
                if let FaultKind::Jam(Some(for_ns)) = fault.kind {
                    jammed.push((axis, setpoint.time_ns.saturating_add(for_ns)));
                }
            }
            false
        });
    }
}

impl Happened {
    fn add(&mut self, place: Place, event: PhysicsEvent) {
        let PhysicsEvent { axis, kind, .. } = event;
        let number = match kind {
            EventKind::LostSteps(_) => 0,
            EventKind::Overload => 1,
            EventKind::LimitSwitch(_) => 2,
            EventKind::BrakeClosed => 3,
            EventKind::Failed(_) => 4,
        };
        let key = (place.line, axis, number);
        if let Some(before) = self.kept.get_mut(&key) {
            if let (EventKind::LostSteps(before), EventKind::LostSteps(more)) =
                (&mut before.kind, kind)
            {
                *before = before.saturating_add(more);
            }
        } else if self.kept.len() < MOST_HAPPENINGS {
            self.kept.insert(key, Happening { place, axis, kind });
        } else {
            self.left_out += 1;
        }
    }
}

impl Plant for Simulated {
    type Error = PhysicsError;

    fn command(&mut self, setpoint: &AxisSetpoint) -> Result<(), PhysicsError> {
        self.fail(setpoint);
        // The machine stands at the first set-point: it is where the others start from.
        let position = if self.begun {
            self.physics.step(&setpoint.axes)?.position
        } else {
            self.physics.axis_state().position
        };
        self.begun = true;
        self.arrived = Some(AxisFeedback { time_ns: setpoint.time_ns, position });
        self.motors.clear();
        self.motors.extend((0..position.len()).map(|axis| self.physics.motor_state(axis)));
        let mut switch = None;
        for event in self.physics.take_events() {
            self.happened.add(setpoint.place, event);
            if let EventKind::LimitSwitch(side) = event.kind {
                switch.get_or_insert(PhysicsError::LimitSwitch { axis: event.axis, side });
            }
        }
        self.run_into(setpoint.place)?;
        switch.map_or(Ok(()), Err)
    }

    fn feedback(&mut self) -> Result<Option<AxisFeedback>, PhysicsError> {
        Ok(self.arrived.take())
    }

    fn motors(&self) -> &[MotorState] {
        &self.motors
    }

    fn record(&self) -> PlantRecord {
        let axes = self.physics.setpoint().position.len();
        PlantRecord {
            happenings: self.happened.kept.values().copied().collect(),
            blows: self.happened.blows.clone(),
            left_out: self.happened.left_out,
            loads: (0..axes).map(|axis| self.physics.motor_load(axis)).collect(),
        }
    }
}
