//! Surroundings of a machine for probing moves: clearance of its tool to the obstacles of its file.

use crate::probe_trip::{Clearance, TripSearch};
use crate::{DirectionRule, Machine};
use nalgebra::Vector3;
use std::sync::Arc;
use twin_gcode::rs274::{Position, Surroundings};
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
    scan: ClearanceScan,
}

/// Surroundings of `machine` that a probe can touch; `None` if its file has none.
pub(crate) fn surroundings(machine: &Machine) -> Option<Surroundings> {
    let collision = machine.collision.as_ref()?;
    let scan =
        ClearanceScan::of_tool(&machine.model, machine.axes.len(), &collision.surroundings).ok()?;
    let around = Around {
        kinematics: Arc::clone(&machine.kinematics),
        frame: machine.frame,
        direction: machine.direction,
        units: machine.axes.iter().map(|axis| axis.to_si(1.0)).collect(),
        near: machine.middle(),
        scan,
    };
    (!around.scan.is_empty()).then(|| Surroundings::new(move || TripSearch::new(around.clone())))
}

impl Clearance for Around {
    fn at(&mut self, at: &Position, point_from_tip: &[f64; 3]) -> Option<f64> {
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
        let shift = self.frame.machine_from_work() * Vector3::from(*point_from_tip);
        self.scan.nearest_shifted(&axes, &-shift).ok()?.map(|nearest| nearest.distance)
    }
}
