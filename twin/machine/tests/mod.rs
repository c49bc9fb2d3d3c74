//! Tests of machine files, valid and invalid.

#![expect(clippy::float_cmp, reason = "given in the file, rounded before, or to be exact")]

mod belts;
mod couplings;
mod drives;
mod kinds;
mod limits;
mod mistakes;
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
const SHORT: &str = include_str!("short.toml");

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

/// What [`only`] finds says all of `words`; its place.
#[track_caller]
fn says(text: &str, words: &[&str]) -> String {
    let (place, message, _) = only(text);
    for word in words {
        assert!(message.contains(word), "{message} lacks {word}");
    }
    place
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
    let with = |board: &Path, other: &Path, more: &str| {
        let text = GANTRY3.replace("/dev/ttyUSB0", &board.display().to_string());
        let other = format!(
            "[[drives]]\nname = \"other\"\nkind = \"bim2ax\"\nport = {other:?}\n{more}\n[[drives]]"
        );
        parse(&edited(&text, "[[drives]]", &other))
    };
    let usb = Path::new("/dev/ttyUSB0");
    assert!(with(usb, Path::new("/dev/uio0"), "").is_ok());
    assert!(with(usb, usb, "map_offset = 4096").is_ok());
    let problems = with(usb, usb, "").unwrap_err();
    let expected = "drive \"other\" is on this port already";
    assert!(problems.iter().any(|one| one.message.contains(expected)), "{problems:#?}");
    // The same under other names: with nothing there, and as a link to it.
    assert!(with(usb, Path::new("/dev/./ttyUSB0"), "").is_err());
    let folder = tempfile::tempdir().unwrap();
    let [port, link] = ["port", "link"].map(|name| folder.path().join(name));
    std::fs::write(&port, "").unwrap();
    std::os::unix::fs::symlink(&port, &link).unwrap();
    assert!(with(&port, &folder.path().join("none"), "").is_ok());
    assert!(with(&port, &link, "").is_err());
}

/// What a manual leaves open depends on the device: the machine file can state it.
#[test]
fn assumptions_are_taken_from_the_file() {
    use twin_interpcnc::Assumptions;
    assert_eq!(board(&load(GANTRY3)).assumptions, Assumptions::default());
    let expected = Assumptions { most_read: 32, broadcasts: false, ..Assumptions::default() };
    let table = "[drives.assumptions]\nmost_read = \"32\"\nbroadcasts = \"false\"\n\n[preparation]";
    assert_eq!(board(&load(&edited(GANTRY3, "[preparation]", table))).assumptions, expected);
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
    near(a.max_jerk.unwrap(), 60_000f64.to_radians());
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
fn what_is_no_finite_number_lies_in_no_range() {
    for number in ["nan", "-nan", "+nan", "inf", "-inf", "+inf", "1e400", "-1e400"] {
        let low = |number: &str| edited(SHORT, "= -50\n", &format!("= {number}\n"));
        assert_eq!(says(&low(number), &["must lie between -1000000 and 1000000"]), number);
        let start = format!("= [300.0, {number}, 20.0]");
        assert_eq!(only(&edited(SCARA2, "= [300.0, 0.0, 20.0]", &start)).0, number);
    }
    for number in ["99999999999999999999999", "-9223372036854775809", "0xFFFFFFFFFFFFFFFFFF"] {
        for (from, bound) in [("= 3200", "1000000000000"), ("= -50", "1000000")] {
            let text = edited(SHORT, from, &format!("= {number}"));
            assert_eq!(says(&text, &[number, bound]), number);
        }
    }
}

#[test]
fn two_axes_do_not_share_a_drive() {
    let text = edited(SHORT, "drive_axis = \"Y\"", "drive_axis = \"X\"");
    let span = parse(&text).unwrap_err()[0].span.clone();
    assert!(text[..span.start].ends_with("drive_axis = "));
    assert!(span.start > text.find("name = \"Y\"").unwrap());
}

#[test]
fn a_role_is_something_the_machine_moves_with_that_kind_of_axis() {
    // Names are free if roles are given, in any order.
    let text = edited(SHORT, "name = \"X\"", "name = \"long\"\nrole = \"Y\"");
    let text = edited(&text, "name = \"Y\"", "name = \"cross\"\nrole = \"X\"");
    let pose = load(&text).kinematics.forward(&AxisVector::from_values([1.0, 2.0, 3.0])).unwrap();
    assert_eq!(pose.position, nalgebra::point![2.0, 1.0, 3.0]);

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
fn of_very_many_problems_the_first_are_shown() {
    use std::fmt::Write;
    let mut text = SHORT.to_owned();
    for number in 0..1234 {
        writeln!(text, "[u{number}]").unwrap();
    }
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), &text).unwrap();
    let reports = Machine::load(file.path()).unwrap_err().reports();
    let shown: Vec<_> = reports.iter().map(ToString::to_string).collect();
    assert_eq!(shown[0], "unknown key `u0` in the file");
    assert_eq!(shown[99], "unknown key `u99` in the file");
    assert_eq!(shown[100..], ["1134 problems more, left out"]);
    // No file of a machine is so long.
    file.as_file().set_len(17 << 20).unwrap();
    let error = Machine::load(file.path()).unwrap_err().to_string();
    let said = "it has 17825792 bytes, and at most 16777216 are read; check that it is the right one, or shorten it";
    assert!(error.ends_with(said), "{error}");
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
    assert!(shown[0].contains("machine.toml:11:"), "{}", shown[0]);
    std::fs::write(&path, SHORT).unwrap();
    assert_eq!(Machine::load(&path).unwrap().path, path);
}
