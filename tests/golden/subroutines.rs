//! RS274 programs with loops and subroutines: the file and line of what is found, and feasible feeds.

use crate::desk::{Desk, number};
use serde_json::{Value, json};

const PLATE: &str = "\
G21 G90 G94 G17
G0 X0 Y0
o<pocket> call [5]
G1 X0 F300
o<pocket> call [9]
M2
";
const POCKET: &str = "o<pocket> sub\n(comment)\nG1 X#1 F600\n  N7 Y2\no<pocket> endsub\n";

/// Line, file and line of the call, of all elements or findings.
fn places(rows: &[Value]) -> Vec<Value> {
    rows.iter().map(|row| json!([row["line"], row["file"], row["called_from"]])).collect()
}

/// The lines are those of LinuxCNC's interpreter for the two files.
#[test]
fn moves_of_a_subroutine_file_have_its_lines() {
    let desk = Desk::new();
    desk.write("plate.ngc", PLATE);
    desk.write("pocket.ngc", POCKET);
    let rows = desk.twin("path plate.ngc").ended(0, "").rows();
    let file = "pocket.ngc";
    let expected = [
        json!([2, null, null]),
        json!([3, file, 3]),
        json!([4, file, 3]),
        json!([4, null, null]),
        json!([3, file, 5]),
        json!([4, file, 5]),
    ];
    assert_eq!(places(&rows), expected);
    assert_eq!((&rows[2]["block"], &rows[3]["block"]), (&json!(7), &Value::Null));
    // The one of the program has the line only.
    assert!(!rows[3].as_object().expect("an object").contains_key("file"));
}

#[test]
fn findings_in_a_subroutine_file() {
    let desk = Desk::new();
    desk.write("plate.ngc", &PLATE.replace("call [9]", "call [700]").replace("X0 F300", "X660"));
    // X may go to 650 mm.
    desk.write("pocket.ngc", &POCKET.replace("N7 Y2", "N7 X#1 Y2\nG1 X1 Q\nX10"));
    let report = desk.twin("check plate.ngc -m machine.toml --format json").ended(1, "").object();
    let of_rule = |rule: &str| -> Vec<Value> {
        let all = report["findings"].as_array().expect("findings");
        places(&all.iter().filter(|one| one["rule"] == rule).cloned().collect::<Vec<_>>())
    };
    let file = "pocket.ngc";
    assert_eq!(of_rule("syntax"), [json!([5, file, 3]), json!([5, file, 5])]);
    desk.write("pocket.ngc", &POCKET.replace("N7 Y2", "N7 X#1 Y2\nX10"));
    let done = desk.twin("check plate.ngc -m machine.toml --format json");
    let findings = done.ended(1, "").object()["findings"].as_array().expect("findings").clone();
    let beyond: Vec<_> =
        findings.into_iter().filter(|one| one["rule"] == "axis-position").collect();
    // Line 4 of the program is another one than line 4 of the file, in which X does not move.
    assert_eq!(places(&beyond), [json!([4, null, null]), json!([3, file, 5]), json!([5, file, 5])]);
    let done = desk.twin("check plate.ngc -m machine.toml");
    done.ended(1, "pocket.ngc line 3 (called from line 5): axis X");
    for text in ["[pocket.ngc:3:", "G1 X#1 F600", "… and in 2 more lines: 4, pocket.ngc:5"] {
        assert!(done.stderr.contains(text), "{text} is not in\n{}", done.stderr);
    }
}

/// The path is along X, Y and Z; Z does 200 mm/s, the others 400 mm/s.
const LOOPS: &str = "\
G21 G90 G94 G17
o2 sub
G1 Y[20+#<_step>]
Z-10
Y0
o2 endsub
F15000
#<_step>=0
o1 while [#<_step> LT 3]
G1 X[100+#<_step>]
o3 if [#<_step> EQ 1]
G1 Z-15
o3 else
G1 X50
o3 endif
o2 call
#<_step>=[#<_step>+1]
o1 endwhile
G1 X0
M2
";

#[test]
fn feasible_feeds_of_loops_and_subroutines() {
    let desk = Desk::new();
    desk.write("loops.ngc", LOOPS);
    let limit = "limit loops.ngc -m machine.toml --feasible slower.ngc";
    desk.twin(limit).ended(0, "F is too fast on 2 of 20 lines; F changed in 4 lines");
    let expected = LOOPS
        .replace("Y[20+#<_step>]", "Y[20+#<_step>] F15000")
        .replace("Z-10\nY0", "Z-10 F12000\nY0 F15000")
        .replace("Z-15", "Z-15 F12000");
    assert_eq!(desk.text("slower.ngc"), expected);
    let path = |name: &str| desk.twin(&format!("path {name} -m machine.toml")).ended(0, "").rows();
    let (before, after) = (path("loops.ngc"), path("slower.ngc"));
    assert!(before.len() > 15 && before.len() == after.len(), "{}", before.len());
    for (mut before, mut after) in before.into_iter().zip(after) {
        let upright = [4, 12].map(Value::from).contains(&before["line"]);
        let expected = if upright { 200.0 } else { 250.0 };
        assert!((number(&after["feed_mm_per_s"]) - expected).abs() < 1e-9, "{after}");
        for element in [&mut before, &mut after] {
            element.as_object_mut().expect("an object").remove("feed_mm_per_s");
        }
        assert_eq!(after, before);
    }
    desk.twin("check slower.ngc -m machine.toml").ended(0, "");
    let again = "limit slower.ngc -m machine.toml --feasible again.ngc";
    desk.twin(again).ended(0, "too fast on 0 of 20 lines");
    assert_eq!(desk.text("again.ngc"), desk.text("slower.ngc"));
}

#[test]
fn the_feed_of_a_subroutine_file_stays() {
    let desk = Desk::new();
    desk.write("plate.ngc", PLATE);
    desk.write("pocket.ngc", &POCKET.replace("F600", "Z-10 F15000"));
    let words = "line 3: the feed of this line cannot be changed: its moves are in a subroutine file of their own";
    desk.twin("limit plate.ngc -m machine.toml --feasible slower.ngc").ended(2, words);
    assert!(!desk.path("slower.ngc").exists());
}
