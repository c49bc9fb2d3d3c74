//! Events at an emulated module other than on its bus, and their handling.

use super::{Module, Surroundings};
use crate::ModuleAxis;

/// Events at a module, and faults of its bus.
pub type Control = twin_drives::Control<Event>;

/// Event at a module other than on its bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// Something else is connected from now on.
    Surroundings(Box<Surroundings>),
    /// The shaft of a motor is held (true) or let go.
    Stall(ModuleAxis, bool),
    /// Power at an axis is there (true) or gone.
    Power(ModuleAxis, bool),
    /// A phase of a motor breaks (true) or is mended.
    PhaseOpen(ModuleAxis, bool),
    /// Phases of a motor get a short circuit (true) or lose it.
    PhaseShort(ModuleAxis, bool),
    /// Positions and axis messages are shown as they are now for good (true), or as they are.
    StuckStatus(bool),
    /// The next moves, of this number, are confirmed and not carried out.
    IgnoreMoves(u32),
    /// The supply fails and is back after this time, ns: the module starts anew.
    BrownOut {
        /// Without supply for so long, ns.
        off_ns: i64,
    },
    /// The check sum of the EEPROM is wrong from the next RESET or start on.
    SpoilEeprom,
}

impl Module {
    /// Makes something happen, now or later.
    pub fn control(&mut self, control: Control) {
        let mut agenda = std::mem::take(&mut self.agenda);
        let mut bus = self.bus.clone();
        agenda.obey(control, &mut bus, &mut |event| self.happen(event));
        (self.agenda, self.bus) = (agenda, bus);
    }

    /// Lets something happen now.
    pub fn happen(&mut self, event: Event) {
        let mut surroundings = *self.surroundings();
        let mut bench = |axis: ModuleAxis, change: &dyn Fn(&mut super::Bench)| {
            surroundings.benches.get_mut(axis.index()).into_iter().for_each(change);
            self.set_surroundings(&surroundings);
        };
        match event {
            Event::Surroundings(surroundings) => self.set_surroundings(&surroundings),
            Event::Stall(axis, stalled) => bench(axis, &|bench| bench.stalled = stalled),
            Event::Power(axis, power) => bench(axis, &|bench| bench.power = power),
            Event::PhaseOpen(axis, open) => bench(axis, &|bench| bench.phase_open = open),
            Event::PhaseShort(axis, short) => bench(axis, &|bench| bench.phase_short = short),
            Event::StuckStatus(stuck) => self.set_stuck_status(stuck),
            Event::IgnoreMoves(moves) => {
                self.axes.iter_mut().for_each(|axis| axis.ignore_moves(moves));
            }
            Event::BrownOut { off_ns } => self.brown_out(off_ns),
            Event::SpoilEeprom => self.spoil_eeprom(),
        }
    }
}
