//! Tests of drives of every family in the loop: closed-form error bounds from the timing of their wires.

use crate::check::{CheckOptions, Outcome, check, wire_rates};
use crate::finding::{Rule, Severity, unfit};
use crate::limit::Limits;
use crate::peak::AxisPeak;
use crate::plant::Plant;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use crate::setpoint::{AxisSetpoint, HORIZON_NS};
use crate::simulated::Simulated;
use std::collections::VecDeque;
use std::path::Path;
use twin_kinematics::{AxisMotion, AxisVector};
use twin_machine::Machine;

/// Three linear axes of 320 increments per mm.
const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");

const CYCLE: f64 = 1e-3;

const VICE: &str = include_str!("../../machines/gantry3_vice.toml");

/// A machine on an InterpCNC board, in the loop.
fn on_board(text: &str) -> String {
    text.replace("kind = \"interpcnc\"", "kind = \"interpcnc\"\nin_loop = true")
}

/// The same on three `SmartDRIVE`s with these addresses.
fn on_bus(text: &str, addresses: [u8; 3]) -> String {
    let text = text.replace("kind = \"interpcnc\"", "kind = \"smartdrive\"\nin_loop = true");
    ["X", "Y", "Z"].into_iter().zip(addresses).fold(text, |text, (axis, address)| {
        text.replace(&format!("drive_axis = \"{axis}\""), &format!("drive_address = {address}"))
    })
}

/// The same with X and Y on a BIM2AX module, Z on a bus.
fn on_module(text: &str) -> String {
    let both = "name = \"bus\"\nkind = \"smartdrive\"\nin_loop = true\n\n[[drives]]\nname = \"board\"\n\
                kind = \"bim2ax\"\nin_loop = true";
    text.replace("name = \"board\"\nkind = \"interpcnc\"", both)
        .replace("drive_axis = \"X\"", "drive_axis = \"1\"")
        .replace("drive_axis = \"Y\"", "drive_axis = \"2\"")
        .replace("drive = \"board\"\ndrive_axis = \"Z\"", "drive = \"bus\"\ndrive_address = 1")
}

/// The gantry with drives of each family.
fn families() -> [String; 3] {
    [on_board(GANTRY3), on_bus(GANTRY3, [7, 2, 31]), on_module(GANTRY3)]
}

fn machine(text: &str) -> Machine {
    Machine::parse(Path::new("machine.toml"), text)
        .unwrap_or_else(|problems| panic!("{problems:#?}"))
}

/// Position, velocity and acceleration `time` s after the start of a move by `way` with `speed` and `rate`, from rest to
/// rest.
fn trapezoid(time: f64, way: f64, speed: f64, rate: f64) -> [f64; 3] {
    let up = speed / rate;
    let end = way / speed + up;
    let left = end - time;
    if time <= up {
        [0.5 * rate * time * time, rate * time, rate]
    } else if left >= up {
        [speed * (time - 0.5 * up), speed, 0.0]
    } else if left > 0.0 {
        [way - 0.5 * rate * left * left, rate * left, -rate]
    } else {
        [way, 0.0, 0.0]
    }
}

/// A move of X and Y by 60 and 30 mm, to half a second behind its end.
fn setpoints(machine: &Machine, speed: f64, rate: f64) -> VecDeque<AxisSetpoint> {
    let way = 0.06;
    let duration = way / speed + speed / rate + 0.5;
    let times = (0..).map(|cycle| cycle * machine.cycle_ns);
    let setpoint = |time_ns: i64| {
        let [position, velocity, acceleration] =
            trapezoid(twin_number::seconds(time_ns), way, speed, rate);
        let vector = |value: f64| AxisVector::from_values([value, 0.5 * value, 0.0]);
        let axes = AxisMotion {
            position: vector(position),
            velocity: vector(velocity),
            acceleration: vector(acceleration),
        };
        AxisSetpoint { path_velocity: velocity, ..crate::simulated::tests::setpoint(time_ns, axes) }
    };
    times.take_while(|time_ns| twin_number::seconds(*time_ns) <= duration).map(setpoint).collect()
}

/// Set-points of that move and the positions of the machine, cycle by cycle.
fn moved(text: &str, speed: f64, rate: f64) -> Vec<(AxisVector, AxisVector)> {
    let machine = machine(text);
    let mut setpoints = setpoints(&machine, speed, rate);
    let mut plant = Simulated::new(&machine, &setpoints[0].axes.position).unwrap();
    assert_eq!(plant.horizon_ns(), HORIZON_NS);
    let mut came = Vec::new();
    while let Some(setpoint) = setpoints.pop_front() {
        plant.command_before(&setpoint, &setpoints).unwrap();
        came.push((setpoint.axes.position, plant.feedback().unwrap().unwrap().position));
    }
    came
}

fn farthest(came: &[(AxisVector, AxisVector)], axis: usize) -> f64 {
    came.iter().map(|(wanted, found)| (wanted[axis] - found[axis]).abs()).fold(0.0, f64::max)
}

/// At rest the machine is at the count of the drive, within one increment and what dry friction leaves.
fn rests_where_it_should(came: &[(AxisVector, AxisVector)]) {
    let (wanted, found) = came[came.len() - 1];
    for axis in 0..3 {
        let apart = (wanted[axis] - found[axis]).abs();
        assert!(apart < 1.5 / 320e3, "axis {axis}: {apart}");
    }
}

/// An axis that is right at one command is wrong by less than the ramp makes of it in a round and a half. A round of an
/// InterpCNC board is three commands and a sample of 6.5 ms each; of three `SmartDRIVE`s an exchange of 2 ms, its bytes
/// (1.7 ms) and a millisecond each, and their speeds are whole turns per minute: 10 mm a turn.
#[test]
fn boards_and_buses_are_as_near_as_their_rounds_allow() {
    let (speed, rate) = (0.1, 1.0);
    let bus = 1.5 * 3.0 * (2e-3 + 1.8e-3 + 1e-3);
    for (text, round, rounding) in [
        (on_board(GANTRY3), 1.5 * 4.0 * 6.5e-3, 0.0),
        (on_bus(GANTRY3, [7, 2, 31]), bus, 0.010 / 60.0 * bus),
    ] {
        let came = moved(&text, speed, rate);
        let most = 0.5 * rate * round * round + 2e-4 + rounding;
        for axis in 0..2 {
            let error = farthest(&came, axis);
            assert!(error < most && error > 1e-6, "axis {axis}: {error}, {most}");
        }
        rests_where_it_should(&came);
    }
}

/// A module goes from point to point and stops in between, so that it is a part of a leg away at times: at constant speed at
/// least half of the plan's way during a stop (11 ms), and at most a leg of the whole horizon.
#[test]
fn bim2ax_modules_go_from_point_to_point() {
    let (speed, rate) = (0.1, 1.0);
    let came = moved(&on_module(GANTRY3), speed, rate);
    let error = farthest(&came, 0);
    assert!(error > 0.4 * speed * 11e-3, "{error}");
    assert!(error < speed * twin_number::seconds(HORIZON_NS), "{error}");
    // It stops several times on the way, with both axes on the line, except for increments and the lag of the servos.
    let stops = came.windows(2).filter(|pair| {
        let on_the_way = pair[0].0[0] > 0.01 && pair[1].0[0] < 0.05;
        let still = |axis: usize| (pair[1].1[axis] - pair[0].1[axis]).abs() < 0.02 * speed * CYCLE;
        on_the_way && still(0) && still(1)
    });
    let stops: Vec<_> = stops.map(|pair| pair[1].1).collect();
    assert!(stops.len() >= 3);
    for stop in stops {
        assert!((stop[0] - 2.0 * stop[1]).abs() < 2e-5, "{stop:?}");
    }
    rests_where_it_should(&came);
}

/// The same every time, and another motion for every family.
#[test]
fn the_loop_repeats_itself_bit_by_bit() {
    let mut others: Vec<Vec<u64>> = Vec::new();
    for text in families() {
        let bits = |came: Vec<(AxisVector, AxisVector)>| -> Vec<_> {
            let values = came.into_iter().flat_map(|(_, found)| [found[0], found[1], found[2]]);
            values.map(f64::to_bits).collect()
        };
        let (one, two) = (bits(moved(&text, 0.05, 1.0)), bits(moved(&text, 0.05, 1.0)));
        assert!(one == two && others.iter().all(|other| *other != one));
        others.push(one);
    }
}

/// A snapshot goes on with the same bits, commands on their way included.
#[test]
fn a_snapshot_goes_on_with_the_same_bits() {
    for text in families() {
        let machine = machine(&text);
        let mut ahead = setpoints(&machine, 0.05, 1.0);
        let mut plant = Simulated::new(&machine, &ahead[0].axes.position).unwrap();
        for _ in 0..497 {
            let setpoint = ahead.pop_front().unwrap();
            plant.command_before(&setpoint, &ahead).unwrap();
        }
        let mut other = plant.clone();
        let rest = |plant: &mut Simulated| -> Vec<_> {
            let mut ahead = ahead.clone();
            let mut bits = Vec::new();
            while let Some(setpoint) = ahead.pop_front() {
                plant.command_before(&setpoint, &ahead).unwrap();
                let found = plant.feedback().unwrap().unwrap().position;
                bits.extend(found.iter().map(|value| value.to_bits()));
            }
            bits
        };
        let (one, two) = (rest(&mut plant), rest(&mut other));
        assert!(one.len() > 1000 && one == two);
    }
}

fn checked(text: &str, program: &str) -> Outcome {
    checked_on(&machine(text), program)
}

fn checked_on(machine: &Machine, program: &str) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.ngc");
    std::fs::write(&path, program).unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Rs274), ReadSettings::default()).unwrap();
    let options =
        CheckOptions { limits: Limits::Programmed, physics: true, ..CheckOptions::default() };
    check(machine, &program, options, &mut |_| {}).unwrap()
}

/// Machines whose axes are not the coordinates: arms, rods, belts that two motors pull. Beyond the servo's error every axis is
/// off by at most what its acceleration makes of a round and a half and two increments, and by some of it.
#[test]
fn arms_rods_and_belts_are_as_near_as_their_rounds_allow() {
    let shipped = [
        include_str!("../../tests/data/machines/scara2.toml"),
        include_str!("../../tests/data/machines/tripod.toml"),
        include_str!("../../machines/gantry_h2.toml"),
    ];
    let program = "G91\nG1 X12 Y6 F3000\nG2 X8 Y8 I8 J0 F2400\nG1 X-20 Y-14 F3000\nM2\n";
    for text in shipped {
        let mut machine = machine(text);
        machine.conditions.rs274.acceleration = 1.0;
        machine.conditions.rs274.deceleration = 1.0;
        let ideal = checked_on(&machine, program);
        let name = &machine.name.clone();
        assert!(!unfit(&ideal.findings), "{name}: {:#?}", ideal.findings);
        let round = 1.0 / wire_rates(&machine)[0].1.samples_per_s;
        machine.put_drives_in_loop();
        let looped = checked_on(&machine, program);
        assert!(!unfit(&looped.findings), "{name}: {:#?}", looped.findings);
        let mut farther = 0;
        for (axis, (ideal, looped)) in
            machine.axes.iter().zip(ideal.peaks.iter().zip(&looped.peaks))
        {
            let error = |peak: &AxisPeak| peak.following_error.unwrap().value;
            let (ideal, looped, rate) = (error(ideal), error(looped), ideal.acceleration.value);
            let most = 0.5 * rate * (1.5 * round).powi(2) + 2.0 / axis.increments_per_si().abs();
            assert!(looped <= ideal + most, "{name} {}: {looped}, {ideal}, {most}", axis.name);
            farther += usize::from(looped > ideal + 0.02 * most);
        }
        assert!(farther >= 2, "{name}");
    }
}

/// A point-to-point module cannot follow an arc at 6 m/min within half a millimetre, a board can; the finding has the line.
#[test]
fn check_tells_which_drives_cannot_follow() {
    let program = "G0 X50 Y50\nG2 X50 Y50 I30 J0 F6000\nM2\n";
    let fine = checked(&on_board(GANTRY3), program);
    assert!(fine.findings.is_empty(), "{:#?}", fine.findings);
    let coarse = checked(&on_module(GANTRY3), program);
    let beyond: Vec<_> =
        coarse.findings.iter().filter(|one| one.rule == Rule::FollowingError).collect();
    assert!(beyond.iter().any(|one| one.line == 2), "{:#?}", coarse.findings);
}

/// Motion after the last planned set-point counts, too: the module is a leg behind when the plan ends in front of the jaw with
/// its switch.
#[test]
fn what_drives_do_behind_the_last_set_point_is_simulated() {
    let switch = "[axes.physics]\nswitches = { upper_mm = 79.9 }\n";
    let text = on_module(GANTRY3).replacen("[axes.physics]\n", switch, 1);
    let outcome = checked(&text, "G0 X10\nG1 X80 F6000\nM2\n");
    let hit = outcome.findings.iter().find(|one| one.rule == Rule::LimitSwitch);
    assert_eq!(hit.map(|hit| hit.line), Some(2), "{:#?}", outcome.findings);
}

/// Increments may also count down.
#[test]
fn reversed_drives_are_as_good() {
    for text in families() {
        let reversed = text.replacen("increments = 3200", "increments = -3200", 1);
        assert!(reversed != text);
        let (one, other) = (moved(&text, 0.05, 1.0), moved(&reversed, 0.05, 1.0));
        let [error, reversed] = [one, other].map(|came| farthest(&came, 0));
        // Registers round up, and so the other way.
        assert!((error - reversed).abs() < 0.3 * error + 2e-5, "{error}, {reversed}");
    }
}

/// Down on the stock, then against the front of the fixed jaw, off and away, at any feed: drives with a delay touch what the
/// plan touches, and do not collide.
#[test]
fn drives_in_the_loop_touch_what_the_plan_touches() {
    for text in [on_board(VICE), on_bus(VICE, [1, 2, 3]), on_module(VICE)] {
        for feed in [30, 60, 300, 1200] {
            let program = format!(
                "G0 Z30\nG0 X50 Y30\nG38.2 Z-20 F{feed}\nG0 Z30\nG0 Y-60\nG0 Z-20\nG38.2 Y10 F{feed}\nG91 G0 Y-5\nG90 G0 Z30\nM2\n"
            );
            let outcome = checked(&text, &program);
            let simulated: Vec<_> = outcome
                .findings
                .iter()
                .filter(|one| one.rule == Rule::Probe && one.message.contains("simulated"))
                .map(|one| (one.line, one.severity))
                .collect();
            let notes = [(3, Severity::Note), (7, Severity::Note)];
            assert_eq!(simulated, notes, "F{feed}: {:#?}", outcome.findings);
            assert!(outcome.findings.iter().all(|one| one.rule != Rule::Collision));
        }
    }
}

/// A jammed axis keeps the probe from its wall: the probe has missed it.
#[test]
fn a_probe_that_does_not_arrive_is_told() {
    // Three millimetres of steps are lost on the way.
    let faults = "[[faults]]\nkind = \"jam\"\naxis = \"Y\"\nat_line = 4\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.ngc");
    std::fs::write(&path, "G0 Z30\nG0 X50 Y-60\nG0 Z-20\nG38.2 Y10 F60\nM2\n").unwrap();
    let program = ProgramFile::new(&path, Some(Dialect::Rs274), ReadSettings::default()).unwrap();
    let machine = machine(VICE);
    let scenario = twin_machine::Scenario::parse(faults, &machine).unwrap();
    let options = CheckOptions {
        limits: Limits::Programmed,
        physics: true,
        scenario,
        ..CheckOptions::default()
    };
    let outcome = check(&machine, &program, options, &mut |_| {}).unwrap();
    let miss = outcome.findings.iter().find(|one| one.message.contains("does not touch")).unwrap();
    assert_eq!((miss.line, miss.rule, miss.severity), (4, Rule::Probe, Severity::Error));
    // From Y−60 to the jaw at Y−20 it is 37 mm with a tool of 6 mm; jammed at once it stays where it is.
    assert!((miss.value.unwrap() - 37.0).abs() < 0.2, "{miss:?}");
}
