//! Motions against closed forms, and under random retargets.
//!
//! The reference is the definition of the profile, integrated in small steps without any plan: at every instant the
//! axis looks whether it must brake for its target, and else goes towards its speed. It knows no stretches and no
//! peaks.

use proptest::prelude::*;

use super::*;

const SECOND: i64 = 1_000_000_000;

fn ramp(start_stop: f64, up: f64, speed: f64, down: f64, target: f64) -> Ramp {
    Ramp { start_stop, acceleration: up, speed, deceleration: down, target }
}

/// What limits speed and rates on the way: position and velocity at even instants must be those of a motion that
/// never exceeds them. Jumps of the velocity are allowed by `jump` only, of the position by `snap`.
fn assert_within(motion: &Motion, ramp: &Ramp, first: State, jump: f64, snap: f64) {
    let rate = ramp.acceleration.max(ramp.deceleration);
    let most = ramp.speed.max(first.velocity.abs());
    let mut last: Option<(i64, State)> = None;
    let step = 1.05 * motion.end_s / 2000.0;
    for index in 0..=2000 {
        let now_ns = motion.start_ns + nanoseconds(f64::from(index) * step);
        let state = motion.at(now_ns);
        assert!(state.velocity.abs() <= most * (1.0 + 1e-9), "{state:?} in {motion:?}");
        if let Some((then_ns, before)) = last {
            let time = seconds(now_ns - then_ns);
            let change = (state.velocity - before.velocity).abs();
            assert!(change <= rate * time * (1.0 + 1e-6) + jump + 1e-6, "{change} in {time} s");
            // A constant acceleration between: the way is the mean of the speeds; a change of it, or a jump, makes a
            // difference of at most the rate over the step.
            let way = state.position - before.position;
            let mean = 0.5 * (state.velocity + before.velocity) * time;
            let room = 0.5 * rate * time * time + jump * time + snap + 2.0 * TOLERANCE;
            assert!((way - mean).abs() <= room, "{way} instead of {mean}");
        }
        last = Some((now_ns, state));
    }
}

/// The definition, integrated in steps of `step_s` for `time_s`.
fn reference(mut state: State, ramp: &Ramp, time_s: f64, step_s: f64) -> State {
    let mut left = time_s;
    while left > 0.0 {
        let step = step_s.min(left);
        left -= step;
        let ahead = ramp.target - state.position;
        let base = ramp.start_stop.min(ramp.speed);
        let speed = state.velocity.abs();
        let stopping = (speed * speed - base * base).max(0.0) / (2.0 * ramp.deceleration);
        let away = state.velocity * ahead < 0.0;
        if ahead.abs() <= speed.max(base) * step && speed <= base + ramp.deceleration * step {
            state = State { position: ramp.target, velocity: 0.0 };
            continue;
        }
        let wanted = if speed > 0.0 && (away || stopping >= ahead.abs()) {
            0.0
        } else {
            ramp.speed * ahead.signum()
        };
        let change = wanted - state.velocity;
        let slower = wanted.abs() < speed;
        let rate = if slower { ramp.deceleration } else { ramp.acceleration };
        let mut velocity = state.velocity + change.clamp(-rate * step, rate * step);
        // The start/stop speed is reached and left at once.
        if speed < base && wanted != 0.0 {
            velocity = base * wanted.signum();
        } else if velocity.abs() < base && (away || velocity * state.velocity <= 0.0) {
            velocity = 0.0;
        }
        state.position += 0.5 * (state.velocity + velocity) * step;
        state.velocity = velocity;
    }
    state
}

prop_compose! {
    /// Ramps whose motions last some seconds.
    fn any_ramp()(
        start_stop in prop_oneof![Just(0.0), 1.0..500.0_f64],
        up in 1e3..1e5_f64,
        speed in 100.0..2e4_f64,
        down in 1e3..1e5_f64,
        target in -20_000..20_000_i32,
    ) -> Ramp {
        ramp(start_stop, up, speed, down, f64::from(target))
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn a_move_from_rest_keeps_its_limits_and_stands_on_its_target(
        ramp in any_ramp(),
        from in -20_000..20_000_i32,
    ) {
        let first = State { position: f64::from(from), velocity: 0.0 };
        let motion = Motion::plan(7, first, &ramp);
        assert_within(&motion, &ramp, first, ramp.start_stop, 0.0);
        let end_ns = 7 + nanoseconds(motion.end_s);
        let last = motion.at(end_ns - 1000);
        // A microsecond before the end it is as far as the speed there makes.
        prop_assert!((last.position - ramp.target).abs() <= ramp.speed * 2e-6 + 1e-3);
        let end = motion.at(end_ns + 2);
        prop_assert_eq!((end.position.to_bits(), end.velocity.to_bits()), (ramp.target.to_bits(), 0));
        prop_assert!(!motion.moving(end_ns + 2));
    }

    /// Speed stays continuous across retargets, or changes by what start/stop speed allows.
    #[test]
    fn retargets_keep_speed_continuous_and_end_on_the_last_target(
        ramps in proptest::collection::vec((any_ramp(), 0.0..0.5_f64), 1..6),
    ) {
        let mut motion = Motion::at_rest(0.0);
        let mut now_ns = 0;
        for (ramp, wait) in &ramps {
            let before = motion.at(now_ns);
            let next = Motion::plan(now_ns, before, ramp);
            let after = next.at(now_ns);
            prop_assert!((after.position - before.position).abs() < 1e-9);
            // From below the start/stop speed it goes to it at once.
            let base = ramp.start_stop.min(ramp.speed);
            let jump = (after.velocity - before.velocity).abs();
            prop_assert!(jump <= 2.0 * base + 1e-9, "{} after {}", after.velocity, before.velocity);
            if before.velocity.abs() > base {
                prop_assert!(jump <= 1e-9, "{} after {}", after.velocity, before.velocity);
            }
            assert_within(&next, ramp, before, 2.0 * ramp.start_stop, 0.0);
            motion = next;
            now_ns += nanoseconds(*wait);
        }
        let target = ramps[ramps.len() - 1].0.target;
        let end = motion.at(now_ns + 1000 * SECOND);
        prop_assert_eq!((end.position.to_bits(), end.velocity.to_bits()), (target.to_bits(), 0));
    }

    /// The plan is where the definition leads to, at a random instant, from a random speed.
    #[test]
    fn the_plan_is_the_definition_integrated(
        ramp in any_ramp(),
        velocity in prop_oneof![Just(0.0), -1e4..1e4_f64],
        part in 0.05..1.0_f64,
    ) {
        // Without start/stop speed: what the definition does at the jump depends on its step.
        let ramp = Ramp { start_stop: 0.0, ..ramp };
        let first = State { position: 0.0, velocity };
        let motion = Motion::plan(0, first, &ramp);
        let time = part * motion.end_s;
        let step = motion.end_s / 2e4;
        let expected = reference(first, &ramp, time, step);
        let found = motion.at(nanoseconds(time));
        // An Euler step late at each of at most four changes of acceleration, the speed between them wrong by a
        // step's change of speed for the rest of the time.
        let rate = ramp.acceleration.max(ramp.deceleration);
        let most = ramp.speed.max(velocity.abs());
        let room = 4.0 * step * (rate * motion.end_s + most) + 1e-3;
        let away = (found.position - expected.position).abs();
        prop_assert!(away <= room, "{found:?} instead of {expected:?} ± {room}");
    }

    /// A stop takes v/a and v²/2a, and ends on the whole step nearest to that.
    #[test]
    fn a_stop_is_the_closed_form(
        ramp in any_ramp(),
        position in -1e6..1e6_f64,
        velocity in -2e4..2e4_f64,
    ) {
        let first = State { position, velocity };
        let motion = Motion::stop(0, first, &ramp);
        let base = ramp.start_stop.min(velocity.abs());
        let time = (velocity.abs() - base) / ramp.deceleration;
        let way = velocity.signum() * (velocity * velocity - base * base) / (2.0 * ramp.deceleration);
        prop_assert!((motion.end_s - time).abs() < 1e-9);
        let end = motion.at(nanoseconds(time) + 1);
        prop_assert_eq!(end.velocity.to_bits(), 0);
        prop_assert!((end.position - (position + way)).abs() <= 0.5 + 1e-6);
        prop_assert_eq!(end.position.fract().abs().to_bits(), 0);
        assert_within(&motion, &ramp, first, ramp.start_stop, 0.5);
    }

    /// A speed is reached after the closed time and kept; a reversal passes through rest.
    #[test]
    fn a_run_reaches_its_speed_and_keeps_it(
        from in -2e4..2e4_f64,
        to in prop_oneof![Just(0.0), -2e4..2e4_f64],
        up in 1e3..1e5_f64,
        down in 1e3..1e5_f64,
    ) {
        let first = State { position: 5.0, velocity: from };
        let motion = Motion::run(0, first, to, up, down);
        let (time, way) = if from * to < 0.0 {
            (
                from.abs() / down + to.abs() / up,
                from * from.abs() / (2.0 * down) + to * to.abs() / (2.0 * up),
            )
        } else {
            let rate = if to.abs() < from.abs() { down } else { up };
            ((to - from).abs() / rate, 0.5 * (to + from) * (to - from).abs() / rate)
        };
        let state = motion.at(nanoseconds(time) + 1);
        prop_assert!((state.velocity - to).abs() < 1e-3, "{state:?} instead of {to}");
        prop_assert!((state.position - 5.0 - way).abs() < 1e-3, "{state:?} instead of {way}");
        prop_assert!(motion.at_speed(nanoseconds(time) + 1));
        prop_assert!(time < 1e-6 || !motion.at_speed(nanoseconds(0.999 * time)));
        let later = motion.at(nanoseconds(time + 10.0));
        prop_assert!((later.position - 5.0 - way - 10.0 * to).abs() < 1e-3);
        prop_assert!(motion.moving(1000 * SECOND));
    }
}

/// 3200 steps at 1000 steps/s² up to 1000 steps/s and 2000 down: 1 s and 500 steps up, 0.5 s and 250 steps down, 2450
/// between.
#[test]
fn a_trapezoid_has_its_corners() {
    let motion = Motion::plan(0, State::default(), &ramp(0.0, 1000.0, 1000.0, 2000.0, 3200.0));
    let corners = [(1.0, 500.0, 1000.0), (3.45, 2950.0, 1000.0), (3.7, 3137.5, 500.0)];
    for (time, position, velocity) in corners {
        let state = motion.at(nanoseconds(time));
        assert!((state.position - position).abs() < 1e-6, "{state:?} after {time} s");
        assert!((state.velocity - velocity).abs() < 1e-6, "{state:?} after {time} s");
    }
    assert!((motion.end_s - 3.95).abs() < 1e-9);
    assert!(!motion.in_final_brake(nanoseconds(3.44)) && motion.in_final_brake(nanoseconds(3.46)));
}

/// At start/stop speed from the first instant to the last: 200 to 600 steps/s at 1000 steps/s², and back.
#[test]
fn start_and_stop_speed_are_jumps() {
    let motion = Motion::plan(0, State::default(), &ramp(200.0, 1000.0, 600.0, 1000.0, 1000.0));
    assert!((motion.at(0).velocity - 200.0).abs() < 1e-9);
    // (600² − 200²) / 2000 = 160 steps and 0.4 s each way, 680 steps between at 600.
    let end = 0.8 + 680.0 / 600.0;
    assert!((motion.end_s - end).abs() < 1e-9);
    let last = motion.at(nanoseconds(end) - 10);
    assert!((last.velocity - 200.0).abs() < 1e-3, "{last:?}");
    // Below the start/stop speed there is no ramp at all.
    let slow = Motion::plan(0, State::default(), &ramp(200.0, 1000.0, 50.0, 1000.0, 100.0));
    assert!((slow.end_s - 2.0).abs() < 1e-9);
    assert!((slow.at(SECOND).position - 50.0).abs() < 1e-6);
}

/// A target behind: brakes, passes its stopping point, returns.
#[test]
fn a_target_behind_is_returned_to() {
    let first = State { position: 0.0, velocity: 1000.0 };
    let motion = Motion::plan(0, first, &ramp(0.0, 500.0, 1000.0, 1000.0, -500.0));
    let turned = motion.at(SECOND);
    assert!((turned.position - 500.0).abs() < 1e-6 && turned.velocity.abs() < 1e-6);
    // 1000 steps back: peak² · (1/1000 + 1/2000) = 1000, so below the speed asked for.
    let peak = (1000.0_f64 / (1.0 / 1000.0 + 1.0 / 2000.0)).sqrt();
    assert!((motion.end_s - (1.0 + peak / 500.0 + peak / 1000.0)).abs() < 1e-9);
    assert!((motion.sense(0) - 1.0).abs() < 1e-9 && (motion.sense(2 * SECOND) + 1.0).abs() < 1e-9);
    assert!((motion.final_sense() + 1.0).abs() < 1e-9);
}

#[test]
fn crossings_are_where_the_closed_form_has_them() {
    // 0 to 10000 at 1000 steps/s with 1000 steps/s²: edge 2500 is 2000 steps after the ramp, at 1 s + 2 s.
    let motion = Motion::plan(0, State::default(), &ramp(0.0, 1e3, 1e3, 1e3, 10e3));
    assert_eq!(motion.crossing(0, 2500.0), Some(3 * SECOND));
    // In the ramp: ½·1000·t² = 125 at half a second.
    assert_eq!(motion.crossing(0, 125.0), Some(SECOND / 2));
    // Reached and not crossed again; beyond the target; behind the start.
    assert_eq!(motion.crossing(4 * SECOND, 2500.0), None);
    assert_eq!(motion.crossing(0, 10_000.5), None);
    assert_eq!(motion.crossing(0, -1.0), None);
    // Shifted by 100 steps and 1 s.
    let other = motion.shifted(100.0).later(SECOND);
    assert_eq!(other.crossing(0, 2600.0), Some(4 * SECOND));
}

#[test]
fn a_motion_that_turns_crosses_an_edge_twice() {
    // At 1000 steps/s and position 0, back to −1000: braked after 1 s and 500 steps, then back.
    let state = State { position: 0.0, velocity: 1e3 };
    let motion = Motion::plan(0, state, &ramp(0.0, 1e3, 1e3, 1e3, -1e3));
    assert!(motion.turns());
    assert_eq!(motion.turn_ns(), SECOND);
    // 375 = 1000·t − 500·t² at half a second, and as long after the turn.
    let there = motion.crossing(0, 375.0).unwrap();
    assert_eq!(there, SECOND / 2);
    let back = motion.crossing(there, 375.0).unwrap();
    assert!((back - 3 * SECOND / 2).abs() <= 1, "{back}");
    assert!(!Motion::at_rest(5.0).turns());
}
