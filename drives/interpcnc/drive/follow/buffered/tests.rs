//! Tests of buffered following: samples that differ from the model, and the motion left in the board.

use super::*;
use crate::{
    BoardAxis,
    protocol::{parameters, registers::Status},
    tests::{MS, Plan, line, unlocked},
};

/// 3000 steps/s for ever, seen at an instant.
fn at_3000(now_ns: i64) -> impl SetpointStream {
    Plan::new(move || now_ns, 0, f64::INFINITY, line(3000.0))
}

fn stamp(executed_ns: i64) -> Stamp {
    Stamp {
        sent_ns: executed_ns - 4 * MS,
        executed_ns,
        uncertainty_ns: MS,
        answered_ns: executed_ns + 2 * MS,
    }
}

fn follower() -> Buffered {
    Buffered::new(&[AxisOptions::new(BoardAxis::X)], Line::default(), 200, 500)
}

/// What a segment goes to on X, steps.
fn target(order: &SegmentOrder) -> f64 {
    f64::from(order.targets[0].unwrap())
}

#[test]
fn nothing_is_sent_before_the_axes_have_been_seen_at_rest() {
    let mut follower = follower();
    assert!(follower.order(&at_3000(0), 0).is_none());
    // Something else is under way.
    follower.sampled(&stamp(0), [500].into_iter(), false);
    assert!(follower.order(&at_3000(0), 0).is_none());
    follower.sampled(&stamp(0), [500].into_iter(), true);
    assert!(follower.order(&at_3000(0), 0).is_some());
}

#[test]
fn a_target_is_on_the_plan_within_its_horizon() {
    let mut follower = follower();
    follower.sampled(&stamp(0), [0].into_iter(), true);
    let order = follower.order(&at_3000(10 * MS), 10 * MS).unwrap();
    assert!(target(&order) > 0.0 && target(&order) <= 3000.0 * 0.26 + 0.5, "{order:?}");
    // While it has enough to do it sends no other.
    follower.executed(&order, 10 * MS, &stamp(17 * MS));
    assert!(follower.order(&at_3000(20 * MS), 20 * MS).is_none());
}

#[test]
fn axes_that_were_stopped_on_the_way_go_on_from_where_they_are() {
    let mut follower = follower();
    follower.sampled(&stamp(0), [0].into_iter(), true);
    let order = follower.order(&at_3000(0), 0).unwrap();
    follower.executed(&order, 0, &stamp(7 * MS));
    // The board says that all is finished, far from the target and long before its time.
    follower.sampled(&stamp(30 * MS), [11].into_iter(), true);
    let again = follower.order(&at_3000(30 * MS), 30 * MS).unwrap();
    // The plan is 90 steps ahead by now; the way from 11 needs a speed that one from the old target does not.
    let modelled = follower.motions(&again, 40 * MS);
    let from = modelled.motions[0].at(40 * MS).position;
    assert!((from - 11.0).abs() < 1e-9, "{from}");
}

#[test]
fn the_model_goes_after_a_board_that_is_late() {
    let mut follower = follower();
    follower.sampled(&stamp(0), [0].into_iter(), true);
    let order = follower.order(&at_3000(0), 0).unwrap();
    follower.executed(&order, 0, &stamp(7 * MS));
    let before = follower.end_ns().unwrap();
    // In the middle of the segment the counter is what the model was 4 ms earlier.
    let middle = 7 * MS + (before - 7 * MS) / 2;
    let shown = follower.queue[0].motions[0].at(middle - 4 * MS).position;
    #[expect(clippy::cast_possible_truncation, reason = "small")]
    follower.sampled(&stamp(middle), [shown.round() as i32].into_iter(), false);
    let moved = follower.end_ns().unwrap() - before;
    assert!((900_000..1_500_000).contains(&moved), "{moved}");
}

#[test]
fn a_master_that_dies_leaves_no_more_than_the_horizon() {
    // Follower and board with exchanges of 7 ms, until the master dies after so many rounds.
    for rounds in 5..60 {
        let mut board = unlocked();
        board.set_parameter(parameters::DEFAULT_ACCELERATION, 500);
        let mut follower = follower();
        let mut now_ns = 0;
        for _ in 0..rounds {
            if let Some(order) = follower.order(&at_3000(now_ns), now_ns) {
                board.advance(7 * MS);
                board.send(&order.command()).unwrap();
                follower.executed(&order, now_ns, &stamp(now_ns + 7 * MS));
                now_ns += 9 * MS;
                board.advance(2 * MS);
            }
            board.advance(5 * MS);
            now_ns += 5 * MS;
            let finished = board.status().segments_finished();
            follower.sampled(&stamp(now_ns), [board.counters()[0]].into_iter(), finished);
            // Never more than one waits.
            let queued = board.status().has(Status::BUFFER_EMPTY);
            assert!(queued || follower.queue.len() <= 2);
        }
        let last = now_ns;
        board.advance(5000 * MS);
        let planned = 3000.0 * seconds(last + 260 * MS);
        assert!(f64::from(board.counters()[0]) <= planned, "{rounds} rounds");
        assert!(board.status().segments_finished());
    }
}
