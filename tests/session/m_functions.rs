//! M functions in a run: acknowledgement, and outputs switched by M functions and tappets.

use super::puppet::{Puppet, run_puppet};
use super::{GANTRY3, Program, Recorder, machine, simulate, simulate_with};
use std::collections::VecDeque;
use std::sync::Arc;
use twin::m_function::Acknowledge;
use twin::session::{Answer, Stopped};

const PROGRAM: &str = "% two
N10 G92 X0 Y0 Z-40
N20 G1 X10 F100 E1000 E-1000
N30 M3
N40 M3
N50 G1 X20
";

/// M3 switches output 2 on and output 5 off.
const SWITCHES: &str =
    "[[m_functions]]\nm = 3\noutputs_on = [2]\noutputs_off = [5]\ntime_ms = 50\n";

fn numbers(recorder: &Recorder<'_>) -> Vec<(u64, u16, u32, bool)> {
    let calls = recorder.m_functions.iter();
    calls.map(|(call, asked)| (call.index, call.number, call.place.line, *asked)).collect()
}

/// Two moves of 10 mm at 100 mm/s with 1000 mm/s² take 0.2 s each.
#[test]
fn by_themselves_they_take_a_cycle() {
    let (machine, program) = (machine(GANTRY3), Program::new(PROGRAM));
    let mut recorder = Recorder::new();
    let ending = simulate(&machine, &program, &mut recorder, &|| 0);
    assert!(ending.stopped.is_none());
    assert!((400_000_000..=404_000_000).contains(&ending.executed_ns), "{}", ending.executed_ns);
    assert_eq!(numbers(&recorder), [(0, 3, 4, false), (1, 3, 5, false)]);
}

#[test]
fn each_may_take_its_time() {
    let (gantry, program) = (machine(GANTRY3), Program::new(PROGRAM));
    let after = Acknowledge::After(300_000_000);
    let ending = simulate_with(after, &gantry, &program, &mut Recorder::new(), &|| 0);
    assert!((1_000_000_000..=1_004_000_000).contains(&ending.executed_ns));
    // What the machine file says of an M function counts more; without drives it is the time alone.
    let gantry = machine(&format!("{GANTRY3}\n{SWITCHES}"));
    let ending = simulate_with(after, &gantry, &program, &mut Recorder::new(), &|| 0);
    assert!((500_000_000..=504_000_000).contains(&ending.executed_ns), "{}", ending.executed_ns);
}

#[test]
fn the_user_is_waited_for_and_no_time_passes() {
    let (machine, program) = (machine(GANTRY3), Program::new(PROGRAM));
    let mut recorder = Recorder::new();
    let silence = std::iter::repeat_n(Answer::NotYet, 30);
    recorder.answers = silence.chain([Answer::Done, Answer::NotYet, Answer::Done]).collect();
    let ending = simulate_with(Acknowledge::Prompt, &machine, &program, &mut recorder, &|| 0);
    assert!(ending.stopped.is_none());
    assert!((400_000_000..=404_000_000).contains(&ending.executed_ns), "{}", ending.executed_ns);
    assert_eq!(numbers(&recorder), [(0, 3, 4, true), (1, 3, 5, true)]);
    assert_eq!(recorder.answers, VecDeque::new());
}

#[test]
fn where_nobody_can_acknowledge_the_run_ends_at_rest() {
    let (machine, program) = (machine(GANTRY3), Program::new(PROGRAM));
    let mut recorder = Recorder::new();
    recorder.answers = [Answer::Done].into();
    let ending = simulate_with(Acknowledge::Prompt, &machine, &program, &mut recorder, &|| 0);
    let Some(Stopped::Unacknowledged { number: 3, place }) = ending.stopped else {
        panic!("{:?}", ending.stopped);
    };
    assert_eq!(place.line, 5);
    recorder.assert_twin_at_rest();
}

#[test]
fn an_interrupt_ends_the_waiting() {
    let (machine, program) = (machine(GANTRY3), Program::new(PROGRAM));
    let mut recorder = Recorder::new();
    recorder.answers = std::iter::repeat_n(Answer::NotYet, 100_000).collect();
    let asked = std::cell::Cell::new(0);
    let interrupts = || {
        asked.set(asked.get() + 1);
        u32::from(asked.get() > 100)
    };
    let ending = simulate_with(Acknowledge::Prompt, &machine, &program, &mut recorder, &interrupts);
    assert!(matches!(ending.stopped, Some(Stopped::Interrupted(_))), "{:?}", ending.stopped);
    assert_eq!(numbers(&recorder), [(0, 3, 4, true)]);
}

#[test]
fn the_drives_switch_before_the_path_goes_on() {
    let machine = machine(&format!("{GANTRY3}\n{SWITCHES}"));
    let puppet = Puppet::default();
    let outputs = Arc::clone(&puppet.outputs);
    let mut recorder = Recorder::new();
    let ending = run_puppet(&machine, puppet, &Program::new(PROGRAM), &mut recorder, &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(*outputs.lock().unwrap(), [(5, false), (2, true), (5, false), (2, true)]);
    // 0.05 s each at least, and what the plan is ahead.
    assert!(ending.executed_ns > 500_000_000, "{}", ending.executed_ns);
}

#[test]
fn a_program_that_ends_early_leaves_no_output_on() {
    let machine = machine(&format!("{GANTRY3}\n{SWITCHES}"));
    let text = format!("{PROGRAM}N60 G1 X10\nN70 G1 X20\nN80 G1 X10\nN90 G1 X20\n");
    // On the path, and off it.
    for interrupts in [1, 2] {
        let puppet = Puppet::default();
        let outputs = Arc::clone(&puppet.outputs);
        let switched = || u32::from(outputs.lock().unwrap().len() >= 2) * interrupts;
        let ending =
            run_puppet(&machine, puppet, &Program::new(&text), &mut Recorder::new(), &switched);
        assert!(matches!(ending.stopped, Some(Stopped::Interrupted(_))), "{:?}", ending.stopped);
        assert!(ending.left_on.is_empty());
        let outputs = outputs.lock().unwrap();
        assert_eq!(outputs.last(), Some(&(2, false)), "{outputs:?}");
    }
}

/// A program that goes to its end is obeyed, also in what it leaves on.
#[test]
fn a_program_that_ends_leaves_on_what_it_has_switched_on() {
    let machine = machine(&format!("{GANTRY3}\n{SWITCHES}"));
    let puppet = Puppet::default();
    let outputs = Arc::clone(&puppet.outputs);
    let program = Program::new("% on\nN10 G92 X0 Y0 Z-40\nN20 G1 X1 F100 E1000 E-1000\nN30 M3\n");
    let ending = run_puppet(&machine, puppet, &program, &mut Recorder::new(), &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(*outputs.lock().unwrap(), [(5, false), (2, true)]);
}

/// Y follows X by the flying shear, whose tappets switch at 220 and 350 mm of the master on its way forwards, and not back.
fn shear(output: &str) -> String {
    let cam = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/cams/flying_shear.toml");
    format!(
        "{GANTRY3}\n[[cams]]\naxis = \"Y\"\nmaster = \"X\"\ncam = {cam:?}\n[[tappet_outputs]]\n{output}"
    )
}

const THERE_AND_BACK: &str = "% shear
N10 G92 X0 Y0 Z-40
N20 G1 X400 F300 E2000 E-2000
N30 G1 X0
";

#[test]
fn outputs_follow_tappets() {
    let machine = machine(&shear("axis = \"Y\"\ngroup = 1\noutput = 4\n"));
    let puppet = Puppet::default();
    let outputs = Arc::clone(&puppet.outputs);
    let mut recorder = Recorder::new();
    let program = Program::new(THERE_AND_BACK);
    let ending = run_puppet(&machine, puppet, &program, &mut recorder, &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(*outputs.lock().unwrap(), [(4, true), (4, false)]);
    let [(device, switched)] = &ending.switched[..] else { panic!("{:?}", ending.switched) };
    assert_eq!((device.as_str(), switched.count), ("board", 2));
    // Nothing is switched before it is due.
    assert!(0.0 < switched.mean_ms() && switched.mean_ms() <= switched.latest_ms(), "{switched:?}");
}

/// As in the example of manual 3.2.1, switch 2 changes a quarter along a move, whether it goes on or off there; switch 3 has
/// no output.
#[test]
fn outputs_follow_switch_points() {
    let machine = machine(&format!("{GANTRY3}\n[[switch_outputs]]\nh = 2\noutput = 4\n"));
    let puppet = Puppet::default();
    let outputs = Arc::clone(&puppet.outputs);
    let program = Program::new(
        "% points\nN10 G92 X0 Y0 Z-40\nN20 G1 X100 F100 E1000 E-1000 H2 O0.25 H3 O0.5\nN30 G1 X0 H-2 O0.25\n",
    );
    let outcome = program.check(&machine);
    let found: Vec<_> = outcome.switch_points.first().iter().collect();
    let all: Vec<_> = found.iter().map(|one| (one.number, one.on, one.place.line)).collect();
    assert_eq!(all, [(2, true, 3), (3, true, 3), (2, false, 4)]);
    // 0.1 s for the first 5 mm, and 100 mm/s from there: 25 mm after 0.3 s, 50 mm after 0.55 s; each move takes 1.1 s.
    for (point, seconds) in found.iter().zip([0.3, 0.55, 1.4]) {
        let late_ns = point.time_ns - (seconds * 1e9) as i64;
        assert!((0..=1_000_000).contains(&late_ns), "{point:?}");
    }
    let ending = run_puppet(&machine, puppet, &program, &mut Recorder::new(), &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(*outputs.lock().unwrap(), [(4, true), (4, false)]);
}

#[test]
fn outputs_of_other_tappets_stay_as_they_are() {
    let machine = machine(&shear("axis = \"Y\"\ngroup = 2\noutput = 4\n"));
    let puppet = Puppet::default();
    let outputs = Arc::clone(&puppet.outputs);
    let program = Program::new(THERE_AND_BACK);
    let ending = run_puppet(&machine, puppet, &program, &mut Recorder::new(), &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(*outputs.lock().unwrap(), []);
}

/// The knife is down when the user stops the run: it is not left there.
#[test]
fn an_output_of_tappets_is_not_left_on() {
    let machine = machine(&shear("axis = \"Y\"\ngroup = 1\ndrive = \"board\"\noutput = 4\n"));
    for interrupts in [1, 2] {
        let puppet = Puppet::default();
        let outputs = Arc::clone(&puppet.outputs);
        let switched = || u32::from(!outputs.lock().unwrap().is_empty()) * interrupts;
        let program = Program::new(THERE_AND_BACK);
        let ending = run_puppet(&machine, puppet, &program, &mut Recorder::new(), &switched);
        assert!(matches!(ending.stopped, Some(Stopped::Interrupted(_))), "{:?}", ending.stopped);
        assert!(ending.left_on.is_empty());
        let outputs = outputs.lock().unwrap();
        assert_eq!(outputs.first(), Some(&(4, true)), "{outputs:?}");
        assert_eq!(outputs.last(), Some(&(4, false)), "{outputs:?}");
    }
}
