//! Check of the dependency table ("Who may know whom") in ARCHITECTURE.md against the manifests.

use crate::manifest::Manifest;
use crate::markdown::{self, Line};
use crate::tree::{Offence, Tree};
use std::io;
use toml::Value;

const PAGE: &str = "ARCHITECTURE.md";
const SECTION: &str = "Who may know whom";
const COMMON: &str = "may be used by all but";

/// Dependencies that the page allows one crate.
#[derive(Debug)]
struct Row {
    line: usize,
    folder: String,
    /// Members it may know; `None` means all.
    ours: Option<Vec<String>>,
    /// Crates from outside that nobody else may use.
    outside: Vec<String>,
}

/// A crate from outside that everybody may use but these members.
#[derive(Debug)]
struct Common {
    line: usize,
    package: String,
    all_but: Vec<String>,
}

/// Every dependency that the page does not allow, and every line of the page that speaks of something that is not
/// there. Tests, benches and examples may use everything from outside, and members that do not know their crate.
fn check(tree: &Tree) -> io::Result<Vec<Offence>> {
    let (root, members) = Manifest::workspace(tree)?;
    let page = tree.read(PAGE)?;
    let (rows, commons) = rules(&page);
    let mut offences = stale(&rows, &commons, &root, &members);
    for member in &members {
        let Some(row) = rows.iter().find(|row| row.folder == member.folder) else {
            offences.push(Offence::new(
                &member.file,
                1,
                format!("{PAGE} does not say whom `{}` may know", member.folder),
            ));
            continue;
        };
        for dependency in member.dependencies(&root) {
            let name = dependency.package.as_str();
            let allowed = if let Some(ours) = members.iter().find(|other| other.package() == name) {
                (dependency.dev && !knows(&rows, &ours.folder, &row.folder))
                    || row.ours.as_ref().is_none_or(|known| known.contains(&ours.folder))
            } else if let Some(common) = commons.iter().find(|common| common.package == name) {
                !common.all_but.contains(&row.folder)
            } else {
                let exclusive =
                    rows.iter().any(|row| row.outside.iter().any(|outside| outside == name));
                !exclusive || dependency.dev || row.outside.iter().any(|outside| outside == name)
            };
            if !allowed {
                let what = format!("`{}` may not know `{name}` ({PAGE}, {SECTION})", row.folder);
                offences.push(Offence::new(&member.file, dependency.line, what));
            }
        }
    }
    Ok(offences)
}

/// The table and the sentence below it.
fn rules(page: &str) -> (Vec<Row>, Vec<Common>) {
    let (mut rows, mut commons) = (Vec::new(), Vec::new());
    for line in markdown::lines(page).filter(|line| line.section == SECTION) {
        rows.extend(row(&line));
        commons.extend(common(&line));
    }
    (rows, commons)
}

fn row(line: &Line<'_>) -> Option<Row> {
    let cells = markdown::cells(line.text).filter(|cells| !markdown::is_rule(cells))?;
    let [folder, ours, outside] = cells.as_slice() else { return None };
    (*folder != "crate").then(|| Row {
        line: line.number,
        folder: (*folder).to_owned(),
        ours: (*ours != "all").then(|| list(ours)),
        outside: list(outside),
    })
}

fn common(line: &Line<'_>) -> Option<Common> {
    let (before, after) = line.text.split_once(COMMON)?;
    let package = before.split_whitespace().next()?.trim_matches('`').to_owned();
    Some(Common {
        line: line.number,
        package,
        all_but: markdown::code_spans(after).map(str::to_owned).collect(),
    })
}

/// Whether the page allows a member to know another one, directly or through others.
fn knows(rows: &[Row], member: &str, other: &str) -> bool {
    let Some(row) = rows.iter().find(|row| row.folder == member) else { return false };
    row.ours.as_ref().is_none_or(|ours| {
        ours.iter().any(|known| known == other || (known != member && knows(rows, known, other)))
    })
}

fn list(cell: &str) -> Vec<String> {
    cell.split(',')
        .map(str::trim)
        .filter(|name| !name.is_empty() && *name != "–")
        .map(str::to_owned)
        .collect()
}

/// Names on the page that nothing answers to: a rule about a misspelt crate would hold for ever.
fn stale(rows: &[Row], commons: &[Common], root: &Manifest, members: &[Manifest]) -> Vec<Offence> {
    let known = root.get(&["workspace", "dependencies"]).and_then(Value::as_table);
    let is_dependency = |name: &str| known.is_some_and(|table| table.contains_key(name));
    let is_member = |name: &str| members.iter().any(|member| member.folder == name);
    let mut offences = Vec::new();
    for row in rows {
        for name in std::iter::once(&row.folder).chain(row.ours.iter().flatten()) {
            if !is_member(name) {
                offences.push(Offence::new(
                    PAGE,
                    row.line,
                    format!("`{name}` is no member of the workspace"),
                ));
            }
        }
        for name in row.outside.iter().filter(|name| !is_dependency(name)) {
            offences.push(Offence::new(
                PAGE,
                row.line,
                format!("`{name}` is no dependency of the workspace"),
            ));
        }
    }
    for common in commons {
        if !is_dependency(&common.package) {
            let what = format!("`{}` is no dependency of the workspace", common.package);
            offences.push(Offence::new(PAGE, common.line, what));
        }
        for name in common.all_but.iter().filter(|name| !is_member(name)) {
            offences.push(Offence::new(
                PAGE,
                common.line,
                format!("`{name}` is no member of the workspace"),
            ));
        }
    }
    offences
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{assert_none, fake};

    #[test]
    fn every_crate_knows_only_what_the_page_allows() -> io::Result<()> {
        assert_none(&check(&Tree::workspace()?)?);
        Ok(())
    }

    const ROOT: &str = "[workspace]\nmembers = [\"low\", \"high\"]\n[workspace.dependencies]\n\
                        engine = \"1\"\nmaths = \"1\"\nlow = { path = \"low\" }\nhigh = { path = \"high\" }\n";
    const TABLE: &str = "## Who may know whom\n\n| crate | ours | outside, exclusively |\n|---|---|---|\n\
                         | low | – | maths |\n| high | low | engine |\n\n\
                         maths is for all and may be used by all but `high`.\n";

    fn found(page: &str, low: &str, high: &str) -> Vec<String> {
        let low = format!("[package]\nname = \"low\"\n[dependencies]\n{low}");
        let high = format!("[package]\nname = \"high\"\n[dependencies]\n{high}");
        let files = [
            ("Cargo.toml", ROOT),
            (PAGE, page),
            ("low/Cargo.toml", &low),
            ("high/Cargo.toml", high.as_str()),
        ];
        let (_folder, tree) = fake::tree(&files);
        check(&tree).unwrap().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_the_page_allows_is_no_offence() {
        let test_only = "maths.workspace = true\n[dev-dependencies]\nengine.workspace = true\n";
        assert_eq!(
            found(TABLE, test_only, "low.workspace = true\nengine.workspace = true\n"),
            [""; 0]
        );
    }

    #[test]
    fn a_crate_that_looks_up_is_found_even_in_its_tests() {
        let found = found(TABLE, "[dev-dependencies]\nhigh.workspace = true\n", "");
        assert_eq!(
            found,
            ["low/Cargo.toml:5: `low` may not know `high` (ARCHITECTURE.md, Who may know whom)"]
        );
    }

    #[test]
    fn an_exclusive_crate_is_found_elsewhere() {
        let found = found(TABLE, "engine.workspace = true\n", "maths.workspace = true\n");
        assert_eq!(
            found,
            [
                "low/Cargo.toml:4: `low` may not know `engine` (ARCHITECTURE.md, Who may know whom)",
                "high/Cargo.toml:4: `high` may not know `maths` (ARCHITECTURE.md, Who may know whom)"
            ]
        );
    }

    #[test]
    fn names_that_stand_for_nothing_are_found() {
        let page = TABLE.replace("| low | – | maths |", "| lower | – | engin |");
        assert_eq!(
            found(&page, "", ""),
            [
                "ARCHITECTURE.md:5: `lower` is no member of the workspace",
                "ARCHITECTURE.md:5: `engin` is no dependency of the workspace",
                "low/Cargo.toml:1: ARCHITECTURE.md does not say whom `low` may know"
            ]
        );
    }
}
