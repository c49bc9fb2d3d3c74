//! Pipeline of the motion stages, connected as in the product.

use std::error::Error;
use twin_gcode::decode;
use twin_gcode::decode::{Item, TextError};
use twin_path::prepare::{CheckedElement, Notices, Preparation};
use twin_path::{Marks, PathElement};
use twin_planner::controller::{DEFAULT_CYCLE_NS, Interpolator, LookAhead};

/// Whatever goes wrong.
pub type Failure = Box<dyn Error>;

/// Turns of up to so much are passed without a stop, rad.
const ANGLE_TOLERANCE: f64 = 0.1;

/// The elements that `decoder` makes; whatever it finds to tell is a failure.
pub fn elements<E: TextError + 'static>(
    decoder: impl Iterator<Item = Result<decode::Item<E>, decode::Failure<E>>>,
) -> impl Iterator<Item = Result<PathElement, Failure>> {
    decoder.map(|item| match item? {
        Item::Element(element) => Ok(element),
        Item::Warning(warning) => Err(warning.into()),
    })
}

/// Prepared for the interpolator: no stage that the program does not ask for.
pub fn prepare(
    elements: impl Iterator<Item = Result<PathElement, Failure>>,
) -> impl Iterator<Item = Result<CheckedElement, Failure>> {
    Preparation::for_marks(Marks::default()).check(elements, ANGLE_TOLERANCE, &Notices::default())
}

/// Plans `path`; how many elements it has.
pub fn plan(path: impl Iterator<Item = Result<CheckedElement, Failure>>) -> usize {
    count(LookAhead::new(path))
}

/// Samples `path` every millisecond; how many set-points that gives.
pub fn sample(path: impl Iterator<Item = Result<CheckedElement, Failure>>) -> usize {
    count(Interpolator::new(LookAhead::new(path), DEFAULT_CYCLE_NS))
}

/// Number of items, none of which is an error.
pub fn count<T>(items: impl Iterator<Item = Result<T, Failure>>) -> usize {
    items
        .map(|item| std::hint::black_box(item).map(drop).expect("a program without errors"))
        .count()
}
