//! Runs within the limits of the axes, and emergency stops off the path: every axis at its own limits.

use crate::puppet::{Puppet, run_puppet};
use crate::recorder::Cycle;
use crate::simulated::CIRCLES;
use crate::{Program, Recorder, SCARA2, machine, portal, simulate, simulate_from, simulate_with};
use std::cell::Cell;
use std::collections::VecDeque;
use std::sync::Arc;
use twin::m_function::Acknowledge;
use twin::program::settings::ReadSettings;
use twin::session::{Answer, Ending, Stopped};
use twin_kinematics::AxisVector;
use twin_machine::Machine;

/// The SCARA, whose axes have jerks that are limited.
pub(crate) fn scara() -> Machine {
    let machine = machine(SCARA2);
    assert!(machine.axes.iter().all(|axis| axis.max_jerk.is_some()));
    machine
}

/// Helices of 30 mm radius and 3 mm pitch on the SCARA at 150 mm/s.
pub(crate) const HELICES: &str = "% helices\nN10 F150 E1000 E-1000\nN20 G2 X300 Y0 I30 J0 Z23\n\
                       N30 G2 I30 J0 Z26\nN40 G2 I30 J0 Z29\nN50 G2 I30 J0 Z32\n";

/// Looks no farther ahead than two elements.
fn short_sighted(text: &str) -> Program {
    let look_ahead = std::num::NonZeroUsize::new(2).unwrap();
    Program::read_by(text, ReadSettings { look_ahead, ..ReadSettings::default() })
}

/// From the cycle `first` on, divided differences of the positions alone stay within the limits of every axis.
#[track_caller]
pub(crate) fn assert_within_limits(machine: &Machine, cycles: &[Cycle], first: usize) {
    let dt = machine.cycle_ns as f64 * 1e-9;
    for (index, axis) in machine.axes.iter().enumerate() {
        let positions = cycles[first.saturating_sub(3)..].iter();
        let mut values: Vec<f64> = positions.map(|cycle| cycle.axes.position[index]).collect();
        let limits = [(axis.max_velocity, 1.001), (axis.max_acceleration, 1.001)];
        let limits = limits.into_iter().chain(axis.max_jerk.map(|jerk| (jerk, 1.05)));
        for (order, (limit, slack)) in limits.enumerate() {
            values = values.windows(2).map(|pair| (pair[1] - pair[0]) / dt).collect();
            let most = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            assert!(
                most <= slack * limit,
                "axis {}: derivative {} is {most}, {} times the limit",
                axis.name,
                order + 1,
                most / limit
            );
        }
    }
}

/// The first cycle behind which the path is left: the last that is on the helices or circles about `center`, at `radius`.
fn leaves(cycles: &[Cycle], center: [f64; 2], radius: f64) -> usize {
    let on = |cycle: &Cycle| {
        let tool = cycle.wanted.tool;
        ((tool.x - center[0]).hypot(tool.y - center[1]) - radius).abs() < 1e-9
    };
    cycles.iter().rposition(on).unwrap()
}

/// All axes rest at the end, and it took no longer than the slowest of them needs: v/A + A/J.
#[track_caller]
fn assert_braked(machine: &Machine, cycles: &[Cycle], from: usize) {
    let moving = |cycle: &Cycle| cycle.axes.velocity.iter().any(|velocity| *velocity != 0.0);
    let last = cycles.last().unwrap();
    assert!(!moving(last) && last.axes.acceleration.iter().all(|value| *value == 0.0), "{last:?}");
    let rests = cycles.iter().rposition(moving).unwrap() + 1;
    let taken = (rests - from) as f64 * machine.cycle_ns as f64 * 1e-9;
    let needs = machine.axes.iter().enumerate().map(|(index, axis)| {
        let velocity = cycles[from].axes.velocity[index].abs();
        // It may be speeding up when it has to brake.
        let turn = axis.max_jerk.map_or(0.0, |jerk| 2.0 * axis.max_acceleration / jerk);
        velocity / axis.max_acceleration + turn
    });
    let needs = needs.fold(0.0, f64::max);
    assert!(taken > 2e-3 && taken <= needs + 2e-3, "{taken} s, {needs} s");
}

#[test]
fn a_plan_that_is_lost_at_full_speed_ends_at_rest_within_the_limits() {
    let machine = scara();
    let start = Program::new(HELICES).check(&machine).start.unwrap();
    // Nobody has checked it. Far enough on for the error not to be known at the start.
    let helix = |number: u32| format!("N{number}0 G2 I30 J0 Z{}\n", 17 + 3 * number);
    let helices: String = (6..26).map(helix).collect();
    let text = format!("{HELICES}{helices}N260 C5\nN270 G2 I30 J0 Z98\nN280 G2 I30 J0 Z101\n");
    for program in [short_sighted(&text), short_sighted(&text).within_axes()] {
        let mut recorder = Recorder::new();
        let auto = Acknowledge::Auto;
        let ending = simulate_from(&start, auto, &machine, &program, &mut recorder, &|| 0);
        let Some(stopped @ Stopped::Program { place, .. }) = &ending.stopped else {
            panic!("{:?}", ending.stopped)
        };
        assert_eq!(place.line, 27);
        assert!(stopped.to_string().starts_with("line 27 (N260): "), "{stopped}");
        assert!(ending.off_path.is_some());
        assert!(ending.reason().unwrap().contains("left the path"), "{:?}", ending.reason());
        let from = leaves(&recorder.cycles, [0.33, 0.0], 0.03);
        assert!(recorder.cycles[from].path_velocity > 0.14, "{:?}", recorder.cycles[from]);
        assert_within_limits(&machine, &recorder.cycles, from);
        assert_braked(&machine, &recorder.cycles, from);
        recorder.assert_twin_at_rest();
    }
}

#[test]
fn drives_follow_to_where_a_lost_plan_ends() {
    let machine = portal();
    // The set-points are planned 0.25 s ahead of the drives: the error is met in the second circle.
    let program = short_sighted(&format!("{CIRCLES}N40 G2 I30 J0\nN50 C5\nN60 G2 I30 J0\n"));
    let puppet = Puppet::default();
    let (found, soft_stops) = (Arc::clone(&puppet.found), Arc::clone(&puppet.soft_stops));
    let mut recorder = Recorder::new();
    let start = Program::new(CIRCLES).check(&machine).start.unwrap();
    let ending = crate::puppet::run_from(&start, &machine, puppet, &program, &mut recorder, &|| 0);
    assert!(matches!(ending.stopped, Some(Stopped::Program { .. })), "{:?}", ending.stopped);
    assert!(ending.off_path.is_some());
    let from = leaves(&recorder.cycles, [0.03, 0.0], 0.03);
    assert_within_limits(&machine, &recorder.cycles, from);
    assert_braked(&machine, &recorder.cycles, from);
    assert_eq!(soft_stops.load(std::sync::atomic::Ordering::SeqCst), 0);
    let wanted = recorder.last().wanted.axes;
    let found = *found.lock().unwrap();
    for ((axis, wanted), found) in machine.axes.iter().zip(wanted.iter()).zip(found) {
        let increments = (wanted * axis.increments_per_si()).round();
        assert!((found as f64 - increments).abs() <= 1.0, "{}: {found} {increments}", axis.name);
    }
}

/// Interrupts `count` times at 1 s.
pub(crate) fn interrupted(
    machine: &Machine,
    program: &Program,
    count: u32,
) -> (Ending, Recorder<'static>) {
    let interrupts = Cell::new(0);
    let mut recorder =
        Recorder::with(|time_ns| interrupts.set(if time_ns >= 1_000_000_000 { count } else { 0 }));
    let ending = simulate(machine, program, &mut recorder, &|| interrupts.get());
    (ending, recorder.ended())
}

#[test]
fn a_second_interrupt_brakes_every_axis_at_its_own_limits() {
    let machine = scara();
    let program = Program::new(&HELICES.replace("E1000 E-1000", "E1000 E-200"));
    let (on_path, slowly) = interrupted(&machine, &program, 1);
    let (ending, recorder) = interrupted(&machine, &program, 2);
    let from = leaves(&recorder.cycles, [0.33, 0.0], 0.03);
    assert_within_limits(&machine, &recorder.cycles, from);
    assert_braked(&machine, &recorder.cycles, from);
    recorder.assert_twin_at_rest();
    assert!(matches!(ending.stopped, Some(Stopped::Interrupted(_))), "{:?}", ending.stopped);
    assert_eq!((on_path.off_path, ending.off_path.map(|place| place.line)), (None, Some(3)));
    // 150 mm/s at 200 mm/s² take 0.75 s on the path.
    assert!(recorder.last().time_ns + 300_000_000 < slowly.last().time_ns);
}

#[test]
fn a_run_within_the_limits_of_the_axes_is_what_was_checked() {
    let machine = scara();
    // Four times what the axes can do, and two M functions.
    let text = HELICES
        .replace("F150 E1000 E-1000", "F900 E9000 E-9000")
        .replace("N30", "N25 M3\nN26 M3\nN30");
    let program = Program::new(&text).within_axes();
    let outcome = program.check(&machine);
    assert!(!outcome.findings.is_empty(), "feeds that the axes cannot hold");
    let mut recorder = Recorder::new();
    let ending = simulate(&machine, &program, &mut recorder, &|| 0);
    assert!(ending.stopped.is_none() && ending.off_path.is_none(), "{:?}", ending.stopped);
    assert_eq!(ending.executed_ns, outcome.duration_ns);
    assert_eq!(recorder.cycles.len() as i64, outcome.duration_ns / machine.cycle_ns + 1);
    assert_within_limits(&machine, &recorder.cycles, 0);
    assert_eq!(recorder.last().path_velocity, 0.0);
    let calls: Vec<_> =
        recorder.m_functions.iter().map(|(call, _)| (call.index, call.place.line)).collect();
    assert_eq!(calls, [(0, 4), (1, 5)]);
    // Some axis is at a limit: it is not merely slow.
    let fastest = |index: usize| {
        let velocities = recorder.cycles.iter().map(|cycle| cycle.axes.velocity[index].abs());
        velocities.fold(0.0, f64::max) / machine.axes[index].max_velocity
    };
    let hardest = |index: usize| {
        let values = recorder.cycles.iter().map(|cycle| cycle.axes.acceleration[index].abs());
        values.fold(0.0, f64::max) / machine.axes[index].max_acceleration
    };
    assert!((0..3).any(|index| fastest(index) > 0.98 || hardest(index) > 0.98));
}

#[test]
fn within_the_limits_of_the_axes_the_user_is_waited_for_as_well() {
    let machine = scara();
    let text = HELICES.replace("N30", "N25 M7\nN26 M7\nN30");
    let program = Program::new(&text).within_axes();
    let outcome = program.check(&machine);
    let mut recorder = Recorder::new();
    let silence = std::iter::repeat_n(Answer::NotYet, 30);
    recorder.answers = silence.chain([Answer::Done, Answer::NotYet, Answer::Done]).collect();
    let ending = simulate_with(Acknowledge::Prompt, &machine, &program, &mut recorder, &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(recorder.answers, VecDeque::new());
    let asked: Vec<_> =
        recorder.m_functions.iter().map(|(call, asked)| (call.index, *asked)).collect();
    assert_eq!(asked, [(0, true), (1, true)]);
    assert_within_limits(&machine, &recorder.cycles, 0);
    // Time that nobody has waited for does not pass: a cycle more or less.
    assert!((ending.executed_ns - outcome.duration_ns).abs() <= 4 * machine.cycle_ns);
    // Every instant is one cycle after the last.
    let mut pairs = recorder.cycles.windows(2);
    assert!(pairs.all(|pair| pair[1].time_ns - pair[0].time_ns == machine.cycle_ns));
}

#[test]
fn outputs_switch_before_a_path_within_the_limits_of_the_axes_goes_on() {
    let switches = "[[m_functions]]\nm = 3\noutputs_on = [2]\ntime_ms = 50\n";
    let machine = machine(&format!("{}\n{switches}", crate::GANTRY3));
    let text =
        "% two\nN10 G92 X0 Y0 Z-40\nN20 G1 X10 F100 E1000 E-1000\nN30 M3\nN40 M3\nN50 G1 X20\n";
    let program = Program::new(text).within_axes();
    let puppet = Puppet::default();
    let outputs = Arc::clone(&puppet.outputs);
    let mut recorder = Recorder::new();
    let ending = run_puppet(&machine, puppet, &program, &mut recorder, &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(*outputs.lock().unwrap(), [(2, true), (2, true)]);
    // Two moves of 0.2 s, and 0.05 s each at least.
    assert!(ending.executed_ns > 500_000_000, "{}", ending.executed_ns);
    assert!((recorder.last().wanted.tool - nalgebra::point![0.02, 0.0, -0.04]).norm() < 1e-9);
}

/// The first one stops on the path, the second off it.
#[test]
fn an_interrupt_before_the_first_cycle_moves_nothing() {
    let machine = portal();
    for (program, count) in [
        (Program::new(CIRCLES), 1),
        (Program::new(CIRCLES), 2),
        (Program::new(CIRCLES).within_axes(), 1),
        (Program::new(CIRCLES).within_axes(), 2),
    ] {
        let mut recorder = Recorder::new();
        let ending = simulate(&machine, &program, &mut recorder, &|| count);
        assert!(matches!(ending.stopped, Some(Stopped::Interrupted(_))), "{:?}", ending.stopped);
        let start = nalgebra::point![0.0, 0.0, -0.04];
        assert!(recorder.cycles.iter().all(|cycle| (cycle.wanted.tool - start).norm() < 1e-12));
        if count == 2 {
            assert_eq!((ending.off_path, ending.executed_ns), (None, 0));
            let at_rest = |cycle: &Cycle| cycle.wanted.axes == AxisVector::zeros(3);
            assert!(recorder.cycles.iter().all(at_rest));
        }
    }
}
