//! Tests of jobs against closed forms.

#![expect(clippy::float_cmp, reason = "numbers of the file, and what must not move at all")]

mod along;
mod block;
mod direct;
mod end;
mod first_cycle;
mod guide;
mod hostile;
mod machine;
mod mistake;
mod order;
mod tappet;
mod word;

use super::JobSetpoints;
use crate::finding::{Finding, Rule};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use crate::setpoint::AxisSetpoint;
use crate::setpoint_source::PlanItem;
use std::path::{Path, PathBuf};
use twin_machine::Machine;

fn machine_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/machines").join(name)
}

/// The axes X, Y and Z of the gantry, in mm.
fn machine() -> Machine {
    Machine::load(&machine_file("gantry3.toml")).unwrap()
}

/// The same with `more` behind its file.
fn machine_with(more: &str) -> Machine {
    let path = machine_file("gantry3.toml");
    Machine::parse(&path, &(std::fs::read_to_string(&path).unwrap() + more)).unwrap()
}

struct Job {
    folder: tempfile::TempDir,
    program: ProgramFile,
}

impl Job {
    /// The same next to another file.
    fn with(self, name: &str, text: &str) -> Self {
        std::fs::write(self.folder.path().join(name), text).unwrap();
        self
    }
}

fn job(text: &str) -> Job {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("job.toml");
    std::fs::write(&path, text).unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Job), ReadSettings::default()).unwrap();
    Job { folder, program }
}

/// Set-points of a job, and its findings.
fn run(job: &Job, machine: &Machine) -> (Vec<AxisSetpoint>, Vec<Finding>) {
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

fn moves(text: &str) -> Vec<AxisSetpoint> {
    let (setpoints, findings) = run(&job(text), &machine());
    assert_eq!(findings, []);
    setpoints
}

fn findings(text: &str) -> Vec<Finding> {
    run(&job(text), &machine()).1
}

/// The only finding.
#[track_caller]
fn only(findings: &[Finding]) -> &Finding {
    let [finding] = findings else { panic!("{findings:#?}") };
    finding
}

/// A finding in this line with these words.
#[track_caller]
fn finds(findings: &[Finding], line: u32, words: &str) {
    let found = findings.iter().any(|one| one.message.contains(words) && one.line == line);
    assert!(found, "{line}, {words}: {findings:?}");
}

/// s.
fn time(setpoint: &AxisSetpoint) -> f64 {
    twin_number::seconds(setpoint.time_ns)
}

/// Position, velocity and acceleration of X, mm, mm/s, mm/s².
fn x(setpoint: &AxisSetpoint) -> [f64; 3] {
    let motion = &setpoint.axes;
    [motion.position[0], motion.velocity[0], motion.acceleration[0]].map(|value| value * 1e3)
}

fn at(setpoints: &[AxisSetpoint], seconds: f64) -> &AxisSetpoint {
    setpoints.iter().find(|one| (time(one) - seconds).abs() < 1e-9).unwrap()
}

/// [`x`] at a time.
fn x_at(setpoints: &[AxisSetpoint], seconds: f64) -> [f64; 3] {
    x(at(setpoints, seconds))
}

fn near(actual: f64, expected: f64, tolerance: f64) {
    assert!((actual - expected).abs() <= tolerance, "{actual} is not {expected}");
}

const START: &str =
    "[[start]]\naxis = \"X\"\nposition_mm = 100\n[[start]]\naxis = \"Y\"\nposition_mm = 50\n";

/// A block of this name on an axis, with keys that `; ` separates.
fn block(name: &str, axis: &str, keys: &str) -> String {
    let lines = keys.split("; ").filter(|key| !key.is_empty());
    let keys: String = lines.flat_map(|key| [key.trim_end(), "\n"]).collect();
    format!("[[blocks]]\nblock = \"{name}\"\naxis = \"{axis}\"\n{keys}")
}

/// A virtual axis, with keys that `; ` separates.
fn virtual_axis(name: &str, kind: &str, keys: &str) -> String {
    let keys = keys.replace("; ", "\n");
    format!("[[virtual_axes]]\nname = \"{name}\"\nkind = \"{kind}\"\n{keys}\n")
}

const FAR_RIGHT: &str = "distance_mm = 100; velocity_mm_per_s = 200; acceleration_mm_per_s2 = 1000";

/// 100 mm at 200 mm/s with 1000 mm/s²: up and down in 0.2 s and 20 mm each, 60 mm between in 0.3 s; then as far again, 0.5 s
/// later, back.
#[test]
fn blocks_begin_behind_each_other() {
    let back =
        "position_mm = 100; velocity_mm_per_s = 200; acceleration_mm_per_s2 = 1000; after_s = 0.5";
    let out = block("MC_MoveRelative", "X", FAR_RIGHT);
    let setpoints = moves(&[START, &out, &block("MC_MoveAbsolute", "X", back)].concat());
    for (seconds, place) in [(0.0, 100.0), (0.1, 105.0), (0.7, 200.0), (1.2, 200.0), (1.3, 195.0)] {
        near(x_at(&setpoints, seconds)[0], place, 1e-9);
    }
    near(x_at(&setpoints, 0.0)[0], 100.0, 0.0);
    near(x_at(&setpoints, 0.35)[1], 200.0, 1e-9);
    // The second begins with the cycle behind the pause, and ends after 0.7 s.
    let last = setpoints.last().unwrap();
    assert!((1_900_000_000..=1_903_000_000).contains(&last.time_ns), "{}", last.time_ns);
    near(x(last)[0], 100.0, 1e-9);
    assert_eq!(x(last)[1..], [0.0; 2]);
    // The lines are those of the blocks.
    assert_eq!([0.3, 1.6].map(|seconds| at(&setpoints, seconds).place.line), [8, 14]);
    // The tool of a gantry is where its axes are.
    for setpoint in &setpoints {
        let [x, y] = [setpoint.axes.position[0], setpoint.axes.position[1]];
        near(setpoint.tool.velocity.x, setpoint.axes.velocity[0], 1e-12);
        near(y, 0.05, 1e-12);
        let first = &setpoints[0];
        near(setpoint.tool.pose.position.x - first.tool.pose.position.x, x - 0.1, 1e-12);
    }
}

fn shaft(max_acceleration: f64) -> String {
    let keys = format!("period_deg = 360; max_acceleration_deg_per_s2 = {max_acceleration}");
    virtual_axis("shaft", "rotary", &keys)
}

/// Y goes 3 mm for every 2 degrees of the shaft; of twenty turns a second each.
#[test]
fn a_slave_in_gear_keeps_its_ratio() {
    let gear = "master = \"shaft\"; ratio_numerator = 3; ratio_denominator = 200";
    let turn = "velocity_deg_per_s = 7200; acceleration_deg_per_s2 = 36000";
    let setpoints = moves(&format!(
        "duration_s = 1.5\n{START}{}{}{}",
        shaft(36e3),
        block("MC_GearIn", "Y", gear),
        block("MC_MoveVelocity", "shaft", turn)
    ));
    // Up in 0.2 s and down in as long: 540 mm/s² of Y.
    let middle = at(&setpoints, 1.0);
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
    let cam = "master = { min = 0, max = 360 }\nslave = { min = 0, max = 40, period = 360 }\n\
        elements = [{ master = 0, slave = 0 }, { master = 180, slave = 40 }, { master = 360, slave = 0 }]\n";
    let job = job(&format!(
        "duration_s = 2\n{}[[start]]\naxis = \"X\"\nposition_mm = 0\n{}{}",
        shaft(36e3),
        block("MC_CamIn", "X", "master = \"shaft\"; cam = \"hump.cam.toml\""),
        block(
            "MC_MoveVelocity",
            "shaft",
            "velocity_deg_per_s = 360; acceleration_deg_per_s2 = 360000"
        )
    ));
    let (setpoints, findings) = run(&job.with("hump.cam.toml", cam), &machine());
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

/// All set-points of a job whose `act` may interrupt it at each of them.
fn acted(
    machine: &Machine,
    job: &Job,
    mut act: impl FnMut(&mut JobSetpoints<'_>, &AxisSetpoint),
) -> Vec<AxisSetpoint> {
    let mut setpoints = JobSetpoints::open(machine, &job.program).unwrap();
    let mut seen = Vec::new();
    while let Some(item) = setpoints.next() {
        let PlanItem::Axes(one) = item else { panic!("{item:?}") };
        act(&mut setpoints, &one);
        seen.push(*one);
    }
    seen
}

/// The same with a stop after `stop_ms`.
fn stopped(machine: &Machine, job: &Job, stop_ms: i64) -> Vec<AxisSetpoint> {
    acted(machine, job, |setpoints, one| {
        if one.time_ns == stop_ms * 1_000_000 {
            setpoints.request_stop();
        }
    })
}

/// Half the override takes twice as long, with half the velocity and a quarter of the acceleration.
#[test]
fn the_override_stretches_time() {
    let (machine, job) =
        (machine(), job(&(START.to_owned() + &block("MC_MoveRelative", "X", FAR_RIGHT))));
    let mut setpoints = JobSetpoints::open(&machine, &job.program).unwrap();
    setpoints.set_override(0.5);
    let slow: Vec<_> = setpoints
        .map(|item| if let PlanItem::Axes(one) = item { *one } else { panic!("{item:?}") })
        .collect();
    let last = slow.last().unwrap();
    near(last.axes.position[0], 0.2, 1e-12);
    // At rest the factor changes at once, within a cycle.
    near(time(last), 1.4, 4e-3);
    let fastest = |by: usize| slow.iter().map(|one| x(one)[by].abs()).fold(0.0, f64::max);
    near(fastest(1), 100.0, 1e-6);
    near(fastest(2), 250.0, 1e-3);
}

/// A hold in the middle stops all axes together, each within its acceleration, and the job goes on to the same end.
#[test]
fn a_hold_brakes_within_the_acceleration_of_the_axes() {
    let machine = machine();
    let job = job(&format!(
        "{START}{}{}",
        block("MC_MoveRelative", "X", "distance_mm = 200; velocity_mm_per_s = 200"),
        block(
            "MC_GearIn",
            "Y",
            "master = \"X\"; ratio_numerator = 1; ratio_denominator = 2; at_s = 0"
        )
    ));
    let mut held = None;
    let seen = acted(&machine, &job, |setpoints, one| match one.time_ns {
        400_000_000 => setpoints.set_override(0.0),
        2_000_000_000 => {
            assert!(setpoints.follows_override());
            held = Some(one.axes.position[0]);
            assert_eq!(one.axes.velocity[0], 0.0);
            setpoints.set_override(1.0);
        }
        _ => {}
    });
    assert!((0.11..0.2).contains(&held.unwrap()), "{held:?}");
    let last = seen.last().unwrap();
    near(last.axes.position[0], 0.3, 1e-12);
    near(last.axes.position[1], 0.05 + 0.1, 1e-6);
    for pair in seen.windows(2) {
        let [before, after] = [&pair[0].axes, &pair[1].axes];
        for (axis, described) in machine.axes.iter().enumerate() {
            let most = described.max_acceleration;
            assert!(after.acceleration[axis].abs() <= most * 1.000_001, "axis {axis}");
            // The velocity is what the positions do.
            let mean = f64::midpoint(before.velocity[axis], after.velocity[axis]);
            near((after.position[axis] - before.position[axis]) / 1e-3, mean, most * 1e-3);
        }
        // In gear all the way.
        near(after.velocity[1], after.velocity[0] / 2.0, 1e-9);
    }
}

/// A hold at any time stays within the acceleration of the axis, which the move itself uses up, and velocities are
/// what positions do.
#[test]
fn a_hold_at_any_time_stays_within_the_acceleration() {
    let machine = machine();
    let most = machine.axes[0].max_acceleration;
    let move_on = block("MC_MoveRelative", "X", "distance_mm = 200; velocity_mm_per_s = 390");
    let job = job(&(START.to_owned() + &move_on));
    for asked in (0..700).step_by(7) {
        let seen = stopped(&machine, &job, asked);
        for (index, one) in seen.iter().enumerate() {
            let (at, now) = (time(one), one.axes.acceleration[0].abs());
            assert!(now <= most * (1.0 + 1e-9), "{now} at {at}, asked for at {asked} ms");
            if let Some(before) = index.checked_sub(1).map(|before| &seen[before]) {
                let step = (one.axes.velocity[0] - before.axes.velocity[0]).abs() / 1e-3;
                assert!(step <= most * 1.02, "{step} at {at}, asked for at {asked} ms");
            }
        }
        assert_eq!(seen.last().unwrap().axes.velocity[0], 0.0, "asked for at {asked} ms");
    }
}

fn endless_and_halted(velocity: f64) -> Job {
    let on = block("MC_MoveVelocity", "X", &format!("velocity_mm_per_s = {velocity}"));
    job(&[START, &on, &block("MC_Halt", "X", "after_s = 2")].concat())
}

/// With a limited jerk a hold in the middle of a steady motion takes its time.
#[test]
fn a_hold_stays_within_the_jerk() {
    let mut machine = machine();
    machine.axes[0].max_jerk = Some(20.0);
    let seen = stopped(&machine, &endless_and_halted(200.0), 1_000);
    let held = seen.iter().filter(|one| time(one) >= 1.0);
    let accelerations: Vec<_> = held.map(|one| one.axes.acceleration[0]).collect();
    for pair in accelerations.windows(2) {
        assert!((pair[1] - pair[0]).abs() <= 20.0e-3 * 1.1, "{pair:?}");
    }
    // From 0.2 m/s with 20 m/s³ it cannot stop before 2·√(v/j) = 0.2 s.
    let last = seen.last().unwrap();
    assert!((1.2..1.5).contains(&time(last)), "{}", time(last));
    assert_eq!(last.axes.velocity[0], 0.0);
}

/// A stop is a hold behind which nothing comes.
#[test]
fn a_stop_ends_the_job_at_rest() {
    let seen = stopped(&machine(), &endless_and_halted(100.0), 1_000);
    let last = seen.last().unwrap();
    assert!(last.time_ns < 1_500_000_000);
    assert_eq!(last.axes.velocity[0], 0.0);
}

/// Mistakes are reported with their lines, and nothing of the job moves.
#[test]
fn mistakes_are_told_with_their_lines() {
    let start = |at: f64| format!("[[start]]\naxis = \"X\"\nposition_mm = {at}\n");
    let move_on = |keys: &str| block("MC_MoveVelocity", "X", keys);
    let gear = |keys: &str| block("MC_GearIn", "X", keys);
    let zero = "`ratio_numerator` is 0: the slave would never move";
    let twice = "two [[start]] say where axis \"X\" starts";
    let (profile, follow) = (
        |points: &str| block("MC_PositionProfile", "X", points),
        |points: &str| block("SMC_FollowPosition", "X", points),
    );
    let speed = "points = [{ delta_s = 1, velocity_mm_per_s = 5 }]";
    let halt = block("MC_Halt", "X", "");
    let trigger = |keys: &str| format!("[[triggers]]\nname = \"mark\"\n{keys}{halt}");
    for (text, line, said) in [
        (String::new(), 1, "lacks [[blocks]]"),
        (block("MC_Move", "X", ""), 2, "`block` is \"MC_Move\""),
        (block("MC_Halt", "Q", ""), 3, "unknown axis \"Q\""),
        (move_on("velocity_mm_per_s = -1"), 4, "velocity_mm_per_s"),
        (move_on("velocity_deg_per_s = 1"), 4, "unknown key"),
        (gear("master = \"X\"; ratio_numerator = 1"), 4, "follow itself"),
        (gear("master = \"Y\"; ratio_numerator = 0"), 5, zero),
        (start(1.0) + &start(2.0) + &block("MC_Halt", "X", ""), 5, twice),
        (block("MC_CamIn", "X", "master = \"Y\"; cam = \"none.toml\""), 5, "none.toml"),
        (block("MC_Halt", "X", "at_s = 1; after_s = 1"), 1, "one of them"),
        ("nonsense".to_owned(), 1, ""),
        // Points and set-points over time.
        (profile(""), 1, "1 to 100 `points`"),
        (profile("points = [{ delta_s = 0.1 }]"), 4, "position_mm"),
        (profile("points = [{ delta_s = 0.1, position_mm = 1, speed = 2 }]"), 4, "unknown key"),
        (block("SMC_FollowVelocity", "X", ""), 1, "need `points`"),
        (block("SMC_FollowVelocity", "X", speed), 4, "set-points end at rest"),
        (follow("points = [{ delta_s = 0, position_mm = 5 }]"), 4, "delta_s"),
        (follow(speed), 4, "position_mm"),
        // Triggers, and a change of cams without a cam.
        (block("MC_TouchProbe", "X", "trigger = \"mark\""), 4, "there are no [[triggers]]"),
        (
            block("MC_MoveRelative", "X", "at_end_of_profile = true"),
            4,
            "not an MC_CamIn of the same axis",
        ),
        (trigger(""), 1, "a trigger needs"),
        (trigger("at_s = 1\naxis = \"X\"\nposition_mm = 1\n"), 1, "a trigger needs"),
        (trigger("axis = \"Q\"\nposition_mm = 1\n"), 3, "unknown axis \"Q\""),
    ] {
        let (setpoints, findings) = run(&job(&text), &machine());
        assert_eq!(setpoints, [], "{text}");
        finds(&findings, line, said);
    }
}

/// Errors on the way are reported with the block's line and the manual's error.
#[test]
fn blocks_that_fail_end_the_job() {
    let found = findings(&block("MC_MoveVelocity", "X", "velocity_mm_per_s = 10"));
    assert_eq!([found[0].rule], [Rule::FunctionBlock]);
    assert!(found[0].message.contains("without end"), "{found:?}");
    assert!(found[0].message.contains("still moves with 10.000 mm/s after"), "{found:?}");
    let found = findings(&block("MC_MoveAbsolute", "X", "position_mm = 10; velocity_mm_per_s = 0"));
    assert!(found[0].message.contains("SMC_MA_INVALID_VELACC_VALUES"), "{found:?}");
    let hint = found[0].hint.as_deref().unwrap_or_default();
    assert!(hint.contains("have to be greater than 0") && found[0].line == 2, "{found:?}");
}

/// After a stop the axis may move again: 100 mm from its position. From 200 mm/s with 1000 mm/s² it stops after 20 mm.
#[test]
fn a_stop_lets_its_axis_go_when_it_stands() {
    let steady = "velocity_mm_per_s = 200; acceleration_mm_per_s2 = 1000";
    let setpoints = moves(
        &[
            START,
            &block("MC_MoveVelocity", "X", steady),
            &block("MC_Stop", "X", "deceleration_mm_per_s2 = 1000; after_s = 0.5"),
            &block("MC_MoveRelative", "X", FAR_RIGHT),
        ]
        .concat(),
    );
    // 20 mm up to speed, half a second and a cycle or two at 200 mm/s, 20 mm down, and 100 mm.
    near(setpoints.last().unwrap().axes.position[0], 0.1 + 0.02 + 0.1 + 0.02 + 0.1, 1e-3);
}

/// A block that loses its axis, or never gets it, ends the job with its line.
#[test]
fn blocks_that_lose_their_axis_are_told() {
    let start = u32::try_from(START.matches('\n').count()).unwrap();
    let relative = |more: &str| block("MC_MoveRelative", "X", &format!("{FAR_RIGHT}{more}"));
    let other = |more: &str| relative(more).replace("\"X\"", "\"Y\"").replace("100", "1");
    let line = |line: u32| format!("(line {})", line + start);
    let cases = [
        // Both at once: the first never moves.
        (
            relative("") + &relative("; with_previous = true"),
            2,
            format!("MC_MoveRelative {} before it moved", line(8)),
        ),
        // Refused while a stop still brakes.
        (
            block("MC_MoveVelocity", "X", "velocity_mm_per_s = 200")
                + &block("MC_Stop", "X", "deceleration_mm_per_s2 = 100")
                + &relative("; with_previous = true"),
            10,
            format!("has lost its axis to MC_Stop {} before it moved", line(6)),
        ),
        // The third begins with the end of the second, while the first is under way: nobody said that it may.
        (
            relative("") + &other("; with_previous = true") + &relative(""),
            2,
            format!("MC_MoveRelative {} before it was done", line(15)),
        ),
    ];
    for (blocks, line, said) in cases {
        let found = findings(&format!("{START}{blocks}"));
        let finding = only(&found);
        assert_eq!((finding.rule, finding.axis.as_deref()), (Rule::FunctionBlock, Some("X")));
        assert!(finding.message.contains(&said), "{said}: {finding:?}");
        assert_eq!(finding.line, line + start, "{finding:?}");
    }
}

/// A block with a time may take over: half a second at 200 mm/s, less 20 mm for getting there, and then 100 mm.
#[test]
fn a_takeover_at_a_stated_time_is_meant() {
    let first = block("MC_MoveRelative", "X", &FAR_RIGHT.replace("= 100;", "= 190;"));
    let second = block("MC_MoveRelative", "X", &format!("{FAR_RIGHT}; at_s = 0.5"));
    let setpoints = moves(&[START, &first, &second].concat());
    near(setpoints.last().unwrap().axes.position[0], 0.1 + 0.1 - 0.02 + 0.1, 1e-3);
}

/// A block for which `duration_s` leaves no time is a mistake.
#[test]
fn blocks_that_never_begin_are_told() {
    let one = block("MC_MoveRelative", "X", FAR_RIGHT);
    let found = findings(&format!("duration_s = 0.3\n{START}{one}{one}"));
    assert_eq!(only(&found).rule, Rule::FunctionBlock);
    finds(&found, 1 + 6 + 6 + 2, "never begins");
}

/// A slave of the machine file follows its master until it is released.
#[test]
fn a_slave_of_the_machine_file_is_not_moved() {
    let machine = machine_with("\n[[gears]]\naxis = \"X\"\nmaster = \"Y\"\nratio_numerator = 1\n");
    let relative = block("MC_MoveRelative", "X", FAR_RIGHT);
    let (_, found) = run(&job(&format!("{START}{relative}")), &machine);
    assert_eq!(only(&found).rule, Rule::Coupling);
    finds(&found, 8, "moves axis X, which follows Y by a gear");
    let out = block("MC_GearOut", "X", "");
    let (setpoints, findings) = run(&job(&format!("{START}{out}{relative}")), &machine);
    assert_eq!(findings, []);
    near(setpoints.last().unwrap().axes.position[0], 0.2, 1e-9);
}

/// A cam in mm does not move an axis in degrees, nor is its master in degrees.
#[test]
fn units_of_a_cam_are_those_of_its_axes() {
    let cam_in = block("MC_CamIn", "X", "master = \"shaft\"; cam = \"hump.cam.toml\"");
    let cam = "name = \"hump\"\nmaster = { min = 0, max = 360, unit = \"mm\" }\n\
               slave = { min = 0, max = 40, unit = \"deg\" }\n\
               elements = [{ master = 0, slave = 0 }, { master = 360, slave = 40 }]\n";
    let job = job(&format!("duration_s = 1\n{}{cam_in}", shaft(36e3)));
    let (setpoints, findings) = run(&job.with("hump.cam.toml", cam), &machine());
    assert_eq!(setpoints, []);
    for said in ["the slave is in deg, axis X in mm", "the master is in mm, axis shaft in deg"] {
        finds(&findings, 1 + 5 + 5, said);
    }
}

/// A cam over seconds, 0 to 40 mm in 2 s on the quintic 10u³ − 15u⁴ + 6u⁵, whose master counts them in mm: half a millisecond
/// late. There is no axis in s, and the message says what helps.
#[test]
fn a_cam_over_time_has_a_master_with_a_millimetre_a_second() {
    let cam = |unit: &str| {
        format!(
            "name = \"t\"\nmaster = {{ min = 0, max = 2, unit = \"{unit}\" }}\nslave = {{ min = 0, max = 40, unit = \"mm\" }}\n\
             elements = [{{ master = 0, slave = 0 }}, {{ master = 2, slave = 40 }}]\n"
        )
    };
    let job = job(&[
        "[[start]]\naxis = \"X\"\nposition_mm = 0\n",
        &virtual_axis("time", "linear", "max_acceleration_mm_per_s2 = 1000"),
        &block("MC_CamIn", "X", "master = \"time\"; cam = \"t.toml\"; periodic = false"),
        &block("MC_MoveVelocity", "time", "velocity_mm_per_s = 1"),
        &block("MC_Halt", "time", "at_s = 3"),
    ]
    .concat());
    let job = job.with("t.toml", &cam("mm"));
    let (setpoints, findings) = run(&job, &machine());
    assert_eq!(findings, []);
    for one in setpoints.iter().filter(|one| (0.01..2.5).contains(&time(one))) {
        let u = ((time(one) - 0.0005) / 2.0).min(1.0);
        let expected = 40.0 * u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
        // 37.5 mm/s at most, and the block begins within a cycle.
        near(one.axes.position[0] * 1e3, expected, 0.06);
    }
    let (_, findings) = run(&job.with("t.toml", &cam("s")), &machine());
    let finding = only(&findings);
    assert!(finding.message.contains("MC_MoveVelocity moves with 1 mm/s"), "{finding:?}");
}
