//! Benchmark of the wires: commands and samples per second, compared with what the wires can carry.

use super::machines::{on_board, on_bus, on_module};
use twin::clock::Clock;
use twin::emulated::connect;
use twin::setpoint::HORIZON_NS;
use twin_bim2ax::SharedModule;
use twin_drives::family::Emulator;
use twin_drives::{IncrementMotion, MAX_DRIVE_AXES, SetpointStream};
use twin_interpcnc::emulator::EmulatedBoard;
use twin_machine::Machine;
use twin_smartdrive::emulator::EmulatedBus;

/// Duration of the followed motion, s.
const FOLLOWED: f64 = 10.0;
/// Increments; of the shipped gantry 10 to 20 mm.
const AMPLITUDE: f64 = 6400.0;
/// Angular frequency of the motion, rad/s: at most 64 mm/s and 205 mm/s².
const OMEGA: f64 = 3.2;

/// 8N1 at 115200 baud, s per byte.
const BYTE: f64 = 10.0 / 115_200.0;
/// Between two frames of Modbus RTU at that speed, s; on either side of a request.
const SILENCE: f64 = 1.75e-3;
/// Time a device takes to answer, s: the machine files' default.
const TURNAROUND: f64 = 2e-3;
/// An order to a BIM2AX is taken after at most so long, s (manual 3.3).
const ORDER: f64 = 10e-3;
/// Zones of a BIM2AX are looked at so often, 1/s.
const LOOKS: f64 = 200.0;

/// Exchange of a Modbus request and its answer with the sum of their bytes, s.
fn modbus(bytes: f64) -> f64 {
    bytes * BYTE + 2.0 * SILENCE + TURNAROUND
}

/// Exchange of an ATB command and its answer, s.
fn atb(bytes: f64, turnaround: f64) -> f64 {
    bytes * BYTE + turnaround
}

/// Circles in all axes.
struct Circles(Clock);

impl SetpointStream for Circles {
    fn now_ns(&self) -> i64 {
        self.0.now_ns()
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let time = 1e-9 * time_ns.max(0) as f64;
        let mut motion = IncrementMotion::default();
        for (axis, (position, velocity)) in
            motion.position.iter_mut().zip(&mut motion.velocity).enumerate()
        {
            let phase = axis as f64;
            *position = AMPLITUDE * ((OMEGA * time + phase).sin() - phase.sin());
            *velocity = AMPLITUDE * OMEGA * (OMEGA * time + phase).cos();
        }
        motion
    }

    fn horizon_ns(&self) -> i64 {
        HORIZON_NS
    }
}

/// What was counted.
struct Counts {
    seconds: f64,
    samples: f64,
    /// Exchanges on the wire.
    exchanges: f64,
    /// Largest deviation from the plan at a sample, increments.
    deviation: f64,
}

pub(crate) fn table() {
    println!(
        "{:34}{:>10}{:>10}{:>12}{:>10}{:>12}",
        "following for 10 s", "commands", "samples", "commands/s", "samples/s", "of the wire"
    );
    // Command 80 and the state of five axes.
    let (command, sample) = (modbus(27.0 + 8.0), modbus(8.0 + 29.0));
    let counts = measure(&on_board());
    let commands = counts.exchanges - counts.samples;
    let used = commands * command + counts.samples * sample;
    print("InterpCNC, three axes", &counts, commands, used / counts.seconds);

    for turnaround in [2e-3, 20e-3, 50e-3] {
        let counts = measure(&on_bus(1e3 * turnaround));
        // GOTO with speed and acceleration. Every answer is a sample of its drive.
        let used = counts.exchanges * atb(11.0 + 9.0, turnaround);
        let name = format!("SmartDRIVE, three axes, {:.0} ms", 1e3 * turnaround);
        print(&name, &counts, counts.exchanges, used / counts.seconds);
    }

    let counts = measure(&on_module());
    // Every look is one interrupt, every order another, and while it is taken nothing is seen of the axes.
    let orders = counts.exchanges - counts.samples;
    let used = counts.samples / LOOKS + orders * ORDER;
    print("BIM2AX, two axes", &counts, orders, used / counts.seconds);
}

fn print(name: &str, counts: &Counts, commands: f64, of_the_wire: f64) {
    println!(
        "{name:34}{commands:>10}{:>10}{:>12.1}{:>10.1}{:>10.1} %   at most {:.0} increments off",
        counts.samples,
        commands / counts.seconds,
        counts.samples / counts.seconds,
        100.0 * of_the_wire,
        counts.deviation,
    );
}

/// What is exchanged while the device follows, without what is exchanged before.
fn measure(machine: &Machine) -> Counts {
    let before = follow(machine, 0.0);
    let mut counts = follow(machine, FOLLOWED);
    counts.exchanges -= before.exchanges;
    counts
}

fn follow(machine: &Machine, seconds: f64) -> Counts {
    let mut connected = connect(machine).expect("an emulated device");
    // The first of the machine file.
    let (emulator, attached) = connected.swap_remove(0);
    let mut drive = attached.drive;
    let before = Circles(Clock::in_future(std::time::Duration::from_hours(1)));
    drive.probe(&before).expect("a device in order");
    drive.enable().expect("a device in order");
    drive.set_position(&[0; MAX_DRIVE_AXES]).expect("axes at rest");
    let mut counts = Counts { seconds: 0.0, samples: 0.0, exchanges: 0.0, deviation: 0.0 };
    let stream = Circles(Clock::start());
    while counts.seconds < seconds {
        let sample = drive.follow(&stream).expect("a device in order");
        counts.samples += 1.0;
        counts.seconds = 1e-9 * stream.now_ns() as f64;
        let planned = stream.at(sample.time_ns).position;
        let deviations = sample.position.iter().zip(planned).take(drive.axis_count());
        let deviations = deviations.map(|(found, planned)| (*found as f64 - planned).abs());
        counts.deviation = deviations.fold(counts.deviation, f64::max);
    }
    counts.exchanges = exchanges(&*emulator);
    drop(drive);
    counts
}

/// Requests that the device has handled; of a module, its interrupts.
fn exchanges(emulator: &dyn Emulator) -> f64 {
    let handled = if let Some(board) = emulator.of::<EmulatedBoard>() {
        board.look().expect("a board").frames_handled()
    } else if let Some(bus) = emulator.of::<EmulatedBus>() {
        let devices = bus.look().expect("a bus");
        devices.iter().map(twin_smartdrive::emulator::Device::frames_handled).sum()
    } else {
        emulator.of::<SharedModule>().expect("a module").module().served()
    };
    handled as f64
}
