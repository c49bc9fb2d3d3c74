//! Registers and bits: read as often as one likes, and written where a repeat does no harm.

use std::borrow::Cow;

use tokio_modbus::{Request, Response};

use super::{InterpCnc, exchange::Sending};
use twin_drives::{Action, Clock, DriveError, ProtocolFault};

impl InterpCnc {
    /// What is understood of the answer to a request that may be repeated.
    pub(super) async fn understood<T>(
        &mut self,
        action: Action,
        request: &Request<'_>,
        clock: &dyn Clock,
        understood: impl Fn(&Response) -> Option<T>,
    ) -> Result<T, DriveError> {
        let proper = |board: &mut Self, answer: &Response| {
            let understood = understood(answer);
            understood.ok_or_else(|| board.distrust(action, ProtocolFault::Garbled))
        };
        self.asked((action, Sending::Repeated), request, clock, proper)
            .await
            .map(|(answer, _)| answer)
    }

    /// Input registers (function 4), asked again at once if no proper answer comes.
    pub(super) async fn read_input(
        &mut self,
        what: &'static str,
        address: u16,
        count: u16,
        clock: &dyn Clock,
    ) -> Result<Vec<u16>, DriveError> {
        let action = Action::Read { what, address, count };
        let request = Request::ReadInputRegisters(address, count);
        let understood = |answer: &Response| match answer {
            Response::ReadInputRegisters(registers) if registers.len() == usize::from(count) => {
                Some(registers.clone())
            }
            _ => None,
        };
        self.understood(action, &request, clock, understood).await
    }

    /// Holding registers (function 3), as many exchanges as it takes.
    pub(super) async fn read_holding(
        &mut self,
        what: &'static str,
        first: u16,
        count: u16,
        clock: &dyn Clock,
    ) -> Result<Vec<u16>, DriveError> {
        let mut all = Vec::with_capacity(count.into());
        let (mut address, mut left) = (first, count);
        while left > 0 {
            let count = left.min(self.options().assumptions.most_read.max(1));
            let action = Action::Read { what, address, count };
            let request = Request::ReadHoldingRegisters(address, count);
            let registers = self.understood(action, &request, clock, |answer| match answer {
                Response::ReadHoldingRegisters(words) if words.len() == usize::from(count) => {
                    Some(words.clone())
                }
                _ => None,
            });
            all.extend(registers.await?);
            (address, left) = (address + count, left - count);
        }
        Ok(all)
    }

    /// Writes holding registers (function 16) that a repeat does not harm.
    pub(super) async fn write_holding(
        &mut self,
        what: &'static str,
        first: u16,
        values: &[u16],
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let mut address = first;
        let most = usize::from(self.options().assumptions.most_written.max(1));
        for part in values.chunks(most) {
            let count = u16::try_from(part.len()).unwrap_or(u16::MAX);
            let action = Action::Write { what, address, count };
            let request = Request::WriteMultipleRegisters(address, Cow::Borrowed(part));
            let done = Response::WriteMultipleRegisters(address, count);
            let confirmed = |answer: &Response| (*answer == done).then_some(());
            self.understood(action, &request, clock, confirmed).await?;
            address = address.saturating_add(count);
        }
        Ok(())
    }

    /// Coils (function 1).
    pub(super) async fn read_coils(
        &mut self,
        what: &'static str,
        address: u16,
        count: u16,
        clock: &dyn Clock,
    ) -> Result<Vec<bool>, DriveError> {
        let action = Action::Read { what, address, count };
        let request = Request::ReadCoils(address, count);
        // The bits come in whole bytes.
        let most = usize::from(count);
        let understood = |answer: &Response| match answer {
            Response::ReadCoils(bits) => bits.get(..most).map(<[_]>::to_vec),
            _ => None,
        };
        self.understood(action, &request, clock, understood).await
    }

    /// Address of entry `first` of an area, if `count` entries from there on are in it; `action` names them in the error.
    pub(super) fn within_area(
        &self,
        action: impl Fn(u16, u16) -> Action,
        (start, size): (u16, u16),
        first: u16,
        count: usize,
    ) -> Result<u16, DriveError> {
        let end = usize::from(first) + count;
        if count > 0 && end <= usize::from(size) {
            return Ok(start + first);
        }
        let counted = u16::try_from(count).unwrap_or(u16::MAX);
        let address = start.saturating_add(first);
        let at = self.at(action(address, counted));
        let value = f64::from(u32::try_from(end).unwrap_or(u32::MAX));
        Err(DriveError::Range { at, register: start, value, unit: "", low: 1.0, high: size.into() })
    }
}
