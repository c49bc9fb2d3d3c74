//! Tappets: binary switches on a cam (manual 4.4.2).

use super::error::CamError;

/// Passages of the master that trigger a tappet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Passage {
    /// With the master's position growing.
    Positive,
    /// With it falling.
    Negative,
    /// Both.
    #[default]
    Every,
}

/// Action of a tappet on the bit of its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Action {
    /// Switches it on.
    On,
    /// Switches it off.
    Off,
    /// Inverts it.
    Invert,
    /// Switches it on after a delay, and off again a duration later.
    Timed {
        /// From passage to on (the manual's "deceleration" is a delay), ns; the manual's unit is a microsecond.
        delay_ns: i64,
        /// From on to off, ns.
        duration_ns: i64,
    },
}

/// A tappet (`SMC_CAMTappet`, manual 4.4.2).
#[doc(alias = "SMC_CAMTappet")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tappet {
    /// Number of the group whose bit it acts on; several may share one.
    pub group: i16,
    /// Its place, master u. The slave position there follows from the curve.
    pub master: f64,
    /// Passages that trigger it.
    pub passage: Passage,
    /// Its action.
    pub action: Action,
}

impl Tappet {
    pub(crate) fn check(&self, index: usize) -> Result<(), CamError> {
        let Action::Timed { delay_ns, duration_ns } = self.action else { return Ok(()) };
        for (what, value) in [("delay", delay_ns), ("duration", duration_ns)] {
            if value < 0 {
                return Err(CamError::TappetTime { index, what, value });
            }
        }
        Ok(())
    }
}
