//! Report of switch points of the path.

use twin_machine::switch_points::SwitchPoints;
use twin_number::{rounded, seconds};

/// Switchings of the path's switches (H words) in the order of time.
#[derive(Clone, Debug, serde::Serialize)]
pub(super) struct SwitchPointsReport {
    switches: Vec<SwitchPointReport>,
    /// How many there are more.
    switches_left_out: u64,
}

#[derive(Clone, Debug, serde::Serialize)]
struct SwitchPointReport {
    h: u8,
    on: bool,
    time_s: f64,
    line: u32,
    block: Option<u32>,
}

impl SwitchPointsReport {
    /// None if nothing is switched.
    pub(crate) fn new(points: &SwitchPoints) -> Option<Self> {
        let switches: Vec<_> = points
            .first()
            .iter()
            .map(|one| SwitchPointReport {
                h: one.number,
                on: one.on,
                time_s: rounded(seconds(one.time_ns)),
                line: one.place.line,
                block: one.place.block,
            })
            .collect();
        let switches_left_out = points.left_out();
        (!switches.is_empty()).then_some(Self { switches, switches_left_out })
    }
}
