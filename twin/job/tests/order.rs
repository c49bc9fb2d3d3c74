//! Tests of the execution order of axes while couplings come and go, and of blocks that are over.

use super::{START, block, findings, job, machine, machine_with, moves, near, run};
use crate::finding::{Finding, Rule};
use crate::job::JobSetpoints;
use crate::setpoint::AxisSetpoint;
use crate::setpoint_source::PlanItem;

fn gear(slave: &str, master: &str, keys: &str) -> String {
    block("MC_GearIn", slave, &format!("master = \"{master}\"; ratio_numerator = 1{keys}"))
}

fn out(axis: &str) -> String {
    block("MC_GearOut", axis, "")
}

fn relative(axis: &str, distance: f64) -> String {
    let rates = "velocity_mm_per_s = 50; acceleration_mm_per_s2 = 500";
    block("MC_MoveRelative", axis, &format!("distance_mm = {distance:?}; {rates}"))
}

/// X and Y in mm and mm/s.
fn both(one: &AxisSetpoint) -> [[f64; 2]; 2] {
    [0, 1].map(|axis| [one.axes.position[axis], one.axes.velocity[axis]].map(|value| value * 1e3))
}

/// X follows Y 50 mm, is released, and then leads it another 20 mm: both positions belong to the same cycle.
#[test]
fn an_axis_may_lead_what_it_has_followed() {
    for (begin, about) in [("", "one behind the other"), ("; with_previous = true", "at once")] {
        let text = START.to_owned()
            + &gear("X", "Y", "")
            + &relative("Y", 50.0)
            + &out("X")
            + &gear("Y", "X", begin)
            + &relative("X", 20.0);
        let setpoints = moves(&text);
        let mut moved = 0;
        for one in &setpoints {
            let [[x, fast], [y, same]] = both(one);
            near(x - 100.0, y - 50.0, 1e-9);
            near(fast, same, 1e-9);
            moved += usize::from(fast > 1.0);
        }
        // 1 s and 0.4 s with 0.1 s to come to speed, of cycles of a millisecond.
        assert!(moved > 1400, "{about}: {moved}");
        let last = both(setpoints.last().unwrap());
        near(last[0][0], 170.0, 1e-9);
        near(last[1][0], 120.0, 1e-9);
    }
}

fn refused(text: &str) -> Finding {
    let mut found = findings(text);
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0)
}

/// A ring of axes is refused when the block begins that closes it, whatever comes before it in the file.
#[test]
fn a_ring_is_refused_at_the_block_that_closes_it() {
    let lines = |text: &str| u32::try_from(text.matches('\n').count()).unwrap();
    let head = START.to_owned() + &gear("X", "Y", "");
    let closing = head.clone() + &relative("Y", 5.0) + &gear("Y", "X", "");
    let found = refused(&closing);
    assert_eq!((found.rule, found.axis.as_deref()), (Rule::Coupling, Some("Y")));
    assert_eq!(found.line, lines(&(head.clone() + &relative("Y", 5.0))) + 2);
    assert_eq!(found.message, "axis Y would follow itself, by way of its masters: X -> Y -> X");
    // By way of a third axis, and with blocks that all begin at once.
    let more = gear("Z", "X", "; with_previous = true");
    let found = refused(&(head.clone() + &more + &gear("Y", "Z", "; with_previous = true")));
    assert_eq!(found.line, lines(&(head.clone() + &more)) + 2);
    assert!(found.message.ends_with("X -> Z -> Y -> X"), "{}", found.message);
    // The block that closes the ring may come first in the file.
    let late = START.to_owned() + &gear("Y", "X", "; at_s = 0.5") + &gear("X", "Y", "; at_s = 0.1");
    let found = refused(&late);
    assert_eq!((found.line, found.axis.as_deref()), (lines(START) + 2, Some("Y")));
    // A coupling of the machine file that is not released counts, too.
    let machine = machine_with("\n[[gears]]\naxis = \"Y\"\nmaster = \"X\"\nratio_numerator = 1\n");
    let ring = gear("X", "Y", "");
    let (_, findings) = run(&job(&ring), &machine);
    assert_eq!((findings[0].rule, findings[0].line), (Rule::Coupling, 2), "{findings:?}");
    let (_, findings) = run(&job(&(out("Y") + &ring + &relative("Y", 5.0))), &machine);
    assert_eq!(findings, []);
}

/// Blocks that are over, and blocks that have not begun, are not called.
#[test]
fn only_blocks_under_way_are_called() {
    let steps = 1_500_u32;
    let step = |index: u32| {
        let way = if index.is_multiple_of(2) { 0.01 } else { -0.01 };
        block("MC_MoveRelative", "X", &format!("distance_mm = {way:?}; velocity_mm_per_s = 50"))
    };
    let text = START.to_owned() + &(0..steps).map(step).collect::<String>();
    let (job, machine) = (job(&text), machine());
    let mut setpoints = JobSetpoints::open(&machine, &job.program).unwrap();
    let (mut cycles, mut called) = (0, 0);
    while let Some(item) = setpoints.next() {
        assert!(matches!(item, PlanItem::Axes(_)), "{item:?}");
        cycles += 1;
        called = setpoints.block_calls().unwrap_or(called);
    }
    assert!(cycles > 2 * u64::from(steps), "{cycles}");
    // One of them at a time, and each once more when it is over.
    assert!(called <= cycles + u64::from(steps), "{called} calls in {cycles} cycles");
}
