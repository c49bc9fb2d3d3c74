//! Errors of the dead-time estimate: why the outputs of a run do not determine the dead time of tappets.

use super::from_run::Seen;
use std::fmt;
use twin_number::significant;

/// A part of the switchings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Those of a group.
    Group(i16),
    /// Of a group those that switch on.
    On(i16),
    /// Of a group those that switch off.
    Off(i16),
    /// Those of the first half of the run.
    First,
    /// Those of the second half.
    Second,
    /// The earlier heap.
    Early,
    /// The later heap.
    Late,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Group(group) => write!(f, "group {group} switches"),
            Self::On(group) => write!(f, "group {group} switches on"),
            Self::Off(group) => write!(f, "group {group} switches off"),
            Self::First => write!(f, "in the first half of the run outputs switch"),
            Self::Second => write!(f, "in the second half they switch"),
            Self::Early => write!(f, "some outputs switch"),
            Self::Late => write!(f, "others switch"),
        }
    }
}

/// What a part of the switchings tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwitchingPart {
    /// Which.
    pub which: Part,
    /// How many.
    pub count: f64,
    /// How long behind the tappets they are, the mean, s.
    pub mean_s: f64,
    /// Squares of what they are beside it, all together, s².
    pub square: f64,
    /// How far samples may have shifted the mean, s.
    pub within_s: f64,
}

impl SwitchingPart {
    pub(super) fn new(which: Part, seen: &[&Seen]) -> Self {
        let sum = |of: &dyn Fn(&Seen) -> f64| seen.iter().map(|seen| of(seen)).sum::<f64>();
        let count = sum(&|_| 1.0);
        let mean_s = sum(&|seen| seen.behind_s) / count.max(1.0);
        let square = sum(&|seen| (seen.behind_s - mean_s).powi(2));
        let within_s = sum(&|seen| seen.within_s) / count.max(1.0);
        Self { which, count, mean_s, square, within_s }
    }
}

impl fmt::Display for SwitchingPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { which, count, mean_s, .. } = self;
        let plural = if *count > 1.0 { "switchings" } else { "switching" };
        write!(f, "{which} {} s behind its tappets ({count} {plural})", significant(*mean_s, 4))
    }
}

/// Outputs that the tappets cannot have switched so.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutputError {
    /// The cam has no such group.
    #[error(
        "the run has outputs of group {group} (`tappet_{group}`), and the cam has no tappet of this group; {}",
        groups(.has)
    )]
    NoGroup {
        /// That of the run.
        group: i16,
        /// Those of the cam.
        has: Vec<i16>,
    },
    /// Two parts have different dead times.
    #[error("{one}, {other}: no dead time is both")]
    Contradictory {
        /// One part.
        one: SwitchingPart,
        /// The other one.
        other: SwitchingPart,
    },
    /// Switchings that are anywhere between tappets.
    #[error(
        "the output of group {group} switches {count} times, from {} s to {} s behind its tappets, and the master comes to such \
         a tappet every {} s: so do outputs that switch at random; something else switches it, or it is not this cam's, or these \
         are too few",
        significant(.ends[0], 4), significant(.ends[1], 4), significant(*.every_s, 4)
    )]
    Random {
        /// Its group.
        group: i16,
        /// How many were seen.
        count: usize,
        /// The earliest and the latest, s.
        ends: [f64; 2],
        /// s.
        every_s: f64,
    },
}

fn groups(has: &[i16]) -> String {
    match has {
        [] => "it has none at all".to_owned(),
        [one] => format!("its tappets are of group {one}"),
        more => {
            let all: Vec<_> = more.iter().map(ToString::to_string).collect();
            format!("its tappets are of the groups {}", all.join(", "))
        }
    }
}
