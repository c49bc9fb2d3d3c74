//! Tests of profiles with closed forms, as tables, pictures and summaries.

use super::*;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile, ProgramItem};
use crate::setpoint::Transformer;
use std::path::{Path, PathBuf};
use twin_kinematics::AxisVector;
use twin_machine::Machine;
use twin_path::Place;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// X: 400 mm/s, 3000 mm/s². Its jerk is limited here, too.
fn gantry() -> Machine {
    let text = std::fs::read_to_string(root().join("tests/data/machines/gantry3.toml")).unwrap();
    let mut machine = Machine::parse(Path::new("gantry3.toml"), &text).unwrap();
    for axis in &mut machine.axes {
        axis.max_jerk = Some(100.0);
    }
    machine
}

fn scara() -> Machine {
    Machine::load(&root().join("tests/data/machines/scara2.toml")).unwrap()
}

fn program(name: &str) -> ProgramFile {
    let path = root().join("examples").join(name);
    ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap()
}

fn vector(machine: &Machine, values: &[f64]) -> AxisVector {
    let mut vector = AxisVector::zeros(machine.axes.len());
    vector.iter_mut().zip(values).for_each(|(slot, value)| *slot = *value);
    vector
}

/// At rest at the start of line 10 (N100).
fn rest(machine: &Machine) -> ProfileSample {
    let zero = vector(machine, &[]);
    ProfileSample {
        time_ns: 0,
        place: Place { block: Some(100), ..Place::at(10) },
        way: 0.0,
        feed: 0.1,
        path_velocity: 0.0,
        path_acceleration: 0.0,
        path_jerk: 0.0,
        position: zero,
        velocity: zero,
        acceleration: zero,
        jerk: zero,
        effort: None,
        binding: None,
    }
}

const FEED: f64 = 0.1;
const ACCELERATION: f64 = 0.5;
const LENGTH: f64 = 0.2;

/// From rest to rest along X, 200 mm with F100 and E500: 0.2 s faster and faster, 1.8 s with F, 0.2 s slower and slower.
/// Line 10 is the first half of the way.
fn trapezoid(machine: &Machine) -> Vec<ProfileSample> {
    let ramp = FEED / ACCELERATION;
    let end = LENGTH / FEED + ramp;
    (0..=2_200_i32)
        .map(|ms| {
            let time = f64::from(ms) * 1e-3;
            let left = end - time;
            let (way, velocity, acceleration, binding) = if time < ramp {
                let way = ACCELERATION * time * time / 2.0;
                (way, ACCELERATION * time, ACCELERATION, Binding::PathAcceleration)
            } else if left <= ramp {
                let way = LENGTH - ACCELERATION * left * left / 2.0;
                let limit = Binding::Axis { axis: 0, quantity: Quantity::Acceleration };
                (way, ACCELERATION * left, -ACCELERATION, limit)
            } else {
                (FEED * (time - ramp / 2.0), FEED, 0.0, Binding::Feed)
            };
            let (line, block) = if way < LENGTH / 2.0 { (10, 100) } else { (11, 110) };
            ProfileSample {
                time_ns: i64::from(ms) * 1_000_000,
                place: Place { block: Some(block), ..Place::at(line) },
                way,
                path_velocity: velocity,
                path_acceleration: acceleration,
                position: vector(machine, &[way]),
                velocity: vector(machine, &[velocity]),
                acceleration: vector(machine, &[acceleration]),
                jerk: vector(machine, &[0.0, 0.0, if ms == 1000 { -25.0 } else { 0.0 }]),
                binding: Some(binding),
                ..rest(machine)
            }
        })
        .collect()
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected}");
}

fn summary_of(machine: &Machine, samples: &[ProfileSample]) -> LimitSummary {
    let mut summing = Summing::new(&machine.axes);
    for sample in samples {
        summing.include(sample);
    }
    let windows = Windows { count: 3, failed: 1, exceeded: 2 };
    summing.finish(windows, |line| (line == 11).then_some(0.08))
}

/// Each ramp takes F/a and loses half of it.
#[test]
fn a_summary_against_the_closed_form() {
    let machine = gantry();
    let summary = summary_of(&machine, &trapezoid(&machine));
    near(summary.duration_s, 2.2, 1e-12);
    near(summary.duration_by_feed_s, 2.0, 1e-9);
    near(summary.length, LENGTH, 1e-12);
    let share = |binding| {
        let share = summary.limited_by.iter().find(|share| share.binding == Some(binding));
        share.map(|share| (share.time_s, share.lost_s)).unwrap()
    };
    let axis = Binding::Axis { axis: 0, quantity: Quantity::Acceleration };
    for (binding, time, lost) in
        [(Binding::PathAcceleration, 0.2, 0.1), (axis, 0.2, 0.1), (Binding::Feed, 1.8, 0.0)]
    {
        let (found_time, found_lost) = share(binding);
        near(found_time, time, 2e-3);
        near(found_lost, lost, 1e-3);
    }
    let lost: f64 = summary.limited_by.iter().map(|share| share.lost_s).sum();
    near(lost, summary.duration_s - summary.duration_by_feed_s, 1e-12);
    assert_eq!(summary.limited_by.last().unwrap().binding, Some(Binding::Feed));
    // Both lines lose the same, by their own limits.
    let lines: Vec<_> = summary.lines.iter().map(|line| (line.place.line, line.binding)).collect();
    assert!(lines.contains(&(10, Some(Binding::PathAcceleration))), "{lines:?}");
    assert!(lines.contains(&(11, Some(axis))) && lines.len() == 2, "{lines:?}");
    for line in &summary.lines {
        near(line.time_s, 1.1, 2e-3);
        near(line.lost_s, 0.1, 1e-3);
        near(line.programmed, FEED, 0.0);
        assert_eq!(line.allowed, (line.place.line == 11).then_some(0.08));
    }
    let [x, y, z] = &summary.peaks[..] else { panic!("three axes") };
    near(x.velocity.value, FEED, 1e-12);
    near(x.acceleration.value, ACCELERATION, 0.0);
    assert_eq!((x.velocity.place.line, y.velocity.value.to_bits()), (10, 0));
    assert_eq!((z.jerk.value.to_bits(), z.jerk.place.line), (25_f64.to_bits(), 10));
    assert_eq!(x.position, Some([0.0, LENGTH]));
}

/// Standing for M functions and dwells is nothing that a feed would win.
#[test]
fn waiting_loses_nothing() {
    let machine = gantry();
    let wait = ProfileSample { feed: 0.0, binding: Some(Binding::Stop), ..rest(&machine) };
    let summary = summary_of(&machine, &[wait, ProfileSample { time_ns: 5_000_000_000, ..wait }]);
    near(summary.duration_by_feed_s, 5.0, 1e-12);
    near(summary.limited_by[0].lost_s, 0.0, 1e-12);
    assert!(summary.lines.is_empty());
    assert_eq!(
        summary_of(&machine, &[]),
        LimitSummary {
            peaks: vec![crate::peak::AxisPeak::default(); 3],
            windows: Windows { count: 3, failed: 1, exceeded: 2 },
            override_factor: 1.0,
            ..LimitSummary::default()
        }
    );
}

/// Of a hundred thousand lines the ten worst, wherever they are. Line n loses (7919 n mod 100003) µs.
#[test]
fn the_worst_of_many_lines_are_found() {
    let machine = gantry();
    let mut summing = Summing::new(&machine.axes);
    let (mut time_ns, mut way) = (0, 0.0);
    let lost = |line: u32| i64::from(line) * 7919 % 100_003;
    for line in 1..=100_002 {
        let place = Place::at(line);
        summing.include(&ProfileSample { time_ns, place, way, ..rest(&machine) });
        way += 1e-3;
        time_ns += 10_000_000 + lost(line) * 1000;
    }
    summing.include(&ProfileSample { time_ns, way, ..rest(&machine) });
    let summary = summing.finish(Windows::default(), |_| None);
    let found: Vec<_> = summary.lines.iter().map(|line| lost(line.place.line)).collect();
    // 7919 is prime to 100003, so that every number below that is lost by one line.
    assert_eq!(found, (99_993..=100_002).rev().collect::<Vec<_>>());
}

#[test]
fn a_table_has_every_number_with_its_unit() {
    let machine = scara();
    let values = |scale: f64| vector(&machine, &[0.1 * scale, -1.0 / 3.0 * scale, 2e-3 * scale]);
    let samples = [
        rest(&machine),
        ProfileSample {
            time_ns: 1_000_000,
            place: Place::at(12),
            way: 0.123_456_789_012,
            path_velocity: 0.05,
            path_acceleration: -0.5,
            path_jerk: 7.0,
            position: values(1.0),
            velocity: values(2.0),
            acceleration: values(-3.0),
            jerk: values(400.0),
            binding: Some(Binding::Axis { axis: 1, quantity: Quantity::Jerk }),
            ..rest(&machine)
        },
    ];
    let mut table = ProfileCsv::new(Vec::new(), &machine.axes, false).unwrap();
    for sample in &samples {
        table.write(sample).unwrap();
    }
    let text = String::from_utf8(table.finish().unwrap()).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next().unwrap(),
        "time_s,line,block,path_mm,feed_mm_per_s,velocity_mm_per_s,acceleration_mm_per_s2,jerk_mm_per_s3,\
         A_deg,A_velocity_deg_per_s,A_acceleration_deg_per_s2,A_jerk_deg_per_s3,\
         B_deg,B_velocity_deg_per_s,B_acceleration_deg_per_s2,B_jerk_deg_per_s3,\
         Z_mm,Z_velocity_mm_per_s,Z_acceleration_mm_per_s2,Z_jerk_mm_per_s3,limited_by,limited_by_axis"
    );
    assert_eq!(lines.next().unwrap(), "0,10,100,0,100,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,,");
    let fields: Vec<_> = lines.next().unwrap().split(',').collect();
    assert_eq!(fields[..8], ["0.001", "12", "", "123.456789012", "100", "50", "-500", "7000"]);
    assert_eq!(fields[20..], ["axis-jerk", "B"]);
    let degrees = |radians: f64| radians * 180.0 / std::f64::consts::PI;
    let expected = [
        degrees(0.1),
        degrees(0.2),
        degrees(-0.3),
        degrees(40.0),
        degrees(-1.0 / 3.0),
        degrees(-2.0 / 3.0),
        degrees(1.0),
        degrees(-400.0 / 3.0),
        2.0,
        4.0,
        -6.0,
        800.0,
    ];
    for (field, expected) in fields[8..20].iter().zip(expected) {
        near(field.parse().unwrap(), expected, expected.abs() * 1e-11);
    }
    assert!(lines.next().is_none());
}

#[test]
fn names_with_commas_stay_one_column() {
    let mut machine = gantry();
    machine.axes[0].name = "X, \"long\"".to_owned();
    let mut table = ProfileCsv::new(Vec::new(), &machine.axes, false).unwrap();
    table.write(&rest(&machine)).unwrap();
    let text = table.finish().unwrap();
    let mut reader = ::csv::Reader::from_reader(text.as_slice());
    assert_eq!(reader.headers().unwrap().get(8), Some("X, \"long\"_mm"));
    assert_eq!(reader.records().next().unwrap().unwrap().len(), 8 + 3 * 4 + 2);
}

#[test]
fn a_summary_in_words() {
    let machine = gantry();
    let summary = summary_of(&machine, &trapezoid(&machine));
    let mut out = Vec::new();
    write_summary(&mut out, &machine, &program("plate.cnc"), &summary).unwrap();
    let text = String::from_utf8(out).unwrap();
    for words in [
        "plate.cnc (din66025) on gantry3: 200.0 mm in 2.200 s; with the programmed feed alone 2.000 s (+10.0 %)",
        // 100 of 400 mm/s, 500 of 3000 mm/s², 25 000 of 100 000 mm/s³.
        "100 mm/s",
        "25.0 %",
        "16.7 %",
        "25000 mm/s³",
        "10 (N100)",
        "programmed acceleration (E)",
        "acceleration of X",
        "80 mm/s",
        "in 1 of 3 windows the solver failed",
        "in 2 of 3 windows a limit is slightly exceeded",
    ] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}

#[test]
fn a_summary_for_programs() {
    let machine = gantry();
    let summary = summary_of(&machine, &trapezoid(&machine));
    let report = LimitReport::new(&machine, &program("plate.cnc"), &summary);
    let value = serde_json::to_value(&report).unwrap();
    let number = |pointer: &str| value.pointer(pointer).and_then(serde_json::Value::as_f64);
    for (pointer, expected) in [
        ("/length_mm", 200.0),
        ("/duration_s", 2.2),
        ("/duration_by_feed_s", 2.0),
        ("/peak/X/velocity/value", 100.0),
        ("/peak/X/velocity/limit", 400.0),
        ("/peak/X/acceleration/value", 500.0),
        ("/peak/Z/jerk/value", 25_000.0),
        ("/peak/Z/jerk/limit", 100_000.0),
        ("/peak/Z/jerk/line", 10.0),
        ("/slowest_lines/0/programmed_feed_mm_per_s", 100.0),
        ("/windows", 3.0),
        ("/windows_failed", 1.0),
        ("/windows_exceeded", 2.0),
    ] {
        near(number(pointer).unwrap_or_else(|| panic!("{pointer}: {value}")), expected, 1e-6);
    }
    assert_eq!(value["dialect"], "din66025");
    let limits: Vec<_> = (0..3)
        .map(|index| {
            let share = &value["limited_by"][index];
            (share["limit"].as_str().unwrap(), share["axis"].as_str())
        })
        .collect();
    for limit in [("path-acceleration", None), ("axis-acceleration", Some("X")), ("feed", None)] {
        assert!(limits.contains(&limit), "{limits:?}");
    }
    let line = value["slowest_lines"].as_array().unwrap();
    let line = line.iter().find(|line| line["line"] == 11).unwrap();
    assert_eq!((&line["block"], &line["largest_feed_mm_per_s"]), (&110.into(), &80.0.into()));
}

fn picture_of(machine: &Machine, samples: &[ProfileSample]) -> String {
    let mut picture = Picture::new(&machine.axes, false);
    for sample in samples {
        picture.include(sample);
    }
    picture.draw("part.cnc", &machine.name)
}

/// The points of the first line of this colour with many points.
fn points(text: &str, color: &str) -> Vec<(f64, f64)> {
    let is_it = |line: &&str| line.starts_with("<polyline") && line.contains(color);
    let curves = text.lines().filter(is_it).map(|line| {
        let (_, points) = line.split_once("points=\"").unwrap();
        let points = points.split('"').next().unwrap().split_whitespace();
        let point = |point: &str| {
            let (x, y) = point.split_once(',').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        };
        points.map(point).collect::<Vec<(f64, f64)>>()
    });
    curves.max_by_key(Vec::len).unwrap()
}

#[test]
fn a_picture_names_what_it_shows() {
    let machine = gantry();
    let text = picture_of(&machine, &trapezoid(&machine));
    for words in [
        "part.cnc on gantry3",
        "2.2 s, 200 mm; at most 25.0 % of a limit: velocity of X in line 10 (N100)",
        "path velocity",
        "acceleration",
        "(% of limit)",
        "time (s)",
        "at most 100 mm/s",
        "line 10 (N100)",
        "X: 25.0 %, 100",
        "Z: 25.0 %, 25000",
        "line of the program",
        "axis Y",
        "programmed feed (F)",
        "programmed acceleration (E)",
    ] {
        assert!(text.contains(words), "{words}");
    }
    assert!(!text.contains("tool tip") && !text.contains("NaN") && !text.contains("inf"));
    // Without a jerk limit the row is missing.
    let text = picture_of(&scara(), &[rest(&scara())]);
    assert!(text.contains("no axis moves") && !text.contains("jerk"));
    assert!(picture_of(&machine, &[]).contains("part.cnc"));
}

/// The velocity along the path is drawn to scale: its ramps, and the feed between them.
#[test]
fn curves_are_to_scale() {
    let machine = gantry();
    let points = points(&picture_of(&machine, &trapezoid(&machine)), "#22262E");
    let (left, right) = (points[0].0, points.last().unwrap().0);
    let bottom = points.iter().map(|point| point.1).fold(0.0, f64::max);
    let top = points.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
    let at = |time: f64| {
        let x = left + (right - left) * time / 2.2;
        let (before, after) = points
            .windows(2)
            .map(|pair| (pair[0], pair[1]))
            .find(|(before, after)| before.0 <= x && x <= after.0 && before.0 < after.0)
            .unwrap();
        before.1 + (after.1 - before.1) * (x - before.0) / (after.0 - before.0)
    };
    for (time, part) in [(0.0, 0.0), (0.1, 0.5), (0.2, 1.0), (1.3, 1.0), (2.05, 0.75), (2.15, 0.25)]
    {
        near((bottom - at(time)) / (bottom - top), part, 4e-3);
    }
}

/// An axis at its limit is on the line that shows it.
#[test]
fn the_limit_is_where_its_line_is() {
    let machine = gantry();
    let samples: Vec<_> = (0..100_i32)
        .map(|number| ProfileSample {
            time_ns: i64::from(number) * 1_000_000,
            velocity: vector(&machine, &[if number < 50 { 0.4 } else { -0.4 }]),
            ..rest(&machine)
        })
        .collect();
    let text = picture_of(&machine, &samples);
    let curve: Vec<_> = points(&text, "#0072B2").iter().map(|point| point.1).collect();
    let dashes: Vec<_> = text
        .lines()
        .filter(|line| line.starts_with("<line") && line.contains("#D62728"))
        .filter_map(|line| line.split_once("y1=\"")?.1.split('"').next()?.parse().ok())
        .collect();
    for y in curve {
        assert!(dashes.iter().any(|dash: &f64| (dash - y).abs() <= 0.1), "{y} {dashes:?}");
    }
    assert!(text.contains("at most 100.0 % of a limit"));
}

/// Hours at 1 kHz fit a page.
#[test]
fn a_picture_of_hours_is_no_larger() {
    let machine = gantry();
    let mut picture = Picture::new(&machine.axes, false);
    for number in 0..400_000_u32 {
        let wave = (f64::from(number) * 0.37).sin();
        picture.include(&ProfileSample {
            time_ns: i64::from(number) * 40_000_000,
            place: Place::at(number),
            path_velocity: 0.05 + 0.05 * wave,
            velocity: vector(&machine, &[0.4 * wave, 0.2 * wave, 0.1]),
            acceleration: vector(&machine, &[wave, -wave, 0.0]),
            jerk: vector(&machine, &[50.0 * wave, 0.0, wave]),
            ..rest(&machine)
        });
    }
    let text = picture.draw("long.cnc", "gantry3");
    assert!(text.len() < 1_500_000, "{} bytes", text.len());
    assert!(text.contains("time (min)"));
}

/// The profile of a program as it runs today, jerk by differences.
#[test]
fn a_program_through_all_outputs() {
    let machine = scara();
    let file = program("plate.cnc");
    let mut transformer = Transformer::new(&machine);
    let mut samples: Vec<ProfileSample> = Vec::new();
    let mut way = 0.0;
    for item in file.open(&machine, crate::m_function::Acknowledgement::default()).unwrap() {
        let ProgramItem::Setpoint(tool) = item else { continue };
        let setpoint = transformer.axes(&tool, None).unwrap();
        let before = samples.last();
        let acceleration = setpoint.axes.acceleration;
        let change = |before: &ProfileSample| {
            let pairs = acceleration.iter().zip(before.acceleration.iter());
            AxisVector::from_values(pairs.map(|(now, before)| (now - before) * 1e3))
        };
        way += setpoint.path_velocity * 1e-3;
        samples.push(ProfileSample {
            time_ns: setpoint.time_ns,
            place: setpoint.place,
            way,
            feed: tool.feed,
            path_velocity: setpoint.path_velocity,
            path_acceleration: before
                .map_or(0.0, |b| (setpoint.path_velocity - b.path_velocity) * 1e3),
            path_jerk: 0.0,
            position: setpoint.axes.position,
            velocity: setpoint.axes.velocity,
            acceleration,
            jerk: before.map_or_else(|| AxisVector::zeros(3), change),
            effort: None,
            binding: Some(if setpoint.path_velocity >= tool.feed * 0.999 {
                Binding::Feed
            } else {
                Binding::PathAcceleration
            }),
        });
    }
    assert!(samples.len() > 1000);
    let summary = summary_of(&machine, &samples);
    assert!(summary.duration_s > summary.duration_by_feed_s);
    let text = picture_of(&machine, &samples);
    assert!(text.contains("velocity of") || text.contains("acceleration of"));
}
