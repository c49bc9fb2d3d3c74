//! Tests of axes that follow a cam (manual 4.6, 5.4).

use super::rig::{CYCLE, cam, cam_in, endless, follow, linear, rotary};
use crate::AxisState;
use twin_cam::{Action, CamInput, CamTable, Knot, Passage, Tappet, TappetValue};

/// 0 to 100 lifts by 10, at rest at both ends.
fn lift(tappets: Vec<Tappet>) -> CamTable {
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(50.0, 10.0), Knot::at_rest(100.0, 0.0)];
    cam(&knots, tappets)
}

#[test]
fn a_slave_follows_its_cam() {
    let (mut axes, mut lead) = ([linear(), linear()], endless(10.0));
    let mut block = cam_in(lift(Vec::new()), CamInput::default());
    let curve = lift(Vec::new()).cam.curve().clone();
    let mut before = 0.0;
    for _ in 0..1500 {
        let shown = follow(&mut axes, &mut lead, &mut block);
        assert!(shown.done && shown.error.is_none(), "in step from the start: {shown:?}");
        let [master, slave] = axes.each_ref().map(|rig| &rig.axis);
        assert_eq!(slave.state(), AxisState::SynchronizedMotion);
        let expected = curve.repeated(master.set_position());
        let position = slave.set_position();
        assert!((position - expected.position).abs() < 1e-9);
        let velocity = expected.velocity * master.set_velocity();
        assert!((slave.set_velocity() - velocity).abs() < 1e-9);
        assert!((position - before).abs() <= 0.4 * 10.0 * CYCLE);
        before = position;
    }
    assert!(axes[0].axis.set_position() > 140.0, "beyond the end");
}

/// The example of two cams in turn (manual 4.6.2, 11.6): Execute falls and rises in the cycle of `EndOfProfile`.
#[test]
fn two_cams_in_turn() {
    let line = |master: f64, slave: f64| Knot { velocity: 0.1, ..Knot::at_rest(master, slave) };
    let once = |knots: &[Knot]| CamTable {
        periodic: false,
        slave_absolute: false,
        ..cam(knots, Vec::new())
    };
    let up = once(&[line(0.0, 0.0), line(360.0, 36.0)]);
    let on = once(&[line(0.0, 0.0), Knot::at_rest(360.0, 18.0)]);
    let (mut master, mut slave, mut lead) = (rotary(), linear(), endless(90.0));
    let mut block = cam_in(up, CamInput::default());
    let (mut turns, mut before) = (0, 0.0);
    for _ in 0..1000 {
        master.call(&mut lead, true);
        slave.cycle(|axis| {
            block.follow(true, &master.axis, axis);
            let ended = block.running().is_some_and(|run| run.coupling().output().end_of_profile);
            if ended && turns == 0 {
                turns += 1;
                block.follow(false, &master.axis, axis);
                block.inputs.table = Some(on.clone());
                block.follow(true, &master.axis, axis);
            }
        });
        let position = slave.axis.set_position();
        assert!((-1e-9..=0.1 * 0.9 + 1e-9).contains(&(position - before)), "{before} {position}");
        before = position;
    }
    assert_eq!(turns, 1);
    assert!((before - 54.0).abs() < 1e-9, "{before}");
}

/// A pulse of 30 ms that has begun before the block is started again ends at its time (manual 5.5: the value stays as it
/// is); with `bSetInitValueAtReset` it ends at once.
#[test]
fn a_timed_tappet_goes_on_over_a_restart() {
    for (reset, expected) in [(false, 3), (true, 1)] {
        let action = Action::Timed { delay_ns: 0, duration_ns: 30_000_000 };
        let timed = Tappet { group: 1, master: 50.05, passage: Passage::Every, action };
        let (mut axes, mut lead) = ([linear(), linear()], endless(10.0));
        let mut block = cam_in(lift(vec![timed]), CamInput::default());
        let mut value = TappetValue::new(1, false, reset);
        let (mut on, mut restarts) = (0, 0);
        // The master is at the tappet after 5 s.
        for _ in 0..900 {
            let [master, slave] = &mut axes;
            master.call(&mut lead, true);
            slave.cycle(|axis| {
                if value.value() && restarts == 0 {
                    restarts += 1;
                    block.follow(false, &master.axis, axis);
                }
                block.follow(true, &master.axis, axis)
            });
            let tappets = &block.running().expect("on the cam").coupling().output().tappets;
            assert_eq!(tappets.now_ns, slave.axis.now_ns());
            on += i32::from(value.step(tappets));
        }
        assert!(axes[0].axis.set_position() > 80.0, "beyond the tappet");
        assert_eq!((on, restarts), (expected, 1), "bSetInitValueAtReset {reset}");
    }
}
