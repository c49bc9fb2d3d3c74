//! Tests of the messages about errors in cam files: all are reported, with their place and the correct form.

use super::files::problems;
use std::path::Path;
use twin_cam::Interpolation;
use twin_machine::cam_file::{CamFile, CamFileError};
use twin_machine::section::MachineFileError;

const SCALES: &str = "master = { min = 0, max = 3 }\nslave = { min = 0, max = 9 }\n";

/// A number of a table that does not fit its type is told where it stands.
#[test]
fn numbers_of_tables_are_told_at_their_place() {
    for (table, message, about) in [
        ("type = \"INT\"\nvalues = [0, 40000, 3, 4]\n", "does not fit INT", "40000"),
        ("type = \"UINT\"\npairs = [[0, 0], [1, 2], [3, -5]]\n", "does not fit UINT", "[3, -5]"),
        ("type = \"INT\"\nvalues = [0, 1, 2.5, 4]\n", "is not a whole number", "2.5"),
        ("pairs = [[0, 0], [2, 1], [1, 2], [3, 0]]\n", "does not lie behind", "[1, 2]"),
    ] {
        let found = problems(&format!("{SCALES}[table]\n{table}"));
        let [(told, place)] = found.as_slice() else { panic!("{found:?}") };
        assert!(told.contains(message), "{told}");
        assert_eq!(place, about);
    }
}

/// What is wrong in one place hides nothing of what is wrong in another.
#[test]
fn all_mistakes_are_told_at_once() {
    let text = "master = { min = 5, max = 3 }\nslave = { min = 0, max = 9 }\nperiode = 9\n\
                tappets = [{ group = 1, master = 1, action = \"timed\", delay = 3 }]\n\
                [table]\ntype = \"WORD\"\nslave_scale = [0, 1]\npairs = [[0, 0], [3, \"9\"]]\nperiodisch = true\n";
    let found = problems(text);
    for said in [
        "`max` is 3; it must be greater than `min`, 5",
        "unknown key `periode` in the file",
        "lacks `duration_us`",
        "unknown key `delay` in [[tappets]] number 1",
        "`type` is \"WORD\"",
        "`slave_scale` has 2 entries",
        "`pairs` is a string",
        "unknown key `periodisch` in [table]",
    ] {
        let told = found.iter().filter(|(message, _)| message.contains(said)).count();
        assert_eq!(told, 1, "{said}: {found:#?}");
    }
    assert_eq!(found.len(), 8, "{found:#?}");
    // Elements that are wrong themselves do not hide that there is a table, too.
    let found =
        problems(&format!("{SCALES}elements = [{{ master = 0 }}]\n[table]\nvalues = [1, 2]\n"));
    let twice = "`table` and `elements` describe the cam twice: leave one of them out";
    assert!(found.iter().any(|(message, _)| message == twice), "{found:?}");
}

#[test]
fn known_keys_of_a_cam_are_named() {
    let text = format!(
        "{SCALES}elements = [{{ master = 0, slave = 0 }}, {{ master = 3, slave = 1 }}]\nq = 1\n"
    );
    let Err(CamFileError::Toml(MachineFileError::Content { problems, .. })) =
        CamFile::from_toml(Path::new("cam.toml"), text)
    else {
        panic!("a cam");
    };
    let help = problems[0].help.as_deref().unwrap_or_default();
    let known = "known here: name, kind, master, slave, coupling, elements, tappets, table";
    assert_eq!(help, known);
}

/// A scaling next to 0 is 0 but for rounding.
#[test]
fn scalings_next_to_nothing_are_refused() {
    let with = |scaling: &str| {
        format!(
            "{SCALES}elements = [{{ master = 0, slave = 0 }}, {{ master = 3, slave = 1 }}]\n[coupling]\nmaster_scaling = {scaling}\n"
        )
    };
    for (scaling, said) in [
        ("1e-300", "`master_scaling` is 1e-300; 1e-15 is the least scaling"),
        ("-9e-16", "`master_scaling` is -9e-16; 1e-15 is the least scaling"),
        ("0", "`master_scaling` is 0; nothing would move"),
    ] {
        let found = problems(&with(scaling));
        let [(told, _)] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!(told, said);
    }
    for scaling in ["1e-15", "-1e-15"] {
        let text = with(scaling);
        assert!(CamFile::from_toml(Path::new("cam.toml"), text).is_ok(), "{scaling}");
    }
}

/// What is wrong with so many columns, in numbers that agree with their nouns.
#[test]
fn columns_are_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let message = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        let error = CamFile::load(&path, Interpolation::Linear).expect_err("no cam");
        error.to_string().replace(&format!("{}: ", path.display()), "")
    };
    assert_eq!(message("a.asc", "0;0\n1\n"), "line 2: 1 column instead of 2");
    assert_eq!(message("b.asc", "0;0\n1;2;3\n"), "line 2: 3 columns instead of 2");
    assert_eq!(message("c.csv", "0,0\n1\n"), "line 2: 1 column instead of 2");
    // Lines of blanks are counted, and say nothing.
    assert_eq!(message("d.csv", "0,0\n \t\n\n1\n\t"), "line 4: 1 column instead of 2");
    let expected = "expected master and slave, or these with velocity and acceleration";
    assert_eq!(message("d.csv", "0\n1\n"), format!("line 1: 1 column; {expected}"));
    assert_eq!(message("e.csv", "0,0,0\n1,0,0\n"), format!("line 1: 3 columns; {expected}"));
    let jerk = "# points\nmaster,slave,velocity,acceleration,jerk\n0,0,0,0,0\n1,0,0,0,0\n";
    let said = message("f.csv", jerk);
    assert_eq!(said, format!("line 3: 5 columns; {expected}: leave out `jerk`"));
    // The line of the header is that of the file.
    let other =
        "\n# points\nmaster_deg,slave_mm,velocity_mm_per_s,acceleration\n0,0,0,0\n1,0,0,0\n";
    let said = message("g.csv", other);
    assert!(said.starts_with("line 3: column `velocity_mm_per_s` is by time"), "{said}");
}
