//! Tests of motion forwards and backwards.

use super::program::{Elements, Error, Pen, programs, run};
use crate::controller::{
    DEFAULT_CYCLE_NS, Direction, Inputs, Status, ToolSetpoint, TwoWayInterpolator, TwoWayPath,
};
use proptest::prelude::*;
use std::num::NonZeroUsize;
use twin_path::PathElement;

fn both_ways(elements: Elements) -> TwoWayInterpolator {
    let capacity = NonZeroUsize::new(1000).unwrap();
    let path = TwoWayPath::new(elements.into_iter(), 0.1, capacity).unwrap();
    TwoWayInterpolator::new(path, DEFAULT_CYCLE_NS)
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

#[test]
fn forwards_it_is_the_interpolator() {
    let elements = Pen::new(0.1, 1.0, 0.5).line(0.02).arc(0.02, 1.0, 0.0).m(3).line(0.01).take();
    let plain: Vec<_> = run(elements.clone()).map(Result::unwrap).collect();
    let mut two_way = both_ways(elements);
    for setpoint in &plain {
        assert_eq!(two_way.cycle(&Inputs::default(), 1.0).as_ref(), Some(setpoint));
    }
    assert!(two_way.end_of_path());
    // It stays there.
    let last = plain.last().unwrap();
    let stays = two_way.cycle(&Inputs::default(), 1.0).unwrap();
    assert_eq!(stays, ToolSetpoint { time_ns: last.time_ns + 1_000_000, ..*last });
    assert_eq!(two_way.direction(), Direction::Standstill);
}

/// 0.1 m/s, 1 m/s²: turned at 0.5 s and 45 mm, at rest at 50 mm after 0.6 s, at the start after 0.6 s more.
#[test]
fn a_negative_override_goes_back() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    pen.line(0.04).switch(5, true, 0.5).line(0.06);
    let mut two_way = both_ways(pen.take());
    let mut ways = Vec::new();
    let mut setpoints = Vec::new();
    for cycle in 0..1300 {
        let velocity = if cycle < 500 { 1.0 } else { -1.0 };
        setpoints.push(two_way.cycle(&Inputs::default(), velocity).unwrap());
        ways.push(two_way.direction());
    }
    assert_eq!((ways[300], ways[550]), (Direction::Positive, Direction::Positive));
    assert!(close(setpoints[600].position.x, 0.05, 1e-12), "{}", setpoints[600].position.x);
    // The set-point at rest and the one from which it goes back may be two.
    assert!(ways[605] == Direction::Negative && ways[800] == Direction::Negative);
    assert!(close(setpoints[800].velocity.x, -0.1, 1e-12));
    assert_eq!(setpoints[800].place.line, 1);
    let last = setpoints[1299];
    assert_eq!((last.position.x, last.status), (0.0, Status::Finished));
    assert!(two_way.end_of_path());
    let end = setpoints.iter().find(|setpoint| setpoint.status == Status::Finished).unwrap();
    assert!(end.time_ns.abs_diff(1_200_000_000) <= 1_000_000, "{}", end.time_ns);
    assert!(close(end.way, 0.1, 1e-12));
    // Passed at 20 mm on the way there, and not undone on the way back.
    assert_eq!(setpoints[240].switches, 0);
    assert_eq!(setpoints[260].switches, 1 << 4);
    assert_eq!(last.switches, 1 << 4);
    // And there again.
    let there: Vec<_> =
        (0..2000).map(|_| two_way.cycle(&Inputs::default(), 1.0).unwrap()).collect();
    assert_eq!(there.last().unwrap().position.x, 0.1);
}

#[test]
fn a_knob_at_zero_stands_still() {
    let mut two_way = both_ways(Pen::new(0.1, 1.0, 1.0).line(0.1).take());
    let setpoints: Vec<_> = (0..2000)
        .map(|cycle| {
            let velocity = if (500..1000).contains(&cycle) { 0.0 } else { 0.5 };
            two_way.cycle(&Inputs::default(), velocity).unwrap()
        })
        .collect();
    assert_eq!(setpoints[700].status, Status::Waiting);
    assert_eq!(setpoints[900].position, setpoints[700].position);
    assert!(setpoints[1200].position.x > setpoints[700].position.x);
}

#[test]
fn backwards_from_the_beginning_is_the_end_of_the_path() {
    let mut two_way = both_ways(Pen::new(0.1, 1.0, 1.0).line(0.1).take());
    for _ in 0..5 {
        let setpoint = two_way.cycle(&Inputs::default(), -1.0).unwrap();
        assert_eq!((setpoint.position.x, setpoint.path_velocity), (0.0, 0.0));
    }
    assert!(two_way.end_of_path());
}

#[test]
fn m_functions_wait_both_ways() {
    let mut two_way = both_ways(Pen::new(0.1, 1.0, 1.0).line(0.01).m(9).line(0.01).take());
    let mut shown = Vec::new();
    for cycle in 0..1500 {
        let velocity = if cycle < 600 { 1.0 } else { -1.0 };
        let setpoint = two_way.cycle(&Inputs::default(), velocity).unwrap();
        if let Some(number) = setpoint.m_function {
            shown.push((number, cycle < 600, setpoint.position.x));
        }
    }
    assert_eq!(shown, [(9, true, 0.01), (9, false, 0.01)]);
}

#[test]
fn a_path_that_does_not_fit_is_refused() {
    let elements = Pen::new(0.1, 1.0, 1.0).line(0.1).line(0.1).line(0.1).take();
    let path = TwoWayPath::new(elements.into_iter(), 0.1, NonZeroUsize::new(2).unwrap());
    let Err(Error::Ipo(error)) = path else { panic!("{path:?}") };
    assert_eq!(error.number(), 1051);
}

#[test]
fn a_path_without_elements_has_no_set_points() {
    assert_eq!(both_ways(Vec::new()).cycle(&Inputs::default(), -1.0), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// To and fro at random: it stays on the path, never jumps, keeps feed and accelerations, and reaches both ends.
    #[test]
    fn to_and_fro(
        elements in programs().prop_filter("no path", |elements| !elements.is_empty()),
        knob in prop::collection::vec((1..300_usize, -1.0..1.0_f64), 0..12),
    ) {
        let whole: Vec<_> = elements.iter().flatten().cloned().collect();
        let jumps = whole.iter().any(|element| element.kind == twin_path::ElementKind::Jump);
        let time: f64 = whole.iter().map(|element| element.length() / element.feed + 1.0).sum();
        prop_assume!(time < 60.0 + whole.len() as f64);
        let fastest = whole.iter().fold(0.0, |most: f64, element| most.max(element.feed));
        let rate = whole.iter().fold(0.0, |most: f64, e| most.max(e.acceleration).max(e.deceleration));
        let mut two_way = both_ways(elements);
        let mut knob: Vec<f64> =
            knob.into_iter().flat_map(|(cycles, velocity)| vec![velocity; cycles]).collect();
        let random = knob.len();
        knob.extend(vec![-1.0; 150_000]);
        let mut last: Option<ToolSetpoint> = None;
        let (mut there, mut cycle) = (false, 0);
        while let Some(velocity) = knob.get(cycle) {
            let velocity = if there { 1.0 } else { *velocity };
            let setpoint = two_way.cycle(&Inputs::default(), velocity).unwrap();
            let element = &whole[setpoint.place.line as usize - 1];
            prop_assert!(setpoint.path_velocity <= element.feed * (1.0 + 1e-9));
            if let Some(last) = last {
                let moved = (setpoint.position - last.position).norm();
                let way = setpoint.way - last.way;
                prop_assert!((-1e-12..=fastest * 1e-3 * (1.0 + 1e-9) + 1e-11).contains(&way), "{way}");
                prop_assert!(jumps || moved <= way + 1e-9, "{moved} {way}");
                prop_assert!((setpoint.path_velocity - last.path_velocity).abs() <= rate * 1e-3 * (1.0 + 1e-6));
            }
            last = Some(setpoint);
            cycle += 1;
            if cycle > random && two_way.end_of_path() {
                if there {
                    prop_assert_eq!(setpoint.position, whole.last().unwrap().end());
                    return Ok(());
                }
                // Turned so shortly before the end that it came to rest there.
                if setpoint.position != whole.last().unwrap().end() || whole[0].start() == setpoint.position {
                    prop_assert_eq!(setpoint.position, whole[0].start());
                    there = true;
                }
            }
        }
        prop_assume!(false);
    }
}

/// The velocity into an element is, backwards, that out of it.
#[test]
fn transition_velocities_go_with_their_place() {
    let mut elements = Pen::new(0.1, 1.0, 1.0).line(0.05).line(0.05).line(0.05).take();
    let limited: &mut PathElement = elements[0].as_mut().unwrap();
    limited.end_velocity = 0.02;
    let mut two_way = both_ways(elements);
    let mut through = Vec::new();
    for cycle in 0..8000 {
        let velocity = if cycle < 4000 { 1.0 } else { -1.0 };
        let setpoint = two_way.cycle(&Inputs::default(), velocity).unwrap();
        for place in [0.05, 0.1] {
            if (setpoint.position.x - place).abs() < 0.5e-4 {
                through.push((place, setpoint.path_velocity));
            }
        }
    }
    let speeds = |place| through.iter().filter(move |(at, _)| *at == place).map(|(_, v)| *v);
    assert!(speeds(0.05).count() >= 2 && speeds(0.05).all(|v| v < 0.03));
    assert!(speeds(0.1).count() >= 1 && speeds(0.1).all(|v| v > 0.05));
}
