//! Planted faults: blocks with deliberate errors.

use super::alone::rate;
use super::called::{Called, Moving, limited, moving, own, passes_on};
use super::checker::Promise;
use super::direct::{self, Direct, Walking};
use super::in_pos::{Couples, InPos};
use super::on_cam::{Cams, OnCam};
use super::random::Random;
use super::{coupled, tables};
use crate::ownership::{Refusal, Start};
use crate::{Axis, AxisState, Master, Motion, Outputs, Points, Progress, SmcError};
use std::sync::Arc;
use twin_cam::{Action, Cam, CamTable, Knot, Shape, Tappet};
use twin_profile::State;

/// The plan or the step of the genuine block.
macro_rules! genuine {
    (plan $with:ty) => {
        fn plan(&self, start: Start, axis: &Axis, with: $with) -> Result<Self::Run, SmcError> {
            self.0.plan(start, axis, with)
        }
    };
    (step $with:ty) => {
        fn step(
            &self,
            run: &mut Self::Run,
            axis: &mut Axis,
            with: $with,
        ) -> Result<Progress, SmcError> {
            self.0.step(run, axis, with)
        }
    };
}

/// A copy of a block with the changes given here.
macro_rules! planted {
    ($(#[$doc:meta])* $name:ident in $state:ident with $with:ty, $($changed:tt)*) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub(super) struct $name(pub(super) crate::$name);

        impl Motion for $name {
            type With = $with;
            type Run = <crate::$name as Motion>::Run;
            const STATE: AxisState = AxisState::$state;
            const LIVE: bool = <crate::$name as Motion>::LIVE;

            $($changed)*
        }
    };
}

planted! {
    /// Takes the axis in every state.
    MoveRelative in DiscreteMotion with (),
    fn admitted(&self, _axis: &Axis) -> Result<(), Refusal> {
        Ok(())
    }
    genuine! { plan () }
    genuine! { step () }
}

planted! {
    /// Moves on without an end, in discrete motion.
    MoveVelocity in DiscreteMotion with (),
    genuine! { plan () }
    genuine! { step () }
}

planted! {
    /// Takes 1.5 times the jerk of the axis.
    MoveAbsolute in DiscreteMotion with (),
    fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<Self::Run, SmcError> {
        let mut axis = axis.clone();
        axis.values.max_jerk *= 1.5;
        self.0.plan(start, &axis, ())
    }
    genuine! { step () }
}

/// The same points in less time.
fn hurried(points: &Points) -> Points {
    let mut points = points.clone();
    for point in &mut points.points {
        point.delta_time *= 0.9;
    }
    points
}

/// A table that is gone through faster than its points say.
macro_rules! hurried_table {
    ($name:ident in $state:ident) => {
        planted! {
            /// Faster than its points say.
            $name in $state with (),
            fn plan(&self, start: Start, axis: &Axis, (): ()) -> Result<Self::Run, SmcError> {
                crate::$name(hurried(&self.0.0)).plan(start, axis, ())
            }
            genuine! { step () }
        }
    };
}

hurried_table!(PositionProfile in DiscreteMotion);
hurried_table!(VelocityProfile in ContinuousMotion);
hurried_table!(AccelerationProfile in ContinuousMotion);

planted! {
    /// Goes a little beyond its set-points.
    Follow in SynchronizedMotion with (),
    genuine! { plan () }
    fn step(&self, run: &mut Self::Run, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        let Progress { setpoint, stage } = self.0.step(run, axis, ())?;
        let position = setpoint.position + 1e-3 * setpoint.velocity.signum();
        Ok(Progress { setpoint: State { position, ..setpoint }, stage })
    }
}

impl Direct for Follow {
    fn given(&mut self) -> &mut crate::Follow {
        &mut self.0
    }
}

planted! {
    /// Slower on its way into step.
    GearInPos in SynchronizedMotion with Master,
    genuine! { plan Master }
    fn step(
        &self,
        run: &mut Self::Run,
        axis: &mut Axis,
        with: Master,
    ) -> Result<Progress, SmcError> {
        let Progress { mut setpoint, stage } = self.0.step(run, axis, with)?;
        if run.is_coupling() {
            setpoint.velocity *= 0.999;
        }
        Ok(Progress { setpoint, stage })
    }
}

impl Couples for GearInPos {
    fn gear(&self) -> &crate::GearInPos {
        &self.0
    }
}

/// Planted fault of a cam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum OfCam {
    /// It ramps onto its cam faster than it was asked.
    Hasty,
    /// It ramps with more acceleration.
    Steep,
    /// It is faster than its cam.
    Fast,
    /// Tappets are lost.
    Lost,
    /// Tappets act twice.
    Doubled,
    /// Pulses come too late.
    Late,
}

/// A slave that is not as its cam.
#[derive(Clone, Debug)]
struct CamIn(crate::CamIn, OfCam);

impl Motion for CamIn {
    type With = Master;
    type Run = crate::CamRun;
    const STATE: AxisState = AxisState::SynchronizedMotion;

    fn plan(&self, start: Start, axis: &Axis, with: Master) -> Result<Self::Run, SmcError> {
        let Self(mut cam, wrong) = self.clone();
        if wrong == OfCam::Hasty {
            cam.input.velocity_difference *= 1.5;
        }
        if wrong == OfCam::Steep {
            cam.input.acceleration *= 5.0;
            cam.input.deceleration *= 5.0;
        }
        cam.table = cam.table.map(|table| with_tappets(&table, wrong));
        cam.plan(start, axis, with)
    }

    fn step(
        &self,
        run: &mut Self::Run,
        axis: &mut Axis,
        with: Master,
    ) -> Result<Progress, SmcError> {
        let Progress { mut setpoint, stage } = self.0.step(run, axis, with)?;
        if self.1 == OfCam::Fast && run.is_in_sync() {
            setpoint.velocity *= 1.0001;
        }
        Ok(Progress { setpoint, stage })
    }
}

impl Cams for CamIn {
    fn cam_in(&self) -> &crate::CamIn {
        &self.0
    }
}

/// The same cam with other tappets.
fn with_tappets(table: &CamTable, wrong: OfCam) -> CamTable {
    let curve = table.cam.curve();
    let knots = [0.0, 40.0, 90.0].map(|master| Knot::at_rest(master, curve.at(master).position));
    let mut tappets: Vec<Tappet> = table.cam.tappets().to_vec();
    match wrong {
        OfCam::Lost => tappets.clear(),
        OfCam::Doubled => tappets.extend_from_within(..),
        OfCam::Late => {
            for tappet in &mut tappets {
                if let Action::Timed { delay_ns, .. } = &mut tappet.action {
                    *delay_ns += 50_000_000;
                }
            }
        }
        OfCam::Hasty | OfCam::Steep | OfCam::Fast => {}
    }
    let cam = Cam::new("cam", Shape::Polynomial(knots.to_vec()), tappets).unwrap();
    CamTable { cam: Arc::new(cam), ..table.clone() }
}

pub(super) fn wrong_cam(wrong: OfCam) -> Box<dyn Called> {
    let inputs: fn(&mut Random, &Axis, &Axis) -> CamIn = match wrong {
        OfCam::Hasty => |random, _, _| CamIn(coupled::cam_in(random), OfCam::Hasty),
        OfCam::Steep => |random, _, _| CamIn(coupled::cam_in(random), OfCam::Steep),
        OfCam::Fast => |random, _, _| CamIn(coupled::cam_in(random), OfCam::Fast),
        OfCam::Lost => |random, _, _| CamIn(coupled::cam_in(random), OfCam::Lost),
        OfCam::Doubled => |random, _, _| CamIn(coupled::cam_in(random), OfCam::Doubled),
        OfCam::Late => |random, _, _| CamIn(coupled::cam_in(random), OfCam::Late),
    };
    Box::new(OnCam::new(moving(coupled::on_cam, inputs, |_, _, _, _| ())))
}

pub(super) fn wrong_gear() -> Box<dyn Called> {
    let inputs = |random: &mut Random, axis: &Axis, master: &Axis| {
        GearInPos(coupled::gear(random, axis, master))
    };
    Box::new(InPos::new(moving(|_, _| Promise::Nothing, inputs, |_, _, _, _| ())))
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

/// A move that jerks.
pub(super) fn jerky() -> Box<dyn Called> {
    limited(
        |MoveAbsolute(it), _| own(it.velocity, it.acceleration, it.deceleration),
        |random, _, _| {
            MoveAbsolute(crate::MoveAbsolute {
                position: random.between(0.0, 90.0),
                velocity: random.between(5.0, 15.0),
                acceleration: rate(random),
                deceleration: rate(random),
                direction: random.direction(),
            })
        },
    )
}

pub(super) fn hurried_positions() -> Box<dyn Called> {
    limited(
        |it: &PositionProfile, begun| tables::by_positions(&it.0.0, begun),
        |random, _, _| PositionProfile(tables::positions(random)),
    )
}

pub(super) fn hurried_velocities() -> Box<dyn Called> {
    limited(
        |it: &VelocityProfile, begun| tables::by_velocities(&it.0.0, begun),
        |random, _, _| VelocityProfile(tables::velocities(random)),
    )
}

pub(super) fn hurried_accelerations() -> Box<dyn Called> {
    limited(
        |it: &AccelerationProfile, begun| tables::by_accelerations(&it.0.0, begun),
        |random, _, _| AccelerationProfile(tables::accelerations(random)),
    )
}

pub(super) fn beyond() -> Box<dyn Called> {
    Box::new(Walking::new(|random, _, _| Follow(direct::kind(random))))
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
