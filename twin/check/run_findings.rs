//! Run findings: following errors, faults and collisions that only a run shows.

use super::following::PredictedFollowing;
use super::{handling, messages};
use crate::compare::Comparison;
use crate::finding::Finding;
use crate::plant::{BodyHappening, Happening, PlantRecord};
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

/// Following errors of emulated drives in a run that are beyond the limits of the machine file, with their cause: this computer,
/// if `busy` says so, the wire, if they were `predicted`, or the axis.
pub fn drive_errors(
    machine: &Machine,
    comparison: &Comparison,
    predicted: Option<&PredictedFollowing>,
    busy: Option<&str>,
) -> Vec<Finding> {
    let axes = machine.axes.iter().zip(&comparison.axes).enumerate();
    let beyond = axes.filter_map(|(index, (axis, statistics))| {
        let (error, place) = statistics.drives.maximum()?;
        let limit = axis.max_following_error.filter(|limit| exceeds(error, *limit))?;
        let predicted = predicted.and_then(|of| of.axes.get(index)?.as_ref()?.maximum());
        let cause = match (busy, predicted) {
            (Some(busy), _) => busy,
            (None, Some((predicted, _))) if exceeds(predicted, limit) => {
                "its wire does not carry more, as predicted"
            }
            _ => "its drive cannot follow the axis",
        };
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

/// One thing that happened to a loose body or a gripper, in words; `None` if it went as meant.
pub fn handled(machine: &Machine, happening: &BodyHappening) -> Option<Finding> {
    handling::finding(machine, happening)
}

/// Events of the simulated machine in a run.
pub fn happenings(machine: &Machine, record: &PlantRecord) -> Vec<Finding> {
    let blows = record.blows.iter().map(|blow| messages::ran_into(machine, blow));
    let others = record.happenings.iter().filter_map(|one| messages::happened(machine, one));
    let touches = record.touches.iter().filter_map(|touch| messages::touched(machine, touch));
    let missed = record.missed.iter().map(messages::missed);
    let handled = record.handled.iter().filter_map(|one| handled(machine, one));
    blows.chain(touches).chain(missed).chain(handled).chain(others).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Statistics;
    use std::path::Path;
    use twin_path::Place;

    /// 0.7 mm where 0.5 are allowed.
    #[test]
    fn errors_of_emulated_drives_have_a_cause() {
        let text = include_str!("../../machines/gantry3.toml");
        let machine = Machine::parse(Path::new("machine.toml"), text).unwrap();
        let place = Place::at(7);
        let of = |error: f64| {
            let mut statistics = Statistics::default();
            statistics.include(error, place);
            statistics
        };
        let mut comparison = Comparison::new(machine.axes.len());
        comparison.axes[0].drives = of(0.7e-3);
        comparison.axes[1].drives = of(0.4e-3);
        let predicted = |error: f64| {
            let axes = vec![Some(of(error)), None, None];
            PredictedFollowing { axes, ..PredictedFollowing::default() }
        };
        let found = |error: f64, busy: Option<&str>| {
            let found = drive_errors(&machine, &comparison, Some(&predicted(error)), busy);
            let [finding] = &found[..] else { panic!("{found:?}") };
            assert_eq!((finding.line, finding.axis.as_deref()), (7, Some("X")), "{finding:?}");
            assert!(crate::finding::unfit(&found));
            finding.message.clone()
        };
        assert!(
            found(0.6e-3, Some("this computer was busy")).ends_with(": this computer was busy")
        );
        assert!(found(0.6e-3, None).ends_with(": its wire does not carry more, as predicted"));
        assert!(found(0.1e-3, None).ends_with(": its drive cannot follow the axis"));
    }
}
