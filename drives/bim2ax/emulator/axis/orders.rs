//! Execution of the orders in the zone "Ordre UC" by an emulated axis.

use super::{Axis, Programmed, Task};
use crate::protocol::bits::{bloc, coefficient, message, uc};
use crate::{MOST_POSITION, REFERENCES};

/// What the zones "Ordre UC" and "Position" hold for one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct AxisOrder {
    /// "Ordre UC".
    pub(crate) uc: u16,
    /// "Ordre bloc".
    pub(crate) bloc: u32,
    /// "Cote à atteindre", µsteps.
    pub(crate) target: i32,
    /// "Vitesse programmée", unit of the drive mode.
    pub(crate) speed: u16,
}

impl Axis {
    /// Takes an order, now. The zone is shared by both axes: 0 is no order, but ends a manual move.
    pub(crate) fn order(&mut self, order: &AxisOrder) {
        if !self.settings.has(coefficient::PRESENT) {
            return;
        }
        let moves = order.uc & uc::MOVES;
        if self.moving() {
            self.order_in_motion(order.uc, moves);
        } else {
            self.order_at_rest(order, moves);
        }
        // What takes no time is over at once: a move of no length, a stop from the start-stop speed.
        self.advance(self.now_ns);
    }

    /// Refuses an order, whatever it is; what is under way goes on.
    pub(crate) fn refuse(&mut self) {
        self.latch(message::REFUSED, true);
    }

    fn order_in_motion(&mut self, word: u16, moves: u16) {
        let manual = self.task == Task::Manual;
        let repeated = manual && moves == self.ack_uc && !self.assumptions.refuses_repeats;
        if word & uc::HARD_STOP != 0 {
            self.latch(message::REFUSED, false);
            self.stop_hard();
        } else if word & uc::ABANDON != 0 {
            self.latch(message::REFUSED, false);
            self.ack_uc = uc::ABANDON;
            if self.assumptions.abandon_loses_homing {
                self.latch(message::HOMED, false);
            }
            self.brake();
        } else if repeated {
            // Repeated while it runs: it goes on.
        } else if moves != 0 {
            self.latch(message::REFUSED, true);
            if self.assumptions.refusal_stops && !self.braking {
                self.brake();
            }
        } else if (manual || self.assumptions.zero_ends_every_move) && !self.braking {
            self.brake();
        }
    }

    fn order_at_rest(&mut self, order: &AxisOrder, moves: u16) {
        if moves.count_ones() > 1 {
            self.latch(message::REFUSED, true);
            return;
        }
        if order.uc & (uc::MOVES | uc::PHASES_OFF | uc::PHASES_ON | uc::MOTOR_TEST) != 0 {
            self.latch(message::REFUSED, false);
        }
        if order.uc & uc::PHASES_OFF != 0 {
            self.latch(message::PHASES_OFF, true);
            self.ack_uc = uc::PHASES_OFF;
        }
        if order.uc & uc::PHASES_ON != 0 {
            self.energise();
        }
        if order.uc & uc::MOTOR_TEST != 0 {
            self.latch(message::PHASES_OFF, false);
            self.ack_uc = uc::MOTOR_TEST;
            self.test_motor();
        }
        match moves {
            0 => {}
            uc::PROGRAMMED if order.bloc & (bloc::ZERO | bloc::FORCE) != 0 => self.declared(order),
            uc::PROGRAMMED => self.start_programmed(order),
            other => self.start(other),
        }
    }

    /// Bits 4 and 5 of the order bloc: the position is declared, nothing moves.
    fn declared(&mut self, order: &AxisOrder) {
        let both = bloc::ZERO | bloc::FORCE;
        let preset = order.bloc & bloc::PRESET != 0;
        let position = match order.bloc & both {
            bloc::ZERO => 0,
            bloc::FORCE if !preset => self.stored,
            bloc::FORCE if order.target != bloc::FORBIDDEN_PRESET => order.target,
            _ => {
                self.latch(message::REFUSED, true);
                return;
            }
        };
        self.declare(position);
        let shaft = self.shaft();
        self.encoder.set_steps(shaft, position);
        self.latch(message::HOMED, true);
        self.ack_uc = 0;
        self.ack_bloc = order.bloc & both;
    }

    /// Homing, manual moves and moves to a switch.
    fn start(&mut self, order: u16) {
        let sense = match order {
            uc::MANUAL_PLUS | uc::TO_PLUS_SWITCH => 1,
            uc::MANUAL_MINUS | uc::TO_MINUS_SWITCH => -1,
            _ => self.first_home_sense(),
        };
        let to_switch = order & (uc::TO_PLUS_SWITCH | uc::TO_MINUS_SWITCH) != 0;
        let limited = self.on_limit(sense) && !to_switch && order != uc::HOME;
        if limited || !self.may_move(sense) {
            return;
        }
        self.accepted(order);
        if order == uc::HOME {
            self.home();
        } else {
            self.task = if to_switch { Task::ToSwitch } else { Task::Manual };
            self.run(sense);
        }
    }

    /// Sense in which homing starts.
    fn first_home_sense(&self) -> i64 {
        let leaves = self.on_cam()
            && !self.settings.has(coefficient::STAY_ON_CAM)
            && !self.encoder.homes_on_index();
        if leaves { -self.home_sense() } else { self.home_sense() }
    }

    fn start_programmed(&mut self, order: &AxisOrder) {
        if self.settings.has(coefficient::HOMING_MANDATORY) && !self.is(message::HOMED) {
            return;
        }
        let reference = order.bloc & bloc::REFERENCE;
        let target = match usize::try_from(reference) {
            Ok(0) if !(-MOST_POSITION..=MOST_POSITION).contains(&order.target) => None,
            Ok(0) if order.bloc & bloc::RELATIVE != 0 => self.counter().checked_add(order.target),
            Ok(0) => Some(order.target),
            Ok(number @ 1..=REFERENCES) => self.settings.references.get(number - 1).copied(),
            _ => {
                self.ack_bloc = bloc::BAD_REFERENCE;
                return;
            }
        };
        let Some(target) = target else {
            self.latch(message::REFUSED, true);
            return;
        };
        let programmed_speed = order.bloc & bloc::PROGRAMMED_SPEED != 0;
        let programmed = Programmed {
            target,
            speed: if programmed_speed { order.speed } else { u16::MAX },
            reference,
            overshooting: order.bloc & bloc::WITHOUT_APPROACH == 0 && self.approaches(target),
            corrections: 0,
        };
        let sense = (self.leg_target(&programmed) - i64::from(self.counter())).signum();
        if sense != 0 && self.on_limit(sense) || !self.may_move(sense) {
            return;
        }
        self.accepted(uc::PROGRAMMED);
        self.corrected = false;
        if self.ignored_moves > 0 {
            self.ignored_moves -= 1;
        } else {
            self.go(programmed);
        }
    }

    /// The next programmed moves, of this number, are acknowledged and not carried out.
    pub(crate) fn ignore_moves(&mut self, moves: u32) {
        self.ignored_moves = moves;
    }

    /// True if nothing forbids to move in the sense of `sense`: power, phases, end switch.
    fn may_move(&mut self, sense: i64) -> bool {
        let faults = message::PHASE_OPEN | message::PHASE_SHORT;
        if !self.bench.power || self.is(faults) || sense != 0 && self.on_switch(sense) {
            return false;
        }
        self.test_motor_at_moves();
        !self.is(faults)
    }

    fn accepted(&mut self, order: u16) {
        self.latch(message::HARD_STOPPED, false);
        self.latch(message::PHASES_OFF, false);
        self.ack_uc = order;
        self.ack_bloc = 0;
    }

    /// The test at the begin and end of moves (3.1.1.16), which finds faults; only an ordered test clears them (7.7).
    pub(super) fn test_motor_at_moves(&mut self) {
        if !self.settings.has(coefficient::NO_MOTOR_TEST) && self.bench.power {
            self.latched |= if self.bench.phase_open { message::PHASE_OPEN } else { 0 };
            self.latched |= if self.bench.phase_short { message::PHASE_SHORT } else { 0 };
        }
    }

    /// The ordered motor test.
    fn test_motor(&mut self) {
        self.latch(message::PHASE_OPEN, self.bench.phase_open);
        self.latch(message::PHASE_SHORT, self.bench.phase_short);
    }
}
