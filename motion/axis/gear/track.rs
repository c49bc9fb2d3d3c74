//! Cam switches and tracks of `MC_DigitalCamSwitch`: positions, direction, compensation, hysteresis.

/// Direction in which a switch counts (`AxisDirection`).
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
    /// `LastOnPosition`, u. On a rotary axis it may be below the first: over the end of the period. A range of a whole period
    /// or more is always on, unless compensations shorten it.
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
    /// `OnCompensation`, s: switches on later, or earlier if negative. A delay is a time; an advance looks at the position that
    /// the axis will have at its present velocity.
    pub on_compensation: f64,
    /// `OffCompensation`, s: the same for switching off; of a timed switch, its end. An output that would go off before it
    /// goes on is never on; one that would go on again before it goes off is always on.
    pub off_compensation: f64,
    /// `Hysteresis`, u: an output that is on stays on this far outside its range. A time begins again only after the axis was
    /// further away than this. The direction changes when the axis goes back by more than this from its farthest point.
    pub hysteresis: f64,
}
