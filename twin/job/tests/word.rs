//! Tests of messages about jobs: each mistake once, at its place, with the value that is wrong.

use super::{block, findings, job, machine, near, only, run, virtual_axis};
use crate::finding::{Rule, Severity};

/// A cam on which Z is 0 at first, and a master that never moves before it begins; Z is at 60.
#[test]
fn a_cam_that_is_elsewhere_is_told_at_its_block() {
    let cam = "name = \"lift\"\nmaster = { min = 0, max = 100, unit = \"mm\" }\nslave = { min = 0, max = 20, unit = \"mm\" }\n\
               elements = [{ master = 0, slave = 0 }, { master = 50, slave = 10 }, { master = 100, slave = 0 }]\n";
    let with = |more: &str| {
        let keys = "master = \"shaft\"; cam = \"lift.toml\"; with_previous = true";
        let text = [
            "duration_s = 1\n[[start]]\naxis = \"Z\"\nposition_mm = 60\n",
            &virtual_axis("shaft", "linear", "max_acceleration_mm_per_s2 = 400"),
            &block("MC_MoveVelocity", "shaft", "velocity_mm_per_s = 25"),
            &block("MC_CamIn", "Z", &format!("{keys}{more}")),
        ];
        run(&job(&text.concat()).with("lift.toml", cam), &machine())
    };
    let (_, findings) = with("");
    let found = only(&findings);
    assert_eq!((found.rule, found.line, found.axis.as_deref()), (Rule::Coupling, 14, Some("Z")));
    let [wants, stands] = ["the cam wants Z at ", "it is at 60 mm"];
    assert!(found.message.contains(wants) && found.message.ends_with(stands), "{found:?}");
    assert!(found.hint.as_deref().is_some_and(|hint| hint.contains("ramp_in")), "{found:?}");
    // The hint gives the value that fits, also for a start that adds to the position of Z.
    let lays = |more: &str| {
        let (_, findings) = with(more);
        let hint = findings[0].hint.clone().unwrap_or_default();
        let quoted = hint.split('`').find(|it| it.starts_with("slave_offset_mm = "));
        (quoted.unwrap_or_else(|| panic!("{findings:?}")).to_owned(), hint)
    };
    let fits = |more: &str| {
        let (setpoints, findings) = with(more);
        assert!(findings.is_empty() && setpoints.len() > 900, "{more}: {findings:?}");
    };
    let (offset, _) = lays("");
    let offset_there: f64 = offset.rsplit(' ').next().unwrap().parse().unwrap();
    near(offset_there, 60.0, 0.1);
    for relative in ["; slave_absolute = false", "; start_mode = \"relative\""] {
        let (offset, hint) = lays(&format!("{relative}; slave_offset_mm = 5"));
        assert!(hint.contains("relative start") && !hint.contains("slave_absolute"), "{hint}");
        fits(&format!("{relative}; {offset}"));
    }
    // A relative cam, the offset of the hint and a ramp do not jump.
    fits("; slave_absolute = false");
    fits(&format!("; {offset}"));
    fits(
        "; start_mode = \"ramp_in\"; velocity_difference_mm_per_s = 150; acceleration_mm_per_s2 = 900; \
         deceleration_mm_per_s2 = 900",
    );
}

#[test]
fn what_is_wrong_is_said_once_and_where_it_is() {
    let gear = |slave: &str, master: &str| {
        block("MC_GearIn", slave, &format!("master = \"{master}\"; ratio_numerator = 1"))
    };
    // The finding is at the block that closes a ring, not at an unrelated one before it.
    let ring = block("MC_Halt", "X", "") + &gear("Z", "Y") + &gear("Y", "Z");
    assert_eq!(only(&findings(&ring)).line, 10);
    // A trigger with a mistake exists for the block that names it.
    let probe = block("MC_TouchProbe", "X", "trigger = \"edge\"");
    let found = findings(&format!("[[triggers]]\nname = \"edge\"\n{probe}"));
    assert!(only(&found).message.contains("a trigger needs `at_s`"), "{found:?}");
}

/// The default of a jerk is reported with its value: 10 times the acceleration.
#[test]
fn a_jerk_that_nobody_gives_is_told() {
    let mut machine = machine();
    for axis in &mut machine.axes {
        axis.max_jerk = None;
    }
    let text = |ramp: &str, jerk: &str| {
        let keys = format!("max_acceleration_mm_per_s2 = 400{jerk}");
        let move_on = block("MC_MoveRelative", "shaft", "distance_mm = 10; velocity_mm_per_s = 25");
        format!("ramp = \"{ramp}\"\n{}{move_on}", virtual_axis("shaft", "linear", &keys))
    };
    for ramp in ["parabolic", "sigmoid"] {
        let (setpoints, findings) = run(&job(&text(ramp, "")), &machine);
        let note = only(&findings);
        assert_eq!(note.severity, Severity::Note);
        let said = "`max_jerk_mm_per_s3` of axis shaft is missing, so that 4000 mm/s³ is used";
        assert!(note.message.contains(said) && !setpoints.is_empty(), "{note:?}");
        let (_, findings) = run(&job(&text(ramp, "; max_jerk_mm_per_s3 = 4000")), &machine);
        assert_eq!(findings, []);
        // An axis of the machine, by its own acceleration.
        let own = text(ramp, "").replace("axis = \"shaft\"", "axis = \"X\"");
        let (_, findings) = run(&job(&own), &machine);
        let x = &machine.axes[0];
        let said = format!("axis X is missing, so that {} ", 10.0 * x.from_si(x.max_acceleration));
        assert!(findings[0].message.contains(&said), "{findings:?}");
    }
    assert_eq!(run(&job(&text("trapezoid", "")), &machine).1, []);
}
