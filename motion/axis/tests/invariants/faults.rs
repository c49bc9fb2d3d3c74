//! Tests of the checker: it must find every planted fault, of the runs or of a block, and name it.

use super::*;

/// Axes with limited jerk.
const LIMITED: [Kind; 4] = [KINDS[1], KINDS[2], KINDS[4], KINDS[5]];

/// Breaks a rule after a call, from the 5000th on.
type Break = fn(u32, &mut Axis, &mut Outputs);
type Planted = fn() -> Box<dyn Called>;

/// The checker finds it in every one of these kinds, in one of some runs of this number of calls.
fn sees(
    what: &str,
    (kinds, calls): (&[Kind], u32),
    expected: &str,
    blocks: impl Fn() -> Blocks,
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
fn with(planted: Box<dyn Called>) -> Blocks {
    let mut blocks = called::single();
    blocks.insert(0, planted);
    blocks
}

/// A relative move that no state holds back.
#[derive(Clone, Debug)]
struct MoveRelative(crate::MoveRelative);

impl Motion for MoveRelative {
    type With = ();
    type Run = <crate::MoveRelative as Motion>::Run;
    const STATE: AxisState = AxisState::DiscreteMotion;

    fn admitted(&self, _: &Axis) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<Self::Run, SmcError> {
        Motion::plan(&self.0, start, axis, ())
    }

    fn step(&self, run: &mut Self::Run, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        Motion::step(&self.0, run, axis, ())
    }
}

fn relative(random: &mut Random) -> crate::MoveRelative {
    crate::MoveRelative {
        distance: way(random),
        velocity: speed(random),
        acceleration: rate(random),
        deceleration: rate(random),
    }
}

fn of_relative(it: &crate::MoveRelative) -> Promise {
    own(it.velocity, it.acceleration, it.deceleration)
}

/// A relative move that does not keep to who has the axis.
fn greedy(owning: Owning) -> Box<dyn Called> {
    let fault = Fault { owning: Some(owning), ..Fault::default() };
    Box::new(moving(|it, _| of_relative(it), |random, _, _| relative(random), fault, ()))
}

/// The same points in less time.
fn hurry(points: &mut Points) {
    points.points.iter_mut().for_each(|point| point.delta_time *= 0.9);
}

/// A slave whose cam has other inputs.
fn wrong_cam(inputs: fn(&mut CamIn)) -> Box<dyn Called> {
    coupled::cam_in(Fault::inputs(inputs))
}

/// The same cam with other tappets.
fn with_tappets(it: &mut CamIn, change: fn(&mut Vec<Tappet>)) {
    let Some(table) = it.table.take() else { return };
    let curve = table.cam.curve();
    let knots = [0.0, 40.0, 90.0].map(|master| Knot::at_rest(master, curve.at(master).position));
    let mut tappets = table.cam.tappets().to_vec();
    change(&mut tappets);
    it.table = Some(CamTable { cam: cam(&knots, tappets).cam, ..table });
}

/// Pulses that come 50 ms too late.
fn delay(tappet: &mut Tappet) {
    if let Action::Timed { delay_ns, .. } = &mut tappet.action {
        *delay_ns += 50_000_000;
    }
}

#[test]
fn the_checker_sees_what_is_broken() {
    let spoils: [(&str, &str, Break); 16] = [
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
        ("kind of motion", "MoveVelocity moves it in DiscreteMotion", |_, axis, _| {
            if axis.state() == AxisState::ContinuousMotion {
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
    let planted: [(&str, &str, Planted); 6] = [
        ("move while stopping", "illegal: Stopping to DiscreteMotion", || {
            limited(
                |MoveRelative(it), _| of_relative(it),
                |random, _, _| MoveRelative(relative(random)),
            )
        }),
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
    let planted: [(&str, &[Kind], &str, Planted); 12] = [
        ("jerk", &LIMITED, "u/s³, moved by", || {
            Box::new(moving(
                |it: &MoveAbsolute, _| own(it.velocity, it.acceleration, it.deceleration),
                |random, _, _| MoveAbsolute {
                    position: random.between(0.0, 90.0),
                    velocity: random.between(5.0, 15.0),
                    acceleration: rate(random),
                    deceleration: rate(random),
                    direction: random.direction(),
                },
                Fault { jerk: 1.5, ..Fault::default() },
                (),
            ))
        }),
        ("position profile", &KINDS, "allowed AxisLimits", || {
            tables::positions(Fault::inputs(|it| hurry(&mut it.0)))
        }),
        ("velocity profile", &KINDS, "allowed AxisLimits", || {
            tables::velocities(Fault::inputs(|it| hurry(&mut it.0)))
        }),
        ("acceleration profile", &LIMITED, "u/s³, moved by", || {
            tables::accelerations(Fault::inputs(|it| hurry(&mut it.0)))
        }),
        ("set-point", &KINDS, "is not the set-point", || {
            direct::walking(Fault::setpoint(|(), it| it.position += 1e-3 * it.velocity.signum()))
        }),
        ("gear on its way", &KINDS, "on the way into step, but", || {
            coupled::gear_in_pos(Fault::setpoint(|run: &GearInPosRun, it| {
                it.velocity *= if run.is_coupling() { 0.999 } else { 1.0 };
            }))
        }),
        ("cam", &KINDS, "in step, but", || {
            coupled::cam_in(Fault::setpoint(|run: &CamRun, it| {
                it.velocity *= if run.is_in_sync() { 1.0001 } else { 1.0 };
            }))
        }),
        ("ramp", &KINDS, "off the cam after", || {
            wrong_cam(|it| it.input.velocity_difference *= 1.5)
        }),
        ("rate", &[KINDS[0], KINDS[3]], "u/s², allowed", || {
            wrong_cam(|CamIn { input, .. }| {
                input.acceleration *= 5.0;
                input.deceleration *= 5.0;
            })
        }),
        ("lost tappet", &KINDS, "acted 0 times, not 1", || {
            wrong_cam(|it| with_tappets(it, Vec::clear))
        }),
        ("doubled tappet", &KINDS, "acted 2 times, not 1", || {
            wrong_cam(|it| with_tappets(it, |all| all.extend_from_within(..)))
        }),
        ("late pulse", &KINDS, "is not there at", || {
            wrong_cam(|it| with_tappets(it, |all| all.iter_mut().for_each(delay)))
        }),
    ];
    for (what, kinds, expected, block) in planted {
        sees(what, (kinds, 200_000), expected, || with(block()), |_, _, _| ());
    }
    let hasty = || alone::moves().into_iter().chain([alone::hasty_on_top(1.5)]).collect();
    sees("way on top", (&KINDS, 200_000), "on top, moved by", hasty, |_, _, _| ());
}
