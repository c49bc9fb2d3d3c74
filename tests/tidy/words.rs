//! Plain English: the constructions that made readers stop may become fewer, never more.
//!
//! Each has the number of places that are left of it in code, messages and documents. Whoever mends some lowers the
//! number; a new line that needs one more says the same in the words of the field.

use crate::tree::{Offence, Tree};
use std::io;

/// A construction, what to write instead, and how often it is left.
const LEFT: [(&str, &str, usize); 10] = [
    ("told", "\"reported\" or \"said by\"", 286),
    ("tells", "\"reports\" or \"says\"", 22),
    ("reckoned", "\"computed\"", 1),
    ("so many", "the number", 38),
    ("is no", "\"is not\"", 207),
    ("are no", "\"are not\"", 33),
    ("what is in the way", "\"obstacles\"", 3),
    ("of a run that", "\"when a run …\"", 2),
    ("held against", "\"compared with\"", 1),
    ("beside", "\"next to\", or the relation that is meant", 197),
];

/// Questions that a heading leaves open.
const QUESTIONS: [&str; 9] =
    ["What", "How", "Where", "When", "Who", "Whom", "Whether", "Which", "Why"];

/// Files that hold words for people: this one quotes what it forbids.
fn pages(tree: &Tree) -> impl Iterator<Item = &str> {
    let endings = ["rs", "md", "toml"];
    let files = endings.into_iter().flat_map(|ending| tree.with_extension(ending));
    let tables = tree.with_extension("csv").filter(|file| file.starts_with("tests/coverage/"));
    files.chain(tables).filter(|file| *file != "tests/tidy/words.rs")
}

/// Constructions of which there are more than are left.
fn check(tree: &Tree, left: &[(&str, &str, usize)]) -> io::Result<Vec<Offence>> {
    let mut counts = vec![(0, None); left.len()];
    for file in pages(tree) {
        for (index, line) in tree.read(file)?.lines().enumerate() {
            let line = line.to_lowercase();
            for ((count, last), (words, ..)) in counts.iter_mut().zip(left) {
                let found = occurrences(&line, words);
                if found > 0 {
                    *count += found;
                    *last = Some((file, index + 1));
                }
            }
        }
    }
    let more = left.iter().zip(counts).filter(|((.., left), (count, _))| count > left);
    let offences = more.map(|((words, instead, left), (count, last))| {
        let (file, line) = last.unwrap_or_default();
        let what =
            format!("\"{words}\" stands in {count} places, {left} are left: write {instead}");
        Offence::new(file, line, what)
    });
    Ok(offences.collect())
}

/// How often whole words stand in a line.
fn occurrences(line: &str, words: &str) -> usize {
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(words)
        .filter(|(at, _)| {
            let (before, behind) = (&line[..*at], &line[at + words.len()..]);
            !before.ends_with(is_letter) && !behind.starts_with(is_letter)
        })
        .count()
}

/// Files whose first line is a question.
fn questions(tree: &Tree) -> io::Result<Vec<Offence>> {
    let mut offences = Vec::new();
    for file in tree.with_extension("rs") {
        let text = tree.read(file)?;
        let heading = text.lines().next().and_then(|line| line.strip_prefix("//! "));
        let first = heading.and_then(|line| line.split_whitespace().next());
        if first.is_some_and(|word| QUESTIONS.contains(&word)) {
            let what = "the heading is a question: name what the file is or does";
            offences.push(Offence::new(file, 1, what));
        }
    }
    Ok(offences)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{assert_none, fake};

    #[test]
    fn worst_constructions_become_fewer() -> io::Result<()> {
        assert_none(&check(&Tree::workspace()?, &LEFT)?);
        Ok(())
    }

    #[test]
    fn headings_are_no_questions() -> io::Result<()> {
        assert_none(&questions(&Tree::workspace()?)?);
        Ok(())
    }

    #[test]
    fn one_more_than_is_left_is_found() {
        let (_folder, tree) = fake::tree(&[
            ("a.rs", "// It is told.\n// Untold.\n"),
            ("b.md", "Told twice, told.\n"),
        ]);
        let found = |left| check(&tree, &[("told", "reports", left)]).unwrap();
        assert_eq!(found(3), []);
        let what = "\"told\" stands in 3 places, 2 are left: write reports";
        assert_eq!(found(2), [Offence::new("b.md", 1, what)]);
    }

    #[test]
    fn questions_are_found_in_headings_only() {
        let (_folder, tree) = fake::tree(&[
            ("a.rs", "//! What is left.\n"),
            ("b.rs", "//! Modal state.\n//! What it is.\n"),
        ]);
        let what = "the heading is a question: name what the file is or does";
        assert_eq!(questions(&tree).unwrap(), [Offence::new("a.rs", 1, what)]);
    }
}
