//! Markdown reader: the small part of the language that the checked pages use.

/// A line of a page.
#[derive(Debug)]
pub(crate) struct Line<'a> {
    /// Counted from 1.
    pub(crate) number: usize,
    pub(crate) text: &'a str,
    /// The last heading of level two before it.
    pub(crate) section: &'a str,
}

/// The lines of a page outside code blocks.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let (mut in_code, mut section) = (false, "");
    text.lines().enumerate().filter_map(move |(index, text)| {
        if text.trim_start().starts_with("```") {
            in_code = !in_code;
            return None;
        }
        if let Some(heading) = text.strip_prefix("## ") {
            section = heading.trim();
        }
        (!in_code).then_some(Line { number: index + 1, text, section })
    })
}

/// Text between backticks.
pub(crate) fn code_spans(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// The cells of a table row, `None` if the line is no row.
pub(crate) fn cells(text: &str) -> Option<Vec<&str>> {
    let inner = text.trim().strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(str::trim).collect())
}

/// True if a row only separates the head of a table from its body.
pub(crate) fn is_rule(cells: &[&str]) -> bool {
    cells.iter().all(|cell| !cell.is_empty() && cell.chars().all(|c| c == '-' || c == ':'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_blocks_are_skipped_and_sections_known() {
        let page = "intro `a`\n## One\n```text\n`not/this`\n```\n`b/c` and `d`\n";
        let seen: Vec<_> = lines(page)
            .map(|line| (line.number, line.section, code_spans(line.text).count()))
            .collect();
        assert_eq!(seen, [(1, "", 1), (2, "One", 0), (6, "One", 2)]);
    }

    #[test]
    fn rows_are_cut_into_cells() {
        assert_eq!(cells("| a | b c || d |"), Some(vec!["a", "b c", "", "d"]));
        assert_eq!(cells("a | b"), None);
        assert!(is_rule(&cells("|---|:--|").unwrap()));
        assert!(!is_rule(&cells("| - | x |").unwrap()));
    }
}
