//! Tests of scenario faults on machines from files: they begin at their time and have their effect.

use super::{load, step};
use crate::simulated::Simulated;
use twin_kinematics::{AxisMotion, AxisVector};
use twin_machine::{Machine, Scenario};

const MOTORS: &str = include_str!("../../../machines/gantry3_motors.toml");

/// Start of the axes, m.
const START: [f64; 3] = [0.1, -0.1, 0.02];

/// m/s².
const ACCELERATION: f64 = 0.4;

/// The plain motion of `axis` after `time` s: within 0.1 s to a constant acceleration, which lasts until 0.7 s; then at constant velocity.
fn motion(axis: usize, time: f64) -> AxisMotion {
    let (rise, until) = (0.1, 0.7);
    let jerk = ACCELERATION / rise;
    let t = time.min(until);
    let [x, v, a] = if t < rise {
        [jerk * t.powi(3) / 6.0, 0.5 * jerk * t * t, jerk * t]
    } else {
        let s = t - rise;
        let (x, v) = (jerk * rise.powi(3) / 6.0, 0.5 * jerk * rise * rise);
        [x + v * s + 0.5 * ACCELERATION * s * s, v + ACCELERATION * s, ACCELERATION]
    };
    let (x, a) = if time < until { (x, a) } else { (x + v * (time - until), 0.0) };
    let of = |value: f64| {
        AxisVector::from_values((0..3).map(|one| if one == axis { value } else { 0.0 }))
    };
    let mut position = of(x);
    position.iter_mut().zip(START).for_each(|(value, start)| *value += start);
    AxisMotion { position, velocity: of(v), acceleration: of(a) }
}

/// How far the axis and its motor are after each millisecond of a second, m.
fn run(machine: &Machine, axis: usize, scenario: &str) -> Vec<[f64; 2]> {
    let start = AxisVector::from_values(START);
    let mut twin = Simulated::new(machine, &start).unwrap();
    if !scenario.is_empty() {
        let scenario = Scenario::parse(scenario, machine).unwrap_or_else(|it| panic!("{it:#?}"));
        twin = twin.in_scenario(&scenario);
    }
    let cycles = (0..=1000_i32).map(|cycle| {
        let time_ns = i64::from(cycle) * machine.cycle_ns;
        let axes = step(&mut twin, time_ns, motion(axis, f64::from(cycle) * 1e-3)).unwrap();
        [axes[axis], twin.physics().motor_position()[axis]]
    });
    cycles.collect()
}

/// Milliseconds at the beginning that both runs have in common, to the bit.
fn same(one: &[[f64; 2]], other: &[[f64; 2]]) -> usize {
    let bits = |states: &[f64; 2]| states.map(f64::to_bits);
    one.iter().zip(other).take_while(|(one, other)| bits(one) == bits(other)).count()
}

fn fault(kind: &str, axis: &str, at_s: f64, more: &str) -> String {
    format!("[[faults]]\nkind = \"{kind}\"\naxis = \"{axis}\"\nat_s = {at_s:?}\n{more}\n")
}

/// A belt between motor and slide is longer by its pull over its stiffness. It pulls against friction and 9.3 kg.
#[test]
fn a_loose_belt_gives_way_by_its_stiffness() {
    let machine = load(MOTORS);
    let sound = run(&machine, 1, "");
    let mass = 6.0 + 3.0 + 0.3;
    let pull = |time: f64| {
        let AxisMotion { velocity, acceleration, .. } = motion(1, time);
        mass * acceleration[1] + 12.0 + 40.0 * velocity[1]
    };
    // Over 100 ms.
    let stretched = |run: &[[f64; 2]], begin: usize| {
        let states = &run[begin..begin + 100];
        states.iter().map(|[axis, motor]| motor - axis).sum::<f64>() / 100.0
    };
    for (percent, play_mm) in [(20.0, 0.0), (50.0, 0.3), (70.0, 0.0)] {
        let more = format!("stiffness_percent = {percent:?}\nbacklash_mm = {play_mm:?}");
        let loose = run(&machine, 1, &fault("loose_belt", "Y", 0.4, &more));
        // The cycle that ends then is the first.
        assert_eq!(same(&sound, &loose), 400, "{percent} %");
        for (begin, states, part, play) in [
            (290, &loose, 1.0, 0.0),
            (590, &loose, percent / 100.0, play_mm * 1e-3),
            (880, &loose, percent / 100.0, play_mm * 1e-3),
            (590, &sound, 1.0, 0.0),
        ] {
            let middle = (f64::from(u32::try_from(begin).unwrap()) + 49.5) * 1e-3;
            let expected = pull(middle) / (part * 1.5e6) + 0.5 * play;
            let found = stretched(states, begin);
            let apart = (found / expected - 1.0).abs();
            assert!(apart < 0.01, "{percent} %, {middle} s: {found} m, not {expected} m");
        }
    }
}

/// A jammed axis keeps its position from that moment on, to the bit, until it is free again.
#[test]
fn an_axis_jams_at_its_time() {
    let machine = load(MOTORS);
    let sound = run(&machine, 1, "");
    for at in [250, 655] {
        let at_s = f64::from(u32::try_from(at).unwrap()) * 1e-3;
        let jammed = run(&machine, 1, &fault("jam", "Y", at_s, "for_s = 0.05"));
        assert_eq!(same(&sound, &jammed), at);
        // It is stopped within a cycle.
        let stays =
            jammed[at..at + 50].iter().all(|[axis, _]| axis.to_bits() == jammed[at][0].to_bits());
        let moved = jammed[at][0] - sound[at - 1][0];
        assert!(stays && moved.abs() < 1e-5, "{moved} m");
        assert!(jammed[at + 60][0] != jammed[at][0], "it is free again");
        assert!((jammed[1000][0] - sound[1000][0]).abs() < 1e-3, "and comes after");
    }
}

/// Lost pulses from their time on, in full steps of 25 µm. (The axis is slow enough to be stopped by that; a faster one would
/// go on and find whole turns of the field again.)
#[test]
fn pulses_are_lost_at_their_time() {
    let machine = load(&MOTORS.replace("force_n = 0.5 ", "force_n = 0.0 "));
    let sound = run(&machine, 2, "");
    for (at, steps) in [(50, 6.0), (80, 8.0)] {
        let at_s = f64::from(u32::try_from(at).unwrap()) * 1e-3;
        let short =
            run(&machine, 2, &fault("lost_steps", "Z", at_s, &format!("steps = {steps:?}")));
        assert_eq!(same(&sound, &short), at);
        let behind = sound[1000][0] - short[1000][0];
        assert!((behind - steps * 25e-6).abs() < 2e-6, "{behind} m");
    }
}
