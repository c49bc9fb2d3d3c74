//! Tests of viscous friction, H belts and tripods: closed forms of straight lines, and every set-point against inverse
//! dynamics.

use super::effort_tests::{GANTRY3, Limited, edited, limited, near, rest_to_rest};
use super::*;
use twin_machine::Machine;

const GANTRY_H2: &str = include_str!("../../machines/gantry_h2.toml");
const TRIPOD: &str = include_str!("../../tests/data/machines/tripod.toml");

/// All axes of a machine without viscous friction, or with forces of other motors.
fn all(text: &str, edits: &[(&str, &str)]) -> Machine {
    let text = edits.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the file");
        text.replace(from, to)
    });
    edited(&text, &[])
}

/// Every set-point against the efforts of the machine in time, which know no path: the largest part of the limit that each
/// motor gives.
fn used(machine: &Machine, found: &Limited) -> Vec<f64> {
    let mut dynamics = machine.path_dynamics().unwrap().unwrap();
    let mut most = vec![0.0_f64; machine.axes.len()];
    for sample in &found.samples {
        let torque = dynamics.at(&sample.position, &sample.velocity, &sample.acceleration).unwrap();
        let motors = torque.axes().iter().zip(&machine.axes).zip(&mut most).enumerate();
        for (index, ((effort, axis), most)) in motors {
            let v = sample.velocity[index];
            let dry = if v == 0.0 { 0.0 } else { axis.simulated.dry_friction().copysign(v) };
            let effort = effort.effort(0.0, 1.0) + dry;
            let reported = sample.effort.unwrap()[index];
            assert!((effort - reported).abs() < 1e-9, "{}: {effort} and {reported}", axis.name);
            *most = most.max(effort.abs() / axis.simulated.effort_limit);
        }
    }
    most
}

/// The least time for `length` with v̇ = (F − d·v)/m at first and `down` at last: v = F/d·(1 − exp(−t/τ)) on the way up, τ = m/d
/// and `later`, s.
fn against_friction([force, drag, mass]: [f64; 3], length: f64, down: f64, later: f64) -> f64 {
    let tau = mass / drag + later;
    let up = |t: f64| {
        let v = force / drag * (1.0 - (-t / tau).exp());
        (v, force / drag * t - tau * v)
    };
    let (mut early, mut late) = (0.0, 100.0);
    for _ in 0..200 {
        let t = f64::midpoint(early, late);
        let (v, way) = up(t);
        if way + v * v / (2.0 * down) < length { early = t } else { late = t }
    }
    early + up(early).0 / down
}

/// 100 N move 33.3 kg against 400 N·s/m: never faster than 250 mm/s, and slower and slower towards that.
#[test]
fn friction_takes_what_it_takes_at_every_speed() {
    let machine = |jerk: &str| {
        let acceleration = format!("max_acceleration_mm_per_s2 = 3000.0{jerk}");
        edited(
            GANTRY3,
            &[
                ("max_force_n = 600.0", "max_force_n = 100.0"),
                ("viscous_friction_n_s_per_m = 60.0", "viscous_friction_n_s_per_m = 400.0"),
                ("coulomb_friction_n = 20.0", "coulomb_friction_n = 0.0"),
                ("max_acceleration_mm_per_s2 = 3000.0", &acceleration),
            ],
        )
    };
    for length in [20.0, 100.0, 300.0] {
        let text = format!("% line\nN10 G92 X0 Y0 Z0 F400 E9000 E-9000\nN20 G1 X{length}\n");
        let least = |later| against_friction([100.0, 400.0, 33.3], length * 1e-3, 3.0, later);
        let expected = least(0.0);
        let found = limited(&machine(""), &text, LimitRules::default());
        println!("{length} mm: {:.6} s, {expected:.6} s", found.duration);
        // The acceleration is that of the velocity at the end of a cell of at most 2 ms: Euler's method backwards, which has a
        // time constant longer by half of that.
        assert!(found.duration > expected * (1.0 - 1e-4), "{}", found.duration);
        assert!(found.duration < least(1e-3) * (1.0 + 1e-4), "{}", found.duration);
        // Friction of the largest velocity all the way would take a good part more.
        near(found.duration, expected, 2e-3);
        let most = used(&machine(""), &found);
        assert!(most[0] > 0.99 && most[0] <= 1.001, "{most:?}");
        // With limited jerk it takes longer by the time in which accelerations come and go, of which there are three.
        let jerk = "\nmax_jerk_mm_per_s3 = 1000000.0";
        let smooth = limited(&machine(jerk), &text, LimitRules::default());
        println!("with jerk: {:.6} s", smooth.duration);
        let change = 3.0 / 1000.0;
        assert!(smooth.duration > expected * (1.0 - 1e-4));
        assert!(smooth.duration < expected * (1.0 + 1e-3) + 3.0 * change, "{}", smooth.duration);
        let most = used(&machine(jerk), &smooth);
        assert!(most[0] > 0.99 && most[0] <= 1.001, "{most:?}");
    }
}

const MOTOR_A: Binding = Binding::Axis { axis: 0, quantity: Quantity::Effort };
const MOTOR_B: Binding = Binding::Axis { axis: 1, quantity: Quantity::Effort };

/// x moves 6.7 kg and y 2.7 kg; either motor feels half of each, and its rotor of 1 kg. Along x, along y, and with A alone.
#[test]
fn motors_of_a_belt_share_what_they_move() {
    let machine = all(
        GANTRY_H2,
        &[
            ("max_force_n = 250.0", "max_force_n = 20.0"),
            ("viscous_friction_n_s_per_m = 10.0", "viscous_friction_n_s_per_m = 0.0"),
        ],
    );
    for (way, moved, motors) in [
        ("X40", 6.7 / 2.0 + 1.0, &[MOTOR_A, MOTOR_B][..]),
        ("Y40", 2.7 / 2.0 + 1.0, &[MOTOR_A, MOTOR_B]),
        ("X40 Y40", 6.7 / 2.0 + 2.7 / 2.0 + 2.0, &[MOTOR_A]),
        ("X40 Y-40", 6.7 / 2.0 + 2.7 / 2.0 + 2.0, &[MOTOR_B]),
    ] {
        let text = format!("% belt\nN10 G92 X0 Y0 Z10 F600 E90000 E-90000\nN20 G1 {way}\n");
        let found = limited(&machine, &text, LimitRules::default());
        // Where both coordinates move the belt goes twice as far.
        let acceleration = 14.0 / moved;
        near(found.duration, rest_to_rest(0.04, acceleration, acceleration), 1e-4);
        assert!(found.findings.is_empty(), "{:?}", found.findings);
        let [first, ..] = &found.changes[..] else { panic!("no changes") };
        assert!(motors.contains(&first.binding) && first.gain_s > 0.0, "{first:?}");
        let most = used(&machine, &found);
        let [a, b, _] = most[..] else { panic!("three axes") };
        assert!(a.max(b) > 0.999 && a.max(b) <= 1.001, "{most:?}");
        let mut rules = LimitRules::default();
        rules.axes.effort = false;
        let free = limited(&machine, &text, rules);
        assert!(free.duration < 0.999 * found.duration, "{way}");
        assert!(free.samples.iter().all(|sample| sample.effort.is_some()));
    }
}

/// In the middle each carriage of 1.5 kg carries a third of platform, tool and rods, and turns a rotor of 1 kg.
#[test]
fn motors_of_a_tripod_lift_it() {
    let machine = all(
        TRIPOD,
        &[
            ("max_force_n = 300.0", "max_force_n = 30.0"),
            ("viscous_friction_n_s_per_m = 10.0", "viscous_friction_n_s_per_m = 0.0"),
        ],
    );
    let carried = 1.5 + (1.2 + 0.3 + 6.0 * 0.06) / 3.0;
    let (weight, moved) = (carried * 9.81, carried + 1.0);
    let (against, with) = ((25.0 - weight) / moved, 8.0_f64.min((25.0 + weight) / moved));
    for (end, up, down) in [(90, against, with), (30, with, against)] {
        let text = format!("% lift\nN10 G92 X0 Y0 Z60 F500 E90000 E-90000\nN20 G1 Z{end}\n");
        let found = limited(&machine, &text, LimitRules::default());
        near(found.duration, rest_to_rest(0.03, up, down), 1e-4);
        assert!(found.findings.is_empty(), "{:?}", found.findings);
    }
    let weak = all(TRIPOD, &[("max_force_n = 300.0", "max_force_n = 20.0")]);
    let text = "% weak\nN10 G92 X0 Y0 Z60 F100 E1000 E-1000\nN20 G1 X50\n";
    let found = limited(&weak, text, LimitRules::default());
    assert!(found.findings.iter().any(|finding| finding.rule == crate::finding::Rule::AxisEffort));
}

/// Lines, arcs and corners on weak motors with much friction, as designed and with rods as measured, with and without limited
/// jerk.
#[test]
fn no_motor_of_a_tripod_gives_more_than_it_can() {
    const PROGRAM: &str = "\
% tripod
N10 G92 X0 Y0 Z60 F500 E20000 E-20000
N20 G1 X100 Y20
N30 G1 X-40 Y80 Z90
N40 G2 X40 Y80 I40 J0
N50 G1 X60 Y-70 Z30
N60 G3 X-60 Y-70 I-60 J0
N70 G1 X0 Y0 Z60
";
    let weak = ("max_force_n = 300.0", "max_force_n = 40.0");
    let drag = ("viscous_friction_n_s_per_m = 10.0", "viscous_friction_n_s_per_m = 15.0");
    let measured = (
        "rod_lengths_mm = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]",
        "rod_lengths_mm = [0.5, -0.3, 0.2, 0.4, -0.6, 0.1]",
    );
    let jerk = (
        "max_acceleration_mm_per_s2 = 8000.0",
        "max_acceleration_mm_per_s2 = 8000.0\nmax_jerk_mm_per_s3 = 400000.0",
    );
    for edits in [&[weak, drag][..], &[weak, drag, measured], &[weak, drag, jerk]] {
        let machine = all(TRIPOD, edits);
        let found = limited(&machine, PROGRAM, LimitRules::default());
        assert!(found.findings.is_empty(), "{:?}", found.findings);
        let most = used(&machine, &found);
        println!("{most:?} of the limits in {:.3} s", found.duration);
        assert!(most.iter().all(|most| *most <= 1.001), "{most:?}");
        assert!(most.iter().fold(0.0, |most: f64, one| most.max(*one)) > 0.99, "{most:?}");
        let mut rules = LimitRules::default();
        rules.axes.effort = false;
        let free = limited(&machine, PROGRAM, rules);
        assert!(free.duration < 0.98 * found.duration, "{} {}", free.duration, found.duration);
    }
}
