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
    for (machine, text, said) in [
        (MOTORS, "", "the scenario lacks [[faults]]"),
        (MOTORS, "[[faults]]\nkind = \"jam\"\nat_s = 1", "[[faults]] number 1 lacks `axis`"),
        (MOTORS, "[[faults]]\nkind = \"jam\"\naxis = \"Q\"\nat_s = 1", "`axis` is \"Q\"; expected"),
        (
            MOTORS,
            "[[faults]]\nkind = \"jan\"\naxis = \"X\"\nat_s = 1",
            "`kind` is \"jan\"; expected",
        ),
        (MOTORS, "[[faults]]\nkind = \"jam\"\naxis = \"X\"", "begins `at_s` or `at_line`"),
        (MOTORS, "[[faults]]\nkind = \"jam\"\naxis = \"X\"\nat_s = 1\nat_line = 2", "one of them"),
        (
            MOTORS,
            "[[faults]]\nkind = \"jam\"\naxis = \"X\"\nat_line = 0",
            "`at_line` is 0; it must",
        ),
        (
            MOTORS,
            "[[faults]]\nkind = \"jam\"\naxis = \"X\"\nat_s = 1\nsteps = 4",
            "unknown key `steps`",
        ),
        (
            MOTORS,
            "[[faults]]\nkind = \"lost_steps\"\naxis = \"X\"\nat_s = 1\nsteps = 4",
            "axis X has no step motor",
        ),
        (
            GANTRY3,
            "[[faults]]\nkind = \"loose_belt\"\naxis = \"X\"\nat_s = 1",
            "the transmission of axis X is rigid",
        ),
        (MOTORS, "[[faults]\nkind", ""),
    ] {
        let problems = parse(text, &load(machine)).expect_err(text);
        assert!(problems.iter().any(|problem| problem.message.contains(said)), "{problems:?}");
        assert!(problems.iter().all(|problem| problem.span.end <= text.len()), "{problems:?}");
    }
}
