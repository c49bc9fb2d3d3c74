//! Tests of devices and of the axes that they drive.

use super::{DriveFamily, SHORT, edited, load, problems, refused};

#[test]
fn every_axis_has_a_drive_or_none() {
    let without = |text: &str, name: &str| {
        let from = text.find(&format!("drive = \"board\"\ndrive_axis = \"{name}\"")).unwrap();
        let to = from + text[from..].find("per_mm").unwrap();
        let to = to + text[to..].find('\n').unwrap() + 1;
        format!("{}{}", &text[..from], &text[to..])
    };
    let found = problems(&without(SHORT, "Y"));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].1, "axis \"Y\" has no `drive`, but others have: all or none");
    let none = without(&without(&without(SHORT, "X"), "Y"), "Z");
    assert!(load(&none).axes.iter().all(|axis| axis.drive.is_none()));
    assert_eq!(load(&none).axes[0].increments_per_si(), 0.0);
}

#[test]
fn a_drive_needs_its_axis_and_its_ratio() {
    for (key, line) in [
        ("drive_axis", "drive_axis = \"X\"\n"),
        ("increments", "increments = 3200\n"),
        ("per_mm", "per_mm = 10\n"),
    ] {
        let found = problems(&edited(SHORT, line, ""));
        let complaint = format!("an axis with a `drive` needs `{key}` too");
        assert!(found.iter().any(|(_, message, _)| *message == complaint), "{key}: {found:#?}");
    }
    // The other way round: a ratio without a drive is a drive that was forgotten.
    let found = problems(&edited(SHORT, "drive = \"board\"\n", ""));
    for key in ["drive_axis", "increments", "per_mm"] {
        let complaint = format!("`{key}` has no effect without a `drive`");
        assert!(found.iter().any(|(_, message, _)| *message == complaint), "{key}: {found:#?}");
    }
    refused("= 3200", "= 0", "0", &["`increments` is 0"]);
    refused("drive = \"board\"", "drive = \"bord\"", "\"bord\"", &["\"bord\"", "board"]);
    let two = edited(SHORT, "[[axes]]", "[[drives]]\nname = \"b\"\nkind = \"interpcnc\"\n[[axes]]");
    assert_eq!(load(&two).drives.len(), 2);
    let found = problems(&edited(&two, "\"b\"", "\"board\""));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].1, "there is a drive \"board\" already");
    // A bus has addresses, a module two axes.
    let bus = edited(SHORT, "\"interpcnc\"", "\"smartdrive\"");
    let found = problems(&bus);
    assert_eq!(found[0].1, "an axis with a `drive` needs `drive_address` too");
    assert_eq!(found[1].1, "axes of this drive are named by `drive_address`");
    let named = ["X", "Y", "Z"].into_iter().zip(1..).fold(bus, |text, (axis, address)| {
        edited(&text, &format!("drive_axis = \"{axis}\""), &format!("drive_address = {address}"))
    });
    let machine = load(&named);
    let places: Vec<_> =
        machine.axes.iter().map(|axis| axis.drive.as_ref().unwrap().index).collect();
    assert_eq!(places, [1, 2, 3]);
    let found = problems(&edited(&named, "drive_address = 2", "drive_address = 32"));
    assert!(found[0].1.contains("between 1 and 31"), "{found:#?}");
    let found = problems(&edited(&named, "drive_address = 2", "drive_address = 1"));
    assert_eq!(found[0].1, "axis \"X\" already hangs on this axis of the drive");
    let module = edited(SHORT, "\"interpcnc\"", "\"bim2ax\"");
    let module = edited(&module, "drive_axis = \"X\"", "drive_axis = \"1\"");
    let module = edited(&module, "drive_axis = \"Y\"", "drive_axis = \"2\"");
    assert!(problems(&module)[0].1.contains("expected \"1\" or \"2\""), "{module}");
    // What is wrong with a device is not wrong with its axes.
    refused("\"interpcnc\"", "\"interpcn\"", "\"interpcn\"", &["expected \"interpcnc\""]);
}

#[test]
fn a_drive_must_be_able_to_do_what_the_axis_may() {
    // 400 mm/s at 320 increments per mm are 128000 steps/s; at 640 they are 256000, above the board's 200 kHz.
    refused("= 3200", "= 6400", "6400", &["400 mm/s are 256000 steps/s", "4 to 200000"]);
    refused("= 3200", "= -6400", "-6400", &["256000 steps/s"]);
    load(&edited(SHORT, "= 3200", "= 5000"));
    refused("= 3200\nper_mm = 10\n", "= 1\nper_mm = 1000\n", "1", &["400 mm/s are 0 steps/s"]);
    // 2^31 / 320 increments per mm are 6710.9 m.
    let far = |mm: &str| edited(SHORT, "position_max_mm = 650", &format!("position_max_mm = {mm}"));
    let fine = edited(&far("1000000"), "= 3200\nper_mm = 10", "= 2147\nper_mm = 1");
    let fine = edited(&fine, "max_velocity_mm_per_s = 400", "max_velocity_mm_per_s = 90");
    load(&fine);
    let found = problems(&edited(&fine, "= 2147\n", "= 2148\n"));
    assert_eq!((found.len(), found[0].0.as_str()), (1, "2148"));
    assert!(found[0].1.contains("2148000000 increments; the drive counts to 2147483647"));
}

/// The manuals of boards and drives speak of addresses; the place of one is reported.
#[test]
fn an_address_is_told_where_it_belongs() {
    for key in ["address", "drive_address"] {
        let found = problems(&edited(SHORT, "[[drives]]", &format!("[[drives]]\n{key} = 3")));
        let [(place, message, help)] = &found[..] else { panic!("{found:#?}") };
        assert_eq!(place, "3");
        assert!(message.contains("the Modbus address of a board is `station`"), "{message}");
        assert!(help.as_ref().unwrap().contains("`station = …`, 1 to 247"), "{help:?}");
    }
    for (kind, key, parts) in [
        ("smartdrive", "address", ["each axis gives the address", "`drive_address = …`, 1 to 31"]),
        ("smartdrive", "station", ["each axis gives the address", "`drive_address = …`, 1 to 31"]),
        ("bim2ax", "address", ["a module has no address", "`map_offset`"]),
    ] {
        let text = edited(SHORT, "kind = \"interpcnc\"", &format!("kind = \"{kind}\"\n{key} = 3"));
        let found = problems(&text);
        let problem = found.iter().find(|(_, message, _)| {
            message.contains(key) && message.contains(" does not belong here")
        });
        let (_, message, help) = problem.unwrap_or_else(|| panic!("{found:#?}"));
        let help = help.as_ref().unwrap();
        assert!(message.contains(parts[0]) && help.contains(parts[1]), "{message}; {help}");
    }
}

/// What a device has to know of switches; the axis's own sense counts, whichever way its drive turns.
#[test]
fn switches_are_said_beside_the_drive() {
    let with = |lines: &str| edited(SHORT, "per_mm = 10\n", &format!("per_mm = 10\n{lines}\n"));
    let of = |lines: &str| load(&with(lines)).axes[0].drive.as_ref().unwrap().switches;
    let none = of("");
    assert_eq!((none.limits, none.home_positive), (None, None));
    for (word, limits) in [
        ("none", [false, false]),
        ("negative", [true, false]),
        ("positive", [false, true]),
        ("both", [true, true]),
    ] {
        assert_eq!(of(&format!("limit_switches = \"{word}\"")).limits, Some(limits));
    }
    assert_eq!(of("home_direction = \"positive\"").home_positive, Some(true));
    assert_eq!(of("home_direction = \"negative\"").home_positive, Some(false));
    let found = problems(&with("limit_switches = \"left\""));
    assert_eq!((found.len(), found[0].0.as_str()), (1, "\"left\""), "{found:#?}");
    assert!(found[0].1.contains("both"), "{found:#?}");
    let without = edited(SHORT, "drive = \"board\"\n", "home_direction = \"positive\"\n");
    let said = "`home_direction` has no effect without a `drive`";
    assert!(problems(&without).iter().any(|(_, message, _)| message == said));
    let reversed = edited(SHORT, "= 3200\nper_mm = 10", "= -3200\nper_mm = 10");
    assert!(load(&reversed).axes[0].drive.as_ref().unwrap().reversed());
}

/// What the file says of encoders, and everything that is wrong with it, each at its place.
#[test]
fn encoders_are_declared_beside_their_device() {
    let of = |kind: &str, keys: &str| {
        edited(
            SHORT,
            "kind = \"interpcnc\"",
            &format!("kind = \"{kind}\"\n[drives.encoder]\n{keys}\n"),
        )
    };
    let keys = "axis = \"Y\"\npoints = -4000\nper_increments = 3200\ntolerance_increments = 64";
    let machine = load(&of("interpcnc", keys));
    let encoder = super::board(&machine).encoder.expect("it is there");
    assert_eq!(encoder.axis, twin_interpcnc::BoardAxis::Y);
    assert_eq!((encoder.points, encoder.increments, encoder.tolerance), (-4000, 3200, 64));
    assert_eq!(super::board(&load(SHORT)).encoder, None);
    for (old, new, place, parts) in [
        ("points = -4000", "points = 0", "0", "an encoder that never counts"),
        ("\"Y\"\np", "\"B\"\np", "\"B\"", "no entry of [[axes]] uses axis B of this drive"),
        ("\"Y\"\np", "\"V\"\np", "\"V\"", "expected \"X\""),
        ("= 3200\nt", "= 0\nt", "0", "between 1 and 1000000000"),
        ("= 64", "= -1", "-1", "between 0 and 1000000"),
        ("tolerance_increments", "tolerance", "tolerance", "unknown key `tolerance`"),
    ] {
        assert!(keys.contains(old));
        let found = problems(&of("interpcnc", &keys.replace(old, new)));
        let problem = found.iter().find(|(at, message, _)| at == place && message.contains(parts));
        assert!(problem.is_some(), "{new}: {found:#?}");
    }
    let found = problems(&of("interpcnc", "axis = \"X\""));
    for key in ["points", "per_increments", "tolerance_increments"] {
        let lacks = format!("[encoder] lacks `{key}`");
        assert!(found.iter().any(|(_, message, _)| *message == lacks), "{found:#?}");
    }

    // A module's, of which X alone hangs on it here.
    let module = |keys: &str| {
        let text = edited(
            SHORT,
            "[[axes]]\nname = \"X\"",
            &format!(
                "[[drives]]\nname = \"module\"\nkind = \"bim2ax\"\nmicrosteps = 8\n[drives.encoder]\n{keys}\n[[axes]]\nname = \"X\""
            ),
        );
        let text = edited(
            &text,
            "drive = \"board\"\ndrive_axis = \"X\"",
            "drive = \"module\"\ndrive_axis = \"2\"",
        );
        text.replace("max_velocity_mm_per_s = 400", "max_velocity_mm_per_s = 100")
    };
    let machine = load(&module("axes = [2]\npoints_per_turn = 4000"));
    let DriveFamily::Bim2Ax(entry) = machine.drives[1].family() else { panic!("a module") };
    let encoder = entry.encoder.as_ref().expect("it is there");
    assert_eq!(encoder.axes, [twin_bim2ax::ModuleAxis::Two]);
    // 200 steps of 8.
    let found = (encoder.points_per_turn, encoder.increments_per_turn, encoder.tolerance);
    assert_eq!(found, (4000, 1600, None));
    let rest = "points_per_turn = 4000\nincrements_per_turn = 3200\ntolerance_increments = 9";
    let machine = load(&module(&format!("axes = [2]\n{rest}")));
    let DriveFamily::Bim2Ax(entry) = machine.drives[1].family() else { panic!("a module") };
    let encoder = entry.encoder.as_ref().expect("it is there");
    assert_eq!((encoder.increments_per_turn, encoder.tolerance), (3200, Some(9)));
    for (axes, parts) in [
        ("axes = [1, 2]", "no entry of [[axes]] uses axis 1 of this drive"),
        ("axes = []", "`axes` names none"),
        ("axes = [3]", "between 1 and 2"),
        ("axes = \"2\"", "an array of whole numbers"),
        ("axis = 2", "unknown key `axis`"),
    ] {
        let found = problems(&module(&format!("{axes}\n{rest}")));
        assert!(found.iter().any(|(_, message, _)| message.contains(parts)), "{axes}: {found:#?}");
    }
    // SmartDRIVEs tell a held shaft themselves.
    let found = problems(&of("smartdrive", "points = 4"));
    assert!(
        found.iter().any(|(_, message, _)| message.contains("unknown key `encoder`")),
        "{found:#?}"
    );
}
