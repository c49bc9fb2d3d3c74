//! Tests of scenarios, valid and invalid.

use super::{GANTRY3, load};
use crate::section::Problem;
use crate::{FaultAt, FaultKind, FaultStart, Machine, Scenario};

const MOTORS: &str = include_str!("../../../machines/gantry3_motors.toml");

fn parse(text: &str, machine: &Machine) -> Result<Scenario, Vec<Problem>> {
    Scenario::parse(text, machine)
}

#[test]
fn faults_begin_at_times_and_lines() {
    let machine = load(MOTORS);
    let text = r#"
[[faults]]
kind = "jam"
axis = "X"
at_line = 12
for_s = 0.5
[[faults]]
kind = "lost_steps"
axis = "Z"
at_s = 1.25
steps = 8
[[faults]]
kind = "loose_belt"
axis = "Y"
at_s = 0
stiffness_percent = 20
backlash_mm = 0.3
[[faults]]
kind = "power_loss"
at_line = 40
"#;
    let at = |axis, start, kind| FaultAt { axis, start, kind };
    let expected = vec![
        at(Some(0), FaultStart::Line(12), FaultKind::Jam(Some(500_000_000))),
        at(Some(2), FaultStart::Time(1_250_000_000), FaultKind::LostSteps(8.0)),
        at(
            Some(1),
            FaultStart::Time(0),
            FaultKind::LooseBelt { stiffness: 0.2, backlash: 0.3 * 1e-3 },
        ),
        at(None, FaultStart::Line(40), FaultKind::PowerLoss),
    ];
    assert_eq!(parse(text, &machine), Ok(Scenario { seed: 0, faults: expected }));
}

#[test]
fn what_is_no_scenario_is_said() {
    let refused = |machine: &str, text: &str, said: &str| {
        let problems = parse(text, &load(machine)).expect_err(text);
        assert!(problems.iter().any(|problem| problem.message.contains(said)), "{problems:?}");
        assert!(problems.iter().all(|problem| problem.span.end <= text.len()), "{problems:?}");
    };
    refused(MOTORS, "", "the scenario lacks [[faults]]");
    refused(MOTORS, "[[faults]\nkind", "");
    for (machine, kind, rest, said) in [
        (MOTORS, "jam", "at_s = 1", "[[faults]] number 1 lacks `axis`"),
        (MOTORS, "jam", "axis = \"Q\"\nat_s = 1", "`axis` is \"Q\"; expected"),
        (MOTORS, "jan", "axis = \"X\"\nat_s = 1", "`kind` is \"jan\"; expected"),
        (MOTORS, "jam", "axis = \"X\"", "begins `at_s` or `at_line`"),
        (MOTORS, "jam", "axis = \"X\"\nat_s = 1\nat_line = 2", "one of them"),
        (MOTORS, "jam", "axis = \"X\"\nat_line = 0", "`at_line` is 0; it must"),
        (MOTORS, "jam", "axis = \"X\"\nat_s = 1\nsteps = 4", "unknown key `steps`"),
        (MOTORS, "lost_steps", "axis = \"X\"\nat_s = 1\nsteps = 4", "axis X has no step motor"),
        (GANTRY3, "loose_belt", "axis = \"X\"\nat_s = 1", "the transmission of axis X is rigid"),
    ] {
        refused(machine, &format!("[[faults]]\nkind = \"{kind}\"\n{rest}"), said);
    }
}
