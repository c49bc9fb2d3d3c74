//! Deadlock detection: blocks that wait for an event that cannot come while axes go on moving.
//!
//! Where everything is at rest, a waiting block waits for ever. Where an axis moves at constant velocity that nothing
//! ends, a block may wait for a position of it. Whether the axis reaches that position is known at once. Any other wait
//! counts as a deadlock if nothing has changed for [`UNCHANGED_NS`].

use super::super::Begins;
use super::super::probe::When;
use super::{Engine, Running, nanoseconds};
use crate::finding::{Finding, Rule};
use twin_axis::AxisState;
use twin_number::{seconds, significant};

/// Time with constant velocities and nothing due after which nothing will change any more, ns.
const UNCHANGED_NS: i64 = 600_000_000_000;

/// Cycles until a waiting block sees that an axis has passed a position.
const SEEN: f64 = 4.0;

/// Blocks whose slave moves like its master once they are done.
const GEARS: [&str; 4] = ["MC_GearIn", "SMC_GearInPos", "MC_GearInPos", "MC_Phasing"];

/// Prospect of a wait.
enum Comes {
    Never(String),
    Later,
    Unknown,
}

impl Engine {
    /// Refuses a wait of the first block that is not over, if it cannot end.
    pub(super) fn refuse_to_wait(&self, index: usize) -> Result<(), Box<Finding>> {
        let under_way = |running: &Running| running.begun_ns.is_some() && running.over_ns.is_none();
        let all = || self.calls.iter().enumerate().filter(|(_, running)| under_way(running));
        let Some(waits) = self.calls.get(index) else { return Ok(()) };
        let alone = || all().all(|(other, _)| other == index) && !self.waits_for_a_profile();
        let why = match self.comes(waits) {
            Comes::Never(why) if alone() => why,
            _ if self.now_ns - self.changed_ns <= UNCHANGED_NS => return Ok(()),
            _ => {
                let later = all().any(|(_, running)| matches!(self.comes(running), Comes::Later));
                if later || self.waits_for_a_profile() {
                    return Ok(());
                }
                let moves = self.axes.iter().find(|moved| !moved.stands());
                let moves = moves.map_or(String::new(), |moved| {
                    let velocity = significant(moved.state.velocity, 4);
                    format!("; axis {} goes on with {velocity} {}/s", moved.name, moved.unit)
                });
                format!("nothing has changed for {:.0} s{moves}", seconds(UNCHANGED_NS))
            }
        };
        let name = self.name(waits.call.axis);
        let message = format!("{} of axis {name} waits for ever: {why}", waits.call.name);
        let mut finding = waits.call.error(Rule::FunctionBlock, name, message);
        finding.hint = Some(
            "set `duration_s` of the job, or add a block with `at_s` that ends this wait"
                .to_owned(),
        );
        Err(finding.into())
    }

    /// True if a block waits for the end of its axis's cam, whose master moves.
    fn waits_for_a_profile(&self) -> bool {
        self.calls.iter().any(|running| {
            let cam = running.behind.and_then(|cam| self.calls.get(cam));
            let on_it = cam.is_some_and(|cam| cam.begun_ns.is_some() && !cam.ended);
            let master = cam.and_then(|cam| self.axes.get(cam.call.master?));
            running.call.begins == Begins::EndOfProfile
                && running.begun_ns.is_none()
                && on_it
                && master.is_some_and(|master| !master.stands())
        })
    }

    /// Prospect of the wait of a block under way.
    fn comes(&self, running: &Running) -> Comes {
        let call = &running.call;
        if let (Some(place), Some(master)) = (call.block.awaits(), call.master) {
            return self.comes_to(master, place, "its master");
        }
        if let Some(trigger) = call.block.trigger() {
            return match self.inputs.when(trigger) {
                Some(When::Passes(axis, place)) => self.comes_to(axis, place, "axis"),
                // It is TRUE in the cycle at that time or in the next one.
                Some(When::At(time)) if nanoseconds(time) + 2 * self.cycle_ns < self.now_ns => {
                    let time = significant(time, 6);
                    Comes::Never(format!("its trigger has been TRUE at {time} s, and is not again"))
                }
                Some(When::At(_)) => Comes::Later,
                None => Comes::Unknown,
            };
        }
        let begun_ns = running.begun_ns.unwrap_or(self.now_ns);
        // A lower bound: MC_Phasing also has to reach its master's velocity.
        let lasts =
            |time: f64| begun_ns.saturating_add(nanoseconds(time)).saturating_add(UNCHANGED_NS);
        let ends = call.block.lasts().map(lasts);
        if ends.is_some_and(|end| end >= self.now_ns) { Comes::Later } else { Comes::Unknown }
    }

    /// Prospect that an axis passes a position at its present velocity.
    fn comes_to(&self, axis: usize, place: f64, which: &str) -> Comes {
        let Some(moved) = self.axes.get(axis) else { return Comes::Unknown };
        let velocity = moved.state.velocity;
        if velocity == 0.0 {
            return Comes::Unknown;
        }
        let ahead = (place - moved.axis.set_position()) * velocity.signum();
        let passes = SEEN * seconds(self.cycle_ns) * velocity.abs();
        if moved.axis.period().is_some() || ahead >= -passes {
            return Comes::Later;
        }
        if !self.goes_on(axis, self.axes.len()) {
            return Comes::Unknown;
        }
        let (name, unit) = (&moved.name, moved.unit);
        Comes::Never(format!(
            "{which} {name} moves away from {} {unit} at {} {unit}/s without end",
            significant(place, 6),
            significant(velocity.abs(), 4)
        ))
    }

    /// True if an axis keeps its constant velocity until another block begins: by itself, or in at most `depth` gears behind
    /// such an axis.
    fn goes_on(&self, axis: usize, depth: usize) -> bool {
        let Some(moved) = self.axes.get(axis).filter(|moved| moved.is_steady()) else {
            return false;
        };
        let taker = moved.taken_by.and_then(|taker| self.calls.get(taker));
        let Some(taker) = taker.filter(|taker| taker.over_ns.is_some()) else { return false };
        match (moved.axis.state(), taker.call.master) {
            (AxisState::ContinuousMotion, _) => true,
            (AxisState::SynchronizedMotion, Some(master)) => {
                depth > 0 && GEARS.contains(&taker.call.name) && self.goes_on(master, depth - 1)
            }
            _ => false,
        }
    }
}
