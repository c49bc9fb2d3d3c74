//! The commands that make sense for an axis, and which of them keeps it nearest to the plan.

use super::{Registers, TOLERANCE, Tracked, window::AxisWindow};
use crate::ramp::{Motion, Ramp, State, nanoseconds};

/// Parts of a round in which a cruise may change its speed.
const RAMP_PARTS: [f64; 4] = [0.2, 0.5, 0.8, 1.0];
/// Part of the position error that a round makes good.
const CORRECTION: f64 = 0.7;
/// How long after the next command is due an axis still need not brake for its target: rounds and s. Long enough for
/// a master that the operating system keeps waiting; what a master that dies leaves undone is not much longer.
const MARGIN_ROUNDS: f64 = 1.5;
const MARGIN_S: f64 = 0.03;
/// Parts of a round at which a motion is compared with the plan: also after it, as the next command may be late.
pub(super) const COMPARED: [f64; 5] = [0.25, 0.5, 0.75, 1.0, 1.25];

/// One axis at the instant at which a command can reach it.
pub(super) struct Candidates<'a, R> {
    pub(super) axis: &'a Tracked<R>,
    pub(super) plan: AxisWindow<'a>,
    pub(super) executed_ns: i64,
    /// Time until the next command, s.
    pub(super) round: f64,
}

impl<R: Registers> Candidates<'_, R> {
    fn after(&self, part: f64) -> i64 {
        self.executed_ns + nanoseconds(part * self.round)
    }

    pub(super) fn motion(&self, order: &R::Move) -> Motion {
        let ramp = self.axis.registers.ramp(order);
        Motion::plan(self.executed_ns, self.axis.motion.at(self.executed_ns), &ramp)
    }

    /// How far a motion is from the plan, increments². A wrong speed at the end of the round counts as half the
    /// distance it makes in the next.
    pub(super) fn cost(&self, motion: &Motion) -> f64 {
        let apart = |part: f64| {
            let time_ns = self.after(part);
            motion.at(time_ns).position - self.plan.at(time_ns).position
        };
        let end_ns = self.after(1.0);
        let speed = motion.at(end_ns).velocity - self.plan.at(end_ns).velocity;
        COMPARED.iter().map(|part| apart(*part).powi(2)).sum::<f64>()
            + (0.5 * self.round * speed).powi(2)
    }

    pub(super) fn profiles(&self) -> Vec<R::Move> {
        let mut out = Vec::with_capacity(16);
        let now = self.axis.motion.at(self.executed_ns);
        let start = self.plan.at(self.executed_ns);
        let end = self.plan.at(self.after(1.0));
        let way =
            end.position - now.position - (1.0 - CORRECTION) * (start.position - now.position);
        for part in RAMP_PARTS {
            out.extend(self.cruise(now, way, part));
        }
        for sense in [1.0, -1.0] {
            self.rest(now, sense, &mut out);
        }
        self.turn(now, end, &mut out);
        if self.axis.registers.speed_step() * self.round > TOLERANCE {
            // Slower than the slowest speed the axis goes by moves from rest to rest.
            out.extend(self.hop(now, end));
        }
        out
    }

    /// Largest acceleration and deceleration, steps/s².
    fn limits(&self) -> (f64, f64) {
        let limits = self.axis.registers.limits();
        (limits.acceleration, limits.deceleration)
    }

    /// Makes `way` in the round, changing speed during about `part` of it, and goes on.
    fn cruise(&self, now: State, way: f64, part: f64) -> Option<R::Move> {
        // way = v₀·T + w·T − sgn(w)·w²/(2·rate), w = change of speed; with a ramp of part·T, w²/rate = |w|·part·T.
        let lack = way - now.velocity * self.round;
        let change = lack / (self.round * (1.0 - 0.5 * part));
        let rate = change.abs() / (part * self.round);
        let (most_up, most_down) = self.limits();
        let slower = change * now.velocity < 0.0;
        let rate = self.axis.registers.whole_rate(rate, if slower { most_down } else { most_up });
        // The rate is rounded and limited: solve again for the change.
        let reach = rate * self.round;
        let change =
            lack.signum() * (reach - (reach * reach - 2.0 * rate * lack.abs()).max(0.0).sqrt());
        let velocity = now.velocity + change;
        let sense = velocity.signum();
        let most = self.most_speed(now.position + way, sense);
        let speed = self.axis.registers.whole_speed(velocity.abs().min(most));
        if speed < 1.0 {
            return None;
        }
        // Ramps down are gentle where the way allows, else as steep as allowed.
        let down = if slower || R::ONE_RATE { rate.max(0.25 * most_down) } else { most_down };
        let margin = MARGIN_ROUNDS * self.round + MARGIN_S;
        let clear = now.position + way + sense * speed * margin;
        let from = if self.plan.at(self.executed_ns).velocity * sense >= 0.0 { 0.0 } else { 1.0 };
        let wanted = clear + sense * speed * speed * 0.5 / down;
        // An axis that was left behind goes to where the plan is at least, not to where it has been.
        let planned = self.plan.at(self.after(from)).position;
        let wanted = if (planned - wanted) * sense > 0.0 { planned } else { wanted };
        let target = self.plan.reached(self.after(from), sense, wanted);
        let left = ((target - clear) * sense).max(1.0);
        let down = down.max(speed * speed * 0.5 / left);
        let up = match (R::ONE_RATE, slower) {
            (true, _) => down,
            (false, true) => most_up,
            (false, false) => rate,
        };
        ((target - now.position) * sense > 0.5).then(|| self.profile(up, speed, down, target))
    }

    /// The largest speed at which an axis at `position` can still stop where the plan rests or turns, unless the plan
    /// itself is faster, and that it may have at all.
    fn most_speed(&self, position: f64, sense: f64) -> f64 {
        let left = self.plan.reached(self.executed_ns, sense, sense * f64::INFINITY) - position;
        let (_, most_down) = self.limits();
        let stops = (2.0 * most_down * (left * sense).max(0.0)).sqrt();
        let planned = self.plan.at(self.after(1.0)).velocity * sense;
        self.axis.most_speed().min(stops.max(planned))
    }

    /// Stands on the next point of rest or turning point, if there is one to be reached soon.
    fn rest(&self, now: State, sense: f64, out: &mut Vec<R::Move>) {
        let target = self.plan.reached(self.executed_ns, sense, sense * f64::INFINITY).round();
        let way = (target - now.position) * sense;
        if way < 0.5 {
            return;
        }
        let (most_up, most_down) = self.limits();
        let limits = self.axis.registers.limits();
        let base = limits.start_stop;
        let speed = (now.velocity * sense).max(0.0);
        if speed > base {
            // Brakes from now on, all the way to the target.
            let down = (speed * speed - base * base) * 0.5 / way;
            let up = if R::ONE_RATE { down } else { most_up };
            out.push(self.profile(up, speed, down, target));
        }
        for part in [0.5, 1.0, 2.0] {
            out.push(self.profile(most_up, way / (part * self.round), most_down, target));
        }
        out.push(self.profile(most_up, limits.speed, most_down, target));
    }

    /// Brakes, reverses and has the plan's speed at the end of the round.
    fn turn(&self, now: State, end: State, out: &mut Vec<R::Move>) {
        let sense = end.velocity.signum();
        let speed = end.velocity.abs();
        if speed < 1.0 || now.velocity * sense >= 0.0 {
            return;
        }
        let (most_up, most_down) = self.limits();
        let clear = end.position + sense * speed * (MARGIN_ROUNDS * self.round + MARGIN_S);
        let rate = (end.velocity - now.velocity).abs() / self.round;
        for (up, down) in [(rate, rate), (most_up, most_down)] {
            let wanted = clear + sense * speed * speed * 0.5 / down.min(most_down);
            let target = self.plan.reached(self.after(1.0), sense, wanted);
            out.push(self.profile(up, speed, down, target));
        }
    }

    /// Goes to where the plan is at the end of the round and rests there.
    fn hop(&self, now: State, end: State) -> Option<R::Move> {
        let target = end.position.round();
        let way = (target - now.position).abs();
        let (most_up, most_down) = self.limits();
        (way > 0.5).then(|| self.profile(most_up, way / self.round, most_down, target))
    }

    /// The move nearest to what is wanted.
    fn profile(&self, up: f64, speed: f64, down: f64, target: f64) -> R::Move {
        let limits = self.axis.registers.limits();
        let speed = speed.min(self.axis.most_speed());
        let wanted = Ramp { acceleration: up, speed, deceleration: down, target, ..limits };
        self.axis.registers.encode(&wanted)
    }
}
