//! Planted faults: blocks with deliberate errors.

use super::*;

/// A copy of a block with another state or admission.
macro_rules! planted {
    ($(#[$doc:meta])* $name:ident, $admitted:expr) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        struct $name(crate::$name);

        impl Motion for $name {
            type With = ();
            type Run = <crate::$name as Motion>::Run;
            const STATE: AxisState = AxisState::DiscreteMotion;

            fn admitted(&self, axis: &Axis) -> Result<(), Refusal> {
                $admitted(axis)
            }

            fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<Self::Run, SmcError> {
                Motion::plan(&self.0, start, axis, ())
            }

            fn step(&self, run: &mut Self::Run, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
                Motion::step(&self.0, run, axis, ())
            }
        }
    };
}

planted! {
    /// Takes the axis in every state.
    MoveRelative, |_| Ok(())
}

planted! {
    /// Moves on without an end, in discrete motion.
    MoveVelocity, |axis: &Axis| axis.admits(Self::STATE)
}

/// A relative move that no state holds back.
pub(super) fn rude() -> Box<dyn Called> {
    limited(|MoveRelative(it), _| of_relative(it), |random, _, _| MoveRelative(relative(random)))
}

fn of_relative(it: &crate::MoveRelative) -> Promise {
    own(it.velocity, it.acceleration, it.deceleration)
}

fn relative(random: &mut Random) -> crate::MoveRelative {
    crate::MoveRelative {
        distance: way(random),
        velocity: speed(random),
        acceleration: rate(random),
        deceleration: rate(random),
    }
}

/// A relative move that does not keep to who has the axis.
pub(super) fn greedy(owning: Owning) -> Box<dyn Called> {
    let fault = Fault { owning: Some(owning), ..Fault::default() };
    Box::new(moving(|it, _| of_relative(it), |random, _, _| relative(random), fault, ()))
}

/// A move of velocity in discrete motion.
pub(super) fn mislabelled() -> Box<dyn Called> {
    limited(
        |MoveVelocity(it), _| own(it.velocity, it.acceleration, it.deceleration),
        |random, _, _| {
            MoveVelocity(crate::MoveVelocity {
                velocity: speed(random),
                acceleration: rate(random),
                deceleration: rate(random),
                direction: random.direction(),
            })
        },
    )
}

/// A move that takes 1.5 times the jerk of the axis.
pub(super) fn jerky() -> Box<dyn Called> {
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
}

/// The same points in less time.
fn hurry(points: &mut Points) {
    for point in &mut points.points {
        point.delta_time *= 0.9;
    }
}

pub(super) fn hurried_positions() -> Box<dyn Called> {
    tables::positions(Fault { inputs: |it| hurry(&mut it.0), ..Fault::default() })
}

pub(super) fn hurried_velocities() -> Box<dyn Called> {
    tables::velocities(Fault { inputs: |it| hurry(&mut it.0), ..Fault::default() })
}

pub(super) fn hurried_accelerations() -> Box<dyn Called> {
    tables::accelerations(Fault { inputs: |it| hurry(&mut it.0), ..Fault::default() })
}

/// Goes a little beyond its set-points.
pub(super) fn beyond() -> Box<dyn Called> {
    let setpoint = |(): &(), it: &mut State| it.position += 1e-3 * it.velocity.signum();
    direct::walking(Fault { setpoint, ..Fault::default() })
}

/// Slower on its way into step.
pub(super) fn wrong_gear() -> Box<dyn Called> {
    let setpoint = |run: &GearInPosRun, it: &mut State| {
        it.velocity *= if run.is_coupling() { 0.999 } else { 1.0 };
    };
    coupled::gear_in_pos(Fault { setpoint, ..Fault::default() })
}

/// A slave that is faster than its cam.
pub(super) fn fast_cam() -> Box<dyn Called> {
    let setpoint = |run: &CamRun, it: &mut State| {
        it.velocity *= if run.is_in_sync() { 1.0001 } else { 1.0 };
    };
    coupled::cam_in(Fault { setpoint, ..Fault::default() })
}

/// A slave whose cam has other inputs.
pub(super) fn wrong_cam(inputs: fn(&mut CamIn)) -> Box<dyn Called> {
    coupled::cam_in(Fault { inputs, ..Fault::default() })
}

/// The same cam with other tappets.
pub(super) fn with_tappets(it: &mut CamIn, change: fn(&mut Vec<Tappet>)) {
    let Some(table) = it.table.take() else { return };
    let curve = table.cam.curve();
    let knots = [0.0, 40.0, 90.0].map(|master| Knot::at_rest(master, curve.at(master).position));
    let mut tappets = table.cam.tappets().to_vec();
    change(&mut tappets);
    it.table = Some(CamTable { cam: cam(&knots, tappets).cam, ..table });
}

/// Pulses that come 50 ms too late.
pub(super) fn delay(tappets: &mut Vec<Tappet>) {
    for tappet in tappets {
        if let Action::Timed { delay_ns, .. } = &mut tappet.action {
            *delay_ns += 50_000_000;
        }
    }
}
