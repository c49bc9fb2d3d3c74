//! Axis limits and the bounds that they give at one place of the path, with b = u̇² and a = ü of its parameter u.

use twin_kinematics::AxisVector;

/// Limits of one axis, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Largest velocity, m/s or rad/s.
    pub velocity: f64,
    /// Largest acceleration, m/s² or rad/s².
    pub acceleration: f64,
    /// Largest deceleration, m/s² or rad/s²: limits an acceleration that is opposite to the velocity.
    pub deceleration: f64,
    /// Largest jerk, m/s³ or rad/s³; `None`: not limited.
    pub jerk: Option<f64>,
}

impl AxisLimits {
    /// Limit of an `acceleration` while the axis moves with `velocity`.
    pub fn acceleration_at(&self, velocity: f64, acceleration: f64) -> f64 {
        if velocity * acceleration < 0.0 { self.deceleration } else { self.acceleration }
    }

    /// The smaller of acceleration and deceleration: holds where the direction of the motion changes.
    pub fn smallest_acceleration(&self) -> f64 {
        self.acceleration.min(self.deceleration)
    }

    /// The larger of acceleration and deceleration.
    pub(super) fn largest_acceleration(&self) -> f64 {
        self.acceleration.max(self.deceleration)
    }

    /// True if the deceleration is a limit of its own.
    pub(super) fn has_own_deceleration(&self) -> bool {
        self.acceleration.to_bits() != self.deceleration.to_bits()
    }
}

/// The reciprocals of what an axis can give.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) velocity: f64,
    /// Of the smaller of acceleration and deceleration, and of the larger.
    pub(super) acceleration: [f64; 2],
    /// 0: not limited.
    pub(super) jerk: f64,
}

/// Derivatives of the axis positions by the path parameter, at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// q′.
    pub first: AxisVector,
    /// q″.
    pub second: AxisVector,
    /// q‴.
    pub third: AxisVector,
}

/// The half plane `a`·ü + `b`·u̇² ≤ 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Coefficient of ü.
    pub a: f64,
    /// Coefficient of u̇².
    pub b: f64,
}

impl Row {
    /// True if the two are the same to a millionth.
    pub(super) fn is_about(&self, other: &Self) -> bool {
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (a.abs() + b.abs());
        same(self.a, other.a) && same(self.b, other.b)
    }
}

/// The strip |`first`·ȧ/√b + 3·`second`·a + `third`·b|·√b ≤ 1: the derivatives of an axis, divided by its jerk limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JerkRow {
    /// q′/J.
    pub first: f64,
    /// q″/J.
    pub second: f64,
    /// q‴/J.
    pub third: f64,
}

impl JerkRow {
    /// Half-way to `other`.
    pub(super) fn between(&self, other: &Self) -> Self {
        Self {
            first: self.first.midpoint(other.first),
            second: self.second.midpoint(other.second),
            third: self.third.midpoint(other.third),
        }
    }

    pub(super) fn new(rates: [f64; 3], part: &Part) -> Self {
        let [first, second, third] = rates.map(|rate| rate * part.jerk);
        Self { first, second, third }
    }

    /// The jerk of the axis, as a part of its limit, with these u̇², ü and dü/du.
    pub(super) fn at(&self, b: f64, a: f64, gamma: f64) -> f64 {
        (self.third * b + 3.0 * self.second * a + self.first * gamma) * b.sqrt()
    }

    pub(super) fn tighten(&mut self, factor: f64) {
        self.first *= factor;
        self.second *= factor;
        self.third *= factor;
    }
}

/// The disc |`a`·ü + `b`·u̇²| ≤ 1: the acceleration of the tool tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// p′ divided by the limit.
    pub a: [f64; 3],
    /// p″ divided by the limit.
    pub b: [f64; 3],
}

/// Source of a bound of u̇² at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CapSource {
    /// The path stops here.
    Stop,
    /// The programmed velocity (F).
    Feed,
    /// The velocity limit of the axis of this number.
    AxisVelocity(u8),
    /// Friction and weight, which leave nothing of the motor of the axis of this number.
    Motor(u8),
    /// The acceleration towards the centre of a curve, or its jump from one element to the next.
    Centripetal,
    /// The velocity that an element asks for at its end.
    EndVelocity,
    /// A turn or a step of the curvature at a joint.
    Joint,
    /// Unconstrained: the acceleration alone.
    Unconstrained,
}

impl CapSource {
    /// By how much u̇² grows where what asks for the bound does, both as parts of themselves.
    pub(super) fn share(self) -> f64 {
        match self {
            // v² = a·r.
            Self::Centripetal => 1.0,
            _ => 2.0,
        }
    }
}

/// Limit that holds the path back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Constraint {
    /// A bound on the velocity.
    Velocity(CapSource),
    /// The acceleration limit of the axis of this number.
    AxisAcceleration(u8),
    /// The jerk limit of the axis of this number.
    AxisJerk(u8),
    /// A further row, by its number: the programmed acceleration (0) and deceleration (1), then, from
    /// [`FIRST_FURTHER_ROW`] on, those of [`super::AxisPath::further`].
    Further(u8),
    /// The acceleration of the tool tip.
    ToolAcceleration,
}

/// The number of the first row of [`super::AxisPath::further`] in a [`Constraint::Further`].
pub const FIRST_FURTHER_ROW: u8 = 2;

/// The number of an axis or row in a [`Constraint`].
pub(super) fn number(index: usize) -> u8 {
    u8::try_from(index).unwrap_or(u8::MAX)
}

/// A bound on u̇² and where it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// Largest u̇².
    pub v2: f64,
    /// Its source.
    pub source: CapSource,
}

impl Cap {
    /// None.
    pub const NONE: Self = Self { v2: f64::INFINITY, source: CapSource::Unconstrained };
    /// A stop.
    pub const STOP: Self = Self { v2: 0.0, source: CapSource::Stop };

    /// The smaller of two; this one if they are equal.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        if other.v2 < self.v2 { other } else { self }
    }
}
