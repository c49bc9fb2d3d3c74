//! Random profile tables, and the promise that follows from their points.

use super::*;

/// Some steps of random size, smaller than `size`.
fn points(random: &mut Random, size: f64, end: Option<f64>) -> Points {
    let mut points: Vec<_> = (0..random.one_of(&[1, 2, 5]))
        .map(|_| ProfilePoint {
            delta_time: random.between(0.2, 0.6),
            value: random.between(-size, size),
        })
        .collect();
    if let Some(value) = end.filter(|_| !random.one_in(3)) {
        points.push(ProfilePoint { delta_time: 0.4, value });
    }
    Points::new(points)
}

pub(super) fn positions(fault: Fault<PositionProfile>) -> Box<dyn Called> {
    Box::new(moving(
        |it, begun| by_positions(&it.0, begun),
        |random, _, _| PositionProfile(Points { absolute: false, ..points(random, 3.0, None) }),
        fault,
        (),
    ))
}

pub(super) fn velocities(fault: Fault<VelocityProfile>) -> Box<dyn Called> {
    let inputs = |random: &mut _, _: &_, _: &_| VelocityProfile(points(random, 10.0, Some(0.0)));
    Box::new(moving(|it, begun| by_velocities(&it.0, begun), inputs, fault, ()))
}

pub(super) fn accelerations(fault: Fault<AccelerationProfile>) -> Box<dyn Called> {
    let inputs = |random: &mut _, _: &_, _: &_| AccelerationProfile(points(random, 20.0, None));
    Box::new(moving(|it, begun| by_accelerations(&it.0, begun), inputs, fault, ()))
}

pub(super) fn all() -> Blocks {
    vec![positions(Fault::default()), velocities(Fault::default()), accelerations(Fault::default())]
}

/// An acceleration over time, by straight lines, from a velocity on.
struct Lines {
    velocity: f64,
    acceleration: f64,
    fastest: f64,
    steepest: f64,
    jerk: f64,
    time: f64,
}

impl Lines {
    fn from(velocity: f64, acceleration: f64) -> Self {
        let (fastest, steepest) = (velocity.abs(), acceleration.abs());
        Self { velocity, acceleration, fastest, steepest, jerk: 0.0, time: 0.0 }
    }

    fn to(&mut self, acceleration: f64, step: f64) {
        let (v, a) = (self.velocity, self.acceleration);
        // Between two of different sign the velocity has its extreme where the line crosses 0.
        let within =
            if a * acceleration < 0.0 { v + 0.5 * a * a * step / (a - acceleration) } else { v };
        self.velocity = v + 0.5 * (a + acceleration) * step;
        self.fastest = self.fastest.max(within.abs()).max(self.velocity.abs());
        self.steepest = self.steepest.max(acceleration.abs());
        self.jerk = self.jerk.max((acceleration - a).abs() / step);
        self.acceleration = acceleration;
        self.time += step;
    }

    /// At the begin and at the end the acceleration may step.
    fn promise(&self, begun: &Begun) -> Promise {
        let time = f64::from(begun.cycles) * CYCLE;
        let steps = begun.cycles == 0 || (time - self.time).abs() < 1.5 * CYCLE;
        let jerk = if steps { f64::INFINITY } else { self.jerk };
        let (velocity, acceleration) = (self.fastest, self.steepest);
        Promise::Limits(AxisLimits { velocity, acceleration, deceleration: acceleration, jerk })
    }
}

fn by_accelerations(points: &Points, begun: &Begun) -> Promise {
    let mut lines = Lines::from(begun.from.velocity, begun.from.acceleration);
    for point in &points.points {
        lines.to(point.value, point.delta_time);
    }
    lines.promise(begun)
}

/// Two parabolas between any two velocities: the acceleration goes up to twice the mean one and back to 0.
fn by_velocities(points: &Points, begun: &Begun) -> Promise {
    let mut lines = Lines::from(begun.from.velocity, 0.0);
    for point in &points.points {
        let step = point.delta_time;
        lines.to(2.0 * (point.value - lines.velocity) / step, 0.5 * step);
        lines.to(0.0, 0.5 * step);
    }
    lines.promise(begun)
}

/// Cubics whose second derivatives m at the points make the first ones continuous, clamped at both ends:
///
/// ```text
/// 2·h₀·m₀ + h₀·m₁ = 6·(s₀ − v₀),  h₋·m₋ + 2·(h₋ + h₊)·m + h₊·m₊ = 6·(s₊ − s₋),  h·m₋ + 2·h·m = 6·(0 − s)
/// ```
fn by_positions(points: &Points, begun: &Begun) -> Promise {
    let mut before = 0.0;
    let chords = points.points.iter().map(|point| {
        let way = point.value - std::mem::replace(&mut before, point.value);
        (point.delta_time, way / point.delta_time)
    });
    let chords: Vec<(f64, f64)> = chords.collect();
    let count = chords.len();
    // Rows of the equations: below, on and above the diagonal, and what they are.
    let chord = |index: Option<usize>| index.and_then(|index| chords.get(index).copied());
    let mut rows: Vec<[f64; 4]> = (0..=count)
        .map(|index| {
            let (near, far) = (chord(index.checked_sub(1)), chord(Some(index)));
            let (h, s) = near.unwrap_or((0.0, begun.from.velocity));
            let (g, t) = far.unwrap_or((0.0, 0.0));
            [h, 2.0 * (h + g), g, 6.0 * (t - s)]
        })
        .collect();
    for index in 1..=count {
        let [_, diagonal, above, right] = rows[index - 1];
        let factor = rows[index][0] / diagonal;
        rows[index][1] -= factor * above;
        rows[index][3] -= factor * right;
    }
    let mut moments = vec![0.0; count + 1];
    for index in (0..=count).rev() {
        let [_, diagonal, above, right] = rows[index];
        let after = moments.get(index + 1).copied().unwrap_or_default();
        moments[index] = (right - above * after) / diagonal;
    }
    let mut lines = Lines::from(begun.from.velocity, moments[0]);
    for ((step, _), moment) in chords.iter().zip(&moments[1..]) {
        lines.to(*moment, *step);
    }
    lines.promise(begun)
}
