//! Elements that lead out of reach: their farthest point, and the move of the part that brings all of them within reach.

use super::{MachinePath, Trial};
use crate::finding::Finding;
use crate::messages::{move_part, unreachable};
use nalgebra::Vector3;
use twin_kinematics::{KinematicsError, Pose, ReachOf};
use twin_machine::Machine;
use twin_planner::blended_path::BlendedElement;
use twin_planner::time_optimal::AxisPath;

/// Number of parts of an element between whose ends the farthest point is looked for.
const PARTS: u32 = 64;
/// Number of steps by which it is found between them.
const STEPS: u32 = 40;
/// Number of moves that are tried.
const MOVES: u32 = 32;
/// Distance from the edge of the reach to which a part is moved, m.
const MARGIN: f64 = 1e-4;
/// Moves off an edge that are tried, m.
const WAYS: [f64; 3] = [1e-4, 1e-3, 1e-2];
/// A point nearer to the axis of the first arm than this has no direction from it, m.
const ON_AXIS: f64 = 1e-6;

/// A point out of reach.
#[derive(Clone, Copy, Debug)]
struct Beyond {
    /// Distance beyond the edge of the reach, m.
    excess: f64,
    /// Where on the element, m.
    at: f64,
    error: KinematicsError,
}

/// Error about `element`, on which the kinematics refuses a point with `error`: its farthest point, and a move of the part that
/// helps, where one is found.
pub(crate) fn out_of_reach(
    machine: &Machine,
    element: &BlendedElement,
    error: &KinematicsError,
) -> Finding {
    let path = MachinePath::without_motors(machine);
    let farthest = farthest(&path, element);
    let error = farthest.map_or(*error, |beyond| beyond.error);
    let mut finding = unreachable(element.place(), &error);
    let by = match error {
        KinematicsError::Singular(tip) => off_edge(machine, element, tip),
        _ if farthest.is_some() => inwards(machine, element),
        _ => None,
    };
    finding.hint = by.map(|by| move_part(&by));
    finding
}

/// Move of the part, m, machine frame, that takes an element off the edge of the reach that it touches at `tip`.
fn off_edge(machine: &Machine, element: &BlendedElement, tip: [f64; 3]) -> Option<Vector3<f64>> {
    let outwards = Vector3::new(tip[0], tip[1], 0.0).try_normalize(0.0)?;
    let mut moves = WAYS.into_iter().flat_map(|way| [-way, way]).map(|way| outwards * way);
    moves.find(|by| {
        let path = MachinePath::without_motors(machine).under(Trial::Moved(*by));
        let places = (0..=PARTS).map(|part| element.length() * f64::from(part) / f64::from(PARTS));
        places.into_iter().all(|at| path.axes(element, at, &path.home()).is_ok())
    })
}

/// The point of an element that is farthest beyond the edge of the reach; none if all of it is within reach.
fn farthest(path: &MachinePath<'_>, element: &BlendedElement) -> Option<Beyond> {
    let length = element.length();
    let place = |part: u32| length * f64::from(part) / f64::from(PARTS);
    let excess = |at: f64| beyond(path, element, at).map_or(0.0, |beyond| beyond.excess);
    let points = (0..=PARTS).filter_map(|part| beyond(path, element, place(part)));
    let first = points.reduce(|most, next| if next.excess > most.excess { next } else { most })?;
    // By golden sections about it.
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let step = place(1);
    let (mut low, mut high) = ((first.at - step).max(0.0), (first.at + step).min(length));
    for _ in 0..STEPS {
        let [one, other] = [high - ratio * (high - low), low + ratio * (high - low)];
        if excess(one) > excess(other) { high = other } else { low = one }
    }
    let found = [low, high, first.at].into_iter().filter_map(|at| beyond(path, element, at));
    found.reduce(|most, next| if next.excess > most.excess { next } else { most })
}

/// The point at `at` m of an element, if it is out of reach.
fn beyond(path: &MachinePath<'_>, element: &BlendedElement, at: f64) -> Option<Beyond> {
    let error = path.axes(element, at, &path.home()).err()?;
    let KinematicsError::Unreachable { distance, reach: [near, far], .. } = error else {
        return None;
    };
    Some(Beyond { excess: (distance - far).max(near - distance), at, error })
}

/// Move of the part, m, machine frame, with which all of an element is within the reach of the arms of a SCARA.
fn inwards(machine: &Machine, element: &BlendedElement) -> Option<Vector3<f64>> {
    let mut by = Vector3::zeros();
    for _ in 0..MOVES {
        let path = MachinePath::without_motors(machine).under(Trial::Moved(by));
        let Some(Beyond { excess, at, error }) = farthest(&path, element) else {
            return Some(by);
        };
        let KinematicsError::Unreachable {
            target,
            of: ReachOf::Arms,
            distance,
            reach: [_, far],
            ..
        } = error
        else {
            return None;
        };
        let outwards = Vector3::new(target[0], target[1], 0.0);
        let outwards = if outwards.norm() > ON_AXIS {
            outwards.normalize()
        } else {
            across(&path, element, at)?
        };
        let inwards = if distance > far { -outwards } else { outwards };
        by += inwards * (excess + MARGIN);
    }
    None
}

/// Direction across the path at `at` m of an element, seen from above.
fn across(path: &MachinePath<'_>, element: &BlendedElement, at: f64) -> Option<Vector3<f64>> {
    let step = element.length() / f64::from(PARTS);
    let ends = [(at - step).max(0.0), (at + step).min(element.length())];
    let [from, to] = ends.map(|at| {
        let Pose { position, .. } = path.pose(element, at);
        position.coords
    });
    let way = to - from;
    Vector3::new(-way.y, way.x, 0.0).try_normalize(0.0)
}
