//! Options of time-optimal planning: limits and resolution.

use crate::blended_path::BlendOptions;
use twin_path::prepare::CircularLimits;

/// Settings of the feed limiter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitOptions {
    /// Options of blending.
    pub course: BlendOptions,
    /// The programmed velocity (F) counts, and that at the end of an element, if it asks for one.
    pub feed: bool,
    /// The programmed accelerations along the path (E+, E−) count.
    pub path_acceleration: bool,
    /// Largest acceleration of the tool tip, m/s²; `None`: not limited.
    pub tool_acceleration: Option<f64>,
    /// Limits of the centripetal acceleration: on curves, and of its jump from one element to the next.
    pub centripetal: CircularLimits,
    /// Time between nodes of the grid, s.
    pub step: f64,
    /// Largest number of grid steps in a part of the plan where nothing changes; an override takes effect at the end of a part.
    pub longest: f64,
    /// Time that is planned at once, s, where the path does not stop before.
    pub horizon: f64,
}

impl LimitOptions {
    /// Everything that the program and the axes ask for, with joints rounded as `course` says.
    pub fn new(course: BlendOptions) -> Self {
        Self {
            course,
            feed: true,
            path_acceleration: true,
            tool_acceleration: None,
            centripetal: CircularLimits::default(),
            step: 1.25e-3,
            longest: 2.0,
            horizon: 1.5,
        }
    }
}
