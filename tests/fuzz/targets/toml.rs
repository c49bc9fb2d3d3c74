//! Fuzz target: tables that users write next to the machine file. The first byte selects the reader: cams and scenarios
//! in TOML, cams as CSV and ASCII tables, parameter files of drives, tool tables of both kinds. What is read and written again is the
//! same, and every error names a line.

#![no_main]

mod problems;

use libfuzzer_sys::{Corpus, fuzz_target};
use std::path::Path;
use std::sync::LazyLock;
use twin_cam::file::read_ascii;
use twin_drives::backup::{self, BackupError};
use twin_gcode::rs274::{LengthUnit, ToolTable, ToolTableError};
use twin_machine::cam_file::{CamFile, CamFileError, columns};
use twin_machine::section::MachineFileError;
use twin_machine::{Machine, Scenario, parse_tool_table};

/// Machine of the scenarios: it has step motors and belts.
static MACHINE: LazyLock<Machine> = LazyLock::new(|| {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines/gantry3_motors.toml");
    Machine::load(Path::new(path)).expect("a machine of the project")
});

/// Master positions at which a cam and its copy are compared.
const PLACES: u32 = 64;

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let Some((reader, table)) = bytes.split_first() else { return Corpus::Reject };
    let text = std::str::from_utf8(table);
    match (reader, text) {
        (b'c', Ok(text)) => cam(text),
        (b's', Ok(text)) => {
            if let Err(found) = Scenario::parse(text, &MACHINE) {
                problems::sound("scenario", text, found);
            }
        }
        (b'T', Ok(text)) => {
            if let Err(found) = parse_tool_table(text) {
                problems::sound("tool table", text, found);
            }
        }
        (b't', _) => match columns::read(Path::new("fuzz.csv"), table) {
            Ok(read) => {
                let width = read.rows.first().map_or(0, |(_, row)| row.len());
                for (line, row) in &read.rows {
                    assert!(*line >= 1 && row.len() == width, "{row:?} in line {line}");
                    assert!(row.iter().all(|value| value.is_finite()), "{row:?} in line {line}");
                }
            }
            Err(error) => assert!(error.to_string().contains("line "), "{error}"),
        },
        (b'a', _) => match read_ascii(table) {
            Ok(pairs) => assert!(pairs.iter().flatten().all(|value| value.is_finite())),
            Err(error) => assert!(!error.to_string().is_empty()),
        },
        (b'p', _) => match backup::read("fuzz.csv", &mut &table[..]) {
            Ok(read) => assert!(read.entries.iter().all(|entry| entry.line >= 1)),
            Err(BackupError::Lines(lines)) => assert!(!lines.is_empty()),
            Err(error) => assert!(error.to_string().contains("fuzz.csv"), "{error}"),
        },
        (b'r', _) => match ToolTable::read(table, LengthUnit::Millimetre) {
            Ok(tools) => assert!(tools.as_slice().is_sorted_by_key(|tool| tool.number)),
            Err(ToolTableError::Io(error)) => assert!(!error.to_string().is_empty()),
            Err(error) => assert!(error.to_string().contains("line "), "{error}"),
        },
        _ => return Corpus::Reject,
    }
    Corpus::Keep
});

fn cam(text: &str) {
    let path = Path::new("fuzz.toml");
    let file = match CamFile::from_toml(path, text.to_owned()) {
        Ok(file) => file,
        Err(CamFileError::Toml(MachineFileError::Content { problems, .. })) => {
            return problems::sound("cam", text, problems);
        }
        Err(error) => panic!("{error}"),
    };
    let written = file.to_toml();
    let again = CamFile::from_toml(path, written.clone());
    let again = again.unwrap_or_else(|error| panic!("{error:?} in\n{written}"));
    let (one, other) = (file.cam.curve(), again.cam.curve());
    let (start, size) = (one.start(), one.extremes().position.magnitude());
    for place in 0..=PLACES {
        let master = start + (one.end() - start) * f64::from(place) / f64::from(PLACES);
        let (here, there) = (one.at(master).position, other.at(master).position);
        assert!(here.is_finite(), "{here} at {master}");
        let difference = (here - there).abs();
        assert!(difference <= 1e-6 * (1.0 + size), "{difference} at {master} in\n{written}");
    }
}
