//! Surroundings of a machine for probing moves: clearance of the tool in its spindle to the obstacles of its file.

use crate::probe_trip::{Clearance, TripSearch};
use crate::tool::SpindleBodies;
use crate::{DirectionRule, Machine};
use nalgebra::Vector3;
use std::sync::Arc;
use twin_gcode::rs274::{Position, ProbePath, Surroundings, ToolTable};
use twin_kinematics::{AxisSource, AxisVector, Kinematics, MachineAxes, Pose, WorkFrame};
use twin_physics::ClearanceScan;

/// The tool of a machine among what its file says is around it.
#[derive(Clone, Debug)]
struct Around {
    kinematics: Arc<MachineAxes>,
    frame: WorkFrame,
    direction: DirectionRule,
    /// Unit of the axes: radians or metres of what the program gives them.
    units: Vec<f64>,
    /// Last positions of the axes.
    near: AxisVector,
    bodies: Arc<SpindleBodies>,
    tools: ToolTable,
    probe: Probe,
}

/// The tool that probes.
#[derive(Clone, Debug)]
struct Probe {
    scan: ClearanceScan,
    /// Its number.
    tool: u32,
    /// Its tip is where the table says; else it is at the tip of the tool offset in force.
    has_own_tip: bool,
}

impl Probe {
    /// Tool `number` of `tools`, or the tool of the machine file.
    fn new(bodies: &SpindleBodies, tools: &ToolTable, number: u32) -> Option<Self> {
        let tool = tools.get(number);
        let scan = bodies.probe_scan(tool).ok()?;
        Some(Self { scan, tool: number, has_own_tip: bodies.changes_with(tool) })
    }
}

/// Surroundings of `machine` that a probe can touch; `None` if its file has none.
pub(crate) fn surroundings(machine: &Machine) -> Option<Surroundings> {
    let bodies = Arc::new(machine.spindle_bodies()?);
    let tools = ToolTable::default();
    let probe = Probe::new(&bodies, &tools, 0)?;
    let around = Around {
        kinematics: Arc::clone(&machine.kinematics),
        frame: machine.frame,
        direction: machine.direction,
        units: machine.axes.iter().map(|axis| axis.to_si(1.0)).collect(),
        near: machine.middle(),
        bodies,
        tools,
        probe,
    };
    let is_empty = around.probe.scan.is_empty();
    (!is_empty).then(|| {
        Surroundings::new(move |tools| {
            TripSearch::new(Around { tools: tools.clone(), ..around.clone() })
        })
    })
}

impl Clearance for Around {
    fn at(&mut self, at: &Position, path: &ProbePath) -> Option<f64> {
        if self.probe.tool != path.tool {
            self.probe = Probe::new(&self.bodies, &self.tools, path.tool)?;
        }
        let extra = at.extra_axes();
        let extra = |number: u8| extra.get(usize::from(number)).copied().unwrap_or_default();
        let direction = match self.direction {
            DirectionRule::Additional(number, angle) => angle + extra(number).to_radians(),
            rule @ (DirectionRule::Path(..) | DirectionRule::Fixed(_)) => rule.at_start(),
        };
        let pose = Pose { position: at.linear.into(), direction };
        let pose = self.frame.pose_to_machine(&pose);
        let mut axes = self.kinematics.inverse(&pose, &self.near).ok()?;
        let sources = self.kinematics.sources().iter().zip(&self.units);
        for (position, (source, unit)) in axes.iter_mut().zip(sources) {
            if let AxisSource::Additional(number) = *source {
                *position = extra(number) * unit;
            }
        }
        self.near = axes;
        // The tool in force hangs below the point that the axes move.
        let below = if self.probe.has_own_tip { [0.0; 3] } else { path.point_from_tip };
        let shift = self.frame.machine_from_work() * Vector3::from(below);
        self.probe.scan.nearest_shifted(&axes, &-shift).ok()?.map(|nearest| nearest.distance)
    }
}
