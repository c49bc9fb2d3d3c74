//! State diagram of an axis (PLCopen; manual 2.4, 5.2).

/// State of an axis (`SMC_AXIS_STATE`, parameter 1000 `nAxisState`).
///
/// ```text
///              ┌────────── homing ◀── MC_Home ───┐
///              ▼                                 │
/// power_off ─▶ standstill ◀───────────────────────┤
///              │  ▲   MC_Move…                    │
///              ▼  │                               │
///  discrete ⇄ continuous ⇄ synchronized ── MC_Stop ─▶ stopping (done and Execute FALSE: standstill)
///
///  every state ─ error of the axis ─▶ errorstop ─ MC_Reset ─▶ standstill (power_off without power)
///  every state but errorstop ─ power lost ─▶ power_off
/// ```
#[doc(alias = "SMC_AXIS_STATE")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AxisState {
    /// 0 `power_off`: no power, or the brake is on.
    PowerOff,
    /// 1 `errorstop`: an error; the axis brakes and waits for a reset.
    ErrorStop,
    /// 2 `stopping`: `MC_Stop` brakes the axis or holds it locked.
    Stopping,
    /// 3 `standstill`: ready.
    Standstill,
    /// 4 `discrete_motion`: on the way to a target.
    DiscreteMotion,
    /// 5 `continuous_motion`: moves on without an end.
    ContinuousMotion,
    /// 6 `synchronized_motion`: follows a master.
    SynchronizedMotion,
    /// 7 `homing`.
    Homing,
}

impl AxisState {
    /// Every state, by number.
    pub const ALL: [Self; 8] = [
        Self::PowerOff,
        Self::ErrorStop,
        Self::Stopping,
        Self::Standstill,
        Self::DiscreteMotion,
        Self::ContinuousMotion,
        Self::SynchronizedMotion,
        Self::Homing,
    ];

    /// Its number in `nAxisState`.
    #[must_use]
    pub const fn number(self) -> i64 {
        self as i64
    }

    /// True if a block moves the axis here and may be aborted by another one.
    #[must_use]
    pub const fn is_motion(self) -> bool {
        matches!(self, Self::DiscreteMotion | Self::ContinuousMotion | Self::SynchronizedMotion)
    }

    /// True if the axis may go from this state to `next` (it may always stay).
    #[must_use]
    pub const fn leads_to(self, next: Self) -> bool {
        match (self, next) {
            (_, Self::ErrorStop | Self::PowerOff)
            | (Self::Standstill, _)
            | (Self::Homing, Self::Stopping | Self::Standstill | Self::Homing) => true,
            (Self::PowerOff | Self::ErrorStop, next) => matches!(next, Self::Standstill),
            (Self::Stopping, next) => matches!(next, Self::Stopping | Self::Standstill),
            (from, next) => from.is_motion() && !matches!(next, Self::Homing),
        }
    }
}
