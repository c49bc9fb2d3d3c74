//! Everything that the digests of the manuals mark as an assumption, and the option that decides it.
//!
//! The tables `QUESTIONS` say what is assumed of which line, what else can be chosen and what the driver makes of it.
//! Here the lines are typed off the digests once more, and the options are walked over field by field: an assumption
//! without an option fails, and so does a field of `Assumptions` that no table explains.

use std::collections::BTreeMap;

use twin_bim2ax as bim2ax;
use twin_drives::{Assumed, AssumedError, OpenQuestion};
use twin_interpcnc as interpcnc;
use twin_smartdrive as smartdrive;

/// Lines of the digest of InterpCNC, and how many assumptions stand on each.
const INTERPCNC: [(u16, usize); 9] =
    [(7, 1), (11, 3), (23, 1), (77, 1), (97, 2), (107, 2), (111, 1), (113, 1), (117, 1)];
/// The same of SmartDRIVE.
const SMARTDRIVE: [(u16, usize); 14] = [
    (9, 1),
    (10, 1),
    (13, 1),
    (75, 2),
    (77, 1),
    (79, 2),
    (83, 4),
    (85, 1),
    (93, 1),
    (126, 1),
    (139, 1),
    (143, 1),
    (147, 1),
    (148, 1),
];
/// The same of BIM2AX.
const BIM2AX: [(u16, usize); 10] =
    [(15, 1), (40, 1), (41, 1), (42, 1), (44, 1), (93, 2), (94, 1), (95, 2), (100, 1), (166, 1)];

/// What `Debug` shows, without spaces and commas, which it sets otherwise over several lines.
fn plain(text: &str) -> String {
    text.chars().filter(|character| !character.is_whitespace() && *character != ',').collect()
}

/// Fields of a value with their values, as `Debug` shows them.
fn fields(value: &impl std::fmt::Debug) -> BTreeMap<String, String> {
    let shown = format!("{value:#?}");
    let mut fields = BTreeMap::new();
    let mut name = String::new();
    for line in shown.lines().skip(1) {
        let inside = line.strip_prefix("    ");
        if let Some((field, rest)) = inside
            .filter(|inside| !inside.starts_with([' ', '}', ']', ')']))
            .and_then(|inside| inside.split_once(": "))
        {
            field.clone_into(&mut name);
            fields.insert(name.clone(), plain(rest));
        } else if let Some(inside) = inside {
            *fields.get_mut(&name).unwrap() += &plain(inside);
        }
    }
    fields
}

/// Compares a table with the lines of the digest and the options that it names.
fn check<A: std::fmt::Debug>(
    questions: &[OpenQuestion],
    lines: &[(u16, usize)],
    assumptions: &A,
    others: &[(&str, BTreeMap<String, String>)],
) {
    for (line, count) in lines {
        let found: Vec<_> = questions.iter().filter(|question| question.line == *line).collect();
        assert!(found.len() >= *count, "line {line} has {count} assumptions: {found:?}");
    }
    let assumed = fields(assumptions);
    assert!(assumed.len() > 10, "{assumed:?}");
    for question in questions {
        let known = question.line == 0 || lines.iter().any(|(line, _)| *line == question.line);
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
    assert_eq!(driver.assumptions, board.assumptions);
    check(
        interpcnc::Assumptions::QUESTIONS,
        &INTERPCNC,
        &driver.assumptions,
        &[("BoardOptions", fields(&board)), ("InterpCncOptions", fields(&driver))],
    );
}

#[test]
fn every_assumption_about_the_drives_has_an_option() {
    use smartdrive::emulator::{DeviceOptions, Wire};
    let driver = smartdrive::SmartDriveOptions::new(Vec::new());
    let device = DeviceOptions::default();
    assert_eq!(driver.assumptions, device.assumptions);
    check(
        smartdrive::Assumptions::QUESTIONS,
        &SMARTDRIVE,
        &driver.assumptions,
        &[
            ("DeviceOptions", fields(&device)),
            ("SmartDriveOptions", fields(&driver)),
            ("Wire", fields(&Wire::default())),
        ],
    );
}

#[test]
fn every_assumption_about_the_module_has_an_option() {
    let driver = bim2ax::Bim2AxOptions::default();
    let module = bim2ax::emulator::ModuleOptions::default();
    assert_eq!(driver.assumptions, module.assumptions);
    check(
        bim2ax::Assumptions::QUESTIONS,
        &BIM2AX,
        &driver.assumptions,
        &[("ModuleOptions", fields(&module)), ("Bim2AxOptions", fields(&driver))],
    );
}

/// The walk over fields sees them all, whatever they hold.
#[test]
fn fields_are_told_apart() {
    #[derive(Debug)]
    #[expect(dead_code, reason = "shown only")]
    struct Outer {
        one: u8,
        many: Option<(u8, u8)>,
        last: Inner,
    }
    #[derive(Debug)]
    #[expect(dead_code, reason = "shown only")]
    struct Inner {
        one: u8,
    }
    let seen = fields(&Outer { one: 1, many: Some((2, 3)), last: Inner { one: 4 } });
    let expected = [("last", "Inner{one:4}"), ("many", "Some((23))"), ("one", "1")];
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
