//! Process behaviour of the binary: exit status, signals, and the files it leaves.

use crate::desk::{Desk, Done, has_keys, number, shipped};
use serde_json::Value;

/// Three circles on the portal, 6 s; begins where the axes of a board stand at power-up.
const CIRCLES: &str = "% circles\nN10 G2 I30 J0 F100 E500 E-500\nN20 G2 I30 J0\nN30 G2 I30 J0\n";
/// 10 mm there and back, 0.4 s.
const SHORT: &str = "% short\nN10 G1 X10 F100 E500 E-500\nN20 G1 X0\n";
/// Faster than the axis (400 mm/s).
const UNFIT: &str = "% unfit\nN10 G1 X300 F500 E2000 E-2000\n";

/// Keys and types of the report of every check, with the keys of others.
#[track_caller]
fn is_check(report: &Value, program: &str, more: &str) {
    let keys = "program machine dialect elements length_mm duration_s peak findings";
    has_keys(report, &format!("{keys} findings_left_out {more}"));
    assert_eq!(report["program"], program);
    assert_eq!(
        (&report["machine"], &report["dialect"]),
        (&"machine.toml".into(), &"din66025".into())
    );
    assert!(report["elements"].is_u64() && report["findings"].is_array());
    has_keys(&report["peak"], "X Y Z");
    for peak in report["peak"].as_object().expect("an object").values() {
        for quantity in ["velocity", "acceleration", "jerk"] {
            has_keys(&peak[quantity], "value limit line block");
            // An axis that does not move has its largest value in no line.
            let (value, line) = (number(&peak[quantity]["value"]), &peak[quantity]["line"]);
            assert_eq!(value > 0.0, line.is_u64(), "{peak}");
            assert_eq!(value <= 0.0, line.is_null(), "{peak}");
        }
        has_keys(&peak["position"], "min max limit_min limit_max");
        assert_eq!(peak["unit"], "mm");
    }
    assert_eq!(report["peak"]["X"]["velocity"]["limit"], 400.0);
    assert_eq!(report["peak"]["X"]["jerk"]["limit"], Value::Null);
}

/// The keys that a run adds.
const RUN_KEYS: &str =
    "completed stopped_because executed_s drive_samples cycle_lateness tool_error_mm axis_error";

/// The key that drives of the machine file add, where they are wanted.
const PREDICTED: &str = "predicted_following";

/// The key that a simulated machine adds.
const MOTOR_LOAD: &str = "motor_load";

#[test]
fn help_that_cannot_be_written_fails() {
    let desk = Desk::new();
    for line in ["--help", "--version", "check --help", "emulate interpcnc --assume help"] {
        let full = std::fs::File::create("/dev/full").expect("a device that is always full");
        let done = Done::from(desk.command(line).stdout(full).output().expect("the binary starts"));
        done.ended(2, "No space left on device");
    }
}

#[test]
fn ctrl_c_stops_a_run_with_drives_and_leaves_report_and_recording() {
    let desk = Desk::new();
    desk.write("circles.cnc", CIRCLES);
    let run = "run circles.cnc --machine machine.toml --report r.json --record r.rrd";
    let done = desk.interrupted("-INT", "emulated InterpCNC", run);
    done.ended(2, "stopped by the user at line 2 (N10)");
    let report = desk.read("r.json");
    is_check(&report, "circles.cnc", &format!("{RUN_KEYS} {MOTOR_LOAD} {PREDICTED} rest"));
    assert_eq!(report["completed"], false);
    assert!(report["stopped_because"].as_str().expect("a reason").contains("stopped by the user"));
    let (executed, duration) = (number(&report["executed_s"]), number(&report["duration_s"]));
    assert!(executed > 0.1 && executed < duration - 1.0, "{executed} s of {duration} s");
    assert!(number(&report["drive_samples"]["count"]) > 0.0);
    let rest = &report["rest"];
    let (asked, rested) = (number(&rest["asked_s"]), number(&rest["time_s"]));
    assert!(asked < rested && rested <= executed && rest["line"] == 2, "{rest:#}");
    // On the circle about 30, 0 with radius 30; the drives stand where they were sent, to their increments.
    let [x, y, z] = [0, 1, 2].map(|place| number(&rest["tool_mm"]["setpoint"][place]));
    assert!(((x - 30.0).hypot(y) - 30.0).abs() < 1e-6 && (z + 40.0).abs() < 1e-6, "{rest:#}");
    for axis in ["X", "Y", "Z"] {
        let at = |who: &str| number(&rest["axes"][axis][who]);
        assert!((at("drives") - at("setpoint")).abs() < 0.05, "{rest:#}");
        assert!((at("twin") - at("setpoint")).abs() < 0.05, "{rest:#}");
        assert_eq!(rest["axes"][axis]["unit"], "mm");
    }
    done.ended(2, &format!("the stop was asked for at {asked:.3} s; "));
    done.ended(2, "the drives were last heard of at ");
    assert!(std::fs::metadata(desk.path("r.rrd")).expect("a recording").len() > 1000);
}

#[test]
fn a_request_to_terminate_stops_a_run_in_real_time() {
    let desk = Desk::new();
    desk.write("circles.cnc", CIRCLES);
    let run = "run circles.cnc --machine machine.toml --drives none --realtime --report r.json";
    desk.interrupted("-TERM", "is read as din66025", run).ended(2, "stopped by the user");
    let report = desk.read("r.json");
    assert_eq!(report["completed"], false);
    assert!(number(&report["executed_s"]) < number(&report["duration_s"]) - 1.0);
    assert_eq!(report["drive_samples"], Value::Null);
    has_keys(&report["cycle_lateness"], "cycles p50_us p99_us max_us");
    // One at the begin, and one per millisecond.
    let cycles = number(&report["cycle_lateness"]["cycles"]) - 1.0;
    assert!((cycles - 1e3 * number(&report["executed_s"])).abs() < 0.5, "{cycles}");
}

#[test]
fn a_run_reports_errors_of_twin_and_drives() {
    let desk = Desk::new();
    desk.allow_late_drives();
    desk.write("short.cnc", SHORT);
    let run = |drives: &str| {
        let done =
            desk.twin(&format!("run short.cnc -m machine.toml --drives {drives} --report r.json"));
        done.ended(0, "short.cnc is read as din66025");
        assert!(done.stdout.contains(": 0 errors") && done.stdout.contains("tool, twin"));
        let report = desk.read("r.json");
        let predicted = if drives == "none" { "" } else { PREDICTED };
        is_check(&report, "short.cnc", &format!("{RUN_KEYS} {MOTOR_LOAD} {predicted}"));
        assert_eq!(
            (&report["completed"], &report["stopped_because"]),
            (&true.into(), &Value::Null)
        );
        assert_eq!(report["executed_s"], report["duration_s"]);
        has_keys(&report["tool_error_mm"], "twin drives drives_against_twin");
        has_keys(&report["axis_error"], "X Y Z");
        report
    };
    let errors = |value: &Value| {
        has_keys(value, "max rms line block");
        let (max, rms) = (number(&value["max"]), number(&value["rms"]));
        assert!(max > 0.0 && rms > 0.0 && rms <= max, "{value}");
        let line = value["line"].as_u64().expect("a line");
        assert!([2, 3].contains(&line), "{value}");
        assert_eq!(value["block"], 10 * line - 10);
    };
    let alone = run("none");
    errors(&alone["tool_error_mm"]["twin"]);
    assert_eq!(alone["tool_error_mm"]["drives"], Value::Null);
    let beside = run("emulated");
    // The same set-points: the simulated machine does the same, to the last digit.
    assert_eq!(beside["tool_error_mm"]["twin"], alone["tool_error_mm"]["twin"]);
    for who in ["twin", "drives", "drives_against_twin"] {
        errors(&beside["tool_error_mm"][who]);
        errors(&beside["axis_error"]["X"][who]);
    }
    assert_eq!(beside["axis_error"]["X"]["unit"], "mm");
    assert!(number(&beside["drive_samples"]["count"]) >= 10.0);
}

#[test]
fn an_exceeded_tolerance_is_status_1_with_the_report() {
    let desk = Desk::new();
    desk.write("short.cnc", SHORT);
    let run = |tolerance: &str| {
        desk.twin(&format!(
            "run short.cnc -m machine.toml --drives none --report r.json --tolerance {tolerance}"
        ))
    };
    run("0.000001").ended(1, "the tolerance is 0.000001 mm");
    let report = desk.read("r.json");
    assert_eq!(report["completed"], true);
    assert!(number(&report["tool_error_mm"]["twin"]["max"]) > 1e-6);
    run("5").ended(0, "");
    for nonsense in ["0", "-1", "nan"] {
        run(nonsense).ended(2, "");
    }
}

#[test]
fn an_unfit_program_moves_nothing_and_is_reported() {
    let desk = Desk::new();
    desk.write("unfit.cnc", UNFIT);
    let done = desk
        .twin("run unfit.cnc -m machine.toml --limits programmed --report r.json --record r.rrd");
    done.ended(1, "axis-velocity");
    assert!(done.stdout.contains("unfit.cnc: not fit: 1 error"));
    assert!(!done.stderr.contains("emulated InterpCNC"), "{}", done.stderr);
    let report = desk.read("r.json");
    is_check(&report, "unfit.cnc", &format!("{RUN_KEYS} {PREDICTED}"));
    assert_eq!((&report["completed"], &report["executed_s"]), (&false.into(), &0.0.into()));
    assert_eq!(report["tool_error_mm"]["twin"], Value::Null);
}

#[test]
fn what_cannot_be_carried_out_is_status_2() {
    let desk = Desk::new();
    desk.write("short.cnc", SHORT);
    desk.write("short.xyz", "no program");
    std::fs::create_dir(desk.path("folder.cnc")).expect("made");
    let run = |program: &str, machine: &str| {
        desk.twin(&format!("run {program} --machine {machine} --drives none"))
    };
    let check =
        |program: &str, machine: &str| desk.twin(&format!("check {program} --machine {machine}"));
    for twin in [&run as &dyn Fn(&str, &str) -> Done, &check] {
        twin("missing.cnc", "machine.toml").ended(2, "cannot read program missing.cnc");
        twin("missing", "machine.toml").ended(2, "cannot read program missing");
        twin("folder.cnc", "machine.toml").ended(2, "folder.cnc");
        twin(".", "machine.toml").ended(2, "directory");
        twin("short.cnc", "missing.toml").ended(2, "cannot read machine file missing.toml");
        twin("short.cnc", ".").ended(2, "directory");
        twin("short.xyz", "machine.toml").ended(2, "--dialect");
    }
    desk.twin("run short.cnc -m machine.toml --no-such-option").ended(2, "--no-such-option");
    desk.twin("run short.cnc").ended(2, "--machine");
    desk.twin("check -m machine.toml").ended(2, "PROGRAM");
    desk.twin("nonsense").ended(2, "nonsense");
    desk.twin("").ended(2, "Usage");
    desk.twin("run short.cnc -m machine.toml --drives real")
        .ended(2, "device `board`: /dev/ttyUSB0, address 1: opening the port");
    let help = desk.twin("--help");
    assert_eq!(help.status, Some(0));
    assert!(help.stdout.contains("Exit status"));
}

#[test]
fn files_that_cannot_be_written_are_noticed_before_anything_runs() {
    let desk = Desk::new();
    desk.write("short.cnc", SHORT);
    for (option, file) in
        [("--report", "missing/r.json"), ("--record", "missing/r.rrd"), ("--report", ".")]
    {
        let done = desk.twin(&format!("run short.cnc -m machine.toml {option} {file}"));
        done.ended(2, file);
        assert!(!done.stdout.contains("ran "), "it ran first:\n{}", done.stdout);
        assert!(!done.stderr.contains("emulated InterpCNC"), "the drives moved:\n{}", done.stderr);
    }
}

#[test]
fn a_program_that_cannot_be_read_does_not_keep_others_from_being_checked() {
    let desk = Desk::new();
    desk.write("short.cnc", SHORT);
    desk.write("unfit.cnc", UNFIT);
    let check = |programs: &str| {
        desk.twin(&format!(
            "check {programs} -m machine.toml --limits programmed --drives predicted --format json"
        ))
    };
    let done = check("short.cnc missing.cnc unfit.cnc");
    done.ended(2, "cannot read program missing.cnc");
    let found = done.rows();
    assert_eq!(found.len(), 2, "{}", done.stdout);
    is_check(&found[0], "short.cnc", PREDICTED);
    is_check(&found[1], "unfit.cnc", PREDICTED);
    let predicted = &found[0][PREDICTED];
    has_keys(predicted, "tool_mm axes devices");
    has_keys(&predicted["tool_mm"], "max rms line block");
    has_keys(&predicted["axes"]["X"], "unit device limit max rms line block");
    let rates = "family commands_per_s samples_per_s exchanges_per_s";
    has_keys(&predicted["devices"]["board"], rates);
    let found = check("unfit.cnc short.cnc").ended(1, "").rows();
    assert_eq!(
        (&found[0]["program"], &found[1]["program"]),
        (&"unfit.cnc".into(), &"short.cnc".into())
    );
    assert_eq!(check("short.cnc").ended(0, "").rows().len(), 1);
}

#[test]
fn findings_carry_what_the_contract_promises() {
    let desk = Desk::new();
    desk.write("wrong.cnc", "% wrong\nN10 G1 X300 F500 E2000 E-2000\nG1 Z-200 F10\nN30 C5\n");
    let report =
        desk.twin("check wrong.cnc -m machine.toml --limits programmed --drives predicted --format json --physics").ended(1, "").object();
    is_check(&report, "wrong.cnc", &format!("{MOTOR_LOAD} {PREDICTED}"));
    has_keys(&report["peak"]["X"]["following_error"], "value limit line block");
    let found = report["findings"].as_array().expect("a list");
    let of = |rule: &str| {
        let fits = |finding: &&Value| finding["rule"] == rule;
        found.iter().find(fits).unwrap_or_else(|| panic!("no {rule} in {found:#?}"))
    };
    let always = "rule severity line block message";
    let velocity = of("axis-velocity");
    let values = "axis value limit unit";
    has_keys(velocity, &format!("{always} {values} largest_feed_mm_per_s"));
    assert_eq!((&velocity["severity"], &velocity["line"]), (&"error".into(), &2.into()));
    assert_eq!((&velocity["block"], &velocity["axis"]), (&10.into(), &"X".into()));
    assert_eq!((number(&velocity["limit"]), &velocity["unit"]), (400.0, &"mm/s".into()));
    assert!((number(&velocity["value"]) - 500.0).abs() < 1e-6);
    assert!((number(&velocity["largest_feed_mm_per_s"]) - 400.0).abs() < 1e-6);
    let position = of("axis-position");
    has_keys(position, &format!("{always} {values}"));
    assert_eq!((&position["line"], &position["block"]), (&3.into(), &Value::Null));
    let word = of("unsupported-word");
    has_keys(word, always);
    assert_eq!(word["block"], 30);
}

#[test]
fn whoever_stops_reading_stops_the_output_without_a_panic() {
    let desk = Desk::new();
    desk.write("wrong.cnc", &format!("% wrong\n{}", "N10 C5\n".repeat(900)));
    let mut child = desk
        .command("check wrong.cnc -m machine.toml --format json")
        .spawn()
        .expect("the binary starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(!stderr.contains("panicked"), "{stderr}");
    assert_eq!(output.status.code(), Some(2));
}

/// A simulated machine that cannot keep up makes a run unfit, as it does a check with --physics.
#[test]
fn an_axis_that_is_lost_in_a_run_is_an_error() {
    let desk = Desk::new();
    let machine = shipped("tests/data/machines/scara2.toml");
    let weak = machine.replace("max_force_n = 400.0", "max_force_n = 5.0");
    assert_ne!(weak, machine);
    desk.write("weak.toml", &weak);
    desk.write("up.cnc", "% up\nN10 G1 Z30 F50\n");
    let arguments = "--machine weak.toml --drives none --report report.json";
    let done = desk.twin(&format!("run up.cnc --limits programmed {arguments}"));
    done.ended(1, "");
    assert!(done.stderr.contains("following-error"), "{}", done.stderr);
    assert_eq!(desk.read("report.json")["findings"][0]["rule"], "following-error");
}

/// A record per cycle without drives; 10 mm at 100 mm/s with 500 mm/s² go there and back in 0.6 s and stand at both ends.
#[test]
fn axes_are_logged_and_their_maxima_reported() {
    let desk = Desk::new();
    desk.allow_late_drives();
    desk.write("short.cnc", SHORT);
    let run = |drives: &str, more: &str| {
        let run = format!("run short.cnc -m machine.toml --drives {drives} --report r.json");
        desk.twin(&format!("{run} {more}"))
    };
    let log = "X=set-position,act-position,set-velocity:x.log";
    run("none", &format!("--log-axis {log} --log-axis Y=all:y.log --tracking-error 2"))
        .ended(0, "");
    let text = desk.text("x.log");
    let records: Vec<Vec<f64>> = text
        .split_terminator("\r\n")
        .map(|record| record.split('\t').map(|value| value.parse().expect("a number")).collect())
        .collect();
    let report = desk.read("r.json");
    let cycles = number(&report["duration_s"]) * 1e3;
    #[expect(clippy::cast_precision_loss, reason = "hundreds")]
    let count = records.len() as f64;
    assert!((count - cycles).abs() <= 1.0 && records.iter().all(|record| record.len() == 3));
    let largest = |column: usize| records.iter().map(|record| record[column]).fold(0.0, f64::max);
    // It turns between two cycles.
    assert!((largest(0) - 10.0).abs() < 1e-3 && (largest(1) - 10.0).abs() < 0.1);
    let peak = number(&report["peak"]["X"]["velocity"]["value"]);
    assert!((largest(2) - peak).abs() < 0.01 * peak, "{}, {peak}", largest(2));
    let y = desk.text("y.log");
    assert!(y.split_terminator("\r\n").all(|record| record.split('\t').count() == 6));
    let maxima = &report["axis_maxima"]["X"];
    has_keys(maxima, "unit dead_time_cycles tracking_error set_velocity set_acceleration");
    assert_eq!(maxima["dead_time_cycles"], 2);
    // The largest of all cycles may miss the peak between two.
    let set = number(&maxima["set_velocity"]["max"]);
    assert!(set > 0.99 * peak && set <= peak + 1e-6, "{set}, {peak}");
    assert!((number(&maxima["set_acceleration"]["max"]) - 500.0).abs() < 1e-6);
    // Two cycles at full speed more than the twin is off by itself.
    let off = number(&report["axis_error"]["X"]["twin"]["max"]);
    let tracking = number(&maxima["tracking_error"]["max"]);
    assert!((tracking - 0.002 * peak).abs() <= off + 1e-9, "{tracking}, {peak}, {off}");

    run("emulated", "--log-axis X=all:x.log --tracking-error").ended(0, "");
    let report = desk.read("r.json");
    let records = desk.text("x.log").lines().count();
    #[expect(clippy::cast_precision_loss, reason = "hundreds")]
    let records = records as f64;
    assert!((records - number(&report["drive_samples"]["count"])).abs() <= 1.0, "{records}");
    let tracking = number(&report["axis_maxima"]["X"]["tracking_error"]["max"]);
    let off = number(&report["axis_error"]["X"]["drives"]["max"]);
    assert!((tracking - off).abs() < 1e-9, "{tracking}, {off}");

    run("none", "--log-axis Q=all:q.log").ended(2, "unknown axis `Q`; the axes are X, Y, Z");
    run("none", "--log-axis X=speed:q.log").ended(2, "`speed` is none of all, set-position");
    run("none", "--log-axis X").ended(2, "expected AXIS=VALUES:FILE");
}

/// Rapids go as fast as the axes can in their direction: X 400 mm/s, and twice as far in X as in Y 200 mm/s of Y. A number in
/// [rs274] caps them.
#[test]
fn rapids_are_as_fast_as_the_axes() {
    let desk = Desk::new();
    let machine = desk.text("machine.toml");
    let (rapid, acceleration) =
        ("rapid_velocity_mm_per_s = 150.0\n", "acceleration_mm_per_s2 = 1000.0\ng28_mm");
    assert!(machine.contains(rapid) && machine.contains(acceleration));
    let free = machine.replace(rapid, "").replace(acceleration, "g28_mm");
    desk.write("free.toml", &free);
    desk.write("capped.toml", &machine.replace(acceleration, "g28_mm"));
    desk.write("rapids.ngc", "G0 X300\nG0 X100 Y100\nM2\n");
    let peaks = |machine: &str, limits: &str| {
        let check = format!("check rapids.ngc -m {machine} --limits {limits} --format json");
        let report = desk.twin(&check).ended(0, "").object();
        let of = |axis: &str, key: &str| number(&report["peak"][axis][key]["value"]);
        [of("X", "velocity"), of("X", "acceleration"), of("Y", "velocity")]
    };
    for limits in ["programmed", "axes"] {
        for (machine, expected) in
            [("free.toml", [400.0, 3000.0, 200.0]), ("capped.toml", [150.0, 3000.0, 67.082])]
        {
            for (found, expected) in peaks(machine, limits).into_iter().zip(expected) {
                let close = (found - expected).abs() < 1.1e-3 * expected;
                assert!(close, "{machine}, {limits}: {found}, not {expected}");
            }
        }
    }
    // An additional axis that the machine lacks has no limits.
    desk.write("turned.ngc", "G0 A90\nG1 A10 F100\nG0 X100\nM2\n");
    let turned = desk.twin("check turned.ngc -m free.toml --limits programmed");
    turned.ended(1, "no axis of the machine has the role \"P\"");
}

/// What moves the axes, what the tool holds, and what the wires carry: three commands of 8.53 ms and a sample of 8.7 ms.
#[test]
fn a_machine_shows_its_motors_and_wires() {
    let desk = Desk::new();
    let text = shipped("machines/gantry3_motors.toml");
    desk.write("motors.toml", &(text + "\n[payload]\nmass_kg = 0.5\n"));
    let shown = desk.twin("machine motors.toml");
    shown.ended(0, "");
    shown.says_all(&["step motor, ", "servo, ", "payload: 0.5 kg at (0, 0, "]);
    let shown = desk.twin("machine machine.toml").stdout;
    assert!(shown.contains("its wire carries 87 commands/s, 29 samples/s at most"), "{shown}");
    assert!(shown.contains("600 N") && shown.contains("payload: none"), "{shown}");
}
