#![expect(clippy::float_cmp, reason = "rounded before, or to be the same bit for bit")]

mod corpus;
mod linuxcnc;
mod moves;

use super::{Decoder, DecoderOptions, Diagnostic, Failure, Item};
use crate::path::{ElementKind, PathElement};

/// Everything a program gives.
#[derive(Debug, Default)]
struct Decoded {
    elements: Vec<PathElement>,
    warnings: Vec<Diagnostic>,
    errors: Vec<Diagnostic>,
}

fn decode_with(options: DecoderOptions, program: &[u8]) -> Decoded {
    let mut decoded = Decoded::default();
    for item in Decoder::new(program, options) {
        match item {
            Ok(Item::Element(element)) => decoded.elements.push(element),
            Ok(Item::Warning(diagnostic)) => decoded.warnings.push(diagnostic),
            Err(Failure::Diagnostic(diagnostic)) => decoded.errors.push(diagnostic),
            Err(Failure::Io(error)) => panic!("reading from memory: {error}"),
        }
    }
    decoded
}

fn decode(program: &str) -> Decoded {
    decode_with(DecoderOptions::default(), program.as_bytes())
}
