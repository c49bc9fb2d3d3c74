//! Words that every emulated device obeys: what goes wrong with its wire or bus, and when.

use super::control::{Switch, one_of, understood};
use clap::ValueEnum;
use twin_drives::{Control, Direction, FaultRule, When, WireFault};

const DIRECTIONS: [(&str, Direction); 2] =
    [("request", Direction::Request), ("answer", Direction::Answer)];

/// What all devices obey.
#[derive(Debug, clap::Subcommand)]
pub(super) enum WireWord {
    /// Requests or answers suffer from now on: drop, delay MS, corrupt BYTES, lose BYTES, double BYTES, truncate KEEP,
    /// duplicate, reorder, wrong-check, noise BYTES, refuse CODE, echo (these two only of requests). On the bus of a BIM2AX a request is what
    /// the host writes for one interrupt, and an answer what the module shows after it: nothing is lost or doubled
    /// byte by byte, there is no wrong-check, noise or echo,
    /// and no answer comes twice
    Fault {
        #[arg(value_parser = one_of(&DIRECTIONS))]
        direction: Direction,
        #[arg(value_enum)]
        fault: FaultWord,
        /// What it takes
        #[arg(default_value_t = 1, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..))]
        value: u32,
        /// Only the next so many
        #[arg(long, group = "when", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..))]
        next: Option<u32>,
        /// Only the one after this number of unharmed ones
        #[arg(long, group = "when", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..))]
        after: Option<u32>,
        /// Every so-many-th
        #[arg(long, group = "when", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..))]
        every: Option<u32>,
        /// At random: this number in a million
        #[arg(long, group = "when", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..))]
        per_million: Option<u32>,
    },
    /// The wire is good again, and nothing is due any more
    NoFaults,
    /// The plug is pulled (off) or put back (on)
    Plug {
        #[arg(value_enum)]
        state: Switch,
    },
    /// Carry out another word after this number of further requests, just before the last of them is carried out
    After {
        #[arg(allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..))]
        requests: u32,
        #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true)]
        words: Vec<String>,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum FaultWord {
    Drop,
    Delay,
    Corrupt,
    Lose,
    Double,
    Truncate,
    Duplicate,
    Reorder,
    WrongCheck,
    Noise,
    Refuse,
    Echo,
}

/// What a device hangs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Carrier {
    /// Bytes of frames.
    Wire,
    /// A memory, which has neither frames nor check sums.
    Bus,
}

impl Carrier {
    /// What can befall what goes this way.
    const fn faults(self, direction: Direction) -> &'static [FaultWord] {
        use FaultWord::{
            Corrupt, Delay, Double, Drop, Duplicate, Echo, Lose, Noise, Refuse, Reorder, Truncate,
            WrongCheck,
        };
        match (self, direction) {
            (Self::Wire, Direction::Request) => &[
                Drop, Delay, Corrupt, Lose, Double, Truncate, Duplicate, Reorder, WrongCheck,
                Noise, Refuse, Echo,
            ],
            (Self::Wire, Direction::Answer) => &[
                Drop, Delay, Corrupt, Lose, Double, Truncate, Duplicate, Reorder, WrongCheck, Noise,
            ],
            (Self::Bus, Direction::Request) => {
                &[Drop, Delay, Corrupt, Truncate, Duplicate, Reorder, Refuse]
            }
            (Self::Bus, Direction::Answer) => &[Drop, Delay, Corrupt, Truncate, Reorder],
        }
    }

    /// # Errors
    /// If nothing of the kind can befall what goes this way, with what can.
    fn check(self, direction: Direction, fault: FaultWord) -> Result<(), String> {
        let known = self.faults(direction);
        if known.contains(&fault) {
            return Ok(());
        }
        let name = |fault: &FaultWord| {
            fault.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
        };
        let way = match direction {
            Direction::Request => "request",
            Direction::Answer => "answer",
        };
        let known: Vec<_> = known.iter().map(name).collect();
        Err(format!("no {way} can {}: there are {}", name(&fault), known.join(", ")))
    }
}

impl FaultWord {
    fn fault(self, value: u32) -> Result<WireFault, String> {
        let count = usize::try_from(value).unwrap_or(usize::MAX);
        Ok(match self {
            Self::Drop => WireFault::Drop,
            Self::Delay => WireFault::Delay { ns: i64::from(value) * 1_000_000 },
            Self::Corrupt => WireFault::Corrupt { bytes: count },
            Self::Lose => WireFault::Lose { bytes: count },
            Self::Double => WireFault::Double { bytes: count },
            Self::Truncate => WireFault::Truncate { keep: count },
            Self::Duplicate => WireFault::Duplicate,
            Self::Reorder => WireFault::Reorder,
            Self::WrongCheck => WireFault::WrongCheck,
            Self::Noise => WireFault::Noise { bytes: count },
            Self::Refuse => WireFault::Refuse {
                code: u8::try_from(value).map_err(|_beyond| format!("no code {value}"))?,
            },
            Self::Echo => WireFault::Echo,
        })
    }
}

impl WireWord {
    /// What it does. `obey` knows what the words after `after` do.
    ///
    /// # Errors
    /// What is wrong with the words, or help about them.
    pub(super) fn control<E>(
        self,
        carrier: Carrier,
        obey: impl FnOnce(&[&str]) -> Result<Control<E>, Said>,
    ) -> Result<Control<E>, Said> {
        Ok(match self {
            Self::Fault { direction, fault, value, next, after, every, per_million } => {
                let when = next.map(When::Next).or(after.map(When::After));
                let when = when.or(every.map(When::Every)).or(per_million.map(When::PerMillion));
                carrier.check(direction, fault).map_err(Err)?;
                let fault = fault.fault(value).map_err(Err)?;
                Control::Fault(FaultRule { direction, when: when.unwrap_or(When::Always), fault })
            }
            Self::NoFaults => Control::NoFaults,
            Self::Plug { state } => Control::Disconnect(!state.is_on()),
            Self::After { requests, words } => {
                let words: Vec<&str> = words.iter().map(String::as_str).collect();
                obey(&words)?.after(requests)
            }
        })
    }
}

/// What is said instead of obeying: help, or what is wrong.
pub(super) type Said = Result<String, String>;

/// Understands words of a family: `own` are those of its devices.
///
/// # Errors
/// What is wrong with the words, or help about them.
pub(super) fn control<T: clap::Parser, E>(
    words: &[&str],
    own: impl FnOnce(T) -> Result<Control<E>, Said>,
) -> Result<Control<E>, Said> {
    own(understood::<T>(words)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A family whose only device can ring.
    #[derive(clap::Parser)]
    #[command(no_binary_name = true, disable_help_flag = true)]
    enum Word {
        Ring,
        #[command(flatten)]
        Wire(WireWord),
    }

    fn parsed(line: &str) -> Result<Control<()>, Said> {
        let words: Vec<&str> = line.split_whitespace().collect();
        obeyed(&words)
    }

    fn obeyed(words: &[&str]) -> Result<Control<()>, Said> {
        control(words, |word| match word {
            Word::Ring => Ok(Control::Event(())),
            Word::Wire(wire) => wire.control(Carrier::Wire, obeyed),
        })
    }

    #[test]
    fn every_fault_can_be_said() {
        let rule =
            |direction, when, fault| Ok(Control::Fault(FaultRule { direction, when, fault }));
        for (line, expected) in [
            ("fault request drop", rule(Direction::Request, When::Always, WireFault::Drop)),
            (
                "fault answer delay 20 --next 3",
                rule(Direction::Answer, When::Next(3), WireFault::Delay { ns: 20_000_000 }),
            ),
            (
                "fault answer corrupt --every 5",
                rule(Direction::Answer, When::Every(5), WireFault::Corrupt { bytes: 1 }),
            ),
            (
                "fault request refuse 3 --after 2",
                rule(Direction::Request, When::After(2), WireFault::Refuse { code: 3 }),
            ),
            (
                "fault answer wrong-check --per-million 1000",
                rule(Direction::Answer, When::PerMillion(1000), WireFault::WrongCheck),
            ),
            ("no-faults", Ok(Control::NoFaults)),
            ("plug off", Ok(Control::Disconnect(true))),
            ("ring", Ok(Control::Event(()))),
            ("after 7 ring", Ok(Control::Event(()).after(7))),
            ("after 7 after 2 plug off", Ok(Control::Disconnect(true).after(2).after(7))),
        ] {
            assert_eq!(parsed(line), expected, "{line}");
        }
        let said = parsed("after 7 fault answer drop --next 1");
        assert!(matches!(said, Ok(Control::After { requests: 7, .. })), "{said:?}");
    }

    #[test]
    fn what_would_do_nothing_is_refused_with_what_there_is() {
        let refused = parsed("fault answer refuse 4");
        let Err(Err(why)) = &refused else { panic!("{refused:?}") };
        assert_eq!(
            why,
            "no answer can refuse: there are drop, delay, corrupt, lose, double, truncate, duplicate, reorder, wrong-check, noise"
        );
        assert!(matches!(parsed("fault answer echo"), Err(Err(_))));
        // A memory has no check sums, and shows a number once.
        let on_bus = |direction| {
            [FaultWord::WrongCheck, FaultWord::Noise, FaultWord::Echo]
                .map(|fault| Carrier::Bus.check(direction, fault).is_err())
        };
        assert_eq!((on_bus(Direction::Request), on_bus(Direction::Answer)), ([true; 3], [true; 3]));
        assert!(Carrier::Bus.check(Direction::Answer, FaultWord::Duplicate).is_err());
        assert!(Carrier::Bus.check(Direction::Request, FaultWord::Duplicate).is_ok());
    }

    #[test]
    fn nonsense_is_named_and_help_is_no_error() {
        for (line, word) in [
            ("fault request refuse 300", "300"),
            ("fault request melt", "melt"),
            ("after 3 dance", "dance"),
            ("fault request drop --next 1 --every 2", "--every"),
        ] {
            let said = parsed(line);
            assert!(matches!(&said, Err(Err(why)) if why.contains(word)), "{line}: {said:?}");
        }
        assert!(matches!(parsed("help"), Err(Ok(text)) if text.contains("no-faults")));
        let help = parsed("help fault");
        assert!(matches!(&help, Err(Ok(text)) if text.contains("--per-million")), "{help:?}");
    }
}
