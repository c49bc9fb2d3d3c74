//! Words of a block to underline for a finding that has no columns of its own.
//!
//! The check sees set-points, not words.

use crate::finding::{Finding, Rule};
use std::ops::Range;

/// Byte ranges to underline in a line of a job, without its comment.
pub(super) fn key(line: &str, finding: &Finding) -> Vec<Range<usize>> {
    if finding.columns.is_some() {
        return words(line, finding);
    }
    let said = line.split('#').next().unwrap_or_default();
    let start = said.len() - said.trim_start().len();
    std::iter::once(start..said.trim_end().len().max(start)).collect()
}

/// Byte ranges of `line` to underline; the whole block if no word stands out.
pub(super) fn words(line: &str, finding: &Finding) -> Vec<Range<usize>> {
    if let Some(columns) = &finding.columns {
        let end = columns.end.min(line.len());
        return std::iter::once(columns.start.min(end)..end).collect();
    }
    let all = block_words(line);
    let of = |letters: &[char]| -> Vec<_> {
        all.iter()
            .filter(|(letter, _)| letters.contains(letter))
            .map(|(_, range)| range.clone())
            .collect()
    };
    // An axis that is a coordinate itself has a word of its own.
    let own: Vec<_> =
        finding.axis.as_deref().and_then(|axis| axis.chars().next()).into_iter().collect();
    let coordinates = ['X', 'Y', 'Z', 'I', 'J', 'R'];
    let candidates = match finding.rule {
        Rule::AxisVelocity | Rule::AxisAcceleration | Rule::AxisJerk | Rule::FollowingError => {
            [of(&['F', 'E']), of(&own), of(&coordinates)]
        }
        Rule::AxisPosition => [of(&own), of(&coordinates), Vec::new()],
        // The block as a whole.
        Rule::Syntax | Rule::UnsupportedWord | Rule::Control => [const { Vec::new() }; 3],
        _ => [of(&coordinates), Vec::new(), Vec::new()],
    };
    let found = candidates.into_iter().find(|words| !words.is_empty());
    found.unwrap_or_else(|| {
        let text = line.trim_end();
        std::iter::once(text.len() - text.trim_start().len()..text.len()).collect()
    })
}

/// Letters and places of the words outside comments.
fn block_words(line: &str) -> Vec<(char, Range<usize>)> {
    let mut words: Vec<(char, Range<usize>)> = Vec::new();
    let mut comment = false;
    for (index, character) in line.char_indices() {
        match character {
            ';' if !comment => break,
            '(' => comment = true,
            ')' => comment = false,
            _ if comment || character.is_whitespace() => {}
            letter if letter.is_ascii_alphabetic() => {
                words.push((letter.to_ascii_uppercase(), index..index + 1));
            }
            other => {
                if let Some((_, range)) = words.last_mut() {
                    range.end = index + other.len_utf8();
                }
            }
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::words;
    use crate::finding::{Finding, Rule};
    use twin_path::Place;

    fn underlined<'l>(line: &'l str, rule: Rule, axis: Option<&str>) -> Vec<&'l str> {
        let mut finding = Finding::error(rule, Place::default(), String::new());
        finding.axis = axis.map(str::to_owned);
        words(line, &finding).into_iter().map(|range| &line[range]).collect()
    }

    #[test]
    fn the_words_that_make_the_difference() {
        let line = "N30 (X) g1 x440 Y-1.5 Z2 F60";
        assert_eq!(underlined(line, Rule::Reach, None), ["x440", "Y-1.5", "Z2"]);
        assert_eq!(underlined(line, Rule::AxisPosition, Some("Z")), ["Z2"]);
        assert_eq!(underlined(line, Rule::AxisPosition, Some("B")), ["x440", "Y-1.5", "Z2"]);
        assert_eq!(underlined(line, Rule::AxisVelocity, Some("Z")), ["F60"]);
        assert_eq!(underlined("N1 Z5", Rule::AxisVelocity, Some("Z")), ["Z5"]);
        assert_eq!(underlined(" (only words) ", Rule::Reach, None), ["(only words)"]);
        assert_eq!(underlined("", Rule::Reach, None), [""]);
    }

    #[test]
    fn columns_that_are_known_win() {
        let mut finding = Finding::error(Rule::Syntax, Place::default(), String::new());
        finding.columns = Some(2..90);
        assert_eq!(words("N1 X", &finding), vec![2..4]);
    }
}
