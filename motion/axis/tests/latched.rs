//! Tests of a latch in the very cycle in which `MC_TouchProbe` begins (manual 5.3).

use super::rig::{endless, linear};
use crate::{TouchProbe, Trigger};

/// An input of the program that is TRUE in this cycle only, or from it on, latches where the axis is in it.
#[test]
fn an_input_that_is_true_when_the_probe_begins_latches_at_once() {
    for stays in [false, true] {
        let mut rig = linear();
        let mut moving = endless(10.0);
        rig.calls(50, &mut moving);
        let (mut trigger, mut probe) = (Trigger::of_program(), TouchProbe::new(None));
        let mut latched = Vec::new();
        for cycle in 0..5 {
            trigger.input = cycle == 0 || stays;
            let (place, shown) = rig.cycle(|axis| {
                moving.call(true, axis);
                (axis.act_position(), probe.call(true, axis, &mut trigger))
            });
            assert!(shown.outputs.done, "in cycle {cycle}: {shown:?}");
            assert!(!shown.outputs.busy && !trigger.is_active());
            latched.push(shown.recorded_position);
            // The first one counts, however long the input stays.
            assert!(cycle > 0 || shown.recorded_position == place, "{shown:?} at {place}");
        }
        assert!(latched.windows(2).all(|pair| pair[0] == pair[1]), "{latched:?}");
    }
}

/// Outside its window it does not latch; begun anew it latches again.
#[test]
fn the_window_and_a_new_edge_count_in_that_cycle() {
    let mut rig = linear();
    rig.axis.shift_zero(5.0, false).expect("a number");
    let mut trigger = Trigger::of_program();
    trigger.input = true;
    let mut probe = TouchProbe::new(Some([6.0, 7.0]));
    let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    assert!(shown.outputs.busy && !shown.outputs.done, "{shown:?}");
    // Into the window while it waits, with an input that is FALSE; then a new edge with one that is TRUE.
    rig.axis.shift_zero(6.5, false).expect("a number");
    trigger.input = false;
    let shown = rig.cycle(|axis| probe.call(false, axis, &mut trigger));
    assert!(shown.outputs.busy && !shown.outputs.done, "{shown:?}");
    trigger.input = true;
    let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    assert!(shown.outputs.done, "{shown:?}");
    assert_eq!(shown.recorded_position, 6.5);
}

/// A capture that the drive reports in that cycle is older than the request.
#[test]
fn a_latch_of_the_drive_from_before_does_not_count() {
    let mut rig = linear();
    let (mut trigger, mut probe) = (Trigger::of_drive(1), TouchProbe::new(None));
    rig.drive.feedback_mut().captured = Some(1.25);
    let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    assert!(shown.outputs.busy && !shown.outputs.done, "{shown:?}");
    rig.drive.feedback_mut().captured = Some(2.5);
    let shown = rig.cycle(|axis| probe.call(true, axis, &mut trigger));
    assert!(shown.outputs.done);
    assert_eq!(shown.recorded_position, 2.5);
}
