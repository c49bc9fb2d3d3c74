//! Tests of program checks against closed forms.

#![expect(clippy::float_cmp, reason = "rounded before, or given")]

use super::findings::MAX_FINDINGS;
use super::{CheckFailure, CheckOptions, Outcome, check};
use crate::finding::{Finding, Rule, Severity, unfit};
use crate::limit::Limits;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use std::fmt::Write;
use std::path::Path;
use twin_machine::Machine;
use twin_number::seconds;

/// Start at 0, 0, 20; X: 400 mm/s, 3000 mm/s², to 650 mm; Z: 200 mm/s.
const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");
/// Start at 300, 0, 20; arms of 250 and 200 mm; A: 240 deg/s, B: 300 deg/s.
const SCARA2: &str = include_str!("../../tests/data/machines/scara2.toml");

fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from} is not in the file");
    text.replacen(from, to, 1)
}

fn examine(machine: &str, program: &str, physics: bool) -> Result<Outcome, CheckFailure> {
    let options = CheckOptions { limits: Limits::Programmed, ..CheckOptions::default() };
    let machine = Machine::parse(Path::new("machine.toml"), machine)
        .unwrap_or_else(|problems| panic!("{problems:#?}"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    std::fs::write(&path, program).unwrap();
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    check(&machine, &program, CheckOptions { physics, ..options }, &mut |_| {})
}

pub(super) fn checked(machine: &str, program: &str) -> Outcome {
    examine(machine, program, false).unwrap()
}

fn fit(machine: &str, program: &str) -> Outcome {
    let outcome = checked(machine, program);
    assert!(outcome.findings.is_empty(), "{program}\n{:#?}", outcome.findings);
    outcome
}

#[track_caller]
fn only(outcome: &Outcome) -> &Finding {
    let [finding] = &outcome.findings[..] else { panic!("{:#?}", outcome.findings) };
    finding
}

/// The findings of `rule` in `line`, of any axis.
fn of(outcome: &Outcome, rule: Rule, line: u32) -> Vec<&Finding> {
    let fits = |finding: &&Finding| finding.rule == rule && finding.line == line;
    outcome.findings.iter().filter(fits).collect()
}

#[track_caller]
fn near(found: f64, wanted: f64, part: f64) {
    assert!((found - wanted).abs() <= part * wanted.abs(), "{found} is not {wanted}");
}

#[test]
fn a_circle_asks_for_its_feed_and_feed_squared_by_radius_of_each_axis() {
    // Entered and left on its tangent at full feed: v = F = 100 mm/s, a = F²/r = 200 mm/s², on both axes in turn. The
    // ramps, 100 mm/s² along X, are milder. Set-points are 0.1 mm, 2 mrad, apart: the peaks are missed by 10⁻⁶.
    let outcome = fit(
        GANTRY3,
        "% circle\nN10 G92 X0 Y0 Z20\nN20 G1 X100 F100 E100 E-100\nN30 G3 X100 Y0 I0 J50\nN40 G1 X200\n",
    );
    let [x, y, z] = &outcome.peaks[..] else { panic!("three axes") };
    near(x.velocity.value, 0.1, 1e-6);
    near(y.velocity.value, 0.1, 1e-6);
    near(x.acceleration.value, 0.2, 1e-6);
    near(y.acceleration.value, 0.2, 1e-6);
    for peak in [&y.velocity, &x.acceleration, &y.acceleration] {
        assert_eq!((peak.place.line, peak.place.block), (4, Some(30)));
    }
    // From the bottom at Y = 0 to the top at Y = 100, and from X = 0 to the end at 200, where the tool is at Z = 20 and
    // the quill, 40 mm above it, stands still.
    let range = |range: Option<[f64; 2]>| range.unwrap().map(|value| (value * 1e6).round());
    assert_eq!(range(x.position), [0.0, 200_000.0]);
    assert_eq!(range(y.position), [0.0, 100_000.0]);
    assert_eq!(range(z.position), [60_000.0, 60_000.0]);
    assert_eq!((z.velocity.value, z.acceleration.value, z.jerk.value), (0.0, 0.0, 0.0));
    // 100 mm up and down at 100 mm/s² take 1 s for 50 mm each.
    let circle = 2.0 * std::f64::consts::PI * 50.0;
    near(outcome.length, (200.0 + circle) * 1e-3, 1e-12);
    let duration = 2.0 * (1.0 + 0.5) + circle / 100.0;
    // The last set-point is the first at or after the end.
    let cycles = twin_number::seconds(outcome.duration_ns) * 1e3;
    assert_eq!(cycles.round(), (duration * 1e3).ceil());
    assert_eq!(outcome.elements, 3);
    assert_eq!(outcome.start.unwrap().to_vec(), [0.0, 0.0, 0.06]);
    assert!(outcome.peaks.iter().all(|peak| peak.following_error.is_none()));
}

/// Axis velocities (rad/s) of a SCARA with arms of 250 and 200 mm, elbow low, with the tool at `x`, `y` (mm) moving with
/// `vx`, `vy` (mm/s): by the inverse of the Jacobian of x = 250 cos A + 200 cos(A+B), y = 250 sin A + 200 sin(A+B).
fn scara_velocities([x, y]: [f64; 2], [vx, vy]: [f64; 2]) -> [f64; 2] {
    let (l1, l2) = (250.0_f64, 200.0_f64);
    let b = ((x * x + y * y - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)).acos();
    let a = y.atan2(x) - (l2 * b.sin()).atan2(l1 + l2 * b.cos());
    let ab = a + b;
    let [[xa, xb], [ya, yb]] = [
        [-l1 * a.sin() - l2 * ab.sin(), -l2 * ab.sin()],
        [l1 * a.cos() + l2 * ab.cos(), l2 * ab.cos()],
    ];
    let determinant = xa * yb - xb * ya;
    [(vx * yb - vy * xb) / determinant, (vy * xa - vx * ya) / determinant]
}

#[test]
fn a_line_asks_of_a_scara_what_its_jacobian_says() {
    // The middle third of a straight line, passed at full feed: dense samples of the closed form against the finding.
    let slow = edited(SCARA2, "max_velocity_deg_per_s = 240.0", "max_velocity_deg_per_s = 1.0");
    let slow = edited(&slow, "max_velocity_deg_per_s = 300.0", "max_velocity_deg_per_s = 1.0");
    let outcome = checked(
        &slow,
        "% line\nN10 G92 X300 Y-150 Z20\nN20 G1 Y-100 F100 E800 E-800\nN30 Y100\nN40 Y150\n",
    );
    let samples: Vec<_> = (0..=20_000)
        .map(|step| scara_velocities([300.0, -100.0 + 0.01 * f64::from(step)], [0.0, 100.0]))
        .collect();
    for (index, axis) in ["A", "B"].into_iter().enumerate() {
        let found = of(&outcome, Rule::AxisVelocity, 4);
        let finding = found.iter().find(|found| found.axis.as_deref() == Some(axis)).unwrap();
        let largest =
            samples.iter().map(|sample| sample[index].abs().to_degrees()).fold(0.0, f64::max);
        near(finding.value.unwrap(), largest, 1e-3);
        assert_eq!((finding.limit, finding.unit), (Some(1.0), Some("deg/s")));
        near(finding.largest_feed_mm_per_s.unwrap(), 100.0 / largest, 5e-3);
    }
}

#[test]
fn a_software_limit_is_the_last_place_allowed() {
    let to = |x: &str| format!("% end\nN10 G1 X{x} F300 E2000 E-2000\n");
    fit(GANTRY3, &to("650"));
    fit(GANTRY3, &to("-50"));
    for (x, limit, side) in [("650.001", 650.0, "above"), ("-50.001", -50.0, "below")] {
        let outcome = checked(GANTRY3, &to(x));
        let finding = only(&outcome);
        assert_eq!((finding.rule, finding.severity), (Rule::AxisPosition, Severity::Error));
        assert_eq!((finding.line, finding.block), (2, Some(10)));
        assert_eq!((finding.axis.as_deref(), finding.unit), (Some("X"), Some("mm")));
        near(finding.value.unwrap(), x.parse().unwrap(), 1e-12);
        near(finding.limit.unwrap(), limit, 1e-12);
        assert!(finding.message.contains(side), "{}", finding.message);
        assert_eq!(finding.largest_feed_mm_per_s, None);
    }
    // Arm A of the SCARA at the end of a line, worked out as in the manual (8.2.4).
    let (x, y, l1, l2) = (300.0_f64, 100.0_f64, 250.0_f64, 200.0_f64);
    let b = ((x * x + y * y - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)).acos();
    let a = (y.atan2(x) - (l2 * b.sin()).atan2(l1 + l2 * b.cos())).to_degrees();
    let program = "% end\nN10 G1 Y100 F100 E500 E-500\n";
    let limited = |limit: f64| {
        edited(SCARA2, "position_max_deg = 150.0", &format!("position_max_deg = {limit:.9}"))
    };
    fit(&limited(a + 1e-6), program);
    let outcome = checked(&limited(a - 1e-6), program);
    assert_eq!(
        (only(&outcome).rule, only(&outcome).axis.as_deref()),
        (Rule::AxisPosition, Some("A"))
    );
}

#[test]
fn a_jump_beyond_the_velocity_of_its_axis_is_bridged() {
    let program = |jump: &str, rest: &str| {
        format!("% jump\nN10 G92 X0 Y0 Z20\nN20 G1 X10 F50 E500 E-500\nN30 G92 {jump}\n{rest}")
    };
    // 100 mm in a cycle of 1 ms are 100 m/s, in the block that jumps, whether or not one follows. The axis goes there on its
    // own (manual 2.2.5): 100 mm at 400 mm/s with 3000 mm/s² take 0.25 s and 0.4/3 s.
    for rest in ["N40 G1 X120\n", ""] {
        let outcome = checked(GANTRY3, &program("X110", rest));
        let finding = only(&outcome);
        assert_eq!((finding.rule, finding.severity), (Rule::Gap, Severity::Note));
        assert_eq!((finding.line, finding.block), (4, Some(30)));
        assert!(finding.message.contains("X by +100.000 mm, in 0.383 s"), "{finding:?}");
        near(outcome.peaks[0].velocity.value, 0.4, 1e-9);
        assert_eq!(outcome.peaks[0].velocity.place.line, 4);
    }
    // A twentieth of a millimetre is 50 mm/s: nothing beyond the axis.
    fit(GANTRY3, &program("X10.05", "N40 G1 X20\n"));
}

/// The feed of `F` words is `feed`; the findings of `rule` must be gone with the feed they recommend, and back with 2 %
/// more.
fn largest_feed_is_the_largest(machine: &str, program: &str, feed: f64, rule: Rule) -> Vec<f64> {
    let with = |feed: f64| program.replace("F#", &format!("F{feed:.9}"));
    let outcome = checked(machine, &with(feed));
    let found: Vec<_> = outcome.findings.iter().filter(|finding| finding.rule == rule).collect();
    assert!(!found.is_empty(), "{:#?}", outcome.findings);
    let mut feeds = Vec::new();
    for finding in found {
        let largest = finding.largest_feed_mm_per_s.unwrap();
        let again = |feed: f64| {
            let outcome = checked(machine, &with(feed));
            of(&outcome, rule, finding.line).iter().any(|other| other.axis == finding.axis)
        };
        assert!(!again(largest), "with F{largest}: {finding:?}");
        assert!(again(1.02 * largest), "with F{}: {finding:?}", 1.02 * largest);
        feeds.push(largest);
    }
    feeds
}

#[test]
fn the_largest_feed_recommended_for_a_velocity_is_the_largest() {
    // Straight along X: the axis limit itself.
    let along = "% x\nN10 G1 X300 F# E2000 E-2000\n";
    let feeds = largest_feed_is_the_largest(GANTRY3, along, 600.0, Rule::AxisVelocity);
    near(feeds[0], 400.0, 1e-9);
    // 3-4-5 in Y and Z: Z does 3/5 of the feed, 200 mm/s at 333.3.
    let slanted = "% yz\nN10 G1 Y80 Z80 F# E1500 E-1500\n";
    let feeds = largest_feed_is_the_largest(GANTRY3, slanted, 350.0, Rule::AxisVelocity);
    near(feeds[0], 200.0 * 5.0 / 3.0, 1e-9);
    // Around a corner of the SCARA's reach, where the velocities change all the time.
    let slow = edited(SCARA2, "max_velocity_deg_per_s = 240.0", "max_velocity_deg_per_s = 10.0");
    let slow = edited(&slow, "max_velocity_deg_per_s = 300.0", "max_velocity_deg_per_s = 10.0");
    let line = "% line\nN10 G1 X200 Y250 F# E400 E-400\n";
    assert_eq!(largest_feed_is_the_largest(&slow, line, 100.0, Rule::AxisVelocity).len(), 2);
    // B is fastest near the stretched arms at the end, where the tool brakes: less feed helps only once it is below
    // what the tool has there anyway.
    let stretching = "% stretch\nN10 G1 X449 F# E100 E-100\n";
    largest_feed_is_the_largest(&slow, stretching, 100.0, Rule::AxisVelocity);
}

/// 96 kHz at 320 increments per mm are 300 mm/s: what the drive cannot step is reported as such, what the axis cannot is not.
#[test]
fn a_velocity_that_drives_or_motors_do_not_allow_names_them() {
    let line = "% x\nN10 G1 X200 F350 E3000 E-3000\n";
    let message = |text: &str| {
        let outcome = checked(text, line);
        let found = of(&outcome, Rule::AxisVelocity, 2);
        assert_eq!((found.len(), found[0].limit), (1, Some(300.0)));
        found[0].message.clone()
    };
    let per = "increments = 3200                  # 200 × 16 microsteps per turn of a 10 mm screw";
    let slow = edited(GANTRY3, per, "increments = 3200\nmax_step_frequency_khz = 96");
    assert!(message(&slow).ends_with("limit of 300 mm/s (step frequency)"), "{}", message(&slow));
    let motor =
        edited(GANTRY3, per, "increments = 3200\nmax_motor_rpm = 1800\nmotor_turns_per_mm = 0.1");
    assert!(message(&motor).ends_with("(motor speed)"));
    let axis = edited(GANTRY3, "max_velocity_mm_per_s = 400.0", "max_velocity_mm_per_s = 300.0");
    assert!(message(&axis).ends_with("limit of 300 mm/s"));
}

#[test]
fn the_largest_feed_recommended_for_an_acceleration_is_the_largest() {
    // a = F²/r with r = 20 mm and 3000 mm/s²: F = 244.95 mm/s.
    let circle = "% circle\nN10 G1 X100 F# E1000 E-1000\nN20 G3 I0 J20\nN30 G1 X200\n";
    let feeds = largest_feed_is_the_largest(GANTRY3, circle, 300.0, Rule::AxisAcceleration);
    assert_eq!(feeds.len(), 2);
    for feed in feeds {
        near(feed, (3000.0 * 20.0_f64).sqrt(), 1e-3);
    }
    // From rest to rest on the circle: the ramps add to it, and are part of what is recommended.
    let alone = "% circle\nN10 G92 X100 Y0 Z20\nN20 G3 I0 J20 F# E2500 E-2500\n";
    largest_feed_is_the_largest(GANTRY3, alone, 300.0, Rule::AxisAcceleration);
}

#[test]
fn no_feed_is_recommended_against_an_acceleration_that_is_programmed() {
    let outcome = checked(GANTRY3, "% ramp\nN10 G1 X100 F100 E3500 E-1000\n");
    let finding = only(&outcome);
    assert_eq!((finding.rule, finding.axis.as_deref()), (Rule::AxisAcceleration, Some("X")));
    near(finding.value.unwrap(), 3500.0, 1e-9);
    assert_eq!(finding.largest_feed_mm_per_s, None);
    let outcome = checked(GANTRY3, "% ramp\nN10 G1 X100 F100 E1000 E-3500\n");
    assert_eq!(only(&outcome).largest_feed_mm_per_s, None);
}

#[test]
fn one_line_is_found_wrong_once_per_axis_and_rule() {
    // 0.7 s of set-points, most of them too fast in X and Y.
    let outcome = checked(GANTRY3, "% fast\nN10 G1 X400 Y300 F900 E3000 E-3000\n");
    let axes: Vec<_> = outcome.findings.iter().map(|finding| finding.axis.as_deref()).collect();
    assert_eq!(axes, [Some("X"), Some("Y")], "{:#?}", outcome.findings);
    // With the largest value: 4/5 and 3/5 of the feed.
    near(outcome.findings[0].value.unwrap(), 720.0, 1e-3);
    near(outcome.findings[1].value.unwrap(), 540.0, 1e-3);
}

#[test]
fn findings_are_bounded_and_the_rest_is_counted_once_each() {
    // Every line ends 1 or 1.5 mm beyond the software limit; each is a hundred set-points.
    let mut program = "% far\nN10 G1 X651 F300 E2900 E-2900\n".to_owned();
    for line in 0..1100 {
        writeln!(program, "N11 G1 X{}", 651.0 + 0.5 * f64::from((line + 1) % 2)).unwrap();
    }
    let outcome = checked(GANTRY3, &program);
    assert_eq!(outcome.findings.len(), MAX_FINDINGS);
    assert_eq!(outcome.findings_left_out, 101);
    assert!(outcome.findings.iter().all(|finding| finding.rule == Rule::AxisPosition));
    near(outcome.peaks[0].position.unwrap()[1], 0.6515, 1e-9);

    let program = format!("% words\n{}", "N10 C5\n".repeat(1200));
    let outcome = checked(GANTRY3, &program);
    assert_eq!((outcome.findings.len(), outcome.findings_left_out), (MAX_FINDINGS, 200));
}

#[test]
fn warnings_never_crowd_out_errors() {
    let jerky = edited(GANTRY3, "position_min_mm", "max_jerk_mm_per_s3 = 1\nposition_min_mm");
    let mut program = "% warned\nN10 G1 X1 F100 E2000 E-2000\n".to_owned();
    for line in 0..1100 {
        writeln!(program, "N11 G1 X{}", 0.2 * f64::from(line % 2)).unwrap();
    }
    program += "N20 G1 X651 F300\n";
    let outcome = checked(&jerky, &program);
    assert!(unfit(&outcome.findings));
    let first = &outcome.findings[0];
    assert_eq!((first.rule, first.block), (Rule::AxisPosition, Some(20)));
    assert_eq!(outcome.findings.len(), MAX_FINDINGS + 1);
    // Each line turns back, with its jerk where it goes from acceleration to deceleration; only the last short one
    // passes into N20 without either. 1101 lines then.
    let of_line = |finding: &Finding| finding.line;
    let jerks: Vec<_> = outcome.findings.iter().skip(1).map(of_line).collect();
    assert_eq!(jerks, (2..=1001).collect::<Vec<_>>());
    assert_eq!(outcome.findings_left_out, 101);
}

#[test]
fn the_worst_comes_first_then_the_order_of_the_program() {
    let jerky = edited(GANTRY3, "position_min_mm", "max_jerk_mm_per_s3 = 1\nposition_min_mm");
    let program = "% worst\nN10 G1 X100 F500 E2000 E-2000\nN20 G1 Z200 F100\nN30 T1\n";
    let outcome = checked(&jerky, program);
    let order: Vec<_> = outcome
        .findings
        .iter()
        .map(|finding| (finding.severity, finding.line, finding.rule))
        .collect();
    assert_eq!(
        order,
        [
            (Severity::Error, 2, Rule::AxisVelocity),
            (Severity::Error, 3, Rule::AxisPosition),
            (Severity::Error, 4, Rule::UnsupportedWord),
            (Severity::Warning, 2, Rule::AxisJerk),
        ]
    );
}

#[test]
fn jerk_is_a_warning_and_only_where_the_file_has_a_limit() {
    let program = "% jerk\nN10 G1 X100 F100 E500 E-500\n";
    let outcome = fit(GANTRY3, program);
    // At the end of the ramp 500 mm/s² become 0 within a cycle: 500000 mm/s³.
    near(outcome.peaks[0].jerk.value, 500.0, 1e-6);
    let limited = |limit: &str| {
        let key = format!("max_jerk_mm_per_s3 = {limit}\nposition_min_mm");
        edited(GANTRY3, "position_min_mm", &key)
    };
    fit(&limited("501000"), program);
    let outcome = checked(&limited("499000"), program);
    let finding = only(&outcome);
    assert_eq!((finding.rule, finding.severity), (Rule::AxisJerk, Severity::Warning));
    assert_eq!((finding.unit, finding.limit), (Some("mm/s^3"), Some(499_000.0)));
    near(finding.value.unwrap(), 500_000.0, 1e-6);
    assert!(!unfit(&outcome.findings));
}

#[test]
fn beyond_reach_is_found_with_distance_and_reach() {
    // √(440² + 110²) = 453.542 mm; the arms reach 450 mm. The rest of the program is checked all the same.
    let program = "% far\nN10 G1 X440 Y110 F100 E500 E-500\nN20 G1 X300 Y0 Z-200\n";
    let outcome = checked(SCARA2, program);
    let reach = of(&outcome, Rule::Reach, 2);
    assert_eq!(reach.len(), 1, "{:#?}", outcome.findings);
    near(reach[0].value.unwrap(), 440.0_f64.hypot(110.0), 1e-6);
    near(reach[0].limit.unwrap(), 450.0, 1e-12);
    assert_eq!(reach[0].unit, Some("mm"));
    assert_eq!(of(&outcome, Rule::AxisPosition, 3).len(), 1, "{:#?}", outcome.findings);
    // Too near: the inner bound is 50 mm.
    let outcome = checked(SCARA2, "% near\nN10 G1 X40 F100 E500 E-500\n");
    let reach = of(&outcome, Rule::Reach, 2);
    near(reach[0].value.unwrap(), 40.0, 1e-9);
    near(reach[0].limit.unwrap(), 50.0, 1e-12);
}

#[test]
fn physics_tells_following_errors_and_holds_them_against_the_limit() {
    let program = "% rehearsal\nN10 G1 X20 F200 E2000 E-2000\n";
    let outcome = examine(GANTRY3, program, true).unwrap();
    assert!(outcome.findings.is_empty(), "{:#?}", outcome.findings);
    let errors: Vec<_> =
        outcome.peaks.iter().map(|peak| peak.following_error.unwrap().value).collect();
    // It moves with inertia and friction: not exactly there, but within its limit of 0.5 mm.
    assert!(errors[0] > 1e-9 && errors[0] < 0.5e-3, "{errors:?}");
    assert!(errors[1] < errors[0] && errors[2] < errors[0], "{errors:?}");
    assert_eq!(outcome.peaks[0].following_error.unwrap().place.line, 2);

    let peak = errors[0] * 1e3;
    let limited = |limit: f64| {
        let key = format!("max_following_error_mm = {limit:.12}");
        edited(GANTRY3, "max_following_error_mm = 0.5", &key)
    };
    let with = |limit| examine(&limited(limit), program, true).unwrap();
    assert!(with(1.001 * peak).findings.is_empty());
    let outcome = with(0.999 * peak);
    let finding = only(&outcome);
    assert_eq!((finding.rule, finding.severity), (Rule::FollowingError, Severity::Error));
    assert_eq!((finding.axis.as_deref(), finding.unit, finding.line), (Some("X"), Some("mm"), 2));
    near(finding.value.unwrap(), peak, 1e-9);
    assert!(fit(&limited(0.999 * peak), program).peaks[0].following_error.is_none());

    // 100 N do not move 30 kg at 2000 mm/s², and hardly overcome 20 N of friction.
    let weak = edited(GANTRY3, "max_force_n = 600.0", "max_force_n = 22.0");
    let outcome = examine(&weak, program, true).unwrap();
    assert_eq!(only(&outcome).rule, Rule::FollowingError);
    assert!(only(&outcome).value.unwrap() > 5.0);
}

#[test]
fn what_cannot_be_read_is_no_finding() {
    let folder = tempfile::tempdir().unwrap();
    let machine = Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap();
    for path in [folder.path(), &folder.path().join("missing.cnc")] {
        let program =
            ProgramFile::new(path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
        let failure = check(
            &machine,
            &program,
            CheckOptions { limits: Limits::Programmed, ..CheckOptions::default() },
            &mut |_| {},
        );
        assert!(matches!(failure, Err(CheckFailure::Read(_))), "{failure:?}");
    }
}

#[test]
fn progress_is_reported_to_the_end_of_the_file() {
    let program = "% long\nN10 G1 X100 F100 E500 E-500\nN20 G1 X0\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.cnc");
    std::fs::write(&path, program).unwrap();
    let machine = Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap();
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    let mut reported = Vec::new();
    check(
        &machine,
        &program,
        CheckOptions { limits: Limits::Programmed, ..CheckOptions::default() },
        &mut |at| reported.push(at.bytes),
    )
    .unwrap();
    assert!(reported.is_sorted() && reported.len() >= 2, "{reported:?}");
    assert_eq!(reported.last(), Some(&Some(program.size().unwrap())));
}

/// An axis is looked for on the turn that its software limits are on: 280° here, not −80°.
#[test]
fn rotary_axes_begin_within_their_limits() {
    let machine = SCARA2
        .replace("position_min_deg = -150.0", "position_min_deg = 30.0")
        .replace("position_max_deg = 150.0", "position_max_deg = 330.0")
        .replace("offsets_deg = [0.0, 0.0]", "offsets_deg = [180.0, 0.0]");
    assert!(machine.contains("offsets_deg = [180.0, 0.0]"));
    let limited = machine.matches("position_min_deg = 30.0").count();
    // Elbow and shoulder of an arm of 250 and 200 mm that is bent by 90° and points to 100° with its upper arm.
    let (upper, lower) = (100f64.to_radians(), 190f64.to_radians());
    let (x, y) =
        (250.0 * upper.cos() + 200.0 * lower.cos(), 250.0 * upper.sin() + 200.0 * lower.sin());
    let program = format!("% bent\nN10 G92 X{x:.6} Y{y:.6} Z20\nN20 G1 Z21 F10\n");
    let outcome = fit(&machine, &program);
    let start = outcome.start.unwrap();
    assert_eq!(limited, 2);
    assert!((start[0].to_degrees() - 280.0).abs() < 1e-4, "{start:?}");
    assert!((start[1].to_degrees() - 90.0).abs() < 1e-4, "{start:?}");
}

#[test]
fn a_program_that_moves_nothing_is_unfit_whatever_else_is_found() {
    let outcome = checked(GANTRY3, "% nothing\nN10 G92 X1 R5\nN20 G1 R5\n");
    assert!(unfit(&outcome.findings), "{:#?}", outcome.findings);
    assert_eq!(of(&outcome, Rule::Syntax, 1).len(), 1);
}

#[test]
fn accelerations_that_nobody_would_wait_for_are_errors() {
    // 100 mm from rest to rest with 1e-9 mm/s²: the closed form is 2·√(100/1e-9) s.
    let outcome = checked(GANTRY3, "% slow\nN10 G1 X100 F100 E0.000000001 E-0.000000001\n");
    let finding = only(&outcome);
    near(finding.value.unwrap(), 2.0 * (100.0 / 1e-9_f64).sqrt(), 1e-12);
}

/// Consequences of a point out of reach have no findings of their own.
#[test]
fn an_unreachable_point_is_one_finding() {
    // 450 mm is as far as the arms reach; towards it they stretch, ever faster.
    let outcome = checked(SCARA2, "% far\nN10 G1 X600 F60\n");
    assert_eq!(only(&outcome).rule, Rule::Reach);
    // From there on the axes are not known: 150 mm at 60 mm/s, and 0.3 s more as the last 18 mm are braked with 100 mm/s².
    near(seconds(outcome.untaken_ns), 150.0 / 60.0 + 0.3, 1e-3);
    assert_eq!(fit(SCARA2, "% near\nN10 G1 X310 F60\n").untaken_ns, 0);
}

/// Where only the pieces of a plan are looked at, set-points are left out. On the simulated machine all of them are taken: times,
/// ends, largest values and findings of the plan are the same.
#[test]
fn what_needs_no_setpoints_is_the_same_with_them() {
    let programs = [
        "% lines\nN10 G92 X300 Y0 Z20\nN20 G1 X340 Y60 F150 E900 E-700\nN30 G1 Y80 F80\nN40 G2 X300 Y40 I-20 J-20\n",
        "% waits\nN10 G92 X300 Y0 Z20\nN20 G1 X320 F100 E500 E-500\nN30 M7\nN40 G1 Y33.3\nN50 G0 Z60\n",
        "% gap\nN10 G92 X300 Y100 Z20\nN20 G1 X310 F100 E500 E-500\nN30 G92 X280 Y100 Z20\nN40 G1 X300\n",
        "% corner\nN10 G92 X300 Y0 Z20\nN20 G1 X320 F300 E3000 E-3000\nN30 G1 X340 Y0.6\nN40 G1 X360\n",
        "% beyond\nN10 G92 X300 Y0 Z20\nN20 G1 X700 F300 E3000 E-3000\nN30 G1 X300\n",
    ];
    let of_plan = [
        Rule::Reach,
        Rule::AxisPosition,
        Rule::AxisVelocity,
        Rule::AxisAcceleration,
        Rule::AxisVelocityStep,
        Rule::Gap,
    ];
    for machine in [GANTRY3, SCARA2] {
        for program in programs {
            let [without, with] =
                [false, true].map(|physics| examine(machine, program, physics).unwrap());
            let times = |of: &Outcome| (of.duration_ns, of.untaken_ns, of.elements);
            assert_eq!(times(&without), times(&with), "{program}");
            let near = |one: f64, other: f64| (one - other).abs() <= 1e-9 * (1.0 + other.abs());
            let ends = [without.end.unwrap(), with.end.unwrap()];
            let mut pairs = ends[0].iter().zip(ends[1].iter());
            assert!(pairs.all(|(one, other)| near(*one, *other)), "{program}");
            for (one, other) in without.peaks.iter().zip(&with.peaks) {
                let (positions, others) = (one.position.unwrap(), other.position.unwrap());
                assert!(
                    near(positions[0], others[0]) && near(positions[1], others[1]),
                    "{program}"
                );
                assert!(near(one.velocity.value, other.velocity.value), "{program}");
                assert!(near(one.acceleration.value, other.acceleration.value), "{program}");
            }
            let found = |of: &Outcome| -> Vec<_> {
                let findings = of.findings.iter().filter(|one| of_plan.contains(&one.rule));
                findings.map(|one| (one.line, one.rule, one.axis.clone())).collect()
            };
            assert_eq!(found(&without), found(&with), "{program}");
        }
    }
}
