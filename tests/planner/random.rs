//! Random paths: lines, arcs, helices, corners and pauses, from hundredths of a millimetre to decimetres.

use super::machines::Machine;
use super::run::{Report, Settings, arrives, run};
use nalgebra::{Point3, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;
use twin_path::Place;
use twin_path::{Arc, ElementKind, PathElement, Plane, Shape};

#[derive(Clone, Debug)]
pub struct Step {
    form: Form,
    straight_on: bool,
    /// m.
    length: f64,
    direction: [f64; 3],
    /// m/s and m/s².
    feed: f64,
    accelerations: [f64; 2],
}

#[derive(Clone, Copy, Debug)]
pub enum Form {
    Line,
    Rapid,
    Arc { plane: Plane, sweep: f64, rise: f64 },
    Dwell,
}

pub fn exponential(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> + Clone {
    (range.start.ln()..range.end.ln()).prop_map(f64::exp)
}

pub fn step() -> impl Strategy<Value = Step> {
    let sweep = prop_oneof![-1.9 * PI..-0.05, 0.05..1.9 * PI];
    let plane = prop_oneof![3 => Just(Plane::Xy), 1 => Just(Plane::Zx), 1 => Just(Plane::Yz)];
    let rise = prop_oneof![Just(0.0), -0.3..0.3];
    let form = prop_oneof![
        8 => Just(Form::Line),
        1 => Just(Form::Rapid),
        5 => (plane, sweep, rise).prop_map(|(plane, sweep, rise)| Form::Arc { plane, sweep, rise }),
        1 => Just(Form::Dwell),
    ];
    // Most as short as CAM writes them.
    let length = prop_oneof![3 => exponential(1e-5..5e-3), 1 => exponential(5e-3..0.05)];
    let flat = (-1.0..1.0, -1.0..1.0).prop_map(|(x, y)| [x, y, 0.0]);
    let direction = prop_oneof![2 => flat, 1 => [-1.0..1.0, -1.0..1.0, -0.5..0.5]];
    let accelerations = [exponential(0.2..20.0), exponential(0.2..20.0)];
    (form, any::<bool>(), length, direction, exponential(5e-3..0.5), accelerations).prop_map(
        |(form, straight_on, length, direction, feed, accelerations)| {
            Step::new(form, straight_on, length, direction, feed, accelerations)
        },
    )
}

impl Step {
    pub fn new(
        form: Form,
        straight_on: bool,
        length: f64,
        direction: [f64; 3],
        feed: f64,
        accelerations: [f64; 2],
    ) -> Self {
        Self { form, straight_on, length, direction, feed, accelerations }
    }

    /// From `at`, where the path arrives in the direction `along`.
    fn element(&self, at: Point3<f64>, along: Option<Vector3<f64>>) -> Option<PathElement> {
        let along = along.filter(|_| self.straight_on);
        let along = along.or_else(|| Vector3::from(self.direction).try_normalize(1e-3))?;
        let (kind, shape) = match self.form {
            Form::Line | Form::Rapid => {
                let shape = Shape::Line { start: at, end: at + along * self.length };
                let cut = matches!(self.form, Form::Line);
                (if cut { ElementKind::Cut } else { ElementKind::Rapid }, shape)
            }
            Form::Arc { plane, sweep, rise } => {
                let [x, y, _] = plane.split(&along);
                let left = Vector2::new(-y, x).try_normalize(1e-3)?;
                let spoke = left * (self.length / sweep);
                let [x, y, z] = plane.split(&at.coords);
                let center = Vector2::new(x, y) + spoke;
                let (sin, cos) = sweep.sin_cos();
                let end = center
                    - Vector2::new(spoke.x * cos - spoke.y * sin, spoke.x * sin + spoke.y * cos);
                let end = plane.join([end.x, end.y, z + rise * self.length]);
                let center = plane.join([center.x, center.y, z]);
                let made = Arc::in_plane(plane, at, end.into(), center.into(), sweep);
                (ElementKind::Cut, Shape::Arc(made))
            }
            Form::Dwell => {
                (ElementKind::Dwell { time_ns: 10_000_000 }, Shape::Line { start: at, end: at })
            }
        };
        let [acceleration, deceleration] = self.accelerations;
        let made = PathElement::new(Place::default(), kind, shape);
        Some(PathElement { feed: self.feed, acceleration, deceleration, ..made })
    }
}

/// The steps one after the other, without those that leave the room.
pub fn walk(steps: &[Step], machine: Machine) -> Vec<PathElement> {
    let [min, max] = machine.room();
    let mut at = Point3::from(0.5 * (min + max));
    let mut along = None;
    let mut path = Vec::new();
    for (index, step) in steps.iter().enumerate() {
        let Some(mut element) = step.element(at, along) else { continue };
        let bounds = element.shape.bounds();
        let inside = (0..3).all(|i| bounds.min[i] >= min[i] && bounds.max[i] <= max[i]);
        if !inside {
            continue;
        }
        element.place.line = index as u32 + 1;
        at = element.end();
        along = arrives(&element).or(along);
        path.push(element);
    }
    path
}

/// Checks the invariants of every motion.
pub fn check(
    report: &Report,
    path: &[PathElement],
    settings: &Settings,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(report.effort.failed, 0);
    // Turns of a knife take microseconds, in which jerks are allowed more below.
    prop_assert!(report.effort.exceeded == 0 || settings.machine.turns(), "{:?}", report.effort);
    prop_assert!(report.feed.value <= 1.001, "feed {:?} on {settings:?}", report.feed);
    limits_hold(report, path, settings, 1.001)
}

/// Checks the limits of every motion, whatever the override was; the path accelerates and brakes by no more than the
/// part `along` of what is programmed.
pub fn limits_hold(
    report: &Report,
    path: &[PathElement],
    settings: &Settings,
    along: f64,
) -> Result<(), TestCaseError> {
    prop_assert!(report.errors.is_empty(), "{:?}", report.errors);
    let mut lines: Vec<u32> = path.iter().map(|element| element.place.line).collect();
    let mut visited = report.lines.clone();
    if settings.machine.turns() {
        // Arcs that stand upright are cut where the tool turns round.
        lines.dedup();
        visited.dedup();
    }
    prop_assert_eq!(&visited, &lines);
    prop_assert!(report.duration.is_finite());
    let limited = [
        ("velocity", report.velocity, 1.001),
        ("acceleration", report.acceleration, 1.001),
        ("jerk", report.jerk, 1.05),
        ("brief jerk", report.brief_jerk, if settings.machine.turns() { 3.0 } else { 1.05 }),
        ("third difference", report.third_difference, 1.05),
        ("path acceleration", report.path_acceleration, along),
        ("velocity step", report.velocity_step, 1e-6),
    ];
    for (name, peak, most) in limited {
        prop_assert!(peak.value <= most, "{name} {peak:?} on {settings:?}, {:?}", report.effort);
    }
    if settings.jerk {
        prop_assert!(report.acceleration_step.value <= 1e-5, "{:?}", report.acceleration_step);
    }
    Ok(())
}

pub fn settings() -> impl Strategy<Value = Settings> {
    let machine = prop::sample::select(Machine::ALL.to_vec());
    let angle = prop_oneof![Just(2_f64.to_radians()), Just(PI)];
    (machine, exponential(1e-6..1e-4), angle).prop_map(|(machine, tolerance, angle)| Settings {
        machine,
        jerk: true,
        tolerance,
        angle,
        horizon: 1.5,
    })
}

/// Failures take long to plan: their paths are made shorter only a few times.
pub fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        max_shrink_iters: 40,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn limits_of_jerk_are_kept(settings in settings(), steps in prop::collection::vec(step(), 1..25)) {
        let path = walk(&steps, settings.machine);
        let report = run(path.iter().cloned(), &settings, settings.options());
        check(&report, &path, &settings)?;
        let fast = Settings { jerk: false, ..settings };
        let fast = run(path.iter().cloned(), &fast, settings.options());
        prop_assert!(fast.duration <= report.duration * 1.001, "{} {}", fast.duration, report.duration);
        let most = 2.0 * fast.duration + 0.2 * f64::from(report.stops);
        prop_assert!(report.duration <= most, "{} of {most}", report.duration);
    }

    #[test]
    fn limits_of_acceleration_are_kept(settings in settings(), steps in prop::collection::vec(step(), 1..25)) {
        let settings = Settings { jerk: false, ..settings };
        let path = walk(&steps, settings.machine);
        let report = run(path.iter().cloned(), &settings, settings.options());
        check(&report, &path, &settings)?;
    }
}

proptest! {
    #![proptest_config(cases(6))]

    #[test]
    fn windows_lose_little(settings in settings(), jerk in any::<bool>(), steps in prop::collection::vec(step(), 10..30)) {
        let whole = Settings { jerk, horizon: 1e3, ..settings };
        let path = walk(&steps, settings.machine);
        let best = run(path.iter().cloned(), &whole, whole.options());
        for horizon in [1.5, 0.6] {
            let part = Settings { horizon, ..whole };
            let report = run(path.iter().cloned(), &part, part.options());
            check(&report, &path, &part)?;
            let loss = report.duration / best.duration - 1.0;
            prop_assert!(loss.abs() <= 3e-4, "{loss:e} with {horizon} s of {} s", best.duration);
        }
    }
}

/// Lines of any length with blends between them, which have to be known twice as far as their horizon once cells are cut: what is
/// planned begins where the last window ended.
#[test]
fn nothing_is_lost_where_cells_become_shorter() {
    let step = Step::new;
    let steps = [
        step(Form::Line, false, 2.984e-3, [-0.6479, -0.9123, -0.2609], 0.01662, [5.248, 1.81]),
        step(Form::Line, false, 5.346e-4, [0.7787, 0.1237, 0.1458], 0.01028, [0.2315, 1.093]),
        step(Form::Line, false, 1.897e-5, [0.9141, 0.1477, 0.1866], 0.01355, [1.584, 2.144]),
        step(Form::Line, true, 4.331e-4, [0.9733, -0.695, -0.1304], 0.1724, [2.931, 0.5947]),
        step(Form::Line, false, 2.351e-3, [-0.8269, -0.1303, 0.2161], 0.1333, [0.2357, 0.4277]),
        step(Form::Line, false, 4.794e-3, [0.3459, -0.5854, -0.2659], 0.4208, [3.955, 1.081]),
        step(Form::Line, false, 0.03855, [-0.2522, -0.5893, 0.1863], 0.3241, [0.9262, 0.2121]),
        step(Form::Line, false, 5.494e-5, [-0.7047, -0.7511, 0.0], 5.352e-3, [0.3234, 0.7808]),
        step(
            Form::Arc { plane: Plane::Xy, sweep: -5.584, rise: 0.0 },
            true,
            7.226e-3,
            [0.423, -0.3567, 0.0],
            0.2707,
            [3.195, 0.2604],
        ),
        step(Form::Line, true, 1.051e-5, [0.198, 0.7363, -0.01225], 0.1687, [11.34, 6.879]),
    ];
    let path = walk(&steps, Machine::Gantry3);
    let settings = Settings {
        machine: Machine::Gantry3,
        jerk: true,
        tolerance: 9.186e-5,
        angle: PI,
        horizon: 0.6,
    };
    let report = run(path.iter().cloned(), &settings, settings.options());
    assert_eq!(report.lines, (1..=10).collect::<Vec<u32>>());
    check(&report, &path, &settings).expect("limits that are kept");
}
