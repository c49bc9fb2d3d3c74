//! The trajectory generator of one drive: what START, STOP, GOTO and STEP make of its motion.
//!
//! Every command comes with its time, and every later instant has a state. Emulated device and prediction
//! move by it.
//!
//! Source: "SmartDRIVE v1.2 - Protocole série ATB", sections START to GOTO, "Paramètres de configuration" (ceilings).
//! Where the manual is silent it goes by [`Assumptions`]. Beyond those: larger speeds and rates than the ceilings are
//! clamped to them unless the device refuses them first; position limits count where the lower is below the upper, and
//! START then rests on the limit; a STEP to where no counter of 32 bits goes is refused (BADPARAMS), or ends at the last
//! position there is, as with position limits; a move towards an active limit switch stops where it is.

#[cfg(test)]
mod tests;

use crate::{
    Assumptions, LimitStop, RejectCode, StepFrom, TrajectoryFlags, ZeroRate,
    protocol::units::StepsPerTurn,
};
use twin_drives::ramp::{Motion, Ramp, State};

/// A rate that brings any speed to rest within less than a µs, µsteps/s².
const WITHOUT_RAMP: f64 = 1e12;

/// Ceilings of speeds, rates and positions: parameters 26 to 33, 43 and 44.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ceilings {
    /// Full steps × divisor.
    pub(crate) turn: StepsPerTurn,
    /// `Trj_VelMax`, rpm.
    pub(crate) velocity: u16,
    /// `Trj_AccMax`, rpm/s.
    pub(crate) acceleration: u16,
    /// `Trj_DecMax`, rpm/s; 0: see [`Assumptions::zero_rate`].
    pub(crate) deceleration: u16,
    /// `Trj_DecLim`, rpm/s; 0: as with `Trj_DecMax`.
    pub(crate) emergency: u16,
    /// `Trj_PosMin` and `Trj_PosMax`, µsteps; they limit nothing unless the first is below the second.
    pub(crate) positions: (i32, i32),
    /// What the manual leaves open.
    pub(crate) assumptions: Assumptions,
}

impl Ceilings {
    /// A rate, 0 for the largest, as µsteps/s².
    fn rate(&self, asked: u16, ceiling: u16) -> f64 {
        let ceiling = match (ceiling, self.assumptions.zero_rate) {
            (0, ZeroRate::Unlimited) if asked == 0 => return WITHOUT_RAMP,
            (0, ZeroRate::Unlimited) => u16::MAX,
            (0, ZeroRate::AsAcceleration) => self.acceleration,
            (ceiling, _) => ceiling,
        };
        let rate = if asked == 0 { ceiling } else { asked.min(ceiling) };
        self.turn.steps(f64::from(rate.max(1)))
    }

    /// With what a motion brakes on a limit switch, µsteps/s².
    fn limit_rate(&self) -> f64 {
        match self.assumptions.limit_stop {
            LimitStop::Emergency => self.rate(0, self.emergency),
            LimitStop::Deceleration => self.rate(0, self.deceleration),
            LimitStop::AtOnce => WITHOUT_RAMP,
        }
    }

    /// A speed, 0 for the largest, as µsteps/s.
    fn speed(&self, asked: u16) -> f64 {
        let speed = if asked == 0 { self.velocity } else { asked.min(self.velocity) };
        self.turn.steps(f64::from(speed.max(1)))
    }

    /// Whether a speed and a rate are no more than their ceilings; the rate counts for both ramps.
    pub(crate) fn allow(&self, speed: u16, rate: u16) -> bool {
        speed <= self.velocity && rate <= self.acceleration
    }

    /// What a GOTO makes of its numbers.
    pub(crate) fn ramp(&self, target: i32, speed: u16, rate: u16) -> Ramp {
        Ramp {
            start_stop: 0.0,
            acceleration: self.rate(rate, self.acceleration),
            speed: self.speed(speed),
            deceleration: self.rate(rate, self.deceleration),
            target: f64::from(target),
        }
    }

    /// Lower and upper position limit, if there are limits, µsteps.
    fn limits(&self) -> Option<(f64, f64)> {
        let (low, high) = self.positions;
        (low < high).then(|| (f64::from(low), f64::from(high)))
    }
}

/// What is to be reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Goal {
    /// The end of the motion: a target, or rest.
    End,
    /// The speed asked for, unless the motion ends before.
    Speed,
    /// Nothing: a switch or a stall has stopped the motion before its goal.
    Missed,
}

/// Position, speed and goal of the motor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Generator {
    motion: Motion,
    goal: Goal,
    /// Of the GOTO or STEP that the motion is for.
    target: Option<i32>,
    /// Rates of the last command, for the variables that show them, µsteps/s².
    rates: (f64, f64),
    /// What has stopped the motion, and whether the trigger has fired, until the next one begins.
    stopped_by: TrajectoryFlags,
    /// Whether LIMP and LIMN are active.
    switches: (bool, bool),
}

impl Generator {
    /// At rest at `position`.
    pub(crate) fn at_rest(position: f64) -> Self {
        Self {
            motion: Motion::at_rest(position),
            goal: Goal::End,
            target: None,
            rates: (0.0, 0.0),
            stopped_by: TrajectoryFlags::NONE,
            switches: (false, false),
        }
    }

    /// GOTO: to `target` with at most `speed` rpm and `rate` rpm/s, 0 for the largest.
    pub(crate) fn go_to(
        &mut self,
        now_ns: i64,
        ceilings: &Ceilings,
        target: i32,
        speed: u16,
        rate: u16,
    ) -> Result<(), RejectCode> {
        let mut ramp = ceilings.ramp(target, speed, rate);
        if let Some((low, high)) = ceilings.limits() {
            if !(low..=high).contains(&ramp.target) && !ceilings.assumptions.clamps_targets {
                return Err(RejectCode::BadParams);
            }
            ramp.target = ramp.target.clamp(low, high);
        }
        self.begin(now_ns, ceilings, Motion::plan(now_ns, self.state(now_ns), &ramp), Goal::End);
        self.target = (self.goal == Goal::End).then_some(saturated(ramp.target));
        self.rates = (ramp.acceleration, ramp.deceleration);
        Ok(())
    }

    /// STEP: as GOTO, `distance` from where the set-point is or is going. One that no position of 32 bits would end is a target
    /// beyond a limit.
    pub(crate) fn step(
        &mut self,
        now_ns: i64,
        ceilings: &Ceilings,
        distance: i32,
        speed: u16,
        rate: u16,
    ) -> Result<(), RejectCode> {
        let from = match ceilings.assumptions.step_from {
            StepFrom::Setpoint => None,
            StepFrom::Target => self.target,
        };
        let from = from.unwrap_or_else(|| self.counter(now_ns));
        let target = match from.checked_add(distance) {
            Some(target) => target,
            None if ceilings.assumptions.clamps_targets => from.saturating_add(distance),
            None => return Err(RejectCode::BadParams),
        };
        self.go_to(now_ns, ceilings, target, speed, rate)
    }

    /// START: to `speed` rpm, with sign, at `rate` rpm/s, 0 for the largest. A speed of 0 is rest.
    pub(crate) fn start(&mut self, now_ns: i64, ceilings: &Ceilings, speed: i16, rate: u16) {
        if speed == 0 {
            return self.stop(now_ns, ceilings, rate);
        }
        let state = self.state(now_ns);
        let sense = if speed < 0 { -1.0 } else { 1.0 };
        let ramp = ceilings.ramp(0, speed.unsigned_abs(), rate);
        let motion = if let Some((low, high)) = ceilings.limits() {
            let target = if sense > 0.0 {
                high.max(state.position.round())
            } else {
                low.min(state.position.round())
            };
            Motion::plan(now_ns, state, &Ramp { target, ..ramp })
        } else {
            let velocity = sense * ramp.speed;
            Motion::run(now_ns, state, velocity, ramp.acceleration, ramp.deceleration)
        };
        self.begin(now_ns, ceilings, motion, Goal::Speed);
        self.rates = (ramp.acceleration, ramp.deceleration);
    }

    /// STOP: to rest at `rate` rpm/s, 0 for the largest.
    pub(crate) fn stop(&mut self, now_ns: i64, ceilings: &Ceilings, rate: u16) {
        let rate = ceilings.rate(rate, ceilings.deceleration);
        self.brake(now_ns, rate);
        self.goal = Goal::End;
        self.stopped_by = TrajectoryFlags::NONE;
        self.rates.1 = rate;
    }

    /// Stands where it is: the power is off, or the rotor is blocked.
    pub(crate) fn freeze(&mut self, now_ns: i64, because: TrajectoryFlags) {
        if because != TrajectoryFlags::NONE && self.in_motion(now_ns) {
            self.goal = Goal::Missed;
            self.stopped_by = self.stopped_by.union(because);
        }
        self.motion = Motion::at_rest(f64::from(self.counter(now_ns)));
        self.target = None;
    }

    /// Stands at `position`, which is where it is from now on; moves and flags are forgotten.
    pub(crate) fn reset(&mut self, position: i32) {
        *self = Self { switches: self.switches, ..Self::at_rest(f64::from(position)) };
    }

    /// The trigger has fired, or has not; the next motion forgets it.
    pub(crate) fn set_triggered(&mut self, fired: bool) {
        let without = self.stopped_by.without(TrajectoryFlags::TRIGGERED);
        self.stopped_by = if fired { without.union(TrajectoryFlags::TRIGGERED) } else { without };
    }

    /// LIMP and LIMN are active or not: a motion towards an active one brakes.
    pub(crate) fn set_switches(
        &mut self,
        now_ns: i64,
        ceilings: &Ceilings,
        positive: bool,
        negative: bool,
    ) {
        self.switches = (positive, negative);
        self.obey_switches(now_ns, ceilings);
    }

    fn begin(&mut self, now_ns: i64, ceilings: &Ceilings, motion: Motion, goal: Goal) {
        let before = self.motion;
        self.motion = motion;
        self.goal = goal;
        self.target = None;
        self.stopped_by = TrajectoryFlags::NONE;
        if let Some(flag) = self.towards_switch(now_ns) {
            // From what it was doing: the new motion may have been away from the switch at first.
            self.motion = before;
            self.brake(now_ns, ceilings.limit_rate());
            self.miss(flag);
        }
    }

    /// The flag of the active switch that the motion goes to, now or in the end.
    fn towards_switch(&self, now_ns: i64) -> Option<TrajectoryFlags> {
        if !self.motion.moving(now_ns) {
            return None;
        }
        let senses = [self.state(now_ns).velocity, self.motion.final_sense()];
        if self.switches.0 && senses.iter().any(|sense| *sense > 0.0) {
            Some(TrajectoryFlags::LIMITED_P)
        } else if self.switches.1 && senses.iter().any(|sense| *sense < 0.0) {
            Some(TrajectoryFlags::LIMITED_N)
        } else {
            None
        }
    }

    fn obey_switches(&mut self, now_ns: i64, ceilings: &Ceilings) {
        if let Some(flag) = self.towards_switch(now_ns)
            && self.goal != Goal::Missed
        {
            self.brake(now_ns, ceilings.limit_rate());
            self.miss(flag);
        }
    }

    fn miss(&mut self, flag: TrajectoryFlags) {
        self.goal = Goal::Missed;
        self.stopped_by = self.stopped_by.union(flag).union(TrajectoryFlags::LIMITED);
    }

    fn brake(&mut self, now_ns: i64, rate: f64) {
        let ramp = Ramp {
            start_stop: 0.0,
            acceleration: rate,
            speed: 1.0,
            deceleration: rate,
            target: 0.0,
        };
        self.motion = Motion::stop(now_ns, self.state(now_ns), &ramp);
        self.target = None;
    }

    /// Position and velocity between the µsteps, µsteps and µsteps/s.
    pub(crate) fn state(&self, now_ns: i64) -> State {
        self.motion.at(now_ns)
    }

    /// Target of the GOTO or STEP taken last, while it holds.
    pub(crate) fn target(&self) -> Option<i32> {
        self.target
    }

    /// Position counter: whole µsteps, 32 bits that overflow as the device's.
    #[expect(clippy::cast_possible_truncation, reason = "the counter keeps the low 32 bits")]
    pub(crate) fn counter(&self, now_ns: i64) -> i32 {
        self.state(now_ns).position.round() as i64 as i32
    }

    /// Whether the speed is not 0.
    pub(crate) fn in_motion(&self, now_ns: i64) -> bool {
        self.state(now_ns).velocity != 0.0
    }

    /// Whether a motion has not ended yet.
    pub(crate) fn is_under_way(&self, now_ns: i64) -> bool {
        self.motion.moving(now_ns)
    }

    /// Acceleration and deceleration of the last command, µsteps/s².
    pub(crate) fn rates(&self) -> (f64, f64) {
        self.rates
    }

    /// The state of the generator as the device reports it.
    pub(crate) fn flags(&self, now_ns: i64) -> TrajectoryFlags {
        let done = match self.goal {
            Goal::End => !self.motion.moving(now_ns),
            Goal::Speed => self.motion.at_speed(now_ns) && self.in_motion(now_ns),
            Goal::Missed => false,
        };
        let mut flags = self.stopped_by;
        if done {
            flags = flags.union(TrajectoryFlags::DONE);
        }
        if self.in_motion(now_ns) {
            flags = flags.union(TrajectoryFlags::IN_MOTION);
        }
        flags
    }
}

/// A target as GOTO has it.
#[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
fn saturated(target: f64) -> i32 {
    target as i32
}
