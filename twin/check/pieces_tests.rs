//! Tests of the check by pieces of the plan: what lies between set-points, against closed forms.

use super::Outcome;
use super::tests::checked;
use crate::finding::{Finding, Rule};
use crate::program::settings::ReadSettings;

/// X and Y: 3000 mm/s², which is 3 mm/s in a cycle.
const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");
/// Arms of 250 and 200 mm; A: 1500 deg/s², B: 2500 deg/s².
const SCARA2: &str = include_str!("../../tests/data/machines/scara2.toml");

const SCARA3: &str = include_str!("../../machines/scara3.toml");

/// The values of a rule by axis, in deg or mm.
fn values(outcome: &Outcome, rule: Rule) -> Vec<(&str, f64)> {
    let found = outcome.findings.iter().filter(|finding| finding.rule == rule);
    let mut values: Vec<_> =
        found.map(|finding| (finding.axis.as_deref().unwrap(), finding.value.unwrap())).collect();
    values.sort_by_key(|(axis, _)| *axis);
    values
}

#[track_caller]
fn near(found: &[(&str, f64)], wanted: &[(&str, f64)], part: f64) {
    let fits = found.len() == wanted.len()
        && found.iter().zip(wanted).all(|((axis, value), (other, expected))| {
            axis == other && (value / expected - 1.0).abs() < part
        });
    assert!(fits, "{found:?} instead of {wanted:?}");
}

fn step(outcome: &Outcome) -> &Finding {
    let mut steps = outcome.findings.iter();
    steps.find(|finding| finding.rule == Rule::AxisVelocityStep).unwrap()
}

/// A corner of `degrees` that is passed at F, at 200 mm from the start.
fn corner(degrees: f64, feed: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (x, y) = (200.0 + 100.0 * cos, 100.0 * sin);
    format!("% corner\nN10 F{feed:.9} E1000 E-1000\nN20 G1 X200 Y0\nN30 G1 X{x:.9} Y{y:.9}\n")
}

/// Y steps by F·sin δ where the path turns by δ without a stop; with the feed of the message by no more than it may.
#[test]
fn a_corner_within_the_tolerance_steps() {
    for degrees in [1.9_f64, 1.0, 0.9] {
        let outcome = checked(GANTRY3, &corner(degrees, 200.0));
        let expected = 200.0 * degrees.to_radians().sin();
        let found = values(&outcome, Rule::AxisVelocityStep);
        near(&found, &[("Y", expected)], 1e-6);
        let finding = step(&outcome);
        assert_eq!((finding.line, finding.limit), (4, Some(3.0)));
        assert!(finding.message.contains(&format!("turns by {degrees}°")), "{finding:?}");
        let feed = finding.largest_feed_mm_per_s.unwrap();
        assert!((feed / (3.0 / degrees.to_radians().sin()) - 1.0).abs() < 1e-6, "{feed}");
        let again = |feed: f64| !checked(GANTRY3, &corner(degrees, feed)).findings.is_empty();
        assert!(!again(feed * (1.0 - 1e-9)) && again(1.001 * feed), "{degrees}");
    }
    // 2.79 mm/s are less than an axis makes in a cycle; the angle is above the tolerance, and the path stops.
    for degrees in [0.8, 15.0] {
        assert_eq!(checked(GANTRY3, &corner(degrees, 200.0)).findings, []);
    }
    // The machine file says otherwise.
    let x = "max_acceleration_mm_per_s2 = 3000.0";
    assert_eq!(GANTRY3.matches(x).count(), 2);
    let weak = GANTRY3.replace(x, &format!("{x}\nmax_velocity_step_mm_per_s = 1.0"));
    let outcome = checked(&weak, &corner(0.8, 200.0));
    near(
        &values(&outcome, Rule::AxisVelocityStep),
        &[("Y", 200.0 * 0.8_f64.to_radians().sin())],
        1e-6,
    );
}

/// A circle of 1 mm as chords of just less than 0.02 mm: each corner of 1.146° is a step of 2 mm/s, and six of them make one of
/// 2·F·sin(6·1.146°/2) within a cycle.
#[test]
fn corners_that_follow_each_other_within_a_cycle_are_one() {
    let angle = 0.02_f64;
    let lines = (1..=400).zip((30..).step_by(10)).map(|(corner, number)| {
        let (sin, cos) = (f64::from(corner) * angle).sin_cos();
        format!("N{number} G1 X{:.9} Y{:.9}\n", 99.0 + cos, 100.0 + sin)
    });
    let begin = "% chords\nN10 G92 X100 Y100\nN20 F100 E2900 E-2900\n".to_owned();
    let program: String = std::iter::once(begin).chain(lines).collect();
    let outcome = checked(GANTRY3, &program);
    let expected = 200.0 * (3.0 * angle).sin();
    for axis in ["X", "Y"] {
        let found = values(&outcome, Rule::AxisVelocityStep).into_iter();
        let worst = found
            .filter(|(name, _)| *name == axis)
            .fold(0.0, |worst, (_, value)| f64::max(worst, value));
        assert!((worst / expected - 1.0).abs() < 1e-3, "{axis}: {worst}");
    }
    // At 55 mm/s three of 1.1 mm/s are in a cycle, at 30 mm/s two of 0.6 mm/s.
    let slower = |feed: &str| checked(GANTRY3, &program.replace("F100", feed)).findings;
    let steps =
        |findings: &[Finding]| findings.iter().any(|one| one.rule == Rule::AxisVelocityStep);
    assert!(steps(&slower("F55")) && !steps(&slower("F30")));
}

/// 300 mm/s are just reached over 5 mm with 1000 mm/s², but for rounding; what is left of the ramp has no acceleration.
#[test]
fn ramps_without_a_duration_have_no_acceleration() {
    let program =
        "% x\nN10 G92 X100 Y0 Z0\nN20 G1 X105 F300 E1000 E-400\nN30 G1 X110 F300 E9000 E-400\n";
    let outcome = checked(GANTRY3, program);
    assert_eq!(outcome.findings, []);
    assert!((outcome.peaks[0].acceleration.value - 1.0).abs() < 1e-6, "{:?}", outcome.peaks[0]);
}

/// Three quarters of a circle about the base turn A by 270 degrees from where it starts, B stays.
#[test]
fn an_arc_may_turn_an_axis_by_more_than_half_a_turn() {
    let program = "% x\nN10 G92 X200 Y0 Z0\nN20 G3 X0 Y-200 I-200 J0 F200 E1000 E-1000\n";
    let [low, high] = checked(SCARA2, program).peaks[0].position.unwrap().map(f64::to_degrees);
    let (inner, outer, r) = (250.0_f64, 200.0_f64, 200.0_f64);
    let start = -((inner * inner + r * r - outer * outer) / (2.0 * inner * r)).acos().to_degrees();
    assert!((low - start).abs() < 1e-6 && (high - start - 270.0).abs() < 1e-6, "{low} {high}");
}

/// An arc that goes on from a line steps in acceleration only, by F²/r.
#[test]
fn from_a_line_into_an_arc() {
    let program =
        "% arc\nN10 F150 E1000 E-1000\nN20 G1 X200 Y0\nN30 G3 X203 Y3 I0 J3\nN40 G1 Y100\n";
    let outcome = checked(GANTRY3, program);
    assert_eq!(values(&outcome, Rule::AxisVelocityStep), []);
    near(&values(&outcome, Rule::AxisAcceleration), &[("X", 7500.0), ("Y", 7500.0)], 1e-6);
}

/// Where the tool comes to rest with a constant deceleration E and the arms stretched, B arrives with
/// √(E·(L1 + L2)/(L1·L2)), and A with L2/(L1 + L2) of that.
#[test]
fn a_line_that_ends_with_stretched_arms_steps() {
    for (feed, deceleration) in [(60.0, 300.0), (100.0, 1000.0), (20.0, 1000.0)] {
        let program = format!(
            "% stretched\nN10 G92 X300 Y0 Z20\nN20 F{feed} E{deceleration} E-{deceleration}\nN30 G1 X450 Y0\n"
        );
        let outcome = checked(SCARA2, &program);
        let b = f64::sqrt(deceleration * 450.0 / (250.0 * 200.0)).to_degrees();
        let wanted = [("A", b * 200.0 / 450.0), ("B", b)];
        near(&values(&outcome, Rule::AxisVelocityStep), &wanted, 1e-3);
        assert_eq!(step(&outcome).largest_feed_mm_per_s, None);
    }
}

/// A circle of 50 mm that touches the edge of the reach, 450 mm, from inside: B = 0.6325·|θ| there, which reverses at once.
#[test]
fn a_circle_that_touches_the_edge_of_the_reach_steps() {
    let program = "% touches\nN10 G92 X350 Y0 Z20\nN20 F60 E300 E-300\nN30 G3 X350 Y0 I50 J0\n";
    let outcome = checked(SCARA2, program);
    // |θ̇| = F/r = 1.2 rad/s.
    let b = 2.0 * 0.632_5 * 1.2_f64.to_degrees();
    let wanted = [("A", b * 200.0 / 450.0), ("B", b)];
    near(&values(&outcome, Rule::AxisVelocityStep), &wanted, 2e-3);
    // The same where one half of the circle ends and the other begins.
    let halves = "% touches\nN10 G92 X350 Y0 Z20\nN20 F60 E300 E-300\nN30 G3 X450 I50 J0\nN40 G3 X350 I-50 J0\n";
    near(&values(&checked(SCARA2, halves), Rule::AxisVelocityStep), &wanted, 2e-3);
}

/// A move against the direction of an axis slows where it ends: with the feeds that are advised the deceleration fits.
#[test]
fn decelerations_have_their_own_feeds_in_both_directions() {
    let limit = "max_acceleration_mm_per_s2 = 3000.0";
    let own = GANTRY3.replace(limit, &format!("{limit}\nmax_deceleration_mm_per_s2 = 1500.0"));
    // On the circle both axes slow by F²/r as often as they speed up.
    for sign in ["", "-"] {
        let program = |feed: f64| {
            format!(
                "% x\nN10 G92 X200 Y0\nN20 F{feed:.9} E500 E-500\nN30 G1 X{sign}10\nN40 G3 I0 J20\nN50 G1 X{sign}200\n"
            )
        };
        let outcome = checked(&own, &program(200.0));
        let found =
            outcome.findings.iter().filter(|one| one.line == 5 && one.limit == Some(1500.0));
        let feeds: Vec<_> = found.map(|one| one.largest_feed_mm_per_s.unwrap()).collect();
        assert!(!feeds.is_empty(), "{:?}", outcome.findings);
        for feed in feeds {
            assert!((feed / (1500.0 * 20.0_f64).sqrt() - 1.0).abs() < 1e-3, "{feed}");
        }
    }
}

/// Where no feed helps, the part moved by what the message says does, and by 0.1 mm less does not.
#[test]
fn a_part_moved_as_advised_fits() {
    let program = |moved: f64| {
        let [start, end] = [300.0, 450.0].map(|x| x + moved);
        format!(
            "% stretched\nN10 G92 X{start:.6} Y0 Z20\nN20 F100 E1000 E-1000\nN30 G1 X{end:.6}\n"
        )
    };
    let outcome = checked(SCARA2, &program(0.0));
    let hints = outcome.findings.iter().map(|finding| finding.hint.as_deref().unwrap());
    let moves = hints.map(|hint| {
        let (_, way) = hint.split_once("move the part by X").unwrap();
        way.strip_suffix(" mm").unwrap().parse::<f64>().unwrap()
    });
    // That of the axis that needs more.
    let moved = moves.fold(0.0, f64::min);
    assert!(moved < -1.0, "{moved}");
    assert_eq!(checked(SCARA2, &program(moved)).findings, []);
    assert!(!checked(SCARA2, &program(moved + 0.1)).findings.is_empty());
}

/// The other elbow is advised where it helps.
#[test]
fn the_other_elbow_fits_where_it_is_advised() {
    let [low, high] = ["low", "high"].map(|elbow| format!("elbow = \"{elbow}\""));
    let other = SCARA2.replacen(&low, &high, 1);
    let program = "% elbow\nN10 G92 X300 Y0 Z20\nN20 G1 X330 Y40 F50 E8000 E-500\n";
    let outcome = checked(SCARA2, program);
    assert!(outcome.findings.iter().any(|finding| {
        finding.hint.as_ref().is_some_and(|hint| hint.contains(&high)) && finding.axis.is_some()
    }));
    assert_eq!(checked(&other, program).findings, []);
}

/// The heading of a tool that turns with the path passes half a turn on the way round: the search for the nearest point ends.
#[test]
fn the_nearest_point_is_found_past_half_a_turn() {
    let tangential = SCARA3.replace("direction = \"fixed\" ", "direction = \"tangential\" ");
    assert_ne!(tangential, SCARA3);
    let program = "% round\nN10 G92 X300 Y0 Z20\nN20 F60 E300 E-300\nN30 G3 X300 Y0 I20 J0\n";
    let nearest = checked(&tangential, program).edge.unwrap();
    assert_eq!(nearest.place.line, 4);
    assert!(nearest.distance > 0.0, "{nearest:?}");
}

/// An emergency stop brakes the path at once, which is a step without an edge of the reach.
#[test]
fn an_emergency_stop_steps_at_once() {
    let changes = ["0.5:emergency-stop=on", "1:emergency-stop=off"];
    let changes = changes.map(|change| change.parse().unwrap()).into();
    let settings = ReadSettings { changes, ..ReadSettings::default() };
    let program = "% stop\nN10 G92 X0 Y0\nN20 G1 X100 F100 E1000 E-1000\n";
    let outcome = super::input_tests::checked(program, settings);
    let finding = step(&outcome);
    near(&values(&outcome, Rule::AxisVelocityStep), &[("X", 100.0)], 1e-6);
    assert!(finding.message.ends_with("the velocity of the path steps here"), "{finding:?}");
    // X may step by 3 mm/s.
    assert!((finding.largest_feed_mm_per_s.unwrap() - 3.0).abs() < 1e-6, "{finding:?}");
}

/// The reach is 50 mm to 450 mm: a line that passes the first axis at 80 mm, one that ends at √(440² + 50²) mm, and a circle
/// that touches the edge.
#[test]
fn the_distance_from_the_edge_is_the_least_of_all_points() {
    let line = |x: f64, y: f64| {
        format!("% line\nN10 G92 X{x} Y-{y} Z20\nN20 F60 E300 E-300\nN30 G1 X{x} Y{y}\nN40 G1 Y0\n")
    };
    let circle = "% circle\nN10 G92 X350 Y0 Z20\nN20 F60 E300 E-300\nN30 G3 X350 Y0 I50 J0\n";
    let end = 450.0 - 440_f64.hypot(50.0);
    for (program, distance) in [(line(80.0, 90.0), 30.0), (line(440.0, 50.0), end)] {
        let nearest = checked(SCARA2, &program).edge.unwrap();
        assert!((nearest.distance - distance * 1e-3).abs() < 1e-5, "{nearest:?} {distance}");
        assert_eq!(nearest.place.line, 4);
    }
    assert!(checked(SCARA2, circle).edge.unwrap().distance < 1e-5);
    assert_eq!(checked(GANTRY3, &line(80.0, 90.0)).edge, None);
}
