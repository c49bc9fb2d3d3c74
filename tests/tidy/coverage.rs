//! Check of `docs/coverage.md`: modules and tests exist, states are one of four, totals are right.

use crate::markdown;
use crate::tree::{Offence, Tree, join};
use std::io;

const PAGE: &str = "docs/coverage.md";
const HEAD: [&str; 5] = ["item", "manual", "module", "test", "state"];
const TOTALS: &str = "| manual | works | partly | not yet | left out | rows |";

/// State of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Works,
    Partly,
    NotYet,
    LeftOut,
}

/// One row of one of the page's tables.
#[derive(Debug)]
struct Row<'a> {
    line: usize,
    /// The manual it belongs to.
    section: &'a str,
    module: &'a str,
    test: &'a str,
    state: &'a str,
}

/// Everything on the page that is not so.
fn check(tree: &Tree) -> io::Result<Vec<Offence>> {
    let page = tree.read(PAGE)?;
    let (rows, mut offences) = rows(&page);
    for row in &rows {
        let mut wrong = |what: String| offences.push(Offence::new(PAGE, row.line, what));
        for path in markdown::code_spans(row.module).filter(|path| !tree.exists(path)) {
            wrong(format!("module `{path}` does not exist"));
        }
        for span in markdown::code_spans(row.test) {
            for what in missing_tests(tree, span)? {
                wrong(what);
            }
        }
        for (cell, name) in [(row.module, "module"), (row.test, "test")] {
            if !is_list_of_spans(cell) {
                wrong(format!("the {name} column holds only names between backticks and commas"));
            }
        }
        match (state(row.state), row.module, row.test) {
            (None, ..) => wrong(format!(
                "`{}` is no state: works, partly: …, not yet, left out: …",
                row.state
            )),
            (Some(State::Works), module, test) if module.is_empty() || test.is_empty() => {
                wrong("what works has a module and a test".to_owned());
            }
            (Some(State::Partly), "", _) => wrong("what partly works has a module".to_owned()),
            (Some(State::NotYet | State::LeftOut), module, test)
                if !(module.is_empty() && test.is_empty()) =>
            {
                wrong("what is not there has no module and no test".to_owned());
            }
            _ => {}
        }
    }
    offences.extend(wrong_totals(&page, &rows));
    Ok(offences)
}

/// The rows of all tables of items, and the rows that are not in order.
fn rows(page: &str) -> (Vec<Row<'_>>, Vec<Offence>) {
    let (mut rows, mut offences, mut in_table) = (Vec::new(), Vec::new(), false);
    for line in markdown::lines(page) {
        let Some(cells) = markdown::cells(line.text) else {
            in_table = false;
            continue;
        };
        if cells == HEAD {
            in_table = true;
        } else if in_table && !markdown::is_rule(&cells) {
            match cells.as_slice() {
                &[item, manual, module, test, state] => {
                    if item.is_empty() || manual.is_empty() {
                        offences.push(Offence::new(
                            PAGE,
                            line.number,
                            "a row names its item and its place in the manual",
                        ));
                    }
                    rows.push(Row {
                        line: line.number,
                        section: line.section,
                        module,
                        test,
                        state,
                    });
                }
                _ => offences.push(Offence::new(
                    PAGE,
                    line.number,
                    format!("{} cells, not 5", cells.len()),
                )),
            }
        }
    }
    (rows, offences)
}

/// The state a cell names; the reason after the colon must be there.
fn state(cell: &str) -> Option<State> {
    match cell.split_once(": ") {
        None if cell == "works" => Some(State::Works),
        None if cell == "not yet" => Some(State::NotYet),
        Some(("partly", reason)) if !reason.trim().is_empty() => Some(State::Partly),
        Some(("left out", reason)) if !reason.trim().is_empty() => Some(State::LeftOut),
        _ => None,
    }
}

/// True if a cell is empty or reads `` `a`, `b` ``.
fn is_list_of_spans(cell: &str) -> bool {
    let pieces: Vec<&str> = cell.split('`').map(str::trim).collect();
    let is_closed = !pieces.len().is_multiple_of(2);
    let around: Vec<&str> = pieces.into_iter().step_by(2).collect();
    is_closed
        && match around.as_slice() {
            [] => true,
            [only] => only.is_empty(),
            [first, inner @ .., last] => {
                first.is_empty() && last.is_empty() && inner.iter().all(|text| *text == ",")
            }
        }
}

/// Missing parts of `file: function, function`, or of a golden case.
fn missing_tests(tree: &Tree, span: &str) -> io::Result<Vec<String>> {
    let Some((file, functions)) = span.split_once(": ") else {
        let is_case = tree.is_file(&join(span, "case.toml"));
        let missing = format!("`{span}` is neither of the form `file: test` nor a golden case");
        return Ok(if is_case { Vec::new() } else { vec![missing] });
    };
    if !tree.is_file(file) {
        return Ok(vec![format!("test file `{file}` does not exist")]);
    }
    let text = tree.read(file)?;
    let functions = functions.split(',').map(str::trim);
    Ok(functions
        .filter(|name| !has_test(&text, name))
        .map(|name| format!("`{file}` has no test `{name}`"))
        .collect())
}

/// True if `text` has a function of this name with a test attribute above it.
fn has_test(text: &str, name: &str) -> bool {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let is_it = |line: &str| {
        line.split_once("fn ").is_some_and(|(_, rest)| {
            rest.strip_prefix(name).is_some_and(|rest| rest.starts_with(['(', '<']))
        })
    };
    lines.iter().enumerate().filter(|(_, line)| is_it(line)).any(|(index, _)| {
        let above = lines.iter().take(index).rev();
        let attributes = above.take_while(|line| line.starts_with("#[") || line.starts_with("//"));
        attributes.into_iter().any(|line| line.starts_with("#[") && line.contains("test"))
    })
}

/// The table at the top of the page, if it is not what the rows add up to.
fn wrong_totals(page: &str, rows: &[Row<'_>]) -> Option<Offence> {
    let expected = totals(rows);
    let start = page.lines().position(|line| line == TOTALS);
    let written: Vec<&str> = page
        .lines()
        .skip(start.map_or(usize::MAX, |start| start + 2))
        .take_while(|line| line.starts_with('|'))
        .collect();
    (written != expected).then(|| {
        let what = format!(
            "the totals should read\n{TOTALS}\n|---|---|---|---|---|---|\n{}",
            expected.join("\n")
        );
        Offence::new(PAGE, start.map_or(1, |start| start + 1), what)
    })
}

/// One row for each manual, in the order of the page, and one for all.
fn totals(rows: &[Row<'_>]) -> Vec<String> {
    let mut sections: Vec<&str> = rows.iter().map(|row| row.section).collect();
    sections.dedup();
    let line = |name: &str, belongs: &dyn Fn(&Row<'_>) -> bool| {
        let of = |wanted| {
            rows.iter().filter(|row| belongs(row) && state(row.state) == Some(wanted)).count()
        };
        let [works, partly, not_yet, left_out] =
            [State::Works, State::Partly, State::NotYet, State::LeftOut].map(of);
        let all = rows.iter().filter(|row| belongs(row)).count();
        format!("| {name} | {works} | {partly} | {not_yet} | {left_out} | {all} |")
    };
    let each = sections.iter().map(|section| line(section, &|row| row.section == *section));
    each.chain(std::iter::once(line("all", &|_| true))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{assert_none, fake};

    #[test]
    fn the_coverage_page_tells_the_truth() -> io::Result<()> {
        assert_none(&check(&Tree::workspace()?)?);
        Ok(())
    }

    const SOURCE: &str = "fn helper() {}\n#[test]\n// why\nfn turns() {}\nproptest! {\n    #[test]\n    fn stays(x in 0..1) {}\n}\n";

    fn page(rows: &[&str], totals: &str) -> String {
        let head = format!("| {} |\n|---|---|---|---|---|\n", HEAD.join(" | "));
        format!(
            "# C\n\n{TOTALS}\n|---|---|---|---|---|---|\n{totals}\n\n## M\n\n{head}{}\n",
            rows.join("\n")
        )
    }

    fn found(rows: &[&str], totals: &str) -> Vec<String> {
        let page = page(rows, totals);
        let (_folder, tree) =
            fake::tree(&[(PAGE, &page), ("a/tests.rs", SOURCE), ("tests/data/arc/case.toml", "")]);
        check(&tree)
            .unwrap()
            .into_iter()
            .map(|offence| format!("{}: {}", offence.line, offence.what))
            .collect()
    }

    #[test]
    fn a_true_page_is_no_offence() {
        let rows = [
            "| x | 1.1 | `a`, `a/tests.rs` | `a/tests.rs: turns, stays` | works |",
            "| y | 1.2 | `a` | `tests/data/arc` | partly: no z |",
            "| z | 1.3 | | | not yet |",
            "| w | 1.4 | | | left out: no bus |",
        ];
        assert_eq!(found(&rows, "| M | 1 | 1 | 1 | 1 | 4 |\n| all | 1 | 1 | 1 | 1 | 4 |"), [""; 0]);
    }

    #[test]
    fn what_does_not_exist_is_found() {
        let rows = [
            "| x | 1 | `b` | `a/tests.rs: turns` | works |",
            "| x | 1 | `a` | `b.rs: turns` | works |",
            "| x | 1 | `a` | `a/tests.rs: helper, turn` | works |",
            "| x | 1 | `a` | `turns` | works |",
        ];
        assert_eq!(
            found(&rows, "| M | 4 | 0 | 0 | 0 | 4 |\n| all | 4 | 0 | 0 | 0 | 4 |"),
            [
                "12: module `b` does not exist",
                "13: test file `b.rs` does not exist",
                "14: `a/tests.rs` has no test `helper`",
                "14: `a/tests.rs` has no test `turn`",
                "15: `turns` is neither of the form `file: test` nor a golden case",
            ]
        );
    }

    #[test]
    fn states_are_checked_against_their_cells() {
        let rows = [
            "| x | 1 | `a` | | works |",
            "| x | 1 | `a` | | not yet |",
            "| x | 1 | | | partly: no y |",
            "| x | 1 | | | partly |",
            "| x | 1 | | | left out: |",
            "| x | 1 | a | | not yet |",
            "| | 1 | | | not yet |",
            "| x | | not yet |",
        ];
        let found = found(&rows, "| M | 1 | 1 | 3 | 0 | 7 |\n| all | 1 | 1 | 3 | 0 | 7 |");
        assert_eq!(
            found,
            [
                "18: a row names its item and its place in the manual",
                "19: 3 cells, not 5",
                "12: what works has a module and a test",
                "13: what is not there has no module and no test",
                "14: what partly works has a module",
                "15: `partly` is no state: works, partly: …, not yet, left out: …",
                "16: `left out:` is no state: works, partly: …, not yet, left out: …",
                "17: the module column holds only names between backticks and commas",
                "17: what is not there has no module and no test",
            ]
        );
    }

    #[test]
    fn a_list_is_spans_and_commas() {
        for list in ["", "`a`", "`a`, `b: c, d`"] {
            assert!(is_list_of_spans(list), "{list}");
        }
        for other in ["a", "`a", "`a` `b`", "`a`, b", "`a`,", "see `a`"] {
            assert!(!is_list_of_spans(other), "{other}");
        }
    }

    #[test]
    fn wrong_totals_are_answered_with_the_right_ones() {
        let found = found(
            &["| x | 1 | | | not yet |"],
            "| M | 0 | 0 | 2 | 0 | 2 |\n| all | 0 | 0 | 2 | 0 | 2 |",
        );
        let [only] = found.as_slice() else { panic!("one offence: {found:?}") };
        assert!(only.ends_with("| M | 0 | 0 | 1 | 0 | 1 |\n| all | 0 | 0 | 1 | 0 | 1 |"), "{only}");
    }
}
