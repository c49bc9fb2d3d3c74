//! Tests of the dialect, and the decoding helpers that they share.

#![expect(clippy::float_cmp, reason = "rounded before, or to be the same bit for bit")]
#![expect(clippy::cast_precision_loss, reason = "counts and dwells: far below 2^53")]

mod compensation;
mod control;
mod corpus;
mod cycles;
mod errors;
mod generate;
mod leniency;
mod linuxcnc;
mod modes;
mod moves;
mod offsets;
mod oracle;
mod parallel;
mod probe;
mod random;
mod refeed;
mod settings;
mod splines;
mod tools;
mod unsupported;
mod words;
mod write;

use super::block::Letter;
use super::{Decoder, DecoderOptions, Diagnostic, Failure, Item, Position};
use twin_path::{ElementKind, PathElement};

/// Everything a program gives.
#[derive(Debug, Default)]
struct Decoded {
    elements: Vec<PathElement>,
    warnings: Vec<Diagnostic>,
    errors: Vec<Diagnostic>,
    /// Number of elements before the first error.
    sound: usize,
    /// The extra axis U is U and not C.
    moves_u: bool,
}

fn decode_with(options: DecoderOptions, program: &[u8]) -> Decoded {
    let mut decoded = Decoded::default();
    let mut decoder = Decoder::new(program, options);
    for item in decoder.by_ref() {
        match item {
            Ok(Item::Element(element)) => decoded.elements.push(element),
            Ok(Item::Warning(diagnostic)) => decoded.warnings.push(diagnostic),
            Err(Failure::Diagnostic(diagnostic)) => {
                if decoded.errors.is_empty() {
                    decoded.sound = decoded.elements.len();
                }
                decoded.errors.push(diagnostic);
            }
            Err(Failure::Io(error)) => panic!("reading from memory: {error}"),
        }
    }
    if decoded.errors.is_empty() {
        decoded.sound = decoded.elements.len();
    }
    decoded.moves_u = decoder.state.shared == Some(Letter::U);
    decoded
}

fn decode(program: &str) -> Decoded {
    decode_with(DecoderOptions::default(), program.as_bytes())
}

/// As [`decode`], with the rules of LinuxCNC.
fn decode_strictly(program: &str) -> Decoded {
    decode_with(DecoderOptions { strict: true, ..DecoderOptions::default() }, program.as_bytes())
}

/// The elements of a program in which nothing is wrong.
#[track_caller]
fn elements_with(options: DecoderOptions, program: &str) -> Vec<PathElement> {
    let decoded = decode_with(options, program.as_bytes());
    assert_eq!(decoded.errors, [], "{program}");
    decoded.elements
}

#[track_caller]
fn elements(program: &str) -> Vec<PathElement> {
    elements_with(DecoderOptions::default(), program)
}

/// Where elements end, mm, rounded to a nanometre.
fn ends_mm(elements: &[PathElement]) -> Vec<[f64; 3]> {
    let round = |metres: f64| (metres * 1e9).round() / 1e6 + 0.0;
    elements.iter().map(|element| element.end().coords.map(round).into()).collect()
}

/// The same as text.
fn ends(elements: &[PathElement]) -> String {
    let place = |[x, y, z]: [f64; 3]| format!("{x} {y} {z}");
    ends_mm(elements).into_iter().map(place).collect::<Vec<_>>().join(" | ")
}

fn kinds(elements: &[PathElement]) -> Vec<ElementKind> {
    elements.iter().map(|element| element.kind).collect()
}

/// `X Y Z` in m and no rotary axes.
fn at(linear: [f64; 3]) -> Position {
    Position { linear, ..Position::default() }
}
