//! `twin limit` as a process: profiles within the limits of machine files, programs with feasible feeds, wrong use.

use crate::desk::{Desk, Done, has_keys, number};
use serde_json::Value;

/// Lines rest to rest on the portal, whose Z axis does 200 mm/s and 2000 mm/s² and is asked for twice the speed. F, E and
/// the corners give every line the time length / velocity + velocity / acceleration.
const LINES: &str = "\
% lines
N10 G92 X300 Y100 Z60 F100 E2000 E-2000
N20 G1 X340 F150 (across)
N30 G1 Z0 F400
N40 G1 X300 F150
N50 G1 Z60 F400
N60 G1 X340 Z40 F100
";

/// What its lines take, s; N60 is √(40² + 20²) mm long, and X and Z can do its 2000 mm/s².
fn least_time() -> f64 {
    let line = |length: f64, velocity: f64| length / velocity + velocity / 2000.0;
    2.0 * line(40.0, 150.0) + 2.0 * line(60.0, 200.0) + line(2000.0_f64.sqrt(), 100.0)
}

fn limit(desk: &Desk, options: &str) -> Done {
    desk.twin(&format!("limit lines.cnc -m machine.toml {options}"))
}

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("lines.cnc", LINES);
    desk
}

fn with_plate(desk: &Desk, command: &str, options: &str) -> Done {
    desk.twin(&format!("{command} examples/plate.cnc --machine machines/scara2.toml {options}"))
}

/// A table with a header.
struct Rows {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Rows {
    fn read(desk: &Desk, name: &str) -> Self {
        let text = desk.text(name);
        let fields = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines();
        let header = fields(lines.next().expect("a header"));
        let rows: Vec<_> = lines.map(fields).collect();
        assert!(rows.iter().all(|row| row.len() == header.len()));
        Self { header, rows }
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let found = self.header.iter().position(|column| column == name);
        let index = found.unwrap_or_else(|| panic!("no {name} in {:?}", self.header));
        self.rows.iter().map(|row| row[index].parse().expect("a number")).collect()
    }

    fn most(&self, name: &str) -> f64 {
        self.column(name).into_iter().fold(0.0, |most, value| most.max(value.abs()))
    }

    /// A row per millisecond, from 0 to `duration`, s.
    #[track_caller]
    fn are_one_per_cycle(&self, duration: f64) {
        let times = self.column("time_s");
        assert!(times.first().is_some_and(|first| first.abs() < 1e-9), "{:?}", times.first());
        for pair in times.windows(2) {
            assert!((pair[1] - pair[0] - 1e-3).abs() < 1e-9, "{} s after {} s", pair[1], pair[0]);
        }
        let last = times.last().expect("there are rows");
        assert!((last - duration).abs() < 1e-9, "the last row is at {last} s of {duration} s");
    }
}

/// No axis comes near its limits on the plate, so F and E alone decide, as they do for the controller's own planning.
#[test]
fn a_program_that_no_axis_limits_takes_as_long_as_ever() {
    let desk = Desk::new();
    let checked = with_plate(&desk, "check", "--format json").ended(0, "").object();
    let limited = with_plate(&desk, "limit", "--format json").ended(0, "").object();
    let (ours, theirs) = (number(&limited["duration_s"]), number(&checked["duration_s"]));
    assert!((ours - theirs).abs() < 2e-3, "{ours} s, and {theirs} s by the controller");
    let (ours, theirs) = (number(&limited["length_mm"]), number(&checked["length_mm"]));
    assert!((ours - theirs).abs() < 1e-3, "{ours} mm, and {theirs} mm by the controller");
    for (axis, peak) in limited["peak"].as_object().expect("axes") {
        let (value, limit) =
            (number(&peak["velocity"]["value"]), number(&peak["velocity"]["limit"]));
        assert!(value > 0.0 && value < 0.6 * limit, "{axis}: {value} of {limit}");
    }
    assert_eq!(limited["windows_failed"], 0);
    assert_eq!(limited["windows_exceeded"], 0);

    let done = with_plate(&desk, "limit", "-o plate.csv --output plate.svg");
    done.ended(0, "");
    let first = done.stdout.lines().next().expect("a summary");
    let (length, duration) = (number(&limited["length_mm"]), number(&limited["duration_s"]));
    let said = format!("plate.cnc (din66025) on scara2: {length:.1} mm in {duration:.3} s");
    assert!(first.contains(&said), "{first}");
    let rows = Rows::read(&desk, "plate.csv");
    rows.are_one_per_cycle(number(&limited["duration_s"]));
    // machines/scara2.toml.
    let limits = [
        ("A_velocity_deg_per_s", 240.0),
        ("B_velocity_deg_per_s", 300.0),
        ("Z_velocity_mm_per_s", 300.0),
        ("A_acceleration_deg_per_s2", 1500.0),
        ("B_acceleration_deg_per_s2", 2500.0),
        ("Z_acceleration_mm_per_s2", 3000.0),
    ];
    for (column, limit) in limits {
        let most = rows.most(column);
        assert!(most > 0.0 && most <= limit, "{column}: {most} of {limit}");
    }
    // The axes really go where and as fast as the table says.
    for axis in ["A_deg", "B_deg", "Z_mm"] {
        let (name, unit) = axis.split_once('_').expect("a unit");
        let velocity = rows.column(&format!("{name}_velocity_{unit}_per_s"));
        let position = rows.column(axis);
        for (at, velocity) in position.windows(3).zip(velocity.iter().skip(1)) {
            let difference = (at[2] - at[0]) / 2e-3;
            assert!((difference - velocity).abs() < 1.0, "{axis}: {difference}, not {velocity}");
        }
    }

    let picture = desk.text("plate.svg");
    roxmltree::Document::parse(&picture).expect("well-formed");
    for words in ["axis A", "axis B", "axis Z", "plate.cnc on scara2", "% of limit"] {
        assert!(picture.contains(words), "{words} is not in the picture");
    }
    assert!(picture.matches("<polyline").count() >= 8, "curves are missing");
}

#[test]
fn an_axis_asked_for_twice_its_speed_is_within_its_limits() {
    let desk = desk();
    desk.twin("check lines.cnc -m machine.toml --limits programmed").ended(1, "axis-velocity");
    let done = limit(&desk, "-o lines.csv --format json");
    let report = done.ended(0, "").object();
    let duration = number(&report["duration_s"]);
    assert!((duration - least_time()).abs() < 2e-3, "{duration} s, not {}", least_time());
    let rows = Rows::read(&desk, "lines.csv");
    rows.are_one_per_cycle(duration);
    // machines/gantry3.toml.
    for (column, limit) in [
        ("X_velocity_mm_per_s", 400.0),
        ("Y_velocity_mm_per_s", 400.0),
        ("Z_velocity_mm_per_s", 200.0),
    ] {
        let most = rows.most(column);
        assert!(most <= limit * (1.0 + 1e-9), "{column}: {most} of {limit}");
    }
    assert!(rows.most("Z_velocity_mm_per_s") > 200.0 * (1.0 - 1e-3), "slower than need be");
    assert!(rows.most("Z_acceleration_mm_per_s2") <= 2000.0 * 1.001);

    // Z goes at 200 mm/s for 0.2 s of each of its two lines, and speeds up and brakes with 2000 mm/s² else: of the 0.4 s
    // that a line takes, 60 mm at 400 mm/s would be 0.15 s.
    let held = report["limited_by"].as_array().expect("a list");
    let by = |limit: &str| {
        let found = held.iter().find(|one| one["limit"] == limit && one["axis"] == "Z");
        found.unwrap_or_else(|| panic!("no {limit} of Z in {held:#?}"))
    };
    assert!((number(&by("axis-velocity")["time_s"]) - 0.4).abs() < 0.03, "{held:#?}");
    let lines = report["slowest_lines"].as_array().expect("a list");
    for line in &lines[..2] {
        assert!([4, 6].map(Value::from).contains(&line["line"]), "{lines:#?}");
        assert!((number(&line["lost_s"]) - 0.25).abs() < 2e-3, "{line}");
        assert_eq!(line["programmed_feed_mm_per_s"], Value::from(400.0), "{line}");
        assert!((number(&line["largest_feed_mm_per_s"]) - 200.0).abs() < 1e-3, "{line}");
    }
}

/// The least time of one line: the SCARA's Z does 300 mm/s and 3000 mm/s² however much more F and E ask for.
#[test]
fn limits_of_an_axis_can_be_left_out() {
    let desk = Desk::new();
    let duration = |options: &str| {
        let program = "tests/data/bad_axis_velocity/program.cnc";
        let limit =
            format!("limit {program} -m tests/data/machines/scara2.toml --format json {options}");
        number(&desk.twin(&limit).ended(0, "").object()["duration_s"])
    };
    let without =
        ["", "--without axis-velocity", "--without axis-velocity --without axis-acceleration"];
    // 70 mm at F400 with E5000.
    let expected = [70.0 / 300.0 + 0.1, 70.0 / 400.0 + 400.0 / 3000.0, 70.0 / 400.0 + 0.08];
    for (options, expected) in without.into_iter().zip(expected) {
        let found = duration(options);
        assert!((found - expected).abs() < 2e-3, "{options:?}: {found} s, not {expected} s");
    }
}

/// Beside those of the axes: drives, headroom, stops.
#[test]
fn drives_headroom_and_stops_can_be_left_out() {
    let desk = desk();
    let x = "[[axes]]\nname = \"X\"\n";
    let more = "headroom_percent = 20\nmax_motor_rpm = 90.0\nmotor_turns_per_mm = 0.01\n";
    desk.edit_machine(x, &format!("{x}{more}"));
    desk.write("x.cnc", "% x\nN10 G92 X0 Y0 Z0 F600 E9000 E-9000\nN20 G1 X50\nN30 M7\nN40 X100\n");
    let report = |options: &str| {
        let limit = format!("limit x.cnc -m machine.toml --format json {options}");
        desk.twin(&limit).ended(0, "").object()
    };
    let [no_drives, no_headroom, no_stops] =
        ["drive-speed", "headroom", "stops"].map(|limit| format!("--without {limit}"));
    // 90 rpm are 150 mm/s; X itself has 400 mm/s and 3000 mm/s². 50 mm at a time, or 100 mm at once.
    let line = |length: f64, velocity: f64, left: f64| {
        let (v, a) = (velocity * left, 3000.0 * left * left);
        length / v + v / a
    };
    let expected = [
        (String::new(), 2.0 * line(50.0, 150.0, 0.8)),
        (no_headroom.clone(), 2.0 * line(50.0, 150.0, 1.0)),
        (no_stops.clone(), line(100.0, 150.0, 0.8)),
        (format!("{no_stops} {no_headroom}"), line(100.0, 150.0, 1.0)),
        (format!("{no_stops} {no_headroom} {no_drives}"), line(100.0, 400.0, 1.0)),
    ];
    for (options, expected) in expected {
        let found = number(&report(&options)["duration_s"]);
        assert!((found - expected).abs() < 4e-3, "{options:?}: {found} s, not {expected} s");
    }
    // What is left out is no limit in the report either.
    let limit = |options: &str| number(&report(options)["peak"]["X"]["velocity"]["limit"]);
    assert!((limit("") - 150.0).abs() < 1e-9 && (limit(&no_drives) - 400.0).abs() < 1e-9);
}

/// A pipe can be read only once.
#[cfg(unix)]
#[test]
fn a_program_may_come_through_a_pipe() {
    let desk = desk();
    let known = limit(&desk, "--format json").ended(0, "").object();
    let pipe = desk.path("pipe.cnc");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo");
    assert!(made.success());
    let writer = std::thread::Builder::new().name("pipe".to_owned());
    let writer = writer.spawn(move || std::fs::write(pipe, LINES)).expect("a thread");
    let piped = desk.twin("limit pipe.cnc -m machine.toml --format json");
    let piped = piped.ended(0, "").object();
    writer.join().expect("written").expect("written");
    assert_eq!(piped["duration_s"], known["duration_s"]);
}

#[test]
fn every_line_tells_what_holds_it_back() {
    let desk = desk();
    let report = limit(&desk, "--lines all.csv --format json").ended(0, "").object();
    let rows = Rows::read(&desk, "all.csv");
    let sum = |column: &str| rows.column(column).iter().sum::<f64>();
    assert!((sum("time_s") - number(&report["duration_s"])).abs() < 1e-6);
    let lost = number(&report["duration_s"]) - number(&report["duration_by_feed_s"]);
    assert!((sum("lost_s") - lost).abs() < 1e-6);
    // The rows of a line stand together, and in all they are what the report has for it.
    let lines = rows.column("line");
    assert!(lines.is_sorted());
    for loss in report["slowest_lines"].as_array().expect("lines") {
        let of = |column: &str| -> f64 {
            let cells = rows.column(column).into_iter().zip(&lines);
            cells
                .filter(|(_, line)| (**line - number(&loss["line"])).abs() < 0.5)
                .map(|(cell, _)| cell)
                .sum()
        };
        assert!((of("time_s") - number(&loss["time_s"])).abs() < 1e-6, "{loss}");
        assert!((of("lost_s") - number(&loss["lost_s"])).abs() < 1e-6, "{loss}");
    }
}

/// X moves 33.3 kg (machines/gantry3.toml): with 100 N, 20 N of them friction, 50 mm from rest to rest take 2·√(L·m/F).
#[test]
fn a_motor_is_named_and_shown_where_it_holds_back() {
    let desk = desk();
    let strong = desk.text("machine.toml");
    let weak = strong.replacen("max_force_n = 600.0", "max_force_n = 100.0", 1).replacen(
        "viscous_friction_n_s_per_m = 60.0",
        "viscous_friction_n_s_per_m = 0.0",
        1,
    );
    assert_ne!(weak, strong);
    desk.write("weak.toml", &weak);
    desk.write("x.cnc", "% x\nN10 G92 X0 Y0 Z0 F400 E9000 E-9000\nN20 G1 X50\n");
    desk.twin("limit x.cnc -m weak.toml -o x.csv -o x.svg")
        .ended(0, "")
        .says("force of X 20 % up: about");
    let rows = Rows::read(&desk, "x.csv");
    let most = rows.most("X_force_n");
    assert!((most - 100.0).abs() < 0.1, "{most} N");
    // Nothing else moves, but Z is held: 3.3 kg.
    assert!((rows.most("Z_force_n") - 3.3 * 9.81).abs() < 1e-6 && rows.most("Y_force_n") < 1e-9);
    let picture = desk.text("x.svg");
    assert!(picture.contains("motor effort") && picture.contains("X: 100.0 %, 100 N"));

    let report = |more: &str| {
        let limit = format!("limit x.cnc -m weak.toml --format json {more}");
        desk.twin(&limit).ended(0, "").object()
    };
    let limited = report("");
    let expected = 2.0 * (0.05_f64 * 33.3 / 80.0).sqrt();
    let duration = number(&limited["duration_s"]);
    assert!((duration - expected).abs() < 1.5e-3, "{duration} s and not {expected} s");
    let held = limited["limited_by"][0].clone();
    assert_eq!((&held["limit"], &held["axis"]), (&"axis-effort".into(), &"X".into()), "{held}");
    let effort = &limited["peak"]["X"]["effort"];
    assert_eq!((&effort["unit"], &effort["limit"]), (&"N".into(), &100.0.into()), "{effort}");
    let free = report("--without motor-torque");
    assert!(number(&free["duration_s"]) < 0.95 * duration);
    assert!(number(&free["peak"]["X"]["effort"]["value"]) > 110.0, "{}", free["peak"]["X"]);

    // Too weak to hold Z.
    desk.write("none.toml", &strong.replacen("max_force_n = 300.0", "max_force_n = 30.0", 1));
    desk.twin("limit x.cnc -m none.toml")
        .ended(1, "axis Z: weight and dry friction take a force of 40.3730 N");
}

#[test]
fn a_feasible_program_is_the_same_but_for_its_feeds() {
    let desk = desk();
    limit(&desk, "--feasible slower.cnc").ended(0, "F is too fast on 2 of 7 lines");
    let written = desk.text("slower.cnc");
    let without_feeds = |text: &str| {
        let words = text.split(' ').map(|word| {
            let (word, end) = word.split_at(word.find('\n').unwrap_or(word.len()));
            format!("{}{end}", if word.starts_with('F') { "F" } else { word })
        });
        words.collect::<Vec<_>>().join(" ")
    };
    assert_ne!(written, LINES);
    assert_eq!(without_feeds(&written), without_feeds(LINES));

    let path = |name: &str| -> Vec<Value> {
        let done = desk.twin(&format!("path {name}"));
        done.ended(0, "").rows()
    };
    let (before, after) = (path("lines.cnc"), path("slower.cnc"));
    assert_eq!((before.len(), after.len()), (5, 5));
    for (mut before, mut after) in before.into_iter().zip(after) {
        let key = "feed_mm_per_s";
        let (programmed, feed) = (number(&before[key]), number(&after[key]));
        let along_z = [4, 6].map(Value::from).contains(&before["line"]);
        assert_eq!(programmed > 200.0, along_z, "{before}");
        if along_z {
            assert!(feed <= 200.0 && feed > 199.0, "{after}");
        } else {
            assert_eq!(before[key], after[key], "{after}");
        }
        for element in [&mut before, &mut after] {
            element.as_object_mut().expect("an object").remove(key);
        }
        assert_eq!(after, before);
    }
    desk.twin("check slower.cnc -m machine.toml").ended(0, "");
    // What can be followed already is not touched, byte for byte.
    let again = "limit slower.cnc -m machine.toml --feasible again.cnc";
    desk.twin(again).ended(0, "too fast on 0 of 7 lines");
    assert_eq!(desk.text("again.cnc"), written);
}

#[test]
fn a_point_out_of_reach_is_told_with_its_line() {
    let desk = Desk::new();
    // The arms are 450 mm long.
    desk.write("far.cnc", "% far\nN10 G92 X300 Y0 Z20\nN20 G1 X360 Y40 F60\nN30 G1 X600 Y0\n");
    let far = "limit far.cnc --machine machines/scara2.toml";
    desk.twin(far).ended(1, "line 4 (N30): the tool cannot be there");
    let report = desk.twin(&format!("{far} --format json")).ended(1, "").object();
    let findings = report["findings"].as_array().expect("a list");
    assert_eq!(findings.len(), 1, "{findings:#?}");
    assert_eq!(
        (&findings[0]["rule"], &findings[0]["line"], &findings[0]["block"]),
        (&"reach".into(), &4.into(), &30.into())
    );
    assert_eq!((&findings[0]["severity"], number(&findings[0]["limit"])), (&"error".into(), 450.0));
    desk.write("wrong.cnc", "% wrong\nN10 G1 X310 Q\n");
    desk.twin("limit wrong.cnc --machine machines/scara2.toml").ended(1, "line 2 (N10)");
}

/// What the controller itself takes for the lines, s: on its 60 mm Z speeds up and brakes with 2000 mm/s² and never comes to
/// 400 mm/s.
fn controllers_time() -> f64 {
    let line = |length: f64, velocity: f64| length / velocity + velocity / 2000.0;
    2.0 * line(40.0, 150.0) + 4.0 * (60.0_f64 / 2000.0).sqrt() + line(2000.0_f64.sqrt(), 100.0)
}

#[test]
fn the_controllers_own_planning_is_compared() {
    let desk = desk();
    let programmed = "--limits programmed";
    let outputs = "-o own.csv -o own.svg --format json";
    let report = limit(&desk, &format!("{programmed} {outputs}")).ended(1, "").object();
    let [own, axes] =
        ["duration_s", "duration_under_axis_limits_s"].map(|key| number(&report[key]));
    assert!((own - controllers_time()).abs() < 6e-3, "{own} s, not {}", controllers_time());
    assert!((axes - least_time()).abs() < 2e-3, "{axes} s, not {}", least_time());
    assert!((number(&report["ratio"]) - axes / own).abs() < 1e-9);
    assert_eq!(report["limits"], "programmed");
    // Both take peaks and findings from the pieces of the plan.
    let checked = desk.twin("check lines.cnc -m machine.toml --limits programmed --format json");
    let checked = checked.ended(1, "").object();
    assert_eq!(report["duration_s"], checked["duration_s"]);
    assert_eq!(report["findings"], checked["findings"]);
    for axis in ["X", "Y", "Z"] {
        for quantity in ["velocity", "acceleration"] {
            let of = |report: &Value| report["peak"][axis][quantity]["value"].clone();
            assert_eq!(of(&report), of(&checked), "{axis} {quantity}");
        }
    }
    let peak = number(&checked["peak"]["Z"]["velocity"]["value"]);
    assert!((peak - 120_000.0_f64.sqrt()).abs() < 1e-6, "{peak}");
    let rows = Rows::read(&desk, "own.csv");
    rows.are_one_per_cycle(own);
    // √(60 · 2000) mm/s.
    let most = rows.most("Z_velocity_mm_per_s");
    assert!(most <= 346.42 && most > 343.0, "{most}");
    let picture = desk.text("own.svg");
    roxmltree::Document::parse(&picture).expect("well-formed");
    assert!(picture.contains("as its controller plans it"));

    let done = limit(&desk, programmed);
    let text = &done.ended(1, "axis Z: velocity 346.41 mm/s").stdout;
    assert!(text.contains("under the limits of the axes 1.98"), "{text}");
    let beyond = "velocity of Z: 1.7";
    let line = text.lines().find(|line| line.starts_with(beyond));
    let line = line.unwrap_or_else(|| panic!("no {beyond} in {text}"));
    let of_line = |text: &str| line.ends_with(&format!(" times its limit in line {text}"));
    assert!(of_line("4 (N30)") || of_line("6 (N50)"), "{line}");
    // Override and profile are its own.
    let slow = format!("{programmed} --override 50 --format json");
    let report = limit(&desk, &slow).ended(0, "").object();
    let line = |length: f64, velocity: f64| length / velocity + velocity / 2000.0;
    let half = 2.0 * (line(40.0, 75.0) + line(60.0, 200.0)) + line(2000.0_f64.sqrt(), 50.0);
    assert!((number(&report["duration_s"]) - half).abs() < 6e-3, "{} {half}", report["duration_s"]);
}

/// Back along X and forth again a knife turns round: 1080 deg/s, 20000 deg/s². The controller has no time for that.
#[test]
fn a_knife_turns_round() {
    let desk = desk();
    let turning = "limit lines.cnc -m machines/gantry_cutter3.toml --format json";
    let report = desk.twin(turning).ended(0, "").object();
    let expected = least_time() + 2.0 * (180.0 / 1080.0 + 1080.0 / 20000.0);
    let found = number(&report["duration_s"]);
    assert!((found - expected).abs() < 1e-3, "{found} {expected}");
    let done = desk.twin(&format!("{turning} --limits programmed"));
    let report = done.ended(1, "").object();
    let found = number(&report["duration_under_axis_limits_s"]);
    assert!((found - expected).abs() < 1e-3, "{found} {expected}");
    assert!((number(&report["duration_s"]) - least_time()).abs() < 0.2, "{report:#}");
}

/// Beyond a software limit it is the farthest point of the line that counts, and no program with other feeds is written.
#[test]
fn a_program_that_is_not_fit_is_called_so() {
    let desk = desk();
    desk.write("lines.cnc", "% far\nN10 G92 X300 Y100 Z60 F100 E2000 E-2000\nN20 G1 X900\n");
    let done = limit(&desk, "--feasible slower.cnc");
    done.ended(1, "axis X at 900.000 mm is above its software limit of 650.000 mm");
    done.ended(1, "slower.cnc: not written");
    assert!(done.stdout.starts_with("lines.cnc: not fit: 1 error"), "{}", done.stdout);
    assert!(!desk.path("slower.cnc").exists());
    desk.write("lines.cnc", "% nothing\n");
    limit(&desk, "").ended(1, "no block that moves anything");
}

/// What is compared is half the programmed feed as well.
#[test]
fn an_override_is_compared_with_its_part_of_the_feed() {
    let desk = desk();
    let report = limit(&desk, "--override 50% --format json");
    let by_feed = 2.0 * 40.0 / 75.0 + 2.0 * 60.0 / 200.0 + 2000.0_f64.sqrt() / 50.0;
    let found = number(&report.object()["duration_by_feed_s"]);
    assert!((found / by_feed - 1.0).abs() < 1e-2, "{found} s, not {by_feed} s");
    limit(&desk, "--override 50%").says("; with 50 % of the programmed feed alone ");
}

/// What is read from or written to is not written over.
#[test]
fn feasible_programs_are_files_of_their_own() {
    let desk = desk();
    limit(&desk, "").ended(0, "");
    let before = std::fs::read(desk.path("machine.toml")).expect("a machine file");
    let known = "something else is read from or written to it";
    desk.write("variables.toml", "g_f = 40\n");
    let variables = "--variables variables.toml --lines variables.toml";
    limit(&desk, variables).ended(2, known);
    limit(&desk, "--feasible machine.toml").ended(2, known);
    limit(&desk, "--feasible same.csv -o same.csv").ended(2, known);
    limit(&desk, "-o same.csv -o ./same.csv").ended(2, "name another file");
    limit(&desk, "-o same.svg --lines same.svg").ended(2, known);
    desk.write("lines.csv", LINES);
    for option in ["-o", "--lines"] {
        let itself = "limit lines.csv --dialect din66025 -m machine.toml";
        desk.twin(&format!("{itself} {option} lines.csv")).ended(2, "this is the program");
    }
    assert_eq!(desk.text("lines.csv"), LINES);
    // What fails leaves what there was.
    desk.write("old.csv", "kept");
    desk.twin("limit none.cnc -m machine.toml -o old.csv").ended(2, "none.cnc");
    assert_eq!(desk.text("old.csv"), "kept");
    // A hard link to the program becomes a file of its own.
    std::fs::hard_link(desk.path("lines.cnc"), desk.path("link.cnc")).expect("linked");
    limit(&desk, "--feasible link.cnc").ended(0, "");
    assert_eq!(desk.text("lines.cnc"), LINES);
    assert_ne!(desk.text("link.cnc"), LINES);
    assert_eq!(std::fs::read(desk.path("machine.toml")).expect("it"), before);
}

/// What `check` finds at the corners of a knife's path is in the comparison.
#[test]
fn a_knife_turns_at_once_in_the_controllers_own_planning() {
    let desk = Desk::new();
    let with = |command: &str, more: &str| {
        let of = "examples/contour.cnc -m machines/gantry_cutter3.toml --format json";
        desk.twin(&format!("{command} {of} {more}")).object()
    };
    let (checked, own) =
        (with("check", "--limits programmed"), with("limit", "--limits programmed"));
    let largest = |report: &Value| number(&report["peak"]["R"]["velocity"]["value"]);
    assert!(largest(&checked) > 2.0 * number(&checked["peak"]["R"]["velocity"]["limit"]));
    assert!((largest(&own) - largest(&checked)).abs() < 1e-6 * largest(&checked), "{own}");
}

#[test]
fn wrong_use_is_status_2() {
    let desk = desk();
    limit(&desk, "-o profile.txt").ended(2, "profile.txt: profiles are written as .csv or .svg");
    limit(&desk, "-o missing/profile.csv").ended(2, "cannot write missing/profile.csv");
    limit(&desk, "-o missing/profile.svg").ended(2, "cannot write missing/profile.svg");
    limit(&desk, "--feasible missing/slower.cnc").ended(2, "cannot write missing/slower.cnc");
    limit(&desk, "--feasible lines.cnc").ended(2, "this is the program itself");
    limit(&desk, "--feasible ./lines.cnc").ended(2, "this is the program itself");
    assert_eq!(desk.text("lines.cnc"), LINES);
    limit(&desk, "--without axis-acceleration --without path-acceleration")
        .ended(2, "nothing limits how fast the path speeds up");
    limit(&desk, "--without gravity").ended(2, "gravity");
    limit(&desk, "--profile sigmoid").ended(2, "--limits programmed");
    limit(&desk, "--look-ahead 3").ended(2, "--limits programmed");
    limit(&desk, "--limits programmed --without feed").ended(2, "--without is for");
    limit(&desk, "--limits programmed --feasible slower.cnc")
        .ended(2, "--feasible is for --limits axes");
    desk.twin("limit none.cnc -m machine.toml").ended(2, "cannot read program none.cnc");
    desk.twin("limit lines.cnc").ended(2, "--machine");
}

#[test]
fn the_report_has_the_fields_of_the_guide() {
    let desk = desk();
    let report = limit(&desk, "--format json").ended(0, "").object();
    let keys = "program machine dialect limits length_mm duration_s duration_by_feed_s peak";
    let lists = "limited_by slowest_lines changes windows windows_failed windows_exceeded findings";
    has_keys(&report, &format!("{keys} {lists}"));
    assert_eq!(
        (&report["program"], &report["machine"], &report["dialect"]),
        (&"lines.cnc".into(), &"machine.toml".into(), &"din66025".into())
    );
    let length = 200.0 + 2000.0_f64.sqrt();
    assert!((number(&report["length_mm"]) - length).abs() < 1e-6);
    // F all the time: 80 mm at 150 mm/s, 120 mm at 400 mm/s, the rest at 100 mm/s.
    let by_feed = 80.0 / 150.0 + 120.0 / 400.0 + 2000.0_f64.sqrt() / 100.0;
    assert!((number(&report["duration_by_feed_s"]) - by_feed).abs() < 5e-3);
    has_keys(&report["peak"], "X Y Z");
    for peak in report["peak"].as_object().expect("an object").values() {
        has_keys(peak, "unit position velocity acceleration jerk effort");
        has_keys(&peak["effort"], "unit value limit line block");
        for quantity in ["velocity", "acceleration", "jerk"] {
            has_keys(&peak[quantity], "value limit line block");
        }
    }
    let each = |list: &str, keys: &str| {
        let list = report[list].as_array().expect("a list");
        assert!(!list.is_empty());
        for one in list {
            has_keys(one, &format!("limit axis {keys}"));
        }
    };
    each("limited_by", "time_s lost_s");
    let feeds = "programmed_feed_mm_per_s largest_feed_mm_per_s";
    each("slowest_lines", &format!("line block {feeds} time_s lost_s"));
    each("changes", "raised_percent gain_s");
    // All the time is somebody's.
    let held = report["limited_by"].as_array().expect("a list").iter();
    let time: f64 = held.map(|one| number(&one["time_s"])).sum();
    assert!((time - number(&report["duration_s"])).abs() < 1e-6, "{time} s");
    assert!(number(&report["windows"]) >= 1.0);
    assert_eq!(
        (&report["windows_failed"], &report["findings"]),
        (&0.into(), &Value::Array(vec![]))
    );
}
