//! Tests of the checker: it must find every planted fault and name it.

use super::*;
use planted::{greedy, with_tappets, wrong_cam};

/// Kinds of axes, and those with limited jerk.
type Kinds = [(Movement, RampType)];
const LIMITED: [(Movement, RampType); 4] = [KINDS[1], KINDS[2], KINDS[4], KINDS[5]];

/// Breaks a rule after a call, from the 5000th on.
type Break = fn(u32, &mut Axis, &mut Outputs);
type Planted = fn() -> Box<dyn Called>;

/// The checker finds it in every one of these kinds, in one of some runs of this number of calls.
fn sees(
    what: &str,
    (kinds, calls): (&Kinds, u32),
    expected: &str,
    blocks: impl Fn() -> Vec<Box<dyn Called>>,
    spoil: Break,
) {
    for kind in kinds {
        let mut found = Vec::new();
        let seen = (0..8).any(|seed| {
            let mut run = Run::new(seed, *kind, blocks(), Around::Forgotten);
            let spoiled = run.calls(calls, &mut |call, axis, shown| {
                if call >= 5_000 {
                    spoil(call, axis, shown);
                }
            });
            found.extend(spoiled.err());
            found.last().is_some_and(|message| message.contains(expected))
        });
        assert!(seen, "nobody sees a wrong {what} of {kind:?}: {found:?}");
    }
}

/// Moves of the axis alone, and a planted one.
fn with(planted: Box<dyn Called>) -> Vec<Box<dyn Called>> {
    let mut blocks = called::single();
    blocks.insert(0, planted);
    blocks
}

#[test]
fn the_checker_sees_what_is_broken() {
    let spoils: [(&str, &str, Break); 15] = [
        ("swallowed done", "has no end", |_, _, shown| shown.done = false),
        ("swallowed abort", "has no end", |_, _, shown| shown.command_aborted = false),
        ("busy", "is busy and does not have the axis", |_, _, shown| {
            (shown.busy, shown.command_aborted) = (shown.busy || shown.command_aborted, false);
        }),
        ("position", "a way ", |_, axis, _| axis.base.position += 0.05),
        ("velocity", "a way ", |call, axis, _| {
            if call == 6_000 {
                axis.base.velocity += 5.0;
                axis.show_set_values();
            }
        }),
        ("limit", "allowed AxisLimits", |_, axis, _| axis.base.velocity = 31.0),
        ("acceleration", "allowed AxisLimits", |_, axis, _| axis.base.acceleration = 401.0),
        ("owner", "0 blocks own 77777", |_, axis, _| axis.values.owner = 77_777),
        ("homing", "a stop that is held", |_, axis, _| {
            if axis.owner() == 0 {
                axis.enter(AxisState::Homing);
            }
        }),
        ("done twice", "ends twice", |call, _, shown| shown.done |= call % 3_001 == 0),
        ("two at once", "a stop is aborted", |_, _, shown| shown.command_aborted |= shown.done),
        ("step", "illegal: DiscreteMotion to Homing", |_, axis, _| {
            if axis.state() == AxisState::DiscreteMotion {
                axis.enter(AxisState::Homing);
                axis.enter(AxisState::DiscreteMotion);
            }
        }),
        ("state", "by itself", |_, axis, _| {
            if axis.state() == AxisState::DiscreteMotion {
                axis.state = AxisState::ContinuousMotion;
            }
        }),
        ("end of a stop", "takes the axis from a stop that is held", |_, axis, _| {
            if axis.state() == AxisState::Stopping {
                axis.release(axis.owner());
            }
        }),
        ("abort", "a stop is aborted", |_, axis, shown| {
            shown.command_aborted |= axis.state() == AxisState::Stopping && shown.done;
            shown.done &= !shown.command_aborted;
        }),
    ];
    for (what, expected, spoil) in spoils {
        sees(what, (&KINDS[..1], 50_000), expected, called::single, spoil);
    }
}

/// Blocks that take the axis against the states and the ownership.
#[test]
fn the_checker_sees_who_has_the_axis() {
    let planted: [(&str, &str, Planted); 7] = [
        ("move while stopping", "illegal: Stopping to DiscreteMotion", planted::rude),
        ("move of velocity", "MoveVelocity moves it in DiscreteMotion", planted::mislabelled),
        ("usurper", "MoveRelative commands an axis of", || greedy(Owning::Usurps)),
        ("masked usurper", "both command the axis", || greedy(Owning::Masked)),
        ("claim", "2 blocks own", || greedy(Owning::Claims)),
        ("deaf block", "MoveRelative: is busy and does not have the axis", || greedy(Owning::Deaf)),
        ("twin", "commands the axis [2, 0] times", || greedy(Owning::Two)),
    ];
    for (what, expected, block) in planted {
        sees(what, (&KINDS[..1], 50_000), expected, || with(block()), |_, _, _| ());
    }
}

/// Blocks that deviate from their inputs too little to show in the axis's own values.
#[test]
fn the_checker_sees_what_blocks_were_not_asked() {
    let planted: [(&str, &Kinds, &str, Planted); 12] = [
        ("jerk", &LIMITED, "u/s³, moved by", planted::jerky),
        ("position profile", &KINDS, "allowed AxisLimits", planted::hurried_positions),
        ("velocity profile", &KINDS, "allowed AxisLimits", planted::hurried_velocities),
        ("acceleration profile", &LIMITED, "u/s³, moved by", planted::hurried_accelerations),
        ("set-point", &KINDS, "is not the set-point", planted::beyond),
        ("gear on its way", &KINDS, "on the way into step, but", planted::wrong_gear),
        ("ramp", &KINDS, "off the cam after", || {
            wrong_cam(|it| it.input.velocity_difference *= 1.5)
        }),
        ("rate", &[KINDS[0], KINDS[3]], "u/s², allowed", || {
            wrong_cam(|CamIn { input, .. }| {
                input.acceleration *= 5.0;
                input.deceleration *= 5.0;
            })
        }),
        ("cam", &KINDS, "in step, but", planted::fast_cam),
        ("lost tappet", &KINDS, "acted 0 times, not 1", || {
            wrong_cam(|it| with_tappets(it, Vec::clear))
        }),
        ("doubled tappet", &KINDS, "acted 2 times, not 1", || {
            wrong_cam(|it| with_tappets(it, |all| all.extend_from_within(..)))
        }),
        ("late pulse", &KINDS, "is not there at", || {
            wrong_cam(|it| with_tappets(it, planted::delay))
        }),
    ];
    for (what, kinds, expected, block) in planted {
        sees(what, (kinds, 200_000), expected, || with(block()), |_, _, _| ());
    }
    let hasty = || alone::moves().into_iter().chain([alone::hasty_on_top(1.5)]).collect();
    sees("way on top", (&KINDS, 200_000), "on top, moved by", hasty, |_, _, _| ());
}
