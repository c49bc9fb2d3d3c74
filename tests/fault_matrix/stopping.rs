//! Stops during a fault: a followed plan is stopped, on the ramps or at once.
//!
//! The device still has work when the stop arrives: a target ahead, near as in a plan or far as in an approach, and
//! with segments a full buffer. Far targets and buffers last longer than the repetition of a lost stop takes. A device
//! that its driver reports as stopped must be at rest, have no work left, and stay in place longer than any earlier
//! command can take.

use std::thread;

use twin_drives::{Clock, MAX_DRIVE_AXES, SetpointStream};

use crate::{
    expected::Cause,
    faults::{Doing, Fault},
    rig::{AxisTruth, Rest, Rig, Truth},
    scenario::{MOST_ATTEMPTS, MOST_LOOKS, Outcome, PAUSE, Plan, SENSES, TARGET, Trial, is_over},
};

/// Far enough that it is not half reached while something is stopped, increments.
const FAR: i64 = 300_000;
/// Distance that an axis may go back when its shaft is held or its current switched off, increments.
const BACK: f64 = 16.0;
/// Looks, [`PAUSE`] apart, during which an axis that was stopped has to stay: frames come late by less.
const STAY_LOOKS: u32 = 70;

impl Rig {
    /// Follows a plan for a time, until all axes move towards their targets; then segments are left waiting if they are to. Returns
    /// the state at that time.
    fn follows_for(&mut self, followed_ns: i64, buffered: bool) -> Result<Truth, Outcome> {
        let plan = Plan { clock: self.clock, start_ns: self.clock.now_ns() + 100_000_000 };
        let count = self.drive().axis_count();
        let truth = loop {
            self.drive().follow(&plan).map_err(Outcome::NotBegun)?;
            let truth = self.truth();
            let moves = truth.moving && (count == 1 || truth.other_moves);
            // On a busy computer a target arrives late: a drive that is too fast for it goes past it, and comes back.
            if plan.now_ns() > followed_ns && moves && truth.goes_ahead(count) {
                break truth;
            }
            if is_over(&plan) {
                return Err(Outcome::Lost(format!("it does not follow: {truth:?}")));
            }
        };
        let reached = plan.at(plan.now_ns() + self.clock.horizon_ns()).position[0];
        self.reached = Some(reached);
        if buffered {
            self.queue_segments(reached.ceil() as i32).map_err(Outcome::NotBegun)?;
            let truth = self.truth();
            if truth.waiting < 2 {
                return Err(Outcome::Lost(format!("nothing waits: {truth:?}")));
            }
            return Ok(truth);
        }
        Ok(truth)
    }

    /// Is stopped out of a plan or on its way to a far target.
    pub(crate) fn stopping(&mut self, trial: &Trial) -> Outcome {
        let hard = trial.doing.halts();
        let begun = if matches!(trial.doing, Doing::FarStopping | Doing::FarHalting) {
            #[expect(clippy::cast_precision_loss, reason = "a small number")]
            let half = FAR as f64 / 2.0;
            self.reached = Some(half);
            let moves = self.to(FAR).and_then(|()| self.moves()).map_err(Outcome::NotBegun);
            moves.map(|()| self.truth())
        } else {
            self.follows_for(trial.strike.followed_ns, trial.buffered)
        };
        let before = match begun {
            Ok(before) => before,
            Err(outcome) => return outcome,
        };
        self.goes_wrong(trial, u32::from(!matches!(trial.fault, Fault::Wire(..))));
        let stopped = if hard { self.drive().hard_stop() } else { self.drive().soft_stop() };
        // What the driver says is compared with the device at once, and with where it was sent.
        if stopped.is_ok()
            && let Err(lost) = self.has_stopped(&before)
        {
            return Outcome::Lost(lost);
        }
        if let Fault::Device(fault) = trial.fault {
            assert!(self.settle(fault) || trial.lives_on, "{fault:?} does not show");
        }
        let rest = Rest(self.clock);
        match stopped {
            Err(error) => Outcome::Told(error),
            Ok(()) if hard && self.is_off_after_hard_stop() => match self.drive().sample(&rest) {
                Err(error) => match Cause::of(&error) {
                    Some(Cause::Locked | Cause::Reset | Cause::Alarm) => Outcome::Survived,
                    _ => Outcome::Told(error),
                },
                Ok(sample) => Outcome::Lost(format!("stopped hard, and obeys: {sample:?}")),
            },
            Ok(()) => match self.rests() {
                // A module says so of an axis that moved.
                Err(error) if hard && Cause::of(&error) == Some(Cause::StoppedHard) => {
                    Outcome::Survived
                }
                rests => rests.map_or_else(Outcome::Told, |_| Outcome::Survived),
            },
        }
    }

    /// Checks that a device reported as stopped is at rest on its path, and stays so.
    fn has_stopped(&mut self, before: &Truth) -> Result<(), String> {
        let truth = self.truth();
        if truth.moving || truth.other_moves {
            return Err(format!("said to be stopped, and moves: {truth:?}"));
        }
        if truth.waiting > 0 {
            return Err(format!("said to be stopped, and has more to do: {truth:?}"));
        }
        if self.drive().commanded() != [None; MAX_DRIVE_AXES] {
            return Err("stopped, and the driver believes that it goes on".to_owned());
        }
        // No farther than the plan was known, or half of a way, and not to the end of what was waiting. A device that has started anew counts
        // from 0, and its mechanics have not moved by that.
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        let end = self.queued.map(|end| end as f64 - 1.0);
        let end = end.or(self.reached.map(|reached| reached + 1.0)).unwrap_or(0.0);
        let count = self.drive().axis_count();
        let axes = SENSES.into_iter().zip(before.axes.iter().zip(&truth.axes)).take(count);
        for (sense, (before, now)) in axes {
            #[expect(clippy::cast_precision_loss, reason = "1 or -1")]
            let sense = sense as f64;
            let (from, to) = (sense * before.mechanical, sense * now.mechanical);
            if !(from - BACK..=end).contains(&to) {
                return Err(format!(
                    "said to be stopped, and is at {to:.0} instead of {from:.0} to {end:.0}"
                ));
            }
        }
        self.stays()
    }

    /// Checks that all axes keep their positions.
    fn stays(&self) -> Result<(), String> {
        let before = self.truth();
        for _ in 0..STAY_LOOKS {
            thread::sleep(PAUSE);
            let now = self.truth();
            let pairs = before.axes.iter().zip(&now.axes);
            let away = pairs.map(|(before, now)| (before.mechanical - now.mechanical).abs());
            if now.moving || now.other_moves || away.fold(0.0, f64::max) > 0.5 {
                return Err(format!("it stood at {before:?}, and goes on: {now:?}"));
            }
        }
        Ok(())
    }

    /// Stops as sessions do after an error: a soft stop, then a hard stop, and both again if neither is confirmed.
    pub(crate) fn stops(&mut self, attempts: u32) -> bool {
        for _ in 0..attempts {
            if self.drive().soft_stop().is_ok() || self.drive().hard_stop().is_ok() {
                break;
            }
        }
        // On its ramp, where its status does not show.
        for _ in 0..MOST_ATTEMPTS {
            let truth = self.truth();
            if !truth.moving && !truth.other_moves {
                return truth.waiting == 0 && self.stays().is_ok();
            }
            thread::sleep(PAUSE);
        }
        false
    }

    /// An axis that cannot be reached goes on to where it was sent, and no farther.
    pub(crate) fn goes_on(&mut self, doing: Doing, told: &Truth) -> Result<(), String> {
        for _ in 0..MOST_LOOKS {
            let truth = self.truth();
            if !truth.moving && !truth.other_moves {
                break;
            }
            thread::sleep(PAUSE);
        }
        let end = self.truth();
        let reached = self.reached.unwrap_or(0.0);
        // As far as the plan was known, all axes of the line.
        let count = self.drive().axis_count();
        let pairs = SENSES.into_iter().zip(told.axes.iter().zip(&end.axes)).take(count);
        let mut ways =
            pairs.map(|(sense, (told, end))| (sense * told.counter, sense * end.counter));
        #[expect(clippy::cast_precision_loss, reason = "counters")]
        let mut on_plan = || {
            ways.all(|(told, end)| end >= told && end as f64 > 300.0 && end as f64 <= reached + 1.0)
        };
        let right = match doing {
            // The plug was pulled before any command.
            Doing::Idle => end.counter == 0,
            Doing::Looking => end.counter == TARGET,
            Doing::ToHome | Doing::Homing => self.is_on_switches(),
            Doing::Moving => on_plan(),
            Doing::FarStopping | Doing::FarHalting => {
                // All axes of the line.
                let mut targets = SENSES.into_iter().zip(&end.axes).take(count);
                let arrived = |(sense, axis): (i64, &AxisTruth)| axis.counter == sense * FAR;
                targets.all(arrived) && told.counter < FAR
            }
            Doing::Stopping | Doing::Halting => match self.queued {
                Some(last) => end.counter == last && told.counter < last && end.waiting == 0,
                None => on_plan(),
            },
        };
        if right && !end.moving && !end.other_moves {
            return Ok(());
        }
        Err(format!("goes on to {end:?}, from {told:?}, planned up to {:?}", self.reached))
    }
}
