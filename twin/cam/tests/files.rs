//! Tests of cam files: a written file reads back the same, and errors name their place.

use crate::cam::edit::{self, Change};
use crate::cam::lost;
use std::path::{Path, PathBuf};
use twin_cam::{Action, Element, Interpolation, Knot, Passage, Shape, StartMode};
use twin_machine::cam_file::{CamFile, CamFileError, Form, csv_of, write_file};

pub(super) fn read(text: &str) -> Result<CamFile, CamFileError> {
    CamFile::from_toml(Path::new("cam.toml"), text.to_owned())
}

/// Remarks about the elements of a cam: the notes, or the warnings.
fn remarks(text: &str, notes: bool) -> Vec<String> {
    let remarks = read(text).expect("a cam").remarks.into_iter();
    remarks.filter(|remark| remark.is_note == notes).map(|remark| remark.text).collect()
}

/// Messages with the words they are about.
pub(super) fn problems(text: &str) -> Vec<(String, String)> {
    let Err(CamFileError::Toml(twin_machine::section::MachineFileError::Content {
        problems, ..
    })) = read(text)
    else {
        panic!("{:?}", read(text));
    };
    let about = |span: std::ops::Range<usize>| text.get(span).unwrap_or_default().to_owned();
    problems.into_iter().map(|problem| (problem.message, about(problem.span))).collect()
}

const LIFT: &str = r#"
name = "lift"                                       # what it is called
master = { min = 0, max = 360, step = 30, unit = "deg" }
slave = { min = 0, max = 100, unit = "mm", period = 100 }
elements = [
  { master = 0, slave = 0 },                        # the rest
  { master = 90, slave = 40, velocity = 0.5 },      # on the way
  { from = [120, 60], to = [180, 90] },
  { master = 240, slave = 50, acceleration = -0.01 },
]
tappets = [
  { group = 3, master = 100, action = "timed", delay_us = 1.5, duration_us = 3000 },
  { group = -1, master = 20, passage = "negative", action = "off" },
]

[coupling]
slave_offset = 12.5  # measured
"#;

#[test]
fn a_cam_written_by_hand() {
    let file = read(LIFT).expect("a cam");
    let source = file.source.as_ref().expect("elements");
    assert_eq!(source.elements.len(), 4);
    let expected = Knot { master: 90.0, slave: 40.0, velocity: 0.5, acceleration: 0.0 };
    assert_eq!(source.elements[1], Element::Point(expected));
    assert_eq!(source.elements[2], Element::Line { from: [120.0, 60.0], to: [180.0, 90.0] });
    assert_eq!(file.coupling.input.slave_offset, 12.5);
    assert_eq!(file.coupling.input.start_mode, StartMode::Absolute);
    // By ascending masters.
    let tappets = file.cam.tappets();
    assert_eq!((tappets[0].group, tappets[0].passage), (-1, Passage::Negative));
    let timed = Action::Timed { delay_ns: 1500, duration_ns: 3_000_000 };
    assert_eq!((tappets[1].passage, tappets[1].action), (Passage::Every, timed));
    assert!(file.repeated && file.cam.curve().end() == 360.0);
    assert_eq!((file.master.key().as_str(), file.slave.key().as_str()), ("deg", "mm"));
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let changed = |from: &str, to: &str| {
        assert!(LIFT.contains(from), "{from}");
        problems(&LIFT.replace(from, to))
    };
    for (from, to, message, about) in [
        ("max = 360", "max = -1", "`max` is -1; it must be greater than `min`, 0", "-1"),
        ("slave = 40, velocity = 0.5", "slave = 40, speed = 0.5", "unknown key `speed`", "speed"),
        ("slave = 40", "slave = \"40\"", "`slave` is a string; expected a number", "\"40\""),
        ("slave = 40", "slave = 1e16", "`slave` is 1e16; it must lie between", "1e16"),
        ("slave = 40,", "", "lacks `slave`", "{ master = 90,  velocity = 0.5 }"),
        (
            "master = 240",
            "master = 150",
            "does not lie behind",
            "{ master = 150, slave = 50, acceleration = -0.01 }",
        ),
        (
            "master = 240",
            "master = 400",
            "lies outside 0 to 360",
            "{ master = 400, slave = 50, acceleration = -0.01 }",
        ),
        (
            "from = [120, 60]",
            "from = [190, 60]",
            "it must be greater than that of `from`, 190",
            "[180, 90]",
        ),
        ("from = [120, 60]", "from = [120]", "`from` has 1 entries; expected 2 numbers", "[120]"),
        ("action = \"off\"", "action = \"of\"", "`action` is \"of\"", "\"of\""),
        ("duration_us = 3000", "duration_us = -1", "`duration_us` is -1", "-1"),
        ("group = 3", "group = 40000", "between -32768 and 32767", "40000"),
        (
            "master = 20,",
            "master = -20,",
            "tappet 2: master -20",
            "{ group = -1, master = -20, passage = \"negative\", action = \"off\" }",
        ),
        ("period = 100", "period = 0", "`period` is 0", "0"),
        ("slave_offset = 12.5", "slave_scaling = 0", "nothing would move", "0"),
        ("slave_offset = 12.5", "start_mode = \"ramp\"", "`start_mode` is \"ramp\"", "\"ramp\""),
    ] {
        let found = changed(from, to);
        assert!(
            found.iter().any(|(said, at)| said.contains(message) && at == about),
            "{to}: {found:?}"
        );
    }
    // A begin that is missing is told at the scale; a line that a point does not meet at the line.
    let found = changed("master = 0, slave = 0", "master = 5, slave = 0");
    assert!(found[0].0.contains("begin at master 5"), "{found:?}");
    let found = problems("name = \"x\"");
    assert!(found.iter().any(|(said, _)| said.contains("no `elements`")), "{found:?}");
}

/// Elements may stand in any order; what is wrong is still told at the one that is wrong.
#[test]
fn elements_out_of_order() {
    let point = "  { master = 90, slave = 40, velocity = 0.5 },      # on the way\n";
    let moved = LIFT.replace(point, "").replace("]\ntappets", &format!("{point}]\ntappets"));
    assert!(moved.find("master = 240") < moved.find("master = 90"));
    assert_eq!(read(&moved).expect("a cam").source, read(LIFT).expect("a cam").source);
    let found = problems(&moved.replace("master = 90", "master = 150"));
    let [(said, at)] = found.as_slice() else { panic!("{found:?}") };
    assert!(said.contains("does not lie behind"), "{said}");
    assert_eq!(at, "{ master = 150, slave = 40, velocity = 0.5 }");
}

#[test]
fn whole_numbers_have_no_fraction() {
    let table = |kind: &str, value: &str| {
        format!(
            "name = \"t\"\nmaster = {{ min = 0, max = 2 }}\nslave = {{ min = 0, max = 9 }}\n\
             [table]\ntype = \"{kind}\"\nvalues = [0, {value}, 2]\n"
        )
    };
    for kind in ["INT", "UINT", "DINT", "UDINT"] {
        let found = problems(&table(kind, "1.5"));
        assert_eq!(found[0].0, format!("value 2: 1.5 is not a whole number, as {kind} needs it"));
        assert!(read(&table(kind, "1.0")).is_ok());
    }
    for kind in ["REAL", "LREAL"] {
        assert!(read(&table(kind, "1.5")).is_ok());
    }
}

/// TOML keeps everything; what other forms lose is reported.
#[test]
fn other_forms_report_what_they_lose() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = read(LIFT).expect("a cam");
    let through = |file: &CamFile, name: &str, points: Option<usize>| {
        let path = folder.path().join(name);
        std::fs::write(&path, write_file(file, &path, points).expect("bytes")).expect("written");
        CamFile::load(&path, Interpolation::Linear).expect("a cam")
    };
    let again = through(&file, "lift.toml", None);
    assert_eq!(again.source, file.source);
    assert_eq!((again.coupling, again.repeated, again.period), (file.coupling, true, Some(100.0)));
    assert_eq!((&again.master, &again.slave), (&file.master, &file.slave));
    assert_eq!(again.to_toml(), file.to_toml());
    assert_eq!(lost(&file, &again), [""; 0]);
    // Points as CSV: units stay, the rest is told.
    let again = through(&file, "other.csv", None);
    assert_eq!((again.master.unit.as_str(), again.slave.unit.as_str()), ("deg", "mm"));
    let header = csv_of(&file, None).lines().next().map(str::to_owned);
    let expected = "master_deg,slave_mm,velocity_mm_per_deg,acceleration_mm_per_deg2";
    assert_eq!(header.as_deref(), Some(expected));
    let said = lost(&file, &again);
    for line in [
        "the name \"lift\" (read again it is \"other\")",
        "the slave's period, 100",
        "that 1 of its elements are straight lines: they are points now",
        "this form has no tappets; 2 of cam.toml are left behind (.toml has them)",
        "[coupling] slave_offset = 12.5",
    ] {
        assert!(said.iter().any(|told| told == line), "{line}: {said:?}");
    }
    assert!(!said.iter().any(|line| line.contains("unit of")), "{said:?}");
    let again = through(&file, "lift.asc", Some(7));
    let said = lost(&file, &again);
    for line in ["the unit of the master, deg", "the unit of the slave, mm"] {
        assert!(said.iter().any(|told| told == line), "{line}: {said:?}");
    }
    assert!(said.iter().any(|line| line.contains("the polynomials between its points")));
    // A unit that is no word.
    let odd = read(&LIFT.replace("unit = \"mm\"", "unit = \"1/min, \\\"x\\\"\"")).expect("a cam");
    assert_eq!(through(&odd, "odd.csv", None).slave.unit, "1/min, \"x\"");
    let unknown = read(&LIFT.replace(", unit = \"mm\"", "")).expect("a cam");
    assert_eq!(through(&unknown, "unknown.csv", None).slave.unit, "");
}

/// A tenth of three and the like: no digits of rounding.
#[test]
fn tables_are_written_in_clean_numbers() {
    let file = read(
        "name = \"t\"\nmaster = { min = 0, max = 1 }\nslave = { min = 0, max = 3 }\n\
         elements = [{ from = [0, 0], to = [1, 3] }]\n",
    );
    let file = file.expect("a cam");
    let text = csv_of(&file, Some(11));
    let rows: Vec<_> = text.lines().skip(1).collect();
    let expected: Vec<_> = (0..=10)
        .map(|tenth| {
            let [x, y] = [tenth, 3 * tenth].map(|tenths| f64::from(tenths) / 10.0);
            format!("{x},{y}")
        })
        .collect();
    assert_eq!(rows, expected);
    let ascii = write_file(&file, Path::new("t.asc"), Some(11)).expect("bytes");
    let ascii = String::from_utf8(ascii).expect("text");
    assert_eq!(ascii.lines().nth(3), Some("0.3;0.9"));
}

#[test]
fn edits_leave_comments_alone() {
    let changes = [
        Change::Coupling("slave_offset", -3.5),
        Change::Coupling("dead_time_s", 0.004),
        Change::CouplingWord("start_mode", "ramp_in"),
    ];
    let text = edit::apply(LIFT, &changes).expect("edited");
    let expected = LIFT.replace(
        "slave_offset = 12.5  # measured\n",
        "slave_offset = -3.5  # measured\ndead_time_s = 0.004\nstart_mode = \"ramp_in\"\n",
    );
    assert_eq!(text, expected);
    let file = read(&text).expect("a cam");
    assert_eq!(file.coupling.dead_time_s, 0.004);
    // Without a section there is one afterwards, at the end.
    let bare = LIFT.split("\n[coupling]").next().expect("a begin");
    let text = edit::apply(bare, &[Change::Coupling("master_offset", 1e-9)]).expect("edited");
    assert_eq!(
        text,
        format!("{bare}\n\n[coupling]\nmaster_offset = 1e-9\n").replace("]\n\n\n[", "]\n\n[")
    );
    let headed = "[coupling] # none yet\n\n[[elements]]\nmaster = 1 # here\nslave = 2 # there\n";
    let text = edit::apply(headed, &[Change::Coupling("slave_offset", 1.0)]);
    let expected = "[coupling] # none yet\nslave_offset = 1\n\n[[elements]]\nmaster = 1 # here\nslave = 2 # there\n";
    assert_eq!(text.as_deref(), Ok(expected));
}

#[test]
fn tables_as_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path
    };
    let load = |path: &PathBuf| CamFile::load(path, Interpolation::Linear);
    let expected = [[0.0, 1.5], [10.0, 2.5]];
    for (name, text) in [
        ("a.csv", "master,slave\n0,1.5\n10,2.5\n"),
        ("b.csv", "# measured\nMaster (deg); Slave (mm)\n0;1,5\n\n10;2,5\n"),
        ("c.csv", "0\t1.5\r\n10\t2.5\r\n"),
        ("d.asc", "10:2,5\r\n0:1,5\r\n"),
    ] {
        let file = load(&write(name, text)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let Shape::Pairs(table) = file.cam.shape() else { panic!("{name}") };
        assert_eq!(table.pairs, expected, "{name}");
        assert_eq!(file.cam.name(), &name[..1]);
    }
    let points = write("p.csv", "master,slave,velocity,acceleration\n0,0,0,0\n10,5,1,0.5\n");
    let Shape::Polynomial(knots) = load(&points).expect("points").cam.shape().clone() else {
        panic!("points")
    };
    assert_eq!(knots[1], Knot { master: 10.0, slave: 5.0, velocity: 1.0, acceleration: 0.5 });
    for (text, message) in [
        ("master,slave\n0,1\nten,2\n", "line 3: `master` is `ten`, which is not a number"),
        ("0,1\n1,nan\n", "line 2: column 2 is `nan`, which is not a number"),
        ("0,1\n1,2,3\n", "line 2: 3 columns instead of 2"),
        ("0,1,2\n1,2,3\n", "line 1: 3 columns; expected master and slave"),
        ("slave,master\n0,1\n", "column `slave` is where `master` should be"),
        ("0,1\n5,2\n\n5,3\n", "line 4: master 5 does not lie behind 5 of line 2"),
        ("", "there is no row of numbers"),
    ] {
        let error = load(&write("wrong.csv", text)).expect_err("wrong").to_string();
        assert!(error.contains(message) && error.contains("wrong.csv"), "{text:?}: {error}");
    }
    for (name, instead) in [
        ("cam.xyz", "(ASCII table of SoftMotion)"),
        ("lift.CAM", "; export a binary .cam file as ASCII table from the program that wrote it"),
        ("lift.txt", "; rename a table of lines `master;slave` to .asc, write other cams as .toml"),
    ] {
        let error = load(&write(name, "")).expect_err("no form");
        assert!(matches!(error, CamFileError::Ending(_)), "{error}");
        let said = format!("{name}: cams are read and written as .toml, .csv or .asc");
        assert!(
            error.to_string().contains(&said) && error.to_string().ends_with(instead),
            "{error}"
        );
    }
}

#[test]
fn shipped_cams_are_cams() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/cams");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("examples/cams") {
        let path = entry.expect("readable").path();
        let file = CamFile::load(&path, Interpolation::Cubic);
        let file = file.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        if file.form == Form::Toml {
            let jumps = file.cam.curve().real_jumps(file.repeated);
            assert_eq!(jumps, [None; 3], "{}", path.display());
        }
        count += 1;
    }
    assert!(count >= 3, "{count}");
}

/// Elements are taken by ascending masters; one that does not stand so is told with its line.
#[test]
fn elements_that_do_not_ascend_are_told() {
    let point = "  { master = 90, slave = 40, velocity = 0.5 },      # on the way\n";
    let moved = LIFT.replace(point, "").replace("]\ntappets", &format!("{point}]\ntappets"));
    let line = 1 + moved.lines().position(|line| line.contains("master = 90")).expect("a line");
    let warnings = remarks(&moved, false);
    let said = format!("line {line}: the element at master 90 comes after the one at 240");
    let [warning] = warnings.as_slice() else { panic!("{warnings:?}") };
    assert!(warning.starts_with(&said), "{warning}");
    assert!(remarks(LIFT, false).is_empty());
}

/// Written values of the end of a periodic cam that are not those of its begin, whole periods aside, are replaced.
#[test]
fn replaced_ends_are_reported() {
    let point = "  { master = 240, slave = 50, acceleration = -0.01 },\n";
    let line = 2 + LIFT.lines().position(|line| line.contains("master = 240")).expect("a line");
    let warnings = |end: &str| {
        let end = format!("{point}  {{ master = 360, {end} }},\n");
        remarks(&LIFT.replace(point, &end), false)
    };
    for right in ["slave = 0", "slave = 200", "slave = 99.99999999, velocity = 0"] {
        assert!(warnings(right).is_empty(), "{right}");
    }
    let found = warnings("slave = 60, velocity = 0.5");
    let expected = format!(
        "line {line}: the element at master 360, the end: slave 60 is replaced by 100, velocity 0.5 is replaced by 0. \
         The end of a periodic cam is the begin plus whole periods of 100; write these values, or leave `period` out"
    );
    assert_eq!(found, [expected]);
    let once = LIFT.replace(", period = 100", "");
    let once = once.replace(point, &format!("{point}  {{ master = 360, slave = 60 }},\n"));
    assert!(remarks(&once, false).is_empty());
}

/// A point without a velocity is a rest. Where the slave goes on in its direction that may not be meant: the files say at
/// which points the slave stops, and why a turn or a dwell is not such a point.
#[test]
fn rests_on_the_way_are_noted() {
    let cam = |slave: &str, elements: &str| {
        let head = "master = { min = 0, max = 360 }";
        remarks(&format!("{head}\nslave = {{ {slave} }}\nelements = [\n{elements}]\n"), true)
    };
    let bare = |points: &[(f64, f64)]| {
        let line =
            |(master, slave): &(f64, f64)| format!("{{ master = {master}, slave = {slave} }},\n");
        points.iter().map(line).collect::<String>()
    };
    let said = |line: usize, points: &str, at: &str| {
        [format!(
            "line {line}: {points} without `velocity`, at master {at}: the slave rests there; \
             write the velocity, or `velocity = 0` for a rest"
        )]
    };
    // A turn at 180 and, as the cam comes back, at its ends; 90 is on the way up, 270 on the way down.
    let lift = bare(&[(0.0, 0.0), (90.0, 10.0), (180.0, 40.0), (270.0, 20.0), (360.0, 0.0)]);
    assert_eq!(cam("", &lift), said(5, "2 points", "90, 270"));
    let meant = lift.replace("slave = 10", "slave = 10, velocity = 0");
    assert_eq!(cam("", &meant), said(7, "1 point", "270"));
    // A rise from dwell to dwell.
    let dwells = bare(&[(0.0, 0.0), (90.0, 0.0), (180.0, 40.0), (360.0, 40.0)]);
    assert!(cam("", &dwells).is_empty());
    // One way it begins and ends at rest; with a period it goes on.
    let way = bare(&[(0.0, 0.0), (360.0, 40.0)]);
    assert!(cam("", &way).is_empty());
    assert_eq!(cam("period = 40", &way), said(4, "1 point", "0"));
    let many: Vec<_> = (0..=9).map(|index| (40.0 * f64::from(index), f64::from(index))).collect();
    assert_eq!(cam("", &bare(&many)), said(5, "8 points", "40, 80, 120, 160, 200 and 3 more"));
}

/// A tappet beside the scale has the number that it has in the file, in which they stand in any order.
#[test]
fn tappets_are_counted_as_they_stand() {
    let found = problems(&LIFT.replace("group = 3, master = 100", "group = 3, master = 800"));
    let [(said, at)] = found.as_slice() else { panic!("{found:?}") };
    assert!(said.starts_with("tappet 1: master 800 lies outside"), "{said}");
    assert!(at.contains("master = 800"), "{at}");
}

/// Without one the slave's scale is from its least to its greatest position; a unit and marks may be said alone. One of both ends
/// is a mistake.
#[test]
fn a_slave_without_a_scale_has_that_of_its_curve() {
    let bare = |slave: &str| {
        let text = format!(
            "name = \"up\"\nmaster = {{ min = 0, max = 10 }}\n{slave}\nelements = [{{ master = 0, slave = 3 }}, {{ master = 10, slave = 43 }}]\n"
        );
        read(&text)
    };
    for (slave, step, unit) in [
        ("", 4.0, ""),
        ("slave = { unit = \"mm\", step = 5 }", 5.0, "mm"),
        ("slave = { unit = \"mm\" }", 4.0, "mm"),
    ] {
        let scale = bare(slave).expect("a cam").source.expect("a source").slave;
        assert_eq!(
            (scale.min, scale.max, scale.step, scale.unit.as_str()),
            (3.0, 43.0, step, unit)
        );
    }
    assert!(bare("slave = { min = 0 }").is_err());
    let table =
        "name = \"t\"\nmaster = { min = 0, max = 10 }\n[table]\nvalues = [-1.0, 4.0, 2.0]\n";
    let scale = read(table).expect("a cam").slave;
    assert_eq!((scale.min, scale.max), (-1.0, 4.0));
    let still = "name = \"s\"\nmaster = { min = 0, max = 10 }\nelements = [{ master = 0, slave = 3 }, { master = 10, slave = 3 }]\n";
    let scale = read(still).expect("a cam").slave;
    assert_eq!((scale.min, scale.max), (2.5, 3.5));
}

/// Steps that no file says are computed again; a scale that no file can have is an error.
#[test]
fn scales_at_the_ends_of_numbers() {
    let of = |slave: &str, end: &str| {
        format!(
            "name = \"s\"\nmaster = {{ min = 0, max = 1 }}\n{slave}\nelements = [{{ master = 0, slave = 0 }}, {{ master = 1, slave = {end} }}]\n"
        )
    };
    for text in [of("slave = { min = 0, max = 1e-308 }", "1e-310"), of("", "1e-20")] {
        let file = read(&text).expect("a cam");
        let again = read(&file.to_toml()).expect("it is read as it was written");
        assert_eq!((again.slave, again.cam), (file.slave, file.cam));
    }
    let far = of("", "0, velocity = -1e15")
        .replace("master = 1,", "master = 1000,")
        .replace("max = 1 ", "max = 1000 ");
    let found = problems(&far);
    let [(message, at)] = &found[..] else { panic!("{found:?}") };
    assert!(message.starts_with("the scale of the slave would go from 0 to "), "{message}");
    assert!(message.contains("it must lie between -1e15 and 1e15: use smaller"), "{message}");
    assert!(at.starts_with("[{ master = 0"), "{at}");
}

/// As tables are: by the file. A name that is said counts, and has to say something.
#[test]
fn a_cam_without_a_name_is_called_as_its_file() {
    let text = "master = { min = 0, max = 360 }\nslave = { min = 0, max = 1 }\n\
                elements = [{ master = 0, slave = 0 }, { master = 360, slave = 1 }]\n";
    let read = |text: &str| CamFile::from_toml(Path::new("cams/lift.toml"), text.to_owned());
    assert_eq!(read(text).expect("a cam").cam.name(), "lift");
    let named = format!("name = \"other\"\n{text}");
    assert_eq!(read(&named).expect("a cam").cam.name(), "other");
    let error = read(&format!("name = 5\n{text}")).expect_err("no text").to_string();
    let mistyped = read(&format!("nmae = \"x\"\n{text}")).expect_err("no such key");
    assert!(!error.is_empty() && format!("{mistyped:?}").contains("nmae"), "{mistyped:?}");
}

/// What is wrong is told once: what the rest of the file makes of it, or what had not been looked at yet, is no news.
#[test]
fn one_mistake_is_one_message() {
    let scales = "master = { min = 0, max = 360 }\nslave = { min = 0, max = 1 }\n";
    let good = "elements = [{ master = 0, slave = 0 }, { master = 360, slave = 1 }]\n";
    let message = |text: &str| -> Vec<String> {
        problems(&format!("{scales}{text}")).into_iter().map(|(message, _)| message).collect()
    };
    let found =
        message("elements = [{ master = \"0\", slave = 0 }, { master = 360, slave = 1 }]\n");
    assert_eq!(found, ["`master` is a string; expected a number"]);
    let found = message("elemnts = [{ master = 0, slave = 0 }]\n");
    let [none, unknown] = found.as_slice() else { panic!("{found:?}") };
    assert!(none.contains("no `elements`") && unknown.contains("`elemnts`"), "{found:?}");
    // Every key of [coupling] is known whatever is wrong with another one.
    let keys = "master_offset = 1\nmaster_scaling = 2\nslave_offset = 3\nslave_scaling = 4\nvelocity_difference = 5\n\
                acceleration = 6\ndeceleration = 7\ntappet_hysteresis = 8\nwanted_master_offset = 1\n\
                wanted_master_scaling = 2\nwanted_slave_offset = 3\nwanted_slave_scaling = 4\ndead_time_s = 0.001\n";
    for (right, wrong, said) in [
        ("", "start_mode = \"ramp\"\n", "`start_mode` is \"ramp\""),
        ("master_offset = 1\n", "master_offset = 1e300\n", "`master_offset` is 1e300"),
        ("slave_scaling = 4\n", "slave_scaling = 0\n", "`slave_scaling` is 0"),
        (
            "wanted_master_scaling = 2\n",
            "wanted_master_scaling = 0\n",
            "`wanted_master_scaling` is 0",
        ),
    ] {
        let keys = format!("\n{keys}").replacen(&format!("\n{right}"), &format!("\n{wrong}"), 1);
        let found = message(&format!("{good}[coupling]{keys}"));
        let [one] = found.as_slice() else { panic!("{found:?}") };
        assert!(one.starts_with(said), "{one}");
    }
    let machine = include_str!("../../../tests/data/machines/gantry3.toml");
    let found: Vec<_> = problems(machine).into_iter().map(|(message, _)| message).collect();
    assert_eq!(found, ["this is a machine file, not a cam"]);
}

/// As spreadsheets and controllers write them: bits as words; and what cannot be meant is told with its line.
#[test]
fn runs_as_others_write_them() {
    let parse = |text: &str| {
        let run = crate::cam::run::RecordedRun::parse(Path::new("run.csv"), text.as_bytes());
        run.map_err(|error| error.to_string())
    };
    let bits = parse("\u{feff}time,master,slave,tappet_3\r\n0,0,0,FALSE\r\n0.1,3,4,TRUE\r\n");
    let outputs: Vec<_> = bits.expect("a run").samples.into_iter().map(|one| one.outputs).collect();
    assert_eq!(outputs, [[false], [true]]);
    for (text, line, said) in [
        ("time,master,slave\n0,0,0\n0.1,TRUE,0\n", 3, "`master` is `TRUE`, which is not a number"),
        ("time,master,slave\n0,0,0\n0.1,1e300,0\n", 3, "`master` is 1e300, which is beyond ±1e15"),
        ("time,master,slave\n0,0,0\n0,1,0,2,0,3\n", 3, "decimal commas"),
        ("time;master;slave\n0;0;0\n0;1;2;3\n", 3, "4 columns instead of 3"),
    ] {
        let error = parse(text).expect_err("wrong");
        assert!(error.contains(&format!("line {line}: ")) && error.contains(said), "{error}");
    }
    let read = |bytes: &[u8]| {
        let run = crate::cam::run::RecordedRun::parse(Path::new("run.csv"), bytes);
        run.expect_err("no UTF-8").to_string()
    };
    assert!(read(b"\xff\xfet\x00i\x00m\x00e\x00").contains("UTF-16"));
    // A degree sign of Latin-1, in line 2.
    let latin = read(b"# run\ntime,master (\xb0),slave\n0,0,0\n");
    assert!(latin.contains("line 2: ") && latin.contains("save it as UTF-8"), "{latin}");
    let tab = parse("time\tmaster\tslave\n0\t0\t0\n0,1\t1,5\t2\n").expect("a run");
    assert_eq!((tab.samples[1].time_s, tab.samples[1].master), (0.1, 1.5));
}
