//! The state of the path's switches (H words, manual 3.2.1 and 6.2.9).

use twin_path::Switch;

/// The switches as the path has set them (`dwSwitches`, `iLastSwitch`).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SwitchBoard {
    pub(crate) states: u32,
    pub(crate) last: u8,
}

impl SwitchBoard {
    /// Applies those of `switches` that lie at `s` of `length` or before it and are not among the first `passed`, which
    /// counts on.
    pub(crate) fn pass(&mut self, switches: &[Switch], passed: &mut usize, s: f64, length: f64) {
        for switch in switches.get(*passed..).unwrap_or_default() {
            if switch.at * length > s {
                break;
            }
            self.apply(*switch);
            *passed += 1;
        }
    }

    /// Applies all that are left.
    pub(crate) fn pass_all(&mut self, switches: &[Switch], passed: &mut usize) {
        for switch in switches.get(*passed..).unwrap_or_default() {
            self.apply(*switch);
        }
        *passed = switches.len();
    }

    fn apply(&mut self, switch: Switch) {
        let bit = match switch.number {
            number @ 1..=32 => 1 << (number - 1),
            _ => return,
        };
        self.last = switch.number;
        if switch.on {
            self.states |= bit;
        } else {
            self.states &= !bit;
        }
    }
}
