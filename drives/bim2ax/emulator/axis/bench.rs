//! Surroundings of an emulated axis: contacts at its inputs, power and motor.

/// A switch that a stretch of the shaft's way actuates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    /// First whole µstep of the shaft at which it is actuated.
    pub low: i64,
    /// Last whole µstep of the shaft at which it is actuated.
    pub high: i64,
    /// True if it closes when actuated, else it opens.
    pub closes: bool,
    /// A contact that does not obey any more: always closed or always open.
    pub stuck: Option<bool>,
}

impl Contact {
    /// Actuated from `low` on upwards.
    pub fn above(low: i64, closes: bool) -> Self {
        Self { low, high: i64::MAX, closes, stuck: None }
    }

    /// Actuated from `high` on downwards.
    pub fn below(high: i64, closes: bool) -> Self {
        Self { low: i64::MIN, high, closes, stuck: None }
    }

    /// Actuated from `low` to `high`.
    pub fn between(low: i64, high: i64, closes: bool) -> Self {
        Self { low, high, closes, stuck: None }
    }

    /// True if current can flow with the shaft at `shaft`.
    pub fn closed(&self, shaft: i64) -> bool {
        self.stuck.unwrap_or((self.low..=self.high).contains(&shaft) == self.closes)
    }

    /// The first whole µstep in the sense of `sense` from `shaft` on at which the contact is in its other state.
    pub(crate) fn next_change(&self, shaft: i64, sense: i64) -> Option<i64> {
        if self.stuck.is_some() {
            return None;
        }
        let inside = (self.low..=self.high).contains(&shaft);
        let edge = match (inside, sense > 0) {
            (false, true) => self.low,
            (false, false) => self.high,
            (true, true) => self.high.checked_add(1)?,
            (true, false) => self.low.checked_sub(1)?,
        };
        // Compared, for an end may be as far away as there are numbers.
        let ahead = if sense > 0 { edge > shaft } else { edge < shaft };
        ahead.then_some(edge)
    }
}

/// Contacts on the inputs of one axis, and its motor. An input without contact is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "independent facts, each on or off")]
pub struct Bench {
    /// On the input of the + end switch.
    pub plus: Option<Contact>,
    /// On the input of the − end switch.
    pub minus: Option<Contact>,
    /// On the input of the home cam.
    pub cam: Option<Contact>,
    /// Power at the module's input.
    pub power: bool,
    /// A phase of the motor is open.
    pub phase_open: bool,
    /// Phases of the motor have a short circuit.
    pub phase_short: bool,
    /// The shaft is held: the motor gets its steps and does not turn.
    pub stalled: bool,
}

impl Default for Bench {
    /// A sound motor with power and nothing on the inputs.
    fn default() -> Self {
        Self {
            plus: None,
            minus: None,
            cam: None,
            power: true,
            phase_open: false,
            phase_short: false,
            stalled: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_change_at_whole_steps_on_either_side() {
        let cam = Contact::between(10, 20, true);
        assert_eq!([9, 10, 20, 21].map(|shaft| cam.closed(shaft)), [false, true, true, false]);
        assert_eq!((cam.next_change(0, 1), cam.next_change(15, 1)), (Some(10), Some(21)));
        assert_eq!((cam.next_change(30, -1), cam.next_change(15, -1)), (Some(20), Some(9)));
        assert_eq!((cam.next_change(30, 1), cam.next_change(0, -1)), (None, None));
        let opener = Contact { closes: false, ..cam };
        assert_eq!([9, 10, 20, 21].map(|shaft| opener.closed(shaft)), [true, false, false, true]);
        let stuck = Contact { stuck: Some(true), ..cam };
        assert!(stuck.closed(0) && stuck.next_change(0, 1).is_none());
        let end = Contact::above(100, true);
        assert_eq!((end.next_change(0, 1), end.next_change(100, 1)), (Some(100), None));
        assert_eq!(end.next_change(200, -1), Some(99));
        assert_eq!(Contact::below(-5, true).next_change(-9, 1), Some(-4));
        // Contacts that are crossed: the one that is behind is asked for.
        assert_eq!(Contact::below(-5, true).next_change(9, 1), None);
        assert_eq!(Contact::above(5, true).next_change(-9, -1), None);
    }
}
