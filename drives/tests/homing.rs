//! Homing by switch on the emulated devices of all families.

use std::{cell::Cell, time::Duration};

use super::bench::{Bench, FAR, HOME, bim2ax, in_every_family, interpcnc};
use twin_drives::{
    Action, Drive, DriveError, Exchange, Identity, Increments, MAX_DRIVE_AXES, ParameterId, Sample,
    SetpointStream, Signals,
    homing::{
        Direction, HomingError, HomingFault, HomingMode, HomingOptions, HomingReport, HomingRun,
        Switch, home_by_switch,
    },
};

/// Position of the reference.
const REFERENCE: i64 = 1000;

/// Where an index pulse would be, going back or on.
const INDEX: [f64; 2] = [-300.0, -1000.0];

/// Slowly 300 increments/s, so that a look takes a few of them; and so fast that the switch is pressed for a second: other
/// tests and builds may keep this one from looking.
fn options(mode: HomingMode) -> HomingOptions {
    HomingOptions {
        #[expect(clippy::cast_precision_loss, reason = "a thousand")]
        home_position: REFERENCE as f64,
        velocity_fast: 500.0,
        mode,
        ..HomingOptions::new(300.0, 20_000.0, 3500.0, 1500.0)
    }
}

fn home(bench: &mut Bench, options: HomingOptions) -> Result<HomingReport, HomingError> {
    let run = HomingRun { axis: 0, switch: bench.home, options };
    // Latched by someone else.
    let index = INDEX[usize::from(options.mode.number() / 4)];
    let mut latched = |_: &Signals, position: f64| {
        let passed = if index > -500.0 { position >= index } else { position <= index };
        passed.then_some(index)
    };
    home_by_switch(&mut *bench.drive, &run, &bench.clock, &mut latched, &|| false)
}

/// The same by a run of one's own, and without an index.
fn home_by(bench: &mut Bench, run: &HomingRun) -> Result<HomingReport, HomingError> {
    home_by_switch(&mut *bench.drive, run, &bench.clock, &mut |_, _| None, &|| false)
}

/// Position of the first axis.
fn position(bench: &mut Bench) -> i64 {
    let sample = bench.drive.sample(&bench.clock).unwrap();
    assert!(!sample.moving);
    assert_eq!(sample.position[1], 77, "the other axis stays");
    sample.position[0]
}

#[expect(clippy::cast_precision_loss, reason = "small positions")]
fn finds_its_reference_in_every_mode(mut bench: Bench) {
    bench.enable();
    // What positions have become more by in all.
    let mut shifted = 0;
    for mode in HomingMode::ALL {
        // From where it stood at first.
        bench.drive.move_to(&[shifted, 0, 0, 0, 0], &[3000.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
        bench.rest();
        let options = options(mode);
        let report = home(&mut bench, options).unwrap();
        let place = report.reference - shifted as f64;
        let reverses = mode.number() < 4;
        let edge = f64::from(if reverses { HOME } else { FAR });
        let sense = if reverses { 1.0 } else { -1.0 };
        let uncertain = options.uncertainty(report.longest_look_ns as f64 * 1e-9) + 2.0;
        let at = position(&mut bench);
        match mode.number() % 4 {
            0 => assert!((place - edge).abs() <= uncertain, "{mode:?}: {report:?}, {uncertain}"),
            1 => {
                assert!((place - edge) * sense >= -2.0, "{mode:?}: {report:?}");
                assert_eq!(at, REFERENCE);
            }
            _ => {
                let index = INDEX[usize::from(!reverses)];
                assert!((report.reference - index).abs() < f64::EPSILON, "{mode:?}: {report:?}");
            }
        }
        // Its distance to the reference is as it was before that was declared.
        let before = (at - report.shift) as f64;
        let away = (at - REFERENCE) as f64 - (before - report.reference);
        assert!(away.abs() <= 0.5, "{mode:?}: {report:?}, {at}");
        shifted += report.shift;
        if mode.number() % 4 == 1 {
            // Indices are in the count of the mechanics.
            let mut back = bench.drive.sample(&bench.clock).unwrap().position;
            back[0] -= shifted;
            bench.drive.set_position(&back).unwrap();
            shifted = 0;
        }
    }
}

fn ends_where_it_should(mut bench: Bench) {
    bench.enable();
    // No further than the user says: here the switch does not come.
    let short = HomingOptions { max_fast_way: 200.0, ..options(HomingMode::default()) };
    let error = home(&mut bench, short).unwrap_err();
    let travel = |error: &HomingFault| matches!(error, HomingFault::Travel { travel, .. } if (*travel - 200.0).abs() < 1.0);
    assert!(matches!(&error, HomingError::Axis { axis: 0, error } if travel(error)), "{error}");
    assert_eq!(position(&mut bench), -200);
    // A switch in the wrong direction.
    let wrong = HomingOptions { direction: Direction::Positive, ..short };
    assert!(home(&mut bench, wrong).is_err());
    assert_eq!(position(&mut bench), 0);
    // A request in the middle of the way.
    let looks = Cell::new(0);
    let run = HomingRun { axis: 0, switch: bench.home, options: options(HomingMode::default()) };
    let abort = || {
        looks.set(looks.get() + 1);
        looks.get() > 3
    };
    let stopped = home_by_switch(&mut *bench.drive, &run, &bench.clock, &mut |_, _| None, &abort);
    assert!(matches!(stopped, Err(HomingError::Aborted { axis: 0 })), "{stopped:?}");
    let at = position(&mut bench);
    assert!(at <= 0, "{at}");
    // Onwards from there, and back to zero.
    let back = HomingOptions { return_to_zero: true, ..options(HomingMode::default()) };
    home(&mut bench, back).unwrap();
    assert_eq!(position(&mut bench), 0);
    // Nothing moves where something is wrong.
    let none = Switch::Input { number: 60, pressed: true };
    let run = HomingRun { switch: none, ..run };
    let error = home_by(&mut bench, &run);
    assert!(matches!(error, Err(HomingError::NoSwitch { .. })), "{error:?}");
    let zero = HomingOptions { velocity_slow: 0.0, ..options(HomingMode::default()) };
    let error = home(&mut bench, zero).unwrap_err();
    assert!(matches!(error, HomingError::Axis { error, .. } if error.number() == Some(50)));
    bench.drive.move_to(&[-300, 0, 0, 0, 0], &[300.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
    let error = home(&mut bench, options(HomingMode::default())).unwrap_err();
    assert!(matches!(error, HomingError::Moving { axis: 0 }), "{error}");
    let at = position(&mut bench);
    assert!((-300..=0).contains(&at), "it has been stopped");
}

/// The limit switch is the home switch: `bIgnoreHWLimit`.
#[expect(clippy::cast_precision_loss, reason = "small positions")]
fn homes_on_a_limit_switch(mut bench: Bench) {
    bench.enable();
    let ignoring = HomingOptions {
        ignore_hardware_limit: true,
        velocity_fast: 1500.0,
        ..options(HomingMode::default())
    };
    let run = HomingRun { axis: 0, switch: Switch::NegativeLimit, options: ignoring };
    let report = home_by(&mut bench, &run).unwrap();
    let uncertain = ignoring.uncertainty(report.longest_look_ns as f64 * 1e-9) + 2.0;
    let away = report.reference - f64::from(bench.limit);
    assert!(away.abs() <= uncertain, "{report:?}, {uncertain}");
    let off = bench.drive.signals(&|| 0).unwrap().axes[0].negative_limit;
    assert_eq!(off, Some(false));
    // Watched, it ends homing.
    let options = HomingOptions { ignore_hardware_limit: false, ..ignoring };
    let run = HomingRun { options, ..run };
    let failed = home_by(&mut bench, &run);
    let found = match &failed {
        Err(HomingError::Drive(error)) => error.is_limit_switch(),
        Err(HomingError::Axis { error, .. }) => error.number() == Some(10),
        _ => false,
    };
    assert!(found, "{failed:?}");
}

/// A device whose wire is cut, all of a sudden.
struct Cut {
    drive: Box<dyn Drive>,
    /// Where its first axis was seen last.
    seen: i64,
    /// From this position on nothing gets through any more, downwards.
    at: i64,
    lost: bool,
}

impl Cut {
    fn live(&mut self) -> Result<&mut dyn Drive, DriveError> {
        if self.lost {
            let at = Exchange { port: "wire".into(), address: 3, action: Action::ReadState };
            return Err(DriveError::Timeout { at, deadline: Duration::from_millis(7) });
        }
        Ok(&mut *self.drive)
    }
}

impl Drive for Cut {
    fn describe(&self) -> String {
        self.drive.describe()
    }

    fn axis_count(&self) -> usize {
        self.drive.axis_count()
    }

    fn identity(&mut self) -> Result<Identity, DriveError> {
        self.live()?.identity()
    }

    fn probe(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        self.live()?.probe(stream)
    }

    fn enable(&mut self) -> Result<(), DriveError> {
        self.live()?.enable()
    }

    fn signals(&mut self, clock: &dyn twin_drives::Clock) -> Result<Signals, DriveError> {
        self.live()?.signals(clock)
    }

    fn set_output(&mut self, output: u8, on: bool) -> Result<(), DriveError> {
        self.live()?.set_output(output, on)
    }

    fn set_position(&mut self, position: &Increments) -> Result<(), DriveError> {
        self.live()?.set_position(position)
    }

    fn move_to(
        &mut self,
        target: &Increments,
        speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), DriveError> {
        self.live()?.move_to(target, speed)
    }

    fn retargets(&self) -> bool {
        self.drive.retargets()
    }

    fn sample(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        let sample = self.live()?.sample(stream)?;
        self.seen = sample.position[0];
        self.lost = self.seen <= self.at;
        Ok(sample)
    }

    fn follow(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        self.live()?.follow(stream)
    }

    fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.live()?.soft_stop()
    }

    fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.live()?.hard_stop()
    }
}

/// Its way would be 30 s long; without anybody who looks it ends after half a second at most. On its way there are several
/// legs, which are one motion where the device can do that.
#[expect(clippy::cast_possible_truncation, reason = "a thousand")]
fn ends_with_its_leg_where_nobody_looks(mut bench: Bench) {
    bench.enable();
    let (clock, limit) = (bench.clock, bench.limit);
    let mut cut = Cut { drive: bench.drive, seen: 0, at: -1100, lost: false };
    // The home switch is passed at 800 increments/s as if its wire were lost: another input is looked at.
    let options = HomingOptions {
        velocity_fast: 800.0,
        max_fast_way: 24_000.0,
        ..options(HomingMode::default())
    };
    let leg = options.longest_leg();
    assert!((leg - 400.0).abs() < 1e-9);
    let run = HomingRun { axis: 0, switch: UNUSED, options };
    let failed = home_by_switch(&mut cut, &run, &clock, &mut |_, _| None, &|| false).unwrap_err();
    assert!(matches!(failed, HomingError::NotStopped { .. }), "{failed}");
    // The wire is whole again, and the axis is no further than it was sent.
    let seen = cut.seen;
    cut.lost = false;
    cut.at = i64::MIN;
    while cut.sample(&clock).unwrap().moving {}
    let end = cut.seen;
    assert!((seen - leg as i64..=seen).contains(&end), "seen at {seen}, at rest at {end}");
    assert!(end > i64::from(limit), "{end}: a switch has stopped it");
}

/// An input that nothing is wired to.
const UNUSED: Switch = Switch::Input { number: 1, pressed: true };

/// The limit switch of X is known to the board by parameters 104 and 105.
fn interpcnc_with_limit() -> Bench {
    let mut bench = interpcnc();
    bench.drive.set_parameter(ParameterId { address: 0, number: 104 }, 8).unwrap();
    bench
}

#[test]
fn legs_end_where_nobody_looks() {
    in_every_family(interpcnc, ends_with_its_leg_where_nobody_looks);
}

#[test]
fn every_family_homes_in_every_mode() {
    in_every_family(interpcnc, finds_its_reference_in_every_mode);
}

#[test]
fn homing_ends_where_it_should() {
    in_every_family(interpcnc, ends_where_it_should);
}

#[test]
fn every_family_homes_on_a_limit_switch() {
    in_every_family(interpcnc_with_limit, homes_on_a_limit_switch);
}

#[test]
fn an_axis_that_does_not_stop_is_reported_with_the_first_error() {
    let mut bench = bim2ax();
    bench.enable();
    // The wire is cut after the first look, and then somebody asks for an end.
    let mut cut = Cut { drive: bench.drive, seen: 0, at: 0, lost: false };
    let run = HomingRun { axis: 0, switch: bench.home, options: options(HomingMode::ALL[0]) };
    let error =
        home_by_switch(&mut cut, &run, &bench.clock, &mut |_, _| None, &|| true).unwrap_err();
    assert_eq!(
        error.to_string(),
        "homing of axis 1: stopped on request; and the axis could not be stopped: wire, address 3: reading status and \
         positions: no answer within 7 ms; use the emergency stop"
    );
    let none = HomingError::NoSwitch { axis: 0, switch: Switch::Home }.to_string();
    let said = "homing of axis 1: the device does not show which input its home switch is at";
    assert_eq!(none, said);
}
