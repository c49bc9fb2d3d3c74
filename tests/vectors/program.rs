//! From the text of a program to its elements, and numbers in the units of the manual.

use nalgebra::Point3;
use std::error::Error;
use std::io::Cursor;
use twin_gcode::din66025::{DecodeError, Decoder, DecoderOptions, Diagnostic, Item};
use twin_gcode::info::MoveType;
use twin_path::PathElement;

/// Error of any stage; none may occur here.
pub(crate) type Fault = Box<dyn Error>;

/// Elements and warnings, but that N words are missing, of the blocks of a program that starts at `start` (mm, in X and Y or X, Y and Z).
pub(crate) fn decoded(start: &[f64], blocks: &str) -> (Vec<PathElement>, Vec<Diagnostic>) {
    let mut options = DecoderOptions::default();
    for (slot, mm) in options.start.iter_mut().zip(start) {
        *slot = mm * 1e-3;
    }
    decoded_with(options, blocks)
}

/// The same under any options.
pub(crate) fn decoded_with(
    options: DecoderOptions,
    blocks: &str,
) -> (Vec<PathElement>, Vec<Diagnostic>) {
    let (mut elements, mut warnings) = (Vec::new(), Vec::new());
    for item in Decoder::with_jumps(Cursor::new(format!("%\n{blocks}\n")), options) {
        match item.unwrap_or_else(|failure| panic!("{blocks}: {failure}")) {
            Item::Element(element) => elements.push(element),
            Item::Warning(Diagnostic { error: DecodeError::MissingBlockNumber, .. }) => {}
            Item::Warning(warning) => warnings.push(warning),
        }
    }
    (elements, warnings)
}

/// The elements of blocks of which nothing is wrong.
pub(crate) fn elements(start: &[f64], blocks: &str) -> Vec<PathElement> {
    let (elements, warnings) = decoded(start, blocks);
    assert!(warnings.is_empty(), "{blocks}: {warnings:?}");
    elements
}

/// The only element of such a program.
pub(crate) fn element(start: &[f64], blocks: &str) -> PathElement {
    let mut elements = elements(start, blocks);
    assert_eq!(elements.len(), 1, "{blocks}");
    elements.remove(0)
}

/// Blocks of lines through `points` (mm) but the first, which is where they start.
pub(crate) fn lines(points: &[[f64; 2]]) -> String {
    let blocks: Vec<_> = points[1..].iter().map(|[x, y]| format!("G1 X{x} Y{y} F10")).collect();
    blocks.join("\n")
}

/// Elements on their way into a stage.
pub(crate) fn stream(
    elements: Vec<PathElement>,
) -> impl Iterator<Item = Result<PathElement, Fault>> {
    elements.into_iter().map(Ok)
}

/// `iMoveType`.
pub(crate) fn move_type(element: &PathElement) -> [f64; 1] {
    [MoveType::of(element).number().map_or(f64::NAN, f64::from)]
}

/// X and Y in mm.
pub(crate) fn xy(point: Point3<f64>) -> [f64; 2] {
    [point.x * 1e3, point.y * 1e3]
}

/// Path length in mm.
pub(crate) fn length(element: &PathElement) -> [f64; 1] {
    [element.length() * 1e3]
}

/// X and Y in mm of the point at a part (0 to 1) of the path length.
pub(crate) fn at(element: &PathElement, part: f64) -> [f64; 2] {
    xy(element.at(part * element.length()).position)
}

/// Start of the first element and the ends of all, in mm: the corners of a path.
pub(crate) fn corners(elements: &[PathElement]) -> Vec<f64> {
    let ends = elements.iter().map(PathElement::end);
    elements.first().map(PathElement::start).into_iter().chain(ends).flat_map(xy).collect()
}
