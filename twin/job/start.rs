//! Start positions of the axes of a job.

use super::{Begins, Call, Start};
use crate::finding::{Finding, Rule};
use crate::messages::no_axes;
use twin_kinematics::AxisVector;
use twin_machine::Machine;
use twin_machine::axis_couplings::AxisCouplings;
use twin_path::Place;

/// Start positions of the axes, in their units: those of programs, or those that the job has `said`. Relative cams of the
/// machine file count from the start of programs.
///
/// # Errors
/// If there is no such position, or a slave of the machine file cannot be at the position that its master gives.
pub(super) fn starts(
    machine: &Machine,
    said: &[Start],
    calls: &mut [Call],
) -> Result<Vec<f64>, Box<Finding>> {
    let first = Place::at(1);
    let all = (0..machine.axes.len()).all(|axis| said.iter().any(|start| start.axis == axis));
    // Slaves get the positions that their masters give below.
    let axes = match machine.start_without_slaves() {
        Some(axes) => axes,
        // The job gives every position.
        None if all => machine.middle(),
        None => {
            let message = "the machine cannot reach `start_mm` of its file, where programs start: give the start of every axis in [[start]]";
            return Err(Finding::error(Rule::Reach, first, message.to_owned()).into());
        }
    };
    let shown = machine.axes.iter().zip(axes.iter()).map(|(axis, value)| axis.from_si(*value));
    let mut start: Vec<_> = shown.collect();
    for Start { axis, position, .. } in said {
        if let Some(slot) = start.get_mut(*axis) {
            *slot = *position;
        }
    }
    if machine.couplings.is_empty() {
        return Ok(start);
    }
    let values = machine.axes.iter().zip(&start).map(|(axis, value)| axis.to_si(*value));
    let own = AxisVector::from_values(values);
    let coupled = AxisCouplings::at_rest(machine, own).map_err(|error| no_axes(first, &error))?;
    for Start { line, axis, .. } in said {
        let place = Place::at(*line);
        twin_machine::axis_couplings::begins_at(machine, *axis, &own, &coupled)
            .map_err(|error| no_axes(place, &error))?;
    }
    let shown = machine.axes.iter().zip(coupled.iter()).map(|(axis, value)| axis.from_si(*value));
    let own = std::mem::replace(&mut start, shown.collect());
    for call in calls.iter_mut().filter(|call| call.begins == Begins::Standing) {
        let before_and_now = own.get(call.axis).zip(start.get(call.axis));
        if call.block.cam_start().is_some_and(|begins| begins.relative)
            && let Some((before, now)) = before_and_now
        {
            call.block.lay(before - now);
        }
    }
    Ok(start)
}
