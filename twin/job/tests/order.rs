//! Tests of the execution order of axes while couplings come and go, and of blocks that are over.

use super::JobSetpoints;
use super::tests::{START, job, machine, moves, near, run};
use crate::finding::{Finding, Rule};
use crate::setpoint::AxisSetpoint;
use crate::setpoint_source::PlanItem;

fn gear(slave: &str, master: &str, keys: &str) -> String {
    format!(
        "[[blocks]]\nblock = \"MC_GearIn\"\naxis = \"{slave}\"\nmaster = \"{master}\"\nratio_numerator = 1\n{keys}"
    )
}

fn out(axis: &str, keys: &str) -> String {
    format!("[[blocks]]\nblock = \"MC_GearOut\"\naxis = \"{axis}\"\n{keys}")
}

fn relative(axis: &str, distance: f64) -> String {
    format!(
        "[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"{axis}\"\ndistance_mm = {distance:?}\nvelocity_mm_per_s = 50\n\
         acceleration_mm_per_s2 = 500\n"
    )
}

/// X and Y in mm and mm/s.
fn both(one: &AxisSetpoint) -> [[f64; 2]; 2] {
    [0, 1].map(|axis| [one.axes.position[axis], one.axes.velocity[axis]].map(|value| value * 1e3))
}

/// X follows Y 50 mm, is let go, and then leads it another 20 mm: each is where the other one has it in the very same cycle.
#[test]
fn an_axis_may_lead_what_it_has_followed() {
    for (begin, told) in [("", "one behind the other"), ("with_previous = true\n", "at once")] {
        let text = START.to_owned()
            + &gear("X", "Y", "")
            + &relative("Y", 50.0)
            + &out("X", "")
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
        assert!(moved > 1400, "{told}: {moved}");
        let last = both(setpoints.last().unwrap());
        near(last[0][0], 170.0, 1e-9);
        near(last[1][0], 120.0, 1e-9);
    }
}

fn refused(text: &str) -> Finding {
    let (_, mut findings) = run(&job(text), &machine());
    assert_eq!(findings.len(), 1, "{findings:?}");
    findings.remove(0)
}

/// A ring that exists is refused where the block begins that closes it, whatever stands before it in the file.
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
    let more = gear("Z", "X", "with_previous = true\n");
    let found = refused(&(head.clone() + &more + &gear("Y", "Z", "with_previous = true\n")));
    assert_eq!(found.line, lines(&(head.clone() + &more)) + 2);
    assert!(found.message.ends_with("X -> Z -> Y -> X"), "{}", found.message);
    // The one that closes it may stand before the one that it closes it with.
    let late = START.to_owned() + &gear("Y", "X", "at_s = 0.5\n") + &gear("X", "Y", "at_s = 0.1\n");
    let found = refused(&late);
    assert_eq!((found.line, found.axis.as_deref()), (lines(START) + 2, Some("Y")));
    // A coupling of the machine file that nobody lets go is one, too.
    let machine_file =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/gantry3.toml");
    let geared = std::fs::read_to_string(&machine_file).unwrap()
        + "\n[[gears]]\naxis = \"Y\"\nmaster = \"X\"\nratio_numerator = 1\n";
    let machine = twin_machine::Machine::parse(&machine_file, &geared).unwrap();
    let ring = gear("X", "Y", "");
    let (_, findings) = run(&job(&ring), &machine);
    assert_eq!((findings[0].rule, findings[0].line), (Rule::Coupling, 2), "{findings:?}");
    let (_, findings) = run(&job(&(out("Y", "") + &ring + &relative("Y", 5.0))), &machine);
    assert_eq!(findings, []);
}

/// However many blocks a job has: those that are over, and those that have not begun, are not called.
#[test]
fn only_blocks_under_way_are_called() {
    let steps = 1_500_u32;
    let step = |index: u32| {
        let way = if index.is_multiple_of(2) { 0.01 } else { -0.01 };
        format!(
            "[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"X\"\ndistance_mm = {way:?}\nvelocity_mm_per_s = 50\n"
        )
    };
    let text = START.to_owned() + &(0..steps).map(step).collect::<String>();
    let job = job(&text);
    let machine = machine();
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
