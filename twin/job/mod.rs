//! Jobs: sequences of function blocks on axes, including cams and gears, as a controller's program calls them (manual
//! chapters 4 and 5).
//!
//! A job is a program like any other. A program in DIN 66025 describes a path; a job calls `MC_MoveAbsolute`,
//! `MC_CamIn` and other blocks. Both give the same set-points to the simulated machine and to the drives.
//!
//! ```toml
//! name = "flying shear"
//! duration_s = 12                     # then every axis that leads is halted
//!
//! [[virtual_axes]]                    # masters that are not axes of the machine
//! name = "web"
//! kind = "rotary"
//! period_deg = 360
//!
//! [[blocks]]
//! block = "MC_CamIn"                  # begins when the block before is done, or in gear, in sync, at its velocity
//! axis = "X"
//! master = "web"
//! cam = "shear.cam.toml"
//!
//! [[blocks]]
//! block = "MC_MoveVelocity"
//! axis = "web"
//! velocity_deg_per_s = 180
//! acceleration_deg_per_s2 = 360
//! ```

mod along;
mod block;
mod direct;
mod engine;
mod kind;
mod pace;
mod probe;
mod read;
mod start;
mod stream;
#[cfg(test)]
mod tests;
mod values;

pub(crate) use read::read;
pub(crate) use stream::JobSetpoints;

use crate::finding::{Finding, Rule, Severity};
use block::Called;
use probe::JobTrigger;
use std::collections::BTreeMap;
use twin_machine::Machine;
use twin_machine::tappets::Tracks;
use twin_path::Place;
use twin_profile::RampType;

/// A job as it is written, for one machine.
#[derive(Debug)]
pub(crate) struct Job {
    /// Shape of the velocity ramps of its blocks.
    ramp: RampType,
    /// After so long every axis that leads is halted, s.
    duration: Option<f64>,
    /// Start positions that the job gives.
    starts: Vec<Start>,
    /// Axes behind those of the machine.
    virtual_axes: Vec<VirtualAxis>,
    /// Inputs that latch positions.
    triggers: Vec<JobTrigger>,
    /// Signals of the tappets of its cams.
    tracks: Tracks,
    /// Blocks in the order of the file.
    calls: Vec<Call>,
}

/// The blocks that jobs call, by the names of the manual.
pub(crate) fn block_names() -> impl Iterator<Item = &'static str> {
    kind::BLOCKS.iter().map(|(name, _)| *name)
}

impl Job {
    /// Every axis: name, period and unit.
    fn masters(&self, machine: &Machine) -> Vec<(String, Option<f64>, &'static str)> {
        let real = machine.axes.iter().map(|axis| {
            let period = axis.period.map(|period| axis.from_si(period));
            (axis.name.clone(), period, axis.unit())
        });
        let imagined =
            self.virtual_axes.iter().map(|axis| (axis.name.clone(), axis.period, axis.unit));
        real.chain(imagined).collect()
    }
}

/// Blocks that leave the motion of their axis to others: superimposed motion, shifts of the zero, probes.
const ON_TOP: [&str; 4] = [SUPERIMPOSED, "MC_SetPosition", "MC_TouchProbe", "MC_AbortTrigger"];

/// The superimposed motion; another one takes over from it.
const SUPERIMPOSED: &str = "MC_MoveSuperImposed";

/// The last block of each axis, by its number, if that is an `MC_CamIn`: the next block may wait for its `EndOfProfile`.
/// Blocks of other axes, such as the master's, may come between them.
#[derive(Debug, Default)]
struct CamsBefore(BTreeMap<usize, usize>);

impl CamsBefore {
    /// The one of this axis.
    fn of(&self, axis: usize) -> Option<usize> {
        self.0.get(&axis).copied()
    }

    /// The next block.
    fn pass(&mut self, index: usize, name: &str, axis: usize) {
        if name == "MC_CamIn" {
            self.0.insert(axis, index);
        } else if !ON_TOP.contains(&name) {
            self.0.remove(&axis);
        }
    }
}

/// Start position of an axis of the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Start {
    /// Its line in the file, from 1.
    line: u32,
    axis: usize,
    /// mm or degrees.
    position: f64,
}

/// A master that is not an axis of the machine.
#[derive(Clone, Debug)]
struct VirtualAxis {
    name: String,
    /// mm or deg.
    unit: &'static str,
    /// mm or degrees.
    period: Option<f64>,
    /// mm/s² or degrees/s².
    max_acceleration: Option<f64>,
    /// mm/s³ or degrees/s³.
    max_jerk: Option<f64>,
    /// mm or degrees.
    start: f64,
}

/// A block and when it is called.
#[derive(Debug)]
struct Call {
    /// The block, as in the manual.
    name: &'static str,
    /// Its line in the file, from 1.
    line: u32,
    /// Axis that it moves: those of the machine, then the virtual ones.
    axis: usize,
    /// Axis that it follows.
    master: Option<usize>,
    block: Box<dyn Called>,
    begins: Begins,
}

impl Call {
    fn place(&self) -> Place {
        Place::at(self.line)
    }

    /// An error at this block about its axis.
    fn error(&self, rule: Rule, axis: &str, message: String) -> Finding {
        let axis = Some(axis.to_owned());
        Finding { axis, ..Finding::error(rule, self.place(), message) }
    }

    /// A note at this block about its axis.
    fn note(&self, axis: &str, message: String) -> Finding {
        let severity = Severity::Note;
        Finding { severity, ..self.error(Rule::FunctionBlock, axis, message) }
    }
}

/// When a block's Execute rises.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Begins {
    /// As soon as the block before it is done: nothing is said.
    Next,
    /// So long after the block before it is done, s.
    After(f64),
    /// At this time, s.
    At(f64),
    /// With the block before it.
    WithPrevious,
    /// In the cycle in which the cam that its axis follows by a block before it shows `EndOfProfile` first.
    EndOfProfile,
    /// At the beginning, by the machine file.
    Standing,
}
