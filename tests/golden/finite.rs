//! Numbers that are not finite leave no command, however extreme the finite numbers of its input are.

use crate::desk::{Desk, shipped};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use std::fmt::Write as _;
use std::fs::File;
use std::ops::Range;
use std::time::Duration;

/// Extreme numbers: the largest, the smallest, those whose squares or cubes are not finite, −0.
const EXTREMES: [f64; 16] = [
    f64::MAX,
    -f64::MAX,
    1e308,
    -1e308,
    1e300,
    -1e160,
    1e150,
    1e100,
    1e15,
    -1e15,
    1e9,
    1e-15,
    1e-160,
    1e-308,
    5e-324,
    -0.0,
];

/// Commands; `@` is a number. What they write begins with `out`.
const COMMANDS: [&str; 62] = [
    "check p.cnc -m machine.toml",
    "check p.cnc -m machine.toml --format json",
    "check p.ngc -m machine.toml --format json --tool-table tools.tbl",
    "check curves.cnc -m machine.toml --format json",
    "check curves.cnc -m machine.toml --limits programmed --format json",
    "check p.cnc -m machine.toml --limits programmed --override @ --profile jerk-limited --jerk @",
    "check p.cnc -m machine.toml --limits programmed --at @:override=@",
    "check p.cnc -m machine.toml --limits programmed --by-position pos.txt --position-offset @",
    "check p.cnc -m machine.toml --physics --format json",
    "check p.cnc -m machine.toml --drives predicted",
    "check p.cnc -m machine.toml --clearance out.csv",
    "check var.cnc -m machine.toml --variables vars.toml",
    "check var.cnc -m machine.toml --var A=@ --var B=@",
    "check job.toml -m machine.toml --format json",
    "path p.cnc -m machine.toml",
    "path p.ngc -m machine.toml --prepare --format jsonl",
    "path curves.cnc --prepare --format info",
    "path curves.cnc --format dxf -o out.dxf",
    "path p.cnc --format svg -o out.svg",
    "path p.ngc --format queue",
    "path curves.cnc --format din66025",
    "path curves.cnc --format rs274",
    "path p.cnc -m machine.toml --format setpoints",
    "path curves.cnc --scale @ --rotate @ --translate @,@",
    "path curves.cnc --linearise @ --format jsonl",
    "path p.cnc --start @,@,@ --angle-tolerance @",
    "path p.cnc --prepare --tool-radius @ --gouge-tolerance @ --rounding-distance @",
    "path p.cnc --prepare --circular-acceleration @ --circular-acceleration-jump @",
    "path part.dxf",
    "path part.dxf --join @ --chord @ --drawing-unit @ --feed @ --acceleration @",
    "path part.dxf --safe-height @ --cut-height @ --plunge-feed @",
    "limit p.cnc -m machine.toml --format json",
    "limit p.cnc -m machine.toml -o out.csv",
    "limit p.ngc -m machine.toml -o out.svg --lines out.csv",
    "limit p.cnc -m machine.toml --feasible out.cnc",
    "run p.cnc -m machine.toml --drives none --report out.json --log-axis X=all:out.log",
    "run p.cnc -m machine.toml --drives none --report out.json --override-at 0.1=@ --tolerance @",
    "cam run job.toml -m machine.toml --drives none --report out.json",
    "machine machine.toml",
    "machine machine.toml --format json",
    "machine machine.toml --svg out.svg --height @ --azimuth @",
    "axes inverse -m machine.toml",
    "axes forward -m machine.toml",
    "cam check lift.toml --master-velocity @ --max-velocity @ --max-acceleration @",
    "cam check lift.toml --master-velocity @ --master-acceleration @ --master-jerk @ --format json",
    "cam check lift.toml --master-offset @ --master-scaling @ --slave-offset @ --slave-scaling @",
    "cam check shear.toml --master-start @ --position-min @ --position-max @",
    "cam check table.csv --interpolation cubic --format json",
    "cam sample table.csv --master-velocity @ --step @",
    "cam sample points.csv --points 9 --master-velocity @ --master-acceleration @ --master-jerk @",
    "cam sample table.asc --points 9 --interpolation cubic",
    "cam plot lift.toml --master-velocity @ --master-jerk @ --max-jerk @ -o out.svg",
    "cam plot points.csv -o out.svg --slave-offset @",
    "cam convert points.csv out.toml --table equidistant --points 30",
    "cam convert table.asc out.csv --tolerance @",
    "cam convert shear.toml out.asc --points 50",
    "tune cam lift.toml --run run.csv --format json",
    "tune cam lift.toml --run run.csv --find slave-offset,slave-scaling --write out.toml -o out.svg",
    "tune cam lift.toml --find slave-scaling --master-velocity @ --max-acceleration @",
    "tune cam lift.toml --find slave-scaling=@..@ --minimise jerk --master-velocity @",
    "tune cam lift.toml --ramp-in @,@ --master-velocity @ --max-velocity @ --max-acceleration @",
    "explain @",
];

const MACHINES: [&str; 6] = [
    "machines/gantry3.toml",
    "machines/gantry3_motors.toml",
    "machines/gantry3_vice.toml",
    "machines/gantry_h2.toml",
    "machines/scara2.toml",
    "machines/tripod.toml",
];

/// The files that commands name.
fn files(machine: usize) -> Vec<(&'static str, String)> {
    let recorded = shipped("examples/tutorial/pick_and_place_run.csv");
    let job = shipped("examples/jobs/flying_shear.toml").replace("../cams/flying_", "");
    vec![
        ("machine.toml", shipped(MACHINES[machine])),
        ("lift.toml", shipped("examples/cams/pick_and_place.toml")),
        ("shear.toml", shipped("examples/cams/flying_shear.toml")),
        ("job.toml", job.replace("duration_s = 14", "duration_s = 5")),
        ("table.csv", shipped("examples/cams/indexer.csv")),
        ("table.asc", "0;0\n90;10\n180;40\n270;20\n360;0\n".to_owned()),
        (
            "points.csv",
            "master,slave,velocity,acceleration\n0,0,0,0\n90,10,0.2,0.01\n180,40,0,0\n360,0,0,0\n"
                .to_owned(),
        ),
        ("run.csv", recorded.split_inclusive('\n').take(700).collect()),
        (
            "p.cnc",
            "% p\nN10 G92 X10 Y0 Z20\nN20 G1 X20 Y5 F50 E500 E-500\nN30 G2 X30 Y5 I5 J0\n\
             N40 G3 X30 Y15 R6 F30\nN50 G51 D2\nN60 G1 X10 Y15\nN70 G1 Y3 X12\nN80 G50\n\
             N90 G4 T0.1\nN100 G1 X10 Y0 Z15\nN110 M100 L5 O5\n"
                .to_owned(),
        ),
        (
            "curves.cnc",
            "% curves\nN10 G1 X20 Y5 F50 E500 E-500\nN20 G8 X30 Y5 I5 J0 K3 L1\n\
             N30 G6 X40 Y5 I5 J3\nN40 G5 X50 Y9\nN50 G5 X60 Y9\nN60 G1 X10 H1 L3 F20\n\
             N70 G41 D1\nN80 G1 X20 Y20\nN90 G1 X40 Y20\nN100 G40\n"
                .to_owned(),
        ),
        (
            "p.ngc",
            "G21 G90 G64 P0.1\nG0 X10 Y0 Z20\nG1 X20 Y5 F600\nG2 X30 Y5 I5 J0\nG3 X30 Y15 R6\n\
             G4 P0.1\nG81 X10 Y10 Z5 R10 F300\nG80\nG91 G1 X5 Y5\nG90 G10 L2 P1 X1\nG54\n\
             G38.2 Z0 F50\nG43 H1\nG1 X12 A3\nM2\n"
                .to_owned(),
        ),
        ("tools.tbl", "T1 P1 Z0.5 D3\nT2 P2 Z11.5 D6\n".to_owned()),
        ("vars.toml", "A = 10\nB = [1, 2, 3]\n".to_owned()),
        ("var.cnc", "% v\nN10 G1 X$A$ F50 E500 E-500\nN20 M3 O$B$\n".to_owned()),
        ("pos.txt", "0\n1\n2\n3\n4\n5\n".to_owned()),
        ("part.dxf", shipped("tests/data/path_drawing/part.dxf")),
        ("axes.csv", "10,20,5\n30,40,5\n300,0,20\n".to_owned()),
    ]
}

/// Ends of the files whose words are a letter and a number without an exponent.
fn has_words(name: &str) -> bool {
    [".cnc", ".ngc", ".tbl"].iter().any(|ending| name.ends_with(ending))
}

/// Places of the numbers in a file.
fn numbers(name: &str, text: &str) -> Vec<Range<usize>> {
    let bytes = text.as_bytes();
    let (mut found, mut at, mut comment) = (Vec::new(), 0, false);
    while let Some(byte) = bytes.get(at) {
        comment = *byte != b'\n' && (comment || *byte == b'#' && !has_words(name));
        let before = at.checked_sub(1).map_or(b'\n', |before| bytes[before]);
        let begins = if has_words(name) {
            before.is_ascii_uppercase() && !b"NGM".contains(&before)
        } else {
            !before.is_ascii_alphanumeric() && !b"_.-\"".contains(&before)
        };
        let is_part = |byte: &&u8| byte.is_ascii_digit() || b".-".contains(byte);
        let end = at + bytes[at..].iter().take_while(is_part).count();
        let whole = bytes.get(end).is_none_or(|next| !next.is_ascii_alphanumeric());
        if begins && whole && !comment && bytes[at..end].iter().any(u8::is_ascii_digit) {
            found.push(at..end);
        }
        at = end.max(at + 1);
    }
    found
}

/// The first word of `text` that stands for a number which is not finite.
fn not_finite(text: &str) -> Option<&str> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.into_iter().find(|word| {
        ["nan", "inf", "infinity"].iter().any(|wrong| word.eq_ignore_ascii_case(wrong))
    })
}

/// Fewer runs than it takes to find everything, in seconds; `TWIN_FINITE_CASES` asks for more.
fn cases() -> u32 {
    let asked = std::env::var("TWIN_FINITE_CASES").ok();
    asked.map_or(200, |asked| asked.parse().expect("a number of cases"))
}

proptest! {
    #![proptest_config(Config {
        cases: cases(),
        rng_seed: RngSeed::Fixed(34),
        failure_persistence: None,
        max_shrink_iters: 60,
        ..Config::default()
    })]

    #[test]
    fn no_output_has_a_number_that_is_not_finite(
        command in 0..COMMANDS.len(),
        machine in 0..MACHINES.len(),
        options in prop::collection::vec((prop::bool::weighted(0.4), 0..EXTREMES.len()), 5),
        changed in prop::collection::vec((any::<prop::sample::Index>(), 0..EXTREMES.len()), 0..=2),
        file in any::<prop::sample::Index>(),
    ) {
        let desk = Desk::new();
        let mut line = COMMANDS[command].to_owned();
        for (is_extreme, value) in options {
            let value = if is_extreme { format!("{:e}", EXTREMES[value]) } else { "1".to_owned() };
            line = line.replacen('@', &value, 1);
        }
        let is_job = line.contains("job.toml");
        let is_stdin = line.starts_with("axes");
        let is_used = |name: &str| {
            line.contains(name) || is_job && name == "shear.toml" || is_stdin && name == "axes.csv"
        };
        let mut used: Vec<_> = files(machine).into_iter().filter(|(name, _)| is_used(name)).collect();
        let mut what = String::new();
        if !used.is_empty() {
            let count = used.len();
            let (name, text) = &mut used[file.index(count)];
            for (place, value) in changed {
                let numbers = numbers(name, text);
                let range = numbers[place.index(numbers.len())].clone();
                let value = EXTREMES[value];
                let value = if has_words(name) { value.to_string() } else { format!("{value:e}") };
                let (start, old) = (range.start, &text[range.clone()]);
                writeln!(what, "{name}, byte {start}: {old} is {value}").expect("in memory");
                text.replace_range(range, &value);
            }
        }
        for (name, text) in &used {
            desk.write(name, text);
        }
        let output = |name| File::create(desk.path(name)).expect("a file");
        let mut command = desk.command(&line);
        command.stdout(output("out.stdout")).stderr(output("out.stderr"));
        if is_stdin {
            command.stdin(File::open(desk.path("axes.csv")).expect("a file"));
        }
        let mut child = command.spawn().expect("the binary starts");
        let mut status = None;
        for _ in 0..12_000 {
            status = child.try_wait().expect("it can be waited for");
            if status.is_some() {
                break;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        if status.is_none() {
            child.kill().expect("it can be killed");
        }
        let status = status.and_then(|status| status.code());
        prop_assert!(matches!(status, Some(0..=2)), "twin {line}\n{what}{status:?}: {}", desk.text("out.stderr"));
        for entry in std::fs::read_dir(desk.path("")).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if name.starts_with("out.") {
                let text = String::from_utf8_lossy(&std::fs::read(&path).expect("a file")).into_owned();
                let found = not_finite(&text);
                prop_assert!(found.is_none(), "twin {line}\n{what}{status:?}: {found:?} in {name}:\n{text:.3000}");
            }
        }
    }
}
