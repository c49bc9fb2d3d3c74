//! Moves of LinuxCNC's interpreter, and their comparison with elements.

use super::*;
use std::f64::consts::TAU;
use twin_path::{Plane, Shape};

/// A move in mm, mm/min, degrees and seconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Move {
    pub(super) line: u32,
    /// rapid, feed, arc, probe or dwell.
    pub(super) kind: String,
    pub(super) end: Option<[f64; 3]>,
    pub(super) feed: Option<f64>,
    pub(super) arc: Option<ArcMove>,
    pub(super) abc: [f64; 3],
    pub(super) seconds: Option<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct ArcMove {
    /// xy, xz or yz.
    pub(super) plane: String,
    /// Positive counter-clockwise; turns that are begun.
    pub(super) turns: i32,
    /// First and second coordinate in the plane, before offsets.
    pub(super) center: [f64; 2],
}

/// `element` as a move of LinuxCNC; `None` for M functions. `center_offset` is the offset between the program's
/// coordinates and the machine's.
pub(super) fn as_move(element: &PathElement, center_offset: [f64; 3]) -> Option<Move> {
    let end = element.end().coords * 1e3;
    let mut result =
        Move { line: element.place.line, end: Some([end.x, end.y, end.z]), ..Move::default() };
    if let Some(extra) = element.extra() {
        result.abc.copy_from_slice(&extra.end[..3]);
    }
    let kind = match (element.kind, &element.shape) {
        (ElementKind::Rapid, _) => "rapid",
        (ElementKind::Cut, Shape::Line { .. }) => "feed",
        (ElementKind::Cut, _) => "arc",
        (ElementKind::Dwell { time_ns }, _) => {
            (result.end, result.abc) = (None, [0.0; 3]);
            result.seconds = Some(time_ns as f64 / 1e9);
            "dwell"
        }
        (ElementKind::Probe { .. }, _) => "probe",
        (ElementKind::MFunction { .. } | ElementKind::Jump, _) => return None,
    };
    kind.clone_into(&mut result.kind);
    if matches!(element.kind, ElementKind::Cut | ElementKind::Probe { .. }) {
        result.feed = Some(element.feed * 6e4);
    }
    if let Shape::Arc(arc) = &element.shape {
        let center = arc.center().coords * 1e3 - nalgebra::Vector3::from(center_offset);
        let [first, second, _] = arc.plane().split(&center);
        let plane = match arc.plane() {
            Plane::Xy => "xy",
            Plane::Zx => "xz",
            Plane::Yz => "yz",
        };
        let turns = (arc.sweep().abs() / TAU - 2e-7).ceil() * arc.sweep().signum();
        result.arc =
            Some(ArcMove { plane: plane.to_owned(), turns: turns as i32, center: [first, second] });
    }
    Some(result)
}

fn close(ours: f64, expected: f64, tolerance: f64) -> bool {
    (ours - expected).abs() <= tolerance
}

impl Move {
    /// Difference of `self` from LinuxCNC's `expected`: end points and centres by more than 1e-4 mm, anything else by
    /// more than LinuxCNC's last printed digit. `None` if it does not.
    pub(super) fn difference(&self, expected: &Self) -> Option<String> {
        let ends = match (&self.end, &expected.end) {
            (Some(ours), Some(expected)) => {
                ours.iter().zip(expected).all(|(ours, expected)| close(*ours, *expected, 1e-4))
            }
            (ours, expected) => ours.is_none() && expected.is_none(),
        };
        let feed = match (self.feed, expected.feed) {
            (Some(ours), Some(expected)) => close(ours, expected, 1e-4 + expected * 1e-9),
            (ours, expected) => ours == expected,
        };
        let arc = match (&self.arc, &expected.arc) {
            (Some(ours), Some(expected)) => {
                ours.plane == expected.plane
                    && ours.turns == expected.turns
                    && ours
                        .center
                        .iter()
                        .zip(expected.center)
                        .all(|(ours, expected)| close(*ours, expected, 1e-4))
            }
            (ours, expected) => ours == expected,
        };
        let abc = self.abc.iter().zip(expected.abc).all(|(ours, abc)| close(*ours, abc, 1e-6));
        let same = self.line == expected.line
            && self.kind == expected.kind
            && ends
            && feed
            && arc
            && abc
            && self.seconds == expected.seconds;
        (!same).then(|| format!("{self:?}, LinuxCNC {expected:?}"))
    }
}
