//! Tests of devices and of the axes that they drive.

use super::{DriveFamily, SHORT, edited, load, problems};

#[test]
fn no_axis_needs_a_drive() {
    let of_drive = ["drive = ", "drive_axis", "increments", "per_mm"];
    let lines = SHORT.lines().filter(|line| !of_drive.iter().any(|key| line.starts_with(key)));
    let machine = load(&lines.collect::<Vec<_>>().join("\n"));
    assert!(machine.axes.iter().all(|axis| axis.drive.is_none()));
    assert_eq!(machine.axes[0].increments_per_si(), 0.0);
}

#[test]
fn axes_are_places_of_their_drive() {
    let two = edited(SHORT, "[[axes]]", "[[drives]]\nname = \"b\"\nkind = \"interpcnc\"\n[[axes]]");
    assert_eq!(load(&two).drives.len(), 2);
    // A bus has addresses, a module two axes.
    let bus = edited(SHORT, "\"interpcnc\"", "\"smartdrive\"");
    let named = ["X", "Y", "Z"].into_iter().zip(1..).fold(bus, |text, (axis, address)| {
        edited(&text, &format!("drive_axis = \"{axis}\""), &format!("drive_address = {address}"))
    });
    let machine = load(&named);
    let places = machine.axes.iter().map(|axis| axis.drive.as_ref().unwrap().index);
    assert!(places.eq([1, 2, 3]));
    let second =
        |address| edited(&named, "drive_address = 2", &format!("drive_address = {address}"));
    assert!(problems(&second(32))[0].1.contains("between 1 and 31"));
    let twice = "axis \"X\" already hangs on this axis of the drive";
    assert_eq!(problems(&second(1))[0].1, twice);
    let module = edited(SHORT, "\"interpcnc\"", "\"bim2ax\"");
    let module = edited(&module, "drive_axis = \"X\"", "drive_axis = \"1\"");
    let module = edited(&module, "drive_axis = \"Y\"", "drive_axis = \"2\"");
    assert!(problems(&module)[0].1.contains("expected \"1\" or \"2\""), "{module}");
}

#[test]
fn a_drive_must_be_able_to_do_what_the_axis_may() {
    // 400 mm/s at 500 increments per mm are 200000 steps/s, the board's most.
    load(&edited(SHORT, "= 3200", "= 5000"));
    // 2^31 / 320 increments per mm are 6710.9 m.
    let far = |mm: &str| edited(SHORT, "position_max_mm = 650", &format!("position_max_mm = {mm}"));
    let fine = edited(&far("1000000"), "= 3200\nper_mm = 10", "= 2147\nper_mm = 1");
    let fine = edited(&fine, "max_velocity_mm_per_s = 400", "max_velocity_mm_per_s = 90");
    load(&fine);
    let found = problems(&edited(&fine, "= 2147\n", "= 2148\n"));
    assert_eq!((found.len(), found[0].0.as_str()), (1, "2148"));
    assert!(found[0].1.contains("2148000000 increments; the drive counts to 2147483647"));
}

/// What a device has to know of switches; the axis's own sense counts, whichever way its drive turns.
#[test]
fn switches_are_keys_of_the_drive() {
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
    let reversed = edited(SHORT, "= 3200\nper_mm = 10", "= -3200\nper_mm = 10");
    assert!(load(&reversed).axes[0].drive.as_ref().unwrap().reversed());
}

/// Keys of an encoder of the Y axis.
pub(super) const BOARD_ENCODER: &str =
    "axis = \"Y\"\npoints = -4000\nper_increments = 3200\ntolerance_increments = 64";

/// [`SHORT`] with a device of `kind` that has an encoder with `keys`.
pub(super) fn encoder(kind: &str, keys: &str) -> String {
    let device = format!("kind = \"{kind}\"\n[drives.encoder]\n{keys}\n");
    edited(SHORT, "kind = \"interpcnc\"", &device)
}

/// [`SHORT`] with its X axis on a module whose encoder has `keys`.
pub(super) fn module(keys: &str) -> String {
    let device =
        "[[drives]]\nname = \"module\"\nkind = \"bim2ax\"\nmicrosteps = 8\n[drives.encoder]";
    let x = "[[axes]]\nname = \"X\"";
    let text = edited(SHORT, x, &format!("{device}\n{keys}\n{x}"));
    let [board, module] = [["board", "X"], ["module", "2"]]
        .map(|[drive, axis]| format!("drive = \"{drive}\"\ndrive_axis = \"{axis}\""));
    edited(&text, &board, &module)
        .replace("max_velocity_mm_per_s = 400", "max_velocity_mm_per_s = 100")
}

#[test]
fn encoders_are_keys_of_their_device() {
    let machine = load(&encoder("interpcnc", BOARD_ENCODER));
    let encoder = super::board(&machine).encoder.expect("it is there");
    assert_eq!(encoder.axis, twin_interpcnc::BoardAxis::Y);
    assert_eq!((encoder.points, encoder.increments, encoder.tolerance), (-4000, 3200, 64));
    assert_eq!(super::board(&load(SHORT)).encoder, None);

    let rest = "axes = [2]\npoints_per_turn = 4000";
    let given = format!("{rest}\nincrements_per_turn = 3200\ntolerance_increments = 9");
    // By default the 200 steps of 8 microsteps.
    for (keys, increments, tolerance) in [(rest, 1600, None), (given.as_str(), 3200, Some(9))] {
        let machine = load(&module(keys));
        let DriveFamily::Bim2Ax(entry) = machine.drives[1].family() else { panic!("a module") };
        let encoder = entry.encoder.as_ref().expect("it is there");
        assert_eq!(encoder.axes, [twin_bim2ax::ModuleAxis::Two]);
        let found = (encoder.points_per_turn, encoder.increments_per_turn, encoder.tolerance);
        assert_eq!(found, (4000, increments, tolerance));
    }
}
