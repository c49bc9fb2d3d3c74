//! Random set-points from the program: small steps for blocks without supervision, jumps for blocks with it.

use super::*;

/// Watch over set-points without supervision: the axis has each of them in its cycle.
struct Walk;

pub(super) fn walking(fault: Fault<Follow>) -> Box<dyn Called> {
    Box::new(moving(walked, |random, _, _| kind(random), fault, Walk).living(walk))
}

/// The steps of the walk; a faster start returns to the walk's velocities at once.
fn walked(_: &Follow, begun: &Begun) -> Promise {
    let too_fast = (begun.from.velocity.abs() - 0.5 * FASTEST).max(0.0);
    let back = if begun.cycles == 0 { too_fast / CYCLE } else { 0.0 };
    Promise::Smooth(STEEPEST.max(back))
}

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
    let kinds = [Follow::Position(0.0), Follow::Velocity(0.0), Follow::PositionVelocity(0.0, 0.0)];
    random.one_of(&kinds)
}

impl Watch<Follow> for Walk {
    fn see(&mut self, Look { block, shown, axis, .. }: &Look<'_, Follow>) -> Checked {
        if !shown.busy {
            return Ok(());
        }
        let (before, now) = (axis.saved_base, axis.base);
        let mean = 0.5 * (before.velocity + now.velocity);
        let given = block.inputs;
        let (place, velocity) = match given {
            Follow::Position(place) => (place, (now.position - before.position) / CYCLE),
            Follow::Velocity(velocity) => {
                (axis.in_program(before.position + mean * CYCLE), velocity)
            }
            Follow::PositionVelocity(place, velocity) => (place, velocity),
        };
        let off = axis.in_program(now.position) - axis.in_program(axis.to_drive(place));
        let off = short(axis, off);
        let gained = (velocity - before.velocity) / CYCLE;
        if off.abs() > 1e-9
            || (now.velocity - velocity).abs() > 1e-9
            || (now.acceleration - gained).abs() > 1e-6
        {
            return Err(format!("{now:?} after {before:?} is not the set-point {given:?}"));
        }
        Ok(())
    }
}

pub(super) fn all() -> Blocks {
    let watched = moving(
        // Set-points of the program have no jerk.
        |_, _| {
            let limits = limits(FASTEST, STEEPEST, STEEPEST);
            Promise::Limits(AxisLimits { jerk: f64::INFINITY, ..limits })
        },
        |random, _, _| ControlAxisBy {
            setpoint: kind(random),
            avoid_gaps: true,
            gap_velocity: random.between(-1.0, 0.5 * FASTEST),
            gap_acceleration: rate(random),
            gap_deceleration: rate(random),
        },
        Fault::default(),
        (),
    );
    vec![walking(Fault::default()), Box::new(watched.living(jump))]
}

fn jump(it: &mut ControlAxisBy, random: &mut Random, _: &Axis, _: State) {
    if !random.one_in(50) {
        return;
    }
    let position = random.between(0.0, 90.0);
    it.setpoint = match it.setpoint {
        // Within the velocity limit it is not a jump (manual 2.2.5), and nothing is promised.
        Follow::Position(last) if (position - last).abs() < FASTEST * CYCLE => return,
        Follow::Position(_) => Follow::Position(position),
        Follow::Velocity(_) => Follow::Velocity(0.5 * way(random)),
        Follow::PositionVelocity(..) => Follow::PositionVelocity(position, 0.0),
    };
}
