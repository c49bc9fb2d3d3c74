//! Control of a served emulated device: events and faults, at once or after a number of requests.

use crate::{FaultRule, FaultyWire};

/// Event at an emulated device, or fault of its wire. `E` is an event at the devices of a family.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Control<E> {
    /// Something happens to the device itself.
    Event(E),
    /// One more fault of the wire, or of the bus.
    Fault(FaultRule),
    /// The wire has no faults any more, and nothing is due any more by [`Control::After`].
    NoFaults,
    /// Random choices of the wire start anew from this seed.
    Seed(u64),
    /// The plug is pulled (true) or put back: meanwhile nothing arrives either way.
    Disconnect(bool),
    /// Something happens after this number of further requests, just before the last of them is carried out; at once
    /// if 0. So it can be put into the middle of what a master does, however fast that is.
    After {
        /// Requests, those included that faults spoil.
        requests: u32,
        /// Control that then takes effect.
        what: Box<Control<E>>,
    },
}

impl<E> Control<E> {
    /// This, after a number of further requests.
    #[must_use]
    pub fn after(self, requests: u32) -> Self {
        Self::After { requests, what: Box::new(self) }
    }
}

/// Controls that wait for a number of requests.
#[derive(Clone, Debug)]
pub struct Agenda<E>(Vec<(u32, Control<E>)>);

impl<E> Default for Agenda<E> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<E> Agenda<E> {
    /// Makes it happen, now or later: to the wire, or to the device by `happen`.
    pub fn obey(&mut self, control: Control<E>, wire: &mut FaultyWire, happen: &mut dyn FnMut(E)) {
        match control {
            Control::Event(event) => happen(event),
            Control::Fault(rule) => wire.add(rule),
            Control::NoFaults => {
                wire.clear();
                self.0.clear();
            }
            Control::Seed(seed) => wire.set_seed(seed),
            Control::Disconnect(disconnected) => wire.set_disconnected(disconnected),
            Control::After { requests: 0, what } => self.obey(*what, wire, happen),
            Control::After { requests, what } => self.0.push((requests, *what)),
        }
    }

    /// A request has come; what happens with it, in the order in which it was asked for.
    pub fn request(&mut self) -> Vec<Control<E>> {
        let mut due = Vec::new();
        for (requests, what) in std::mem::take(&mut self.0) {
            if requests <= 1 {
                due.push(what);
            } else {
                self.0.push((requests - 1, what));
            }
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Direction, When, WireFault};

    #[test]
    fn things_happen_with_the_request_they_are_meant_for() {
        let (mut agenda, mut wire) = (Agenda::default(), FaultyWire::new(0));
        let mut seen = Vec::new();
        let mut obey = |agenda: &mut Agenda<char>, control| {
            agenda.obey(control, &mut wire, &mut |event| seen.push(event));
        };
        obey(&mut agenda, Control::Event('a').after(0));
        obey(&mut agenda, Control::Event('b').after(2));
        obey(&mut agenda, Control::Event('c').after(1));
        obey(&mut agenda, Control::Event('d').after(2));
        assert_eq!(agenda.request(), [Control::Event('c')]);
        assert_eq!(agenda.request(), [Control::Event('b'), Control::Event('d')]);
        assert_eq!(agenda.request(), []);
        obey(&mut agenda, Control::Event('e').after(1));
        obey(&mut agenda, Control::NoFaults);
        assert_eq!(agenda.request(), []);
        assert_eq!(seen, ['a']);
    }

    #[test]
    fn faults_go_to_the_wire() {
        let (mut agenda, mut wire) = (Agenda::<()>::default(), FaultyWire::new(0));
        let rule =
            FaultRule { direction: Direction::Request, when: When::Always, fault: WireFault::Drop };
        agenda.obey(Control::Fault(rule), &mut wire, &mut |()| {});
        assert!(wire.pass(Direction::Request, &[1]).pieces.is_empty());
        agenda.obey(Control::NoFaults, &mut wire, &mut |()| {});
        assert_eq!(wire.pass(Direction::Request, &[1]).pieces.len(), 1);
        agenda.obey(Control::Disconnect(true), &mut wire, &mut |()| {});
        assert!(wire.pass(Direction::Request, &[1]).pieces.is_empty());
    }
}
