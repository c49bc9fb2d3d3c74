//! Checker of the invariants, cycle after cycle, for any sequence of block calls.

use super::*;
use std::cmp::Ordering;

/// One begun execution of a block, from its edge on.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    open: bool,
    reached: bool,
    before: Outputs,
}

/// Promise of the block that moves the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Promise {
    /// The block's own limits, once it has come back to them.
    Limits(AxisLimits),
    /// That position and velocity belong together, with so much acceleration, u/s².
    Smooth(f64),
    /// The same, and on axes with limited jerk so much of it, u/s³; whether the slave steps with the master's zero.
    OnCam { rate: f64, jerk: f64, steps: bool },
    /// Nothing: the drive moves itself.
    Nothing,
}

/// Limits of a block, with the jerk of the axis.
pub(super) const fn limits(velocity: f64, acceleration: f64, deceleration: f64) -> AxisLimits {
    AxisLimits { velocity, acceleration, deceleration, jerk: JERK }
}

impl Promise {
    /// Of an axis that brakes by itself, or that nothing moves.
    pub(super) const USUAL: Self = Self::Limits(limits(0.5 * FASTEST, STEEPEST, STEEPEST));
}

/// Checker with the last cycle and the unfinished executions of blocks.
#[derive(Debug)]
pub(super) struct Checker {
    state: AxisState,
    /// Who has to keep the axis, whatever the others do.
    keeper: Option<Keeper>,
    /// Drive's position, velocity and acceleration of the last set-point.
    motion: [f64; 3],
    /// What was on top of the motion in the last set-point.
    overlay: State,
    tallies: Vec<Tally>,
    /// Who has commanded the axis in this cycle, below and on top, and as which owner.
    commanders: [Option<(String, i64)>; 2],
}

impl Checker {
    pub(super) fn new(axis: &Axis, blocks: usize) -> Self {
        Self {
            state: axis.state(),
            keeper: None,
            motion: [axis.to_drive(axis.set_position()), 0.0, 0.0],
            overlay: State::default(),
            tallies: vec![Tally::default(); blocks],
            commanders: [None, None],
        }
    }

    /// After a call of a block that moves the axis in this layer, 0 below and 1 on top: only who has the axis, or has just
    /// given it back, has commanded it, and once. Who takes it commands it anew, after who had it before. `before` is who
    /// had it before the call, in this layer, and how many had it by then.
    pub(super) fn commanded(
        &mut self,
        name: &str,
        layer: usize,
        axis: &Axis,
        [was_owned, owners, mine]: [i64; 3],
    ) -> Checked {
        let count = axis.commands[layer];
        if axis.commands[1 - layer] > 0 || count > 1 {
            return Err(format!("{name} commands the axis {:?} times in a call", axis.commands));
        }
        if count == 0 {
            return Ok(());
        }
        let owner = match [axis.owner(), axis.overlay_owner][layer] {
            // It has taken it and given it back at once, or has given it back only.
            0 if axis.values.owners != owners => axis.values.owners,
            0 => was_owned,
            owner if owner == mine => owner,
            owner => return Err(format!("{name} commands an axis of {owner}")),
        };
        if owner == 0 {
            return Err(format!("{name} commands an axis of nobody"));
        }
        let before = self.commanders[layer].replace((name.to_owned(), owner));
        match before.filter(|(_, before)| *before == owner) {
            Some((before, _)) => Err(format!("{before} and {name} both command the axis")),
            None => Ok(()),
        }
    }

    /// Last outputs of a block.
    pub(super) fn before(&self, index: usize) -> Outputs {
        self.tallies[index].before
    }

    /// Takes the outputs of a block of this name.
    pub(super) fn block(
        &mut self,
        index: usize,
        name: &str,
        rises: bool,
        shown: Outputs,
    ) -> Checked {
        let tally = &mut self.tallies[index];
        let (shows, before) = (ends(shown), ends(tally.before));
        if shows.iter().filter(|it| **it).count() > 1 {
            return Err(format!("block {index} shows {shown:?} at once"));
        }
        if rises {
            *tally = Tally { open: true, ..Tally::default() };
        }
        if shows.iter().zip(before).any(|(shows, before)| *shows && (rises || !before)) {
            if !tally.open {
                return Err(format!("block {index} ends twice: {shown:?}"));
            }
            if shown.done && shown.busy {
                if tally.reached {
                    return Err(format!("block {index} reaches its velocity twice"));
                }
                tally.reached = true;
            } else {
                tally.open = false;
            }
        }
        if shown.busy && !tally.open {
            return Err(format!("block {index} is busy after its end"));
        }
        if tally.open && !shown.busy {
            // A stop that has been done gives the axis back with Execute; who has come to a velocity or into step has not ended.
            if !tally.reached || legal::short(name) != "Stop" {
                return Err(format!("block {index} has no end"));
            }
            tally.open = false;
        }
        tally.before = shown;
        Ok(())
    }

    /// Every step that the axis has made since the last look is one of the diagram, and no state has changed without one.
    pub(super) fn states(&mut self, axis: &mut Axis) -> Checked {
        for [from, to] in axis.entered.drain(..) {
            if from != self.state || !legal::is_arrow(from, to) {
                return Err(format!("illegal: {from:?} to {to:?} after {:?}", self.state));
            }
            self.state = to;
        }
        if axis.state() != self.state {
            return Err(format!("{:?} has become {:?} by itself", self.state, axis.state()));
        }
        Ok(())
    }

    /// After a call of a block, with or without Execute: the states, that of who moves the axis, and who keeps it.
    pub(super) fn called(
        &mut self,
        axis: &mut Axis,
        by: (&str, bool),
        mover: Option<&str>,
    ) -> Checked {
        self.states(axis)?;
        let state = axis.state();
        match mover.map(legal::demanded) {
            Some(demanded) if state != demanded => {
                return Err(format!("{} moves it in {state:?}", mover.unwrap_or_default()));
            }
            None if axis.owner() == 0
                && axis.overlay_owner != 0
                && state != AxisState::DiscreteMotion =>
            {
                return Err(format!("moved on top in {state:?}"));
            }
            _ => {}
        }
        self.keeper = Keeper::after(self.keeper, axis, by, mover)?;
        Ok(())
    }

    /// Those who think that they move the axis, by their owner numbers, are the one that does.
    pub(super) fn owned(&mut self, axis: &Axis, owners: &[i64]) -> Checked {
        self.commanders = [None, None];
        let claims = owners.iter().filter(|owner| axis.owner() == **owner && **owner != 0).count();
        if claims > 1 || (axis.owner() != 0) != (claims == 1) {
            return Err(format!("{claims} blocks own {}", axis.owner()));
        }
        let may_be_owned = axis.state().is_motion()
            || [AxisState::Stopping, AxisState::Homing].contains(&axis.state());
        if axis.owner() != 0 && !may_be_owned {
            return Err(format!("{} moves it in {:?}", axis.owner(), axis.state()));
        }
        let moving = axis.owner() != 0 || axis.overlay_owner != 0;
        if may_be_owned && !moving {
            return Err(format!("nobody moves it in {:?}", axis.state()));
        }
        Ok(())
    }

    /// Continuous, and within the limits: of a superimposed motion `above`, with `followed` u/s² from the master. Positions
    /// are the drive's: where the zero is moves nothing.
    pub(super) fn motion(
        &mut self,
        axis: &Axis,
        promise: Promise,
        above: &AxisLimits,
        followed: f64,
    ) -> Checked {
        let overlay = std::mem::replace(&mut self.overlay, axis.overlay);
        let wrapped = axis.set_position();
        if axis.period().is_some_and(|period| !(0.0..period).contains(&wrapped)) {
            return Err(format!("{wrapped} is outside the period"));
        }
        let [before, v0, a0] = self.motion;
        let now = [axis.to_drive(wrapped), axis.set_velocity(), axis.set_acceleration()];
        self.motion = now;
        let [position, velocity, acceleration] = now;
        if !now.iter().all(|value| value.is_finite()) {
            return Err(format!("{now:?}"));
        }
        let way = position - before;
        // Of the turns of a rotary axis the one that the velocities say: a fast one makes more than half of one in a cycle.
        let mean = 0.5 * (velocity + v0) * CYCLE;
        let off = short(axis, way - mean).abs();
        let change = (velocity - v0).abs();
        if !axis.is_powered() {
            return Ok(());
        }
        let limited = axis.ramp() != RampType::Trapezoid;
        let on_top = if axis.overlay_moved {
            above.acceleration.max(above.deceleration).max(overlay.acceleration.abs())
        } else {
            0.0
        };
        let (base, before) = (axis.base, axis.saved_base);
        // The most that may be asked for, and the parts of it by which a way and a velocity may be off.
        let (most, [of_way, of_velocity]) = match promise {
            Promise::Nothing => return Ok(()),
            Promise::Smooth(rate) | Promise::OnCam { rate, .. } => {
                if base.acceleration.abs() > rate * (1.0 + 1e-9) + followed + 1e-6 {
                    return Err(format!("{acceleration} u/s², allowed {rate} u/s²"));
                }
                if let (Promise::OnCam { jerk, .. }, true) = (promise, limited) {
                    step(before.acceleration, base.acceleration, jerk)?;
                }
                // Half as much again for what the master's cycles round.
                (rate + on_top + followed, [0.75, 1.5])
            }
            Promise::Limits(limits) => {
                // Beyond the limits it first comes back to them; in errorstop it brakes both motions together.
                let from = if axis.braking.is_some() { axis.saved } else { before };
                within(from, base, &limits, limited)?;
                if axis.overlay_moved {
                    within(overlay, axis.overlay, above, limited)
                        .map_err(|what| format!("{what} on top"))?;
                }
                let steep = limits.acceleration.max(limits.deceleration);
                ((steep + on_top).max(a0.abs()), [0.25, 1.0 + 1e-9])
            }
        };
        // No step of the position: the way is the mean velocity's, but for what the rate can add.
        if off > of_way * most * CYCLE * CYCLE + 1e-9 {
            return Err(format!("a way {off} off, with {velocity} after {v0} u/s"));
        }
        if change > of_velocity * most * CYCLE + 1e-9 {
            return Err(format!("{velocity} after {v0} u/s, allowed {most} u/s²"));
        }
        Ok(())
    }
}

/// The limits are kept, once a motion has come back to them: an acceleration takes its time under limited jerk.
fn within(from: State, now: State, limits: &AxisLimits, limited: bool) -> Checked {
    let settling = 0.5 * from.acceleration * from.acceleration / JERK;
    let settling = if limited { settling } else { 0.0 };
    let fastest = limits.velocity.max(from.velocity.abs() + settling);
    let growth = now.acceleration * now.velocity.signum();
    let rate = match growth.total_cmp(&0.0) {
        _ if now.velocity == 0.0 => limits.acceleration.max(limits.deceleration),
        Ordering::Less => limits.deceleration,
        _ => limits.acceleration,
    };
    // What it has come with may be more.
    let steepest = rate.max(from.acceleration.abs());
    if now.velocity.abs() > fastest * (1.0 + 1e-9)
        || now.acceleration.abs() > steepest * (1.0 + 1e-9)
    {
        return Err(format!("{now:?} after {from:?}, allowed {limits:?}"));
    }
    if limited { step(from.acceleration, now.acceleration, limits.jerk) } else { Ok(()) }
}

/// The acceleration changes in a cycle by no more than the jerk, u/s³, allows.
fn step(before: f64, now: f64, jerk: f64) -> Checked {
    if (now - before).abs() > jerk * CYCLE * (1.0 + 1e-6) {
        return Err(format!("{now} after {before} u/s², allowed {jerk} u/s³"));
    }
    Ok(())
}
