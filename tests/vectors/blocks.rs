//! Blocks of single axes and gears (manual 2.2, 5.3, 5.4).

use super::vector::check;
use twin_axis::{
    Axis, AxisConfig, Block, Direction, Follow, GearInPos, MoveAbsolute, MoveVelocity, Movement,
    Power, TrackingError, VirtualDrive, atan2, fmod,
};

/// An axis with its drive, and power on.
struct Powered {
    axis: Axis,
    drive: VirtualDrive,
}

impl Powered {
    fn new(cycle: f64, period: Option<f64>, position: f64) -> Self {
        let movement = period.map_or(Movement::Linear, |period| Movement::Rotary { period });
        let axis = Axis::new(AxisConfig { movement, cycle, ..AxisConfig::default() });
        let mut powered = Self { axis, drive: VirtualDrive::new(position) };
        for _ in 0..3 {
            powered.cycle(|_| ());
        }
        powered
    }

    fn cycle<T>(&mut self, blocks: impl FnOnce(&mut Axis) -> T) -> T {
        self.axis.begin_cycle(&self.drive.feedback());
        Power { regulator_on: true, drive_start: true }.call(true, &mut self.axis);
        let shown = blocks(&mut self.axis);
        self.drive.follow(&self.axis.end_cycle());
        shown
    }
}

#[test]
pub(crate) fn direction() {
    check("axis-direction", |vector| {
        let [from, target, period] = ["pos", "target", "period"].map(|name| vector.number(name));
        let limits = 100.0;
        let to = |position, direction| {
            Block::new(MoveAbsolute {
                position,
                velocity: limits,
                acceleration: limits,
                deceleration: limits,
                direction,
            })
        };
        // How far the axis goes from `axis`, and for how long.
        let run = |it: &mut Powered, mut block: Block<MoveAbsolute>| {
            let (mut way, mut cycles, mut before) = (0.0, 0_u32, it.axis.set_position());
            loop {
                let done = it.cycle(|axis| block.call(true, axis)).done;
                let step = it.axis.set_position() - before;
                way += step - period * (step / period).round();
                before = it.axis.set_position();
                cycles += 1;
                if done {
                    return (way, f64::from(cycles) * it.axis.cycle());
                }
            }
        };
        for (name, direction) in [
            ("shortest", Direction::Shortest),
            ("positive", Direction::Positive),
            ("negative", Direction::Negative),
        ] {
            let mut it = Powered::new(0.01, Some(period), from);
            let (way, _) = run(&mut it, to(target, direction));
            vector.expect(name, [way]);
        }
        // From 0 with +100 u/s to 340. A time in whole cycles is at most one cycle more than the exact one.
        let cycle = 1e-4;
        let moving = || {
            let mut it = Powered::new(cycle, Some(period), 0.0);
            let mut endless = Block::new(MoveVelocity {
                velocity: limits,
                acceleration: limits,
                deceleration: limits,
                direction: Direction::Positive,
            });
            while !it.cycle(|axis| endless.call(true, axis)).done {}
            it.axis.shift_zero(0.0, false).expect("a number");
            it
        };
        let exact = |name: &str, direction| {
            let mut it = moving();
            let mut block = to(340.0, direction);
            it.cycle(|axis| block.call(true, axis));
            let planned = block.running().expect("it runs").duration();
            vector.expect(name, [planned]);
            let (way, time) = run(&mut moving(), to(340.0, direction));
            assert!((planned..planned + cycle * 1.001).contains(&time), "{planned} {time}");
            way
        };
        let positive = exact("fastest/t_positive", Direction::Positive);
        let negative = exact("fastest/t_negative", Direction::Negative);
        let (fastest, _) = run(&mut moving(), to(340.0, Direction::Fastest));
        let chosen = if (fastest - negative).abs() < 1e-6 { "negative" } else { "positive" };
        assert!((positive - negative - period).abs() < 1e-6);
        vector.expect_word("fastest/chosen", chosen);
    });
}

#[test]
pub(crate) fn conversions() {
    check("axis-units", |vector| {
        vector.expect("fmod", [fmod(-30.0, 360.0)]);
        vector.expect("atan2", [atan2(-1.0, 0.0)]);
    });
}

#[test]
pub(crate) fn gear_in_position() {
    check("gear-in-pos", |vector| {
        let sync = vector.numbers("sync");
        let ratio_numerator = vector.word("ratio").parse().expect("a whole number");
        let mut block = Block::new(GearInPos {
            ratio_numerator,
            ratio_denominator: 1,
            master_sync_position: sync[0],
            slave_sync_position: sync[1],
            master_start_distance: vector.number("dist"),
        });
        // 1 u a cycle, so that the master is at the place of the vector in one of them.
        let mut master = Powered::new(0.01, None, 0.0);
        let mut slave = Powered::new(0.01, None, vector.number("slave0"));
        let mut lead = Block::new(Follow::Position(0.0));
        for place in 0..=160_u8 {
            lead.inputs = Follow::Position(f64::from(place));
            master.cycle(|axis| lead.call(true, axis));
            slave.cycle(|axis| block.follow(true, &master.axis, axis));
            if place.to_string() == vector.word("master") {
                vector.expect("slave", [slave.axis.set_position()]);
                let gear = slave.axis.set_velocity() / master.axis.set_velocity();
                vector.expect("gear", [gear]);
            }
        }
        assert!((slave.axis.set_position() - sync[1] - 2.0 * (160.0 - sync[0])).abs() < 1e-9);
    });
}

#[test]
pub(crate) fn tracking_error() {
    check("diag-tracking", |vector| {
        let [velocity, cycle] = ["v", "cycle"].map(|name| vector.number(name));
        let whole = |name: &str| vector.word(name).parse::<u8>().expect("a whole number");
        let mut it = Powered::new(cycle, None, 0.0);
        let mut watch = TrackingError::new(whole("dead"));
        let mut ramp = Block::new(Follow::Position(0.0));
        let late = f64::from(whole("lag"));
        for count in 0..100_u8 {
            let at = |cycles: f64| (velocity * cycle * cycles).max(0.0);
            let mut feedback = it.drive.feedback();
            feedback.position = at(f64::from(count) - late);
            it.axis.begin_cycle(&feedback);
            Power { regulator_on: true, drive_start: true }.call(true, &mut it.axis);
            ramp.inputs = Follow::Position(at(f64::from(count)));
            ramp.call(true, &mut it.axis);
            watch.call(&it.axis, false, u32::from(count));
            it.drive.follow(&it.axis.end_cycle());
        }
        vector.expect("error", [watch.error]);
    });
}
