//! The sequence with an axis made of a few lines, whose edges are known.

use proptest::prelude::*;

use super::*;

/// An axis that goes at constant speed and stops at once or after a way; its switch is pressed from `low` to `high`.
#[derive(Default)]
struct Axis {
    position: f64,
    target: f64,
    velocity: f64,
    time_ns: i64,
    look_ns: i64,
    /// Way that it takes to stop.
    coasts: f64,
    low: f64,
    high: f64,
    /// The switch tells what was so long ago.
    delay_ns: i64,
    was: Vec<(i64, f64)>,
    index: Option<f64>,
    limit: Option<(f64, bool)>,
    extremes: (f64, f64),
}

impl Axis {
    fn new() -> Self {
        Self {
            velocity: 1.0,
            look_ns: 1_000_000,
            coasts: 2.0,
            low: -60.0,
            high: -40.0,
            was: vec![(i64::MIN, 0.0)],
            ..Self::default()
        }
    }

    fn advance(&mut self, for_ns: i64) {
        #[expect(clippy::cast_precision_loss, reason = "milliseconds")]
        let way = self.velocity * for_ns as f64 * 1e-9;
        let left = self.target - self.position;
        self.position += left.clamp(-way, way);
        self.time_ns += for_ns;
        self.was.push((self.time_ns, self.position));
        let (low, high) = self.extremes;
        self.extremes = (low.min(self.position), high.max(self.position));
    }

    fn pressed(&self) -> bool {
        let then_ns = self.time_ns - self.delay_ns;
        let after = self.was.partition_point(|(time, _)| *time <= then_ns);
        let (_, position) = self.was[after - 1];
        (self.low..self.high).contains(&position)
    }

    /// Looks at the switch, and half a look later at the position.
    fn look(&mut self, before: f64) -> Seen {
        self.advance(self.look_ns / 2);
        let (switch_ns, open) = (self.time_ns, !self.pressed());
        self.advance(self.look_ns / 2);
        let passed =
            |index: &f64| (before.min(self.position)..before.max(self.position)).contains(index);
        Seen {
            time_ns: self.time_ns,
            position: self.position,
            moving: (self.target - self.position).abs() > 1e-9,
            switch_ns,
            open,
            index: self.index.filter(passed),
            limit: self.limit.filter(|(place, _)| self.position <= *place).map(|(_, side)| side),
        }
    }

    /// Homes; positions are the new ones afterwards.
    fn home(&mut self, options: &HomingOptions) -> Result<Homing, HomingFault> {
        let mut homing = Homing::new(options)?;
        let mut before = self.position;
        for _ in 0..1_000_000 {
            let seen = self.look(before);
            before = self.position;
            match homing.step(&seen)? {
                Order::Wait => {}
                Order::Go { target, velocity } => (self.target, self.velocity) = (target, velocity),
                Order::Stop => {
                    let left = self.target - self.position;
                    self.target = self.position + left.clamp(-self.coasts, self.coasts);
                }
                Order::Declare { position } => {
                    assert!(!seen.moving);
                    let shift = position - self.position;
                    (self.position, self.target) = (position, position);
                    self.low += shift;
                    self.high += shift;
                    self.was = vec![(i64::MIN, position)];
                    before = position;
                }
                Order::Done => return Ok(homing),
            }
        }
        panic!("it never ends");
    }
}

fn options(mode: HomingMode) -> HomingOptions {
    HomingOptions { home_position: 500.0, mode, ..HomingOptions::new(10.0, 1000.0, 200.0, 80.0) }
}

fn usual() -> HomingOptions {
    options(HomingMode::default())
}

/// What the axis goes slowly between two looks at the switch.
const LOOK: f64 = 0.01 + 1e-9;

#[test]
fn every_mode_finds_its_edge() {
    // Off a switch from −60 to −40: back over −40, or on over −60; the index two further on.
    let cases = [
        (HomingMode::FastBslowSStop, -40.0, 500.0 + 2.0),
        (HomingMode::FastBslowStopS, -38.0, 500.0),
        (HomingMode::FastBslowISStop, -35.0, 500.0 + 2.0),
        (HomingMode::FastSlowSStop, -60.0, 500.0 - 2.0),
        (HomingMode::FastSlowStopS, -62.0, 500.0),
        (HomingMode::FastSlowISStop, -65.0, 500.0 - 2.0),
    ];
    for (mode, reference, position) in cases {
        let mut axis = Axis { index: Some(reference), ..Axis::new() };
        let homing = axis.home(&options(mode)).unwrap();
        assert!((homing.reference().unwrap() - reference).abs() <= LOOK, "{mode:?}");
        assert!((axis.position - position).abs() <= LOOK, "{mode:?}: {}", axis.position);
        // And the edge is where it should be in the new count, but for those that are not of it.
        let edge = if mode.number() < 4 { axis.high } else { axis.low };
        let away = if mode.number() % 4 == 0 { 500.0 } else { edge };
        assert!((edge - away).abs() <= LOOK, "{mode:?}: {edge}");
    }
    let numbers: Vec<_> =
        (0..8).filter(|number| HomingMode::from_number(*number).is_some()).collect();
    assert_eq!(numbers, [0, 1, 2, 4, 5, 6]);
}

#[test]
fn the_other_direction_is_a_mirror() {
    let mut axis = Axis { low: 40.0, high: 60.0, ..Axis::new() };
    let positive = HomingOptions { direction: Direction::Positive, ..usual() };
    let homing = axis.home(&positive).unwrap();
    assert!((homing.reference().unwrap() - 40.0).abs() <= LOOK);
    assert!((axis.position - 498.0).abs() <= LOOK);
}

#[test]
fn a_late_switch_is_corrected() {
    // A third of a second late; slowly that is 3.3 units.
    for (signal_delay, beyond, within) in [(0.0, 3.33, 0.02), (0.333, 0.0, LOOK)] {
        let mut axis = Axis { delay_ns: 333_000_000, low: -150.0, ..Axis::new() };
        let homing = axis.home(&HomingOptions { signal_delay, ..usual() }).unwrap();
        let reference = homing.reference().unwrap();
        assert!((reference + 40.0 - beyond).abs() < within, "{signal_delay} s: {reference}");
    }
}

#[test]
fn an_axis_may_begin_on_its_switch_or_pass_it() {
    let mut on = Axis { position: -50.0, target: -50.0, ..Axis::new() };
    on.was = vec![(i64::MIN, -50.0)];
    let homing = on.home(&usual()).unwrap();
    assert!((homing.reference().unwrap() + 40.0).abs() <= LOOK);
    assert!(on.extremes.0 >= -50.0, "it did not go fast");
    // Braking takes it over the switch and beyond.
    let mut past = Axis { coasts: 30.0, ..Axis::new() };
    let homing = past.home(&usual()).unwrap();
    assert!(past.extremes.0 < -60.0);
    assert!((homing.reference().unwrap() + 40.0).abs() <= LOOK, "it came back");
    let mut past = Axis { coasts: 30.0, ..Axis::new() };
    let error = past.home(&options(HomingMode::FastSlowSStop)).unwrap_err();
    assert!(matches!(error, HomingFault::SwitchPassed { .. }), "{error}");
}

#[test]
fn it_goes_no_further_than_it_may() {
    let mut axis = Axis { low: -1e9, high: -300.0, ..Axis::new() };
    let error = axis.home(&usual()).unwrap_err();
    let expected = HomingFault::Travel { what: "the home switch", from: 0.0, travel: 200.0 };
    assert_eq!((error, axis.extremes), (expected, (-200.0, 0.0)));
    // A switch that stays closed.
    let mut axis = Axis { low: -1e9, high: 1e9, ..Axis::new() };
    let error = axis.home(&usual()).unwrap_err();
    assert!(matches!(error, HomingFault::Travel { what: "the edge of the home switch", .. }));
    assert_eq!((axis.extremes, usual().longest_ways()), ((0.0, 80.0), (200.0, 80.0)));
    // No index.
    let mut axis = Axis::new();
    let forwards = options(HomingMode::FastSlowISStop);
    let error = axis.home(&forwards).unwrap_err();
    assert!(matches!(error, HomingFault::Travel { what: "the index pulse", .. }), "{error}");
    let (forth, back) = forwards.longest_ways();
    assert!(axis.extremes.0 >= -forth && back.abs() < f64::EPSILON);
}

#[test]
fn limit_switches_end_it_unless_they_are_ignored() {
    let mut axis = Axis { limit: Some((-41.0, false)), ..Axis::new() };
    let error = axis.home(&usual()).unwrap_err();
    assert!(matches!(error, HomingFault::HardwareLimit { positive: false, .. }), "{error}");
    let mut axis = Axis { limit: Some((-41.0, false)), ..Axis::new() };
    let ignoring = HomingOptions { ignore_hardware_limit: true, ..usual() };
    assert!(axis.home(&ignoring).is_ok());
    // Error 51 for the modes that go on over the switch.
    for mode in HomingMode::ALL {
        let error = HomingOptions { mode, ..ignoring }.check().err();
        assert_eq!(error.and_then(|error| error.number()), (mode.number() >= 4).then_some(51));
    }
}

#[test]
fn it_returns_to_zero() {
    let mut axis = Axis::new();
    let back = HomingOptions { return_to_zero: true, ..usual() };
    axis.home(&back).unwrap();
    assert!(axis.position.abs() < 1e-9);
    assert!((axis.high - 500.0).abs() <= LOOK, "{}", axis.high);
}

/// 50, `SMC_3SH_INVALID_VELACC_VALUES`.
#[test]
fn impossible_values_are_refused() {
    let good = usual();
    assert_eq!(good.check(), Ok(()));
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for wrong in [
            HomingOptions { velocity_slow: value, ..good },
            HomingOptions { velocity_fast: value, ..good },
            HomingOptions { acceleration: value, ..good },
            HomingOptions { deceleration: value, ..good },
            HomingOptions { max_fast_way: value, ..good },
            HomingOptions { max_slow_way: value, ..good },
        ] {
            assert_eq!(Homing::new(&wrong).unwrap_err().number(), Some(50), "{wrong:?}");
        }
    }
    let late = HomingOptions { signal_delay: -0.1, ..good };
    let nowhere = HomingOptions { home_position: f64::NAN, ..good };
    for wrong in [late, nowhere] {
        assert_eq!(wrong.check().unwrap_err().number(), Some(50), "{wrong:?}");
    }
}

proptest! {
    /// Wherever the switch lies within the way, and however seldom it is looked at, the edge is found to what the axis goes
    /// between two looks.
    #[test]
    fn the_reference_is_as_exact_as_the_looks(
        high in -150.0..-1.0, width in 5.0..70.0, look_ms in 1_i32..40, coasts in 0.0..4.0,
    ) {
        let (look_ns, look_s) = (i64::from(look_ms) * 1_000_000, f64::from(look_ms) * 1e-3);
        let mut axis = Axis { low: high - width, high, look_ns, coasts, ..Axis::new() };
        let options = HomingOptions { velocity_fast: 50.0, ..usual() };
        // Fast it is seen twice at least.
        prop_assume!(width > 2.0 * 50.0 * look_s + coasts);
        let homing = axis.home(&options).unwrap();
        let away = homing.reference().unwrap() - high;
        prop_assert!((-1e-9..=options.uncertainty(look_s)).contains(&away), "{away}");
    }
}
