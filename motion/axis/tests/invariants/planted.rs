//! Planted faults: blocks with deliberate errors.

use super::alone::rate;
use super::called::{Called, Fault, Moving, limited, moving, own, passes_on};
use super::checker::Promise;
use super::direct::Walking;
use super::random::Random;
use super::{coupled, tables};
use crate::ownership::{Refusal, Start};
use crate::{Axis, AxisState, CamIn, Motion, MoveAbsolute, Outputs, Points, Progress, SmcError};
use std::sync::Arc;
use twin_cam::{Action, Cam, CamTable, Knot, Shape, Tappet};

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
                self.0.plan(start, axis, ())
            }

            fn step(&self, run: &mut Self::Run, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
                self.0.step(run, axis, ())
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
    limited(
        |it: &MoveRelative, _| of_relative(&it.0),
        |random, _, _| MoveRelative(relative(random)),
    )
}

fn of_relative(it: &crate::MoveRelative) -> Promise {
    own(it.velocity, it.acceleration, it.deceleration)
}

/// Velocity, acceleration and deceleration.
fn rates(random: &mut Random) -> [f64; 3] {
    let (velocity, rate) = (random.between(0.1, 15.0), random.between(40.0, 200.0));
    [velocity, rate, rate]
}

fn relative(random: &mut Random) -> crate::MoveRelative {
    let distance = random.between(-20.0, 20.0);
    let [velocity, acceleration, deceleration] = rates(random);
    crate::MoveRelative { distance, velocity, acceleration, deceleration }
}

/// A move of velocity in discrete motion.
pub(super) fn mislabelled() -> Box<dyn Called> {
    limited(
        |MoveVelocity(it), _| own(it.velocity, it.acceleration, it.deceleration),
        |random, _, _| {
            let [velocity, acceleration, deceleration] = rates(random);
            let direction = random.direction();
            MoveVelocity(crate::MoveVelocity { velocity, acceleration, deceleration, direction })
        },
    )
}

/// A move that takes 1.5 times the jerk of the axis.
pub(super) fn jerky() -> Box<dyn Called> {
    let inputs = |random: &mut Random, _: &Axis, _: &Axis| MoveAbsolute {
        position: random.between(0.0, 90.0),
        velocity: random.between(5.0, 15.0),
        acceleration: rate(random),
        deceleration: rate(random),
        direction: random.direction(),
    };
    let moving = moving(
        |it: &MoveAbsolute, _| own(it.velocity, it.acceleration, it.deceleration),
        inputs,
        |_, _, _, _| (),
    );
    Box::new(moving.with(Fault { jerk: 1.5, ..Fault::default() }))
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
    let setpoint =
        |(): &(), it: &mut twin_profile::State| it.position += 1e-3 * it.velocity.signum();
    Box::new(Walking::new(Fault { setpoint, ..Fault::default() }))
}

/// Slower on its way into step.
pub(super) fn wrong_gear() -> Box<dyn Called> {
    let setpoint = |run: &crate::GearInPosRun, it: &mut twin_profile::State| {
        if run.is_coupling() {
            it.velocity *= 0.999;
        }
    };
    coupled::gear_in_pos(Fault { setpoint, ..Fault::default() })
}

/// A slave that is faster than its cam.
pub(super) fn fast_cam() -> Box<dyn Called> {
    let setpoint = |run: &crate::CamRun, it: &mut twin_profile::State| {
        if run.is_in_sync() {
            it.velocity *= 1.0001;
        }
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
    let mut tappets: Vec<Tappet> = table.cam.tappets().to_vec();
    change(&mut tappets);
    let cam = Cam::new("cam", Shape::Polynomial(knots.to_vec()), tappets).unwrap();
    it.table = Some(CamTable { cam: Arc::new(cam), ..table });
}

/// Pulses that come 50 ms too late.
pub(super) fn delay(tappets: &mut Vec<Tappet>) {
    for tappet in tappets {
        if let Action::Timed { delay_ns, .. } = &mut tappet.action {
            *delay_ns += 50_000_000;
        }
    }
}

/// Planted fault of a relative move in the ownership of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Owning {
    /// It commands the axis when another one has it: to where that has it.
    Usurps,
    /// The same, and it says that it is that one.
    Masked,
    /// It only says so.
    Claims,
    /// It does not notice that it has lost the axis.
    Deaf,
    /// There are two of it.
    Two,
}

/// A relative move that does not keep to who has the axis.
struct Greedy {
    moving: Moving<crate::MoveRelative>,
    owning: Owning,
    /// Who else it says it is.
    mask: Option<i64>,
}

pub(super) fn greedy(owning: Owning) -> Box<dyn Called> {
    let moving = moving(|it, _| of_relative(it), |random, _, _| relative(random), |_, _, _, _| ());
    Box::new(Greedy { moving, owning, mask: None })
}

impl Called for Greedy {
    fn call(
        &mut self,
        execute: bool,
        random: &mut Random,
        axis: &mut Axis,
        master: &Axis,
    ) -> Outputs {
        let mut twin = self.moving.block.clone();
        let mut shown = self.moving.call(execute, random, axis, master);
        let (mine, owner) = (self.moving.owner(), axis.owner());
        let others = execute && owner != 0 && owner != mine;
        let masks = matches!(self.owning, Owning::Masked | Owning::Claims);
        self.mask = (others && masks).then_some(owner);
        match self.owning {
            Owning::Usurps | Owning::Masked if others => axis.drive_to(axis.base),
            Owning::Deaf if shown.command_aborted && axis.state().is_motion() => {
                (shown.command_aborted, shown.busy) = (false, true);
            }
            Owning::Two if mine != 0 && twin.owner() == Some(mine) => {
                twin.call(execute, axis);
            }
            _ => {}
        }
        shown
    }

    passes_on!(moving: change name promise);

    fn owner(&self) -> i64 {
        self.mask.unwrap_or(self.moving.owner())
    }
}
