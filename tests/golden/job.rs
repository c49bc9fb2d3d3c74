//! Jobs as a process: blocks, cams and gears through check, simulated machine and drives.

use crate::desk::{Desk, number};

/// 0 to 40 mm over half a turn from rest to rest, and back.
const LIFT: &str = r#"
name = "lift"
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 40, unit = "mm", period = 40 }
elements = [{ master = 0, slave = 0 }, { master = 180, slave = 40 }, { master = 360, slave = 0 }]
"#;

/// The shaft turns at so many degrees/s for 3 s; X follows it by the cam, Y at 10 mm per turn.
fn job(velocity: f64) -> String {
    format!(
        r#"
duration_s = 3
[[start]]
axis = "X"
position_mm = 0

[[virtual_axes]]
name = "shaft"
kind = "rotary"
period_deg = 360
max_acceleration_deg_per_s2 = 720

[[blocks]]
block = "MC_CamIn"
axis = "X"
master = "shaft"
cam = "lift.toml"

[[blocks]]
block = "MC_GearIn"
axis = "Y"
master = "shaft"
ratio_numerator = 10
ratio_denominator = 360

[[blocks]]
block = "MC_MoveVelocity"
axis = "shaft"
velocity_deg_per_s = {velocity:.1}
"#
    )
}

fn desk(velocity: f64) -> Desk {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    desk.write("job.toml", &job(velocity));
    desk
}

/// The cam's slope is 15/8 · 40 mm / 180° at most: with 360°/s that is 150 mm/s. Y goes with 10 mm/s.
#[test]
fn a_job_runs_like_a_program() {
    let desk = desk(360.0);
    let arguments = "cam run job.toml --machine machine.toml --drives none";
    desk.twin(&format!("{arguments} --report run.json --tolerance 1"))
        .ended(0, "job.toml is read as job");
    let report = desk.read("run.json");
    assert_eq!(report["dialect"], "job");
    assert_eq!(report["completed"], true);
    let peak = |axis: &str| number(&report["peak"][axis]["velocity"]["value"]);
    assert!((peak("X") - 150.0).abs() < 0.01, "{}", peak("X"));
    assert!((peak("Y") - 10.0).abs() < 1e-9, "{}", peak("Y"));
    // It has been simulated: the twin is near its set-points, but not on them.
    let error = number(&report["tool_error_mm"]["twin"]["max"]);
    assert!((1e-6..1.0).contains(&error), "{error}");
    // 3 s, and half a second in which the shaft brakes.
    let executed = number(&report["executed_s"]);
    assert!((executed - 3.5).abs() < 0.005, "{executed}");
}

/// On the cam: 40·(10s³ − 15s⁴ + 6s⁵) mm over half a turn, and the same back.
fn lift(degrees: f64) -> f64 {
    let turn = degrees.rem_euclid(360.0);
    let s = turn.min(360.0 - turn) / 180.0;
    40.0 * s.powi(3) * (10.0 + s * (6.0 * s - 15.0))
}

/// The trail of the set-points in the recording, mm.
fn trail(desk: &Desk) -> Vec<[f32; 3]> {
    let chunks = crate::recording::chunks(desk);
    let strips = rerun::LineStrips3D::descriptor_strips();
    let rows = crate::recording::rows::<rerun::components::LineStrip3D>(
        &chunks,
        "trail/set-point",
        &strips,
    );
    let points = rows.into_iter().flat_map(|(_, strips)| strips).flat_map(|strip| strip.0);
    points.map(|point| point.0).collect()
}

/// What the view shows of a job is where its axes lead the tool: Y goes 10 mm a turn, X is on its cam.
#[test]
fn the_view_shows_where_a_job_leads() {
    let desk = desk(360.0);
    desk.twin("run job.toml --machine machine.toml --drives none --record r.rrd").ended(0, "");
    let trail = trail(&desk);
    assert!(trail.len() > 50, "{}", trail.len());
    for [x, y, z] in trail.iter().map(|point| point.map(f64::from)) {
        assert!((x - lift(36.0 * y)).abs() < 1e-3, "{x} {y}");
        assert!((z + 40.0).abs() < 1e-4, "{z}");
    }
    // Nearly three turns: half a second up to speed, and half a second to rest behind 3 s.
    let ends = [trail[0], trail[trail.len() - 1]].map(|point| f64::from(point[1]));
    assert!(ends[0] < 0.2 && (ends[1] - 30.0).abs() < 0.2, "{ends:?}");
    let chunks = crate::recording::chunks(&desk);
    let speeds = crate::recording::series(&chunks, "speed/set-point");
    let fastest = speeds.iter().map(|(_, speed)| *speed).fold(0.0, f64::max);
    // X with 150 mm/s and Y with 10 mm/s at once.
    assert!((fastest - 150.0_f64.hypot(10.0)).abs() < 0.1, "{fastest}");
}

/// With a cam in the machine file, Y goes up 40 mm while any program moves X by 180 mm, through check, simulated machine and
/// view. At 100 mm/s its speed is 15/8 · 40/180 · 100 mm/s at most.
#[test]
fn a_cam_of_the_machine_file_holds_in_programs() {
    let desk = Desk::new();
    desk.add_to_machine("\n[[cams]]\naxis = \"Y\"\nmaster = \"X\"\ncam = \"lift.toml\"\n");
    desk.write("lift.toml", &LIFT.replace("\"deg\"", "\"mm\""));
    desk.write("along.cnc", "% along\nN10 G1 X180 F100 E500 E-500\n");
    let run = "run along.cnc --machine machine.toml --drives none";
    desk.twin(&format!("{run} --report run.json --record r.rrd")).ended(0, "");
    let report = desk.read("run.json");
    assert_eq!(report["completed"], true);
    let peak = |axis: &str| number(&report["peak"][axis]["velocity"]["value"]);
    assert!((peak("X") - 100.0).abs() < 1e-6, "{}", peak("X"));
    assert!((peak("Y") - 15.0 / 8.0 * 40.0 / 180.0 * 100.0).abs() < 0.01, "{}", peak("Y"));
    let error = number(&report["tool_error_mm"]["twin"]["max"]);
    assert!((1e-6..1.0).contains(&error), "{error}");
    let trail = trail(&desk);
    assert!(trail.len() > 50, "{}", trail.len());
    for [x, y, _] in trail.iter().map(|point| point.map(f64::from)) {
        assert!((y - lift(x)).abs() < 1e-3, "{x} {y}");
    }
    let [x, y, _] = trail[trail.len() - 1].map(f64::from);
    assert!((x - 180.0).abs() < 0.5 && (y - 40.0).abs() < 0.01, "{x} {y}");
    // A cam that cannot be opened is the manual's 2200.
    std::fs::remove_file(desk.path("lift.toml")).expect("it was there");
    desk.twin("check along.cnc --machine machine.toml").ended(2, "(error 2200)");
}

/// Three times as fast X is asked for 450 mm/s, 400 are its limit: the line is that of the block that makes it so.
#[test]
fn a_slave_that_is_too_fast_is_told_with_its_line() {
    let desk = desk(1080.0);
    let line =
        job(1080.0).lines().position(|line| line.contains("MC_MoveVelocity")).expect("it is there")
            + 1;
    let report =
        desk.twin("check job.toml --machine machine.toml --format json").ended(1, "").object();
    let findings = report["findings"].as_array().expect("findings");
    let found = findings.iter().find(|one| one["rule"] == "axis-velocity").expect("it is too fast");
    assert_eq!(found["line"], line);
    assert_eq!(found["axis"], "X");
    assert!((number(&found["value"]) - 450.0).abs() < 0.1, "{found}");
    assert!(found.get("largest_feed_mm_per_s").is_none(), "{found}");
    // A run refuses it.
    desk.twin("run job.toml --machine machine.toml --drives none").ended(1, "velocity");
}

/// What is wrong with a cam is told with the cam's own lines, whoever names it.
#[test]
fn a_broken_cam_is_told_with_its_own_lines() {
    let desk = desk(360.0);
    desk.write("lift.toml", &LIFT.replace("min = 0, max = 40", "min = 0, maximum = 40"));
    let named =
        job(360.0).lines().position(|line| line.contains("lift.toml")).expect("it is there") + 1;
    desk.twin("check job.toml --machine machine.toml")
        .ended(1, "lift.toml: line 4: ")
        .ended(1, "unknown key `maximum`")
        .ended(1, &format!("job.toml:{named}"))
        .ended(1, "lift.toml:4:")
        .ended(1, "slave = { min = 0, maximum = 40");
    let report = desk.twin("check job.toml --machine machine.toml --format json").object();
    let message = report["findings"][0]["message"].as_str().expect("a message");
    assert!(message.contains("lift.toml: line 4: "), "{message}");
    let machine = desk.text("machine.toml");
    let cam = "\n[[cams]]\naxis = \"Z\"\nmaster = \"X\"\ncam = \"lift.toml\"\n";
    desk.write("cams.toml", &format!("{machine}{cam}"));
    let line = format!("{machine}{cam}").lines().count();
    desk.twin("machine cams.toml")
        .ended(2, "lift.toml: line 4: ")
        .ended(2, &format!("cams.toml:{line}"))
        .ended(2, "lift.toml:4:")
        .ended(2, "slave = { min = 0, maximum = 40");
}

/// The emulated board follows a job as it follows a path.
#[test]
fn drives_follow_a_job() {
    let desk = desk(180.0);
    desk.allow_late_drives();
    desk.twin("run job.toml --machine machine.toml --report run.json").ended(0, "");
    let report = desk.read("run.json");
    assert!(number(&report["drive_samples"]["count"]) > 20.0);
    // X goes up to 75 mm/s; a drive that did not follow would be 40 mm off.
    let error = number(&report["tool_error_mm"]["drives"]["max"]);
    assert!((1e-4..20.0).contains(&error), "{error}");
}

/// With a gear in the machine file, Z goes down 1 mm per 10 mm of X in any program, and only by X.
#[test]
fn a_gear_of_the_machine_file_holds_in_programs() {
    let desk = Desk::new();
    desk.add_to_machine(
        "\n[[gears]]\naxis = \"Z\"\nmaster = \"X\"\nratio_numerator = -1\nratio_denominator = 10\n",
    );
    desk.write("along.cnc", "% along\nN10 G1 X100 F100 E500 E-500\n");
    let report =
        desk.twin("check along.cnc --machine machine.toml --format json").ended(0, "").object();
    assert!((number(&report["peak"]["Z"]["velocity"]["value"]) - 10.0).abs() < 1e-6);
    desk.write("down.cnc", "% down\nN10 G1 X100 F100 E500 E-500\nN20 G1 Z-45\n");
    desk.twin("check down.cnc --machine machine.toml")
        .ended(1, "axis Z follows X by a gear of the machine file, but the program moves it");
    desk.twin("machine machine.toml").says("Z follows X in gear, -1 : 10");
}

/// X follows a shaft of 360°/s, which is up to speed after half a second and 90°; its tappets at 100.2° and 190.2° switch an output
/// on and off, every turn: 0.5 s + (100.2° − 90°) / 360°/s, and a quarter of a second later. In 3 s there are three turns less 90°.
#[test]
fn tappets_of_a_job_are_told() {
    let desk = desk(360.0);
    let tappets = "tappets = [{ group = 4, master = 100.2, action = \"on\" }, { group = 4, master = 190.2, action = \"off\" }]\n";
    desk.write("lift.toml", &format!("{LIFT}{tappets}"));
    let report =
        desk.twin("check job.toml --machine machine.toml --format json").ended(0, "").object();
    let tappets = &report["tappets"];
    assert_eq!(tappets["signals"][0]["axis"], "X");
    assert_eq!(tappets["signals"][0]["group"], 4);
    assert_eq!(tappets["signals"][0]["switched"], 6);
    let switches = tappets["switches"].as_array().expect("switches");
    assert_eq!(switches.len(), 6);
    for (index, one) in (0_u8..).zip(switches) {
        let on = index % 2 == 0;
        let turn = f64::from(index / 2);
        let angle = if on { 100.2 } else { 190.2 };
        let passes = 0.5 + turn + (angle - 90.0) / 360.0;
        assert_eq!(one["on"], on);
        // Blocks begin behind each other, a cycle each; the switching is seen within a cycle.
        let late = number(&one["time_s"]) - passes;
        assert!((0.0..0.006).contains(&late), "{one}: {late}");
        assert_eq!(one["master"]["axis"], "shaft");
        assert!((number(&one["master"]["position"]) - angle).abs() < 0.37, "{one}");
    }
    desk.twin("check job.toml --machine machine.toml").says("tappet 4 of X");
    // The view has marks and a line.
    desk.twin("run job.toml --machine machine.toml --drives none --record r.rrd").ended(0, "");
    let chunks = crate::recording::chunks(&desk);
    assert!(crate::recording::entities(&chunks).contains("/trail/switched"));
    let line = crate::recording::series(&chunks, "switched/0");
    let rises = line.windows(2).filter(|pair| pair[0].1 < 0.5 && pair[1].1 > 0.5).count();
    let falls = line.windows(2).filter(|pair| pair[0].1 > 0.5 && pair[1].1 < 0.5).count();
    assert_eq!((rises, falls), (3, 3));
}

/// A gear of 3 : 1 leaves X a third of what Y bears; on a cam it leaves it what the cam makes of it.
#[test]
fn limited_programs_know_their_slaves() {
    let desk = Desk::new();
    let machine = desk.text("machine.toml");
    let gear = "\n[[gears]]\naxis = \"Y\"\nmaster = \"X\"\nratio_numerator = 3\n";
    desk.write("machine.toml", &format!("{machine}{gear}"));
    desk.write("along.cnc", "% along\nN10 G1 X60 F1000 E9000 E-9000\n");
    desk.twin("limit along.cnc --machine machine.toml").ended(0, "");
    let check = "check along.cnc --machine machine.toml --format json";
    let report = desk.twin(&format!("{check} --limits axes")).ended(0, "").object();
    let peak = |axis: &str| number(&report["peak"][axis]["velocity"]["value"]);
    assert!((peak("Y") - 3.0 * peak("X")).abs() < 1e-6, "{report}");
    let limit = number(&report["peak"]["Y"]["velocity"]["limit"]);
    assert!(peak("Y") > 0.95 * limit && peak("Y") < 1.001 * limit, "{report}");
    // The same with a cam: 40 mm over 60 mm, whose slope is 15/8 · 40/60 = 1.25 at most.
    let cam = "\n[[cams]]\naxis = \"Y\"\nmaster = \"X\"\ncam = \"lift.toml\"\nmaster_scaling = 3\n";
    desk.write("lift.toml", &LIFT.replace("\"deg\"", "\"mm\""));
    desk.write("machine.toml", &format!("{machine}{cam}"));
    desk.twin("limit along.cnc --machine machine.toml").ended(0, "");
    let report = desk.twin(&format!("{check} --limits axes")).ended(0, "").object();
    let part = |quantity: &str| {
        let peak = &report["peak"]["Y"][quantity];
        number(&peak["value"]) / number(&peak["limit"])
    };
    let used = part("velocity").max(part("acceleration"));
    assert!((0.9..1.001).contains(&used), "{report}");
}

#[test]
fn what_is_about_paths_refuses_jobs() {
    let desk = desk(90.0);
    for line in [
        "limit job.toml --machine machine.toml",
        "path job.toml",
        "check job.toml --machine machine.toml --limits axes",
    ] {
        desk.twin(line).ended(2, "a job");
    }
}

/// The shipped example is fit for the machine that it names.
#[test]
fn the_shipped_job_is_fit() {
    let desk = Desk::new();
    let (job, machine) = ("examples/jobs/flying_shear.toml", "machines/gantry3.toml");
    desk.twin(&format!("check {job} --machine {machine} --format json")).ended(0, "");
}

/// A job that is none says nothing of motion, and of its drives nothing is predicted.
#[test]
fn a_job_with_mistakes_prints_no_table_of_drives() {
    let desk = desk(360.0);
    let check = |desk: &Desk| desk.twin("check job.toml --machine machine.toml --drives predicted");
    assert!(check(&desk).stdout.contains("drives, predicted"));
    desk.write("job.toml", &job(360.0).replace("MC_GearIn", "MC_GearInn"));
    let done = check(&desk);
    done.ended(1, "MC_GearInn");
    assert!(!done.stdout.contains("drives, predicted"), "{}", done.stdout);
}
