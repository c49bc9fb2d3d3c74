//! Random paths with random inputs.

use super::control::{Drip, drive};
use super::program::{Elements, Error, Pen, checked, curved_programs, programs};
use crate::controller::{
    DEFAULT_CYCLE_NS, Inputs, Interpolator, LookAhead, Override, Status, ToolSetpoint, VelocityMode,
};
use crate::planned_motion::PathState;
use crate::planned_motion::PlannedPiece;
use proptest::prelude::*;
use std::collections::VecDeque;
use std::f64::consts::PI;
use twin_path::{ElementKind, PathElement, Switch};

/// At least one element.
fn paths() -> impl Strategy<Value = Elements> {
    prop_oneof![2 => programs(), 1 => curved_programs()]
        .prop_filter("no path", |elements| !elements.is_empty())
}

/// Programs with M functions, dwells and switches in between.
fn eventful() -> impl Strategy<Value = Elements> {
    let event = (0..6_u8, 1..33_u8, any::<bool>(), 0.0..=1.0_f64);
    (paths(), prop::collection::vec(event, 60)).prop_map(|(elements, events)| {
        let mut all = Vec::new();
        for (element, (kind, number, on, at)) in elements.into_iter().zip(events) {
            let mut element = element.unwrap();
            let (place, end) = (element.place, element.end());
            if kind >= 3 {
                let switches = &mut element.details.get_or_insert_default().switches;
                assert!(switches.add(Switch { number, on, at }));
                if kind == 5 {
                    assert!(switches.add(Switch { number: 33 - number, on: !on, at: 1.0 - at }));
                }
            }
            all.push(Ok(element));
            let wait = match kind {
                0 if number < 9 => ElementKind::MFunction { number: number.into() },
                1 if number < 9 => ElementKind::Dwell { time_ns: i64::from(number) * 700_000 },
                _ => continue,
            };
            let shape = twin_path::Shape::Line { start: end, end };
            all.push(Ok::<_, Error>(PathElement::new(place, wait, shape)));
        }
        for (line, element) in (1..).zip(all.iter_mut().flatten()) {
            element.place.line = line;
        }
        all
    })
}

fn modes() -> impl Strategy<Value = VelocityMode> {
    prop_oneof![
        2 => Just(VelocityMode::Trapezoid),
        2 => Just(VelocityMode::Sigmoid),
        1 => Just(VelocityMode::JerkLimited { jerk: 30.0 }),
    ]
}

/// One demand, and for how many cycles.
fn demands() -> impl Strategy<Value = Vec<(usize, Inputs)>> {
    let inputs = prop_oneof![
        3 => Just(Inputs::default()),
        2 => Just(Inputs { slow_stop: true, ..Inputs::default() }),
        1 => Just(Inputs { emergency_stop: true, ..Inputs::default() }),
        1 => Just(Inputs { wait_at_next_stop: true, ..Inputs::default() }),
        1 => Just(Inputs { single_step: true, ..Inputs::default() }),
        1 => Just(Inputs { acknowledge_m: false, ..Inputs::default() }),
        3 => (0.05..2.0_f64).prop_map(|factor| Inputs {
            override_factor: Override::new(factor).unwrap(),
            ..Inputs::default()
        }),
    ];
    prop::collection::vec((1..400_usize, inputs), 0..12)
}

/// The demand of each cycle; in the end nothing but the mode.
fn schedule(demands: &[(usize, Inputs)], mode: VelocityMode) -> impl Fn(usize) -> Inputs {
    let all: Vec<Inputs> =
        demands.iter().flat_map(|(cycles, inputs)| std::iter::repeat_n(*inputs, *cycles)).collect();
    move |cycle| Inputs { mode, ..all.get(cycle).copied().unwrap_or_default() }
}

const MOST: usize = 200_000;

struct Found {
    setpoints: Vec<ToolSetpoint>,
    elements_done: u64,
    length: f64,
    pieces: Vec<PlannedPiece>,
    /// Within [`MOST`] cycles.
    ended: bool,
}

fn find(
    source: VecDeque<Option<Result<twin_path::prepare::CheckedElement, Error>>>,
    inputs: impl Fn(usize) -> Inputs,
) -> Found {
    let mut interpolator = Interpolator::new(LookAhead::new(Drip(source)), DEFAULT_CYCLE_NS);
    interpolator.record(false);
    let setpoints = drive(&mut interpolator, MOST, inputs);
    Found {
        setpoints,
        pieces: std::iter::from_fn(|| interpolator.next_piece()).collect(),
        elements_done: interpolator.elements_done(),
        length: interpolator.path_length(),
        ended: interpolator.poll_cycle(&Inputs::default()) == std::task::Poll::Ready(None),
    }
}

/// Every set-point in motion is a sample of the pieces that were recorded, and these go on one from the other.
fn samples(found: &Found) -> Result<(), TestCaseError> {
    let mut pieces = found.pieces.iter().peekable();
    for setpoint in found.setpoints.iter().filter(|setpoint| setpoint.path_velocity > 0.0) {
        let until = |piece: &PlannedPiece| piece.start.until(setpoint.time_ns);
        while pieces.next_if(|piece| until(piece) >= piece.piece.duration).is_some() {}
        let Some(piece) = pieces.peek() else {
            return Err(TestCaseError::fail(format!("no piece for {setpoint:?}")));
        };
        let (state, _) = piece.piece.at(until(piece).max(0.0));
        let point = piece.element.at(state.position);
        let apart = (point.position - setpoint.position).norm();
        let slower = (state.velocity - setpoint.path_velocity).abs();
        prop_assert!(apart < 1e-10 && slower < 1e-9, "{apart} {slower} {setpoint:?} {piece:?}");
    }
    for [piece, next] in found.pieces.array_windows() {
        let rests = |state: &PathState| state.velocity < 1e-6;
        let (end, start) = (piece.piece.at(piece.piece.duration).0, next.piece.at(0.0).0);
        let gap = next.start() - piece.start() - piece.piece.duration;
        let meet = gap.abs() < 1e-9 && (end.velocity - start.velocity).abs() < 1e-9;
        prop_assert!(meet || rests(&start), "{gap} {end:?} {start:?}");
    }
    Ok(())
}

/// Everything that holds whatever is asked for.
fn check(
    elements: &Elements,
    found: &Found,
    demands: &[(usize, Inputs)],
    mode: VelocityMode,
) -> Result<(), TestCaseError> {
    samples(found)?;
    let whole: Vec<_> = elements.iter().flatten().cloned().collect();
    let length: f64 = whole.iter().map(PathElement::length).sum();
    let last = found.setpoints.last().unwrap();
    prop_assert_eq!(last.status, Status::Finished);
    prop_assert_eq!(last.path_velocity, 0.0);
    prop_assert_eq!(last.position, whole.last().unwrap().end());
    prop_assert!((found.length - length).abs() <= 1e-11, "{} {}", found.length, length);
    prop_assert_eq!(found.elements_done, whole.len() as u64);

    let factor = if mode == VelocityMode::Sigmoid { PI / 2.0 } else { 1.0 };
    let overrides = schedule(demands, mode);
    // What an override of more than 1 allows, it allows until the ramp after it has ended.
    let raised = demands
        .iter()
        .fold(1.0, |most: f64, (_, inputs)| most.max(inputs.override_factor.factor()));
    let emergency = demands.iter().any(|(_, inputs)| inputs.emergency_stop);
    let mut before = None::<&ToolSetpoint>;
    for (n, setpoint) in found.setpoints.iter().enumerate() {
        prop_assert_eq!(setpoint.time_ns, n as i64 * 1_000_000);
        let element = &whole[setpoint.place.line as usize - 1];
        let speed = setpoint.path_velocity;
        prop_assert!(speed <= element.feed * raised * (1.0 + 1e-8), "{speed} {}", element.feed);
        let along =
            if speed > 0.0 { setpoint.acceleration.dot(&setpoint.velocity) / speed } else { 0.0 };
        let rounding = 1e-8 * setpoint.acceleration.norm() + 1e-6;
        prop_assert!(
            along <= factor * element.acceleration + rounding,
            "{along} {}",
            element.acceleration
        );
        prop_assert!(
            -along <= factor * element.deceleration + rounding,
            "{along} {}",
            element.deceleration
        );
        if let Some(before) = before {
            let moved = setpoint.way - before.way;
            prop_assert!(moved >= -1e-12, "{moved}");
            let most = whole
                .iter()
                .filter(|e| {
                    e.place.line >= before.place.line && e.place.line <= setpoint.place.line
                })
                .fold(0.0, |most: f64, e| most.max(e.feed));
            prop_assert!(moved <= most * raised * 1e-3 * (1.0 + 1e-8) + 1e-11, "{moved} {most}");
            let jumped = whole[before.place.line as usize - 1..setpoint.place.line as usize]
                .iter()
                .any(|e| e.kind == ElementKind::Jump);
            let chord = (setpoint.position - before.position).norm();
            prop_assert!(jumped || chord <= moved + 1e-9, "{chord} {moved}");
            if !emergency {
                let rate = whole
                    .iter()
                    .fold(0.0, |rate: f64, e| rate.max(e.acceleration).max(e.deceleration));
                prop_assert!(
                    (speed - before.path_velocity).abs()
                        <= factor * rate * 1e-3 * (1.0 + 1e-6) + 1e-9
                );
            }
        }
        if setpoint.status == Status::Constant && speed > 0.0 {
            let factor = overrides(n).override_factor.factor();
            prop_assert!(
                speed <= element.feed * factor * (1.0 + 1e-8),
                "{speed} {} {factor}",
                element.feed
            );
        }
        before = Some(setpoint);
    }
    check_switches(&whole, found)?;
    check_m_functions(&whole, found)
}

/// Every switch acts once, in order, as soon as it is passed and not before.
fn check_switches(whole: &[PathElement], found: &Found) -> Result<(), TestCaseError> {
    // Where along the path each switch is.
    let mut switches = Vec::new();
    let mut way = 0.0;
    for element in whole {
        for switch in element.switches() {
            switches.push((way + switch.at * element.length(), *switch));
        }
        way += element.length();
    }
    let mut states = vec![0_u32];
    for (_, switch) in &switches {
        let bit = 1 << (switch.number - 1);
        let before = *states.last().unwrap();
        states.push(if switch.on { before | bit } else { before & !bit });
    }
    let (mut passed, last) = (0, found.setpoints.last().unwrap());
    for setpoint in &found.setpoints {
        while setpoint.switches != states[passed]
            || switches.get(passed).is_some_and(|(at, _)| *at < setpoint.way - 1e-9)
        {
            prop_assert!(
                passed < switches.len() && switches[passed].0 <= setpoint.way + 1e-9,
                "{:b} after {} of {switches:?} at {}",
                setpoint.switches,
                passed,
                setpoint.way
            );
            passed += 1;
        }
    }
    let left = &switches[passed..];
    prop_assert!(left.iter().all(|(at, _)| *at >= way - 1e-9), "{left:?}");
    prop_assert_eq!(last.switches, *states.last().unwrap());
    Ok(())
}

fn check_m_functions(whole: &[PathElement], found: &Found) -> Result<(), TestCaseError> {
    // The M functions, one after the other.
    let mut shown: Vec<_> = found
        .setpoints
        .iter()
        .filter_map(|setpoint| Some((setpoint.place.line, setpoint.m_function?)))
        .collect();
    shown.dedup();
    let expected: Vec<_> = whole
        .iter()
        .filter_map(|element| match element.kind {
            ElementKind::MFunction { number } => Some((element.place.line, number)),
            _ => None,
        })
        .collect();
    prop_assert_eq!(shown, expected);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn whatever_is_asked_the_path_is_kept(elements in eventful(), demands in demands(), mode in modes()) {
        let source = checked(elements.clone()).map(Some).collect();
        let found = find(source, schedule(&demands, mode));
        prop_assume!(found.ended);
        check(&elements, &found, &demands, mode)?;
    }

    #[test]
    fn modes_change_while_running(elements in eventful(), demands in demands()) {
        let modes = [VelocityMode::Sigmoid, VelocityMode::Trapezoid, VelocityMode::JerkLimited { jerk: 50.0 }];
        let asked = schedule(&demands, VelocityMode::Trapezoid);
        let source = checked(elements.clone()).map(Some).collect();
        let found = find(source, |cycle| Inputs { mode: modes[cycle / 137 % 3], ..asked(cycle) });
        prop_assume!(found.ended);
        check(&elements, &found, &demands, VelocityMode::Sigmoid)?;
    }

    #[test]
    fn starved_anywhere_it_never_jumps(
        elements in eventful(),
        gaps in prop::collection::vec(prop_oneof![Just(0_usize), 0..500_usize], 120),
        mode in modes(),
    ) {
        let mut source = VecDeque::new();
        for (element, gap) in checked(elements.clone()).zip(gaps) {
            source.push_back(Some(element));
            source.extend(std::iter::repeat_with(|| None).take(gap));
        }
        let found = find(source, schedule(&[], mode));
        prop_assume!(found.ended);
        check(&elements, &found, &[], mode)?;
    }

    /// From the start on, every transition is a stop; nothing else is.
    #[test]
    fn single_steps_stop_at_every_transition(elements in paths(), mode in modes()) {
        let whole: Vec<_> = elements.iter().flatten().cloned().collect();
        let inputs = Inputs { single_step: true, mode, ..Inputs::default() };
        let found = find(checked(elements).map(Some).collect(), |_| inputs);
        prop_assume!(found.ended);
        for element in whole.iter().filter(|element| element.length() > 0.0) {
            let rests = found.setpoints.iter().any(|setpoint| {
                setpoint.place == element.place
                    && setpoint.path_velocity == 0.0
                    && setpoint.position == element.end()
            });
            prop_assert!(rests, "{}", element.place);
        }
    }

    /// A stop costs time, nothing else.
    #[test]
    fn a_slow_stop_leads_to_the_same_end(elements in paths(), when in 0..2000_usize, mode in modes()) {
        let whole: Vec<_> = elements.iter().flatten().cloned().collect();
        let asked = Inputs { slow_stop: true, mode, ..Inputs::default() };
        let free = Inputs { mode, ..Inputs::default() };
        let found = find(checked(elements).map(Some).collect(), |cycle| {
            if (when..when + 300).contains(&cycle) { asked } else { free }
        });
        prop_assume!(found.ended);
        prop_assert_eq!(found.setpoints.last().unwrap().position, whole.last().unwrap().end());
        prop_assert_eq!(found.elements_done, whole.len() as u64);
    }

    #[test]
    fn the_same_demands_give_the_same_setpoints(elements in eventful(), demands in demands(), mode in modes()) {
        let source = || checked(elements.clone()).map(Some).collect();
        let [one, other] = [(); 2].map(|()| find(source(), schedule(&demands, mode)));
        prop_assert_eq!(one.setpoints, other.setpoints);
    }
}

#[test]
fn several_switches_pass_in_one_cycle_in_order() {
    let mut pen = Pen::new(1.0, 100.0, 100.0);
    for _ in 0..100 {
        pen.line(1e-4).switch(3, true, 0.25).switch(3, false, 0.5).switch(4, true, 0.75);
    }
    pen.line(0.01).switch(32, true, 0.0);
    let source = checked(pen.take()).map(Some).collect();
    let found = find(source, |_| Inputs::default());
    assert!(found.setpoints.iter().any(|setpoint| setpoint.last_switch == 4));
    let last = found.setpoints.last().unwrap();
    assert_eq!((last.switches, last.last_switch), (1 << 31 | 1 << 3, 32));
}
