//! Run findings: following errors, faults and collisions that only a run shows.

use super::messages;
use crate::compare::Comparison;
use crate::finding::Finding;
use crate::plant::{Happening, PlantRecord};
use crate::tolerance::exceeds;
use twin_machine::Machine;

/// Following errors of the simulated machine in a run that are beyond the limits of the machine file.
pub fn following_errors(machine: &Machine, comparison: &Comparison) -> Vec<Finding> {
    let axes = machine.axes.iter().zip(&comparison.axes);
    let beyond = axes.filter_map(|(axis, statistics)| {
        let (error, place) = statistics.twin.maximum()?;
        let limit = axis.max_following_error.filter(|limit| exceeds(error, *limit))?;
        Some(messages::too_far(axis, place, error, limit))
    });
    beyond.collect()
}

/// Following errors of the drives in a run that are beyond the limits of the machine file, with their probable `cause`.
pub fn drive_errors(machine: &Machine, comparison: &Comparison, cause: &str) -> Vec<Finding> {
    let axes = machine.axes.iter().zip(&comparison.axes);
    let beyond = axes.filter_map(|(axis, statistics)| {
        let (error, place) = statistics.drives.maximum()?;
        let limit = axis.max_following_error.filter(|limit| exceeds(error, *limit))?;
        Some(messages::drive_was_too_far(axis, place, error, limit, cause))
    });
    beyond.collect()
}

/// The faults that a run to its end has not begun.
pub fn faults_to_come(machine: &Machine, record: &PlantRecord) -> Vec<Finding> {
    record.faults_to_come.iter().map(|fault| messages::never_began(machine, fault)).collect()
}

/// One thing that happened to the simulated machine, in words.
pub fn happening(machine: &Machine, happening: &Happening) -> Option<Finding> {
    messages::happened(machine, happening)
}

/// Events of the simulated machine in a run.
pub fn happenings(machine: &Machine, record: &PlantRecord) -> Vec<Finding> {
    let blows = record.blows.iter().map(|blow| messages::ran_into(machine, blow));
    let others = record.happenings.iter().filter_map(|one| messages::happened(machine, one));
    let touches = record.touches.iter().filter_map(|touch| messages::touched(machine, touch));
    let missed = record.missed.iter().map(messages::missed);
    blows.chain(touches).chain(missed).chain(others).collect()
}
