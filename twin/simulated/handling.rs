//! Grippers as programs switch them, and what happens to loose bodies.

use crate::plant::{BodyHappening, BodyRecord};
use crate::setpoint::AxisSetpoint;
use twin_machine::switch_points::changed;
use twin_machine::{Collision, GripperControl, GripperSignal, Machine};
use twin_physics::{BodyEventKind, PhysicsMachine, Surroundings, distance_to_bodies};

/// Most events that are kept.
const MOST_EVENTS: usize = 1000;

/// Grippers and loose bodies of a simulated machine.
#[derive(Clone, Debug)]
pub(super) struct Handling {
    surroundings: Surroundings,
    controls: Vec<GripperControl>,
    /// The last M function.
    last_call: Option<u64>,
    /// Switches of the path at the last set-point.
    switches: u32,
    /// Grippers that close (true) or open at a time, ns.
    due: Vec<(i64, usize, bool)>,
    happened: Vec<BodyHappening>,
    /// New ones since the last call.
    news: Vec<BodyHappening>,
    pub(super) left_out: u64,
}

impl Handling {
    /// Of `machine`; `None` without bodies and grippers.
    pub(super) fn of(machine: &Machine) -> Option<Self> {
        let collision = machine.collision.as_ref()?;
        let Collision { surroundings, controls, .. } = collision;
        collision.handles_bodies().then(|| Self {
            surroundings: surroundings.clone(),
            controls: controls.clone(),
            last_call: None,
            switches: 0,
            due: Vec::new(),
            happened: Vec::new(),
            news: Vec::new(),
            left_out: 0,
        })
    }

    /// Switches the grippers that are due at `setpoint`, to which `physics` has come, and takes what happened to bodies.
    pub(super) fn act(&mut self, setpoint: &AxisSetpoint, physics: &mut PhysicsMachine) {
        self.observe(setpoint);
        let now_ns = setpoint.time_ns;
        for (_, gripper, close) in self.due.extract_if(.., |(time_ns, ..)| *time_ns <= now_ns) {
            physics.grip(gripper, close);
        }
        for event in physics.take_body_events() {
            // What goes as meant must not crowd out what does not.
            if matches!(event.kind, BodyEventKind::Gripped { .. } | BodyEventKind::Released { .. })
            {
                continue;
            }
            let distance = match event.kind {
                BodyEventKind::Missed { gripper } => self.distance(gripper, physics),
                _ => None,
            };
            let happening = BodyHappening {
                place: setpoint.place,
                time_ns: now_ns,
                kind: event.kind,
                distance,
            };
            if self.happened.len() < MOST_EVENTS {
                self.happened.push(happening);
                self.news.push(happening);
            } else {
                self.left_out += 1;
            }
        }
    }

    /// Looks for M functions that begin, and for switches that change.
    fn observe(&mut self, setpoint: &AxisSetpoint) {
        let mut begun = None;
        if let Some(call) = setpoint.m_call
            && self.last_call.replace(call.index) != Some(call.index)
        {
            begun = Some(call.number);
        }
        let before = std::mem::replace(&mut self.switches, setpoint.switches);
        for (gripper, control) in self.controls.iter().enumerate() {
            let close = match control.signal {
                GripperSignal::MFunctions([close, open]) => {
                    let of = |number| begun == Some(number);
                    of(close).then_some(true).or(of(open).then_some(false))
                }
                GripperSignal::Switch(number) => {
                    let mut changes = changed(before, setpoint.switches);
                    changes.find(|(switch, _)| *switch == number).map(|(_, on)| on)
                }
            };
            let due_ns = setpoint.time_ns.saturating_add(control.delay_ns);
            self.due.extend(close.map(|close| (due_ns, gripper, close)));
        }
    }

    /// Distance of a gripper from the nearest body, m.
    fn distance(&self, gripper: usize, physics: &PhysicsMachine) -> Option<f64> {
        let gripper = self.surroundings.grippers.get(gripper)?;
        let place = physics.link_poses().get(gripper.link)? * gripper.point;
        distance_to_bodies(&self.surroundings.bodies, &physics.body_poses(), &place)
    }

    /// What happened to bodies so far.
    pub(super) fn happened(&self) -> Vec<BodyHappening> {
        self.happened.clone()
    }

    /// The same since the last call.
    pub(super) fn news(&mut self) -> Vec<BodyHappening> {
        std::mem::take(&mut self.news)
    }

    /// Where the bodies are.
    pub(super) fn bodies(&self, physics: &PhysicsMachine) -> Vec<BodyRecord> {
        let held_by = |body: usize| {
            let mut grippers = 0..self.controls.len();
            grippers.find(|gripper| physics.held_by(*gripper) == Some(body))
        };
        let poses = physics.body_poses().into_iter().enumerate();
        poses.map(|(body, pose)| BodyRecord { pose, held_by: held_by(body) }).collect()
    }
}
