//! Tests of the errors: numbers, names and blocks of the manual's list (9.3), and texts in three languages.

use super::{Language, SmcError, TABLE};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// The rows of the manual's list (9.3), one of the coverage table each: "number `name` text (`block`)".
const COVERAGE: &str = include_str!("../../../tests/coverage/softmotion_error.csv");

const LANGUAGES: [Language; 3] = [Language::English, Language::German, Language::French];

/// Raisers that are not one block.
const SEVERAL: [(&str, &[u16]); 6] = [
    ("every block", &[0, 31]),
    ("drive interface", &[1, 10, 30]),
    ("motion blocks", &[20, 32]),
    ("blocks that take a cam", &[750]),
    ("blocks that take a CNC program", &[1500]),
    ("blocks that take a queue", &[1501]),
];

/// Where the manual prints another block than is meant: that of 251 for 276, and names of its other chapters.
const MISPRINTED: [(u16, &str); 5] = [
    (276, "MC_MoveAdditive"),
    (277, "MC_MoveAdditive"),
    (725, "MC_Phase"),
    (726, "MC_Phase"),
    (775, "MC_GearInPos"),
];

fn several(error: SmcError) -> Option<&'static str> {
    let found = SEVERAL.iter().find(|(_, numbers)| numbers.contains(&error.number()));
    found.map(|(raisers, _)| *raisers)
}

/// Numbers, names and blocks; every name once.
#[test]
fn every_number_of_the_manual_is_there() {
    let rows = COVERAGE.lines().filter_map(|row| {
        let item = row.split_once(",SMC_Error,9.3,")?.1.trim_start_matches('"');
        let (number, rest) = item.split_once(" `")?;
        let (name, text) = rest.split_once("` ")?;
        Some((number.parse::<u16>().ok()?, name, text))
    });
    let rows: Vec<_> = rows.collect();
    assert_eq!(rows.len(), SmcError::ALL.len());
    for (error, (number, name, text)) in SmcError::ALL.iter().zip(rows) {
        assert_eq!((error.number(), error.name()), (number, name));
        match several(*error) {
            Some(raisers) => assert_eq!(error.raised_by(), raisers),
            None => assert!(text.contains(&format!("(`{}`", error.raised_by())), "{error}: {text}"),
        }
    }
    let known = (0..=u16::MAX).filter_map(SmcError::from_number);
    assert!(known.eq(SmcError::ALL.iter().copied()), "a number too many");
    let names: BTreeSet<_> = SmcError::ALL.iter().map(|error| error.name()).collect();
    assert_eq!(names.len(), SmcError::ALL.len());
    assert!(names.iter().all(|name| name.starts_with("SMC_")));
}

/// The list is that of the manual's text, but for its misprints. Skipped where that is not at hand.
#[test]
fn the_list_is_the_manuals() {
    let Some(path) = text() else {
        println!("skipped: no text of the manual (TWIN_SHARED, ../shared)");
        return;
    };
    let text = fs::read_to_string(path).expect("the text of the manual");
    // Four columns: number, block, name and description. Names have the blanks of line breaks.
    let rows = text.lines().filter_map(|line| {
        let cells: Vec<_> = line.split('\t').collect();
        let [number, block, name, _] = cells.as_slice() else { return None };
        let name = name.replace(' ', "");
        let number: u16 = number.parse().ok()?;
        name.starts_with("SMC_").then(|| (number, name, (*block).to_owned()))
    });
    let rows: Vec<_> = rows.collect();
    assert_eq!(rows.len(), SmcError::ALL.len());
    for (error, (number, name, block)) in SmcError::ALL.iter().zip(rows) {
        // The name of 131 is printed as that of 130.
        let meant = if number == 131 { "SMC_RP_REQUESTING_ERROR" } else { &name };
        assert_eq!((error.number(), error.name()), (number, meant));
        let misprint = MISPRINTED.iter().find(|(misprinted, _)| *misprinted == number);
        let raiser = misprint.map_or(error.raised_by(), |(_, printed)| *printed);
        let first = block.split(',').next().unwrap_or_default();
        let same = if several(*error).is_some() {
            ["tous", "Tous les modules", "DriveInterface"].iter().any(|it| first.starts_with(it))
        } else {
            first.eq_ignore_ascii_case(raiser)
        };
        assert!(same, "{error}: {block}");
    }
}

fn text() -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?.parent()?;
    let shared = env::var_os("TWIN_SHARED").map_or(workspace.join("../shared"), PathBuf::from);
    let path = shared.join("manuals/softmotion-2.3.fr.txt");
    path.is_file().then_some(path)
}

/// The table has a row per error, in the order of the numbers, with its name and a text in every column.
#[test]
fn every_error_has_its_row() {
    let rows: Vec<Vec<_>> = TABLE.lines().skip(1).map(|row| row.split('\t').collect()).collect();
    let heads: Vec<_> = rows.iter().map(|row| (row[0].to_owned(), row[1])).collect();
    let errors = SmcError::ALL.iter().map(|error| (error.number().to_string(), error.name()));
    assert_eq!(heads, errors.collect::<Vec<_>>());
    for row in rows {
        assert_eq!(row.len(), 11, "{row:?}");
        assert!(row.iter().all(|cell| !cell.is_empty() && cell.trim() == *cell), "{row:?}");
    }
}

/// Raisers that are not the name of a block have a text in every language.
#[test]
fn raisers_have_a_text_in_three_languages() {
    for error in SmcError::ALL {
        let [english, german, french] = LANGUAGES.map(|language| error.raised_by_in(language));
        assert_eq!(english, error.raised_by());
        if english.starts_with("SMC_") || english.starts_with("MC_") {
            assert_eq!([german, french], [english; 2], "{error}");
        } else {
            assert!(german != english && french != english && german != french, "{error}");
        }
    }
}

#[test]
fn every_error_has_a_text_in_three_languages() {
    let mut umlauts = 0;
    for error in SmcError::ALL {
        let texts = LANGUAGES.map(|language| error.text(language));
        let remedies = LANGUAGES.map(|language| error.remedy(language));
        // An IEC STRING(100) holds a text (SMC_ErrorString).
        for (texts, lengths) in [(texts, 5..=100), (remedies, 15..=usize::MAX)] {
            let [english, german, french] = texts;
            assert!(texts.iter().all(|it| lengths.contains(&it.chars().count())), "{texts:?}");
            assert!(english != german && german != french && french != english, "{error}");
        }
        // Names of inputs, blocks and constants are the same in all of them.
        let names = |text: &str| {
            let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            let named = words.filter(|word| word.contains('_') && word.len() > 4);
            named.map(str::to_owned).collect::<BTreeSet<_>>()
        };
        let [english, german, french] = remedies.map(names);
        assert_eq!([&german, &french], [&english; 2], "{error}");
        umlauts += usize::from(remedies[1].contains(['ä', 'ü', 'ö']));
    }
    assert!(umlauts > 20, "{umlauts}");
    let error = SmcError::CiMasterOutOfScale;
    let texts = [error.text(Language::German), error.text(Language::French), &error.to_string()];
    let expected = [
        "der Master ist außerhalb des Bereichs der Kurvenscheibe",
        "l'axe maître est en dehors de la plage de la came",
        "626 SMC_CI_MASTER_OUT_OF_SCALE: the master is outside the range of the cam",
    ];
    assert_eq!(texts, expected);
    // The remedy names the directions that an end velocity may have.
    for error in [SmcError::McrInvalidDirection, SmcError::McaInvalidDirection] {
        let remedy = error.remedy(Language::English);
        assert!(remedy.starts_with("give positive, negative or current as EndVelocityDirection"));
    }
}
