//! Tests of canned cycles, threads and spindle speeds beyond the moves of `linuxcnc.rs`: M functions, and what differs
//! from LinuxCNC.

use super::*;

/// The elements as text: kind, end in mm, and the feed in mm/min or the M function and its K.
fn listed(program: &str) -> String {
    let elements = elements(&format!("{program}\nM2"));
    let ends = ends_mm(&elements);
    let line = |(element, [x, y, z]): (&PathElement, [f64; 3])| match element.kind {
        ElementKind::Rapid => format!("rapid {x} {y} {z}"),
        ElementKind::Cut => {
            format!("cut {x} {y} {z} F{}", (element.feed * 6e7).round() / 1e3)
        }
        ElementKind::Dwell { time_ns } => format!("dwell {}", time_ns as f64 / 1e9),
        ElementKind::MFunction { number } => {
            let k = element.m_parameters().k;
            format!(
                "M{number}{}",
                k.map_or(String::new(), |k| format!(" {}", (k * 1e6).round() / 1e6))
            )
        }
        other => panic!("{other:?}"),
    };
    elements.iter().zip(ends).map(line).collect::<Vec<_>>().join(", ")
}

/// The order of stops and turns is that of the calls that `rs274 -g` prints.
#[test]
fn spindle_in_cycles() {
    for (cycle, expected) in [
        (
            "M3 S9 G84 Z-5 R2 P1",
            "M3 9, rapid 0 0 2, rapid 0 0 2, cut 0 0 -5 F60, M5, M4 9, dwell 1, cut 0 0 2 F60, M5, M3 9, M5",
        ),
        (
            "M4 S9 G74 Z-5 R2",
            "M4 9, rapid 0 0 2, rapid 0 0 2, cut 0 0 -5 F60, M5, M3 9, dwell 0, cut 0 0 2 F60, M5, M4 9, M5",
        ),
        (
            "M4 S9 G86 Z-5 R2 P1",
            "M4 9, rapid 0 0 2, rapid 0 0 2, cut 0 0 -5 F60, dwell 1, M5, rapid 0 0 2, M4 9, M5",
        ),
        (
            "M3 G87 Z-5 R2 I1 J2 K-3",
            "M3, rapid 0 0 2, rapid 0 0 2, rapid 1 2 2, M5, M19 0, rapid 1 2 -5, rapid 0 0 -5, M3, \
             cut 0 0 -3 F60, cut 0 0 -5 F60, M5, M19 0, rapid 1 2 -5, rapid 1 2 2, rapid 0 0 2, M3, M5",
        ),
        (
            "M3 S9 M8 G89 Z-5 R2 P1",
            "M3 9, M8, rapid 0 0 2, rapid 0 0 2, cut 0 0 -5 F60, dwell 1, cut 0 0 2 F60, M5, M9",
        ),
    ] {
        assert_eq!(listed(&format!("F60 {cycle}")), expected, "{cycle}");
    }
}

/// The tool leaves the hole of G88 by itself, so that the next rapid does not start at the bottom as in LinuxCNC.
#[test]
fn boring_with_a_stop() {
    assert_eq!(
        listed("F60 M3 S9 G88 Z-5 R2 P1\nX4"),
        "M3 9, rapid 0 0 2, rapid 0 0 2, cut 0 0 -5 F60, dwell 1, M5, M0, M3 9, rapid 0 0 2, \
         rapid 0 0 2, rapid 4 0 2, cut 4 0 -5 F60, dwell 1, M5, M0, M3 9, rapid 4 0 2, M5"
    );
}

/// LinuxCNC 2.9 mixes up the axes of G74 and G84 in these planes.
#[test]
fn tapping_in_other_planes() {
    assert_eq!(
        listed("G18 F60 M3 S9 G84 X1 Z2 Y-5 R2"),
        "M3 9, rapid 0 2 0, rapid 1 2 2, cut 1 -5 2 F60, M5, M4 9, dwell 0, cut 1 2 2 F60, M5, M3 9, M5"
    );
    assert_eq!(
        listed("G19 F60 M4 S9 G74 Y1 Z3 X-5 R2"),
        "M4 9, rapid 2 0 0, rapid 2 1 3, cut -5 1 3 F60, M5, M3 9, dwell 0, cut 2 1 3 F60, M5, M4 9, M5"
    );
}

#[test]
fn rigid_tapping() {
    assert_eq!(
        listed("M3 S100 G33.1 Z-5 K1.5\nG0 X1"),
        "M3 100, cut 0 0 -5 F150, M4 100, cut 0 0 0 F150, M3 100, rapid 1 0 0, M5"
    );
    // I is the factor of the speed on the way back, 1 at least.
    assert_eq!(
        listed("M4 S100 G33.1 Z-5 K1 I2.5\nZ-4 K1 I.5"),
        "M4 100, cut 0 0 -5 F100, M3 250, cut 0 0 0 F250, M4 100, cut 0 0 -4 F100, M3 100, cut 0 0 0 F100, M4 100, M5"
    );
}

#[test]
fn oriented_spindle() {
    let found = elements("M3 S5\nM19 R90 P2 Q1\nM19\nM2");
    let parameters: Vec<_> =
        found.iter().map(|e| (e.m_parameters().k, e.m_parameters().l)).collect();
    let m19 = |k, l| (Some(k), l);
    assert_eq!(parameters, [m19(5.0, None), m19(90.0, Some(2.0)), m19(0.0, None)]);
    assert_eq!(kinds(&found)[1..], [ElementKind::MFunction { number: 19 }; 2]);
}

/// G96: S in m/min at the radius X, at most D revolutions per minute; a cut takes the lower speed of its ends.
#[test]
fn surface_speed() {
    // 31.4159 m/min at a radius of 10 mm are 500 revolutions per minute.
    let turning = "G95 F.1 G96 S31.41592653589793";
    for (program, expected) in [
        ("G0 X10\n# G1 Z-1", "rapid 10 0 0, cut 10 0 -1 F50"),
        ("G0 X10\n# G1 X20", "rapid 10 0 0, cut 20 0 0 F25"),
        ("G0 X-20\n# G1 X-10", "rapid -20 0 0, cut -10 0 0 F25"),
        ("G0 X20\n# D400 G1 X0", "rapid 20 0 0, cut 0 0 0 F25"),
        ("G0 Z1\n# D400 G1 Z0", "rapid 0 0 1, cut 0 0 0 F40"),
        ("G7 G0 X40\n# G1 Z1", "rapid 20 0 0, cut 20 0 1 F25"),
        ("G0 X10\n# M3\nM5", "rapid 10 0 0, M3 500, M5"),
        ("# M3\nM5", "M3, M5"),
        ("G0 X20\n#\nG97 S300 G1 X10", "rapid 20 0 0, cut 10 0 0 F30"),
        (
            "G20 G0 X1\nG95 F.1 G96 S3.14159265358979312\nG1 Z1",
            "rapid 25.4 0 0, cut 25.4 0 25.4 F15.24",
        ),
    ] {
        assert_eq!(listed(&program.replace('#', turning)), expected, "{program}");
    }
    let decoded = decode(&format!("{turning}\nG1 Z-1\nM2"));
    assert_eq!(
        decoded.errors[0].to_string(),
        "line 2: feed per revolution at X0, where G96 has no highest speed; program it with D in the block of G96"
    );
}

/// The path goes on where an erroneous thread was to lead.
#[test]
fn threads_with_errors() {
    let decoded = decode("G33 Z-5 K1\nG0 X1\nG33.1 Z-9 K1\nG0 X2\nM2");
    assert_eq!(decoded.errors.len(), 2);
    assert_eq!(ends(&decoded.elements), "1 0 -5 | 2 0 -5");
}
