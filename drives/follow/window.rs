//! The plan ahead, sampled once per round.

use crate::{
    SetpointStream,
    ramp::{State, seconds},
};

/// Distance of the points at which the plan is looked at, ns.
const SPACING_NS: i64 = 2_000_000;
/// Points at most: one second.
const MOST_POINTS: usize = 501;

/// The plan ahead, at even distances.
#[derive(Clone, Debug, Default)]
pub(super) struct Window {
    /// Instant of the first point, ns.
    pub(super) start_ns: i64,
    /// Positions and velocities per axis.
    points: Vec<Vec<State>>,
}

impl Window {
    pub(super) fn look(stream: &dyn SetpointStream, axes: usize) -> Self {
        let start_ns = stream.now_ns();
        let count = usize::try_from(stream.horizon_ns() / SPACING_NS)
            .map_or(1, |count| count + 1)
            .min(MOST_POINTS);
        let mut points = vec![Vec::with_capacity(count); axes];
        let mut time_ns = start_ns;
        for _ in 0..count {
            let motion = stream.at(time_ns);
            for ((axis, position), velocity) in
                points.iter_mut().zip(motion.position).zip(motion.velocity)
            {
                axis.push(State { position, velocity });
            }
            time_ns += SPACING_NS;
        }
        Self { start_ns, points }
    }

    pub(super) fn axis(&self, axis: usize) -> AxisWindow<'_> {
        AxisWindow {
            start_ns: self.start_ns,
            points: self.points.get(axis).map_or(&[], Vec::as_slice),
        }
    }
}

/// The plan of one axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisWindow<'a> {
    start_ns: i64,
    points: &'a [State],
}

impl AxisWindow<'_> {
    /// Number of whole distances before an instant, and the rest.
    fn place(&self, time_ns: i64) -> (usize, i64) {
        let since_ns = (time_ns - self.start_ns).max(0);
        (usize::try_from(since_ns / SPACING_NS).unwrap_or(usize::MAX), since_ns % SPACING_NS)
    }

    /// The plan at an instant: a cubic between two points. Beyond the horizon it rests where it ends.
    pub(super) fn at(&self, time_ns: i64) -> State {
        let (index, rest_ns) = self.place(time_ns);
        let Some([from, to]) =
            self.points.get(index..).and_then(|points| points.first_chunk::<2>())
        else {
            return self
                .points
                .last()
                .map_or_else(State::default, |last| State { velocity: 0.0, ..*last });
        };
        let (step, t) = (seconds(SPACING_NS), seconds(rest_ns));
        let mean = (to.position - from.position) / step;
        let bend = (3.0 * mean - 2.0 * from.velocity - to.velocity) / step;
        let twist = (from.velocity + to.velocity - 2.0 * mean) / (step * step);
        State {
            position: from.position + (from.velocity + (bend + twist * t) * t) * t,
            velocity: from.velocity + (2.0 * bend + 3.0 * twist * t) * t,
        }
    }

    /// Its largest speed ahead, steps/s.
    pub(super) fn fastest(&self) -> f64 {
        self.points.iter().map(|point| point.velocity.abs()).fold(0.0, f64::max)
    }

    /// The position nearest to `wanted` that the plan reaches after `time_ns` on its way in the sense of `sense`,
    /// before it turns.
    pub(super) fn reached(&self, time_ns: i64, sense: f64, wanted: f64) -> f64 {
        let (index, _) = self.place(time_ns);
        let mut farthest = self.at(time_ns).position;
        for point in self.points.get(index.saturating_add(1)..).unwrap_or_default() {
            if (farthest - wanted) * sense >= 0.0 {
                return wanted;
            }
            if (point.position - farthest) * sense < -0.5 {
                break;
            }
            if (point.position - farthest) * sense > 0.0 {
                farthest = point.position;
            }
        }
        if (farthest - wanted) * sense >= 0.0 { wanted } else { farthest }
    }
}
