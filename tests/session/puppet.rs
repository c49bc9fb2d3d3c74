//! Fake drives and machines for rare behaviour of real ones.

use crate::simulated::CIRCLES;
use crate::{GANTRY3, Program, Recorder, machine, portal};
use std::cell::Cell;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use twin::attached::Attached;
use twin::hardware::{Guarded, Hardware, HardwareError};
use twin::plant::{AxisFeedback, Plant};
use twin::session::{Ending, Session, Stopped};
use twin::setpoint::AxisSetpoint;
use twin_drives::{
    Action, Drive, DriveError, Exchange, Identity, Increments, MAX_DRIVE_AXES, Sample,
    SetpointStream,
};
use twin_kinematics::AxisVector;
use twin_machine::Machine;
use twin_physics::PhysicsError;

/// A drive that is where the stream says at any time, and knows that time exactly.
#[derive(Debug, Default)]
pub(super) struct Puppet {
    position: Increments,
    pub(super) soft_stops: Arc<AtomicU32>,
    /// Its position, for others.
    pub(super) found: Arc<Mutex<Increments>>,
    /// Does not answer from then on.
    fails_at_ns: Option<i64>,
    /// From then on it does not answer until the plan rests.
    silent_from_ns: Option<i64>,
    /// From then on its first axis is so many increments off the plan.
    off_from_ns: Option<(i64, i64)>,
    /// Then it is kept waiting once, for so many ms, like everything else of a process that is frozen.
    frozen_at_ns: Option<(i64, u64)>,
    pub(super) outputs: Arc<Mutex<Vec<(u8, bool)>>>,
    /// So many cycles in which it moves and is not there, once it is off the plan: it goes after it.
    chases: Option<u32>,
    /// Confirms no stop.
    deaf: bool,
}

impl Puppet {
    fn stops(&self) -> Result<(), DriveError> {
        if self.deaf { Err(unanswered()) } else { Ok(()) }
    }
}

fn unanswered() -> DriveError {
    let at = Exchange { port: "puppet".into(), address: 1, action: Action::ReadState };
    DriveError::Timeout { at, deadline: Duration::from_millis(1) }
}

impl Drive for Puppet {
    fn describe(&self) -> String {
        "a puppet".to_owned()
    }

    fn axis_count(&self) -> usize {
        3
    }

    fn identity(&mut self) -> Result<Identity, DriveError> {
        Ok(Identity { family: "puppet", units: Vec::new() })
    }

    fn probe(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        self.sample(stream)
    }

    fn enable(&mut self) -> Result<(), DriveError> {
        Ok(())
    }

    fn set_output(&mut self, output: u8, on: bool) -> Result<(), DriveError> {
        self.outputs.lock().unwrap().push((output, on));
        Ok(())
    }

    fn set_position(&mut self, position: &Increments) -> Result<(), DriveError> {
        self.position = *position;
        Ok(())
    }

    fn move_to(
        &mut self,
        target: &Increments,
        _speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), DriveError> {
        self.position = *target;
        Ok(())
    }

    fn sample(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        Ok(Sample { time_ns: stream.now_ns(), position: self.position, moving: false })
    }

    fn follow(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        // Not at once: an exchange takes its time.
        std::thread::sleep(Duration::from_millis(3));
        let time_ns = stream.now_ns();
        if self.fails_at_ns.is_some_and(|fails_at_ns| time_ns >= fails_at_ns) {
            return Err(unanswered());
        }
        if self.silent_from_ns.is_some_and(|from_ns| time_ns >= from_ns) {
            let rests = |velocity: &f64| velocity.abs() < 1e-9;
            // A program that is not stopped rests at its end.
            while !stream.at(stream.now_ns()).velocity.iter().all(rests) {
                std::thread::sleep(Duration::from_millis(1));
            }
            self.silent_from_ns = None;
        }
        if let Some((_, ms)) = self.frozen_at_ns.take_if(|(at_ns, _)| time_ns >= *at_ns) {
            std::thread::sleep(Duration::from_millis(ms));
        }
        let time_ns = stream.now_ns();
        let motion = stream.at(time_ns);
        for (position, wanted) in self.position.iter_mut().zip(motion.position) {
            *position = wanted.round() as i64;
        }
        let off_ns = self.off_from_ns.filter(|(from_ns, _)| time_ns >= *from_ns);
        if let Some((_, off)) = off_ns {
            self.position[0] += off;
            self.chases = self.chases.map(|cycles| cycles.saturating_sub(1));
            if self.chases == Some(0) {
                self.off_from_ns = None;
            }
        }
        *self.found.lock().unwrap() = self.position;
        let chases = self.chases.is_some() && off_ns.is_some();
        let moving = chases || motion.velocity.iter().any(|velocity| velocity.abs() > 1.0);
        Ok(Sample { time_ns, position: self.position, moving })
    }

    fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.soft_stops.fetch_add(1, Ordering::SeqCst);
        self.stops()
    }

    fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.stops()
    }
}

/// A machine that is where it is told to be, until it fails.
#[derive(Debug)]
struct Ideal {
    fails_at_ns: i64,
    arrived: Option<AxisFeedback>,
}

impl Plant for Ideal {
    type Error = PhysicsError;

    fn command(&mut self, setpoint: &AxisSetpoint) -> Result<(), PhysicsError> {
        let time_ns = setpoint.time_ns;
        if time_ns >= self.fails_at_ns {
            return Err(PhysicsError::Diverged(time_ns));
        }
        self.arrived = Some(AxisFeedback { time_ns, position: setpoint.axes.position });
        Ok(())
    }

    fn feedback(&mut self) -> Result<Option<AxisFeedback>, PhysicsError> {
        Ok(self.arrived.take())
    }
}

/// Runs `text` on an ideal machine and a puppet; also how often the drive was told to brake.
fn run(
    puppet: Puppet,
    text: &str,
    recorder: &mut Recorder<'_>,
    interrupts: &dyn Fn() -> u32,
) -> (Ending, u32) {
    let soft_stops = Arc::clone(&puppet.soft_stops);
    let ending = run_puppet(&portal(), puppet, &Program::new(text), recorder, interrupts);
    (ending, soft_stops.load(Ordering::SeqCst))
}

/// Runs `program` on an ideal machine and a puppet.
pub(super) fn run_puppet(
    machine: &Machine,
    puppet: Puppet,
    program: &Program,
    recorder: &mut Recorder<'_>,
    interrupts: &dyn Fn() -> u32,
) -> Ending {
    let start = program.check(machine).start.unwrap();
    run_from(&start, machine, puppet, program, recorder, interrupts)
}

/// The error of drives that have stopped a run.
#[track_caller]
fn failed(ending: &Ending) -> &HardwareError {
    match &ending.stopped {
        Some(Stopped::Drives { source, .. }) => source,
        other => panic!("{other:?}"),
    }
}

/// Without a check.
pub(super) fn run_from(
    start: &AxisVector,
    machine: &Machine,
    puppet: Puppet,
    program: &Program,
    recorder: &mut Recorder<'_>,
    interrupts: &dyn Fn() -> u32,
) -> Ending {
    let twin = Ideal { fails_at_ns: i64::MAX, arrived: None };
    run_both(start, machine, twin, puppet, program, recorder, interrupts)
}

fn run_both(
    start: &AxisVector,
    machine: &Machine,
    twin: Ideal,
    puppet: Puppet,
    program: &Program,
    recorder: &mut Recorder<'_>,
    interrupts: &dyn Fn() -> u32,
) -> Ending {
    // A computer that is busy keeps even these waiting.
    let guarded = puppet.silent_from_ns.is_some()
        || puppet.frozen_at_ns.is_some()
        || puppet.off_from_ns.is_some() && !puppet.deaf;
    let attached = Attached { device: 0, drive: Box::new(puppet) };
    let mut hardware =
        Hardware::start(machine, vec![attached], start, machine.cycle_ns, 0.25).unwrap();
    if guarded {
        hardware = hardware.guarded(machine, Guarded::Real);
    }
    while !hardware.ready().unwrap() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let session = Session { hardware: Some(hardware), ..program.session(machine, twin) };
    session.run(recorder, interrupts).unwrap()
}

#[test]
fn samples_are_compared_with_what_was_wanted_at_their_time() {
    // However late or early the session looks: half an increment, √(2 · (1/640)²) mm in X and Y, is all that an exact
    // drive is off, and the chord of 0.1 mm on 30 mm.
    let mut recorder = Recorder::new();
    let (ending, soft_stops) =
        run(Puppet::default(), "% circle\nN10 G2 I30 J0 F250 E1500 E-1500\n", &mut recorder, &|| 0);
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(soft_stops, 0);
    let tool = ending.comparison.tool;
    let (max, place) = tool.drives.maximum().unwrap();
    assert!(max > 0.0 && max < 2.5e-6, "{max} m at {place}");
    let (max, _) = tool.drives_against_twin.maximum().unwrap();
    assert!(max < 2.5e-6, "{max} m");
    assert_eq!(tool.twin.maximum().unwrap().0, 0.0);
    assert!(recorder.heard.len() > 20);
    // An ideal machine has no motors.
    assert!(recorder.motors.iter().all(Vec::is_empty));
}

#[test]
fn a_simulated_machine_that_fails_brakes_the_drives() {
    let mut recorder = Recorder::new();
    let puppet = Puppet::default();
    let found = Arc::clone(&puppet.found);
    let soft_stops = Arc::clone(&puppet.soft_stops);
    let (machine, program) = (portal(), Program::new(CIRCLES));
    let start = program.check(&machine).start.unwrap();
    let twin = Ideal { fails_at_ns: 300_000_000, arrived: None };
    let ending = run_both(&start, &machine, twin, puppet, &program, &mut recorder, &|| 0);
    let soft_stops = soft_stops.load(Ordering::SeqCst);
    let Some(stopped @ Stopped::Twin { place, .. }) = &ending.stopped else {
        panic!("{:?}", ending.stopped)
    };
    assert_eq!(place.line, 2);
    assert!(stopped.to_string().contains("diverged"), "{stopped}");
    assert_eq!((soft_stops, ending.off_path.map(|place| place.line)), (0, Some(2)));
    // At 0.3 s, 20 mm along the circle (v·(t − v/2E)), at full speed; then 1.7 mm at most with 3000 mm/s² in X and Y each, and
    // a moment until the session has heard of it.
    let (sin, cos) = (20.0f64 / 30.0).sin_cos();
    let [x, y, ..] = found.lock().unwrap().map(|increments| increments as f64 / 320.0);
    let (x, y) = (x - 30.0 * (1.0 - cos), y - 30.0 * sin);
    let along = x * sin + y * cos;
    assert!(along > 0.5 && along < 8.0, "{x} mm {y} mm");
    // What the drives did after that has nothing to be compared with.
    assert!(ending.comparison.tool.drives_against_twin.maximum().unwrap().0 < 2.5e-6);
}

/// The others would go on without it: everything comes to rest on the path, while its driver goes on asking.
#[test]
fn a_drive_that_keeps_silent_brings_everything_to_rest_on_the_path() {
    let mut recorder = Recorder::new();
    let puppet = Puppet { silent_from_ns: Some(300_000_000), ..Puppet::default() };
    let found = Arc::clone(&puppet.found);
    let (ending, soft_stops) = run(puppet, CIRCLES, &mut recorder, &|| 0);
    let source = failed(&ending);
    assert!(matches!(source, HardwareError::Silent { .. }), "{source}");
    let said = ending.stopped.as_ref().expect("it has failed").to_string();
    assert!(said.contains("device `board` has not answered for"), "{said}");
    // Nobody has left the path, and the drive has come to where it ends.
    assert_eq!((soft_stops, ending.off_path), (0, None));
    recorder.assert_twin_at_rest();
    let last = recorder.last();
    for (found, wanted) in
        found.lock().unwrap().iter().zip([last.wanted.tool.x, last.wanted.tool.y])
    {
        assert!((*found as f64 / 320e3 - wanted).abs() < 2e-6, "{found} {wanted}");
    }
}

#[test]
fn an_axis_that_is_too_far_away_stops_the_run() {
    let mut recorder = Recorder::new();
    // 1 mm of 0.5. Following to the end of the plan it would come there all the same, 0.6 s later, by a way of its own: its device
    // is stopped.
    let off_from_ns = Some((300_000_000, -320));
    let puppet = Puppet { off_from_ns, chases: Some(200), ..Puppet::default() };
    let (ending, soft_stops) = run(puppet, CIRCLES, &mut recorder, &|| 0);
    let said = ending.reason().expect("it has been stopped");
    for part in [
        "failed at line 2 (N10): following-error: axis X is ",
        "at most 0.5000 mm is allowed (max_following_error_mm)",
        "the axes left the path and braked, each at its own limits",
    ] {
        assert!(said.contains(part), "{said}");
    }
    let HardwareError::TooFar { error, limit, .. } = failed(&ending) else { panic!("{said}") };
    // Half an increment beside what it is off.
    assert!((error - 1.0).abs() < 2e-3 && (limit - 0.5).abs() < 1e-12, "{said}");
    assert_eq!((soft_stops, recorder.last().path_velocity), (1, 0.0));
}

/// The plan has ended, and there is none to be changed: a drive that goes after its end is stopped by itself.
#[test]
fn an_axis_that_is_too_far_away_at_the_end_is_stopped() {
    let text = "% 0.2 s\nN10 G1 X10 F100 E1000 E-1000\n";
    // It would get there after six seconds.
    let off_from_ns = Some((200_000_000, -320));
    let puppet = Puppet { off_from_ns, chases: Some(2000), ..Puppet::default() };
    let (ending, soft_stops) = run(puppet, text, &mut Recorder::new(), &|| 0);
    assert!(matches!(failed(&ending), HardwareError::TooFar { .. }), "{:?}", ending.stopped);
    assert_eq!((ending.executed_ns, soft_stops), (200_000_000, 1));
    assert_eq!(ending.not_stopped, [""; 0]);
}

/// Drives that do not come to rest are stopped in the end, and that nothing confirms it is told.
#[test]
fn a_stop_of_unsettled_drives_that_nothing_confirms_is_told() {
    let text = "% 0.2 s\nN10 G1 X10 F100 E1000 E-1000\n";
    // Nobody watches how far it is off.
    let off_from_ns = Some((200_000_000, -320));
    let puppet = Puppet { off_from_ns, chases: Some(u32::MAX), deaf: true, ..Puppet::default() };
    let (ending, soft_stops) = run(puppet, text, &mut Recorder::new(), &|| 0);
    assert!(matches!(ending.stopped, Some(Stopped::Unsettled)), "{:?}", ending.stopped);
    // Asked for by the session, and once more because it was not confirmed.
    assert_eq!(soft_stops, 2);
    assert_eq!(ending.not_stopped.len(), 1, "{:?}", ending.not_stopped);
    assert!(ending.not_stopped[0].starts_with("device `board`, axes X, Y, Z: puppet, address 1"));
    assert!(ending.stopping.is_none());
}

#[test]
fn drives_that_fail_after_the_last_set_point_have_failed() {
    // They are asked for the last time at the end or after it, and say nothing but that they fail.
    let text = "% 0.2 s\nN10 G1 X10 F100 E1000 E-1000\n";
    let puppet = Puppet { fails_at_ns: Some(200_000_000), ..Puppet::default() };
    let (ending, soft_stops) = run(puppet, text, &mut Recorder::new(), &|| 0);
    let stopped = &ending.stopped;
    assert!(matches!(stopped, Some(Stopped::Drives { .. })), "{stopped:?}");
    assert_eq!((ending.executed_ns, soft_stops), (200_000_000, 1));
}

#[test]
fn drives_do_not_leap_after_a_session_that_was_kept_waiting() {
    let waited = Cell::new(false);
    let mut recorder = Recorder::with(|time_ns| {
        if time_ns >= 200_000_000 && !waited.replace(true) {
            // Longer than the drives' plan reaches.
            std::thread::sleep(Duration::from_millis(400));
        }
    });
    let (ending, soft_stops) = run(Puppet::default(), CIRCLES, &mut recorder, &|| 0);
    assert!(matches!(failed(&ending), HardwareError::Starved { .. }), "{:?}", ending.stopped);
    assert_eq!((soft_stops, recorder.last().path_velocity), (1, 0.0));
}

/// A process that is suspended and goes on: whoever is first to wake, no drive follows what is overdue.
#[test]
fn drives_do_not_leap_after_a_process_that_was_frozen() {
    let waited = Cell::new(false);
    let mut recorder = Recorder::with(|time_ns| {
        if time_ns >= 200_000_000 && !waited.replace(true) {
            // Longer than the drives' plan reaches, and not as long as the drive: planning goes on before it looks.
            std::thread::sleep(Duration::from_millis(400));
        }
    });
    let puppet = Puppet { frozen_at_ns: Some((200_000_000, 600)), ..Puppet::default() };
    let found = Arc::clone(&puppet.found);
    // The silence of a drive that nobody listens to is not what is looked for.
    let patient = GANTRY3.replace("start_mm = [0.0, 0.0, 20.0]", "start_mm = [0.0, 0.0, -40.0]");
    let kind = "kind = \"interpcnc\"";
    let patient = patient.replace(kind, &format!("{kind}\nlongest_silence_ms = 2000"));
    let stops = Arc::clone(&puppet.soft_stops);
    let program = Program::new(CIRCLES);
    let ending = run_puppet(&machine(&patient), puppet, &program, &mut recorder, &|| 0);
    let soft_stops = stops.load(Ordering::SeqCst);
    assert!(matches!(failed(&ending), HardwareError::Starved { .. }), "{:?}", ending.stopped);
    assert_eq!((soft_stops, recorder.last().path_velocity), (1, 0.0));
    // At 100 mm/s (500 mm/s²) along the circle of 30 mm: 35 mm at 0.45 s, where its plan ended, and 70 mm at 0.8 s.
    let [x, y, ..] = found.lock().unwrap().map(|increments| increments as f64 / 320.0);
    let along = 30.0 * y.atan2(30.0 - x);
    assert!((5.0..45.0).contains(&along), "{x} mm {y} mm, {along} mm along");
}

#[test]
fn only_the_second_interrupt_brakes_the_drives_off_the_path() {
    for (interrupts, off_path, brakes) in [(1, false, 0), (2, true, 0), (3, true, 1)] {
        let count = Cell::new(0);
        let mut recorder = Recorder::with(|time_ns| {
            if time_ns >= 200_000_000 {
                count.set(interrupts);
            }
        });
        let (ending, soft_stops) = run(Puppet::default(), CIRCLES, &mut recorder, &|| count.get());
        let stopped = &ending.stopped;
        assert!(matches!(stopped, Some(Stopped::Interrupted(_))), "{stopped:?}");
        assert_eq!((ending.off_path.is_some(), soft_stops), (off_path, brakes));
        assert_eq!(recorder.last().path_velocity, 0.0);
    }
}

#[test]
fn an_interrupt_when_everything_is_planned_changes_nothing() {
    let count = Cell::new(0);
    let mut recorder = Recorder::with(|time_ns| count.set(u32::from(time_ns >= 100_000_000)));
    let text = "% 0.2 s\nN10 G1 X10 F100 E1000 E-1000\n";
    let (ending, soft_stops) = run(Puppet::default(), text, &mut recorder, &|| count.get());
    assert!(ending.stopped.is_none(), "{:?}", ending.stopped);
    assert_eq!(soft_stops, 0);
    assert!((recorder.last().wanted.tool - nalgebra::point![0.01, 0.0, -0.04]).norm() < 1e-12);
}
