//! Scenario: faults of the simulated machine, and their start.
//!
//! ```toml
//! [[faults]]
//! axis = "X"                # a power loss may leave it out: then it is all axes
//! at_line = 12              # when the first set-point of this line is due; or …
//! # at_s = 3.5              # … so long after the start of the program
//! kind = "jam"              # "jam", "lost_steps", "loose_belt" or "power_loss"
//! for_s = 0.5               # jam: how long; by default forever
//! # steps = 8               # lost_steps: full steps of the pulse train that do not reach the motor
//! # stiffness_percent = 20  # loose_belt: what is left; default 100
//! # backlash_mm = 0.2       # loose_belt: play that is added (backlash_deg); default 0
//! ```

use super::{Axis, Machine};
use crate::section::{self, MachineFileError, Problem, Section};
use std::path::Path;

/// Faults that a scenario injects.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scenario {
    /// Of noise.
    pub seed: u64,
    /// In the order of the file.
    pub faults: Vec<FaultAt>,
}

/// A fault and when it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultAt {
    /// Axis in machine-file order; `None`: all of them.
    pub axis: Option<usize>,
    /// Its start.
    pub start: FaultStart,
    /// Its kind.
    pub kind: FaultKind,
}

/// Start of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultStart {
    /// Time after the start of the program, ns.
    Time(i64),
    /// With the first set-point of this line.
    Line(u32),
}

/// A fault. SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// The axis does not move, for this time (ns) or forever.
    Jam(Option<i64>),
    /// The next full steps of the pulse train do not reach the step motor.
    LostSteps(f64),
    /// The belt is softer by this factor, and has this much more play (m or rad).
    LooseBelt {
        /// Part of the stiffness that is left.
        stiffness: f64,
        /// m or rad.
        backlash: f64,
    },
    /// No power.
    PowerLoss,
}

impl Scenario {
    /// Reads a scenario for `machine`.
    ///
    /// # Errors
    /// [`MachineFileError`] with everything that is wrong with it.
    pub fn load(path: &Path, machine: &Machine) -> Result<Self, MachineFileError> {
        section::load("scenario", path, |text| Self::parse(text, machine))
    }

    /// Reads the text of one.
    ///
    /// # Errors
    /// With everything that is wrong with it, in file order.
    pub fn parse(text: &str, machine: &Machine) -> Result<Self, Vec<Problem>> {
        section::parse(text, |root| {
            let sections = root.sections("faults");
            if sections.is_empty() {
                root.complain("the scenario lacks [[faults]]");
            }
            let faults: Vec<_> = sections.iter().map(|one| fault(one, machine)).collect();
            sections.into_iter().for_each(Section::finish);
            root.check_unknown();
            Some(Self { seed: 0, faults: faults.into_iter().collect::<Option<_>>()? })
        })
    }
}

/// Seconds as ns.
#[expect(clippy::cast_possible_truncation, reason = "at most 10^6 s")]
fn ns(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

fn fault(section: &Section<'_>, machine: &Machine) -> Option<FaultAt> {
    let kinds = ["jam", "lost_steps", "loose_belt", "power_loss"].map(|kind| (kind, kind));
    let Some(kind) = section.required_choice("kind", &kinds) else {
        section.accept_all();
        return None;
    };
    let names: Vec<_> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
    let choices: Vec<_> = names.iter().enumerate().map(|(index, name)| (*name, index)).collect();
    let no_power = kind == "power_loss";
    let index = if no_power {
        section.choice("axis", &choices)
    } else {
        section.required_choice("axis", &choices)
    };
    let start = start(section);
    let axis = index.and_then(|index| machine.axes.get(index));
    let kind = match kind {
        "power_loss" => Some(FaultKind::PowerLoss),
        "jam" => Some(FaultKind::Jam(section.number("for_s", 1e-3..=1e6).map(ns))),
        "lost_steps" => {
            let steps = section.required_number("steps", 1e-3..=1e9);
            if let Some(axis) = axis
                && !axis.simulated.steps()
            {
                section.complain_at("kind", format!("axis {} has no step motor", axis.name));
            }
            steps.map(FaultKind::LostSteps)
        }
        _ => axis.and_then(|axis| loose_belt(section, axis)),
    };
    Some(FaultAt { axis: if no_power { index } else { Some(index?) }, start: start?, kind: kind? })
}

fn loose_belt(section: &Section<'_>, axis: &Axis) -> Option<FaultKind> {
    let left = section.number("stiffness_percent", 0.01..=100.0).unwrap_or(100.0);
    let backlash = section.number(&format!("backlash_{}", axis.unit()), 0.0..=1e3);
    if axis.simulated.transmission.is_none() {
        let message =
            format!("the transmission of axis {} is rigid: it has no stiffness", axis.name);
        section.complain_at("kind", message);
        return None;
    }
    if !section.has("stiffness_percent") && backlash.is_none() {
        let key = format!("backlash_{}", axis.unit());
        section.complain(format!("a loose belt needs `stiffness_percent`, `{key}` or both"));
    }
    let backlash = axis.to_si(backlash.unwrap_or(0.0));
    Some(FaultKind::LooseBelt { stiffness: left * 0.01, backlash })
}

fn start(section: &Section<'_>) -> Option<FaultStart> {
    let time = section.number("at_s", 0.0..=1e6).map(|seconds| FaultStart::Time(ns(seconds)));
    let line = section.integer("at_line", 1..=i64::from(u32::MAX));
    let line = line.and_then(|line| u32::try_from(line).ok()).map(FaultStart::Line);
    if section.has("at_s") == section.has("at_line") {
        section.complain("a fault begins `at_s` or `at_line`, one of them");
    }
    time.or(line)
}
