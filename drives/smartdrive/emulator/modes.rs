//! The modes that move by inputs. The manual gives their names and which inputs they have; what is here is assumed.

use super::{Device, Input, Phase, inputs::Pins};
use crate::{
    Mode,
    protocol::parameters::{POSITION_MAX, POSITION_MIN, PUSH_PULL_DISTANCE},
};

/// Levels that a mode has seen: GO, DIR and the analog input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Seen {
    go: bool,
    dir: bool,
    analog: Option<u16>,
}

impl Seen {
    pub(super) fn now(pins: &Pins) -> Self {
        Self { go: pins.is_active(Input::Go), dir: pins.is_active(Input::Dir), analog: None }
    }
}

impl Device {
    /// Moves as the inputs say, in modes that do.
    pub(super) fn obey_inputs(&mut self) {
        if self.phase != Phase::Running || self.homing.is_some() {
            return;
        }
        let before = self.seen;
        let now = Seen { analog: Some(self.analog[0]), ..Seen::now(&self.pins) };
        self.seen = now;
        if now == before {
            return;
        }
        let (go_edge, dir_edge) = (now.go && !before.go, now.dir && !before.dir);
        let sense = if now.dir { -1 } else { 1 };
        let distance = i32::try_from(self.memory.value(PUSH_PULL_DISTANCE)).unwrap_or(0);
        match self.mode {
            Mode::Off | Mode::Custom | Mode::Remote | Mode::Changing => {}
            Mode::Position => {
                let low = self.memory.value(POSITION_MIN);
                let span = self.memory.value(POSITION_MAX) - low;
                let target = low + span * i64::from(self.analog[0]) / 32_767;
                self.go(i32::try_from(target).unwrap_or(0));
            }
            Mode::Velocity => self.run(i16::from(now.go) - i16::from(now.dir)),
            Mode::VelocityDirection => self.run(i16::from(now.go) * sense),
            Mode::VelocityStartStop => {
                if go_edge || dir_edge {
                    let moving = self.generator.in_motion(self.now_ns);
                    let start = if go_edge { 1 } else { -1 };
                    self.run(if moving { 0 } else { start });
                }
            }
            Mode::VelocityStartStopDirection => {
                if go_edge {
                    let moving = self.generator.in_motion(self.now_ns);
                    self.run(if moving { 0 } else { sense });
                }
            }
            Mode::Advance => {
                if go_edge || dir_edge {
                    let distance = if go_edge { distance } else { distance.saturating_neg() };
                    self.go(self.counter().saturating_add(distance));
                }
            }
            Mode::AdvanceDirection => {
                if go_edge {
                    let distance = distance.saturating_mul(sense.into());
                    self.go(self.counter().saturating_add(distance));
                }
            }
            Mode::PushPull | Mode::PushPullHome => {
                if now.go != before.go {
                    self.go(if now.go { distance } else { 0 });
                }
            }
        }
    }

    /// Runs at the largest speed in the sense of `sense`, or stops.
    fn run(&mut self, sense: i16) {
        let ceilings = self.ceilings();
        let speed = i16::try_from(ceilings.velocity).unwrap_or(i16::MAX);
        self.generator.start(self.now_ns, &ceilings, speed.saturating_mul(sense), 0);
    }

    fn go(&mut self, target: i32) {
        let ceilings = self.ceilings();
        let accepted = self.generator.go_to(self.now_ns, &ceilings, target, 0, 0).is_ok();
        // Outside the position limits it does not move, and no master hears of it.
        if !accepted {
            self.generator.stop(self.now_ns, &ceilings, 0);
        }
    }
}
