//! Tests of a master whose zero is shifted: it does not move, so its slaves do not.

use super::*;

/// The slave's way in a cycle, the short way round.
fn way(slave: &Rig, before: f64) -> f64 {
    short(&slave.axis, slave.axis.set_position() - before)
}

/// A cycle of a master with `lead`, whose zero may shift after that, and then of its slave with `block`.
fn shifted<M: Motion<With = Master> + Clone>(
    axes: &mut [Rig; 2],
    lead: &mut impl Called,
    shift: Option<(f64, bool)>,
    block: &mut Block<M>,
) -> Outputs {
    let lead = |axis: &mut Axis| {
        lead.call(true, axis);
        if let Some((position, relative)) = shift {
            axis.shift_zero(position, relative).expect("a number");
        }
    };
    pair(axes, lead, |master, axis| block.follow(true, master, axis))
}

/// 400 cycles of a master at 10 u/s, whose zero moves within cycles and between two; slave's way in each, u.
fn ways<M: Motion<With = Master> + Clone>(rig: fn() -> Rig, block: &mut Block<M>) -> Vec<f64> {
    let (mut axes, mut lead) = ([rig(), rig()], endless(10.0));
    let all = (0..400).map(|cycle| {
        let before = axes[1].axis.set_position();
        let shift = (cycle % 50 == 49).then_some((100.0, cycle % 100 == 99));
        shifted(&mut axes, &mut lead, shift, block);
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
        let found = ways(rig, &mut gear(-3, 2));
        // −15 u/s from 0.4 s on.
        for (cycle, way) in found.iter().enumerate().skip(45) {
            assert!((way + 15.0 * CYCLE).abs() < 1e-9, "{cycle}: {way}");
        }
        let found = ways(rig, &mut phasing(3.0, 10.0, 500.0));
        // At most 10 u/s more than the master, and then its velocity.
        for (cycle, way) in found.iter().enumerate() {
            let most = if cycle < 150 { 20.0 } else { 10.0 };
            assert!((0.0..=most * CYCLE + 1e-9).contains(way), "{cycle}: {way}");
        }
    }
}

/// The sync position moves with the zero while the slave waits for it, and no more once the slave couples.
#[test]
fn a_gear_in_position_meets_its_master_where_the_program_says() {
    for shifted_at in [9.0, 13.0, 20.0] {
        let (mut axes, mut lead, mut is_shifted) = ([linear(), linear()], endless(10.0), false);
        let mut block = in_pos([2, 1], [15.0, 6.0], 5.0);
        for _ in 0..400 {
            let before = [axes[1].axis.set_position(), axes[1].axis.set_velocity()];
            let shifts = !is_shifted && axes[0].axis.set_position() > shifted_at;
            is_shifted |= shifts;
            let shift = shifts.then_some((-4.0, true));
            let shown = shifted(&mut axes, &mut lead, shift, &mut block);
            let [master, slave] = &axes;
            let mean = 0.5 * (before[1] + slave.axis.set_velocity()) * CYCLE;
            assert!((way(slave, before[0]) - mean).abs() < 0.01, "{shifted_at}");
            if shown.done {
                // If the zero has moved on the way, the master is 4 u further than it shows.
                let lost = if shifted_at > 10.0 && is_shifted { 4.0 } else { 0.0 };
                let at = master.axis.set_position() + lost;
                let expected = 6.0 + 2.0 * (at - 15.0);
                assert!((slave.axis.set_position() - expected).abs() < 1e-9, "{shifted_at}");
            }
        }
        assert!(is_shifted && axes[1].axis.set_velocity() == 20.0);
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

/// With `MasterAbsolute` the slave is strictly at the cam's position for the master's (manual 4.6.2).
#[test]
fn cams_follow_positions_only_where_they_are_absolute() {
    for (master_absolute, step) in [(false, 0.0), (true, 10.0)] {
        let table = CamTable { master_absolute, ..straight(100.0, 0.5) };
        let mut block = cam_in(table, CamInput::default());
        let (mut axes, mut lead) = ([linear(), linear()], endless(10.0));
        for cycle in 0..300 {
            let before = axes[1].axis.set_position();
            let shift = (cycle == 200).then_some((20.0, true));
            shifted(&mut axes, &mut lead, shift, &mut block);
            let jump = if cycle == 200 { step } else { 0.0 };
            if cycle > 100 {
                let off = way(&axes[1], before) - jump - axes[1].axis.set_velocity() * CYCLE;
                assert!(off.abs() < 1e-9, "{cycle}: {off}");
            }
        }
    }
}
