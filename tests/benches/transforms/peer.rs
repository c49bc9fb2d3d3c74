//! LinuxCNC's kinematics modules as peer: the same tool positions, with the modules compiled from unchanged sources.

use super::machines::{self, Placed, Visit, each};
use super::{PLACES, motions, positions, with_derivatives};
use criterion::Criterion;
use std::env;
use std::fmt::Write as _;
use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use twin_kinematics::transform::Transform;
use twin_kinematics::{Kinematics, KinematicsError};

/// Number of runs, of which the fastest counts: slower ones were disturbed.
const RUNS: usize = 40;
/// Passes over the table per run: short enough to be left alone on a busy machine now and then.
const PASSES: u32 = 20;

/// Positions per second that are wanted, in millions.
const TARGETS: [(&str, f64); 5] =
    [("Gantry3", 200.0), ("GantryH2", 200.0), ("Scara2", 20.0), ("Scara3", 15.0), ("Tripod", 30.0)];

/// A pass over a table.
type Pass = Box<dyn Fn() -> Result<(), KinematicsError>>;

/// One machine of ours.
struct Ours {
    name: &'static str,
    positions: Pass,
    with_derivatives: Pass,
    /// The fastest times of one call.
    times: [Duration; 2],
}

#[derive(Default)]
struct Collect(Vec<Ours>);

impl Visit for Collect {
    fn visit<T: Transform<N> + Kinematics, const N: usize>(
        &mut self,
        name: &'static str,
        placed: &Placed<T, N>,
    ) {
        let (machine, tools) = (placed.machine.clone(), placed.tools.clone());
        let pass = move || positions(black_box(&machine), black_box(&tools)).map(drop_value);
        let positions: Pass = Box::new(pass);
        let (machine, motions) = (placed.machine.clone(), motions(placed));
        let near = placed.axes.clone();
        let pass = move || {
            let found =
                with_derivatives(black_box(&machine), black_box(&motions), black_box(&near));
            found.map(drop_value)
        };
        let with_derivatives: Pass = Box::new(pass);
        self.0.push(Ours { name, positions, with_derivatives, times: [Duration::MAX; 2] });
    }
}

fn drop_value<T>(value: T) {
    black_box(value);
}

/// One module of LinuxCNC, with the tool positions of the machine of ours that is the same.
struct Peer {
    module: &'static str,
    like: &'static str,
    program: PathBuf,
    pins: Vec<String>,
    /// Lines of nine numbers.
    table: PathBuf,
    /// ns per call.
    time: f64,
}

/// Prints positions per second, what velocities and accelerations cost, and how the peer does.
pub fn compare(_: &mut Criterion) {
    if !env::args().any(|argument| argument == "--bench") {
        return; // cargo only tests that the benchmark can be run
    }
    let mut ours = Collect::default();
    each(PLACES, &mut ours);
    let Collect(mut ours) = ours;
    let folder = tempfile::tempdir().expect("a place for programs");
    let mut peers = peers(folder.path());
    for _ in 0..RUNS {
        // One after the other, so that all see the same machine.
        for machine in &mut ours {
            let [position, derivatives] = &mut machine.times;
            *position = (*position).min(timed(&machine.positions));
            *derivatives = (*derivatives).min(timed(&machine.with_derivatives));
        }
        for peer in &mut peers {
            peer.time = peer.time.min(peer.run());
        }
    }
    println!("Tool positions to axes, one core, the fastest of {RUNS} runs in turn:");
    for machine in &ours {
        let [position, derivatives] = machine.times.map(nanoseconds);
        let mut line = format!(
            "  {:17}{:7.2} ns, {:6.1} million/s; with derivatives {:7.2} ns, {:.2} times that",
            machine.name,
            position,
            1e3 / position,
            derivatives,
            derivatives / position
        );
        if let Some((_, target)) = TARGETS.iter().find(|(name, _)| *name == machine.name) {
            write!(line, "; wanted {target} million/s and 3 times").expect("a text");
        }
        println!("{line}");
        for peer in peers.iter().filter(|peer| peer.like == machine.name) {
            println!(
                "    peer, {}: {:.2} ns, {:.1} million/s; ours is {:.1} times as fast",
                peer.module,
                peer.time,
                1e3 / peer.time,
                peer.time / position
            );
        }
    }
}

/// Of one call.
fn nanoseconds(pass: Duration) -> f64 {
    let calls = f64::from(PASSES) * f64::from(u32::try_from(PLACES).expect("a small table"));
    pass.as_secs_f64() * 1e9 / calls
}

#[expect(clippy::disallowed_methods, reason = "a benchmark is about time")]
fn timed(pass: &Pass) -> Duration {
    let start = Instant::now();
    for _ in 0..PASSES {
        pass().expect("within reach");
    }
    start.elapsed()
}

/// Those that can be compiled.
fn peers(folder: &Path) -> Vec<Peer> {
    let Some(source) = env::var_os("LINUXCNC_SRC").map(PathBuf::from) else {
        println!(
            "peer, LinuxCNC's kinematics: skipped, LINUXCNC_SRC (the top of its sources) is not set"
        );
        return Vec::new();
    };
    let radius = {
        let dimensions = machines::DELTA;
        let half = 0.5 * dimensions.rod_distance;
        let middle = |radius: f64| (radius * radius - half * half).sqrt();
        middle(dimensions.outer_radius) - middle(dimensions.inner_radius)
    };
    let scara = |d6: f64| vec![0.0, 340.0, 0.0, 250.0, 0.0, d6];
    let two = machines::scara2(PLACES);
    let three = machines::scara3(PLACES);
    let line = |x: f64, y: f64, z: f64, c: f64| {
        let c = c.to_degrees();
        format!("{:?} {:?} {:?} 0 0 {c:?} 0 0 0\n", x * 1e3, y * 1e3, z * 1e3)
    };
    let belt = machines::gantry_h2(PLACES);
    // LinuxCNC's towers are turned by 60° against ours, which costs neither of them anything.
    let delta = machines::tripod(PLACES);
    let tables: [(&str, &str, Vec<f64>, String); 4] = [
        (
            "corexykins",
            "GantryH2",
            vec![],
            belt.tools.iter().map(|p| line(p.x, p.y, 0.0, 0.0)).collect(),
        ),
        (
            "scarakins",
            "Scara2",
            scara(0.0),
            two.tools.iter().map(|p| line(p.x, p.y, 0.0, 0.0)).collect(),
        ),
        (
            "scarakins",
            "Scara3",
            scara(50.0),
            three.tools.iter().map(|p| line(p.x, p.y, 0.0, p.z)).collect(),
        ),
        (
            "lineardeltakins",
            "Tripod",
            vec![radius * 1e3, machines::DELTA.rod_length * 1e3],
            delta.tools.iter().map(|p| line(p.x, p.y, p.z, 0.0)).collect(),
        ),
    ];
    let peers = tables.into_iter().filter_map(|(module, like, pins, text)| {
        let program = compiled(&source, folder, module)?;
        let table = folder.join(like);
        fs::write(&table, text).expect("a place for tool positions");
        let pins = pins.into_iter().map(|pin| format!("{pin:?}")).collect();
        Some(Peer { module, like, program, pins, table, time: f64::INFINITY })
    });
    peers.collect()
}

/// The program `tests/peers/linuxcnc_kins.c` with a module of LinuxCNC in it; none if it does not compile.
fn compiled(source: &Path, folder: &Path, module: &str) -> Option<PathBuf> {
    let program = folder.join(module);
    let mut command = Command::new(env::var_os("CC").unwrap_or("cc".into()));
    command.args(["-O2", "-DRTAPI", "-DUSPACE"]).arg(format!("-DKINS=\"{module}.c\""));
    if module == "scarakins" {
        command.arg("-DSWITCHABLE");
    }
    for part in ["emc/kinematics", "rtapi", "hal", "emc/nml_intf", "libposemath"] {
        command.arg("-I").arg(source.join("src").join(part));
    }
    let ours = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/peers/linuxcnc_kins.c");
    command.arg(ours).arg("-o").arg(&program).arg("-lm");
    match command.status() {
        Ok(status) if status.success() => Some(program),
        Ok(status) => {
            println!("peer, {module}: skipped, the compiler ends with {status}");
            None
        }
        Err(error) => {
            println!("peer, {module}: skipped, no compiler: {error}");
            None
        }
    }
}

impl Peer {
    /// ns per call, as it measures itself.
    fn run(&self) -> f64 {
        let table = fs::File::open(&self.table).expect("the tool positions");
        let mut command = Command::new(&self.program);
        command.args(["time-inverse", "0"]).args(&self.pins).stdin(Stdio::from(table));
        let output = command.output().expect("the peer runs");
        let text = String::from_utf8_lossy(&output.stdout);
        text.trim().parse().expect("the peer says how long it takes")
    }
}
