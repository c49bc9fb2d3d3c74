//! Random programs, and those of LinuxCNC's own tests, compared with LinuxCNC's interpreter.
//!
//! `oracle.py` next to this file runs the interpreter of Debian's package linuxcnc-uspace; without it these tests are
//! skipped. `TWIN_LONG` takes ten times as many programs, `TWIN_SEED` another first seed, `TWIN_PROGRAMS` another
//! number of programs.

use super::corpus::as_linuxcnc_move;
use super::generate;
use super::moves::{self, Move};
use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::{Tool, ToolReference, ToolTable};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, thread};

const PYTHON: &str = "/usr/bin/python3";
const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/rs274/tests/oracle.py");

/// Number, offset in X, Y and Z, and diameter of each tool, mm.
const TOOLS: [(u32, [f64; 3], f64); 4] = [
    (3, [1.0, -2.0, 30.25], 3.0),
    (1, [0.0, 0.0, 50.5], 6.0),
    (2, [0.0, 0.0, 10.0], 4.0),
    (4, [0.0, 0.0, 0.0], 8.0),
];
/// Targets of G28 and G30 and origin of G55, mm and degrees.
const G28: [f64; 9] = [5.0, 10.0, 50.0, 0.0, 0.0, 0.0, 0.0, 0.0, 25.0];
const G30: [f64; 9] = [-5.0, 20.0, 100.0, 10.0, 20.0, 0.0, 0.0, -15.0, 0.0];
const G55: [f64; 9] = [100.0, 200.0, -30.0, 15.0, 0.0, 0.0, 0.0, 40.0, -5.0];

/// What LinuxCNC makes of a program.
#[derive(Debug)]
pub(super) struct Verdict {
    pub(super) moves: Vec<Move>,
    /// Where and why it stopped, if not at the end.
    pub(super) stopped: Option<(u64, String)>,
}

fn position([x, y, z, a, b, c, u, v, w]: [f64; 9]) -> Position {
    let [linear, parallel] = [[x, y, z], [u, v, w]].map(|axes| axes.map(|length| length / 1e3));
    Position { linear, rotary: [a, b, c], parallel }
}

fn options() -> DecoderOptions {
    let tools = TOOLS.map(|(number, offset, diameter)| Tool {
        number,
        offset: offset.map(|length| length / 1e3),
        diameter: diameter / 1e3,
        ..Tool::default()
    });
    let mut options = DecoderOptions {
        tools: Some(ToolTable::new(tools)),
        g28: position(G28),
        g30: position(G30),
        reference: ToolReference::Tip,
        ..DecoderOptions::default()
    };
    options.work_offsets[1] = position(G55);
    options
}

/// True if the interpreter can be run.
pub(super) fn is_installed() -> bool {
    let found = Command::new(PYTHON).args(["-c", "import gcode"]).output();
    let found = found.is_ok_and(|output| output.status.success());
    if !found {
        println!("skipped: {PYTHON} has no module gcode (package linuxcnc-uspace)");
    }
    found
}

/// Runs LinuxCNC's interpreter over `programs`, with `arguments` of the script.
pub(super) fn linuxcnc(programs: &[String], arguments: &[&str]) -> Vec<Verdict> {
    let folder = env::temp_dir().join(format!("twin-oracle-{:?}", thread::current().id()));
    fs::create_dir_all(&folder).unwrap();
    let tools =
        TOOLS.map(|(number, [x, y, z], diameter)| format!("{number} {x} {y} {z} {diameter}\n"));
    fs::write(folder.join("tools"), tools.concat()).unwrap();
    let parameters = [(5161_u32.., G28), (5181.., G30), (5241.., G55)].into_iter();
    let parameters = parameters.flat_map(|(numbers, values)| numbers.zip(values));
    let parameters = parameters.map(|(number, value)| format!("{number} {value}\n"));
    fs::write(folder.join("parameters"), parameters.collect::<Vec<_>>().concat()).unwrap();
    let mut child = Command::new(PYTHON)
        .args(["-B", SCRIPT, "--tools", "tools", "--parameters", "parameters"])
        .args(arguments)
        .current_dir(&folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    for program in programs {
        writeln!(input, "{}", json!({ "name": "", "program": program })).unwrap();
    }
    drop(input);
    let output = child.wait_with_output().unwrap();
    fs::remove_dir_all(&folder).unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let verdicts: Vec<_> =
        text.lines().map(|line| verdict(&serde_json::from_str(line).unwrap())).collect();
    assert_eq!(verdicts.len(), programs.len(), "{:?}", output.status);
    verdicts
}

fn verdict(object: &Value) -> Verdict {
    let moves = object["moves"].as_array().unwrap().iter().map(as_linuxcnc_move).collect();
    let message = || object["message"].as_str().unwrap().to_owned();
    // A warning here.
    let is_end = object["message"] == "File ended with no percent sign or program end";
    let stopped =
        (object["rc"] != 0 && !is_end).then(|| (object["line"].as_u64().unwrap(), message()));
    Verdict { moves, stopped }
}

/// First difference of the decoder from LinuxCNC, up to the first error of either.
fn difference(program: &str, verdict: &Verdict) -> Option<String> {
    let decoded = decode_with(options(), program.as_bytes());
    let (error, stopped) = match (decoded.errors.first(), &verdict.stopped) {
        (None, None) => return moves::difference(&decoded, &verdict.moves).err(),
        (Some(error), None) => return Some(error.to_string()),
        (None, Some(stopped)) => return Some(format!("no error; LinuxCNC: {stopped:?}")),
        (Some(error), Some(stopped)) => (error, stopped),
    };
    let line = u64::from(error.place.line);
    // An error in a subroutine has the line of its call in LinuxCNC.
    let letters: String = program.to_uppercase().split_whitespace().collect();
    let calls = letters.contains("CALL") || letters.contains("M98");
    let is_unknown =
        error.error.rule() == Rule::UnsupportedWord && !stopped.1.starts_with("Unknown ");
    if is_unknown || !calls && ![line, line + 1].contains(&stopped.0) {
        return Some(format!("{error}; LinuxCNC: {stopped:?}"));
    }
    moves::difference(&decoded, &verdict.moves).err()
}

/// The program without the lines that it does not need to differ in this way, taken or refused by LinuxCNC as before.
fn minimised(program: &str, is_refused: bool, found: &str) -> String {
    // An error has the line first, moves their names, counts digits.
    let kind = |found: &str| found.chars().next().filter(char::is_ascii_alphabetic);
    let differing = |programs: &[String]| -> Vec<bool> {
        // Loops may have lost their ends.
        let verdicts = linuxcnc(programs, &["--timeout", "1"]);
        let differing = programs.iter().zip(&verdicts).map(|(program, verdict)| {
            verdict.stopped.is_some() == is_refused
                && difference(program, verdict).is_some_and(|other| kind(&other) == kind(found))
        });
        differing.collect()
    };
    let mut program = program.to_owned();
    let mut size = program.lines().count().div_ceil(2);
    while size > 0 {
        let without = |left_out: &[usize]| -> String {
            let lines = program.lines().enumerate();
            let kept = lines.filter(|(index, _)| !left_out.contains(&(index / size)));
            kept.map(|(_, line)| format!("{line}\n")).collect::<Vec<_>>().concat()
        };
        let count = program.lines().count().div_ceil(size);
        let each: Vec<String> = (0..count).map(|part| without(&[part])).collect();
        let useless: Vec<usize> = (0..count)
            .zip(differing(&each))
            .filter_map(|(part, is_useless)| is_useless.then_some(part))
            .collect();
        let Some(first) = useless.first() else {
            size /= 2;
            continue;
        };
        let shortest = without(&useless);
        program = if differing(std::slice::from_ref(&shortest))[0] {
            shortest
        } else {
            each[*first].clone()
        };
    }
    program
}

fn number(name: &str, default: u64) -> u64 {
    env::var(name).map_or(default, |value| value.parse().expect("a number"))
}

/// Random programs of the features with these marks, and LinuxCNC's verdicts.
fn random(seeds: Range<u64>, marks: &str) -> Vec<(u64, String, Verdict)> {
    let features = generate::features(marks);
    let programs: Vec<String> =
        seeds.clone().map(|seed| generate::program(seed, &features)).collect();
    let verdicts = linuxcnc(&programs, &[]);
    seeds
        .zip(programs)
        .zip(verdicts)
        .map(|((seed, program), verdict)| (seed, program, verdict))
        .collect()
}

/// Asserts that LinuxCNC takes most of these, so that all of their lines count.
fn assert_few_refused(cases: &[(u64, String, Verdict)]) {
    let refused = cases.iter().filter(|(.., verdict)| verdict.stopped.is_some());
    for (seed, program, verdict) in refused.clone().take(3) {
        println!("seed {seed}: {:?}\n{program}", verdict.stopped);
    }
    assert!(refused.count() * 20 < cases.len());
}

#[test]
fn random_programs_are_as_linuxcnc_reads_them() {
    if !is_installed() {
        return;
    }
    let default = if env::var_os("TWIN_LONG").is_some() { 20_000 } else { 2_000 };
    let (first, count) = (number("TWIN_SEED", 0), number("TWIN_PROGRAMS", default));
    let cases = random(first..first + count, "+");
    assert_few_refused(&cases);
    let differing = cases.iter().filter_map(|case| Some((case, difference(&case.1, &case.2)?)));
    let differing: Vec<_> = differing.collect();
    for ((seed, program, verdict), found) in differing.iter().take(3) {
        let program = minimised(program, verdict.stopped.is_some(), found);
        let shorter = difference(&program, &linuxcnc(std::slice::from_ref(&program), &[])[0]);
        println!("seed {seed}: {found}\n{program}{shorter:?}\n");
    }
    let moves: usize = cases.iter().map(|(.., verdict)| verdict.moves.len()).sum();
    assert!(differing.is_empty(), "{} of {count} programs differ, {moves} moves", differing.len());
}

/// The grammar is LinuxCNC's, that of features that are not supported yet included.
#[test]
fn linuxcnc_takes_random_programs() {
    if is_installed() {
        assert_few_refused(&random(0..500, "+-"));
    }
}

/// The programs below `folder`, in order.
fn programs_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            programs_below(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "ngc") {
            found.push(path);
        }
    }
}

/// LinuxCNC's own tests of its interpreter (`tests/interp` in the folder of its sources, `TWIN_LINUXCNC`) but for those
/// in `linuxcnc_tests.txt`.
#[test]
fn programs_of_linuxcncs_tests() {
    let Some(sources) = env::var_os("TWIN_LINUXCNC") else {
        println!("skipped: TWIN_LINUXCNC does not name a folder of LinuxCNC's sources");
        return;
    };
    if !is_installed() {
        return;
    }
    let (root, mut paths) = (Path::new(&sources).join("tests/interp"), Vec::new());
    programs_below(&root, &mut paths);
    let texts: Vec<String> = paths
        .iter()
        .map(|path| String::from_utf8_lossy(&fs::read(path).unwrap()).into_owned())
        .collect();
    let rows = include_str!("linuxcnc_tests.txt").lines().filter(|line| !line.starts_with('#'));
    let mut left_out: BTreeMap<&str, &str> =
        rows.map(|row| row.split_once(": ").unwrap()).collect();
    let (mut agreeing, mut differing) = (0, 0);
    for (path, (text, verdict)) in paths.iter().zip(texts.iter().zip(linuxcnc(&texts, &[]))) {
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
        match (difference(text, &verdict), left_out.remove(name)) {
            (None, reason) => {
                agreeing += 1;
                if let Some(reason) = reason {
                    println!("{name} agrees now: {reason}");
                }
            }
            (Some(_), Some(_)) => {}
            (Some(found), None) => {
                differing += 1;
                println!("{name}: {found}");
            }
        }
    }
    println!("{agreeing} of {} agree", paths.len());
    assert_eq!(differing, 0);
    assert_eq!(left_out, BTreeMap::new(), "these are not there");
}
