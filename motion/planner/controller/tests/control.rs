//! Tests of inputs that change while the path runs, computed by hand.

use super::program::{Elements, Error, Pen, checked, run};
use crate::controller::{
    DEFAULT_CYCLE_NS, Inputs, Interpolator, LookAhead, Override, Source, Status, ToolSetpoint,
};
use nalgebra::{Point3, Vector3};
use std::collections::VecDeque;
use std::task::Poll;
use twin_path::prepare::CheckedElement;

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

/// Up to `cycles` set-points, with inputs that depend on the cycle.
pub(super) fn drive<I: Source<Item = Result<CheckedElement, Error>>>(
    interpolator: &mut Interpolator<LookAhead<I, Error>, Error>,
    cycles: usize,
    inputs: impl Fn(usize) -> Inputs,
) -> Vec<ToolSetpoint> {
    let mut setpoints = Vec::new();
    for cycle in 0..cycles {
        match interpolator.poll_cycle(&inputs(cycle)) {
            Poll::Ready(Some(setpoint)) => setpoints.push(setpoint.unwrap()),
            Poll::Ready(None) => break,
            Poll::Pending => {}
        }
    }
    setpoints
}

fn driven(elements: Elements, inputs: impl Fn(usize) -> Inputs) -> Vec<ToolSetpoint> {
    drive(&mut run(elements), 20_000, inputs)
}

fn with_override(factor: f64) -> Inputs {
    Inputs { override_factor: Override::new(factor).unwrap(), ..Inputs::default() }
}

/// Waits all the time between two cycles, otherwise runs.
fn between(from: usize, to: usize, asked: Inputs) -> impl Fn(usize) -> Inputs {
    move |cycle| if (from..to).contains(&cycle) { asked } else { Inputs::default() }
}

fn resting(setpoint: &ToolSetpoint) -> bool {
    setpoint.velocity == Vector3::zeros()
        && setpoint.acceleration == Vector3::zeros()
        && setpoint.path_velocity == 0.0
}

/// 100 mm at 0.1 m/s with 1 m/s²: 0.1 s and 5 mm per ramp, 1.1 s.
fn hundred() -> Elements {
    Pen::new(0.1, 1.0, 1.0).line(0.1).take()
}

#[test]
fn overrides_below_a_hundredth_are_refused() {
    for factor in [0.0, -1.0, 0.009, f64::NAN, f64::INFINITY] {
        assert_eq!(Override::new(factor).unwrap_err().number(), 1001);
    }
    assert!(Override::new(0.01).is_ok() && Override::new(2.0).is_ok());
}

#[test]
fn an_override_from_the_start_scales_the_velocity_only() {
    for (factor, duration) in [(0.5, 2.0 + 0.05), (1.0, 1.1), (2.0, 0.5 + 0.2)] {
        let mut interpolator = run(hundred());
        drive(&mut interpolator, 10_000, |_| with_override(factor));
        assert!(close(interpolator.duration(), duration, 1e-12), "{factor}");
    }
}

/// Halved at 0.5 s, when 45 mm are done: 50 ms and 3.75 mm down to 0.05 m/s, then 50 mm, then 1.25 mm down.
#[test]
fn an_override_is_taken_over_at_constant_velocity() {
    let mut interpolator = run(hundred());
    let setpoints = drive(&mut interpolator, 10_000, |cycle| {
        if cycle < 500 { Inputs::default() } else { with_override(0.5) }
    });
    assert!(close(setpoints[500].position.x, 0.045, 1e-14));
    assert_eq!(setpoints[500].status, Status::Decelerating);
    assert!(close(setpoints[550].position.x, 0.04875, 1e-13));
    assert_eq!(setpoints[551].status, Status::Constant);
    assert!(close(interpolator.duration(), 0.55 + 0.05 / 0.05 + 0.05, 1e-9));
    assert_eq!(setpoints.last().unwrap().position, Point3::new(0.1, 0.0, 0.0));
}

/// Manual 6.2.9: not while it accelerates or brakes.
#[test]
fn an_override_waits_for_the_end_of_a_ramp() {
    let setpoints =
        driven(hundred(), |cycle| if cycle < 50 { Inputs::default() } else { with_override(2.0) });
    assert!(close(setpoints[99].path_velocity, 0.099, 1e-12));
    assert!(close(setpoints[100].path_velocity, 0.1, 1e-12));
    // From the first set-point at constant velocity on, the 100th or the next.
    assert!(close(setpoints[150].path_velocity, 0.15, 1.1e-3));
    let late = driven(
        hundred(),
        |cycle| {
            if cycle < 1001 { Inputs::default() } else { with_override(2.0) }
        },
    );
    assert_eq!(late, driven(hundred(), |_| Inputs::default()));
}

#[test]
fn a_lower_override_brakes_through_short_elements() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    for _ in 0..1000 {
        pen.line(1e-4);
    }
    let mut interpolator = run(pen.take());
    let setpoints = drive(&mut interpolator, 10_000, |cycle| {
        if cycle < 500 { Inputs::default() } else { with_override(0.5) }
    });
    assert!(close(setpoints[525].path_velocity, 0.075, 1e-12));
    assert!(close(setpoints[600].path_velocity, 0.05, 1e-12));
    assert!(
        close(interpolator.duration(), 0.55 + 0.05 / 0.05 + 0.05, 1e-9),
        "{}",
        interpolator.duration()
    );
}

/// At 0.5 s and 45 mm: down in 0.1 s and 5 mm; on from 50 mm after 0.8 s.
#[test]
fn a_slow_stop_waits_and_goes_on() {
    let asked = Inputs { slow_stop: true, ..Inputs::default() };
    let mut interpolator = run(hundred());
    let setpoints = drive(&mut interpolator, 10_000, between(500, 800, asked));
    assert_eq!(setpoints[550].status, Status::Decelerating);
    assert!(close(setpoints[600].position.x, 0.05, 1e-14));
    for setpoint in &setpoints[601..800] {
        assert!(resting(setpoint) && setpoint.status == Status::Waiting);
        assert!(close(setpoint.position.x, 0.05, 1e-14));
    }
    assert_eq!(setpoints[800].status, Status::Accelerating);
    assert!(close(interpolator.duration(), 0.8 + 0.6, 1e-9));
    assert_eq!(setpoints.last().unwrap().status, Status::Finished);
    assert_eq!(setpoints.last().unwrap().position, Point3::new(0.1, 0.0, 0.0));
    assert!(!interpolator.stopped_early());
}

#[test]
fn a_slow_stop_released_while_braking_comes_to_rest_first() {
    let asked = Inputs { slow_stop: true, ..Inputs::default() };
    let mut interpolator = run(hundred());
    let setpoints = drive(&mut interpolator, 10_000, between(500, 501, asked));
    assert!(close(setpoints[600].position.x, 0.05, 1e-14));
    assert!(setpoints[600].path_velocity <= 1e-12);
    assert!(close(interpolator.duration(), 0.6 + 0.6, 1e-9));
}

#[test]
fn an_emergency_stop_holds_the_position_at_once() {
    let asked = Inputs { emergency_stop: true, ..Inputs::default() };
    let mut interpolator = run(hundred());
    let setpoints = drive(&mut interpolator, 10_000, between(500, 600, asked));
    for setpoint in &setpoints[500..600] {
        assert!(resting(setpoint) && setpoint.status == Status::Waiting);
        assert_eq!(setpoint.position, setpoints[499].position);
        assert_eq!(setpoint.tangent(), Vector3::zeros());
    }
    // From rest: 44.9 mm are done.
    assert_eq!(setpoints[600].position, setpoints[499].position);
    assert!(close(setpoints[650].path_velocity, 0.05, 1e-12));
    assert!(close(interpolator.duration(), 0.6 + 0.551 + 0.1, 1e-9));
}

/// What has no path waits, too: it goes on in the cycle after the release, without catching up.
#[test]
fn an_emergency_stop_before_a_jump() {
    let asked = Inputs { emergency_stop: true, ..Inputs::default() };
    let elements = Pen::new(0.1, 1.0, 1.0).line(0.0).line(0.02).take();
    let mut interpolator = run(elements);
    let setpoints = drive(&mut interpolator, 10_000, between(0, 25, asked));
    assert!(setpoints[..25].iter().all(resting));
    assert_eq!(setpoints[25].position.x, 0.0);
    assert!(close(setpoints[26].position.x, 0.5e-6, 1e-15));
    assert_eq!(setpoints.last().unwrap().position.x, 0.02);
}

#[test]
fn it_waits_at_the_next_corner() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    pen.line(0.01).line(0.01).turn(1.0).line(0.02);
    let asked = Inputs { wait_at_next_stop: true, ..Inputs::default() };
    // 0.2 m·s... the corner is reached after 0.2/0.1·0.1 + 0.1 = 0.3 s.
    let mut interpolator = run(pen.take());
    let setpoints = drive(&mut interpolator, 10_000, between(50, 1000, asked));
    assert!(setpoints[299].path_velocity > 0.0);
    for setpoint in &setpoints[301..1000] {
        assert!(resting(setpoint) && setpoint.status == Status::Waiting);
        assert_eq!((setpoint.position.x, setpoint.place.line), (0.02, 2));
    }
    assert!(close(interpolator.duration(), 1.0 + 0.3, 1e-9));
}

#[test]
fn single_steps_rest_a_cycle_at_every_transition() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    pen.line(0.01).line(0.01).line(0.01);
    let ends: Vec<_> = pen.elements.iter().flatten().map(twin_path::PathElement::end).collect();
    let asked = Inputs { single_step: true, ..Inputs::default() };
    let mut interpolator = run(pen.take());
    let setpoints = drive(&mut interpolator, 10_000, |_| asked);
    // Up and down 10 mm with 1 m/s²: 0.2 s, and a cycle.
    assert!(close(interpolator.duration(), 0.2 * 3.0 + 2.0 * 1e-3, 1e-9));
    assert_eq!((setpoints[200].position, setpoints[200].place.line), (ends[0], 1));
    assert!(resting(&setpoints[200]));
    assert_eq!((setpoints[201].position, setpoints[201].place.line), (ends[0], 2));
    assert_eq!(setpoints[401].position, ends[1]);
    assert_eq!(setpoints.len(), 603);
}

/// 5 mm are needed to stop from 0.1 m/s: asked for at 45 mm, elements of 4 mm, the first end that can be met is that at
/// 52 mm, and the deceleration is not exceeded.
#[test]
fn single_steps_begin_where_they_can() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    for _ in 0..25 {
        pen.line(0.004);
    }
    let setpoints =
        driven(pen.take(), |cycle| Inputs { single_step: cycle >= 500, ..Inputs::default() });
    let rests: Vec<_> = setpoints[1..].iter().filter(|setpoint| resting(setpoint)).collect();
    assert!(close(rests[0].position.x, 0.052, 1e-12), "{}", rests[0].position.x);
    assert!(close(rests[1].position.x, 0.056, 1e-12));
    for setpoint in &setpoints {
        assert!(setpoint.acceleration.x >= -1.0 - 1e-9);
    }
}

#[test]
fn an_abort_ends_at_once() {
    let mut interpolator = run(hundred());
    let setpoints = drive(&mut interpolator, 10_000, |cycle| Inputs {
        abort: cycle == 300,
        ..Inputs::default()
    });
    assert_eq!(setpoints.len(), 301);
    let last = setpoints[300];
    assert!(resting(&last) && last.status == Status::Finished);
    assert_eq!(last.position, setpoints[299].position);
    assert!(interpolator.stopped_early());
}

#[test]
fn m_functions_wait_for_their_acknowledgement() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    pen.line(0.01).m(7).line(0.01);
    (pen.elements[1].as_mut().unwrap()).details = Some(Box::new(twin_path::Details {
        parameters: twin_path::MParameters { k: Some(2.5), l: None, o: None },
        ..Default::default()
    }));
    let mut interpolator = run(pen.take());
    let acknowledged = |cycle| Inputs { acknowledge_m: cycle == 900, ..Inputs::default() };
    let shown = drive(&mut interpolator, 901, acknowledged);
    for (cycle, setpoint) in shown.iter().enumerate() {
        assert_eq!(setpoint.m_function, (200..900).contains(&cycle).then_some(7), "{cycle}");
    }
    assert!(resting(&shown[500]) && shown[500].status == Status::Waiting);
    assert_eq!((shown[500].position.x, shown[500].place.line), (0.01, 2));
    assert_eq!(interpolator.m_parameters(), None);
    let rest = drive(&mut interpolator, 1000, |_| Inputs::default());
    assert_eq!(rest.last().unwrap().position.x, 0.02);
    assert!(close(interpolator.duration(), 1.1, 1e-9));
}

#[test]
fn parameters_of_an_m_function_are_there_while_it_waits() {
    let mut interpolator = run(Pen::new(0.1, 1.0, 1.0).m(3).take());
    assert_eq!(interpolator.m_parameters(), None);
    let inputs = Inputs { acknowledge_m: false, ..Inputs::default() };
    drive(&mut interpolator, 5, |_| inputs);
    assert_eq!(interpolator.m_parameters(), Some(twin_path::MParameters::default()));
    let rest = drive(&mut interpolator, 5, |_| Inputs::default());
    assert_eq!(rest.len(), 1);
    assert_eq!((rest[0].status, rest[0].m_function), (Status::Finished, None));
}

#[test]
fn dwells_take_their_time() {
    let mut interpolator =
        run(Pen::new(0.1, 1.0, 1.0).line(0.01).dwell(250_300_000).line(0.01).take());
    let setpoints = drive(&mut interpolator, 10_000, |_| Inputs::default());
    assert!(close(interpolator.duration(), 0.2 + 0.2503 + 0.2, 1e-9));
    assert!(setpoints[200..450].iter().all(|setpoint| resting(setpoint)
        && setpoint.status == Status::Waiting
        && setpoint.place.line == 2));
}

#[test]
fn statuses_and_their_numbers() {
    let setpoints = driven(hundred(), |_| Inputs::default());
    let at = |ms: usize| (setpoints[ms].status.number(), setpoints[ms].status.is_working());
    assert_eq!(at(50), (2, true));
    assert_eq!(at(500), (3, true));
    assert_eq!(at(1050), (4, true));
    assert_eq!(at(1100), (5, false));
    assert_eq!((Status::Init.number(), Status::Waiting.number()), (1, 6));
    assert!(Status::Waiting.is_working() && !Status::Init.is_working());
}

/// The mean over the cycle and the direction, on a circle.
#[test]
fn mean_velocity_and_tangent() {
    let mut interpolator = run(Pen::new(0.1, 1.0, 1.0).arc(0.05, 3.0, 0.0).take());
    let setpoints = drive(&mut interpolator, 500, |_| Inputs::default());
    let [before, last] = [setpoints[498], setpoints[499]];
    let step = (last.position - before.position).norm();
    assert!(close(interpolator.mean_velocity(), step / 1e-3, 1e-15));
    assert!(close(last.tangent().norm(), 1.0, 1e-15));
    assert!(close(last.tangent().dot(&(last.position - Point3::new(0.0, 0.05, 0.0))), 0.0, 1e-15));
}

/// A source that gives what it is fed.
pub(super) struct Drip(pub(super) VecDeque<Option<Result<CheckedElement, Error>>>);

impl Source for Drip {
    type Item = Result<CheckedElement, Error>;

    fn poll_next(&mut self) -> Poll<Option<Self::Item>> {
        match self.0.pop_front() {
            Some(Some(element)) => Poll::Ready(Some(element)),
            Some(None) => Poll::Pending,
            None => Poll::Ready(None),
        }
    }
}

/// Two lines in line; the second comes after 400 questions.
#[test]
fn starved_it_brakes_waits_and_goes_on() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    let mut elements: VecDeque<_> = checked(pen.line(0.02).line(0.02).take()).map(Some).collect();
    let second = elements.pop_back().unwrap();
    elements.extend(std::iter::repeat_with(|| None).take(4400));
    elements.push_back(second);
    let plan = LookAhead::with_window(Drip(elements), std::num::NonZeroUsize::new(1).unwrap());
    let mut interpolator = Interpolator::new(plan, DEFAULT_CYCLE_NS);
    let setpoints = drive(&mut interpolator, 10_000, |_| Inputs::default());
    // 20 mm take 0.3 s.
    assert_eq!(setpoints[300].position.x, 0.02);
    assert!(!interpolator.limited() && !interpolator.starved());
    assert_eq!((setpoints[400].status, setpoints[400].position.x), (Status::Waiting, 0.02));
    assert!(interpolator.duration() > 0.6);
    assert_eq!(setpoints.last().unwrap().position.x, 0.04);
}

/// 100 lines of 1 mm seen one at a time: it could be faster, and says so.
#[test]
fn a_small_window_is_told() {
    let mut pen = Pen::new(0.1, 1.0, 1.0);
    for _ in 0..100 {
        pen.line(0.001);
    }
    let elements = pen.take();
    for (window, limited) in [(2, true), (50, false)] {
        let window = std::num::NonZeroUsize::new(window).unwrap();
        let plan = LookAhead::with_window(checked(elements.clone()), window);
        let mut interpolator = Interpolator::new(plan, DEFAULT_CYCLE_NS);
        drive(&mut interpolator, 100, |_| Inputs::default());
        assert_eq!(interpolator.limited(), limited);
    }
}

/// What another thread sends: nothing before it is there, everything in the end.
#[test]
fn it_begins_when_the_path_is_there() {
    let (sender, receiver) = std::sync::mpsc::sync_channel(16);
    let plan: LookAhead<_, Error> = LookAhead::new(crate::controller::Incoming(receiver));
    let mut interpolator = Interpolator::new(plan, DEFAULT_CYCLE_NS);
    assert!(interpolator.poll_cycle(&Inputs::default()).is_pending());
    let elements = || Pen::new(0.1, 1.0, 1.0).line(0.02).line(0.02).take();
    for element in checked(elements()) {
        // The first goes on into something that is not there yet.
        assert!(interpolator.poll_cycle(&Inputs::default()).is_pending());
        sender.send(element).unwrap();
    }
    drop(sender);
    let setpoints = drive(&mut interpolator, 10_000, |_| Inputs::default());
    assert_eq!(setpoints, driven(elements(), |_| Inputs::default()));
}
