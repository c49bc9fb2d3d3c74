//! Rest positions of the axes of a stopped run.

use crate::compare::Measured;
use crate::hardware::LastHeard;
use crate::setpoint::AxisSetpoint;
use std::fmt::Write;
use twin_machine::Machine;
use twin_number::seconds;
use twin_path::Place;

/// Rest positions of the axes before the end of the program.
#[derive(Clone, Debug)]
pub struct Rest {
    /// Time of the user's request, if the user stopped the run, ns.
    pub asked_ns: Option<i64>,
    /// The first set-point at rest, ns.
    pub time_ns: i64,
    /// Its block.
    pub place: Place,
    /// Tool and axes of this set-point.
    pub wanted: Measured,
    /// Final position of the simulated machine, unless it has failed.
    pub twin: Option<Measured>,
    /// Time of the last sample of the drives, ns, and their positions.
    pub drives: Option<(i64, Measured)>,
}

impl Rest {
    /// In words, with the names and units of a machine.
    pub fn message(&self, machine: &Machine) -> String {
        let mut told = String::new();
        let time = seconds(self.time_ns);
        let place = self.place;
        // Writing to a string cannot fail.
        let mut tell = |text: std::fmt::Arguments<'_>| told.write_fmt(text).unwrap_or_default();
        if let Some(asked_ns) = self.asked_ns {
            tell(format_args!("the stop was asked for at {:.3} s; ", seconds(asked_ns)));
        }
        let at = positions(machine, &self.wanted);
        match &self.drives {
            None => tell(format_args!("the axes came to rest at {time:.3} s, {place}: {at}")),
            Some((heard_ns, drives)) => {
                tell(format_args!("the set-points came to rest at {time:.3} s, {place}: {at}"));
                let (heard, at) = (seconds(*heard_ns), positions(machine, drives));
                tell(format_args!("; the drives were last heard of at {heard:.3} s: {at}"));
            }
        }
        told
    }
}

/// Last known axis positions of each device, a line each; nothing unless one of them has failed.
pub fn whereabouts(machine: &Machine, heard: &[LastHeard]) -> Vec<String> {
    if !heard.iter().any(|one| one.lost) {
        return Vec::new();
    }
    let line = |one: &LastHeard| {
        let axes = one.axes.iter().filter_map(|(index, position)| {
            let axis = machine.axes.get(*index)?;
            Some(format!("{} {:.4} {}", axis.name, axis.from_si(*position), axis.unit()))
        });
        let at = axes.collect::<Vec<_>>().join(", ");
        let unknown = if one.lost { "; its position since then is not known" } else { "" };
        let time = seconds(one.time_ns);
        format!("device `{}` was last heard of at {time:.3} s: {at}{unknown}", one.device)
    };
    heard.iter().map(line).collect()
}

/// Of axes and tool, in words.
fn positions(machine: &Machine, measured: &Measured) -> String {
    let axes = machine.axes.iter().zip(measured.axes.iter()).map(|(axis, position)| {
        format!("{} {:.4} {}", axis.name, axis.from_si(*position), axis.unit())
    });
    let [x, y, z] = [measured.tool.x, measured.tool.y, measured.tool.z].map(|value| value * 1e3);
    format!("{}; tool at X {x:.4} Y {y:.4} Z {z:.4} mm", axes.collect::<Vec<_>>().join(", "))
}

/// Watches where everything rests.
#[derive(Clone, Debug, Default)]
pub(super) struct Resting {
    /// Time of the user's first stop request.
    pub(super) asked_ns: Option<i64>,
    /// The first of the set-points that are where the last one is.
    setpoint: Option<AxisSetpoint>,
    /// The simulated machine as it was last seen.
    pub(super) twin: Option<Measured>,
    /// Time and positions of the last sample of the drives.
    pub(super) drives: Option<(i64, Measured)>,
}

impl Resting {
    /// A set-point is executed.
    pub(super) fn executed(&mut self, setpoint: &AxisSetpoint) {
        if self.setpoint.is_none_or(|rests| rests.axes.position != setpoint.axes.position) {
            self.setpoint = Some(*setpoint);
        }
    }

    /// Rest positions; none if nothing was executed. Axes that were at rest at the request came to rest then.
    pub(super) fn rest(self) -> Option<Rest> {
        let Self { asked_ns, setpoint, twin, drives } = self;
        let AxisSetpoint { time_ns, place, axes, tool, .. } = setpoint?;
        let wanted = Measured { axes: axes.position, tool: tool.pose.position };
        let time_ns = time_ns.max(asked_ns.unwrap_or(i64::MIN));
        Some(Rest { asked_ns, time_ns, place, wanted, twin, drives })
    }
}
