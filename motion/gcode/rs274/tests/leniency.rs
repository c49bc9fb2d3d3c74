//! Tests of what shops run although LinuxCNC refuses it.

use super::*;

/// Warnings of a program that is read nevertheless, and its elements.
#[track_caller]
fn lenient(program: &str) -> (Vec<String>, Vec<PathElement>) {
    let decoded = decode(program);
    assert_eq!(decoded.errors, [], "{program}");
    (decoded.warnings.iter().map(ToString::to_string).collect(), decoded.elements)
}

/// Program, where its lines end, warning, and the errors of LinuxCNC.
#[test]
fn one_warning_of_a_kind() {
    let missing_end = "the program does not end with M2, M30 or a second %";
    let cases: [(&str, &str, &str, &[&str]); 7] = [
        (
            "G0 X1\n\n",
            "1 0 0",
            "line 2: the program ends with its file, without M2, M30 or a second % (LinuxCNC refuses it)",
            &[&format!("line 2: {missing_end}")],
        ),
        (
            "G0 X1\n%\nG0 X2",
            "1 0 0",
            "line 2: the program ends with %, but does not begin with it (LinuxCNC refuses it)",
            &["line 2: the program ends with %, and must begin with it then"],
        ),
        (
            "X1 Y2\nX3\nG1 F6 X4\nM2",
            "1 2 0 | 3 2 0 | 4 2 0",
            "line 1: coordinates before any motion word (G0, G1, ...) are read as G0 (LinuxCNC refuses it); 1 time more, last in line 2",
            &[
                "line 1: axis words without a motion: no G0, G1, G2, G3 or canned cycle is in force",
                "line 2: axis words without a motion: no G0, G1, G2, G3 or canned cycle is in force",
            ],
        ),
        (
            "G1 X1\nX2\nG2 X4 I1\nG0 X9\nM2",
            "1 0 0 | 2 0 0 | 4 0 0 | 9 0 0",
            "line 1: motion before any F is read with 100 mm/min: write F, or the sender sets another (LinuxCNC refuses it); 2 times more, last in line 3",
            &["line 1: motion without a feed: F has not been set, or not since G94"],
        ),
        (
            "F60 G2 X2 I1 K5\nG3 X0 I-1 K1\nM2",
            "2 0 0 | 0 0 0",
            "line 1: K of an arc has no effect along the normal of its plane (LinuxCNC refuses it); 1 time more, last in line 2",
            &[
                "line 1: K is not in the plane of the arc",
                "line 2: K is not in the plane of the arc",
            ],
        ),
        (
            "F60 G18 G2 X2 I1 J5\nM2",
            "2 0 0",
            "line 1: J of an arc has no effect along the normal of its plane (LinuxCNC refuses it)",
            &["line 1: J is not in the plane of the arc"],
        ),
        (
            "G0 X1\nM10 P2\nM2",
            "1 0 0 | 1 0 0",
            "line 2: M10 is read as an M function at which the path waits (LinuxCNC refuses it)",
            &["line 2: M10 is not supported"],
        ),
    ];
    for (program, path, warning, errors) in cases {
        let (warnings, elements) = lenient(program);
        assert_eq!(warnings, [warning]);
        assert_eq!(ends(&elements), path, "{program}");
        let strict = decode_strictly(program);
        let found: Vec<_> = strict.errors.iter().map(ToString::to_string).collect();
        assert_eq!(found, errors, "{program}");
        assert_eq!(strict.warnings, []);
    }
}

/// K0 has no effect, and is refused by LinuxCNC only.
#[test]
fn a_centre_of_zero_is_harmless() {
    let program = "F60 G2 X2 I1 K0\nM2";
    assert_eq!(lenient(program).0, [""; 0]);
    assert_eq!(decode_strictly(program).errors.len(), 1);
}

/// The assumed feed is that of all blocks until F, and of no other lack of a feed.
#[test]
fn assumed_feed() {
    let (warnings, elements) = lenient("G1 X1\nF60 X2\nM2");
    assert_eq!(warnings.len(), 1);
    let feeds: Vec<_> = elements.iter().map(|it| (it.feed * 6e7).round() / 1e3).collect();
    assert_eq!(feeds, [100.0, 60.0]);
    for program in ["G1 X1 F0\nM2", "F5 G93\nG94\nG1 X1\nM2", "M3 S9 G95 G1 X1\nM2"] {
        assert_eq!(decode(program).errors.len(), 1, "{program}");
    }
    // An F that could not be read is one error, and nothing else.
    let decoded = decode("G1 X1 F1.2.3\nX2\nM2");
    assert_eq!((decoded.errors.len(), decoded.warnings.len()), (1, 0));
    assert_eq!(ends(&decoded.elements), "2 0 0");
}

/// G80 says that nothing moves.
#[test]
fn coordinates_behind_g80() {
    assert_eq!(decode("G80\nX1\nM2").errors.len(), 1);
}

/// LinuxCNC reads 253 bytes, the line end included.
#[test]
fn long_lines() {
    for (length, errors) in [(252, 0), (253, 1)] {
        let program = format!("G0 X1{}\nM2", " ".repeat(length - 5));
        assert_eq!(decode(&program).errors.len(), 0);
        assert_eq!(decode_strictly(&program).errors.len(), errors);
    }
}

/// M words of other controls in one block are those of blocks of their own, in the order of the program.
#[test]
fn m_words_of_other_controls() {
    let (warnings, found) = lenient("M10 M110 M47 P2\nM47 M8\nM2");
    let numbers: Vec<_> = found.iter().map(|element| element.kind).collect();
    let expected = [10, 47, 110, 8, 47, 9].map(|number| ElementKind::MFunction { number });
    assert_eq!(numbers, expected);
    assert_eq!(found[0].m_parameters().k, Some(2.0));
    let read = "is read as an M function at which the path waits (LinuxCNC refuses it)";
    assert_eq!(
        warnings,
        [format!("line 1: M10 {read}"), format!("line 1: M47 {read}; 1 time more, last in line 2"),]
    );
    let decoded = decode("M10 M47\nM2");
    let columns: Vec<_> = decoded.warnings.iter().map(|it| it.columns.clone().unwrap()).collect();
    assert_eq!(columns, [0..3, 4..7]);
    assert_eq!(decode_strictly("M10 M47\nM2").errors.len(), 2);
    // LinuxCNC takes four M words, and one of M100 to M199.
    assert_eq!(decode("M10 M11 M12 M13 M14\nM2").errors.len(), 1);
    assert_eq!(decode("M110 M111\nM2").errors.len(), 1);
    assert_eq!(decode("M98 P1 M47\nM2").errors.len(), 1);
}
