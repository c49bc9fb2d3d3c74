//! Command line: usage, arguments and options of every command, from the definition that parses them.

use super::{cell, compare};
use clap::{Arg, Command};
use std::fmt::Write;

const HEAD: &str = "\
# Command line

All commands with their arguments and options, as `twin COMMAND --help` shows them.
Every command also has `-h` and `--help`. Numbers below 0 need no `=`.

Exit status of every command: 0 done, nothing wrong; 1 the program is not fit, or a tolerance was exceeded; 2 the command could not be carried out.
";

/// Paragraphs of a help text; lines that are indented are examples.
fn paragraphs(text: &str) -> String {
    let mut out = String::new();
    let mut code = false;
    for line in text.lines() {
        let indented = line.starts_with("  ");
        if !line.is_empty() && indented != code {
            let end = out.trim_end().len();
            out.truncate(end);
            out.push_str(if indented { "\n\n```text\n" } else { "\n```\n\n" });
            code = indented;
        }
        out.push_str(line.trim_end());
        out.push('\n');
    }
    if code {
        out.push_str("```\n");
    }
    out
}

/// `text` with a full stop, if it has none.
fn stopped(text: &str) -> String {
    if text.is_empty() || text.ends_with(['.', ':']) { text.to_owned() } else { format!("{text}.") }
}

fn help_of(argument: &Arg) -> String {
    let long = argument.get_long_help().or(argument.get_help());
    let long = long.map(ToString::to_string).unwrap_or_default();
    let paragraphs: Vec<_> =
        long.split("\n\n").map(|paragraph| stopped(&cell(paragraph))).collect();
    let mut text = paragraphs.join(" ");
    let takes = argument.get_action().takes_values();
    let values = argument.get_possible_values();
    let values: Vec<_> = values.iter().filter(|value| takes && !value.is_hide_set()).collect();
    if !values.is_empty() {
        let named = values.iter().map(|value| {
            let help = value.get_help().map(|help| format!(" ({})", cell(&help.to_string())));
            format!("`{}`{}", value.get_name(), help.unwrap_or_default())
        });
        write!(text, " Values: {}.", named.collect::<Vec<_>>().join(", ")).expect("a string");
    }
    let defaults: Vec<_> =
        argument.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if takes && !defaults.is_empty() {
        write!(text, " Default: `{}`.", defaults.join(" ")).expect("a string");
    }
    text
}

fn name_of(argument: &Arg) -> String {
    let values: Vec<_> =
        argument.get_value_names().unwrap_or_default().iter().map(ToString::to_string).collect();
    let values = if argument.get_action().takes_values() { values } else { Vec::new() };
    let bars = |text: String| text.replace('|', "\\|");
    if argument.is_positional() {
        let more = if argument.get_num_args().is_some_and(|count| count.max_values() > 1) {
            "…"
        } else {
            ""
        };
        return bars(format!("`{}`{more}", values.join(" ")));
    }
    let short = argument.get_short().map(|short| format!("-{short}"));
    let long = argument.get_long().map(|long| format!("--{long}"));
    let names: Vec<_> = short.into_iter().chain(long).collect();
    let optional = argument.get_num_args().is_some_and(|count| count.min_values() == 0);
    let values = match values.join(" ") {
        none if none.is_empty() => none,
        some if optional => format!(" [{some}]"),
        some => format!(" {some}"),
    };
    bars(format!("`{}{values}`", names.join(", ")))
}

fn write(page: &mut String, command: &Command, path: &str, depth: usize) {
    let about = command.get_long_about().or(command.get_about()).map(ToString::to_string);
    let usage = command.clone().bin_name(path).render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ");
    let usage: Vec<_> = usage.lines().map(str::trim).collect();
    write!(page, "\n{} `{path}`\n\n", "#".repeat(depth.min(4))).expect("a string");
    page.push_str(&paragraphs(&about.unwrap_or_default()));
    write!(page, "\n```text\n{}\n```\n", usage.join("\n")).expect("a string");
    let seen = |argument: &&Arg| {
        !argument.is_hide_set() && !["help", "version"].contains(&argument.get_id().as_str())
    };
    let mut groups: Vec<(Option<&str>, bool, Vec<&Arg>)> = Vec::new();
    for one in command.get_arguments().filter(seen) {
        let (heading, positional) = (one.get_help_heading(), one.is_positional());
        match groups.iter_mut().find(|(other, place, _)| (*other, *place) == (heading, positional))
        {
            Some((.., list)) => list.push(one),
            None => groups.push((heading, positional, vec![one])),
        }
    }
    groups.sort_by_key(|(heading, positional, _)| (!positional, heading.is_some()));
    for (heading, positional, list) in groups {
        if let Some(heading) = heading {
            write!(page, "\n{heading}:\n").expect("a string");
        }
        let what = if positional { "argument" } else { "option" };
        write!(page, "\n| {what} | meaning |\n|---|---|\n").expect("a string");
        for one in list {
            writeln!(page, "| {} | {} |", name_of(one), help_of(one)).expect("a string");
        }
    }
    if let Some(after) = command.get_after_long_help().or(command.get_after_help()) {
        page.push('\n');
        page.push_str(&paragraphs(&after.to_string()));
    }
    for below in
        command.get_subcommands().filter(|below| !below.is_hide_set() && below.get_name() != "help")
    {
        write(page, below, &format!("{path} {}", below.get_name()), depth + 1);
    }
}

#[test]
fn the_chapter_on_the_command_line_is_up_to_date() {
    let mut page = HEAD.to_owned();
    let mut command = twin::command::definition();
    command.build();
    write(&mut page, &command, "twin", 2);
    compare("command_line.md", &page);
}
