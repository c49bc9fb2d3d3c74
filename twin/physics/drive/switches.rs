//! Limit and home switches of an axis.

/// Positions of the switches of an axis, m or rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SwitchParameters {
    /// The lower limit switch: on at and below.
    pub lower: Option<f64>,
    /// The upper limit switch: on at and above.
    pub upper: Option<f64>,
    /// The home switch: on in between.
    pub home: Option<[f64; 2]>,
}

/// States of the switches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SwitchStates {
    /// The lower limit switch.
    pub lower: bool,
    /// The upper limit switch.
    pub upper: bool,
    /// The home switch.
    pub home: bool,
}

impl SwitchParameters {
    /// States of the switches with the axis at `position`.
    pub(crate) fn at(&self, position: f64) -> SwitchStates {
        SwitchStates {
            lower: self.lower.is_some_and(|lower| position <= lower),
            upper: self.upper.is_some_and(|upper| position >= upper),
            home: self.home.is_some_and(|[from, to]| (from..=to).contains(&position)),
        }
    }
}
