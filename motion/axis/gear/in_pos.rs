//! `SMC_GearInPos`: couples a slave to its master from a given position on.

use crate::ownership::Start;
use crate::{Axis, AxisState, Master, Motion, Progress, SmcError, Stage};
use twin_profile::{AxisLimits, Profile, RampType, State};

/// Velocity and position follow the master from a place on (`SMC_GearInPos`, manual 5.4). `done` is `InSync`, `StartSync`
/// is [`GearInPosRun::is_coupling`] and `Active` is [`Block::is_active`](crate::Block::is_active).
///
/// When the master is at `master_sync_position`, the slave is at `slave_sync_position` with the ratio of velocities.
/// Before that it follows a polynomial of fifth degree over the master's position, from its own velocity to that of
/// the ratio, with the curvature 0 at both ends; the manual only says a polynomial. It may reverse for a moment. With
/// sigmoid and parabolic ramps it begins with the slave's acceleration, which therefore does not step; its later change
/// follows from the positions and the master's velocity. While such a slave waits, it reduces its acceleration within its
/// jerk.
///
/// With a `master_start_distance` above 0 the slave goes on until the master is that close; with 0 it begins at once. A
/// moving slave waits until the master's velocity changes by less than a quarter in a cycle: over the positions of a master
/// that starts from rest it would be infinitely fast. A master that reverses meanwhile is an error 775. If the master's zero
/// moves (`MC_SetPosition`), the sync position moves with it until the slave begins.
#[doc(alias = "SMC_GearInPos")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearInPos {
    /// `RatioNumerator`.
    pub ratio_numerator: i32,
    /// `RatioDenominator`, not 0.
    pub ratio_denominator: i32,
    /// `MasterSyncPosition`, u of the master.
    pub master_sync_position: f64,
    /// `SlaveSyncPosition`, u.
    pub slave_sync_position: f64,
    /// `MasterStartDistance`, u of the master, not negative.
    pub master_start_distance: f64,
}

/// Coupling on its way.
#[derive(Clone, Debug)]
pub struct GearInPosRun {
    /// The master in the cycle before, and its place unwound.
    master: Master,
    unwound: f64,
    phase: Phase,
}

#[derive(Clone, Debug)]
enum Phase {
    /// The master is not there yet.
    Waiting,
    /// On the polynomial.
    Coupling(Quintic),
    /// Coupled: places of master (unwound) and slave that belong to each other.
    Coupled([f64; 2]),
}

impl GearInPosRun {
    /// `StartSync`: the slave is being coupled.
    #[must_use]
    pub fn is_coupling(&self) -> bool {
        matches!(self.phase, Phase::Coupling(_))
    }
}

/// y over x from (x0, y0) with slope v0 and curvature k0 on by h, where the curvature is 0.
#[derive(Clone, Copy, Debug)]
struct Quintic {
    x0: f64,
    h: f64,
    /// By powers of (x − x0) / h.
    coefficients: [f64; 6],
    /// Sync position of the slave, unwound.
    end: f64,
}

impl Quintic {
    fn new([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], [v0, v1]: [f64; 2], k0: f64) -> Self {
        let h = x1 - x0;
        let c2 = 0.5 * k0 * h * h;
        // Value, slope and half the curvature that the upper three add at the end.
        let rise = y1 - y0 - v0 * h - c2;
        let p = h * (v1 - v0) - 2.0 * c2;
        let coefficients = [
            y0,
            v0 * h,
            c2,
            10.0 * rise - 4.0 * p - c2,
            -15.0 * rise + 7.0 * p + 2.0 * c2,
            6.0 * rise - 3.0 * p - c2,
        ];
        Self { x0, h, coefficients, end: y1 }
    }

    /// Value, slope and curvature at x.
    fn at(&self, x: f64) -> [f64; 3] {
        let w = (x - self.x0) / self.h;
        let [c0, c1, c2, c3, c4, c5] = self.coefficients;
        let value = c0 + w * (c1 + w * (c2 + w * (c3 + w * (c4 + w * c5))));
        let slope = c1 + w * (2.0 * c2 + w * (3.0 * c3 + w * (4.0 * c4 + w * 5.0 * c5)));
        let curvature = 2.0 * c2 + w * (6.0 * c3 + w * (12.0 * c4 + w * 20.0 * c5));
        [value, slope / self.h, curvature / (self.h * self.h)]
    }
}

impl GearInPos {
    fn ratio(&self) -> f64 {
        f64::from(self.ratio_numerator) / f64::from(self.ratio_denominator)
    }

    /// The polynomial from the cycle before, if the master is close enough and as fast as it has to be.
    fn polynomial(&self, run: &GearInPosRun, master: &Master, axis: &Axis) -> Option<Quintic> {
        /// By which part of it the master's velocity may have changed.
        const STEADY: f64 = 0.25;
        let GearInPosRun { unwound, master: Master { velocity: before, acceleration, .. }, .. } =
            *run;
        let Master { velocity, period, .. } = *master;
        let from = axis.saved_base;
        let limited = axis.ramp() != RampType::Trapezoid;
        let at_rest = from.velocity == 0.0 && (from.acceleration == 0.0 || !limited);
        let steady = before != 0.0 && (velocity - before).abs() <= STEADY * before.abs();
        if !at_rest && !steady {
            return None;
        }
        let sign = velocity.signum();
        // The place ahead of the master, on a rotary one the next time round.
        let ahead = sign * (self.master_sync_position - unwound);
        let ahead = period.map_or(ahead, |period| {
            let ahead = crate::fmod(ahead, period);
            if ahead > 0.0 { ahead } else { period }
        });
        let near = self.master_start_distance == 0.0
            || ahead <= self.master_start_distance * (1.0 + 1e-12);
        if velocity == 0.0 || ahead <= 0.0 || !near {
            return None;
        }
        let slope = if at_rest { 0.0 } else { from.velocity / before };
        let curvature = if at_rest || !limited {
            0.0
        } else {
            (from.acceleration - slope * acceleration) / (before * before)
        };
        let slopes = [slope, self.ratio()];
        let way = sign * ahead;
        let target = axis.to_drive(self.slave_sync_position);
        // A rotary slave goes to the place that is nearest to the way of the mean velocity.
        let natural = from.position + 0.5 * (slopes[0] + slopes[1]) * way;
        let target = axis
            .period()
            .map_or(target, |period| target + period * ((natural - target) / period).round());
        let places = [from.position, target];
        Some(Quintic::new([unwound, unwound + way], places, slopes, curvature))
    }
}

impl Motion for GearInPos {
    type With = Master;
    type Run = GearInPosRun;
    const STATE: AxisState = AxisState::SynchronizedMotion;
    const GOES_ON: bool = true;

    fn plan(&self, _start: Start, _axis: &Axis, master: Master) -> Result<GearInPosRun, SmcError> {
        let places =
            [self.master_sync_position, self.slave_sync_position, self.master_start_distance];
        // The manual has no errors for inputs of this block: MC_GearIn's for the ratio, an invalid parameter's for positions.
        if self.ratio_denominator == 0 {
            return Err(SmcError::GiRatioDenom);
        }
        if !places.iter().all(|place| place.is_finite()) || self.master_start_distance < 0.0 {
            return Err(SmcError::WpParamInvalid);
        }
        Ok(GearInPosRun { master, unwound: master.position, phase: Phase::Waiting })
    }

    fn step(
        &self,
        run: &mut GearInPosRun,
        axis: &mut Axis,
        master: Master,
    ) -> Result<Progress, SmcError> {
        let travel = master.travel_since(&run.master);
        if matches!(run.phase, Phase::Waiting) {
            // The sync position is one of the program: until the slave begins, it moves with the zero.
            run.unwound += master.zero - run.master.zero;
            // From the cycle before, whose set-point the slave has, so that nothing steps.
            let polynomial = self.polynomial(run, &master, axis);
            if let Some(polynomial) = polynomial.filter(|_| travel != 0.0) {
                run.phase = Phase::Coupling(polynomial);
            }
        }
        run.master = master;
        run.unwound += travel;
        if let Phase::Coupling(polynomial) = &run.phase {
            if travel * polynomial.h < 0.0 {
                return Err(SmcError::GipMasterDirectionChange);
            }
            if (run.unwound - polynomial.x0) / polynomial.h >= 1.0 {
                let place = polynomial.x0 + polynomial.h;
                run.phase = Phase::Coupled([place, polynomial.end]);
            }
        }
        let on = |[value, slope, curvature]: [f64; 3]| State {
            position: value,
            velocity: slope * master.velocity,
            acceleration: slope * master.acceleration + curvature * master.velocity.powi(2),
        };
        let (setpoint, stage) = match &run.phase {
            Phase::Waiting => (axis.goes_on(), Stage::Busy),
            Phase::Coupling(polynomial) => (on(polynomial.at(run.unwound)), Stage::Busy),
            Phase::Coupled([place, slave]) => {
                let value = slave + self.ratio() * (run.unwound - place);
                (on([value, self.ratio(), 0.0]), Stage::Reached)
            }
        };
        Ok(Progress { setpoint, stage })
    }
}

impl Axis {
    /// One cycle on at the present velocity; with limited jerk at the velocity after the acceleration has ended.
    fn goes_on(&self) -> State {
        let State { position, velocity, acceleration } = self.saved_base;
        let cycle = self.cycle();
        let on = State { position: position + velocity * cycle, velocity, acceleration: 0.0 };
        if self.ramp() == RampType::Trapezoid || acceleration == 0.0 {
            return on;
        }
        let jerk = self.values.max_jerk;
        let settled = velocity + 0.5 * acceleration * acceleration.abs() / jerk;
        let limits = AxisLimits {
            velocity: settled.abs().max(velocity.abs()).max(f64::MIN_POSITIVE),
            acceleration: acceleration.abs(),
            deceleration: acceleration.abs(),
            jerk,
        };
        // Without a valid jerk the velocity is kept.
        Profile::to_velocity(self.saved_base, settled, limits, self.ramp())
            .map_or(on, |profile| profile.at(cycle))
    }
}
