//! Profile segments: spans of time in which the acceleration follows one law, and a chain of them.

use super::State;

/// Most segments of a profile: coming back to the limits takes 2, each of two ramps through a standstill 5, and one lies
/// between them at constant velocity.
pub(super) const MOST_SEGMENTS: usize = 14;

/// The acceleration over one stretch of time:
///
/// ```text
/// angular = 0:  a(t) = a0 + jerk·t
/// else:         a(t) = a0·cos(angular·t) + jerk/angular·sin(angular·t)
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Segment {
    /// Time of its begin, s.
    pub(super) start: f64,
    /// State at its begin. If the acceleration steps, it is that after the step.
    pub(super) state: State,
    /// Jerk at the beginning, u/s³.
    pub(super) jerk: f64,
    /// Angular frequency of the acceleration, rad/s.
    pub(super) angular: f64,
}

impl Segment {
    /// State `time` s after the beginning.
    pub(super) fn after(&self, time: f64) -> State {
        let State { position, velocity, acceleration } = self.state;
        let jerk = self.jerk;
        if self.angular > 0.0 {
            let (sin, cos) = (self.angular * time).sin_cos();
            let half = (0.5 * self.angular * time).sin();
            // Integrals of cos and sin from 0; 1 − cos without the loss of digits.
            let of_cos = sin / self.angular;
            let of_sin = 2.0 * half * half / self.angular;
            let peak = jerk / self.angular;
            return State {
                position: position
                    + velocity * time
                    + (acceleration * of_sin + peak * (time - of_cos)) / self.angular,
                velocity: velocity + acceleration * of_cos + peak * of_sin,
                acceleration: acceleration * cos + peak * sin,
            };
        }
        State {
            position: position
                + time * (velocity + time * (0.5 * acceleration + time * jerk / 6.0)),
            velocity: velocity + time * (acceleration + 0.5 * time * jerk),
            acceleration: acceleration + time * jerk,
        }
    }
}

/// A chain of segments, each from the end of the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Track {
    segments: [Segment; MOST_SEGMENTS],
    count: usize,
    /// Sum of the durations, s.
    pub(super) duration: f64,
    /// At the end.
    pub(super) state: State,
}

#[expect(clippy::indexing_slicing, reason = "at most MOST_SEGMENTS, as counted there")]
impl Track {
    /// Without segments.
    pub(super) fn new(state: State) -> Self {
        Self { segments: [Segment::default(); MOST_SEGMENTS], count: 0, duration: 0.0, state }
    }

    /// Goes on for `duration` s with `acceleration` and `jerk`.
    pub(super) fn push(&mut self, duration: f64, acceleration: f64, jerk: f64) {
        self.swing(duration, acceleration, jerk, 0.0);
    }

    /// Goes on for `duration` s with an acceleration that swings with `angular` rad/s.
    pub(super) fn swing(&mut self, duration: f64, acceleration: f64, jerk: f64, angular: f64) {
        self.state.acceleration = acceleration;
        // Rounding may make a duration of 0 negative; NaN must come through.
        if duration <= 0.0 {
            return;
        }
        let segment = Segment { start: self.duration, state: self.state, jerk, angular };
        self.segments[self.count] = segment;
        self.count += 1;
        self.state = segment.after(duration);
        self.duration += duration;
    }

    /// The segments so far.
    pub(super) fn segments(&self) -> &[Segment] {
        &self.segments[..self.count]
    }
}
