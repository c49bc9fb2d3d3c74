//! Rules of findings, with their texts and severities.

use super::{cell, compare};
use std::fmt::Write;
use twin::finding::{Rule, Severity};

const HEAD: &str = "\
# Rules

Every finding belongs to one of these rules. `twin check`, `twin run` and `twin limit` report findings, and so do `twin cam` and jobs; the field `rule` of a [report](report.md) has the name.

- `error`: the program is not fit for the machine, and the exit status is 1.
- `warning`: the program runs, but perhaps not as meant.
- `note`: worth knowing.

A rule with several severities has the worst one first. `twin explain RULE` shows the same texts; numbers of `SMC_ERROR` are in [Errors by number](../errors.md).

| rule | severity | meaning | remedy |
|---|---|---|---|
";

const CAMS: &str = "
## Cams and jobs

Of cams and jobs some rules mean more:

| rule | meaning | remedy |
|---|---|---|
";

fn name(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

#[test]
fn the_chapter_on_rules_is_up_to_date() {
    let mut page = HEAD.to_owned();
    for &rule in Rule::ALL {
        let [meaning, remedy] = rule.meaning().map(cell);
        let severities: Vec<_> = rule.severities().iter().copied().map(name).collect();
        let severities = severities.join(", ");
        writeln!(page, "| `{}` | {severities} | {meaning} | {remedy} |", rule.name())
            .expect("a string");
    }
    page.push_str(CAMS);
    for &rule in Rule::ALL {
        let Some(texts) = rule.of_cams() else { continue };
        let [meaning, remedy] = texts.map(cell);
        writeln!(page, "| `{}` | {meaning} | {remedy} |", rule.name()).expect("a string");
    }
    compare("rules.md", &page);
}
