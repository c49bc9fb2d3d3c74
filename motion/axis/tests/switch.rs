//! Tests of cam switches along an axis (manual 5.5).

use super::rig::{CYCLE, endless, linear, rotary, short};
use crate::{Block, CamSwitch, DigitalCamSwitch, Follow, SwitchDirection, TappetMode, Track};

fn range(first_on: f64, last_on: f64) -> CamSwitch {
    CamSwitch { track: 1, first_on, last_on, direction: SwitchDirection::Both, duration: None }
}

/// A switch of output 0 with options.
fn block(switch: CamSwitch, track: Track) -> DigitalCamSwitch {
    let mut tracks = [Track::default(); 32];
    tracks[0] = track;
    DigitalCamSwitch::new(&[switch], tracks)
}

/// Where output 0 is on over a turn at `velocity` u/s, u: begin and end, as seen.
fn on(switch: CamSwitch, track: Track, velocity: f64) -> Vec<[f64; 2]> {
    let (mut rig, mut moving, mut block) = (rotary(), endless(velocity), block(switch, track));
    let (mut spans, mut was, mut ended) = (Vec::<[f64; 2]>::new(), false, None);
    // In the first turn it gets up to speed; the second one, from 0 on, counts.
    let mut turned = 0.0;
    while turned < 720.0 {
        let before = rig.axis.set_position();
        rig.call(&mut moving, true);
        turned += short(&rig.axis, rig.axis.set_position() - before).abs();
        let shown = block.call(true, &rig.axis).outputs[0];
        if turned > 360.0 {
            let at = rig.axis.set_position();
            match (was, shown) {
                (false, true) => spans.push([at, f64::NAN]),
                (true, false) => match spans.last_mut() {
                    Some(span) => span[1] = at,
                    // It was on when the turn began.
                    None => ended = Some(at),
                },
                _ => {}
            }
        }
        was = shown;
    }
    if let (Some(span), Some(at)) = (spans.last_mut(), ended) {
        span[1] = at;
    }
    spans
}

/// One span from begin to end, to the way of a cycle.
fn near(spans: &[[f64; 2]], expected: [f64; 2]) {
    assert_eq!(spans.len(), 1, "{spans:?}");
    for (seen, expected) in spans[0].iter().zip(expected) {
        assert!(short(&rotary().axis, seen - expected).abs() <= 0.5 + 1e-6, "{spans:?}");
    }
}

/// The same of the spans that have an end: one that begins with the next turn has none yet.
fn meets(spans: &[[f64; 2]], expected: [f64; 2]) {
    let ended: Vec<_> = spans.iter().copied().filter(|span| !span[1].is_nan()).collect();
    near(&ended, expected);
}

#[test]
fn ranges_switch_in_both_directions_and_over_the_end() {
    let (plain, switch) = (Track::default(), range(100.0, 200.0));
    let one_way = CamSwitch { direction: SwitchDirection::Negative, ..switch };
    // On 0.2 s later (10 u at 50 u/s), off 0.4 s earlier.
    let moved = later(0.2, -0.4);
    let sticky = Track { hysteresis: 3.0, ..plain };
    for (switch, track, velocity, expected) in [
        (switch, plain, 50.0, [100.0, 200.0]),
        (switch, plain, -50.0, [200.0, 100.0]),
        (range(300.0, 40.0), plain, 50.0, [300.0, 40.0]),
        (one_way, plain, -50.0, [200.0, 100.0]),
        (switch, moved, 50.0, [110.0, 180.0]),
        (switch, moved, -50.0, [190.0, 120.0]),
        (switch, sticky, 50.0, [100.0, 203.0]),
    ] {
        near(&on(switch, track, velocity), expected);
    }
    assert_eq!(on(one_way, plain, 50.0).len(), 0);
}

/// Further than half a turn ahead: a delay is positive, an advance negative (manual 5.5), 40 u at 50 u/s.
#[test]
fn compensations_reach_over_the_end_of_the_period() {
    let long = range(0.0, 300.0);
    for (track, velocity, expected) in [
        (later(0.0, 0.8), 50.0, [0.0, 340.0]),
        (later(0.0, 0.8), -50.0, [300.0, 320.0]),
        (later(-0.8, 0.0), 50.0, [320.0, 300.0]),
        (later(-0.8, 0.0), -50.0, [340.0, 0.0]),
        (later(-0.8, -0.8), 50.0, [320.0, 260.0]),
    ] {
        meets(&on(long, track, velocity), expected);
    }
    // On until after it is on again; off before it is on.
    assert!(on(long, later(0.0, 1.4), 50.0).is_empty());
    assert!(is_always(long, later(0.0, 1.4), true));
    assert!(is_always(range(0.0, 10.0), later(0.4, 0.0), false));
}

/// True if output 0 has this value all the time on an axis at 50 u/s.
fn is_always(switch: CamSwitch, track: Track, shown: bool) -> bool {
    let (mut rig, mut moving, mut block) = (rotary(), endless(50.0), block(switch, track));
    (0..1_000).all(|cycle| {
        rig.call(&mut moving, true);
        block.call(true, &rig.axis).outputs[0] == shown || cycle < 100
    })
}

#[test]
fn a_whole_period_is_always_on() {
    for switch in [range(0.0, 360.0), range(100.0, 460.0), range(-400.0, 400.0)] {
        assert!(is_always(switch, Track::default(), true), "{switch:?}");
    }
    meets(&on(range(90.0, 450.0), later(0.0, -0.4), 50.0), [90.0, 70.0]);
}

/// On for 0.5 s, 25 u, from 100 on; switching on and off are compensated alike.
#[test]
fn a_timed_switch_stays_on_for_its_time() {
    let switch = CamSwitch { duration: Some(0.5), ..range(100.0, 0.0) };
    for (track, velocity, [begin, end]) in [
        (Track::default(), 50.0, [100.0, 125.0]),
        (later(0.0, 0.2), 50.0, [100.0, 135.0]),
        (later(0.0, -0.2), 50.0, [100.0, 115.0]),
        (later(0.4, 0.2), -50.0, [80.0, 45.0]),
    ] {
        let spans = on(switch, track, velocity);
        let [[from, to]] = spans[..] else { panic!("{spans:?}") };
        assert!((from - begin).abs() <= 0.5 && (to - end).abs() <= 1.0, "{spans:?}");
    }
    assert!(on(switch, later(0.0, -0.6), 50.0).is_empty());
}

/// An axis that oscillates about the place starts the time once; beyond the hysteresis and back, once more.
#[test]
fn a_timed_switch_has_a_hysteresis() {
    let switch = CamSwitch { duration: Some(0.5), ..range(100.0, 0.0) };
    let mut block = block(switch, Track { hysteresis: 1.0, ..Track::default() });
    let mut rig = rotary();
    let mut go = Block::new(Follow::Position(99.5));
    let mut seen = Vec::new();
    for cycle in 0..400_u32 {
        // On 100 at 0.01 s, and every 0.1 s again; at 2.5 s back to 98, from 2.7 s on 100 again.
        let place = match cycle {
            0..250 if cycle % 10 < 5 => 100.2,
            250..270 => 98.0,
            270.. => 100.2,
            _ => 99.8,
        };
        go.inputs = Follow::Position(if cycle == 0 { 99.5 } else { place });
        rig.call(&mut go, true);
        if block.call(true, &rig.axis).outputs[0] {
            seen.push(cycle);
        }
    }
    let expected: Vec<u32> = (1..51).chain(270..320).collect();
    assert_eq!(seen, expected);
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
    let (mut rig, mut moving) = (rotary(), endless(50.0));
    let mut blocks = [TappetMode::Auto, TappetMode::Demand, TappetMode::Actual].map(|mode| {
        let mut block = DigitalCamSwitch::new(&[range(10.0, 20.0)], [Track::default(); 32]);
        block.mode = mode;
        block
    });
    let mut first = [0_u32; 3];
    for count in 1..200 {
        rig.call(&mut moving, true);
        for (block, first) in blocks.iter_mut().zip(&mut first) {
            if block.call(true, &rig.axis).outputs[0] && *first == 0 {
                *first = count;
            }
        }
    }
    // The virtual drive is one cycle behind.
    assert_eq!([first[1] - first[0], first[2] - first[0]], [0, 1]);
}

/// The cycles in which output 0 is on while an axis goes a `way`: position and velocity at a time, s.
fn cycles_on(switch: CamSwitch, track: Track, way: impl Fn(f64) -> (f64, f64)) -> Vec<u32> {
    let (mut rig, mut block) = (linear(), block(switch, track));
    let mut go = Block::new(Follow::Position(way(0.0).0));
    rig.calls(2, &mut go);
    let mut go = Block::new(Follow::Position(0.0));
    let on = (0..60).filter(|cycle| {
        let (position, velocity) = way(f64::from(*cycle) * CYCLE);
        go.inputs = Follow::PositionVelocity(position, velocity);
        rig.call(&mut go, true);
        block.call(true, &rig.axis).outputs[0]
    });
    on.collect()
}

fn later(on_compensation: f64, off_compensation: f64) -> Track {
    Track { on_compensation, off_compensation, hysteresis: 0.0 }
}

/// From rest at `start` with 1000 u/s².
fn starting(start: f64) -> impl Fn(f64) -> (f64, f64) {
    move |t| (start + 500.0 * t * t, 1000.0 * t)
}

/// With `velocity` through 100 at 0.054 s, then to rest `beyond` behind it.
fn braking(velocity: f64, beyond: f64) -> impl Fn(f64) -> (f64, f64) {
    let rate = velocity * velocity / (2.0 * beyond);
    move |t| match t - 0.054 {
        t if t < 0.0 => (100.0 + velocity * t, velocity),
        t if t < velocity / rate => {
            (100.0 + velocity * t - 0.5 * rate * t * t, velocity - rate * t)
        }
        _ => (100.0 + beyond, 0.0),
    }
}

/// To `peak` at 0.1 s and back, with 1000 u/s².
fn turning(peak: f64) -> impl Fn(f64) -> (f64, f64) {
    move |t| (peak - 500.0 * (t - 0.1) * (t - 0.1), -1000.0 * (t - 0.1))
}

/// A delay is one of switching, in seconds (manual 5.5), whatever the axis does meanwhile.
#[test]
fn delays_are_times() {
    let switch = range(100.0, 200.0);
    let check = |track, way: &dyn Fn(f64) -> (f64, f64), on: std::ops::Range<u32>| {
        assert_eq!(cycles_on(switch, track, way), on.collect::<Vec<_>>(), "{track:?}");
    };
    // Behind the end, off; beyond it there is nothing to switch.
    check(later(0.0, 0.1), &starting(201.0), 0..0);
    // Inside, on: nothing is switched before the end, at 0.445 s.
    check(later(0.1, 0.0), &starting(101.0), 0..45);
    check(later(0.0, 0.1), &starting(101.0), 0..55);
    // Inside from 0.06 s on, where it stays.
    for beyond in [0.55, 2.2] {
        check(later(0.1, 0.0), &braking(10.0, beyond), 16..60);
    }
    // Inside from 0.0225 s to 0.1775 s, and out where it has come in.
    for (on, off, cycles) in [
        (0.0, 0.0, 3..18),
        (0.1, 0.1, 13..28),
        (0.1, 0.0, 13..18),
        (0.0, 0.3, 3..48),
        (0.2, 0.0, 0..0),
    ] {
        check(later(on, off), &turning(103.0), cycles);
    }
}

#[test]
fn delays_of_timed_switches_are_times() {
    let switch = CamSwitch { duration: Some(0.05), ..range(100.0, 0.0) };
    // Passed at 0.054 s, on from 0.154 s to 0.204 s, wherever it is by then.
    for (velocity, beyond) in [(10.0, 0.55), (20.0, 2.2)] {
        let on = cycles_on(switch, later(0.1, 0.0), braking(velocity, beyond));
        assert_eq!(on, (16..21).collect::<Vec<_>>(), "{beyond}");
    }
    // Forth at 0.0225 s, back at 0.1775 s.
    let on = cycles_on(switch, later(0.1, 0.0), turning(103.0));
    assert_eq!(on, (13..18).chain(28..33).collect::<Vec<_>>());
}

/// An advance looks where the axis will be at its present velocity; braking switches nothing back.
#[test]
fn advances_are_not_taken_back() {
    let switch = range(100.0, 200.0);
    // 99 + 500 t² + 50 t is 100 at 0.017 s; it is beyond 200 at 0.4494 s.
    let on: Vec<u32> = (2..45).collect();
    assert_eq!(cycles_on(switch, later(-0.05, 0.0), starting(99.0)), on);
    // Seen inside at 0.02 s; it does not come there, and is off from when it turns.
    let on: Vec<u32> = (2..11).collect();
    assert_eq!(cycles_on(switch, later(-0.05, 0.0), turning(99.5)), on);
    // Seen beyond the end at 0.03 s, where it does not come; from when it turns it is inside again, until it is seen beyond
    // the other end: 199 − 500 t² − 50 t is 100 at 0.398 s.
    let on: Vec<u32> = (0..3).chain(11..50).collect();
    assert_eq!(cycles_on(switch, later(0.0, -0.05), turning(199.0)), on);
    // A time begins once, where it is seen to come to 100: between 0.01 s and 0.02 s.
    let timed = CamSwitch { duration: Some(0.05), ..range(100.0, 0.0) };
    let on: Vec<u32> = (2..7).collect();
    assert_eq!(cycles_on(timed, later(-0.05, 0.0), turning(99.5)), on);
}

/// `MC_SetPosition` moves the zero, not the axis: what is on at the new place is, and nothing has been passed.
#[test]
fn a_zero_that_moves_passes_nothing() {
    let timed = CamSwitch { duration: Some(0.05), ..range(100.0, 0.0) };
    let second = CamSwitch { track: 2, ..range(140.0, 160.0) };
    let (mut rig, mut block) =
        (linear(), DigitalCamSwitch::new(&[timed, second], [Track::default(); 32]));
    rig.cycle(|_| ());
    assert_eq!(block.call(true, &rig.axis).outputs[..2], [false; 2]);
    rig.cycle(|axis| axis.shift_zero(150.0, false).expect("a number"));
    assert_eq!(block.call(true, &rig.axis).outputs[..2], [false, true]);
}
