//! Program check on the virtual machine, before anything moves.

mod cam_jumps;
mod checker;
mod clearance;
mod collision;
#[cfg(test)]
mod collision_tests;
#[cfg(test)]
mod direction_tests;
mod edge;
mod findings;
mod following;
#[cfg(test)]
mod following_tests;
#[cfg(test)]
mod gap_tests;
mod handling;
#[cfg(test)]
mod input_tests;
mod instant;
mod largest_feed;
mod messages;
mod options;
mod pieces;
#[cfg(test)]
mod pieces_tests;
mod plan_check;
mod programmed_plan;
mod rehearsal;
mod remedy;
mod run_findings;
#[cfg(test)]
mod tests;

use crate::finding;
use crate::finding::{Finding, Rule, Severity};
use crate::limit::Limits;
use crate::m_function::Acknowledgement;
use crate::m_function::MCalls;
use crate::peak::AxisPeak;
use crate::planning::Planning;
use crate::plant::{BodyRecord, PlantRecord};
use crate::program::{Dialect, ProgramFile};
use crate::setpoint_source::PlanItem;
use crate::spindle::ToolLeft;
use checker::Checker;
pub use clearance::{ClearanceCsv, ClearancePicture};
use collision::Way;
pub use collision::{BlockClearance, Clearances};
pub use edge::EdgeDistance;
use findings::About;
use following::FollowingBeside;
pub use following::{PredictedFollowing, PredictedTraffic, wire_rates};
pub use options::{CheckFailure, CheckOptions};
pub(crate) use plan_check::PlanCheck;
use rehearsal::Rehearsal;
pub use run_findings::{
    drive_errors, faults_to_come, following_errors, handled, happening, happenings,
};
use std::collections::BTreeSet;
use twin_gcode::rs274::Tool;
use twin_kinematics::AxisVector;
use twin_machine::Machine;
use twin_machine::switch_points::SwitchPoints;
use twin_machine::tappets::{Signal, Switched};
use twin_physics::MotorLoad;
use twin_planner::controller::VelocityMode;

/// By which factors set-points may exceed velocities, accelerations and jerks of axes: the controller's own not at all; those
/// within the limits of the axes by what may happen between the places at which these are asked for.
const CONTROLLER: [f64; 3] = [1.0; 3];
const WITHIN_AXES: [f64; 3] = [1.001, 1.001, 1.05];

fn slack(limits: Limits) -> [f64; 3] {
    match limits {
        Limits::Programmed => CONTROLLER,
        Limits::Axes => WITHIN_AXES,
    }
}

/// Velocity of rapids where the machine file and not the program says it, m/s.
fn rapids(machine: &Machine, program: &ProgramFile) -> Option<f64> {
    (program.dialect() == Dialect::Rs274).then_some(machine.conditions.rs274.rapid_velocity)
}

/// Result of a check.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Number of path elements.
    pub elements: u64,
    /// Length of the path, m.
    pub length: f64,
    /// Duration, ns.
    pub duration_ns: i64,
    /// For so long of it the machine cannot take the set-points, and nothing else is known of the axes, ns.
    pub untaken_ns: i64,
    /// Largest values per axis, machine-file order.
    pub peaks: Vec<AxisPeak>,
    /// Findings, worst first.
    pub findings: Vec<Finding>,
    /// Number of further findings.
    pub findings_left_out: u64,
    /// Axis positions at the first set-point, m or rad; where the program before ended, if there is one.
    pub start: Option<AxisVector>,
    /// Axis positions at the last set-point, m or rad.
    pub end: Option<AxisVector>,
    /// Loads of the simulated motors, machine-file order; none if it was not simulated.
    pub loads: Vec<MotorLoad>,
    /// Loose bodies at the end, machine-file order; none if they were not simulated.
    pub bodies: Vec<BodyRecord>,
    /// Smallest clearances; none if the machine file has no obstacles and no collision check.
    pub clearances: Clearances,
    /// Smallest distance from the edge of the reach; none if the machine has no such edge, or no path is planned in pieces.
    pub edge: Option<EdgeDistance>,
    /// Following-error prediction; none if it was not requested, there are no drives, or the machine cannot take a
    /// set-point.
    pub following: Option<PredictedFollowing>,
    /// Tappet switchings of the cams.
    pub tappets: Switched,
    /// Switchings of the path's switches.
    pub switch_points: SwitchPoints,
    /// Numbers of the M functions that are executed.
    pub m_calls: BTreeSet<u16>,
    /// Their calls, with their words.
    pub m_functions: MCalls,
    /// The tool of the tool table in the spindle at the beginning, if there is one.
    pub start_tool: Option<Tool>,
    /// The tool that an RS274 program leaves in the spindle.
    pub tool: Option<ToolLeft>,
}

/// Progress of a check.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Bytes of the program's file that are done; none for a job without a duration, whose end is not known.
    pub bytes: Option<u64>,
    /// Time of the program, ns.
    pub time_ns: i64,
}

/// Checks a whole program. `progress` receives the progress.
///
/// # Errors
/// If the file cannot be read, the simulated machine cannot be built, or the machine is none whose axes a path can be planned
/// for.
pub fn check(
    machine: &Machine,
    program: &ProgramFile,
    options: CheckOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, CheckFailure> {
    check_watched(machine, program, options, progress, &mut |_| {})
}

/// As [`check`], and gives `watch` the smallest clearance at every set-point.
///
/// # Errors
/// Those of [`check`].
pub fn check_watched(
    machine: &Machine,
    program: &ProgramFile,
    options: CheckOptions,
    progress: &mut dyn FnMut(Progress),
    watch: &mut dyn FnMut(&BlockClearance),
) -> Result<Outcome, CheckFailure> {
    let CheckOptions { limits, acknowledge, continues, .. } = options;
    let mut outcome = std::thread::scope(|scope| {
        let following = options.drives.then(|| FollowingBeside::start(scope, machine));
        let following = following.transpose()?.flatten();
        checked(machine, program, options, following, (progress, watch))
    })?;
    outcome.start_tool = program.spindle(machine).tool().copied();
    // Behind a block that cannot be read the path goes on with a jump that nobody has written.
    let unread = |finding: &Finding| {
        let of_text =
            matches!(finding.rule, Rule::Syntax | Rule::UnsupportedWord | Rule::ArcGeometry);
        of_text && finding.severity == Severity::Error
    };
    if program.dialect() == Dialect::Rs274 && outcome.findings.iter().any(unread) {
        outcome.findings.retain(|one| one.rule != Rule::Gap || one.severity != Severity::Note);
    }
    let plans = limits == Limits::Axes && program.dialect() != Dialect::Job;
    if plans && !finding::unfit(&outcome.findings) {
        let rules = Acknowledgement::for_check(machine, acknowledge);
        outcome.findings.extend(programmed_plan::warning(machine, program, rules, continues)?);
        finding::sort(&mut outcome.findings);
    }
    Ok(outcome)
}

/// Progress of a check: how far it has come, and the clearances to obstacles.
type Watchers<'w> = (&'w mut dyn FnMut(Progress), &'w mut dyn FnMut(&BlockClearance));

fn checked(
    machine: &Machine,
    program: &ProgramFile,
    options: CheckOptions,
    mut following: Option<FollowingBeside<'_>>,
    (progress, watch): Watchers<'_>,
) -> Result<Outcome, CheckFailure> {
    let CheckOptions { limits, physics, scenario, acknowledge, drives: _, continues } = options;
    let (slack, rapids) = (slack(limits), rapids(machine, program));
    let mut checker = Checker::new(machine, rapids, slack, program.dialect());
    if program.settings().inputs.mode != VelocityMode::Trapezoid {
        // Feeds are solved for on trapezoids.
        checker = checker.without_feeds();
    }
    checker.continue_from(continues);
    let spindle = program.spindle(machine);
    let mut way = Way::new(machine, &spindle)?;
    let mut rehearsal = physics.then(|| Rehearsal::new(machine, scenario, spindle));
    let rules = Acknowledgement::for_check(machine, acknowledge);
    let mut items = Planning::new(machine, program, limits, rules)?;
    let every_cycle = rehearsal.is_some() || way.is_some() || following.is_some();
    checker.begin(&mut items, every_cycle);
    let (mut countdown, mut switched, mut m_calls) = (0u32, Switched::default(), BTreeSet::new());
    let (mut m_functions, mut switch_points) = (MCalls::default(), SwitchPoints::default());
    while let Some(item) = items.next() {
        checker.pieces(&mut items);
        let setpoint = match item {
            PlanItem::Tool(tool) => {
                if let Some(bridge) = checker.bridge(&tool) {
                    items.bridge(bridge, &tool);
                    continue;
                }
                m_calls.extend(tool.m_function);
                let call = items.m_call();
                if let Some(call) = &call {
                    m_functions.observe(call);
                    way.as_mut().map_or(Ok(()), |way| way.observe(machine, call))?;
                }
                checker.tool(&tool, call)
            }
            PlanItem::Bridging(instant) => checker.bridging(&instant),
            PlanItem::Axes(setpoint) => Some(*checker.axes(&setpoint)),
            PlanItem::Diagnostic(finding) => {
                checker.findings.add(None, finding);
                continue;
            }
            PlanItem::Io(error) => return Err(error.into()),
        };
        if let Some(setpoint) = &setpoint {
            let transformer = &checker.transformer;
            let at = (setpoint.time_ns, setpoint.place);
            switch_points.observe(setpoint.switches, at);
            let job = items.job();
            switched.observe(setpoint.tappets, at, |signal| match job {
                Some(job) => job.tappet_master(signal),
                None => transformer.tappet_master(signal),
            });
        }
        let Some(setpoint) = setpoint else {
            // There is no plan to follow.
            following = None;
            continue;
        };
        if let Some(following) = &mut following {
            following.take(&setpoint);
        }
        if let Some(way) = &mut way
            && let Some(clearance) = way.look(machine, &setpoint, &mut checker.findings)
        {
            watch(&clearance);
        }
        if let Some(rehearsal) = &mut rehearsal {
            rehearsal.take(&setpoint, &mut checker)?;
        }
        countdown = countdown.checked_sub(1).unwrap_or_else(|| {
            progress(Progress { bytes: items.bytes_done(), time_ns: setpoint.time_ns });
            1000
        });
    }
    checker.pieces(&mut items);
    progress(Progress { bytes: items.bytes_done(), time_ns: checker.time_ns() });
    if items.elements() == 0 && !checker.findings.any_error() {
        checker.findings.add(None, finding::nothing_moves());
    }
    let finished = rehearsal.map(|rehearsal| rehearsal.finish(&mut checker));
    let record = finished.transpose()?.unwrap_or_default();
    simulated(machine, &record, &mut checker);
    (switched.signals, switched.lost) = signals(&items, &checker);
    if switched.lost > 0 {
        checker.findings.add(None, messages::lost_tappets(switched.lost));
    }
    let predicted = following.and_then(FollowingBeside::finish);
    let mut outcome = checker.finish();
    (outcome.tappets, outcome.switch_points, outcome.m_calls) = (switched, switch_points, m_calls);
    (outcome.m_functions, outcome.tool) = (m_functions, items.tool_left());
    if let Some((predicted, findings, left_out)) = predicted {
        outcome.following = Some(predicted);
        outcome.findings.extend(findings);
        outcome.findings_left_out += left_out;
        finding::sort(&mut outcome.findings);
    }
    outcome.findings_left_out += record.left_out + items.left_out();
    (outcome.loads, outcome.bodies) = (record.loads, record.bodies);
    outcome.clearances = way.map(Way::into_found).unwrap_or_default();
    (outcome.elements, outcome.length) = (items.elements(), items.length());
    // Nothing of a job has a feed.
    let is_job = program.dialect() == Dialect::Job;
    let without_feed = outcome.findings.iter_mut().filter(|_| is_job);
    without_feed.for_each(|finding| finding.largest_feed_mm_per_s = None);
    Ok(outcome)
}

/// What has become of the simulated machine.
fn simulated(machine: &Machine, record: &PlantRecord, checker: &mut Checker<'_>) {
    for blow in &record.blows {
        checker.findings.add(Some(About::Simulated), messages::ran_into(machine, blow));
    }
    for touch in record.touches.iter().filter_map(|touch| messages::touched(machine, touch)) {
        checker.findings.add(Some(About::Simulated), touch);
    }
    for miss in &record.missed {
        checker.findings.add(Some(About::Simulated), messages::missed(miss));
    }
    for finding in faults_to_come(machine, record) {
        checker.findings.add(Some(About::Simulated), finding);
    }
    for event in &record.handled {
        if let Some(finding) = handled(machine, event) {
            checker.findings.add(Some(About::Handling(event.subject())), finding);
        }
    }
    for happening in &record.happenings {
        if let Some(finding) = messages::happened(machine, happening) {
            checker.findings.add(Some(About::Axis(happening.axis)), finding);
        }
    }
}

/// What tappets switch, and how many were lost.
fn signals(items: &Planning<'_>, checker: &Checker<'_>) -> (Vec<Signal>, u64) {
    match items.job() {
        Some(job) => (job.signals().to_vec(), job.lost_tappets()),
        None => (checker.transformer.signals().to_vec(), checker.transformer.lost_tappets()),
    }
}
