//! `MC_DigitalCamSwitch`.

use crate::axis::Axis;

/// Outputs, at most.
const TRACKS: usize = 32;

/// In which direction a switch counts (`AxisDirection`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SwitchDirection {
    /// 0: both.
    #[default]
    Both,
    /// 1.
    Positive,
    /// 2.
    Negative,
}

/// A switch along an axis (`MC_CAMSWITCH_TR`).
#[doc(alias = "MC_CAMSWITCH_TR")]
#[doc(alias = "MC_CAMSWITCH_REF")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamSwitch {
    /// `TrackNumber`, 1 to 32: output 0 to 31. Others switch nothing.
    pub track: u8,
    /// `FirstOnPosition`, u.
    pub first_on: f64,
    /// `LastOnPosition`, u. On a rotary axis it may be below the first: over the end of the period. A whole period after it,
    /// or more, is always on.
    pub last_on: f64,
    /// `AxisDirection`.
    pub direction: SwitchDirection,
    /// `CamSwitchMode` 1: on for this time, s (`Duration`), from `first_on`; none for mode 0, by position.
    pub duration: Option<f64>,
}

/// Options of an output (`MC_TRACK_TR`).
#[doc(alias = "MC_TRACK_TR")]
#[doc(alias = "MC_TRACK_REF")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Track {
    /// `OnCompensation`, s: switched on so much later, or earlier if negative.
    pub on_compensation: f64,
    /// `OffCompensation`, s: the same for switching off. One that is to be switched off before it is switched on is never
    /// on, one that is switched on again before it is switched off is always on.
    pub off_compensation: f64,
    /// `Hysteresis`, u: so far beyond a place an output that is on stays on. A time begins again only when the axis has
    /// been further away from the place than that.
    pub hysteresis: f64,
}

/// Which position counts (`MC_TappetMode`).
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

/// What [`DigitalCamSwitch`] shows.
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
/// Several switches of a track are one output: it is on if one of them is. An axis at rest counts in the direction in
/// which it moved last.
#[doc(alias = "MC_DigitalCamSwitch")]
#[derive(Clone, Debug)]
pub struct DigitalCamSwitch {
    switches: Vec<Switched>,
    tracks: [Track; TRACKS],
    /// `EnableMasks`: a bit for each output, the lowest for output 0.
    pub enable_mask: u32,
    /// `TappetMode`.
    pub mode: TappetMode,
    /// Position in the cycle before, u.
    before: Option<f64>,
    forward: bool,
}

/// A switch and how it stands.
#[derive(Clone, Copy, Debug)]
struct Switched {
    switch: CamSwitch,
    on: bool,
    /// Time it will still be on, s.
    left: f64,
    /// Where its time has begun, as long as the axis is still there, u.
    held: Option<f64>,
}

impl DigitalCamSwitch {
    /// These switches, every output enabled.
    #[must_use]
    pub fn new(switches: &[CamSwitch], tracks: [Track; TRACKS]) -> Self {
        let switches =
            switches.iter().map(|it| Switched { switch: *it, on: false, left: 0.0, held: None });
        Self {
            switches: switches.collect(),
            tracks,
            enable_mask: u32::MAX,
            mode: TappetMode::Auto,
            before: None,
            forward: true,
        }
    }

    /// Calls it, for a cycle, with Enable and its axis.
    pub fn call(&mut self, enable: bool, axis: &Axis) -> SwitchOutputs {
        if !enable {
            self.before = None;
            for switched in &mut self.switches {
                (switched.on, switched.left, switched.held) = (false, 0.0, None);
            }
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
        if velocity != 0.0 {
            self.forward = velocity > 0.0;
        }
        let seen = Seen {
            position,
            before: self.before.unwrap_or(position),
            velocity,
            forward: self.forward,
            period: axis.period(),
            cycle: axis.cycle(),
        };
        self.before = Some(position);
        let mut outputs = [false; TRACKS];
        for switched in &mut self.switches {
            let index = usize::from(switched.switch.track).wrapping_sub(1);
            let Some(track) = self.tracks.get(index) else { continue };
            switched.advance(&seen, track);
            let enabled = u32::from(switched.switch.track)
                .checked_sub(1)
                .and_then(|bit| self.enable_mask.checked_shr(bit))
                .is_some_and(|mask| mask & 1 == 1);
            if let Some(output) = outputs.get_mut(index) {
                *output |= switched.on && enabled;
            }
        }
        SwitchOutputs { outputs, in_operation: true }
    }
}

/// What the switches look at.
struct Seen {
    position: f64,
    before: f64,
    velocity: f64,
    forward: bool,
    period: Option<f64>,
    cycle: f64,
}

impl Seen {
    /// The short way from one place to another, u.
    fn way(&self, from: f64, to: f64) -> f64 {
        let way = to - from;
        self.period.map_or(way, |period| way - period * (way / period).round())
    }
}

impl Switched {
    fn advance(&mut self, seen: &Seen, track: &Track) {
        let counts = match self.switch.direction {
            SwitchDirection::Both => true,
            SwitchDirection::Positive => seen.forward,
            SwitchDirection::Negative => !seen.forward,
        };
        match self.switch.duration {
            None => self.on = counts && self.is_inside(seen, track),
            Some(duration) => self.time(counts, duration, seen, track),
        }
    }

    fn is_inside(&self, seen: &Seen, track: &Track) -> bool {
        let CamSwitch { first_on, last_on, .. } = self.switch;
        let length = last_on - first_on;
        let length = match seen.period {
            // What is longer comes round to itself.
            Some(period) if length >= period => period,
            Some(period) => crate::axis::fmod(length, period),
            None if length < 0.0 => return false,
            None => length,
        };
        // Along the direction of travel: from where it is switched on to where it is switched off.
        let (sign, entry) = if seen.forward { (1.0, first_on) } else { (-1.0, first_on + length) };
        let speed = seen.velocity.abs();
        let slack = if self.on { track.hysteresis } else { 0.0 };
        let length = length + speed * (track.off_compensation - track.on_compensation);
        if length < 0.0 {
            return false;
        }
        let entry = speed * track.on_compensation - slack + sign * entry;
        let ahead = sign * seen.position - entry;
        let ahead = seen.period.map_or(ahead, |period| crate::axis::fmod(ahead, period));
        let whole = seen.period.is_some_and(|period| length + 2.0 * slack >= period);
        whole || (0.0..=length + 2.0 * slack).contains(&ahead)
    }

    fn time(&mut self, counts: bool, duration: f64, seen: &Seen, track: &Track) {
        self.left = (self.left - seen.cycle).max(0.0);
        let shift = seen.velocity * track.on_compensation;
        let place = self.switch.first_on + shift;
        let [before, now] = [seen.before, seen.position].map(|position| seen.way(place, position));
        // Close to the place only: on the far side of a period the short way changes its sign, too.
        let close = (now - before).abs() <= 2.0 * seen.way(seen.before, seen.position).abs();
        let crossed =
            if seen.forward { before < 0.0 && now >= 0.0 } else { before > 0.0 && now <= 0.0 };
        let near = |at: f64| seen.way(at, seen.position).abs() <= track.hysteresis;
        if counts && close && crossed && self.held.is_none() {
            self.left = (duration + track.off_compensation).max(0.0);
            self.held = Some(place);
        }
        self.held = self.held.filter(|at| near(*at));
        self.on = self.left > 0.0;
    }
}
