//! Cam file formats as a process: accepted and refused forms, and the tolerance of tables.

use crate::desk::{Desk, Done};

/// 0 to 100 mm over half a turn from rest to rest, and back.
const LIFT: &str = "name = \"lift\"\nmaster = { min = 0, max = 360, unit = \"deg\" }\nslave = { min = 0, max = 100, unit = \"mm\", period = 100 }\n\
                    elements = [{ master = 0, slave = 0 }, { master = 180, slave = 100 }, { master = 360, slave = 0 }]\n";

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    desk
}

/// The quintic from rest to rest, and its mirror image.
fn lift(x: f64) -> f64 {
    let s = x.min(360.0 - x) / 180.0;
    100.0 * s.powi(3) * (10.0 + s * (6.0 * s - 15.0))
}

/// The fewest chords of the lift with their ends at equal distances that miss it by no more than this, by trying all of them.
fn fewest_chords(points: usize, tolerance: f64) -> usize {
    let number = |index: usize| f64::from(u32::try_from(index).expect("few"));
    let place = |index: usize| 360.0 * number(index) / number(points - 1);
    let keeps = |from: usize, to: usize| {
        let [a, b] = [from, to].map(place);
        (1..50).map(|step| f64::from(step) / 50.0).all(|share| {
            let chord = lift(a) + (lift(b) - lift(a)) * share;
            (chord - lift(a + (b - a) * share)).abs() <= tolerance
        })
    };
    let mut fewest = vec![0];
    for to in 1..points {
        let reached = (0..to).filter(|from| keeps(*from, to)).map(|from| fewest[from] + 1);
        fewest.push(reached.min().expect("neighbours"));
    }
    fewest[points - 1]
}

fn rows(desk: &Desk, name: &str) -> Vec<Vec<f64>> {
    let text = desk.text(name);
    let row = |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect();
    text.lines().skip(1).map(row).collect()
}

/// The number behind these words on standard error.
fn number(done: &Done, words: &str) -> f64 {
    let text = done.stderr.split(words).nth(1).and_then(|rest| rest.split(' ').next());
    text.and_then(|text| text.parse().ok()).unwrap_or_else(|| panic!("{words}: {}", done.stderr))
}

/// Derivatives by time, as `sample` writes them, are no points of a cam; master and slave alone are its table.
#[test]
fn samples_by_time_are_no_points() {
    let desk = desk();
    desk.twin("cam sample lift.toml --master-velocity 360 --points 361 -o whole.csv").ended(0, "");
    let whole = desk.text("whole.csv");
    let cut = |columns: usize| {
        let line = |line: &str| line.split(',').take(columns).collect::<Vec<_>>().join(",") + "\n";
        whole.lines().map(line).collect::<String>()
    };
    desk.write("four.csv", &cut(4));
    desk.write("two.csv", &cut(2));
    for name in ["whole.csv", "four.csv"] {
        desk.twin(&format!("cam check {name}"))
            .ended(
                2,
                "line 1: column `velocity_mm_per_s` is by time, as `twin cam sample` writes it",
            )
            .ended(2, "expected `velocity_mm_per_deg`, or `master_deg` and `slave_mm` alone");
    }
    let ends = |name: &str| {
        let found = desk.twin(&format!("cam check {name} --format json")).ended(0, "").object();
        ["min", "max"].map(|end| found["position"][end].as_f64().expect("a number"))
    };
    let is_whole = |name: &str| {
        let [least, most] = ends(name);
        least.abs() < 1e-9 && (most - 100.0).abs() < 1e-9
    };
    assert!(is_whole("two.csv"));
    // Points by the master are read as they were.
    desk.twin("cam convert lift.toml points.csv").ended(0, "where it was everywhere");
    assert!(is_whole("points.csv"));
    desk.write(
        "other.csv",
        "master_deg,slave_mm,velocity_mm_per_mm,acceleration_mm_per_mm2\n0,0,0,0\n360,9,0,0\n",
    );
    desk.twin("cam check other.csv")
        .ended(2, "the velocity of points is in mm/deg; expected `velocity_mm_per_deg`");
}

/// A table keeps to the tolerance against the cam itself, which straight lines between its own points miss as well.
#[test]
fn tolerances_count_from_the_cam() {
    let desk = desk();
    let table = |points: u32| format!("--table pairs --tolerance 0.1 --points {points}");
    let done = desk.twin(&format!("cam convert lift.toml thin.csv {}", table(100)));
    done.ended(0, "points became");
    let thin = rows(&desk, "thin.csv");
    let mut far = 0.0_f64;
    for pair in thin.windows(2) {
        let ([x0, y0], [x1, y1]) = ([pair[0][0], pair[0][1]], [pair[1][0], pair[1][1]]);
        for step in 0..=1000 {
            let share = f64::from(step) / 1000.0;
            far = far.max((y0 + (y1 - y0) * share - lift(x0 + (x1 - x0) * share)).abs());
        }
    }
    assert!(far <= 0.1 && far > 0.09, "{far}");
    assert!((far - number(&done, "the slave is ")).abs() < 1e-4, "{far}: {}", done.stderr);
    // Points are left out one by one from the table's, which may cost some over the fewest that there can be.
    let fewest = fewest_chords(100, 0.1) + 1;
    assert!((fewest..=fewest + 3).contains(&thin.len()), "{} points, {fewest}", thin.len());
    // 3.6 degrees apart, two of its points have 0.1008 mm between their chord and the cam.
    let pick = "cam convert examples/cams/pick_and_place.toml pick.toml";
    desk.twin(&format!("{pick} {}", table(100))).ended(2, "the slave is 0.100791 mm from the cam");
    let done = desk.twin(&format!("{pick} {}", table(200)));
    done.ended(0, "");
    assert!(number(&done, "the slave is ") <= 0.1, "{}", done.stderr);
    desk.twin(&format!("cam convert lift.toml few.csv {}", table(10)))
        .ended(2, "with all 10 points of the table the slave is ")
        .ended(2, "mm from the cam, more than --tolerance 0.1; make a table of more points");
    assert!(!desk.path("few.csv").exists());
}

/// Cubics stay cubics, and whole numbers whole numbers, where points are left out; what does not is told.
#[test]
fn a_table_with_fewer_points_is_otherwise_the_same() {
    let desk = desk();
    let convert = |from: &str, to: &str, more: &str| {
        let done = desk.twin(&format!("cam convert {from} {to} {more}"));
        done.ended(0, "");
        (desk.text(to), done)
    };
    convert("lift.toml", "cubic.toml", "--table pairs --points 73 --interpolation cubic");
    let (text, done) = convert("cubic.toml", "thin.toml", "--tolerance 0.05");
    assert!(text.contains("interpolation = \"cubic\""), "{text}");
    assert!(number(&done, "the slave is ") <= 0.05, "{}", done.stderr);
    // Straight lines between all of the points are 100·5.77/180²·5²/8 mm from the cubics, where these bend most.
    let straight = "--tolerance 0.1 --interpolation linear";
    let (text, _) = convert("cubic.toml", "straight.toml", straight);
    assert!(!text.contains("cubic"), "{text}");
    // A table as text is read with straight lines, so these keep the tolerance.
    let (_, done) = convert("cubic.toml", "thin.asc", "--tolerance 0.1");
    assert!(number(&done, "the slave is ") <= 0.1, "{}", done.stderr);
    done.ended(0, "thin.asc: lost: cubics between its points");
    let whole = "--points 200 --type int --tolerance 0.1 --table";
    let (text, done) = convert("lift.toml", "whole.toml", &format!("{whole} pairs"));
    assert!(text.contains("type = \"INT\""), "{text}");
    assert!(number(&done, "the slave is ") <= 0.1, "{}", done.stderr);
    let (_, done) = convert("lift.toml", "even.toml", &format!("{whole} equidistant"));
    done.ended(0, "lost: the type of its numbers, INT")
        .ended(0, "lost: that its points are equidistant: they are pairs now");
}

/// What an option would do nothing for is refused, and nothing is written.
#[test]
fn options_that_would_do_nothing_are_refused() {
    let desk = desk();
    desk.write(
        "marks.toml",
        "name = \"marks\"\nkind = \"tappets\"\nmaster = { min = 0, max = 360 }\n\
         tappets = [{ group = 4, master = 90, action = \"on\" }]\n",
    );
    let table = "--table pairs --points 40";
    desk.twin(&format!("cam convert lift.toml table.toml {table}")).ended(0, "");
    desk.twin("cam convert lift.toml points.csv").ended(0, "");
    let polynomials =
        "it has polynomials between its points; --interpolation is for tables in .csv and .asc";
    let itself = "the file says itself how it goes on between its points; --interpolation is for";
    for (from, to, more, said) in [
        ("lift.toml", "x.toml", "--points 10", "--points is for tables that are made"),
        ("table.toml", "x.toml", "--points 10", "--points is for tables that are made"),
        (
            "table.toml",
            "x.csv",
            "--points 10 --tolerance 1",
            "--points writes positions at equal distances, --tolerance leaves some out",
        ),
        ("lift.toml", "x.toml", "--interpolation cubic", polynomials),
        ("points.csv", "x.toml", "--interpolation linear", polynomials),
        ("table.toml", "x.toml", "--interpolation cubic", itself),
        ("marks.toml", "x.toml", table, "this cam has tappets alone: there is no curve"),
        ("marks.toml", "x.csv", "", "tappets alone have no positions"),
        ("marks.toml", "x.asc", "--points 9", "tappets alone have no positions"),
    ] {
        desk.twin(&format!("cam convert {from} {to} {more}")).ended(2, said);
        assert!(!desk.path(to).exists(), "{from} {to} {more}");
    }
    for command in ["check", "sample"] {
        desk.twin(&format!("cam {command} table.toml --interpolation cubic")).ended(2, itself);
    }
    desk.twin("cam plot lift.toml -o x.svg --interpolation cubic").ended(2, polynomials);
    // Of a block of a job as well.
    desk.write(
        "job.toml",
        "[[virtual_axes]]\nname = \"shaft\"\nkind = \"rotary\"\nmax_acceleration_deg_per_s2 = 720\n[[blocks]]\n\
         block = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"shaft\"\ncam = \"lift.toml\"\ninterpolation = \"cubic\"\n",
    );
    desk.twin("check job.toml --machine machine.toml")
        .ended(1, "it has polynomials between its points; `interpolation` is for .csv and .asc")
        .ended(1, "job.toml:10:");
}

/// Binary `.cam` files and lines of words are neither read nor written: the message names the forms and the way out.
#[test]
fn other_forms_are_refused() {
    let desk = desk();
    let forms = "cams are read and written as .toml, .csv or .asc (ASCII table of SoftMotion)";
    desk.write("lift.txt", "cam lift\nmaster 0 360\nslave 0 100\npoint 0 0\npoint 360 0\n");
    desk.write("lift.CAM", "\u{95}CAM\r\n");
    for (name, instead) in [
        ("lift.CAM", "export a binary .cam file as ASCII table from the program that wrote it"),
        ("lift.txt", "rename a table of lines `master;slave` to .asc, write other cams as .toml"),
    ] {
        let said = format!("{name}: {forms}; {instead}");
        desk.twin(&format!("cam check {name}")).ended(2, &said);
        desk.twin(&format!("cam convert {name} new.toml")).ended(2, &said);
        assert!(!desk.path("new.toml").exists());
        std::fs::remove_file(desk.path(name)).expect("it was written");
        desk.twin(&format!("cam convert lift.toml {name}")).ended(2, &said);
        assert!(!desk.path(name).exists());
    }
}

/// A device has no end, whatever its name says that it is.
#[cfg(unix)]
#[test]
fn what_has_no_end_is_no_cam() {
    let desk = desk();
    for (name, most) in [("z.asc", 268_435_456), ("z.csv", 268_435_456), ("z.toml", 16_777_216)] {
        std::os::unix::fs::symlink("/dev/zero", desk.path(name)).expect("a link");
        let said = format!("it has more than {most} bytes, the most that are read");
        desk.twin(&format!("cam check {name}")).ended(2, &said);
    }
    desk.twin("tune cam lift.toml --run z.csv")
        .ended(2, "cannot read run z.csv: it has more than 268435456 bytes");
    desk.twin("machine z.toml").ended(2, "it has more than 16777216 bytes");
}
