//! The sequence: what is seen, what is to be done.

use super::{History, HomingFault, HomingOptions};

/// Looks without motion after which an axis that has been sent off counts as arrived: the first may be from before it
/// began to move.
const LOOKS_AT_REST: u8 = 2;

/// Look at the axis. Switch and position may be of different instants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Time of the position, ns.
    pub time_ns: i64,
    /// Position, u.
    pub position: f64,
    /// Whether the axis moves.
    pub moving: bool,
    /// Time of the switch, ns.
    pub switch_ns: i64,
    /// `bEndSwitch`: true if the switch is open.
    pub open: bool,
    /// `fIndexPosition` where `bIndexOccured` is true: position of the last index pulse since the switch has opened.
    pub index: Option<f64>,
    /// A limit switch is active: that in the positive direction (true), or the other.
    pub limit: Option<bool>,
}

/// Next action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Look again.
    Wait,
    /// Go to `target` at `velocity` (above 0), from rest or from motion.
    Go {
        /// u.
        target: f64,
        /// u/s.
        velocity: f64,
    },
    /// Come to rest.
    Stop,
    /// At rest: the present position is `position` from now on.
    Declare {
        /// u.
        position: f64,
    },
    /// Homing is done.
    Done,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Begin,
    /// Fast towards the switch, to the end of the way.
    Fast {
        end: f64,
    },
    /// Braking on the switch.
    Braking,
    /// Slowly off the switch, once it has been seen closed.
    Slow {
        end: f64,
        closed: bool,
    },
    /// Slowly on, to the index.
    Index {
        end: f64,
    },
    /// Braking at the end; the reference, if it is not where the axis will stand.
    Stopping {
        reference: Option<f64>,
    },
    /// The reference has been declared.
    Declared,
    /// On the way to position 0.
    Returning,
    Done,
}

/// `SMC_Homing`. Show it what is seen, do what it says, and show it the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Homing {
    options: HomingOptions,
    phase: Phase,
    history: History,
    /// Where the search under way began, u.
    from: f64,
    looks_at_rest: u8,
    reference: Option<f64>,
}

/// s as ns.
fn delay_ns(seconds: f64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "saturates: nobody waits for centuries")]
    let nanoseconds = (seconds * 1e9).round() as i64;
    nanoseconds
}

impl Homing {
    /// Homing with these inputs of an axis at rest.
    ///
    /// # Errors
    /// As [`HomingOptions::check`].
    pub fn new(options: &HomingOptions) -> Result<Self, HomingFault> {
        options.check()?;
        // A look before the delayed one may be late.
        let keep_ns = delay_ns(options.signal_delay).saturating_add(1_000_000_000);
        let history = History::new(keep_ns);
        let (options, phase) = (*options, Phase::Begin);
        Ok(Self { options, phase, history, from: 0.0, looks_at_rest: 0, reference: None })
    }

    /// Reference, u in the count from before it was declared; known once it has been found.
    pub fn reference(&self) -> Option<f64> {
        self.reference
    }

    /// Whether the switch has opened and the index pulse counts from now on.
    pub fn awaits_index(&self) -> bool {
        matches!(self.phase, Phase::Index { .. })
    }

    /// Next action.
    ///
    /// # Errors
    /// [`HomingFault::Travel`] if switch or index do not come within the way; [`HomingFault::SwitchPassed`];
    /// [`HomingFault::HardwareLimit`] on a limit switch that is not to be ignored; [`HomingFault::NotArrived`]. Homing has
    /// failed then: the axis is to be stopped.
    pub fn step(&mut self, seen: &Seen) -> Result<Order, HomingFault> {
        self.history.push(seen.time_ns, seen.position);
        let ended = matches!(self.phase, Phase::Declared | Phase::Returning | Phase::Done);
        if let Some(positive) = seen.limit
            && !self.options.ignore_hardware_limit
            && !ended
        {
            return Err(HomingFault::HardwareLimit { position: seen.position, positive });
        }
        self.looks_at_rest = if seen.moving { 0 } else { self.looks_at_rest.saturating_add(1) };
        match self.phase {
            Phase::Begin => Ok(self.begin(seen)),
            Phase::Fast { end } => self.fast(seen, end),
            Phase::Braking => self.braking(seen),
            Phase::Slow { end, closed } => self.slow(seen, end, closed),
            Phase::Index { end } => self.index(seen, end),
            Phase::Stopping { reference } => Ok(self.stopping(seen, reference)),
            Phase::Declared => Ok(self.declared()),
            Phase::Returning => self.returning(seen),
            Phase::Done => Ok(Order::Done),
        }
    }

    fn sign(&self) -> f64 {
        self.options.direction.sign()
    }

    /// Sends the axis off.
    fn go(&mut self, from: f64, way: f64, velocity: f64) -> (Order, f64) {
        self.from = from;
        self.looks_at_rest = 0;
        let target = from + way;
        (Order::Go { target, velocity }, target)
    }

    fn begin(&mut self, seen: &Seen) -> Order {
        if !seen.open {
            self.phase = Phase::Braking;
            return Order::Stop;
        }
        let way = self.sign() * self.options.max_fast_way;
        let (order, end) = self.go(seen.position, way, self.options.velocity_fast);
        self.phase = Phase::Fast { end };
        order
    }

    /// Fails if the axis has come to rest, at the end of its way or before.
    fn arrived(&self, seen: &Seen, end: f64, what: &'static str) -> Result<Order, HomingFault> {
        if self.looks_at_rest < LOOKS_AT_REST {
            return Ok(Order::Wait);
        }
        let travel = (end - self.from).abs();
        if (seen.position - end).abs() > 1.0_f64.max(1e-9 * travel) {
            return Err(HomingFault::NotArrived { position: seen.position, target: end });
        }
        Err(HomingFault::Travel { what, from: self.from, travel })
    }

    fn fast(&mut self, seen: &Seen, end: f64) -> Result<Order, HomingFault> {
        if seen.open {
            return self.arrived(seen, end, "the home switch");
        }
        self.phase = Phase::Braking;
        Ok(Order::Stop)
    }

    fn braking(&mut self, seen: &Seen) -> Result<Order, HomingFault> {
        if seen.moving {
            return Ok(Order::Wait);
        }
        let reverses = self.options.mode.reverses();
        if seen.open && !reverses {
            return Err(HomingFault::SwitchPassed { position: seen.position });
        }
        let sense = if reverses { -self.sign() } else { self.sign() };
        let way = sense * self.options.max_slow_way;
        let (order, end) = self.go(seen.position, way, self.options.velocity_slow);
        self.phase = Phase::Slow { end, closed: !seen.open };
        Ok(order)
    }

    fn slow(&mut self, seen: &Seen, end: f64, closed: bool) -> Result<Order, HomingFault> {
        if !closed || !seen.open {
            self.phase = Phase::Slow { end, closed: closed || !seen.open };
            let what = if closed { "the edge of the home switch" } else { "the home switch" };
            return self.arrived(seen, end, what);
        }
        if self.options.mode.by_index() {
            self.phase = Phase::Index { end };
            return Ok(Order::Wait);
        }
        let edge_ns = seen.switch_ns.saturating_sub(delay_ns(self.options.signal_delay));
        let edge = self.history.at(edge_ns).unwrap_or(seen.position);
        let reference = (!self.options.mode.at_rest()).then_some(edge);
        self.reference = reference;
        self.phase = Phase::Stopping { reference };
        Ok(Order::Stop)
    }

    fn index(&mut self, seen: &Seen, end: f64) -> Result<Order, HomingFault> {
        if seen.index.is_none() {
            return self.arrived(seen, end, "the index pulse");
        }
        self.reference = seen.index;
        self.phase = Phase::Stopping { reference: seen.index };
        Ok(Order::Stop)
    }

    fn stopping(&mut self, seen: &Seen, reference: Option<f64>) -> Order {
        if seen.moving {
            return Order::Wait;
        }
        let reference = reference.unwrap_or(seen.position);
        self.reference = Some(reference);
        self.phase = Phase::Declared;
        Order::Declare { position: self.options.home_position + (seen.position - reference) }
    }

    fn declared(&mut self) -> Order {
        if !self.options.return_to_zero {
            self.phase = Phase::Done;
            return Order::Done;
        }
        self.phase = Phase::Returning;
        self.looks_at_rest = 0;
        Order::Go { target: 0.0, velocity: self.options.velocity_fast }
    }

    fn returning(&mut self, seen: &Seen) -> Result<Order, HomingFault> {
        if self.looks_at_rest < LOOKS_AT_REST {
            return Ok(Order::Wait);
        }
        if seen.position.abs() > 1.0 {
            return Err(HomingFault::NotArrived { position: seen.position, target: 0.0 });
        }
        self.phase = Phase::Done;
        Ok(Order::Done)
    }
}
