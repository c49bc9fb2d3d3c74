//! Checks against closed forms, and runs whose truth is known.

use crate::cam::check::{AxisLimits, CamCheck, CamUse};
use crate::cam::picture::{Shown, on_stretches};
use crate::cam::run::RecordedRun;
use crate::cam::tune::dead_time::{switchings, tappet_dead_time};
use crate::cam::tune::{ANYTHING, TuneError, errors, fit_run, rms, within_limits};
use crate::finding::{Rule, Severity};
use std::fmt::Write;
use std::path::Path;
use twin_cam::tune::Free;
use twin_cam::{MasterMotion, Quantity, SlaveLimits};
use twin_machine::cam_file::CamFile;

pub(super) const LIFT: &str = r#"
name = "lift"
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 100, unit = "mm", period = 100 }
elements = [{ master = 0, slave = 0 }, { master = 180, slave = 100 }, { master = 360, slave = 0 }]
tappets = [
  { group = 1, master = 50, passage = "positive", action = "on" },
  { group = 1, master = 200, passage = "positive", action = "off" },
  { group = 2, master = 350, action = "timed", delay_us = 10000, duration_us = 100000 },
  { group = 3, master = 300, action = "on" },
  { group = 3, master = 30, action = "off" },
]
"#;

pub(super) fn cam(text: &str) -> CamFile {
    CamFile::from_toml(Path::new("cam.toml"), text.to_owned()).expect("a cam")
}

pub(super) fn using(file: &CamFile, velocity: f64, limits: AxisLimits) -> CamUse {
    let master = MasterMotion { velocity, ..MasterMotion::default() };
    CamUse { master, coupling: file.coupling, repeated: file.repeated, limits, start: None }
}

fn limits(velocity: f64, acceleration: f64) -> AxisLimits {
    let motion = SlaveLimits { velocity, acceleration, ..SlaveLimits::NONE };
    AxisLimits { motion, ..AxisLimits::NONE }
}

/// From rest to rest over w by h a quintic has y′ = 15/8 · h/w and y″ = 10/√3 · h/w² at most.
#[test]
fn limits_of_a_lift_in_closed_form() {
    let file = cam(LIFT);
    let (first, second) =
        (15.0 / 8.0 * 100.0 / 180.0, 10.0 / 3.0_f64.sqrt() * 100.0 / 180.0_f64.powi(2));
    let mut use_it = using(&file, 200.0, limits(205.0, 350.0));
    use_it.coupling.input.slave_scaling = -2.0;
    use_it.coupling.input.slave_offset = 7.0;
    use_it.coupling.input.master_scaling = 0.5;
    use_it.coupling.input.master_offset = 10.0;
    let check = CamCheck::new(&file, use_it);
    let near = |found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    };
    near(check.bounds.velocity.max, first * 2.0 * 100.0);
    near(check.bounds.acceleration.max, second * 2.0 * 100.0 * 100.0);
    assert_eq!((check.bounds.position.max, check.bounds.position.min), (7.0, -193.0));
    // On the cam at 180: the master at (180 − 10) / 0.5.
    near(check.bounds.position.at_min, 340.0);
    let largest = check.largest.as_ref().expect("a velocity");
    near(largest.value, 205.0 / 2.0 / first / 0.5);
    assert_eq!(largest.limited.expect("a limit").0, Quantity::Velocity);
    let rules: Vec<_> = check.findings.iter().map(|finding| finding.rule).collect();
    assert_eq!(rules, [Rule::AxisVelocity, Rule::AxisAcceleration]);
    assert_eq!(check.smoothness(), "C2");
    // Just at the largest velocity nothing is found.
    let value = largest.value;
    use_it.master.velocity = value;
    assert!(CamCheck::new(&file, use_it).findings.is_empty());
}

#[test]
fn positions_and_jumps_are_found() {
    let file = cam(LIFT);
    let mut use_it = using(&file, 1.0, AxisLimits { position: [5.0, 90.0], ..AxisLimits::NONE });
    let check = CamCheck::new(&file, use_it);
    assert_eq!(check.findings.len(), 2);
    assert!(check.findings.iter().all(|finding| finding.rule == Rule::AxisPosition));
    // A periodic cam that does not come back.
    let text = LIFT.replace(
        "{ master = 180, slave = 100 }, { master = 360, slave = 0 }]",
        "{ master = 360, slave = 100 }]",
    );
    let gains = cam(&text.replace(", period = 100", ""));
    use_it.repeated = true;
    let check = CamCheck::new(&gains, use_it);
    assert_eq!(check.findings.len(), 1);
    assert!(check.findings[0].message.contains("gains 100 mm in every pass"));
    // Backwards at twice the scale, with one limit that is a number and one that is none.
    let mut twice = use_it;
    twice.coupling.input.slave_scaling = 2.0;
    twice.coupling.input.master_scaling = -1.0;
    let check = CamCheck::new(&gains, twice);
    assert_eq!(check.gain(), Some(-200.0));
    twice.limits.position = [f64::NEG_INFINITY, 50.0];
    let check = CamCheck::new(&gains, twice);
    let words = "the slave gains -200 mm in every pass of the cam and leaves its greatest position, 50 mm, sooner or later";
    assert_eq!(check.findings[0].message, words);
    // y′ of the triangle jumps from 1 to −1, times the velocity of the master.
    let table = "name = \"t\"\nmaster = { min = 0, max = 20 }\nslave = { min = 0, max = 10 }\n[table]\npairs = [[0, 0], [10, 10], [20, 0]]\n";
    let file = cam(table);
    let check = CamCheck::new(&file, using(&file, 3.0, AxisLimits::NONE));
    assert_eq!(check.smoothness(), "C0");
    let jump = check.jumps[1].expect("a jump");
    assert_eq!((jump.master, jump.by), (10.0, -6.0));
    assert_eq!(check.findings[0].severity, Severity::Warning);
    let check = CamCheck::new(&file, using(&file, 3.0, limits(100.0, 1e9)));
    assert_eq!(check.findings[0].severity, Severity::Error);
    assert!(check.largest.is_err());
}

#[test]
fn bars_of_tappets() {
    let file = cam(LIFT);
    // At 100 deg/s, so that a millisecond is a tenth of a degree.
    let use_it = using(&file, 100.0, AxisLimits::NONE);
    let shown = Shown { file: &file, using: &use_it, name: "" };
    assert_eq!(on_stretches(&shown, 1), [[50.0, 200.0]]);
    // On over the end of the cam: the pass before says how one begins.
    assert_eq!(on_stretches(&shown, 3), [[0.0, 30.0], [300.0, 360.0]]);
    assert_eq!(on_stretches(&shown, 2), [[351.0, 360.0], [0.0, 1.0]]);
    let once = CamUse { repeated: false, ..use_it };
    let shown = Shown { using: &once, ..shown };
    assert_eq!(on_stretches(&shown, 3), [[300.0, 360.0]]);
    // With the other direction the cam is passed from its end on: 300 switches on, 30 off; 350 a millisecond later, downwards; and
    // what is passed forwards only never.
    let mut back = use_it;
    back.coupling.input.master_scaling = -1.0;
    let shown = Shown { using: &back, ..shown };
    assert_eq!(on_stretches(&shown, 3), [[30.0, 300.0]]);
    assert_eq!(on_stretches(&shown, 2), [[339.0, 349.0]]);
    assert_eq!(on_stretches(&shown, 1), [[0.0; 2]; 0]);
}

/// Numbers that come again with their seed (splitmix64).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let high = u32::try_from((bits ^ (bits >> 31)) >> 32).expect("32 bits");
        (f64::from(high) + 0.5) / 4_294_967_296.0
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    pub(super) fn normal(&mut self) -> f64 {
        (-2.0 * self.share().ln()).sqrt() * (std::f64::consts::TAU * self.share()).cos()
    }
}

/// A run of 2,000 ms that gets faster, with the output of group 1: what is switched switches `dead` later.
fn run(random: &mut Random, [offset, shift, dead]: [f64; 3], noise: f64) -> RecordedRun {
    let file = cam(LIFT);
    let curve = file.cam.curve();
    let master = |time: f64| 200.0 * time + 150.0 * time * time;
    let place = |time: f64| master(time) + offset;
    let on = |time: f64| {
        let (inside, _) = curve.wrap(place((time - dead).max(-0.5)));
        (50.0..200.0).contains(&inside)
    };
    let mut text = String::from("time_ms,master_deg,slave_mm,tappet_1\n");
    // Samples come 2 ms apart, beginning anywhere.
    let begin = random.between(0.0, 0.002);
    for index in 0..2000_i32 {
        let time = begin + f64::from(index) * 0.002;
        let slave = curve.repeated(place(time)).position + shift + noise * random.normal();
        let output = u8::from(on(time));
        writeln!(text, "{},{},{slave},{output}", time * 1e3, master(time)).expect("text");
    }
    RecordedRun::parse(Path::new("run.csv"), text.as_bytes()).expect("a run")
}

/// The dead time of 1,000 runs: switchings are known to a sample, so that their errors are even, not normal, and smaller for it: 95 %
/// hit or more, within 4 standard deviations of chance.
#[test]
fn dead_times_of_a_thousand_runs_lie_in_their_intervals() {
    let file = cam(LIFT);
    let use_it = using(&file, 200.0, AxisLimits::NONE);
    let mut hits = 0;
    for seed in 0..1000 {
        let mut random = Random(seed);
        let [offset, shift, truth] =
            [[-170.0, 170.0], [-20.0, 20.0], [0.001, 0.03]].map(|[a, b]| random.between(a, b));
        let run = run(&mut random, [offset, shift, truth], 0.2);
        let seen = switchings(&file, &with_offset(&use_it, offset), &run);
        let dead = tappet_dead_time(&use_it, &seen, run.between_s()).expect("a dead time");
        hits += usize::from(dead.holds(truth));
        assert!((dead.value - truth).abs() < 0.002, "{seed}: {dead:?} {truth:?}");
    }
    assert!(hits >= 922, "{hits}");
}

/// A sensor that slips for a sample is told with its line, and nothing is fitted.
#[test]
fn samples_that_are_off_are_told_with_their_lines() {
    let file = cam(LIFT);
    let use_it = using(&file, 200.0, AxisLimits::NONE);
    let free = Free::OFFSETS;
    let mut run = run(&mut Random(3), [30.0, 4.0, 0.01], 0.2);
    run.samples = run.samples.into_iter().step_by(40).collect();
    assert!(fit_run(&file, &use_it, &run, free, [None; 4]).is_ok());
    run.samples[17].slave += 6.0;
    run.samples[31].slave -= 3.0;
    let error = fit_run(&file, &use_it, &run, free, [None; 4]).expect_err("outliers");
    let TuneError::Outliers { outliers } = &error else { panic!("{error}") };
    let lines: Vec<_> = outliers.iter().map(|(line, _)| *line).collect();
    assert_eq!(lines, [run.samples[17].line, run.samples[31].line]);
    assert!((outliers[0].1 - 6.0).abs() < 1.0 && (outliers[1].1 + 3.0).abs() < 1.0);
    assert!(error.to_string().contains(&format!("line {} (by ", lines[0])), "{error}");
}

fn with_offset(using: &CamUse, offset: f64) -> CamUse {
    let mut moved = *using;
    moved.coupling.input.master_offset = offset;
    moved
}

#[test]
fn a_run_says_how_far_the_slave_was() {
    let file = cam(LIFT);
    let use_it = using(&file, 200.0, AxisLimits::NONE);
    let run = run(&mut Random(5), [12.0, 3.0, 0.01], 0.0);
    let right = errors(&file, &with_offset(&use_it, 12.0), &run);
    assert!(right.iter().all(|(_, error)| (error - 3.0).abs() < 1e-9));
    assert!((rms(&right) - 3.0).abs() < 1e-9);
    // 200 + 300 · time deg/s after four seconds.
    let last = run.velocity(run.samples.len() - 1);
    assert!((last - 1400.0).abs() < 2.0, "{last}");
    let none = RecordedRun { groups: Vec::new(), ..run };
    let error =
        tappet_dead_time(&use_it, &switchings(&file, &use_it, &none), 0.002).expect_err("none");
    assert_eq!(error, TuneError::FewSwitchings { found: 0, needed: 4 });
}

/// An output that something else switches, half a second behind its tappet, is told with its line.
#[test]
fn a_switching_that_is_none_of_the_tappets_is_told() {
    let file = cam(LIFT);
    let use_it = with_offset(&using(&file, 200.0, AxisLimits::NONE), 12.0);
    let mut run = run(&mut Random(5), [12.0, 3.0, 0.01], 0.0);
    let seen = switchings(&file, &use_it, &run);
    let found = tappet_dead_time(&use_it, &seen, run.between_s()).expect("a dead time");
    assert!((found.value - 0.01).abs() < 0.001, "{found:?}");
    let off = run.samples.iter().position(|sample| !sample.outputs[0]).expect("off");
    let on = run.samples[off..].iter().position(|sample| sample.outputs[0]).expect("on") + off;
    run.samples[on..on + 60].iter_mut().for_each(|sample| sample.outputs[0] = false);
    let seen = switchings(&file, &use_it, &run);
    let error = tappet_dead_time(&use_it, &seen, run.between_s()).expect_err("an outlier");
    let TuneError::Outlier { line, behind_s, .. } = error else { panic!("{error}") };
    assert_eq!(line, run.samples[on + 60].line);
    assert!((behind_s - 0.13).abs() < 0.002, "{behind_s}");
}

#[test]
fn runs_that_are_none() {
    let parse = |text: &str| {
        let error = RecordedRun::parse(Path::new("run.csv"), text.as_bytes()).expect_err("none");
        error.to_string()
    };
    for (text, message) in [
        ("time,master,slave\n0,1,2\n0,2,3\n", "line 3: time 0 s is not later than 0 s in line 2"),
        ("time,master\n0,1\n", "0 columns `slave`; there must be one"),
        (
            "time,tappet_2,master,tappet_1,slave,tappet_1\n0,0,1,0,1,1\n",
            "line 1: 2 columns `tappet_1`; there must be one",
        ),
        ("time_h,master,slave\n0,1,2\n", "`h` is not a unit of time"),
        ("time,master,slave,tappet_x\n0,1,2,0\n", "names no group"),
        ("time,master,slave,tappet_1\n0,1,2,0.5\n", "line 2: tappet_1 is 0.5; it must be 0 or 1"),
        ("time,master,slave,torque\n0,1,2,0.5\n", "column `torque` is not one of"),
        ("0,1,2,3\n", "4 columns without a header"),
        ("time,master,slave\n0,1,\n", "line 2: `slave` is ``, which is not a number"),
    ] {
        assert!(parse(text).contains(message), "{text:?}: {}", parse(text));
    }
    let run = RecordedRun::parse(
        Path::new("run.csv"),
        b"Time (us);Master [mm];Slave\n0;1,5;2\n1000;2;3\n",
    );
    let run = run.expect("a run");
    assert!((run.samples[1].time_s - 0.001).abs() < 1e-15 && run.samples[0].master == 1.5);
}

/// What keeps the limits is nearest to the motion so far: the peak of y″ · (s · v)² is at its limit with the largest scaling.
#[test]
fn scalings_and_offsets_within_limits() {
    let file = cam(LIFT);
    let none = Free::NONE;
    let within_limits = |file: &CamFile, using: &CamUse, free: Free| {
        let sought = free.list().map(|free| free.then_some(ANYTHING));
        Ok::<_, TuneError>(within_limits(file, using, sought)?.0)
    };
    let second = 10.0 / 3.0_f64.sqrt() * 100.0 / 180.0_f64.powi(2);
    let use_it = using(&file, 300.0, limits(1e6, 900.0));
    let found =
        within_limits(&file, &use_it, Free { master_scaling: true, ..none }).expect("a scaling");
    let expected = (900.0 / second).sqrt() / 300.0;
    assert!((found.coupling.input.master_scaling / expected - 1.0).abs() < 1e-9);
    let found =
        within_limits(&file, &use_it, Free { slave_scaling: true, ..none }).expect("a scaling");
    let expected = 900.0 / (second * 300.0 * 300.0);
    assert!((found.coupling.input.slave_scaling / expected - 1.0).abs() < 1e-9);
    // 0 to 100 into 20 to 150: up by 20; into 20 to 90: smaller as well, if that is free.
    let offset = Free { slave_offset: true, ..none };
    let mut low = using(&file, 1.0, AxisLimits { position: [20.0, 150.0], ..AxisLimits::NONE });
    assert_eq!(
        within_limits(&file, &low, offset).expect("an offset").coupling.input.slave_offset,
        20.0
    );
    low.limits.position = [20.0, 90.0];
    let error = within_limits(&file, &low, offset).expect_err("too high");
    assert!(matches!(error, TuneError::NoRoom { what: "SlaveOffset", .. }), "{error}");
    let found = within_limits(&file, &low, Free { slave_scaling: true, ..offset }).expect("both");
    assert!((found.coupling.input.slave_scaling - 0.7).abs() < 1e-12);
    assert!((found.coupling.input.slave_offset - 20.0).abs() < 1e-12);
    // What stands on its limits keeps them.
    assert!(CamCheck::new(&file, found).findings.is_empty());
    // Without the offset, 0 to 100 into 0 to 70 or −50 to 40 by the scaling alone; into 20 to 90 not at all.
    for (position, expected) in [([0.0, 70.0], 0.7), ([-50.0, 40.0], 0.4)] {
        low.limits.position = position;
        let found = within_limits(&file, &low, Free { slave_scaling: true, ..none }).expect("one");
        assert!((found.coupling.input.slave_scaling - expected).abs() < 1e-12);
        assert!(CamCheck::new(&file, found).findings.is_empty());
    }
    low.limits.position = [20.0, 90.0];
    let error = within_limits(&file, &low, Free { slave_scaling: true, ..none }).expect_err("none");
    assert!(matches!(error, TuneError::NoRoom { what: "SlaveScaling", .. }), "{error}");
    // What keeps them already is left alone, bit for bit.
    let wide = using(&file, 1.0, limits(1e6, 1e6));
    assert_eq!(
        within_limits(&file, &wide, Free { master_offset: false, ..Free::ALL }).expect("kept"),
        wide
    );
}
