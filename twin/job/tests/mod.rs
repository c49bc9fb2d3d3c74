//! Tests of jobs against closed forms.

#![expect(clippy::float_cmp, reason = "numbers of the file, and what must not move at all")]

use super::JobSetpoints;
use crate::finding::{Finding, Rule};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use crate::setpoint::AxisSetpoint;
use crate::setpoint_source::PlanItem;
use std::path::Path;
use twin_machine::Machine;

/// The axes X, Y and Z of the shipped gantry, in mm.
pub(super) fn machine() -> Machine {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/gantry3.toml");
    Machine::load(&path).unwrap()
}

pub(super) struct Job {
    pub(super) folder: tempfile::TempDir,
    pub(super) program: ProgramFile,
}

pub(super) fn job(text: &str) -> Job {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("job.toml");
    std::fs::write(&path, text).unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Job), ReadSettings::default()).unwrap();
    Job { folder, program }
}

/// Set-points of a job, and its findings.
pub(super) fn run(job: &Job, machine: &Machine) -> (Vec<AxisSetpoint>, Vec<Finding>) {
    assert!(job.folder.path().is_dir());
    let mut found = (Vec::new(), Vec::new());
    for item in JobSetpoints::open(machine, &job.program).unwrap() {
        match item {
            PlanItem::Axes(setpoint) => found.0.push(*setpoint),
            PlanItem::Diagnostic(finding) => found.1.push(finding),
            PlanItem::Tool(_) | PlanItem::Bridging(_) | PlanItem::Io(_) => panic!("a job has none"),
        }
    }
    found
}

pub(super) fn moves(text: &str) -> Vec<AxisSetpoint> {
    let (setpoints, findings) = run(&job(text), &machine());
    assert_eq!(findings, []);
    setpoints
}

/// s.
pub(super) fn time(setpoint: &AxisSetpoint) -> f64 {
    twin_number::seconds(setpoint.time_ns)
}

pub(super) fn near(actual: f64, expected: f64, tolerance: f64) {
    assert!((actual - expected).abs() <= tolerance, "{actual} is not {expected}");
}

pub(super) const START: &str =
    "[[start]]\naxis = \"X\"\nposition_mm = 100\n[[start]]\naxis = \"Y\"\nposition_mm = 50\n";

/// 100 mm at 200 mm/s with 1000 mm/s²: up and down in 0.2 s and 20 mm each, 60 mm between in 0.3 s; then as far again, 0.5 s
/// later, back.
#[test]
fn blocks_begin_behind_each_other() {
    let setpoints = moves(&format!(
        "{START}[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"X\"\ndistance_mm = 100\nvelocity_mm_per_s = 200\n\
         acceleration_mm_per_s2 = 1000\n[[blocks]]\nblock = \"MC_MoveAbsolute\"\naxis = \"X\"\nposition_mm = 100\n\
         velocity_mm_per_s = 200\nacceleration_mm_per_s2 = 1000\nafter_s = 0.5\n"
    ));
    let at =
        |seconds: f64| setpoints.iter().find(|one| (time(one) - seconds).abs() < 1e-9).unwrap();
    near(at(0.0).axes.position[0], 0.1, 0.0);
    near(at(0.1).axes.position[0], 0.105, 1e-12);
    near(at(0.35).axes.velocity[0], 0.2, 1e-12);
    near(at(0.7).axes.position[0], 0.2, 1e-12);
    near(at(1.2).axes.position[0], 0.2, 1e-12);
    near(at(1.3).axes.position[0], 0.195, 1e-12);
    // The second begins with the cycle behind the pause, and ends after 0.7 s.
    let last = setpoints.last().unwrap();
    assert!((1_900_000_000..=1_903_000_000).contains(&last.time_ns), "{}", last.time_ns);
    near(last.axes.position[0], 0.1, 1e-12);
    assert_eq!([last.axes.velocity[0], last.axes.acceleration[0]], [0.0; 2]);
    // The lines are those of the blocks.
    assert_eq!([at(0.3).place.line, at(1.6).place.line], [8, 14]);
    // The tool of a gantry is where its axes are.
    for setpoint in &setpoints {
        let [x, y] = [setpoint.axes.position[0], setpoint.axes.position[1]];
        near(setpoint.tool.velocity.x, setpoint.axes.velocity[0], 1e-12);
        near(y, 0.05, 1e-12);
        let first = &setpoints[0];
        near(setpoint.tool.pose.position.x - first.tool.pose.position.x, x - 0.1, 1e-12);
    }
}

const SHAFT: &str = "[[virtual_axes]]\nname = \"shaft\"\nkind = \"rotary\"\nperiod_deg = 360\nmax_acceleration_deg_per_s2 = 36000\n";

/// Y goes 3 mm for every 2 degrees of the shaft; of twenty turns a second each.
#[test]
fn a_slave_in_gear_keeps_its_ratio() {
    let setpoints = moves(&format!(
        "duration_s = 1.5\n{START}{SHAFT}[[blocks]]\nblock = \"MC_GearIn\"\naxis = \"Y\"\nmaster = \"shaft\"\n\
         ratio_numerator = 3\nratio_denominator = 200\n[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"shaft\"\n\
         velocity_deg_per_s = 7200\nacceleration_deg_per_s2 = 36000\n"
    ));
    // Up in 0.2 s and down in as many: 540 mm/s² of Y.
    let middle = setpoints.iter().find(|one| one.time_ns == 1_000_000_000).unwrap();
    near(middle.axes.velocity[1], 7200.0 * 0.015 * 1e-3, 1e-9);
    near(middle.axes.position[1] - 0.05, 7200.0 * 0.9 * 0.015 * 1e-3, 7200.0 * 0.015e-3 * 2e-3);
    let last = setpoints.last().unwrap();
    assert_eq!(last.axes.velocity[1], 0.0);
    near(time(last), 1.7, 3e-3);
    near(last.axes.position[1] - 0.05, 7200.0 * 1.5 * 0.015 * 1e-3, 7200.0 * 0.015e-3 * 2e-3);
    for pair in setpoints.windows(2) {
        let [before, after] = [&pair[0].axes, &pair[1].axes];
        assert!((after.velocity[1] - before.velocity[1]).abs() <= 0.54e-3 + 1e-9);
        assert!(after.position[1] >= before.position[1], "{} s", time(&pair[1]));
    }
}

/// A cam from (0, 0) to (360, 0) by (180, 40) mm at rest: in the closed form of the quintic 40·(10p³ − 15p⁴ + 6p⁵).
#[test]
fn a_slave_on_its_cam_is_where_the_cam_says() {
    let job = job(&format!(
        "duration_s = 2\n{SHAFT}[[start]]\naxis = \"X\"\nposition_mm = 0\n[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"X\"\n\
         master = \"shaft\"\ncam = \"hump.cam.toml\"\n[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"shaft\"\n\
         velocity_deg_per_s = 360\nacceleration_deg_per_s2 = 360000\n"
    ));
    let cam = "master = { min = 0, max = 360 }\nslave = { min = 0, max = 40, period = 360 }\n\
        elements = [{ master = 0, slave = 0 }, { master = 180, slave = 40 }, { master = 360, slave = 0 }]\n";
    std::fs::write(job.folder.path().join("hump.cam.toml"), cam).unwrap();
    let (setpoints, findings) = run(&job, &machine());
    assert_eq!(findings, []);
    let shape = |turn: f64| {
        let p = if turn < 0.5 { 2.0 * turn } else { 2.0 - 2.0 * turn };
        0.04 * p.powi(3) * (10.0 + p * (-15.0 + 6.0 * p))
    };
    let mut most: f64 = 0.0;
    for one in setpoints.iter().filter(|one| (10_000_000..2_000_000_000).contains(&one.time_ns)) {
        // Up to speed within a millisecond, in which the master comes half as far.
        let turn = (time(one) - 0.5e-3 - 1e-3).rem_euclid(1.0);
        near(one.axes.position[0], shape(turn), 2e-4);
        most = most.max(one.axes.velocity[0].abs());
    }
    // Half a turn in half a second: 40 mm · 15/8 / 0.5 s.
    near(most, 0.04 * 1.875 / 0.5, 1e-5);
}

/// Half the override takes twice as long, with half the velocity and a quarter of the acceleration.
#[test]
fn the_override_stretches_time() {
    let text = format!(
        "{START}[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"X\"\ndistance_mm = 100\nvelocity_mm_per_s = 200\n\
         acceleration_mm_per_s2 = 1000\n"
    );
    let machine = machine();
    let job = job(&text);
    let mut setpoints = JobSetpoints::open(&machine, &job.program).unwrap();
    setpoints.set_override(0.5);
    let slow: Vec<_> = setpoints.by_ref().collect();
    let last = slow.last().unwrap();
    let PlanItem::Axes(last) = last else { panic!("{last:?}") };
    near(last.axes.position[0], 0.2, 1e-12);
    // At rest the factor changes at once, within a cycle.
    near(time(last), 1.4, 4e-3);
    let fastest = |by: fn(&AxisSetpoint) -> f64| {
        let axes = slow.iter().filter_map(|item| match item {
            PlanItem::Axes(one) => Some(by(one).abs()),
            _ => None,
        });
        axes.fold(0.0, f64::max)
    };
    near(fastest(|one| one.axes.velocity[0]), 0.1, 1e-9);
    near(fastest(|one| one.axes.acceleration[0]), 0.25, 1e-6);
}

/// A hold in the middle stops all axes together, each within its acceleration, and what was held goes on to the same end.
#[test]
fn a_hold_brakes_within_the_acceleration_of_the_axes() {
    let machine = machine();
    let job = job(&format!(
        "{START}[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"X\"\ndistance_mm = 200\nvelocity_mm_per_s = 200\n\
         [[blocks]]\nblock = \"MC_GearIn\"\naxis = \"Y\"\nmaster = \"X\"\nratio_numerator = 1\nratio_denominator = 2\nat_s = 0\n"
    ));
    let most: Vec<_> = machine.axes.iter().map(|axis| axis.max_acceleration).collect();
    let mut setpoints = JobSetpoints::open(&machine, &job.program).unwrap();
    let mut seen: Vec<AxisSetpoint> = Vec::new();
    let mut held = None;
    while let Some(item) = setpoints.next() {
        let PlanItem::Axes(one) = item else { panic!("{item:?}") };
        match one.time_ns {
            400_000_000 => setpoints.set_override(0.0),
            2_000_000_000 => {
                assert!(setpoints.follows_override());
                held = Some(one.axes.position[0]);
                assert_eq!(one.axes.velocity[0], 0.0);
                setpoints.set_override(1.0);
            }
            _ => {}
        }
        seen.push(*one);
    }
    assert!((0.11..0.2).contains(&held.unwrap()), "{held:?}");
    let last = seen.last().unwrap();
    near(last.axes.position[0], 0.3, 1e-12);
    near(last.axes.position[1], 0.05 + 0.1, 1e-6);
    for pair in seen.windows(2) {
        for (axis, most) in most.iter().enumerate() {
            let [before, after] = [&pair[0].axes, &pair[1].axes];
            assert!(after.acceleration[axis].abs() <= most * 1.000_001, "axis {axis}");
            // What is said of the velocity is what the positions do.
            let mean = f64::midpoint(before.velocity[axis], after.velocity[axis]);
            near((after.position[axis] - before.position[axis]) / 1e-3, mean, most * 1e-3);
        }
        // In gear all the way.
        near(pair[1].axes.velocity[1], pair[1].axes.velocity[0] / 2.0, 1e-9);
    }
}

/// Whenever it is asked for, a hold stays within the acceleration of the axis, which the move itself uses up, and velocities are
/// what positions do.
#[test]
fn a_hold_at_any_time_stays_within_the_acceleration() {
    let machine = machine();
    let most = machine.axes[0].max_acceleration;
    let job = job(&format!(
        "{START}[[blocks]]\nblock = \"MC_MoveRelative\"\naxis = \"X\"\ndistance_mm = 200\nvelocity_mm_per_s = 390\n"
    ));
    for asked in (0..700).step_by(7) {
        let mut setpoints = JobSetpoints::open(&machine, &job.program).unwrap();
        let mut before: Option<AxisSetpoint> = None;
        while let Some(item) = setpoints.next() {
            let PlanItem::Axes(one) = item else { panic!("{item:?}") };
            if one.time_ns == asked * 1_000_000 {
                setpoints.request_stop();
            }
            let told = one.axes.acceleration[0].abs();
            assert!(
                told <= most * (1.0 + 1e-9),
                "{told} at {}, asked for at {asked} ms",
                time(&one)
            );
            if let Some(before) = before {
                let step = (one.axes.velocity[0] - before.axes.velocity[0]).abs() / 1e-3;
                assert!(step <= most * 1.02, "{step} at {}, asked for at {asked} ms", time(&one));
            }
            before = Some(*one);
        }
        assert_eq!(before.unwrap().axes.velocity[0], 0.0, "asked for at {asked} ms");
    }
}

/// With a limited jerk a hold in the middle of a steady motion takes its time.
#[test]
fn a_hold_stays_within_the_jerk() {
    let mut machine = machine();
    machine.axes[0].max_jerk = Some(20.0);
    let job = job(&format!(
        "{START}[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"X\"\nvelocity_mm_per_s = 200\n[[blocks]]\n\
         block = \"MC_Halt\"\naxis = \"X\"\nafter_s = 2\n"
    ));
    let mut setpoints = JobSetpoints::open(&machine, &job.program).unwrap();
    let mut seen = Vec::new();
    while let Some(item) = setpoints.next() {
        let PlanItem::Axes(one) = item else { panic!("{item:?}") };
        if one.time_ns == 1_000_000_000 {
            setpoints.request_stop();
        }
        seen.push(*one);
    }
    let held = seen.iter().filter(|one| time(one) >= 1.0);
    let accelerations: Vec<_> = held.map(|one| one.axes.acceleration[0]).collect();
    for pair in accelerations.windows(2) {
        assert!((pair[1] - pair[0]).abs() <= 20.0e-3 * 1.1, "{pair:?}");
    }
    // From 0.2 m/s with 20 m/s³ it cannot stand before 2·√(v/j) = 0.2 s.
    let last = seen.last().unwrap();
    assert!((1.2..1.5).contains(&time(last)), "{}", time(last));
    assert_eq!(last.axes.velocity[0], 0.0);
}

/// A stop is a hold behind which nothing comes.
#[test]
fn a_stop_ends_the_job_at_rest() {
    let machine = machine();
    let job = job(&format!(
        "{START}[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"X\"\nvelocity_mm_per_s = 100\n[[blocks]]\n\
         block = \"MC_Halt\"\naxis = \"X\"\nafter_s = 2\n"
    ));
    let mut setpoints = JobSetpoints::open(&machine, &job.program).unwrap();
    let mut last = None;
    while let Some(item) = setpoints.next() {
        let PlanItem::Axes(one) = item else { panic!("{item:?}") };
        if one.time_ns == 1_000_000_000 {
            setpoints.request_stop();
        }
        last = Some(one);
    }
    let last = last.unwrap();
    assert!(last.time_ns < 1_500_000_000);
    assert_eq!(last.axes.velocity[0], 0.0);
}

/// What is wrong is said with its line, and nothing of the job moves.
#[test]
fn mistakes_are_told_with_their_lines() {
    let cases = [
        ("", 1, "lacks [[blocks]]"),
        ("[[blocks]]\nblock = \"MC_Move\"\naxis = \"X\"\n", 2, "`block` is \"MC_Move\""),
        ("[[blocks]]\nblock = \"MC_Halt\"\naxis = \"Q\"\n", 3, "there is no axis \"Q\""),
        (
            "[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"X\"\nvelocity_mm_per_s = -1\n",
            4,
            "velocity_mm_per_s",
        ),
        (
            "[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"X\"\nvelocity_deg_per_s = 1\n",
            4,
            "unknown key",
        ),
        (
            "[[blocks]]\nblock = \"MC_GearIn\"\naxis = \"X\"\nmaster = \"X\"\nratio_numerator = 1\n",
            4,
            "follow itself",
        ),
        (
            "[[blocks]]\nblock = \"MC_GearIn\"\naxis = \"X\"\nmaster = \"Y\"\nratio_numerator = 0\n",
            5,
            "`ratio_numerator` is 0: the slave would never move",
        ),
        (
            "[[start]]\naxis = \"X\"\nposition_mm = 1\n[[start]]\naxis = \"X\"\nposition_mm = 2\n\
             [[blocks]]\nblock = \"MC_Halt\"\naxis = \"X\"\n",
            5,
            "two [[start]] say where axis \"X\" starts",
        ),
        (
            "[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"Y\"\ncam = \"none.toml\"\n",
            5,
            "none.toml",
        ),
        (
            "[[blocks]]\nblock = \"MC_Halt\"\naxis = \"X\"\nat_s = 1\nafter_s = 1\n",
            1,
            "one of them",
        ),
        ("nonsense", 1, ""),
    ];
    for (text, line, said) in cases {
        let (setpoints, findings) = run(&job(text), &machine());
        assert_eq!(setpoints, [], "{text}");
        let found = findings.iter().find(|one| one.message.contains(said) && one.line == line);
        assert!(found.is_some(), "{text}: {findings:?}");
    }
}

/// What goes wrong on the way is told with the block's line and the manual's error.
#[test]
fn blocks_that_fail_end_the_job() {
    let endless = "[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"X\"\nvelocity_mm_per_s = 10\n";
    let (_, findings) = run(&job(endless), &machine());
    assert_eq!([findings[0].rule], [Rule::FunctionBlock]);
    assert!(findings[0].message.contains("nothing ends that"), "{findings:?}");
    let zero = "[[blocks]]\nblock = \"MC_MoveAbsolute\"\naxis = \"X\"\nposition_mm = 10\nvelocity_mm_per_s = 0\n";
    let (_, findings) = run(&job(zero), &machine());
    assert!(findings[0].message.contains("SMC_MA_INVALID_VELACC_VALUES"), "{findings:?}");
    assert_eq!(findings[0].line, 2);
}

/// A block on X.
fn block(name: &str, more: &str) -> String {
    format!("[[blocks]]\nblock = \"{name}\"\naxis = \"X\"\n{more}")
}

const FAR_RIGHT: &str =
    "distance_mm = 100\nvelocity_mm_per_s = 200\nacceleration_mm_per_s2 = 1000\n";

/// Behind a stop the axis may move again: 100 mm from where it stands. From 200 mm/s with 1000 mm/s² it stands after 20 mm.
#[test]
fn a_stop_lets_its_axis_go_when_it_stands() {
    let steady =
        block("MC_MoveVelocity", "velocity_mm_per_s = 200\nacceleration_mm_per_s2 = 1000\n");
    let stop = block("MC_Stop", "deceleration_mm_per_s2 = 1000\nafter_s = 0.5\n");
    let setpoints = moves(&format!("{START}{steady}{stop}{}", block("MC_MoveRelative", FAR_RIGHT)));
    // 20 mm up to speed, half a second and a cycle or two at 200 mm/s, 20 mm down, and 100 mm.
    near(setpoints.last().unwrap().axes.position[0], 0.1 + 0.02 + 0.1 + 0.02 + 0.1, 1e-3);
}

/// Whoever loses its axis, or never gets it, ends the job with its line.
#[test]
fn blocks_that_lose_their_axis_are_told() {
    let start = u32::try_from(START.matches('\n').count()).unwrap();
    let relative = |more: &str| block("MC_MoveRelative", &format!("{FAR_RIGHT}{more}"));
    let other = |more: &str| relative(more).replace("\"X\"", "\"Y\"").replace("100", "1");
    let cases = [
        // Both at once: the first never moves.
        (
            relative("") + &relative("with_previous = true\n"),
            2,
            "MC_MoveRelative (line 8) before it moved",
        ),
        // Refused while a stop still brakes.
        (
            block("MC_MoveVelocity", "velocity_mm_per_s = 200\n")
                + &block("MC_Stop", "deceleration_mm_per_s2 = 100\n")
                + &relative("with_previous = true\n"),
            10,
            "has lost its axis to MC_Stop (line 6) before it moved",
        ),
        // The third begins with the end of the second, while the first is under way: nobody said that it may.
        (
            relative("") + &other("with_previous = true\n") + &relative(""),
            2,
            "MC_MoveRelative (line 15) before it was done",
        ),
    ];
    for (blocks, line, said) in cases {
        let (_, findings) = run(&job(&format!("{START}{blocks}")), &machine());
        let [finding] = &findings[..] else { panic!("{blocks}: {findings:?}") };
        assert_eq!((finding.rule, finding.axis.as_deref()), (Rule::FunctionBlock, Some("X")));
        // Lines of blocks count from where they begin.
        let said = said.replace("(line ", "(line #");
        let lines: Vec<_> = (1..40_u32)
            .map(|n| (format!("(line {})", n + start), format!("(line #{n})")))
            .collect();
        let message =
            lines.iter().fold(finding.message.clone(), |text, (from, to)| text.replace(from, to));
        assert!(message.contains(&said), "{said}: {finding:?}");
        assert_eq!(finding.line, line + start, "{finding:?}");
    }
}

/// What says when it takes over may: half a second at 200 mm/s, less 20 mm for getting there, and then 100 mm.
#[test]
fn a_takeover_at_a_stated_time_is_meant() {
    let first = FAR_RIGHT.replace("= 100\n", "= 190\n");
    let second = format!("{FAR_RIGHT}at_s = 0.5\n");
    let setpoints = moves(&format!(
        "{START}{}{}",
        block("MC_MoveRelative", &first),
        block("MC_MoveRelative", &second)
    ));
    near(setpoints.last().unwrap().axes.position[0], 0.1 + 0.1 - 0.02 + 0.1, 1e-3);
}

/// What `duration_s` leaves no time for is no part of a job that is fit.
#[test]
fn blocks_that_never_begin_are_told() {
    let two = block("MC_MoveRelative", FAR_RIGHT) + &block("MC_MoveRelative", FAR_RIGHT);
    let (_, findings) = run(&job(&format!("duration_s = 0.3\n{START}{two}")), &machine());
    let [finding] = &findings[..] else { panic!("{findings:?}") };
    assert_eq!(finding.rule, Rule::FunctionBlock);
    assert!(finding.message.contains("never begins"), "{finding:?}");
    assert_eq!(finding.line, 1 + 6 + 6 + 2);
}

/// A slave of the machine file is its master's until it is let go.
#[test]
fn a_slave_of_the_machine_file_is_not_moved() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/gantry3.toml");
    let text = std::fs::read_to_string(&path).unwrap()
        + "\n[[gears]]\naxis = \"X\"\nmaster = \"Y\"\nratio_numerator = 1\n";
    let machine = Machine::parse(&path, &text).unwrap();
    let relative = block("MC_MoveRelative", FAR_RIGHT);
    let (_, findings) = run(&job(&format!("{START}{relative}")), &machine);
    let [finding] = &findings[..] else { panic!("{findings:?}") };
    assert_eq!((finding.rule, finding.line), (Rule::Coupling, 8));
    assert!(finding.message.contains("moves axis X, which follows Y by a gear"), "{finding:?}");
    let (setpoints, findings) =
        run(&job(&format!("{START}{}{relative}", block("MC_GearOut", ""))), &machine);
    assert_eq!(findings, []);
    near(setpoints.last().unwrap().axes.position[0], 0.2, 1e-9);
}

/// A cam in mm does not move an axis in degrees, nor is it led by one.
#[test]
fn units_of_a_cam_are_those_of_its_axes() {
    let cam_in = "[[blocks]]\nblock = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"shaft\"\ncam = \"hump.cam.toml\"\n";
    let job = job(&format!("duration_s = 1\n{SHAFT}{cam_in}"));
    let cam = "name = \"hump\"\nmaster = { min = 0, max = 360, unit = \"mm\" }\n\
               slave = { min = 0, max = 40, unit = \"deg\" }\n\
               elements = [{ master = 0, slave = 0 }, { master = 360, slave = 40 }]\n";
    std::fs::write(job.folder.path().join("hump.cam.toml"), cam).unwrap();
    let (setpoints, findings) = run(&job, &machine());
    assert_eq!(setpoints, []);
    let line = 1 + 5 + 5;
    for said in ["the slave is in deg, axis X in mm", "the master is in mm, axis shaft in deg"] {
        let found = findings.iter().find(|one| one.message.contains(said));
        assert_eq!(found.map(|one| one.line), Some(line), "{findings:?}");
    }
}

/// A cam over seconds, 0 to 40 mm in 2 s on the quintic 10u³ − 15u⁴ + 6u⁵, whose master counts them in mm: half a millisecond late. In s
/// there is no such axis, and the message says what helps.
#[test]
fn a_cam_over_time_has_a_master_with_a_millimetre_a_second() {
    let text = "[[start]]\naxis = \"X\"\nposition_mm = 0\n[[virtual_axes]]\nname = \"time\"\nkind = \"linear\"\nmax_acceleration_mm_per_s2 = 1000\n\
                [[blocks]]\nblock = \"MC_CamIn\"\naxis = \"X\"\nmaster = \"time\"\ncam = \"t.toml\"\nperiodic = false\n\
                [[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"time\"\nvelocity_mm_per_s = 1\n\
                [[blocks]]\nblock = \"MC_Halt\"\naxis = \"time\"\nat_s = 3\n";
    let cam = |unit: &str| {
        format!(
            "name = \"t\"\nmaster = {{ min = 0, max = 2, unit = \"{unit}\" }}\nslave = {{ min = 0, max = 40, unit = \"mm\" }}\n\
             elements = [{{ master = 0, slave = 0 }}, {{ master = 2, slave = 40 }}]\n"
        )
    };
    let job = job(text);
    let path = job.folder.path().join("t.toml");
    std::fs::write(&path, cam("mm")).unwrap();
    let (setpoints, findings) = run(&job, &machine());
    assert_eq!(findings, []);
    for one in setpoints.iter().filter(|one| (0.01..2.5).contains(&time(one))) {
        let u = ((time(one) - 0.0005) / 2.0).min(1.0);
        let expected = 40.0 * u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
        // 37.5 mm/s at most, and the block begins within a cycle.
        near(one.axes.position[0] * 1e3, expected, 0.06);
    }
    std::fs::write(&path, cam("s")).unwrap();
    let (_, findings) = run(&job, &machine());
    let [finding] = &findings[..] else { panic!("{findings:?}") };
    assert!(finding.message.contains("MC_MoveVelocity moves with 1 mm/s"), "{finding:?}");
}
