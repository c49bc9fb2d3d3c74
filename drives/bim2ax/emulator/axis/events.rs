//! Event queue of an emulated axis: the next edge, switch, limit or end of a leg, and its consequences.

use super::{Axis, Homing, Programmed, Task};
use crate::protocol::bits::{bloc, coefficient, message, uc};
use twin_drives::ramp::Motion;

/// What can happen to a moving axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// The leg is at its end.
    End,
    /// The edge of the cam, or the index.
    Edge,
    /// The end switch in the direction of motion.
    Switch,
    /// The soft limit in the direction of motion.
    Limit,
}

impl Axis {
    /// The next thing to happen and when. Of several at the same instant the first listed counts.
    pub(super) fn next_event(&self) -> Option<(i64, Event)> {
        if self.task == Task::Rest {
            return None;
        }
        let candidates = [
            (self.edge_ns(), Event::Edge),
            (self.switch_ns(), Event::Switch),
            (self.limit_ns(), Event::Limit),
            (Some(self.motion.end_ns()), Event::End),
        ];
        let known = candidates.into_iter().filter_map(|(at, event)| Some((at?, event)));
        known.min_by_key(|(at_ns, _)| *at_ns)
    }

    /// When homing comes to its edge.
    fn edge_ns(&self) -> Option<i64> {
        let Task::Homing(phase) = self.task else { return None };
        if self.braking || self.held.is_some() || phase == Homing::Stopping {
            return None;
        }
        let (shaft, sense) = (self.shaft(), self.sense * self.direction());
        if phase == Homing::Seeking
            && let Some(edge) = self.encoder.next_index(shaft, sense)
        {
            return self.shaft_ns(edge);
        }
        let wanted = phase == Homing::Seeking;
        if phase == Homing::Clearing || self.encoder.homes_on_index() {
            return None;
        }
        if self.on_cam() == wanted {
            return Some(self.now_ns);
        }
        self.shaft_ns(self.bench.cam?.next_change(shaft, sense)?)
    }

    /// When the end switch ahead becomes active. A ramp that has begun goes on over it, unless it stops brutally.
    fn switch_ns(&self) -> Option<i64> {
        if self.braking && !self.settings.has(coefficient::BRUTAL_STOP) {
            return None;
        }
        if self.on_switch(self.sense) {
            return Some(self.now_ns);
        }
        if self.held.is_some() || self.settings.has(coefficient::IGNORE_SWITCHES) {
            return None;
        }
        self.shaft_ns(
            self.switch(self.sense)?.next_change(self.shaft(), self.sense * self.direction())?,
        )
    }

    /// When the soft limit ahead is reached.
    fn limit_ns(&self) -> Option<i64> {
        if self.braking || !self.is(message::HOMED) || self.task == Task::ToSwitch {
            return None;
        }
        let limit = if self.sense > 0 { self.settings.soft_plus } else { self.settings.soft_minus };
        self.counter_ns(limit.into())
    }

    /// When the shaft is at a µstep ahead of it.
    fn shaft_ns(&self, shaft: i64) -> Option<i64> {
        self.counter_ns((shaft - self.offset) * self.direction())
    }

    /// The first instant from now on at which the counter has come as far as `counter` in the sense of motion.
    fn counter_ns(&self, counter: i64) -> Option<i64> {
        let there = |time_ns: i64| (self.count(time_ns) - counter) * self.sense >= 0;
        let (mut before, mut after) = (self.now_ns, self.motion.end_ns());
        if there(before) {
            return Some(before);
        }
        if !there(after) {
            return None;
        }
        // A leg goes in one direction only, so the instant can be enclosed.
        while after - before > 1 {
            let middle = before + (after - before) / 2;
            if there(middle) {
                after = middle;
            } else {
                before = middle;
            }
        }
        Some(after)
    }

    pub(super) fn happen(&mut self, event: Event) {
        match event {
            Event::End => self.leg_ended(),
            Event::Limit => self.brake(),
            Event::Switch => {
                if !self.settings.has(coefficient::BRUTAL_STOP) {
                    self.brake();
                    return;
                }
                // 3.1.1.11: a move to the switch keeps homing.
                let homed = self.is(message::HOMED) && self.task == Task::ToSwitch;
                self.stand();
                self.latch(message::HARD_STOPPED, true);
                self.finish();
                self.latch(message::HOMED, homed);
            }
            Event::Edge => match self.task {
                Task::Homing(Homing::Leaving) => {
                    let hysteresis = self.settings.hysteresis.into();
                    self.run_by(Homing::Clearing, -self.home_sense(), hysteresis);
                }
                _ => self.run_by(
                    Homing::Stopping,
                    self.home_sense(),
                    self.settings.origin_stop.into(),
                ),
            },
        }
    }

    fn leg_ended(&mut self) {
        self.stand();
        if self.braking {
            self.finish();
            return;
        }
        match self.task {
            Task::Homing(Homing::Clearing) => self.seek(),
            Task::Homing(Homing::Stopping) => {
                if !self.assumptions.homing_keeps_position {
                    self.declare(0);
                }
                let shaft = self.shaft();
                self.encoder.home(shaft);
                self.finish();
                self.latch(message::HOMED, true);
            }
            Task::Programmed(programmed) if programmed.overshooting => {
                self.go(Programmed { overshooting: false, ..programmed });
            }
            Task::Programmed(programmed) => self.arrived(programmed),
            // A manual move, or one that finds neither cam nor switch, has come to the end of the counter.
            Task::Rest | Task::Homing(_) | Task::Manual | Task::ToSwitch => self.finish(),
        }
    }

    /// A programmed move is where it was to be by its counter; the encoder may know better.
    fn arrived(&mut self, programmed: Programmed) {
        let target = i64::from(programmed.target);
        let lack = self.encoder.steps(self.shaft()).map(|steps| target - i64::from(steps));
        if let Some(lack) = lack
            && lack.abs() > self.corrections.tolerance.into()
            && programmed.corrections < self.corrections.most
        {
            self.corrected = true;
            self.declare(super::saturated(target - lack));
            self.go(Programmed { corrections: programmed.corrections + 1, ..programmed });
            return;
        }
        self.finish();
    }

    /// The order is over.
    pub(super) fn finish(&mut self) {
        if let Task::Programmed(programmed) = self.task {
            self.ack_bloc = programmed.reference & bloc::REFERENCE;
        }
        if self.ack_uc & (uc::ABANDON | uc::HARD_STOP) == 0 {
            self.ack_uc = 0;
        }
        self.task = Task::Rest;
        self.braking = false;
        self.stored = self.counter();
        self.ends += 1;
        self.test_motor_at_moves();
    }

    /// Stands on the µstep where it is.
    pub(super) fn stand(&mut self) {
        self.motion = Motion::at_rest(f64::from(self.counter()));
    }

    /// Stops without ramp: message 6, homing lost (5.5).
    pub(super) fn stop_hard(&mut self) {
        self.stand();
        self.ack_uc = uc::HARD_STOP;
        self.latch(message::HARD_STOPPED, true);
        self.latch(message::HOMED, false);
        self.finish();
    }

    /// Stops with ramp.
    pub(super) fn brake(&mut self) {
        self.braking = true;
        let ramp = self.settings.ramp(self.settings.start_stop(), 0.0);
        self.motion = Motion::stop(self.now_ns, self.motion.at(self.now_ns), &ramp);
    }
}
