//! A start with a ramp: what the cam leaves of the limits, and what values make of the ramp.

use super::wish::{RampError, RampIn, RampWish};
use crate::coupling::CamCoupling;
use crate::curve::Curve;
use crate::polynomial::{Extremes, extremes, shifted};
use crate::selection::{CamInput, StartMode};
use crate::{Approach, Gap, Quantity};
use twin_profile::{AxisLimits, RampType, State};

/// Of a limit this part is rounding.
const ROUNDING: f64 = 1e-9;
/// Moments at which a ramp is looked at.
const MOMENTS: u32 = 4000;

/// What a ramp is made of: velocity, acceleration, deceleration and jerk; without meaning the jerk of trapezoid ones.
type Values = [f64; 4];

/// A wish, and where slave and cam are at the start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    wish: &'a RampWish,
    /// Where the master is on the scale of the cam.
    place: f64,
    gap: Gap,
}

/// Motion of a ramp: time after the start, s, and where cam and slave are then.
pub(super) type Moment = (f64, State, State);

impl<'a> Problem<'a> {
    /// # Errors
    /// [`RampError::Coupling`] if the coupling does not start.
    pub(super) fn new(wish: &'a RampWish) -> Result<Self, RampError> {
        let RampWish { table, input, master, slave, ramp, .. } = wish;
        let mode = match input.start_mode {
            StartMode::Absolute | StartMode::Relative => StartMode::RampIn,
            directed => directed,
        };
        let input = CamInput { start_mode: StartMode::Absolute, ..*input };
        let coupling = CamCoupling::start(table.clone(), input, master, slave, 0)?;
        let on_cam = coupling.output().slave;
        // The acceleration of trapezoid ramps steps.
        let steps = *ramp == RampType::Trapezoid;
        let gap = Gap {
            distance: on_cam.position - slave.position,
            velocity: slave.velocity - on_cam.velocity,
            acceleration: if steps { 0.0 } else { slave.acceleration - on_cam.acceleration },
            period: table.slave_period,
            mode,
        };
        Ok(Self { wish, place: coupling.place(), gap })
    }

    fn curve(&self) -> &Curve {
        self.wish.table.cam.curve()
    }

    /// How fast the master moves on the scale of the cam.
    fn speed(&self) -> f64 {
        self.wish.master.velocity * self.wish.input.master_scaling
    }

    /// State of the slave on its cam at a time after the start, turns of a rotary slave aside.
    pub(super) fn cam_at(&self, time_s: f64) -> State {
        let RampWish { table, input, slave, .. } = self.wish;
        let (factor, speed) = (input.slave_scaling, self.speed());
        let place = self.place + speed * time_s;
        let at = if table.periodic { self.curve().repeated(place) } else { self.curve().at(place) };
        let shift = if table.slave_absolute { 0.0 } else { slave.position };
        State {
            position: at.position * factor + input.slave_offset + shift,
            velocity: at.velocity * speed * factor,
            acceleration: at.acceleration * speed * speed * factor,
        }
    }

    /// Peaks of velocity, acceleration and jerk that the cam needs on the way of the master in a time.
    fn needed(&self, time_s: f64) -> [f64; 3] {
        let (speed, factor, curve) = (self.speed(), self.wish.input.slave_scaling, self.curve());
        let (width, way) = (curve.end() - curve.start(), speed * time_s);
        let periodic = self.wish.table.periodic;
        let at = if periodic { curve.wrap(self.place).0 } else { self.place };
        let ways = if periodic && way.abs() >= width {
            vec![[curve.start(), curve.end()]]
        } else {
            let (from, to) = (at.min(at + way), at.max(at + way));
            // A way over the end of a periodic cam goes on at its begin, and the other way round.
            let all = [0.0, width, -width].map(|by| [from - by, to - by]);
            if periodic { all.to_vec() } else { vec![all[0]] }
        };
        let mut found = [Extremes::NONE; 3];
        for piece in curve.pieces() {
            for [from, to] in &ways {
                let from = from.max(piece.start) - piece.start;
                let to = to.min(piece.start + piece.width) - piece.start;
                let [_, derivatives @ ..] = piece.polynomials();
                for (found, c) in found.iter_mut().zip(derivatives).filter(|_| from <= to) {
                    found.join(&extremes(&shifted(&c, from), to - from), 0.0);
                }
            }
        }
        [0, 1, 2].map(|index: usize| {
            let Extremes { min, max, .. } = found[index];
            let peak = if min <= max { min.abs().max(max.abs()) } else { 0.0 };
            let by = [speed, speed.powi(2), speed.powi(3)][index];
            (peak * by * factor).abs()
        })
    }

    /// What the cam leaves of the limits on the way of the master in a time.
    pub(super) fn left(&self, time_s: f64) -> Result<Values, RampError> {
        let mut left = [f64::INFINITY; 3];
        for ((slot, quantity), peak) in left.iter_mut().zip(Quantity::ALL).zip(self.needed(time_s))
        {
            let (what, limit) = (quantity.name(), self.wish.limits.of(quantity));
            if peak >= limit {
                return Err(RampError::NoRoom { what, peak, limit });
            }
            *slot = limit - peak;
        }
        let [velocity, acceleration, jerk] = left;
        Ok([velocity, acceleration, acceleration, jerk])
    }

    /// A ramp of these values, and what comes of it.
    pub(super) fn ramp(&self, values: Values) -> Result<RampIn, RampError> {
        let [velocity_difference, acceleration, deceleration, ramp_jerk] = values;
        let (duration_s, moments) = self.moments(values, MOMENTS)?;
        let [.., of_cam] = self.needed(duration_s);
        let from = self.wish.slave;
        let mut ramp = RampIn {
            velocity_difference,
            acceleration,
            deceleration,
            ramp_jerk,
            duration_s,
            peak_velocity: from.velocity.abs(),
            peak_acceleration: 0.0,
            peak_jerk: ramp_jerk + of_cam,
            positions: [from.position; 2],
        };
        for (.., slave) in moments {
            ramp.peak_velocity = ramp.peak_velocity.max(slave.velocity.abs());
            ramp.peak_acceleration = ramp.peak_acceleration.max(slave.acceleration.abs());
            let [least, greatest] = ramp.positions;
            ramp.positions = [least.min(slave.position), greatest.max(slave.position)];
        }
        Ok(ramp)
    }

    /// How long a ramp of these values takes, s, and `count` moments of it; cam positions on the turn on which a rotary slave
    /// comes onto its cam.
    pub(super) fn moments(
        &self,
        [velocity, acceleration, deceleration, jerk]: Values,
        count: u32,
    ) -> Result<(f64, impl Iterator<Item = Moment>), RampError> {
        let limits = AxisLimits { velocity, acceleration, deceleration, jerk };
        let (approach, turned) = Approach::new(self.gap, limits, self.wish.ramp)?;
        let duration_s = approach.profile().duration();
        let problem = *self;
        let moment = move |index: u32| {
            let time_s = duration_s * f64::from(index) / f64::from(count);
            let mut cam = problem.cam_at(time_s);
            cam.position -= turned;
            (time_s, cam, approach.at(time_s, cam).unwrap_or(cam))
        };
        Ok((duration_s, (0..=count).map(moment)))
    }

    /// The limit that a ramp exceeds: of the position, or one that the slave exceeds already at its start.
    pub(super) fn beyond(&self, ramp: &RampIn) -> Option<RampError> {
        let ([low, high], [least, greatest]) = (self.wish.position, ramp.positions);
        let room = ROUNDING * (greatest - least + greatest.abs());
        let moves = [Quantity::Velocity, Quantity::Acceleration].map(|of| {
            let limit = self.wish.limits.of(of);
            (of.name(), ramp.peak(of), limit, ramp.peak(of) - limit * (1.0 + ROUNDING))
        });
        let ends = [("position", least, low, low - room - least)];
        let ends = ends.into_iter().chain([("position", greatest, high, greatest - high - room)]);
        let found = ends.chain(moves).find(|(.., by)| *by > 0.0);
        found.map(|(what, reached, limit, _)| RampError::Beyond { what, reached, limit })
    }
}
