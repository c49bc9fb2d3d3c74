//! Random homing by switch and by drive.

use super::alone::{rate, speed, way};
use super::called::{Called, any, limited, own};
use super::checker::Promise;
use crate::{Direction, Home, HomingBySwitch, HomingMode};

/// Homing by the program's switch and by the drive.
pub(super) fn all() -> Vec<Box<dyn Called>> {
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
        limited(
            |_, _| Promise::Nothing,
            |random, _, _| Home {
                position: way(random),
                deceleration: random.one_of(&[0.0, 50.0]),
            },
        ),
    ]
}
