//! Tests of the dialect, and the decoding helpers that they share.

#![expect(clippy::float_cmp, reason = "rounded before, or to be the same bit for bit")]

mod curves;
mod errors;
mod jumps;
mod language;
mod random;
mod refeed;
mod warnings;
mod words;
mod write;

use super::{DecodeError, Decoder, DecoderOptions, Diagnostic, Failure, Item};
use nalgebra::Point3;
use std::io::Cursor;
use twin_path::{ElementKind, PathElement, Shape};

type Decoded = Vec<Result<Item, Diagnostic>>;

/// Everything `program` gives, starting at `start` in mm.
fn decode_from(start_mm: [f64; 3], program: &[u8]) -> Decoded {
    let start = start_mm.map(|mm| mm / 1e3);
    decode_with(DecoderOptions { start, ..DecoderOptions::default() }, program)
}

/// Everything `program` gives, jumps included, but the warning that a block has no N word: most tests leave N words out.
fn decode_with(options: DecoderOptions, program: &[u8]) -> Decoded {
    let unnumbered = |item: &Result<Item, Diagnostic>| {
        matches!(item, Ok(Item::Warning(Diagnostic { error: DecodeError::MissingBlockNumber, .. })))
    };
    let mut decoded = decode_all(options, program);
    decoded.retain(|item| !unnumbered(item));
    decoded
}

/// Everything `program` gives, jumps included.
fn decode_all(options: DecoderOptions, program: &[u8]) -> Decoded {
    Decoder::with_jumps(Cursor::new(program), options)
        .map(|item| match item {
            Ok(item) => Ok(item),
            Err(Failure::Diagnostic(diagnostic)) => Err(diagnostic),
            Err(Failure::Io(error)) => panic!("reading from memory: {error}"),
        })
        .collect()
}

fn decode(blocks: &str) -> Decoded {
    decode_from([0.0; 3], format!("%\n{blocks}").as_bytes())
}

/// The elements of a program of which nothing is wrong.
#[track_caller]
fn elements_of(decoded: &Decoded) -> Vec<PathElement> {
    assert_eq!(diagnostics(decoded), []);
    remaining(decoded)
}

/// The same; the `%` line is added.
#[track_caller]
fn elements(blocks: &str) -> Vec<PathElement> {
    elements_of(&decode(blocks))
}

/// The elements that remain of a program with errors or warnings.
fn remaining(decoded: &Decoded) -> Vec<PathElement> {
    let element = |item: &Result<Item, Diagnostic>| match item {
        Ok(Item::Element(element)) => Some(element.clone()),
        _ => None,
    };
    decoded.iter().filter_map(element).collect()
}

fn diagnostics(decoded: &Decoded) -> Vec<Diagnostic> {
    let diagnostic = |item: &Result<Item, Diagnostic>| match item {
        Ok(Item::Element(_)) => None,
        Ok(Item::Warning(diagnostic)) | Err(diagnostic) => Some(diagnostic.clone()),
    };
    decoded.iter().filter_map(diagnostic).collect()
}

/// Start and end of every element in mm, to the nanometre.
fn ends_mm(elements: &[PathElement]) -> Vec<[[f64; 3]; 2]> {
    let mm = |point: Point3<f64>| point.coords.map(|metres| (metres * 1e9).round() / 1e6).into();
    elements.iter().map(|element| [mm(element.start()), mm(element.end())]).collect()
}

/// The same as text.
fn ways(elements: &[PathElement]) -> String {
    let place = |[x, y, z]: [f64; 3]| format!("{x} {y} {z}");
    let way = |ends: [[f64; 3]; 2]| ends.map(place).join(" > ");
    ends_mm(elements).into_iter().map(way).collect::<Vec<_>>().join(" | ")
}

fn kinds(elements: &[PathElement]) -> Vec<ElementKind> {
    elements.iter().map(|element| element.kind).collect()
}

#[track_caller]
fn assert_close(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-8, "{value}, expected {expected}");
}
