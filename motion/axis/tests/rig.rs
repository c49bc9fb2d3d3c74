//! Test rig: an axis with its virtual drive and power on, and the blocks that most tests call.

use crate::{
    Axis, AxisConfig, Block, CamIn, Direction, Encoder, GearIn, GearInPos, Home, Master, Motion,
    MoveAbsolute, MoveAdditive, MoveRelative, MoveSuperImposed, MoveVelocity, Movement, Outputs,
    Phasing, Power, Reset, Stop, SuperImposed, VirtualDrive,
};
use std::sync::Arc;
use twin_cam::{Cam, CamInput, CamTable, Knot, Shape, StartMode, Tappet};

/// Cycle of the tests, s.
pub(super) const CYCLE: f64 = 0.01;

pub(super) struct Rig {
    pub(super) axis: Axis,
    pub(super) drive: VirtualDrive,
    /// Input of `MC_Power`.
    pub(super) power: Power,
}

/// A block that needs its axis only.
pub(super) trait Called {
    fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs;
}

impl<M: Motion<With = ()> + Clone> Called for Block<M> {
    fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
        Self::call(self, execute, axis)
    }
}

macro_rules! called {
    ($($block:ident)*) => {
        $(impl Called for $block {
            fn call(&mut self, execute: bool, axis: &mut Axis) -> Outputs {
                Self::call(self, execute, axis)
            }
        })*
    };
}

called!(Reset SuperImposed);

impl Rig {
    /// With this configuration but the cycle, powered and at a standstill at 0.
    pub(super) fn new(config: AxisConfig) -> Self {
        let axis = Axis::new(AxisConfig { cycle: CYCLE, ..config });
        let power = Power { regulator_on: true, drive_start: true };
        let mut rig = Self { axis, drive: VirtualDrive::new(0.0), power };
        rig.run(2, |_| ());
        rig
    }

    /// The same after a move to `place`.
    pub(super) fn at(mut self, place: f64) -> Self {
        self.done(&mut to(place));
        self
    }

    /// One cycle with these blocks.
    pub(super) fn cycle<T>(&mut self, blocks: impl FnOnce(&mut Axis) -> T) -> T {
        self.axis.begin_cycle(&self.drive.feedback());
        self.power.call(true, &mut self.axis);
        let shown = blocks(&mut self.axis);
        self.drive.follow(&self.axis.end_cycle());
        shown
    }

    /// `count` cycles with these blocks.
    pub(super) fn run<T>(&mut self, count: u32, mut blocks: impl FnMut(&mut Axis) -> T) {
        for _ in 0..count {
            self.cycle(&mut blocks);
        }
    }

    /// Cycles until `blocks` returns true: their number.
    pub(super) fn until(&mut self, mut blocks: impl FnMut(&mut Axis) -> bool) -> u32 {
        for count in 1..100_000 {
            if self.cycle(&mut blocks) {
                return count;
            }
        }
        panic!("it does not come to an end");
    }

    /// One cycle with this block.
    pub(super) fn call(&mut self, block: &mut impl Called, execute: bool) -> Outputs {
        self.cycle(|axis| block.call(execute, axis))
    }

    /// `count` cycles with this block, Execute TRUE.
    pub(super) fn calls(&mut self, count: u32, block: &mut impl Called) {
        self.run(count, |axis| block.call(true, axis));
    }

    /// Cycles with this block, Execute TRUE, until it is done: their number.
    pub(super) fn done(&mut self, block: &mut impl Called) -> u32 {
        self.until(|axis| block.call(true, axis).done)
    }

    /// Calls `block` until `change`, made after every cycle, has it end with an error.
    pub(super) fn fails(&mut self, block: &mut impl Called, change: impl Fn(&mut Self)) -> Outputs {
        for _ in 0..200 {
            let shown = self.call(block, true);
            if shown.error.is_some() {
                return shown;
            }
            change(self);
        }
        panic!("it does not fail");
    }
}

/// A cycle of a master with `lead` and then of its slave with `block`.
pub(super) fn follow<M: Motion<With = Master> + Clone>(
    [master, slave]: &mut [Rig; 2],
    lead: &mut impl Called,
    block: &mut Block<M>,
) -> Outputs {
    master.call(lead, true);
    slave.cycle(|axis| block.follow(true, &master.axis, axis))
}

/// Linear, 100 u/s, 100 u/s².
pub(super) fn linear() -> Rig {
    Rig::new(AxisConfig::default())
}

/// Rotary with a period of 360 u.
pub(super) fn rotary() -> Rig {
    Rig::new(AxisConfig { movement: Movement::Rotary { period: 360.0 }, ..AxisConfig::default() })
}

/// A way of an axis, u; of a rotary one the short way round.
pub(super) fn short(axis: &Axis, way: f64) -> f64 {
    axis.period().map_or(way, |period| way - period * (way / period).round())
}

pub(super) fn to(position: f64) -> Block<MoveAbsolute> {
    Block::new(MoveAbsolute {
        position,
        velocity: 10.0,
        acceleration: 100.0,
        deceleration: 100.0,
        direction: Direction::Shortest,
    })
}

pub(super) fn by(distance: f64) -> Block<MoveRelative> {
    Block::new(MoveRelative { distance, velocity: 10.0, acceleration: 100.0, deceleration: 100.0 })
}

pub(super) fn add(distance: f64) -> Block<MoveAdditive> {
    Block::new(MoveAdditive { distance, velocity: 10.0, acceleration: 100.0, deceleration: 100.0 })
}

/// Endless motion with a velocity and its sign.
pub(super) fn endless(velocity: f64) -> Block<MoveVelocity> {
    let direction = if velocity < 0.0 { Direction::Negative } else { Direction::Positive };
    endless_in(direction, velocity.abs())
}

pub(super) fn endless_in(direction: Direction, velocity: f64) -> Block<MoveVelocity> {
    let (acceleration, deceleration) = (100.0, 100.0);
    Block::new(MoveVelocity { velocity, acceleration, deceleration, direction })
}

pub(super) fn stop(deceleration: f64) -> Block<Stop> {
    Block::new(Stop { deceleration })
}

pub(super) fn home(position: f64, deceleration: f64) -> Block<Home> {
    Block::new(Home { position, deceleration })
}

/// A distance on top of the present motion, with the same acceleration and deceleration.
pub(super) fn on_top(distance: f64, velocity_diff: f64, acceleration: f64) -> SuperImposed {
    let deceleration = acceleration;
    SuperImposed::new(MoveSuperImposed { distance, velocity_diff, acceleration, deceleration })
}

/// A velocity gear with 50 u/s² both ways.
pub(super) fn gear(ratio_numerator: i32, ratio_denominator: u32) -> Block<GearIn> {
    let (acceleration, deceleration) = (50.0, 50.0);
    Block::new(GearIn { ratio_numerator, ratio_denominator, acceleration, deceleration })
}

/// A gear of a ratio that meets its master at a place, from a distance of the master on.
pub(super) fn in_pos(
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
pub(super) fn phasing(phase_shift: f64, velocity: f64, acceleration: f64) -> Block<Phasing> {
    Block::new(Phasing { phase_shift, velocity, acceleration, deceleration: acceleration })
}

/// A cam through knots, with tappets.
pub(super) fn cam(knots: &[Knot], tappets: Vec<Tappet>) -> CamTable {
    let cam = Cam::new("cam", Shape::Polynomial(knots.to_vec()), tappets).expect("a cam");
    CamTable::new(Arc::new(cam))
}

/// A straight cam: `slope` times the master, over `width`.
pub(super) fn straight(width: f64, slope: f64) -> CamTable {
    let knot = |x: f64| Knot { velocity: slope, ..Knot::at_rest(x, slope * x) };
    cam(&[knot(0.0), knot(width)], Vec::new())
}

pub(super) fn cam_in(table: CamTable, input: CamInput) -> Block<CamIn> {
    Block::new(CamIn { table: Some(table), input })
}

/// Inputs of a ramp onto a cam, with the same acceleration and deceleration.
pub(super) fn ramp_in(velocity_difference: f64, acceleration: f64) -> CamInput {
    CamInput {
        start_mode: StartMode::RampIn,
        velocity_difference,
        acceleration,
        deceleration: acceleration,
        ..CamInput::default()
    }
}

pub(super) fn encoder(movement: Movement, modulo: u32, ratio: [i64; 2]) -> Encoder {
    Encoder::new(AxisConfig { ratio, movement, cycle: CYCLE, ..AxisConfig::default() }, modulo)
}
