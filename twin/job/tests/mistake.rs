//! Tests that all mistakes of a job are reported together, each once.

use super::{block, findings, job, machine, only, run, virtual_axis};

fn messages(text: &str) -> Vec<String> {
    findings(text).into_iter().map(|finding| finding.message).collect()
}

/// Each of these words is in one message, and there are no others.
#[track_caller]
fn said(text: &str, expected: &[&str]) {
    let found = messages(text);
    for words in expected {
        let times = found.iter().filter(|message| message.contains(words)).count();
        assert_eq!(times, 1, "{words}: {found:#?}");
    }
    assert_eq!(found.len(), expected.len(), "{found:#?}");
}

/// A shaft, and behind it a cam of X.
fn on_cam(keys: &str) -> String {
    let shaft = virtual_axis("shaft", "rotary", "max_acceleration_deg_per_s2 = 720");
    shaft + &block("MC_CamIn", "X", &format!("master = \"shaft\"; {keys}"))
}

#[test]
fn an_axis_that_nobody_knows_hides_nothing() {
    let keys = "cam = \"none.toml\"; start_mode = \"ramp\"; periodic = 1; at_s = -1; slave_offset_mm = \"3\"; \
                master_offset_deg = \"9\"";
    let [slave, master] = ["`slave_offset_mm`", "`master_offset_deg`"];
    let [no_slave, no_master] = ["unknown axis \"Q\"", "unknown axis \"belt\""];
    for (axis, lead, more) in [
        ("X", "shaft", [slave, master]),
        ("X", "belt", ["unknown axis \"belt\"; the axes are X, Y, Z, shaft", slave]),
        ("Q", "shaft", [no_slave, master]),
        ("Q", "belt", [no_slave, no_master]),
    ] {
        let text = on_cam(keys).replace("\"X\"", &format!("\"{axis}\""));
        let text = text.replace("master = \"shaft\"", &format!("master = \"{lead}\""));
        let whatever =
            ["(error 2200)", "`start_mode` is \"ramp\"", "`periodic` is an integer", "`at_s`"];
        said(&text, &[&whatever[..], &more].concat());
    }
    let gear =
        block("MC_GearIn", "Q", "master = \"X\"; ratio_numerator = 0; ratio_denominator = 0");
    said(&gear, &[no_slave, "`ratio_numerator` is 0", "`ratio_denominator` is 0"]);
}

/// A cam with a mistake still counts as a cam for the block that goes on behind it.
#[test]
fn a_mistake_makes_no_other() {
    let keys = "master = \"shaft\"; cam = \"none.toml\"; at_end_of_profile = true";
    let text = on_cam("cam = \"none.toml\"") + &block("MC_CamIn", "X", keys);
    let found = messages(&text);
    assert!(found.len() == 2 && found.iter().all(|one| one.contains("(error 2200)")), "{found:#?}");
    // The deceleration is known though the acceleration is wrong.
    let keys = "distance_mm = 1; velocity_mm_per_s = 1; acceleration_mm_per_s2 = -1; deceleration_mm_per_s2 = 1";
    let axis = "[[virtual_axes]]\nname = \"n\"\nkind = \"linear\"\n";
    said(
        &(axis.to_owned() + &block("MC_MoveRelative", "n", keys)),
        &["`acceleration_mm_per_s2` is -1"],
    );
    // A trigger at an unknown axis.
    let trigger = "[[triggers]]\nname = \"t\"\naxis = \"Q\"\nposition_mm = 3\n";
    said(
        &(trigger.to_owned() + &block("MC_Halt", "X", "")),
        &["unknown axis \"Q\"; the axes are X, Y, Z"],
    );
}

/// As `twin cam check` refuses them.
#[test]
fn scalings_of_nothing_are_refused() {
    let cam = include_str!("../../../examples/cams/pick_and_place.toml");
    for (key, value, words) in [
        ("master_scaling", "0", "`master_scaling` is 0; nothing would move"),
        ("slave_scaling", "0.0", "`slave_scaling` is 0; nothing would move"),
        ("master_scaling", "-1e-16", "`master_scaling` is -1e-16; 1e-15 is the least scaling"),
    ] {
        let job = job(&on_cam(&format!("cam = \"c.toml\"; {key} = {value}")));
        let (_, findings) = run(&job.with("c.toml", cam), &machine());
        let finding = only(&findings);
        assert_eq!((finding.message.as_str(), finding.line), (words, 10));
    }
}

/// A file of another kind has no line of its own to show.
#[test]
fn a_job_that_is_named_as_a_cam_is_told_once() {
    let found = findings(&on_cam("cam = \"job.toml\""));
    let finding = only(&found);
    assert!(finding.message.ends_with("this is a job, not a cam: `twin cam run` runs it"));
    assert_eq!((finding.line, finding.elsewhere.is_none()), (9, true));
}

/// A name that is given twice is listed once.
#[test]
fn names_that_are_given_twice_are_listed_once() {
    let axis = |name: &str| format!("[[virtual_axes]]\nname = \"{name}\"\nkind = \"linear\"\n");
    let axes = [axis("X"), axis("n"), axis("n"), block("MC_Halt", "Q", "")].concat();
    let found = messages(&axes);
    let [x, n, q] = found.as_slice() else { panic!("{found:#?}") };
    assert!(x.contains("\"X\" already") && n.contains("\"n\" already"), "{found:#?}");
    assert!(q.ends_with("the axes are X, Y, Z, n"), "{q}");
    let triggers = "[[triggers]]\nname = \"t\"\nat_s = 1\n[[triggers]]\nname = \"t\"\nat_s = 2\n";
    let found = messages(&(triggers.to_owned() + &block("MC_TouchProbe", "X", "trigger = \"u\"")));
    let [twice, none] = found.as_slice() else { panic!("{found:#?}") };
    assert!(twice.contains("\"t\" already"), "{twice}");
    assert!(none.ends_with("there is no trigger \"u\"; there are t"), "{none}");
}

#[test]
fn files_of_another_kind_are_told_as_such() {
    let cam = include_str!("../../../examples/cams/pick_and_place.toml");
    said(include_str!("../../../machines/gantry3.toml"), &["this is a machine file, not a job"]);
    said(cam, &["this is a cam, not a job: `twin cam check` looks at it"]);
    let path = std::path::Path::new("machine.toml");
    for (text, words) in [
        (block("MC_Halt", "X", "").as_str(), "this is a job, not a machine file"),
        (cam, "this is a cam, not a machine file"),
    ] {
        let problems = twin_machine::Machine::parse(path, text).expect_err("no machine");
        assert_eq!(problems.len(), 1, "{problems:#?}");
        assert!(problems[0].message.starts_with(words), "{problems:#?}");
    }
}
