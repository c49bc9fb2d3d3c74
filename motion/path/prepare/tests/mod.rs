//! Tests of path preparation, one file per adapter.

#![expect(clippy::float_cmp, reason = "what an adapter leaves alone stays the same to the bit")]

mod avoid_loops;
mod check_velocities;
mod corner;
mod limit_circular;
mod preparation;
mod random;
mod tool_radius;

use random::random_path;

use crate::Place;
use crate::prepare::{CheckError, CornerError, Notice, Notices, ToolRadiusError};
use crate::{
    Arc, Details, ElementKind, ExtraAxes, Marks, PathElement, ProbeOutcome, Probing, Shape, Switch,
};
use nalgebra::{Point3, Vector3};

/// Errors of the adapters and of a test's stream.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
enum Error {
    #[error(transparent)]
    Check(#[from] CheckError),
    #[error(transparent)]
    Corner(#[from] CornerError),
    #[error(transparent)]
    ToolRadius(#[from] ToolRadiusError),
    #[error("upstream")]
    Upstream(u32),
}

type Item = Result<PathElement, Error>;

/// The tolerance of the vectors, 1e-8 mm, in m.
const VECTOR_TOLERANCE: f64 = 1e-11;

/// The unbroken path that a stage makes of another, and what it notices.
fn through<I: Iterator<Item = Item>>(
    path: Vec<PathElement>,
    stage: impl FnOnce(std::vec::IntoIter<Item>, Notices) -> I,
) -> (Vec<PathElement>, Vec<Notice>) {
    let (items, notices) = (path.into_iter().map(Ok).collect::<Vec<_>>(), Notices::default());
    let path: Vec<_> = stage(items.into_iter(), notices.clone()).map(Result::unwrap).collect();
    assert_continuous(&path);
    (path, taken(&notices))
}

fn element(kind: ElementKind, shape: Shape, feed: f64) -> PathElement {
    let place = Place { block: Some(10), ..Place::at(1) };
    let limits = PathElement::new(place, kind, shape);
    PathElement { feed, acceleration: 0.1, deceleration: 0.1, ..limits }
}

/// A move that a probe has ended.
const PROBE: ElementKind =
    ElementKind::Probe { probing: Probing::TOUCH, outcome: ProbeOutcome::Tripped };

fn line(kind: ElementKind, start: [f64; 3], end: [f64; 3], feed: f64) -> PathElement {
    element(kind, Shape::Line { start: start.into(), end: end.into() }, feed)
}

fn cut(start: [f64; 3], end: [f64; 3], feed: f64) -> PathElement {
    line(ElementKind::Cut, start, end, feed)
}

fn arc(center: [f64; 3], radius: f64, start_angle: f64, sweep: f64, feed: f64) -> PathElement {
    let center = Point3::from(center);
    let on = |angle: f64| center + Vector3::new(angle.cos(), angle.sin(), 0.0) * radius;
    let arc = Arc::new(on(start_angle), on(start_angle + sweep), center, sweep);
    element(ElementKind::Cut, Shape::Arc(arc), feed)
}

/// A path in words, mm: a start, then an element to each place, on lines 1, 2, 3 … of the program. Before a place `r`
/// makes a positioning of it, `j` a jump, `p` a probing move; `oX,Y:A` is an arc of A° about X/Y, `m` an M function.
/// Without Z the height stays. `D` is the radius from here on; G words begin with the next element and end with the last.
fn path(text: &str) -> Vec<PathElement> {
    let (mut at, mut radius, mut begins) = (Point3::origin(), 0.0, Marks::default());
    let (mut path, mut started) = (Vec::<PathElement>::new(), false);
    for word in text.split_whitespace() {
        let (letter, numbers) = split(word);
        let mark = |marks: &mut Marks, mark: Marks| *marks = marks.with(mark);
        let next = match (letter, &numbers[..]) {
            ("D", [value]) => {
                radius = value * 1e-3;
                continue;
            }
            ("G", [word]) => {
                let ends = path.last_mut().map(|element| &mut element.marks);
                match (*word, ends) {
                    (40.0, Some(ends)) => mark(ends, Marks::CORRECTION_END),
                    (50.0, Some(ends)) => mark(ends, Marks::CORNERS_END),
                    (60.0, Some(ends)) => mark(ends, Marks::LOOPS_END),
                    (41.0, _) => mark(&mut begins, Marks::CORRECTION_LEFT),
                    (42.0, _) => mark(&mut begins, Marks::CORRECTION_RIGHT),
                    (51.0, _) => mark(&mut begins, Marks::SMOOTHING),
                    (52.0, _) => mark(&mut begins, Marks::ROUNDING),
                    (61.0, _) => mark(&mut begins, Marks::LOOPS),
                    other => panic!("{other:?}"),
                }
                continue;
            }
            ("o", [x, y, degrees]) => {
                let (center, sweep) = (Point3::new(x * 1e-3, y * 1e-3, at.z), degrees.to_radians());
                let end = center
                    + nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), sweep)
                        * (at - center);
                element(ElementKind::Cut, Shape::Arc(Arc::new(at, end, center, sweep)), 0.05)
            }
            ("m", []) => m_function(at),
            (_, place) => {
                let end = placed(place, at);
                line(kind_of(letter), at.into(), end.into(), 0.05)
            }
        };
        at = next.end();
        if std::mem::replace(&mut started, true) {
            let marks = std::mem::take(&mut begins);
            path.push(PathElement { tool_radius: radius, marks, ..next });
        }
    }
    numbered(path)
}

/// Cuts of 1 m, right and up in turn, on lines 1, 2, 3 … of the program.
fn stairs(count: u32) -> Vec<PathElement> {
    let at = |n: u32| [f64::from(n.div_ceil(2)), f64::from(n / 2), 0.0];
    numbered((0..count).map(|n| cut(at(n), at(n + 1), 0.05)).collect())
}

/// Words of cuts to these points.
fn words(points: impl IntoIterator<Item = [f64; 2]>) -> String {
    let words: Vec<_> = points.into_iter().map(|[x, y]| format!("{x},{y}")).collect();
    words.join(" ")
}

/// Letter and numbers of a word of a path.
fn split(word: &str) -> (&str, Vec<f64>) {
    let (letter, rest) =
        word.split_at(word.find(|c: char| !c.is_alphabetic()).unwrap_or(word.len()));
    let numbers = rest.split([',', ':']).filter(|number| !number.is_empty());
    (letter, numbers.map(|number| number.parse().unwrap()).collect())
}

fn kind_of(letter: &str) -> ElementKind {
    match letter {
        "" => ElementKind::Cut,
        "r" => ElementKind::Rapid,
        "j" => ElementKind::Jump,
        "m" => ElementKind::MFunction { number: 8 },
        "p" => PROBE,
        _ => panic!("{letter}"),
    }
}

/// A place in mm, at the height of `before` where it has no Z.
fn placed(numbers: &[f64], before: Point3<f64>) -> Point3<f64> {
    let [x, y, ref z @ ..] = *numbers else { panic!("{numbers:?}") };
    Point3::new(x * 1e-3, y * 1e-3, z.first().map_or(before.z, |z| z * 1e-3))
}

/// The elements on lines 1, 2, 3 … of the program.
fn numbered(mut elements: Vec<PathElement>) -> Vec<PathElement> {
    for (number, element) in (1..).zip(&mut elements) {
        element.place = Place::at(number);
    }
    elements
}

fn m_function(at: Point3<f64>) -> PathElement {
    element(ElementKind::MFunction { number: 8 }, Shape::Line { start: at, end: at }, 0.05)
}

/// The elements with marks on the first and on the last of them.
fn marked(mut elements: Vec<PathElement>, begin: Marks, end: Marks) -> Vec<PathElement> {
    if let [first, ..] = &mut elements[..] {
        first.marks = first.marks.with(begin);
    }
    if let [.., last] = &mut elements[..] {
        last.marks = last.marks.with(end);
    }
    elements
}

fn ends(path: &[PathElement]) -> Option<[Point3<f64>; 2]> {
    Some([path.first()?.start(), path.last()?.end()])
}

fn length(path: &[PathElement]) -> f64 {
    path.iter().map(PathElement::length).sum()
}

/// Both lines of a corner with many M functions in between.
fn with_many(corner: Vec<PathElement>, count: usize) -> Vec<PathElement> {
    let [first, second] = corner.try_into().unwrap();
    let many = vec![m_function(first.end()); count];
    [first].into_iter().chain(many).chain([second]).collect()
}

/// Every element joins the one before, to the bit.
fn assert_continuous(elements: &[PathElement]) {
    for pair in elements.windows(2) {
        assert_eq!(pair[0].end(), pair[1].start(), "between {:?} and {:?}", pair[0], pair[1]);
        // What names no extra axes has them at 0.
        let end = pair[0].extra().map_or([0.0; 5], |extra| extra.end);
        let start = pair[1].extra().map_or([0.0; 5], |extra| extra.start);
        assert_eq!(end, start, "between {:?} and {:?}", pair[0], pair[1]);
    }
}

fn close(a: Point3<f64>, b_mm: [f64; 3]) -> bool {
    (a - Point3::from(b_mm) * 1e-3).norm() <= VECTOR_TOLERANCE
}

/// Asserts that the elements lead through these places, and are of these kinds: the words of [`path`], arcs as lines.
#[track_caller]
fn assert_path(path: &[PathElement], text: &str) {
    let found: Vec<_> = path.iter().map(|e| (e.kind, e.start() * 1e3, e.end() * 1e3)).collect();
    let mut at = path.first().map_or(Point3::origin(), PathElement::start);
    let words: Vec<_> = text.split_whitespace().map(split).collect();
    assert_eq!(path.len() + 1, words.len(), "{text}: {found:?}");
    for (index, (letter, numbers)) in words.iter().enumerate() {
        let place = placed(numbers, at);
        if index > 0 {
            at = path[index - 1].end();
            assert_eq!(path[index - 1].kind, kind_of(letter), "element {index} of {found:?}");
        }
        assert!((at - place).norm() <= VECTOR_TOLERANCE, "place {index} of {found:?}");
    }
}

/// The first extra axis from `start` to `end`, and the others at 0.
fn with_extra(element: PathElement, (start, end): (f64, f64)) -> PathElement {
    let wide = |p: f64| [p, 0.0, 0.0, 0.0, 0.0];
    let extra = Some(ExtraAxes { start: wide(start), end: wide(end) });
    PathElement { details: Some(Box::new(Details { extra, ..Details::default() })), ..element }
}

/// Where the first extra axis is at both ends of every element.
fn extras(path: &[PathElement]) -> Vec<Option<(f64, f64)>> {
    path.iter().map(|e| e.extra().map(|extra| (extra.start[0], extra.end[0]))).collect()
}

/// With switches that turn on, by number and place.
fn switched(mut element: PathElement, switches: &[(u8, f64)]) -> PathElement {
    let details = element.details.get_or_insert_default();
    for &(number, at) in switches {
        assert!(details.switches.add(Switch { number, on: true, at }));
    }
    element
}

/// The switches of an element by number, their places to nine digits.
fn switches(element: &PathElement) -> Vec<(u8, f64)> {
    let mut found: Vec<_> =
        element.switches().iter().map(|s| (s.number, (s.at * 1e9).round() / 1e9)).collect();
    found.sort_by_key(|(number, _)| *number);
    found
}

fn taken(notices: &Notices) -> Vec<Notice> {
    std::iter::from_fn(|| notices.take()).collect()
}
