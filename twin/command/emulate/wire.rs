//! What can happen to what a device hangs on: the same words for every family.

use super::control::Switch;
use twin_drives::{Control, Direction, FaultRule, When, WireFault};

/// Told at the end of `help`.
pub(super) const LATER: &str = "after N and any of these words: it happens when N more requests have come, just before the last \
                                of them is carried out";

/// What can happen to the wire, or to the bus of a module.
#[derive(Debug, clap::Subcommand)]
pub(super) enum WireWord {
    /// The plug is pulled (off) or put back (on)
    Plug {
        #[arg(value_enum)]
        state: Switch,
    },
    /// Something befalls what comes from the master (request) or goes to it (answer)
    Fault {
        #[arg(value_enum)]
        direction: DirectionWord,
        #[arg(value_enum)]
        fault: FaultWord,
        /// What it takes: ms, bytes or the code of a refusal
        #[arg(default_value_t = 1)]
        value: u32,
        #[command(flatten)]
        when: WhenWords,
    },
    /// The wire is good again, and nothing is put off any more
    NoFaults,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum DirectionWord {
    Request,
    Answer,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum FaultWord {
    /// It does not arrive
    Drop,
    /// It arrives VALUE ms later
    Delay,
    /// VALUE of its bytes are others
    Corrupt,
    /// Only its first VALUE bytes arrive
    Truncate,
    /// It arrives twice
    Duplicate,
    /// Two of its bytes change places
    Reorder,
    /// Its check sum is wrong
    WrongCheck,
    /// VALUE bytes of noise come before it
    Noise,
    /// The device refuses it with the code VALUE
    Refuse,
    /// The master hears what it sends
    Echo,
}

/// Which frames; all without one of them.
#[derive(Clone, Copy, Debug, clap::Args)]
#[group(multiple = false)]
pub(super) struct WhenWords {
    /// Only the next N frames
    #[arg(long, value_name = "N")]
    next: Option<u32>,
    /// Only the one behind N frames that pass unharmed
    #[arg(long, value_name = "N")]
    behind: Option<u32>,
    /// Every N-th frame
    #[arg(long, value_name = "N")]
    every: Option<u32>,
    /// N frames of a million, by chance
    #[arg(long, value_name = "N")]
    per_million: Option<u32>,
}

impl WhenWords {
    fn when(self) -> When {
        let next = self.next.map(When::Next);
        let behind = self.behind.map(When::After);
        let every = self.every.map(When::Every);
        let chance = self.per_million.map(When::PerMillion);
        next.or(behind).or(every).or(chance).unwrap_or(When::Always)
    }
}

impl WireWord {
    /// What it does.
    ///
    /// # Errors
    /// If the value is none for this fault.
    pub(super) fn control<E>(self) -> Result<Control<E>, String> {
        Ok(match self {
            Self::Plug { state } => Control::Disconnect(!state.is_on()),
            Self::NoFaults => Control::NoFaults,
            Self::Fault { direction, fault, value, when } => {
                let direction = match direction {
                    DirectionWord::Request => Direction::Request,
                    DirectionWord::Answer => Direction::Answer,
                };
                let (fault, when) = (fault.of(value)?, when.when());
                Control::Fault(FaultRule { direction, when, fault })
            }
        })
    }
}

impl FaultWord {
    fn of(self, value: u32) -> Result<WireFault, String> {
        let count = usize::try_from(value).unwrap_or(usize::MAX);
        Ok(match self {
            Self::Drop => WireFault::Drop,
            Self::Delay => WireFault::Delay { ns: nanoseconds(value) },
            Self::Corrupt => WireFault::Corrupt { bytes: count },
            Self::Truncate => WireFault::Truncate { keep: count },
            Self::Duplicate => WireFault::Duplicate,
            Self::Reorder => WireFault::Reorder,
            Self::WrongCheck => WireFault::WrongCheck,
            Self::Noise => WireFault::Noise { bytes: count },
            Self::Refuse => WireFault::Refuse {
                code: u8::try_from(value)
                    .map_err(|_beyond| format!("refuse {value}: codes go from 0 to 255"))?,
            },
            Self::Echo => WireFault::Echo,
        })
    }
}

/// Milliseconds as nanoseconds.
pub(super) fn nanoseconds(ms: u32) -> i64 {
    i64::from(ms) * 1_000_000
}

/// How many requests later the rest of a line is to happen.
///
/// # Errors
/// If there is no number behind `after`.
pub(super) fn put_off<'a, 'b>(words: &'a [&'b str]) -> Result<(u32, &'a [&'b str]), String> {
    match words {
        ["after", count, rest @ ..] => match count.parse() {
            Ok(count) => Ok((count, rest)),
            Err(_) => Err(format!("after {count}: a number of requests comes behind `after`")),
        },
        ["after"] => Err("a number of requests comes behind `after`".to_owned()),
        all => Ok((0, all)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, clap::Parser)]
    #[command(no_binary_name = true)]
    struct Line {
        #[command(subcommand)]
        word: WireWord,
    }

    fn control(line: &str) -> Result<Control<()>, String> {
        let words: Vec<_> = line.split(' ').collect();
        let line = Line::try_parse_from(words).map_err(|error| error.to_string())?;
        line.word.control()
    }

    #[test]
    fn words_are_what_the_wire_knows() {
        use {Direction::Answer, Direction::Request};
        let rule =
            |direction, when, fault| Ok(Control::Fault(FaultRule { direction, when, fault }));
        let (next, every) = (When::Next(2), When::Every(10));
        for (line, expected) in [
            ("plug off", Ok(Control::Disconnect(true))),
            ("plug on", Ok(Control::Disconnect(false))),
            ("no-faults", Ok(Control::NoFaults)),
            ("fault request drop", rule(Request, When::Always, WireFault::Drop)),
            (
                "fault answer delay 20 --next 2",
                rule(Answer, next, WireFault::Delay { ns: 20_000_000 }),
            ),
            (
                "fault answer corrupt 3 --every 10",
                rule(Answer, every, WireFault::Corrupt { bytes: 3 }),
            ),
            (
                "fault request truncate 4 --behind 7",
                rule(Request, When::After(7), WireFault::Truncate { keep: 4 }),
            ),
            (
                "fault answer duplicate --per-million 5",
                rule(Answer, When::PerMillion(5), WireFault::Duplicate),
            ),
            ("fault answer wrong-check", rule(Answer, When::Always, WireFault::WrongCheck)),
            ("fault request refuse 6", rule(Request, When::Always, WireFault::Refuse { code: 6 })),
            ("fault request echo", rule(Request, When::Always, WireFault::Echo)),
            ("fault answer noise 9", rule(Answer, When::Always, WireFault::Noise { bytes: 9 })),
            ("fault answer reorder", rule(Answer, When::Always, WireFault::Reorder)),
        ] {
            assert_eq!(control(line), expected, "{line}");
        }
        for line in [
            "fault request refuse 256",
            "fault sideways drop",
            "fault answer drop --next 1 --every 2",
        ] {
            assert!(control(line).is_err(), "{line}");
        }
    }

    #[test]
    fn words_are_put_off() {
        assert_eq!(put_off(&["after", "3", "plug", "off"]), Ok((3, ["plug", "off"].as_slice())));
        assert_eq!(put_off(&["plug", "off"]), Ok((0, ["plug", "off"].as_slice())));
        assert!(put_off(&["after"]).is_err());
        assert!(put_off(&["after", "plug", "off"]).is_err());
    }
}
