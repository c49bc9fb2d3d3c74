//! Findings about the cams that jobs and machine files name.

use crate::desk::Desk;
use serde_json::Value;

/// Up 40 mm and down; the point at 90 stands behind those it belongs before.
const MOVED: &str = r#"name = "lift"
master = { min = 0, max = 360, unit = "mm" }
slave = { min = 0, max = 40, unit = "mm", period = 40 }
elements = [
  { master = 0, slave = 0 },
  { master = 180, slave = 40 },
  { master = 90, slave = 20, velocity = 0.3 },
]
"#;

/// 20 mm over 60 mm, and then nothing; beyond, 6 mm at once.
const TABLE: &str = r#"name = "bent"
master = { min = 0, max = 180, unit = "mm" }
slave = { min = 0, max = 40, unit = "mm" }
[table]
pairs = [[0, 0], [60, 20], [180, 20]]
"#;

/// What is found in a program on the gantry with `more` in its machine file.
fn findings(desk: &Desk, program: &str, more: &str, status: i32) -> Vec<Value> {
    let machine = desk.text("machine.toml");
    desk.write("coupled.toml", &format!("{machine}{more}"));
    let done = desk.twin(&format!("check {program} --machine coupled.toml --format json"));
    assert_eq!(done.status, Some(status), "{}\n{}", done.stdout, done.stderr);
    let report = done.object();
    report["findings"].as_array().expect("findings").clone()
}

fn cam(name: &str) -> String {
    format!("\n[[cams]]\naxis = \"Y\"\nmaster = \"X\"\ncam = \"{name}\"\n")
}

/// With the file and the line of the cam, whoever names it.
#[test]
fn elements_that_do_not_ascend_are_told_wherever_a_cam_is_named() {
    let desk = Desk::new();
    desk.write("moved.toml", MOVED);
    desk.write("along.cnc", "% along\nN10 G1 X20 F50 E500 E-500\n");
    let line = 1 + MOVED.lines().position(|line| line.contains("master = 90")).expect("a line");
    let said =
        format!("moved.toml: line {line}: the element at master 90 comes after the one at 180");
    let found = findings(&desk, "along.cnc", &cam("moved.toml"), 0);
    let [one] = found.as_slice() else { panic!("{found:?}") };
    assert!(one["message"].as_str().is_some_and(|message| message.contains(&said)), "{one}");
    assert_eq!((&one["severity"], &one["axis"]), (&Value::from("warning"), &Value::from("Y")));
    assert_eq!(one["line"], 0);
    let done = desk.twin("check along.cnc --machine coupled.toml");
    assert!(!done.stderr.contains("line 0"), "{}", done.stderr);
    let job = "[[start]]\naxis = \"X\"\nposition_mm = 0\n\n[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"Y\"\nmaster = \"X\"\n\
               cam = \"moved.toml\"\n\n[[blocks]]\nblock = \"MC_MoveAbsolute\"\naxis = \"X\"\nposition_mm = 20\n\
               velocity_mm_per_s = 50\nacceleration_mm_per_s2 = 500\nwith_previous = true\n";
    desk.write("job.toml", job);
    let found = findings(&desk, "job.toml", "", 0);
    let [one] = found.as_slice() else { panic!("{found:?}") };
    assert!(one["message"].as_str().is_some_and(|message| message.contains(&said)), "{one}");
    assert_eq!(one["line"], 6);
}

/// At 100 mm/s Y loses its 20/60 · 100 mm/s where X passes 60 mm, in the second block and not in the first; its acceleration makes
/// 3 mm/s in a cycle. Of a table whose slope changes by less than that it is a warning.
#[test]
fn a_cam_that_jumps_is_told_at_the_line_that_passes_it() {
    let desk = Desk::new();
    desk.write("bent.toml", TABLE);
    desk.write("along.cnc", "% along\nN10 G1 X30 F100 E900 E-900\nN20 G1 X90\n");
    let jumps = |more: &str, status: i32| -> Vec<Value> {
        let all = findings(&desk, "along.cnc", more, status).into_iter();
        all.filter(|one| one["rule"] == "cam-continuity").collect()
    };
    let found = jumps(&cam("bent.toml"), 1);
    let [one] = found.as_slice() else { panic!("{found:?}") };
    let said = "the velocity of axis Y jumps by -33.3333 mm/s where its cam bent has its master X at 60 mm";
    assert_eq!((&one["message"], &one["line"]), (&Value::from(said), &Value::from(3)));
    assert_eq!(one["severity"], "error");
    // Beside its zero, and three times as fast.
    let found = jumps(
        &format!(
            "{}master_offset_mm = 24\nmaster_scaling = 3\nperiodic = false\n",
            cam("bent.toml")
        ),
        1,
    );
    let [one] = found.as_slice() else { panic!("{found:?}") };
    assert!(
        one["message"].as_str().is_some_and(
            |text| text.ends_with("-100 mm/s where its cam bent has its master X at 12 mm")
        ),
        "{one}"
    );
    assert_eq!(one["line"], 2);
    desk.write("bent.toml", &TABLE.replace("[180, 20]", "[180, 59]"));
    let found = jumps(&cam("bent.toml"), 0);
    let [one] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((&one["severity"], &one["line"]), (&Value::from("warning"), &Value::from(3)));
}

/// A job tells it, too, where the cam holds all the time: at 4 mm/s the step is 4/3 mm/s, which is within what the axis can do in a
/// cycle, so that no acceleration tells it. Where a block lets the slave go, it is not where the cam has it.
#[test]
fn a_cam_that_jumps_in_a_job_is_told() {
    let desk = Desk::new();
    desk.write("bent.toml", TABLE);
    let moved = "[[start]]\naxis = \"X\"\nposition_mm = 58\n\n[[start]]\naxis = \"Y\"\nposition_mm = 19.333333333333332\n\n\
                 [[blocks]]\nblock = \"MC_MoveAbsolute\"\naxis = \"X\"\nposition_mm = 62\nvelocity_mm_per_s = 4\n";
    let jumps = |job: &str, status: i32| -> Vec<Value> {
        desk.write("job.toml", job);
        let all = findings(&desk, "job.toml", &cam("bent.toml"), status).into_iter();
        all.filter(|one| one["rule"] == "cam-continuity").collect()
    };
    let found = jumps(moved, 0);
    let [one] = found.as_slice() else { panic!("{found:?}") };
    let said = "the velocity of axis Y jumps by -1.33333 mm/s where its cam bent has its master X at 60 mm";
    assert_eq!((&one["message"], &one["severity"]), (&Value::from(said), &Value::from("warning")));
    assert_eq!(one["line"], 10);
    let fast = moved.replace("velocity_mm_per_s = 4\n", "velocity_mm_per_s = 20\n");
    assert_eq!(jumps(&fast, 1)[0]["severity"], "error");
    let out = "\n[[blocks]]\nblock = \"MC_CamOut\"\naxis = \"Y\"\nat_s = 0.1\n\n[[blocks]]\nblock = \"MC_Halt\"\naxis = \"Y\"\nwith_previous = true\n";
    assert_eq!(jumps(&format!("{moved}{out}"), 0), Vec::<Value>::new());
}

/// A master that is beyond its cam is told with its place, in programs and in jobs, and a job may put it elsewhere.
#[test]
fn a_master_beyond_its_cam_is_told_with_its_place() {
    let desk = Desk::new();
    desk.write("bent.toml", TABLE);
    desk.write("along.cnc", "% along\nN10 G1 X20 F50 E500 E-500\n");
    let beyond = format!("{}master_offset_mm = 400\n", cam("bent.toml"));
    let said = "axis Y: the master is at 400 of the cam, which goes from 0 to 180 (error 626)";
    let moved = "[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"X\"\ndistance_mm = 20\nvelocity_mm_per_s = 50\n\
                 acceleration_mm_per_s2 = 500\n";
    desk.write("job.toml", moved);
    for program in ["along.cnc", "job.toml"] {
        let found = findings(&desk, program, &beyond, 1);
        let [one] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((&one["message"], &one["rule"]), (&Value::from(said), &Value::from("coupling")));
    }
    // From −30 to −10 it is at 150 to 170, where the cam rests.
    let offset = beyond.replace("= 400", "= 180");
    desk.write("job.toml", &format!("[[start]]\naxis = \"X\"\nposition_mm = -30\n\n{moved}"));
    assert_eq!(findings(&desk, "job.toml", &offset, 0), Vec::<Value>::new());
}

/// A block whose master is outside the cam reports the master's position and the range of the cam.
#[test]
fn a_cam_that_does_not_start_says_from_where_it_does() {
    let desk = Desk::new();
    desk.write("bent.toml", TABLE);
    let job = |offset: &str| {
        let start = "[[start]]\naxis = \"X\"\nposition_mm = 10\n\n";
        let block =
            "[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"Y\"\nmaster = \"X\"\ncam = \"bent.toml\"\n";
        desk.write("job.toml", &format!("{start}{block}{offset}\n"));
        desk.twin("check job.toml --machine machine.toml")
    };
    job("master_offset_mm = 200")
        .ended(1, "SMC_CI_MASTER_OUT_OF_SCALE (626)")
        .ended(1, "master X is at 10 mm; the cam starts with it from -200 to -20 mm");
    job("master_offset_mm = -20\nmaster_absolute = false")
        .ended(1, "with master_absolute = false, master_offset has to be from 0 to 180 of the cam");
}
