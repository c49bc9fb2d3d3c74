//! Tests of the order of axes and of the start times of blocks.

use super::order::masters_first;
use super::schedule::Schedule;
use crate::job::block::moving;
use crate::job::{Begins, Call};
use twin_axis::Halt;

#[test]
fn masters_come_before_their_slaves() {
    assert_eq!(masters_first(&[], 3), Ok(vec![0, 1, 2]));
    assert_eq!(masters_first(&[(2, 1), (1, 0)], 3), Ok(vec![2, 1, 0]));
    assert_eq!(masters_first(&[(3, 0), (3, 1), (0, 1)], 4), Ok(vec![2, 3, 0, 1]));
    assert_eq!(masters_first(&[(0, 1), (1, 2), (2, 1)], 3), Err(vec![1, 2, 1]));
}

fn schedule(begins: &[Begins]) -> Schedule {
    let call = |begins: &Begins| Call {
        name: "MC_Halt",
        line: 1,
        axis: 0,
        master: None,
        block: moving(Halt { deceleration: 1.0 }),
        begins: *begins,
    };
    Schedule::new(&begins.iter().map(call).collect::<Vec<_>>())
}

fn due(schedule: &mut Schedule, now_ns: i64) -> Vec<usize> {
    std::iter::from_fn(|| schedule.next(now_ns)).collect()
}

#[test]
fn blocks_come_when_what_they_wait_for_has_happened() {
    use Begins::{After, At, EndOfProfile, Next, Standing, WithPrevious};
    let begins = [Standing, Next, WithPrevious, After(2e-9), At(5e-9), Next, EndOfProfile, Next];
    let mut plan = schedule(&begins);
    assert_eq!(due(&mut plan, 0), [0, 1]);
    // A coupling of the machine file has no next block, over or not.
    plan.over(0, 1);
    plan.begun(0, 1);
    assert!(due(&mut plan, 4).is_empty());
    plan.begun(1, 4);
    assert_eq!(due(&mut plan, 4), [2]);
    plan.over(1, 4);
    assert!(due(&mut plan, 4).is_empty(), "3 waits for 2");
    plan.over(2, 4);
    assert_eq!(due(&mut plan, 5), [4]);
    assert_eq!(due(&mut plan, 6), [3]);
    plan.over(4, 7);
    assert_eq!((due(&mut plan, 7), plan.is_empty()), (vec![5], true));
    // The cam starts 6.
    plan.over(5, 8);
    assert!(plan.is_empty());
    plan.over(6, 9);
    assert_eq!(due(&mut plan, 9), [7]);
}

#[test]
fn who_waits_for_whom() {
    use Begins::{At, EndOfProfile, Next, WithPrevious};
    let plan = schedule(&[Next, Next, WithPrevious, Next, At(1.0), Next, WithPrevious, Next]);
    let waits = |index: usize| -> Vec<usize> {
        (index + 1..8).filter(|later| plan.waits_for(index, *later)).collect()
    };
    assert_eq!(waits(0), [1, 2, 3]);
    // 2 begins with it, and 3 waits for that one.
    assert!(waits(1).is_empty());
    assert_eq!(waits(4), [5, 6, 7]);
    let plan = schedule(&[Next, Next, EndOfProfile, Next]);
    assert_eq!([1, 2, 3].map(|later| plan.waits_for(0, later)), [true, false, false]);
}
