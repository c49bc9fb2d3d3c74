//! Watchdog of a run: device silence while its axes are to move, and following errors beyond the limits of the machine
//! file.
//!
//! A driver asks a silent device again before it gives up. Meanwhile the other devices would go on along the path
//! without it. The session therefore gets an error as soon as the silence lasts too long, and brings all axes to rest.

use super::HardwareError;
use super::stream::Stream;
use crate::emulated;
use std::time::Duration;
use twin_drives::{MAX_DRIVE_AXES, SetpointStream};
use twin_machine::{Axis, DeviceEntry, Machine};

/// How long a device may keep silent where the machine file does not say otherwise: at least this, ms.
const USUAL_SILENCE_MS: u32 = 300;

/// A silence of fewer rounds on the wire than this cannot be distinguished from a usual one.
const LEAST_ROUNDS: u32 = 3;

/// Samples in a row that have to show an axis too far away: the time of one alone may be uncertain.
const MOST_SAMPLES: u32 = 2;

/// Kind of drives that a run moves, real or emulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guarded {
    /// Real ones.
    Real,
    /// Emulated ones, which are as late as the computer is busy, and of which nothing breaks: how far an axis is off is
    /// reported at the end, and silence ends a run only where the machine file says how long it may last.
    Emulated,
}

/// How far an axis may be from its set-points.
#[derive(Clone, Debug)]
struct Limit {
    axis: String,
    /// m or rad.
    most: f64,
    /// "mm" or "deg", and how many of them m or rad are.
    unit: &'static str,
    scale: f64,
}

/// Watchdog of one device.
#[derive(Clone, Debug, Default)]
pub(super) struct Guard {
    silence_ms: Option<u32>,
    limits: [Option<Limit>; MAX_DRIVE_AXES],
    /// When it was last heard of, ns.
    heard_ns: i64,
    /// Whether its axes moved then, or the plan has moved them since.
    moving: bool,
    /// Where the plan had its axes then, increments, once somebody has looked.
    origin: Option<[f64; MAX_DRIVE_AXES]>,
    /// Up to when the plan has been looked at, ns: it does not remember for as long as a silence may last.
    looked_ns: i64,
    /// Samples in a row that show an axis too far away.
    beyond: [u32; MAX_DRIVE_AXES],
    reported_silence: bool,
    reported_error: bool,
    /// Whose drives it watches, once somebody has said so.
    whose: Option<Guarded>,
}

impl Guard {
    /// Of a device of a machine, by its place in the file.
    pub(super) fn new(machine: &Machine, device: usize, whose: Guarded) -> Self {
        let entry = machine.drives.get(device);
        let mut guard = Self::default();
        let said = entry.and_then(|entry| entry.silence_ms);
        if whose == Guarded::Emulated {
            return Self { silence_ms: said, ..guard };
        }
        guard.whose = Some(whose);
        guard.silence_ms = said.or_else(|| Some(usual_silence_ms(machine, (device, entry?))));
        for (limit, (_, axis)) in guard.limits.iter_mut().zip(machine.axes_of(device)) {
            *limit = Limit::of(axis);
        }
        guard
    }

    /// True if it watches real drives.
    pub(super) fn is_of_real(&self) -> bool {
        self.whose == Some(Guarded::Real)
    }

    /// True if the following error of one of its axes has exceeded its limit.
    pub(super) fn is_astray(&self) -> bool {
        self.reported_error
    }

    /// It begins to follow.
    pub(super) fn begin(&mut self, now_ns: i64) {
        (self.heard_ns, self.looked_ns, self.origin) = (now_ns, now_ns, None);
    }

    /// Takes a sample of the device with the following errors of its axes, m or rad.
    pub(super) fn heard(
        &mut self,
        (time_ns, moving): (i64, bool),
        deviation: &[f64; MAX_DRIVE_AXES],
    ) -> Option<HardwareError> {
        self.begin(time_ns);
        (self.moving, self.reported_silence) = (moving, false);
        let mut farthest: Option<(&Limit, f64)> = None;
        let axes = self.limits.iter().zip(&mut self.beyond).zip(deviation);
        for ((limit, beyond), deviation) in axes {
            let Some(limit) = limit else { continue };
            let error = deviation.abs();
            *beyond = if error > limit.most { beyond.saturating_add(1) } else { 0 };
            let worse = farthest.is_none_or(|(of, worst)| error / limit.most > worst / of.most);
            if *beyond >= MOST_SAMPLES && worse {
                farthest = Some((limit, error));
            }
        }
        let (limit, error) = farthest.filter(|_| !self.reported_error)?;
        self.reported_error = true;
        Some(HardwareError::TooFar {
            axis: limit.axis.clone(),
            error: error * limit.scale,
            limit: limit.most * limit.scale,
            unit: limit.unit,
            time_ns,
        })
    }

    /// Fails, once for each silence, if it has lasted too long by `now_ns` and the stream was to move any of the first
    /// `axes` axes meanwhile. A way out and back counts, too.
    pub(super) fn silence(
        &mut self,
        device: &str,
        now_ns: i64,
        (stream, axes): (&Stream, usize),
    ) -> Option<HardwareError> {
        let limit_ms = self.silence_ms.filter(|_| !self.reported_silence)?;
        if !self.moving {
            let origin = self.origin.get_or_insert_with(|| stream.at(self.heard_ns).position);
            self.moving = stream.strays(origin, (self.looked_ns, now_ns), axes);
            self.looked_ns = now_ns;
        }
        let silent_ms = now_ns.saturating_sub(self.heard_ns) / 1_000_000;
        if silent_ms <= i64::from(limit_ms) || !self.moving {
            return None;
        }
        self.reported_silence = true;
        let device = device.to_owned();
        Some(HardwareError::Silent { device, silent_ms, limit_ms, then: None })
    }
}

impl Limit {
    fn of(axis: &Axis) -> Option<Self> {
        let most = axis.max_following_error?;
        let (axis, unit, scale) = (axis.name.clone(), axis.unit(), axis.from_si(1.0));
        Some(Self { axis, most, unit, scale })
    }
}

/// How long a device may keep silent where the file does not say: two answers in a row may be lost in the middle of a round, and
/// another round may pass until the axes are seen. Its driver goes on asking meanwhile.
fn usual_silence_ms(machine: &Machine, device: (usize, &DeviceEntry)) -> u32 {
    let (loss, round) = (lost_answer(machine, device), emulated::round(machine, device));
    whole_ms(2 * (loss + round)).max(USUAL_SILENCE_MS)
}

/// Time that one lost answer costs: what the deadline has to spare, the pause after it, and no more than a round until the answer
/// to the repeat.
pub(crate) fn lost_answer(machine: &Machine, device: (usize, &DeviceEntry)) -> Duration {
    let [added, pause] = device.1.waits();
    added + pause + emulated::round(machine, device)
}

/// Fails where the machine file lets a device be silent for less than a few of its rounds: any run would be stopped.
pub(super) fn check(machine: &Machine, device: usize) -> Result<(), HardwareError> {
    let Some(entry) = machine.drives.get(device) else { return Ok(()) };
    let Some(said_ms) = entry.silence_ms else { return Ok(()) };
    let round = emulated::round(machine, (device, entry));
    let least_ms = whole_ms(LEAST_ROUNDS * round);
    if said_ms >= least_ms {
        return Ok(());
    }
    let (file, device) = (machine.path.display().to_string(), entry.name.clone());
    Err(HardwareError::Impatient { file, device, said_ms, least_ms, round_ms: whole_ms(round) })
}

/// Not less than it is, ms.
fn whole_ms(time: Duration) -> u32 {
    u32::try_from(time.as_micros().div_ceil(1000)).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use twin_drives::IncrementMotion;

    fn guard() -> Guard {
        let limit = Limit { axis: "X".to_owned(), most: 0.5e-3, unit: "mm", scale: 1e3 };
        let mut guard = Guard { silence_ms: Some(300), ..Guard::default() };
        guard.limits[1] = Some(limit);
        guard
    }

    const MS: i64 = 1_000_000;

    /// Cycles of 1 ms; of the first axis.
    fn stream(positions: impl Iterator<Item = f64>) -> Stream {
        let stream = Stream::new([0.0; MAX_DRIVE_AXES], MS);
        for (cycle, first) in (0..).zip(positions) {
            let mut motion = IncrementMotion::default();
            motion.position[0] = first;
            stream.push(cycle * MS, motion);
        }
        stream
    }

    #[test]
    fn silence_counts_from_the_last_sample_and_only_while_axes_are_to_move() {
        // It sets out at 1000 ms, by an increment in 10 ms.
        let stream = stream((0..1500).map(|cycle| f64::from((cycle - 1000).max(0)) / 10.0));
        let (moves, others) = ((&stream, 3), (&stream, 0));
        let mut guard = guard();
        guard.begin(709 * MS);
        assert!(guard.silence("board", 1009 * MS, moves).is_none());
        let mut standing = guard.clone();
        assert!(standing.silence("board", 1400 * MS, others).is_none(), "nothing is to move");
        let error = guard.silence("board", 1010 * MS, moves).expect("too long");
        assert!(error.to_string().contains("`board` has not answered for 301 ms"), "{error}");
        assert!(guard.silence("board", 1400 * MS, moves).is_none(), "it has been reported");
        // Heard of again, and while its axes moved.
        assert!(guard.heard((1500 * MS, true), &[0.0; MAX_DRIVE_AXES]).is_none());
        assert!(guard.silence("board", 1800 * MS, others).is_none());
        assert!(guard.silence("board", 1801 * MS, others).is_some());
    }

    /// Lost answers are asked for again, whatever the wire; rounds are those of the manual's 8N1 bytes.
    #[test]
    fn two_lost_answers_are_no_silence() {
        let silence = |keys: &str| {
            let text = include_str!("../../machines/gantry3.toml");
            let text = text.replacen("kind = \"interpcnc\"", keys, 1);
            let machine = Machine::parse(Path::new("machine.toml"), &text).unwrap();
            let real = Guard::new(&machine, 0, Guarded::Real).silence_ms;
            assert!(check(&machine, 0).is_ok());
            assert_eq!(Guard::new(&machine, 0, Guarded::Emulated).silence_ms, None);
            real.expect("there is one")
        };
        // Twice 20 ms and two rounds, of which each takes four exchanges of 7 to 9 ms: less than the least.
        assert_eq!(silence("kind = \"interpcnc\""), 300);
        // Four exchanges of 8 bytes at least each way at 960 bytes/s, four times.
        let slow = silence("kind = \"interpcnc\"\nbaud = 9600");
        assert!((40 + 4 * 4 * 16 * 1000 / 960..1000).contains(&slow), "{slow}");
        let patient = silence("kind = \"interpcnc\"\nanswer_deadline_ms = 1000");
        assert!((2000 + 4 * 28..2000 + 4 * 40).contains(&patient), "{patient}");
    }

    #[test]
    fn a_silence_of_few_rounds_is_refused() {
        let text = include_str!("../../machines/gantry3.toml");
        let keys = "kind = \"interpcnc\"\nbaud = 9600\nlongest_silence_ms = 30";
        let text = text.replacen("kind = \"interpcnc\"", keys, 1);
        let machine = Machine::parse(Path::new("machine.toml"), &text).unwrap();
        let said = check(&machine, 0).unwrap_err().to_string();
        for part in ["machine.toml: device `board`: longest_silence_ms = 30 is", "at least "] {
            assert!(said.contains(part), "{said}");
        }
    }

    #[test]
    fn a_way_out_and_back_is_to_move() {
        // 2 increments between 100 and 140 ms, between two looks and long before the third.
        let out = |cycle: i32| f64::from((20 - (cycle - 120).abs()).max(0)) / 10.0;
        let stream = stream((0..500).map(out));
        for looks in [&[301][..], &[50, 301], &[50, 200, 301]] {
            let mut guard = guard();
            guard.begin(0);
            let error = looks.iter().find_map(|ms| guard.silence("board", ms * MS, (&stream, 1)));
            assert!(
                matches!(error, Some(HardwareError::Silent { silent_ms: 301, .. })),
                "{looks:?}"
            );
        }
        // Less than an increment is none.
        let mut guard = guard();
        guard.begin(0);
        let little = self::stream((0..500).map(|cycle| out(cycle) * 0.499));
        assert!(guard.silence("board", 301 * MS, (&little, 1)).is_none());
    }

    #[test]
    fn an_axis_is_too_far_away_in_two_samples_running() {
        let mut guard = guard();
        let off = |error: f64| [9.0, error, 9.0, 9.0, 9.0];
        // The limit itself, and others without one, are no matter; one sample alone neither.
        for error in [0.5e-3, -0.7e-3, 0.0, 0.7e-3] {
            assert!(guard.heard((1, true), &off(error)).is_none(), "{error}");
        }
        let error = guard.heard((2, true), &off(-0.8e-3)).expect("twice");
        let said = error.to_string();
        for part in ["following-error", "axis X", "0.8000 mm", "at most 0.5000 mm"] {
            assert!(said.contains(part), "{said}");
        }
        assert!(guard.heard((3, true), &off(0.9e-3)).is_none(), "it has been reported");
    }
}
