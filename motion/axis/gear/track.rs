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
    /// `LastOnPosition`, u. On a rotary axis it may be below the first: over the end of the period. A whole period after it,
    /// or more, is always on, unless it is switched off so much earlier, or on so much later, that less is left.
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
    /// `OnCompensation`, s: switched on so much later, or earlier if negative. What is later is the same time later whatever
    /// the axis does meanwhile; what is earlier is where the axis will be if it goes on as fast as it does.
    pub on_compensation: f64,
    /// `OffCompensation`, s: the same for switching off. One that is to be switched off before it is switched on is never
    /// on, one that is switched on again before it is switched off is always on. Of a timed switch, its end.
    pub off_compensation: f64,
    /// `Hysteresis`, u: so far beyond a place an output that is on stays on. A time begins again only when the axis has
    /// been further away from the place than that. An axis turns, for switches that count in one direction and for places
    /// that are looked for ahead, when it has gone back by more than that from the farthest point it has come to.
    pub hysteresis: f64,
}
