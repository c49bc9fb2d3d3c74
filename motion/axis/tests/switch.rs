//! Switches along an axis (manual 5.5).

use super::blocks::endless;
use super::rig::rotary;
use crate::axis::{Block, CamSwitch, DigitalCamSwitch, Follow, SwitchDirection, TappetMode, Track};

fn range(first_on: f64, last_on: f64) -> CamSwitch {
    CamSwitch { track: 1, first_on, last_on, direction: SwitchDirection::Both, duration: None }
}

/// Where output 0 is on over a turn at `velocity` u/s, u: begin and end, as seen.
fn on(switch: CamSwitch, track: Track, velocity: f64) -> Vec<[f64; 2]> {
    let mut tracks = [Track::default(); 32];
    tracks[0] = track;
    let (mut rig, mut moving) = (rotary(), endless(velocity));
    let mut block = DigitalCamSwitch::new(&[switch], tracks);
    let (mut spans, mut was, mut ended) = (Vec::<[f64; 2]>::new(), false, None);
    // The first turn is to get up to speed; the second, from 0 on, counts.
    let mut turned = 0.0;
    while turned < 720.0 {
        let before = rig.axis.set_position();
        rig.cycle(|axis| moving.call(true, axis));
        let way = rig.axis.set_position() - before;
        turned += (way - 360.0 * (way / 360.0).round()).abs();
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

#[test]
fn ranges_switch_in_both_directions_and_over_the_end() {
    let near = |spans: &[[f64; 2]], expected: [f64; 2]| {
        assert_eq!(spans.len(), 1, "{spans:?}");
        for (seen, expected) in spans[0].iter().zip(expected) {
            let away = seen - expected;
            assert!((away - 360.0 * (away / 360.0).round()).abs() <= 0.5 + 1e-6, "{spans:?}");
        }
    };
    near(&on(range(100.0, 200.0), Track::default(), 50.0), [100.0, 200.0]);
    near(&on(range(100.0, 200.0), Track::default(), -50.0), [200.0, 100.0]);
    near(&on(range(300.0, 40.0), Track::default(), 50.0), [300.0, 40.0]);
    let one_way = CamSwitch { direction: SwitchDirection::Negative, ..range(100.0, 200.0) };
    assert_eq!(on(one_way, Track::default(), 50.0).len(), 0);
    near(&on(one_way, Track::default(), -50.0), [200.0, 100.0]);
    // On 0.2 s later (10 u at 50 u/s), off 0.4 s earlier.
    let track = Track { on_compensation: 0.2, off_compensation: -0.4, hysteresis: 0.0 };
    near(&on(range(100.0, 200.0), track, 50.0), [110.0, 180.0]);
    near(&on(range(100.0, 200.0), track, -50.0), [190.0, 120.0]);
    let track = Track { hysteresis: 3.0, ..Track::default() };
    near(&on(range(100.0, 200.0), track, 50.0), [100.0, 203.0]);
}

fn meets(spans: &[[f64; 2]], expected: [f64; 2]) {
    // One that begins with the next turn has no end yet.
    let spans: Vec<_> = spans.iter().filter(|span| !span[1].is_nan()).collect();
    assert_eq!(spans.len(), 1, "{spans:?}");
    for (seen, expected) in spans[0].iter().zip(expected) {
        let away = seen - expected;
        assert!((away - 360.0 * (away / 360.0).round()).abs() <= 0.5 + 1e-6, "{spans:?}");
    }
}

/// Further than half a turn ahead: a delay is positive, an advance negative (manual 5.5), 40 u at 50 u/s.
#[test]
fn compensations_reach_over_the_end_of_the_period() {
    let long = range(0.0, 300.0);
    let later = Track { off_compensation: 0.8, ..Track::default() };
    meets(&on(long, later, 50.0), [0.0, 340.0]);
    meets(&on(long, later, -50.0), [300.0, 320.0]);
    let earlier = Track { on_compensation: -0.8, ..Track::default() };
    meets(&on(long, earlier, 50.0), [320.0, 300.0]);
    meets(&on(long, earlier, -50.0), [340.0, 0.0]);
    let both = Track { on_compensation: -0.8, off_compensation: -0.8, hysteresis: 0.0 };
    meets(&on(long, both, 50.0), [320.0, 260.0]);
    // On until after it is on again; off before it is on.
    let over = Track { off_compensation: 1.4, ..Track::default() };
    assert!(on(long, over, 50.0).is_empty());
    assert!(is_always(long, over, true));
    let never = Track { on_compensation: 0.4, ..Track::default() };
    assert!(is_always(range(0.0, 10.0), never, false));
}

/// Whether output 0 is that, all the time, of an axis at 50 u/s.
fn is_always(switch: CamSwitch, track: Track, shown: bool) -> bool {
    let mut tracks = [Track::default(); 32];
    tracks[0] = track;
    let (mut rig, mut moving) = (rotary(), endless(50.0));
    let mut block = DigitalCamSwitch::new(&[switch], tracks);
    (0..1_000).all(|cycle| {
        rig.cycle(|axis| moving.call(true, axis));
        block.call(true, &rig.axis).outputs[0] == shown || cycle < 100
    })
}

#[test]
fn a_whole_period_is_always_on() {
    for switch in [range(0.0, 360.0), range(100.0, 460.0), range(-400.0, 400.0)] {
        assert!(is_always(switch, Track::default(), true), "{switch:?}");
    }
    let earlier = Track { off_compensation: -0.4, ..Track::default() };
    meets(&on(range(90.0, 450.0), earlier, 50.0), [90.0, 70.0]);
}

#[test]
fn a_timed_switch_stays_on_for_its_time() {
    let switch = CamSwitch { duration: Some(0.5), ..range(100.0, 0.0) };
    let spans = on(switch, Track::default(), 50.0);
    assert_eq!(spans.len(), 1, "{spans:?}");
    assert!((spans[0][0] - 100.0).abs() <= 0.5 && (spans[0][1] - 125.0).abs() <= 1.0, "{spans:?}");
}

/// Switching off is delayed or advanced like switching on.
#[test]
fn a_timed_switch_is_compensated_on_both_sides() {
    let switch = CamSwitch { duration: Some(0.5), ..range(100.0, 0.0) };
    for (off_compensation, end) in [(0.2, 135.0), (-0.2, 115.0)] {
        let spans = on(switch, Track { off_compensation, ..Track::default() }, 50.0);
        assert_eq!(spans.len(), 1, "{spans:?}");
        assert!(
            (spans[0][0] - 100.0).abs() <= 0.5 && (spans[0][1] - end).abs() <= 1.0,
            "{spans:?}"
        );
    }
    let track = Track { on_compensation: 0.4, off_compensation: 0.2, hysteresis: 0.0 };
    let spans = on(switch, track, -50.0);
    assert_eq!(spans.len(), 1, "{spans:?}");
    assert!((spans[0][0] - 80.0).abs() <= 0.5 && (spans[0][1] - 45.0).abs() <= 1.0, "{spans:?}");
    let track = Track { off_compensation: -0.6, ..Track::default() };
    assert!(on(switch, track, 50.0).is_empty());
}

/// An axis that oscillates about the place starts the time once; beyond the hysteresis and back, once more.
#[test]
fn a_timed_switch_has_a_hysteresis() {
    let switch = CamSwitch { duration: Some(0.5), ..range(100.0, 0.0) };
    let mut tracks = [Track::default(); 32];
    tracks[0].hysteresis = 1.0;
    let (mut rig, mut block) = (rotary(), DigitalCamSwitch::new(&[switch], tracks));
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
        rig.cycle(|axis| go.call(true, axis));
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
    rig.cycle(|axis| moving.call(true, axis));
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
        rig.cycle(|axis| moving.call(true, axis));
        for (block, first) in blocks.iter_mut().zip(&mut first) {
            if block.call(true, &rig.axis).outputs[0] && *first == 0 {
                *first = count;
            }
        }
    }
    // The virtual drive is one cycle behind.
    assert_eq!([first[1] - first[0], first[2] - first[0]], [0, 1]);
}
