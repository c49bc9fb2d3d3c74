//! Tests of following-error predictions against closed forms, and of the places that report them.

use super::following::Follower;
use super::{CheckOptions, Outcome, check, wire_rates};
use crate::finding::{Finding, Rule, Severity};
use crate::in_loop::DrivesInLoop;
use crate::limit::Limits;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use crate::setpoint::AxisSetpoint;
use nalgebra::Point3;
use std::collections::VecDeque;
use std::path::Path;
use twin_drives::{IncrementMotion, Prediction, SetpointStream, WireRates};
use twin_kinematics::{AxisMotion, AxisVector, Kinematics, Pose, ToolMotion};
use twin_machine::Machine;
use twin_machine::tappets::TappetBits;
use twin_path::Place;

/// Three linear axes of 320 increments per mm and more, half a millimetre of following error, on a board.
const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");

/// A device that is where its plan was this many ns before.
#[derive(Clone, Debug)]
struct Late {
    delay_ns: i64,
    seen: VecDeque<(i64, IncrementMotion)>,
}

impl Prediction for Late {
    fn axis_count(&self) -> usize {
        3
    }

    fn advance(&mut self, plan: &dyn SetpointStream, time_ns: i64) -> IncrementMotion {
        self.seen.push_back((time_ns, plan.at(time_ns)));
        while self.seen.get(1).is_some_and(|(at, _)| *at <= time_ns - self.delay_ns) {
            self.seen.pop_front();
        }
        self.seen.front().map(|(_, motion)| *motion).unwrap_or_default()
    }

    fn exchanges(&self) -> u64 {
        600
    }

    fn rates(&self) -> WireRates {
        WireRates::default()
    }

    fn copied(&self) -> Box<dyn Prediction> {
        Box::new(self.clone())
    }
}

fn machine(text: &str) -> Machine {
    Machine::parse(Path::new("machine.toml"), text)
        .unwrap_or_else(|problems| panic!("{problems:#?}"))
}

/// Behind a plan of constant speed a device is speed times delay late, no more and no less, and that is what is reported: of the axis
/// and the tool, in the line in which it is first as large, and as a warning where the machine file allows less.
#[test]
fn a_late_device_is_speed_times_delay_behind() {
    let machine = machine(GANTRY3);
    let late = Late { delay_ns: 12_000_000, seen: VecDeque::new() };
    let drives = DrivesInLoop::predicting(&machine, |_, _| Some(late.copied())).unwrap();
    let height = machine.kinematics.forward(&AxisVector::zeros(3)).unwrap().position.z;
    let mut follower = Follower::new(&machine, drives);
    // 0.1 m/s of X for a second, then half of that.
    for cycle in 0..=2000_i32 {
        let time = f64::from(cycle) * 1e-3;
        let (speed, line) = if cycle <= 1000 { (0.1, 7) } else { (0.05, 8) };
        let position = 0.1 * time.min(1.0) + 0.05 * (time - 1.0).max(0.0);
        let vector = |x: f64| AxisVector::from_values([x, 0.0, 0.0]);
        follower.take(&AxisSetpoint {
            time_ns: i64::from(cycle) * 1_000_000,
            place: Place::at(line),
            axes: AxisMotion {
                position: vector(position),
                velocity: vector(speed),
                acceleration: vector(0.0),
            },
            tool: ToolMotion::at_rest(Pose {
                position: Point3::new(position, 0.0, height),
                direction: 0.0,
            }),
            m_call: None,
            path_velocity: speed,
            feed: None,
            probing: false,
            tappets: TappetBits::default(),
            switches: 0,
        });
    }
    let (predicted, findings) = follower.finish();
    let (largest, place) = predicted.axes[0].unwrap().maximum().unwrap();
    assert!((largest - 0.1 * 0.012).abs() < 1e-9, "{largest}");
    assert_eq!(place.line, 7);
    let (tool, _) = predicted.tool.maximum().unwrap();
    assert!((tool - 0.1 * 0.012).abs() < 1e-9, "{tool}");
    assert_eq!(predicted.axes[1].unwrap().maximum().unwrap().0.to_bits(), 0);
    // 600 in two seconds and until it rests, a dozen cycles later.
    assert!((predicted.devices[0].exchanges_per_s - 600.0 / 2.012).abs() < 1.0);

    // 1.2 mm in the first line and 0.6 mm in the second, which begins a delay late.
    let (findings, left_out) = findings.into_list();
    let key = |finding: &Finding| (finding.line, finding.rule, finding.severity);
    let mut lines: Vec<_> = findings.iter().map(key).collect();
    lines.sort();
    let warning = |line| (line, Rule::FollowingError, Severity::Warning);
    assert_eq!((lines, left_out), (vec![warning(7), warning(8)], 0));
    let first = findings.iter().find(|finding| finding.line == 7).unwrap();
    assert!((first.value.unwrap() - 1.2).abs() < 1e-6 && first.limit == Some(0.5), "{first:?}");
    assert_eq!((first.axis.as_deref(), first.unit), (Some("X"), Some("mm")));
}

/// The digest's table: command 80 of 27 + 8 bytes 8.5 ms, a sample of five axes 8.7 ms, with 2 ms of turnaround; GOTO v,a of
/// 11 + 9 bytes 1.7 ms, 2 ms of response and a gap of 1 ms; an order of 10 ms and a look of 1 ms, 200 looks a second at most.
#[test]
fn wires_carry_what_their_timing_allows() {
    let of = |text: &str| wire_rates(&machine(text));
    let near = |found: f64, wanted: f64| {
        assert!((found / wanted - 1.0).abs() < 0.01, "{found}, not {wanted}");
    };
    let board = of(GANTRY3);
    let round = 3.0 * 8.53e-3 + 8.7e-3;
    near(board[0].1.commands_per_s, 3.0 / round);
    near(board[0].1.samples_per_s, 1.0 / round);
    let bus = of(&on_bus());
    near(bus[0].1.commands_per_s, 1.0 / 4.736e-3);
    near(bus[0].1.samples_per_s, 1.0 / (3.0 * 4.736e-3));
    let module = of(&on_module());
    near(module[0].1.commands_per_s, 2.0 / 11e-3);
    near(module[0].1.samples_per_s, 1.0 / 6e-3);
    // Four times the baud rate.
    let slow = of(&GANTRY3.replace("kind = \"interpcnc\"", "kind = \"interpcnc\"\nbaud = 28800"));
    assert!(slow[0].1.samples_per_s < 0.5 * board[0].1.samples_per_s);
}

/// X, Y and Z on drives of a bus.
fn on_bus() -> String {
    let text = GANTRY3.replace("kind = \"interpcnc\"", "kind = \"smartdrive\"");
    [("X", 1), ("Y", 2), ("Z", 3)].into_iter().fold(text, |text, (axis, address)| {
        text.replace(&format!("drive_axis = \"{axis}\""), &format!("drive_address = {address}"))
    })
}

/// X and Y on a module, Z on a bus.
fn on_module() -> String {
    let both =
        "name = \"board\"\nkind = \"bim2ax\"\n\n[[drives]]\nname = \"bus\"\nkind = \"smartdrive\"";
    GANTRY3
        .replace("name = \"board\"\nkind = \"interpcnc\"", both)
        .replace("drive_axis = \"X\"", "drive_axis = \"1\"")
        .replace("drive_axis = \"Y\"", "drive_axis = \"2\"")
        .replace("drive = \"board\"\ndrive_axis = \"Z\"", "drive = \"bus\"\ndrive_address = 1")
}

fn checked(text: &str, program: &str, drives: bool) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.ngc");
    std::fs::write(&path, program).unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Rs274), ReadSettings::default()).unwrap();
    let options = CheckOptions { limits: Limits::Programmed, drives, ..CheckOptions::default() };
    check(&machine(text), &program, options, &mut |_| {}).unwrap()
}

/// At constant speed a module that goes from point to point stands for an order and a look between two legs, 11 ms, while the plan
/// goes on: at best half of that way before and half behind. What it makes of a leg is at most what the plan makes in its whole
/// horizon. A program of many lines is reported at the line in which it is worst.
#[test]
fn a_module_stands_while_its_plan_goes_on() {
    let program = "G0 Z30\nG1 X100 F3000\nG1 X160 F6000\nM2\n";
    let outcome = checked(&on_module(), program, true);
    let predicted = outcome.following.unwrap();
    let (largest, place) = predicted.axes[0].unwrap().maximum().unwrap();
    assert!((0.5 * 0.1 * 0.011..0.1 * 0.25).contains(&largest), "{largest}");
    assert_eq!(place.line, 3);
    assert_eq!(predicted.devices.len(), 2);
    let warning = |finding: &&Finding| finding.rule == Rule::FollowingError;
    let warnings: Vec<_> = outcome.findings.iter().filter(warning).collect();
    let limited = predicted.axes[0].unwrap().maximum().unwrap().0 > 0.5e-3;
    assert_eq!(
        warnings.iter().any(|one| one.line == 3 && one.axis.as_deref() == Some("X")),
        limited
    );
    assert!(warnings.iter().all(|one| one.severity == Severity::Warning));
}

#[test]
fn a_prediction_repeats_itself_and_is_made_only_where_it_is_wanted() {
    let program = "G0 X50 Y50\nG2 X50 Y50 I30 J0 F6000\nM2\n";
    for text in [GANTRY3.to_owned(), on_bus(), on_module()] {
        let (one, two) = (checked(&text, program, true), checked(&text, program, true));
        assert!(one.following.is_some() && one.following == two.following);
        assert_eq!(one.findings, two.findings);
        assert!(checked(&text, program, false).following.is_none());
    }
    // Without a plan there is nothing to follow.
    let beyond =
        checked(include_str!("../../tests/data/machines/scara2.toml"), "G1 X900 F600\nM2\n", true);
    assert!(beyond.following.is_none() && !beyond.findings.is_empty());
}
