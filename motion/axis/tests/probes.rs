//! Tests of probes, of the program and of the drive (manual 5.3).

use super::*;

#[test]
fn a_probe_of_the_program_latches_within_its_window() {
    let (mut rig, mut moving) = (linear(), endless(10.0));
    let (mut trigger, mut probe) = (Trigger::of_program(), TouchProbe::new(Some([2.0, 3.0])));
    rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    let (mut early, mut at) = (false, f64::NAN);
    rig.until(|axis| {
        moving.call(true, axis);
        at = axis.act_position();
        // Before the window, and then within.
        trigger.input = (0.5..1.0).contains(&at) || at > 2.5;
        early |= trigger.input && at < 2.0;
        let shown = probe.call(true, axis, &mut trigger);
        assert!(!shown.outputs.done || shown.recorded_position == at);
        shown.outputs.done
    });
    assert!(early && at > 2.5 && at < 2.7, "{at}");
    assert!(!trigger.is_active());
}

/// Over the end of the period, and all the way round: 1 u outside the window nothing counts.
#[test]
fn a_window_of_a_rotary_axis_may_reach_over_the_end() {
    for (window, inside, outside) in [
        ([350.0, 10.0], vec![350.0, 359.0, 0.0, 10.0], vec![11.0, 180.0, 349.0]),
        ([10.0, 350.0], vec![10.0, 180.0, 350.0], vec![351.0, 0.0, 9.0]),
        ([0.0, 360.0], vec![0.0, 1.0, 180.0, 359.0], vec![]),
        ([90.0, 500.0], vec![0.0, 1.0, 89.0, 180.0, 359.0], vec![]),
    ] {
        let latches = |place: f64| {
            let mut rig = rotary();
            rig.axis.shift_zero(place, false).expect("a number");
            let (mut trigger, mut probe) = (Trigger::of_program(), TouchProbe::new(Some(window)));
            rig.cycle(|axis| probe.call(true, axis, &mut trigger));
            trigger.input = true;
            let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger));
            assert!(!shown.outputs.done || shown.recorded_position == place);
            shown.outputs.done
        };
        assert!(inside.iter().all(|place| latches(*place)), "{window:?}");
        assert!(!outside.iter().any(|place| latches(*place)), "{window:?}");
    }
}

#[test]
fn a_probe_of_the_drive_takes_what_it_captured() {
    let (mut rig, mut trigger) = (linear(), Trigger::of_drive(2));
    let [mut probe, mut other] = [(); 2].map(|()| TouchProbe::new(None));
    rig.axis.shift_zero(100.0, true).expect("a number");
    // A capture that the drive reports in the cycle of the edge is older than the request.
    rig.drive.feedback_mut().captured = Some(1.25);
    let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger)).outputs;
    assert!(shown.busy && !shown.done, "{shown:?}");
    rig.drive.feedback_mut().captured = Some(1.234);
    let [other, shown] =
        rig.cycle(|axis| [&mut other, &mut probe].map(|it| it.call(true, axis, &mut trigger)));
    assert_eq!(other.outputs.error, Some(SmcError::TpTriggeroccupied));
    assert!(shown.outputs.done);
    assert!((shown.recorded_position - 101.234).abs() < 1e-12);
}

/// The drive gets a window in its own positions; in the program's it stays where it is when the zero moves. A drive
/// without windows refuses one.
#[test]
fn a_window_of_the_drive_moves_with_the_zero() {
    let (mut rig, mut trigger) = (linear(), Trigger::of_drive(2));
    let mut probe = TouchProbe::new(Some([102.0, 103.0]));
    rig.axis.shift_zero(100.0, true).expect("a number");
    rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    let window = |rig: &mut Rig| rig.axis.end_cycle().capture.and_then(|capture| capture.window);
    assert_eq!(window(&mut rig), Some([2.0, 3.0]));
    rig.axis.shift_zero(40.0, true).expect("a number");
    assert_eq!(window(&mut rig), Some([-38.0, -37.0]));
    let mut rig = Rig::new(AxisConfig { capture_window: false, ..AxisConfig::default() });
    let mut probe = TouchProbe::new(Some([0.0, 1.0]));
    let shown = rig.cycle(|axis| probe.call(true, axis, &mut Trigger::of_drive(1)));
    assert_eq!(shown.outputs.error, Some(SmcError::TpCouldntSetWindow));
}

#[test]
fn an_aborted_trigger_ends_the_probe() {
    let (mut rig, mut trigger) = (linear(), Trigger::of_program());
    let (mut probe, mut abort) = (TouchProbe::new(None), AbortTrigger::default());
    let shown = rig.cycle(|axis| abort.call(true, axis, &mut trigger));
    assert_eq!(shown.error, Some(SmcError::AtTriggernotoccupied));
    rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    rig.cycle(|axis| abort.call(false, axis, &mut trigger));
    assert!(rig.cycle(|axis| abort.call(true, axis, &mut trigger)).done);
    assert!(rig.cycle(|axis| probe.call(true, axis, &mut trigger)).outputs.command_aborted);
}

/// An input of the program that is TRUE in this cycle only, or from it on, latches where the axis is in it.
#[test]
fn an_input_that_is_true_when_the_probe_begins_latches_at_once() {
    for stays in [false, true] {
        let (mut rig, mut moving, mut latched) = (linear(), endless(10.0), None);
        rig.calls(50, &mut moving);
        let (mut trigger, mut probe) = (Trigger::of_program(), TouchProbe::new(None));
        for cycle in 0..5 {
            trigger.input = cycle == 0 || stays;
            let (place, shown) = rig.cycle(|axis| {
                moving.call(true, axis);
                (axis.act_position(), probe.call(true, axis, &mut trigger))
            });
            let outputs = (shown.outputs.done, shown.outputs.busy, trigger.is_active());
            assert_eq!(outputs, (true, false, false), "in cycle {cycle}");
            // The first one counts, however long the input stays.
            assert_eq!(shown.recorded_position, *latched.get_or_insert(place));
        }
    }
}

/// Outside its window it does not latch; begun anew it latches again.
#[test]
fn the_window_and_a_new_edge_count_in_that_cycle() {
    let (mut rig, mut trigger) = (linear(), Trigger::of_program());
    let mut probe = TouchProbe::new(Some([6.0, 7.0]));
    // Into the window while it waits, with an input that is FALSE; then a new edge with one that is TRUE.
    for (place, input, done) in [(5.0, true, false), (6.5, false, false), (6.5, true, true)] {
        rig.axis.shift_zero(place, false).expect("a number");
        trigger.input = input;
        let shown = rig.cycle(|axis| probe.call(input, axis, &mut trigger));
        assert_eq!((shown.outputs.busy, shown.outputs.done), (!done, done), "{place} {input}");
        assert!(!done || shown.recorded_position == 6.5, "{shown:?}");
    }
}

/// A trigger is released and taken by another probe within a cycle: the latch then is for that probe, in any call order.
#[test]
fn a_probe_whose_trigger_another_one_has_is_aborted() {
    for fast in [false, true] {
        for first in [false, true] {
            let mut rig = linear();
            let mut trigger = if fast { Trigger::of_drive(1) } else { Trigger::of_program() };
            let mut probes = [(); 2].map(|()| TouchProbe::new(None));
            rig.cycle(|axis| probes[0].call(true, axis, &mut trigger));
            rig.cycle(|axis| {
                AbortTrigger::default().call(true, axis, &mut trigger);
                probes[1].call(true, axis, &mut trigger)
            });
            (rig.drive.feedback_mut().captured, trigger.input) = (fast.then_some(2.5), !fast);
            let mut aborted = [true, false];
            if !first {
                probes.reverse();
                aborted.reverse();
            }
            let shown = rig.cycle(|axis| probes.map(|mut it| it.call(true, axis, &mut trigger)));
            let shown = shown.map(|it| (it.outputs.command_aborted, it.outputs.done));
            assert_eq!(shown, aborted.map(|aborted| (aborted, !aborted)), "{fast} {first}");
            assert!(!trigger.is_active());
        }
    }
}

#[test]
fn a_probe_without_an_answer_is_402() {
    for before in [true, false] {
        let (mut rig, mut trigger) = (linear(), Trigger::of_drive(1));
        let mut probe = TouchProbe::new(None);
        if !before {
            rig.cycle(|axis| probe.call(true, axis, &mut trigger));
        }
        rig.drive.feedback_mut().communicating = false;
        let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger)).outputs;
        assert_eq!(shown.error, Some(SmcError::TpCommError));
        assert!(!trigger.is_active());
    }
}
