//! Simulated machine as a plant: one simulated cycle per set-point.

mod handling;
#[cfg(test)]
pub(crate) mod tests;

use crate::in_loop::DrivesInLoop;
use crate::plant::{
    AxisFeedback, Blow, BodyHappening, Happening, Plant, PlantRecord, ProbeMiss, ProbeTouch,
};
use crate::setpoint::{AxisSetpoint, HORIZON_NS};
use crate::spindle::Spindle;
use crate::touch_probe::TouchProbe;
use handling::Handling;
use nalgebra::Isometry3;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use twin_kinematics::{AxisMotion, AxisVector};
use twin_machine::{
    FaultAt, FaultKind, FaultStart, Machine, Scenario, SimulationError, SpindleBodies,
};
use twin_path::Place;
use twin_physics::{
    Contact, EventKind, Fault, MotorState, PhysicsError, PhysicsEvent, PhysicsMachine, Side,
    SwitchStates, YieldingTool,
};

/// Most happenings that are kept; the first thousand of a long program are enough.
const MOST_HAPPENINGS: usize = 1000;

/// Cycles in which the machine stops after a blow.
const STOPPING: u32 = 20;

/// Cycles in which a blow is over.
const BLOW: u32 = 3;

/// Simulates one cycle per set-point; the feedback is the position of the axes at the set-point's time.
///
/// A clone is a complete snapshot: with the same set-points both give the same bits.
#[derive(Clone, Debug)]
pub struct Simulated {
    physics: PhysicsMachine,
    /// Drives between set-points and motors.
    drives: Option<DrivesInLoop>,
    begun: bool,
    arrived: Option<AxisFeedback>,
    /// Motors in the last cycle.
    motors: Vec<MotorState>,
    happened: Happened,
    /// Faults that have not begun.
    faults: Vec<FaultAt>,
    /// Jammed axes with the end of the jam, ns.
    jammed: Vec<(usize, i64)>,
    spindle: Spindle,
    /// With a collision check.
    bodies: Option<Arc<SpindleBodies>>,
    probe: Option<TouchProbe>,
    handling: Option<Handling>,
}

/// Happenings, by line, axis and kind.
#[derive(Clone, Debug, Default)]
struct Happened {
    kept: BTreeMap<(u32, usize, u8), Happening>,
    blows: Vec<Blow>,
    touches: Vec<ProbeTouch>,
    missed: Vec<ProbeMiss>,
    left_out: u64,
    /// New ones since the last call.
    news: Vec<Happening>,
}

impl Simulated {
    /// The machine at rest at `start` (m or rad), its drives enabled.
    ///
    /// # Errors
    /// If the machine file describes no machine that physics can simulate.
    pub fn new(machine: &Machine, start: &AxisVector) -> Result<Self, SimulationError> {
        Self::with_spindle(machine, start, Spindle::default())
    }

    /// The same with the tool of `spindle`, which changes at M6 and M61.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn with_spindle(
        machine: &Machine,
        start: &AxisVector,
        spindle: Spindle,
    ) -> Result<Self, SimulationError> {
        let tool = spindle.number();
        let built = Self::built(machine, start, spindle);
        built.map_err(|error| SimulationError::with_tool(machine, error, tool))
    }

    fn built(
        machine: &Machine,
        start: &AxisVector,
        spindle: Spindle,
    ) -> Result<Self, PhysicsError> {
        let physics = machine.physics_with(start, spindle.tool())?;
        let bodies = machine.spindle_bodies().map(Arc::new);
        let probe = match &bodies {
            Some(bodies) => {
                let scan = bodies.probe_scan(spindle.tool())?;
                Some(TouchProbe::new(scan, DrivesInLoop::resolution(machine)))
            }
            None => None,
        };
        Ok(Self {
            physics,
            drives: DrivesInLoop::of(machine),
            begun: false,
            arrived: None,
            motors: Vec::with_capacity(machine.axes.len()),
            happened: Happened::default(),
            faults: Vec::new(),
            jammed: Vec::new(),
            spindle,
            bodies,
            probe,
            handling: Handling::of(machine),
        })
    }

    /// The machine with faults to come, and the noise of a seed.
    #[must_use]
    pub fn in_scenario(self, scenario: &Scenario) -> Self {
        let physics = self.physics.with_seed(scenario.seed);
        Self { physics, faults: scenario.faults.clone(), ..self }
    }

    /// The machine itself.
    pub fn physics(&self) -> &PhysicsMachine {
        &self.physics
    }

    /// Refuses to begin on a limit switch.
    fn start(&mut self, place: Place) -> Result<(), PhysicsError> {
        for axis in 0..self.physics.setpoint().position.len() {
            let SwitchStates { lower, upper, .. } = self.physics.switches(axis);
            let on = [(Side::Lower, lower), (Side::Upper, upper)].into_iter().find(|(_, on)| *on);
            if let Some((side, _)) = on {
                let kind = EventKind::LimitSwitch(side);
                self.happened.add(place, PhysicsEvent { time_ns: 0, axis, kind });
                return Err(PhysicsError::LimitSwitch { axis, side });
            }
        }
        Ok(())
    }

    /// Changes the tool where the path waits at M6 or M61.
    fn change_tool(&mut self, setpoint: &AxisSetpoint) -> Result<(), PhysicsError> {
        if !setpoint.m_call.is_some_and(|call| self.spindle.observe(&call)) {
            return Ok(());
        }
        let (Some(bodies), Some(probe)) = (&self.bodies, &mut self.probe) else { return Ok(()) };
        let tool = self.spindle.tool();
        let (model, surroundings) = bodies.with(tool);
        self.physics.insert_bodies(&model, &surroundings)?;
        probe.change_tool(bodies.probe_scan(tool)?);
        Ok(())
    }

    /// The probe at the positions of the axes.
    fn feel(&mut self, setpoint: &AxisSetpoint, position: &AxisVector) -> Result<(), PhysicsError> {
        let Some(probe) = &mut self.probe else { return Ok(()) };
        let felt = probe.feel(setpoint, position, self.drives.is_some())?;
        self.physics.set_yielding(felt.yielding);
        self.happened.touches.extend(felt.touch);
        self.happened.missed.extend(felt.missed);
        Ok(())
    }

    /// Lets the machine stop after collisions at `place`, records them, and returns the first one as an error.
    fn run_into(&mut self, place: Place) -> Result<(), PhysicsError> {
        let (cycle, tool) = (self.physics.cycle(), self.spindle.number());
        let collisions = self.physics.take_collisions().into_iter();
        let blows = collisions.map(|one| {
            let Contact { parts, force, .. } = one.contact;
            Blow { place, parts, tool, speed: one.speed, impulse: force * cycle, peak: 0.0 }
        });
        let mut blows: Vec<_> = blows.collect();
        let Some(first) = blows.first().map(|blow| blow.parts) else { return Ok(()) };
        // The drives hold the present position, as in a stop.
        let stop = AxisMotion::at_rest(self.physics.axis_state().position);
        for cycles in 1..STOPPING {
            if self.physics.step(&stop).is_err() {
                break;
            }
            for contact in self.physics.contacts().iter().filter(|_| cycles < BLOW) {
                for blow in blows.iter_mut().filter(|blow| blow.parts == contact.parts) {
                    blow.impulse += contact.force * cycle;
                }
            }
        }
        for blow in &mut blows {
            blow.peak = self.physics.peak_force(blow.impulse, blow.speed);
        }
        let blow = blows.iter().find(|blow| blow.parts == first);
        let impulse = blow.map_or(0.0, |blow| blow.impulse);
        self.happened.blows.extend(blows);
        Err(PhysicsError::Collision { parts: first, impulse })
    }

    /// Probing moves without a touch, including the present one.
    fn missed(&self) -> Vec<ProbeMiss> {
        let under_way = self.probe.as_ref().and_then(TouchProbe::missed);
        self.happened.missed.iter().copied().chain(under_way).collect()
    }

    /// Begins and ends the faults that are due at `setpoint`.
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
            let happening = Happening { place, axis, kind };
            self.kept.insert(key, happening);
            self.news.push(happening);
        } else {
            self.left_out += 1;
        }
    }
}

impl Plant for Simulated {
    type Error = PhysicsError;

    fn command(&mut self, setpoint: &AxisSetpoint) -> Result<(), PhysicsError> {
        self.command_before(setpoint, &VecDeque::new())
    }

    fn horizon_ns(&self) -> i64 {
        if self.drives.is_some() { HORIZON_NS } else { 0 }
    }

    fn has_arrived(&self) -> bool {
        self.drives.as_ref().is_none_or(DrivesInLoop::have_arrived)
    }

    fn command_before(
        &mut self,
        setpoint: &AxisSetpoint,
        ahead: &VecDeque<AxisSetpoint>,
    ) -> Result<(), PhysicsError> {
        self.fail(setpoint);
        self.change_tool(setpoint)?;
        let asked = match &mut self.drives {
            Some(drives) => drives.motion(setpoint, ahead),
            None => setpoint.axes,
        };
        // The machine is at rest at the first set-point.
        if self.probe.is_some() && setpoint.probing {
            self.physics.set_yielding(YieldingTool::Always);
        }
        let position = if self.begun {
            self.physics.step(&asked)?.position
        } else {
            self.begun = true;
            self.start(setpoint.place)?;
            self.physics.axis_state().position
        };
        self.feel(setpoint, &position)?;
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
        let crashed = self.run_into(setpoint.place);
        if let Some(handling) = &mut self.handling {
            handling.act(setpoint, &mut self.physics);
        }
        crashed?;
        switch.map_or(Ok(()), Err)
    }

    fn feedback(&mut self) -> Result<Option<AxisFeedback>, PhysicsError> {
        Ok(self.arrived.take())
    }

    fn body_poses(&self) -> Vec<Isometry3<f64>> {
        self.physics.body_poses()
    }

    fn motors(&self) -> &[MotorState] {
        &self.motors
    }

    fn tool(&self) -> Option<u32> {
        self.spindle.number()
    }

    fn news(&mut self) -> Vec<Happening> {
        std::mem::take(&mut self.happened.news)
    }

    fn body_news(&mut self) -> Vec<BodyHappening> {
        self.handling.as_mut().map(Handling::news).unwrap_or_default()
    }

    fn record(&self) -> PlantRecord {
        let handling = self.handling.as_ref();
        let axes = self.physics.setpoint().position.len();
        PlantRecord {
            happenings: self.happened.kept.values().copied().collect(),
            blows: self.happened.blows.clone(),
            touches: self.happened.touches.clone(),
            missed: self.missed(),
            faults_to_come: self.faults.clone(),
            handled: handling.map(Handling::happened).unwrap_or_default(),
            bodies: handling.map(|it| it.bodies(&self.physics)).unwrap_or_default(),
            left_out: self.happened.left_out + handling.map_or(0, |handling| handling.left_out),
            loads: (0..axes).map(|axis| self.physics.motor_load(axis)).collect(),
        }
    }
}
