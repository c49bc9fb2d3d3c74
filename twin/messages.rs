//! Messages of findings that check, limit, planning and jobs share: the fault, with value and limit.

use crate::bridge::Bridge;
use crate::finding::{Finding, Rule, Severity};
use crate::tolerance::ROUNDING;
use nalgebra::Vector3;
use std::collections::BTreeSet;
use std::path::Path;
use twin_kinematics::{Kinematics, KinematicsError, ReachOf};
use twin_machine::axis_couplings::AxesError;
use twin_machine::axis_kind::AxisKind;
use twin_machine::cam_file::CamRemark;
use twin_machine::{Axis, Machine};
use twin_number::{counted, seconds};
use twin_path::Place;
use twin_viz::Ended;

/// An axis that goes less than this across a gap is not named, m or rad.
const STAYS: f64 = 5e-7;

/// A gap of the path that the axes cross, inside a program or, if `is_first`, before it.
pub(crate) fn bridged(machine: &Machine, bridge: &Bridge, is_first: bool) -> Finding {
    let ways = machine.axes.iter().zip(bridge.ways()).filter(|(_, way)| way.abs() > STAYS);
    let ways: Vec<_> = ways
        .map(|(axis, way)| format!("{} by {:+.3} {}", axis.name, axis.from_si(way), axis.unit()))
        .collect();
    let message = format!(
        "{}: each axis moves there at its own limits, {}, in {:.3} s, as SMC_ControlAxisByPos does",
        if is_first {
            "the program begins elsewhere than the one before ended"
        } else {
            "the set-point jumps here"
        },
        ways.join(", "),
        bridge.duration()
    );
    let finding = Finding::error(Rule::Gap, bridge.place, message);
    Finding { severity: Severity::Note, ..finding }
}

/// A recording, log or report, by its kind and file, that ended before the run.
pub(crate) fn recording_ended(kind: &str, file: &Path, ended: &Ended) -> Finding {
    let Ended { time_ns, line, cause, lost } = ended;
    let records = counted(usize::try_from(*lost).unwrap_or(usize::MAX), "record");
    let lost = if *lost > 0 { format!("; {records} lost") } else { String::new() };
    let (time, file) = (seconds(*time_ns), file.display());
    let message = format!("the {kind} {file} ended at {time:.3} s: {cause}{lost}");
    let place = Place::at(*line);
    let hint = "make room, or name a file on another disk; the run went on without it".to_owned();
    let finding = Finding::error(Rule::RecordingEnded, place, message);
    Finding { severity: Severity::Warning, hint: Some(hint), ..finding }
}

/// A set-point without axis positions.
pub(crate) fn no_axes(place: Place, error: &AxesError) -> Finding {
    match error {
        AxesError::Kinematics(error) => unreachable(place, error),
        AxesError::Moved { axis, from, to, unit, .. } => {
            let mut finding = Finding::error(Rule::Coupling, place, error.to_string());
            finding.axis = Some(axis.clone());
            finding.with_value(*to, *from, unit)
        }
        AxesError::Begins { axis, from, at, unit, .. } => {
            let mut finding = Finding::error(Rule::Coupling, place, error.to_string());
            finding.axis = Some(axis.clone());
            finding.hint =
                Some("leave the slave out, or lay the cam there (`slave_offset_…`)".to_owned());
            finding.with_value(*from, *at, unit)
        }
        AxesError::Cam { axis, .. } => {
            let mut finding = Finding::error(Rule::Coupling, place, error.to_string());
            finding.axis = Some(axis.clone());
            finding
        }
    }
}

/// Remark about elements of a cam: the author may have meant another one.
pub(crate) fn cam_remark(place: Place, axis: Option<String>, remark: &CamRemark) -> Finding {
    let mut finding = Finding::error(Rule::CamContinuity, place, remark.text.clone());
    let severity = if remark.is_note { Severity::Note } else { Severity::Warning };
    (finding.severity, finding.axis) = (severity, axis);
    finding
}

/// A master that is on tappets of its slave's cam when the cam begins.
pub(crate) fn starts_on_tappets(
    place: Place,
    [slave, master]: [&str; 2],
    groups: &[i16],
) -> Finding {
    // On a periodic cam a group may have a tappet at the end and one at the begin.
    let groups: BTreeSet<_> = groups.iter().collect();
    let listed: Vec<_> = groups.iter().map(ToString::to_string).collect();
    let (plural, act) = if groups.len() == 1 { ("", "it acts") } else { ("s", "they act") };
    let message = format!(
        "axis {master} is at the tappet{plural} of group{plural} {} when the cam of {slave} begins: {act} the next time the axis comes there, not at the start",
        listed.join(", ")
    );
    let mut finding = Finding::error(Rule::FunctionBlock, place, message);
    (finding.severity, finding.axis) = (Severity::Note, Some(slave.to_owned()));
    finding
}

/// Half of what is shown of a length, m.
const ROUNDED: f64 = 5e-5;

/// Advice to move the part, m, machine frame. Coordinates are rounded to 0.1 mm, and it is moved no less for that.
pub(crate) fn move_part(by: &Vector3<f64>) -> String {
    // The largest one counts in any case.
    let least = ROUNDED.min(0.5 * by.amax());
    let by = by.map(|way| if way.abs() > least { way + ROUNDED.copysign(way) } else { 0.0 });
    let coordinates = ["X", "Y", "Z"].into_iter().zip(by.iter());
    let moved = coordinates.filter(|(_, way)| **way != 0.0);
    let moved: Vec<_> = moved.map(|(name, way)| format!("{name}{:+.1}", way * 1e3)).collect();
    format!("move the part by {} mm", moved.join(" "))
}

/// A set-point that the kinematics refuses.
pub(crate) fn unreachable(place: Place, error: &KinematicsError) -> Finding {
    let (rule, what) = match error {
        KinematicsError::Singular(_) => (Rule::Singularity, "the tool cannot go on as programmed"),
        _ => (Rule::Reach, "the tool cannot be there"),
    };
    let finding = Finding::error(rule, place, format!("{what}: {error}"));
    match error {
        KinematicsError::Unreachable { target, of, distance, reach: [near, far] } => {
            let limit = if *distance < *near { *near } else { *far };
            let mut finding = finding.with_value(distance * 1e3, limit * 1e3, "mm");
            let outwards = Vector3::new(target[0], target[1], 0.0).try_normalize(0.0);
            if let (ReachOf::Arms, Some(outwards)) = (of, outwards) {
                finding.hint = Some(move_part(&(outwards * (limit - distance))));
            }
            finding
        }
        _ => finding,
    }
}

/// Adds the move of the part to findings about positions of linear axes, where it is the same everywhere: not on tripods, whose
/// axes move the tool as all of them are.
pub(crate) fn add_moves(machine: &Machine, findings: &mut [Finding]) {
    let middle = machine.middle();
    let Ok(from) = machine.kinematics.forward(&middle) else { return };
    let beyond =
        |finding: &&mut Finding| finding.rule == Rule::AxisPosition && finding.hint.is_none();
    for finding in findings.iter_mut().filter(beyond) {
        let named = |axis: &(usize, &Axis)| Some(&axis.1.name) == finding.axis.as_ref();
        let Some((index, axis)) = machine.axes.iter().enumerate().find(named) else { continue };
        let Some((value, limit)) = finding.value.zip(finding.limit) else { continue };
        if axis.kind == AxisKind::Rotary || machine.kind.starts_with("tripod") {
            continue;
        }
        let mut moved = middle;
        if let Some(position) = moved.get_mut(index) {
            *position += axis.to_si(limit - value);
        }
        if let Ok(to) = machine.kinematics.forward(&moved) {
            let by = to.position - from.position;
            finding.hint = (by.norm() > 0.0).then(|| move_part(&by));
        }
    }
}

/// An axis beyond its software limits.
pub(crate) fn beyond_position(axis: &Axis, place: Place, position: f64) -> Option<Finding> {
    let [low, high] = axis.position_limits;
    let tolerance = ROUNDING * (high - low);
    let limit = if position < low - tolerance {
        low
    } else if position > high + tolerance {
        high
    } else {
        return None;
    };
    let (value, limit, unit) = (axis.from_si(position), axis.from_si(limit), axis.unit());
    let side = if position < low { "below" } else { "above" };
    let message = format!(
        "axis {} at {value:.3} {unit} is {side} its software limit of {limit:.3} {unit}",
        axis.name
    );
    let mut finding =
        Finding::error(Rule::AxisPosition, place, message).with_value(value, limit, unit);
    finding.axis = Some(axis.name.clone());
    Some(finding)
}
