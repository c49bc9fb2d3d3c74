//! Tests of import and export, and the drawings that they share.

mod corpus;
mod entities;
mod hostile;
mod programs;
mod round_trip;

use super::*;
use crate::{ElementKind, PathElement, Shape};
use nalgebra::Point3;

/// A drawing in mm with these entities, each written as its pairs separated by blanks: `LINE 10 0 20 0 11 5 21 0`.
fn drawing(entities: &[&str]) -> String {
    full_drawing("", &[], entities)
}

/// The same with table entries and the entities of blocks, each from its `BLOCK` to its `ENDBLK`.
fn full_drawing(tables: &str, blocks: &[&str], entities: &[&str]) -> String {
    let pairs = |entities: &[&str]| -> String {
        let words =
            entities.iter().flat_map(|entity| ["0"].into_iter().chain(entity.split_whitespace()));
        words.flat_map(|word| [word, "\n"]).collect()
    };
    let [blocks, entities] = [blocks, entities].map(pairs);
    format!(
        "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n\
         0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n{tables}0\nENDTAB\n0\nENDSEC\n\
         0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n\
         0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
    )
}

fn imported(text: &str) -> Import {
    import(text.as_bytes(), &ImportOptions::default()).unwrap()
}

/// The cuts of all programs.
fn cuts(import: &Import) -> Vec<PathElement> {
    let elements = import.programs.iter().flat_map(|program| &program.elements);
    elements.filter(|element| element.kind == ElementKind::Cut).cloned().collect()
}

fn notes(import: &Import) -> Vec<(&str, Reason, u64)> {
    import.notes.iter().map(|note| (note.kind.as_str(), note.reason, note.count)).collect()
}

/// The only shape of a drawing of one entity.
fn only(entity: &str) -> Shape {
    let import = imported(&drawing(&[entity]));
    assert_eq!(import.notes, [], "{entity}");
    let [element] = cuts(&import).try_into().unwrap();
    element.shape
}

/// Positions at a part of the length, mm.
#[track_caller]
fn assert_at(shape: &Shape, part: f64, expected_mm: [f64; 3]) {
    let position = shape.at(part * shape.length()).position * 1e3;
    let off = (position - Point3::from(expected_mm)).norm();
    assert!(off < 1e-8, "{position} at {part}, expected {expected_mm:?}");
}

#[track_caller]
fn assert_close(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-6, "{value}, expected {expected}");
}
