//! Tests of device thread and set-point stream with a mock drive.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "a few thousand increments and cycles"
)]

use super::stream::Stream;
use super::{Guarded, Hardware, HardwareError};
use crate::attached::Attached;
use crate::clock::Clock;
use crate::plant::{AxisFeedback, Plant};
use crate::setpoint::AxisSetpoint;
use crate::setpoint::HORIZON_NS;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use twin_drives::{
    Action, Drive, DriveError, Exchange, Identity, IncrementMotion, Increments, MAX_DRIVE_AXES,
    Sample, SetpointStream,
};
use twin_kinematics::{AxisMotion, AxisVector, Pose, ToolMotion};
use twin_machine::Machine;
use twin_machine::tappets::TappetBits;
use twin_path::Place;

/// 320, 320 and 640 increments per mm.
const GANTRY3: &str = include_str!("../../machines/gantry3.toml");
const CYCLE_NS: i64 = 1_000_000;

fn machine() -> Machine {
    Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap()
}

/// What a test sees and decides of its [`Puppet`].
#[expect(clippy::struct_excessive_bools, reason = "each is something else that goes wrong")]
#[derive(Debug, Default)]
struct Strings {
    probe_fails: bool,
    /// Does not answer from this sample on.
    samples_fail_from: Option<u32>,
    follow_panics: bool,
    /// Does not answer while it follows until there is a word from here.
    follow_waits: Option<Mutex<Receiver<()>>>,
    /// Does not move wherever it is sent.
    stuck: bool,
    /// Confirms no stop.
    goes_on: bool,
    /// Says after a soft stop that it moves, until this number of hard stops.
    moves_until: Option<u32>,
    /// `soft_stop` waits for a word from here.
    stop_waits: Option<Mutex<Receiver<()>>>,
    samples: AtomicU32,
    followed: AtomicU32,
    soft_stops: AtomicU32,
    hard_stops: AtomicU32,
    stopped: AtomicBool,
    outputs: Mutex<Vec<(u8, bool)>>,
}

/// A drive that is where the stream says, at any time, without a wire.
#[derive(Debug)]
struct Puppet {
    strings: Arc<Strings>,
    axes: usize,
    position: Increments,
}

impl Puppet {
    fn refusal() -> DriveError {
        let at = Exchange { port: "puppet".into(), address: 1, action: Action::ReadState };
        DriveError::Timeout { at, deadline: Duration::from_millis(1) }
    }

    fn rounded(motion: &IncrementMotion) -> Increments {
        let mut increments = [0; MAX_DRIVE_AXES];
        for (increments, position) in increments.iter_mut().zip(motion.position) {
            *increments = position.round() as i64;
        }
        increments
    }
}

impl Drive for Puppet {
    fn describe(&self) -> String {
        "a puppet".to_owned()
    }

    fn axis_count(&self) -> usize {
        self.axes
    }

    fn identity(&mut self) -> Result<Identity, DriveError> {
        Ok(Identity { family: "puppet", units: Vec::new() })
    }

    fn probe(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        if self.strings.probe_fails { Err(Self::refusal()) } else { self.sample(stream) }
    }

    fn enable(&mut self) -> Result<(), DriveError> {
        Ok(())
    }

    fn set_output(&mut self, output: u8, on: bool) -> Result<(), DriveError> {
        self.strings.outputs.lock().unwrap().push((output, on));
        Ok(())
    }

    fn set_position(&mut self, position: &Increments) -> Result<(), DriveError> {
        self.position = *position;
        Ok(())
    }

    fn move_to(
        &mut self,
        target: &Increments,
        speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), DriveError> {
        assert!(speed.iter().take(self.axes).all(|speed| *speed >= 1.0), "{speed:?}");
        if !self.strings.stuck {
            self.position = *target;
        }
        Ok(())
    }

    fn sample(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        let count = self.strings.samples.fetch_add(1, Ordering::SeqCst);
        if self.strings.samples_fail_from.is_some_and(|from| count >= from) {
            return Err(Self::refusal());
        }
        let stops = |of: &AtomicU32| of.load(Ordering::SeqCst);
        let moving = self.strings.moves_until.is_some_and(|most| {
            stops(&self.strings.soft_stops) > 0 && stops(&self.strings.hard_stops) < most
        });
        if moving {
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(Sample { time_ns: stream.now_ns(), position: self.position, moving })
    }

    fn follow(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        assert!(!self.strings.follow_panics, "as asked");
        if let Some(waits) = &self.strings.follow_waits {
            waits.lock().unwrap().recv_timeout(Duration::from_mins(1)).unwrap_or_default();
        }
        let time_ns = stream.now_ns();
        let motion = stream.at(time_ns);
        self.strings.followed.fetch_add(1, Ordering::SeqCst);
        if !self.strings.stuck {
            self.position = Self::rounded(&motion);
        }
        let moving = motion.velocity.iter().any(|velocity| velocity.abs() > 1e-9);
        Ok(Sample { time_ns, position: self.position, moving: moving && !self.strings.stuck })
    }

    fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.strings.soft_stops.fetch_add(1, Ordering::SeqCst);
        if let Some(waits) = &self.strings.stop_waits {
            // Without the word in a minute the test has failed; it must end all the same.
            waits.lock().unwrap().recv_timeout(Duration::from_mins(1)).unwrap_or_default();
        }
        if self.strings.goes_on {
            return Err(Self::refusal());
        }
        self.strings.stopped.store(true, Ordering::SeqCst);
        Ok(())
    }

    fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.strings.hard_stops.fetch_add(1, Ordering::SeqCst);
        if self.strings.goes_on { Err(Self::refusal()) } else { Ok(()) }
    }
}

/// The only device.
fn only(puppet: Puppet) -> Vec<Attached> {
    vec![Attached { device: 0, drive: Box::new(puppet) }]
}

const START: [f64; 3] = [0.1, -0.05, 0.06];

fn start(strings: Strings) -> (Hardware, Arc<Strings>) {
    let strings = Arc::new(strings);
    let puppet = Puppet { strings: Arc::clone(&strings), axes: 3, position: [0; MAX_DRIVE_AXES] };
    let at = AxisVector::from_values(START);
    let hardware = Hardware::start(&machine(), only(puppet), &at, CYCLE_NS, 0.25).unwrap();
    (hardware, strings)
}

/// What becomes of the approach.
fn approach(hardware: &mut Hardware) -> Result<(), HardwareError> {
    while !hardware.ready()? {
        std::thread::sleep(Duration::from_millis(1));
    }
    Ok(())
}

/// Waits for the thread's end and takes everything it said.
fn listen(hardware: &mut Hardware) -> (Vec<AxisFeedback>, Option<HardwareError>) {
    let mut heard = Vec::new();
    loop {
        let running = hardware.is_running();
        loop {
            match hardware.feedback() {
                Ok(Some(feedback)) => heard.push(feedback),
                Ok(None) => break,
                Err(error) => return (heard, Some(error)),
            }
        }
        if !running {
            return (heard, None);
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Waits for an error.
fn first_error(hardware: &mut Hardware) -> HardwareError {
    loop {
        match hardware.feedback() {
            Ok(_) => std::thread::sleep(Duration::from_millis(1)),
            Err(error) => return error,
        }
    }
}

fn setpoint(cycle: i64, x: f64, velocity: f64) -> AxisSetpoint {
    let at = |x| AxisVector::from_values([x, START[1], START[2]]);
    let zero = nalgebra::Vector3::zeros();
    let still = AxisVector::zeros(3);
    let velocity = AxisVector::from_values([velocity, 0.0, 0.0]);
    AxisSetpoint {
        m_call: None,
        time_ns: cycle * CYCLE_NS,
        place: Place::default(),
        axes: AxisMotion { position: at(x), velocity, acceleration: still },
        tool: ToolMotion {
            pose: Pose { position: nalgebra::point![x, 0.0, 0.0], direction: 0.0 },
            velocity: zero,
            acceleration: zero,
            direction_velocity: 0.0,
            direction_acceleration: 0.0,
        },
        path_velocity: 0.0,
        feed: None,
        probing: false,
        tappets: TappetBits::default(),
        switches: 0,
    }
}

/// Plans rest at the start for a number of cycles.
fn plan_rest(hardware: &mut Hardware, cycles: i64) {
    for cycle in 0..=cycles {
        hardware.command(&setpoint(cycle, START[0], 0.0)).unwrap();
    }
}

/// Drives that follow a minute of rest at the start.
fn following(strings: Strings) -> (Hardware, Arc<Strings>) {
    let (mut hardware, strings) = start(strings);
    approach(&mut hardware).unwrap();
    plan_rest(&mut hardware, 60_000);
    hardware.follow(Clock::start());
    (hardware, strings)
}

fn motion(position: f64, velocity: f64) -> IncrementMotion {
    IncrementMotion { position: [position; MAX_DRIVE_AXES], velocity: [velocity; MAX_DRIVE_AXES] }
}

#[test]
fn a_stream_rests_at_the_start_until_something_is_planned() {
    let stream = Stream::new([7.0; MAX_DRIVE_AXES], CYCLE_NS);
    for time_ns in [i64::MIN / 2, -1, 0, 1, i64::MAX] {
        assert_eq!(stream.at(time_ns), motion(7.0, 0.0));
    }
    assert_eq!((stream.now_ns(), stream.end_ns()), (-1, 0));
    stream.start(Clock::start());
    assert!(stream.now_ns() >= 0);
    assert_eq!(stream.horizon_ns(), HORIZON_NS);
}

#[test]
fn a_stream_is_interpolated_between_cycles_and_rests_at_its_ends() {
    let stream = Stream::new([0.0; MAX_DRIVE_AXES], CYCLE_NS);
    for (cycle, position, velocity) in [(0, 10.0, 0.0), (1, 20.0, 10.0), (2, 40.0, 20.0)] {
        stream.push(cycle * CYCLE_NS, motion(position, velocity));
    }
    assert_eq!(stream.at(0), motion(10.0, 0.0));
    assert_eq!(stream.at(CYCLE_NS / 4), motion(12.5, 2.5));
    assert_eq!(stream.at(CYCLE_NS), motion(20.0, 10.0));
    assert_eq!(stream.at(CYCLE_NS * 3 / 2), motion(30.0, 15.0));
    assert_eq!(stream.at(-CYCLE_NS), motion(10.0, 0.0));
    assert_eq!(stream.at(2 * CYCLE_NS), motion(40.0, 0.0));
    assert_eq!(stream.at(i64::MAX), motion(40.0, 0.0));
    assert_eq!(stream.end_ns(), 2 * CYCLE_NS);
}

#[test]
fn a_stream_is_replaced_behind_an_instant() {
    let stream = Stream::new([0.0; MAX_DRIVE_AXES], CYCLE_NS);
    for cycle in 0..3000 {
        stream.push(cycle * CYCLE_NS, motion(10.0 * cycle as f64, 1e4));
    }
    // Also what has been forgotten at the front counts.
    let rest = [29_908.0, 29_912.0].map(|position| motion(position, 0.0));
    stream.replace(2990 * CYCLE_NS, rest.into_iter());
    assert_eq!(stream.end_ns(), 2992 * CYCLE_NS);
    for (cycle, position) in [(2989, 29_890.0), (2990, 29_900.0), (2991, 29_908.0)] {
        let found = stream.at(cycle * CYCLE_NS).position.first().copied().unwrap();
        assert!((found - position).abs() < 1e-9, "{cycle}: {found}");
    }
    assert_eq!(stream.at(5000 * CYCLE_NS), motion(29_912.0, 0.0));
    // Nothing left to do: it rests where it is.
    stream.replace(2989 * CYCLE_NS, std::iter::empty());
    assert_eq!(stream.at(2990 * CYCLE_NS), motion(29_890.0, 0.0));
}

#[test]
fn a_stream_forgets_what_is_long_past() {
    let stream = Stream::new([0.0; MAX_DRIVE_AXES], CYCLE_NS);
    let cycles = 100_000;
    for cycle in 0..cycles {
        stream.push(cycle * CYCLE_NS, motion(cycle as f64, 1000.0));
    }
    assert_eq!(stream.end_ns(), (cycles - 1) * CYCLE_NS);
    assert_eq!(stream.at((cycles - 500) * CYCLE_NS), motion(99_500.0, 1000.0));
    // A second and the horizon are kept; before that there is only the oldest that is known.
    let oldest = stream.at(0).position[0];
    assert!((98_700.0..98_800.0).contains(&oldest), "{oldest}");
}

#[test]
fn the_drives_come_to_the_start_follow_and_rest_at_the_end() {
    let (mut hardware, strings) = start(Strings::default());
    approach(&mut hardware).unwrap();
    // 30 mm in X and back, ending where it began. The axes set out late, as real ones do: after 30 ms at rest where
    // they will rest in the end.
    let path = |cycle: i64| 0.1 + 0.001 * (30 - (cycle - 60).abs()).max(0) as f64;
    for cycle in 0..=90 {
        let velocity = if (30..90).contains(&cycle) { 1.0 } else { 0.0 };
        hardware.command(&setpoint(cycle, path(cycle), velocity)).unwrap();
    }
    hardware.follow(Clock::start());
    hardware.finish(false);
    let (heard, error) = listen(&mut hardware);
    assert!(error.is_none(), "{error:?}");
    assert!(!hardware.is_running());
    let last = heard.last().unwrap();
    assert!(last.time_ns >= 90 * CYCLE_NS, "the end at 90 ms was not waited for: {last:?}");
    // In m and rad again; half an increment of 320 per mm is 1.6 µm.
    for (position, wanted) in last.position.iter().zip(START) {
        assert!((position - wanted).abs() < 2e-6, "{last:?}");
    }
    assert_eq!(strings.soft_stops.load(Ordering::SeqCst), 0);
}

#[test]
fn a_device_that_does_not_answer_is_an_error_of_the_approach() {
    let (mut hardware, _) = start(Strings { probe_fails: true, ..Strings::default() });
    assert!(matches!(approach(&mut hardware), Err(HardwareError::Drive { .. })));
    let (mut hardware, strings) =
        start(Strings { samples_fail_from: Some(1), ..Strings::default() });
    assert!(matches!(approach(&mut hardware), Err(HardwareError::Drive { .. })));
    drop(hardware);
    assert!(strings.stopped.load(Ordering::SeqCst));
    // Waiting for the session, too.
    let (mut hardware, _) = start(Strings { samples_fail_from: Some(50), ..Strings::default() });
    approach(&mut hardware).unwrap();
    let (_, error) = listen(&mut hardware);
    assert!(matches!(error, Some(HardwareError::Drive { .. })), "{error:?}");
    // An error is reported once; after it there is nothing.
    assert!(matches!(hardware.feedback(), Ok(None)));
}

#[test]
fn an_axis_that_does_not_come_to_the_start_is_stuck() {
    let (mut hardware, _) = start(Strings { stuck: true, ..Strings::default() });
    let Err(HardwareError::Stuck { device: _, position, target }) = approach(&mut hardware) else {
        panic!("it cannot be there")
    };
    assert_eq!(position, [0, 0, 0]);
    // 100, −50 and 60 mm at 320, 320 and 640 increments per mm.
    assert_eq!(target, [32_000, -16_000, 38_400]);
}

#[test]
fn a_driver_that_panics_is_reported_and_its_device_stopped() {
    let (mut hardware, strings) = following(Strings { follow_panics: true, ..Strings::default() });
    let (_, error) = listen(&mut hardware);
    assert!(
        matches!(&error, Some(HardwareError::Panicked { device }) if device == "board"),
        "{error:?}"
    );
    hardware.abandon();
    assert_eq!(hardware.not_stopped(), [""; 0]);
    assert_eq!(strings.soft_stops.load(Ordering::SeqCst), 1);
}

/// A device that does not stop is reported as such, also if the user has given up on the way to the start.
#[test]
fn an_unconfirmed_stop_is_reported() {
    let strings = Strings { probe_fails: true, goes_on: true, ..Strings::default() };
    let (mut hardware, _) = start(strings);
    assert!(approach(&mut hardware).is_err());
    hardware.abandon();
    let error = hardware.not_stopped();
    assert_eq!(error.len(), 1, "{error:?}");
    assert!(error[0].starts_with("device `board`, axes X, Y, Z: puppet, address 1"), "{error:?}");
}

/// A status that shows "moving" after a confirmed stop keeps nobody waiting for ever: a hard stop comes, and where that changes
/// nothing either the state of the axes is reported as unknown.
#[test]
fn axes_that_move_on_after_a_confirmed_stop_are_stopped_hard() {
    let both = [1, u32::MAX].map(|most| {
        let strings = Strings { moves_until: Some(most), ..Strings::default() };
        let (mut hardware, strings) = following(strings);
        hardware.stop();
        (hardware, strings)
    });
    let reported = both.map(|(mut hardware, strings)| {
        let (_, error) = listen(&mut hardware);
        let Some(HardwareError::Moves { device, waited_s: 10.. }) = &error else {
            panic!("{error:?}")
        };
        assert_eq!(device, "board");
        hardware.abandon();
        assert_eq!(strings.soft_stops.load(Ordering::SeqCst), 1);
        assert_eq!(strings.hard_stops.load(Ordering::SeqCst), 1);
        hardware.not_stopped().to_vec()
    });
    let [rests, moves] = reported;
    assert_eq!(rests, [""; 0]);
    assert_eq!(moves.len(), 1, "{moves:?}");
    assert!(
        moves[0].starts_with("device `board`: it has confirmed a stop, and reports motion"),
        "{moves:?}"
    );
}

#[test]
fn outputs_that_nobody_switches_are_reported() {
    let (word, waits): (SyncSender<()>, _) = sync_channel(1);
    let (mut hardware, strings) =
        following(Strings { follow_waits: Some(Mutex::new(waits)), ..Strings::default() });
    // While the driver waits for its device, at most 64 wait.
    (0..32).for_each(|_| hardware.switch(&[1], &[2], 0));
    assert!(hardware.feedback().is_ok() && !hardware.has_switched());
    hardware.switch(&[3], &[], 0);
    let error = hardware.feedback().map(|_| ()).unwrap_err();
    assert!(
        matches!(&error, HardwareError::Outputs { device, output: 3, .. } if device == "board"),
        "{error}"
    );
    drop(word);
    drop(hardware);
    assert!(strings.outputs.lock().unwrap().iter().all(|(output, _)| *output != 3));
}

/// The first device takes its time to stop; the second is stopped meanwhile.
#[test]
fn devices_are_stopped_at_once_not_one_after_the_other() {
    let other = "[[drives]]\nname = \"other\"\nkind = \"interpcnc\"\n\n[[drives]]";
    let text = GANTRY3
        .replacen("[[drives]]", other, 1)
        .replace("drive = \"board\"\ndrive_axis = \"X\"", "drive = \"other\"\ndrive_axis = \"X\"");
    let machine = Machine::parse(Path::new("machine.toml"), &text).unwrap();
    let (word, waits): (SyncSender<()>, _) = sync_channel(1);
    let slow = Strings { stop_waits: Some(Mutex::new(waits)), ..Strings::default() };
    let [slow, quick] = [slow, Strings::default()].map(Arc::new);
    let drives = [(&slow, 1), (&quick, 2)].into_iter().enumerate();
    let drives = drives.map(|(device, (strings, axes))| {
        let strings = Arc::clone(strings);
        let puppet = Puppet { strings, axes, position: [0; MAX_DRIVE_AXES] };
        Attached { device, drive: Box::new(puppet) }
    });
    let at = AxisVector::from_values(START);
    let mut hardware = Hardware::start(&machine, drives.collect(), &at, CYCLE_NS, 0.25).unwrap();
    approach(&mut hardware).unwrap();
    let dropped = std::thread::Builder::new().spawn(move || drop(hardware)).unwrap();
    // Not before that the first one is let go.
    while !quick.stopped.load(Ordering::SeqCst) {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(!slow.stopped.load(Ordering::SeqCst));
    word.send(()).unwrap();
    dropped.join().unwrap();
    assert!(slow.stopped.load(Ordering::SeqCst));
}

#[test]
fn an_error_is_reported_before_the_device_is_stopped() {
    let (word, waits): (SyncSender<()>, _) = sync_channel(1);
    let strings = Strings {
        samples_fail_from: Some(5),
        stop_waits: Some(Mutex::new(waits)),
        ..Strings::default()
    };
    let (mut hardware, strings) = start(strings);
    approach(&mut hardware).unwrap();
    let error = first_error(&mut hardware);
    assert!(matches!(error, HardwareError::Drive { .. }));
    assert!(!strings.stopped.load(Ordering::SeqCst), "reported only after the stop");
    assert!(hardware.is_running());
    word.send(()).unwrap();
    drop(hardware);
    assert!(strings.stopped.load(Ordering::SeqCst));
}

#[test]
fn a_stop_brakes_whatever_is_under_way_and_stays_asked_for() {
    let (mut hardware, strings) = following(Strings::default());
    hardware.stop();
    hardware.finish(false);
    let (_, error) = listen(&mut hardware);
    assert!(error.is_none(), "{error:?}");
    assert_eq!(strings.soft_stops.load(Ordering::SeqCst), 1);

    // Also before there is anything to follow.
    let (mut hardware, strings) = start(Strings::default());
    hardware.stop();
    let (_, error) = listen(&mut hardware);
    assert!(error.is_none() && !hardware.is_running(), "{error:?}");
    hardware.follow(Clock::start());
    assert_eq!(strings.followed.load(Ordering::SeqCst), 0);
}

#[test]
fn drives_that_nobody_listens_to_are_brought_to_rest() {
    let (hardware, strings) = following(Strings::default());
    // A puppet answers at once: samples soon fill the channel, and the thread waits for the session.
    while strings.followed.load(Ordering::SeqCst) < 1025 {
        std::thread::sleep(Duration::from_millis(1));
    }
    drop(hardware);
    assert!(strings.stopped.load(Ordering::SeqCst));
}

#[test]
fn drives_whose_plan_runs_dry_brake_and_say_so() {
    let (mut hardware, strings) = start(Strings::default());
    approach(&mut hardware).unwrap();
    plan_rest(&mut hardware, 50);
    hardware.follow(Clock::start());
    // The session is kept waiting: no set-points after 50 ms, and no word that those were the last.
    let (_, error) = listen(&mut hardware);
    assert!(matches!(error, Some(HardwareError::Starved { .. })), "{error:?}");
    drop(hardware);
    assert_eq!(strings.soft_stops.load(Ordering::SeqCst), 1);
}

#[test]
fn a_start_beyond_the_counters_is_refused() {
    let puppet = Puppet { strings: Arc::default(), axes: 3, position: [0; MAX_DRIVE_AXES] };
    let far = AxisVector::from_values([0.0, -7000.0, 0.0]);
    let refused = Hardware::start(&machine(), only(puppet), &far, CYCLE_NS, 0.25);
    match refused {
        Err(error) => assert_eq!(error.to_string(), BEYOND),
        Ok(hardware) => panic!("{hardware:?}"),
    }
}

/// 2^31 − 1 increments by 320 per mm.
const BEYOND: &str = "device `board`: axis Y at -7000000 mm is beyond what its drive counts: at most 2147483647 increments, \
                      which are 6710886.396875 mm, either way";

/// No axis of any device gets a set-point that one of them cannot count.
#[test]
fn a_setpoint_beyond_the_counters_is_refused_and_sent_to_no_axis() {
    let (mut hardware, _strings) = start(Strings::default());
    approach(&mut hardware).unwrap();
    for cycle in 0..=500 {
        hardware.command(&setpoint(cycle, START[0], 0.0)).unwrap();
    }
    let mut far = setpoint(501, START[0] + 1e-5, 0.01);
    far.axes.position = AxisVector::from_values([START[0] + 1e-5, -7000.0, START[2]]);
    assert_eq!(hardware.command(&far).unwrap_err().to_string(), BEYOND);
    // Of another plan what can be counted, and then the error.
    hardware.follow(Clock::start());
    let good = setpoint(501, START[0] + 1e-5, 0.0);
    hardware.replan(500 * CYCLE_NS, &[&good, &far].into_iter());
    // Samples come before and after the error, as this computer has time.
    let (mut heard, error) = listen(&mut hardware);
    assert_eq!(error.expect("an error").to_string(), BEYOND);
    let (later, error) = listen(&mut hardware);
    assert!(error.is_none(), "{error:?}");
    heard.extend(later);
    // On gantry3's 320 increments per mm 10 µm are 3.2: it is at the last place that could be counted.
    assert!((heard.last().unwrap().position[0] - START[0] - 1e-5).abs() < 2e-6);
}

/// Its driver goes on asking, and it may be heard of again: only the session hears of it meanwhile.
#[test]
fn a_silent_device_is_reported_while_its_driver_waits() {
    let (word, waits): (SyncSender<()>, _) = sync_channel(2000);
    let strings = Strings { follow_waits: Some(Mutex::new(waits)), ..Strings::default() };
    let (hardware, strings) = start(strings);
    let mut hardware = hardware.guarded(&machine(), Guarded::Real);
    approach(&mut hardware).unwrap();
    // 30 mm in X.
    for cycle in 0..=3000 {
        hardware.command(&setpoint(cycle, START[0] + 1e-5 * cycle as f64, 0.01)).unwrap();
    }
    hardware.follow(Clock::start());
    hardware.finish(false);
    let error = first_error(&mut hardware);
    let HardwareError::Silent { device, silent_ms, limit_ms, then: None } = &error else {
        panic!("{error}")
    };
    // Beyond two lost answers, and the least.
    assert!(device == "board" && *limit_ms == 300 && *silent_ms > i64::from(*limit_ms), "{error}");
    assert!(hardware.is_running() && strings.followed.load(Ordering::SeqCst) == 0);
    // It answers after all, and brings the axes to the end of the plan.
    drop(word);
    let (heard, error) = listen(&mut hardware);
    assert!(error.is_none(), "{error:?}");
    assert!((heard.last().unwrap().position[0] - START[0] - 0.03).abs() < 2e-6);
    assert_eq!(strings.soft_stops.load(Ordering::SeqCst), 0);
}
