//! Reader of the coverage tables, `tests/coverage/*.csv`: one statement of a manual per row.

use crate::tree::{Offence, Tree};
use std::io;

/// Folder of the tables.
const FOLDER: &str = "tests/coverage/";
const HEAD: [&str; 10] =
    ["manual", "chapter", "section", "place", "item", "state", "reach", "note", "files", "tests"];

/// State of a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum State {
    /// A command, a key or a job block reaches it.
    Works,
    /// Only Rust programs reach it.
    Library,
    /// The note says what is missing.
    Partly,
    /// The note says why.
    LeftOut,
}

impl State {
    pub(crate) const ALL: [Self; 4] = [Self::Works, Self::Library, Self::Partly, Self::LeftOut];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Works => "works",
            Self::Library => "library",
            Self::Partly => "partly",
            Self::LeftOut => "left out",
        }
    }
}

/// One statement.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// The table.
    pub(crate) file: String,
    /// Its line there.
    pub(crate) line: usize,
    pub(crate) manual: String,
    pub(crate) chapter: String,
    pub(crate) section: String,
    /// Section, page or heading of the manual.
    pub(crate) place: String,
    /// Name and meaning; names between backticks.
    pub(crate) item: String,
    pub(crate) state: State,
    /// Command, key, job block, word of a program or library path.
    pub(crate) reach: Vec<String>,
    pub(crate) note: String,
    /// Source files and folders.
    pub(crate) files: Vec<String>,
    /// `file: function, function`, or the folder of a golden case.
    pub(crate) tests: Vec<String>,
}

impl Row {
    /// An offence in this row.
    pub(crate) fn offence(&self, what: impl Into<String>) -> Offence {
        Offence::new(&self.file, self.line, what)
    }

    /// Names between backticks with which the item begins, behind a number at most.
    pub(crate) fn names(&self) -> Vec<&str> {
        let mut rest =
            self.item.trim_start_matches(|c: char| c.is_ascii_digit() || "–- ".contains(c));
        let mut names = Vec::new();
        while let Some((name, behind)) =
            rest.strip_prefix('`').and_then(|rest| rest.split_once('`'))
        {
            names.push(name);
            rest = behind.trim_start_matches([' ', ',']);
        }
        names
    }
}

/// All rows, in the order of files and lines, and rows that cannot be read.
pub(crate) fn read(tree: &Tree) -> io::Result<(Vec<Row>, Vec<Offence>)> {
    let (mut rows, mut offences) = (Vec::new(), Vec::new());
    for file in tree.with_extension("csv").filter(|file| file.starts_with(FOLDER)) {
        let text = tree.read(file)?;
        let mut records = csv::Reader::from_reader(text.as_bytes());
        if records.headers()?.iter().ne(HEAD) {
            offences.push(Offence::new(file, 1, format!("the columns are {}", HEAD.join(", "))));
            continue;
        }
        for record in records.records() {
            let record = record?;
            let line = record.position().map_or(1, |at| usize::try_from(at.line()).unwrap_or(1));
            match row(file, line, &record) {
                Ok(row) => rows.push(row),
                Err(what) => offences.push(Offence::new(file, line, what)),
            }
        }
    }
    Ok((rows, offences))
}

fn row(file: &str, line: usize, record: &csv::StringRecord) -> Result<Row, String> {
    let cell = |index: usize| record.get(index).unwrap_or_default().trim();
    let named = |index: usize| match cell(index) {
        "" => Err(format!("the column {} is empty", HEAD.get(index).unwrap_or(&""))),
        text => Ok(text.to_owned()),
    };
    let list = |index: usize| {
        let parts = cell(index).split(';').map(str::trim).filter(|part| !part.is_empty());
        parts.map(str::to_owned).collect()
    };
    let state = State::ALL.into_iter().find(|state| state.name() == cell(5));
    Ok(Row {
        file: file.to_owned(),
        line,
        manual: named(0)?,
        chapter: named(1)?,
        section: named(2)?,
        place: named(3)?,
        item: named(4)?,
        state: state.ok_or_else(|| {
            format!("`{}` is not a state: works, library, partly, left out", cell(5))
        })?,
        reach: list(6),
        note: cell(7).to_owned(),
        files: list(8),
        tests: list(9),
    })
}

#[cfg(test)]
pub(crate) mod fake {
    //! Tables that exist for one test.

    use super::HEAD;

    /// The text of a table; a row is given from `item` on.
    pub(crate) fn table(rows: &[&str]) -> String {
        let rows = rows.iter().fold(String::new(), |text, row| text + "M,C,S,1," + row + "\n");
        format!("{}\n{rows}", HEAD.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::fake::tree;

    #[test]
    fn rows_are_read_with_their_lists_and_lines() {
        let text = fake::table(&["\"12 `a`, `b` c\",works,twin check; G1,,a.rs; b,c.rs: x"]);
        let (_folder, tree) = tree(&[("tests/coverage/m.csv", &text), ("tests/data/n.csv", "x\n")]);
        let (rows, offences) = read(&tree).unwrap();
        assert_eq!((rows.len(), offences), (1, Vec::new()));
        assert_eq!((rows[0].line, rows[0].state), (2, State::Works));
        assert_eq!(rows[0].names(), ["a", "b"]);
        assert_eq!(
            (&rows[0].reach[..], &rows[0].files[..]),
            (
                &["twin check".to_owned(), "G1".to_owned()][..],
                &["a.rs".to_owned(), "b".to_owned()][..]
            )
        );
    }

    #[test]
    fn unknown_states_and_empty_names_are_found() {
        let text = fake::table(&["a,not yet,,,,", ",works,,,,"]);
        let (_folder, tree) =
            tree(&[("tests/coverage/m.csv", &text), ("tests/coverage/n.csv", "a,b\n")]);
        let found: Vec<_> = read(&tree).unwrap().1.iter().map(ToString::to_string).collect();
        assert_eq!(found.len(), 3, "{found:?}");
        assert!(found[0].ends_with("`not yet` is not a state: works, library, partly, left out"));
        assert!(
            found[1].ends_with("the column item is empty") && found[2].contains("the columns are")
        );
    }
}
