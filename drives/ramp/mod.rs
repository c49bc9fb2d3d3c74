//! The profile generator of one axis, as all drive families have it: what a device makes of a move to a target.
//!
//! The axis starts at its start/stop speed, accelerates, cruises, decelerates to the start/stop speed and rests on
//! the target. If it already moves, speed stays continuous: it slows down to a lower speed, or brakes, reverses and
//! returns when the target lies behind it or too near to stop at (InterpCNC "Commande 80"; SmartDRIVE GOTO, whose
//! start/stop speed is 0; BIM2AX moves, which are never retargeted).
//!
//! A motion is planned once, in closed form, as a few stretches of constant acceleration from the instant of the
//! command; asking for the state at any later instant depends on nothing in between. Emulators move by it, and
//! drivers foresee by it where a device will be when the next command reaches it.

#[cfg(test)]
mod tests;

/// Limits and target of a motion, in steps and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// Speed at which the axis may start and stop at once, steps/s.
    pub start_stop: f64,
    /// Steps/s², more than zero.
    pub acceleration: f64,
    /// Steps/s, more than zero.
    pub speed: f64,
    /// Steps/s², more than zero.
    pub deceleration: f64,
    /// Steps.
    pub target: f64,
}

/// Ways shorter than this are rounding errors (positions of 32 bits), steps.
const TOLERANCE: f64 = 1e-6;

/// Position and velocity, steps and steps/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Steps.
    pub position: f64,
    /// Steps/s.
    pub velocity: f64,
}

/// A stretch of constant acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Stretch {
    duration: f64,
    state: State,
    acceleration: f64,
}

impl Stretch {
    fn at(&self, time: f64) -> State {
        State {
            position: self.state.position
                + (self.state.velocity + 0.5 * self.acceleration * time) * time,
            velocity: self.state.velocity + self.acceleration * time,
        }
    }
}

/// A motion from one instant on: at most a brake before reversing, then up (or down) to speed, cruise and final brake.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    start_ns: i64,
    stretches: [Stretch; 4],
    end_s: f64,
    rest: f64,
    /// Duration of the final brake, s.
    final_brake_s: f64,
    /// Sign of the velocity with which it ends; 0 if it never moves.
    final_sense: f64,
}

impl Motion {
    /// Standing at `position`.
    pub fn at_rest(position: f64) -> Self {
        Self { rest: position, ..Self::default() }
    }

    /// The motion that a move command given at `start_ns` makes of `state`.
    pub fn plan(start_ns: i64, mut state: State, ramp: &Ramp) -> Self {
        let mut stretches = [Stretch::default(); 4];
        let mut final_sense = if state.velocity == 0.0 { 0.0 } else { state.velocity.signum() };
        let [turn, change, cruise, brake] = &mut stretches;
        // Below the start/stop frequency a motion has no ramp.
        let base = ramp.start_stop.min(ramp.speed);
        let base_v2 = base * base;
        let half_up = 0.5 / ramp.acceleration;
        let half_down = 0.5 / ramp.deceleration;

        let ahead = |state: &State| (ramp.target - state.position) * state.velocity.signum();
        let stopping = (state.velocity * state.velocity - base_v2).max(0.0) * half_down;
        let overshoots = stopping > ahead(&state) + TOLERANCE;
        if state.velocity != 0.0 && (overshoots || ahead(&state) <= 0.0) {
            let slow = base.min(state.velocity.abs());
            let (stretch, stopped) =
                stretch_to(state, state.velocity.signum(), slow, ramp.deceleration);
            *turn = stretch;
            state = State { position: stopped.position, velocity: 0.0 };
        }

        let sense = (ramp.target - state.position).signum();
        let distance = (ramp.target - state.position).abs();
        let speed = (state.velocity * sense).max(base);
        if distance > TOLERANCE {
            final_sense = sense;
            state.velocity = sense * speed;
            if speed > ramp.speed {
                (*change, state) = stretch_to(state, sense, ramp.speed, ramp.deceleration);
            } else {
                // Where the way is too short for the full speed, ramps meet at the peak.
                let peak_v2 = (distance + speed * speed * half_up + base_v2 * half_down)
                    / (half_up + half_down);
                let peak = peak_v2.sqrt().clamp(speed, ramp.speed.max(speed));
                (*change, state) = stretch_to(state, sense, peak, ramp.acceleration);
            }
            let peak = state.velocity.abs();
            let braking = (peak * peak - base_v2).max(0.0) * half_down;
            let cruising = ((ramp.target - state.position) * sense - braking).max(0.0);
            *cruise = Stretch { duration: cruising / peak, state, acceleration: 0.0 };
            state.position += sense * cruising;
            (*brake, _) = stretch_to(state, sense, base.min(peak), ramp.deceleration);
        }
        let end_s = stretches.iter().map(|stretch| stretch.duration).sum();
        Self {
            start_ns,
            stretches,
            end_s,
            rest: ramp.target,
            final_brake_s: stretches[3].duration,
            final_sense,
        }
    }

    /// The motion that brings `state` to `velocity` (with sign, steps/s) and keeps it there for ever; a reversal brakes
    /// with `deceleration` and accelerates again with `acceleration`, steps/s² (SmartDRIVE START).
    pub fn run(
        start_ns: i64,
        mut state: State,
        velocity: f64,
        acceleration: f64,
        deceleration: f64,
    ) -> Self {
        let mut stretches = [Stretch::default(); 4];
        let [turn, change, cruise, _] = &mut stretches;
        let sense = if velocity == 0.0 { state.velocity.signum() } else { velocity.signum() };
        if state.velocity * sense < 0.0 {
            (*turn, state) = stretch_to(state, -sense, 0.0, deceleration);
        }
        let rate = if velocity.abs() < state.velocity.abs() { deceleration } else { acceleration };
        (*change, state) = stretch_to(state, sense, velocity.abs(), rate);
        *cruise = Stretch { duration: f64::INFINITY, state, acceleration: 0.0 };
        Self {
            start_ns,
            stretches,
            end_s: f64::INFINITY,
            rest: state.position,
            final_brake_s: 0.0,
            final_sense: sense,
        }
    }

    /// True once the speed no longer changes, or for good at the end.
    pub fn at_speed(&self, time_ns: i64) -> bool {
        let [turn, change, ..] = &self.stretches;
        self.elapsed(time_ns) >= turn.duration + change.duration
    }

    /// Sign of the velocity with which it ends; 0 if it never moves.
    pub fn final_sense(&self) -> f64 {
        self.final_sense
    }

    /// The motion that a ramp stop (commands 41, 42) given at `start_ns` makes of `state`: it ends on the whole step
    /// nearest to where the ramp ends.
    pub fn stop(start_ns: i64, state: State, ramp: &Ramp) -> Self {
        let slow = ramp.start_stop.min(state.velocity.abs());
        let (brake, stopped) = stretch_to(state, state.velocity.signum(), slow, ramp.deceleration);
        let mut stretches = [Stretch::default(); 4];
        stretches[0] = brake;
        let final_sense = if state.velocity == 0.0 { 0.0 } else { state.velocity.signum() };
        let rest = stopped.position.round();
        Self {
            start_ns,
            stretches,
            end_s: brake.duration,
            rest,
            final_brake_s: brake.duration,
            final_sense,
        }
    }

    /// Position and velocity at an instant; before the start as at the start.
    pub fn at(&self, time_ns: i64) -> State {
        let mut time = self.elapsed(time_ns);
        if time >= self.end_s {
            return State { position: self.rest, velocity: 0.0 };
        }
        for stretch in &self.stretches {
            if time < stretch.duration {
                return stretch.at(time);
            }
            time -= stretch.duration;
        }
        State { position: self.rest, velocity: 0.0 }
    }

    /// True until the motion has ended.
    pub fn moving(&self, time_ns: i64) -> bool {
        self.elapsed(time_ns) < self.end_s
    }

    /// The first instant at which it has ended, ns.
    pub fn end_ns(&self) -> i64 {
        let mut time_ns = nanoseconds(self.end_s);
        // Seconds and nanoseconds round differently: by a nanosecond or, after years, by a few.
        while self.elapsed(self.start_ns.saturating_add(time_ns)) < self.end_s && time_ns < i64::MAX
        {
            time_ns = time_ns.saturating_add(1 + time_ns / (1 << 52));
        }
        self.start_ns.saturating_add(time_ns)
    }

    /// The first instant after `after_ns` at which the axis is on the other side of `edge` than at `after_ns`, ns; on
    /// the far side is a point on the edge or beyond it in positive direction.
    pub fn crossing(&self, after_ns: i64, edge: f64) -> Option<i64> {
        let beyond = |time_ns: i64| self.at(time_ns).position >= edge;
        let here = beyond(after_ns);
        // Between these instants the axis moves in one direction only.
        let mut from_ns = after_ns;
        for until_ns in [self.turn_ns(), self.end_ns()] {
            if until_ns <= from_ns {
                continue;
            }
            if beyond(until_ns) != here {
                let (mut low, mut high) = (from_ns, until_ns);
                while high - low > 1 {
                    let middle = i64::midpoint(low, high);
                    if beyond(middle) == here { low = middle } else { high = middle }
                }
                return Some(high);
            }
            from_ns = until_ns;
        }
        None
    }

    /// Whether it brakes in order to reverse, or to turn back to a target that lies behind.
    pub fn turns(&self) -> bool {
        let [turn, ..] = &self.stretches;
        turn.duration > 0.0 && self.end_s > turn.duration
    }

    /// The instant at which it has braked in order to reverse, ns; its start if it does not.
    pub fn turn_ns(&self) -> i64 {
        let [turn, ..] = &self.stretches;
        self.start_ns.saturating_add(nanoseconds(turn.duration))
    }

    /// The same motion so much later.
    #[must_use]
    pub fn later(mut self, ns: i64) -> Self {
        self.start_ns = self.start_ns.saturating_add(ns);
        self
    }

    /// The same motion somewhere else, `by` steps farther.
    #[must_use]
    pub fn shifted(mut self, by: f64) -> Self {
        for stretch in &mut self.stretches {
            stretch.state.position += by;
        }
        self.rest += by;
        self
    }

    /// Sign of the velocity at an instant, after the end of the last velocity; 0 if it never moves.
    pub fn sense(&self, time_ns: i64) -> f64 {
        let velocity = self.at(time_ns).velocity;
        if velocity == 0.0 { self.final_sense } else { velocity.signum() }
    }

    /// True while it brakes to stand on the target.
    pub fn in_final_brake(&self, time_ns: i64) -> bool {
        let time = self.elapsed(time_ns);
        time < self.end_s && time >= self.end_s - self.final_brake_s
    }

    fn elapsed(&self, time_ns: i64) -> f64 {
        seconds(time_ns.saturating_sub(self.start_ns).max(0))
    }
}

/// The stretch from `state`, which moves in the sense of `sense` or rests, to `speed` in that sense, and the state at
/// its end. At that speed already it has no duration.
fn stretch_to(state: State, sense: f64, speed: f64, rate: f64) -> (Stretch, State) {
    let change = speed - state.velocity.abs();
    let stretch = Stretch {
        duration: change.abs() / rate,
        state,
        acceleration: sense * change.signum() * rate,
    };
    if stretch.duration > 0.0 {
        (stretch, State { velocity: sense * speed, ..stretch.at(stretch.duration) })
    } else {
        (Stretch::default(), state)
    }
}

/// Nanoseconds as seconds.
#[expect(
    clippy::cast_precision_loss,
    reason = "spans of at most days: the rounding is below a nanosecond"
)]
pub fn seconds(ns: i64) -> f64 {
    ns as f64 * 1e-9
}

/// Seconds as nanoseconds, to the nearest.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a float cast saturates, and spans are far from the limit"
)]
pub fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

/// A duration in whole nanoseconds.
pub fn whole_ns(duration: std::time::Duration) -> i64 {
    i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)
}
