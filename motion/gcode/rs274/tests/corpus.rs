//! Corpus of programs from CAM systems and by hand, compared with LinuxCNC's interpreter.
//!
//! The moves are those of LinuxCNC 2.9, in a file next to each program: one JSON object per move; the last one gives
//! the line and the reason at which the interpreter stopped. One thing in them is not LinuxCNC's: the script that wrote
//! them takes every feed as inches per minute. Where only rotary axes move it is degrees per minute, as `rs274 -g`
//! shows, which passes the same F on for moves in X and in A; [`correct_rotary_feeds`] undoes it.

use super::moves::{
    LOWEST_INVERSE_TIME, Move, as_linuxcnc, assert_same_moves, decode_as_linuxcnc,
    moves_before_error,
};
use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::DecodeError;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The programs of a group of `corpus.txt`, each with the line and the text of its first error.
pub(super) fn programs(group: &str) -> impl Iterator<Item = (&'static str, u32, &'static str)> {
    let rows = include_str!("corpus.txt").lines();
    rows.filter_map(move |row| {
        let mut words = row.strip_prefix(group)?.strip_prefix(' ')?.splitn(3, ' ');
        let (name, line) = (words.next()?, words.next().map_or(0, |line| line.parse().unwrap()));
        Some((name, line, words.next().unwrap_or_default()))
    })
}

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
    correct_threads(&String::from_utf8_lossy(&fs::read(program).unwrap()), &mut moves);
    if program.ends_with("camotics/botomata_bottom.nc") {
        // The script has centres without offsets, and G10 of this program sets Y.
        let text = fs::read_to_string(program).unwrap();
        let y = |line: &str| -> Option<f64> {
            line.strip_prefix("G10 L2 P2 ")?.split_once('Y')?.1.split(' ').next()?.parse().ok()
        };
        for one in moves.iter_mut().filter(|one| one.points.len() == 5) {
            let before = text.lines().take(one.line as usize);
            one.points[4] += before.filter_map(y).last().unwrap();
        }
    }
    if program.ends_with("linuxcnc_debian/puma_cube.ngc") {
        // It has A without its offset, too: G10 sets it to 180.
        for one in &mut moves {
            one.extra[0] += 180.0;
        }
    }
    if program.ends_with("linuxcnc_debian/comp311.ngc") {
        // The script that wrote the moves forgot the end of the arc before M6. `rs274 -g` goes on from there: of
        // `g0 x1.4 y2.8`, `g2 x2 y3 i.6 j-.8`, `t4 m6`, `g0 z1` the last is STRAIGHT_TRAVERSE(2, 3, 1).
        let rapid = moves.iter_mut().find(|one| one.line == 23).unwrap();
        assert_eq!(rapid.points, [35.56, 71.12, 25.4]);
        rapid.points = vec![50.8, 76.2, 25.4];
    }
    (moves, stopped)
}

/// Leaves out the feeds of threads (G33, G33.1): the script has the F before, and the spindle makes them. It also leaves
/// out the way back of G33.1.
fn correct_threads(text: &str, moves: &mut Vec<Move>) {
    let lines: Vec<String> = text.lines().map(str::to_ascii_lowercase).collect();
    let (mut corrected, mut before) = (Vec::new(), vec![0.0; 3]);
    for mut one in moves.drain(..) {
        let line = &lines[one.line as usize - 1];
        let end = one.points.get(..3).map(<[f64]>::to_vec);
        if line.starts_with("g33") {
            one.feed = LOWEST_INVERSE_TIME[0];
        }
        if line.starts_with("g33.1") {
            let back = Move { points: before.clone(), ..one.clone() };
            corrected.extend([one, back]);
            continue;
        }
        before = end.unwrap_or(before);
        corrected.push(one);
    }
    *moves = corrected;
}

/// Makes the feeds of moves in which no linear axis takes part degrees per minute. The programs with such moves are in
/// inches.
fn correct_rotary_feeds(moves: &mut [Move]) {
    let (mut end, mut extra) = (vec![0.0; 3], [0.0; 5]);
    for one in moves.iter_mut().filter(|one| one.kind != "dwell") {
        if one.points == end && one.extra != extra {
            one.feed = one.feed.map(|feed| feed / 25.4);
        }
        (end, extra) = (one.points[..3].to_vec(), one.extra);
    }
}

pub(super) fn as_linuxcnc_move(object: &Value) -> Move {
    let number = |value: &Value| value.as_f64().unwrap();
    let numbers = |key: &str| object[key].as_array().into_iter().flatten().map(number);
    let mut kind = object["kind"].as_str().unwrap().to_owned();
    if kind == "arc" {
        kind = format!("arc {} {}", object["plane"].as_str().unwrap(), object["turns"]);
    }
    let mut extra = [0.0; 5];
    extra.iter_mut().zip(numbers("abc")).for_each(|(slot, angle)| *slot += angle);
    extra[2..].iter_mut().zip(numbers("uvw")).for_each(|(slot, length)| *slot += length);
    Move {
        line: u32::try_from(object["line"].as_u64().unwrap()).unwrap(),
        kind,
        points: numbers("end").chain(numbers("center")).collect(),
        feed: object["feed"].as_f64(),
        extra,
        seconds: object["seconds"].as_f64(),
    }
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
    let groups = ["within", "wrong", "feedless", "outside"];
    let names: Vec<_> = groups.into_iter().flat_map(programs).map(|(name, ..)| name).collect();
    let listed: BTreeSet<String> = names.iter().map(|name| (*name).to_owned()).collect();
    assert_eq!(listed.len(), names.len(), "one is listed twice");
    assert_eq!(found, listed);
}

#[test]
fn moves_are_those_of_linuxcnc() {
    let Some(corpus) = corpus() else { return };
    let mut count = 0;
    for (name, ..) in programs("within") {
        let path = corpus.join(name);
        let decoded = decode_as_linuxcnc(&fs::read(&path).unwrap());
        let (expected, stopped) = linuxcnc(&path);
        let ends = |one: &Diagnostic| {
            matches!(one.error, DecodeError::MissingEnd | DecodeError::MissingPercent)
        };
        // These errors of LinuxCNC come behind all moves.
        assert_eq!(decoded.errors.iter().filter(|one| !ends(one)).count(), 0, "{name}");
        assert_eq!(decoded.errors.len(), usize::from(stopped.is_some()), "{name}: {stopped:?}");
        let lenient = decode_with(as_linuxcnc(), &fs::read(&path).unwrap());
        assert_eq!(lenient.errors, [], "{name}");
        count += assert_same_moves(name, &decoded, &expected);
        if let Some(message) = stopped {
            let end = message == "File ended with no percent sign or program end"
                || message == "Bad character '%' used";
            assert!(end, "{name}: {message}");
        }
    }
    assert!(count > 100_000, "{count}");
}

#[test]
fn programs_that_linuxcnc_refuses_have_errors() {
    let Some(corpus) = corpus() else { return };
    for wrong in programs("wrong") {
        let (name, line, _) = wrong;
        let path = corpus.join(name);
        let text = fs::read(&path).unwrap();
        let decoded = decode_as_linuxcnc(&text);
        let rule = assert_first_error(wrong, &decoded, &text);
        assert_ne!(rule, Rule::UnsupportedWord, "{name}");
        let (expected, stopped) = linuxcnc(&path);
        assert!(stopped.is_some(), "{name}");
        assert_same_moves(name, &decoded, &expected);
        // LinuxCNC goes no further.
        assert!(expected.last().is_none_or(|last| last.line < line), "{name}");
    }
}

#[test]
fn words_that_are_not_understood_are_told() {
    let Some(corpus) = corpus() else { return };
    for outside in programs("outside") {
        let (name, ..) = outside;
        let path = corpus.join(name);
        let text = fs::read(&path).unwrap();
        let decoded = decode_as_linuxcnc(&text);
        let rule = assert_first_error(outside, &decoded, &text);
        assert_eq!(rule, Rule::UnsupportedWord, "{name}");
        let mut expected = linuxcnc(&path).0;
        // LinuxCNC goes on.
        expected.truncate(moves_before_error(&decoded).len());
        assert_same_moves(name, &decoded, &expected);
    }
}

/// LinuxCNC's preview moves with feed 0, which its machine refuses.
#[test]
fn programs_without_a_feed_have_an_error() {
    let Some(corpus) = corpus() else { return };
    for feedless in programs("feedless") {
        let text = fs::read(corpus.join(feedless.0)).unwrap();
        let decoded = decode_as_linuxcnc(&text);
        assert_eq!(assert_first_error(feedless, &decoded, &text), Rule::Syntax);
        assert_eq!(decoded.errors[0].error, DecodeError::MissingFeed);
        assert_eq!(decoded.errors.len(), 1, "{feedless:?}");
    }
}
