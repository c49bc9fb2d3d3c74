//! Faults of a wire or bus: what becomes of a frame on its way. Pure and deterministic: the same seed and the same
//! frames give the same faults.
//!
//! A bus has no frames: there, what a host writes before an interrupt is a request, and what the module shows after
//! it an answer (`drives/bim2ax/emulator/bus.rs` says what each fault means then).

use std::fmt;

/// Direction of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// From the master to the device.
    Request,
    /// From the device to the master.
    Answer,
}

/// Fault of a frame on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WireFault {
    /// It does not arrive.
    Drop,
    /// It arrives so much later, ns.
    Delay {
        /// Nanoseconds, more than 0.
        ns: i64,
    },
    /// Some of its bytes arrive as others.
    Corrupt {
        /// Number of bytes; all of them if there are fewer.
        bytes: usize,
    },
    /// Some of its bytes, wherever they are, do not arrive: a receiver that was read too late.
    Lose {
        /// Number of bytes; all of them if there are fewer.
        bytes: usize,
    },
    /// Some of its bytes, wherever they are, arrive twice.
    Double {
        /// Number of bytes; all of them if there are fewer.
        bytes: usize,
    },
    /// Only its first bytes arrive.
    Truncate {
        /// Number of bytes.
        keep: usize,
    },
    /// It arrives twice.
    Duplicate,
    /// Two neighbouring bytes change places; they are different ones if there are such.
    Reorder,
    /// Its last byte, which is (part of) the check sum of every family, arrives as another.
    WrongCheck,
    /// Bytes of noise arrive before it.
    Noise {
        /// Number of bytes.
        bytes: usize,
    },
    /// The device hears it and refuses it with this code of its family (Modbus exception, ATB NAK), unexecuted. Only of
    /// requests.
    Refuse {
        /// The code.
        code: u8,
    },
    /// Bytes of the master also come back to it, before the answer, as over a two-wire adapter that listens while
    /// it sends. Only of requests.
    Echo,
}

impl fmt::Display for WireFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Drop => f.write_str("drop"),
            Self::Delay { ns } => write!(f, "delay by {ns} ns"),
            Self::Corrupt { bytes } => write!(f, "corrupt {bytes} bytes"),
            Self::Lose { bytes } => write!(f, "lose {bytes} bytes"),
            Self::Double { bytes } => write!(f, "double {bytes} bytes"),
            Self::Truncate { keep } => write!(f, "truncate to {keep} bytes"),
            Self::Duplicate => f.write_str("duplicate"),
            Self::Reorder => f.write_str("reorder"),
            Self::WrongCheck => f.write_str("wrong check sum"),
            Self::Noise { bytes } => write!(f, "{bytes} bytes of noise"),
            Self::Refuse { code } => write!(f, "refuse with {code}"),
            Self::Echo => f.write_str("echo"),
        }
    }
}

/// Frames that a fault befalls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum When {
    /// All of them.
    Always,
    /// The next ones, of this number.
    Next(u32),
    /// The next one after this number that pass unharmed.
    After(u32),
    /// Every so-many-th; 0 and 1 are all.
    Every(u32),
    /// By chance, this number of a million.
    PerMillion(u32),
}

/// A fault, the frames it befalls and the way they go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FaultRule {
    /// Direction of the frames.
    pub direction: Direction,
    /// Choice of the frames.
    pub when: When,
    /// Their fault.
    pub fault: WireFault,
}

/// Result of a frame's way over the wire.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Passed {
    /// Pieces that arrive, each with its delay, ns.
    pub pieces: Vec<(i64, Vec<u8>)>,
    /// The code with which the device is to refuse it.
    pub refusal: Option<u8>,
    /// It comes back to its sender as well.
    pub echo: bool,
}

/// A wire with faults, or none.
#[derive(Clone, Debug)]
pub struct FaultyWire {
    /// Rules, each with the frames it has seen.
    rules: Vec<(FaultRule, u32)>,
    disconnected: bool,
    random: u64,
}

impl FaultyWire {
    /// A wire without faults. The seed decides what chance does.
    pub fn new(seed: u64) -> Self {
        Self { rules: Vec::new(), disconnected: false, random: seed }
    }

    /// One more fault, from the next frame on. Rules act in the order in which they came, each on what the one before
    /// has left.
    pub fn add(&mut self, rule: FaultRule) {
        self.rules.push((rule, 0));
    }

    /// Starts the random choices anew from this seed.
    pub fn set_seed(&mut self, seed: u64) {
        self.random = seed;
    }

    /// No faults any more.
    pub fn clear(&mut self) {
        self.rules.clear();
    }

    /// Pulls the plug or puts it back: meanwhile nothing arrives either way.
    pub fn set_disconnected(&mut self, disconnected: bool) {
        self.disconnected = disconnected;
    }

    /// Whether the plug is pulled.
    pub fn is_disconnected(&self) -> bool {
        self.disconnected
    }

    /// Sends a frame over the wire.
    pub fn pass(&mut self, direction: Direction, frame: &[u8]) -> Passed {
        let mut passed = Passed::default();
        if self.disconnected {
            return passed;
        }
        passed.pieces.push((0, frame.to_vec()));
        for fault in self.befalling(direction) {
            self.befall(&fault, direction, &mut passed);
        }
        passed
    }

    /// Faults of the next frame, for transports other than a stream of bytes.
    /// Nothing where the plug is pulled ([`Self::is_disconnected`]).
    pub fn befalling(&mut self, direction: Direction) -> Vec<WireFault> {
        if self.disconnected {
            return Vec::new();
        }
        let mut faults = Vec::new();
        let mut rules = std::mem::take(&mut self.rules);
        for (rule, seen) in rules.iter_mut().filter(|(rule, _)| rule.direction == direction) {
            if self.befalls(rule.when, *seen) {
                faults.push(rule.fault);
            }
            *seen = seen.saturating_add(1);
        }
        rules.retain(|(rule, seen)| match rule.when {
            When::Next(count) => *seen < count,
            When::After(count) => *seen <= count,
            _ => true,
        });
        self.rules = rules;
        faults
    }

    /// Whether a rule that has seen `seen` frames befalls this one.
    fn befalls(&mut self, when: When, seen: u32) -> bool {
        match when {
            When::Always => true,
            When::Next(count) => seen < count,
            When::After(count) => seen == count,
            When::Every(count) => (seen + 1).is_multiple_of(count.max(1)),
            When::PerMillion(chances) => self.below(1_000_000) < u64::from(chances),
        }
    }

    fn befall(&mut self, fault: &WireFault, direction: Direction, passed: &mut Passed) {
        let request = direction == Direction::Request;
        match *fault {
            WireFault::Drop => passed.pieces.clear(),
            WireFault::Delay { ns } => {
                for (later_ns, _) in &mut passed.pieces {
                    *later_ns = later_ns.saturating_add(ns.max(0));
                }
            }
            WireFault::Corrupt { bytes } => {
                for (_, frame) in &mut passed.pieces {
                    self.corrupt(frame, bytes);
                }
            }
            WireFault::Lose { bytes } => {
                for (_, frame) in &mut passed.pieces {
                    for _ in 0..bytes.min(frame.len()) {
                        frame.remove(self.place(frame.len()));
                    }
                }
                passed.pieces.retain(|(_, frame)| !frame.is_empty());
            }
            WireFault::Double { bytes } => {
                for (_, frame) in &mut passed.pieces {
                    self.double(frame, bytes);
                }
            }
            WireFault::Truncate { keep } => {
                passed.pieces.iter_mut().for_each(|(_, frame)| frame.truncate(keep));
                passed.pieces.retain(|(_, frame)| !frame.is_empty());
            }
            WireFault::Duplicate => {
                let again = passed.pieces.clone();
                passed.pieces.extend(again);
            }
            WireFault::Reorder => {
                for (_, frame) in &mut passed.pieces {
                    self.reorder(frame);
                }
            }
            WireFault::WrongCheck => {
                let lasts = passed.pieces.iter_mut().filter_map(|(_, frame)| frame.last_mut());
                lasts.for_each(|last| *last ^= 0x55);
            }
            WireFault::Noise { bytes } => {
                for (_, frame) in &mut passed.pieces {
                    let noise: Vec<u8> = (0..bytes).map(|_| self.byte()).collect();
                    frame.splice(0..0, noise);
                }
            }
            WireFault::Refuse { code } if request => passed.refusal = Some(code),
            WireFault::Echo if request => passed.echo = true,
            WireFault::Refuse { .. } | WireFault::Echo => {}
        }
    }

    /// Changes `bytes` different bytes.
    pub fn corrupt(&mut self, frame: &mut [u8], bytes: usize) {
        let mut places: Vec<usize> = (0..frame.len()).collect();
        for _ in 0..bytes.min(frame.len()) {
            let place = places.swap_remove(self.place(places.len()));
            // Never by 0: the byte is another.
            let change = self.byte().max(1);
            if let Some(byte) = frame.get_mut(place) {
                *byte ^= change;
            }
        }
    }

    /// Repeats `bytes` different bytes, each behind itself.
    fn double(&mut self, frame: &mut Vec<u8>, bytes: usize) {
        let mut times = vec![1; frame.len()];
        let mut places: Vec<usize> = (0..frame.len()).collect();
        for _ in 0..bytes.min(frame.len()) {
            let place = places.swap_remove(self.place(places.len()));
            if let Some(times) = times.get_mut(place) {
                *times = 2;
            }
        }
        let repeated = frame.iter().zip(times).flat_map(|(byte, times)| vec![*byte; times]);
        *frame = repeated.collect();
    }

    fn reorder(&mut self, frame: &mut [u8]) {
        let differ = frame.windows(2).enumerate().filter(|(_, pair)| pair.first() != pair.last());
        let places: Vec<usize> = differ.map(|(place, _)| place).collect();
        if places.is_empty() {
            return;
        }
        let chosen = places.get(self.place(places.len())).copied();
        if let Some(place) = chosen.filter(|place| place + 1 < frame.len()) {
            frame.swap(place, place + 1);
        }
    }

    fn byte(&mut self) -> u8 {
        let [byte, ..] = self.next().to_be_bytes();
        byte
    }

    /// Below a count, which is more than 0.
    fn place(&mut self, count: usize) -> usize {
        let count = u64::try_from(count).unwrap_or(u64::MAX);
        usize::try_from(self.below(count)).unwrap_or(0)
    }

    fn below(&mut self, count: u64) -> u64 {
        // The bias of the remainder is less than one in 2⁴⁴ for a million.
        self.next() % count.max(1)
    }

    /// `SplitMix64` (Steele, Lea and Flood, 2014): a counter whose bits are mixed.
    fn next(&mut self) -> u64 {
        self.random = self.random.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.random ^ self.random >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: [u8; 8] = [1, 4, 4, 0, 0, 12, 0xF1, 0x3F];

    fn wire(fault: WireFault, when: When) -> FaultyWire {
        let mut wire = FaultyWire::new(7);
        wire.add(FaultRule { direction: Direction::Answer, when, fault });
        wire
    }

    fn once(fault: WireFault) -> Vec<(i64, Vec<u8>)> {
        wire(fault, When::Always).pass(Direction::Answer, &FRAME).pieces
    }

    /// Places at which bytes are others.
    fn changed(frame: &[u8]) -> Vec<usize> {
        (0..FRAME.len()).filter(|place| frame[*place] != FRAME[*place]).collect()
    }

    #[test]
    fn random_numbers_are_those_of_the_publication() {
        // First outputs of SplitMix64 from seed 1234567, as published with the reference implementation.
        let mut wire = FaultyWire::new(1_234_567);
        assert_eq!(wire.next(), 6_457_827_717_110_365_317);
        assert_eq!(wire.next(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn each_fault_does_what_it_says() {
        assert_eq!(once(WireFault::Drop), []);
        assert_eq!(once(WireFault::Delay { ns: 5 }), [(5, FRAME.to_vec())]);
        assert_eq!(once(WireFault::Truncate { keep: 3 }), [(0, vec![1, 4, 4])]);
        assert_eq!(once(WireFault::Truncate { keep: 0 }), []);
        assert_eq!(once(WireFault::Duplicate), [(0, FRAME.to_vec()), (0, FRAME.to_vec())]);
        assert_eq!(changed(&once(WireFault::Corrupt { bytes: 3 })[0].1).len(), 3);
        assert_eq!(changed(&once(WireFault::Corrupt { bytes: 99 })[0].1).len(), 8);
        assert_eq!(changed(&once(WireFault::WrongCheck)[0].1), [7]);
        // What is left are bytes of the frame in their order, and what is too much are bytes next to themselves.
        for bytes in [1, 3, 99] {
            let lost = once(WireFault::Lose { bytes }).pop().map_or(Vec::new(), |(_, frame)| frame);
            assert_eq!(lost.len(), FRAME.len().saturating_sub(bytes));
            let mut of_frame = FRAME.iter();
            assert!(lost.iter().all(|byte| of_frame.any(|own| own == byte)), "{lost:?}");
            let bytes_of = [1, 2, 3, 4, 5, 6, 7, 8];
            let double = WireFault::Double { bytes };
            let mut doubled = wire(double, When::Always).pass(Direction::Answer, &bytes_of).pieces;
            let (_, mut doubled) = doubled.remove(0);
            assert_eq!(doubled.len(), 8 + bytes.min(8));
            doubled.dedup();
            assert_eq!(doubled, bytes_of);
        }
        let noisy = once(WireFault::Noise { bytes: 5 });
        assert_eq!(noisy[0].1[5..], FRAME);
        let reordered = once(WireFault::Reorder).remove(0).1;
        let places = changed(&reordered);
        assert_eq!(places.len(), 2);
        assert_eq!(places[1], places[0] + 1);
        assert_eq!(reordered[places[0]], FRAME[places[1]]);
    }

    #[test]
    fn refusals_and_echoes_are_of_requests() {
        for (direction, refusal, echo) in
            [(Direction::Request, Some(4), true), (Direction::Answer, None, false)]
        {
            let mut wire = FaultyWire::new(0);
            for fault in [WireFault::Refuse { code: 4 }, WireFault::Echo] {
                wire.add(FaultRule { direction, when: When::Always, fault });
            }
            let passed = wire.pass(direction, &FRAME);
            assert_eq!((passed.refusal, passed.echo), (refusal, echo));
            assert_eq!(passed.pieces, [(0, FRAME.to_vec())]);
        }
    }

    #[test]
    fn faults_befall_the_frames_they_are_meant_for() {
        let lost = |when| {
            let mut wire = wire(WireFault::Drop, when);
            (0..6).filter(|_| wire.pass(Direction::Answer, &FRAME).pieces.is_empty()).count()
        };
        assert_eq!(lost(When::Always), 6);
        assert_eq!(lost(When::Next(2)), 2);
        assert_eq!(lost(When::After(3)), 1);
        assert_eq!(lost(When::Every(3)), 2);
        let mut after = wire(WireFault::Drop, When::After(2));
        let lost: Vec<bool> =
            (0..5).map(|_| after.pass(Direction::Answer, &FRAME).pieces.is_empty()).collect();
        assert_eq!(lost, [false, false, true, false, false]);
        // The other way nothing happens, and is not counted.
        let mut other = wire(WireFault::Drop, When::Next(1));
        assert_eq!(other.pass(Direction::Request, &FRAME).pieces.len(), 1);
        assert_eq!(other.pass(Direction::Answer, &FRAME).pieces.len(), 0);
    }

    #[test]
    fn a_seed_set_later_counts_as_one_from_the_start() {
        let corrupted = |wire: &mut FaultyWire| {
            wire.clear();
            let fault = WireFault::Corrupt { bytes: 2 };
            wire.add(FaultRule { direction: Direction::Answer, when: When::Always, fault });
            wire.pass(Direction::Answer, &FRAME).pieces
        };
        let (mut one, mut other) = (FaultyWire::new(1), FaultyWire::new(2));
        assert_ne!(corrupted(&mut one), corrupted(&mut other));
        one.set_seed(3);
        other.set_seed(3);
        assert_eq!(corrupted(&mut one), corrupted(&mut other));
    }

    #[test]
    fn chance_is_fair_and_the_same_every_time() {
        let run = |seed| {
            let mut wire = FaultyWire::new(seed);
            let when = When::PerMillion(250_000);
            wire.add(FaultRule { direction: Direction::Answer, when, fault: WireFault::Drop });
            (0..10_000).filter(|_| wire.pass(Direction::Answer, &FRAME).pieces.is_empty()).count()
        };
        // Ten standard deviations of a binomial distribution are 433.
        assert!(run(1).abs_diff(2500) < 433, "{}", run(1));
        assert_eq!(run(1), run(1));
        assert_ne!(run(1), run(2));
    }

    #[test]
    fn nothing_passes_a_wire_that_is_not_plugged_in() {
        let mut wire = FaultyWire::new(0);
        wire.set_disconnected(true);
        assert_eq!(wire.pass(Direction::Request, &FRAME), Passed::default());
        wire.set_disconnected(false);
        assert_eq!(wire.pass(Direction::Request, &FRAME).pieces.len(), 1);
    }
}
