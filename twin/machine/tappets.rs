//! Tappet signals of the cams that run (manual 4.4.2, `SMC_GetTappetValue` 5.5).
//!
//! Each tappet group of a slave is one signal, initially off (`bInitValue`), evaluated at every set-point. A slave
//! that changes its cam keeps its signals (`bSetInitValueAtReset` is FALSE).

use twin_cam::{TappetBit, TappetData, Trigger};

/// Largest number of signals of one program.
pub const MOST_SIGNALS: usize = 64;

/// Signal of one tappet group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Name of the slave whose cam has the tappets.
    pub axis: String,
    /// Number of the group.
    pub group: i16,
}

impl std::fmt::Display for Signal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "tappet {} of {}", self.group, self.axis)
    }
}

/// `[[tappet_outputs]]` of a machine file: an output that is on while the tappets of a group have it on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TappetOutput {
    /// Name of the slave whose cam has the tappets: an axis of the machine, or a virtual one of a job.
    pub axis: String,
    /// Number of the group.
    pub group: i16,
    /// The device, an index into [`crate::Machine::drives`].
    pub device: usize,
    /// The output, from 1, as [`twin_drives::Drive::set_output`] counts them.
    pub output: u8,
}

/// Signals as bits, in the order of their list: on or off at one set-point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TappetBits(u64);

impl TappetBits {
    /// True if the signal `index` is on.
    pub fn is_on(self, index: usize) -> bool {
        index < MOST_SIGNALS && self.0 >> index & 1 == 1
    }

    /// The signals that are not as in `before`, each with what it is now.
    pub fn changed(self, before: Self) -> impl Iterator<Item = (usize, bool)> {
        (0..MOST_SIGNALS)
            .filter(move |index| self.is_on(*index) != before.is_on(*index))
            .map(move |index| (index, self.is_on(index)))
    }

    fn set(&mut self, index: usize, on: bool) {
        if index < MOST_SIGNALS {
            self.0 = self.0 & !(1 << index) | u64::from(on) << index;
        }
    }
}

/// Position of a master, for people.
#[derive(Clone, Debug, PartialEq)]
pub struct MasterPlace {
    /// Name of the axis.
    pub axis: String,
    /// mm or degrees.
    pub position: f64,
    /// mm or deg.
    pub unit: &'static str,
}

/// The signals of a program under way.
#[derive(Clone, Debug, Default)]
pub struct Tracks {
    signals: Vec<Signal>,
    of_signals: Vec<Track>,
    lost: u64,
}

/// One of them.
#[derive(Clone, Debug, Default)]
struct Track {
    /// Number of the slave.
    slave: usize,
    /// The master whose passage acted last.
    master: Option<usize>,
    bit: TappetBit,
}

impl Tracks {
    /// Adds a signal for this group of this slave, if there is none yet; false if there are too many.
    pub fn add(&mut self, slave: usize, name: &str, group: i16) -> bool {
        if self.find(slave, group).is_some() {
            return true;
        }
        if self.of_signals.len() >= MOST_SIGNALS {
            return false;
        }
        self.signals.push(Signal { axis: name.to_owned(), group });
        self.of_signals.push(Track { slave, ..Track::default() });
        true
    }

    fn find(&self, slave: usize, group: i16) -> Option<usize> {
        let mut both = self.signals.iter().zip(&self.of_signals);
        both.position(|(signal, track)| track.slave == slave && signal.group == group)
    }

    /// The signals that tappets switch.
    pub fn signals(&self) -> &[Signal] {
        &self.signals
    }

    /// A tappet of the cam between `slave` and `master` acts.
    pub fn take(&mut self, slave: usize, master: usize, trigger: &Trigger) {
        if let Some(index) = self.find(slave, trigger.group)
            && let Some(track) = self.of_signals.get_mut(index)
        {
            track.master = Some(master);
            track.bit.take(trigger);
        }
    }

    /// Takes the tappet actions of a cam in a cycle; the cam's clock is `later_ns` behind the program's.
    pub(crate) fn take_all(
        &mut self,
        (slave, master): (usize, usize),
        data: &TappetData,
        later_ns: i64,
    ) {
        self.lose(data);
        for trigger in data.triggers() {
            let time_ns = trigger.time_ns.saturating_add(later_ns);
            self.take(slave, master, &Trigger { time_ns, ..*trigger });
        }
    }

    /// Counts what a cycle had no room for.
    pub(crate) fn lose(&mut self, data: &TappetData) {
        self.lost = self.lost.saturating_add(u64::try_from(data.lost).unwrap_or(u64::MAX));
    }

    /// Tappets that did not act because there were too many in a cycle.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// States of the signals at the set-point at `time_ns`.
    pub fn at(&mut self, time_ns: i64) -> TappetBits {
        let mut bits = TappetBits::default();
        for (index, track) in self.of_signals.iter_mut().enumerate() {
            bits.set(index, track.bit.at(time_ns));
        }
        bits
    }

    /// The axis whose passage switched the signal `index` last.
    pub fn master(&self, index: usize) -> Option<usize> {
        self.of_signals.get(index)?.master
    }
}

/// A signal that is switched.
#[derive(Clone, Debug, PartialEq)]
pub struct TappetSwitch {
    /// Its number among the signals.
    pub signal: usize,
    /// On or off.
    pub on: bool,
    /// Set-point at which it is seen, ns.
    pub time_ns: i64,
    /// Place in the program.
    pub place: twin_path::Place,
    /// Position of the master then.
    pub master: Option<MasterPlace>,
}

/// More switchings than these are counted, not kept.
pub(crate) const MOST_SWITCHES: usize = 10_000;

/// Everything that tappets switched along a program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Switched {
    /// The signals.
    pub signals: Vec<Signal>,
    /// The first 10,000 switchings, in the order of time.
    pub switches: Vec<TappetSwitch>,
    /// Number of switchings of each signal.
    pub counts: Vec<u64>,
    /// Number of switchings that were not kept.
    pub left_out: u64,
    /// Tappets that did not act because there were too many in a cycle.
    pub lost: u64,
    last: TappetBits,
}

impl Switched {
    /// Takes the next set-point; `master` gives the position of the master of a signal.
    pub fn observe(
        &mut self,
        bits: TappetBits,
        (time_ns, place): (i64, twin_path::Place),
        master: impl Fn(usize) -> Option<MasterPlace>,
    ) {
        let before = std::mem::replace(&mut self.last, bits);
        if bits == before {
            return;
        }
        for (signal, on) in bits.changed(before) {
            if self.counts.len() <= signal {
                self.counts.resize(signal + 1, 0);
            }
            if let Some(count) = self.counts.get_mut(signal) {
                *count += 1;
            }
            if self.switches.len() < MOST_SWITCHES {
                let master = master(signal);
                self.switches.push(TappetSwitch { signal, on, time_ns, place, master });
            } else {
                self.left_out += 1;
            }
        }
    }
}
