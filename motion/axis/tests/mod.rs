//! Tests of axes and their blocks, cycle by cycle, and their rig: an axis with its virtual drive and power on, and the
//! blocks that most tests call.

#![allow(
    clippy::float_cmp,
    reason = "set-points that are exact: targets, values at rest, what was written"
)]

mod cams;
mod direct;
mod examples;
mod framework;
mod gears;
mod homing;
mod invariants;
mod jerk;
mod probes;
mod refusals;
mod states;
mod tables;
mod targets;
mod zeros;

use super::*;
use invariants::{Random, is_arrow};
use std::sync::Arc;
use twin_cam::{
    Action, Cam, CamInput, CamTable, Knot, Passage, Shape, StartMode, Tappet, TappetBit, TappetData,
};
use twin_profile::{AxisLimits, ProfilePoint, RampType, State};

/// Cycle of the tests, s.
const CYCLE: f64 = 0.01;

struct Rig {
    axis: Axis,
    drive: VirtualDrive,
    /// Input of `MC_Power`.
    power: Power,
}

/// A block that needs its axis only.
trait Called {
    fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs;
}

impl<M: Motion<With = ()> + Clone> Called for Block<M> {
    fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
        Self::call(self, execute, axis)
    }
}

impl Called for Reset {
    fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
        Self::call(self, execute, axis)
    }
}

impl Called for SuperImposed {
    fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
        Self::call(self, execute, axis)
    }
}

impl Rig {
    /// With this configuration but the cycle, powered and at a standstill at 0.
    fn new(config: AxisConfig) -> Self {
        let axis = Axis::new(AxisConfig { cycle: CYCLE, ..config });
        let power = Power { regulator_on: true, drive_start: true };
        let mut rig = Self { axis, drive: VirtualDrive::new(0.0), power };
        rig.run(2, |_| ());
        rig
    }

    /// The same after a move to `place`.
    fn at(mut self, place: f64) -> Self {
        self.done(&mut to(place));
        self
    }

    /// One cycle with these blocks.
    fn cycle<T>(&mut self, blocks: impl FnOnce(&mut Axis) -> T) -> T {
        self.axis.begin_cycle(&self.drive.feedback());
        self.power.call(true, &mut self.axis);
        let shown = blocks(&mut self.axis);
        self.drive.follow(&self.axis.end_cycle());
        shown
    }

    /// `count` cycles with these blocks.
    fn run<T>(&mut self, count: u32, mut blocks: impl FnMut(&mut Axis) -> T) {
        for _ in 0..count {
            self.cycle(&mut blocks);
        }
    }

    /// Cycles until `blocks` returns true: their number.
    fn until(&mut self, mut blocks: impl FnMut(&mut Axis) -> bool) -> u32 {
        for count in 1..100_000 {
            if self.cycle(&mut blocks) {
                return count;
            }
        }
        panic!("it does not come to an end");
    }

    /// One cycle with this block.
    fn call(&mut self, block: &mut impl Called, execute: bool) -> Outputs {
        self.cycle(|axis| block.call(execute, axis))
    }

    /// `count` cycles with this block, Execute TRUE.
    fn calls(&mut self, count: u32, block: &mut impl Called) {
        self.run(count, |axis| block.call(true, axis));
    }

    /// Cycles with this block, Execute TRUE, until it is done: their number.
    fn done(&mut self, block: &mut impl Called) -> u32 {
        self.until(|axis| block.call(true, axis).done)
    }

    /// Calls `block` until `change`, made after every cycle, has it end with an error: the number of calls, and its outputs.
    fn fails(&mut self, block: &mut impl Called, change: impl Fn(&mut Self)) -> (u32, Outputs) {
        for count in 1..200 {
            let shown = self.call(block, true);
            if shown.error.is_some() {
                return (count, shown);
            }
            change(self);
        }
        panic!("it does not fail");
    }
}

/// One cycle of a master and its slave.
fn pair<T>(
    [master, slave]: &mut [Rig; 2],
    lead: impl FnOnce(&mut Axis),
    follow: impl FnOnce(&Axis, &mut Axis) -> T,
) -> T {
    master.cycle(lead);
    slave.cycle(|axis| follow(&master.axis, axis))
}

/// The same with a block each.
fn follow<M: Motion<With = Master> + Clone>(
    axes: &mut [Rig; 2],
    lead: &mut impl Called,
    block: &mut Block<M>,
) -> Outputs {
    pair(axes, |axis| _ = lead.call(true, axis), |master, axis| block.follow(true, master, axis))
}

/// Linear, 100 u/s, 100 u/s².
fn linear() -> Rig {
    Rig::new(AxisConfig::default())
}

/// Rotary with a period of 360 u.
fn rotary() -> Rig {
    Rig::new(AxisConfig { movement: Movement::Rotary { period: 360.0 }, ..AxisConfig::default() })
}

/// A way of an axis, u; of a rotary one the short way round.
fn short(axis: &Axis, way: f64) -> f64 {
    axis.period().map_or(way, |period| way - period * (way / period).round())
}

/// The way until `blocks` returns true, turns counted, u, and the largest speed on it, u/s.
fn way(rig: &mut Rig, mut blocks: impl FnMut(&mut Axis) -> bool) -> [f64; 2] {
    let (mut way, mut fastest, mut before) = (0.0, 0.0_f64, rig.axis.set_position());
    rig.until(|axis| {
        let done = blocks(axis);
        way += short(axis, axis.set_position() - before);
        fastest = fastest.max(axis.set_velocity().abs());
        before = axis.set_position();
        assert!(axis.period().is_none_or(|period| (0.0..period).contains(&before)));
        done
    });
    [way, fastest]
}

fn to(position: f64) -> Block<MoveAbsolute> {
    Block::new(MoveAbsolute {
        position,
        velocity: 10.0,
        acceleration: 100.0,
        deceleration: 100.0,
        direction: Direction::Shortest,
    })
}

fn by(distance: f64) -> Block<MoveRelative> {
    Block::new(MoveRelative { distance, velocity: 10.0, acceleration: 100.0, deceleration: 100.0 })
}

fn add(distance: f64) -> Block<MoveAdditive> {
    Block::new(MoveAdditive { distance, velocity: 10.0, acceleration: 100.0, deceleration: 100.0 })
}

/// Endless motion with a velocity and its sign.
fn endless(velocity: f64) -> Block<MoveVelocity> {
    let direction = if velocity < 0.0 { Direction::Negative } else { Direction::Positive };
    endless_in(direction, velocity.abs())
}

fn endless_in(direction: Direction, velocity: f64) -> Block<MoveVelocity> {
    let (acceleration, deceleration) = (100.0, 100.0);
    Block::new(MoveVelocity { velocity, acceleration, deceleration, direction })
}

/// Watched set-points, with the same gap acceleration and deceleration.
fn watched(setpoint: Follow, gap_velocity: f64, gap_acceleration: f64) -> ControlAxisBy {
    let gap_deceleration = gap_acceleration;
    ControlAxisBy { setpoint, avoid_gaps: true, gap_velocity, gap_acceleration, gap_deceleration }
}

/// To 5 u with a velocity there.
fn past_5(end_velocity: f64, end_velocity_direction: Direction) -> MoveContinuousAbsolute {
    let MoveAbsolute { position, velocity, acceleration, deceleration, direction } = to(5.0).inputs;
    MoveContinuousAbsolute {
        position,
        velocity,
        end_velocity,
        end_velocity_direction,
        acceleration,
        deceleration,
        direction,
    }
}

fn stop(deceleration: f64) -> Block<Stop> {
    Block::new(Stop { deceleration })
}

fn home(position: f64, deceleration: f64) -> Block<Home> {
    Block::new(Home { position, deceleration })
}

/// A distance on top of the present motion, with the same acceleration and deceleration.
fn on_top(distance: f64, velocity_diff: f64, acceleration: f64) -> SuperImposed {
    let deceleration = acceleration;
    SuperImposed::new(MoveSuperImposed { distance, velocity_diff, acceleration, deceleration })
}

/// A velocity gear with 50 u/s² both ways.
fn gear(ratio_numerator: i32, ratio_denominator: u32) -> Block<GearIn> {
    let (acceleration, deceleration) = (50.0, 50.0);
    Block::new(GearIn { ratio_numerator, ratio_denominator, acceleration, deceleration })
}

/// A gear of a ratio that meets its master at a place, from a distance of the master on.
fn in_pos(
    [ratio_numerator, ratio_denominator]: [i32; 2],
    [master_sync_position, slave_sync_position]: [f64; 2],
    master_start_distance: f64,
) -> Block<GearInPos> {
    Block::new(GearInPos {
        ratio_numerator,
        ratio_denominator,
        master_sync_position,
        slave_sync_position,
        master_start_distance,
    })
}

/// A phase shift with the same acceleration and deceleration.
fn phasing(phase_shift: f64, velocity: f64, acceleration: f64) -> Block<Phasing> {
    Block::new(Phasing { phase_shift, velocity, acceleration, deceleration: acceleration })
}

/// A cam through knots, with tappets.
fn cam(knots: &[Knot], tappets: Vec<Tappet>) -> CamTable {
    let cam = Cam::new("cam", Shape::Polynomial(knots.to_vec()), tappets).expect("a cam");
    CamTable::new(Arc::new(cam))
}

/// A straight cam: `slope` times the master, over `width`.
fn straight(width: f64, slope: f64) -> CamTable {
    let knot = |x: f64| Knot { velocity: slope, ..Knot::at_rest(x, slope * x) };
    cam(&[knot(0.0), knot(width)], Vec::new())
}

/// The bit of group 1 after a cycle of its cam.
fn switched(bit: &mut TappetBit, tappets: &TappetData) -> bool {
    for trigger in tappets.triggers().filter(|trigger| trigger.group == 1) {
        bit.take(trigger);
    }
    bit.at(tappets.now_ns)
}

fn cam_in(table: CamTable, input: CamInput) -> Block<CamIn> {
    Block::new(CamIn { table: Some(table), input })
}

/// Inputs of a ramp onto a cam, with the same acceleration and deceleration.
fn ramp_in(velocity_difference: f64, acceleration: f64) -> CamInput {
    CamInput {
        start_mode: StartMode::RampIn,
        velocity_difference,
        acceleration,
        deceleration: acceleration,
        ..CamInput::default()
    }
}
