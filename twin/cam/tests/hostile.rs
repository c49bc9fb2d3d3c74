//! Files of cams that nobody would write are survived, and what is wrong with them names the file and, where it has any, the line.

use crate::cam::check::{AxisLimits, CamCheck, CamUse};
use crate::cam::sample::{Sampling, write};
use proptest::prelude::*;
use std::path::Path;
use twin_cam::file::AsciiError;
use twin_cam::{Interpolation, MasterMotion, SlaveLimits};
use twin_machine::cam_file::{CamFile, CamFileError};
use twin_machine::section::MachineFileError;

const TOML: &str = "name = \"lift\"\nmaster = { min = 0, max = 360, unit = \"deg\" }\n\
    slave = { min = 0, max = 100, unit = \"mm\" }\nelements = [{ master = 0, slave = 0 }, { master = 360, slave = 100 }]\n\
    tappets = [{ group = 1, master = 90, action = \"timed\", duration_us = 5 }]\n[coupling]\nmaster_scaling = 1\n";
const CSV: &str = "master,slave,velocity,acceleration\n0,0,0,0\n180,50,0.1,0\n360,0,0,0\n";
const ASCII: &str = "0;0\r\n90;12.5\r\n180;50\r\n360;0\r\n";

/// Shipped ones.
const SHIPPED: [&str; 2] = [
    include_str!("../../../examples/cams/pick_and_place.toml"),
    include_str!("../../../examples/cams/flying_shear.toml"),
];

/// The forms in text, each with a file that is right.
const FORMS: [(&str, &str); 3] = [("toml", TOML), ("csv", CSV), ("asc", ASCII)];

const PIECES: [&str; 22] = [
    "\n",
    ";",
    ",",
    "\t",
    " ",
    "=",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "nan",
    "-inf",
    "1e999",
    "-1e308",
    "0x1",
    "99999999999999999999",
    "\u{0}",
    "ä",
    "tappet",
    "#",
    "period = 0\n",
];

fn load(folder: &Path, ending: &str, bytes: &[u8]) {
    let path = folder.join(format!("hostile.{ending}"));
    std::fs::write(&path, bytes).unwrap();
    let Err(error) = CamFile::load(&path, Interpolation::Cubic) else { return };
    let said = error.to_string();
    // CR alone ends a line in a file without LF.
    let lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r')).count();
    match error {
        CamFileError::Toml(error) => {
            assert!(said.contains("hostile.toml"), "{said}");
            if let MachineFileError::Content { text, problems, .. } = &error {
                assert!(!problems.is_empty());
                // The place is in the text: that is how its line is shown.
                assert!(problems.iter().all(|one| one.span.end <= text.len()), "{problems:?}");
            }
            for report in error.reports() {
                assert!(!format!("{report:?}").is_empty());
            }
        }
        CamFileError::Table { line, .. } => {
            assert!(usize::try_from(line).unwrap() <= lines, "{said}");
            assert!(said.contains("hostile.csv: line "), "{said}");
        }
        // The whole file lacks something.
        CamFileError::Ascii { source: AsciiError::TooFew { .. }, .. } => {
            assert!(said.contains("hostile."), "{said}");
        }
        CamFileError::Ascii { .. } => assert!(said.contains(": line "), "{said}"),
        _ => assert!(said.contains(&format!("hostile.{ending}")), "{said}"),
    }
}

/// What is a cam after all is looked at as a command would: nothing of it panics, and what is written of it is read again.
fn is_used(folder: &Path, text: String) {
    load(folder, "toml", text.as_bytes());
    let Ok(file) = CamFile::from_toml(Path::new("hostile.toml"), text) else { return };
    let master = MasterMotion { velocity: 100.0, acceleration: 50.0, jerk: 10.0 };
    let motion = SlaveLimits { velocity: 200.0, acceleration: 3000.0, jerk: 1e5 };
    let limits = AxisLimits { motion, position: [-1e3, 1e3], ..AxisLimits::NONE };
    let using =
        CamUse { master, coupling: file.coupling, repeated: file.repeated, limits, start: None };
    let check = CamCheck::new(&file, using);
    assert!(check.findings.iter().all(|finding| !finding.message.is_empty()));
    assert!(!check.json().to_string().is_empty());
    let mut out = Vec::new();
    write(&file, &using, Sampling::Count(50), &mut out).unwrap();
    assert_eq!(String::from_utf8(out).unwrap().lines().count(), 51);
    let again = CamFile::from_toml(Path::new("again.toml"), file.to_toml());
    assert!(again.is_ok(), "{:?}", again.map(|file| file.coupling));
}

#[test]
fn the_files_are_right_before_they_are_spoilt() {
    let folder = tempfile::tempdir().unwrap();
    for (ending, text) in FORMS {
        let path = folder.path().join(format!("right.{ending}"));
        std::fs::write(&path, text).unwrap();
        CamFile::load(&path, Interpolation::Cubic)
            .unwrap_or_else(|error| panic!("{ending}: {error}"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let folder = tempfile::tempdir().unwrap();
        for ending in ["toml", "csv", "asc", "txt", "cam"] {
            load(folder.path(), ending, &bytes);
        }
    }

    #[test]
    fn files_with_pieces_moved_are_survived(
        form in 0..FORMS.len(),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), 0usize..12, 0..PIECES.len()), 1..6),
    ) {
        let (ending, text) = FORMS[form];
        let mut text: Vec<char> = text.chars().collect();
        for (place, length, piece) in changes {
            let start = place.index(text.len() + 1);
            let end = (start + length).min(text.len());
            text.splice(start..end, PIECES[piece].chars());
        }
        let folder = tempfile::tempdir().unwrap();
        load(folder.path(), ending, text.into_iter().collect::<String>().as_bytes());
    }

    #[test]
    fn shipped_cams_with_pieces_moved_are_survived(
        which in 0..SHIPPED.len(),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), 0usize..20, 0..PIECES.len()), 1..5),
    ) {
        let mut text: Vec<char> = SHIPPED[which].chars().collect();
        for (place, length, piece) in changes {
            let start = place.index(text.len() + 1);
            let end = (start + length).min(text.len());
            text.splice(start..end, PIECES[piece].chars());
        }
        is_used(tempfile::tempdir().unwrap().path(), text.into_iter().collect());
    }

    #[test]
    fn shipped_cams_with_other_numbers_are_survived(
        which in 0..SHIPPED.len(),
        changes in proptest::collection::vec(
            (any::<prop::sample::Index>(), prop_oneof![
                any::<f64>().prop_map(|number| format!("{number:e}")),
                (-400.0..400.0f64).prop_map(|number| format!("{number:.3}")),
                any::<i64>().prop_map(|number| number.to_string()),
            ]),
            1..4,
        ),
    ) {
        let mut text = SHIPPED[which].to_owned();
        for (place, number) in changes {
            let starts: Vec<_> = text.match_indices("= ").map(|(at, _)| at + 2)
                .filter(|at| text[*at..].starts_with(|c: char| c == '-' || c.is_ascii_digit())).collect();
            let start = starts[place.index(starts.len())];
            let end = start + text[start..].find([' ', '\n', ',', ']']).unwrap();
            text.replace_range(start..end, &number);
        }
        is_used(tempfile::tempdir().unwrap().path(), text);
    }
}
