//! The motion of an axis against closed forms and against the manual's words.

mod homing;
mod limits;
mod orders;
mod programmed;

use super::{Axis, AxisOrder, AxisSettings, Bench};
use crate::{
    DriveMode,
    protocol::bits::{coefficient, uc},
};

pub(super) const MS: i64 = 1_000_000;

/// 1/64 steps with speeds in µsteps/s: 1000 start-stop, 10000 fast, 20000 µsteps/s².
pub(super) fn settings() -> AxisSettings {
    AxisSettings {
        coefficient: coefficient::PRESENT
            | coefficient::CAM_CLOSES
            | coefficient::SWITCHES_CLOSE
            | coefficient::NO_MOTOR_TEST,
        mode: DriveMode::from_code(0x0060).unwrap(),
        start_stop_speed: 1000,
        fast_speed: 10_000,
        acceleration: 20_000,
        ..AxisSettings::default()
    }
}

/// The same with more bits in the coefficient.
pub(super) fn with(bits: u16) -> AxisSettings {
    AxisSettings { coefficient: settings().coefficient | bits, ..settings() }
}

/// The same with bits of the coefficient cleared.
pub(super) fn without(bits: u16) -> AxisSettings {
    AxisSettings { coefficient: settings().coefficient & !bits, ..settings() }
}

/// An axis at time 0 whose counter and shaft are at 0.
pub(super) fn axis(settings: &AxisSettings, bench: &Bench) -> Axis {
    Axis::power_up(0, settings, bench, 0, 0, 0)
}

/// An axis with the usual settings and nothing on its inputs.
pub(super) fn usual() -> Axis {
    axis(&settings(), &Bench::default())
}

/// The order `uc` alone.
pub(super) fn simple(uc: u16) -> AxisOrder {
    AxisOrder { uc, ..AxisOrder::default() }
}

/// A programmed move.
pub(super) fn programmed(bloc: u32, target: i32, speed: u16) -> AxisOrder {
    AxisOrder { uc: uc::PROGRAMMED, bloc, target, speed }
}

/// Lets the axis finish and gives the time since `from_ns` in seconds, to the nanosecond.
pub(super) fn finish(axis: &mut Axis) -> f64 {
    let from_ns = axis.now_ns();
    let mut low = from_ns;
    let mut high = from_ns + 1;
    let moving = |at_ns: i64| {
        let mut later = *axis;
        later.advance(at_ns);
        later.moving()
    };
    while moving(high) {
        assert!(high - from_ns < 1_000_000 * MS, "it moves for more than a thousand seconds");
        low = high;
        high = from_ns + 2 * (high - from_ns);
    }
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if moving(middle) { low = middle } else { high = middle }
    }
    let end_ns = if moving(low) { high } else { low };
    axis.advance(end_ns);
    twin_drives::ramp::seconds(end_ns - from_ns)
}

#[track_caller]
pub(super) fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected} ± {tolerance}");
}
