//! Small programs compared with LinuxCNC's interpreter.
//!
//! `linuxcnc.txt` is the output of LinuxCNC 2.9's interpreter (Debian package linuxcnc-uspace 2.9, its Python module
//! `gcode`, all offsets zero) for programs that were written to test its rules: `| line of the program`, then its moves
//! in mm and mm/min as `line kind x y z [F feed] [plane turns n center first second] [abc a b c]`,
//! `line dwell seconds`, or `! error`, where it stopped. Where only rotary axes move F is in degrees per minute, as
//! `rs274 -g` has it; for a program in inches the module gives 25.4 times as much. `probe` moves go to their ends:
//! there is nothing to touch.

use super::moves::{ArcMove, Move, as_move};
use super::*;
use crate::rs274::{Tool, ToolTable};

#[derive(Debug, Default)]
struct Case {
    name: String,
    program: String,
    moves: Vec<Move>,
    error: Option<String>,
}

fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for line in include_str!("linuxcnc.txt").lines() {
        if let Some(name) = line.strip_prefix("== ") {
            cases.push(Case { name: name.to_owned(), ..Case::default() });
            continue;
        }
        let case = cases.last_mut().expect("a case has a name");
        if let Some(text) = line.strip_prefix('|') {
            case.program += text.strip_prefix(' ').unwrap_or(text);
            case.program.push('\n');
        } else if let Some(error) = line.strip_prefix("! ") {
            case.error = Some(error.to_owned());
        } else {
            case.moves.push(parse(line));
        }
    }
    cases
}

fn next<'a>(words: &mut impl Iterator<Item = &'a str>) -> f64 {
    words.next().unwrap().parse().unwrap()
}

fn parse(line: &str) -> Move {
    let mut words = line.split(' ');
    let mut result = Move {
        line: words.next().unwrap().parse().unwrap(),
        kind: words.next().unwrap().to_owned(),
        ..Move::default()
    };
    if result.kind == "dwell" {
        result.seconds = Some(next(&mut words));
    } else {
        result.end = Some(std::array::from_fn(|_| next(&mut words)));
    }
    while let Some(word) = words.next() {
        match word {
            "F" => result.feed = Some(next(&mut words)),
            "abc" => result.abc = std::array::from_fn(|_| next(&mut words)),
            plane => {
                assert_eq!(words.next(), Some("turns"));
                let turns = words.next().unwrap().parse().unwrap();
                assert_eq!(words.next(), Some("center"));
                let center = std::array::from_fn(|_| next(&mut words));
                result.arc = Some(ArcMove { plane: plane.to_owned(), turns, center });
            }
        }
    }
    result
}

#[test]
fn programs_are_as_linuxcnc_reads_them() {
    let mut wrong = Vec::new();
    let cases = cases();
    for case in &cases {
        // Every tool is there and has length zero.
        let tools = (1..200).map(|number| Tool { number, ..Tool::default() });
        let options =
            DecoderOptions { tools: Some(ToolTable::new(tools)), ..DecoderOptions::default() };
        let decoded = decode_with(options, case.program.as_bytes());
        let first_error = decoded.errors.first().map_or(u32::MAX, |error| error.place.line);
        let ours: Vec<Move> = decoded
            .elements
            .iter()
            .filter(|element| element.place.line < first_error)
            .filter_map(|element| as_move(element, [0.0; 3]))
            .collect();
        // Of the block that it stops at LinuxCNC may have made some moves.
        let expected: Vec<&Move> = case.moves.iter().filter(|m| m.line < first_error).collect();
        let difference =
            ours.iter().zip(&expected).find_map(|(ours, expected)| ours.difference(expected));
        if difference.is_some()
            || ours.len() != expected.len()
            || case.error.is_some() == decoded.errors.is_empty()
        {
            wrong.push(format!(
                "{}: {} of {} moves, {difference:?}, errors {:?}, expected {:?}\n",
                case.name,
                ours.len(),
                expected.len(),
                decoded.errors,
                case.error
            ));
        }
    }
    assert!(cases.len() > 200, "{}", cases.len());
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), cases.len(), wrong.concat());
}
