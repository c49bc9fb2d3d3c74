//! Report of the rest positions of a stopped run.

use crate::compare::Measured;
use crate::per_axis::PerAxis;
use crate::session::Rest;
use twin_machine::Machine;
use twin_number::{rounded, seconds};

/// Rest positions of the axes.
#[derive(Clone, Debug, serde::Serialize)]
pub struct RestReport {
    /// When the user asked for it, s since the start of the program; null if something else stopped the run.
    asked_s: Option<f64>,
    /// The first set-point at rest, s since the start of the program.
    time_s: f64,
    line: u32,
    block: Option<u32>,
    axes: PerAxis<AxisRest>,
    tool_mm: ToolRest,
    /// When the drives were last heard of, s since the start of the program.
    drives_heard_s: Option<f64>,
}

/// Where one axis came to rest, in its unit.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct AxisRest {
    unit: &'static str,
    setpoint: f64,
    twin: Option<f64>,
    drives: Option<f64>,
}

/// Where the tool tip came to rest in the machine frame: x, y, z.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct ToolRest {
    setpoint: [f64; 3],
    twin: Option<[f64; 3]>,
    drives: Option<[f64; 3]>,
}

impl RestReport {
    /// On a machine.
    pub fn new(machine: &Machine, rest: &Rest) -> Self {
        let drives = rest.drives.as_ref().map(|(_, measured)| measured);
        let twin = rest.twin.as_ref();
        let axes = machine.axes.iter().enumerate().map(|(index, axis)| {
            let position = |of: &Measured| {
                rounded(axis.from_si(of.axes.get(index).copied().unwrap_or_default()))
            };
            let (twin, drives) = (twin.map(position), drives.map(position));
            let rest =
                AxisRest { unit: axis.unit(), setpoint: position(&rest.wanted), twin, drives };
            (axis.name.clone(), rest)
        });
        let tool = |of: &Measured| {
            [of.tool.x, of.tool.y, of.tool.z].map(|component| rounded(component * 1e3))
        };
        Self {
            asked_s: rest.asked_ns.map(seconds),
            time_s: rounded(seconds(rest.time_ns)),
            line: rest.place.line,
            block: rest.place.block,
            axes: PerAxis(axes.collect()),
            tool_mm: ToolRest {
                setpoint: tool(&rest.wanted),
                twin: twin.map(tool),
                drives: drives.map(tool),
            },
            drives_heard_s: rest.drives.as_ref().map(|(heard_ns, _)| seconds(*heard_ns)),
        }
    }
}
