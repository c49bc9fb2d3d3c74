//! Moves of LinuxCNC's interpreter, and their comparison with elements.

use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::{Tool, ToolReference, ToolTable};
use std::f64::consts::TAU;
use twin_path::{Plane, Shape};

/// A move in mm, mm/min, degrees and seconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Move {
    pub(super) line: u32,
    /// rapid, feed, probe, dwell or arc, which has its plane (xy, xz or yz) and the turns that are begun behind it,
    /// positive counter-clockwise.
    pub(super) kind: String,
    /// The end, and of an arc the first and second coordinate of its centre in the plane.
    pub(super) points: Vec<f64>,
    pub(super) feed: Option<f64>,
    /// A, B, C or U, V, W: degrees and mm.
    pub(super) extra: [f64; 5],
    pub(super) seconds: Option<f64>,
}

/// Decodes a program as LinuxCNC was run: every tool is there, with length zero and a diameter of 6 mm, all
/// offsets are zero. Moves are those of the tool's tip.
pub(super) fn decode_as_linuxcnc(program: &[u8]) -> Decoded {
    decode_with(DecoderOptions { strict: true, ..as_linuxcnc() }, program)
}

/// The tools of LinuxCNC, and where it measures positions.
pub(super) fn as_linuxcnc() -> DecoderOptions {
    let tools = (0..200).map(|number| Tool { number, diameter: 0.006, ..Tool::default() });
    let tools = Some(ToolTable::new(tools));
    DecoderOptions { tools, reference: ToolReference::Tip, ..DecoderOptions::default() }
}

/// Asserts that the moves before the first error are LinuxCNC's, but for those of the block with the error, of which
/// either may have made some.
#[track_caller]
pub(super) fn assert_same_moves(name: &str, decoded: &Decoded, expected: &[Move]) -> usize {
    difference(decoded, expected).unwrap_or_else(|difference| panic!("{name}: {difference}"))
}

/// Moves before the block with the first error.
pub(super) fn moves_before_error(decoded: &Decoded) -> Vec<Move> {
    let end = decoded.errors.first().map(|error| error.place.line);
    let elements = decoded.elements[..decoded.sound].iter();
    let mut moves: Vec<Move> = elements
        .filter_map(|element| {
            let mut one = as_move(element)?;
            one.feed = one.feed.map(|feed| feed * feed_of_parallel_axes(element, decoded.moves_u));
            Some(one)
        })
        .collect();
    while moves.last().is_some_and(|last| Some(last.line) == end) {
        moves.pop();
    }
    moves
}

/// The number of moves that agree, or the first that does not.
pub(super) fn difference(decoded: &Decoded, expected: &[Move]) -> Result<usize, String> {
    let end = decoded.errors.first().map(|error| error.place.line);
    let (ours, mut expected) = (moves_before_error(decoded), expected);
    while expected.last().is_some_and(|last| Some(last.line) == end) {
        expected = &expected[..expected.len() - 1];
    }
    for (ours, expected) in ours.iter().zip(expected) {
        if let Some(difference) = ours.difference(expected) {
            return Err(difference);
        }
    }
    // Where LinuxCNC stops in a corner (G41, G42) it leaves out the moves that wait for it.
    let gouge = Some(Rule::CompensationGouge);
    let stops = decoded.errors.first().map(|error| error.error.rule()) == gouge;
    if ours.len() == expected.len() || (stops && ours.len() > expected.len()) {
        return Ok(ours.len());
    }
    Err(format!("{} moves, LinuxCNC {}", ours.len(), expected.len()))
}

/// LinuxCNC's feed by that of `element`, which counts angles too where X, Y and Z stay.
fn feed_of_parallel_axes(element: &PathElement, moves_u: bool) -> f64 {
    let Some(extra) = element.extra().filter(|_| element.shape.length() <= 0.0) else { return 1.0 };
    let lengths = if moves_u { 2.. } else { 3.. };
    let squares = extra.start.iter().zip(extra.end).map(|(start, end)| (end - start).powi(2));
    let shift = squares.collect::<Vec<_>>()[lengths].iter().sum::<f64>().sqrt();
    if shift > 0.0 { shift / extra.length() } else { 1.0 }
}

/// `element` as a move; M functions are none.
pub(super) fn as_move(element: &PathElement) -> Option<Move> {
    let points = (element.end().coords * 1e3).as_slice().to_vec();
    let mut result = Move { line: element.place.line, points, ..Move::default() };
    if let Some(extra) = element.extra() {
        result.extra = extra.end;
    }
    result.kind = match (element.kind, &element.shape) {
        (ElementKind::Rapid, _) => "rapid".to_owned(),
        (ElementKind::Cut, Shape::Line { .. }) => "feed".to_owned(),
        (ElementKind::Cut, Shape::Arc(arc)) => {
            result.points.extend(&arc.plane().split(&(arc.center().coords * 1e3))[..2]);
            let plane = match arc.plane() {
                Plane::Xy => "xy",
                Plane::Zx => "xz",
                Plane::Yz => "yz",
            };
            let turns = (arc.sweep().abs() / TAU - 2e-7).ceil() * arc.sweep().signum();
            format!("arc {plane} {turns}")
        }
        (ElementKind::Dwell { time_ns }, _) => {
            (result.points, result.extra) = (Vec::new(), [0.0; 5]);
            result.seconds = Some(time_ns as f64 / 1e9);
            "dwell".to_owned()
        }
        (ElementKind::Cut, shape) => panic!("{shape:?}"),
        (ElementKind::Probe { .. }, _) => "probe".to_owned(),
        (ElementKind::MFunction { .. } | ElementKind::Jump, _) => return None,
    };
    if matches!(element.kind, ElementKind::Cut | ElementKind::Probe { .. }) {
        result.feed = Some(element.feed * 6e4);
    }
    Some(result)
}

/// LinuxCNC's lowest feeds in inverse time, mm/min, of programs in mm and in inches; here a block takes the time that F
/// says.
pub(super) const LOWEST_INVERSE_TIME: [Option<f64>; 2] = [Some(0.1), Some(2.54)];

impl Move {
    /// Difference of `self` from LinuxCNC's `expected`: end points and centres by more than 1e-4 mm, anything else by
    /// more than LinuxCNC's last printed digit. `None` if it does not.
    pub(super) fn difference(&self, expected: &Self) -> Option<String> {
        fn close(ours: &[f64], expected: &[f64], tolerance: f64) -> bool {
            let mut pairs = ours.iter().zip(expected);
            ours.len() == expected.len() && pairs.all(|(a, b)| (a - b).abs() <= tolerance)
        }
        let feed_tolerance = 1e-4 + expected.feed.unwrap_or_default() * 1e-9;
        let same = self.line == expected.line
            && self.kind == expected.kind
            && close(&self.points, &expected.points, 1e-4)
            && (LOWEST_INVERSE_TIME.contains(&expected.feed)
                || close(self.feed.as_slice(), expected.feed.as_slice(), feed_tolerance))
            && close(&self.extra, &expected.extra, 1e-6)
            && self.seconds == expected.seconds;
        (!same).then(|| format!("{self:?}, LinuxCNC {expected:?}"))
    }
}
