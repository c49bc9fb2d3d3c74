//! Probes among what a machine file says is there, in closed form.

use super::{AxisProbe, AxisProbeEnd};
use crate::check::{CheckOptions, Outcome, check};
use crate::finding::{Rule, Severity};
use crate::machine::Machine;
use crate::program::{Dialect, ProgramFile};
use crate::settings::ReadSettings;
use crate::simulated::Simulated;
use std::path::Path;
use twin_kinematics::{Kinematics, Pose};

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
        let simulated: Vec<_> =
            said.iter().filter(|one| one.2.starts_with("in the simulated")).collect();
        assert_eq!(!simulated.is_empty(), physics, "{said:?}");
    }
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
    };
    let (mut simulated, start) = before_the_jaw(&machine, 0.02);
    let end = probe.run(&machine, &mut simulated).unwrap();
    let AxisProbeEnd::Tripped { latched, rest } = end else { panic!("{end:?}") };
    let jaw = start + 0.02;
    assert!((latched - jaw).abs() <= velocity * 1e-3 + 1e-6, "{latched} is not {jaw}");
    let stop = velocity * velocity / (2.0 * deceleration);
    assert!((rest - latched - stop).abs() < velocity * 2e-3, "{rest} is not {}", latched + stop);
    // A probe gives way: there is no blow.
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
