//! Runs that were recorded within the periods of axes: master and slave go on, and of seeded trials as many hold the truth as of
//! runs that were recorded on and on.

use super::found::{Random, cam, using};
use crate::cam::check::{AxisLimits, CamUse};
use crate::cam::run::{RecordedRun, RunSample};
use crate::cam::tune::{Unwound, fit_run, run_dead_time, unwound};
use twin_cam::tune::Free;
use twin_machine::cam_file::CamFile;

const TRIALS: u32 = 100;
/// Of 100 trials that hold with 95 % fewer do in one case of 100.
const HOLD: u32 = 89;

/// Points at rest, and the same cam from the quintic between them alone, with what it gains.
struct Points {
    points: &'static [(f64, f64)],
    /// Unit and period of the slave.
    slave: &'static str,
}

impl Points {
    fn file(&self, tappets: &str) -> CamFile {
        let each =
            |(master, slave): &(f64, f64)| format!("{{ master = {master}, slave = {slave} }}, ");
        let points: Vec<_> = self.points.iter().map(each).collect();
        cam(&format!(
            "name = \"c\"\nmaster = {{ min = 0, max = 360, unit = \"deg\" }}\nslave = {{ {} }}\nelements = [ {}]\n\
             tappets = [{tappets}]\n",
            self.slave,
            points.concat()
        ))
    }

    fn at(&self, place: f64) -> f64 {
        let gain = self.points[self.points.len() - 1].1 - self.points[0].1;
        let (passes, at) = ((place / 360.0).floor(), place.rem_euclid(360.0));
        let pair = self.points.windows(2).find(|pair| at <= pair[1].0).expect("on the cam");
        let part = (at - pair[0].0) / (pair[1].0 - pair[0].0);
        let lift = part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
        passes * gain + pair[0].1 + (pair[1].1 - pair[0].1) * lift
    }
}

const LIFT: Points = Points {
    points: &[(0.0, 0.0), (40.0, 0.0), (140.0, 80.0), (180.0, 80.0), (260.0, 12.0), (360.0, 0.0)],
    slave: "unit = \"mm\", period = 80",
};
/// A rotary table that is moved on by a turn in every pass, and one that swings about its zero.
const TABLE: Points = Points {
    points: &[(0.0, 0.0), (90.0, 60.0), (250.0, 300.0), (360.0, 360.0)],
    slave: "unit = \"deg\", period = 360",
};
const SWING: Points = Points {
    points: &[(0.0, -20.0), (120.0, 35.0), (180.0, 35.0), (360.0, -20.0)],
    slave: "unit = \"deg\", period = 360",
};
/// A feed of 50 mm a pass.
const FEED: Points = Points {
    points: &[(0.0, 0.0), (100.0, 10.0), (250.0, 45.0), (360.0, 50.0)],
    slave: "unit = \"mm\", period = 50",
};

/// How a run is recorded.
struct Way<'a> {
    cam: &'a Points,
    /// u/s.
    velocity: f64,
    /// Least position and period.
    master: Option<[f64; 2]>,
    slave: Option<[f64; 2]>,
    /// How much further on the slave is, of what was before.
    on: f64,
    free: Free,
    noise: [f64; 2],
}

fn within(value: f64, range: Option<[f64; 2]>) -> f64 {
    range.map_or(value, |[lowest, period]| (value - lowest).rem_euclid(period) + lowest)
}

impl Way<'_> {
    /// Three seconds, the truth, and how often its values are held.
    fn hold(&self) -> [u32; 4] {
        let file = self.cam.file("");
        let use_it = using(&file, self.velocity.abs(), AxisLimits::NONE);
        let mut held = [0; 4];
        for seed in 0..TRIALS {
            let mut random = Random(u64::from(seed) + 77_000);
            let mut truth = [0.0, 1.0, 0.0, 1.0];
            let wide = [
                (5.0, self.free.master_offset),
                (0.01, self.free.master_scaling),
                (1.0, self.free.slave_offset),
                (0.03, self.free.slave_scaling),
            ];
            for (value, (by, free)) in truth.iter_mut().zip(wide) {
                *value += if free { random.between(-by, by) } else { 0.0 };
            }
            // Offsets count from where positions are recorded, so it begins within both kinds of periods.
            let begin = random.between(5.0, 175.0);
            let sample = |index: u32| {
                let time_s = f64::from(index) * 0.004;
                let master = begin + self.velocity * time_s;
                let slave = truth[3] * self.cam.at(truth[1] * master + truth[0]) + truth[2];
                let slave = slave + self.on + self.noise[1] * random.normal();
                let master = master + self.noise[0] * random.normal();
                let line = u64::from(index) + 2;
                let (master, slave) = (within(master, self.master), within(slave, self.slave));
                RunSample { line, time_s, master, slave, outputs: Vec::new() }
            };
            let run = RecordedRun { groups: Vec::new(), samples: (0..750).map(sample).collect() };
            let Unwound { run, master, slave } = unwound(&file, &use_it, &run, None);
            assert_eq!(master, self.master.map(|[_, period]| period), "{seed}");
            assert_eq!(slave, self.slave.map(|[_, period]| period), "{seed}");
            let found = fit_run(&file, &use_it, &run, self.free, [None; 4])
                .unwrap_or_else(|error| panic!("{seed}: {error}"));
            for ((held, found), truth) in held.iter_mut().zip(found.estimates).zip(truth) {
                *held += u32::from(found.half_width <= 0.0 || found.holds(truth));
            }
        }
        held
    }
}

/// With a scaling of the master that is free, a slave that gains in every pass, and one that goes round itself, forwards and
/// backwards: whatever is recorded within a period, the truth is found as well as without.
#[test]
fn what_begins_again_goes_on() {
    let plain = Way {
        cam: &LIFT,
        velocity: 360.0,
        master: Some([0.0, 360.0]),
        slave: None,
        on: 0.0,
        free: Free::ALL,
        noise: [0.0, 0.05],
    };
    let half = Some([-180.0, 360.0]);
    let ways = [
        Way { ..plain },
        Way { velocity: -300.0, master: half, noise: [0.05, 0.05], ..plain },
        Way { master: Some([0.0, 720.0]), ..plain },
        Way { cam: &TABLE, slave: Some([0.0, 360.0]), free: Free::OFFSETS, ..plain },
        Way { cam: &TABLE, slave: half, velocity: -250.0, ..plain },
        // It was ten turns on when the recording began, which nobody can know of a master within its period.
        Way { cam: &TABLE, on: 3600.0, free: Free::OFFSETS, ..plain },
        Way { cam: &FEED, on: 500.0, free: Free::OFFSETS, ..plain },
        Way { cam: &SWING, slave: Some([0.0, 360.0]), free: Free::OFFSETS, ..plain },
        Way { cam: &SWING, master: None, slave: Some([0.0, 360.0]), ..plain },
    ];
    for (index, way) in ways.iter().enumerate() {
        let held = way.hold();
        assert!(held.iter().all(|held| *held >= HOLD), "{index}: {held:?}");
    }
}

/// The period of the master is its axis's, whatever its scaling: with 1.5 a pass of the cam is 240 of its 360.
#[test]
fn dead_times_of_a_scaled_master() {
    let tappets = r#"{ group = 1, master = 50, passage = "positive", action = "on" }, { group = 1, master = 200, passage = "positive", action = "off" }"#;
    let file = LIFT.file(tappets);
    let mut use_it = using(&file, 300.0, AxisLimits::NONE);
    use_it.coupling.input.master_scaling = 1.5;
    use_it.coupling.input.master_offset = 20.0;
    let dead = 0.012;
    for period in [360.0, 720.0, 240.0, 500.0] {
        let mut held = 0;
        for seed in 0..20 {
            let mut random = Random(seed + 5);
            let begin = random.between(0.0, 240.0);
            let sample = |index: u32| {
                let time_s = f64::from(index) * 0.004;
                let place = |time: f64| 1.5 * (begin + 300.0 * time) + 20.0;
                let seen = place(time_s - dead).rem_euclid(360.0);
                let master = (begin + 300.0 * time_s + 0.01 * random.normal()).rem_euclid(period);
                let slave = LIFT.at(place(time_s));
                let line = u64::from(index) + 2;
                RunSample {
                    line,
                    time_s,
                    master,
                    slave,
                    outputs: vec![(50.0..200.0).contains(&seen)],
                }
            };
            let run = RecordedRun { groups: vec![1], samples: (0..2000).map(sample).collect() };
            // A period that is neither passes nor turns has to be told.
            let given = (period == 500.0).then_some(period);
            let known = unwound(&file, &use_it, &run, given);
            assert_eq!(known.master, Some(period), "{seed}");
            let unknown = unwound(&file, &use_it, &run, None);
            assert_eq!(unknown.master, given.is_none().then_some(period), "{seed}");
            let (found, _) = run_dead_time(&file, &use_it, &known.run)
                .unwrap_or_else(|error| panic!("{period} {seed}: {error}"));
            let time = found;
            held += u32::from(time.holds(dead) && time.half_width < 0.004);
        }
        assert!(held >= 18, "{period}: {held}");
    }
}

/// What lies nearer to what was in effect than whole passes on is the same motion, with what the slave gains.
#[test]
fn the_same_motion_beside_what_was() {
    let file = TABLE.file("");
    let before = using(&file, 300.0, AxisLimits::NONE);
    let mut after = before;
    let input = &mut after.coupling.input;
    (input.master_offset, input.slave_offset, input.slave_scaling) = (718.8, -720.0, 1.01);
    let beside: CamUse = after.beside(&before, &file);
    let told = beside.coupling.input;
    assert!((told.master_offset + 1.2).abs() < 1e-9, "{told:?}");
    for master in 0..100_i32 {
        let master = 7.3 * f64::from(master);
        let [one, other] = [after.coupling.input, told].map(|input| {
            input.slave_scaling * TABLE.at(master + input.master_offset) + input.slave_offset
        });
        assert!((one - other).abs() < 1e-9, "{master}: {one} {other}");
    }
    assert_eq!(before.beside(&before, &file), before);
}
