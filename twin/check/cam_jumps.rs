//! Jumps of the machine file's cams at the master positions that a program passes.

use crate::finding::{Finding, Rule, Severity};
use crate::job::JobSetpoints;
use crate::setpoint::AxisSetpoint;
use twin_cam::Joints;
use twin_kinematics::AxisVector;
use twin_machine::{Axis, CoupledBy, Machine};
use twin_number::seconds;
use twin_number::significant;

/// A part of a limit below which a jump is rounding.
const ROUNDING: f64 = 1e-9;

/// The cams that jump, each with where its master is.
#[derive(Debug)]
pub(super) struct CamJumps<'m> {
    machine: &'m Machine,
    cams: Vec<Watched<'m>>,
}

#[derive(Debug)]
struct Watched<'m> {
    /// Slave and master, by their places in the machine file.
    axis: usize,
    master: usize,
    /// What it is called.
    name: &'m str,
    joints: Joints,
    /// Of the master, offset and scaling; of the slave, its scaling.
    offset: f64,
    scaling: f64,
    factor: f64,
    absolute: bool,
    /// What a position of the master, in its unit, gets beside it, and where it was last.
    last: Option<(f64, f64)>,
}

impl<'m> CamJumps<'m> {
    /// Cam jumps of `machine`.
    pub(super) fn new(machine: &'m Machine) -> Self {
        let watched = |coupling: &'m twin_machine::Coupling| {
            let CoupledBy::Cam(selection) = &coupling.by else { return None };
            let (table, input) = (&selection.table, &selection.input);
            let joints = Joints::of(table.cam.curve(), table.periodic);
            (!joints.is_empty()).then(|| Watched {
                axis: coupling.axis,
                master: coupling.master,
                name: table.cam.name(),
                joints,
                offset: input.master_offset,
                scaling: input.master_scaling,
                factor: input.slave_scaling,
                absolute: table.master_absolute,
                last: None,
            })
        };
        let cams = machine.couplings.iter().filter_map(watched).collect();
        Self { machine, cams }
    }

    /// Of a job those alone that hold all the time: the others are not where their masters have them.
    pub(super) fn leave_out(&mut self, job: &JobSetpoints<'_>) {
        self.cams.retain(|cam| !job.disturbs(cam.axis, cam.master));
    }

    /// Cams that jump on the way to this set-point: the slave's axis, and the finding.
    pub(super) fn look(&mut self, setpoint: &AxisSetpoint) -> Vec<(usize, Finding)> {
        let mut found = Vec::new();
        for cam in &mut self.cams {
            let axes = self.machine.axes.get(cam.axis).zip(self.machine.axes.get(cam.master));
            if let Some((slave, master)) = axes {
                let told = cam.look(setpoint, (slave, master), seconds(self.machine.cycle_ns));
                found.extend(told.into_iter().map(|finding| (cam.axis, finding)));
            }
        }
        found
    }
}

impl Watched<'_> {
    fn look(
        &mut self,
        setpoint: &AxisSetpoint,
        (slave, master): (&Axis, &Axis),
        cycle: f64,
    ) -> Vec<Finding> {
        let of = |values: &AxisVector| {
            master.from_si(values.get(self.master).copied().unwrap_or_default())
        };
        let position = of(&setpoint.axes.position);
        let Some((shift, before)) = self.last else {
            // As it shows itself, within its period; counted from there where the cam is relative.
            let period = master.period.map(|period| master.from_si(period));
            let shown = period.map_or(position, |period| position.rem_euclid(period));
            let shift = if self.absolute { shown - position } else { -position };
            self.last = Some((shift, position));
            return Vec::new();
        };
        self.last = Some((shift, position));
        let place = |position: f64| (position + shift) * self.scaling + self.offset;
        let (from, to) = (place(before), place(position));
        let rate = (of(&setpoint.axes.velocity) * self.scaling).abs();
        let [limit_v, limit_a] =
            [slave.max_velocity, slave.smallest_acceleration()].map(|limit| slave.from_si(limit));
        let names =
            [("position", "", 1.0, limit_v * cycle), ("velocity", "/s", rate, limit_a * cycle)];
        let mut found = Vec::new();
        for (joint, (index, (name, per, times, bears))) in
            self.joints.passed(from, to).into_iter().zip(names.into_iter().enumerate())
        {
            let Some(joint) = joint else { continue };
            // Positions fall where the master goes back; a velocity changes by as much both ways.
            let sign = if index == 0 && to < from { -1.0 } else { 1.0 };
            let by = sign * times * self.factor * joint.rises.get(index).copied().unwrap_or(0.0);
            if by.abs() <= ROUNDING * bears {
                continue;
            }
            let at = (joint.place - self.offset) / self.scaling - shift;
            let (unit, of_master) = (slave.unit(), master.unit());
            let message = format!(
                "the {name} of axis {} jumps by {} {unit}{per} where its cam {} has its master {} at {} {of_master}",
                slave.name,
                significant(by, 6),
                self.name,
                master.name,
                significant(at, 6),
            );
            let mut finding = Finding::error(Rule::CamContinuity, setpoint.place, message);
            // What an axis does within a cycle is a step for nobody but the cam.
            if index == 1 && by.abs() <= bears {
                finding.severity = Severity::Warning;
            }
            finding.axis = Some(slave.name.clone());
            finding.hint =
                Some(format!("`twin cam check` shows where the cam {} jumps", self.name));
            found.push(finding);
        }
        found
    }
}
