//! Runs of the simulated machine alone.

use crate::{Program, Recorder, SCARA2, machine, portal, simulate};
use std::cell::Cell;
use twin::clock::Clock;
use twin::compare::ErrorStatistics;
use twin::limit::LimitFailure;
use twin::session::{Session, Stopped};
use twin::simulated::Simulated;
use twin_physics::MotorState;

/// 18.03 mm, a semicircle of 10 mm radius, 17 mm: 1.2 s on the SCARA.
const SHORT: &str =
    "% short\nN10 F120 E600 E-600\nN20 G1 X290 Y15\nN30 G2 X310 Y15 R10\nN40 G1 X300 Y0 Z12\n";
/// Three full circles of 30 mm radius on the portal, at full feed from 100 mm/s² on: 6 s.
pub(crate) const CIRCLES: &str =
    "% circles\nN10 G2 I30 J0 F100 E500 E-500\nN20 G2 I30 J0\nN30 G2 I30 J0\n";

#[test]
fn the_same_run_gives_the_same_numbers_to_the_last_bit() {
    let machine = machine(SCARA2);
    let program = Program::new(SHORT);
    let run = || {
        let mut recorder = Recorder::new();
        let ending = simulate(&machine, &program, &mut recorder, &|| 0);
        assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
        (ending, recorder)
    };
    let ((first, seen), (second, seen_again)) = (run(), run());
    assert_eq!(first.comparison.tool, second.comparison.tool);
    assert_eq!(first.comparison.axes, second.comparison.axes);
    assert_eq!(first.executed_ns, second.executed_ns);
    let tools = |recorder: &Recorder<'_>| -> Vec<_> {
        recorder.cycles.iter().map(|cycle| cycle.twin).collect()
    };
    assert_eq!(tools(&seen), tools(&seen_again));
}

/// Cycle by cycle the motors are told of as the record sums them up.
#[test]
fn what_motors_do_is_told_in_every_cycle() {
    let machine = machine(include_str!("../../machines/gantry3_motors.toml"));
    let text = "% short\nN10 G92 X0 Y0 Z20 F100 E600 E-600\nN20 G1 X20 Y15\nN30 G1 X0 Z12\n";
    let mut recorder = Recorder::new();
    let ending = simulate(&machine, &Program::new(text), &mut recorder, &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(recorder.motors.len(), recorder.cycles.len());
    for (axis, load) in ending.record.loads.iter().enumerate() {
        let motors: Vec<_> = recorder.motors.iter().map(|motors| motors[axis]).collect();
        // The machine stands at the first set-point; the others have a cycle each.
        let energy: f64 = motors[1..].iter().map(|motor| motor.power * 1e-3).sum();
        let wanted = load.driving_energy - load.braking_energy;
        assert!(wanted.abs() > 1e-6, "{load:?}");
        assert!((energy - wanted).abs() < 1e-9, "axis {axis}: {energy} J, not {wanted} J");
        let peak = motors.iter().map(|motor| motor.effort.abs()).fold(0.0, f64::max);
        // The mean of a cycle is below the peak within it, and not by much.
        assert!(peak <= load.peak_effort && peak > 0.5 * load.peak_effort, "{peak} N, {load:?}");
        let used = motors.iter().filter_map(MotorState::utilisation).fold(0.0, f64::max);
        assert!(used > 0.001 && used < 1.0, "axis {axis}: {used}");
        let warmth = motors.iter().filter_map(|motor| motor.warmth).reduce(f64::max);
        assert!(warmth <= load.peak_warmth && warmth.is_some() == load.peak_warmth.is_some());
        // Z alone has a step motor.
        assert!(motors.iter().all(|motor| motor.load_angle.is_some() == (axis == 2)));
    }
    assert_eq!(ending.record.loads.len(), 3);
}

#[test]
fn the_simulated_machine_follows_closely_and_not_exactly() {
    let machine = machine(SCARA2);
    let program = Program::new(SHORT);
    let outcome = program.check(&machine);
    let mut recorder = Recorder::new();
    let ending = simulate(&machine, &program, &mut recorder, &|| 0);
    // Every set-point of the check, one per millisecond, and the last at the end.
    assert_eq!(ending.executed_ns, outcome.duration_ns);
    assert_eq!(recorder.cycles.len() as i64, outcome.duration_ns / machine.cycle_ns + 1);
    let times_are_cycles = |(index, cycle): (usize, &crate::recorder::Cycle)| {
        cycle.time_ns == index as i64 * machine.cycle_ns
    };
    assert!(recorder.cycles.iter().enumerate().all(times_are_cycles));
    // It moved, all the way: 18.028 + 31.416 + √(10² + 15² + 8²) mm.
    let travelled: f64 =
        recorder.cycles.windows(2).map(|pair| (pair[1].twin.tool - pair[0].twin.tool).norm()).sum();
    let length = (10f64.hypot(15.0) + 10.0 * std::f64::consts::PI + 389f64.sqrt()) * 1e-3;
    assert!((travelled - length).abs() < 0.01 * length, "{travelled} m of {length} m");
    assert!((outcome.length - length).abs() < 1e-9);
    recorder.assert_twin_at_rest();
    assert!((recorder.last().twin.tool - nalgebra::point![0.3, 0.0, 0.012]).norm() < 1e-4);

    let ErrorStatistics { twin, drives, drives_against_twin } = ending.comparison.tool;
    let (max, place) = twin.maximum().unwrap();
    assert!(max > 1e-7 && max < 5e-4, "{max} m");
    assert!(twin.rms() > 0.0 && twin.rms() < max);
    assert!((2..=5).contains(&place.line));
    assert_eq!((drives.maximum(), drives_against_twin.maximum()), (None, None));
    // What is reported is what was shown.
    let shown = recorder.cycles.iter().map(|cycle| (cycle.twin.tool - cycle.wanted.tool).norm());
    assert_eq!(shown.fold(0.0, f64::max), max);
    for (index, axis) in ending.comparison.axes.iter().enumerate() {
        let shown = recorder
            .cycles
            .iter()
            .map(|cycle| (cycle.twin.axes[index] - cycle.wanted.axes[index]).abs());
        assert_eq!(Some(shown.fold(0.0, f64::max)), axis.twin.maximum().map(|(max, _)| max));
    }
    let lines: Vec<_> = recorder.cycles.iter().map(|cycle| cycle.line).collect();
    assert!(lines.is_sorted() && lines.first() == Some(&3) && lines.last() == Some(&5));
}

#[test]
fn an_interrupt_stops_on_the_path_at_rest() {
    let machine = portal();
    let program = Program::new(CIRCLES);
    let duration_ns = program.check(&machine).duration_ns;
    let interrupts = Cell::new(0);
    let mut recorder =
        Recorder::with(|time_ns| interrupts.set(u32::from(time_ns >= 1_500_000_000)));
    let ending = simulate(&machine, &program, &mut recorder, &|| interrupts.get());
    let Some(Stopped::Interrupted(place)) = ending.stopped else { panic!("{:?}", ending.stopped) };
    assert_eq!((place.line, place.block), (2, Some(10)));
    // From 100 mm/s at 500 mm/s² 0.2 s, after the 0.1 s that are simulated in one go.
    assert!(ending.executed_ns < 2_000_000_000 && ending.executed_ns < duration_ns / 2);
    assert_eq!(ending.executed_ns, recorder.last().time_ns);
    recorder.assert_twin_at_rest();
    // On the circle about 30, 0.
    let radius = (recorder.last().wanted.tool - nalgebra::point![0.03, 0.0, -0.04]).norm();
    assert!((radius - 0.03).abs() < 1e-9, "{radius}");
    let before = &recorder.cycles[recorder.cycles.len() - 100];
    assert!(before.path_velocity > 0.01, "it braked, and did not just stop");
    // Where that was: v/a = 0.2 s after the end of the 0.1 s that were simulated already, on the circle.
    let reason = ending.rest.as_ref().unwrap().message(&machine);
    let rest = ending.rest.unwrap();
    let asked_ns = rest.asked_ns.unwrap();
    assert!((1_500_000_000..1_600_000_000).contains(&asked_ns), "{asked_ns}");
    let braked_ns = rest.time_ns - asked_ns;
    assert!((200_000_000..302_000_000).contains(&braked_ns), "{braked_ns}");
    assert_eq!((rest.place.line, rest.place.block), (2, Some(10)));
    assert_eq!(rest.wanted.tool, recorder.last().wanted.tool);
    assert!((rest.twin.unwrap().tool - rest.wanted.tool).norm() < 1e-6 && rest.drives.is_none());
    // The portal's axes are the tool's coordinates.
    let [x, y] = [0, 1].map(|axis| rest.wanted.axes[axis] * 1e3);
    for part in [
        format!(
            "the stop was asked for at {:.3} s; the axes came to rest at",
            asked_ns as f64 * 1e-9
        ),
        format!("{:.3} s, line 2 (N10): X {x:.4} mm, Y {y:.4} mm", rest.time_ns as f64 * 1e-9),
        format!("tool at X {x:.4} Y {y:.4} Z -40.0000 mm"),
    ] {
        assert!(reason.contains(&part), "{reason} has no {part}");
    }
}

#[test]
fn what_was_not_checked_is_not_run() {
    let machine = machine(SCARA2);
    let program = Program::new(SHORT);
    let start = program.check(&machine).start.unwrap();
    let run = || {
        let twin = Simulated::new(&machine, &start).unwrap();
        program.session(&machine, twin).run(&mut Recorder::new(), &|| 0)
    };
    assert!(run().unwrap().stopped.is_none());
    // Harmless, but another program.
    std::fs::write(program.file.path(), "% other\nN10 G1 X290 F100 E500 E-500\n").unwrap();
    let error = run().unwrap_err();
    assert!(error.to_string().contains("has changed"), "{error}");
    std::fs::remove_file(program.file.path()).unwrap();
    let error = run().unwrap_err();
    let missing =
        matches!(&error, LimitFailure::Read(error) if error.kind() == std::io::ErrorKind::NotFound);
    assert!(missing, "{error}");
}

#[test]
fn a_file_that_changes_during_the_run_ends_it() {
    let machine = machine(SCARA2);
    // Longer than what is read at once.
    let mut text = "% long\nN10 G92 X300 Y0 Z20\nN20 G1 F100 E500 E-500\n".to_owned();
    for _ in 0..4000 {
        text.push_str("N30 G1 X300.1 Y0.0000\nN40 G1 X300.0 Y0.0000\n");
    }
    let program = Program::new(&text);
    let changed = Cell::new(false);
    let mut recorder = Recorder::with(|_| {
        if !changed.replace(true) {
            std::fs::write(program.file.path(), text.replace("300.1", "900.1")).unwrap();
        }
    });
    let ending = simulate(&machine, &program, &mut recorder, &|| 0);
    let Some(stopped @ Stopped::Read(_)) = &ending.stopped else { panic!("{:?}", ending.stopped) };
    assert!(stopped.to_string().contains("has changed"), "{stopped}");
}

#[test]
fn in_real_time_a_run_takes_no_less_than_its_time() {
    let machine = portal();
    let program = Program::new("% 0.2 s\nN10 G1 X10 F100 E1000 E-1000\n");
    let start = program.check(&machine).start.unwrap();
    let twin = Simulated::new(&machine, &start).unwrap();
    let session = Session { realtime: true, ..program.session(&machine, twin) };
    let clock = Clock::start();
    let ending = session.run(&mut Recorder::new(), &|| 0).unwrap();
    assert!(ending.executed_ns >= 199_000_000);
    assert!(clock.now_ns() >= ending.executed_ns, "{} ns", clock.now_ns());
}
