//! Robustness tests of the decoder: random bytes and random programs.

use super::*;
use crate::decode::{Rule, TextError};
use crate::rs274::{DecodeError, MAX_CYCLE_MOVES, Tool, ToolReference, ToolTable};
use proptest::prelude::*;
use std::io::BufReader;
use twin_path::Shape;

/// Everything a program gives, in order, read in pieces of `capacity` bytes.
fn run(program: &[u8], capacity: usize, options: &DecoderOptions) -> Vec<Result<Item, Diagnostic>> {
    let reader = BufReader::with_capacity(capacity, program);
    let items = Decoder::new(reader, options.clone()).map(|item| {
        item.map_err(|failure| match failure {
            Failure::Diagnostic(diagnostic) => diagnostic,
            Failure::Io(error) => panic!("reading from memory: {error}"),
        })
    });
    items.collect()
}

/// Random text that resembles a program more often than random bytes do.
pub(super) fn scraps() -> impl Strategy<Value = Vec<u8>> {
    let scrap = prop_oneof![
        4 => "[NGXYZABCIJKRFMTSHPQLOUVWEDngxyzijkrf$/%();\\[\\]#= \t.,+-]{0,3}",
        6 => "[NGXYZABCUVWIJKRFMTSHPQLO$]-?[0-9]{0,4}\\.?[0-9]{0,3} ?",
        3 => "G(0|1|2|3|4|5|5\\.[123]|17|18|19|1[789]\\.1|2[018]|30|38\\.[2-5]|4[0-39]|4[12]\\.1|5[3-9]|59\\.[123]|61|61\\.1|64|7|8|33|33\\.1|7[346]|8[0-9]|9[0-7]|9[01]\\.1|92\\.[123]|98|99) ",
        1 => "G(81|82|83) X1 Z-[0-9]{1,9} R[0-9] Q\\.?[0-9] P[0-9] L[0-9]{1,6} ",
        2 => "(M3 S90 G8[4-8]|M4 S.5 G74|M3 S9 G7 G76|S[0-9] G33(.1)?) Z-[0-9]{1,6} [PQ][0-9] I-?[0-9] J[0-9] K[0-9] R[0-9] H[0-9]{1,6} E[0-9] L[0-9] ",
        1 => "(G95 F.1|G96 D9?) S[0-9]{1,4} ",
        1 => "M(0|1|2|[3-9]|19|30|4[89]|5[0-3]|6[0-8]|7[0-3]|1[0-9]{2}) ",
        1 => "G5\\.2 P[0-9] L[0-9]\nX[0-9] Y1 P\\.[0-9]\nX-9 Y[0-9] P[1-9]{1,3}\nG5\\.3 ",
        3 => "\r?\n",
        1 => "\\PC{0,4}",
    ];
    let bytes = prop_oneof![
        8 => scrap.prop_map(String::into_bytes),
        1 => prop::collection::vec(any::<u8>(), 0..4),
        1 => (1..400_usize, "[0-9.A-Z ]").prop_map(|(count, text)| text.repeat(count).into_bytes()),
    ];
    prop::collection::vec(bytes, 0..60).prop_map(|scraps| scraps.concat())
}

fn options() -> impl Strategy<Value = DecoderOptions> {
    let position = || {
        ([-1.0..1.0, -1.0..1.0, -1.0..1.0_f64], any::<bool>()).prop_map(|(linear, turned)| {
            let rotary = [if turned { 30.0 } else { 0.0 }, 0.0, 0.0];
            Position { linear, rotary, parallel: linear }
        })
    };
    (position(), position(), position(), any::<[bool; 4]>()).prop_map(
        |(start, offset, home, [skip, tip, keep, floor])| {
            let mut options = DecoderOptions {
                start,
                g28: home,
                g30: offset,
                skip_suppressed_blocks: skip,
                keep_empty_moves: keep,
                tools: Some(ToolTable::new((0..50).map(|number| Tool {
                    number,
                    offset: [0.0, 1e-3, 1e-3 * f64::from(number)],
                    diameter: 1e-4 * f64::from(number),
                    ..Tool::default()
                }))),
                ..DecoderOptions::default()
            };
            if tip {
                options.reference = ToolReference::Tip;
            }
            options.work_offsets[1] = offset;
            if floor {
                options.surroundings = super::probe::above(-1.0).surroundings;
            }
            options
        },
    )
}

/// A coordinate with up to three decimals.
fn number() -> impl Strategy<Value = String> {
    (-200_000..200_000_i32, 0..4_usize)
        .prop_map(|(thousandths, decimals)| format!("{:.decimals$}", f64::from(thousandths) / 1e3))
}

fn words(letters: &'static str) -> impl Strategy<Value = String> {
    prop::sample::subsequence(letters.chars().collect::<Vec<_>>(), 1..=letters.len())
        .prop_flat_map(|letters| {
            letters
                .into_iter()
                .map(|letter| number().prop_map(move |number| format!("{letter}{number} ")))
                .collect::<Vec<_>>()
        })
        .prop_map(|words| words.concat())
}

/// One block of a program; arcs and cycles of it may be impossible.
fn block() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => (prop::sample::select(vec!["G0", "G1", "g01", "", "G53 G0", "G38.2", "g38.3", "G38.4", "G 38.5"]), words("XYZ"))
            .prop_map(|(command, words)| format!("{command}{words}")),
        1 => words("XYZABCVW").prop_map(|words| format!("G1{words}")),
        2 => (2..4, words("XYZ"), 1..400_000).prop_map(|(g, words, r)| format!(
            "G{g} {words} R{}", f64::from(r) / 1e3
        )),
        2 => (2..4, words("IJ"), 1..5).prop_map(|(g, words, p)| format!("G17 G{g} {words} P{p} Z1")),
        2 => (0..7_usize, words("XY"), 1..50, 1..9, 1..4).prop_map(|(cycle, words, depth, r, l)| {
            let cycle = ["G81", "G82 P.1", "G83 Q.7", "G73 Q.9", "G85", "M3 G87 I1 J.1 K-1", "G89 P.1"][cycle];
            format!("G90 G17 G94 F100 {cycle} {words} Z-{depth} R{r} L{l}")
        }),
        2 => (words("XY"), number(), number(), number(), any::<bool>()).prop_map(|(end, i, j, p, cubic)| {
            let (word, last) = if cubic { ("G5", format!("P{p} Q-1")) } else { ("G5.1", String::new()) };
            format!("G40 G0 Z1\nG17 {word} {end} I{i} J{j} {last}")
        }),
        1 => (number(), number(), 1..900, 1..6).prop_map(|(x, y, p, l)| format!(
            "G40 G0 Z1\nG90 G5.2 L{l}\nX{x} Y{y} P.{p}\nX{y} Y5 P{p}\nX{y} Y{x} P1\nX9 Y9 P2\nG5.3"
        )),
        1 => (words("XYZ"), 0..3_usize).prop_map(|(words, g)| {
            let word = ["G28", "G30", "G92"][g];
            format!("G80 {word} {words}")
        }),
        1 => (0..50).prop_map(|tool| format!("G43 H{tool}")),
        3 => prop::sample::select(vec![
            "G17", "G18", "G19", "G20", "G21", "G90", "G91", "G90.1", "G91.1", "G94 F100", "G95 S90 F.7",
            "G54", "G55", "G59.3", "G49", "G40", "G41", "G42 D9", "G41.1 D2", "G61", "G64 P.1", "G92.1", "G92.2", "G92.3", "G98",
            "G10 L2 P0 X1 R30", "G10 L20 P2 Y5", "G10 L2 P0 R0", "G10 L1 P3 Z7", "G10 L11 P3 X1 Y2",
            "G28.1", "G30.1", "G43.1 Z5 A3 W2", "G10 L2 P2 V5", "M4 S9 $-1", "G43.2 H3", "M61 Q2", "G80 G52 X3", "#5221=2 #5250=9",
            "G99", "G4 P.25", "M3 S100", "M6 T3", "M8", "M0", "M70", "M72", "M73", "M62 P1", "M66 P1", "M101", "G61.1", "(text)", "; text", "", "F7.5",
        ]).prop_map(str::to_owned),
    ]
}

pub(super) fn programs() -> impl Strategy<Value = Vec<String>> {
    prop::collection::vec(block(), 0..40).prop_map(|mut lines| {
        lines.insert(0, "F20".to_owned());
        lines
    })
}

proptest! {
    #[test]
    fn any_bytes_end(program in prop::collection::vec(any::<u8>(), 0..300)) {
        run(&program, 64, &DecoderOptions::default());
    }

    /// Nothing panics, a line gives no more than a cycle may have and its errors, and how the bytes arrive does not
    /// matter.
    #[test]
    fn any_scraps_end(program in scraps(), capacity in 1..40_usize, options in options()) {
        let items = run(&program, 8192, &options);
        let lines = program.split(|byte| *byte == b'\n').count();
        prop_assert!(items.len() <= lines * (MAX_CYCLE_MOVES + 10) + program.len());
        prop_assert_eq!(&run(&program, capacity, &options), &items);
    }

    /// Whatever the bytes, elements join and are finite, errors have sentences and point at bytes of their lines.
    #[test]
    fn scraps_join(program in scraps(), options in options()) {
        let decoded = decode_with(options, &program);
        let lines: Vec<_> = program.split(|byte| *byte == b'\n').collect();
        for diagnostic in decoded.errors.iter().chain(&decoded.warnings) {
            let line = lines[diagnostic.place.line as usize - 1];
            let columns = diagnostic.columns.clone().unwrap_or(0..1);
            prop_assert!(columns.start < columns.end, "{diagnostic:?}");
            prop_assert!(diagnostic.columns.is_none() || columns.end <= line.len(), "{diagnostic:?}");
            prop_assert!(!diagnostic.error.to_string().is_empty());
        }
        let mut end = None;
        for element in &decoded.elements {
            prop_assert_eq!(element.start(), end.unwrap_or(element.start()));
            prop_assert!(element.length().is_finite() && element.feed.is_finite());
            end = Some(element.end());
        }
    }

    /// Elements follow one another bit for bit, in the order of lines; along each the path goes from start to end
    /// without a step.
    #[test]
    fn elements_join(lines in programs(), options in options()) {
        let reference = options.reference;
        let start = options.start.linear;
        let decoded = decode_with(options, lines.join("\n").as_bytes());
        let (mut end, mut line, mut extra) = (None, 0, None);
        for element in &decoded.elements {
            let first = reference == ToolReference::ControlPoint && decoded.errors.is_empty();
            let from = end.unwrap_or(if first { start.into() } else { element.start() });
            prop_assert_eq!(element.start(), from);
            let length = element.shape.length();
            prop_assert!((element.shape.at(0.0).position - element.start()).norm() <= 1e-9);
            prop_assert!((element.shape.at(length).position - element.end()).norm() <= 1e-9);
            // Just before its end the path is just before its end: no step but for the rounding of arcs' radii.
            let near = element.shape.at(length * (1.0 - 1e-12)).position;
            let slack = if matches!(element.shape, Shape::Arc(_)) { 1e-9 } else { 1e-12 };
            prop_assert!((near - element.end()).norm() <= slack + 1e-12 * length, "{element:?}");
            if let (Some(before), Some(now)) = (extra, element.extra()) {
                prop_assert_eq!(before, now.start);
            }
            prop_assert!(element.place.line >= line);
            prop_assert!(!element.kind.is_motion() || element.feed > 0.0);
            (end, line) = (Some(element.end()), element.place.line);
            extra = element.extra().map(|extra| extra.end);
        }
    }

    /// The blocks of these programs are right but for impossible arcs, cycles and sums of relative targets.
    #[test]
    fn errors_are_few(lines in programs()) {
        let tools = (0..50).map(|number| Tool { number, ..Tool::default() });
        let options = DecoderOptions { tools: Some(ToolTable::new(tools)), ..DecoderOptions::default() };
        let decoded = decode_with(options, lines.join("\n").as_bytes());
        for error in &decoded.errors {
            let geometry = [Rule::ArcGeometry, Rule::CompensationGouge].contains(&error.error.rule());
            let other = matches!(
                error.error,
                DecodeError::OutOfRange { .. }
                    | DecodeError::MachineFrameIncremental
                    | DecodeError::RetractBelowBottom { .. }
                    | DecodeError::EndlessCycle(_)
                    | DecodeError::MissingWord { .. }
                    | DecodeError::AxesWithoutMotion
                    | DecodeError::MissingFeed
                    | DecodeError::NoSavedModes
                    | DecodeError::ProbeNowhere(_)
                    | DecodeError::Compensated(_)
                    | DecodeError::CompensationTwice(_)
                    | DecodeError::CompensationPlane(_)
                    | DecodeError::CompensationEntry { .. }
                    | DecodeError::ArcAfterCompensation
                    | DecodeError::ProbePerRevolution
                    | DecodeError::SpindleDirection { .. }
            );
            prop_assert!(geometry || other, "{error}\n{}", lines.join("\n"));
        }
    }

    #[test]
    fn line_ends_do_not_matter(lines in programs(), options in options()) {
        let decode = |text: String| {
            let decoded = decode_with(options.clone(), text.as_bytes());
            (decoded.elements, decoded.errors)
        };
        let unix = decode(lines.join("\n"));
        prop_assert_eq!(&decode(lines.join("\r\n")), &unix);
        prop_assert_eq!(&decode(lines.join("\n") + "\n"), &unix);
    }

    /// Neither the order of words, nor blanks between them or case, nor N words change the path.
    #[test]
    fn order_of_words_does_not_matter(words in Just(vec!["G1", "X1.5", "Y-2", "Z3", "F10", "S100", "M3", "G91", "T3", "M8"]).prop_shuffle(), blank in "[ \t]{0,2}", lower: bool) {
        let expected = elements("G1 X1.5 Y-2 Z3 F10 S100 M3 G91 T3 M8\nM2");
        let mut line = words.join(&blank);
        if lower {
            line = line.to_lowercase();
        }
        prop_assert_eq!(elements(&format!("{line}\nM2")), expected);
    }
}

/// Lines without end are left out as they come; memory does not grow with the program.
#[test]
fn memory_is_bounded() {
    for piece in [
        &b"X"[..],
        b"9",
        b"(",
        b"X1 ",
        b"#",
        b"\n",
        b"G13 ",
        b"G1 X1 F1 L9\n",
        b"G0 X1\nX2\n",
        b"G91 G81 X.001 Z-1 R1 L2000 F1\n",
    ] {
        let program = piece.repeat((1_usize << 20).div_ceil(piece.len()));
        let reader = BufReader::new(&program[..]);
        let mut decoder = Decoder::new(reader, DecoderOptions::default());
        let mut most = 0;
        while decoder.next().is_some() {
            most = most.max(decoder.capacity());
        }
        // A line, and what a line gives: an error a word, or the moves of a cycle.
        assert!(most <= 1 << 18, "{:?}: {most}", String::from_utf8_lossy(piece));
    }
}
