//! Invariants of every path, whatever its source.

#![allow(dead_code, reason = "not every target decodes or prepares")]

use std::error::Error;
use twin_gcode::decode::{Failure, Item, TextError};
use twin_path::prepare::{CheckVelocities, Notices, Preparation, Sections};
use twin_path::{AxisMask, ElementKind, Marks, PathElement, Shape};
use twin_planner::controller::{DEFAULT_CYCLE_NS, Inputs, Interpolator, LookAhead, ToolSetpoint};

/// Set-points sampled at most.
const SETPOINTS: usize = 2_000;

/// Largest number of pieces from a line or an arc and the corner behind it.
const PIECES: usize = 16;

/// Largest number of pieces from a curve that is halved twelve times and replaced by biarcs, and the corners between
/// them.
const CURVE_PIECES: usize = 3 * 2 << 12;

/// The angle up to which turns are passed without a stop, rad.
const ANGLE_TOLERANCE: f64 = 0.03;

/// The elements that `decoder` makes, at most `most` items in all; they meet bit for bit.
pub fn decoded<E: TextError>(
    decoder: impl Iterator<Item = Result<Item<E>, Failure<E>>>,
    most: usize,
) -> Vec<PathElement> {
    let mut items = 0;
    let mut path = Vec::new();
    for item in decoder {
        items += 1;
        assert!(items <= most, "more than {most} items");
        match item {
            Ok(Item::Element(element)) => path.push(element),
            Ok(Item::Warning(diagnostic)) | Err(Failure::Diagnostic(diagnostic)) => {
                // Every message must format.
                assert!(!diagnostic.to_string().is_empty());
            }
            Err(Failure::Io(error)) => panic!("reading from memory: {error}"),
        }
    }
    connected(&path, 0.0);
    path
}

/// Every element is somewhere, has a length, and starts within `tolerance`, m, of where the one before ends.
pub fn connected(path: &[PathElement], tolerance: f64) {
    for element in path {
        assert!(element.start().coords.iter().all(|x| x.is_finite()), "{element:?}");
        assert!(element.end().coords.iter().all(|x| x.is_finite()), "{element:?}");
        assert!(element.length().is_finite() && element.length() >= 0.0, "{element:?}");
    }
    for (one, next) in path.iter().zip(path.iter().skip(1)) {
        let gap = (next.start() - one.end()).norm();
        assert!(gap <= tolerance, "{gap} m between {one:?} and {next:?}");
    }
}

/// `path` through `preparation`, as far as it goes without an error. Its number of elements is bounded.
pub fn prepared(path: &[PathElement], preparation: &Preparation) -> Vec<PathElement> {
    let notices = Notices::default();
    let stages = preparation.apply(path.iter().cloned().map(Ok::<_, Box<dyn Error>>), &notices);
    let prepared: Vec<_> = stages.map_while(Result::ok).collect();
    let most: usize = path.iter().map(most_pieces).sum();
    assert!(prepared.len() <= most + PIECES, "{} of {}", prepared.len(), path.len());
    while let Some(notice) = notices.take() {
        assert!(!notice.to_string().is_empty());
    }
    connected(&prepared, 1e-9);
    prepared
}

fn most_pieces(element: &PathElement) -> usize {
    match element.shape {
        Shape::Line { .. } | Shape::Arc(_) => PIECES,
        Shape::Ellipse(_) | Shape::Cubic(_) => CURVE_PIECES,
    }
}

/// Preparation that the marks of `path` ask for, or none if its sections overlap.
pub fn by_marks(path: &[PathElement]) -> Preparation {
    let mut sections = Sections::default();
    if path.iter().any(|element| sections.pass(element.marks).is_err()) {
        return Preparation::default();
    }
    let marks = path.iter().fold(Marks::default(), |marks, element| marks.with(element.marks));
    Preparation::for_marks(marks)
}

/// Samples `path` as far as a machine would wait, with what `inputs` says for each cycle, if anything. Unless it is
/// `foreign`, with curves that need not end where they say, no set-point is further from the one before than its
/// velocity allows.
pub fn sampled(
    path: Vec<PathElement>,
    foreign: bool,
    mut inputs: impl FnMut(usize) -> Option<Inputs>,
) {
    let fastest = path.iter().map(|element| element.feed).fold(0.0, f64::max);
    let steady = !foreign && path.iter().all(is_steady);
    let uneven = path.iter().map(|element| unevenness(&element.shape)).fold(1.0, f64::max);
    let end = path.last().map(PathElement::end);
    let elements = path.into_iter().map(Ok::<_, Box<dyn Error>>);
    let planned = LookAhead::new(CheckVelocities::new(elements, ANGLE_TOLERANCE));
    let mut interpolator = Interpolator::new(planned, DEFAULT_CYCLE_NS);
    let (mut factor, mut before) = (1.0_f64, None::<ToolSetpoint>);
    for cycle in 0..SETPOINTS {
        if let Some(inputs) = inputs(cycle) {
            factor = factor.max(inputs.override_factor.factor());
            interpolator.set_inputs(inputs);
        }
        let Some(item) = interpolator.next() else {
            if let (Some(end), Some(before), false) = (end, before, interpolator.stopped_early()) {
                assert!(before.position == end, "the path ends at {end}, not at {before:?}");
            }
            return;
        };
        let Ok(setpoint) = item else { return };
        let numbers = setpoint.position.coords.iter().chain(&setpoint.velocity);
        let numbers = numbers.chain(&setpoint.acceleration).chain(&setpoint.extra.position);
        assert!(numbers.into_iter().all(|x| x.is_finite()), "{setpoint:?}");
        assert!(setpoint.path_velocity >= 0.0, "{setpoint:?}");
        // Without a path the feed may be anything.
        let feed = setpoint.feed.max(0.0);
        assert!(setpoint.path_velocity <= factor * feed * (1.0 + 1e-8), "{setpoint:?}");
        if let (true, Some(before)) = (steady, before) {
            let way = (setpoint.position - before.position).norm();
            let most = uneven * factor * fastest * f64::from(DEFAULT_CYCLE_NS.get()) * 1e-9;
            let rounding = 1e-9 * (1.0 + setpoint.position.coords.norm());
            assert!(way <= most * 1.01 + rounding, "{way} m in one cycle, {setpoint:?}");
        }
        before = Some(setpoint);
    }
}

/// Largest velocity along a shape for a path velocity of 1: the length of an arc whose radii differ is that of its mean radius.
fn unevenness(shape: &Shape) -> f64 {
    match shape {
        Shape::Arc(arc) => {
            let (start, end) = (arc.radius(), arc.end_radius());
            start.max(end) / start.midpoint(end)
        }
        _ => 1.0,
    }
}

/// True if the tool never jumps and never moves faster than along the path, as it does where Z has a profile of its
/// own.
fn is_steady(element: &PathElement) -> bool {
    let details = element.details.as_deref();
    let smooth_z = details.is_some_and(|details| details.s_profile.contains(AxisMask::Z));
    element.kind != ElementKind::Jump && !smooth_z
}
