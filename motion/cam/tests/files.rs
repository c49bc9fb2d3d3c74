//! Cams in files: damaged ones are found, whole ones come back as they were.

use super::{curve, knots};
use crate::cam::file::{
    AsciiError, Beside, CamReadError, CamWriteError, MAX_ELEMENTS, TextError, clean, read,
    read_ascii, read_beside, read_knots, read_text, reduce, write, write_ascii, write_beside,
    write_text,
};
use crate::cam::{
    Action, Cam, CamError, CamInput, Compile, Element, Equidistant, Interpolation, Kind, Knot,
    PairTable, Passage, Scale, Shape, Source, StartMode, TableScale, Tappet, VariableType,
};
use proptest::prelude::*;

fn shapes() -> [Shape; 3] {
    let slave = TableScale { min: 0.0, max: 360.0, table_min: 0.0, table_max: 65_536.0 };
    let (variable, interpolation) = (VariableType::Uint, Interpolation::Cubic);
    [
        Shape::Polynomial(vec![
            Knot { master: -1.5, slave: 0.1, velocity: -0.25, acceleration: 1e-300 },
            Knot::at_rest(100.0, 50.0),
            Knot::at_rest(360.0, -0.0),
        ]),
        Shape::Equidistant(Equidistant {
            variable,
            start: 0.0,
            end: 360.0,
            periodic: true,
            slave,
            interpolation,
            values: vec![0.0, 16_384.0, 65_535.0],
        }),
        Shape::Pairs(PairTable {
            variable,
            master: slave,
            slave,
            periodic: false,
            interpolation: Interpolation::Linear,
            pairs: vec![[0.0, 7.0], [16_384.0, 32_768.0], [65_535.0, 0.0]],
        }),
    ]
}

fn tappets() -> Vec<Tappet> {
    let timed = Action::Timed { delay_ns: 1_500_250, duration_ns: 3_000_000 };
    let tappet = |group, master, passage, action| Tappet { group, master, passage, action };
    vec![
        tappet(1, 5.0, Passage::Positive, Action::On),
        tappet(-7, 10.0, Passage::Negative, Action::Off),
        tappet(i16::MAX, 20.0, Passage::Every, Action::Invert),
        tappet(2, 30.0, Passage::Every, timed),
    ]
}

fn cams() -> Vec<Cam> {
    shapes().map(|shape| Cam::new("Hub à 5 mm", shape, tappets()).expect("a cam")).into()
}

fn bytes(cam: &Cam) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(cam, &mut bytes).expect("written");
    bytes
}

#[test]
fn cams_come_back() {
    for cam in cams() {
        assert_eq!(read(bytes(&cam).as_slice()).expect("a cam"), cam);
    }
}

/// Everything that TOML knows: a line, units, period, coupling; and a table's.
fn besides() -> Vec<(Cam, Beside)> {
    let mut source = Source::new("lift");
    source.slave.unit = "mm".to_owned();
    source.period = Some(100.0);
    source.insert_point(0.0, 0.0);
    source.insert_line([100.0, 40.0], [200.0, 90.0]);
    source.insert_point(360.0, 0.0);
    let cam = source.compile(Compile::Polynomial).expect("a cam");
    let input = CamInput {
        master_offset: -12.5,
        slave_scaling: 0.3,
        start_mode: StartMode::RampInNegative,
        velocity_difference: 7.0,
        tappet_dead_time_s: -0.004,
        ..CamInput::default()
    };
    let of_source = Beside {
        kind: source.kind,
        master: source.master.clone(),
        slave: source.slave.clone(),
        period: source.period,
        repeated: true,
        elements: Some(source.elements.clone()),
        input,
        wanted: Some([1.0, 2.0, 3.0, 4.0]),
    };
    let of_table =
        Beside { period: None, repeated: false, elements: None, wanted: None, ..of_source.clone() };
    vec![(cam, of_source), (cams()[1].clone(), of_table)]
}

fn bytes_beside(cam: &Cam, beside: &Beside) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_beside(cam, beside, &mut bytes).expect("written");
    bytes
}

/// Version 1.1 holds what stands beside the cam; files of version 1.0 are read as ever, byte for byte what they were.
#[test]
fn what_stands_beside_comes_back() {
    for (cam, beside) in besides() {
        let whole = bytes_beside(&cam, &beside);
        assert_eq!(&whole[8..10], [1, 3]);
        let found = read_beside(whole.as_slice()).expect("a cam");
        assert_eq!(found, (cam.clone(), Some(beside)));
        // Who asks for the cam alone gets it.
        assert_eq!(read(whole.as_slice()).expect("a cam"), cam);
        let old = bytes(&cam);
        assert_eq!(&old[8..10], [1, 0]);
        assert_eq!(read_beside(old.as_slice()).expect("a cam"), (cam, None));
        for length in 0..whole.len() {
            let error = read_beside(&whole[..length]).expect_err("cut");
            assert!(matches!(error, CamReadError::Truncated { .. }), "{length}: {error}");
        }
        for bit in 0..whole.len() * 8 {
            let mut damaged = whole.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(read_beside(damaged.as_slice()).is_err(), "bit {bit}");
        }
    }
}

/// Elements of another curve, and numbers that cannot be, with right checksums.
#[test]
fn nonsense_beside_a_cam_is_refused() {
    let (cam, beside) = besides().swap_remove(0);
    let refused = |beside: Beside| {
        read_beside(bytes_beside(&cam, &beside).as_slice()).expect_err("nonsense").to_string()
    };
    let mut other = beside.clone();
    other.elements.as_mut().expect("elements")[1] =
        Element::Line { from: [100.0, 40.0], to: [200.0, 91.0] };
    assert!(refused(other).contains("are not those of the cam"));
    let mut other = beside.clone();
    other.input.slave_scaling = 0.0;
    assert!(refused(other).contains("0 stands as scaling"));
    let mut other = beside.clone();
    other.input.acceleration = -1.0;
    assert!(refused(other).contains("-1 stands as input of MC_CamIn"));
    let mut other = beside.clone();
    other.master.max = other.master.min;
    assert!(refused(other).contains("end of a scale"));
    let other = Beside { period: Some(f64::NAN), ..beside };
    assert!(refused(other).contains("period"));
}

/// 0.1 · 3 is 0.30000000000000004; a third stays a third.
#[test]
fn numbers_are_clean() {
    assert_eq!(clean(0.1 * 3.0).to_bits(), 0.3_f64.to_bits());
    assert_eq!(clean(10.351_562_500_000_002).to_string(), "10.3515625");
    for value in [1.0 / 3.0, 0.0, -2.5e-300, 1e300 / 7.0, 0.123_456_789_012_3] {
        assert_eq!(clean(value).to_bits(), value.to_bits());
    }
}

/// 2203 for another version, 2204 for a file that ends too early (`SMC_ReadCAM`, manual 9.3).
#[test]
fn damaged_files_have_the_manuals_numbers() {
    let whole = bytes(&cams()[0]);
    let mut newer = whole.clone();
    newer[8] += 1;
    for (bytes, number) in [(&newer[..], 2203), (&whole[..whole.len() - 1], 2204)] {
        let error = read(bytes).expect_err("damaged");
        assert_eq!(error.number(), Some(number));
        assert!(error.to_string().ends_with(&format!("(error {number})")), "{error}");
    }
    let mut spoilt = whole;
    spoilt[20] ^= 1;
    assert_eq!(read(spoilt.as_slice()).expect_err("damaged").number(), None);
}

#[test]
fn every_truncation_and_every_addition_is_found() {
    for cam in cams() {
        let whole = bytes(&cam);
        for length in 0..whole.len() {
            let error = read(&whole[..length]).expect_err("cut");
            let is_cut =
                matches!(error, CamReadError::Truncated { offset } if offset == length as u64);
            assert!(is_cut, "{length}: {error}");
        }
        let mut more = whole.clone();
        more.push(0);
        let end = whole.len() as u64;
        assert!(
            matches!(read(more.as_slice()), Err(CamReadError::Trailing { offset }) if offset == end)
        );
    }
}

#[test]
fn every_flipped_bit_is_found() {
    for cam in cams() {
        let whole = bytes(&cam);
        for bit in 0..whole.len() * 8 {
            let mut damaged = whole.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let error = read(damaged.as_slice()).expect_err("damaged");
            let expected = match bit / 8 {
                0..8 => {
                    matches!(error, CamReadError::NotACam { offset } if offset == (bit / 8) as u64)
                }
                8..10 => matches!(error, CamReadError::Version { .. }),
                10..20 => matches!(error, CamReadError::Checksum { offset: 16 }),
                _ => matches!(error, CamReadError::Checksum { .. }),
            };
            assert!(expected, "bit {bit}: {error}");
        }
    }
}

/// Whole files of our own that say nonsense: with the right checksums.
#[test]
fn sealed_nonsense_is_refused() {
    let whole = bytes(&cams()[1]);
    let sealed = |at: usize, value: &[u8]| {
        let mut bytes = whole.clone();
        bytes[at..at + value.len()].copy_from_slice(value);
        let end = bytes.len() - 4;
        let sum = crc32fast::hash(&bytes[20..end]);
        bytes[end..].copy_from_slice(&sum.to_le_bytes());
        let sum = crc32fast::hash(&bytes[..16]);
        bytes[16..20].copy_from_slice(&sum.to_le_bytes());
        read(bytes.as_slice()).expect_err("nonsense")
    };
    let unknown = |error, at, name| matches!(error, CamReadError::Unknown { offset, field, .. } if offset == at && field == name);
    // 2202, another way to compile cams than the manual's (`SMC_ReadCAM`, manual 9.3).
    for value in [0, 4, 9] {
        let error = sealed(10, &[value]);
        assert!(
            matches!(error, CamReadError::CompileType { offset: 10, value: it } if it == value)
        );
        assert_eq!(error.number(), Some(2202));
        assert!(error.to_string().ends_with("(error 2202)"), "{error}");
    }
    assert!(unknown(sealed(11, &[2]), 11, "flags"));
    // The name has 11 bytes, so the type of variables stands at 35.
    assert!(unknown(sealed(35, &[7]), 35, "type of variables"));
    assert!(unknown(sealed(36, &[2]), 36, "interpolation"));
    assert!(unknown(sealed(24, &[0xff]), 24, "UTF-8"));
    let many = (MAX_ELEMENTS + 1).to_le_bytes();
    let error = sealed(37 + 6 * 8, &many);
    assert!(matches!(error, CamReadError::TooMany { field: "values", .. }), "{error}");
    assert_eq!(error.number(), Some(2201));
    let error = sealed(37 + 6 * 8, &1000_u32.to_le_bytes());
    assert!(
        matches!(error, CamReadError::Truncated { .. } | CamReadError::TooMany { .. }),
        "{error}"
    );
    let error = sealed(37, &f64::NAN.to_le_bytes());
    assert!(matches!(error, CamReadError::Cam(CamError::NotAscending { .. })), "{error}");
    let error = sealed(12, &u32::MAX.to_le_bytes());
    assert!(matches!(error, CamReadError::TooMany { offset: 12, .. }), "{error}");
}

#[test]
fn names_have_a_limit() {
    let cam = Cam::new(&"x".repeat(256), shapes()[0].clone(), Vec::new()).expect("a cam");
    let error = write(&cam, Vec::new()).expect_err("too long");
    assert!(matches!(error, CamWriteError::TooMany { value: 256, limit: 255, .. }), "{error}");
}

#[test]
fn tables_as_text() {
    let curve = curve(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(128.0, 100.0)]);
    let mut text = Vec::new();
    write_ascii(&curve, 5, &mut text).expect("written");
    let text = String::from_utf8(text).expect("text");
    assert_eq!(text, "0;0\r\n32;10.3515625\r\n64;50\r\n96;89.6484375\r\n128;100\r\n");
    let points = read_ascii(text.as_bytes()).expect("points");
    assert_eq!((points.len(), points[1]), (5, [32.0, 10.351_562_5]));
    // Both separators, a decimal comma, remarks, any order.
    let mixed = "\u{feff}# table\n10:1,5\n\n -2.5 ; 3e0 \r\n";
    assert_eq!(read_ascii(mixed.as_bytes()).expect("points"), [[-2.5, 3.0], [10.0, 1.5]]);
    let knots = read_knots("0;0;0;0\n10;5;0.5;-1".as_bytes()).expect("points");
    let end = Knot { master: 10.0, slave: 5.0, velocity: 0.5, acceleration: -1.0 };
    assert_eq!(knots, [Knot::at_rest(0.0, 0.0), end]);
}

#[test]
fn tables_say_where_they_are_wrong() {
    for (text, message) in [
        ("0;0\n1;2;3", "line 2: 3 columns instead of 2"),
        ("0;0\n\n1;two", "line 3: slave `two` is no number"),
        ("inf;0\n1;1", "line 1: master `inf` is no number"),
        ("5;0\n1;1\n5;2", "line 3: master 5 stands in line 1 already"),
        ("5;0", "a table needs 2 points, there are 1"),
    ] {
        let error = read_ascii(text.as_bytes()).expect_err(message);
        assert_eq!(error.to_string(), message);
    }
    let long = "1".repeat(2000);
    let error = read_ascii(long.as_bytes()).expect_err("long");
    assert!(matches!(error, AsciiError::TooLong { line: 1, what: "bytes", limit: 1000 }));
}

#[test]
fn lines_need_two_points() {
    let points: Vec<_> = (0..=100_i32).map(|i| [f64::from(i), f64::from(i) * 0.1]).collect();
    assert_eq!(reduce(&points, 1e-9), [points[0], points[100]]);
    // A roof needs its ridge.
    let roof: Vec<_> = (0..=100_i32).map(|i| [f64::from(i), f64::from((i - 50).abs())]).collect();
    assert_eq!(reduce(&roof, 1e-9), [roof[0], roof[50], roof[100]]);
    assert_eq!(reduce(&roof, 50.0).len(), 2);
    assert_eq!(reduce(&roof[..1], 1.0), roof[..1]);
    assert!(reduce(&[], 1.0).is_empty());
    // A parabola 1/2·x² between points w apart is missed by w²/8: 1 u for 0.125.
    let parabola: Vec<_> =
        (0..=1000_i32).map(|i| f64::from(i) / 100.0).map(|x| [x, x * x / 2.0]).collect();
    assert_eq!(reduce(&parabola, 0.125).len(), 11);
}

proptest! {
    #[test]
    fn reduced_tables_keep_their_tolerance(steps in prop::collection::vec((0.01..5.0_f64, -3.0..3.0_f64), 2..200), tolerance in 0.0..5.0_f64) {
        let mut at = [0.0, 0.0];
        let points: Vec<_> = steps.iter().map(|(dx, dy)| { at = [at[0] + dx, at[1] + dy]; at }).collect();
        let kept = reduce(&points, tolerance);
        prop_assert_eq!((kept.first(), kept.last()), (points.first(), points.last()));
        for point in &points {
            let index = kept.partition_point(|kept| kept[0] <= point[0]).clamp(1, kept.len() - 1);
            let [a, b] = [kept[index - 1], kept[index]];
            let on_line = a[1] + (b[1] - a[1]) / (b[0] - a[0]) * (point[0] - a[0]);
            prop_assert!((on_line - point[1]).abs() <= tolerance + 1e-12);
        }
    }

    #[test]
    fn any_curve_comes_back(knots in knots()) {
        let cam = Cam::new("any", Shape::Polynomial(knots), Vec::new()).expect("a cam");
        prop_assert_eq!(read(bytes(&cam).as_slice()).expect("a cam"), cam);
    }

    #[test]
    fn any_bytes_and_any_text_end(noise in prop::collection::vec(any::<u8>(), 0..200), text in ".{0,200}") {
        let _cam = read(noise.as_slice());
        let _points = read_ascii(noise.as_slice());
        let _source = read_text(&text);
    }
}

const BY_HAND: &str = "\
cam lift                     # its name
master 0 360 step 20 unit °
slave 0 100 step 10 unit mm
period 360
point 0 0
line 60 20 120 70
point 200 90 v 0.5 a 0.01
tappet 1 at 45 positive on
tappet 2 at 60 every timed delay_us 1500.25 duration_us 3000
tappet -3 at 0 negative invert
";

#[test]
fn a_cam_by_hand() {
    let source = read_text(BY_HAND).expect("a cam");
    assert_eq!(
        (source.name.as_str(), source.kind, source.period),
        ("lift", Kind::Cam, Some(360.0))
    );
    let scale = Scale { min: 0.0, max: 360.0, step: 20.0, unit: "°".to_owned() };
    assert_eq!(source.master, scale);
    let point = Knot { master: 200.0, slave: 90.0, velocity: 0.5, acceleration: 0.01 };
    let line = Element::Line { from: [60.0, 20.0], to: [120.0, 70.0] };
    assert_eq!(
        source.elements,
        [Element::Point(Knot::at_rest(0.0, 0.0)), line, Element::Point(point)]
    );
    let timed = Action::Timed { delay_ns: 1_500_250, duration_ns: 3_000_000 };
    let found: Vec<_> = source.tappets.iter().map(|t| (t.group, t.passage, t.action)).collect();
    let expected = [
        (-3, Passage::Negative, Action::Invert),
        (1, Passage::Positive, Action::On),
        (2, Passage::Every, timed),
    ];
    assert_eq!(found, expected);
    assert_eq!(read_text(&write_text(&source)).expect("a cam"), source);
    let cam = source.compile(Compile::Polynomial).expect("a cam");
    assert_eq!((cam.curve().at(90.0).position, cam.tappets().len()), (45.0, 3));
}

#[test]
fn tappets_by_hand() {
    let source = read_text("tappets gate\nmaster 0 10\ntappet 1 at 10 every off").expect("tappets");
    assert_eq!((source.kind, source.tappets.len()), (Kind::Tappets, 1));
    assert_eq!(read_text(&write_text(&source)).expect("tappets"), source);
}

#[test]
fn lines_by_hand_say_what_is_wrong() {
    let with = |line: &str| {
        let text = format!("cam x\nmaster 0 360\nslave 0 1\n{line}\n");
        read_text(&text).expect_err(line).to_string()
    };
    for (line, message) in [
        (
            "pont 1 2",
            "line 4: `pont` is not one of cam, tappets, master, slave, period, point, line, tappet",
        ),
        ("point 1", "line 4: `point` needs slave"),
        ("point 1 x", "line 4: `point`: `x` is not a number"),
        ("point 1 nan", "line 4: `point`: `nan` is not a number"),
        ("point 400 1", "line 4: `point`: master 400 is not from 0 to 360"),
        ("point 1 1 w 3", "line 4: `point`: `w` is not a name of a number"),
        ("line 5 0 5 1", "line 4: `line`: end of the master 5 is not greater than 5"),
        ("period -1", "line 4: `period`: period -1 is not greater than 0"),
        ("master 0 1", "line 4: `master` stands twice"),
        (
            "tappet 99999 at 1 every on",
            "line 4: `tappet`: `99999` is not a group of -32768 to 32767",
        ),
        (
            "tappet 1 at 1 sideways on",
            "line 4: `tappet`: `sideways` is not positive, negative or every",
        ),
        ("tappet 1 at 1 every timed delay_us 5", "line 4: `tappet` needs duration_us and a number"),
        (
            "tappet 1 at 1 every timed duration_us -5",
            "line 4: `tappet`: duration_us -5 is not from 0 to 86400000000",
        ),
        ("tappet 1 at 361 every on", "line 4: `tappet`: master 361 is not from 0 to 360"),
        (
            "tappet 1 at 1 every on now",
            "line 4: `tappet`: `now` is not expected here: the line should end",
        ),
    ] {
        assert_eq!(with(line), message);
    }
    assert_eq!(read_text("master 0 1"), Err(TextError::NoLine { key: "cam" }));
    assert_eq!(read_text("cam x\nmaster 0 1"), Err(TextError::NoLine { key: "slave" }));
}
