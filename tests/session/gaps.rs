//! Jumps of the set-point in a run: the axes cross them on their own (manual 3.2, 11.7.1).

use super::{GANTRY3, Program, Recorder, machine, simulate, simulate_with};
use std::cell::Cell;
use twin::m_function::Acknowledge;
use twin::session::{Answer, Stopped};

/// The example of manual 3.2, with M6 behind the jump. X: 400 mm/s, 3000 mm/s², 60000 mm/s³.
const PROGRAM: &str = "% example
N10 G92 X100 Y100
N20 G1 X100 Y100 F100 E1000 E-1000
N30 G92 X50 Y100
N35 M6
N40 G1 X60
";

/// 50 mm from rest to rest with t = 3000/60000 s for each change of the acceleration: t + √(t² + 4·50/3000); and 10 mm at 100 mm/s
/// with 1000 mm/s² in 0.2 s.
fn least_ns() -> i64 {
    let t = 3000.0_f64 / 60000.0;
    ((t + (t * t + 4.0 * 50.0 / 3000.0).sqrt() + 0.2) * 1e9) as i64
}

#[test]
fn the_path_waits_for_the_axes() {
    let (machine, program) = (machine(GANTRY3), Program::new(PROGRAM));
    let mut recorder = Recorder::new();
    let ending = simulate(&machine, &program, &mut recorder, &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    let least = least_ns();
    assert!((least..=least + 6_000_000).contains(&ending.executed_ns), "{}", ending.executed_ns);
    // No step is longer than a cycle of 400 mm/s, none of the velocity harder than 3000 mm/s².
    for pair in recorder.cycles.windows(2) {
        let of = |index: usize| (pair[index].axes.position[0], pair[index].axes.velocity[0]);
        let ((x0, v0), (x1, v1)) = (of(0), of(1));
        assert!((x1 - x0).abs() <= 0.4e-3 + 1e-12 && (v1 - v0).abs() <= 3e-3 + 1e-12, "{pair:?}");
        assert_eq!(pair[1].time_ns - pair[0].time_ns, machine.cycle_ns);
    }
    assert!((recorder.last().wanted.tool.x - 0.06).abs() < 1e-9);
    assert_eq!(recorder.last().path_velocity, 0.0);
}

/// The M function behind the jump is asked for when the axes are there, and the path goes on from there.
#[test]
fn an_m_function_behind_a_jump_is_waited_for() {
    let (machine, program) = (machine(GANTRY3), Program::new(PROGRAM));
    let mut recorder = Recorder::new();
    recorder.answers = [Answer::NotYet, Answer::Done].into();
    let ending = simulate_with(Acknowledge::Prompt, &machine, &program, &mut recorder, &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    let [(call, true)] = &recorder.m_functions[..] else { panic!("{:?}", recorder.m_functions) };
    let since = least_ns() - 200_000_000;
    assert!((since..=since + 4_000_000).contains(&call.since_ns), "{call:?}");
}

/// A stop on the way brakes every axis there.
#[test]
fn a_stop_in_a_gap_brakes_the_axes() {
    let machine = machine(GANTRY3);
    for within_axes in [false, true] {
        let text = PROGRAM.replace("N30 G92 X50", "N30 G92 X600");
        let program = Program::new(&text);
        let program = if within_axes { program.within_axes() } else { program };
        let time = Cell::new(0);
        let mut recorder = Recorder::with(|time_ns| time.set(time_ns));
        let interrupts = || u32::from(time.get() > 300_000_000);
        let ending = simulate(&machine, &program, &mut recorder, &interrupts);
        assert!(matches!(ending.stopped, Some(Stopped::Interrupted(_))), "{:?}", ending.stopped);
        let x = recorder.last().wanted.tool.x;
        assert!((0.15..0.4).contains(&x), "{x}");
        recorder.assert_twin_at_rest();
    }
}
