//! Tests of machine files, valid and invalid.

#![expect(clippy::float_cmp, reason = "given in the file, rounded before, or to be exact")]

mod belts;
mod couplings;
mod drives;
mod kinds;
mod limits;
mod payload;
mod programs;
mod scenario;
mod simulated;
mod simulation_error;
mod surroundings;
mod survival;

use super::{Axis, DriveFamily, Machine};
use crate::axis_kind::AxisKind;
use crate::section::{MachineFileError, Problem};
use std::path::Path;
use twin_interpcnc::{Following, InterpCncEntry, Parity};
use twin_kinematics::{AxisVector, Kinematics, Pose};

const SCARA2: &str = include_str!("../../../machines/scara2.toml");
const GANTRY3: &str = include_str!("../../../machines/gantry3.toml");

/// As short as a machine with a drive can be.
const SHORT: &str = r#"name = "portal"
[kinematics]
kind = "gantry3"
[[drives]]
name = "board"
kind = "interpcnc"
[[axes]]
name = "X"
kind = "linear"
position_min_mm = -50
position_max_mm = 650
max_velocity_mm_per_s = 400
max_acceleration_mm_per_s2 = 3000
drive = "board"
drive_axis = "X"
increments = 3200
per_mm = 10
[[axes]]
name = "Y"
kind = "linear"
position_min_mm = -250
position_max_mm = 450
max_velocity_mm_per_s = 400
max_acceleration_mm_per_s2 = 3000
drive = "board"
drive_axis = "Y"
increments = 3200
per_mm = 10
[[axes]]
name = "Z"
kind = "linear"
position_min_mm = -60
position_max_mm = 120
max_velocity_mm_per_s = 200
max_acceleration_mm_per_s2 = 2000
drive = "board"
drive_axis = "Z"
increments = 3200
per_mm = 5
"#;

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap()
}

fn parse(text: &str) -> Result<Machine, Vec<Problem>> {
    Machine::parse(Path::new("machine.toml"), text)
}

fn load(text: &str) -> Machine {
    parse(text).unwrap_or_else(|problems| panic!("{problems:#?}"))
}

/// `text` with the first `from` replaced, which must be there.
fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from} is not in the file");
    text.replacen(from, to, 1)
}

/// What is wrong with `text`: the place in the text, the message, the help.
fn problems(text: &str) -> Vec<(String, String, Option<String>)> {
    let Err(problems) = parse(text) else { panic!("nothing is found wrong with\n{text}") };
    assert!(!problems.is_empty());
    problems
        .into_iter()
        .map(|problem| (text[problem.span].to_owned(), problem.message, problem.help))
        .collect()
}

/// The only thing wrong with `text`.
#[track_caller]
fn only(text: &str) -> (String, String, Option<String>) {
    let mut problems = problems(text);
    assert_eq!(problems.len(), 1, "{problems:#?}");
    problems.remove(0)
}

/// The only thing wrong with [`SHORT`] when `from` is replaced.
#[track_caller]
fn problem(from: &str, to: &str) -> (String, String, Option<String>) {
    only(&edited(SHORT, from, to))
}

/// What [`only`] finds says all of `words`; its place.
#[track_caller]
fn says(text: &str, words: &[&str]) -> String {
    let (place, message, _) = only(text);
    for word in words {
        assert!(message.contains(word), "{message} lacks {word}");
    }
    place
}

/// What [`problem`] finds is at `place` and says all of `words`.
#[track_caller]
fn refused(from: &str, to: &str, place: &str, words: &[&str]) {
    assert_eq!(says(&edited(SHORT, from, to), words), place);
}

fn near(one: f64, other: f64) {
    assert!((one - other).abs() <= 1e-15 * other.abs(), "{one} is not {other}");
}

#[test]
fn the_shipped_machines_are_as_their_comments_say() {
    let scara = load(SCARA2);
    assert_eq!((scara.name.as_str(), scara.kind), ("scara2", "scara2"));
    let names = |machine: &Machine| -> Vec<_> {
        machine.axes.iter().map(|axis| (axis.name.clone(), axis.kind)).collect()
    };
    let (rotary, linear) = (AxisKind::Rotary, AxisKind::Linear);
    let of = |name: &str, kind| (name.to_owned(), kind);
    assert_eq!(names(&scara), [of("A", rotary), of("B", rotary), of("Z", linear)]);
    // Both arms along +x reach 250 + 200 mm; the tool is 60 mm long.
    let pose = scara.kinematics.forward(&AxisVector::from_values([0.0, 0.0, 0.06])).unwrap();
    assert!((pose.position - nalgebra::point![0.45, 0.0, 0.0]).norm() < 1e-15, "{pose:?}");
    let start = scara.conditions.start.map(|value| (value * 1e6).round());
    assert_eq!(start, [300_000.0, 0.0, 20_000.0]);
    near(scara.conditions.angle_tolerance, 2f64.to_radians());
    assert_eq!(scara.gravity, nalgebra::vector![0.0, 0.0, -9.81]);
    let board = board(&scara);
    assert_eq!((board.address, board.baud, board.parity), (1, 115_200, Parity::None));
    assert_eq!(scara.drives[0].port.as_deref(), Some("/dev/ttyUSB0"));
    assert_eq!((board.start_stop_hz, board.acceleration_khz_per_s), (200, 2000));
    assert_eq!(board.turnaround_us, 2000);

    let gantry = load(GANTRY3);
    assert_eq!(names(&gantry), [of("X", linear), of("Y", linear), of("Z", linear)]);
    assert_eq!(gantry.kind, "gantry3");
    // What the files do not say is the same as what they say is the default.
    assert_eq!(gantry.gravity, scara.gravity);
    assert_eq!(self::board(&gantry).turnaround_us, board.turnaround_us);
    for machine in [scara, gantry] {
        assert!(machine.start_axes().is_some(), "{} cannot stand at its start", machine.name);
        let devices: Vec<_> =
            machine.axes.iter().map(|axis| axis.drive.as_ref().unwrap().index).collect();
        assert_eq!(devices, [0, 1, 2]);
    }
}

/// A real drive answers as slowly as it does; an emulated one as fast as it is set to.
#[test]
fn real_devices_have_their_own_response_time() {
    let mut machine = load(GANTRY3);
    assert!(!machine.drives[0].expect_real());
    assert_eq!(machine.drives[0].expected_response_us(), 2000);
    let slow = "kind = \"interpcnc\"\nturnaround_ms = 18.5\nfollowing = \"buffered\"\n\
                start_stop_hz = 1500\n";
    let mut machine = load(&GANTRY3.replace("kind = \"interpcnc\"\n", slow));
    assert_eq!(board(&machine).turnaround_us, 2000);
    let buffered = Following::Buffered { start_stop_hz: 1500, acceleration_khz_per_s: 2000 };
    assert_eq!(board(&machine).following, buffered);
    assert!(machine.drives[0].expect_real());
    assert_eq!(board(&machine).turnaround_us, 18_500);
}

/// Each device has its own port, except modules mapped from the same one.
#[test]
fn no_two_devices_are_on_one_port() {
    let with = |port: &str, more: &str| {
        let board = "[[drives]]\nname = \"board\"\nkind = \"interpcnc\"\nport = \"/dev/ttyUSB0\"";
        assert!(GANTRY3.contains(board));
        let other =
            format!("[[drives]]\nname = \"other\"\nkind = \"bim2ax\"\nport = \"{port}\"\n{more}\n");
        Machine::parse(
            Path::new("machine.toml"),
            &GANTRY3.replace(board, &format!("{other}\n{board}")),
        )
    };
    assert!(with("/dev/uio0", "").is_ok());
    assert!(with("/dev/ttyUSB0", "map_offset = 4096").is_ok());
    let problems = with("/dev/ttyUSB0", "").unwrap_err();
    let expected = "drive \"other\" is on this port already";
    assert!(problems.iter().any(|one| one.message.contains(expected)), "{problems:#?}");
    // The same under other names: with nothing there, and as a link to it.
    assert!(with("/dev/./ttyUSB0", "").is_err());
    let folder = tempfile::tempdir().unwrap();
    let [port, link] = ["port", "link"].map(|name| folder.path().join(name));
    std::fs::write(&port, "").unwrap();
    std::os::unix::fs::symlink(&port, &link).unwrap();
    let linked = |one: &Path, other: &Path| {
        let text = GANTRY3.replace("/dev/ttyUSB0", &one.display().to_string());
        let other = other.display();
        let other =
            format!("[[drives]]\nname = \"other\"\nkind = \"bim2ax\"\nport = \"{other}\"\n");
        let text = text.replacen("[[drives]]", &format!("{other}\n[[drives]]"), 1);
        Machine::parse(Path::new("machine.toml"), &text)
    };
    assert!(linked(&port, &folder.path().join("none")).is_ok());
    assert!(linked(&port, &link).is_err());
}

/// What a manual leaves open depends on the device: the machine file can state it.
#[test]
fn assumptions_are_taken_from_the_file() {
    use twin_interpcnc::Assumptions;
    let with = |line: &str| {
        let table = format!("[drives.assumptions]\n{line}\n\n[preparation]");
        GANTRY3.replacen("[preparation]", &table, 1)
    };
    assert_eq!(board(&load(GANTRY3)).assumptions, Assumptions::default());
    let expected = Assumptions { most_read: 32, broadcasts: false, ..Assumptions::default() };
    let said = "most_read = \"32\"\nbroadcasts = \"false\"";
    assert_eq!(board(&load(&with(said))).assumptions, expected);
    for (line, what) in [
        ("most_read = \"many\"", "it can be"),
        ("most_red = \"32\"", "there is no assumption `most_red`"),
    ] {
        let problems = Machine::parse(Path::new("machine.toml"), &with(line)).unwrap_err();
        assert!(problems.iter().any(|one| one.message.contains(what)), "{problems:#?}");
    }
}

fn board(machine: &Machine) -> &InterpCncEntry {
    let DriveFamily::InterpCnc(entry) = machine.drives[0].family() else { panic!("{machine:?}") };
    entry
}

#[test]
fn values_are_si_inside() {
    let machine = load(SCARA2);
    let [a, _, z] = &machine.axes[..] else { panic!("three axes") };
    near(a.position_limits[0], (-150f64).to_radians());
    near(a.position_limits[1], 150f64.to_radians());
    near(a.max_velocity, 240f64.to_radians());
    near(a.max_acceleration, 1500f64.to_radians());
    near(a.max_following_error.unwrap(), 0.5f64.to_radians());
    assert_eq!(a.max_jerk, None);
    near(z.position_limits[0], -0.06);
    near(z.position_limits[1], 0.14);
    near(z.max_velocity, 0.3);
    near(z.max_acceleration, 3.0);
    near(z.max_following_error.unwrap(), 0.5e-3);
    // Forces and torques are SI already.
    assert_eq!((a.simulated.effort_limit, a.simulated.dry_friction()), (120.0, 1.5));
    assert_eq!((z.simulated.effort_limit, z.simulated.viscous_friction()), (400.0, 20.0));
    near(a.from_si(std::f64::consts::PI), 180.0);
    near(z.to_si(z.from_si(0.123)), 0.123);

    let jerky = edited(SCARA2, "# max_jerk_deg_per_s3", "max_jerk_deg_per_s3");
    near(load(&jerky).axes[0].max_jerk.unwrap(), 60_000f64.to_radians());
    let moved = SCARA2
        .replacen("translation_mm = [0.0, 0.0, 0.0]", "translation_mm = [10.0, -20.0, 5.0]", 1)
        .replacen("rotation_deg = [0.0, 0.0, 0.0]", "rotation_deg = [0.0, 0.0, 90.0]", 1);
    let tip = Pose { position: nalgebra::point![0.1, 0.0, 0.0], direction: 0.0 };
    let found = load(&moved).frame.pose_to_machine(&tip).position;
    assert!((found - nalgebra::point![0.01, 0.08, 0.005]).norm() < 1e-15, "{found}");
}

#[test]
fn increments_are_an_exact_ratio() {
    let increments = |axis: &Axis, value: f64| axis.increments_per_si() * axis.to_si(value);
    let machine = load(SCARA2);
    // 200 steps of 16 microsteps and a gear 50:1 are 160000 increments a turn; 3200 per 5 mm are 640 per mm.
    assert_eq!(increments(&machine.axes[0], 360.0), 160_000.0);
    assert_eq!(increments(&machine.axes[0], 90.0), 40_000.0);
    assert_eq!(increments(&machine.axes[1], -360.0), -128_000.0);
    near(increments(&machine.axes[2], 1.0), 640.0);
    let reversed = edited(SCARA2, "increments = 160000", "increments = -160000");
    assert_eq!(increments(&load(&reversed).axes[0], 360.0), -160_000.0);
    // A third of a turn has no finite decimal; three of them are a turn.
    let third = edited(SCARA2, "per_deg = 360.0", "per_deg = 120.0");
    let third = edited(&third, "max_velocity_deg_per_s = 240.0", "max_velocity_deg_per_s = 100.0");
    assert_eq!(increments(&load(&third).axes[0], 120.0), 160_000.0);
}

#[test]
fn numbers_may_be_written_in_every_way_toml_has() {
    let ways =
        [("3200", "3_200"), ("3200", "0xC80"), ("= 400", "= 4e2"), ("= 400", "= 0b110010000")];
    for (plain, other) in ways {
        let machine = load(&edited(SHORT, plain, other));
        assert_eq!(machine.axes, load(SHORT).axes, "{other}");
    }
}

#[test]
fn a_key_may_be_missing_only_if_it_has_a_default() {
    let needed = [
        ("name = \"portal\"\n", "the file lacks `name`"),
        ("kind = \"gantry3\"\n", "[kinematics] lacks `kind`"),
        ("name = \"board\"\n", "[[drives]] number 1 lacks `name`"),
        ("kind = \"interpcnc\"\n", "[[drives]] number 1 lacks `kind`"),
        ("name = \"X\"\n", "[[axes]] number 1 lacks `name`"),
        ("kind = \"linear\"\n", "[[axes]] number 1 lacks `kind`"),
        ("position_min_mm = -50\n", "[[axes]] number 1 lacks `position_min_mm`"),
        ("position_max_mm = 650\n", "[[axes]] number 1 lacks `position_max_mm`"),
        ("max_velocity_mm_per_s = 400\n", "[[axes]] number 1 lacks `max_velocity_mm_per_s`"),
        (
            "max_acceleration_mm_per_s2 = 3000\n",
            "[[axes]] number 1 lacks `max_acceleration_mm_per_s2`",
        ),
    ];
    for (line, complaint) in needed {
        let found = problems(&edited(SHORT, line, ""));
        assert!(found.iter().any(|problem| problem.1 == complaint), "{complaint}: {found:#?}");
    }
    // The complaint points at the table that lacks it.
    let (place, ..) = problem("position_max_mm = 650\n", "");
    assert!(place.starts_with("[[axes]]"), "{place}");
    let without_kinematics = edited(SHORT, "[kinematics]\nkind = \"gantry3\"\n", "");
    assert_eq!(problems(&without_kinematics)[0].1, "the file lacks [kinematics]");
    let scara = edited(SCARA2, "arm_lengths_mm = [250.0, 200.0]", "");
    assert!(problems(&scara)[0].1.contains("[kinematics] lacks `arm_lengths_mm`"));
}

#[test]
fn a_value_of_another_type_is_named_with_its_type() {
    refused("= -50", "= \"-50\"", "\"-50\"", &["`position_min_mm` is a string", "a number"]);
    refused("= -50", "= true", "true", &["`position_min_mm` is a boolean", "a number"]);
    refused("= -50", "= [-50]", "[-50]", &["`position_min_mm` is an array", "a number"]);
    refused("= -50", "= 1979-05-27", "1979-05-27", &["`position_min_mm` is a datetime"]);
    refused("= -50", "= {mm = -50}", "{mm = -50}", &["`position_min_mm` is a table"]);
    refused("\"portal\"", "7", "7", &["`name` is an integer; expected a string"]);
    refused("= 3200", "= 3200.0", "3200.0", &["`increments` is a float", "whole number"]);
    for (arms, place, words) in [
        ("250.0", "250.0", "an array of 2 numbers"),
        ("[250.0]", "[250.0]", "has 1 entries"),
        ("[250.0, \"200\"]", "\"200\"", "is a string"),
    ] {
        let (found, message, _) = &problems(&edited(SCARA2, "[250.0, 200.0]", arms))[0];
        assert_eq!((found.as_str(), message.contains(words)), (place, true), "{message}");
    }

    let flat = "name = \"x\"\nkinematics = 3\naxes = 4\ndrives = [5]\n";
    let found = problems(flat);
    let about = |place: &str, words: &str| {
        let fits =
            |(found, message, _): &&(String, String, _)| found == place && message.contains(words);
        assert!(found.iter().any(|problem| fits(&problem)), "{words}: {found:#?}");
    };
    about("3", "`kinematics` is an integer; expected a table");
    about("4", "`axes` is an integer; expected tables headed [[axes]]");
    about("5", "`drives` is an integer; expected tables headed [[drives]]");
}

#[test]
fn a_number_beyond_its_range_is_shown_with_both_bounds() {
    let cases = [
        ("= -50\n", "= -1000001\n", "-1000001", ["-1000000 ", "1000000"]),
        ("= 650\n", "= 1e7\n", "1e7", ["-1000000 ", "1000000"]),
        ("s = 400\n", "s = 0\n", "0", ["0.001 ", "1000000"]),
        ("s2 = 3000\n", "s2 = -3000\n", "-3000", ["0.001 ", "100000000"]),
        ("per_mm = 10\n", "per_mm = 0\n", "0", ["0.000001 ", "1000000000"]),
    ];
    for (from, to, number, [low, high]) in cases {
        let is = format!(" is {number}; ");
        refused(from, to, number, &[&is, &format!("between {low}and {high}")]);
    }
    let in_drive = |line: &str, number: &str, bounds: &str| {
        let to = format!("kind = \"interpcnc\"\n{line}{number}\n");
        refused("kind = \"interpcnc\"\n", &to, number, &[bounds]);
    };
    in_drive("station = ", "0", "between 1 and 247");
    in_drive("station = ", "248", "between 1 and 247");
    in_drive("baud = ", "300", "between 4800 and 256000");
    in_drive("start_stop_hz = ", "65536", "between 1 and 65535");
    in_drive("acceleration_khz_per_s = ", "0", "between 1 and 65535");
    in_drive("emulated_turnaround_ms = ", "-1", "between 0 and 1000");
    in_drive("turnaround_ms = ", "1001", "between 0 and 1000");
    let in_physics = |line: &str, number: &str, bounds: &str| {
        let to = format!("[axes.physics]\n{line}{number}\n[[axes]]\nname = \"Y\"\n");
        refused("[[axes]]\nname = \"Y\"\n", &to, number, &[bounds]);
    };
    in_physics("max_force_n = ", "0", "between 0.001 and 10000000");
    in_physics("velocity_loop_bandwidth_hz = ", "251", "between 1 and 250");
    in_physics("coulomb_friction_n = ", "-0.1", "between 0 and 1000000");
    let (place, message, _) =
        problems(&edited(SCARA2, "[250.0, 200.0]", "[250.0, -200.0]")).remove(0);
    assert_eq!(place, "-200.0");
    assert!(message.contains("`arm_lengths_mm` is -200.0; it must lie between 1 and 100000"));
}

#[test]
fn what_is_no_finite_number_lies_in_no_range() {
    for number in ["nan", "-nan", "+nan", "inf", "-inf", "+inf", "1e400", "-1e400"] {
        let bound = "must lie between -1000000 and 1000000";
        refused("= -50\n", &format!("= {number}\n"), number, &[bound]);
        let start = format!("= [300.0, {number}, 20.0]");
        assert_eq!(only(&edited(SCARA2, "= [300.0, 0.0, 20.0]", &start)).0, number);
    }
    for number in ["99999999999999999999999", "-9223372036854775809", "0xFFFFFFFFFFFFFFFFFF"] {
        refused("= 3200", &format!("= {number}"), number, &[number, "1000000000000"]);
        refused("= -50\n", &format!("= {number}\n"), number, &[number, "1000000"]);
    }
}

#[test]
fn an_unknown_key_is_refused_with_the_key_that_was_meant() {
    let meant = |from: &str, to: &str, key: &str| {
        let found = problems(&edited(SHORT, from, to));
        let unknown = |(_, message, _): &&(String, String, _)| message.starts_with("unknown key");
        let (place, message, help) = found.iter().find(unknown).expect("an unknown key").clone();
        assert!(message.contains(&format!("`{place}`")), "{message}");
        assert_eq!(help.unwrap(), format!("did you mean `{key}`?"), "{message}");
    };
    meant("position_min_mm", "positon_min_mm", "position_min_mm");
    meant("max_velocity_mm_per_s ", "max_velocity_mm_s ", "max_velocity_mm_per_s");
    // The unit of the other kind of axis.
    let right = "max_acceleration_mm_per_s2";
    meant(right, "max_acceleration_deg_per_s2", right);
    meant("per_mm = 10", "per_deg = 10", "per_mm");
    meant("[kinematics]", "[kinematic]", "kinematics");
    meant("[[drives]]", "[[drive]]", "drives");
    meant("[[drives]]", "[[drives]]\nports = \"a\"", "port");
    meant("[[drives]]", "[tool]\nlenght_mm = 3\n[[drives]]", "length_mm");
    meant("[[drives]]", "[program]\nstart = [0, 0, 0]\n[[drives]]", "start_mm");
    meant("[[drives]]", "[body]\nquill_mass = 3\n[[drives]]", "quill_mass_kg");
    meant("per_mm = 5", "per_mm = 5\n[axes.physics]\nmax_torque_n = 3", "max_force_n");
    // Nothing like it: what there is.
    let (place, message, help) = problem("[[drives]]", "colour = \"blue\"\n[[drives]]");
    assert_eq!((&*place, &*message), ("colour", "unknown key `colour` in [kinematics]"));
    assert_eq!(help.unwrap(), "known here: kind, deviations, offsets_mm, length_scale_mm");
    // A key that is there already is not suggested.
    let (_, _, help) = problem("per_mm = 10", "per_mm = 10\nper_mn = 10");
    assert!(!help.unwrap().contains("`per_mm`"));
}

#[test]
fn words_are_chosen_from_a_list() {
    let (place, message, help) = problem("\"gantry3\"", "\"gantry\"");
    assert_eq!(place, "\"gantry\"");
    assert!(
        message.contains("`kind` is \"gantry\"; expected \"gantry2\", \"gantry3\", ")
            && message.ends_with("\"scara3\" or \"tripod\""),
        "{message}"
    );
    assert_eq!(help.as_deref(), Some("did you mean \"gantry3\"?"));
    refused("\"linear\"", "\"Linear\"", "\"Linear\"", &["\"rotary\" or \"linear\""]);
    refused("drive_axis = \"X\"", "drive_axis = \"W\"", "\"W\"", &["\"X\", \"Y\""]);
    refused("\"interpcnc\"", "\"smart\"", "\"smart\"", &["expected \"interpcnc\""]);
    let parity = "kind = \"interpcnc\"\nparity = \"mark\"\n";
    refused("kind = \"interpcnc\"\n", parity, "\"mark\"", &["\"none\", \"even\" or \"odd\""]);
    assert_eq!(only(&edited(SCARA2, "elbow = \"low\"", "elbow = \"left\"")).0, "\"left\"");
    refused("name = \"X\"", "name = \"\"", "\"\"", &["`name` is empty"]);
}

#[test]
fn two_axes_share_neither_name_nor_drive_nor_role() {
    let to = "name = \"X\"\nrole = \"Y\"";
    refused("name = \"Y\"", to, "\"X\"", &["there is an axis \"X\" already"]);
    let words = ["axis \"X\" already hangs on this axis of the drive"];
    refused("drive_axis = \"Y\"", "drive_axis = \"X\"", "\"X\"", &words);
    // Of the second of two, not the first.
    let text = edited(SHORT, "drive_axis = \"Y\"", "drive_axis = \"X\"");
    let span = parse(&text).unwrap_err()[0].span.clone();
    assert!(text[..span.start].ends_with("drive_axis = "));
    assert!(span.start > text.find("name = \"Y\"").unwrap());

    let same_role = problems(&edited(SHORT, "name = \"Y\"", "name = \"Y\"\nrole = \"X\""));
    assert_eq!(same_role.len(), 2, "{same_role:#?}");
    assert!(same_role.iter().any(|(place, message, _)| {
        place == "\"X\"" && message.contains("axis \"Y\" has the role \"X\", which another axis")
    }));
    assert!(same_role.iter().any(|(_, message, _)| message == "no axis moves Y of the gantry3"));
}

#[test]
fn a_role_is_something_the_machine_moves_with_that_kind_of_axis() {
    // Names are free if roles are given, in any order.
    let text = edited(SHORT, "name = \"X\"", "name = \"long\"\nrole = \"Y\"");
    let text = edited(&text, "name = \"Y\"", "name = \"cross\"\nrole = \"X\"");
    let pose = load(&text).kinematics.forward(&AxisVector::from_values([1.0, 2.0, 3.0])).unwrap();
    assert_eq!(pose.position, nalgebra::point![2.0, 1.0, 3.0]);

    let found = problems(&edited(SHORT, "name = \"X\"", "name = \"X\"\nrole = \"T\""));
    assert_eq!(found.len(), 2, "{found:#?}");
    let complaint =
        "axis \"X\" has the role \"T\"; of a gantry3 axes move X, Y, Z, or P Q U V W in addition";
    assert!(found.iter().any(|(place, message, _)| place == "\"T\"" && message == complaint));
    assert!(found.iter().any(|(_, message, _)| message == "no axis moves X of the gantry3"));
    // The transform of a SCARA uses X itself.
    let (_, message, _) = only(&edited(SCARA2, "name = \"Z\"", "name = \"Z\"\nrole = \"X\""));
    let complaint =
        "axis \"Z\" has the role \"X\"; of a scara2 axes move A, B, Z, or P Q U V W in addition";
    assert_eq!(message, complaint);

    let (before, last) = SHORT.split_at(SHORT.rfind("[[axes]]").unwrap());
    let turning = last.replace("_mm", "_deg").replace("\"linear\"", "\"rotary\"");
    let (place, message, _) = only(&format!("{before}{turning}"));
    assert_eq!(place, "\"Z\"");
    assert_eq!(message, "axis \"Z\" is rotary; what moves Z of a gantry3 is linear");
    // A SCARA without its own Z axis has no use for a tool with a length.
    let (arms, _) = SCARA2.split_at(SCARA2.find("# The transform knows nothing of Z").unwrap());
    says(arms, &["needs an axis that moves Z"]);
    load(&edited(arms, "length_mm = 60.0", "length_mm = 0.0"));
}

#[test]
fn software_limits_leave_room() {
    let words = ["`position_max_mm` is -50; it must be above `position_min_mm`, -50"];
    refused("position_max_mm = 650", "position_max_mm = -50", "-50", &words);
    refused("position_max_mm = 650", "position_max_mm = -60", "-60", &["must be above"]);
}

#[test]
fn several_problems_come_at_once_in_the_order_of_the_file() {
    let text = edited(SHORT, "\"portal\"", "5");
    let text = edited(&text, "\"interpcnc\"", "\"plc\"");
    let text = edited(&text, "= 650", "= 1e9");
    let text = edited(&text, "name = \"Z\"", "nam = \"Z\"");
    let found: Vec<_> = problems(&text).into_iter().map(|(place, ..)| place).collect();
    assert_eq!(found.len(), 5, "{found:#?}");
    assert_eq!(found[..3], ["5", "\"plc\"", "1e9"]);
    // The third axis lacks its name, and has a key too many.
    assert!(found[3..].contains(&"nam".to_owned()), "{found:#?}");
    let spans: Vec<_> =
        parse(&text).unwrap_err().into_iter().map(|problem| problem.span.start).collect();
    assert!(spans.is_sorted());
}

#[test]
fn what_is_not_toml_is_refused_where_it_goes_wrong() {
    let (place, message, _) = problem("name = \"portal\"", "name = portal");
    assert!(place.contains("portal") && !message.is_empty(), "{place}: {message}");
    let (place, message, _) = problem("name = \"X\"\n", "name = \"X\"\nname = \"U\"\n");
    assert!(message.contains("duplicate key"), "{place}: {message}");
    assert!(!problems("%\nN10 G0 X1\n").is_empty());
    assert!(!problems("name = \"unfinished").is_empty());
}

#[test]
fn an_empty_file_lacks_everything() {
    for text in ["", "\n\n# nothing but a comment\n", "\u{feff}"] {
        let found: Vec<_> = problems(text).into_iter().map(|(_, message, _)| message).collect();
        assert_eq!(
            found,
            ["the file lacks `name`", "the file lacks [[axes]]", "the file lacks [kinematics]"]
        );
    }
}

#[test]
fn too_many_axes_are_refused() {
    let mut text = SHORT.to_owned();
    for number in 0..6 {
        let axis = format!(
            "[[axes]]\nname = \"U{number}\"\nrole = \"Z\"\nkind = \"linear\"\nposition_min_mm = 0\n\
             position_max_mm = 1\nmax_velocity_mm_per_s = 1\nmax_acceleration_mm_per_s2 = 1\n"
        );
        text += &axis;
    }
    let found = problems(&text);
    assert!(found.iter().any(|(_, message, _)| message == "9 axes; at most 8 are supported"));
}

#[test]
fn a_file_that_cannot_be_read_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("machine.toml");
    let refused = |path: &Path| match Machine::load(path) {
        Err(error @ MachineFileError::Read { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    };
    assert!(refused(&path).contains("machine.toml"));
    assert!(refused(folder.path()).contains("directory"));
    std::fs::write(&path, b"name = \"\xff\"").unwrap();
    assert!(refused(&path).contains("invalid utf-8 sequence of 1 bytes from index 8"));
    std::fs::write(&path, edited(SHORT, "= -50", "= nan")).unwrap();
    let Err(error) = Machine::load(&path) else { panic!("it has a problem") };
    let shown: Vec<_> = error.reports().iter().map(|report| format!("{report:?}")).collect();
    assert_eq!(shown.len(), 1);
    assert!(shown[0].contains("machine.toml:10:"), "{}", shown[0]);
    std::fs::write(&path, SHORT).unwrap();
    assert_eq!(Machine::load(&path).unwrap().path, path);
}
