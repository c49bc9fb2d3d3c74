//! Tests that all mistakes of a job are reported together, each once.

use super::tests::{job, machine, run};

fn message(text: &str) -> Vec<String> {
    let (_, findings) = run(&job(text), &machine());
    findings.into_iter().map(|finding| finding.message).collect()
}

/// Each of these has a line in what is told, and there is nothing else.
#[track_caller]
fn said(text: &str, expected: &[&str]) {
    let found = message(text);
    for words in expected {
        let times = found.iter().filter(|message| message.contains(words)).count();
        assert_eq!(times, 1, "{words}: {found:#?}");
    }
    assert_eq!(found.len(), expected.len(), "{found:#?}");
}

const SHAFT: &str =
    "[[virtual_axes]]\nname = \"shaft\"\nkind = \"rotary\"\nmax_acceleration_deg_per_s2 = 720\n";

#[test]
fn an_axis_that_nobody_knows_hides_nothing() {
    let cam = |axes: &str| {
        format!(
            "{SHAFT}[[blocks]]\nblock = \"MC_CamIn\"\n{axes}cam = \"none.toml\"\nstart_mode = \"ramp\"\nperiodic = 1\n\
             at_s = -1\nslave_offset_mm = \"3\"\nmaster_offset_deg = \"9\"\n"
        )
    };
    let whatever =
        ["(error 2200)", "`start_mode` is \"ramp\"", "`periodic` is an integer", "`at_s`"];
    let with = |more: &[&'static str]| [&whatever[..], more].concat();
    said(
        &cam("axis = \"X\"\nmaster = \"shaft\"\n"),
        &with(&["`slave_offset_mm`", "`master_offset_deg`"]),
    );
    said(
        &cam("axis = \"X\"\nmaster = \"belt\"\n"),
        &with(&["there is no axis \"belt\"; there are X, Y, Z, shaft", "`slave_offset_mm`"]),
    );
    said(
        &cam("axis = \"Q\"\nmaster = \"shaft\"\n"),
        &with(&["there is no axis \"Q\"", "`master_offset_deg`"]),
    );
    said(
        &cam("axis = \"Q\"\nmaster = \"belt\"\n"),
        &with(&["there is no axis \"Q\"", "there is no axis \"belt\""]),
    );
    let gear = "[[blocks]]\nblock = \"MC_GearIn\"\naxis = \"Q\"\nmaster = \"X\"\nratio_numerator = 0\nratio_denominator = 0\n";
    said(gear, &["there is no axis \"Q\"", "`ratio_numerator` is 0", "`ratio_denominator` is 0"]);
}

/// A cam that is not right is one all the same for the block that goes on behind it.
#[test]
fn a_mistake_makes_no_other() {
    let text = format!(
        "{SHAFT}[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"shaft\"\ncam = \"none.toml\"\n[[blocks]]\n\
         block = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"shaft\"\ncam = \"none.toml\"\nat_end_of_profile = true\n"
    );
    let found = message(&text);
    assert!(found.len() == 2 && found.iter().all(|one| one.contains("(error 2200)")), "{found:#?}");
    // The deceleration is known though the acceleration is wrong.
    said(
        "[[virtual_axes]]\nname = \"n\"\nkind = \"linear\"\n[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"n\"\ndistance_mm = 1\n\
         velocity_mm_per_s = 1\nacceleration_mm_per_s2 = -1\ndeceleration_mm_per_s2 = 1\n",
        &["`acceleration_mm_per_s2` is -1"],
    );
    // Of a trigger at an axis that nobody knows.
    said(
        "[[triggers]]\nname = \"t\"\naxis = \"Q\"\nposition_mm = 3\n[[blocks]]\nblock = \"MC_Halt\"\naxis = \"X\"\n",
        &["there is no axis \"Q\"; there are X, Y, Z"],
    );
}

/// As `twin cam check` refuses them.
#[test]
fn scalings_of_nothing_are_refused() {
    let cam = include_str!("../../examples/cams/pick_and_place.toml");
    for (key, value, words) in [
        ("master_scaling", "0", "`master_scaling` is 0; nothing would move"),
        ("slave_scaling", "0.0", "`slave_scaling` is 0; nothing would move"),
        ("master_scaling", "-1e-16", "`master_scaling` is -1e-16; 1e-15 is the least scaling"),
    ] {
        let text = format!(
            "{SHAFT}[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"shaft\"\ncam = \"c.toml\"\n{key} = {value}\n"
        );
        let job = job(&text);
        std::fs::write(job.folder.path().join("c.toml"), cam).unwrap();
        let (_, findings) = run(&job, &machine());
        let [finding] = findings.as_slice() else { panic!("{findings:#?}") };
        assert_eq!((finding.message.as_str(), finding.line), (words, 10));
    }
}

/// A file of another kind has no line to show beside the job's own.
#[test]
fn a_job_that_is_named_as_a_cam_is_told_once() {
    let text = format!(
        "{SHAFT}[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"shaft\"\ncam = \"job.toml\"\n"
    );
    let (_, findings) = run(&job(&text), &machine());
    let [finding] = findings.as_slice() else { panic!("{findings:#?}") };
    assert!(finding.message.ends_with("this is a job, no cam: `twin cam run` runs it"));
    assert_eq!((finding.line, finding.elsewhere.is_none()), (9, true));
}

/// What stands twice is named once among what there is.
#[test]
fn names_that_are_given_twice_are_listed_once() {
    let axes = "[[virtual_axes]]\nname = \"X\"\nkind = \"linear\"\n[[virtual_axes]]\nname = \"n\"\nkind = \"linear\"\n\
                [[virtual_axes]]\nname = \"n\"\nkind = \"linear\"\n";
    let block = "[[blocks]]\nblock = \"MC_Halt\"\naxis = \"Q\"\n";
    let found = message(&format!("{axes}{block}"));
    let [x, n, q] = found.as_slice() else { panic!("{found:#?}") };
    assert!(x.contains("\"X\" already") && n.contains("\"n\" already"), "{found:#?}");
    assert!(q.ends_with("there are X, Y, Z, n"), "{q}");
    let triggers = "[[triggers]]\nname = \"t\"\nat_s = 1\n[[triggers]]\nname = \"t\"\nat_s = 2\n";
    let block = "[[blocks]]\nblock = \"MC_TouchProbe\"\naxis = \"X\"\ntrigger = \"u\"\n";
    let found = message(&format!("{triggers}{block}"));
    let [twice, none] = found.as_slice() else { panic!("{found:#?}") };
    assert!(twice.contains("\"t\" already"), "{twice}");
    assert!(none.ends_with("there is no trigger \"u\"; there are t"), "{none}");
}

#[test]
fn files_of_another_kind_are_told_as_such() {
    said(include_str!("../../machines/gantry3.toml"), &["this is a machine file, no job"]);
    said(
        include_str!("../../examples/cams/pick_and_place.toml"),
        &["this is a cam, no job: `twin cam check` looks at it"],
    );
    let path = std::path::Path::new("machine.toml");
    for (text, words) in [
        ("[[blocks]]\nblock = \"MC_Halt\"\naxis = \"X\"\n", "this is a job, no machine file"),
        (include_str!("../../examples/cams/pick_and_place.toml"), "this is a cam, no machine file"),
    ] {
        let problems = twin_machine::Machine::parse(path, text).expect_err("no machine");
        assert_eq!(problems.len(), 1, "{problems:#?}");
        assert!(problems[0].message.starts_with(words), "{problems:#?}");
    }
}
