//! Outputs of runs that contradict each other, or that no tappet has switched.

use super::found::{Random, cam, using};
use crate::cam::check::{AxisLimits, CamUse};
use crate::cam::run::{RecordedRun, RunSample};
use crate::cam::tune::dead_time::Part;
use crate::cam::tune::{TuneError, run_dead_time};
use twin_cam::tune::Estimate;
use twin_machine::cam_file::CamFile;

const TWO: &str = r#"
name = "two"
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 100, unit = "mm", period = 100 }
elements = [{ master = 0, slave = 0 }, { master = 180, slave = 100 }, { master = 360, slave = 0 }]
tappets = [
  { group = 1, master = 60, passage = "positive", action = "on" },
  { group = 1, master = 200, passage = "positive", action = "off" },
  { group = 2, master = 100, passage = "positive", action = "on" },
  { group = 2, master = 300, passage = "positive", action = "off" },
]
"#;

pub(super) const VELOCITY: f64 = 300.0;

/// Ten seconds, a sample every `between`; `outputs` says of the time what is on.
pub(super) fn recorded(
    groups: &[i16],
    between: f64,
    count: u32,
    mut outputs: impl FnMut(f64) -> Vec<bool>,
) -> RecordedRun {
    let sample = |index: u32| {
        let time_s = f64::from(index) * between;
        let (line, master) = (u64::from(index) + 2, VELOCITY * time_s);
        RunSample { line, time_s, master, slave: 0.0, outputs: outputs(time_s) }
    };
    RecordedRun { groups: groups.to_vec(), samples: (0..count).map(sample).collect() }
}

/// The output of tappets from `on` to `off`, each edge so much later, s.
pub(super) fn late(time: f64, [on, off]: [f64; 2], [rise, fall]: [f64; 2]) -> bool {
    let since = |place: f64, dead: f64| (VELOCITY * (time - dead) - place).rem_euclid(360.0);
    since(on, rise) < since(off, fall)
}

pub(super) fn message(run: &RecordedRun) -> Result<Estimate, TuneError> {
    let (file, use_it) = two();
    run_dead_time(&file, &use_it, run).map(|(found, _)| found)
}

pub(super) fn two() -> (CamFile, CamUse) {
    let file = cam(TWO);
    let use_it = using(&file, VELOCITY, AxisLimits::NONE);
    (file, use_it)
}

pub(super) fn output_error(run: &RecordedRun) -> TuneError {
    message(run).expect_err("outputs that are refused")
}

pub(super) const FIRST: [f64; 2] = [60.0, 200.0];
pub(super) const SECOND: [f64; 2] = [100.0, 300.0];

/// Group 1 is 5 ms late and group 2 later, without any scatter: no dead time is both, and both are told. Of the same dead
/// time, within what samples tell, it is found.
#[test]
fn groups_that_contradict_each_other_are_told() {
    for (between, second) in [(0.001, 0.04), (0.001, 0.01), (0.001, 0.02), (0.002, 0.01)] {
        let run = recorded(&[1, 2], between, 8000, |time| {
            vec![late(time, FIRST, [0.005; 2]), late(time, SECOND, [second; 2])]
        });
        let error = output_error(&run);
        let TuneError::TwoDeadTimes { one, other } = &error else { panic!("{error}") };
        assert_eq!((one.which, other.which), (Part::Group(1), Part::Group(2)));
        assert!((one.mean_s - 0.005).abs() <= between && (other.mean_s - second).abs() <= between);
        let text = error.to_string();
        assert!(text.contains("group 1 switches 0.00") && text.contains("group 2"), "{text}");
    }
    for between in [0.001, 0.004] {
        let run = recorded(&[1, 2], between, 3000, |time| {
            vec![late(time, FIRST, [0.0053; 2]), late(time, SECOND, [0.0053; 2])]
        });
        assert!(message(&run).expect("one dead time").holds(0.0053));
    }
}

/// Edges of one group, halves of the run, and every other switching.
#[test]
fn other_parts_that_contradict_each_other_are_told() {
    let which = |run: &RecordedRun| match output_error(run) {
        TuneError::TwoDeadTimes { one, other } => (one.which, other.which),
        other => panic!("{other}"),
    };
    let edges = recorded(&[1], 0.001, 8000, |time| vec![late(time, FIRST, [0.004, 0.011])]);
    assert_eq!(which(&edges), (Part::On(1), Part::Off(1)));
    let halves = recorded(&[1], 0.001, 8000, |time| {
        vec![late(time, FIRST, [if time < 4.0 { 0.004 } else { 0.012 }; 2])]
    });
    assert_eq!(which(&halves), (Part::First, Part::Second));
    let turns = recorded(&[1], 0.001, 15_000, |time| {
        let odd = (VELOCITY * time / 360.0).rem_euclid(2.0) < 1.0;
        vec![late(time, FIRST, [if odd { 0.004 } else { 0.03 }; 2])]
    });
    assert_eq!(which(&turns), (Part::Early, Part::Late));
}

/// Dead times that scatter by a millisecond, alike in both groups or not: what is true is found, in 200 of 200 runs, and lies in its
/// interval in 95 % of them or more (half a sample is added).
#[test]
fn scatter_is_no_contradiction() {
    for scatter in [[0.001, 0.001], [0.0002, 0.0015]] {
        let mut hits = 0;
        for seed in 0..200 {
            let mut random = Random(seed + 3000);
            // A dead time of its own for each turn and edge.
            let mut drawn: Vec<[f64; 4]> = Vec::new();
            let run = recorded(&[1, 2], 0.002, 4000, |time| {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a few turns"
                )]
                let turn = ((VELOCITY * time - 30.0) / 360.0 + 1.0).floor() as usize;
                while drawn.len() <= turn {
                    let mut of = |index: usize| 0.012 + scatter[index] * random.normal();
                    drawn.push([of(0), of(0), of(1), of(1)]);
                }
                let [a, b, c, d] = drawn[turn];
                vec![late(time, FIRST, [a, b]), late(time, SECOND, [c, d])]
            });
            let found = message(&run).unwrap_or_else(|error| panic!("{seed}: {error}"));
            hits += usize::from(found.holds(0.012));
        }
        assert!(hits >= 190, "{hits} of 200");
    }
}

/// Outputs that change at random, seldom or often, are never fitted but by chance, of one in a thousand.
#[test]
fn outputs_at_random_are_told() {
    let mut fitted = 0;
    for (chance, count) in [(0.5, 1500), (0.2, 6000), (0.05, 6000), (0.01, 6000), (0.002, 6000)] {
        for seed in 0..60 {
            let mut random = Random(seed + 500);
            let mut on = random.share() < 0.5;
            let run = recorded(&[1], 0.002, count, |_| {
                on ^= random.share() < chance;
                vec![on]
            });
            fitted += usize::from(message(&run).is_ok());
        }
    }
    assert_eq!(fitted, 0);
    let mut random = Random(1);
    let run = recorded(&[1], 0.002, 1500, |_| vec![random.share() < 0.5]);
    let error = output_error(&run);
    assert!(matches!(error, TuneError::Scattered { group: 1, .. }), "{error}");
    // 25 turns, and one pulse.
    let run = recorded(&[1], 0.002, 15_000, |time| vec![(0.205..0.67).contains(&time)]);
    let error = message(&run).expect_err("two switchings");
    assert!(matches!(error, TuneError::FewSwitchings { .. }), "{error}");
}

#[test]
fn groups_that_the_cam_has_not_are_told() {
    let run = recorded(&[1, 9], 0.002, 3000, |time| vec![late(time, FIRST, [0.005; 2]), false]);
    let error = output_error(&run);
    assert_eq!(error, TuneError::NoGroup { group: 9, has: vec![1, 2] });
    assert!(error.to_string().contains("`tappet_9`"), "{error}");
}
