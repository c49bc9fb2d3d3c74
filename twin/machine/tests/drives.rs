//! Devices and the axes that hang on them.

use super::{SHORT, edited, load, problems, refused};

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
        let complaint = format!("`{key}` says nothing without a `drive`");
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

/// The manuals of boards and drives speak of addresses; where one is written is told.
#[test]
fn an_address_is_told_where_it_belongs() {
    for key in ["address", "drive_address"] {
        let found = problems(&edited(SHORT, "[[drives]]", &format!("[[drives]]\n{key} = 3")));
        let [(place, message, help)] = &found[..] else { panic!("{found:#?}") };
        assert_eq!(place, "3");
        assert!(message.contains("its Modbus address is `station` here"), "{message}");
        assert!(help.as_ref().unwrap().contains("`station = …`, 1 to 247"), "{help:?}");
    }
    for (kind, key, parts) in [
        ("smartdrive", "address", ["each axis says the address", "`drive_address = …`, 1 to 31"]),
        ("smartdrive", "station", ["each axis says the address", "`drive_address = …`, 1 to 31"]),
        ("bim2ax", "address", ["a module, which has no address", "`map_offset`"]),
    ] {
        let text = edited(SHORT, "kind = \"interpcnc\"", &format!("kind = \"{kind}\"\n{key} = 3"));
        let found = problems(&text);
        let told = found
            .iter()
            .find(|(_, message, _)| message.contains(key) && message.contains(" is no key of "));
        let (_, message, help) = told.unwrap_or_else(|| panic!("{found:#?}"));
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
    let said = "`home_direction` says nothing without a `drive`";
    assert!(problems(&without).iter().any(|(_, message, _)| message == said));
    let reversed = edited(SHORT, "= 3200\nper_mm = 10", "= -3200\nper_mm = 10");
    assert!(load(&reversed).axes[0].drive.as_ref().unwrap().reversed());
}
