//! Small programs compared with LinuxCNC's interpreter.
//!
//! `linuxcnc.txt` is the output of LinuxCNC 2.9's interpreter (Debian package linuxcnc-uspace 2.9, its Python module
//! `gcode`, all offsets zero) for programs that were written to test its rules: `| line of the program`, then its moves
//! in mm and mm/min as `line kind x y z [F feed] [plane turns n center first second] [abc a b c]
//! [uvw u v w]`, `line dwell seconds`, or `! error`, where it stopped. Where only rotary axes move F is in degrees per minute, as
//! `rs274 -g` has it; for a program in inches the module gives 25.4 times as much. `probe` moves go to their ends:
//! there is nothing to touch.

use super::moves::{Move, decode_as_linuxcnc, difference};
use std::{fmt::Debug, str::FromStr, str::Split};

#[derive(Debug, Default)]
pub(super) struct Case {
    pub(super) name: String,
    pub(super) program: String,
    pub(super) moves: Vec<Move>,
    pub(super) error: Option<String>,
}

pub(super) fn cases(text: &str) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for line in text.lines() {
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

fn parse(line: &str) -> Move {
    fn next<T: FromStr<Err: Debug>>(words: &mut Split<'_, char>) -> T {
        words.next().unwrap().parse().unwrap()
    }
    let words = &mut line.split(' ');
    let mut result = Move { line: next(words), kind: next(words), ..Move::default() };
    if result.kind == "dwell" {
        result.seconds = Some(next(words));
    } else {
        result.points = (0..3).map(|_| next(words)).collect();
    }
    while let Some(word) = words.next() {
        match word {
            "F" => result.feed = Some(next(words)),
            "abc" => result.extra[..3].fill_with(|| next(words)),
            "uvw" => result.extra[2..].iter_mut().for_each(|slot| *slot += next::<f64>(words)),
            plane => {
                assert_eq!(words.next(), Some("turns"));
                result.kind = format!("{} {plane} {}", result.kind, next::<i32>(words));
                assert_eq!(words.next(), Some("center"));
                result.points.extend([0; 2].map(|_| next::<f64>(words)));
            }
        }
    }
    result
}

#[test]
fn programs_are_as_linuxcnc_reads_them() {
    let cases = cases(include_str!("linuxcnc.txt"));
    let mut wrong = Vec::new();
    for Case { name, program, moves, error } in &cases {
        let decoded = decode_as_linuxcnc(program.as_bytes());
        if let Err(difference) = difference(&decoded, moves) {
            wrong.push(format!("{name}: {difference}"));
        }
        if decoded.errors.is_empty() != error.is_none() {
            wrong.push(format!("{name}: {error:?}, {:?}", decoded.errors));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    assert!(cases.len() > 280, "{}", cases.len());
}
