//! Options: unknowns and objective.

use crate::cam::tune::Least;
use crate::command::Failure;
use crate::command::cam::number;
use clap::ValueEnum;
use twin_cam::Quantity;

/// Objective.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Minimise {
    /// The slave's error against the --run, root mean square: what a run is fitted by
    Error,
    /// The largest acceleration of the slave
    Acceleration,
    /// The largest jerk of the slave
    Jerk,
}

impl Minimise {
    /// The quantity whose peak it is.
    pub(super) fn quantity(self) -> Option<Quantity> {
        match self {
            Self::Error => None,
            Self::Acceleration => Some(Quantity::Acceleration),
            Self::Jerk => Some(Quantity::Jerk),
        }
    }
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
pub(super) fn intervals(find: &[Sought]) -> [Option<[f64; 2]>; 4] {
    NAMES.map(|(_, what)| find.iter().find(|sought| sought.what == what)?.between)
}

/// Objective, and the constraints of offsets and scalings.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "What is to be smallest")]
pub(super) struct LeastOptions {
    /// The slave's error against a --run (the default with one), or the peak of its acceleration or jerk at the master's motion.
    /// With --ramp-in and --within the peak until the slave is on its cam
    ///
    /// The peak grows with both scalings, and would be 0 with a scaling of 0: intervals of --find and the limits hold them. The
    /// result says which of these does. With a --run the slave's deviation is undone first, by both offsets and what
    /// --find names: from there the peak is made smaller, at the velocity and acceleration that the master has in the run. What the
    /// slave does then is what is wanted of it from now on (`wanted_…`).
    #[arg(long, value_enum)]
    minimise: Option<Minimise>,
}

impl LeastOptions {
    /// The quantity whose peak is to be smallest.
    pub(super) fn quantity(&self) -> Option<Quantity> {
        self.minimise.and_then(Minimise::quantity)
    }

    /// Whether the unknowns change a peak: a scaling does. Offsets that have an interval are to be in it, too.
    fn seeks(find: &[Sought]) -> bool {
        find.iter().any(|sought| match sought.what {
            Find::MasterScaling | Find::SlaveScaling => true,
            Find::MasterOffset | Find::SlaveOffset => sought.between.is_some(),
        })
    }

    /// The peak to minimise; none for the error or nothing.
    pub(super) fn least(&self, find: &[Sought]) -> Option<Least> {
        let quantity = self.quantity().filter(|_| Self::seeks(find))?;
        let anything = [f64::NEG_INFINITY, f64::INFINITY];
        let sought = NAMES.map(|(_, what)| {
            let found = find.iter().find(|sought| sought.what == what)?;
            Some(found.between.unwrap_or(anything))
        });
        Some(Least { quantity, sought })
    }

    /// Refuses options without effect; of a ramp, whether there is one, and whether it has a time.
    pub(super) fn check(
        &self,
        find: &[Sought],
        with_run: bool,
        [ramps, within]: [bool; 2],
    ) -> Result<(), Failure> {
        let has = |what| find.iter().any(|sought| sought.what == what);
        let peak = self.quantity().is_some();
        let scaling = has(Find::MasterScaling) || has(Find::SlaveScaling);
        let offsets_alone = !find.is_empty() && !scaling;
        // A run determines them, and a ramp has a peak of its own.
        let of_ramp = with_run && within;
        let wrong = if self.minimise == Some(Minimise::Error) && !with_run {
            "--minimise error needs a --run, against which the slave has an error"
        } else if find.iter().any(|sought| sought.between.is_some()) && !(peak || with_run) {
            "an interval of --find is for --minimise acceleration and jerk, or for a --run"
        } else if peak && find.is_empty() && !within {
            "--minimise acceleration and jerk need what to --find, or a --ramp-in with --within: a ramp without it is as short as the limits allow"
        } else if peak && ramps && !within {
            "--ramp-in without --within is as short as the limits allow and minimises nothing"
        } else if peak && offsets_alone && !of_ramp {
            "offsets alone change no peak: --find a scaling"
        } else if !peak && !with_run && has(Find::MasterOffset) {
            "no limit depends on MasterOffset: a --run determines it"
        } else {
            return Ok(());
        };
        Err(Failure::Usage(wrong.to_owned()))
    }
}
