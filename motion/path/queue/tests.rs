//! Tests of queue files: round trips, damage and arbitrary bytes.

use super::*;
use crate::Place;
use crate::{
    Arc, AxisMask, Cubic, Details, ElementKind, Ellipse, ExtraAxes, MParameters, Marks,
    PathElement, Plane, ProbeOutcome, Probing, Shape, Switch, Switches, reversed,
};
use nalgebra::{Point2, Point3, Vector2};
use proptest::prelude::*;
use std::f64::consts::TAU;
use std::io::{self, Cursor};

fn written(elements: &[PathElement]) -> Vec<u8> {
    let mut writer = QueueWriter::new(Vec::new(), Generator::CheckVelocities).unwrap();
    for element in elements {
        writer.write(element).unwrap();
    }
    assert_eq!(writer.elements(), elements.len() as u64);
    writer.finish().unwrap()
}

/// The elements before the first error, and that error.
fn read(bytes: &[u8]) -> (Vec<PathElement>, Option<QueueReadError>) {
    let mut reader = match QueueReader::new(bytes) {
        Ok(reader) => reader,
        Err(error) => return (Vec::new(), Some(error)),
    };
    let mut elements = Vec::new();
    for element in &mut reader {
        match element {
            Ok(element) => elements.push(element),
            Err(error) => {
                assert!(reader.next().is_none());
                return (elements, Some(error));
            }
        }
    }
    assert_eq!(reader.elements(), elements.len() as u64);
    (elements, None)
}

fn coordinate() -> BoxedStrategy<f64> {
    prop_oneof![
        8 => -10.0..10.0,
        1 => Just(-0.0),
        1 => any::<f64>().prop_filter("finite, also doubled", |value| value.abs() < 1e300),
    ]
    .boxed()
}

fn point() -> impl Strategy<Value = Point3<f64>> {
    [coordinate(), coordinate(), coordinate()].prop_map(Point3::from)
}

fn pair() -> impl Strategy<Value = [f64; 2]> {
    [coordinate(), coordinate()]
}

fn four() -> impl Strategy<Value = [f64; 4]> {
    [coordinate(), coordinate(), coordinate(), coordinate()]
}

fn shape() -> impl Strategy<Value = Shape> {
    let plane = prop::sample::select(vec![Plane::Xy, Plane::Zx, Plane::Yz]);
    prop_oneof![
        (point(), point()).prop_map(|(start, end)| Shape::Line { start, end }),
        (plane, point(), point(), point(), coordinate()).prop_map(
            |(plane, start, end, center, sweep)| Shape::Arc(Arc::in_plane(
                plane, start, end, center, sweep
            ))
        ),
        (point(), point(), pair(), pair(), coordinate(), -TAU..TAU).prop_map(
            |(start, end, center, major, minor, sweep)| {
                let (center, major) = (Point2::from(center), Vector2::from(major));
                Shape::Ellipse(Box::new(Ellipse::new(start, end, center, major, minor, sweep)))
            }
        ),
        (four(), four(), coordinate(), coordinate())
            .prop_map(|(x, y, start, end)| Shape::Cubic(Box::new(Cubic::new(x, y, start, end)))),
        (point(), pair(), point()).prop_map(|(start, control, end)| Shape::Cubic(Box::new(
            Cubic::parabola(start, control.into(), end)
        ))),
    ]
}

fn details() -> impl Strategy<Value = Details> {
    let five = || prop::array::uniform5(coordinate());
    let switch = (1..=32_u8, any::<bool>(), 0.0..=1.0).prop_map(|(number, on, at)| Switch {
        number,
        on,
        at,
    });
    let extra =
        prop::option::of((five(), five()).prop_map(|(start, end)| ExtraAxes { start, end }));
    let parameters = (
        prop::option::of(coordinate()),
        prop::option::of(coordinate()),
        prop::option::of(prop::array::uniform8(coordinate())),
    )
        .prop_map(|(k, l, o)| MParameters { k, l, o });
    (extra, any::<u16>(), prop::collection::vec(switch, 0..=3), parameters).prop_map(
        |(extra, s_profile, list, parameters)| {
            let mut switches = Switches::default();
            assert!(list.into_iter().all(|switch| switches.add(switch)));
            Details { extra, s_profile: AxisMask(s_profile), switches, parameters }
        },
    )
}

fn probe() -> impl Strategy<Value = ElementKind> {
    use ProbeOutcome::{NotTripped, Tripped, Unknown};
    let probings =
        [Probing::TOUCH, Probing::TRY_TOUCH, Probing::RELEASE, Probing::TRY_RELEASE].to_vec();
    (prop::sample::select(probings), prop::sample::select(vec![Unknown, Tripped, NotTripped]))
        .prop_map(|(probing, outcome)| ElementKind::Probe { probing, outcome })
}

prop_compose! {
    fn element()(
        line: u32,
        block: Option<u32>,
        kind in prop_oneof![
            Just(ElementKind::Rapid),
            Just(ElementKind::Cut),
            Just(ElementKind::Jump),
            any::<u16>().prop_map(|number| ElementKind::MFunction { number }),
            any::<i64>().prop_map(|time_ns| ElementKind::Dwell { time_ns }),
            probe(),
        ],
        shape in shape(),
        limits in prop::array::uniform5(coordinate()),
        endless: bool,
        marks: u8,
        details in prop::option::of(details()),
    ) -> PathElement {
        let [feed, acceleration, deceleration, end_velocity, tool_radius] = limits;
        let end_velocity = if endless { f64::INFINITY } else { end_velocity };
        PathElement {
            feed,
            acceleration,
            deceleration,
            end_velocity,
            tool_radius,
            marks: Marks(marks),
            details: details.map(Box::new),
            ..PathElement::new(Place { line, block }, kind, shape)
        }
    }
}

/// An element of every shape, with and without details.
fn sample() -> Vec<PathElement> {
    let at = |x: f64, y: f64| Point3::new(x, y, 0.1);
    let shapes = [
        Shape::Line { start: at(0.0, 0.0), end: at(1.0, 0.0) },
        Shape::Arc(Arc::new(at(1.0, 0.0), at(0.0, 1.0), at(0.0, 0.0), TAU / 4.0)),
        Shape::Ellipse(Box::new(Ellipse::new(
            at(0.0, 1.0),
            at(-2.0, 0.0),
            Point2::origin(),
            Vector2::new(2.0, 0.0),
            1.0,
            TAU / 4.0,
        ))),
        Shape::Cubic(Box::new(Cubic::parabola(at(-2.0, 0.0), Point2::origin(), at(0.0, 0.0)))),
    ];
    let place = |line| Place { line, block: Some(10 * line) };
    let mut elements: Vec<_> = (1..)
        .zip(shapes)
        .map(|(line, shape)| PathElement {
            feed: 0.05,
            ..PathElement::new(place(line), ElementKind::Cut, shape)
        })
        .collect();
    let parameters = MParameters { k: Some(1.5), l: None, o: Some([1.0; 8]) };
    elements.push(PathElement {
        details: Some(Box::new(Details { parameters, ..Details::default() })),
        ..PathElement::new(
            place(5),
            ElementKind::MFunction { number: 7 },
            Shape::Line { start: at(0.0, 0.0), end: at(0.0, 0.0) },
        )
    });
    elements
}

/// The layout as the module's page has it, by hand, with checksums of Python's `zlib.crc32`: a queue of one rapid from
/// (1, 0, 0) to (0, 0, 0), line 3, no N word, and nothing set but the end velocity, which is infinite.
#[test]
fn layout() {
    let line = Shape::Line { start: Point3::new(1.0, 0.0, 0.0), end: Point3::origin() };
    let place = Place { line: 3, block: None };
    let bytes = written(&[PathElement::new(place, ElementKind::Rapid, line)]);
    let mut expected = b"\x95TWQ\r\n\x1a\n\x01\x00\xFE\x00".to_vec();
    expected.extend(HEADER_SUM.to_le_bytes());
    expected.extend([b'B', 97, 0, 0, 0]);
    expected.extend([3, 0, 0, 0, 0, 0, 1]);
    expected.extend([0, 0, 0, 0, 0, 0, 0xF0, 0x3F]);
    expected.extend([0; 64]);
    expected.extend([0, 0, 0, 0, 0, 0, 0xF0, 0x7F]);
    expected.extend([0; 10]);
    expected.extend(BLOCK_SUM.to_le_bytes());
    expected.extend([b'E', 1, 0, 0, 0, 0, 0, 0, 0]);
    expected.extend(TOTAL_SUM.to_le_bytes());
    expected.extend(END_SUM.to_le_bytes());
    assert_eq!(bytes, expected);
}
const HEADER_SUM: u32 = 0x9c24_8d54;
const BLOCK_SUM: u32 = 0xa5af_40d1;
const TOTAL_SUM: u32 = 0xc85e_bbdd;
const END_SUM: u32 = 0x98c1_62b8;

/// `SMC_OUTQUEUE.byGenerator` (manual 6.5), and which of them the interpolator takes.
#[test]
fn generators() {
    let numbers = [1, 10, 11, 12, 13, 14, 30, 31, 32, 254, 255];
    for number in 0..=255 {
        let generator = Generator::from_number(number);
        assert_eq!(generator.is_some(), numbers.contains(&number), "{number}");
        let Some(generator) = generator else { continue };
        assert_eq!((generator.number(), generator.is_checked()), (number, number >= 254));
        let file = QueueWriter::new(Vec::new(), generator).unwrap().finish().unwrap();
        assert_eq!(QueueReader::new(file.as_slice()).unwrap().generator(), generator);
    }
}

/// Only elements before the damage may be handed out, and the damage is reported.
#[track_caller]
fn assert_found(bytes: &[u8], what: &dyn std::fmt::Display) {
    let (elements, error) = read(bytes);
    let error = error.unwrap_or_else(|| panic!("{what}: nothing found"));
    assert!(!error.to_string().is_empty());
    assert!(sample().starts_with(&elements), "{what}: {elements:?}");
}

#[test]
fn every_truncation_is_found() {
    let bytes = written(&sample());
    for length in 0..bytes.len() {
        assert_found(&bytes[..length], &length);
        let (_, error) = read(&bytes[..length]);
        let Some(QueueReadError::Truncated(offset)) = error else { panic!("{length}: {error:?}") };
        assert_eq!(offset, length as u64);
    }
}

#[test]
fn every_flipped_bit_is_found() {
    let bytes = written(&sample());
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << bit;
            assert_found(&damaged, &format_args!("bit {bit} of byte {at}"));
        }
    }
}

#[test]
fn every_other_byte_is_found() {
    let bytes = written(&sample()[..1]);
    for at in 0..bytes.len() {
        for value in 0..=255_u8 {
            let mut damaged = bytes.clone();
            if std::mem::replace(&mut damaged[at], value) != value {
                assert_found(&damaged, &format_args!("byte {at} made {value}"));
            }
        }
    }
}

#[test]
fn what_is_wrong_is_named() {
    let bytes = written(&sample());
    let with = |at: usize, new: &[u8]| {
        let mut bytes = bytes.clone();
        bytes.splice(at..at + new.len(), new.iter().copied());
        read(&bytes).1.unwrap()
    };
    assert!(matches!(with(0, b"%"), QueueReadError::NotAQueue(0)));
    assert!(matches!(read(b"% program").1, Some(QueueReadError::NotAQueue(0))));
    assert!(matches!(read(b"\x95T").1, Some(QueueReadError::Truncated(2))));
    assert!(matches!(with(8, &[2, 0]), QueueReadError::Version { version: 2, offset: 8 }));
    assert!(matches!(with(10, &[1]), QueueReadError::Checksum(12)));
    assert!(matches!(with(16, b"X"), QueueReadError::Tag { offset: 16, tag: b'X' }));
    for length in [0, 65_537, u32::MAX] {
        let error = with(17, &length.to_le_bytes());
        let QueueReadError::BlockLength { offset: 17, length: found } = error else {
            panic!("{error:?}")
        };
        assert_eq!(found, length);
    }
    let mut longer = bytes.clone();
    longer.push(0);
    let length = bytes.len() as u64;
    assert!(matches!(read(&longer).1, Some(QueueReadError::Trailing(offset)) if offset == length));
}

/// Blocks that are whole but lost, doubled or exchanged, and an end record of another file.
#[test]
fn blocks_in_the_wrong_place_are_found() {
    let many = |count: usize| -> Vec<_> { sample().into_iter().cycle().take(count).collect() };
    let elements = many(2000);
    let bytes = written(&elements);
    assert_eq!(read(&bytes).0, elements);
    let mut blocks = Vec::new();
    let mut at = HEADER_BYTES;
    while bytes[at] == BLOCK {
        let length = u32::from_le_bytes(bytes[at + 1..at + 5].try_into().unwrap()) as usize;
        assert!(length <= MAX_BLOCK_BYTES);
        blocks.push(at..at + length + 9);
        at += length + 9;
    }
    assert!(blocks.len() > 3, "{}", blocks.len());
    let assemble = |order: &[usize]| {
        let mut file = bytes[..HEADER_BYTES].to_vec();
        for block in order {
            file.extend(&bytes[blocks[*block].clone()]);
        }
        file.extend(&bytes[at..]);
        read(&file)
    };
    let all: Vec<_> = (0..blocks.len()).collect();
    assert!(assemble(&all).1.is_none());
    let exchanged: Vec<_> = [1, 0].into_iter().chain(2..blocks.len()).collect();
    let doubled: Vec<_> = [0].into_iter().chain(0..blocks.len()).collect();
    for order in [&all[1..], &exchanged, &doubled] {
        assert!(matches!(assemble(order).1, Some(QueueReadError::Checksum(_))));
    }
    let shorter = assemble(&all[..all.len() - 1]);
    assert!(matches!(shorter.1, Some(QueueReadError::Count { expected: 2000, .. })));
    assert!(elements.starts_with(&shorter.0));
}

#[test]
fn elements_that_cannot_be_read_are_not_written() {
    let mut writer = QueueWriter::new(Vec::new(), Generator::Editor).unwrap();
    let good = sample();
    writer.write(&good[0]).unwrap();
    for value in [f64::NAN, f64::INFINITY] {
        let bad = PathElement { feed: value, ..good[1].clone() };
        let error = writer.write(&bad).unwrap_err();
        assert!(matches!(
            error,
            QueueWriteError::Content { place, error: ContentError::NotFinite(_) } if place == bad.place
        ));
    }
    writer.write(&good[2]).unwrap();
    let (elements, error) = read(&writer.finish().unwrap());
    assert!(error.is_none());
    assert_eq!(elements, [good[0].clone(), good[2].clone()]);
}

proptest! {
    /// Bit for bit: `Debug` distinguishes −0 from 0, `==` does not.
    #[test]
    fn written_and_read_is_the_same(elements in prop::collection::vec(element(), 0..20)) {
        let (back, error) = read(&written(&elements));
        prop_assert!(error.is_none(), "{error:?}");
        prop_assert_eq!(format!("{back:?}"), format!("{elements:?}"));
    }

    /// As if the path were held as a whole, also over several pieces of the spool, and errors where upstream has them.
    #[test]
    fn backwards_through_a_file(elements in prop::collection::vec(element(), 0..20), often in 1..200_usize) {
        let count = elements.len() * often;
        let path: Vec<_> = elements.into_iter().cycle().take(count).collect();
        let upstream = path.iter().cloned().map(Ok::<_, io::Error>);
        let back: Result<Vec<_>, _> = Backwards::new(upstream, Cursor::new(Vec::new())).collect();
        prop_assert_eq!(format!("{:?}", back.unwrap()), format!("{:?}", reversed(&path)));
    }

    #[test]
    fn any_bytes_end(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(read(&bytes).1.is_some());
        let mut file = written(&[])[..HEADER_BYTES].to_vec();
        file.extend(&bytes);
        prop_assert!(read(&file).1.is_some());
    }

    /// Payloads of any content under right checksums: elements or errors.
    #[test]
    fn any_payload_ends(mut payload in prop::collection::vec(any::<u8>(), 1..500), seed in element(), change in 0..400_usize, value: u8) {
        if value > 40 {
            payload.clear();
            record::write(&mut payload, &seed);
            let at = change % payload.len();
            payload[at] = value;
        }
        let mut rest = payload.as_slice();
        while let Ok(_element) = record::read(&mut rest) {}
        prop_assert!(rest.len() <= payload.len());
    }
}
