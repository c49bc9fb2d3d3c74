//! Programs as people write them: missing words, closing marks, encodings, sections of preparation, and the units of
//! the messages about them.

use crate::desk::{Desk, number};
use serde_json::Value;

/// The points of the prepared cuts of a program, mm.
fn cuts(desk: &Desk, program: &str) -> Vec<[[f64; 2]; 2]> {
    let done = desk.twin(&format!("path {program} --prepare"));
    done.ended(0, "");
    let rows = done.stdout.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let point = |row: &Value, key: &str| [0, 1].map(|axis| number(&row[key][axis]));
    rows.filter(|row| row["kind"] != "rapid")
        .map(|row| [point(&row, "start_mm"), point(&row, "end_mm")])
        .collect()
}

fn check(desk: &Desk, program: &str, status: i32) -> Value {
    let done = desk.twin(&format!("check {program} -m machine.toml --format json"));
    done.ended(status, "").object()
}

/// Rule, severity and line of every finding.
fn found(report: &Value) -> Vec<(String, String, u64)> {
    let findings = report["findings"].as_array().expect("a list").iter();
    let text = |value: &Value| value.as_str().expect("text").to_owned();
    findings
        .map(|one| {
            let line = one["line"].as_u64().expect("a line");
            (text(&one["rule"]), text(&one["severity"]), line)
        })
        .collect()
}

fn syntax(severity: &str, line: u64) -> (String, String, u64) {
    ("syntax".to_owned(), severity.to_owned(), line)
}

/// The N word is required (manual 3.2), and so is D for correction, smoothing and rounding (3.4).
#[test]
fn missing_words_are_warnings() {
    let desk = Desk::new();
    desk.write("bare.cnc", "%\nG1 X10 F50 E500 E-500\nX20\n");
    let report = check(&desk, "bare.cnc", 0);
    assert_eq!(found(&report), [syntax("warning", 2)]);
    for word in ["G41", "G42", "G51", "G52"] {
        let text = format!("%\nN10 G1 X10 F50 E500 E-500\nN20 {word}\nN30 G1 Y50\nN40 X50\n");
        desk.write("radius.cnc", &text);
        let report = check(&desk, "radius.cnc", 0);
        let lines = found(&report);
        let [(rule, severity, 4)] = &lines[..] else { panic!("{word}: {lines:?}") };
        assert_eq!((rule.as_str(), severity.as_str()), ("syntax", "warning"), "{word}");
        let message = report["findings"][0]["message"].as_str().expect("text");
        assert!(message.contains("D is 0 mm") && message.contains(word), "{message}");
    }
}

/// Each stage acts between its own marks (manual 6.2.3, 6.2.5); together they are an error (3.4).
#[test]
fn sections_of_preparation() {
    let desk = Desk::new();
    let text = |end: &str| {
        format!(
            "%\nN10 G0 X0 Y0 F50 E500 E-500\nN20 G41 D10\nN30 G1 X100\nN40 Y100\n{end}\nN60 G0 X200 Y0\n\
             N70 G51 D10\nN80 G1 X300\nN90 Y100\nN100 G50\n"
        )
    };
    desk.write("sections.cnc", &text("N50 G40"));
    let cuts = cuts(&desk, "sections.cnc");
    // Vector prep-toolcorr-inner, and a circle of 10 mm about the corner at 300/0.
    let expected = [
        [[0.0, 10.0], [90.0, 10.0]],
        [[90.0, 10.0], [90.0, 100.0]],
        [[200.0, 0.0], [290.0, 0.0]],
        [[290.0, 0.0], [300.0, 10.0]],
        [[300.0, 10.0], [300.0, 100.0]],
    ];
    assert_eq!(cuts.len(), expected.len(), "{cuts:?}");
    for (cut, wanted) in cuts.iter().flatten().flatten().zip(expected.iter().flatten().flatten()) {
        assert!((cut - wanted).abs() < 1e-6, "{cuts:?}");
    }
    desk.write("overlap.cnc", &text("N50 (still on)"));
    desk.twin("path overlap.cnc --prepare")
        .ended(1, "line 9 (N80): tool radius correction and smoothing cannot be combined");
}

/// A second % ends the program; what follows is not part of it.
#[test]
fn a_closing_percent_ends_the_program() {
    let desk = Desk::new();
    let program = "% closed\nN10 G1 X10 F50 E500 E-500\n%\n";
    desk.write("closed.cnc", program);
    let report = check(&desk, "closed.cnc", 0);
    assert_eq!(found(&report), [syntax("note", 3)]);
    assert!((number(&report["length_mm"]) - 10.0).abs() < 1e-9);
    desk.write("more.cnc", &format!("{program}N20 X20\n"));
    let report = check(&desk, "more.cnc", 0);
    assert_eq!(found(&report), [syntax("warning", 3)]);
    assert!((number(&report["length_mm"]) - 10.0).abs() < 1e-9);
}

fn utf_16(text: &str) -> Vec<u8> {
    let units = std::iter::once(0xfeff).chain(text.encode_utf16());
    units.flat_map(u16::to_le_bytes).collect()
}

/// The same text with other line ends is the same; text in UTF-16 is refused by that name, whatever it is.
#[test]
fn texts_of_other_systems() {
    let desk = Desk::new();
    let drawing =
        "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0\n20\n0\n11\n10\n21\n0\n0\nENDSEC\n0\nEOF\n";
    desk.write("p.cnc", "% p\nN10 G1 X10 F50 E500 E-500\nN20 G20 L10 K0\nN30 G41 D1\nN40 G1 Y20\n");
    desk.write("p.ngc", "G21 G90\nG1 X10 F600\nM2\n");
    desk.write("d.dxf", drawing);
    desk.write("cam.csv", "0;0\n10;5\n20;10\n");
    for (file, command) in [
        ("p.cnc", "check FILE -m machine.toml --format json"),
        ("p.ngc", "check FILE -m machine.toml --format json"),
        ("d.dxf", "path FILE"),
        ("cam.csv", "cam sample FILE"),
        ("machine.toml", "machine FILE --format json"),
    ] {
        let other = format!("other-{file}");
        let run = |name: &str| desk.twin(&command.replace("FILE", name));
        let text = desk.text(file);
        let plain = run(file);
        let status = plain.status.expect("it ended by itself");
        assert!(status < 2, "{}", plain.stderr);
        desk.write(&other, &text.replace('\n', "\r"));
        let same = run(&other).ended(status, "").stdout.replace(&other, file);
        assert_eq!(same, plain.stdout, "{file}");
        std::fs::write(desk.path(&other), utf_16(&text)).expect("written");
        run(&other).ended(2, "UTF-16 (little-endian); save it as UTF-8");
    }
}

/// A file of another program is one error, whatever its ending says.
#[test]
fn binary_files() {
    let desk = Desk::new();
    for name in ["p.cnc", "p.ngc"] {
        std::fs::write(desk.path(name), b"PK\r\n\x14\0\x08\0\x02\x03").expect("written");
        for command in ["check", "path"] {
            let done = desk.twin(&format!("{command} {name} -m machine.toml"));
            let done = done.ended(2, "this is not a text program: byte 0x14 at line 2, column 1");
            assert!(!done.stderr.contains("is not part of a word"), "{}", done.stderr);
        }
    }
}

/// The line with the number of other findings names the option that shows them.
#[test]
fn all_findings_on_request() {
    let desk = Desk::new();
    let words: Vec<String> = (101..126).map(|number| format!("G{number}")).collect();
    desk.write("p.ngc", &format!("{}\nM2\n", words.join("\n")));
    let brief = desk.twin("check p.ngc -m machine.toml");
    let brief = brief.ended(1, "more; `twin check -v` shows them");
    assert!(!brief.stderr.contains("G125 is not supported"), "{}", brief.stderr);
    let all = desk.twin("check p.ngc -m machine.toml -v");
    let all = all.ended(1, "G125 is not supported");
    assert!(!all.stderr.contains("`twin check -v`"), "{}", all.stderr);
}

/// Degrees of an additional axis are not millimetres, and no message is in metres.
#[test]
fn lengths_are_millimetres() {
    let desk = Desk::new();
    desk.write("turn.cnc", "%\nN10 G1 X10 F50 E500 E-500\nN20 G1 P90\n");
    desk.twin("path turn.cnc --format info")
        .ended(0, "")
        .says("length           10.000 mm (0.000 rapid, 10.000 cut)");
    let rows = desk.twin("path turn.cnc");
    let last: Value =
        serde_json::from_str(rows.stdout.lines().last().expect("rows")).expect("JSON");
    assert_eq!((number(&last["length_mm"]), number(&last["extra"]["P"][1])), (0.0, 90.0));
    let text = "%\nN10 G41 D5\nN20 G1 X50 F50\nN30 D4.1\nN40 G1 Y50\n";
    desk.write("radius.cnc", text);
    let said = "the tool radius changes from 5 mm to 4.1 mm within tool radius correction";
    desk.twin("path radius.cnc --prepare").ended(1, said);
}

/// A check says first whether the program is fit, and how many findings there are.
#[test]
fn the_verdict_comes_first() {
    let desk = Desk::new();
    desk.write("fit.cnc", "%\nN10 G1 X10 F50 E500 E-500\n");
    desk.write("unfit.cnc", "%\nN10 G1 X300 F500 E2000 E-2000\n");
    let first = |program: &str, status: i32| {
        let done = desk.twin(&format!("check {program} -m machine.toml --limits programmed"));
        done.ended(status, "").stdout.lines().next().expect("a line").to_owned()
    };
    assert_eq!(first("fit.cnc", 0), "fit.cnc: fit: 0 errors, 0 warnings");
    assert_eq!(first("unfit.cnc", 1), "unfit.cnc: not fit: 1 error, 0 warnings");
}

/// What one lost answer costs is a line that only -v asks for: 20 ms to spare and a round of an InterpCNC, three commands of
/// 35 bytes and a sample of 37 with two silences of 1.75 ms and 2 ms for the board each, are 54 ms at 20 mm/s.
#[test]
fn lost_answers_are_a_line_behind_v() {
    let desk = Desk::new();
    desk.write("slow.cnc", "%\nN10 G1 X40 F20 E500 E-500\n");
    let run = |more: &str| {
        let done = desk.twin(&format!("check slow.cnc -m machine.toml --drives predicted {more}"));
        done.ended(0, "");
        let lines = done.stdout.lines().filter(|line| line.contains("lost answer"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(run("").is_empty());
    let said = run("-v");
    let [line] = &said[..] else { panic!("{said:?}") };
    assert!(line.contains("up to 54 ms: X 1.09 mm (limit 0.50, line 2)"), "{line}");
}

/// `fSWMaxDeceleration` (manual 2.1.3): E-2000 is more than the axis may brake with, E2000 is not more than it may
/// speed up with.
#[test]
fn a_deceleration_has_its_own_limit() {
    let desk = Desk::new();
    let text = desk.text("machine.toml");
    let key = "max_acceleration_mm_per_s2 = 3000.0";
    assert!(text.contains(key));
    let own = format!("{key}\nmax_deceleration_mm_per_s2 = 1500.0");
    desk.write("machine.toml", &text.replacen(key, &own, 1));
    desk.write("hard.cnc", "%\nN10 G1 X200 F100 E2000 E-2000\n");
    desk.write("soft.cnc", "%\nN10 G1 X200 F100 E2000 E-1500\n");
    let report = check(&desk, "hard.cnc --limits programmed", 1);
    let finding = &report["findings"][0];
    assert_eq!(finding["rule"], "axis-acceleration");
    let message = finding["message"].as_str().expect("text");
    assert!(message.contains("deceleration 2000") && message.contains("1500"), "{message}");
    for (key, value, limit) in [("acceleration", 2000.0, 3000.0), ("deceleration", 2000.0, 1500.0)]
    {
        let peak = &report["peak"]["X"][key];
        assert!((number(&peak["value"]) - value).abs() < 1e-6, "{peak}");
        assert!((number(&peak["limit"]) - limit).abs() < 1e-6, "{peak}");
    }
    assert_eq!(report["peak"]["Y"]["deceleration"], Value::Null);
    assert!(found(&check(&desk, "soft.cnc --limits programmed", 0)).is_empty());
    // Plans within the limits of the axes speed up with E2000 and slow down with the deceleration of the axis.
    let report = check(&desk, "hard.cnc --limits axes", 0);
    for (key, most) in [("acceleration", 2000.0), ("deceleration", 1500.0)] {
        let value = number(&report["peak"]["X"][key]["value"]);
        assert!((most * 0.999..=most * 1.001).contains(&value), "{key}: {value}");
    }
    // 200 mm at 100 mm/s, with ramps of 100/2000 s and 100/1500 s.
    let takes = 2.0 + 0.5 * (100.0 / 2000.0 + 100.0 / 1500.0);
    assert!((number(&report["duration_s"]) - takes).abs() < 2e-3, "{}", report["duration_s"]);
    desk.twin("machine machine.toml").ended(0, "").says("3000.0 mm/s², braking 1500.0");
    let axes = desk.twin("machine machine.toml --format json").ended(0, "").object();
    assert!((number(&axes["axes"][0]["deceleration"]) - 1500.0).abs() < 1e-9, "{axes}");
}

/// Every X of a path that is followed by position must occur once (manual 6.6).
#[test]
fn ambiguous_paths_by_position() {
    let desk = Desk::new();
    desk.write("x.txt", "0\n5\n12\n25\n");
    let program = |middle: &str| {
        desk.write(
            "a.cnc",
            &format!("%\nN10 G92 X0 Y0\nN20 G1 X10 Y5 F20\n{middle}\nN40 G1 X30 Y20\n"),
        );
        desk.twin("path a.cnc --format setpoints --by-position x.txt")
    };
    program("N30 G1 X20 Y10").ended(0, "");
    assert!(!program("N30 G1 X20 Y10").stderr.contains("ambiguous-position"));
    for (middle, said) in [
        ("N30 G1 X7 Y10", "X goes back by 3.000 mm"),
        ("N30 G1 Y10", "X stays here while the path goes on by 5.000 mm"),
    ] {
        program(middle).ended(0, "ambiguous-position").ended(0, "line 4 (N30)").ended(0, said);
    }
}

/// Message and hint of every finding of a control.
fn of_control(report: &Value) -> Vec<String> {
    let findings = report["findings"].as_array().expect("a list").iter();
    findings
        .filter(|one| one["rule"] == "control")
        .map(|one| format!("{} {}", one["severity"], one["message"]).replace('"', ""))
        .collect()
}

/// What a control refuses is an error, what it passes over a warning; the machine file may name the control.
#[test]
fn programs_for_a_control() {
    let desk = Desk::new();
    desk.write("part.nc", "G21 F600\nG0 X10\nG81 X20 Z-1 R0\nX30\nG80\nM1\n");
    let machine = std::fs::read_to_string(desk.path("machine.toml")).expect("a machine");
    let machine = machine.replace("[rs274]", "[rs274]\ncontrol = \"grbl\"");
    desk.write("grbl.toml", &machine);
    let expected = ["error grbl refuses G81", "warning grbl passes over M1: optional stops"]
        .map(str::to_owned);
    for arguments in ["-m machine.toml --for grbl", "-m grbl.toml"] {
        let done = desk.twin(&format!("check part.nc {arguments} --format json"));
        assert_eq!(of_control(&done.ended(1, "").object()), expected, "{arguments}");
    }
    // The option is the stronger one; the program of the machine's control has no end, which LinuxCNC refuses.
    let done = desk.twin("check part.nc -m grbl.toml --for linuxcnc --format json");
    let report = done.ended(1, "").object();
    assert_eq!(found(&report), [syntax("error", 6)]);
    let done = desk.twin("check part.nc -m machine.toml --for grbl");
    let hint = "`twin path PROGRAM --for grbl --format rs274` writes it without this word";
    assert!(done.ended(1, "").stderr.contains(hint), "{}", done.stderr);
    desk.write("part.cnc", "%\nN10 G1 X10 F50 E500 E-500\n");
    let done = desk.twin("check part.cnc -m machine.toml --for grbl");
    done.ended(2, "grbl does not read DIN 66025");
    desk.twin("check part.cnc -m machine.toml --strict")
        .ended(2, "--strict is for programs in RS274");
    desk.twin("check part.nc -m machine.toml --for siemens").ended(2, "softmotion");
}

/// What LinuxCNC refuses and shops run is one warning of a kind, or an error with `--strict`.
#[test]
fn lenient_and_strict() {
    let desk = Desk::new();
    desk.write("shop.nc", "G21\nX10\nX11\nG1 X12\nX13\nG2 X15 I1 K3\nM10\nM10\n");
    let warnings = [2, 4, 6, 7, 8].map(|line| {
        let rule = match line {
            6 => "arc-geometry",
            7 => "unsupported-word",
            _ => "syntax",
        };
        (rule.to_owned(), "warning".to_owned(), line)
    });
    assert_eq!(found(&check(&desk, "shop.nc", 0)), warnings);
    let done = desk.twin("check shop.nc -m machine.toml --strict --format json");
    let report = done.ended(1, "").object();
    let lines: Vec<_> =
        found(&report).into_iter().map(|(_, severity, line)| (severity, line)).collect();
    let error = |line| ("error".to_owned(), line);
    assert_eq!(lines, [2, 3, 4, 6, 7, 8, 8].map(error));
}
