//! Fuzz target: any bytes as a program of SoftMotion's dialect, decoded, prepared, planned and sampled.

#![no_main]

mod path;

use libfuzzer_sys::fuzz_target;
use std::io::{BufReader, Cursor};
use twin_gcode::din66025::{marks_in, Decoder, DecoderOptions};
use twin_path::Marks;

/// Jumps a program may take.
const JUMPS: u32 = 20;

fuzz_target!(|program: &[u8]| {
    let mut options = DecoderOptions { jumps: JUMPS, ..DecoderOptions::default() };
    options.variables.set("a", 2.0);
    // Every byte is good for an item, each time the program runs.
    let most = (JUMPS as usize + 2) * (program.len() + 2);
    let decoder = Decoder::with_jumps(Cursor::new(program), options.clone());
    let whole = path::decoded(decoder, most);
    // However it is cut into pieces, it is the same.
    let pieces = BufReader::with_capacity(3, Cursor::new(program));
    assert_eq!(whole, path::decoded(Decoder::with_jumps(pieces, options), most));
    let marks = whole.iter().fold(Marks::default(), |marks, element| marks.with(element.marks));
    let found = marks_in(program).expect("read from memory");
    let begun = Marks(marks.0 & Marks::STARTS.0);
    assert!(found.contains(begun), "{found:?} is said to be all of {begun:?}");
    let prepared = path::prepared(&whole, &path::by_marks(&whole));
    path::sampled(prepared, false, |_| None);
});
