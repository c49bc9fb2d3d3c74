//! The module over its memory: one exchange at a time, each with a deadline.
//!
//! An exchange is an interrupt and its answer. What the module says only changes with an interrupt, and whether it
//! has changed does not show in its content; so before every exchange the driver writes $FF over the number of
//! the zone refreshed last, and waits until the module has put one there again. The module needs 300 µs for an
//! interrupt and may not be asked without pause (9.2.4), so the driver looks every millisecond.

mod orders;
mod parameters;
mod programmed;
mod travel;

use std::{io, sync::Arc, time::Duration};

use tokio::time::{Instant, sleep, timeout};

pub use programmed::Start;

use super::{AXES, Assumptions, ByteOrder, Fault, ModuleAxis};
use crate::protocol::{
    bits::card,
    memory::{BIM2AX_BOCM, Memory, RECEIPT_ORDERS, Window},
    parameter::Parameter,
    zone::{Orders, ParameterExchange, Positions, ReadZone, Target, WriteZone, ZoneBytes},
};
use twin_drives::{Action, Clock, DriveError, Exchange, Exchanges, ProtocolFault};

/// First version that takes several zones with one interrupt and gives receipts.
const ZONES_AT_ONCE: u16 = 15;
/// What parameter $62 can be, mA; −1 if the software does not know.
const RATINGS_MA: [i32; 4] = [1000, 2000, 5000, -1];

/// Settings of the driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bim2AxOptions {
    /// Byte order of the module's numbers; it is checked on connecting.
    pub byte_order: ByteOrder,
    /// Time after which an answer is looked for, and between two looks. The manual asks for 1 ms at least.
    pub pause: Duration,
    /// Longest time an answer may take. The manual says 1 ms here and 10 ms there, of the same answer.
    pub deadline: Duration,
    /// Time after which an answer that is late comes no more. After a missed deadline the driver waits so long before
    /// it asks anything but a stop, lest the late answer be taken for the next.
    pub worst_latency: Duration,
    /// Longest time from RESET until $FD d0 shows that the software has stopped; the manual says nothing (A).
    pub reset_start: Duration,
    /// Longest time from then until the software runs; the manual says nothing (A).
    pub reset_deadline: Duration,
    /// From version 15 on: write positions and orders with one interrupt and ask for receipts of orders.
    pub zones_at_once: bool,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
}

impl Default for Bim2AxOptions {
    /// Big-endian, 1 ms, 10 ms, 20 ms, 1 s, 5 s, several zones at once where the module can.
    fn default() -> Self {
        Self {
            byte_order: ByteOrder::Big,
            pause: Duration::from_millis(1),
            deadline: Duration::from_millis(10),
            worst_latency: Duration::from_millis(20),
            reset_start: Duration::from_secs(1),
            reset_deadline: Duration::from_secs(5),
            zones_at_once: true,
            assumptions: Assumptions::default(),
        }
    }
}

/// Time stamps of an exchange, on the caller's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BusStamp {
    /// The module was interrupted, ns.
    pub sent_ns: i64,
    /// Its answer was there, ns.
    pub answered_ns: i64,
}

impl BusStamp {
    /// The middle of the exchange, ns.
    pub fn middle_ns(&self) -> i64 {
        self.sent_ns + (self.answered_ns - self.sent_ns) / 2
    }
}

/// Identity of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Version of its software, parameter $63.
    pub version: u16,
    /// Rating, mA; −1 if the software does not know, parameter $62.
    pub rating_ma: i32,
    /// "Messages carte".
    pub card_messages: u32,
}

/// A module. All calls need a tokio runtime with time.
#[derive(Debug)]
pub struct Bim2Ax {
    port: Arc<str>,
    options: Bim2AxOptions,
    window: Window,
    version: u16,
    /// An answer may still be on its way.
    late: bool,
    exchanges: Exchanges,
}

impl Bim2Ax {
    /// The module in a memory; `port` is its name in messages. Reads and writes nothing.
    pub fn new(port: &str, memory: impl Memory + 'static, options: &Bim2AxOptions) -> Self {
        Self {
            port: port.into(),
            options: *options,
            window: Window::new(memory),
            version: 0,
            late: false,
            exchanges: Exchanges::new(options.deadline),
        }
    }

    /// Statistics of its exchanges.
    pub(crate) fn exchanges(&self) -> &Exchanges {
        &self.exchanges
    }

    /// The settings it was made with.
    pub fn options(&self) -> &Bim2AxOptions {
        &self.options
    }

    /// Exchange of an error, with the action under way.
    pub(crate) fn at(&self, action: Action) -> Exchange {
        Exchange { port: Arc::clone(&self.port), address: 0, action }
    }

    /// What the memory says.
    fn bus<T>(&self, action: Action, outcome: io::Result<T>) -> Result<T, DriveError> {
        outcome.map_err(|source| DriveError::Transport { at: self.at(action), source })
    }

    /// Looks who is there: identifier, status, byte order, version and rating. Changes nothing.
    ///
    /// # Errors
    /// If it is no such module, does not run, does not answer, its numbers are in the other byte order, or the check sum
    /// of its EEPROM is wrong.
    pub async fn identify(&mut self, clock: &dyn Clock) -> Result<Identity, DriveError> {
        let known = self.identify_any(clock).await?;
        let checksum_fault = Fault::CardMessages { messages: card::CHECKSUM };
        known.ok_or_else(|| checksum_fault.at(self.at(Action::Identify)))
    }

    /// The same; `None` of a module the check sum of whose EEPROM is wrong. It takes no orders and reports no parameters, so
    /// neither version nor rating: it only has parameters written (8.1).
    ///
    /// # Errors
    /// If it is no such module, does not run, does not answer, or its numbers are in the other byte order.
    pub async fn identify_any(
        &mut self,
        clock: &dyn Clock,
    ) -> Result<Option<Identity>, DriveError> {
        let action = Action::Identify;
        // What is read once may have been spoilt on the bus, which has no check sums.
        let found = match self.window.stranger() {
            Ok(None) => Ok(None),
            _ => self.window.stranger(),
        };
        if let Some(found) = self.bus(action, found)? {
            return Err(Fault::Identity { expected: BIM2AX_BOCM, found }.at(self.at(action)));
        }
        let (bytes, order) = self.look_at_card(clock).await?;
        if order.is_some_and(|order| order != self.options.byte_order) {
            return Err(Fault::ByteOrder.at(self.at(action)));
        }
        let card_messages = ParameterExchange::decode(&bytes, self.options.byte_order).messages;
        if card_messages & card::CHECKSUM != 0 {
            return Ok(None);
        }
        let mut rating_ma = self.rating(clock).await?;
        if !RATINGS_MA.contains(&rating_ma) {
            rating_ma = self.rating(clock).await?;
        }
        if !RATINGS_MA.contains(&rating_ma) {
            return Err(Fault::ByteOrder.at(self.at(action)));
        }
        let version = self.parameter(Parameter::Version, clock).await?;
        self.version = u16::try_from(version).unwrap_or(0);
        Ok(Some(Identity { version: self.version, rating_ma, card_messages }))
    }

    async fn rating(&mut self, clock: &dyn Clock) -> Result<i32, DriveError> {
        Ok(self.parameter(Parameter::Rating, clock).await?.cast_signed())
    }

    /// The zone with "Messages carte", and the byte order that these tell.
    async fn look_at_card(
        &mut self,
        clock: &dyn Clock,
    ) -> Result<(ZoneBytes, Option<ByteOrder>), DriveError> {
        let (bytes, _) = self.exchange(ReadZone::Parameter, clock).await?;
        let [.., a, b, c, d] = bytes;
        Ok((bytes, ByteOrder::of_card_messages([a, b, c, d])))
    }

    /// Takes the byte order that the module itself reports, if it reports one; true if it is another than before. Changes
    /// nothing in the module.
    ///
    /// # Errors
    /// If it does not answer.
    pub async fn adopt_byte_order(&mut self, clock: &dyn Clock) -> Result<bool, DriveError> {
        let (_, order) = self.look_at_card(clock).await?;
        let before = self.options.byte_order;
        self.options.byte_order = order.unwrap_or(before);
        Ok(self.options.byte_order != before)
    }

    /// True if the module, once identified, takes several zones at once and the driver may use it.
    fn at_once(&self) -> bool {
        self.version >= ZONES_AT_ONCE && self.options.zones_at_once
    }

    /// Checks that the module may be interrupted.
    fn check_running(&mut self, action: Action) -> Result<(), DriveError> {
        let running = self.window.running();
        if self.bus(action, running)? {
            return Ok(());
        }
        // Where nobody is, everything reads as if the software did not run.
        let stranger = self.window.stranger();
        let fault = match self.bus(action, stranger)? {
            Some(found) => Fault::Identity { expected: BIM2AX_BOCM, found },
            None => Fault::NotRunning,
        };
        Err(fault.at(self.at(action)))
    }

    /// Waits until no late answer can come any more, if one can.
    async fn settle(&mut self) {
        if self.late {
            self.outlast().await;
        }
    }

    /// Waits until nothing that was given before can arrive any more.
    async fn outlast(&mut self) {
        sleep(self.options.worst_latency).await;
        self.late = false;
    }

    /// Asks for a zone and reads it. Asked again at once if no proper answer comes: it changes nothing.
    async fn exchange(
        &mut self,
        zone: ReadZone,
        clock: &dyn Clock,
    ) -> Result<(ZoneBytes, BusStamp), DriveError> {
        let action = Action::ReadZone { zone: zone.number(), name: zone.name() };
        let repeats = self.exchanges.begin();
        loop {
            self.settle().await;
            self.check_running(action)?;
            let sent = self.window.forget_refreshed().and_then(|()| self.window.request(zone));
            self.bus(action, sent)?;
            match self.answer(action, zone, clock).await {
                Err(error) if error.is_lost() && self.exchanges.may_repeat(&repeats) => {}
                Ok(done) => {
                    self.exchanges.done();
                    return Ok(done);
                }
                failed => return failed,
            }
        }
    }

    /// Waits until the module has refreshed a zone, and reads it.
    async fn answer(
        &mut self,
        action: Action,
        zone: ReadZone,
        clock: &dyn Clock,
    ) -> Result<(ZoneBytes, BusStamp), DriveError> {
        let sent_ns = clock.now_ns();
        let (pause, deadline) = (self.options.pause, self.options.deadline);
        let answered = async |module: &mut Self| {
            loop {
                sleep(pause).await;
                let read = module.window.read_zone(zone);
                let (refreshed, bytes) = module.bus(action, read)?;
                match ReadZone::from_number(refreshed) {
                    Some(found) if found == zone => return Ok(bytes),
                    Some(_) => {
                        // An answer has come, to something else or spoilt.
                        module.late = false;
                        let fault = ProtocolFault::Garbled;
                        return Err(DriveError::Protocol { at: module.at(action), fault });
                    }
                    None => {}
                }
            }
        };
        // If the caller gives up meanwhile, the answer may come later.
        self.late = true;
        let begun = Instant::now();
        let outcome = timeout(deadline, async { answered(self).await }).await;
        let outcome =
            outcome.unwrap_or_else(|_| Err(DriveError::Timeout { at: self.at(action), deadline }));
        let bytes = outcome.inspect_err(|error| {
            if error.is_lost() {
                self.exchanges.lost();
            }
        })?;
        self.exchanges.answered(begun.elapsed(), Duration::ZERO);
        self.late = false;
        Ok((bytes, BusStamp { sent_ns, answered_ns: clock.now_ns() }))
    }

    /// Writes a zone and waits for what it is to be answered with.
    async fn write(
        &mut self,
        action: Action,
        zone: WriteZone,
        bytes: &ZoneBytes,
        read: ReadZone,
        clock: &dyn Clock,
    ) -> Result<(ZoneBytes, BusStamp), DriveError> {
        self.check_running(action)?;
        let written =
            self.window.forget_refreshed().and_then(|()| self.window.write_zone(zone, bytes, read));
        self.bus(action, written)?;
        self.answer(action, read, clock).await
    }

    /// Theoretical positions and axis messages.
    ///
    /// # Errors
    /// If the module does not answer.
    pub async fn positions(
        &mut self,
        clock: &dyn Clock,
    ) -> Result<(Positions, BusStamp), DriveError> {
        let (bytes, stamp) = self.exchange(ReadZone::Positions, clock).await?;
        Ok((Positions::decode(&bytes, self.options.byte_order), stamp))
    }

    /// Acknowledgements of the orders; bits without meaning are 0.
    ///
    /// # Errors
    /// If the module does not answer.
    pub async fn acknowledgements(&mut self, clock: &dyn Clock) -> Result<Orders, DriveError> {
        let (bytes, _) = self.exchange(ReadZone::Acknowledgements, clock).await?;
        Ok(self.acknowledged(&bytes))
    }

    fn acknowledged(&self, bytes: &ZoneBytes) -> Orders {
        let Orders { uc, bloc } = Orders::decode(bytes, self.options.byte_order);
        Orders { uc, bloc: bloc.map(|word| word & crate::protocol::bits::bloc::ACKNOWLEDGED) }
    }

    /// Encoder positions in points and encoder messages.
    ///
    /// # Errors
    /// If the module does not answer.
    pub async fn encoder_points(
        &mut self,
        clock: &dyn Clock,
    ) -> Result<(Positions, BusStamp), DriveError> {
        let (bytes, stamp) = self.exchange(ReadZone::EncoderPoints, clock).await?;
        Ok((Positions::decode(&bytes, self.options.byte_order), stamp))
    }

    /// Encoder positions in steps, which may be wrong by one or two, and encoder messages.
    ///
    /// # Errors
    /// If the module does not answer.
    pub async fn encoder_steps(
        &mut self,
        clock: &dyn Clock,
    ) -> Result<(Positions, BusStamp), DriveError> {
        let (bytes, stamp) = self.exchange(ReadZone::EncoderSteps, clock).await?;
        Ok((Positions::decode(&bytes, self.options.byte_order), stamp))
    }
}
