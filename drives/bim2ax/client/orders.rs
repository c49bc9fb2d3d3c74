//! Orders to the axes.

use tokio::time::{sleep, timeout};

use super::{
    AXES, Action, Bim2Ax, BusStamp, Clock, DriveError, Duration, ModuleAxis, Orders,
    RECEIPT_ORDERS, ReadZone, Target, WriteZone,
};
use crate::{
    EntryOrder, Fault,
    protocol::bits::{message, uc},
};
use twin_drives::Axes;

/// Messages that tell why a move does not happen.
const HINDRANCES: u16 =
    message::REFUSED | message::POWER_ABSENT | message::PHASE_OPEN | message::PHASE_SHORT;

impl Bim2Ax {
    /// Writes the zone "Ordre UC", after Position zones if any, and gives the acknowledgements.
    pub(super) async fn order(
        &mut self,
        name: &'static str,
        orders: Orders,
        targets: [Option<Target>; AXES],
        clock: &dyn Clock,
    ) -> Result<(Orders, BusStamp), DriveError> {
        let [one, two] = orders.uc;
        let action = Action::Order { bits: one | two, name };
        // A stop does not wait: it stops, whatever is answered.
        let stops = (one | two) & (uc::ABANDON | uc::HARD_STOP) != 0;
        if !stops {
            self.settle().await;
        }
        self.check_others(action, &orders, clock).await?;
        let byte_order = self.options.byte_order;
        let zones: Vec<_> = ModuleAxis::ALL
            .into_iter()
            .zip(targets)
            .filter_map(|(axis, target)| {
                Some((WriteZone::of_axis(axis), target?.encode(byte_order)))
            })
            .collect();
        let listed = self.options.assumptions.entry_order == EntryOrder::Listed;
        if !zones.is_empty() && self.at_once() && listed {
            return self.order_at_once(action, zones, &orders, clock).await;
        }
        for (zone, bytes) in zones {
            let writing = Action::WriteZone { zone: zone.number(), name: zone.name() };
            self.write(writing, zone, &bytes, ReadZone::Positions, clock).await?;
        }
        if self.at_once() {
            let asked = self.window.ask_receipt(RECEIPT_ORDERS);
            self.bus(action, asked)?;
        }
        let bytes = orders.encode(byte_order);
        let read = ReadZone::Acknowledgements;
        let (bytes, stamp) = self.write(action, WriteZone::Orders, &bytes, read, clock).await?;
        self.check_receipt(action)?;
        Ok((self.acknowledged(&bytes), stamp))
    }

    /// Where the order 0 ends every move, an order for one axis may not find the other in a move that it would end.
    async fn check_others(
        &mut self,
        action: Action,
        orders: &Orders,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let [one, two] = orders.uc;
        if !self.options.assumptions.zero_ends_every_move || (one == 0) == (two == 0) {
            return Ok(());
        }
        let (seen, _) = self.positions(clock).await?;
        let axes = (0_u8..)
            .zip(orders.uc.into_iter().zip(seen.messages))
            .filter(|(_, (order, messages))| *order == 0 && messages & message::MOVING != 0)
            .fold(0, |mask, (axis, _)| mask | 1 << axis);
        if axes == 0 {
            return Ok(());
        }
        Err(DriveError::Moving { at: self.at(action), axes: Axes::Numbers(axes) })
    }

    /// Positions and orders with one interrupt; what that refreshes is looked at in the zone of acknowledgements,
    /// which is refreshed with all others.
    async fn order_at_once(
        &mut self,
        action: Action,
        mut zones: Vec<(WriteZone, super::ZoneBytes)>,
        orders: &Orders,
        clock: &dyn Clock,
    ) -> Result<(Orders, BusStamp), DriveError> {
        zones.push((WriteZone::Orders, orders.encode(self.options.byte_order)));
        self.check_running(action)?;
        let written = self
            .window
            .forget_refreshed()
            .and_then(|()| self.window.ask_receipt(RECEIPT_ORDERS))
            .and_then(|()| self.window.write_zones(&zones));
        self.bus(action, written)?;
        // $F0 reads zone 0.
        let (_, stamp) = self.answer(action, ReadZone::Positions, clock).await?;
        self.check_receipt(action)?;
        Ok((self.acknowledgements(clock).await?, stamp))
    }

    /// The module has answered: from version 15 on it has also cleared the receipt flag.
    fn check_receipt(&mut self, action: Action) -> Result<(), DriveError> {
        if !self.at_once() {
            return Ok(());
        }
        let receipts = self.window.receipts();
        if self.bus(action, receipts)? & RECEIPT_ORDERS == 0 {
            return Ok(());
        }
        Err(DriveError::Timeout { at: self.at(action), deadline: self.options.deadline })
    }

    /// The same order for the axes named.
    async fn same(
        &mut self,
        name: &'static str,
        order: u16,
        axes: &[ModuleAxis],
        clock: &dyn Clock,
    ) -> Result<Orders, DriveError> {
        let uc = ModuleAxis::ALL.map(|axis| if axes.contains(&axis) { order } else { 0 });
        let orders = Orders { uc, bloc: [0; AXES] };
        Ok(self.order(name, orders, [None; AXES], clock).await?.0)
    }

    /// Checks that an axis obeys, or has done so already.
    pub(super) async fn check_started(
        &mut self,
        name: &'static str,
        order: u16,
        axes: &[ModuleAxis],
        acknowledged: &Orders,
        done: impl Fn(ModuleAxis, i32, u16) -> bool,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let lacks = |axis: &&ModuleAxis| {
            acknowledged.uc.get(axis.index()).is_none_or(|word| word & order == 0)
        };
        if !axes.iter().any(|axis| lacks(&axis)) {
            return Ok(());
        }
        let (seen, _) = self.positions(clock).await?;
        for axis in axes.iter().filter(lacks) {
            let index = axis.index();
            let messages = seen.messages.get(index).copied().unwrap_or(0);
            let position = seen.positions.get(index).copied().unwrap_or(0);
            if messages & HINDRANCES != 0 || !done(*axis, position, messages) {
                let at = self.at(Action::Order { bits: order, name });
                let axis = u8::try_from(axis.number()).unwrap_or(0);
                return Err(Fault::AxisMessages { axis, messages }.at(at));
            }
        }
        Ok(())
    }

    /// Starts homing. [`Self::rested`] waits for its end, when message bit 4 shows whether it is done.
    ///
    /// # Errors
    /// If an axis does not start, or the module does not answer.
    pub async fn home(&mut self, axes: &[ModuleAxis], clock: &dyn Clock) -> Result<(), DriveError> {
        let acknowledged = self.same("homing", uc::HOME, axes, clock).await?;
        // One whose acknowledgement was not seen has ended, or moves; if it moves for another reason this order was refused.
        let done = |_, _, messages: u16| messages & (message::HOMED | message::MOVING) != 0;
        self.check_started("homing", uc::HOME, axes, &acknowledged, done, clock).await
    }

    /// Abandons moves: both axes brake on their ramps. Sent again once if no answer comes
    /// or an axis goes on without having acknowledged it, and if an order that was given before may arrive after it.
    ///
    /// # Errors
    /// If the module does not answer.
    pub async fn abandon(&mut self, clock: &dyn Clock) -> Result<(), DriveError> {
        self.stopping("abandon", uc::ABANDON, clock).await
    }

    /// Stops both axes without ramp; homing is lost where one moved. Sent again once if no answer comes
    /// or an axis goes on without having acknowledged it, and if an order that was given before may arrive after it.
    ///
    /// # Errors
    /// If the module does not answer.
    pub async fn stop_hard(&mut self, clock: &dyn Clock) -> Result<(), DriveError> {
        self.stopping("hard stop", uc::HARD_STOP, clock).await
    }

    async fn stopping(
        &mut self,
        name: &'static str,
        order: u16,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let late = self.late;
        let stopped = self.confirmed_stop(name, order, clock).await;
        if !late {
            return stopped;
        }
        // An order that was given before the stop may arrive after it.
        self.outlast().await;
        self.confirmed_stop(name, order, clock).await
    }

    /// Gives a stop, and once more if it may not have been heard.
    async fn confirmed_stop(
        &mut self,
        name: &'static str,
        order: u16,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        match self.same(name, order, &ModuleAxis::ALL, clock).await {
            Err(DriveError::Timeout { .. } | DriveError::Protocol { .. }) => {}
            Ok(acknowledged) => {
                let lacks = acknowledged.uc.map(|word| word & order == 0);
                if lacks == [false; AXES] {
                    return Ok(());
                }
                // An axis at rest acknowledges no stop.
                let (seen, _) = self.positions(clock).await?;
                let moves = seen.messages.map(|messages| messages & message::MOVING != 0);
                if !lacks.into_iter().zip(moves).any(|(lacks, moves)| lacks && moves) {
                    return Ok(());
                }
            }
            Err(error) => return Err(error),
        }
        self.same(name, order, &ModuleAxis::ALL, clock).await.map(|_| ())
    }

    /// Switches phases on or off at standstill (on: revision D).
    ///
    /// # Errors
    /// If they do not follow, or the module does not answer.
    pub async fn set_phases(
        &mut self,
        axes: &[ModuleAxis],
        on: bool,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let (name, order) =
            if on { ("phases on", uc::PHASES_ON) } else { ("phases off", uc::PHASES_OFF) };
        self.same(name, order, axes, clock).await?;
        let done = |_, _, messages: u16| (messages & message::PHASES_OFF == 0) == on;
        self.check_started(name, order, axes, &Orders::default(), done, clock).await
    }

    /// Tests the motors at standstill, which switches their phases on and clears faults that are gone.
    ///
    /// # Errors
    /// If a phase is open or has a short circuit, or the module does not answer.
    pub async fn test_motors(
        &mut self,
        axes: &[ModuleAxis],
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        const NAME: &str = "motor test";
        let acknowledged = self.same(NAME, uc::MOTOR_TEST, axes, clock).await?;
        let faults = message::PHASE_OPEN | message::PHASE_SHORT;
        let tested = |axis: ModuleAxis, _, messages: u16| {
            let word = acknowledged.uc.get(axis.index()).copied().unwrap_or(0);
            word & uc::MOTOR_TEST != 0 && messages & faults == 0
        };
        let nothing = Orders::default();
        self.check_started(NAME, uc::MOTOR_TEST, axes, &nothing, tested, clock).await
    }

    /// Waits until two looks in a row show that neither axis moves: one may have been spoilt on the bus, or be that at a
    /// memory which a reset has cleared.
    ///
    /// # Errors
    /// If one still moves after `patience`, or the module does not answer.
    pub async fn rested(
        &mut self,
        patience: Duration,
        clock: &dyn Clock,
    ) -> Result<(super::Positions, BusStamp), DriveError> {
        let mut moving = 0;
        let mut resting_looks = 0;
        let pause = 4 * self.options.pause;
        let resting = async {
            loop {
                let seen = self.positions(clock).await?;
                moving = (0_u8..)
                    .zip(seen.0.messages)
                    .filter(|(_, messages)| messages & message::MOVING != 0)
                    .fold(0, |mask, (axis, _)| mask | 1 << axis);
                resting_looks = if moving == 0 { resting_looks + 1 } else { 0 };
                if resting_looks == 2 {
                    return Ok(seen);
                }
                if moving != 0 {
                    sleep(pause).await;
                }
            }
        };
        let outcome = timeout(patience, resting).await;
        outcome.unwrap_or_else(|_| {
            Err(DriveError::Moving { at: self.at(Action::ReadState), axes: Axes::Numbers(moving) })
        })
    }
}
