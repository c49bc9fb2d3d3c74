//! Tests of a master whose zero is shifted (`MC_SetPosition`, `MC_Home`, `bSet` of an encoder): it does not move, so
//! its slaves do not.

use super::blocks::endless;
use super::gears::{gear, pair};
use super::rig::{CYCLE, Rig, linear, rotary};
use crate::{
    Axis, Block, CamIn, Encoder, EncoderConfig, GearInPos, Home, Movement, Phasing, TimeAxis,
};
use std::sync::Arc;
use twin_cam::{Cam, CamInput, CamTable, Knot, Shape};

fn phasing() -> Block<Phasing> {
    let (phase_shift, velocity) = (3.0, 10.0);
    Block::new(Phasing { phase_shift, velocity, acceleration: 500.0, deceleration: 500.0 })
}

/// The slave's way in a cycle, the short way round.
fn way(slave: &Rig, before: f64) -> f64 {
    let way = slave.axis.set_position() - before;
    slave.axis.period().map_or(way, |period| way - period * (way / period).round())
}

/// `cycles` of a master at 10 u/s, whose zero moves in the middle and at other times; slave's way in each, u.
fn ways(rig: fn() -> Rig, cycles: usize, mut follow: impl FnMut(&Axis, &mut Axis)) -> Vec<f64> {
    let (mut master, mut slave) = (rig(), rig());
    let mut lead = endless(10.0);
    let mut all = Vec::new();
    for cycle in 0..cycles {
        let before = slave.axis.set_position();
        pair(
            &mut master,
            &mut slave,
            |axis| {
                lead.call(true, axis);
                if cycle % 50 == 49 {
                    axis.shift_zero(100.0, cycle % 100 == 99).expect("a number");
                }
            },
            &mut follow,
        );
        // Between the cycles, too.
        if cycle == 120 {
            master.axis.shift_zero(-33.0, true).expect("a number");
        }
        all.push(way(&slave, before));
    }
    all
}

#[test]
fn slaves_in_gear_do_not_notice_that_the_zero_moves() {
    for rig in [linear, rotary] {
        let mut block = gear(-3, 2);
        let found = ways(rig, 400, |master, axis| _ = block.follow(true, master, axis));
        // −15 u/s from 0.4 s on.
        for (cycle, way) in found.iter().enumerate().skip(45) {
            assert!((way + 15.0 * CYCLE).abs() < 1e-9, "{cycle}: {way}");
        }
        let mut block = phasing();
        let found = ways(rig, 400, |master, axis| _ = block.follow(true, master, axis));
        // At most 10 u/s more than the master, and then as it.
        for (cycle, way) in found.iter().enumerate() {
            let most = if cycle < 150 { 20.0 } else { 10.0 };
            assert!((0.0..=most * CYCLE + 1e-9).contains(way), "{cycle}: {way}");
        }
    }
}

/// The place to meet is one of the program: it moves with the zero while the slave waits for it. Once it is being coupled,
/// nothing moves.
#[test]
fn a_gear_in_position_meets_its_master_where_the_program_says() {
    for shifted_at in [9.0, 13.0, 20.0] {
        let (mut master, mut slave) = (linear(), linear());
        let (mut lead, mut shifted) = (endless(10.0), false);
        let mut block = Block::new(GearInPos {
            ratio_numerator: 2,
            ratio_denominator: 1,
            master_sync_position: 15.0,
            slave_sync_position: 6.0,
            master_start_distance: 5.0,
        });
        for _ in 0..400 {
            let before = [slave.axis.set_position(), slave.axis.set_velocity()];
            let shown = pair(
                &mut master,
                &mut slave,
                |axis| {
                    lead.call(true, axis);
                    if !shifted && axis.set_position() > shifted_at {
                        axis.shift_zero(-4.0, true).expect("a number");
                        shifted = true;
                    }
                },
                |master, axis| block.follow(true, master, axis),
            );
            let mean = 0.5 * (before[1] + slave.axis.set_velocity()) * CYCLE;
            assert!((way(&slave, before[0]) - mean).abs() < 0.01, "{shifted_at}");
            if shown.done {
                // Moved once it was on its way: it is 4 u further than it says.
                let lost = if shifted_at > 10.0 && shifted { 4.0 } else { 0.0 };
                let at = master.axis.set_position() + lost;
                let expected = 6.0 + 2.0 * (at - 15.0);
                assert!((slave.axis.set_position() - expected).abs() < 1e-9, "{shifted_at}");
            }
        }
        assert!(shifted && slave.axis.set_velocity() == 20.0);
    }
}

#[test]
fn a_master_that_is_homed_takes_nobody_along() {
    for rig in [linear, rotary] {
        let (mut master, mut slave) = (rig(), rig());
        let mut there = super::framework::to(30.0);
        master.until(|axis| there.call(true, axis).done);
        let (mut block, mut home) =
            (gear(2, 1), Block::new(Home { position: 5.0, deceleration: 0.0 }));
        for cycle in 0..50 {
            let begins = cycle == 20;
            pair(
                &mut master,
                &mut slave,
                |axis| _ = home.call(begins, axis),
                |master, axis| block.follow(true, master, axis),
            );
            assert_eq!(slave.axis.set_position(), 0.0, "{cycle}");
            // As a slave sees it that is called before its master's blocks.
            master.axis.begin_cycle(&master.drive.feedback());
            slave.cycle(|axis| block.follow(true, &master.axis, axis));
            assert_eq!(slave.axis.set_position(), 0.0, "{cycle}");
        }
        assert_eq!(master.axis.set_position(), 5.0);
    }
}

#[test]
fn an_encoder_and_a_time_that_are_set_take_nobody_along() {
    let mut encoder = Encoder::new(EncoderConfig {
        id: 1,
        ratio: [1, 1],
        movement: Movement::Linear,
        software_limits: None,
        modulo: 0,
        cycle: CYCLE,
    });
    let (mut slave, mut block) = (linear(), gear(1, 1));
    for cycle in 0..20 {
        encoder.call(700, (cycle == 10).then_some(50.0));
        slave.cycle(|axis| block.follow(true, encoder.axis(), axis));
        assert_eq!(slave.axis.set_position(), 0.0, "{cycle}");
    }
    // A new edge counts from 0 again; the time has gone on by nothing in that cycle.
    let mut time = TimeAxis::new(CYCLE, None);
    let (mut slave, mut block) = (linear(), gear(10, 1));
    for cycle in 0..200 {
        let before = slave.axis.set_position();
        time.call(cycle != 100);
        slave.cycle(|axis| block.follow(true, time.axis(), axis));
        let way = slave.axis.set_position() - before;
        assert!((-1e-9..=10.0 * CYCLE + 1e-9).contains(&way), "{cycle}: {way}");
    }
}

/// A cam that lies where its master was (`MasterAbsolute` FALSE) stays there. One for the master's positions has its slave
/// strictly where the position says (manual 4.6.2).
#[test]
fn cams_follow_positions_only_where_they_are_absolute() {
    for (master_absolute, step) in [(false, 0.0), (true, 10.0)] {
        let knot = |x: f64| Knot { velocity: 0.5, ..Knot::at_rest(x, 0.5 * x) };
        let cam = Cam::new("cam", Shape::Polynomial(vec![knot(0.0), knot(100.0)]), Vec::new());
        let table = CamTable::new(Arc::new(cam.expect("a cam")));
        let table = CamTable { master_absolute, ..table };
        let mut block = Block::new(CamIn { table: Some(table), input: CamInput::default() });
        let (mut master, mut slave) = (linear(), linear());
        let mut lead = endless(10.0);
        for cycle in 0..300 {
            let before = slave.axis.set_position();
            pair(
                &mut master,
                &mut slave,
                |axis| {
                    lead.call(true, axis);
                    if cycle == 200 {
                        axis.shift_zero(20.0, true).expect("a number");
                    }
                },
                |master, axis| block.follow(true, master, axis),
            );
            let jump = if cycle == 200 { step } else { 0.0 };
            if cycle > 100 {
                let off = way(&slave, before) - jump - slave.axis.set_velocity() * CYCLE;
                assert!(off.abs() < 1e-9, "{cycle}: {off}");
            }
        }
    }
}
