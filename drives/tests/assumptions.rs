//! Everything that the digests of the manuals mark as an assumption, and the option that decides it.
//!
//! The tables `QUESTIONS` say what is assumed of which line, what else can be chosen and what the driver makes of it.
//! Here the lines are typed off the digests once more, and the options are walked over field by field: an assumption
//! without an option fails, and so does a field of `Assumptions` that no table explains.

use std::collections::BTreeMap;

use twin_bim2ax as bim2ax;
use twin_drives::{Assumed, AssumedError};
use twin_interpcnc as interpcnc;
use twin_smartdrive as smartdrive;

/// Lines of the digest of InterpCNC with assumptions, once for each.
const INTERPCNC: [u16; 13] = [7, 11, 11, 11, 23, 77, 97, 97, 107, 107, 111, 113, 117];
/// The same of SmartDRIVE.
const SMARTDRIVE: [u16; 19] =
    [9, 10, 13, 75, 75, 77, 79, 79, 83, 83, 83, 83, 85, 93, 126, 139, 143, 147, 148];
/// The same of BIM2AX.
const BIM2AX: [u16; 12] = [15, 40, 41, 42, 44, 93, 93, 94, 95, 95, 100, 166];

/// What `Debug` shows, without spaces and commas, which it sets otherwise over several lines.
fn plain(text: &str) -> String {
    text.chars().filter(|character| !character.is_whitespace() && *character != ',').collect()
}

/// Fields of a value with their values, as `Debug` shows them: one begins on each line that is four spaces in.
fn fields(value: &impl std::fmt::Debug) -> BTreeMap<String, String> {
    let shown = format!("{value:#?}");
    let mut fields: Vec<String> = Vec::new();
    for piece in shown.trim_end_matches("\n}").split("\n    ").skip(1) {
        match fields.last_mut() {
            Some(field) if piece.starts_with([' ', '}', ']', ')']) => *field += piece,
            _ => fields.push(piece.to_owned()),
        }
    }
    let parted = |field: &String| {
        let (name, value) = field.split_once(": ").unwrap();
        (name.to_owned(), plain(value))
    };
    fields.iter().map(parted).collect()
}

/// Compares a table with the lines of the digest and the options that it names.
fn check<A: Assumed + std::fmt::Debug>(
    lines: &[u16],
    [driver, device]: [&A; 2],
    others: &[(&str, BTreeMap<String, String>)],
) {
    assert_eq!(driver, device);
    let questions = A::QUESTIONS;
    for line in lines {
        let found: Vec<_> = questions.iter().filter(|question| question.line == *line).collect();
        let count = lines.iter().filter(|other| *other == line).count();
        assert!(found.len() >= count, "line {line} has {count} assumptions: {found:?}");
    }
    let assumed = fields(driver);
    assert!(assumed.len() > 10, "{assumed:?}");
    for question in questions {
        let known = question.line == 0 || lines.contains(&question.line);
        assert!(known, "{question:?}");
        let (of, field) = question.option.split_once('.').unwrap();
        let options = if of == "Assumptions" {
            &assumed
        } else {
            &others.iter().find(|(name, _)| *name == of).unwrap().1
        };
        let default = options.get(field).map(String::as_str);
        // Defaults of assumptions are those of the table that makes the question.
        if of == "Assumptions" {
            assert!(default.is_some(), "{question:?}");
        } else {
            assert_eq!(default, Some(plain(question.default).as_str()), "{question:?}");
        }
        let said = [question.question, question.alternatives, question.driver];
        assert!(said.iter().all(|text| !text.is_empty()), "{question:?}");
    }
    for field in assumed.keys() {
        let option = format!("Assumptions.{field}");
        let asked = questions.iter().filter(|question| question.option == option).count();
        assert_eq!(asked, 1, "{option}");
    }
}

#[test]
fn every_assumption_about_the_board_has_an_option() {
    let driver = interpcnc::InterpCncOptions::new(Vec::new());
    let board = interpcnc::emulator::BoardOptions::default();
    let others = [("BoardOptions", fields(&board)), ("InterpCncOptions", fields(&driver))];
    check(&INTERPCNC, [&driver.assumptions, &board.assumptions], &others);
}

#[test]
fn every_assumption_about_the_drives_has_an_option() {
    use smartdrive::emulator::{DeviceOptions, Wire};
    let driver = smartdrive::SmartDriveOptions::new(Vec::new());
    let device = DeviceOptions::default();
    let others = [
        ("DeviceOptions", fields(&device)),
        ("SmartDriveOptions", fields(&driver)),
        ("Wire", fields(&Wire::default())),
    ];
    check(&SMARTDRIVE, [&driver.assumptions, &device.assumptions], &others);
}

#[test]
fn every_assumption_about_the_module_has_an_option() {
    let driver = bim2ax::Bim2AxOptions::default();
    let module = bim2ax::emulator::ModuleOptions::default();
    let others = [("ModuleOptions", fields(&module)), ("Bim2AxOptions", fields(&driver))];
    check(&BIM2AX, [&driver.assumptions, &module.assumptions], &others);
}

/// The walk over fields sees them all, whatever they hold.
#[test]
fn fields_are_told_apart() {
    #[derive(Debug)]
    #[expect(dead_code, reason = "shown only")]
    struct Fields<T> {
        one: u8,
        many: Option<(u8, u8)>,
        last: T,
    }
    let last = Fields { one: 4, many: None, last: () };
    let seen = fields(&Fields { one: 1, many: Some((2, 3)), last });
    let last = "Fields{one:4many:Nonelast:()}";
    let expected = [("last", last), ("many", "Some((23))"), ("one", "1")];
    assert!(seen.iter().map(|(name, value)| (name.as_str(), value.as_str())).eq(expected));
}

/// Every field can be set by its name, to everything that is said to be allowed, and to nothing else.
fn check_names<A: Assumed + std::fmt::Debug + PartialEq>() {
    let assumed = fields(&A::default());
    for field in assumed.keys() {
        assert!(A::NAMES.iter().any(|name| name.starts_with(field.as_str())), "{field}");
    }
    for name in A::NAMES {
        assert!(A::question(name).is_some(), "{name} answers no question");
        let values = A::values(name).unwrap();
        let allowed = values.allowed;
        let (mut seen, mut count) = (Vec::new(), 0);
        for value in allowed.split(" or ").flat_map(|part| part.split(" to ")) {
            let mut changed = A::default();
            changed.set(&name.replace('_', "-"), value).unwrap();
            if !seen.contains(&changed) {
                seen.push(changed);
            }
            count += 1;
        }
        // Each value is another assumption, and not all are the usual one.
        assert_eq!(seen.len(), count, "{name}: {allowed}");
        assert!(count > 1, "{name}: {allowed}");
        // What is assumed otherwise nothing, as people say it.
        let mut said = A::default();
        said.set(name, &values.usual).unwrap();
        assert_eq!(said, A::default(), "{name}");
        assert_ne!(values.unit.is_empty(), allowed.contains(" to "), "{name}: {}", values.unit);
        let wrong = A::default().set(name, "perhaps");
        assert!(matches!(wrong, Err(AssumedError::Value { .. })), "{wrong:?}");
    }
    let unknown = A::default().set("nonsense", "true").unwrap_err().to_string();
    assert!(A::NAMES.iter().all(|name| unknown.contains(name)), "{unknown}");
}

#[test]
fn every_assumption_has_a_name() {
    check_names::<interpcnc::Assumptions>();
    check_names::<smartdrive::Assumptions>();
    check_names::<bim2ax::Assumptions>();
}
