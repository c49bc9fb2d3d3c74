//! Probing moves (RS274: G38.2 to G38.5): straight, and over as soon as the probe trips.

use std::fmt;

/// Trip of a probe that ends a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ProbeTrip {
    /// It touches something: towards the work (G38.2, G38.3).
    Touch,
    /// It comes free of what it touches: away from the work (G38.4, G38.5).
    Release,
}

/// Programmed probing move. [`fmt::Display`] gives its G word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Probing {
    /// Trip that ends it before its programmed end.
    pub trips: ProbeTrip,
    /// True if it is an error if that does not happen (G38.2, G38.4).
    pub required: bool,
}

impl Probing {
    /// G38.2.
    pub const TOUCH: Self = Self { trips: ProbeTrip::Touch, required: true };
    /// G38.3.
    pub const TRY_TOUCH: Self = Self { trips: ProbeTrip::Touch, required: false };
    /// G38.4.
    pub const RELEASE: Self = Self { trips: ProbeTrip::Release, required: true };
    /// G38.5.
    pub const TRY_RELEASE: Self = Self { trips: ProbeTrip::Release, required: false };

    /// The number of its G word.
    pub const fn g_number(self) -> f64 {
        match (self.trips, self.required) {
            (ProbeTrip::Touch, true) => 38.2,
            (ProbeTrip::Touch, false) => 38.3,
            (ProbeTrip::Release, true) => 38.4,
            (ProbeTrip::Release, false) => 38.5,
        }
    }
}

impl fmt::Display for Probing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "G{}", self.g_number())
    }
}

/// Outcome of a probing move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ProbeOutcome {
    /// At its programmed end, because nobody has said what there is to touch.
    Unknown,
    /// At the trip of the probe.
    Tripped,
    /// At its programmed end, on the way to which the probe does not trip.
    NotTripped,
}
