//! Late or missing plans: the old plan goes on, and every executed plan ends at rest.

use super::machines::Machine;
use super::random::{Form, Step, cases, exponential, limits_hold, settings, step, walk};
use super::run::{Settings, Watch};
use proptest::prelude::*;
use std::collections::VecDeque;
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_path::{PathElement, Plane};
use twin_planner::time_optimal::{
    Arrival, KinematicPath, Lead, LimitError, Piece, Pieces, PlanExecutor, Planned, Planner,
    Request,
};

/// A held path rests so long, s.
const HELD: f64 = 0.02;

type Wrong = String;

/// At a time, s, the override becomes this.
type Change = (f64, f64);

/// How long the side that plans takes for a piece, s, one after the other and then again.
#[derive(Clone, Debug)]
struct Pace(Vec<f64>);

#[derive(Debug, Default)]
struct Executed {
    report: super::run::Report,
    late: u64,
    /// From each change to when the path followed or rested for good, s.
    delays: Vec<f64>,
    /// The longest plan that there ever was ahead, s.
    ahead: f64,
    work: u64,
}

/// Executes `path` while it is planned at this pace, with these changes.
fn execute(path: &[PathElement], settings: &Settings, changes: &[Change], pace: &Pace) -> Executed {
    let checked =
        CheckVelocities::new(path.iter().cloned().map(Ok::<_, CheckError>), settings.angle)
            .map(|next| next.map_err(|error| -> Wrong { error.to_string() }));
    let planner = Planner::new(checked, settings.machine.path(settings.jerk), settings.options());
    let mut pieces = Pieces::new(planner);
    let axes = settings.machine.path(settings.jerk);
    let mut watch = Watch::new(&axes);
    let mut result = Executed::default();
    let mut spliced: PlanExecutor<Wrong> = PlanExecutor::new(Lead::default());
    let mut changes: VecDeque<Change> = changes.iter().copied().collect();
    let mut paces = pace.0.iter().copied().cycle();
    // What is on its way, and when it is there.
    let mut underway: Option<(f64, Piece<Wrong>)> = None;
    let mut request: Option<Request<Wrong>> = None;
    let mut pending: Option<(f64, f64)> = None;
    let mut held = 0;
    // At first there is time.
    spliced.receive(pieces.next_piece());
    loop {
        let now = watch.report.duration;
        if let Some((_, factor)) = changes.pop_front_if(|(time, _)| *time <= now) {
            request = Some(spliced.set_override(factor));
            pending = Some((now, factor));
            held = 0;
        }
        // The other side: one piece after the other.
        loop {
            if let Some((_, piece)) = underway.take_if(|(there, _)| *there <= now) {
                if spliced.receive(piece) == Arrival::Late {
                    request = Some(spliced.ask_again());
                }
                result.ahead = result.ahead.max(spliced.ahead());
            }
            if underway.is_some() || !(request.is_some() || spliced.wants_more()) {
                break;
            }
            if let Some(request) = request.take() {
                pieces.obey(request);
            }
            if pieces.is_resting() {
                break;
            }
            pieces.forget(spliced.needs());
            underway = Some((now + paces.next().unwrap(), pieces.next_piece()));
        }
        if spliced.is_starving() && request.is_none() {
            request = Some(spliced.ask_again());
        }
        if let Some((since, factor)) = pending.filter(|_| spliced.follows()) {
            result.delays.push(now - since);
            watch.factor = (factor, f64::INFINITY);
            pending = None;
        }
        match spliced.take() {
            Some(Ok(Planned::Leg(leg))) => watch.leg(&leg),
            Some(Ok(Planned::Pause(element))) => {
                watch.rest();
                watch.report.lines.push(element.place().line);
                watch.report.stops += 1;
            }
            Some(Ok(Planned::Hold { .. })) => {
                watch.wait(HELD);
                held += 1;
                assert!(held < 10_000, "it rests for ever");
                // Let go on if nothing else does.
                if held > 5 && changes.is_empty() && underway.is_none() && request.is_none() {
                    changes.push_back((0.0, 1.0));
                }
            }
            Some(Err(LimitError::Upstream(error))) => panic!("{error}"),
            Some(Err(error)) => watch.report.errors.push(error.to_string()),
            None => break,
        }
    }
    watch.rest();
    watch.report.effort = pieces.planner().effort();
    result.report = watch.report;
    result.late = spliced.late();
    result.work = result.report.effort.most_replanning;
    result
}

fn spliced(
    settings: Settings,
    steps: &[Step],
    changes: &[Change],
    pace: &Pace,
) -> Result<(), TestCaseError> {
    let path = walk(steps, settings.machine);
    let executed = execute(&path, &settings, changes, pace);
    let Executed { report, late, delays, ahead, work } = &executed;
    println!("{} changes, {late} late, delays {delays:?}, {ahead} s ahead, {work}", changes.len());
    limits_hold(report, &path, &settings, 1.02)?;
    let most = Planner::<
        std::iter::Empty<_>,
        CheckError,
        KinematicPath<twin_kinematics::MachineAxes>,
    >::MOST_WORK;
    prop_assert!(*work < 2 * most, "{work}");
    Ok(())
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let factor = prop_oneof![2 => Just(0.0), 2 => exponential(1e-2..0.05), 4 => exponential(0.05..2.0), 2 => Just(1.0)];
    prop::collection::vec((exponential(1e-2..0.5), factor), 1..8).prop_map(|mut changes| {
        let mut time = 0.0;
        for (at, _) in &mut changes {
            time += *at;
            *at = time;
        }
        changes
    })
}

/// From at once to longer than any lead.
fn pace() -> impl Strategy<Value = Pace> {
    let time = prop_oneof![3 => Just(0.0), 3 => exponential(1e-2..0.2), 2 => exponential(0.1..3.0)];
    prop::collection::vec(time, 1..6).prop_map(Pace)
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn jerks_are_limited_whenever_plans_come(settings in settings(), steps in prop::collection::vec(step(), 1..20), changes in changes(), pace in pace()) {
        spliced(settings, &steps, &changes, &pace)?;
    }

    #[test]
    fn accelerations_are_limited_whenever_plans_come(settings in settings(), steps in prop::collection::vec(step(), 1..20), changes in changes(), pace in pace()) {
        spliced(Settings { jerk: false, ..settings }, &steps, &changes, &pace)?;
    }
}

/// A line of 0.5 m at 0.1 m/s.
fn long_line() -> (Vec<PathElement>, Settings) {
    let tolerance = 1e-5;
    let settings = Settings {
        machine: Machine::Gantry3,
        jerk: true,
        tolerance,
        angle: std::f64::consts::PI,
        horizon: 1.5,
    };
    (vec![super::replan::line(0.5, 0.1)], settings)
}

#[test]
fn an_override_counts_after_the_lead_where_planning_is_fast_enough() {
    let (path, settings) = long_line();
    let pace = Pace(vec![0.03]);
    let changes = [(0.5, 0.5), (1.0, 0.0), (1.5, 1.0), (2.0, 0.1), (2.5, 2.0)];
    let Executed { late, delays, report, .. } = execute(&path, &settings, &changes, &pace);
    assert_eq!((late, report.errors.len()), (0, 0));
    assert_eq!(delays.len(), changes.len());
    // The item that is under way, and one that begins just within the lead.
    assert!(delays.iter().all(|delay| *delay <= 0.1 + 0.01), "{delays:?}");
}

#[test]
fn the_lead_is_doubled_until_the_plan_is_in_time() {
    let (path, settings) = long_line();
    // Longer than 0.2 s, shorter than 0.4 s.
    let pace = Pace(vec![0.3]);
    let Executed { late, delays, .. } = execute(&path, &settings, &[(1.0, 0.5)], &pace);
    assert_eq!(late, 2);
    // A piece that was under way is waited for at first.
    assert!(delays[0] <= 4.0 * 0.3 + 0.4 + 0.02 && delays[0] > 0.6, "{delays:?}");
}

#[test]
fn a_hold_is_over_at_the_end_of_what_is_planned_at_the_latest() {
    let (path, settings) = long_line();
    // No plan comes in time any more.
    let pace = Pace(vec![0.0, 0.0, 0.0, 60.0]);
    let Executed { report, ahead, .. } = execute(&path, &settings, &[(1.0, 0.0)], &pace);
    assert!(report.errors.is_empty());
    // A window of one and a half horizons, and what is to be ahead before another is planned.
    assert!(ahead < 1.5 * 1.5 + 1.0, "{ahead} s");
    // The wait for the plan is a rest, not a motion.
    assert!(report.velocity.value <= 1.001 && report.third_difference.value <= 1.05, "{report:?}");
    assert!(report.duration > 60.0);
}

/// A plan may end in a blend but for rounding, where the next one must not have a cell of 1e-20 m: in one so short rounding
/// drowns the jerks.
#[test]
#[allow(clippy::unreadable_literal, reason = "as they were found: fewer digits are another path")]
fn an_acceleration_goes_on_from_plan_to_plan() {
    let arc = |plane, sweep, rise| Form::Arc { plane, sweep, rise };
    let steps = [
        Step::new(
            Form::Line,
            false,
            0.002255446212285847,
            [0.0, -0.6075633416118688, 0.0],
            0.5,
            [18.38337326220304, 1.0],
        ),
        Step::new(
            Form::Line,
            false,
            2.3579783576407348e-5,
            [0.44689962043944664, -0.1363384790474046, 0.0],
            0.14647615709930795,
            [2.1604824475644566, 0.3346419894680971],
        ),
        Step::new(
            arc(Plane::Yz, -4.811797995570654, -0.06406143715300358),
            true,
            2.5160433349865174e-5,
            [-0.33607272185311454, 0.5359624248109468, 0.0],
            0.013934669429969893,
            [7.557827827336566, 6.1820355226734165],
        ),
        Step::new(
            arc(Plane::Xy, -3.794163958084847, 0.0),
            false,
            0.0002880357486385573,
            [0.16238058813728407, -0.14387464616247012, 0.0],
            0.22155584172006376,
            [1.1738725633014566, 18.93261044236704],
        ),
        Step::new(
            Form::Line,
            false,
            5.067773627960168e-5,
            [0.49255198428689667, -0.20514890337094588, 0.0],
            0.339408186181936,
            [3.1857027041851276, 3.137390190888578],
        ),
        Step::new(
            arc(Plane::Yz, -4.0817140738219475, 0.0),
            false,
            0.009614664590521689,
            [-0.4380977630112801, -0.3338253376216664, -0.18254157233874171],
            0.08449845820446816,
            [6.080184510388469, 0.6251934543811272],
        ),
        Step::new(
            Form::Line,
            false,
            0.02999490957307206,
            [-0.7471716229173195, -0.581944880517649, 0.0],
            0.005300930076540815,
            [0.42496896263792217, 8.012303585116896],
        ),
    ];
    let settings = Settings {
        machine: Machine::Scara2,
        jerk: true,
        tolerance: 1.000_000_000_000_000_9e-4,
        angle: std::f64::consts::PI,
        horizon: 1.5,
    };
    let path = walk(&steps, settings.machine);
    let pace = Pace(vec![0.03837291024155448, 0.07090694573322902, 0.512769850873645]);
    let changes = [(0.016710423416096385, 0.06659380463671143)];
    let Executed { report, .. } = execute(&path, &settings, &changes, &pace);
    limits_hold(&report, &path, &settings, 1.02).expect("limits that are kept");
}
