//! Tests of unsupported words: each is reported with line and word; nothing is skipped silently.

use super::decode_strictly as decode;
use crate::decode::{Rule, TextError};

/// G words of the subset in tenths.
const G: [u16; 81] = [
    0, 10, 20, 30, 40, 50, 51, 52, 53, 70, 80, 100, 170, 171, 180, 181, 190, 191, 200, 210, 280,
    281, 300, 301, 330, 331, 382, 383, 384, 385, 400, 410, 411, 420, 421, 430, 431, 432, 490, 520,
    530, 540, 550, 560, 570, 580, 590, 591, 592, 593, 610, 611, 640, 730, 740, 760, 800, 810, 820,
    830, 840, 850, 860, 870, 880, 890, 900, 901, 910, 911, 920, 921, 922, 923, 930, 940, 950, 960,
    970, 980, 990,
];
const M: [u16; 31] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 19, 30, 48, 49, 50, 51, 52, 53, 60, 61, 62, 63, 64, 65, 66, 67,
    68, 70, 71, 72, 73,
];
const LETTERS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";

/// Asserts that the second line has this error alone or first, and that nothing is executed of it.
#[track_caller]
fn assert_unsupported(block: &str, pointed: &str, message: &str) {
    let decoded = decode(&format!("G0 X1\nN20 {block}\nM2"));
    let [error, ..] = &decoded.errors[..] else { panic!("{block:?} is taken for something") };
    assert_eq!(error.error.rule(), Rule::UnsupportedWord, "{block:?}: {error}");
    assert_eq!(error.to_string(), format!("line 2 (N20): {message}"), "{block:?}");
    let line = format!("N20 {block}");
    assert_eq!(&line[error.columns.clone().unwrap()], pointed, "{block:?}");
    assert_eq!(decoded.elements.len(), 1, "{block:?}");
}

#[test]
fn every_g_word() {
    for tenths in 0..=1010_u16 {
        if G.contains(&tenths) {
            let decoded = decode(&format!("G{}.{}", tenths / 10, tenths % 10));
            let refused = decoded.errors.iter().any(|e| e.error.rule() == Rule::UnsupportedWord);
            assert!(!refused, "{tenths}: {:?}", decoded.errors);
            continue;
        }
        let number = f64::from(tenths) / 10.0;
        let word = format!("G{number}");
        assert_unsupported(&format!("X2 {word} Y3"), &word, &format!("{word} is not supported"));
    }
    for number in ["G-1", "G0.05", "G61.15", "G1000", "G99999999999999999999"] {
        let decoded = decode(&format!("X1\n{number}\nM2"));
        let error = &decoded.errors[1];
        assert_eq!((error.place.line, error.error.rule()), (2, Rule::UnsupportedWord), "{number}");
    }
}

#[test]
fn every_m_word() {
    for number in 0..=1000_u16 {
        let word = format!("M{number}");
        if matches!(number, 98 | 99) {
            // Subroutines: `linuxcnc.txt`.
        } else if M.contains(&number) || matches!(number, 100..=199) {
            let block = match number {
                61 => "M61 Q1".to_owned(),
                62..=66 => format!("{word} P1"),
                67 | 68 => format!("{word} E1 Q1"),
                72 => "M70\nM72".to_owned(),
                _ => word.clone(),
            };
            assert_eq!(decode(&format!("{block}\nM2")).errors, [], "{word}");
        } else {
            assert_unsupported(&format!("{word} X2"), &word, &format!("{word} is not supported"));
        }
    }
    for word in ["M-1", "M3.5"] {
        assert_unsupported(word, word, &format!("{word} is not supported"));
    }
}

#[test]
fn every_letter() {
    for letter in ('A'..='Z').filter(|letter| !LETTERS.contains(*letter)) {
        for letter in [letter, letter.to_ascii_lowercase()] {
            let word = format!("{letter}1.5");
            let upper = letter.to_ascii_uppercase();
            let message = format!("{upper} words are not supported");
            assert_unsupported(&format!("X2 {word}"), &word, &message);
        }
    }
    for letter in LETTERS.chars() {
        let decoded = decode(&format!("{letter}1"));
        assert!(decoded.errors.iter().all(|error| error.error.rule() != Rule::UnsupportedWord));
    }
}
