//! Options: unknowns and objective.

use crate::cam::tune::{ANYTHING, Intervals};
use crate::command::Failure;
use crate::command::cam::number;
use clap::ValueEnum;
use twin_cam::Quantity;

/// Quantity of the slave whose peak is minimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Minimise {
    /// The largest acceleration of the slave
    Acceleration,
    /// The largest jerk of the slave
    Jerk,
}

/// An offset or a scaling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Find {
    MasterOffset,
    MasterScaling,
    SlaveOffset,
    SlaveScaling,
}

/// Their names, in the order of the inputs.
const NAMES: [(&str, Find); 4] = [
    ("master-offset", Find::MasterOffset),
    ("master-scaling", Find::MasterScaling),
    ("slave-offset", Find::SlaveOffset),
    ("slave-scaling", Find::SlaveScaling),
];

/// An unknown and its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sought {
    pub(super) what: Find,
    pub(super) between: Option<[f64; 2]>,
}

pub(super) fn sought(text: &str) -> Result<Sought, String> {
    let (name, interval) = match text.split_once('=') {
        Some((name, interval)) => (name, Some(interval)),
        None => (text, None),
    };
    let what = NAMES.into_iter().find(|(known, _)| *known == name.trim()).ok_or_else(|| {
        let names = NAMES.map(|(name, _)| name).join(", ");
        format!("`{name}` is none of {names}")
    })?;
    let between = interval.map(|interval| {
        let (low, high) = interval.split_once("..").ok_or_else(|| {
            format!("`{interval}` is not an interval; expected FROM..TO, like 0.9..1.1")
        })?;
        let [low, high] = [number(low)?, number(high)?];
        if low > high { Err(format!("{low} is more than {high}")) } else { Ok([low, high]) }
    });
    Ok(Sought { what: what.1, between: between.transpose()? })
}

/// Intervals of the unknowns, in the order of the inputs.
pub(super) fn intervals(find: &[Sought]) -> Intervals {
    NAMES.map(|(_, what)| find.iter().find(|sought| sought.what == what)?.between)
}

/// The same, of unknowns without an interval everything.
pub(super) fn sought_within(find: &[Sought]) -> Intervals {
    NAMES.map(|(_, what)| {
        let found = find.iter().find(|sought| sought.what == what)?;
        Some(found.between.unwrap_or(ANYTHING))
    })
}

/// Objective: the peak to minimise.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Smallest peak")]
pub(super) struct LeastOptions {
    /// Make the slave's peak acceleration or jerk smallest, at the master's motion: with --find that of the cam, with --ramp-in and
    /// --within that of the start
    ///
    /// The peak grows with both scalings, and would be 0 with a scaling of 0: intervals of --find and the limits hold them. The
    /// result says which of these does.
    #[arg(long, value_enum, conflicts_with = "run")]
    minimise: Option<Minimise>,
}

impl LeastOptions {
    /// The quantity whose peak is to be smallest.
    pub(super) fn quantity(&self) -> Option<Quantity> {
        self.minimise.map(|minimise| match minimise {
            Minimise::Acceleration => Quantity::Acceleration,
            Minimise::Jerk => Quantity::Jerk,
        })
    }

    /// Refuses options without effect; of a ramp, whether there is one, and whether it has a time.
    pub(super) fn check(
        &self,
        find: &[Sought],
        with_run: bool,
        [ramps, within]: [bool; 2],
    ) -> Result<(), Failure> {
        let has = |what| find.iter().any(|sought| sought.what == what);
        let peak = self.minimise.is_some();
        let scaling = has(Find::MasterScaling) || has(Find::SlaveScaling);
        let twice = |one: &Sought| find.iter().filter(|other| other.what == one.what).count() > 1;
        let wrong = if find.iter().any(twice) {
            "--find names a value twice"
        } else if peak && ramps && !within {
            "--ramp-in without --within is as short as the limits allow and minimises nothing"
        } else if peak && !ramps && !scaling {
            "offsets alone change no peak: --find a scaling"
        } else if !peak && !with_run && has(Find::MasterOffset) {
            "no limit depends on MasterOffset: a --run determines it"
        } else {
            return Ok(());
        };
        Err(Failure::Usage(wrong.to_owned()))
    }
}
