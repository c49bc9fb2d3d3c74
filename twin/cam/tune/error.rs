//! Errors of cam tuning.

use super::dead_time::SwitchingPart;
use twin_cam::CamError;
use twin_cam::tune::{ConstraintError, FitError, RampError};
use twin_number::significant;

/// Why something is not tuned. Positions and velocities are in the units of the axes, times (`…_s`) in seconds, lines those of the run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum TuneError {
    #[error("offsets and scalings: {}{}", .0, meant(.0))]
    Fit(#[source] FitError),
    #[error("offsets and scalings: the slave is far from where the other samples have it in {}",
        all(.outliers, |(line, by)| format!("line {line} (by {})", significant(*by, 4))))]
    Outliers { outliers: Vec<(u64, f64)> },
    #[error(
        "offsets and scalings: residuals of {} {unit} rms remain and are not noise (correlation from sample to sample {}): \
         the slave does something that the cam does not describe, so no interval would be valid; the nearest fit, {nearest}, is \
         not proposed. Check that the run is of this cam and this coupling",
        significant(*.rms, 4), significant(*.correlation, 3)
    )]
    NoNoise { correlation: f64, rms: f64, unit: String, nearest: String },
    #[error(
        "offsets and scalings: the slave makes {} of the stroke that is wanted (SlaveScaling {}): is it recorded in other units than \
         the cam's? If that is its scaling, --find slave-scaling=FROM..TO says so",
        significant(*.strokes, 4), significant(*.scaling, 4)
    )]
    Stroke { scaling: f64, strokes: f64 },
    #[error(
        "dead time of the tappets: {found} switching{} too few for a dead time: {needed} are needed",
        if *.found == 1 { " is" } else { "s are" }
    )]
    FewSwitchings { found: usize, needed: usize },
    #[error(
        "dead time of the tappets: the output of line {line} switches {} s behind its tappet, the others about {} s: \
         something else switched it, or it is not this cam's",
        significant(*.behind_s, 4), significant(*.usual_s, 4)
    )]
    Outlier { line: u64, behind_s: f64, usual_s: f64 },
    #[error(
        "dead time of the tappets: the {count} switchings of group {group} scatter by {} s, and the master passes such a tappet \
         every {} s: an output that switches at random looks the same. Check that this cam alone switches it, or record more \
         samples per second",
        significant(*.scatter_s, 4), significant(*.every_s, 4)
    )]
    Scattered { group: i16, count: f64, scatter_s: f64, every_s: f64 },
    #[error(
        "dead time of the tappets: the output switches {} ± {} s before its tappets, and a dead time cannot be negative: it is \
         inverted, or not this cam's, or more was compensated than `dead_time_s` says",
        significant(-.value_s, 4), significant(*.half_width_s, 4)
    )]
    Early { value_s: f64, half_width_s: f64 },
    #[error(
        "dead time of the tappets: the output switches {} s behind its tappets, and the master comes to such a tappet every {} s: \
         several tappets may have switched it, or it is inverted",
        significant(*.value_s, 4), significant(*.every_s, 4)
    )]
    Late { value_s: f64, every_s: f64 },
    #[error(
        "dead time of the tappets: the run has outputs of group {group} (`tappet_{group}`), and the cam has no tappet of this \
         group; {}",
        groups(.has)
    )]
    NoGroup { group: i16, has: Vec<i16> },
    #[error("dead time of the tappets: {one}, {other}: a dead time cannot be both")]
    TwoDeadTimes { one: SwitchingPart, other: SwitchingPart },
    #[error("the smallest peak: {0}")]
    Minimise(#[source] ConstraintError),
    #[error("ramp: {0}")]
    Ramp(#[from] RampError),
    #[error(
        "the tappet of group {group} at {} of the cam must move to {}, so that the master still passes it at {}; but the cam is \
         not periodic and goes from {} to {}: lengthen the cam, or remove the tappet",
        significant(*.at, 6), significant(*.to, 6), significant(*.master, 6), significant(.range[0], 6),
        significant(.range[1], 6)
    )]
    TappetBeyond { group: i16, at: f64, master: f64, to: f64, range: [f64; 2] },
    #[error(
        "the tappets of group {group} at {} and {} of the cam, its begin and its end, would both be at {} so that the master \
         passes them where it did, and there they have no order: leave one of them out",
        significant(.places[0], 6), significant(.places[1], 6), significant(*.to, 6)
    )]
    TappetsMeet { group: i16, places: [f64; 2], to: f64 },
    #[error("tappets: {0}")]
    Cam(#[source] CamError),
    #[error("no {what} keeps the limits: {why}")]
    NoRoom { what: &'static str, why: String },
}

impl TuneError {
    /// Whether the call is at fault, not cam or data: a limit is not given that is needed.
    pub(crate) fn is_of_call(&self) -> bool {
        matches!(self, Self::Ramp(RampError::NoLimit { .. } | RampError::Steps))
    }
}

fn all<T>(items: &[T], said: impl Fn(&T) -> String) -> String {
    items.iter().map(said).collect::<Vec<_>>().join(", ")
}

/// The option that decides between answers that fit alike.
fn meant(error: &FitError) -> String {
    let FitError::Ambiguous { unknown, .. } = error else { return String::new() };
    let name = if *unknown == "MasterScaling" { "master-scaling" } else { "master-offset" };
    format!(": --find {name}=FROM..TO says which of them is meant")
}

fn groups(has: &[i16]) -> String {
    match has {
        [] => "it has none at all".to_owned(),
        [one] => format!("its tappets are of group {one}"),
        more => format!("its tappets are of the groups {}", all(more, ToString::to_string)),
    }
}
