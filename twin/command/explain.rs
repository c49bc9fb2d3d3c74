//! `twin explain`: meaning and remedy of error numbers, error names, rules and blocks, and keys of machine files.

use super::show::table;
use super::{Failure, Status};
use crate::finding::Rule;
use crate::job::block_names;
use clap::ValueEnum;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io::{self, Write};
use twin_axis::{Language, SmcError};
use twin_machine::KeyMeaning;

/// Explain errors of SoftMotion (`SMC_ERROR`) by number or name, the rules of `twin check`, the errors that a block raises, and
/// the keys of machine files
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Arguments {
    /// Numbers (626), names (`SMC_CI_MASTER_OUT_OF_SCALE`, with or without `SMC_`, in any case), rules (axis-velocity), blocks (`MC_CamIn`) or keys of machine files (`headroom_percent`)
    #[arg(value_name = "NUMBER|NAME", required_unless_present = "list", conflicts_with = "list")]
    what: Vec<String>,

    /// All of them as a table
    #[arg(long)]
    list: bool,

    /// The language of the texts; German or French if `LC_ALL`, `LC_MESSAGES` or `LANG` say so, else English. Rules are in English
    #[arg(long, value_enum)]
    language: Option<Texts>,

    /// For people, or one JSON object per line
    #[arg(long, value_enum, default_value = "human")]
    format: Format,
}

const AFTER_HELP: &str = "\
Exit status:
  0  all of them are explained
  2  one of them is not known

Examples:
  twin explain 626
  twin explain smc_gi_ratio_denom 1003 --language de
  twin explain axis-velocity
  twin explain headroom_percent
  twin explain --list --language all";

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Texts {
    En,
    De,
    Fr,
    All,
}

impl Texts {
    fn languages(self) -> &'static [Language] {
        match self {
            Self::En => &[Language::English],
            Self::De => &[Language::German],
            Self::Fr => &[Language::French],
            Self::All => &[Language::English, Language::German, Language::French],
        }
    }

    /// As the environment asks for.
    fn of_locale(variable: impl Fn(&str) -> Option<String>) -> Self {
        let said = ["LC_ALL", "LC_MESSAGES", "LANG"].into_iter().filter_map(variable);
        let said = said.into_iter().find(|value| !value.is_empty()).unwrap_or_default();
        match said.get(..2) {
            Some("de") => Self::De,
            Some("fr") => Self::Fr,
            _ => Self::En,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    Human,
    Json,
}

/// What can be explained.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Topic {
    Error(SmcError),
    Rule(Rule),
    /// A function block, by its name.
    Block(&'static str),
    /// A key of machine files, which several tables may have.
    Key(&'static str),
}

impl Topic {
    fn all() -> impl Iterator<Item = Self> {
        let errors = SmcError::ALL.iter().copied().map(Self::Error);
        errors.chain(Rule::ALL.iter().copied().map(Self::Rule))
    }

    fn name(self) -> &'static str {
        match self {
            Self::Error(error) => error.name(),
            Self::Rule(rule) => rule.name(),
            Self::Block(name) | Self::Key(name) => name,
        }
    }

    /// The blocks that jobs call, and those that errors name.
    fn blocks() -> impl Iterator<Item = Self> {
        let errors = SmcError::ALL.iter().flat_map(|error| raisers(*error));
        block_names().chain(errors).map(Self::Block)
    }

    /// The keys of machine files.
    fn keys() -> impl Iterator<Item = Self> {
        // Names that are up to the user explain nothing.
        let keys = KeyMeaning::all().map(|one| one.key).filter(|key| *key != "NAME");
        keys.map(Self::Key)
    }

    /// By number or name; else what to say of it.
    fn find(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if let Ok(number) = text.parse::<i64>() {
            let found = u16::try_from(number).ok().and_then(SmcError::from_number);
            return found.map(Self::Error).ok_or_else(|| near_number(number));
        }
        let wanted = text.to_uppercase();
        let same = |topic: &Self| {
            let name = topic.name().to_uppercase();
            name == wanted || name.strip_prefix("SMC_") == Some(&wanted)
        };
        Self::all()
            .chain(Self::blocks())
            .chain(Self::keys())
            .find(same)
            .ok_or_else(|| near_name(text))
    }
}

/// The blocks by which an error is raised, by their names; those that stand for many of them are none.
fn raisers(error: SmcError) -> impl Iterator<Item = &'static str> {
    let names = error.raised_by().split(", ");
    names.filter(|name| ["MC_", "SMC_"].iter().any(|prefix| name.starts_with(prefix)))
}

/// What a block raises: errors of its own, under the name of the manual or of PLCopen, then those that blocks of its kind raise.
fn raised_in(block: &str) -> impl Iterator<Item = SmcError> {
    let plain = |name: &str| name.trim_start_matches('S').to_uppercase();
    let name = plain(block);
    let own = move |error: &SmcError| raisers(*error).any(|raiser| plain(raiser) == name);
    SmcError::ALL.iter().copied().filter(own)
}

/// Where the inputs of blocks stand.
const KEYS: &str = "docs/src/jobs.md, \"Blocks\"";

/// The numbers below and above.
fn near_number(number: i64) -> String {
    let known = |error: &&SmcError| i64::from(error.number()) < number;
    let below = SmcError::ALL.iter().take_while(known).last();
    let above = SmcError::ALL.iter().find(|error| i64::from(error.number()) > number);
    let near: Vec<_> = below.into_iter().chain(above).map(ToString::to_string).collect();
    format!("{number} is not a number of SMC_ERROR; the next ones are:\n{}", near.join("\n"))
}

/// How many names are suggested.
const SUGGESTIONS: usize = 3;

fn near_name(text: &str) -> String {
    let wanted = text.to_uppercase();
    let wanted = wanted.strip_prefix("SMC_").unwrap_or(&wanted);
    let alike = |topic: Topic| {
        let name = topic.name().to_uppercase();
        // Part of a name is as good as a name that is mistyped.
        let name = name.strip_prefix("SMC_").unwrap_or(&name);
        let part = if wanted.len() >= 3 && name.contains(wanted) { 1.0 } else { 0.0 };
        strsim::jaro_winkler(wanted, name).max(part)
    };
    let all = Topic::all().chain(Topic::blocks()).chain(Topic::keys());
    let mut near: Vec<_> = all.map(|topic| (alike(topic), topic.name())).collect();
    near.retain(|(alike, _)| *alike > 0.75);
    near.sort_by(|one, other| other.0.total_cmp(&one.0));
    let mut names: Vec<_> = near.into_iter().map(|(_, name)| name).collect();
    let mut seen = BTreeSet::new();
    names.retain(|name| seen.insert(*name));
    names.truncate(SUGGESTIONS);
    let help = match names.as_slice() {
        [] => "twin explain --list shows all of them".to_owned(),
        names => format!("did you mean {}?", names.join(" or ")),
    };
    format!("`{text}` is not an SMC_ERROR, a block, a rule or a key of machine files; {help}")
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let asked = arguments.language;
    let texts = asked.unwrap_or_else(|| Texts::of_locale(|name| std::env::var(name).ok()));
    let mut out = io::stdout().lock();
    if arguments.list {
        list(&mut out, texts, arguments.format).map_err(Failure::Stdio)?;
        return Ok(Status::Fit);
    }
    let mut unknown = Vec::new();
    let mut shown = false;
    for text in &arguments.what {
        match Topic::find(text) {
            Ok(topic) => {
                let written = match arguments.format {
                    Format::Human => tell(&mut out, topic, texts, shown),
                    Format::Json => writeln!(out, "{}", object(topic)),
                };
                written.map_err(Failure::Stdio)?;
                shown = true;
            }
            Err(message) => unknown.push(message),
        }
    }
    if unknown.is_empty() { Ok(Status::Fit) } else { Err(Failure::Usage(unknown.join("\n"))) }
}

fn tell(out: &mut impl Write, topic: Topic, texts: Texts, behind: bool) -> io::Result<()> {
    if behind {
        writeln!(out)?;
    }
    match topic {
        Topic::Error(error) => {
            writeln!(out, "{} {}", error.number(), error.name())?;
            let name = |language| if texts == Texts::All { long(language) } else { "" };
            for language in texts.languages() {
                writeln!(out, "  {}{}", name(*language), error.text(*language))?;
            }
            for language in texts.languages() {
                let by = error.raised_by_in(*language);
                writeln!(out, "  {}: {by}", raised_by(*language))?;
            }
            texts.languages().iter().try_for_each(|language| {
                writeln!(out, "  {}: {}", to_do(*language), error.remedy(*language))
            })
        }
        Topic::Rule(rule) => {
            let [meaning, remedy] = rule.meaning();
            writeln!(out, "{} (rule of twin)", rule.name())?;
            writeln!(out, "  {meaning}\n  what to do: {remedy}")?;
            if let Some([meaning, remedy]) = rule.of_cams() {
                writeln!(out, "  of cams and jobs: {meaning}\n  what to do there: {remedy}")?;
            }
            Ok(())
        }
        Topic::Block(name) => {
            writeln!(out, "{name} (block)")?;
            let language = *texts.languages().first().unwrap_or(&Language::English);
            let mut none = true;
            for error in raised_in(name) {
                none = false;
                let text = error.text(language);
                writeln!(out, "  {} {}: {text}", error.number(), error.name())?;
            }
            if none {
                writeln!(out, "  no error of its own")?;
            }
            let general = "  and what every block, or every block that moves, raises: 20, 31, 32";
            writeln!(out, "{general}; `twin explain NUMBER` says what to do")?;
            if block_names().any(|block| block == name) {
                writeln!(out, "  its inputs in a job: {KEYS}")?;
            }
            Ok(())
        }
        Topic::Key(key) => {
            writeln!(out, "{key} (key of machine files)")?;
            meanings(key).try_for_each(|KeyMeaning { table, default, meaning, .. }| {
                let table = if table.is_empty() { "top level" } else { table };
                let plain = |text: &str| text.replace('`', "");
                let default = match default {
                    "" => "required".to_owned(),
                    needed if needed.starts_with("required") => plain(needed),
                    default => format!("default: {}", plain(default)),
                };
                writeln!(out, "  {table}: {} ({default})", plain(meaning))
            })
        }
    }
}

/// The meanings of a key, by tables.
fn meanings(key: &'static str) -> impl Iterator<Item = KeyMeaning> {
    KeyMeaning::all().filter(move |one| one.key == key)
}

fn raised_by(language: Language) -> &'static str {
    match language {
        Language::English => "raised by",
        Language::German => "gemeldet von",
        Language::French => "signalée par",
    }
}

fn to_do(language: Language) -> &'static str {
    match language {
        Language::English => "what to do",
        Language::German => "was zu tun ist",
        Language::French => "que faire",
    }
}

fn long(language: Language) -> &'static str {
    match language {
        Language::English => "English: ",
        Language::German => "Deutsch: ",
        Language::French => "français : ",
    }
}

/// With all languages, whatever the locale: other programs choose for themselves.
fn object(topic: Topic) -> Value {
    match topic {
        Topic::Error(error) => json!({
            "number": error.number(),
            "name": error.name(),
            "text": {
                "en": error.text(Language::English),
                "de": error.text(Language::German),
                "fr": error.text(Language::French),
            },
            "raised_by": error.raised_by(),
            "remedy": error.remedy(Language::English),
            "remedies": {
                "en": error.remedy(Language::English),
                "de": error.remedy(Language::German),
                "fr": error.remedy(Language::French),
            },
        }),
        Topic::Block(name) => {
            let errors: Vec<_> = raised_in(name)
                .map(|error| json!({ "number": error.number(), "name": error.name() }))
                .collect();
            json!({ "block": name, "errors": errors, "in_jobs": block_names().any(|block| block == name) })
        }
        Topic::Key(key) => {
            let tables: Vec<_> = meanings(key)
                .map(|KeyMeaning { table, default, meaning, .. }| {
                    json!({ "table": table, "default": default, "meaning": meaning })
                })
                .collect();
            json!({ "key": key, "tables": tables })
        }
        Topic::Rule(rule) => {
            let [meaning, remedy] = rule.meaning();
            let of_cams = rule
                .of_cams()
                .map(|[text, remedy]| json!({ "text": { "en": text }, "remedy": remedy }));
            json!({ "rule": rule.name(), "text": { "en": meaning }, "remedy": remedy, "of_cams": of_cams })
        }
    }
}

fn list(out: &mut impl Write, texts: Texts, format: Format) -> io::Result<()> {
    if format == Format::Json {
        return Topic::all().try_for_each(|topic| writeln!(out, "{}", object(topic)));
    }
    let mut errors = table();
    let languages = texts.languages();
    // The blocks are there once, in English, next to texts in several languages.
    let language = match languages {
        [only] => *only,
        _ => Language::English,
    };
    let [number, name] = match language {
        Language::English => ["no.", "name"],
        Language::German => ["Nr.", "Name"],
        Language::French => ["n°", "nom"],
    };
    let header = [number, name, raised_by(language)].into_iter().map(str::to_owned);
    let texts = languages.iter().map(|language| match language {
        Language::English => "text".to_owned(),
        Language::German => "Text".to_owned(),
        Language::French => "texte".to_owned(),
    });
    errors.set_header(header.chain(texts));
    for error in SmcError::ALL {
        let by = error.raised_by_in(language).to_owned();
        let row = [error.number().to_string(), error.name().to_owned(), by];
        let texts = languages.iter().map(|language| error.text(*language).to_owned());
        errors.add_row(row.into_iter().chain(texts));
    }
    let mut rules = table();
    rules.set_header(["rule of twin", "text"]);
    for &rule in Rule::ALL {
        rules.add_row([rule.name(), rule.meaning()[0]]);
    }
    writeln!(out, "{errors}\n{rules}")
}

#[cfg(test)]
mod tests {
    use super::{Texts, Topic, raised_in};
    use twin_axis::SmcError;

    #[test]
    fn names_in_any_case_with_or_without_their_prefix() {
        let expected = Ok(Topic::Error(SmcError::CiMasterOutOfScale));
        for text in ["626", " 626 ", "SMC_CI_MASTER_OUT_OF_SCALE", "smc_ci_master_out_of_scale"] {
            assert_eq!(Topic::find(text), expected, "{text}");
        }
        assert_eq!(Topic::find("ci_Master_out_of_scale"), expected);
        assert_eq!(Topic::find("Axis-Velocity").map(Topic::name), Ok("axis-velocity"));
    }

    /// Numbers and raisers of manual 9.3; `SMC_GearInPos` is `MC_GearInPos` by the name of `PLCopen`.
    #[test]
    fn blocks_have_their_errors() {
        for (block, expected) in [
            ("MC_CamIn", &[625, 626, 627, 628][..]),
            ("mc_gearinpos", &[775]),
            ("SMC_GearInPos", &[775]),
            ("MC_ReadParameter", &[130, 131]),
            ("MC_CamOut", &[]),
        ] {
            let Ok(Topic::Block(name)) = Topic::find(block) else { panic!("{block}") };
            assert!(name.eq_ignore_ascii_case(block));
            let found: Vec<_> = raised_in(name).map(SmcError::number).collect();
            for number in expected {
                assert!(found.contains(number), "{block}: {found:?}");
            }
            assert!(!expected.is_empty() || found.iter().all(|number| *number > 600), "{found:?}");
        }
        assert!(Topic::find("MC_CamInn").expect_err("unknown").contains("did you mean MC_CamIn"));
    }

    #[test]
    fn the_nearest_are_suggested() {
        let said = |text| Topic::find(text).expect_err("unknown");
        assert!(said("629").contains("628 SMC_CI_SCALING_INCORRECT"), "{}", said("629"));
        assert!(said("629").contains("675 SMC_GI_RATIO_DENOM"), "{}", said("629"));
        assert!(said("70000").contains("5001 "), "{}", said("70000"));
        assert!(said("-1").contains("0 SMC_NO_ERROR"), "{}", said("-1"));
        assert!(
            said("SMC_CI_MASTER_OUT_OF_SCAL").contains("did you mean SMC_CI_MASTER_OUT_OF_SCALE")
        );
        assert!(said("ratio_denom").contains("SMC_GI_RATIO_DENOM"), "{}", said("ratio_denom"));
        assert!(said("axis-velocty").contains("did you mean axis-velocity"));
        assert!(said("§").contains("--list"), "{}", said("§"));
    }

    #[test]
    fn the_locale_says_which_language() {
        let of = |name: &'static str, value: &'static str| {
            Texts::of_locale(move |asked| (asked == name).then(|| value.to_owned()))
        };
        assert_eq!(of("LANG", "de_AT.UTF-8"), Texts::De);
        assert_eq!(of("LC_ALL", "fr_FR"), Texts::Fr);
        assert_eq!(of("LANG", "C.UTF-8"), Texts::En);
        assert_eq!(of("LANG", "é"), Texts::En);
    }
}
