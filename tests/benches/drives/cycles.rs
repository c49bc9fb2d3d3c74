//! Benchmark of cycle lateness: the delay from the due time of a cycle to its start.

use super::load::Load;
use super::machines::on_board;
use twin::check::{CheckOptions, check};
use twin::emulated::connect;
use twin::hardware::Hardware;
use twin::limit::Limits;
use twin::m_function::Acknowledge;
use twin::program::settings::ReadSettings;
use twin::program::{Dialect, ProgramFile};
use twin::session::{Answer, DriveSample, Observer, Punctuality, Session, TwinCycle};
use twin::simulated::Simulated;
use twin_machine::Machine;

/// Part of their largest velocity with which axes come to the start.
const APPROACH: f64 = 0.25;

/// Circles for about ten seconds.
const PROGRAM: &str = "% circles\n\
    N10 G1 X100 Y0 Z20 F100 E800 E-800\n\
    N20 G2 X140 Y0 Z24 R20\nN30 G2 X100 Y0 Z20 R20\nN40 G2 X140 Y0 Z24 R20\nN50 G2 X100 Y0 Z20 R20\n\
    N60 G2 X140 Y0 Z24 R20\nN70 G2 X100 Y0 Z20 R20\nN80 G2 X140 Y0 Z24 R20\nN90 G2 X100 Y0 Z20 R20\n\
    N100 G2 X140 Y0 Z24 R20\nN110 G2 X100 Y0 Z20 R20\nN120 G2 X140 Y0 Z24 R20\nN130 G2 X100 Y0 Z20 R20\n";

/// Watches nothing.
struct Nobody;

impl Observer for Nobody {
    fn twin(&mut self, _cycle: &TwinCycle<'_>) {}
    fn drives(&mut self, _sample: &DriveSample<'_>) {}
    fn m_function(&mut self, _call: &twin::m_function::MCall, _asked: bool) {}
    fn answer(&mut self) -> Answer {
        Answer::Nobody
    }
}

pub(crate) fn table() {
    println!(
        "{:44}{:>8}{:>10}{:>10}{:>10}",
        "cycles of 1 ms, late by µs", "cycles", "p50", "p99", "max"
    );
    // A thread that has become one of real time stays so: the ordinary ones first.
    for real_time in [false, true] {
        if real_time && twin::priority::real_time().is_err() {
            println!("this user may not have real-time threads");
            return;
        }
        for loaded in [false, true] {
            let thread = if real_time { "real-time thread" } else { "ordinary thread" };
            let computer = if loaded { "busy computer" } else { "idle computer" };
            // Load that is started by a real-time thread would be one, too.
            let load = loaded.then(|| ordinary(Load::start));
            let punctuality = run();
            drop(load);
            println!(
                "{:44}{:>8}{:>10}{:>10}{:>10}",
                format!("{thread}, {computer}"),
                punctuality.cycles(),
                punctuality.percentile_us(50.0),
                punctuality.percentile_us(99.0),
                punctuality.max_us()
            );
        }
    }
}

/// What `start` starts is as nice as any other program.
fn ordinary<T: Send>(start: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = scope.spawn(|| {
            twin::priority::ordinary().expect("any thread may be ordinary");
            start()
        });
        thread.join().expect("a thread that only starts others")
    })
}

/// Runs the program on the simulated machine and a board.
fn run() -> Punctuality {
    let machine: Machine = on_board();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("circles.cnc");
    std::fs::write(&path, PROGRAM).expect("a file in it");
    let program = ProgramFile::new(&path, Some(Dialect::Din66025), ReadSettings::default())
        .expect("a known dialect");
    let options = CheckOptions { limits: Limits::Programmed, ..CheckOptions::default() };
    let outcome = check(&machine, &program, options, &mut |_| {}).expect("a file");
    let start = outcome.start.expect("a program that moves");
    let connected = connect(&machine).expect("an emulated board");
    let (emulators, attached): (Vec<_>, Vec<_>) = connected.into_iter().unzip();
    let mut hardware = Hardware::start(&machine, attached, &start, machine.cycle_ns, APPROACH)
        .expect("a start within the counters");
    while !hardware.ready().expect("a board in order") {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let twin = Simulated::new(&machine, &start).expect("shipped with the product");
    let session = Session {
        machine: &machine,
        continues: None,
        program: &program,
        twin,
        hardware: Some(hardware),
        limits: Limits::Programmed,
        acknowledge: Acknowledge::Auto,
        overrides: &[],
        realtime: true,
    };
    let ending = session.run(&mut Nobody, &|| 0).expect("a file");
    if let Some(stopped) = &ending.stopped {
        println!("{stopped}");
    }
    drop(emulators);
    ending.punctuality.expect("a run in step with the wall clock")
}
