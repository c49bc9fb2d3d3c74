//! Friction model of a slide, a bearing or a motor: Coulomb, breakaway, Stribeck and viscous.

/// Friction of one moving part: Coulomb, breakaway with its fall by Stribeck, and viscous.
///
/// ```text
/// f(v) = −sign(v)·(c + (b − c)·exp(−(v/vs)²)) − d·v        at rest what holds it, up to b
/// ```
///
/// Armstrong-Hélouvry, Dupont, Canudas de Wit, *A survey of models … for the control of machines with friction*, 1994.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionParameters {
    /// c: of a sliding part at any velocity, N or Nm.
    pub coulomb: f64,
    /// b: what has to be overcome from rest, N or Nm, at least `coulomb`; slides have 1 to 2 times that.
    pub breakaway: f64,
    /// vs: where what is above `coulomb` has fallen to 37 %, m/s or rad/s; slides have 1 to 10 mm/s.
    pub stribeck_velocity: f64,
    /// d: N·s/m or Nm·s/rad.
    pub viscous: f64,
}

impl FrictionParameters {
    /// No friction.
    pub const NONE: Self =
        Self { coulomb: 0.0, breakaway: 0.0, stribeck_velocity: 0.0, viscous: 0.0 };

    /// Dry friction that is the same at every velocity, and viscous friction.
    pub const fn new(coulomb: f64, viscous: f64) -> Self {
        Self { coulomb, breakaway: coulomb, stribeck_velocity: 0.0, viscous }
    }

    /// Dry friction at `velocity`: what opposes motion, or holds at rest at the most.
    pub(super) fn dry(&self, velocity: f64) -> f64 {
        let more = self.breakaway - self.coulomb;
        if more <= 0.0 {
            return self.coulomb;
        }
        let ratio = velocity / self.stribeck_velocity.max(f64::MIN_POSITIVE);
        if ratio.abs() > FALLEN {
            return self.coulomb;
        }
        self.coulomb + more * (-ratio * ratio).exp()
    }

    /// True if there is any dry friction.
    pub(super) fn is_dry(&self) -> bool {
        self.coulomb.max(self.breakaway) > 0.0
    }

    /// Both together, as of parts that are joined rigidly.
    pub(super) fn and(&self, other: &Self) -> Self {
        Self {
            coulomb: self.coulomb + other.coulomb,
            breakaway: self.breakaway.max(self.coulomb) + other.breakaway.max(other.coulomb),
            stribeck_velocity: self.stribeck_velocity.max(other.stribeck_velocity),
            viscous: self.viscous + other.viscous,
        }
    }

    /// The fields with their names and least values.
    pub(super) fn ranges(&self) -> [(&'static str, f64, f64, f64); 4] {
        [
            ("coulomb friction", self.coulomb, 0.0, f64::MAX),
            ("breakaway friction", self.breakaway, 0.0, f64::MAX),
            ("stribeck velocity", self.stribeck_velocity, 0.0, f64::MAX),
            ("viscous friction", self.viscous, 0.0, f64::MAX),
        ]
    }
}

/// Stribeck velocities at which friction above Coulomb's is below rounding: e⁻⁴⁹.
const FALLEN: f64 = 7.0;

/// Slower than this, rounding included, a part is at rest, m/s or rad/s.
pub(super) const REST: f64 = 1e-12;

/// Margin below the holding limit, relative: more than the rounding where a part breaks away.
const LEFT: f64 = 1e-9;

/// Effect of dry friction over a short time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum DryFriction {
    /// Nothing.
    #[default]
    None,
    /// Opposes motion in this direction.
    Slides(f64),
    /// Gives what holds the part.
    Sticks,
}

impl DryFriction {
    /// Of a part at rest that `force` would hold, with at most `most` available.
    pub(super) fn at_rest(force: f64, most: f64) -> Self {
        if force.abs() < most * (1.0 - LEFT) { Self::Sticks } else { Self::Slides(-force.signum()) }
    }

    pub(super) fn sticks(self) -> bool {
        self == Self::Sticks
    }

    /// The force at `velocity`, viscous friction included, without what holds a part that sticks.
    pub(super) fn force(self, velocity: f64, friction: &FrictionParameters) -> f64 {
        let dry = match self {
            Self::None | Self::Sticks => 0.0,
            Self::Slides(direction) => -direction * friction.dry(velocity),
        };
        dry - friction.viscous * velocity
    }
}
