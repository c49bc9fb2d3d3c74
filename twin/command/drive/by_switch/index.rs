//! The index pulse of modes 2 and 6.

use super::BySwitch;
use crate::command::Failure;
use twin_drives::Signals;
use twin_drives::homing::HomingMode;

/// Waits for the edge of an index pulse.
pub(super) struct Index {
    /// Which input, and its level during the pulse.
    input: Option<(u8, bool)>,
    /// It has been seen without the pulse, since the switch has opened.
    armed: bool,
}

impl Index {
    /// Where the axis was when the pulse was first seen.
    pub(super) fn seen(&mut self, signals: &Signals, position: f64) -> Option<f64> {
        let (number, level) = self.input?;
        let on = signals.inputs.get(number)? == level;
        let begins = on && self.armed;
        self.armed |= !on;
        begins.then_some(position)
    }
}

impl BySwitch {
    /// Where the index pulse of modes 2 and 6 is seen.
    pub(super) fn index(&self, signals: &Signals, mode: HomingMode) -> Result<Index, Failure> {
        let by_index = matches!(mode, HomingMode::FastBslowISStop | HomingMode::FastSlowISStop);
        let number = mode.number();
        let message = match self.index_input {
            None if by_index => {
                // No drive latches one for its master, and the index of an encoder is at no input: it would have to be wired to one.
                format!(
                    "mode {number} ends on an index pulse, which no drive reports to its master: --index-input N names its \
                     input; a BIM2AX homes on the index of its encoder by itself (bit 3 of encoder-definition, then `home` without --by-switch)"
                )
            }
            Some(_) if !by_index => {
                format!(
                    "--index-input has no effect in mode {number}: only modes 2 and 6 go to an index pulse"
                )
            }
            Some(input) => {
                let count = signals.inputs.count();
                if input <= count {
                    return Ok(Index { input: Some((input, !self.index_low)), armed: false });
                }
                format!("--index-input {input}: the drive shows {count} inputs")
            }
            None => return Ok(Index { input: None, armed: false }),
        };
        Err(Failure::Usage(message))
    }
}

#[cfg(test)]
mod tests {
    use super::Index;
    use twin_drives::{Bits, Signals};

    /// 2.2.7: the pulse counts once the switch has opened. One under way then began before.
    #[test]
    fn an_index_pulse_counts_from_its_edge_on() {
        let with =
            |level: u64| Signals { inputs: Bits::new(level << 2, 8, &[]), ..Signals::default() };
        let mut index = Index { input: Some((3, true)), armed: false };
        let seen = [(1, 10.0), (0, 11.0), (0, 12.0), (1, 13.0)];
        let found = seen.map(|(level, position)| index.seen(&with(level), position));
        assert_eq!(found, [None, None, None, Some(13.0)]);
        // One that is off during the pulse.
        let mut index = Index { input: Some((3, false)), armed: false };
        let found = seen.map(|(level, position)| index.seen(&with(level), position));
        assert_eq!(found, [None, Some(11.0), Some(12.0), None]);
    }
}
