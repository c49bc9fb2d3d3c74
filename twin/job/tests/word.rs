//! Tests of messages about jobs: each mistake once, at its place, with the value that is wrong.

use super::tests::{job, machine, near, run};
use crate::finding::{Rule, Severity};
use std::path::Path;
use twin_machine::Machine;

/// A cam on which Z is 0 at first, and a master that never moves before it begins; Z stands at 60.
#[test]
fn a_cam_that_is_elsewhere_is_told_at_its_block() {
    let folder = tempfile::tempdir().unwrap();
    let cam = folder.path().join("lift.toml");
    let text = "name = \"lift\"\nmaster = { min = 0, max = 100, unit = \"mm\" }\nslave = { min = 0, max = 20, unit = \"mm\" }\n\
                elements = [{ master = 0, slave = 0 }, { master = 50, slave = 10 }, { master = 100, slave = 0 }]\n";
    std::fs::write(&cam, text).unwrap();
    let text = |more: &str| {
        format!(
            "duration_s = 1\n[[start]]\naxis = \"Z\"\nposition_mm = 60\n[[virtual_axes]]\nname = \"shaft\"\nkind = \"linear\"\n\
             max_acceleration_mm_per_s2 = 400\n[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"shaft\"\n\
             velocity_mm_per_s = 25\n[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"Z\"\nmaster = \"shaft\"\ncam = '{}'\n\
             with_previous = true\n{more}",
            cam.display()
        )
    };
    let (_, findings) = run(&job(&text("")), &machine());
    assert_eq!(findings.len(), 1, "{findings:?}");
    let found = &findings[0];
    assert_eq!((found.rule, found.line, found.axis.as_deref()), (Rule::Coupling, 14, Some("Z")));
    let [wants, stands] = ["the cam wants Z at ", "it stands at 60 mm"];
    assert!(found.message.contains(wants) && found.message.ends_with(stands), "{found:?}");
    assert!(found.hint.as_deref().is_some_and(|hint| hint.contains("ramp_in")), "{found:?}");
    // What it would have to be is said with its value, for a start that adds to where Z stands, too.
    let lays = |more: &str| {
        let (_, findings) = run(&job(&text(more)), &machine());
        let hint = findings[0].hint.clone().unwrap_or_default();
        let quoted = hint.split('`').find(|it| it.starts_with("slave_offset_mm = "));
        (quoted.unwrap_or_else(|| panic!("{findings:?}")).to_owned(), hint)
    };
    let (offset, _) = lays("");
    let offset_there: f64 = offset.rsplit(' ').next().unwrap().parse().unwrap();
    near(offset_there, 60.0, 0.1);
    for relative in ["slave_absolute = false\n", "start_mode = \"relative\"\n"] {
        let (offset, hint) = lays(&format!("{relative}slave_offset_mm = 5\n"));
        assert!(hint.contains("relative start") && !hint.contains("slave_absolute"), "{hint}");
        let more = format!("{relative}{offset}\n");
        let (setpoints, findings) = run(&job(&text(&more)), &machine());
        assert!(findings.is_empty() && setpoints.len() > 900, "{more}: {findings:?}");
    }
    // With a cam that lies where Z stands, and with a ramp, nothing jumps.
    for more in [
        "slave_absolute = false\n",
        &format!("{offset}\n"),
        "start_mode = \"ramp_in\"\nvelocity_difference_mm_per_s = 150\nacceleration_mm_per_s2 = 900\n\
         deceleration_mm_per_s2 = 900\n",
    ] {
        let (setpoints, findings) = run(&job(&text(more)), &machine());
        assert!(findings.is_empty() && setpoints.len() > 900, "{more}: {findings:?}");
    }
}

#[test]
fn what_is_wrong_is_said_once_and_where_it_is() {
    let block = |name: &str, keys: &str| format!("[[blocks]]\nblock = \"{name}\"\n{keys}");
    let gear = |slave: &str, master: &str| {
        block(
            "MC_GearIn",
            &format!("axis = \"{slave}\"\nmaster = \"{master}\"\nratio_numerator = 1\n"),
        )
    };
    // The block that closes a ring is told, behind one that has nothing to do with it.
    let ring = block("MC_Halt", "axis = \"X\"\n") + &gear("Z", "Y") + &gear("Y", "Z");
    let (_, findings) = run(&job(&ring), &machine());
    assert_eq!((findings.len(), findings[0].line), (1, 10), "{findings:?}");
    // A trigger that is half said is there for the block that names it.
    let probe = block("MC_TouchProbe", "axis = \"X\"\ntrigger = \"edge\"\n");
    let (_, findings) = run(&job(&format!("[[triggers]]\nname = \"edge\"\n{probe}")), &machine());
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert!(findings[0].message.contains("a trigger comes `at_s`"), "{findings:?}");
    let endless = block("MC_MoveVelocity", "axis = \"X\"\nvelocity_mm_per_s = 10\n");
    let (_, findings) = run(&job(&endless), &machine());
    assert!(findings[0].message.contains("still moves with 10.000 mm/s behind"), "{findings:?}");
    let zero = block("MC_MoveAbsolute", "axis = \"X\"\nposition_mm = 10\nvelocity_mm_per_s = 0\n");
    let (_, findings) = run(&job(&zero), &machine());
    let hint = findings[0].hint.as_deref().unwrap_or_default();
    assert!(hint.contains("have to be greater than 0"), "{findings:?}");
}

/// A jerk that nobody has given is said, with what it is: 10 times the acceleration.
#[test]
fn a_jerk_that_nobody_gives_is_told() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/gantry3.toml");
    let mut machine = Machine::load(&path).unwrap();
    for axis in &mut machine.axes {
        axis.max_jerk = None;
    }
    let text = |ramp: &str, jerk: &str| {
        format!(
            "ramp = \"{ramp}\"\n[[virtual_axes]]\nname = \"shaft\"\nkind = \"linear\"\n\
             max_acceleration_mm_per_s2 = 400\n{jerk}[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"shaft\"\n\
             distance_mm = 10\nvelocity_mm_per_s = 25\n"
        )
    };
    for ramp in ["parabolic", "sigmoid"] {
        let (setpoints, findings) = run(&job(&text(ramp, "")), &machine);
        let [note] = &findings[..] else { panic!("{findings:?}") };
        assert_eq!(note.severity, Severity::Note);
        let said = "nobody gives `max_jerk_mm_per_s3` of axis shaft, so that it is 4000 mm/s³";
        assert!(note.message.contains(said) && !setpoints.is_empty(), "{note:?}");
        let (_, findings) = run(&job(&text(ramp, "max_jerk_mm_per_s3 = 4000\n")), &machine);
        assert_eq!(findings, []);
        // An axis of the machine, by its own acceleration.
        let own = text(ramp, "").replace("axis = \"shaft\"", "axis = \"X\"");
        let (_, findings) = run(&job(&own), &machine);
        let x = &machine.axes[0];
        let jerk = 10.0 * x.from_si(x.max_acceleration);
        assert!(
            findings[0].message.contains(&format!("axis X, so that it is {jerk} ")),
            "{findings:?}"
        );
    }
    assert_eq!(run(&job(&text("trapezoid", "")), &machine).1, []);
}
