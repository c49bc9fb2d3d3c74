//! Fuzz tests: malformed machine files cause no panic.

use super::{GANTRY3, SCARA2, parse};
use crate::section::MachineFileError;
use proptest::prelude::*;

/// Whatever comes of `text`, it comes without a panic, and can be shown.
fn survives(text: &str) {
    if let Err(problems) = parse(text) {
        let error = MachineFileError::Content {
            what: "machine file",
            path: "machine.toml".into(),
            text: text.to_owned(),
            problems,
        };
        for report in error.reports() {
            assert!(!format!("{report:?}").is_empty());
        }
    }
}

/// Pieces that make more of a file's grammar than letters do.
const PIECES: [&str; 24] = [
    "[[axes]]\n",
    "[axes.physics]\n",
    "[kinematics]\n",
    "kind = \"scara2\"\n",
    "kind = 3\n",
    "= ",
    "nan",
    "-inf",
    "\"",
    "[",
    "]",
    "{",
    "}",
    "\n",
    "1e999",
    "0x",
    ".",
    "ä",
    "\u{0}",
    "name = \"X\"\n",
    "increments = -1\n",
    "99999999999999999999",
    "#",
    "drive = \"board\"\n",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_survived(text in any::<String>()) {
        survives(&text);
    }

    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        survives(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn shipped_files_with_pieces_moved_are_survived(
        gantry in any::<bool>(),
        changes in proptest::collection::vec((0.0..1.0f64, 0usize..80, 0..PIECES.len()), 1..6),
    ) {
        let mut text: Vec<char> = if gantry { GANTRY3 } else { SCARA2 }.chars().collect();
        for (place, length, piece) in changes {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss,
                reason = "a place in the text")]
            let start = (place * text.len() as f64) as usize;
            let end = (start + length).min(text.len());
            text.splice(start..end, PIECES[piece].chars());
        }
        survives(&text.into_iter().collect::<String>());
    }

    #[test]
    fn shipped_files_with_other_numbers_are_survived(
        gantry in any::<bool>(),
        which in 0usize..60,
        number in prop_oneof![any::<f64>().prop_map(|number| format!("{number:e}")), any::<i64>().prop_map(|number| number.to_string())],
    ) {
        // Every number of the files follows "= " or is in brackets.
        let text = if gantry { GANTRY3 } else { SCARA2 };
        let starts: Vec<_> = text.match_indices("= ").map(|(at, _)| at + 2)
            .filter(|at| text[*at..].starts_with(|c: char| c == '-' || c.is_ascii_digit())).collect();
        let start = starts[which % starts.len()];
        let end = start + text[start..].find([' ', '\n']).unwrap();
        survives(&format!("{}{number}{}", &text[..start], &text[end..]));
    }
}
