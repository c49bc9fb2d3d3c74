//! `twin cam` as a process, against closed forms.

use crate::desk::Desk;
use serde_json::Value;

/// 0 to 100 mm over 180° from rest to rest, and back.
const LIFT: &str = r#"
name = "lift"
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 100, unit = "mm", period = 100 }
elements = [
  { master = 0, slave = 0 },  # down
  { master = 180, slave = 100 },
  { master = 360, slave = 0 },
]
tappets = [{ group = 1, master = 90, action = "on" }]
"#;

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    desk
}

#[track_caller]
fn near(value: &Value, expected: f64) {
    let found = value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"));
    assert!(
        (found - expected).abs() <= 1e-9 * expected.abs().max(1.0),
        "{found}, expected {expected}"
    );
}

/// The quintic from rest to rest over w by h: y′ = 15/8 · h/w at most, y″ = 10/√3 · h/w², y‴ = 60 · h/w³.
#[test]
fn bounds_in_closed_form() {
    let desk = desk();
    let check = "cam check lift.toml --master-velocity 200 --format json";
    let found = desk
        .twin(&format!("{check} --max-velocity 250 --max-acceleration 2000 --position-max 100"))
        .ended(0, "")
        .object();
    let (h, w, v) = (100.0, 180.0_f64, 200.0);
    near(&found["velocity"]["max"], 15.0 / 8.0 * h / w * v);
    near(&found["velocity"]["at_max"], 90.0);
    near(&found["acceleration"]["max"], 10.0 / 3.0_f64.sqrt() * h / (w * w) * v * v / 1.0);
    near(&found["jerk"]["max"], 60.0 * h / w.powi(3) * v.powi(3));
    near(&found["largest_master"]["velocity"], 250.0 / (15.0 / 8.0 * h / w));
    assert_eq!(found["largest_master"]["limited_by"], "velocity");
    assert_eq!(found["continuity"], "C2");
    near(&found["tappets"][0]["slave"], 50.0);
    // Faster than the slave.
    desk.twin("cam check lift.toml --master-velocity 300 --max-velocity 250")
        .ended(1, "axis-velocity")
        .ended(1, "its limit is 250 mm/s")
        .ended(1, "the master may go 240 deg/s")
        .says("the master may go 240 deg/s");
}

/// The limits of machines/gantry3.toml: X slides from −50 to 650 mm with 400 mm/s.
#[test]
fn limits_of_an_axis_of_a_machine() {
    let desk = desk();
    let check = "cam check lift.toml --machine machine.toml --format json";
    let found = desk.twin(&format!("{check} --axis X")).ended(0, "").object();
    near(&found["position"]["limit"][0], -50.0);
    near(&found["velocity"]["limit"][1], 400.0);
    let found = desk.twin(&format!("{check} --axis X --slave-offset 600")).ended(1, "").object();
    assert_eq!(found["findings"][0]["rule"], "axis-position");
    near(&found["findings"][0]["value"], 700.0);
    desk.twin(&format!("{check} --axis Q")).ended(2, "unknown axis Q; the axes are X, Y, Z");
    desk.write("turn.toml", &LIFT.replace("\"mm\"", "\"deg\""));
    desk.twin("cam check turn.toml --machine machine.toml --axis X")
        .ended(2, "the slave is in deg, axis X in mm");
}

#[test]
fn samples_are_the_curve() {
    let desk = desk();
    let done = desk.twin("cam sample lift.toml --step 45 --master-velocity 10");
    done.ended(0, "");
    let rows: Vec<_> = done.stdout.lines().collect();
    assert_eq!(
        rows[0],
        "master_deg,slave_mm,velocity_mm_per_s,acceleration_mm_per_s2,jerk_mm_per_s3"
    );
    assert_eq!(rows.len(), 10);
    // The vector cam-rest-rest: y, v and a at 45 with the master at 1, here at 10.
    let row: Vec<f64> = rows[2].split(',').map(|cell| cell.parse().expect("a number")).collect();
    for (found, expected) in row.iter().zip([45.0, 10.351_562_5, 5.859_375, 1.736_111_111_11]) {
        assert!((found - expected).abs() < 1e-9, "{row:?}");
    }
    desk.twin("cam sample lift.toml --points 3 -o out.csv").ended(0, "");
    assert_eq!(desk.text("out.csv").lines().count(), 4);
    desk.twin("cam sample lift.toml -o lift.toml").ended(2, "name another file");
}

#[test]
fn forms_are_converted_and_back() {
    let desk = desk();
    let convert = |from: &str, to: &str, more: &str, words: &str| {
        desk.twin(&format!("cam convert {from} {to} {more}")).ended(0, words);
    };
    let check = |name: &str| {
        let done = desk.twin(&format!("cam check {name} --format json"));
        done.ended(0, "");
        let mut found = done.object();
        let object = found.as_object_mut().expect("an object");
        for key in ["file", "master", "slave", "cam"] {
            object.remove(key);
        }
        found
    };
    convert("lift.toml", "again.toml", "", "the slave is where it was everywhere");
    assert_eq!(check("again.toml"), check("lift.toml"));
    convert("lift.toml", "points.csv", "", "3 points; the slave is where it was everywhere");
    // 721 positions, of which few are needed for a hundredth of a mm.
    convert("lift.toml", "lift.asc", "--points 721", "721 points");
    // The numbers of the table, and the end, where the first one comes again.
    convert("lift.toml", "even.asc", "--table equidistant --points 73", "74 points");
    let ascii = std::fs::read(desk.path("lift.asc")).expect("written");
    assert!(ascii.starts_with(b"0;0\r\n0.5;"));
    let done = desk.twin("cam convert lift.asc thin.toml --tolerance 0.01");
    done.ended(0, "721 points became").ended(0, "u from where it was at most");
    let far = done.stderr.split("the slave is ").nth(1).and_then(|rest| rest.split(' ').next());
    let far: f64 = far.expect("a distance").parse().expect("a number");
    assert!(far <= 0.01 && far > 0.001, "{}", done.stderr);
    convert("lift.toml", "table.toml", "--table equidistant --points 360 --type int", "360 points");
    desk.twin("cam convert lift.toml lift.xyz").ended(2, "are read and written as");
    desk.twin("cam convert lift.toml x.toml --tolerance 1").ended(2, "--tolerance is for tables");
}

#[test]
fn what_is_wrong_with_a_file_is_shown_at_its_place() {
    let desk = desk();
    desk.write("wrong.toml", &LIFT.replace("slave = 100 }", "slave = 100, speed = 3 }"));
    desk.twin("cam check wrong.toml").ended(2, "unknown key `speed`").ended(2, "wrong.toml:7");
    desk.write("wrong.csv", "master,slave\n0,1\nx,2\n");
    desk.twin("cam check wrong.csv").ended(2, "wrong.csv: line 3: `master` is `x`");
}

#[test]
fn shipped_cams_are_checked_and_drawn() {
    let desk = Desk::new();
    let limits = "--master-velocity 360 --max-velocity 600 --max-acceleration 8000";
    let pick = "examples/cams/pick_and_place.toml";
    desk.twin(&format!("cam check {pick} {limits}")).ended(0, "");
    desk.twin(&format!("cam plot {pick} -o pick.svg {limits}")).ended(0, "");
    let picture = desk.text("pick.svg");
    assert!(picture.starts_with("<svg ") && picture.trim_end().ends_with("</svg>"));
    for word in
        ["position", "velocity", "acceleration", "jerk", "tappets of group 1", "master (deg)"]
    {
        assert!(picture.contains(word), "{word}");
    }
    desk.twin(&format!("cam plot {pick} -o again.svg {limits}")).ended(0, "");
    assert!(picture == desk.text("again.svg"));
    let shear = "cam check examples/cams/flying_shear.toml --master-velocity 500";
    desk.twin(&format!("{shear} --max-velocity 1200 --max-acceleration 12000")).ended(0, "");
    let index = "examples/cams/indexer.csv";
    desk.twin(&format!("cam check {index} --interpolation cubic --once")).ended(0, "");
    desk.twin(&format!("cam check {index} --max-acceleration 1000")).ended(1, "cam-continuity");
}

#[test]
fn what_the_master_does_is_in_table_and_picture() {
    let desk = desk();
    desk.twin("cam sample lift.toml --step 1e-9")
        .ended(2, "--step: a step of 0.000000001 makes 360000000001 places")
        .ended(2, "more than 100000000");
    let master = "--master-velocity 10 --master-acceleration 6";
    let done = desk.twin(&format!("cam sample lift.toml {master} --points 5"));
    done.ended(0, "");
    let row = done.stdout.lines().nth(2).expect("a row at 90");
    let row: Vec<f64> = row.split(',').map(|cell| cell.parse().expect("a number")).collect();
    // y′ is 15/8 · 100/180 there, y″ 0.
    assert!((row[5] + 6.25).abs() < 1e-9 && (row[6] - 6.25).abs() < 1e-9, "{row:?}");
    desk.twin("cam plot lift.toml -o lift.svg --master-acceleration 6").ended(0, "");
    let picture = desk.text("lift.svg");
    assert!(picture.contains("least and greatest while the master accelerates and jerks"));
}

/// Places of the points of a line.
type Line = Vec<(f64, f64)>;

/// Places of texts that are numbers, and of lines, in a picture.
fn parts(picture: &str) -> (Vec<(f64, f64, f64)>, Vec<Line>) {
    let attribute = |tag: &str, name: &str| -> Option<f64> {
        tag.split(&format!(" {name}=\"")).nth(1)?.split('"').next()?.parse().ok()
    };
    let mut numbers = Vec::new();
    let mut lines = Vec::new();
    for tag in picture.split('<') {
        if let Some((head, text)) = tag.split_once('>')
            && head.starts_with("text ")
            && let Ok(number) = text.trim().replace('\u{2212}', "-").parse::<f64>()
            && let (Some(x), Some(y)) = (attribute(head, "x"), attribute(head, "y"))
        {
            numbers.push((x, y, number));
        }
        if tag.starts_with("polyline ") {
            let points = tag.split(" points=\"").nth(1).and_then(|rest| rest.split('"').next());
            let point = |pair: &str| {
                let (x, y) = pair.split_once(',')?;
                Some((x.parse().ok()?, y.parse().ok()?))
            };
            lines.push(points.unwrap_or_default().split_whitespace().filter_map(point).collect());
        }
    }
    (numbers, lines)
}

/// The scale of an axis of a picture: what stands at a place, from two numbers beside it that are far apart.
fn scale(numbers: &[(f64, f64)]) -> impl Fn(f64) -> f64 + use<> {
    let by = |one: &&(f64, f64), other: &&(f64, f64)| one.0.total_cmp(&other.0);
    let (low, high) = (numbers.iter().min_by(by), numbers.iter().max_by(by));
    let (low, high) = (*low.expect("a number"), *high.expect("another one"));
    assert!(high.0 > low.0, "{numbers:?}");
    move |place| low.1 + (place - low.0) / (high.0 - low.0) * (high.1 - low.1)
}

/// Every point of the four curves lies where y, y′, y″ and y‴ of the quintic are, by the numbers beside the rows.
#[test]
fn the_picture_is_the_curve() {
    let desk = desk();
    // At 1 deg/s derivatives by time are those by the master.
    desk.twin("cam plot lift.toml --master-velocity 1 -o lift.svg").ended(0, "");
    let picture = desk.text("lift.svg");
    // The jerk is so small that its numbers have a power of ten, which stands with the unit.
    let units = [("(mm)", 1.0), ("(mm/s)", 1.0), ("(mm/s²)", 1.0), ("(10⁻³ mm/s³)", 1e-3)];
    for (unit, _) in units {
        assert!(picture.contains(&format!(">{unit}</text>")), "{unit}");
    }
    let (numbers, lines) = parts(&picture);
    // Numbers of rows stand in one column, those of the master in one line below.
    let left = numbers.iter().map(|(x, ..)| *x).fold(f64::INFINITY, f64::min);
    let below = numbers.iter().map(|(_, y, _)| *y).fold(f64::NEG_INFINITY, f64::max);
    let masters: Vec<_> = numbers
        .iter()
        .filter(|(_, y, _)| *y >= below)
        .map(|(x, _, number)| (*x, *number))
        .collect();
    let master = scale(&masters);
    let beside: Vec<_> = numbers
        .iter()
        .filter(|(x, y, _)| *x <= left && *y < below)
        .map(|(_, y, number)| (*y, *number))
        .collect();
    // y and derivatives of the rise, 100 over 180; the way back is its mirror image.
    let curve = |x: f64, derivative: usize| {
        let s = x.min(360.0 - x) / 180.0;
        let (h, w) = (100.0, 180.0_f64);
        let sign = if x > 180.0 && derivative % 2 == 1 { -1.0 } else { 1.0 };
        sign / units[derivative].1
            * match derivative {
                0 => h * (10.0 * s.powi(3) - 15.0 * s.powi(4) + 6.0 * s.powi(5)),
                1 => h / w * (30.0 * s.powi(2) - 60.0 * s.powi(3) + 30.0 * s.powi(4)),
                2 => h / w.powi(2) * (60.0 * s - 180.0 * s.powi(2) + 120.0 * s.powi(3)),
                _ => h / w.powi(3) * (60.0 - 360.0 * s + 360.0 * s.powi(2)),
            }
    };
    let curves: Vec<_> = lines.into_iter().filter(|line: &Vec<_>| line.len() > 100).collect();
    // A row begins on the left; what jumps half way, as the jerk does, goes on in another line.
    let mut rows: Vec<Line> = Vec::new();
    for line in curves {
        match rows.last_mut() {
            Some(row) if master(line[0].0) >= 90.0 => row.extend(line),
            _ => rows.push(line),
        }
    }
    assert_eq!(rows.len(), 4, "rows of curves");
    for (derivative, points) in rows.iter().enumerate() {
        let (top, bottom) = points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (_, y)| (a.min(*y), b.max(*y)));
        // A row has a margin of an eighth above and below.
        let margin = 0.15 * (bottom - top);
        let of_row: Vec<_> = beside
            .iter()
            .filter(|(y, _)| *y >= top - margin && *y <= bottom + margin)
            .copied()
            .collect();
        let value = scale(&of_row);
        let pixel = (value(0.1) - value(0.0)).abs();
        let across = (master(0.1) - master(0.0)).abs();
        assert!(points.len() > 700, "{} points", points.len());
        let (first, last) = (points[0].0, points[points.len() - 1].0);
        assert!(master(first).abs() <= across && (master(last) - 360.0).abs() <= across);
        for (x, y) in points {
            let (place, found) = (master(*x).clamp(0.0, 360.0), value(*y));
            // A tenth of a pixel either way, and as much of the numbers next to the row.
            let steep = (curve((place + across).min(360.0), derivative)
                - curve((place - across).max(0.0), derivative))
            .abs();
            let near_jump = derivative == 3 && (place - 180.0).abs() <= 2.0 * across;
            let tolerance = 2.0 * pixel + steep;
            let expected = curve(place, derivative);
            let mirrored = near_jump && (found + expected).abs() <= tolerance;
            assert!(
                (found - expected).abs() <= tolerance || mirrored,
                "derivative {derivative} at {place}: {found}, expected {expected}"
            );
        }
    }
}

/// What a form leaves behind, and files of another kind, are told.
#[test]
fn what_is_lost_or_mistaken_is_told() {
    let desk = desk();
    desk.twin("cam convert lift.toml lift.csv")
        .ended(0, "1 of lift.toml are left behind")
        .ended(0, "lift.csv: lost: the slave's period, 100")
        .ended(0, "lift.csv: lost: this form has no tappets");
    let table = desk.text("lift.csv");
    assert!(
        table.starts_with("master_deg,slave_mm,velocity_mm_per_deg,acceleration_mm_per_deg2\n")
    );
    let kept = desk.twin("cam convert lift.toml kept.toml");
    kept.ended(0, "");
    assert!(!kept.stderr.contains("lost"), "{}", kept.stderr);
    desk.twin("cam plot lift.toml --master-velocity 360 -o lift.png").ended(2, "pictures are SVG");
    assert!(!desk.path("lift.png").exists());
    desk.twin("cam run lift.toml --machine machine.toml --drives none")
        .ended(1, "this is a cam, not a job");
    desk.write("job.toml", "[[blocks]]\nblock = \"MC_Halt\"\naxis = \"X\"\n");
    desk.twin("cam check job.toml --master-velocity 1").ended(2, "this is a job, not a cam");
}

/// 1.1 · 100 − 110 is 0 but for rounding, in doubles 1.4e-14; and what cannot be read is the manual's 2200.
#[test]
fn rounding_is_no_place_of_a_tappet() {
    let desk = Desk::new();
    desk.write(
        "lift.toml",
        "name = \"lift\"\nmaster = { min = 0, max = 360 }\nslave = { min = 0, max = 100 }\nelements = [{ master = 0, slave = 0 }, \
         { master = 180, slave = 100 }, { master = 360, slave = 0 }]\ntappets = [{ group = 1, master = 180, passage = \"positive\", \
         action = \"on\" }]\n",
    );
    let done = desk.twin("cam check lift.toml --slave-scaling 1.1 --slave-offset -110");
    done.ended(0, "");
    let row = done.stdout.lines().find(|line| line.contains(" positive "));
    let cells: Vec<_> =
        row.unwrap_or_else(|| panic!("{}", done.stdout)).split_whitespace().collect();
    assert_eq!(cells.get(3..5), Some(&["180", "0"][..]), "{}", done.stdout);
    desk.write(
        "turned.toml",
        "name = \"turned\"\nmaster = { min = 0, max = 9 }\nslave = { min = 0, max = 9 }\nelements = [{ master = 0, slave = 0 },\n\
         { master = 9, slave = 0 },\n{ master = 5, slave = 5 }]\n",
    );
    desk.twin("cam check turned.toml")
        .ended(0, "turned.toml: line 6: the element at master 5 comes after the one at 9");
    for name in ["none.toml", "none.asc"] {
        desk.twin(&format!("cam check {name}")).ended(2, "(error 2200)");
    }
}

/// 0 to 20 over 50, and a line of 0.8 on to 60 at 100: there a slave that stays has to lose 0.8 at once, at whatever velocity.
#[test]
fn a_cam_that_jumps_has_no_largest_velocity() {
    let desk = Desk::new();
    let elements = "elements = [{ master = 0, slave = 0 }, { from = [50, 20], to = [100, 60] }]";
    // Where nobody says it the slave's scale is from its least to its greatest position.
    desk.write(
        "line.toml",
        &format!("name = \"line\"\nmaster = {{ min = 0, max = 100 }}\n{elements}\n"),
    );
    let check = |more: &str| desk.twin(&format!("cam check line.toml {more}"));
    let done = check("--max-acceleration 100");
    done.ended(1, "the pass ends at master 100").ended(1, "jumps by -0.8 u/s");
    let said = "no velocity of the master is slow enough: y\u{2032} jumps by -0.8 at master 100";
    assert!(done.stdout.contains(said) && !done.stdout.contains("may go"), "{}", done.stdout);
    // A velocity alone has a bound.
    check("--max-velocity 8").ended(0, "").says("the master may go 10 u/s");
}

/// Numbers for people: what is rounding beside the cam is 0, and what exceeds a limit by little is told with as many digits as that
/// takes. Places are 0.1 apart, of which 3 are not 0.3.
#[test]
fn rounding_is_not_told() {
    let desk = desk();
    let done = desk.twin("cam check lift.toml --max-velocity 1.0416665 --master-offset 0.3");
    // 15/8 · 100/180 mm/deg.
    done.ended(1, "the slave's velocity is 1.0416667 mm/s at master 89.7 deg")
        .ended(1, "its limit is 1.0416665 mm/s");
    let sampled = |more: &str| desk.twin(&format!("cam sample lift.toml --points 3601 {more}"));
    for more in ["", "--slave-scaling 0.1", "--slave-offset -50 --master-acceleration 7"] {
        let done = sampled(more);
        done.ended(0, "");
        for cell in done.stdout.lines().skip(1).flat_map(|line| line.split(',')) {
            let value: f64 = cell.parse().expect("a number");
            assert!(value == 0.0 || value.abs() > 1e-12, "{cell}");
        }
    }
}

/// A cam of tappets alone has no slave: nothing is told of one.
#[test]
fn tappets_alone_have_no_table_of_a_slave() {
    let desk = Desk::new();
    let text = "name = \"marks\"\nkind = \"tappets\"\nmaster = { min = 0, max = 360, unit = \"deg\" }\n\
                tappets = [{ group = 4, master = 90, action = \"on\" }]\n";
    desk.write("marks.toml", text);
    let done = desk.twin("cam check marks.toml --master-velocity 180");
    done.ended(0, "");
    for (word, told) in [
        ("tappets only", true),
        ("500", true),
        ("master (deg)", true),
        ("position", false),
        ("slave", false),
        ("may go", false),
    ] {
        assert_eq!(done.stdout.contains(word), told, "{word} in {}", done.stdout);
    }
}

/// Whatever its size, an offset of the master is refused with its limit, or reckoned with as far as numbers go, and at once.
#[test]
fn offsets_of_any_size_are_told_or_taken() {
    let desk = desk();
    let cam = |offset: &str| {
        desk.write(
            "far.toml",
            &format!(
                "master = {{ min = 0, max = 360 }}\nslave = {{ min = 0, max = 9, period = 9 }}\n\
                 elements = [{{ master = 0, slave = 0 }}, {{ master = 100, slave = 9 }}, {{ master = 360, slave = 0 }}]\n\
                 tappets = [{{ group = 1, master = 20, action = \"invert\" }}]\n[coupling]\nmaster_offset = {offset}\n"
            ),
        );
    };
    desk.write(
        "run.csv",
        "time,master,slave,tappet_1\n0,0,0,0\n0.1,10,1,1\n0.2,20,2,0\n0.3,30,3,1\n",
    );
    let commands = [
        "cam check far.toml",
        "cam sample far.toml --step 30",
        "cam plot far.toml -o far.svg",
        "cam convert far.toml again.toml --force",
        "tune cam far.toml --run run.csv",
        "tune cam far.toml --find slave-scaling --max-velocity 1",
        "tune cam far.toml --ramp-in 0,0 --max-velocity 1 --max-acceleration 1",
    ];
    for (offset, said) in [
        ("1e300", "`master_offset` is 1e300; it must lie between"),
        ("-1e16", "`master_offset` is -1e16; it must lie between"),
        ("nan", "`master_offset` is nan"),
    ] {
        cam(offset);
        for command in commands {
            desk.twin(command).ended(2, said);
        }
    }
    for offset in ["1e15", "-1e15", "-123456789012.5"] {
        cam(offset);
        for command in commands {
            let done = desk.twin(command);
            let run = command.contains("run.csv");
            let as_usual = if run { Some(1) } else { Some(0) };
            let beyond = command.contains("--ramp-in") && done.stderr.contains("the master is at ");
            assert!(done.status == as_usual || beyond, "{offset} {command:?}: {}", done.stderr);
        }
        // 1e15 and 1e15 mod 360: the same place of the cam.
        let value = offset.parse::<f64>().expect("a number").rem_euclid(360.0);
        let samples = |offset: &str| {
            cam(offset);
            let done = desk.twin("cam sample far.toml --step 30");
            let slave = |line: &str| line.split(',').nth(1).map(str::to_owned);
            done.stdout.lines().skip(1).filter_map(slave).collect::<Vec<_>>()
        };
        let [mut far, mut near] = [samples(offset), samples(&value.to_string())];
        far.sort();
        near.sort();
        assert_eq!(far.len(), 13, "{far:?}");
        assert_eq!(far, near, "{offset}");
    }
    cam("0");
    desk.twin("cam check far.toml --master-offset 1e300").ended(2, "`1e300` is beyond ±1e15");
}

/// Options stand under the headings that they belong to, and none speaks of another that its command has not.
#[test]
fn help_is_in_order() {
    let desk = desk();
    let help = |command: &str| {
        let done = desk.twin(&format!("{command} --help"));
        done.ended(0, "");
        done.stdout
    };
    let own: [(&str, &[&str]); 4] = [
        ("cam check", &["--format"]),
        ("cam plot", &["--output"]),
        ("cam sample", &["--points", "--step", "--output"]),
        ("tune cam", &["--run", "--master-start", "--ramp-in", "--within", "--write", "--format"]),
    ];
    for (command, options) in own {
        let text = help(command);
        let heading = text.find("\nMaster:\n").expect("a heading");
        for option in options {
            let place = [format!(" {option} <"), format!(" {option} [")]
                .iter()
                .filter_map(|words| text.lines().position(|line| line.contains(words.as_str())))
                .min()
                .unwrap_or_else(|| panic!("{command:?} has no {option}"));
            let before: usize = text.lines().take(place).map(|line| line.len() + 1).sum();
            assert!(before < heading, "{command:?}: {option} is under a heading");
        }
        assert_eq!(text.contains("with a --run that of the run"), command == "tune cam", "{text}");
    }
}
