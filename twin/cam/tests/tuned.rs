//! Tuning again and again: what is proposed makes the slave do what is wanted, and is not proposed twice.

use super::found::{LIFT, Random, cam, using};
use crate::cam::check::{AxisLimits, CamUse};
use crate::cam::run::{RecordedRun, RunSample};
use crate::cam::tune::dead_time::{switchings, tappet_dead_time};
use crate::cam::tune::{TuneError, changes, corrected, errors, fit_run, rms, wanted};
use std::path::Path;
use twin_cam::tune::{Estimate, Free};
use twin_machine::cam_file::{CamFile, Coupling};

/// A machine: its slave lags, s, and is at `gain` times where it should be, and `shift` beside it.
pub(super) struct Plant {
    pub(super) lag: f64,
    pub(super) gain: f64,
    pub(super) shift: f64,
}

/// Three turns in three seconds.
pub(super) const VELOCITY: f64 = 360.0;

/// What a machine does with a coupling in effect.
pub(super) fn recorded(
    file: &CamFile,
    in_effect: &Coupling,
    plant: &Plant,
    noise: f64,
) -> RecordedRun {
    let input = &in_effect.input;
    let mut random = Random(7);
    let sample = |index: i32| {
        let time_s = f64::from(index) * 0.004;
        let seen = VELOCITY * (time_s - plant.lag) * input.master_scaling + input.master_offset;
        let y = file.cam.curve().repeated(seen).position;
        let told = y * input.slave_scaling + input.slave_offset;
        let slave = plant.gain * told + plant.shift + noise * random.normal();
        let line = 2 + u64::from(index.unsigned_abs());
        RunSample { line, time_s, master: VELOCITY * time_s, slave, outputs: Vec::new() }
    };
    RecordedRun { groups: Vec::new(), samples: (0..750).map(sample).collect() }
}

/// The lift, 70 high at 120: up it goes in another way than down, so that no mirrored lift fits alike.
pub(super) fn uneven() -> String {
    LIFT.replace(
        "{ master = 180, slave = 100 }",
        "{ master = 120, slave = 70 }, { master = 180, slave = 100 }",
    )
}

const FREE: Free = Free { master_scaling: false, ..Free::ALL };

fn tuned(file: &CamFile, use_it: &CamUse, run: &RecordedRun) -> CamUse {
    let fit = fit_run(file, &wanted(use_it), run, FREE, [None; 4]).expect("a fit");
    corrected(file, use_it, &fit).0
}

/// A slave f(m − 1.8) gets `MasterOffset` +1.8, with which it is f(m); one of γ·p + d gets scaling 1/γ and offset −d/γ. With
/// these in effect it does what is wanted, and another run changes nothing.
#[test]
fn what_is_proposed_undoes_the_deviation() {
    let lift = uneven();
    let file = cam(&lift);
    let plant = Plant { lag: 0.005, gain: 1.02, shift: 3.0 };
    let first = using(&file, VELOCITY, AxisLimits::NONE);
    let run = recorded(&file, &first.coupling, &plant, 0.0);
    let second = tuned(&file, &first, &run);
    let input = &second.coupling.input;
    for (value, truth) in [
        (input.master_offset, 1.8),
        (input.slave_scaling, 1.0 / 1.02),
        (input.slave_offset, -3.0 / 1.02),
        (input.master_scaling, 1.0),
    ] {
        assert!((value - truth).abs() < 1e-9, "{value} is not {truth}");
    }
    // The file keeps what was wanted.
    let text = crate::cam::edit::apply(&lift, &changes(&first, &second)).expect("changed");
    let again = CamFile::from_toml(Path::new("cam.toml"), text).expect("a cam");
    assert_eq!(again.coupling, second.coupling);
    assert_eq!(again.coupling.wanted, Some([0.0, 1.0, 0.0, 1.0]));
    let copy = CamFile::from_toml(Path::new("copy.toml"), again.to_toml());
    assert_eq!(copy.expect("a cam").coupling, again.coupling);
    let run = recorded(&file, &again.coupling, &plant, 0.0);
    assert!(rms(&errors(&file, &wanted(&second), &run)) < 1e-9);
    let third = tuned(&file, &second, &run);
    assert_eq!(third, second);
    assert_eq!(changes(&second, &third), []);
}

/// Offsets and scalings that are wanted stay wanted: at twice the height and 7 higher, 30 degrees early.
#[test]
fn what_is_wanted_is_the_coupling_as_it_stands() {
    let lift = uneven();
    let file = cam(&lift);
    let plant = Plant { lag: 0.005, gain: 1.02, shift: 3.0 };
    let mut first = using(&file, VELOCITY, AxisLimits::NONE);
    let input = &mut first.coupling.input;
    (input.master_offset, input.slave_offset, input.slave_scaling) = (30.0, 7.0, 2.0);
    let want = first;
    let second = tuned(&file, &first, &recorded(&file, &first.coupling, &plant, 0.05));
    assert!((second.coupling.input.master_offset - 31.8).abs() < 0.05, "{second:?}");
    assert_eq!(second.coupling.wanted, Some([30.0, 1.0, 7.0, 2.0]));
    // γ · (s · y + b) + d = 2 · y + 7.
    assert!((second.coupling.input.slave_scaling - 2.0 / 1.02).abs() < 1e-3);
    assert!((second.coupling.input.slave_offset - 4.0 / 1.02).abs() < 0.03);
    let run = recorded(&file, &second.coupling, &plant, 0.0);
    assert!(rms(&errors(&file, &want, &run)) < 0.05);
}

/// A run at 360 deg/s whose output of group 1 is what `on` says of the time.
fn switched(between: f64, begin: f64, velocity: f64, on: impl Fn(f64) -> bool) -> RecordedRun {
    let mut samples = Vec::new();
    let mut time_s = begin;
    while time_s < 6.0 {
        let line = 2 + u64::try_from(samples.len()).expect("a line");
        let outputs = vec![on(time_s)];
        samples.push(RunSample { line, time_s, master: velocity * time_s, slave: 0.0, outputs });
        time_s += between;
    }
    RecordedRun { groups: vec![1], samples }
}

fn dead_time(run: &RecordedRun, in_effect: f64) -> Result<Estimate, TuneError> {
    let file = cam(LIFT);
    let mut use_it = using(&file, VELOCITY, AxisLimits::NONE);
    use_it.coupling.dead_time_s = in_effect;
    let seen = switchings(&file, &use_it, run);
    tappet_dead_time(&use_it, &seen, run.between_s())
}

/// The output of the tappets at 50 and 200, so much later.
fn late(dead: f64, velocity: f64) -> impl Fn(f64) -> bool {
    move |time| (50.0..200.0).contains(&(velocity * (time - dead)).rem_euclid(360.0))
}

/// At 4 ms a turn is 250 samples at 360 deg/s, so that every switching has the same error, and 248.8 at 361.7 deg/s.
#[test]
fn the_dead_time_lies_in_its_interval_however_it_is_sampled() {
    for velocity in [360.0, 361.7] {
        let mut hits = 0;
        for seed in 0..400 {
            let mut random = Random(seed);
            let (truth, begin) = (random.between(0.001, 0.03), random.between(0.0, 0.004));
            let run = switched(0.004, begin, velocity, late(truth, velocity));
            let found = dead_time(&run, 0.0).expect("a dead time");
            hits += usize::from(found.holds(truth));
            // No wider than twice what a sample can hide.
            assert!(found.half_width <= 0.004, "{found:?}");
        }
        assert!(hits >= 380, "{hits} of 400 at {velocity}");
    }
}

/// A dead time of 12 ms of which 5 are compensated shows 7, and is 12; with 12 compensated it shows none, and is 12.
#[test]
fn the_dead_time_comes_again() {
    for compensated in [0.0, 0.005, 0.012] {
        let run = switched(0.001, 0.0003, 360.0, late(0.012 - compensated, 360.0));
        let found = dead_time(&run, compensated).expect("a dead time");
        assert!(found.holds(0.012), "{found:?}");
    }
}

/// Outputs that have nothing to do with the tappets, are inverted, too early or too late.
#[test]
fn switchings_that_are_no_dead_time_are_said() {
    let flips = [0.5, 1.0, 2.2, 3.9, 4.4, 5.2];
    let random = |time: f64| flips.iter().filter(|flip| **flip <= time).count() % 2 == 1;
    let error = dead_time(&switched(0.002, 0.0, 360.0, random), 0.0).expect_err("flips");
    assert!(matches!(error, TuneError::Scattered { group: 1, count: 6.0, .. }), "{error}");
    let inverted = |time| !late(0.01, 360.0)(time);
    let error = dead_time(&switched(0.002, 0.0, 360.0, inverted), 0.0).expect_err("inverted");
    assert!(matches!(error, TuneError::Scattered { .. }), "{error}");
    let error = dead_time(&switched(0.002, 0.0, 360.0, late(-0.03, 360.0)), 0.0);
    let error = error.expect_err("before");
    let TuneError::Early { value_s, .. } = error else { panic!("{error}") };
    assert!((value_s + 0.03).abs() < 0.001, "{value_s}");
    let error = dead_time(&switched(0.002, 0.0, 360.0, late(0.3, 360.0)), 0.0).expect_err("late");
    let TuneError::Late { value_s, every_s } = error else { panic!("{error}") };
    assert!((value_s - 0.3).abs() < 0.001 && (every_s - 1.0).abs() < 0.01, "{value_s} {every_s}");
}
