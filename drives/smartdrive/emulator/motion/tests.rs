//! The generator under random commands: what must hold whatever is asked of it.

use proptest::prelude::*;

use super::*;
use twin_drives::ramp::{nanoseconds, seconds};

const MS: i64 = 1_000_000;

/// 3200 µsteps a turn, 600 rpm, 3000 and 2000 rpm/s, 9000 in emergencies.
fn ceilings(positions: (i32, i32)) -> Ceilings {
    Ceilings {
        turn: StepsPerTurn::new(200, 16).unwrap(),
        velocity: 600,
        acceleration: 3000,
        deceleration: 2000,
        emergency: 9000,
        positions,
        assumptions: Assumptions::default(),
    }
}

/// 600 rpm, µsteps/s.
const FASTEST: f64 = 600.0 * 3200.0 / 60.0;

#[derive(Clone, Copy, Debug)]
enum Asked {
    GoTo(i32, u16, u16),
    Step(i32, u16, u16),
    Start(i16, u16),
    Stop(u16),
    Switches(bool, bool),
}

fn any_command() -> impl Strategy<Value = Asked> {
    let speed = || prop_oneof![Just(0_u16), 1..2000_u16];
    let rate = || prop_oneof![Just(0_u16), 1..9000_u16];
    prop_oneof![
        (-20_000..20_000_i32, speed(), rate()).prop_map(|(p, v, a)| Asked::GoTo(p, v, a)),
        (-20_000..20_000_i32, speed(), rate()).prop_map(|(d, v, a)| Asked::Step(d, v, a)),
        (-2000..2000_i16, rate()).prop_map(|(v, a)| Asked::Start(v, a)),
        rate().prop_map(Asked::Stop),
        (any::<bool>(), any::<bool>()).prop_map(|(p, n)| Asked::Switches(p, n)),
    ]
}

/// Refused or not.
fn give(generator: &mut Generator, now_ns: i64, ceilings: &Ceilings, asked: Asked) {
    match asked {
        Asked::GoTo(target, speed, rate) => {
            generator.go_to(now_ns, ceilings, target, speed, rate).unwrap_or_default();
        }
        Asked::Step(distance, speed, rate) => {
            generator.step(now_ns, ceilings, distance, speed, rate).unwrap_or_default();
        }
        Asked::Start(speed, rate) => generator.start(now_ns, ceilings, speed, rate),
        Asked::Stop(rate) => generator.stop(now_ns, ceilings, rate),
        Asked::Switches(positive, negative) => {
            generator.set_switches(now_ns, ceilings, positive, negative);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Speed and position are continuous whatever is asked (a stop ends on a whole µstep: half a µstep), speeds and
    /// rates stay below their ceilings, position limits hold, and nothing moves on towards an active switch for longer
    /// than braking takes.
    #[test]
    fn whatever_is_asked_the_ceilings_hold(
        commands in proptest::collection::vec((any_command(), 0..400_i64), 1..20),
        limited in any::<bool>(),
    ) {
        let ceilings = ceilings(if limited { (-5000, 6000) } else { (0, 0) });
        let mut generator = Generator::at_rest(0.0);
        let mut now_ns = 0;
        let steepest = ceilings.turn.steps(9000.0);
        // Slowest deceleration the commands can ask for is 1 rpm/s; overshooting a limit by it is the caller's wish.
        for (asked, wait_ms) in commands {
            let before = generator.state(now_ns);
            give(&mut generator, now_ns, &ceilings, asked);
            let after = generator.state(now_ns);
            prop_assert!((after.position - before.position).abs() <= 0.5 + 1e-9, "{asked:?}");
            prop_assert!((after.velocity - before.velocity).abs() < 1e-6, "{asked:?}");
            let mut last = after;
            for _ in 0..wait_ms {
                now_ns += MS;
                let state = generator.state(now_ns);
                prop_assert!(state.velocity.abs() <= FASTEST + 1e-6, "{state:?}");
                let change = (state.velocity - last.velocity).abs();
                prop_assert!(change <= steepest * 1e-3 + 1e-6, "{change} after {asked:?}");
                let way = (state.position - last.position).abs();
                prop_assert!(way <= FASTEST * 1e-3 + 0.5 + 1e-6, "{way} after {asked:?}");
                last = state;
            }
        }
    }

    /// The last GOTO is reached exactly and says so, whatever was before.
    #[test]
    fn the_last_target_is_reached(
        commands in proptest::collection::vec((any_command(), 0..400_i64), 0..8),
        target in -20_000..20_000_i32,
    ) {
        let ceilings = ceilings((0, 0));
        let mut generator = Generator::at_rest(0.0);
        let mut now_ns = 0;
        for (asked, wait_ms) in commands {
            give(&mut generator, now_ns, &ceilings, asked);
            now_ns += wait_ms * MS;
        }
        generator.set_switches(now_ns, &ceilings, false, false);
        generator.go_to(now_ns, &ceilings, target, 0, 0).unwrap();
        // From 600 rpm at 2000 rpm/s and back, and 2000 turns at 600 rpm at the very most.
        now_ns += nanoseconds(1000.0);
        prop_assert_eq!(generator.counter(now_ns), target);
        prop_assert_eq!(generator.flags(now_ns), TrajectoryFlags::DONE);
        prop_assert!(!generator.is_under_way(now_ns));
    }

    /// Targets outside the limits are refused and change nothing; START ends on them.
    #[test]
    fn position_limits_hold(target in -20_000..20_000_i32, speed in 1..600_i16, wait_ms in 0..2000_i64) {
        let ceilings = ceilings((-5000, 6000));
        let mut generator = Generator::at_rest(0.0);
        generator.start(0, &ceilings, speed, 0);
        let now_ns = wait_ms * MS;
        let before = generator.state(now_ns + MS);
        let accepted = generator.go_to(now_ns, &ceilings, target, 0, 0).is_ok();
        prop_assert_eq!(accepted, (-5000..=6000).contains(&target));
        if !accepted {
            let after = generator.state(now_ns + MS);
            prop_assert_eq!(after.position.to_bits(), before.position.to_bits());
            prop_assert_eq!(generator.counter(nanoseconds(1000.0)), 6000);
        }
    }

    /// Stopped by a switch it rests within v²/2a of where it was, and stays.
    #[test]
    fn a_switch_stops_within_the_emergency_way(speed in 1..600_i16, wait_ms in 1..2000_i64) {
        let ceilings = ceilings((0, 0));
        let mut generator = Generator::at_rest(0.0);
        generator.start(0, &ceilings, -speed, 0);
        let now_ns = wait_ms * MS;
        let before = generator.state(now_ns);
        generator.set_switches(now_ns, &ceilings, false, true);
        let rate = ceilings.turn.steps(9000.0);
        let way = before.velocity * before.velocity / (2.0 * rate);
        let end = now_ns + nanoseconds(before.velocity.abs() / rate) + 1;
        let stands = generator.state(end);
        prop_assert!((before.position - stands.position - way).abs() <= 0.5 + 1e-6);
        prop_assert_eq!(generator.state(end + 1000 * MS).position.to_bits(), stands.position.to_bits());
        prop_assert!(generator.flags(end).contains(TrajectoryFlags::LIMITED_N));
        prop_assert!(!generator.flags(end).contains(TrajectoryFlags::DONE));
    }
}

/// 600 rpm at 3000 rpm/s take 0.2 s.
#[test]
fn a_speed_is_done_when_it_is_reached() {
    let ceilings = ceilings((0, 0));
    let mut generator = Generator::at_rest(0.0);
    generator.start(0, &ceilings, 600, 0);
    let flags = |generator: &Generator, time: f64| generator.flags(nanoseconds(time));
    assert_eq!(flags(&generator, 0.0), TrajectoryFlags::NONE);
    assert_eq!(flags(&generator, 0.199), TrajectoryFlags::IN_MOTION);
    let reached = TrajectoryFlags::IN_MOTION.union(TrajectoryFlags::DONE);
    assert_eq!(flags(&generator, 0.201), reached);
    // A retarget begins anew, a stop at 2000 rpm/s takes 0.3 s.
    generator.stop(nanoseconds(1.0), &ceilings, 0);
    assert_eq!(flags(&generator, 1.299), TrajectoryFlags::IN_MOTION);
    assert_eq!(flags(&generator, 1.301), TrajectoryFlags::DONE);
    assert!((seconds(nanoseconds(1.301)) - 1.301).abs() < 1e-9);
}

/// The counter has 32 bits and goes on beyond them.
#[test]
fn the_counter_overflows_as_32_bits_do() {
    let generator = Generator::at_rest(2_147_483_650.0);
    assert_eq!(generator.counter(0), -2_147_483_646);
}

/// "STEP: as GOTO": the target is a position of 32 bits. Never the other way.
#[test]
fn a_step_beyond_32_bits_is_refused_or_ends_at_the_last_position() {
    let refuses = ceilings((0, 0));
    let clamps = Ceilings {
        assumptions: Assumptions { clamps_targets: true, ..refuses.assumptions },
        ..refuses
    };
    for (at, distance, last) in [(2_147_480_000, 5000, i32::MAX), (-2_147_480_000, -5000, i32::MIN)]
    {
        let mut generator = Generator::at_rest(f64::from(at));
        let refused = generator.step(0, &refuses, distance, 0, 0);
        assert_eq!((refused, generator.target()), (Err(RejectCode::BadParams), None));
        assert!(!generator.is_under_way(MS), "it stands");
        assert_eq!(generator.step(0, &clamps, distance, 0, 0), Ok(()));
        assert_eq!(generator.counter(nanoseconds(100.0)), last);
    }
}
