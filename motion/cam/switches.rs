//! Outputs that an axis switches by its position (`MC_DigitalCamSwitch`, manual 5.5).
//!
//! A switch is on while the axis is between two positions, or for a time from one of them on. Its track's compensations
//! move both edges in time: what switches later looks at where the axis was, what switches earlier at where it will be,
//! both at the present velocity.

use super::tappet::Passage;
use super::unwrap::Unwrap;

/// Outputs a block has.
pub const OUTPUTS: u8 = 32;

/// What a switch goes by (`CamSwitchMode`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SwitchMode {
    /// 0: on from the first to the last position. On a rotary axis the first may be the greater one: the range then goes
    /// over the end of the period.
    Position {
        /// `LastOnPosition`, u.
        last_on: f64,
    },
    /// 1: on for a time after the first position.
    Time {
        /// `Duration`, ns.
        duration_ns: i64,
    },
}

/// A switch (`MC_CAMSWITCH_TR`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    /// Number of the output, 1 to [`OUTPUTS`]; switches of one output are OR-ed.
    pub track: u8,
    /// `FirstOnPosition`, u.
    pub first_on: f64,
    /// In which direction of the axis it works (`AxisDirection` 0 both, 1 positive, 2 negative).
    pub direction: Passage,
    /// What it goes by.
    pub mode: SwitchMode,
}

/// Options of an output (`MC_TRACK_TR`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Track {
    /// `OnCompensation`: it switches on this much later, earlier if negative, s.
    pub on_compensation_s: f64,
    /// `OffCompensation`: it switches off this much later, earlier if negative, s.
    pub off_compensation_s: f64,
    /// `Hysteresis`: a switch that has switched does not do so again before the axis has moved this far away, u.
    pub hysteresis: f64,
}

/// Why switches cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SwitchError {
    /// There is no such output.
    #[error("switch {index}: track {track} is not one of 1 to {OUTPUTS}")]
    NoSuchTrack {
        /// Which switch, from 1.
        index: usize,
        /// Its track.
        track: u8,
    },
    /// The range of a switch on a linear axis is empty, or a position is no number.
    #[error("switch {index}: from {first_on} to {last_on} is no range")]
    NoRange {
        /// Which switch, from 1.
        index: usize,
        /// Its first position, u.
        first_on: f64,
        /// Its last position, u.
        last_on: f64,
    },
}

#[derive(Clone, Copy, Debug)]
struct State {
    switch: Switch,
    on: bool,
    /// Where it switched last, until the axis has gone away from there.
    held: Option<f64>,
    /// Where it looked for the axis in the last cycle.
    looked: Option<f64>,
    /// Until when it is on by time, ns.
    until_ns: Option<(i64, i64)>,
}

/// Switches up to 32 outputs (`MC_DigitalCamSwitch`, manual 5.5).
#[derive(Clone, Debug)]
pub struct DigitalCamSwitch {
    switches: Vec<State>,
    tracks: [Track; 32],
    period: Option<f64>,
    unwrap: Option<Unwrap>,
    forwards: bool,
    outputs: u32,
}

impl DigitalCamSwitch {
    /// Makes the block ready, all outputs off. `period` is that of the axis, if it is rotary.
    ///
    /// # Errors
    /// [`SwitchError`] if a switch has no output or no range.
    pub fn new(
        switches: &[Switch],
        tracks: [Track; 32],
        period: Option<f64>,
    ) -> Result<Self, SwitchError> {
        let period = period.filter(|period| period.is_finite() && *period > 0.0);
        for (index, switch) in (1..).zip(switches) {
            let Switch { track, first_on, mode, .. } = *switch;
            if !(1..=OUTPUTS).contains(&track) {
                return Err(SwitchError::NoSuchTrack { index, track });
            }
            let last_on = match mode {
                SwitchMode::Position { last_on } => last_on,
                SwitchMode::Time { .. } => first_on,
            };
            let finite = first_on.is_finite() && last_on.is_finite();
            if !finite || (period.is_none() && last_on < first_on) {
                return Err(SwitchError::NoRange { index, first_on, last_on });
            }
        }
        let state = |switch: &Switch| State {
            switch: *switch,
            on: false,
            held: None,
            looked: None,
            until_ns: None,
        };
        Ok(Self {
            switches: switches.iter().map(state).collect(),
            tracks,
            period,
            unwrap: None,
            forwards: true,
            outputs: 0,
        })
    }

    /// A cycle: position (u) and velocity (u/s) of the axis, set or actual ones as `TappetMode` says, the time, and
    /// which outputs are enabled (`EnableMasks`, bit 0 for output 1). Gives the outputs, bit 0 for output 1.
    ///
    /// An axis at rest keeps the direction it had; before its first motion that is the positive one.
    pub fn step(&mut self, position: f64, velocity: f64, now_ns: i64, enable: u32) -> u32 {
        let period = self.period;
        let whole =
            self.unwrap.get_or_insert_with(|| Unwrap::new(period, position)).follow(position);
        if velocity != 0.0 {
            self.forwards = velocity > 0.0;
        }
        let here = Here { whole, velocity, forwards: self.forwards, now_ns };
        let mut outputs = 0;
        for state in &mut self.switches {
            let index = usize::from(state.switch.track) - 1;
            let track = self.tracks.get(index).copied().unwrap_or_default();
            if state.step(&here, &track, period) {
                outputs |= 1 << index;
            }
        }
        self.outputs = outputs & enable;
        self.outputs
    }

    /// Output 1 to 32; any other one is off.
    pub fn output(&self, track: u8) -> bool {
        (1..=OUTPUTS).contains(&track) && self.outputs >> (track - 1) & 1 == 1
    }
}

/// The axis in a cycle; positions go on over the ends of its period.
struct Here {
    whole: f64,
    velocity: f64,
    forwards: bool,
    now_ns: i64,
}

impl State {
    fn step(&mut self, here: &Here, track: &Track, period: Option<f64>) -> bool {
        let works = match self.switch.direction {
            Passage::Every => true,
            Passage::Positive => here.forwards,
            Passage::Negative => !here.forwards,
        };
        match self.switch.mode {
            SwitchMode::Position { last_on } => {
                let wanted = works && self.is_inside(last_on, here, track, period);
                if self.held.is_some_and(|at| (here.whole - at).abs() > track.hysteresis) {
                    self.held = None;
                }
                if wanted != self.on && self.held.is_none() {
                    self.on = wanted;
                    if track.hysteresis > 0.0 {
                        self.held = Some(here.whole);
                    }
                }
                self.on
            }
            SwitchMode::Time { duration_ns } => {
                if self.passes(here, track, period) && works {
                    let later = |seconds: f64| {
                        #[expect(clippy::cast_possible_truncation, reason = "saturates")]
                        let ns = (seconds * 1e9).round() as i64;
                        here.now_ns.saturating_add(ns)
                    };
                    // A delay counts from the passage; an advance is in where it is looked for.
                    let on = later(track.on_compensation_s.max(0.0));
                    let off = later(track.off_compensation_s).saturating_add(duration_ns);
                    self.until_ns = Some((on, off));
                }
                if self.until_ns.is_some_and(|(_, off)| here.now_ns >= off) {
                    self.until_ns = None;
                }
                self.until_ns.is_some_and(|(on, _)| here.now_ns >= on)
            }
        }
    }

    /// Whether the axis is in the range, each edge seen with its compensation.
    fn is_inside(&self, last_on: f64, here: &Here, track: &Track, period: Option<f64>) -> bool {
        let first = self.switch.first_on;
        let width = match period {
            Some(period) if last_on - first < period => (last_on - first).rem_euclid(period),
            _ => last_on - first,
        };
        let mut at = here.whole - first;
        if let Some(period) = period {
            // The turn whose range is nearest.
            at = (at - width / 2.0 + period / 2.0).rem_euclid(period) + width / 2.0 - period / 2.0;
        }
        let entering = at - here.velocity * track.on_compensation_s;
        let leaving = at - here.velocity * track.off_compensation_s;
        if here.forwards {
            entering >= 0.0 && leaving <= width
        } else {
            entering <= width && leaving >= 0.0
        }
    }

    /// Whether the axis passes the first position in this cycle, seen as early as the compensation says.
    fn passes(&mut self, here: &Here, track: &Track, period: Option<f64>) -> bool {
        let ahead = here.velocity * -track.on_compensation_s.min(0.0);
        let to = here.whole + ahead - self.switch.first_on;
        let Some(from) = self.looked.replace(to) else { return false };
        if self.held.is_some_and(|at| (here.whole - at).abs() > track.hysteresis) {
            self.held = None;
        }
        let turn = period.map_or(0.0, |period| (to / period).round() * period);
        let (from, to) = (from - turn, to - turn);
        let passed = if here.forwards { from < 0.0 && to >= 0.0 } else { from > 0.0 && to <= 0.0 };
        if passed && self.held.is_none() {
            if track.hysteresis > 0.0 {
                self.held = Some(here.whole);
            }
            return true;
        }
        false
    }
}
