//! Replanning while the path is under way: overrides, feed holds and resumption.

use super::machines::{BUILD_UP, Machine};
use super::random::{Step, cases, exponential, limits_hold, settings, step, walk};
use super::run::{Report, Settings, Watch};
use nalgebra::Point3;
use proptest::prelude::*;
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::num::NonZeroU32;
use std::time::Instant;
use twin_kinematics::MachineAxes;
use twin_path::Place;
use twin_path::prepare::{CheckError, CheckVelocities, CheckedElement};
use twin_path::{ElementKind, PathElement, Shape};
use twin_planner::controller::Status;
use twin_planner::time_optimal::{Followed, Follower, KinematicPath, LimitError, Planned, Planner};

/// So much is planned ahead, s.
const LOOKAHEAD: f64 = 0.5;
/// A held path rests so long, s.
const HELD: f64 = 0.02;
/// Within this time, s, an acceleration that was under way goes on for a while.
const BUILT_DOWN: f64 = 0.06;

/// At a time, s, the override becomes this.
type Change = (f64, f64);

/// Further results in addition to the motion.
#[derive(Debug, Default)]
struct Replanned {
    report: Report,
    /// From the first leg planned anew to rest, s, and the way, m, per hold.
    stops: Vec<[f64; 2]>,
    /// The longest time for a plan to come after a change, and between others, s.
    took: [f64; 2],
}

/// Follows `path` with these changes, each of which leaves what begins within `lead` s as it is.
fn drive(path: &[PathElement], settings: &Settings, changes: &[Change], lead: f64) -> Replanned {
    let checked =
        CheckVelocities::new(path.iter().cloned().map(Ok::<_, CheckError>), settings.angle);
    let mut planner =
        Planner::new(checked, settings.machine.path(settings.jerk), settings.options());
    let axes = settings.machine.path(settings.jerk);
    let mut watch = Watch::new(&axes);
    let mut result = Replanned::default();
    let mut changes = changes.iter().copied().peekable();
    let mut queue: VecDeque<Planned> = VecDeque::new();
    let mut ended = false;
    // When overrides begin to count.
    let mut counts: VecDeque<Change> = VecDeque::new();
    let mut way = 0.0;
    let mut stop: Option<[f64; 2]> = None;
    let mut fresh = false;
    loop {
        let takes = |item: &Planned| match item {
            Planned::Leg(leg) => leg.stretch.duration(),
            _ => 0.0,
        };
        while !ended && queue.iter().map(takes).sum::<f64>() < LOOKAHEAD {
            #[expect(clippy::disallowed_methods, reason = "how long planning takes")]
            let begun = Instant::now();
            let next = planner.next();
            let took = begun.elapsed().as_secs_f64();
            let slot = &mut result.took[usize::from(!std::mem::take(&mut fresh))];
            *slot = slot.max(took);
            match next {
                Some(Ok(Planned::Hold { .. })) => break,
                Some(Ok(item)) => queue.push_back(item),
                Some(Err(LimitError::Upstream(error))) => panic!("{error}"),
                Some(Err(error)) => watch.report.errors.push(error.to_string()),
                None => ended = true,
            }
        }
        let now = watch.report.duration;
        if let Some((_, factor)) = changes.next_if(|(time, _)| *time <= now) {
            let mut begins = now;
            let mut keep = 0;
            while keep < queue.len() && begins < now + lead {
                begins += takes(&queue[keep]);
                keep += 1;
            }
            let back = queue.split_off(keep);
            if back.is_empty() && ended {
                continue;
            }
            planner.take_back(back.into_iter().map(Ok));
            planner.set_override(factor);
            counts.push_back((begins, factor));
            (ended, fresh) = (false, true);
            continue;
        }
        let Some(item) = queue.pop_front() else {
            if ended {
                break;
            }
            // Held.
            assert!(planner.override_factor() <= 0.0 && planner.is_held());
            if let Some([since, from]) = stop.take() {
                result.stops.push([now - since, way - from]);
            }
            watch.wait(HELD);
            if changes.peek().is_none_or(|(time, _)| *time > watch.report.duration) {
                planner.set_override(1.0);
                counts.push_back((watch.report.duration, 1.0));
            }
            continue;
        };
        while let Some((time, factor)) = counts.pop_front_if(|(time, _)| *time <= now + 1e-9) {
            watch.factor = (factor, time + BUILT_DOWN);
            stop = (factor == 0.0).then_some([now, way]);
        }
        match item {
            Planned::Leg(leg) => {
                watch.leg(&leg);
                way += leg.stretch.length();
            }
            Planned::Pause(element) => {
                watch.rest();
                watch.report.lines.push(element.place().line);
                watch.report.stops += 1;
            }
            Planned::Hold { .. } => unreachable!(),
        }
    }
    watch.rest();
    watch.report.effort = planner.effort();
    result.report = watch.report;
    result
}

pub fn line(length: f64, feed: f64) -> PathElement {
    let start = Point3::new(0.02, 0.0, 0.0);
    let shape = Shape::Line { start, end: Point3::new(0.02 + length, 0.0, 0.0) };
    let made = PathElement::new(Place::at(1), ElementKind::Cut, shape);
    PathElement { feed, acceleration: 20.0, deceleration: 20.0, ..made }
}

fn gantry(jerk: bool) -> Settings {
    Settings { machine: Machine::Gantry3, jerk, tolerance: 1e-5, angle: PI, horizon: 1.5 }
}

/// From v to rest with acceleration and jerk limits: time and way of the three phases.
fn braking(v: f64, a: f64, j: f64) -> [f64; 2] {
    let (build_up, hold) =
        if v * j >= a * a { (a / j, v / a - a / j) } else { ((v / j).sqrt(), 0.0) };
    let time = 2.0 * build_up + hold;
    // Symmetric about its middle.
    [time, 0.5 * v * time]
}

#[test]
fn a_hold_on_a_line_is_the_closed_form() {
    for feed in [0.39, 0.1, 0.03, 0.004] {
        for jerk in [true, false] {
            let at = 0.3;
            let done = drive(&[line(0.3, feed)], &gantry(jerk), &[(at, 0.0)], 0.05);
            let j = if jerk { 3.0 / BUILD_UP } else { 1e12 };
            let [time, way] = braking(feed, 3.0, j);
            println!(
                "{feed} m/s, jerk {jerk}: {:?}, at best {time} s {way} m; {:?} s; {:?}",
                done.stops, done.took, done.report.effort
            );
            assert_eq!(done.stops.len(), 1);
            let [took, went] = done.stops[0];
            // At the faster end of a cell the solver leaves 4 % of the jerk limit.
            assert!(took >= time * 0.999 && took <= time * 1.02 + 2e-3, "{took} instead of {time}");
            assert!(went >= way * 0.999 && went <= way * 1.02, "{went} instead of {way}");
            assert_eq!(done.report.effort.not_replanned, 0);
        }
    }
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let factor = prop_oneof![3 => Just(0.0), 4 => exponential(0.05..2.0), 2 => Just(1.0)];
    prop::collection::vec((exponential(1e-3..0.3), factor), 1..12).prop_map(|mut changes| {
        let mut time = 0.0;
        for (at, _) in &mut changes {
            time += *at;
            *at = time;
        }
        changes
    })
}

fn holds(
    settings: Settings,
    steps: &[Step],
    changes: &[Change],
    lead: f64,
) -> Result<(), TestCaseError> {
    let path = walk(steps, settings.machine);
    let Replanned { report, took, .. } = drive(&path, &settings, changes, lead);
    println!(
        "{} changes, {:?}, jerk {}: {:.1} ms, {:.1} ms else; {:?}",
        changes.len(),
        settings.machine,
        settings.jerk,
        took[0] * 1e3,
        took[1] * 1e3,
        report.effort
    );
    // While it brakes it may be faster by what the slowest profile needs not to be the only one.
    // Where no new plan was found the old one goes on for a while.
    // Out of a corner in which a knife turns the path may have to speed up: else the knife would have to stop too hard.
    let held = report.effort.not_replanned == 0 && !settings.machine.turns();
    let most = if held { 1.08 } else { f64::INFINITY };
    prop_assert!(report.feed.value <= most, "feed {:?} on {settings:?}", report.feed);
    limits_hold(&report, &path, &settings, 1.02)
}

#[test]
fn what_is_asked_for_is_what_the_path_comes_to() {
    for jerk in [true, false] {
        // How long the path may go on as it was, s: to the first leg behind the lead. To less than 3 % it comes by way of
        // rest, with one more landing and launch.
        for (factor, waits) in [(0.5, 0.01), (0.1, 0.01), (1e-2, 0.05)] {
            let (feed, at, lead, length) = (0.1, 0.3, 0.05, 0.055);
            let path = [line(length, feed)];
            let Replanned { report, .. } = drive(&path, &gantry(jerk), &[(at, factor)], lead);
            println!("{factor}, jerk {jerk}: {} s, {:?}", report.duration, report.effort);
            // Up to the feed, from there to the other, and to rest: each symmetric about its middle. In between it goes on.
            let slow = factor * feed;
            let takes =
                |change: f64| braking(change, 3.0, if jerk { 3.0 / BUILD_UP } else { 1e12 })[0];
            let (up, over, down) = (takes(feed), takes(feed - slow), takes(slow));
            let expected = |from: f64| {
                let left = length
                    - feed * (from - 0.5 * up)
                    - 0.5 * (feed + slow) * over
                    - 0.5 * slow * down;
                from + over + left / slow + down
            };
            let [most, least] = [at + lead, at + lead + waits].map(expected);
            let took = report.duration;
            assert!(took >= least && took < 1.01 * most, "{factor}: {took} s, not {most} s");
        }
    }
}

proptest! {
    #![proptest_config(cases(8))]

    #[test]
    fn limits_of_a_knife_are_kept_through_changes(settings in settings(), steps in prop::collection::vec(step(), 1..16), changes in changes(), lead in 0.0..0.2) {
        holds(Settings { machine: Machine::Cutter, ..settings }, &steps, &changes, lead)?;
    }
}

proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn limits_of_jerk_are_kept_through_changes(settings in settings(), steps in prop::collection::vec(step(), 1..25), changes in changes(), lead in 0.0..0.2) {
        holds(settings, &steps, &changes, lead)?;
    }

    #[test]
    fn limits_of_acceleration_are_kept_through_changes(settings in settings(), steps in prop::collection::vec(step(), 1..25), changes in changes(), lead in 0.0..0.2) {
        holds(Settings { jerk: false, ..settings }, &steps, &changes, lead)?;
    }
}

/// A line with an M function in its middle, a switch, and a way back.
fn with_m_function() -> Vec<PathElement> {
    let at = |x: f64, y: f64| Point3::new(x, y, 0.0);
    let element = |line, kind, start, end| {
        let place = Place::at(line);
        let made = PathElement::new(place, kind, Shape::Line { start, end });
        PathElement { feed: 0.1, acceleration: 20.0, deceleration: 20.0, ..made }
    };
    vec![
        element(1, ElementKind::Cut, at(0.02, 0.0), at(0.06, 0.0)),
        element(2, ElementKind::MFunction { number: 7 }, at(0.06, 0.0), at(0.06, 0.0)),
        element(3, ElementKind::Cut, at(0.06, 0.0), at(0.06, 0.05)),
    ]
}

/// Set-points with what is done to the follower at some of them.
fn follow(mut act: impl FnMut(usize, &mut Following)) -> Vec<Followed> {
    let checked = CheckVelocities::new(with_m_function().into_iter().map(Ok::<_, CheckError>), PI);
    let settings = gantry(true);
    let planner = Planner::new(
        Box::new(checked) as Upstream,
        settings.machine.path(true),
        settings.options(),
    );
    let cycle = NonZeroU32::new(1_000_000).unwrap();
    let mut follower = Follower::new(planner, cycle);
    let mut all: Vec<Followed> = Vec::new();
    while let Some(followed) = follower.next() {
        all.push(followed.unwrap());
        act(all.len(), &mut follower);
        assert!(all.len() < 20_000, "no end");
    }
    let x: Vec<_> = all.iter().map(|followed| followed.tool.position).collect();
    for four in x.windows(4) {
        let jerk = (four[3] - four[2]) - 2.0 * (four[2] - four[1]) + (four[1] - four[0]);
        assert!(jerk.norm() / 1e-9 <= 1.05 * 3.0 / BUILD_UP, "{four:?}");
    }
    all
}

type Upstream = Box<dyn Iterator<Item = Result<CheckedElement, CheckError>>>;
type Following = Follower<Planner<Upstream, CheckError, KinematicPath<MachineAxes>>>;

#[test]
fn a_held_follower_stays_and_goes_on() {
    let all = follow(|count, follower| match count {
        // Held; still held at rest.
        200 | 700 => follower.set_override(0.0),
        1000 => follower.set_override(0.5),
        1050 => follower.set_override(2.0),
        _ => {}
    });
    let rests = all[700].tool;
    assert_eq!((rests.status, rests.m_function), (Status::Waiting, None));
    assert!(rests.path_velocity <= 0.0);
    assert_eq!(rests.position, all[999].tool.position);
    assert_ne!(rests.position, all[1040].tool.position);
    let last = all.last().unwrap();
    assert_eq!(last.tool.position, Point3::new(0.06, 0.05, 0.0));
    assert!((last.tool.way - 0.09).abs() < 1e-12, "{}", last.tool.way);
    let most = all.iter().skip(1400).map(|followed| followed.tool.path_velocity);
    let most = most.fold(0.0, f64::max);
    assert!(most <= 0.2 * 1.001, "{most}");
    assert_eq!(all.iter().filter(|followed| followed.tool.m_function.is_some()).count(), 1);
}

#[test]
fn a_stop_leaves_the_rest_undone() {
    let all = follow(|count, follower| {
        if count == 50 {
            follower.stop();
        }
    });
    let last = all.last().unwrap();
    assert_eq!(last.tool.status, Status::Finished);
    assert_eq!(last.element.place().line, 1);
    // The speed is still building up to the feed: the stop goes on with the same jerk, so that the way is that of the
    // acceleration and that of the braking. One cycle at the feed passes until the stop is planned.
    let [_, braking] = braking(0.1, 3.0, 3.0 / BUILD_UP);
    let late = last.tool.way - 2.0 * braking;
    assert!((0.0..1e-4).contains(&late), "{late}");
    assert!((last.tool.position.x - 0.02 - last.tool.way).abs() < 1e-12);
}
