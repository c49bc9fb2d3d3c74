//! Messages of the check: the fault, with value and limit.

use super::BlockClearance;
use crate::finding::{Finding, Rule, Severity};
use crate::messages::beyond_position;
use crate::plant::{Blow, Happening, ProbeMiss, ProbeTouch};
use crate::program::Dialect;
use std::collections::BTreeSet;
use twin_cam::MAX_TRIGGERS;
use twin_kinematics::Kinematics;
use twin_machine::axis_kind::AxisKind;
use twin_machine::{Axis, FaultAt, FaultStart, Machine, SimulationError, VelocitySource};
use twin_number::seconds;
use twin_path::Place;
use twin_physics::{EventKind, Fault, Part};

/// An axis that is farther than this from where it is sent, m or rad, beyond its software limits, is not only following behind.
const RUN_AWAY: f64 = 2e-3;

/// Tappets beyond the number that a cam reports per cycle.
pub(super) fn lost_tappets(count: u64) -> Finding {
    let message = format!(
        "lost tappets: {count}; in a cycle the master passed more than the {MAX_TRIGGERS} that a cam reports (SMC_TappetData): slow the master down, or move the tappets apart"
    );
    let mut finding = Finding::error(Rule::FunctionBlock, Place::at(1), message);
    finding.severity = Severity::Warning;
    finding
}

/// A program in `dialect` that moves the additional axis of the role `letter` on a machine without it. The third one of
/// RS274 is C or, if `is_u` says so, U.
pub(super) fn no_additional_axis(
    place: Place,
    letter: char,
    dialect: Dialect,
    is_u: Option<bool>,
) -> Finding {
    let name = match (dialect, letter) {
        (Dialect::Rs274, 'P') => "A".to_owned(),
        (Dialect::Rs274, 'Q') => "B".to_owned(),
        (Dialect::Rs274, 'U') => {
            is_u.map_or("C or U", |is_u| if is_u { "U" } else { "C" }).to_owned()
        }
        _ => letter.to_string(),
    };
    let needs =
        if dialect == Dialect::Rs274 { format!(", which {name} needs") } else { String::new() };
    let message = format!(
        "the program moves the additional axis {name}, but no axis of the machine has the role \"{letter}\"{needs}"
    );
    Finding::error(Rule::UnsupportedWord, place, message)
}

/// A simulated axis that is beyond its software limits though it is not sent there.
pub(super) fn ran_away(axis: &Axis, place: Place, wanted: f64, actual: f64) -> Option<Finding> {
    if beyond_position(axis, place, wanted).is_some() || (actual - wanted).abs() < RUN_AWAY {
        return None;
    }
    let mut finding = beyond_position(axis, place, actual)?;
    finding.message = format!(
        "in the simulated machine {}: its motor does not hold it at its set-point, {:.3} {}",
        finding.message,
        axis.from_si(wanted),
        axis.unit()
    );
    Some(finding)
}

/// A velocity (rad/s or m/s) above the axis's.
pub(super) fn too_fast(axis: &Axis, place: Place, velocity: f64) -> Finding {
    let quantity = Quantity { name: "velocity", units: ["deg/s", "mm/s"] };
    let finding = too_much(axis, Rule::AxisVelocity, &quantity, place, velocity, axis.max_velocity);
    match axis.velocity_limit().source {
        VelocitySource::Axis => finding,
        source => {
            let message = format!("{} ({})", finding.message, source.name());
            Finding { message, ..finding }
        }
    }
}

/// An acceleration (rad/s² or m/s²) above the axis's, or a deceleration if the axis `slows`.
pub(super) fn too_hard(axis: &Axis, place: Place, acceleration: f64, slows: bool) -> Finding {
    let name = if slows { "deceleration" } else { "acceleration" };
    let quantity = Quantity { name, units: ["deg/s^2", "mm/s^2"] };
    let limit = axis.acceleration_limit(slows);
    too_much(axis, Rule::AxisAcceleration, &quantity, place, acceleration, limit)
}

/// A jerk (rad/s³ or m/s³) above `limit`. A trapezoidal profile steps in acceleration; that alone makes no program
/// unfit.
pub(super) fn too_jerky(axis: &Axis, place: Place, jerk: f64, limit: f64) -> Finding {
    let quantity = Quantity { name: "jerk", units: ["deg/s^3", "mm/s^3"] };
    Finding {
        severity: Severity::Warning,
        ..too_much(axis, Rule::AxisJerk, &quantity, place, jerk, limit)
    }
}

/// The same where the plan is to keep the limit, and is far from it: an error, which no feed cures.
pub(super) fn far_too_jerky(axis: &Axis, place: Place, jerk: f64, limit: f64) -> Finding {
    Finding {
        severity: Severity::Error,
        hint: Some("keep the path away from the edge of the reach, or move the part".to_owned()),
        ..too_jerky(axis, place, jerk, limit)
    }
}

/// A velocity (rad/s or m/s) that changes by `value` at once.
pub(super) fn step(axis: &Axis, place: Place, value: f64, limit: f64) -> Finding {
    too_much(axis, Rule::AxisVelocityStep, &STEP, place, value, limit)
}

/// Something that happens because a tool that turns with the path does so at once.
pub(super) fn turns_at_once(mut finding: Finding) -> Finding {
    finding.message = format!("{}: the tool turns with the path at once here", finding.message);
    finding.hint = Some("round the corner, or plan within the limits of the axes (--limits axes), which turns the tool at rest".to_owned());
    finding
}

/// A step of a velocity where the path turns by `angle`, rad; small enough with a velocity up to `feed`, m/s.
pub(super) fn at_corner(mut finding: Finding, angle: f64, feed: f64) -> Finding {
    let angle = twin_number::significant(angle.to_degrees(), 3);
    finding.message = format!("{}: the path turns by {angle}° without a stop", finding.message);
    finding.largest_feed_mm_per_s = Some(feed * 1e3);
    finding
}

/// A step of a velocity where the path stops, starts or turns round; small enough with a velocity up to `feed`, m/s.
pub(super) fn at_once(mut finding: Finding, feed: f64) -> Finding {
    finding.message = format!("{}: the velocity of the path steps here", finding.message);
    finding.largest_feed_mm_per_s = Some(feed * 1e3);
    finding
}

/// A step of a velocity at an edge of the reach.
pub(super) fn at_edge(mut finding: Finding) -> Finding {
    finding.message = format!("{}: the tool is at an edge of the reach", finding.message);
    finding
}

/// A plan by F and E alone that overloads an axis, as `worst` says.
pub(super) fn overloaded_as_programmed(worst: &Finding) -> Finding {
    let factor = worst.value.zip(worst.limit).map_or(0.0, |(value, limit)| (value / limit).abs());
    let message = format!(
        "a controller that plans by F and E alone overloads an axis here by a factor of {}: {}",
        twin_number::significant(factor, 3),
        worst.message
    );
    let hint = "check with --limits programmed, which lists all such lines".to_owned();
    Finding {
        rule: Rule::ProgrammedPlan,
        severity: Severity::Warning,
        message,
        hint: Some(hint),
        largest_feed_mm_per_s: None,
        ..worst.clone()
    }
}

/// A distance (rad or m) between set-point and simulated machine above `limit`.
pub(super) fn too_far(axis: &Axis, place: Place, error: f64, limit: f64) -> Finding {
    let quantity = Quantity { name: "following error", units: ["deg", "mm"] };
    too_much(axis, Rule::FollowingError, &quantity, place, error, limit)
}

/// Hint where no feed is looked for.
pub(super) const LOWER: &str = "lower F or E";

/// Hint on a rapid in RS274 that is too fast, with the `cap` of the machine file, m/s, infinite if it has none.
pub(super) fn rapid_hint(cap: f64) -> String {
    let now = if cap.is_finite() {
        format!(" (it is {} mm/s)", twin_number::significant(cap * 1e3, 6))
    } else {
        String::new()
    };
    format!("lower `rapid_velocity_mm_per_s` in [rs274] of the machine file{now}")
}

/// A distance (rad or m) between set-point and drive above `limit` in a run, with its probable cause.
pub(super) fn drive_was_too_far(
    axis: &Axis,
    place: Place,
    error: f64,
    limit: f64,
    cause: &str,
) -> Finding {
    let quantity = Quantity { name: "error of its drive", units: ["deg", "mm"] };
    let mut finding = too_much(axis, Rule::FollowingError, &quantity, place, error, limit);
    finding.message = format!("{}: {cause}", finding.message);
    finding
}

/// A distance (rad or m) between set-point and drive above `limit`, as its rehearsal foresees it.
pub(super) fn drive_too_far(axis: &Axis, place: Place, error: f64, limit: f64) -> Finding {
    let quantity = Quantity { name: "predicted error of its drive", units: ["deg", "mm"] };
    let finding = too_much(axis, Rule::FollowingError, &quantity, place, error, limit);
    Finding { severity: Severity::Warning, ..finding }
}

/// An event of the simulated machine; `None` if it does not concern the program.
pub(super) fn happened(machine: &Machine, happening: &Happening) -> Option<Finding> {
    let Happening { place, axis, kind } = *happening;
    let axis = machine.axes.get(axis)?;
    let name = &axis.name;
    let mut finding = match kind {
        EventKind::LostSteps(steps) => {
            let message = format!(
                "axis {name}: the step motor lost {} full steps; it stays {} its set-point",
                steps.abs(),
                if steps > 0 { "below" } else { "above" }
            );
            Finding::error(Rule::LostSteps, place, message)
        }
        EventKind::Overload => {
            let overload = axis.simulated.overload?;
            let (unit, what) = (axis.kind.effort_unit(), axis.kind.effort_name());
            let message = format!(
                "axis {name}: the motor gets too warm; its continuous {what} is {:.2} {unit}",
                overload.continuous_effort
            );
            let finding = Finding::error(Rule::MotorOverload, place, message);
            Finding { severity: Severity::Warning, ..finding }
        }
        EventKind::LimitSwitch(side) => {
            let message = format!("axis {name}: is on its {side} limit switch");
            Finding::error(Rule::LimitSwitch, place, message)
        }
        EventKind::Failed(fault) => {
            let what = match fault {
                Fault::Jam => "it jams".to_owned(),
                Fault::LostSteps(steps) => {
                    format!("{steps} full steps of its pulse train are left out")
                }
                Fault::LooseBelt { stiffness, backlash } => format!(
                    "its belt has {:.0} % of its stiffness left and {:.3} {} more play",
                    stiffness * 100.0,
                    axis.from_si(backlash),
                    axis.unit()
                ),
                Fault::PowerLoss => "its drive has no power any more".to_owned(),
            };
            let message = format!("axis {name}: {what} (a fault of the scenario)");
            Finding { severity: Severity::Note, ..Finding::error(Rule::Fault, place, message) }
        }
        EventKind::BrakeClosed => return None,
    };
    finding.axis = Some(name.clone());
    Some(finding)
}

/// Two parts that overlap.
pub(super) fn in_the_way(machine: &Machine, found: &BlockClearance) -> Finding {
    let [one, other] = found.names(machine);
    let depth = -found.nearest.distance * 1e3;
    let [x, y, z] = found.nearest.points[0].coords.into();
    let message = format!(
        "{one} is {depth:.3} mm deep in {other}, at X {:.3} Y {:.3} Z {:.3} mm of the machine",
        x * 1e3,
        y * 1e3,
        z * 1e3
    );
    Finding::error(Rule::Collision, found.place, message).with_value(-depth, 0.0, "mm")
}

/// A machine that is not simulated, or not any further, because parts overlap where the program starts or the tool changes.
pub(super) fn starts_inside(
    machine: &Machine,
    (place, is_start): (Place, bool),
    (parts, tool): ([Part; 2], Option<u32>),
) -> Finding {
    let [one, other] = parts.map(|part| machine.part_name_with(part, tool));
    let message = if is_start {
        format!("not simulated: {one} and {other} overlap where the program starts")
    } else {
        format!("not simulated from here on: {one} and {other} overlap after the tool change")
    };
    let finding = Finding::error(Rule::Collision, place, message);
    Finding { severity: Severity::Note, ..finding }
}

/// Two parts nearer to each other than is wanted (m).
pub(super) fn too_near(machine: &Machine, found: &BlockClearance, wanted: f64) -> Finding {
    let [one, other] = found.names(machine);
    // Parts that touch have the distance 0.
    let (distance, wanted) = (found.nearest.distance.max(0.0) * 1e3, wanted * 1e3);
    let message = format!(
        "{one} comes as near as {distance:.3} mm to {other}; the clearance wanted is {wanted:.3} mm"
    );
    let finding = Finding::error(Rule::Collision, found.place, message);
    Finding { severity: Severity::Warning, ..finding.with_value(distance, wanted, "mm") }
}

/// A blow in the simulated machine.
pub(super) fn ran_into(machine: &Machine, blow: &Blow) -> Finding {
    let Blow { place, parts, tool, speed, impulse, peak } = *blow;
    let stiffness = machine.collision.as_ref().map_or(0.0, |it| it.surroundings.stiffness) * 1e-3;
    let [one, other] = parts.map(|part| machine.part_name_with(part, tool));
    let message = format!(
        "{one} ran into {other} with {:.1} mm/s in the simulated machine: impulse {impulse:.3} N·s, peak force {} at {stiffness} N/mm (stiffness_n_per_mm)",
        speed * 1e3,
        in_newtons(peak)
    );
    let finding = Finding::error(Rule::Collision, place, message);
    Finding { value: Some(peak), unit: Some("N"), ..finding }
}

/// A probe that touched something in the simulated machine.
pub(super) fn touched(machine: &Machine, touch: &ProbeTouch) -> Option<Finding> {
    let tip = machine.kinematics.forward(&touch.position).ok()?;
    let tip = machine.frame.pose_to_work(&tip).position * 1e3;
    // In micrometres; zero is not below zero.
    let [x, y, z] = tip.coords.map(|value| (value * 1e3).round() * 1e-3 + 0.0).into();
    let message =
        format!("in the simulated machine the probe touched at X {x:.3} Y {y:.3} Z {z:.3} mm");
    let finding = Finding::error(Rule::Probe, touch.place, message);
    Some(Finding { severity: Severity::Note, ..finding })
}

/// A probe that did not touch in the simulated machine what it touches in the plan.
pub(super) fn missed(miss: &ProbeMiss) -> Finding {
    let nearest = miss.nearest * 1e3;
    let message = format!(
        "in the simulated machine the probe does not touch: it comes as near as {nearest:.4} mm before the path goes on"
    );
    Finding::error(Rule::Probe, miss.place, message).with_value(nearest, 0.0, "mm")
}

/// A fault of the scenario that has not begun.
pub(super) fn never_began(machine: &Machine, fault: &FaultAt) -> Finding {
    let (line, when) = match fault.start {
        FaultStart::Time(time_ns) => (1, format!("at {} s", seconds(time_ns))),
        FaultStart::Line(line) => (line, format!("at line {line}")),
    };
    let axis = fault.axis.and_then(|axis| machine.axes.get(axis));
    let whose = axis.map_or_else(|| "all axes".to_owned(), |axis| format!("axis {}", axis.name));
    let message = format!(
        "the fault of {whose} {when} in the scenario never began, because nothing moved then"
    );
    let finding = Finding::error(Rule::Fault, Place::at(line), message);
    Finding { severity: Severity::Warning, ..finding }
}

/// A force with its significant digits.
fn in_newtons(force: f64) -> String {
    if force < 1e3 { format!("{force:.0} N") } else { format!("{:.1} kN", force * 1e-3) }
}

/// The simulated machine has run away from its set-points.
pub(super) fn lost(place: Place, error: &SimulationError) -> Finding {
    let message = format!("the simulated machine cannot follow: {error}");
    Finding::error(Rule::FollowingError, place, message)
}

/// Removes clearance warnings about parts that also collide.
pub(super) fn leave_out_nearness(findings: &mut Vec<Finding>) {
    let is_collision = |finding: &&Finding| finding.rule == Rule::Collision;
    let hits = findings.iter().filter(is_collision);
    let hits = hits.filter(|finding| finding.severity == Severity::Error);
    let hits: BTreeSet<_> = hits.map(|finding| finding.place().key()).collect();
    findings.retain(|finding| {
        !(is_collision(&finding)
            && finding.severity == Severity::Warning
            && hits.contains(&finding.place().key()))
    });
}

/// Removes findings about axes near a point that cannot be reached: no feed would help them.
pub(super) fn leave_out_consequences(findings: &mut Vec<Finding>) {
    let unreachable: BTreeSet<_> = findings
        .iter()
        .filter(|finding| finding.rule == Rule::Reach)
        .map(|finding| finding.place().key())
        .collect();
    let about = |finding: &Finding| (finding.place().key(), finding.axis.clone());
    let broken = findings
        .iter()
        .filter(|finding| finding.rule == Rule::AxisJerk && finding.severity == Severity::Error);
    let broken: BTreeSet<_> = broken.map(about).collect();
    findings.retain(|finding| {
        let warning = finding.rule == Rule::AxisJerk && finding.severity == Severity::Warning;
        !(warning && broken.contains(&about(finding)))
    });
    findings.retain(|finding| {
        let follows = matches!(
            finding.rule,
            Rule::AxisVelocity
                | Rule::AxisAcceleration
                | Rule::AxisJerk
                | Rule::AxisVelocityStep
                | Rule::Singularity
        );
        !(follows && unreachable.contains(&finding.place().key()))
    });
}

/// A change of the velocity.
const STEP: Quantity =
    Quantity { name: "change of the velocity at once", units: ["deg/s", "mm/s"] };

/// What is measured, in which unit for rotary and linear axes.
struct Quantity {
    name: &'static str,
    units: [&'static str; 2],
}

fn too_much(
    axis: &Axis,
    rule: Rule,
    quantity: &Quantity,
    place: Place,
    value: f64,
    limit: f64,
) -> Finding {
    let (value, limit) = (axis.from_si(value.abs()), axis.from_si(limit));
    let [rotary, linear] = quantity.units;
    let unit = match axis.kind {
        AxisKind::Rotary => rotary,
        AxisKind::Linear => linear,
    };
    let shown = unit.replace("^2", "²").replace("^3", "³");
    let [is, most] = twin_number::apart(value, limit);
    let message = format!(
        "axis {}: {} {is} {shown} is above its limit of {most} {shown}",
        axis.name, quantity.name
    );
    let mut finding = Finding::error(rule, place, message).with_value(value, limit, unit);
    finding.axis = Some(axis.name.clone());
    finding
}
