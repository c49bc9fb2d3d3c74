//! Corpus of programs from CAM systems and by hand, compared with LinuxCNC's interpreter.
//!
//! The moves are those of LinuxCNC 2.9, in a file next to each program: one JSON object per move; the last one gives
//! the line and the reason at which the interpreter stopped. One thing in them is not LinuxCNC's: the script that wrote
//! them takes every feed as inches per minute. Where only rotary axes move it is degrees per minute, as `rs274 -g`
//! shows, which passes the same F on for moves in X and in A; [`correct_rotary_feeds`] undoes it.

use super::moves::{ArcMove, Move, as_move};
use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::{Tool, ToolTable};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Programs of words that are understood: every move is LinuxCNC's.
pub(super) const WITHIN: [&str; 29] = [
    "bcnc/sample.gcode",
    "camotics/bear.nc",
    "camotics/bottom.ngc",
    "camotics/buildbotics.gcode",
    "camotics/cameo.nc",
    "camotics/engrave.ngc",
    "camotics/flower_mold.nc",
    "camotics/top.ngc",
    "fluidnc/arcs_arrows.nc",
    "gpr/linuxcnc_sample.ngc",
    "gsender/FourAxisSurface_finishPass.nc",
    "gsender/arc-xy-plane.gcode",
    "gsender/inline-comment.gcode",
    "gsender/longmill-line_M0.nc",
    "gsender/sample.gcode",
    "gsender/tball.gcode",
    "tinyg/Batman.tap",
    "tinyg/alpha_01_full_test_001.gcode",
    "tinyg/inventables_pine_logo.nc",
    "tinyg/plate.nc",
    "tinyg/roadrunner.gcode",
    "ugs/Gates_combined_R12.nc",
    "ugs/arc_rword_test.gcode",
    "ugs/electric_turtle.nc",
    "ugs/enclosure.nc",
    "ugs/no_spaces.gcode",
    "ugs/ordbot_handle.nc",
    "ugs/square.nc",
    "ugs/ugs.gcode",
];

/// Programs of words that are understood in which something is wrong: the line of the first error and its text. Up to
/// there the moves are LinuxCNC's, and LinuxCNC stops there.
const WRONG: [(&str, u32, &str); 5] = [
    // A radius of 29 mm at the start and of 27.6 mm at the end.
    ("gsender/Circle_Diamond_Square_Calibration.gcode", 624, "N624 G3 X21 Y-20 I20 J21"),
    // An arc with neither centre nor radius: G2 goes on from the line before.
    ("gsender/full-circle-without-xyz.gcode", 11, "N55 X.75"),
    // Axes before any G word.
    ("tinyg/hacdc.gcode", 1, "X0.6796Y9.1444"),
    ("tinyg/zoetrope.gcode", 81, "Y"),
    ("fluidnc/parsetest.nc", 4, "x0"),
];

/// Programs with words that are not understood: the first of them, what it is and where. Up to there the moves are
/// LinuxCNC's.
const OUTSIDE: [(&str, u32, &str); 26] = [
    ("camotics/botomata_bottom.nc", 6, "G10"),
    ("camotics/cutout.ngc", 3, "#<z_safe>"),
    ("camotics/genes-encoder.ngc", 22, "o100 sub"),
    ("camotics/mt_kazbegi_2013.ngc", 1, "#<safe>"),
    ("camotics/tiny_cat_outline.ngc", 43, "#2=-1.5"),
    ("fluidnc/parser.nc", 2, "$"),
    ("fluidnc/probe.nc", 1, "#<"),
    ("gpr/camaster_sample.tap", 1, "[VECTRIC CNC"),
    ("gsender/TrainDriveShaft_GRBL.nc", 3527, "M29"),
    ("gsender/longmill-line_invalid_gcode.nc", 124, "U25"),
    ("linuxcnc_debian/circles.ngc", 20, "o<circles> sub"),
    ("linuxcnc_debian/comp.ngc", 12, "g42"),
    ("linuxcnc_debian/comp311.ngc", 26, "g41"),
    ("linuxcnc_debian/example.ngc", 2, "G10"),
    ("linuxcnc_debian/flowsnake.ngc", 5, "o1000 sub"),
    ("linuxcnc_debian/gmoccapy_2_tools_with_cutter_radius_compensation.ngc", 37, "G41"),
    ("linuxcnc_debian/lathe_pawn.ngc", 3, "G8"),
    ("linuxcnc_debian/lathecomp.ngc", 20, "g42"),
    ("linuxcnc_debian/m70m72-demo.ngc", 6, "O<showstate> sub"),
    ("linuxcnc_debian/mmount.ngc", 24, "#100=10.0"),
    ("linuxcnc_debian/offsets.ngc", 1, "#5599 = 1"),
    ("linuxcnc_debian/puma_cube.ngc", 20, "g10"),
    ("linuxcnc_debian/spiral.ngc", 8, "o100 repeat"),
    ("linuxcnc_debian/threading.ngc", 10, "#1=.05"),
    ("linuxcnc_debian/turning.ngc", 3, "O<turning> sub"),
    ("linuxcnc_debian/useful-subroutines.ngc", 14, "o100 sub"),
];

/// No program but the protocol of a talk between a sender and a controller: its first character.
const NO_PROGRAM: (&str, u32, &str) = ("fluidnc/flow_control_basic.nc", 1, "-");

/// The folder of programs, if it is there.
pub(super) fn corpus() -> Option<PathBuf> {
    let shared = std::env::var_os("TWIN_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let corpus = shared.join("corpus");
    if corpus.join("INDEX.tsv").is_file() {
        return Some(corpus);
    }
    println!("skipped: there is no {}", corpus.join("INDEX.tsv").display());
    None
}

/// The moves of LinuxCNC's interpreter, and why it stopped if that was before the end.
fn linuxcnc(program: &Path) -> (Vec<Move>, Option<String>) {
    let mut path = program.as_os_str().to_owned();
    path.push(".moves.jsonl");
    let text = fs::read_to_string(&path)
        .or_else(|_| fs::read_to_string(program.with_extension("moves.jsonl")))
        .unwrap();
    let mut objects: Vec<Value> =
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let verdict = objects.pop().unwrap();
    let stopped = (verdict["rc"] != 0).then(|| verdict["message"].as_str().unwrap().to_owned());
    let mut moves: Vec<Move> = objects.iter().map(as_linuxcnc_move).collect();
    correct_rotary_feeds(&mut moves);
    (moves, stopped)
}

/// Makes the feeds of moves in which no linear axis takes part degrees per minute. The programs with such moves are in
/// inches.
fn correct_rotary_feeds(moves: &mut [Move]) {
    let (mut end, mut abc) = ([0.0; 3], [0.0; 3]);
    for one in moves {
        let Some(to) = one.end else { continue };
        if to == end && one.abc != abc && one.kind == "feed" {
            one.feed = one.feed.map(|feed| feed / 25.4);
        }
        (end, abc) = (to, one.abc);
    }
}

fn as_linuxcnc_move(object: &Value) -> Move {
    fn numbers<const N: usize>(value: &Value) -> [f64; N] {
        std::array::from_fn(|index| value[index].as_f64().unwrap())
    }
    let arc = (object["kind"] == "arc").then(|| ArcMove {
        plane: object["plane"].as_str().unwrap().to_owned(),
        turns: i32::try_from(object["turns"].as_i64().unwrap()).unwrap(),
        center: numbers(&object["center"]),
    });
    Move {
        line: u32::try_from(object["line"].as_u64().unwrap()).unwrap(),
        kind: object["kind"].as_str().unwrap().to_owned(),
        end: object.get("end").map(numbers),
        feed: object.get("feed").and_then(Value::as_f64),
        arc,
        abc: object.get("abc").map_or([0.0; 3], numbers),
        seconds: object.get("seconds").and_then(Value::as_f64),
    }
}

/// Decodes the program at `path` as LinuxCNC was run: every tool is there and has length zero, all offsets are zero.
fn decode_file(text: &[u8]) -> Decoded {
    let tools = (1..200).map(|number| Tool { number, ..Tool::default() });
    let options =
        DecoderOptions { tools: Some(ToolTable::new(tools)), ..DecoderOptions::default() };
    decode_with(options, text)
}

/// Asserts that the moves before line `end` are LinuxCNC's, and returns how many these are.
#[track_caller]
fn assert_same_moves(name: &str, decoded: &Decoded, expected: &[Move], end: u32) -> usize {
    let before: Vec<&Move> = expected.iter().take_while(|expected| expected.line < end).collect();
    let ours: Vec<Move> = decoded
        .elements
        .iter()
        .take_while(|element| element.place.line < end)
        .filter_map(|element| as_move(element, [0.0; 3]))
        .collect();
    for (ours, expected) in ours.iter().zip(&before) {
        assert_eq!(ours.difference(expected), None, "{name}");
    }
    assert_eq!(ours.len(), before.len(), "{name}");
    ours.len()
}

/// Asserts that the first thing wrong is in this line at this text.
#[track_caller]
fn assert_first_error(
    (name, line, pointed): (&str, u32, &str),
    decoded: &Decoded,
    text: &[u8],
) -> Rule {
    let first = decoded.errors.first().unwrap_or_else(|| panic!("{name}: nothing is wrong"));
    assert_eq!(first.place.line, line, "{name}: {first}");
    let index = usize::try_from(line).unwrap() - 1;
    let bytes = text.split(|byte| *byte == b'\n').nth(index).unwrap();
    let columns = first.columns.clone().unwrap_or(0..bytes.len());
    let found = String::from_utf8_lossy(&bytes[columns]).into_owned();
    assert!(found.starts_with(pointed), "{name}: {first}, at {found:?} instead of {pointed:?}");
    first.error.rule()
}

#[test]
fn every_program_is_listed() {
    let Some(corpus) = corpus() else { return };
    let index = fs::read_to_string(corpus.join("INDEX.tsv")).unwrap();
    let found: BTreeSet<String> = index
        .lines()
        .skip(1)
        .map(|line| line.split('\t').take(2).collect::<Vec<_>>().join("/"))
        .collect();
    let names = WITHIN.into_iter().chain(WRONG.map(|(name, _, _)| name));
    let names = names.chain(OUTSIDE.map(|(name, _, _)| name)).chain([NO_PROGRAM.0]);
    let listed: BTreeSet<String> = names.map(str::to_owned).collect();
    assert_eq!(listed.len(), WITHIN.len() + WRONG.len() + OUTSIDE.len() + 1, "one is listed twice");
    assert_eq!(found, listed);
}

#[test]
fn moves_are_those_of_linuxcnc() {
    let Some(corpus) = corpus() else { return };
    let mut count = 0;
    for name in WITHIN {
        let path = corpus.join(name);
        let decoded = decode_file(&fs::read(&path).unwrap());
        assert_eq!(decoded.errors, [], "{name}");
        let (expected, stopped) = linuxcnc(&path);
        count += assert_same_moves(name, &decoded, &expected, u32::MAX);
        assert_eq!(count_moves(&decoded), expected.len(), "{name}");
        // What LinuxCNC does not like about the end of some of these programs; see the documentation of the module.
        if let Some(message) = stopped {
            let end = message == "File ended with no percent sign or program end"
                || message == "Bad character '%' used";
            assert!(end, "{name}: {message}");
        }
    }
    assert!(count > 100_000, "{count}");
}

fn count_moves(decoded: &Decoded) -> usize {
    decoded.elements.iter().filter(|element| as_move(element, [0.0; 3]).is_some()).count()
}

#[test]
fn programs_that_linuxcnc_refuses_have_errors() {
    let Some(corpus) = corpus() else { return };
    for wrong in WRONG.into_iter().chain([NO_PROGRAM]) {
        let (name, line, _) = wrong;
        let path = corpus.join(name);
        let text = fs::read(&path).unwrap();
        let decoded = decode_file(&text);
        let rule = assert_first_error(wrong, &decoded, &text);
        assert_ne!(rule, Rule::UnsupportedWord, "{name}");
        let (expected, stopped) = linuxcnc(&path);
        assert!(stopped.is_some(), "{name}");
        assert_same_moves(name, &decoded, &expected, line);
        // LinuxCNC goes no further.
        assert!(expected.last().is_none_or(|last| last.line < line), "{name}");
    }
}

#[test]
fn words_that_are_not_understood_are_told() {
    let Some(corpus) = corpus() else { return };
    for outside in OUTSIDE {
        let (name, line, _) = outside;
        let path = corpus.join(name);
        let text = fs::read(&path).unwrap();
        let decoded = decode_file(&text);
        let rule = assert_first_error(outside, &decoded, &text);
        assert_eq!(rule, Rule::UnsupportedWord, "{name}");
        let mut expected = linuxcnc(&path).0;
        if name == "linuxcnc_debian/comp311.ngc" {
            // The script that wrote the moves forgot the end of the arc before M6. `rs274 -g` goes on from there: of
            // `g0 x1.4 y2.8`, `g2 x2 y3 i.6 j-.8`, `t4 m6`, `g0 z1` the last is STRAIGHT_TRAVERSE(2, 3, 1).
            let rapid = expected.iter_mut().find(|expected| expected.line == 23).unwrap();
            assert_eq!(rapid.end, Some([35.56, 71.12, 25.4]));
            rapid.end = Some([50.8, 76.2, 25.4]);
        }
        assert_same_moves(name, &decoded, &expected, line);
    }
}
