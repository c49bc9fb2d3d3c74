//! Profile tables: motion through given points (`MC_PositionProfile`, `MC_VelocityProfile`, `MC_AccelerationProfile`,
//! manual 5.3).

use super::planned::{all_finite, finite};
use super::segment::Segment;
use super::{ProfileError, State};

/// Most points of a table (`ArraySize`).
pub const MOST_POINTS: usize = 100;

/// Part of the larger value by which the first point may be off the state that the motion starts from.
const SAME: f64 = 1e-9;

/// A sum of which less than this part of what was added is left is 0, but for rounding.
const ROUNDED: f64 = 1e-12;

/// A point of a table (`SMC_TP`, `SMC_TV`, `SMC_TA`).
#[doc(alias = "SMC_TP")]
#[doc(alias = "SMC_TV")]
#[doc(alias = "SMC_TA")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Time since the point before, of the first one since the start, s.
    pub delta_time: f64,
    /// Position, velocity or acceleration there, before scaling.
    pub value: f64,
}

/// Values of a table and their interpretation: the curve goes through `scale`·value + `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileTable<'a> {
    /// The points (`TimePosition`, `TimeVelocity`, `TimeAcceleration`).
    pub points: &'a [ProfilePoint],
    /// True if values count from 0, false if from the value at the start (`IsAbsolute`).
    pub absolute: bool,
    /// Factor of the values.
    pub scale: f64,
    /// Added to them after that, u, u/s or u/s².
    pub offset: f64,
}

/// A motion through the points of a table, at a constant velocity after the last of them.
///
/// The state at the start is the first node of the curve. A first point without `delta_time` says the same again; it
/// must not ask for another position or velocity. The acceleration may step there.
///
/// ```
/// use twin_profile::{ProfilePoint, ProfileTable, State, TableProfile};
///
/// let points = [(0.0, 0.0), (1.0, 10.0), (1.0, 15.0)]
///     .map(|(delta_time, value)| ProfilePoint { delta_time, value });
/// let table = ProfileTable { points: &points, absolute: true, scale: 1.0, offset: 0.0 };
/// let profile = TableProfile::positions(State::resting(0.0), table)?;
/// assert!((profile.at(1.0).velocity - 11.25).abs() < 1e-12);
/// assert_eq!(profile.at(2.0), State::resting(15.0));
/// # Ok::<(), twin_profile::ProfileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TableProfile {
    segments: Vec<Segment>,
    duration: f64,
    end: State,
}

impl TableProfile {
    /// Cubic polynomials through positions, with continuous velocity and acceleration; at the start the velocity of
    /// `from`, at the end none (`MC_PositionProfile`).
    ///
    /// # Errors
    ///
    /// A [`ProfileError`] for an empty or too long table, for times that do not grow, for numbers that are not finite, and
    /// for a first point without `delta_time` elsewhere.
    pub fn positions(from: State, table: ProfileTable) -> Result<Self, ProfileError> {
        let nodes = nodes(from, table, from.position)?;
        same("position", from.position, nodes.first)?;
        let velocities = slopes(from, &nodes.points);
        let mut state = from;
        let mut profile = Self::empty(from);
        let ends = velocities.into_iter().skip(1);
        for (&(step, position), velocity) in nodes.points.iter().zip(ends) {
            let mean = (position - state.position) / step;
            let acceleration = (6.0 * mean - 4.0 * state.velocity - 2.0 * velocity) / step;
            let jerk = 6.0 * (state.velocity + velocity - 2.0 * mean) / (step * step);
            profile.push(step, State { acceleration, ..state }, jerk);
            state = State { position, velocity, acceleration: acceleration + jerk * step };
        }
        profile.ended(State { acceleration: 0.0, ..state })
    }

    /// Parabolas through velocities, two between any two points, which meet in the middle; no acceleration at the
    /// points (`MC_VelocityProfile`). The position is the integral from that of `from`.
    ///
    /// # Errors
    ///
    /// As for [`Self::positions`], the first point's velocity for its position.
    pub fn velocities(from: State, table: ProfileTable) -> Result<Self, ProfileError> {
        let nodes = nodes(from, table, from.velocity)?;
        same("velocity", from.velocity, nodes.first)?;
        let mut profile = Self::empty(from);
        for &(step, velocity) in &nodes.points {
            let state = State { acceleration: 0.0, ..profile.end };
            let half = 0.5 * step;
            let jerk = (velocity - state.velocity) / (half * half);
            profile.push(half, state, jerk);
            profile.push(half, profile.end, -jerk);
            profile.end.velocity = velocity;
        }
        let end = State { acceleration: 0.0, ..profile.end };
        profile.ended(end)
    }

    /// Straight lines through accelerations (`MC_AccelerationProfile`). Position and velocity are the integrals from
    /// those of `from`. After the last point there is no acceleration.
    ///
    /// # Errors
    ///
    /// As for [`Self::positions`], but that the acceleration of the first point may be any.
    pub fn accelerations(from: State, table: ProfileTable) -> Result<Self, ProfileError> {
        let nodes = nodes(from, table, from.acceleration)?;
        let acceleration = nodes.first.unwrap_or(from.acceleration);
        let mut profile = Self::empty(State { acceleration, ..from });
        let mut added = from.velocity.abs();
        for &(step, acceleration) in &nodes.points {
            let before = profile.end;
            let jerk = (acceleration - before.acceleration) / step;
            profile.push(step, before, jerk);
            profile.end.acceleration = acceleration;
            added += (profile.end.velocity - before.velocity).abs();
        }
        // Accelerations that cancel out end at rest.
        let velocity = unless_rounded(profile.end.velocity, added);
        let end = State { velocity, acceleration: 0.0, ..profile.end };
        profile.ended(end)
    }

    fn empty(from: State) -> Self {
        Self { segments: Vec::new(), duration: 0.0, end: from }
    }

    fn push(&mut self, step: f64, state: State, jerk: f64) {
        let segment = Segment { start: self.duration, state, jerk, angular: 0.0 };
        self.segments.push(segment);
        self.end = segment.after(step);
        self.duration += step;
    }

    fn ended(self, end: State) -> Result<Self, ProfileError> {
        if (self.duration + end.position + end.velocity).is_finite() {
            Ok(Self { end, ..self })
        } else {
            Err(ProfileError::TooLarge { target: end.position })
        }
    }

    /// Sum of the times of all points, s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// State at the end.
    pub fn end(&self) -> State {
        self.end
    }

    /// State `time` s after the start, for times before that the state there. After the end the motion goes on with
    /// the velocity it has there.
    pub fn at(&self, time: f64) -> State {
        let after = time - self.duration;
        if after >= 0.0 {
            let position = self.end.position + self.end.velocity * after;
            return State { position, ..self.end };
        }
        let later = self.segments.partition_point(|segment| segment.start <= time);
        self.segments
            .get(later.saturating_sub(1))
            .map_or(self.end, |segment| segment.after((time - segment.start).max(0.0)))
    }
}

/// Nodes behind the start: time since the one before, and value.
struct Nodes {
    /// Value of a first point without `delta_time`.
    first: Option<f64>,
    points: Vec<(f64, f64)>,
}

fn nodes(from: State, table: ProfileTable, start: f64) -> Result<Nodes, ProfileError> {
    all_finite(from)?;
    let count = table.points.len();
    if count == 0 || count > MOST_POINTS {
        return Err(ProfileError::Points { count, most: MOST_POINTS });
    }
    let base = if table.absolute { 0.0 } else { start };
    let mut nodes = Nodes { first: None, points: Vec::with_capacity(count) };
    for (index, point) in table.points.iter().enumerate() {
        let scaled = table.scale * point.value;
        let summed = base.abs() + table.offset.abs() + scaled.abs();
        let value = unless_rounded(base + table.offset + scaled, summed);
        let value = finite("value of a point", value)?;
        let step = finite("time of a point", point.delta_time)?;
        if step > 0.0 {
            nodes.points.push((step, value));
        } else if step < 0.0 || index > 0 {
            return Err(ProfileError::TimeStep { point: index + 1, step });
        } else {
            nodes.first = Some(value);
        }
    }
    Ok(nodes)
}

/// A sum of numbers that are `added` together without their signs; 0 if nothing but rounding is left of them.
fn unless_rounded(sum: f64, added: f64) -> f64 {
    if sum.abs() <= ROUNDED * added { 0.0 } else { sum }
}

/// A first point must be where the motion is.
fn same(quantity: &'static str, is: f64, asked: Option<f64>) -> Result<(), ProfileError> {
    match asked {
        Some(asked) if (asked - is).abs() > SAME * asked.abs().max(is.abs()).max(1.0) => {
            Err(ProfileError::Jump { quantity, is, asked })
        }
        _ => Ok(()),
    }
}

/// Velocities at the nodes, that of the start first, so that the acceleration is continuous between cubic polynomials:
///
/// ```text
/// v₋/h₋ + 2·v·(1/h₋ + 1/h₊) + v₊/h₊ = 3·(m₋/h₋ + m₊/h₊),  m = Δp/h
/// ```
fn slopes(from: State, points: &[(f64, f64)]) -> Vec<f64> {
    let mut before = from.position;
    let chords: Vec<(f64, f64)> = points
        .iter()
        .map(|&(step, position)| {
            let slope = (position - before) / step;
            before = position;
            (1.0 / step, slope)
        })
        .collect();
    // Downwards each velocity as a − b·(the next one), upwards the velocities, from none at the end.
    let mut rows = vec![(from.velocity, 0.0)];
    let (mut a, mut b) = (from.velocity, 0.0);
    for pair in chords.windows(2) {
        let [(near, m), (far, n)] = *pair else { continue };
        let pivot = 2.0 * (near + far) - near * b;
        a = (3.0 * (m * near + n * far) - near * a) / pivot;
        b = far / pivot;
        rows.push((a, b));
    }
    let mut velocity = 0.0;
    let mut velocities: Vec<f64> = Vec::with_capacity(rows.len() + 1);
    velocities.push(velocity);
    for (a, b) in rows.into_iter().rev() {
        velocity = a - b * velocity;
        velocities.push(velocity);
    }
    velocities.reverse();
    velocities
}
