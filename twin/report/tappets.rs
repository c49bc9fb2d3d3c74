//! Report of tappet switchings.

use twin_machine::tappets::{MasterPlace, Switched, TappetSwitch};
use twin_number::{rounded, seconds};

/// Tappet switchings of all slaves and groups.
#[derive(Clone, Debug, serde::Serialize)]
pub(super) struct TappetsReport {
    /// Every group of every slave.
    signals: Vec<SignalReport>,
    /// In the order of time.
    switches: Vec<SwitchReport>,
    /// How many there are more.
    switches_left_out: u64,
    /// Tappets that did not act because there were too many in a cycle.
    lost: u64,
}

#[derive(Clone, Debug, serde::Serialize)]
struct SignalReport {
    axis: String,
    group: i16,
    switched: u64,
}

#[derive(Clone, Debug, serde::Serialize)]
struct SwitchReport {
    axis: String,
    group: i16,
    on: bool,
    time_s: f64,
    line: u32,
    block: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    master: Option<MasterReport>,
}

#[derive(Clone, Debug, serde::Serialize)]
struct MasterReport {
    axis: String,
    position: f64,
    unit: &'static str,
}

impl TappetsReport {
    /// None if there are no tappets.
    pub(crate) fn new(switched: &Switched) -> Option<Self> {
        if switched.signals.is_empty() {
            return None;
        }
        let counts = switched.counts.iter().copied().chain(std::iter::repeat(0));
        let signals = switched.signals.iter().zip(counts).map(|(signal, switched)| {
            let (axis, group) = (signal.axis.clone(), signal.group);
            SignalReport { axis, group, switched }
        });
        let switches = switched.switches.iter().filter_map(|one| {
            let TappetSwitch { signal, on, time_ns, place, master } = one;
            let signal = switched.signals.get(*signal)?;
            let master = master.as_ref().map(|master| {
                let MasterPlace { axis, position, unit } = master;
                MasterReport { axis: axis.clone(), position: rounded(*position), unit }
            });
            let (axis, group) = (signal.axis.clone(), signal.group);
            let (line, block) = (place.line, place.block);
            let time_s = seconds(*time_ns);
            Some(SwitchReport { axis, group, on: *on, time_s, line, block, master })
        });
        Some(Self {
            signals: signals.collect(),
            switches: switches.collect(),
            switches_left_out: switched.left_out,
            lost: switched.lost,
        })
    }
}
