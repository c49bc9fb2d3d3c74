//! Tests of axes that follow a cam (manual 4.6, 5.4).

use super::blocks::endless;
use super::rig::{CYCLE, Rig, linear, rotary};
use crate::{AxisState, Block, CamIn, Decouple, SmcError};
use std::sync::Arc;
use twin_cam::{
    Action, Cam, CamInput, CamTable, Knot, Passage, Shape, StartMode, Tappet, TappetValue,
};

fn table(knots: &[Knot]) -> CamTable {
    let cam = Cam::new("cam", Shape::Polynomial(knots.to_vec()), Vec::new()).expect("a cam");
    CamTable::new(Arc::new(cam))
}

/// 0 to 100 lifts by 10, at rest at both ends.
fn lift() -> CamTable {
    table(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(50.0, 10.0), Knot::at_rest(100.0, 0.0)])
}

fn block(table: CamTable, input: CamInput) -> Block<CamIn> {
    Block::new(CamIn { table: Some(table), input })
}

#[test]
fn a_slave_follows_its_cam() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut block) = (endless(10.0), block(lift(), CamInput::default()));
    let curve = lift().cam.curve().clone();
    let mut before = 0.0;
    for _ in 0..1500 {
        master.cycle(|axis| lead.call(true, axis));
        let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
        assert!(shown.done && shown.error.is_none(), "in step from the start: {shown:?}");
        assert_eq!(slave.axis.state(), AxisState::SynchronizedMotion);
        let expected = curve.repeated(master.axis.set_position());
        let position = slave.axis.set_position();
        assert!((position - expected.position).abs() < 1e-9);
        let velocity = expected.velocity * master.axis.set_velocity();
        assert!((slave.axis.set_velocity() - velocity).abs() < 1e-9);
        assert!((position - before).abs() <= 0.4 * 10.0 * CYCLE);
        before = position;
    }
    assert!(master.axis.set_position() > 140.0, "beyond the end");
}

#[test]
fn what_is_missing_is_told() {
    let shown = |block: &mut Block<CamIn>, at: f64| {
        let (master, mut slave) = (standing(at), linear());
        slave.cycle(|axis| block.follow(true, &master.axis, axis)).error
    };
    let mut none = Block::new(CamIn { table: None, input: CamInput::default() });
    assert_eq!(shown(&mut none, 0.0), Some(SmcError::CiNoCamSelected));
    let mut outside = block(lift(), CamInput { master_offset: -1.0, ..CamInput::default() });
    assert_eq!(shown(&mut outside, 0.0), Some(SmcError::CiMasterOutOfScale));
    let ramp = CamInput { start_mode: StartMode::RampIn, ..CamInput::default() };
    let mut ramp = block(lift(), ramp);
    assert_eq!(shown(&mut ramp, 0.0), Some(SmcError::CiRampinNeedsVelaccValues));
    let mut scaled = block(lift(), CamInput { slave_scaling: f64::NAN, ..CamInput::default() });
    assert_eq!(shown(&mut scaled, 0.0), Some(SmcError::CiScalingIncorrect));
}

fn standing(at: f64) -> Rig {
    let rig = linear();
    assert!((rig.axis.set_position() - at).abs() < 1e-12);
    rig
}

/// A slave in motion comes onto its cam without a step of position or velocity, and goes on alone with the velocity it
/// has there.
#[test]
fn ramps_take_over_a_moving_slave() {
    for rig in [linear, rotary] {
        let (mut master, mut slave) = (linear(), rig());
        let (mut lead, mut other) = (endless(10.0), endless(-7.0));
        for _ in 0..50 {
            master.cycle(|axis| lead.call(true, axis));
            slave.cycle(|axis| other.call(true, axis));
        }
        let input = CamInput {
            start_mode: StartMode::RampIn,
            velocity_difference: 30.0,
            acceleration: 60.0,
            deceleration: 60.0,
            ..CamInput::default()
        };
        let mut block = block(lift(), input);
        let mut velocity = slave.axis.set_velocity();
        let curve = lift().cam.curve().clone();
        let mut cycles = 0;
        loop {
            cycles += 1;
            assert!(cycles < 1000, "it comes onto the cam");
            master.cycle(|axis| lead.call(true, axis));
            let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
            // 60 u/s² of the bridge and what the cam accelerates at 10 u/s.
            let most = (60.0 + 2.5) * CYCLE + 1e-9;
            assert!((slave.axis.set_velocity() - velocity).abs() <= most, "cycle {cycles}");
            velocity = slave.axis.set_velocity();
            if shown.done {
                break;
            }
        }
        for _ in 0..20 {
            master.cycle(|axis| lead.call(true, axis));
            slave.cycle(|axis| block.follow(true, &master.axis, axis));
        }
        let expected = curve.repeated(master.axis.set_position());
        let off = slave.axis.set_position() - expected.position;
        assert!((off - 360.0 * (off / 360.0).round()).abs() < 1e-9, "{off}");
        let velocity = slave.axis.set_velocity();
        let mut out = Block::new(Decouple);
        for _ in 0..10 {
            slave.cycle(|axis| out.call(true, axis));
        }
        assert!((slave.axis.set_velocity() - velocity).abs() < 1e-9);
        assert_eq!(slave.axis.state(), AxisState::ContinuousMotion);
    }
}

/// The example of two cams in turn (manual 4.6.2, 11.6): Execute falls and rises in the cycle of `EndOfProfile`.
#[test]
fn two_cams_in_turn() {
    let line = |master: f64, slave: f64| Knot { velocity: 0.1, ..Knot::at_rest(master, slave) };
    let up = table(&[line(0.0, 0.0), line(360.0, 36.0)]);
    let on = table(&[line(0.0, 0.0), Knot::at_rest(360.0, 18.0)]);
    let once = |table: CamTable| CamTable { periodic: false, slave_absolute: false, ..table };
    let (mut master, mut slave) = (rotary(), linear());
    let (mut lead, mut block) = (endless(90.0), block(once(up), CamInput::default()));
    let (mut turns, mut before) = (0, 0.0);
    for _ in 0..1000 {
        master.cycle(|axis| lead.call(true, axis));
        slave.cycle(|axis| {
            block.follow(true, &master.axis, axis);
            let ended = block.running().is_some_and(|run| run.coupling().output().end_of_profile);
            if ended && turns == 0 {
                turns += 1;
                block.follow(false, &master.axis, axis);
                block.inputs.table = Some(once(on.clone()));
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

/// A pulse of 30 ms that has begun before the block is started again ends when it would have (manual 5.5: the value stays
/// as it is), and one that is reset ends at once.
#[test]
fn a_timed_tappet_goes_on_over_a_restart() {
    for (reset, expected) in [(false, 3), (true, 1)] {
        let action = Action::Timed { delay_ns: 0, duration_ns: 30_000_000 };
        let timed = Tappet { group: 1, master: 50.05, passage: Passage::Every, action };
        let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(50.0, 10.0), Knot::at_rest(100.0, 0.0)];
        let cam = Cam::new("cam", Shape::Polynomial(knots.to_vec()), vec![timed]).expect("a cam");
        let (mut master, mut slave) = (linear(), linear());
        let mut block = block(CamTable::new(Arc::new(cam)), CamInput::default());
        let (mut lead, mut value) = (endless(10.0), TappetValue::new(1, false, reset));
        let (mut on, mut restarts) = (0, 0);
        // It is there after 5 s.
        for _ in 0..900 {
            master.cycle(|axis| lead.call(true, axis));
            let was = value.value();
            slave.cycle(|axis| {
                if was && restarts == 0 {
                    restarts += 1;
                    block.follow(false, &master.axis, axis);
                }
                block.follow(true, &master.axis, axis)
            });
            let tappets = &block.running().expect("on the cam").coupling().output().tappets;
            assert_eq!(tappets.now_ns, slave.axis.now_ns());
            on += i32::from(value.step(tappets));
        }
        assert!(master.axis.set_position() > 80.0, "beyond the tappet");
        assert_eq!((on, restarts), (expected, 1), "bSetInitValueAtReset {reset}");
    }
}
