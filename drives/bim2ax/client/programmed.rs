//! Programmed moves, and positions that are declared without motion: what goes with the zone "Ordre bloc".

use super::{
    AXES, Action, Bim2Ax, BusStamp, Clock, DriveError, ModuleAxis, Orders, Target, WriteZone,
};
use crate::{
    MOST_POSITION,
    protocol::bits::{bloc, message, uc},
};

/// A programmed move of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// Destination, µsteps.
    pub to: i32,
    /// Speed in the unit of the drive mode, capped by the fast speed; none for the fast speed.
    pub speed: Option<u16>,
    /// Without the unidirectional approach, if the axis has one.
    pub directly: bool,
}

impl Start {
    /// A move at the fast speed.
    pub fn to(position: i32) -> Self {
        Self { to: position, speed: None, directly: false }
    }

    /// Order bloc and content of the Position zone.
    fn encoded(&self) -> (u32, Target) {
        let speed = self.speed.map_or(0, |_| bloc::PROGRAMMED_SPEED);
        let directly = if self.directly { bloc::WITHOUT_APPROACH } else { 0 };
        (speed | directly, Target { position: self.to, speed: self.speed.unwrap_or(0) })
    }
}

impl Bim2Ax {
    /// Starts programmed moves of one or both axes with one order.
    ///
    /// # Errors
    /// If a target is beyond ±4194303; if an axis does not start, with its messages; if the module does not answer, when it
    /// is unknown whether it has got the order.
    pub async fn start(
        &mut self,
        moves: [Option<Start>; AXES],
        clock: &dyn Clock,
    ) -> Result<BusStamp, DriveError> {
        const NAME: &str = "programmed move";
        let mut orders = Orders::default();
        let mut targets = [None; AXES];
        let mut axes = Vec::with_capacity(AXES);
        for (axis, start) in ModuleAxis::ALL.into_iter().zip(moves) {
            let Some(start) = start else { continue };
            self.check_range(axis, start.to)?;
            let (word, target) = start.encoded();
            let index = axis.index();
            if let Some(order) = orders.uc.get_mut(index) {
                *order = uc::PROGRAMMED;
            }
            if let Some(bits) = orders.bloc.get_mut(index) {
                *bits = word;
            }
            if let Some(place) = targets.get_mut(index) {
                *place = Some(target);
            }
            axes.push(axis);
        }
        let (acknowledged, stamp) = self.order(NAME, orders, targets, clock).await?;
        // One that moves for another reason has refused this order.
        let done = |axis: ModuleAxis, position, messages: u16| {
            let target = targets.get(axis.index()).copied().flatten();
            let there = target.is_some_and(|target| target.position == position);
            there || messages & message::MOVING != 0
        };
        self.check_started(NAME, uc::PROGRAMMED, &axes, &acknowledged, done, clock).await?;
        Ok(stamp)
    }

    fn check_range(&self, axis: ModuleAxis, position: i32) -> Result<(), DriveError> {
        if (-MOST_POSITION..=MOST_POSITION).contains(&position) {
            return Ok(());
        }
        Err(self.beyond(axis, position))
    }

    /// Error of a position that the zone of an axis does not take.
    fn beyond(&self, axis: ModuleAxis, position: i32) -> DriveError {
        let zone = WriteZone::of_axis(axis);
        let at = self.at(Action::WriteZone { zone: zone.number(), name: zone.name() });
        let (register, value) = (zone.offset().into(), position.into());
        let (low, high) = ((-MOST_POSITION).into(), MOST_POSITION.into());
        DriveError::Range { at, register, value, unit: "µsteps", low, high }
    }

    /// Declares the present position of an axis at standstill to be 0.
    ///
    /// # Errors
    /// If the module does not acknowledge it, or does not answer.
    pub async fn zero(&mut self, axis: ModuleAxis, clock: &dyn Clock) -> Result<(), DriveError> {
        self.declare("zero", axis, bloc::ZERO, None, clock).await
    }

    /// Declares the present position of an axis at standstill to be the last one that the module has stored.
    ///
    /// # Errors
    /// As [`Self::zero`].
    pub async fn recall(&mut self, axis: ModuleAxis, clock: &dyn Clock) -> Result<(), DriveError> {
        self.declare("recall of the last position", axis, bloc::FORCE, None, clock).await
    }

    /// Declares the present position of an axis at standstill to be `position`, µsteps.
    ///
    /// # Errors
    /// If it is $C0DE, which the module forbids, or beyond ±4194303; else as [`Self::zero`].
    pub async fn preset(
        &mut self,
        axis: ModuleAxis,
        position: i32,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        self.check_range(axis, position)?;
        if position == bloc::FORBIDDEN_PRESET {
            return Err(self.beyond(axis, position));
        }
        let target = Some(Target { position, speed: 0 });
        self.declare("preset", axis, bloc::FORCE | bloc::PRESET, target, clock).await
    }

    async fn declare(
        &mut self,
        name: &'static str,
        axis: ModuleAxis,
        bits: u32,
        target: Option<Target>,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let of = |value| ModuleAxis::ALL.map(|any| if any == axis { value } else { 0 });
        let uc = ModuleAxis::ALL.map(|any| if any == axis { uc::PROGRAMMED } else { 0 });
        let targets = ModuleAxis::ALL.map(|any| target.filter(|_| any == axis));
        let orders = Orders { uc, bloc: of(bits) };
        let (acknowledged, _) = self.order(name, orders, targets, clock).await?;
        let wanted = bits & (bloc::ZERO | bloc::FORCE);
        let word = acknowledged.bloc.get(axis.index()).copied().unwrap_or(0);
        let done = |_, _, messages: u16| word == wanted && messages & message::MOVING == 0;
        self.check_started(name, uc::PROGRAMMED, &[axis], &Orders::default(), done, clock).await
    }
}
