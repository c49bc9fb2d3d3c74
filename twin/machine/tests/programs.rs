//! Tests of machine-file settings for programs: additional axes, RS274, M functions.

use super::{Machine, SHORT, load, near, problems};
use twin_kinematics::{AxisVector, Kinematics};

/// A turntable outside of the transform.
const TURNTABLE: &str = "[[axes]]\nname = \"C\"\nrole = \"P\"\nkind = \"rotary\"\nposition_min_deg = -3600\nposition_max_deg = 3600\nmax_velocity_deg_per_s = 360\nmax_acceleration_deg_per_s2 = 3600\n";

/// The short machine without its drive.
pub(super) fn without_drive() -> String {
    let lines: Vec<_> = SHORT.lines().filter(|line| !line.starts_with("drive")).collect();
    (lines.join("\n") + "\n")
        .replace("[[drives]]\nname = \"board\"\nkind = \"interpcnc\"\n", "")
        .replace("increments = 3200\nper_mm = 10\n", "")
        .replace("increments = 3200\nper_mm = 5\n", "")
}

/// An additional axis starts where the file says, in its own unit, and not in the middle of its limits.
#[test]
fn additional_axes_start_where_the_file_says() {
    let turntable = TURNTABLE.replace("max_deg = 3600", "max_deg = 90");
    let text = format!("{}{turntable}", without_drive());
    assert_eq!(load(&text).start_axes().unwrap().get(3), Some(&0.0));
    let started = load(&format!("{text}[program]\nstart_additional = [-90, 1, 2, 3, 4]\n"));
    near(started.start_axes().unwrap()[3], -std::f64::consts::FRAC_PI_2);
}

#[test]
fn additional_axes_stand_beside_the_transform() {
    let text = without_drive();
    let turntable = TURNTABLE;
    let machine = load(&format!("{text}{turntable}"));
    assert_eq!(machine.axes.len(), 4);
    let axes = AxisVector::from_values([0.1, 0.2, 0.05, 3.0]);
    let pose = machine.kinematics.forward(&axes).unwrap();
    assert_eq!(machine.kinematics.inverse(&pose, &axes).unwrap(), axes);
    assert_eq!(machine.model.joints.last().unwrap().name, "C");
    let found = problems(&format!("{text}{turntable}{}", turntable.replace("\"C\"", "\"D\"")));
    assert!(found[0].1.contains("has the role \"P\", which another axis has already"));
}

#[test]
fn what_rs274_programs_find() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tools.tbl"), "T3 P3 Z50 D6\n").unwrap();
    let file = folder.path().join("machine.toml");
    let section = "[rs274]\nrapid_velocity_mm_per_s = 250\nacceleration_mm_per_s2 = 800\ntool_table = \"tools.tbl\"\ntool = 3\ng28_mm = [1, 2, 3]\n[rs274.work_offsets_mm]\ng55 = [10, 20, 30]\ng59_3 = [1, 1, 1]\n";
    let machine = Machine::parse(&file, &format!("{SHORT}{section}")).unwrap();
    let found = machine.conditions.rs274;
    near(found.rapid_velocity, 0.25);
    assert_eq!([found.acceleration, found.deceleration], [0.8; 2]);
    assert_eq!(found.g28.linear.map(|value| (value * 1e3).round()), [1.0, 2.0, 3.0]);
    assert_eq!(found.work_offsets[1].linear.map(|value| (value * 1e3).round()), [10.0, 20.0, 30.0]);
    near(found.work_offsets[8].linear[0], 1e-3);
    assert_eq!(found.tool, 3);
    assert!(found.tools.is_some());
    std::fs::write(folder.path().join("tools.tbl"), "T3 Z\n").unwrap();
    let found = Machine::parse(&file, &format!("{SHORT}{section}")).unwrap_err();
    assert!(found[0].message.contains("tools.tbl: line 1"), "{}", found[0].message);
    std::fs::remove_file(folder.path().join("tools.tbl")).unwrap();
    let found = Machine::parse(&file, &format!("{SHORT}{section}")).unwrap_err();
    assert!(found[0].message.contains("No such file"), "{}", found[0].message);
}

#[test]
fn tool_tables_in_toml() {
    let folder = tempfile::tempdir().unwrap();
    let machine = folder.path().join("machine.toml");
    let read = |text: &str| {
        std::fs::write(folder.path().join("tools.toml"), text).unwrap();
        // The unit is that of tables without one.
        let section = "[rs274]\nunit = \"inch\"\ntool_table = \"tools.toml\"\n";
        Machine::parse(&machine, &format!("{SHORT}{section}"))
    };
    let table = "\
[[tools]]
number = 7
pocket = 3
diameter_mm = 6
length_mm = 42.5
comment = \"end mill\"
[[tools]]
number = 2
offset_mm = [1, -2]
rotary_offset_deg = [0, 90, 0]
diameter_mm = -0.8
orientation = 2
front_angle_deg = 95
back_angle_deg = 155
";
    let found = read(table).unwrap().conditions.rs274.tools.unwrap();
    let [second, seventh] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((second.number, seventh.number), (2, 7));
    let micrometres = |length: f64| (length * 1e6).round();
    assert_eq!(seventh.offset.map(micrometres), [0.0, 0.0, 42_500.0]);
    assert_eq!(micrometres(seventh.diameter), 6000.0);
    assert_eq!(second.offset.map(micrometres), [1000.0, -2000.0, 0.0]);
    assert_eq!(micrometres(second.diameter), -800.0);
    assert_eq!(second.rotary_offset, [0.0, 90.0, 0.0]);
    assert_eq!((second.front_angle, second.back_angle, second.orientation), (95.0, 155.0, 2));

    let message = |text: &str| {
        let [problem] = &read(text).unwrap_err()[..] else { panic!("one problem of {text}") };
        problem.message.clone()
    };
    for (text, line, expected) in [
        ("", 1, "the tool table lacks [[tools]]"),
        ("[[tools]]\nlength_mm = 1\n", 1, "[[tools]] number 1 lacks `number`"),
        ("[[tools]]\nnumber = 1\ndiametre_mm = 6\n", 3, "unknown key `diametre_mm`"),
        ("[[tools]]\nnumber = 1\n\ndiameter_mm = \"6\"\n", 4, "`diameter_mm` is a string"),
        ("[[tools]]\nnumber = 1\nlength_mm = 1e5\n", 3, "`length_mm`"),
        ("[[tools]]\nnumber = 1\norientation = 10\n", 3, "10"),
        ("[[tools]]\nnumber = -1\n", 2, "-1"),
        ("[[tools]]\nnumber = 1\n[[tools]]\nnumber = 1\n", 4, "tool 1 is in the table already"),
        ("tool = 1\n[[tools]]\nnumber = 1\n", 1, "unknown key `tool`"),
    ] {
        let found = message(text);
        for part in ["tools.toml", &format!("line {line}: "), expected] {
            assert!(found.contains(part), "{found} lacks {part}");
        }
    }
    std::fs::remove_file(folder.path().join("tools.toml")).unwrap();
    let section = "[rs274]\ntool_table = \"tools.toml\"\n";
    let found = Machine::parse(&machine, &format!("{SHORT}{section}")).unwrap_err();
    assert!(found[0].message.contains("No such file"), "{}", found[0].message);
}

#[test]
fn what_m_functions_switch() {
    let machine = load(&format!(
        "{SHORT}[[m_functions]]\nm = 3\noutputs_on = [1, 2]\ntime_ms = 1500\n[[m_functions]]\nm = 5\noutputs_off = [1, 2]\n"
    ));
    let [m3, m5] = machine.m_functions.as_slice() else { panic!("two") };
    assert_eq!((m3.number, &m3.outputs_on[..], m3.time_ns), (3, &[1, 2][..], 1_500_000_000));
    assert_eq!((m5.number, &m5.outputs_off[..], m5.time_ns), (5, &[1, 2][..], 0));
}

#[test]
fn which_outputs_follow_switches_of_the_path() {
    let machine = load(&format!("{SHORT}[[switch_outputs]]\nh = 2\noutput = 4\n"));
    let [one] = machine.switch_outputs.as_slice() else { panic!("one") };
    assert_eq!((one.number, one.device, one.output), (2, 0, 4));
}

#[test]
fn which_outputs_follow_tappets() {
    let section = "axis = \"Y\"\ngroup = 1\noutput = 4";
    let machine = load(&format!("{SHORT}[[tappet_outputs]]\n{section}\n"));
    let [one] = machine.tappet_outputs.as_slice() else { panic!("one") };
    assert_eq!((one.axis.as_str(), one.group, one.device, one.output), ("Y", 1, 0, 4));
}
