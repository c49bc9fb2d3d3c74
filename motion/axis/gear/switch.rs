//! `MC_DigitalCamSwitch`: outputs that an axis switches at its positions.

use super::track::{CamSwitch, Track};
use crate::Axis;
use crate::gear::cam_switch_track::{Ahead, Switched};
use twin_cam::Unwrap;

/// Outputs, at most.
const TRACKS: usize = 32;

/// Least move of a zero, u.
const SAME: f64 = 1e-9;

/// Position that switches the outputs (`MC_TappetMode`).
#[doc(alias = "MC_TappetMode")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TappetMode {
    /// `tp_mode_auto`: the set position if the axis is powered, else the actual one.
    #[default]
    Auto,
    /// `tp_mode_demandposition`.
    Demand,
    /// `tp_mode_actualposition`.
    Actual,
}

/// Outputs of [`DigitalCamSwitch`].
#[doc(alias = "MC_OUTPUT_REF")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SwitchOutputs {
    /// `Outputs`.
    pub outputs: [bool; TRACKS],
    /// `InOperation`.
    pub in_operation: bool,
}

/// Outputs that an axis switches at its positions, as a mechanical cam would (`MC_DigitalCamSwitch`, manual 5.5).
///
/// Several switches of a track are one output: it is on if one of them is. An axis at rest counts in the direction of its
/// last motion. Enabling the block passes nothing: the outputs show the present position at once.
#[doc(alias = "MC_DigitalCamSwitch")]
#[derive(Clone, Debug)]
pub struct DigitalCamSwitch {
    switches: Vec<Switched>,
    tracks: [Track; TRACKS],
    /// `EnableMasks`: a bit for each output, the lowest for output 0.
    pub enable_mask: u32,
    /// `TappetMode`.
    pub mode: TappetMode,
    seen: Option<Seen>,
}

/// The axis as it was seen last.
#[derive(Clone, Debug)]
struct Seen {
    unwrap: Unwrap,
    /// Shift of its zero, u: moving the zero passes nothing.
    zero: f64,
    /// True for the set position, false for the actual one.
    demand: bool,
    now_ns: i64,
}

impl DigitalCamSwitch {
    /// These switches, every output enabled.
    #[must_use]
    pub fn new(switches: &[CamSwitch], tracks: [Track; TRACKS]) -> Self {
        Self {
            switches: switches.iter().map(|switch| Switched::new(*switch)).collect(),
            tracks,
            enable_mask: u32::MAX,
            mode: TappetMode::Auto,
            seen: None,
        }
    }

    /// Calls it, for a cycle, with Enable and its axis. Delays and durations count by the axis's clock
    /// ([`Axis::now_ns`]).
    pub fn call(&mut self, enable: bool, axis: &Axis) -> SwitchOutputs {
        if !enable {
            self.seen = None;
            self.switches.iter_mut().for_each(Switched::disable);
            return SwitchOutputs::default();
        }
        let demand = match self.mode {
            TappetMode::Auto => axis.is_powered(),
            TappetMode::Demand => true,
            TappetMode::Actual => false,
        };
        let (position, velocity) = if demand {
            (axis.set_position(), axis.set_velocity())
        } else {
            (axis.act_position(), axis.act_velocity())
        };
        let (period, now_ns, zero) = (axis.period(), axis.now_ns(), axis.zero);
        let moved = |seen: &Seen| {
            let by = zero - seen.zero;
            let by = period.map_or(by, |period| by - period * (by / period).round());
            by.abs() > SAME || seen.demand != demand
        };
        let goes_on = self.seen.take().filter(|seen| !moved(seen));
        let begins = goes_on.is_none();
        let unwrap = Unwrap::new(period, position);
        let mut seen = goes_on.unwrap_or(Seen { unwrap, zero, demand, now_ns });
        let at = Ahead {
            position: seen.unwrap.follow(position),
            velocity,
            went_forwards: !axis.was_negative(),
            period,
            begins,
            from_ns: seen.now_ns,
            now_ns,
        };
        self.seen = Some(Seen { zero, now_ns, ..seen });
        let mut outputs = [false; TRACKS];
        for switched in &mut self.switches {
            let number = switched.track();
            let index = usize::from(number).wrapping_sub(1);
            let Some(track) = self.tracks.get(index) else { continue };
            let on = switched.advance(&at, track);
            let enabled = u32::from(number)
                .checked_sub(1)
                .and_then(|bit| self.enable_mask.checked_shr(bit))
                .is_some_and(|mask| mask & 1 == 1);
            if let Some(output) = outputs.get_mut(index) {
                *output |= on && enabled;
            }
        }
        SwitchOutputs { outputs, in_operation: true }
    }
}
