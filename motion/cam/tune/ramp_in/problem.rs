//! A start with a ramp: what values make of it, and whether that keeps the limits.

use super::course::Way;
use super::wish::{RampError, RampGoal, RampIn, RampWish};
use crate::SlaveLimits;
use crate::coupling::CamCoupling;
use crate::curve::Curve;
use crate::ramp_in::RampIn as RampInMotion;
use crate::selection::{CamInput, StartMode};
use crate::{Approach, Gap};
use twin_profile::{AxisLimits, RampType};

/// Of a limit this part is rounding.
pub(super) const ROUNDING: f64 = 1e-12;

/// What a ramp is made of: velocity, acceleration, deceleration and jerk; without meaning the jerk of trapezoid ones.
pub(in crate::tune) type Values = [f64; 4];

pub(super) fn values(ramp: &RampIn) -> Values {
    [ramp.velocity_difference, ramp.acceleration, ramp.deceleration, ramp.ramp_jerk]
}

/// A wish, and where slave and cam are at the start.
#[derive(Clone, Copy, Debug)]
pub(in crate::tune) struct Problem<'a> {
    pub(super) wish: &'a RampWish,
    /// `VelocityDiff` is at most this: a gentle ramp has none beyond the axis's own velocity, even where the cam comes towards the
    /// slave, which then stays below it.
    pub(super) most: f64,
    /// Where the master is on the scale of the cam.
    pub(super) place: f64,
    gap: Gap,
    /// What positions are compared with, u: how far the slave is from its cam, and how far it goes on it.
    span: f64,
}

impl<'a> Problem<'a> {
    /// # Errors
    /// [`RampError::Coupling`] if the coupling does not start.
    pub(in crate::tune) fn new(wish: &'a RampWish) -> Result<Self, RampError> {
        let RampWish { table, input, master, slave, limits, goal, .. } = wish;
        let mode = match input.start_mode {
            StartMode::Absolute | StartMode::Relative => StartMode::RampIn,
            directed => directed,
        };
        let input = CamInput { start_mode: StartMode::Absolute, ..*input };
        let coupling = CamCoupling::start(table.clone(), input, master, slave, 0)?;
        let on_cam = coupling.output().slave;
        let gap = Gap {
            distance: on_cam.position - slave.position,
            velocity: slave.velocity - on_cam.velocity,
            acceleration: slave.acceleration - on_cam.acceleration,
            period: table.slave_period,
            mode,
        };
        let most = match goal {
            RampGoal::Soonest => f64::INFINITY,
            RampGoal::Gentlest { .. } => limits.velocity,
        };
        let y = table.cam.curve().extremes().position;
        let [distance, ..] = magnitudes(&gap, false);
        let span = distance + (y.max - y.min) * input.slave_scaling.abs();
        Ok(Self { wish, most, place: coupling.place(), gap, span: span.max(f64::MIN_POSITIVE) })
    }

    /// Without a largest `VelocityDiff`.
    pub(super) fn free(self) -> Self {
        Self { most: f64::INFINITY, ..self }
    }

    /// The same start with another wish.
    pub(super) fn with<'b>(&self, wish: &'b RampWish) -> Problem<'b> {
        Problem { wish, most: self.most, place: self.place, gap: self.gap, span: self.span }
    }

    pub(super) fn curve(&self) -> &Curve {
        self.wish.table.cam.curve()
    }

    /// How fast the master moves on the scale of the cam.
    pub(super) fn speed(&self) -> f64 {
        self.wish.master.velocity * self.wish.input.master_scaling
    }

    /// Whether the acceleration changes by a jerk, which is then one of the values.
    pub(super) fn limited(&self) -> bool {
        self.wish.ramp != RampType::Trapezoid
    }

    /// How far the slave is from its cam, how much faster, and by how much it is accelerated more, as magnitudes.
    pub(super) fn gap(&self) -> [f64; 3] {
        magnitudes(&self.gap, self.limited())
    }

    /// What the values are at most, as logarithms.
    pub(super) fn most_values(&self) -> Values {
        let jerk = if self.limited() { self.wish.limits.jerk.ln() } else { f64::INFINITY };
        [self.most.ln(), f64::INFINITY, f64::INFINITY, jerk]
    }

    /// No ramp is over sooner, s: with all that the axis and the motion of the cam allow.
    pub(super) fn least_time(&self) -> f64 {
        let [distance, velocity, _] = self.gap();
        let [of_velocity, of_acceleration] = self.cam_peaks();
        let most = self.wish.limits.velocity.max(self.wish.slave.velocity.abs()) + of_velocity;
        let pull = self.wish.limits.acceleration + of_acceleration;
        let root = (velocity * velocity + 2.0 * pull * distance).sqrt();
        (distance / most).max(velocity / pull).max((root - velocity) / pull)
    }

    /// Largest velocity and acceleration of the cam.
    pub(super) fn cam_peaks(&self) -> [f64; 2] {
        let (speed, factor) = (self.speed(), self.wish.input.slave_scaling);
        let found = self.curve().extremes();
        [
            (found.velocity.magnitude() * speed * factor).abs(),
            (found.acceleration.magnitude() * speed * speed * factor).abs(),
        ]
    }

    /// A ramp of these values, and exactly what comes of it.
    pub(in crate::tune) fn ramp(&self, values: Values) -> Result<RampIn, RampError> {
        let [velocity_difference, acceleration, deceleration, ramp_jerk] = values;
        let slave = self.wish.slave;
        let mut ramp = RampIn {
            velocity_difference,
            acceleration,
            deceleration,
            ramp_jerk,
            duration_s: 0.0,
            peak_velocity: slave.velocity.abs(),
            peak_acceleration: 0.0,
            peak_jerk: 0.0,
            peak_cam_jerk: 0.0,
            positions: [slave.position; 2],
        };
        self.follow(&self.way(values)?, &mut ramp);
        Ok(ramp)
    }

    /// The motion of a ramp of these values, on top of the cam's.
    pub(super) fn way(
        &self,
        [velocity, acceleration, deceleration, jerk]: Values,
    ) -> Result<Way, RampError> {
        let RampWish { table, input, master, slave, ramp, .. } = self.wish;
        let begin = self.gap.velocity;
        if *ramp == RampType::Trapezoid {
            let input = CamInput {
                start_mode: self.gap.mode,
                velocity_difference: velocity,
                acceleration,
                deceleration,
                ..*input
            };
            let coupling = CamCoupling::start(table.clone(), input, master, slave, 0)?;
            let bridge = coupling.bridge().into_iter().flat_map(RampInMotion::pieces);
            Ok(Way::new(begin, bridge.map(|(duration, pull)| [duration, pull, 0.0, 0.0])))
        } else {
            let limits = AxisLimits { velocity, acceleration, deceleration, jerk };
            let (approach, _) = Approach::new(self.gap, limits, *ramp)?;
            Ok(Way::new(begin, approach.profile().stretches()))
        }
    }

    /// By how much a ramp exceeds the limit that it exceeds most, as a part of it. The jerk is that of ramp and cam together.
    pub(super) fn excess(&self, ramp: &RampIn) -> f64 {
        let SlaveLimits { velocity, acceleration, jerk } = self.wish.limits;
        // What the slave moves at from before is not the ramp's doing.
        let velocity = velocity.max(self.wish.slave.velocity.abs());
        let [low, high] = self.wish.position;
        let [least, greatest] = ramp.positions;
        let span = self.span.max(least.abs()).max(greatest.abs());
        let axis = if self.limited() { ramp.ramp_jerk } else { 0.0 };
        let parts = [
            (low - least) / span,
            (greatest - high) / span,
            ramp.velocity_difference / self.most - 1.0,
            axis / jerk - 1.0,
            ramp.peak_jerk / jerk - 1.0,
            ramp.peak_velocity / velocity - 1.0,
            ramp.peak_acceleration / acceleration - 1.0,
        ];
        parts.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether a ramp keeps all limits but for rounding.
    pub(in crate::tune) fn keeps(&self, ramp: &RampIn) -> bool {
        self.excess(ramp) <= ROUNDING
    }
}

/// The magnitudes of a gap, of a rotary slave on the way that is shortest; acceleration counts where the jerk is limited.
fn magnitudes(gap: &Gap, limited: bool) -> [f64; 3] {
    let Gap { distance, velocity, acceleration, period, .. } = *gap;
    let turns = period.map_or(0.0, |period| (distance / period).round() * period);
    let pull = if limited { acceleration } else { 0.0 };
    [distance - turns, velocity, pull].map(f64::abs)
}
