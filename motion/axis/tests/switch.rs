//! Tests of cam switches along an axis (manual 5.5).

use super::*;
use crate::SwitchDirection::{Both, Negative, Positive};

fn range(first_on: f64, last_on: f64) -> CamSwitch {
    CamSwitch { track: 1, first_on, last_on, direction: Both, duration: None }
}

fn one_way(direction: SwitchDirection) -> CamSwitch {
    CamSwitch { direction, ..range(100.0, 200.0) }
}

/// On for a time, s, from a place on.
fn timed(duration: f64) -> CamSwitch {
    CamSwitch { duration: Some(duration), ..range(100.0, 0.0) }
}

/// Switches on and off later, s.
fn later(on_compensation: f64, off_compensation: f64) -> Track {
    Track { on_compensation, off_compensation, hysteresis: 0.0 }
}

fn sticky(hysteresis: f64) -> Track {
    Track { hysteresis, ..Track::default() }
}

/// The cycles in which output 0 changes, from off, along a way of positions and velocities.
fn changed(mut rig: Rig, switch: CamSwitch, track: Track, way: &[(f64, f64)]) -> Vec<usize> {
    let mut block = DigitalCamSwitch::new(&[switch], [track; 32]);
    rig.calls(2, &mut Block::new(Follow::Position(way[0].0)));
    let (mut go, mut before) = (Block::new(Follow::Position(0.0)), false);
    let changes = |(_, (position, velocity)): &(usize, &(f64, f64))| {
        go.inputs = Follow::PositionVelocity(*position, *velocity);
        rig.call(&mut go, true);
        let now = block.call(true, &rig.axis).outputs[0];
        std::mem::replace(&mut before, now) != now
    };
    way.iter().enumerate().filter(changes).map(|(cycle, _)| cycle).collect()
}

/// The places at which output 0 changes, along a way from place to place.
fn changes(rig: Rig, switch: CamSwitch, track: Track, places: &[f64]) -> Vec<f64> {
    let steps = places.iter().scan(places[0], |before, place| {
        let way = place - std::mem::replace(before, *place);
        Some((*place, way / CYCLE))
    });
    let cycles = changed(rig, switch, track, &steps.collect::<Vec<_>>());
    cycles.into_iter().map(|cycle| places[cycle]).collect()
}

/// Output 0 in the third turn at this velocity: its value at the begin, and where it changes.
fn in_a_turn(switch: CamSwitch, track: Track, velocity: f64) -> (bool, Vec<f64>) {
    let way = |cycle: u16| f64::from(cycle) * velocity * CYCLE;
    let way: Vec<_> = (0..3 * 720).map(|cycle| (way(cycle).rem_euclid(360.0), velocity)).collect();
    let all = changed(rotary(), switch, track, &way);
    let before = all.iter().filter(|cycle| **cycle < 2 * 720).count();
    (before % 2 == 1, all[before..].iter().map(|cycle| way[*cycle].0).collect())
}

/// On and off once a turn at 50 u/s: 0.2 s are 10 u. A delay is positive, an advance negative (manual 5.5).
#[test]
fn switches_of_a_turning_axis() {
    let (plain, forwards, back) = (Track::default(), 50.0, -50.0);
    let (middle, long) = (range(100.0, 200.0), range(0.0, 300.0));
    for (switch, track, velocity, [on, off]) in [
        (middle, plain, forwards, [100.0, 200.0]),
        (middle, plain, back, [200.0, 100.0]),
        (range(300.0, 40.0), plain, forwards, [300.0, 40.0]),
        (one_way(Negative), plain, back, [200.0, 100.0]),
        (middle, later(0.2, -0.4), forwards, [110.0, 180.0]),
        (middle, later(0.2, -0.4), back, [190.0, 120.0]),
        (middle, sticky(3.0), forwards, [100.0, 203.0]),
        // Further than half a turn ahead, over the end of the period.
        (long, later(0.0, 0.8), forwards, [0.0, 340.0]),
        (long, later(0.0, 0.8), back, [300.0, 320.0]),
        (long, later(-0.8, 0.0), forwards, [320.0, 300.0]),
        (long, later(-0.8, 0.0), back, [340.0, 0.0]),
        (long, later(-0.8, -0.8), forwards, [320.0, 260.0]),
        // 0.5 s are 25 u; switching on and off are compensated alike.
        (timed(0.5), plain, forwards, [100.0, 125.0]),
        (timed(0.5), later(0.0, 0.2), forwards, [100.0, 135.0]),
        (timed(0.5), later(0.0, -0.2), forwards, [100.0, 115.0]),
        (timed(0.5), later(0.4, 0.2), back, [80.0, 45.0]),
        // 40 u longer than a period, off 60 u earlier: on until 70. Both 20 u earlier: from 70 on.
        (range(90.0, 490.0), later(0.0, -1.2), forwards, [90.0, 70.0]),
        (range(90.0, 490.0), later(-0.4, -1.6), forwards, [70.0, 50.0]),
        (range(90.0, 450.0), later(0.0, -0.4), forwards, [90.0, 70.0]),
        // More than two periods: 750 u, off 440 u earlier.
        (range(90.0, 840.0), later(0.0, -8.8), forwards, [90.0, 40.0]),
        // On 20 u later, off where the next one begins; on 60 u later: 40 u beyond the next begin it is still on.
        (range(90.0, 450.0), later(0.4, 0.0), forwards, [110.0, 90.0]),
        (range(90.0, 490.0), later(1.2, 0.0), forwards, [150.0, 130.0]),
        // On 20 u later and off 40 u earlier.
        (range(90.0, 490.0), later(0.4, -0.8), forwards, [110.0, 90.0]),
        (range(90.0, 490.0), later(0.4, -1.6), forwards, [110.0, 50.0]),
    ] {
        let (is_on, changes) = in_a_turn(switch, track, velocity);
        assert_eq!(changes.len(), 2, "{switch:?} {track:?}: {changes:?}");
        for (at, expected) in changes.iter().zip(if is_on { [off, on] } else { [on, off] }) {
            let off_by = short(&rotary().axis, at - expected);
            assert!(off_by.abs() <= 0.5 + 1e-6, "{switch:?} {track:?}: {changes:?}");
        }
    }
    for (switch, track, always) in [
        (one_way(Negative), plain, false),
        // On until after it is on again; off before it is on.
        (long, later(0.0, 1.4), true),
        (range(0.0, 10.0), later(0.4, 0.0), false),
        (timed(0.5), later(0.0, -0.6), false),
        // A whole period, and more.
        (range(0.0, 360.0), plain, true),
        (range(100.0, 460.0), plain, true),
        (range(-400.0, 400.0), plain, true),
        // 400 u long, off 20 u earlier: on until 110, where it has been on again since 90.
        (range(90.0, 490.0), later(0.0, -0.4), true),
        (range(90.0, 490.0), later(-0.4, -0.4), true),
        (range(90.0, 450.0), later(0.4, 0.4), true),
        (range(90.0, 450.0), later(0.0, 0.4), true),
        (range(90.0, 490.0), later(0.4, 0.0), true),
    ] {
        assert_eq!(in_a_turn(switch, track, 50.0), (always, vec![]), "{switch:?} {track:?}");
    }
}

/// An axis that oscillates about the place starts the time once; beyond the hysteresis and back, once more.
#[test]
fn a_timed_switch_has_a_hysteresis() {
    let way = (0..400_u32).map(|cycle| match cycle {
        // On 100 at 0.01 s, and every 0.1 s again; at 2.5 s back to 98, from 2.7 s on 100 again.
        0 => 99.5,
        1..250 if cycle % 10 < 5 => 100.2,
        250..270 => 98.0,
        270.. => 100.2,
        _ => 99.8,
    });
    let way: Vec<_> = way.map(|place| (place, 0.0)).collect();
    assert_eq!(changed(rotary(), timed(0.5), sticky(1.0), &way), [1, 51, 270, 320]);
}

#[test]
fn outputs_can_be_masked_and_disabled() {
    let (mut rig, mut moving) = (rotary(), endless(50.0));
    rig.call(&mut moving, true);
    let second = CamSwitch { track: 2, ..range(0.0, 350.0) };
    let mut block = DigitalCamSwitch::new(&[range(0.0, 350.0), second], [Track::default(); 32]);
    let shown = block.call(true, &rig.axis);
    assert!(shown.in_operation && shown.outputs[0] && shown.outputs[1] && !shown.outputs[2]);
    block.enable_mask = 1;
    assert_eq!(block.call(true, &rig.axis).outputs[..2], [true, false]);
    let shown = block.call(false, &rig.axis);
    assert!(!shown.in_operation && !shown.outputs[0]);
}

#[test]
fn set_or_actual_positions_count_as_asked() {
    let first = [TappetMode::Auto, TappetMode::Demand, TappetMode::Actual].map(|mode| {
        let (mut rig, mut moving) = (rotary(), endless(50.0));
        let mut block = DigitalCamSwitch::new(&[range(10.0, 20.0)], [Track::default(); 32]);
        block.mode = mode;
        rig.until(|axis| {
            moving.call(true, axis);
            block.call(true, axis).outputs[0]
        })
    });
    // The virtual drive is one cycle behind.
    assert_eq!([first[1] - first[0], first[2] - first[0]], [0, 1]);
}

/// Position and velocity at a time, s.
type Way = Box<dyn Fn(f64) -> (f64, f64)>;

/// From rest at `start` with 1000 u/s².
fn starting(start: f64) -> Way {
    Box::new(move |t| (start + 500.0 * t * t, 1000.0 * t))
}

/// With `velocity` through 100 at 0.054 s, then to rest `beyond` behind it.
fn braking(velocity: f64, beyond: f64) -> Way {
    let rate = velocity * velocity / (2.0 * beyond);
    Box::new(move |t| match t - 0.054 {
        t if t < 0.0 => (100.0 + velocity * t, velocity),
        t if t < velocity / rate => {
            (100.0 + velocity * t - 0.5 * rate * t * t, velocity - rate * t)
        }
        _ => (100.0 + beyond, 0.0),
    })
}

/// To `peak` at 0.1 s and back, with 1000 u/s².
fn turning(peak: f64) -> Way {
    Box::new(move |t| (peak - 500.0 * (t - 0.1) * (t - 0.1), -1000.0 * (t - 0.1)))
}

/// A delay is one of switching, in seconds (manual 5.5), whatever the axis does meanwhile. An advance looks where the axis
/// will be at its present velocity; braking switches nothing back. The cycles of 60 in which it is on.
#[test]
fn compensations_are_times() {
    let (switch, short) = (range(100.0, 200.0), timed(0.05));
    for (switch, track, way, on) in [
        // Behind the end, off; beyond it there is nothing to switch.
        (switch, later(0.0, 0.1), starting(201.0), &[][..]),
        // Inside, on: nothing is switched before the end, at 0.445 s.
        (switch, later(0.1, 0.0), starting(101.0), &[0, 45][..]),
        (switch, later(0.0, 0.1), starting(101.0), &[0, 55][..]),
        // Inside from 0.06 s on, where it stays.
        (switch, later(0.1, 0.0), braking(10.0, 0.55), &[16][..]),
        (switch, later(0.1, 0.0), braking(10.0, 2.2), &[16][..]),
        // Inside from 0.0225 s to 0.1775 s, and out where it has come in.
        (switch, later(0.0, 0.0), turning(103.0), &[3, 18][..]),
        (switch, later(0.1, 0.1), turning(103.0), &[13, 28][..]),
        (switch, later(0.1, 0.0), turning(103.0), &[13, 18][..]),
        (switch, later(0.0, 0.3), turning(103.0), &[3, 48][..]),
        (switch, later(0.2, 0.0), turning(103.0), &[][..]),
        // Passed at 0.054 s, on from 0.154 s to 0.204 s, wherever it is by then.
        (short, later(0.1, 0.0), braking(10.0, 0.55), &[16, 21][..]),
        (short, later(0.1, 0.0), braking(20.0, 2.2), &[16, 21][..]),
        // Forth at 0.0225 s, back at 0.1775 s.
        (short, later(0.1, 0.0), turning(103.0), &[13, 18, 28, 33][..]),
        // 99 + 500 t² + 50 t is 100 at 0.017 s; it is beyond 200 at 0.4494 s.
        (switch, later(-0.05, 0.0), starting(99.0), &[2, 45][..]),
        // Seen inside at 0.02 s; it does not come there, and is off from when it turns.
        (switch, later(-0.05, 0.0), turning(99.5), &[2, 11][..]),
        // Seen beyond the end at 0.03 s, where it does not come; from when it turns it is inside again, until it is seen
        // beyond the other end: 199 − 500 t² − 50 t is 100 at 0.398 s.
        (switch, later(0.0, -0.05), turning(199.0), &[0, 3, 11, 50][..]),
        // A time begins once, where it is seen to come to 100: between 0.01 s and 0.02 s.
        (short, later(-0.05, 0.0), turning(99.5), &[2, 7][..]),
    ] {
        let way: Vec<_> = (0..60_u32).map(|cycle| way(f64::from(cycle) * CYCLE)).collect();
        assert_eq!(changed(linear(), switch, track, &way), on, "{switch:?} {track:?}");
    }
}

/// `MC_SetPosition` moves the zero, not the axis: what is on at the new place is, and nothing has been passed.
#[test]
fn a_zero_that_moves_passes_nothing() {
    let second = CamSwitch { track: 2, ..range(140.0, 160.0) };
    let (mut rig, mut block) =
        (linear(), DigitalCamSwitch::new(&[timed(0.05), second], [Track::default(); 32]));
    rig.cycle(|_| ());
    assert_eq!(block.call(true, &rig.axis).outputs[..2], [false; 2]);
    rig.cycle(|axis| axis.shift_zero(150.0, false).expect("a number"));
    assert_eq!(block.call(true, &rig.axis).outputs[..2], [false, true]);
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
    let back = to - 0.75 * (to - from).signum();
    let jitter = std::iter::repeat_n([back, to], 20).flatten();
    by_quarters(&[from, to].into_iter().chain(jitter).collect::<Vec<_>>())
}

fn both_ways(on_compensation: f64, off_compensation: f64) -> Track {
    Track { on_compensation, off_compensation, hysteresis: 1.0 }
}

/// Changes of the outputs for both directions, forwards and backwards along a way, with a range from 100 to 200.
#[test]
fn a_hysteresis_takes_jitter_for_no_turn() {
    let mut rows = vec![
        // More than the hysteresis back from the farthest point the axis has turned.
        (
            by_quarters(&[90.0, 110.0, 109.0, 112.0, 90.0, 93.0]),
            sticky(2.0),
            [&[100.0, 97.75][..], &[100.0, 109.75], &[109.75, 97.75]],
        ),
        // Forwards again: 3 u from the farthest point on the way back are enough, 2 u are not.
        (
            by_quarters(&[90.0, 150.0, 110.0, 112.0, 109.0, 115.0]),
            sticky(2.0),
            [&[100.0], &[100.0, 147.75, 111.25], &[147.75, 111.25]],
        ),
        // Seen 1.25 u beyond the end, with the hysteresis, at 196.25; backwards it is inside to where 5 u ahead is beyond 99.
        (
            [jittering(90.0, 198.25), by_quarters(&[198.0, 90.0])].concat(),
            both_ways(0.0, -0.2),
            [&[100.0, 196.25, 197.0, 103.75], &[100.0, 196.25], &[197.0, 103.75]],
        ),
    ];
    // An advance holds while an axis jitters and ends when it turns: 0.2 s at 25 u/s are 5 u. Seen inside at 95, 1.25 u
    // before 98.25 it has turned, and has never been inside.
    for off_compensation in [0.0, -0.2] {
        let way = [jittering(90.0, 98.25), by_quarters(&[98.0, 90.0])].concat();
        rows.push((way, both_ways(-0.2, off_compensation), [&[95.0, 97.0], &[95.0, 97.0], &[]]));
    }
    // Jitter by less than the hysteresis switches nothing, anywhere in the range and at its ends.
    for to in [100.25, 100.5, 150.0, 200.0, 200.5] {
        rows.push((jittering(90.0, to), sticky(1.0), [&[100.0], &[100.0], &[]]));
        rows.push((jittering(210.0, 300.0 - to), sticky(1.0), [&[200.0], &[], &[200.0]]));
    }
    for (way, track, expected) in rows {
        for (direction, expected) in [Both, Positive, Negative].into_iter().zip(expected) {
            let found = changes(linear(), one_way(direction), track, &way);
            assert_eq!(found, expected, "{direction:?} {track:?} {way:?}");
        }
    }
    // Without a hysteresis it does, and every turn counts.
    let without = |way: &[f64]| changes(linear(), one_way(Positive), Track::default(), way);
    assert_eq!(without(&jittering(90.0, 150.0)).len(), 41);
    let turns = without(&by_quarters(&[90.0, 110.0, 109.0, 112.0, 90.0, 93.0]));
    assert_eq!(turns, [100.0, 109.75, 109.25, 111.75]);
}

#[test]
fn a_switch_turns_over_the_end_of_the_period() {
    for (start, end) in [(350.0, 20.0), (20.0, 50.0)] {
        // 10 u after the begin of the range, which for the first one is at the end of the period.
        let begin = start - 5.0;
        let shown = |direction, way: Vec<f64>| {
            let way: Vec<_> = way.iter().map(|at| at.rem_euclid(360.0)).collect();
            let switch = CamSwitch { direction, ..range(start, end) };
            changes(rotary(), switch, sticky(1.0), &way)
        };
        assert_eq!(shown(Positive, jittering(begin, start + 10.25)), [start]);
        assert_eq!(shown(Negative, jittering(begin, start + 10.25)), []);
        let back = || by_quarters(&[begin, start + 10.5, begin]);
        let turned = (start + 9.25_f64).rem_euclid(360.0);
        assert_eq!(shown(Positive, back()), [start, turned]);
        assert_eq!(shown(Negative, back()), [turned, start - 1.25]);
    }
}

/// Motion within the hysteresis does not change it; a switch for both directions does not wait for it.
#[test]
fn a_switch_that_is_enabled_at_rest_knows_the_direction_of_the_last_motion() {
    for (velocity, expected) in [(50.0, [true, true, false]), (-50.0, [true, false, true])] {
        for (direction, expected) in [Both, Positive, Negative].into_iter().zip(expected) {
            let (mut rig, mut go) = (linear(), endless(velocity));
            let mut halt = Block::new(Halt { deceleration: 100.0 });
            rig.calls(100, &mut go);
            rig.until(|axis| [go.call(true, axis), halt.call(true, axis)][1].done);
            let switch = CamSwitch { direction, ..range(-500.0, 500.0) };
            let mut block = DigitalCamSwitch::new(&[switch], [sticky(1.0); 32]);
            let shown = block.call(true, &rig.axis).outputs[0];
            assert_eq!(shown, expected, "{velocity} {direction:?}");
        }
    }
    let way = by_quarters(&[200.5, 198.0]);
    for (direction, on) in [(Both, 200.0), (Negative, 198.25)] {
        assert_eq!(changes(linear(), one_way(direction), sticky(2.0), &way), [on]);
    }
}
