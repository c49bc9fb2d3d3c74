//! The driver against frames computed elsewhere, and against the emulator on a pseudo-terminal; fixtures for all tests of
//! this crate.

#[path = "../../tests/common.rs"]
#[allow(dead_code, reason = "each family uses a part")]
pub(crate) mod common;
#[path = "../../tests/peer.rs"]
#[allow(dead_code, reason = "each family uses a part")]
mod peer;

mod assumptions;
mod board;
mod encoder;
mod faults;
mod peers;
mod terminal;
mod vectors;
mod wire;

use std::{f64::consts::TAU, fmt};

use crate::{
    Assumptions, AxisOptions, AxisValues, BoardAxis, Command, MoveProfile,
    emulator::{Board, BoardOptions, Cam, EmulatedBoard, EmulatorOptions},
    protocol::vectors::vector,
};
use twin_drives::{DriveError, IncrementMotion, MAX_DRIVE_AXES, SetpointStream, ramp::seconds};

pub(crate) const MS: i64 = 1_000_000;

/// The profile of vector 11, command 80.
pub(crate) fn profile(target: i32) -> MoveProfile {
    MoveProfile {
        start_stop_hz: 200,
        acceleration_khz_per_s: 50,
        speed_hz: 20_000,
        deceleration_khz_per_s: 40,
        target,
    }
}

pub(crate) fn go(axis: BoardAxis, target: i32) -> Command {
    Command::Move { axis, profile: profile(target) }
}

pub(crate) fn x_only(value: i32) -> AxisValues {
    [Some(value), None, None, None, None]
}

/// Command 6 on X.
pub(crate) fn segment_of_x(speed_hz: u32, target: i32) -> Command {
    Command::Interpolated { speed_hz, targets: x_only(target) }
}

/// Command 78 with a switch and its level: 50 kHz/s, 5000 Hz, off it at 500 Hz.
pub(crate) fn home(
    axis: BoardAxis,
    (input, contact): (u16, u16),
    max_stroke: i32,
    final_position: i32,
) -> Command {
    Command::HomeAxis {
        axis,
        input,
        contact,
        acceleration_khz_per_s: 50,
        fast_hz: 5000,
        deceleration_khz_per_s: 50,
        max_stroke,
        slow_hz: 500,
        final_position,
    }
}

/// A normally open switch.
pub(crate) fn switch(input: u8, axis: BoardAxis, from: i32, to: i32) -> Cam {
    Cam { input, axis, from, to, normally_closed: false }
}

pub(crate) fn assuming(assumptions: Assumptions) -> BoardOptions {
    BoardOptions { assumptions, ..BoardOptions::default() }
}

/// A board of which something else is assumed, unlocked.
pub(crate) fn assumed(assumptions: Assumptions) -> Board {
    let mut board = Board::new(&assuming(assumptions));
    assert_eq!(board.handle(&vector(1)), Some(vector(2)));
    board
}

pub(crate) fn unlocked() -> Board {
    assumed(Assumptions::default())
}

/// A board on a pseudo-terminal, in real time.
pub(crate) fn emulated(options: &EmulatorOptions) -> EmulatedBoard {
    EmulatedBoard::start(options, common::wall_clock()).unwrap()
}

/// A kind of errors.
pub(crate) type Kind = fn(&DriveError) -> bool;

pub(crate) const EEPROM_FAILED: Kind = |error| matches!(error, DriveError::EepromFailed { .. });
pub(crate) const ENABLE_OPEN: Kind = |error| matches!(error, DriveError::EnableOpen { .. });
pub(crate) const LOCKED: Kind = |error| matches!(error, DriveError::Locked { .. });
/// No answer, or none that can be one.
pub(crate) const LOST: Kind =
    |error| matches!(error, DriveError::Timeout { .. } | DriveError::Protocol { .. });
pub(crate) const RANGE: Kind = |error| matches!(error, DriveError::Range { .. });
pub(crate) const TIMEOUT: Kind = |error| matches!(error, DriveError::Timeout { .. });
pub(crate) const UNFINISHED: Kind = |error| matches!(error, DriveError::Unfinished { .. });

#[track_caller]
pub(crate) fn fails<T: fmt::Debug>(outcome: &Result<T, DriveError>, kind: Kind) {
    assert!(outcome.as_ref().is_err_and(kind), "{outcome:?}");
}

/// Ramps of 1000 kHz/s.
pub(crate) fn steep(axis: BoardAxis) -> AxisOptions {
    AxisOptions {
        acceleration_khz_per_s: 1000,
        deceleration_khz_per_s: 1000,
        ..AxisOptions::new(axis)
    }
}

/// The first axes, with such ramps.
pub(crate) fn steep_axes(count: usize) -> Vec<AxisOptions> {
    BoardAxis::ALL.into_iter().take(count).map(steep).collect()
}

/// A plan in closed form, at rest before its start and after its end.
pub(crate) struct Plan<C, F> {
    pub(crate) clock: C,
    pub(crate) start_ns: i64,
    pub(crate) horizon_ns: i64,
    pub(crate) end_s: f64,
    pub(crate) of: F,
}

impl<C, F> Plan<C, F> {
    /// Known 250 ms ahead.
    pub(crate) fn new(clock: C, start_ns: i64, end_s: f64, of: F) -> Self {
        Self { clock, start_ns, horizon_ns: 250 * MS, end_s, of }
    }
}

impl<C, F> SetpointStream for Plan<C, F>
where
    C: Fn() -> i64 + Sync,
    F: Fn(f64) -> IncrementMotion + Sync,
{
    fn now_ns(&self) -> i64 {
        (self.clock)() - self.start_ns
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let time = seconds(time_ns);
        let mut motion = (self.of)(time.clamp(0.0, self.end_s));
        if time < 0.0 || time >= self.end_s {
            motion.velocity = [0.0; MAX_DRIVE_AXES];
        }
        motion
    }

    fn horizon_ns(&self) -> i64 {
        self.horizon_ns
    }
}

/// Positions and velocities of the first axes.
pub(crate) fn motion(axes: impl IntoIterator<Item = (f64, f64)>) -> IncrementMotion {
    let mut motion = IncrementMotion::default();
    for (axis, (position, velocity)) in axes.into_iter().enumerate() {
        (motion.position[axis], motion.velocity[axis]) = (position, velocity);
    }
    motion
}

/// `amplitude`·(1 − cos 2πft) per axis: at rest where its time by its frequency is whole or a half.
pub(crate) fn sines(waves: Vec<(f64, f64)>) -> impl Fn(f64) -> IncrementMotion + Sync {
    move |time| {
        motion(waves.iter().map(|(amplitude, frequency)| {
            let pulsation = TAU * frequency;
            let (sin, cos) = (pulsation * time).sin_cos();
            (amplitude * (1.0 - cos), amplitude * pulsation * sin)
        }))
    }
}

/// A line of X and Y at constant speed, which begins and ends at once.
pub(crate) fn line(speed: f64) -> impl Fn(f64) -> IncrementMotion + Sync {
    move |time| motion([(speed * time, speed), (-0.5 * speed * time, -0.5 * speed)])
}
