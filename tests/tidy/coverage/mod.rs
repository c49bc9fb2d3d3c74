//! Check of the coverage tables: sources, tests and what reaches each statement exist; the pages made from the tables
//! are up to date.
//!
//! The pages are written anew with
//!
//! ```sh
//! TWIN_COVERAGE=write cargo test -p twin-tests --test tidy -- coverage
//! ```

mod index;
mod page;
mod reach;
pub(crate) mod table;

use crate::markdown;
use crate::tree::{Offence, Tree, join};
use reach::Reach;
use std::io;
use table::{Row, State};

/// Everything in the tables that is not true.
fn check(tree: &Tree) -> io::Result<Vec<Offence>> {
    let (rows, mut offences) = table::read(tree)?;
    let known = Reach::of(tree)?;
    for row in &rows {
        let mut wrong = |what: String| offences.push(row.offence(what));
        for file in row.files.iter().filter(|file| !tree.exists(file)) {
            wrong(format!("`{file}` does not exist"));
        }
        for test in &row.tests {
            for what in missing_tests(tree, test)? {
                wrong(what);
            }
        }
        for reach in &row.reach {
            if let Some(what) = known.missing(reach) {
                wrong(what);
            }
        }
        if let Some(what) = contradiction(row) {
            wrong(what.to_owned());
        }
    }
    Ok(offences)
}

/// Contradiction between the state of a row and its other cells.
fn contradiction(row: &Row) -> Option<&'static str> {
    let proven = !row.files.is_empty() && !row.tests.is_empty();
    let library = row.reach.iter().filter(|reach| reach::is_library(reach)).count();
    let all_library = !row.reach.is_empty() && library == row.reach.len();
    match row.state {
        State::Works if !proven => Some("what works has files and tests"),
        State::Works if row.reach.is_empty() || library > 0 => Some(
            "what works is reached by a command, a key, a job block or a word; else it is library",
        ),
        State::Library if !proven => Some("what the library has has files and tests"),
        State::Library if !all_library => {
            Some("what only the library has is reached by library paths")
        }
        State::Partly if row.files.is_empty() || row.reach.is_empty() || row.note.is_empty() => {
            Some("what partly works has files, a reach and a note on what is missing")
        }
        State::LeftOut if row.note.is_empty() => Some("what is left out has a note on the reason"),
        State::LeftOut
            if !(row.files.is_empty() && row.tests.is_empty() && row.reach.is_empty()) =>
        {
            Some("what is left out has no files, no tests and no reach")
        }
        _ => None,
    }
}

/// Missing tests of the page on faults, the last cell of whose rows has a file and functions in it.
fn missing_fault_tests(tree: &Tree, text: &str) -> io::Result<Vec<String>> {
    let mut missing = Vec::new();
    for line in markdown::lines(text) {
        let Some(cells) = markdown::cells(line.text) else { continue };
        let Some((fault, test)) = cells.first().zip(cells.get(2)) else { continue };
        let mut spans = markdown::code_spans(test);
        let Some(file) = spans.next() else {
            if !markdown::is_rule(&cells) && *fault != "fault" {
                missing.push(format!("line {}: `{fault}` has no test", line.number));
            }
            continue;
        };
        missing.extend(missing_tests(
            tree,
            &format!("{file}: {}", spans.collect::<Vec<_>>().join(",")),
        )?);
    }
    Ok(missing)
}

/// Missing parts of `file: function, function`, or of a golden case.
fn missing_tests(tree: &Tree, test: &str) -> io::Result<Vec<String>> {
    let Some((file, functions)) = test.split_once(": ") else {
        let is_case = tree.is_file(&join(test, "case.toml"));
        let missing = format!("`{test}` is neither of the form `file: test` nor a golden case");
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{assert_none, fake};
    use std::{env, fs};

    #[test]
    fn the_coverage_tables_are_true() -> io::Result<()> {
        assert_none(&check(&Tree::workspace()?)?);
        Ok(())
    }

    #[test]
    fn faults_have_their_tests() -> io::Result<()> {
        let tree = Tree::workspace()?;
        let page = tree.read("docs/src/what_can_go_wrong.md")?;
        assert_eq!(missing_fault_tests(&tree, &page)?, Vec::<String>::new());
        let wrong = "| fault | does | test |\n|---|---|---|\n| a | b | `tests/golden/process.rs`: `no_such` |\n| c | d | |\n";
        assert_eq!(missing_fault_tests(&tree, wrong)?.len(), 2);
        Ok(())
    }

    #[test]
    fn coverage_pages_are_up_to_date() -> io::Result<()> {
        let tree = Tree::workspace()?;
        let (rows, _) = table::read(&tree)?;
        let mut offences = Vec::new();
        for (file, made) in [page::made(&tree, &rows)?, index::made(&rows)] {
            if env::var_os("TWIN_COVERAGE").is_some_and(|value| value == "write") {
                fs::write(tree.path(file), &made)?;
            }
            if tree.read(file).ok().as_deref() != Some(&made) {
                let what = "differs from tests/coverage: TWIN_COVERAGE=write makes it anew";
                offences.push(Offence::new(file, 1, what));
            }
        }
        assert_none(&offences);
        Ok(())
    }

    const SOURCE: &str = "fn helper() {}\n#[test]\n// why\nfn turns() {}\nproptest! {\n    #[test]\n    fn stays(x in 0..1) {}\n}\n";
    const COMMANDS: &str = "#[derive(Subcommand)]\nenum Command { Check(Arguments) }\n";

    fn found(rows: &[&str]) -> Vec<String> {
        let text = table::fake::table(rows);
        let files = [
            ("tests/coverage/m.csv", text.as_str()),
            ("a/tests.rs", SOURCE),
            ("tests/data/arc/case.toml", ""),
            ("twin/command/mod.rs", COMMANDS),
            ("Cargo.toml", "[workspace]\nmembers = [\"lib\"]\n"),
            ("lib/Cargo.toml", "[package]\nname = \"twin-lib\"\n"),
            ("lib/lib.rs", "pub fn turn() {}\n"),
        ];
        let (_folder, tree) = fake::tree(&files);
        let offences = check(&tree).unwrap();
        offences.iter().map(|offence| format!("{}: {}", offence.line, offence.what)).collect()
    }

    #[test]
    fn true_rows_are_no_offence() {
        let rows = [
            "x,works,twin check,,a; a/tests.rs,\"a/tests.rs: turns, stays\"",
            "y,partly,twin check,no z,a,tests/data/arc",
            "z,library,twin_lib::turn,,a,tests/data/arc",
            "w,left out,,no bus,,",
        ];
        assert_eq!(found(&rows), [""; 0]);
    }

    #[test]
    fn missing_files_tests_and_commands_are_found() {
        let rows = [
            "x,works,twin check,,b,a/tests.rs: turns",
            "x,works,twin check,,a,b.rs: turns",
            "x,works,twin check,,a,\"a/tests.rs: helper, turn\"",
            "x,works,twin check,,a,turns",
            "x,works,twin go,,a,a/tests.rs: turns",
        ];
        assert_eq!(
            found(&rows),
            [
                "2: `b` does not exist",
                "3: test file `b.rs` does not exist",
                "4: `a/tests.rs` has no test `helper`",
                "4: `a/tests.rs` has no test `turn`",
                "5: `turns` is neither of the form `file: test` nor a golden case",
                "6: `twin go`: there is no command `go`",
            ]
        );
    }

    #[test]
    fn states_are_compared_with_their_cells() {
        let rows = [
            "x,works,twin check,,a,",
            "x,works,,,a,tests/data/arc",
            "x,works,twin_lib::turn,,a,tests/data/arc",
            "x,library,twin check,,a,tests/data/arc",
            "x,partly,twin check,,a,",
            "x,left out,,,,",
            "x,left out,twin check,no bus,,",
        ];
        let found = found(&rows);
        let ends = [
            "what works has files and tests",
            "else it is library",
            "else it is library",
            "what only the library has is reached by library paths",
            "a note on what is missing",
            "a note on the reason",
            "no files, no tests and no reach",
        ];
        assert_eq!(found.len(), ends.len(), "{found:?}");
        for (found, end) in found.iter().zip(ends) {
            assert!(found.ends_with(end), "{found}");
        }
    }
}
