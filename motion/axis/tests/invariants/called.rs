//! Every block that moves an axis, with inputs that change at random.

use super::checker::{Limits, Promise};
use super::coupled::{self, InPos, OnCam};
use super::random::Random;
use super::{FASTEST, JERK, STEEPEST};
use crate::axis::profile::{ProfilePoint, State};
use crate::axis::tests::rig::{self, CYCLE};
use crate::axis::{
    AbortTrigger, AccelerationProfile, Axis, Block, CamIn, ControlAxisBy, ControllerMode, Decouple,
    Direction, Follow, GearIn, GearInPos, Halt, Home, HomingBySwitch, HomingMode, Master, Motion,
    MoveAbsolute, MoveAdditive, MoveContinuousAbsolute, MoveContinuousRelative, MoveRelative,
    MoveSuperImposed, MoveVelocity, Outputs, ParameterNumber, Phasing, Points, PositionProfile,
    SetControllerMode, Stop, SuperImposed, TouchProbe, Trigger, VelocityProfile, WriteParameter,
};
use crate::cam::{Cam, CamInput, CamTable, Knot, Shape, StartMode};
use std::any::type_name;
use std::sync::Arc;

/// A block that can be called.
pub(super) trait Called {
    fn call(
        &mut self,
        execute: bool,
        random: &mut Random,
        axis: &mut Axis,
        master: &Axis,
    ) -> Outputs;

    /// What it has to keep beside what all blocks keep, after it has been called.
    fn watch(&mut self, _shown: Outputs, _axis: &Axis, _master: &Axis) -> Result<(), String> {
        Ok(())
    }

    /// Other inputs, now and then wrong ones.
    fn change(&mut self, random: &mut Random, axis: &Axis, master: &Axis);

    /// What it is called.
    fn name(&self) -> &'static str {
        type_name::<Self>()
    }

    /// Who it is while it moves the axis.
    fn owner(&self) -> i64 {
        0
    }

    /// Whether it never ends, never fails, and is never aborted.
    fn exceptions(&self) -> [bool; 3] {
        let name = self.name();
        [
            name.contains("Follow") || name.contains("ControlAxis"),
            name.contains("Probe") || name.contains("Mode"),
            ["Stop", "Hom", "Mode", "Write"].iter().any(|it| name.contains(it)),
        ]
    }

    /// What it keeps while it moves the axis.
    fn promise(&self) -> Promise {
        Promise::USUAL
    }

    /// What it keeps while it moves on top of another block.
    fn on_top(&self) -> Option<Limits> {
        None
    }
}

/// What a block needs beside its axis, from the master.
pub(super) trait Take {
    fn take(master: &Axis) -> Self;
}

impl Take for () {
    fn take(_: &Axis) -> Self {}
}

impl Take for Master {
    fn take(master: &Axis) -> Self {
        Self::of(master)
    }
}

/// A [`Block`], how its inputs are chosen, and how those that count every cycle change.
pub(super) struct Moving<M: Motion> {
    pub(super) block: Block<M>,
    promise: Keeps<M>,
    /// What it was given when it began, and whether it has been done since, whatever it shows.
    pub(super) taken: M,
    done: bool,
    inputs: fn(&mut Random, &Axis, &Axis) -> M,
    live: Live<M>,
    execute: bool,
}

/// What a block keeps that was given these inputs, and is done (in gear) or not yet.
pub(super) type Keeps<M> = fn(&M, bool) -> Promise;

/// How inputs that count every cycle change, with how the axis goes on from the last cycle.
type Live<M> = fn(&mut M, &mut Random, &Axis, State);

impl<M: Motion<With: Take> + Clone> Called for Moving<M> {
    fn call(
        &mut self,
        execute: bool,
        random: &mut Random,
        axis: &mut Axis,
        master: &Axis,
    ) -> Outputs {
        let rises = execute && !self.execute;
        self.execute = execute;
        // Who takes over does so from all there is, motions on top included.
        let goes_on = self.block.owner() == Some(axis.owner()) && !rises;
        let from = if goes_on { axis.saved_base } else { axis.saved };
        (self.live)(&mut self.block.inputs, random, axis, from);
        if rises {
            self.taken = self.block.inputs.clone();
            self.done = false;
        }
        let shown = self.block.call_with(execute, axis, M::With::take(master));
        self.done |= shown.done;
        shown
    }

    fn change(&mut self, random: &mut Random, axis: &Axis, master: &Axis) {
        self.block.inputs = (self.inputs)(random, axis, master);
    }

    fn name(&self) -> &'static str {
        type_name::<M>()
    }

    fn owner(&self) -> i64 {
        self.block.owner().unwrap_or_default()
    }

    fn promise(&self) -> Promise {
        (self.promise)(&self.taken, self.done)
    }
}

/// A block that keeps what it promises, and whose inputs are taken over at the rising edge.
pub(super) fn limited<M: Motion<With: Take> + Clone + 'static>(
    promise: Keeps<M>,
    inputs: fn(&mut Random, &Axis, &Axis) -> M,
) -> Box<dyn Called> {
    any(promise, inputs, |_, _, _, _| ())
}

fn any<M: Motion<With: Take> + Clone + 'static>(
    promise: Keeps<M>,
    inputs: fn(&mut Random, &Axis, &Axis) -> M,
    live: Live<M>,
) -> Box<dyn Called> {
    Box::new(moving(promise, inputs, live))
}

fn moving<M: Motion<With: Take> + Clone>(
    promise: Keeps<M>,
    inputs: fn(&mut Random, &Axis, &Axis) -> M,
    live: Live<M>,
) -> Moving<M> {
    let nowhere = Axis::new(crate::axis::AxisConfig::default());
    let block = Block::new(inputs(&mut Random(1), &nowhere, &nowhere));
    let taken = block.inputs.clone();
    Moving { block, promise, taken, done: false, inputs, live, execute: false }
}

/// The block's own velocity, acceleration and deceleration.
fn own(velocity: f64, acceleration: f64, deceleration: f64) -> Promise {
    Promise::Limits(Limits::new(velocity, acceleration, deceleration))
}

/// What it was given when it began, too.
struct OnTop(SuperImposed, Limits, bool);

impl Called for OnTop {
    fn call(&mut self, execute: bool, _: &mut Random, axis: &mut Axis, _: &Axis) -> Outputs {
        if execute && !self.2 {
            let MoveSuperImposed { velocity_diff, acceleration, deceleration, .. } = self.0.inputs;
            self.1 = Limits::new(velocity_diff, acceleration, deceleration);
        }
        self.2 = execute;
        self.0.call(execute, axis)
    }

    fn on_top(&self) -> Option<Limits> {
        Some(self.1)
    }

    fn change(&mut self, random: &mut Random, _: &Axis, _: &Axis) {
        self.0.inputs.distance = random.between(-6.0, 6.0);
        self.0.inputs.velocity_diff = speed(random);
        (self.0.inputs.acceleration, self.0.inputs.deceleration) = (rate(random), rate(random));
    }
}

/// Another controller mode, now and then.
struct Mode(SetControllerMode);

impl Called for Mode {
    fn call(&mut self, execute: bool, _: &mut Random, axis: &mut Axis, _: &Axis) -> Outputs {
        self.0.call(execute, axis)
    }

    fn change(&mut self, random: &mut Random, _: &Axis, _: &Axis) {
        use ControllerMode::{Current, Position, Torque, Velocity};
        self.0.mode = random.one_of(&[Position, Position, Position, Velocity, Torque, Current]);
    }
}

/// Parameters that change nothing about motion, protected ones and unknown ones.
struct Write {
    block: WriteParameter,
    execute: bool,
    /// Which one it was given when it began.
    taken: u16,
}

impl Write {
    const FREE: [u16; 3] = [1112, 1122, 1132];
    const PROTECTED: [u16; 6] = [1000, 1022, 1030, 1100, 1110, 999];
}

impl Called for Write {
    fn call(&mut self, execute: bool, _: &mut Random, axis: &mut Axis, _: &Axis) -> Outputs {
        if execute && !self.execute {
            self.taken = match self.block.number {
                ParameterNumber::Axis(number) => number,
                ParameterNumber::Drive(_) => 0,
            };
        }
        self.execute = execute;
        self.block.call(execute, axis)
    }

    fn watch(&mut self, shown: Outputs, axis: &Axis, _: &Axis) -> Result<(), String> {
        let free = Self::FREE.contains(&self.taken);
        if shown.busy || (shown.done && !free) || (shown.error.is_some() && free) {
            return Err(format!("{} in {:?}: {shown:?}", self.taken, axis.state()));
        }
        Ok(())
    }

    fn change(&mut self, random: &mut Random, _: &Axis, _: &Axis) {
        let numbers = if random.one_in(2) { &Self::FREE[..] } else { &Self::PROTECTED };
        self.block.number = ParameterNumber::Axis(random.one_of(numbers));
        self.block.value = random.between(1.0, 100.0);
    }
}

/// A probe of the program or of the drive.
struct Probe {
    block: TouchProbe,
    trigger: Trigger,
    abort: AbortTrigger,
}

impl Called for Probe {
    fn call(&mut self, execute: bool, random: &mut Random, axis: &mut Axis, _: &Axis) -> Outputs {
        self.trigger.input = random.one_in(100);
        self.abort.call(random.one_in(500), axis, &mut self.trigger);
        self.block.call(execute, axis, &mut self.trigger).outputs
    }

    fn change(&mut self, random: &mut Random, _: &Axis, _: &Axis) {
        let window = [random.between(0.0, 90.0), random.between(0.0, 90.0)];
        self.block.window = (!random.one_in(3)).then_some(window);
    }
}

fn rate(random: &mut Random) -> f64 {
    if random.one_in(50) { 0.0 } else { random.between(0.2 * STEEPEST, STEEPEST) }
}

fn speed(random: &mut Random) -> f64 {
    random.between(0.1, 0.5 * FASTEST)
}

fn way(random: &mut Random) -> f64 {
    random.between(-20.0, 20.0)
}

/// Moves of the axis alone.
pub(super) fn single() -> Vec<Box<dyn Called>> {
    vec![
        limited(
            |it: &MoveAbsolute, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveAbsolute {
                position: random.between(0.0, 90.0),
                velocity: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
                direction: random.direction(),
            },
        ),
        limited(
            |it: &MoveRelative, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveRelative {
                distance: way(random),
                velocity: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
            },
        ),
        limited(
            |it: &MoveAdditive, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveAdditive {
                distance: way(random),
                velocity: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
            },
        ),
        limited(
            |it: &MoveVelocity, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveVelocity {
                velocity: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
                direction: random.direction(),
            },
        ),
        limited(
            |it: &Halt, _| own(0.0, it.deceleration, it.deceleration),
            |random, _, _| Halt { deceleration: rate(random) },
        ),
        limited(
            |it: &Stop, _| own(0.0, it.deceleration, it.deceleration),
            |random, _, _| Stop { deceleration: rate(random) },
        ),
        on_top(),
    ]
}

/// Called last, as the manual has it.
fn on_top() -> Box<dyn Called> {
    let limits = Limits::new(1.0, 1.0, 1.0);
    Box::new(OnTop(rig::on_top(1.0, 1.0, 1.0, 1.0), limits, false))
}

fn probe(trigger: Trigger) -> Box<dyn Called> {
    Box::new(Probe { block: TouchProbe::new(None), trigger, abort: AbortTrigger::default() })
}

/// All blocks there are.
pub(super) fn all() -> Vec<Box<dyn Called>> {
    let mut blocks = single();
    blocks.pop();
    blocks.extend(continued());
    blocks.extend(coupled());
    blocks.extend(direct());
    blocks.extend(homed());
    blocks.push(Box::new(Mode(SetControllerMode::default())));
    let block = WriteParameter::new(ParameterNumber::Axis(1112), 1.0);
    blocks.push(Box::new(Write { block, execute: false, taken: 1112 }));
    blocks.extend([probe(Trigger::of_program()), probe(Trigger::of_drive(1)), on_top()]);
    blocks
}

/// Moves on from a place, and through tables.
fn continued() -> Vec<Box<dyn Called>> {
    /// Some steps of random size, smaller than `size`.
    fn points(random: &mut Random, size: f64, end: Option<f64>) -> Points {
        let mut points: Vec<_> = (0..random.one_of(&[1, 2, 5]))
            .map(|_| ProfilePoint {
                delta_time: random.between(0.2, 0.6),
                value: random.between(-size, size),
            })
            .collect();
        if let Some(value) = end.filter(|_| !random.one_in(3)) {
            points.push(ProfilePoint { delta_time: 0.4, value });
        }
        Points::new(points)
    }
    vec![
        limited(
            |it: &MoveContinuousAbsolute, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveContinuousAbsolute {
                position: random.between(0.0, 90.0),
                velocity: 0.5 * FASTEST,
                end_velocity: speed(random),
                end_velocity_direction: random.direction(),
                acceleration: rate(random),
                deceleration: rate(random),
                direction: random.direction(),
            },
        ),
        limited(
            |it: &MoveContinuousRelative, _| own(it.velocity, it.acceleration, it.deceleration),
            |random, _, _| MoveContinuousRelative {
                distance: way(random),
                velocity: 0.5 * FASTEST,
                end_velocity: speed(random),
                end_velocity_direction: random.direction(),
                acceleration: rate(random),
                deceleration: rate(random),
            },
        ),
        limited(
            |_, _| Promise::Smooth,
            |random, _, _| PositionProfile(Points { absolute: false, ..points(random, 3.0, None) }),
        ),
        limited(
            |_, _| Promise::Smooth,
            |random, _, _| VelocityProfile(points(random, 10.0, Some(0.0))),
        ),
        limited(
            |_, _| Promise::Smooth,
            |random, _, _| AccelerationProfile(points(random, 20.0, None)),
        ),
    ]
}

/// Behind a master that does at most 10 u/s and 60 u/s², with half the jerk.
fn coupled() -> Vec<Box<dyn Called>> {
    vec![
        limited(
            |it: &GearIn, in_gear| {
                let ratio = f64::from(it.ratio_numerator) / f64::from(it.ratio_denominator);
                let (fastest, steepest) = (10.0 * ratio.abs(), 60.0 * ratio.abs());
                // In gear it does what the master does, in whatever direction.
                let rate = |own: f64| {
                    if in_gear { it.acceleration.max(it.deceleration).max(steepest) } else { own }
                };
                own(fastest, rate(it.acceleration), rate(it.deceleration))
            },
            |random, _, _| GearIn {
                ratio_numerator: random.one_of(&[-3, -2, -1, 0, 1, 2, 3]),
                ratio_denominator: random.one_of(&[2, 2, 3, 5, 0]),
                acceleration: rate(random),
                deceleration: rate(random),
            },
        ),
        limited(
            |it: &Phasing, _| {
                // What falls in the shift may grow in the sum.
                let rate = it.acceleration.max(it.deceleration) + 60.0;
                let velocity = it.velocity + 10.0;
                let jerk = 1.5 * JERK;
                Promise::Limits(Limits { velocity, acceleration: rate, deceleration: rate, jerk })
            },
            |random, _, _| Phasing {
                phase_shift: way(random),
                velocity: random.between(0.1, 5.0),
                acceleration: rate(random).min(100.0),
                deceleration: rate(random).min(100.0),
            },
        ),
        Box::new(InPos(moving(
            |_, _| Promise::Smooth,
            |random, axis, master| {
                let sign = if master.set_velocity() < 0.0 { -1.0 } else { 1.0 };
                GearInPos {
                    ratio_numerator: random.one_of(&[-3, -1, 1, 2, 3]),
                    ratio_denominator: random.one_of(&[1, 2, 5, 0]),
                    master_sync_position: master.set_position() + sign * random.between(2.0, 30.0),
                    slave_sync_position: axis.set_position() + way(random),
                    master_start_distance: random.one_of(&[0.0, 5.0, 20.0]),
                }
            },
            |_, _, _, _| (),
        ))),
        on_cam(),
        // One more, so that cams are switched between.
        on_cam(),
        // On with whatever velocity there was.
        limited(|_, _| own(f64::INFINITY, STEEPEST, STEEPEST), |_, _, _| Decouple),
    ]
}

/// The cam itself has at most 0.94·1500 u/s³ of the master's jerk, 3·0.072·15·90 of its velocity and acceleration and
/// 0.019·15³ of its velocity alone, 1762 u/s³ together; the ramp onto it has the axis's beside that.
fn on_cam() -> Box<dyn Called> {
    let moving = moving(
        |it: &CamIn, _| {
            let absolute = it.table.as_ref().is_some_and(|table| table.master_absolute);
            if absolute { Promise::OnMaster(JERK + 1762.0) } else { Promise::Jerk(JERK + 1762.0) }
        },
        |random, _, _| CamIn { table: cam(random), input: cam_input(random) },
        |_, _, _, _| (),
    );
    Box::new(OnCam::new(moving))
}

fn cam(random: &mut Random) -> Option<CamTable> {
    let knots =
        vec![Knot::at_rest(0.0, 0.0), Knot::at_rest(40.0, way(random)), Knot::at_rest(90.0, 0.0)];
    let cam = Cam::new("cam", Shape::Polynomial(knots), coupled::tappets(random)).unwrap();
    let table = CamTable {
        periodic: random.one_in(2),
        master_absolute: random.one_in(2),
        slave_absolute: random.one_in(2),
        ..CamTable::new(Arc::new(cam))
    };
    (!random.one_in(20)).then_some(table)
}

fn cam_input(random: &mut Random) -> CamInput {
    // The other two are allowed to jump.
    let modes = [StartMode::RampIn, StartMode::RampInPositive, StartMode::RampInNegative];
    CamInput {
        master_scaling: random.between(0.5, 1.5),
        slave_offset: way(random),
        slave_scaling: random.between(-1.0, 1.0),
        start_mode: random.one_of(&modes),
        velocity_difference: speed(random),
        acceleration: rate(random),
        deceleration: rate(random),
        tappet_hysteresis: random.one_of(&[0.0, 2.0]),
        ..CamInput::default()
    }
}

/// Set-points from the program: a walk for those that are not watched, jumps for those that are.
fn direct() -> Vec<Box<dyn Called>> {
    fn walk(it: &mut Follow, random: &mut Random, axis: &Axis, last: State) {
        let change = random.between(-STEEPEST, STEEPEST) * axis.cycle();
        let velocity = (last.velocity + change).clamp(-0.5 * FASTEST, 0.5 * FASTEST);
        let mean = 0.5 * (last.velocity + velocity);
        let after = |velocity: f64| axis.in_program(last.position + velocity * axis.cycle());
        *it = match *it {
            Follow::Position(_) => Follow::Position(after(velocity)),
            Follow::Velocity(_) => Follow::Velocity(velocity),
            Follow::PositionVelocity(..) => Follow::PositionVelocity(after(mean), velocity),
        };
    }
    fn kind(random: &mut Random) -> Follow {
        let kinds =
            [Follow::Position(0.0), Follow::Velocity(0.0), Follow::PositionVelocity(0.0, 0.0)];
        random.one_of(&kinds)
    }
    vec![
        any(|_, _| Promise::Smooth, |random, _, _| kind(random), walk),
        any(
            // Set-points of the program have no jerk.
            |_, _| {
                let limits = Limits::new(FASTEST, STEEPEST, STEEPEST);
                Promise::Limits(Limits { jerk: f64::INFINITY, ..limits })
            },
            |random, _, _| ControlAxisBy {
                setpoint: kind(random),
                avoid_gaps: true,
                gap_velocity: random.between(-1.0, 0.5 * FASTEST),
                gap_acceleration: rate(random),
                gap_deceleration: rate(random),
            },
            |it, random, _, _| {
                if !random.one_in(50) {
                    return;
                }
                let position = random.between(0.0, 90.0);
                it.setpoint = match it.setpoint {
                    // What is not too fast is no jump (manual 2.2.5), and no promise.
                    Follow::Position(last) if (position - last).abs() < FASTEST * CYCLE => return,
                    Follow::Position(_) => Follow::Position(position),
                    Follow::Velocity(_) => Follow::Velocity(0.5 * way(random)),
                    Follow::PositionVelocity(..) => Follow::PositionVelocity(position, 0.0),
                };
            },
        ),
    ]
}

/// Homing by the program's switch and by the drive.
fn homed() -> Vec<Box<dyn Called>> {
    use HomingMode::{
        FastBackSlowIndexSetStop, FastBackSlowSetStop, FastBackSlowStopSet, FastSlowIndexSetStop,
        FastSlowSetStop, FastSlowStopSet,
    };
    const MODES: [HomingMode; 6] = [
        FastBackSlowSetStop,
        FastBackSlowStopSet,
        FastBackSlowIndexSetStop,
        FastSlowSetStop,
        FastSlowStopSet,
        FastSlowIndexSetStop,
    ];
    vec![
        any(
            |it: &HomingBySwitch, _| {
                own(it.velocity_fast.max(it.velocity_slow), it.acceleration, it.deceleration)
            },
            |random, _, _| HomingBySwitch {
                home_position: way(random),
                velocity_slow: random.between(0.5, 3.0),
                velocity_fast: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
                direction: random.one_of(&[Direction::Negative, Direction::Positive]),
                end_switch: true,
                signal_delay: random.one_of(&[0.0, 0.03]),
                mode: random.one_of(&MODES),
                return_to_zero: random.one_in(2),
                index_occurred: false,
                index_position: 0.0,
                ignore_hw_limit: random.one_in(2),
            },
            |it, _, axis, _| {
                // Closed for 2 u of every 10 of the drive's, a pulse at each tenth u.
                let at = axis.to_drive(axis.act_position());
                it.end_switch = at.rem_euclid(10.0) >= 2.0;
                it.index_occurred = at.rem_euclid(1.0) < 0.1;
                it.index_position = axis.in_program(at.floor());
            },
        ),
        limited(|_, _| Promise::Nothing, |random, _, _| Home { position: way(random) }),
    ]
}
