//! Tests of a master whose zero is shifted (`MC_SetPosition`, `MC_Home`, `bSet` of an encoder): it does not move, so
//! its slaves do not.

use super::gears::pair;
use super::rig::{CYCLE, Rig, cam_in, encoder, endless, gear, home, in_pos, linear, phasing};
use super::rig::{rotary, short, straight};
use crate::{Axis, Movement, TimeAxis};
use twin_cam::{CamInput, CamTable};

/// The slave's way in a cycle, the short way round.
fn way(slave: &Rig, before: f64) -> f64 {
    short(&slave.axis, slave.axis.set_position() - before)
}

/// `cycles` of a master at 10 u/s, whose zero moves within cycles and between two; slave's way in each, u.
fn ways(rig: fn() -> Rig, cycles: usize, mut follow: impl FnMut(&Axis, &mut Axis)) -> Vec<f64> {
    let (mut axes, mut lead) = ([rig(), rig()], endless(10.0));
    let all = (0..cycles).map(|cycle| {
        let before = axes[1].axis.set_position();
        pair(
            &mut axes,
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
            axes[0].axis.shift_zero(-33.0, true).expect("a number");
        }
        way(&axes[1], before)
    });
    all.collect()
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
        let mut block = phasing(3.0, 10.0, 500.0);
        let found = ways(rig, 400, |master, axis| _ = block.follow(true, master, axis));
        // At most 10 u/s more than the master, and then its velocity.
        for (cycle, way) in found.iter().enumerate() {
            let most = if cycle < 150 { 20.0 } else { 10.0 };
            assert!((0.0..=most * CYCLE + 1e-9).contains(way), "{cycle}: {way}");
        }
    }
}

/// The sync position is one of the program: it moves with the zero while the slave waits for it. Once the slave couples,
/// it moves no more.
#[test]
fn a_gear_in_position_meets_its_master_where_the_program_says() {
    for shifted_at in [9.0, 13.0, 20.0] {
        let (mut axes, mut lead, mut shifted) = ([linear(), linear()], endless(10.0), false);
        let mut block = in_pos([2, 1], [15.0, 6.0], 5.0);
        for _ in 0..400 {
            let before = [axes[1].axis.set_position(), axes[1].axis.set_velocity()];
            let shown = pair(
                &mut axes,
                |axis| {
                    lead.call(true, axis);
                    if !shifted && axis.set_position() > shifted_at {
                        axis.shift_zero(-4.0, true).expect("a number");
                        shifted = true;
                    }
                },
                |master, axis| block.follow(true, master, axis),
            );
            let [master, slave] = &axes;
            let mean = 0.5 * (before[1] + slave.axis.set_velocity()) * CYCLE;
            assert!((way(slave, before[0]) - mean).abs() < 0.01, "{shifted_at}");
            if shown.done {
                // If the zero has moved on the way, the master is 4 u further than it shows.
                let lost = if shifted_at > 10.0 && shifted { 4.0 } else { 0.0 };
                let at = master.axis.set_position() + lost;
                let expected = 6.0 + 2.0 * (at - 15.0);
                assert!((slave.axis.set_position() - expected).abs() < 1e-9, "{shifted_at}");
            }
        }
        assert!(shifted && axes[1].axis.set_velocity() == 20.0);
    }
}

#[test]
fn a_master_that_is_homed_takes_nobody_along() {
    for rig in [linear, rotary] {
        let (mut axes, mut block, mut home) = ([rig().at(30.0), rig()], gear(2, 1), home(5.0, 0.0));
        for cycle in 0..50 {
            pair(
                &mut axes,
                |axis| _ = home.call(cycle == 20, axis),
                |master, axis| block.follow(true, master, axis),
            );
            assert_eq!(axes[1].axis.set_position(), 0.0, "{cycle}");
            // As for a slave that is called before its master's blocks.
            let [master, slave] = &mut axes;
            master.axis.begin_cycle(&master.drive.feedback());
            slave.cycle(|axis| block.follow(true, &master.axis, axis));
            assert_eq!(slave.axis.set_position(), 0.0, "{cycle}");
        }
        assert_eq!(axes[0].axis.set_position(), 5.0);
    }
}

#[test]
fn an_encoder_and_a_time_that_are_set_take_nobody_along() {
    let mut encoder = encoder(Movement::Linear, 0, [1, 1]);
    let (mut slave, mut block) = (linear(), gear(1, 1));
    for cycle in 0..20 {
        encoder.call(700, (cycle == 10).then_some(50.0));
        slave.cycle(|axis| block.follow(true, encoder.axis(), axis));
        assert_eq!(slave.axis.set_position(), 0.0, "{cycle}");
    }
    // A new edge counts from 0 again; the time stands still in that cycle.
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

/// A cam with `MasterAbsolute` FALSE stays at the master's position at its start. With TRUE its slave is strictly at the
/// position of the cam for the master's position (manual 4.6.2).
#[test]
fn cams_follow_positions_only_where_they_are_absolute() {
    for (master_absolute, step) in [(false, 0.0), (true, 10.0)] {
        let table = CamTable { master_absolute, ..straight(100.0, 0.5) };
        let mut block = cam_in(table, CamInput::default());
        let (mut axes, mut lead) = ([linear(), linear()], endless(10.0));
        for cycle in 0..300 {
            let before = axes[1].axis.set_position();
            pair(
                &mut axes,
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
                let off = way(&axes[1], before) - jump - axes[1].axis.set_velocity() * CYCLE;
                assert!(off.abs() < 1e-9, "{cycle}: {off}");
            }
        }
    }
}
