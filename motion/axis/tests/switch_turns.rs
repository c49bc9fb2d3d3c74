//! Tests of cam switches on an axis that reverses or jitters (manual 5.5: a hysteresis keeps an output from switching
//! on and off while an axis oscillates).

use super::rig::{CYCLE, Rig, endless, linear, rotary};
use crate::{Block, CamSwitch, DigitalCamSwitch, Follow, SwitchDirection, Track};

fn range(first_on: f64, last_on: f64, direction: SwitchDirection) -> CamSwitch {
    CamSwitch { track: 1, first_on, last_on, direction, duration: None }
}

fn with_hysteresis(hysteresis: f64) -> Track {
    Track { hysteresis, ..Track::default() }
}

/// Output 0 at each place of the way, a cycle apart, at the velocity of its last step.
fn shown(mut rig: Rig, switch: CamSwitch, track: Track, way: &[f64]) -> Vec<bool> {
    let mut tracks = [Track::default(); 32];
    tracks[0] = track;
    let mut block = DigitalCamSwitch::new(&[switch], tracks);
    let mut go = Block::new(Follow::Position(way[0]));
    rig.call(&mut go.clone(), true);
    let mut before = way[0];
    way.iter()
        .map(|place| {
            go.inputs = Follow::PositionVelocity(*place, (place - before) / CYCLE);
            before = *place;
            rig.call(&mut go, true);
            block.call(true, &rig.axis).outputs[0]
        })
        .collect()
}

/// Where output 0 changes along the way.
fn changes(rig: Rig, switch: CamSwitch, track: Track, way: &[f64]) -> Vec<(f64, bool)> {
    let shown = shown(rig, switch, track, way);
    let mut before = false;
    let mut changes = Vec::new();
    for (place, shown) in way.iter().zip(shown) {
        if shown != before {
            changes.push((*place, shown));
        }
        before = shown;
    }
    changes
}

/// From place to place by quarters of a unit, which are exact: 25 u/s.
fn by_quarters(places: &[f64]) -> Vec<f64> {
    let mut way = vec![places[0]];
    for place in &places[1..] {
        let from = *way.last().expect("the first");
        let by = 0.25 * (place - from).signum();
        let steps = std::iter::successors(Some(from + by), |at| Some(at + by));
        way.extend(steps.take_while(|at| (place - at) * by >= 0.0));
    }
    way
}

/// Forth to `to`, then 20 times back by 0.75 u and forth again.
fn jittering(from: f64, to: f64) -> Vec<f64> {
    let forwards = if to > from { 1.0 } else { -1.0 };
    let mut places = vec![from, to];
    for _ in 0..20 {
        places.extend([to - 0.75 * forwards, to]);
    }
    by_quarters(&places)
}

/// The manual's example: output 1 forwards from 0 to 100 and backwards from 300 to 200, output 2 either way from 100 to 300,
/// output 3 for 2 s from 10 on.
#[test]
fn the_manuals_switches() {
    use SwitchDirection::{Both, Negative, Positive};
    let second = CamSwitch { track: 2, ..range(100.0, 300.0, Both) };
    let third = CamSwitch { track: 3, duration: Some(2.0), ..range(10.0, 0.0, Both) };
    let switches = [range(200.0, 300.0, Negative), second, third, range(0.0, 100.0, Positive)];
    let mut block = DigitalCamSwitch::new(&switches, [Track::default(); 32]);
    let mut rig = linear();
    let mut go = Block::new(Follow::Position(0.0));
    // 25 u/s: 50 u in 2 s.
    let way = by_quarters(&[-20.0, 320.0, -20.0]);
    let top = way.iter().position(|place| *place == 320.0).expect("the top");
    for (index, place) in way.iter().copied().enumerate() {
        let forwards = index <= top;
        go.inputs = Follow::Position(place);
        rig.call(&mut go, true);
        let outputs = block.call(true, &rig.axis).outputs;
        let first = if forwards { 0.0..=100.0 } else { 200.0..=300.0 };
        assert_eq!(outputs[0], first.contains(&place), "{place} {forwards}");
        assert_eq!(outputs[1], (100.0..=300.0).contains(&place), "{place} {forwards}");
        let third = if forwards { 10.0..60.0 } else { -20.0..10.25 };
        assert_eq!(outputs[2], third.contains(&place), "{place} {forwards}");
        assert!(outputs[3..].iter().all(|on| !on));
    }
}

/// Jitter by less than the hysteresis switches nothing, anywhere in the range and at its ends; without a hysteresis it does.
#[test]
fn jitter_does_not_turn_a_switch() {
    use SwitchDirection::{Both, Negative, Positive};
    for to in [100.25, 100.5, 150.0, 200.0, 200.5] {
        let shown = |direction| {
            let (switch, way) = (range(100.0, 200.0, direction), jittering(90.0, to));
            changes(linear(), switch, with_hysteresis(1.0), &way)
        };
        assert_eq!(shown(Positive), [(100.0, true)], "{to}");
        assert_eq!(shown(Both), [(100.0, true)], "{to}");
        assert_eq!(shown(Negative), [], "{to}");
        let shown = |direction| {
            let (switch, way) = (range(100.0, 200.0, direction), jittering(210.0, 300.0 - to));
            changes(linear(), switch, with_hysteresis(1.0), &way)
        };
        assert_eq!(shown(Negative), [(200.0, true)], "{to}");
        assert_eq!(shown(Positive), [], "{to}");
    }
    let way = jittering(90.0, 150.0);
    let turns = changes(linear(), range(100.0, 200.0, Positive), Track::default(), &way);
    assert_eq!(turns.len(), 41, "{turns:?}");
}

/// More than the hysteresis back from the farthest point the axis has turned: one direction's output is off, the other's on.
#[test]
fn a_switch_turns_beyond_the_hysteresis() {
    use SwitchDirection::{Both, Negative, Positive};
    let way = by_quarters(&[90.0, 110.0, 109.0, 112.0, 90.0, 93.0]);
    let shown = |direction, hysteresis| {
        changes(linear(), range(100.0, 200.0, direction), with_hysteresis(hysteresis), &way)
    };
    assert_eq!(shown(Positive, 2.0), [(100.0, true), (109.75, false)]);
    assert_eq!(shown(Negative, 2.0), [(109.75, true), (97.75, false)]);
    assert_eq!(shown(Both, 2.0), [(100.0, true), (97.75, false)]);
    let turns = [(100.0, true), (109.75, false), (109.25, true), (111.75, false)];
    assert_eq!(shown(Positive, 0.0), turns);
    // Forwards again: 3 u from the farthest point on the way back are enough, 2 u are not.
    let way = by_quarters(&[90.0, 150.0, 110.0, 112.0, 109.0, 115.0]);
    let shown =
        |direction| changes(linear(), range(100.0, 200.0, direction), with_hysteresis(2.0), &way);
    assert_eq!(shown(Positive), [(100.0, true), (147.75, false), (111.25, true)]);
    assert_eq!(shown(Negative), [(147.75, true), (111.25, false)]);
}

/// Turning and jittering over the end of the period is the same as elsewhere.
#[test]
fn a_switch_turns_over_the_end_of_the_period() {
    use SwitchDirection::{Negative, Positive};
    for (start, end) in [(350.0, 20.0), (20.0, 50.0)] {
        // 10 u after the begin of the range, which for the first one is at the end of the period.
        let switch = |direction| range(start, end, direction);
        let begin = start - 5.0;
        let wrapped = |way: Vec<f64>| way.iter().map(|at| at.rem_euclid(360.0)).collect::<Vec<_>>();
        let way = wrapped(jittering(begin, start + 10.25));
        let shown = |direction| changes(rotary(), switch(direction), with_hysteresis(1.0), &way);
        assert_eq!(shown(Positive), [(start, true)]);
        assert_eq!(shown(Negative), []);
        let way = wrapped(by_quarters(&[begin, start + 10.5, begin]));
        let shown = |direction| changes(rotary(), switch(direction), with_hysteresis(1.0), &way);
        let turned = (start + 9.25_f64).rem_euclid(360.0);
        assert_eq!(shown(Positive), [(start, true), (turned, false)]);
        assert_eq!(shown(Negative), [(turned, true), (start - 1.25, false)]);
    }
}

/// An advance holds while an axis jitters and ends when it turns: 0.2 s at 25 u/s are 5 u.
#[test]
fn jitter_takes_no_advance_back() {
    use SwitchDirection::{Both, Negative, Positive};
    let track = |on_compensation, off_compensation| Track {
        on_compensation,
        off_compensation,
        hysteresis: 1.0,
    };
    // Seen inside at 95, 1.25 u before 98.25 it has turned, and has never been inside.
    let way = [jittering(90.0, 98.25), by_quarters(&[98.0, 90.0])].concat();
    let shown = |direction, track| changes(linear(), range(100.0, 200.0, direction), track, &way);
    for track in [track(-0.2, 0.0), track(-0.2, -0.2)] {
        for direction in [Both, Positive] {
            assert_eq!(shown(direction, track), [(95.0, true), (97.0, false)], "{track:?}");
        }
        assert_eq!(shown(Negative, track), [], "{track:?}");
    }
    // Seen 1.25 u beyond the end, with the hysteresis, at 196.25; backwards it is inside to where 5 u ahead is beyond 99.
    let way = [jittering(90.0, 198.25), by_quarters(&[198.0, 90.0])].concat();
    let shown =
        |direction| changes(linear(), range(100.0, 200.0, direction), track(0.0, -0.2), &way);
    assert_eq!(shown(Positive), [(100.0, true), (196.25, false)]);
    assert_eq!(shown(Both), [(100.0, true), (196.25, false), (197.0, true), (103.75, false)]);
    assert_eq!(shown(Negative), [(197.0, true), (103.75, false)]);
}

/// A switch enabled at rest takes the direction of the last motion; motion within the hysteresis does not change it, and a
/// switch for both directions does not wait for that.
#[test]
fn a_switch_that_is_enabled_at_rest_knows_the_direction_of_the_last_motion() {
    use SwitchDirection::{Both, Negative, Positive};
    for (velocity, expected) in [(50.0, [true, true, false]), (-50.0, [true, false, true])] {
        for (direction, expected) in [Both, Positive, Negative].into_iter().zip(expected) {
            let (mut rig, mut go) = (linear(), endless(velocity));
            let mut halt = Block::new(crate::Halt { deceleration: 100.0 });
            rig.calls(100, &mut go);
            rig.until(|axis| [go.call(true, axis), halt.call(true, axis)][1].done);
            let switch = range(-500.0, 500.0, direction);
            let mut block = DigitalCamSwitch::new(&[switch], [with_hysteresis(1.0); 32]);
            let shown = block.call(true, &rig.axis).outputs[0];
            assert_eq!(shown, expected, "{velocity} {direction:?}");
        }
    }
    let way = by_quarters(&[200.5, 198.0]);
    let both = changes(linear(), range(100.0, 200.0, Both), with_hysteresis(2.0), &way);
    assert_eq!(both, [(200.0, true)]);
    let negative = changes(linear(), range(100.0, 200.0, Negative), with_hysteresis(2.0), &way);
    assert_eq!(negative, [(198.25, true)]);
}

/// Where output 0 is off in the fourth turn at 50 u/s, u from its begin.
fn off_in_a_turn(switch: CamSwitch, track: Track) -> Vec<f64> {
    let way: Vec<_> = (0..4 * 720).map(|cycle| f64::from(cycle) * 0.5).collect();
    let wrapped: Vec<_> = way.iter().map(|at| at.rem_euclid(360.0)).collect();
    let shown = shown(rotary(), switch, track, &wrapped);
    let turn = way.iter().zip(shown).skip(3 * 720);
    turn.filter(|(_, shown)| !shown).map(|(at, _)| at - 1080.0).collect()
}

/// A switch longer than a period reaches over its next begin: it is off only if its advance, at 50 u/s, ends it before
/// that.
#[test]
fn a_switch_longer_than_a_period_may_be_switched_off_earlier_or_on_later() {
    let off = |last_on, on, off| {
        let track = Track { on_compensation: on, off_compensation: off, hysteresis: 0.0 };
        off_in_a_turn(range(90.0, last_on, SwitchDirection::Both), track)
    };
    for (last_on, on_later, off_later) in [
        // 400 u long, off 20 u earlier: on until 110, where it has been on again since 90.
        (490.0, 0.0, -0.4),
        (490.0, -0.4, -0.4),
        (450.0, 0.4, 0.4),
        (450.0, 0.0, 0.4),
        (490.0, 0.4, 0.0),
    ] {
        assert!(off(last_on, on_later, off_later).is_empty(), "{last_on} {on_later} {off_later}");
    }
    for (last_on, on_later, off_later, [from, to]) in [
        // 60 u earlier: on until 70. Both 20 u earlier: from 70 on.
        (490.0, 0.0, -1.2, [70.0, 90.0]),
        (490.0, -0.4, -1.6, [50.0, 70.0]),
        (450.0, 0.0, -0.4, [70.0, 90.0]),
        // More than two periods: 750 u, off 440 u earlier.
        (840.0, 0.0, -8.8, [40.0, 90.0]),
        // On 20 u later, off where the next one begins.
        (450.0, 0.4, 0.0, [90.0, 110.0]),
        // On 60 u later: 40 u beyond the next begin it is still on.
        (490.0, 1.2, 0.0, [130.0, 150.0]),
        // On 20 u later and off 40 u earlier.
        (490.0, 0.4, -0.8, [90.0, 110.0]),
        (490.0, 0.4, -1.6, [50.0, 110.0]),
    ] {
        let off = off(last_on, on_later, off_later);
        let [first, last] = [off[0], off[off.len() - 1]];
        assert!((first - from).abs() <= 0.5 && (last - to).abs() <= 0.5, "{off:?}");
        assert!(off.windows(2).all(|pair| pair[1] - pair[0] == 0.5), "one gap: {off:?}");
    }
}
