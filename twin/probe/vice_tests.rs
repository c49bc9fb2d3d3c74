//! Tests of probing moves among the obstacles of a machine file against closed forms.

use super::{AxisProbe, AxisProbeEnd};
use crate::check::{CheckOptions, Outcome, check};
use crate::finding::{Rule, Severity};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use crate::simulated::Simulated;
use std::path::Path;
use twin_kinematics::{Kinematics, Pose};
use twin_machine::Machine;

/// Jaws with their tops at Z−10, the fixed one from Y−20 to Y0, stock from Z−30 to Z0, 100 × 60 mm; a tool of 6 mm.
const VICE: &str = include_str!("../../machines/gantry3_vice.toml");

fn machine() -> Machine {
    Machine::parse(Path::new("machine.toml"), VICE)
        .unwrap_or_else(|problems| panic!("{problems:#?}"))
}

fn checked(program: &str, physics: bool) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.ngc");
    std::fs::write(&path, program).unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Rs274), ReadSettings::default()).unwrap();
    let options = CheckOptions { physics, ..CheckOptions::default() };
    check(&machine(), &program, options, &mut |_| {}).unwrap()
}

/// Down on the stock, then against the front of the fixed jaw, off and away.
const TOUCH_OFF: &str = "G0 Z30\nG0 X50 Y30\nG38.2 Z-20 F100\nG0 Z30\nG0 Y-60\nG0 Z-20\n\
                         G38.2 Y10 F60\nG91 G0 Y-5\nG90 G0 Z30\nM2\n";

#[test]
fn probes_stop_on_stock_and_jaws() {
    for physics in [false, true] {
        let outcome = checked(TOUCH_OFF, physics);
        let said: Vec<_> =
            outcome.findings.iter().map(|one| (one.line, one.rule, &*one.message)).collect();
        assert!(outcome.findings.iter().all(|one| one.severity == Severity::Note), "{said:?}");
        for expected in [
            (3, Rule::Probe, "probe touches at X 50.000 Y 30.000 Z 0.000 mm"),
            (7, Rule::Probe, "probe touches at X 50.000 Y -23.000 Z -20.000 mm"),
        ] {
            assert!(said.contains(&expected), "{said:?}");
        }
        // Where the simulated machine is when it touches: as near as its drives follow (half a millimetre is allowed, and at
        // 100 mm/min it is less than a hundredth).
        let simulated = said.iter().filter(|one| one.2.starts_with("in the simulated"));
        let simulated: Vec<_> = simulated.map(|one| (one.0, place(one.2))).collect();
        if !physics {
            assert!(simulated.is_empty(), "{said:?}");
            continue;
        }
        let expected = [(3, [50.0, 30.0, 0.0]), (7, [50.0, -23.0, -20.0])];
        assert_eq!(simulated.len(), expected.len(), "{said:?}");
        for ((line, found), (wanted_line, wanted)) in simulated.iter().zip(expected) {
            assert_eq!(*line, wanted_line, "{said:?}");
            let near =
                found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 0.011);
            assert!(near, "{said:?}");
        }
    }
}

/// What is behind X, Y and Z.
fn place(text: &str) -> Vec<f64> {
    let words: Vec<_> = text.split_whitespace().collect();
    let behind = |letter: &str| {
        let at = words.iter().position(|word| *word == letter).unwrap();
        words[at + 1].parse().unwrap()
    };
    ["X", "Y", "Z"].map(behind).to_vec()
}

/// A touch does not permit going on: through what was touched, or into something else with stock at the tool.
#[test]
fn a_probe_is_a_tool_again_when_it_has_touched() {
    for (program, line) in [
        ("G0 Z30\nG0 X50 Y-60\nG0 Z-20\nG38.2 Y10 F60\nG0 Y40\nG0 Z30\nM2\n", 5),
        ("G0 Z30\nG0 X50 Y30\nG38.2 Z-20 F100\nG1 Z-12 F300\nG1 Y-40 F600\nG0 Z30\nM2\n", 5),
    ] {
        for physics in [false, true] {
            let outcome = checked(program, physics);
            let hit = |unit: &str| {
                outcome.findings.iter().any(|one| {
                    one.rule == Rule::Collision
                        && one.severity == Severity::Error
                        && one.line == line
                        && one.unit == Some(unit)
                })
            };
            assert!(hit("mm"), "{program}: {:#?}", outcome.findings);
            assert_eq!(hit("N"), physics, "{program}: {:#?}", outcome.findings);
        }
    }
}

/// Without a tool of its own a machine probes with the tip of that of the tool table: G43 H1, 25 mm long.
#[test]
fn a_tool_of_the_table_probes_with_its_tip() {
    let bare = VICE
        .replace("length_mm = 60.0\n", "")
        .replace("diameter_mm = 6.0  ", "# ")
        .replace("holder_", "# ")
        .replace("[rs274]", "[rs274]\ntool_table = \"tools.tbl\"");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tools.tbl"), "T1 P1 Z25 D6\n").unwrap();
    let machine = Machine::parse(&folder.path().join("machine.toml"), &bare)
        .unwrap_or_else(|problems| panic!("{problems:#?}"));
    let path = folder.path().join("program.ngc");
    std::fs::write(&path, "T1 M6\nG43 H1\nG0 Z55\nG0 X50 Y30\nG38.2 Z-20 F100\nM2\n").unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Rs274), ReadSettings::default()).unwrap();
    let outcome = check(&machine, &program, CheckOptions::default(), &mut |_| {}).unwrap();
    // Z0 of the program is the stock's top.
    let said: Vec<_> = outcome.findings.iter().map(|one| &*one.message).collect();
    assert!(
        said.iter().any(|one| one.starts_with("probe touches at X 50.000 Y 30.000 Z 25.000")),
        "{said:?}"
    );
}

#[test]
fn a_probe_that_finds_nothing_says_so() {
    let outcome = checked("G0 Z30\nG0 X200 Y30\nG38.2 Z10 F100\nG38.3 Z5\nM2\n", false);
    let [finding] = &outcome.findings[..] else { panic!("{:#?}", outcome.findings) };
    assert_eq!((finding.line, finding.rule, finding.severity), (3, Rule::Probe, Severity::Error));
}

/// Beside the jaw, `gap` m in front of it.
fn before_the_jaw(machine: &Machine, gap: f64) -> (Simulated, f64) {
    let place = Pose { position: [0.05, -0.023 - gap, -0.02].into(), direction: 0.0 };
    let place = machine.frame.pose_to_machine(&place);
    let axes = machine.kinematics.inverse(&place, &machine.middle()).unwrap();
    (Simulated::new(machine, &axes).unwrap(), axes[1])
}

/// Command 40: what is latched is the place of the jaw, to what the axis goes in a cycle; rest is v²/2a further.
#[test]
fn an_axis_probes_until_it_touches() {
    let machine = machine();
    let (velocity, deceleration) = (0.01, 0.1);
    let probe = AxisProbe {
        axis: 1,
        stroke: 0.05,
        start_velocity: 1e-3,
        velocity,
        acceleration: 0.05,
        deceleration,
        window: None,
    };
    let (mut simulated, start) = before_the_jaw(&machine, 0.02);
    let end = probe.run(&machine, &mut simulated).unwrap();
    let AxisProbeEnd::Tripped { latched, rest } = end else { panic!("{end:?}") };
    let jaw = start + 0.02;
    assert!((latched - jaw).abs() <= velocity * 1e-3 + 1e-6, "{latched} is not {jaw}");
    let stop = velocity * velocity / (2.0 * deceleration);
    assert!((rest - latched - stop).abs() < velocity * 2e-3, "{rest} is not {}", latched + stop);
    // A probe gives way: there is no impact.
    assert!(simulated.physics().contacts().is_empty());

    // It has tripped by now.
    assert_eq!(probe.run(&machine, &mut simulated).unwrap(), AxisProbeEnd::AlreadyTripped);

    // Away from the jaw there is nothing; the stroke ends exactly.
    let (mut simulated, start) = before_the_jaw(&machine, 0.02);
    let away = AxisProbe { stroke: -0.03, ..probe };
    assert_eq!(away.run(&machine, &mut simulated).unwrap(), AxisProbeEnd::NotTripped);
    let rest = simulated.physics().axis_state().position[1];
    assert!((rest - (start - 0.03)).abs() < 2e-5, "{rest}");
}

/// Command 40 on the board itself, 320 steps/mm: the counter at the edge, whole steps, and a ramp down behind it.
#[test]
fn a_board_in_the_loop_probes_with_its_own_ramps() {
    let mut machine = machine();
    machine.put_drives_in_loop();
    let (start_velocity, velocity, deceleration) = (1e-3, 0.01, 0.1);
    let probe = AxisProbe {
        axis: 1,
        stroke: 0.05,
        start_velocity,
        velocity,
        acceleration: 0.05,
        deceleration,
        window: None,
    };
    let (mut simulated, start) = before_the_jaw(&machine, 0.02);
    let end = probe.run(&machine, &mut simulated).unwrap();
    let AxisProbeEnd::Tripped { latched, rest } = end else { panic!("{end:?}") };
    let jaw = start + 0.02;
    let step = 1.0 / 320e3;
    assert!((latched - jaw).abs() <= velocity * 1e-3 + step, "{latched} is not {jaw}");
    assert!(
        (latched / step - (latched / step).round()).abs() < 1e-6,
        "{latched} is not a whole step"
    );
    // 0.1 m/s² are 32 thousand steps/s², which command 40 can say; it brakes from the cycle behind the edge.
    let stop = (velocity * velocity - start_velocity * start_velocity) / (2.0 * deceleration);
    let apart = rest - latched - stop;
    assert!(apart.abs() < velocity * 1e-3 + 2.0 * step, "{rest} is not {}", latched + stop);

    // The end of the stroke, and what has tripped before.
    assert_eq!(probe.run(&machine, &mut simulated).unwrap(), AxisProbeEnd::AlreadyTripped);
    let (mut simulated, start) = before_the_jaw(&machine, 0.02);
    let away = AxisProbe { stroke: -0.03, ..probe };
    assert_eq!(away.run(&machine, &mut simulated).unwrap(), AxisProbeEnd::NotTripped);
    let rest = simulated.physics().axis_state().position[1];
    assert!((rest - (start - 0.03)).abs() < 2e-5 + step, "{rest}");
    // What no register holds is said.
    let steep = AxisProbe { deceleration: 300.0, ..probe };
    let refused = steep.run(&machine, &mut simulated).unwrap_err().to_string();
    assert_eq!(
        refused,
        "deceleration of 96000 thousand steps/s²: command 40 has 1 to 65535 thousand steps/s²"
    );
}

/// `WindowOnly`: what touches before the window is nothing to it, a trip in it counts.
#[test]
fn a_trip_outside_its_window_does_not_count() {
    let machine = machine();
    let (simulated, start) = before_the_jaw(&machine, 0.02);
    let jaw = start + 0.02;
    let probe = |window| AxisProbe {
        axis: 1,
        stroke: 0.03,
        start_velocity: 0.0,
        velocity: 0.01,
        acceleration: 0.1,
        deceleration: 0.1,
        window: Some(window),
    };
    let end = |window| probe(window).run(&machine, &mut simulated.clone()).unwrap();
    for window in [[jaw - 1e-3, jaw + 1e-3], [jaw + 1e-3, jaw - 1e-3]] {
        let AxisProbeEnd::Tripped { latched, .. } = end(window) else { panic!("{window:?}") };
        assert!((latched - jaw).abs() < 2e-5, "{latched}");
    }
    for window in [[start, jaw - 1e-3], [jaw + 1e-3, jaw + 9e-3]] {
        assert_eq!(end(window), AxisProbeEnd::NotTripped, "{window:?}");
    }
    let mut looped = self::machine();
    looped.put_drives_in_loop();
    let refused = probe([jaw - 1e-3, jaw]).run(&looped, &mut simulated.clone()).unwrap_err();
    assert_eq!(refused.to_string(), "command 40 has no window; a trip counts everywhere");
}
