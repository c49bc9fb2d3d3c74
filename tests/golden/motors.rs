//! Motors of the simulated machine, reported by `twin check --physics` as a process.

use crate::desk::{Desk, Done, number, shipped};
use crate::recording::{chunks, recorded, series};
use serde_json::Value;

/// Z comes down slowly, then fast.
const DOWN: &str = "\
% down
N10 G92 X100 Y0 Z60 F20 E400 E-400
N20 G1 Z50
N30 G1 Z0 F140 E1400 E-1400
";

/// The shipped machine with `edits` in its file.
fn desk(edits: &[(&str, &str)]) -> Desk {
    let desk = Desk::new();
    let mut machine = shipped("machines/gantry3_motors.toml");
    for (from, to) in edits {
        assert!(machine.contains(from), "{from}");
        machine = machine.replace(from, to);
    }
    desk.write("motors.toml", &machine);
    desk.write("down.cnc", DOWN);
    desk
}

fn check(desk: &Desk, format: &str) -> Done {
    desk.twin(&format!(
        "check down.cnc -m motors.toml --limits programmed --physics --format {format}"
    ))
}

fn json(desk: &Desk, status: i32) -> Value {
    check(desk, "json").ended(status, "").object()
}

#[test]
fn the_shipped_motors_do_it() {
    let desk = desk(&[]);
    let report = json(&desk, 0);
    let z = &report["motor_load"]["Z"];
    assert_eq!(z["effort_unit"], "N");
    // It carries 3.3 kg, and the limit is what is left at 150 mm/s, 1800 turns a minute.
    assert!(number(&z["rms_effort"]) > 20.0, "{z}");
    let limit = 0.55 * std::f64::consts::TAU / 0.005;
    assert!((number(&z["effort_limit"]) - limit).abs() < 1e-6 * limit, "{z}");
    let percent = number(&z["utilisation_percent"]);
    assert!((percent - number(&z["peak_effort"]) / limit * 100.0).abs() < 1e-6, "{z}");
    // Going down, the motor brakes more than it drives.
    assert!(number(&z["braking_energy_j"]) > 0.0, "{z}");
    assert!(number(&report["motor_load"]["X"]["warmth_percent"]) < 1.0, "{report:#}");
    check(&desk, "human").ended(0, "").says("peak power");
}

/// A step motor too weak for the fast line loses steps there, and is told so on that line alone.
#[test]
fn lost_steps_have_a_line() {
    let desk = desk(&[(
        "[300.0, 1.7], [1200.0, 0.8], [2400.0, 0.3]",
        "[300.0, 0.6], [1200.0, 0.1], [2400.0, 0.04]",
    )]);
    let report = json(&desk, 1);
    let findings = report["findings"].as_array().expect("a list");
    let lost: Vec<_> = findings.iter().filter(|one| one["rule"] == "lost-steps").collect();
    let [lost] = &lost[..] else { panic!("{findings:#?}") };
    assert_eq!((&lost["line"], &lost["block"]), (&4.into(), &30.into()), "{lost}");
    assert_eq!((&lost["axis"], &lost["severity"]), (&"Z".into(), &"error".into()), "{lost}");
    let message = lost["message"].as_str().expect("a text");
    assert!(message.contains("full steps"), "{message}");
}

#[test]
fn a_limit_switch_stops_the_machine() {
    let desk = desk(&[(
        "[axes.physics.brake]",
        "[axes.physics.switches]\nlower_mm = 70.0\n[axes.physics.brake]",
    )]);
    let report = json(&desk, 1);
    let findings = report["findings"].as_array().expect("a list");
    let [switch] = &findings[..] else { panic!("{findings:#?}") };
    assert_eq!((&switch["rule"], &switch["line"]), (&"limit-switch".into(), &4.into()), "{switch}");
    assert!(switch["message"].as_str().is_some_and(|text| text.contains("lower limit switch")));
    // And in a run: the path is left, and the reason is told.
    let run = desk.twin("run down.cnc -m motors.toml --drives none");
    run.ended(2, "");
    assert!(run.stderr.contains("axis Z ran on its lower limit switch"), "{}", run.stderr);
}

#[test]
fn a_motor_that_gets_too_warm_is_a_warning() {
    let desk = desk(&[(
        "friction_nm = 0.02 ",
        "friction_nm = 0.02\ncontinuous_torque_nm = 0.02\nthermal_time_constant_s = 0.5 ",
    )]);
    let report = json(&desk, 0);
    let findings = report["findings"].as_array().expect("a list");
    assert!(
        findings.iter().any(|one| {
            one["rule"] == "motor-overload" && one["severity"] == "warning" && one["axis"] == "Z"
        }),
        "{findings:#?}"
    );
    assert!(number(&report["motor_load"]["Z"]["warmth_percent"]) > 100.0);
}

/// What the motors do is in the recording of a run, as often as the errors are, and agrees with its report.
#[test]
fn a_recording_shows_the_motors() {
    let desk = desk(&[]);
    let aslant = DOWN.replace("G1 Z50", "G1 X120 Z50").replace("G1 Z0", "G1 X0 Z0");
    desk.write("aslant.cnc", &aslant);
    let run = "run aslant.cnc -m motors.toml --drives none";
    let out = "--record r.rrd --report r.json";
    desk.twin(&format!("{run} {out}")).ended(0, "");
    let report = desk.read("r.json");
    let errors = recorded(&desk, "error/axis_mm/Z/twin");
    assert!(errors.len() > 200, "{}", errors.len());
    let most = |entity: &str| {
        let values = recorded(&desk, entity);
        assert_eq!(values.len(), errors.len(), "{entity}");
        values.into_iter().fold(0.0_f64, |most, value| most.max(value.abs()))
    };
    let load = &report["motor_load"];
    for (entity, axis, reported) in [
        ("motor/force_n/X/twin", "X", "peak_effort"),
        ("motor/force_n/Z/twin", "Z", "peak_effort"),
        ("motor/power_w/X/twin", "X", "peak_power_w"),
        ("motor/warmth_percent/X/twin", "X", "warmth_percent"),
    ] {
        // Every fourth cycle is shown, and the mean of each. (The power of a step motor swings faster than that.)
        let (shown, told) = (most(entity), number(&load[axis][reported]));
        assert!(shown > 0.5 * told && shown <= told * (1.0 + 1e-9), "{entity}: {shown}, {told}");
    }
    // At rest it is the holding torque, 1.9 Nm on a screw of 5 mm.
    let holding = 1.9 * std::f64::consts::TAU / 0.005;
    assert!((most("motor/force_n/Z/limit") - holding).abs() < 1e-3 * holding);
    // It carries 3.3 kg.
    let holds = 3.3 * 9.80665 / holding * 100.0;
    let used = most("motor/utilisation_percent/Z/twin");
    assert!(used > holds && used < 100.0, "{used} %");
    let angle = most("motor/load_angle_full_steps/Z/twin");
    assert!(angle > 0.001 && angle < 1.0, "{angle} full steps");
    // X has no step motor, and Z is not watched for its warmth.
    for entity in [
        "motor/load_angle_full_steps/X/twin",
        "motor/warmth_percent/Z/twin",
        "motor/torque_nm/X/twin",
    ] {
        assert!(recorded(&desk, entity).is_empty(), "{entity}");
    }
}

/// A scenario: what goes wrong, from which line on, and what comes of it; the same in a check and in a run.
#[test]
fn faults_on_purpose_have_lines() {
    let desk = desk(&[]);
    let fault = |kind: &str| {
        desk.write("faults.toml", &format!("[[faults]]\nkind = {kind}\nat_line = 4\n"));
    };
    let message = |desk: &Desk, rule: &str, line: u32| {
        let check = "check down.cnc -m motors.toml --physics --format json";
        let done = desk.twin(&format!("{check} --faults faults.toml"));
        let report = done.object();
        let findings = report["findings"].as_array().expect("a list").clone();
        let fits = |one: &&Value| one["rule"] == rule && one["line"] == line && one["axis"] == "Z";
        assert!(findings.iter().any(|one| fits(&one)), "no {rule}: {findings:#?}");
        done
    };
    fault("\"lost_steps\"\naxis = \"Z\"\nsteps = 12");
    let done = message(&desk, "lost-steps", 4);
    done.says("lost 12 full steps");
    message(&desk, "fault", 4);
    // 40 mm on a screw of 5 mm, 200 steps a turn, against an axis that jams on the way.
    fault("\"jam\"\naxis = \"Z\"");
    message(&desk, "lost-steps", 4);
    message(&desk, "following-error", 4);
    fault("\"power_loss\"");
    message(&desk, "fault", 4);

    let run = "run down.cnc -m motors.toml --drives none --faults faults.toml";
    let done = desk.twin(run);
    assert!(done.stderr.contains("its drive has no power any more"), "{}", done.stderr);
    let refused = desk.twin("check down.cnc -m motors.toml --faults faults.toml");
    assert_eq!(refused.status, Some(2));
    assert!(
        refused.stderr.contains("--faults has no effect without --physics"),
        "{}",
        refused.stderr
    );
    desk.write("faults.toml", "[[faults]]\nkind = \"jamm\"\naxis = \"Z\"\nat_s = 1\n");
    let refused = desk.twin(run);
    assert_eq!(refused.status, Some(2));
    assert!(refused.stderr.contains("did you mean \"jam\""), "{}", refused.stderr);
}

/// A scenario's time, all the way from its file to the recording: at constant velocity a screw that has 1 % of its stiffness left gives
/// way by friction over stiffness, from the moment on that the file says.
#[test]
fn a_fault_begins_at_its_time() {
    let desk = desk(&[]);
    desk.write("across.cnc", "% across\nN10 G92 X0 Y0 Z60 F200 E400 E-400\nN20 G1 X300\n");
    desk.write(
        "loose.toml",
        "[[faults]]\nkind = \"loose_belt\"\naxis = \"X\"\nat_s = 1.0\nstiffness_percent = 1.0\n",
    );
    let run = "run across.cnc -m motors.toml --drives none";
    desk.twin(&format!("{run} --record r.rrd --faults loose.toml"));
    let errors = series(&chunks(&desk), "error/axis_mm/X/twin");
    let mean = |from: f64, to: f64| {
        let within = errors.iter().filter(|(ns, _)| {
            #[expect(clippy::cast_precision_loss, reason = "seconds")]
            let time = *ns as f64 * 1e-9;
            (from..to).contains(&time)
        });
        let values: Vec<f64> = within.map(|(_, value)| *value).collect();
        assert!(values.len() > 10, "{from} s: {values:?}");
        #[expect(clippy::cast_precision_loss, reason = "some hundreds")]
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        mean.abs()
    };
    // 20 N and 60 N·s/m at 0.2 m/s, on a screw of 60 kN/mm with 5 µm of play, of which half is to be made up for.
    let pull = 20.0 + 60.0 * 0.2;
    let [sound, loose] = [pull / 60_000.0, pull / 600.0].map(|stretched| stretched + 2.5e-3);
    let (before, after) = (mean(0.8, 0.99), mean(1.2, 1.45));
    assert!((before - sound).abs() < 0.3e-3, "{before} mm, not {sound} mm");
    assert!((after - before - (loose - sound)).abs() < 0.01 * loose, "{after} mm, {loose} mm");
    // No earlier, and hardly later: in the hundredth of a second that begins then it is more than half there.
    let (just_before, at_once) = (mean(0.95, 0.998), mean(1.002, 1.1));
    assert!((just_before - before).abs() < 0.1e-3, "{just_before} mm");
    assert!(at_once > 0.5 * loose, "{at_once} mm");
}

/// Noise: the same seed, the same run.
#[test]
fn a_seed_makes_the_noise() {
    let desk = desk(&[("force_n = 0.5 ", "force_n = 20.0 ")]);
    let run = |seed: &str| {
        let check = "check down.cnc -m motors.toml --physics --format json";
        desk.twin(&format!("{check} --seed {seed}")).stdout
    };
    assert_eq!(run("7"), run("7"));
    assert_ne!(run("7"), run("8"));
}

/// A fault in a line that moves nothing, or after the end, is no fault, and is said.
#[test]
fn faults_that_never_begin_are_told() {
    let desk = desk(&[]);
    for (start, line) in [("at_line = 999", 999), ("at_line = 1", 1), ("at_s = 999.0", 1)] {
        desk.write("late.toml", &format!("[[faults]]\nkind = \"jam\"\naxis = \"X\"\n{start}\n"));
        let done = desk.twin("check down.cnc -m motors.toml --physics --faults late.toml");
        let said = format!("line {line}: the fault of axis X at ");
        assert!(done.ended(0, "never began").stderr.contains(&said), "{}", done.stderr);
    }
}
