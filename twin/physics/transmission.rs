//! Elastic transmissions: gears, belts and screws as a spring with backlash between motor and axis.

/// The part of the play over which damping sets in.
const ONSET: f64 = 0.1;

/// A transmission that is not rigid, everything at the axis (behind the gear).
///
/// ```text
/// twist = motor − axis      effort = k·(twist ∓ backlash/2) + d·(rate of twist)      none within the backlash
/// ```
///
/// Teeth push and do not pull: with backlash, damping never turns the sign, and sets in over the first tenth of the play.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticTransmission {
    /// k: N/m or Nm/rad. Belts of machines have 10⁴ to 10⁶ N/m, ball screws 10⁷ to 10⁸ N/m, harmonic gears 10⁴ Nm/rad.
    pub stiffness: f64,
    /// d: N·s/m or Nm·s/rad.
    pub damping: f64,
    /// Whole play at reversal, m or rad.
    pub backlash: f64,
}

impl ElasticTransmission {
    /// With the damping ratio `ratio` (0.01 to 0.1 for metal, 0.05 to 0.2 for belts) between the inertias of motor and axis.
    pub fn damped(stiffness: f64, ratio: f64, backlash: f64, motor: f64, axis: f64) -> Self {
        let reduced = motor * axis / (motor + axis);
        Self { stiffness, damping: 2.0 * ratio * (stiffness * reduced).sqrt(), backlash }
    }

    /// Effort on the axis from a motor that is `twist` (m or rad) ahead, with the rate `rate` of the twist.
    pub(super) fn effort(&self, twist: f64, rate: f64) -> f64 {
        let Self { stiffness, damping, backlash } = *self;
        if backlash <= 0.0 {
            return stiffness * twist + damping * rate;
        }
        let (side, push) = self.push(twist, rate);
        side * push.max(0.0)
    }

    /// Loaded side of the teeth (1: the motor drives upwards; 0: within the play), and the effort there; below 0
    /// where the teeth part faster than the spring unwinds.
    pub(super) fn push(&self, twist: f64, rate: f64) -> (f64, f64) {
        let Self { stiffness, damping, backlash } = *self;
        let wound = twist - twist.clamp(-0.5 * backlash, 0.5 * backlash);
        if wound == 0.0 {
            return (0.0, 0.0);
        }
        let (side, wound) = (wound.signum(), wound.abs());
        let engaged = (wound / (ONSET * backlash)).min(1.0);
        (side, stiffness * wound + damping * engaged * rate * side)
    }

    /// Leads of the motor between two twists at which another law begins; none without backlash.
    pub(super) fn edges_between(&self, one: f64, other: f64) -> impl Iterator<Item = f64> + use<> {
        let (low, high) = (one.min(other), one.max(other));
        let half = 0.5 * self.backlash;
        let engaged = half + ONSET * self.backlash;
        [-engaged, -half, half, engaged].into_iter().filter(move |side| (low..=high).contains(side))
    }

    /// True if `twist` (m or rad) is more than play.
    pub(super) fn is_wound(&self, twist: f64) -> bool {
        twist.abs() > 0.5 * self.backlash
    }

    /// Lead of the motor where the axis feels `effort` at rest.
    pub(super) fn twist(&self, effort: f64) -> f64 {
        if effort == 0.0 {
            return 0.0;
        }
        effort / self.stiffness + 0.5 * self.backlash.copysign(effort)
    }

    /// The angular frequency of its resonance between inertias, rad/s.
    pub(super) fn resonance(&self, motor: f64, axis: f64) -> f64 {
        (self.stiffness * (motor + axis) / (motor * axis)).sqrt()
    }

    /// The fields with their names and ranges.
    pub(super) fn ranges(&self) -> [(&'static str, f64, f64, f64); 3] {
        [
            ("stiffness", self.stiffness, f64::MIN_POSITIVE, f64::MAX),
            ("damping", self.damping, 0.0, f64::MAX),
            ("backlash", self.backlash, 0.0, f64::MAX),
        ]
    }
}
