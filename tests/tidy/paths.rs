//! Check that every path in ARCHITECTURE.md exists.

use crate::markdown;
use crate::tree::{Offence, Tree};
use std::io;
use std::path::Path;

const PAGE: &str = "ARCHITECTURE.md";

/// Paths between backticks that lead nowhere.
fn check(tree: &Tree) -> io::Result<Vec<Offence>> {
    let page = tree.read(PAGE)?;
    let mut offences = Vec::new();
    for line in markdown::lines(&page) {
        for (index, span) in markdown::code_spans(line.text).enumerate() {
            // In the code map a line begins with the folder it tells about.
            let is_entry = line.section == "Code map" && index == 0 && line.text.starts_with('`');
            if (is_entry || looks_like_path(span)) && !tree.exists(span) {
                offences.push(Offence::new(PAGE, line.number, format!("`{span}` does not exist")));
            }
        }
    }
    Ok(offences)
}

/// With a slash in it, or with the ending of a file of ours; nothing that holds code.
fn looks_like_path(span: &str) -> bool {
    let plain = span.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c));
    let ending =
        Path::new(span).extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    plain
        && (span.contains('/')
            || ["rs", "toml", "md", "cnc", "ngc", "urdf", "json"].contains(&ending))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{assert_none, fake};

    #[test]
    fn every_path_in_the_architecture_exists() -> io::Result<()> {
        assert_none(&check(&Tree::workspace()?)?);
        Ok(())
    }

    #[test]
    fn a_path_that_leads_nowhere_is_found() {
        let page = "# A\n`core/run.rs`, `core/gone.rs`, `core`, `Read`, `feed_mm_per_s`, `lib.md`, `a / b()`.\n\
                    ## Code map\n\n`core`: here.\n`shell`: nowhere, unlike `Shape`.\n```text\n`no/path`\n```\n";
        let (_folder, tree) = fake::tree(&[(PAGE, page), ("core/run.rs", "")]);
        let found: Vec<_> = check(&tree).unwrap().iter().map(ToString::to_string).collect();
        assert_eq!(
            found,
            [
                "ARCHITECTURE.md:2: `core/gone.rs` does not exist",
                "ARCHITECTURE.md:2: `lib.md` does not exist",
                "ARCHITECTURE.md:6: `shell` does not exist"
            ]
        );
    }
}
