//! Items of a set-point source, which may be the controller, the axis-limited plan or a job.

use crate::bridge::BridgeSetpoint;
use crate::finding::Finding;
use crate::program::ProgramItem;
use crate::setpoint::AxisSetpoint;
use std::io;
use twin_planner::controller::{Override, ToolSetpoint};

/// The least override that moves anything; less is a feed hold.
pub const LEAST_OVERRIDE: f64 = Override::LEAST;
/// The largest override.
pub const MOST_OVERRIDE: f64 = 2.0;

/// Items of a program, one after the other.
#[derive(Debug)]
pub(crate) enum PlanItem {
    /// Where the tool shall be at the next instant, which the transform makes axes of.
    Tool(ToolSetpoint),
    /// Where the axes are between two set-points of the tool: a gap is bridged.
    Bridging(BridgeSetpoint),
    /// Where the axes shall be then.
    Axes(Box<AxisSetpoint>),
    /// What is wrong with the program.
    Diagnostic(Finding),
    /// The file cannot be read any further.
    Io(io::Error),
}

impl From<ProgramItem> for PlanItem {
    fn from(item: ProgramItem) -> Self {
        match item {
            ProgramItem::Setpoint(tool) => Self::Tool(tool),
            ProgramItem::Diagnostic(finding) => Self::Diagnostic(finding),
            ProgramItem::Io(error) => Self::Io(error),
        }
    }
}
