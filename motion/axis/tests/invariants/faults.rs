//! Tests of the checker: it must find every planted fault and name it.

use super::called::{self, Called};
use super::planted::{self, Owning, with_tappets};
use super::{Around, KINDS, Run, alone};
use crate::{Axis, AxisState, CamIn, Movement, Outputs};
use twin_profile::RampType;

#[test]
fn the_checker_sees_what_is_broken() {
    type Spoil = fn(u32, &mut Axis, &mut Outputs);
    let spoils: [(&str, &str, Spoil); 11] = [
        ("swallowed done", "has no end", |_, _, shown| shown.done = false),
        ("swallowed abort", "has no end", |_, _, shown| shown.command_aborted = false),
        ("busy", "is busy and does not have the axis", |call, _, shown| {
            shown.busy |= call > 5_000 && shown.command_aborted;
            shown.command_aborted &= call <= 5_000;
        }),
        ("position", "a way of ", |call, axis, _| {
            if call > 5_000 {
                axis.base.position += 0.05;
            }
        }),
        ("velocity", "a way of ", |call, axis, _| {
            if call == 5_000 {
                axis.base.velocity += 5.0;
                axis.show_set_values();
            }
        }),
        ("limit", "allowed Limits", |call, axis, _| {
            if call > 5_000 {
                axis.base.velocity = 31.0;
            }
        }),
        ("acceleration", "allowed Limits", |call, axis, _| {
            if call > 5_000 {
                axis.base.acceleration = 401.0;
            }
        }),
        ("owner", "0 blocks own 77777", |call, axis, _| {
            if call > 5_000 {
                axis.values.owner = 77_777;
            }
        }),
        ("state", "a stop that is held", |call, axis, _| {
            if call > 5_000 && axis.owner() == 0 {
                axis.values.owner = 0;
                axis.enter(AxisState::Homing);
            }
        }),
        ("done twice", "ends twice", |call, _, shown| {
            shown.done |= call % 3_001 == 0;
        }),
        ("two at once", "a stop is aborted", |_, _, shown| {
            shown.command_aborted |= shown.done;
        }),
    ];
    for (what, words, spoil) in spoils {
        let found = (0..8).any(|seed| {
            Run::new(seed, KINDS[0], called::single(), Around::Forgotten)
                .calls(50_000, spoil)
                .is_err_and(|message| message.contains(words))
        });
        assert!(found, "nobody sees a wrong {what}");
    }
}

#[test]
fn the_checker_sees_illegal_states() {
    type Blocks = fn() -> Vec<Box<dyn Called>>;
    type Spoil = fn(u32, &mut Axis, &mut Outputs);
    let nothing: Spoil = |_, _, _| ();
    let step: Spoil = |call, axis, _| {
        if call > 5_000 && axis.state() == AxisState::DiscreteMotion {
            axis.enter(AxisState::Homing);
            axis.enter(AxisState::DiscreteMotion);
        }
    };
    let silent: Spoil = |call, axis, _| {
        if call > 5_000 && axis.state() == AxisState::DiscreteMotion {
            axis.state = AxisState::ContinuousMotion;
        }
    };
    let lets_go: Spoil = |call, axis, _| {
        if call > 5_000 && axis.state() == AxisState::Stopping {
            axis.release(axis.owner());
        }
    };
    let aborted: Spoil = |_, axis, shown| {
        shown.command_aborted |= axis.state() == AxisState::Stopping && shown.done;
        shown.done &= !shown.command_aborted;
    };
    let rude: Blocks = || with(planted::rude());
    let mislabelled: Blocks = || with(planted::mislabelled());
    let plain: Blocks = called::single;
    for (what, blocks, spoil, expected) in [
        ("step", plain, step, "illegal: DiscreteMotion to Homing"),
        ("state", plain, silent, "by itself"),
        ("end of a stop", plain, lets_go, "takes the axis from a stop that is held"),
        ("abort", plain, aborted, "a stop is aborted"),
        ("move while stopping", rude, nothing, "illegal: Stopping to DiscreteMotion"),
        ("move of velocity", mislabelled, nothing, "MoveVelocity moves it in DiscreteMotion"),
    ] {
        let found: Vec<_> = (0..8)
            .filter_map(|seed| {
                Run::new(seed, KINDS[0], blocks(), Around::Forgotten).calls(50_000, spoil).err()
            })
            .collect();
        assert!(
            found.iter().any(|it| it.contains(expected)),
            "nobody sees a wrong {what}: {found:?}"
        );
    }
}

/// Faults of the ownership of an axis.
#[test]
fn the_checker_sees_who_has_the_axis() {
    for (owning, expected) in [
        (Owning::Usurps, "MoveRelative commands an axis of"),
        (Owning::Masked, "both command the axis"),
        (Owning::Claims, "2 blocks own"),
        (Owning::Deaf, "MoveRelative: is busy and does not have the axis"),
        (Owning::Two, "commands the axis [2, 0] times"),
    ] {
        sees(&format!("{owning:?}"), &KINDS[..1], expected, || with(planted::greedy(owning)));
    }
}

/// Blocks that deviate from their inputs too little to show in the axis's own values.
#[test]
fn the_checker_sees_what_blocks_were_not_asked() {
    type Planted = fn() -> Box<dyn Called>;
    let limited = [KINDS[1], KINDS[2], KINDS[4], KINDS[5]];
    let planted: [(&str, &[_], &str, Planted); 13] = [
        ("jerk", &limited, "u/s³, moved by", planted::jerky),
        ("position profile", &KINDS, "allowed Limits", planted::hurried_positions),
        ("velocity profile", &KINDS, "allowed Limits", planted::hurried_velocities),
        ("acceleration profile", &limited, "u/s³, moved by", planted::hurried_accelerations),
        ("set-point", &KINDS, "is not the set-point", planted::beyond),
        ("gear on its way", &KINDS, "on the way into step, but", planted::wrong_gear),
        ("ramp", &KINDS, "off the cam after", || {
            planted::wrong_cam(|it| it.input.velocity_difference *= 1.5)
        }),
        ("rate", &[KINDS[0], KINDS[3]], "u/s², allowed", || {
            planted::wrong_cam(|CamIn { input, .. }| {
                input.acceleration *= 5.0;
                input.deceleration *= 5.0;
            })
        }),
        ("cam", &KINDS, "in step, but", planted::fast_cam),
        ("lost tappet", &KINDS, "acted 0 times, not 1", || {
            planted::wrong_cam(|it| with_tappets(it, Vec::clear))
        }),
        ("doubled tappet", &KINDS, "acted 2 times, not 1", || {
            planted::wrong_cam(|it| with_tappets(it, |all| all.extend_from_within(..)))
        }),
        ("late pulse", &KINDS, "is not there at", || {
            planted::wrong_cam(|it| with_tappets(it, planted::delay))
        }),
        ("way on top", &KINDS, "on top, moved by", || alone::hasty_on_top(1.5)),
    ];
    for (what, kinds, expected, block) in planted {
        sees(what, kinds, expected, || match what {
            "way on top" => {
                let mut blocks = alone::moves();
                blocks.push(block());
                blocks
            }
            _ => with(block()),
        });
    }
}

/// The checker finds it in every one of these kinds, in one of some runs.
fn sees(
    what: &str,
    kinds: &[(Movement, RampType)],
    expected: &str,
    blocks: impl Fn() -> Vec<Box<dyn Called>>,
) {
    for kind in kinds {
        let mut found = Vec::new();
        for seed in 0..8 {
            let mut run = Run::new(seed, *kind, blocks(), Around::Forgotten);
            found.extend(run.calls(200_000, |_, _, _| ()).err());
            if found.last().is_some_and(|message| message.contains(expected)) {
                break;
            }
        }
        assert!(
            found.last().is_some_and(|message| message.contains(expected)),
            "nobody sees a wrong {what} of {kind:?}: {found:?}"
        );
    }
}

/// Moves of the axis alone, and a planted one.
fn with(planted: Box<dyn Called>) -> Vec<Box<dyn Called>> {
    let mut blocks = called::single();
    blocks.insert(0, planted);
    blocks
}
