//! Overrides, feed holds and the first interrupt while a program runs: on the path, within the limits of the axes.

use crate::emergency::{HELICES, assert_within_limits, interrupted, scara};
use crate::puppet::{Puppet, run_puppet};
use crate::recorder::Cycle;
use crate::simulated::CIRCLES;
use crate::{Program, Recorder, portal, simulate};
use std::cell::Cell;
use twin::m_function::Acknowledge;
use twin::session::{Answer, Ending, OverrideChange, Session, Stopped};
use twin::simulated::Simulated;

/// What begins within this time, s, goes on as it was planned.
const LEAD: f64 = 0.1;
/// Items take some cycles.
const ITEM: f64 = 0.01;

fn seconds(time_ns: i64) -> f64 {
    time_ns as f64 * 1e-9
}

/// Delays from each request to the path's reaction, s.
fn delays(ending: &Ending) -> Vec<f64> {
    let delay = |change: &OverrideChange| {
        let follows_ns = change.follows_ns.unwrap_or_else(|| panic!("{change:?}"));
        seconds(follows_ns - change.asked.time_ns)
    };
    ending.overrides.iter().map(delay).collect()
}

/// Path velocities from one time to another, s: least and largest.
fn velocities(cycles: &[Cycle], from: f64, to: f64) -> [f64; 2] {
    let within = cycles.iter().filter(|cycle| (from..to).contains(&seconds(cycle.time_ns)));
    let all = within.map(|cycle| cycle.path_velocity);
    all.fold([f64::INFINITY, 0.0], |[least, most], v| [least.min(v), most.max(v)])
}

/// All set-points are on the helices: 30 mm about 330, 0, climbing 3 mm a turn from 20 mm on.
#[track_caller]
fn assert_on_helices(cycles: &[Cycle]) {
    for cycle in cycles {
        let tool = cycle.wanted.tool;
        let (x, y) = (tool.x - 0.33, tool.y);
        assert!((x.hypot(y) - 0.03).abs() < 1e-9, "{tool}");
        // Clockwise from the left.
        let turn = (-y).atan2(x) / std::f64::consts::TAU + 0.5;
        let off = (tool.z - 0.02) / 3e-3 - turn;
        assert!((off - off.round()).abs() < 1e-5, "{tool}: {off}");
    }
}

const CHANGES: [&str; 7] =
    ["0.7s=50%", "1.2s=0", "1.7s=120%", "2.3s=0", "2.31s=10%", "2.6s=200", "3s=100"];

#[test]
fn limits_of_the_axes_hold_across_changes_of_the_override() {
    let machine = scara();
    // Once as slow as programmed, once as fast as the axes can.
    for (feeds, slow) in [("F150 E1000 E-1000", true), ("F900 E9000 E-9000", false)] {
        let text = HELICES.replace("F150 E1000 E-1000", feeds);
        let mut recorder = Recorder::new();
        let undisturbed = Program::new(&text).within_axes();
        simulate(&machine, &undisturbed, &mut recorder, &|| 0);
        let end = recorder.last().wanted.tool;

        let program = undisturbed.with_overrides(&CHANGES);
        let mut recorder = Recorder::new();
        let ending = simulate(&machine, &program, &mut recorder, &|| 0);
        assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
        let cycles = &recorder.cycles;
        assert_within_limits(&machine, cycles, 0);
        assert_on_helices(cycles);
        assert!((recorder.last().wanted.tool - end).norm() < 1e-9);
        assert_eq!(ending.late_plans, 0);
        if slow {
            assert_eq!(ending.overrides.len(), CHANGES.len());
            // One change comes before the path has followed the one before it.
            assert_eq!(ending.overrides[3].follows_ns, None);
            let others = ending.overrides.iter().filter(|change| change.follows_ns.is_some());
            for change in others {
                let delay = seconds(change.follows_ns.unwrap() - change.asked.time_ns);
                assert!((0.0..=LEAD + ITEM).contains(&delay), "{change:?}");
            }
            // 150 mm/s and half of it take 0.1 s at 1000 mm/s² to change, and some for the jerk.
            let near = |[least, most]: [f64; 2], v: f64| least > 0.995 * v && most < 1.001 * v;
            assert!(near(velocities(cycles, 0.4, 0.8), 0.15));
            assert!(near(velocities(cycles, 1.05, 1.2), 0.075));
            assert_eq!(velocities(cycles, 1.55, 1.7), [0.0, 0.0]);
            assert!(near(velocities(cycles, 2.15, 2.4), 0.18));
            assert!(near(velocities(cycles, 2.65, 2.7), 0.015));
        }
    }
}

#[test]
fn the_controllers_own_planning_has_an_override_as_well() {
    let machine = portal();
    let program = Program::new(CIRCLES).with_overrides(&["1s=50%", "2s=0", "3s=100"]);
    let mut recorder = Recorder::new();
    let ending = simulate(&machine, &program, &mut recorder, &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    let cycles = &recorder.cycles;
    // From 100 mm/s at 500 mm/s²: 0.1 s to 50 mm/s, 0.1 s more to rest.
    assert!(velocities(cycles, 0.5, 0.99)[0] > 0.0999);
    let [least, most] = velocities(cycles, 1.11, 2.0);
    assert!(least > 0.0499 && most < 0.0501, "{least} {most}");
    assert_eq!(velocities(cycles, 2.11, 3.0), [0.0, 0.0]);
    assert!(velocities(cycles, 3.21, 3.5)[0] > 0.0999);
    assert!(
        delays(&ending).iter().all(|delay| (0.0..=0.002).contains(delay)),
        "{:?}",
        ending.overrides
    );
    recorder.assert_twin_at_rest();
}

#[test]
fn the_first_interrupt_brakes_on_the_path_within_the_limits_of_the_axes() {
    let machine = scara();
    for feeds in ["F150 E1000 E-1000", "F900 E9000 E-9000"] {
        let program = Program::new(&HELICES.replace("F150 E1000 E-1000", feeds)).within_axes();
        let (ending, recorder) = interrupted(&machine, &program, 1);
        assert!(matches!(ending.stopped, Some(Stopped::Interrupted(_))), "{:?}", ending.stopped);
        assert_eq!(ending.off_path, None);
        assert_within_limits(&machine, &recorder.cycles, 0);
        assert_on_helices(&recorder.cycles);
        recorder.assert_twin_at_rest();
        // Set-points of 0.1 s may be planned already. Then the lead, and 0.15 s at 1000 mm/s², or less.
        let rests = seconds(recorder.last().time_ns);
        assert!(rests < 1.0 + 0.1 + LEAD + ITEM + 0.15 + 0.08, "{rests}");
        assert!(velocities(&recorder.cycles, 0.9, 1.0)[0] > 0.1);
    }
}

#[test]
fn a_stop_does_not_wait_for_an_m_function() {
    let machine = scara();
    let program = Program::new(&HELICES.replace("N30", "N25 M7\nN30")).within_axes();
    let interrupts = Cell::new(0);
    let asked = Cell::new(0);
    let mut recorder = Recorder::with(|_| {});
    recorder.answers = std::iter::repeat_n(Answer::NotYet, 1000).collect();
    let ending =
        crate::simulate_with(Acknowledge::Prompt, &machine, &program, &mut recorder, &|| {
            // Long after it began to wait: rounds of the session.
            asked.set(asked.get() + 1);
            interrupts.set(u32::from(asked.get() > 400));
            interrupts.get()
        });
    assert!(
        matches!(ending.stopped, Some(Stopped::Interrupted(place)) if place.line == 4),
        "{:?}",
        ending.stopped
    );
    assert_eq!(ending.off_path, None);
    assert!(!recorder.answers.is_empty());
    assert!((recorder.last().wanted.tool.z - 0.023).abs() < 1e-9);
}

#[test]
fn beside_the_wall_clock_limits_hold_whenever_plans_come() {
    let machine = scara();
    let helix = |number: u32| format!("N{number}0 G2 I30 J0 Z{}\n", 17 + 3 * number);
    let further: String = (6..18).map(helix).collect();
    let text = HELICES.replace("F150 E1000 E-1000", "F900 E9000 E-9000") + &further;
    let program = Program::new(&text).within_axes();
    let program = program
        .with_overrides(&["0.3s=30%", "0.5s=0", "0.9s=80%", "1.0s=100", "1.3s=5%", "1.6s=200"]);
    let start = program.check(&machine).start.unwrap();
    let twin = Simulated::new(&machine, &start).unwrap();
    let session = Session { realtime: true, ..program.session(&machine, twin) };
    let mut recorder = Recorder::new();
    let ending = session.run(&mut recorder, &|| 0).unwrap();
    println!("{:?}, {} late", ending.overrides, ending.late_plans);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_within_limits(&machine, &recorder.cycles, 0);
    assert_on_helices(&recorder.cycles);
    assert!((recorder.last().wanted.tool - nalgebra::point![0.3, 0.0, 0.068]).norm() < 1e-9);
    // The last one at least has been followed: the lead grows until a plan is in time, and there is path enough for that.
    assert!(ending.overrides.last().unwrap().follows_ns.is_some());
}

#[test]
fn drives_follow_a_path_that_is_held_and_stopped() {
    let machine = portal();
    let program = Program::new(CIRCLES).within_axes();
    let program = program.with_overrides(&["0.4s=50%", "0.7s=0", "1.1s=100"]);
    let interrupts = Cell::new(0);
    let mut recorder =
        Recorder::with(|time_ns| interrupts.set(u32::from(time_ns >= 1_600_000_000)));
    let puppet = Puppet::default();
    let ending = run_puppet(&machine, puppet, &program, &mut recorder, &|| interrupts.get());
    assert!(matches!(ending.stopped, Some(Stopped::Interrupted(_))), "{:?}", ending.stopped);
    assert_eq!(ending.off_path, None);
    assert_within_limits(&machine, &recorder.cycles, 0);
    recorder.assert_twin_at_rest();
    let radius = (recorder.last().wanted.tool - nalgebra::point![0.03, 0.0, -0.04]).norm();
    assert!((radius - 0.03).abs() < 1e-9, "{radius}");
    // What the puppet says is where the set-points are, to an increment.
    assert!(ending.comparison.tool.drives.maximum().unwrap().0 < 1e-5);
}
