//! Page of totals: `docs/src/coverage.md`, whose introduction is written by hand.

use super::table::{Row, State};
use crate::tree::Tree;
use std::fmt::Write;
use std::io;

const PAGE: &str = "docs/src/coverage.md";
/// Line below which the page is made from the tables.
const MADE: &str = "<!-- made from tests/coverage by tests/tidy -->";

/// The page and its text.
pub(super) fn made(tree: &Tree, rows: &[Row]) -> io::Result<(&'static str, String)> {
    let page = tree.read(PAGE)?;
    let by_hand = page.split_once(MADE).map_or(page.as_str(), |(by_hand, _)| by_hand);
    let mut text = format!("{by_hand}{MADE}\n\n## Totals\n\n{}", totals(rows));
    for (state, heading) in [(State::Partly, "Partly"), (State::LeftOut, "Left out")] {
        lists(&mut text, rows, state, heading);
    }
    Ok((PAGE, text))
}

/// Chapters in the order of the tables, and all of them.
fn totals(rows: &[Row]) -> String {
    let mut table = "| manual | chapter |".to_owned();
    for state in State::ALL {
        write!(table, " {} |", state.name()).unwrap_or_default();
    }
    table += " rows |\n|---|---|---:|---:|---:|---:|---:|\n";
    let mut line = |manual: &str, chapter: &str, of: &dyn Fn(&&Row) -> bool| {
        write!(table, "| {manual} | {chapter} |").unwrap_or_default();
        for state in State::ALL {
            let count = rows.iter().filter(of).filter(|row| row.state == state).count();
            write!(table, " {count} |").unwrap_or_default();
        }
        writeln!(table, " {} |", rows.iter().filter(of).count()).unwrap_or_default();
    };
    for first in chapters(rows) {
        let chapter = if first.chapter == first.manual { "" } else { &first.chapter };
        line(&first.manual, chapter, &|row| is_of(first, row));
    }
    line("all", "", &|_| true);
    table
}

/// The first row of each chapter.
fn chapters(rows: &[Row]) -> Vec<&Row> {
    let mut found: Vec<&Row> = Vec::new();
    for row in rows {
        if !found.iter().any(|first| is_of(first, row)) {
            found.push(row);
        }
    }
    found
}

fn is_of(first: &Row, row: &Row) -> bool {
    (&first.manual, &first.chapter) == (&row.manual, &row.chapter)
}

/// Statements in one state by chapter; those with the same note share a line.
fn lists(text: &mut String, rows: &[Row], state: State, heading: &str) {
    write!(text, "\n## {heading}\n").unwrap_or_default();
    let rows: Vec<Row> = rows.iter().filter(|row| row.state == state).cloned().collect();
    for first in chapters(&rows) {
        write!(text, "\n### {}\n\n", first.chapter).unwrap_or_default();
        let mut notes: Vec<(&str, Vec<&Row>)> = Vec::new();
        for row in rows.iter().filter(|row| is_of(first, row)) {
            match notes.iter_mut().find(|(note, _)| *note == row.note) {
                Some((_, same)) => same.push(row),
                None => notes.push((&row.note, vec![row])),
            }
        }
        for (note, same) in notes {
            let items: Vec<_> =
                same.iter().map(|row| format!("{} ({})", row.item, row.place)).collect();
            writeln!(text, "- {}: {note}.", items.join("; ")).unwrap_or_default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::{fake, read};
    use super::*;
    use crate::tree::fake::tree;

    #[test]
    fn totals_and_reasons_are_on_the_page() {
        let text = fake::table(&[
            "x,works,twin check,,a,b",
            "y,left out,,no bus,,",
            "z,left out,,no bus,,",
            "w,partly,twin check,no u,a,",
        ]);
        let page = "# Coverage\n\nBy hand.\n\n";
        let (_folder, tree) = tree(&[("tests/coverage/m.csv", &text), (PAGE, page)]);
        let (rows, _) = read(&tree).unwrap();
        let (_, made) = made(&tree, &rows).unwrap();
        assert!(made.starts_with(&format!("{page}{MADE}\n")), "{made}");
        assert!(
            made.contains("| M | C | 1 | 0 | 1 | 2 | 4 |\n| all |  | 1 | 0 | 1 | 2 | 4 |\n"),
            "{made}"
        );
        assert!(made.contains("## Partly\n\n### C\n\n- w (1): no u.\n"), "{made}");
        assert!(made.ends_with("## Left out\n\n### C\n\n- y (1); z (1): no bus.\n"), "{made}");
    }
}
