//! Workshop fixture: three emulated devices as the real ones, commissioned for one machine with axes on all of them.

use crate::desk::{Desk, Done, comes};
use std::cell::RefCell;
use std::path::Path;
use twin::clock::Clock;
use twin_bim2ax::emulator as module;
use twin_bim2ax::{Contact, ModuleAxis};
use twin_interpcnc::BoardAxis;
use twin_interpcnc::emulator as board;
use twin_smartdrive::emulator as bus;

pub(crate) fn clock() -> impl Fn() -> i64 + Send + Sync {
    let clock = Clock::start();
    move || clock.now_ns()
}

/// There and back, 0.7 s. All axes are at 0 where it begins.
pub(crate) const SHORT: &str =
    "% short\nN10 G1 X10 Y5 Z-35 U8 F50 E500 E-500\nN20 G1 X0 Y0 Z-40 U0\n";
/// Half a minute.
pub(crate) const LONG: &str =
    "% long\nN10 G1 X200 Y100 Z20 U60 F15 E300 E-300\nN20 G1 X0 Y0 Z-40 U0\n";

/// X and Y on a board, Z on a bus, U on a module; all of them have plenty of time to answer beside other tests.
pub(crate) fn mixture(desk: &Desk) -> String {
    let text = desk.text("machine.toml");
    let devices = "name = \"board\"\nkind = \"interpcnc\"\nport = \"board\"\nanswer_deadline_ms = 2000\n\n\
                   [[drives]]\nname = \"bus\"\nkind = \"smartdrive\"\nport = \"bus\"\nanswer_deadline_ms = 2000\n\
                   firmware = \"1.2.0\"\n\n\
                   [[drives]]\nname = \"module\"\nkind = \"bim2ax\"\nport = \"module\"\nanswer_deadline_ms = 2000";
    let u = "\n[[axes]]\nname = \"U\"\nkind = \"linear\"\nposition_min_mm = -100.0\nposition_max_mm = 100.0\n\
             max_velocity_mm_per_s = 100.0\nmax_acceleration_mm_per_s2 = 1000.0\ndrive = \"module\"\n\
             drive_axis = \"1\"\nincrements = 3200\nper_mm = 10.0\n";
    let old = "name = \"board\"\nkind = \"interpcnc\"\nport = \"/dev/ttyUSB0\"";
    let of_z = "drive = \"board\"\ndrive_axis = \"Z\"";
    assert!(text.contains(old) && text.contains(of_z));
    // A computer that is busy lets axes fall behind.
    let text = text.replace("max_following_error_mm = 0.5", "max_following_error_mm = 100.0");
    text.replace(old, devices).replace(of_z, "drive = \"bus\"\ndrive_address = 1") + u
}

/// Three devices that somebody has commissioned for the mixture, and its machine file.
pub(crate) struct Shop {
    pub(crate) desk: Desk,
    pub(crate) board: board::EmulatedBoard,
    pub(crate) bus: RefCell<Option<bus::EmulatedBus>>,
    pub(crate) module: module::EmulatedModule,
}

/// Settings that `twin drive` makes on a drive of the bus and on a module.
pub(crate) const BUS: [&str; 5] = [
    "Trj_VelMax 2880",
    "Trj_AccMax 30000",
    "Trj_DecMax 30000",
    "Trj_PosMin -38400",
    "Trj_PosMax 76800",
];
pub(crate) const MODULE: [&str; 4] = [
    "acceleration-1 65535",
    "fast-speed-1 2400",
    "soft-limit-plus-1 32001",
    "soft-limit-minus-1 -32001",
];

/// A module restarts faster than a real one, and slowly enough to be seen to.
pub(crate) const QUICK_BOOT_NS: i64 = 200_000_000;

/// A module whose software runs.
pub(crate) fn started(options: &module::EmulatorOptions) -> module::EmulatedModule {
    let running = module::EmulatedModule::start(options, clock()).expect("it starts");
    comes(|| running.module().watchdog());
    running
}

pub(crate) fn a_board(link: &Path) -> board::EmulatedBoard {
    let options =
        board::EmulatorOptions { link: Some(link.to_owned()), ..board::EmulatorOptions::default() };
    board::EmulatedBoard::start(&options, clock()).expect("it starts")
}

pub(crate) fn a_bus(link: &Path) -> bus::EmulatedBus {
    let devices = vec![bus::DeviceOptions::default()];
    let link = Some(link.to_owned());
    let options = bus::EmulatorOptions { devices, link, ..bus::EmulatorOptions::default() };
    bus::EmulatedBus::start(&options, clock()).expect("it starts")
}

/// Its cam is 400 to 900 µsteps behind the start.
pub(crate) fn a_module(path: &Path) -> module::EmulatedModule {
    let mut options = module::EmulatorOptions::new(path);
    options.module.boot_ns = QUICK_BOOT_NS;
    // Where a module corrects a move in time, the counter of a held shaft is right again.
    options.module.corrections.most = 0;
    for bench in &mut options.surroundings.benches {
        bench.cam = Some(Contact::between(-900, -400, true));
    }
    started(&options)
}

/// The firmware of drives starts within 300 ms: until then nobody answers.
pub(crate) fn listens(desk: &Desk, port: &str) {
    let status = format!("drive smartdrive --port {port} --deadline 300 status");
    assert!((0..50).any(|_| desk.twin(&status).status == Some(0)), "nobody answers");
}

impl Shop {
    pub(crate) fn new() -> Self {
        let desk = Desk::new();
        desk.write("mixture.toml", &mixture(&desk));
        desk.write("short.cnc", SHORT);
        desk.write("long.cnc", LONG);
        let board = a_board(&desk.path("board"));
        let bus = RefCell::new(Some(a_bus(&desk.path("bus"))));
        let module = a_module(&desk.path("module"));
        let shop = Self { desk, board, bus, module };
        shop.by_hand("interpcnc", "board", "unlock");
        listens(&shop.desk, "bus");
        shop.commission_bus();
        for set in MODULE {
            shop.by_hand("bim2ax", "module", &format!("set {set}"));
        }
        shop.by_hand("bim2ax", "module", "reset");
        shop.by_hand("bim2ax", "module", "unlock 1");
        shop
    }

    /// Waits until the program has X on its way.
    pub(crate) fn under_way(&self) {
        comes(|| self.board.look().expect("it runs").position(BoardAxis::X) > 5.0 * 320.0);
    }

    /// X's home switch, at IN5, closes where it is so many increments behind where it was switched on, and beyond.
    pub(crate) fn press_home_behind(&self, position: i32) {
        let axis = BoardAxis::X;
        let cam =
            board::Cam { input: 5, axis, from: i32::MIN, to: position, normally_closed: false };
        let bench = board::Bench { cams: vec![cam], ..board::Bench::default() };
        self.board.control(board::Control::Event(board::Event::Bench(bench))).expect("it runs");
    }

    /// A cam that is never reached.
    pub(crate) fn hide_the_cam(&self) {
        let mut module = self.module.module();
        let mut surroundings = *module.surroundings();
        for bench in &mut surroundings.benches {
            bench.cam = Some(Contact::between(-4_000_000, -3_900_000, true));
        }
        module.set_surroundings(&surroundings);
    }

    pub(crate) fn commission_bus(&self) {
        for set in BUS {
            self.by_hand("smartdrive", "bus", &format!("set {set}"));
        }
        self.by_hand("smartdrive", "bus", "unlock");
    }

    /// Carries out every command of the start-up checks that sets something.
    #[track_caller]
    pub(crate) fn copy_commands(&self, done: &Done) {
        let said = ["set it: twin ", "then:   twin "];
        let commands = done.stderr.lines().filter_map(|line| {
            said.iter()
                .find_map(|start| line.trim().strip_prefix(start))
                .map(|rest| rest.split("   (").next().unwrap_or(rest))
        });
        let commands: Vec<_> = commands.collect();
        assert!(commands.len() >= 3, "{}", done.stderr);
        for command in commands {
            self.desk.twin(command).ended(0, "");
        }
    }

    #[track_caller]
    pub(crate) fn by_hand(&self, family: &str, port: &str, action: &str) {
        let drive = format!("drive {family} --port {port} --deadline 2000");
        self.desk.twin(&format!("{drive} {action}")).ended(0, "");
    }

    /// The command line `twin run PROGRAM --drives real …`.
    pub(crate) fn real(program: &str, more: &str) -> String {
        format!("run {program} -m mixture.toml --drives real {more}")
    }

    /// A run of the long program, disturbed by `act` as soon as X is on its way, and ended by `signal` after that.
    pub(crate) fn disturbed(&self, signal: &str, act: impl FnOnce(&str)) -> Done {
        let run = Self::real("long.cnc", "--homed --home=U --yes --report run.json");
        self.desk.meanwhile_of(signal, "axis U is home", &run, |process| {
            self.under_way();
            act(process);
        })
    }

    /// Waits until the axes of board and module are at rest.
    pub(crate) fn others_come_to_rest(&self) {
        comes(|| {
            let still = self.module.module().velocity(ModuleAxis::One).abs() < f64::EPSILON;
            still && self.board.look().expect("it runs").status().moving().is_empty()
        });
    }

    pub(crate) fn run(&self, program: &str, more: &str) -> Done {
        self.desk.twin(&Self::real(program, more))
    }

    /// Homed by hand, but for the module, which has to be homed in any case.
    pub(crate) fn homed(&self, program: &str, more: &str) -> Done {
        self.run(program, &format!("--homed --home=U --yes {more}"))
    }

    /// Ends all devices; where their axes stand, in mm, and that they rest.
    #[track_caller]
    pub(crate) fn at_rest(self) -> [Option<f64>; 4] {
        let u = {
            let module = self.module.module();
            assert!(module.velocity(ModuleAxis::One).abs() < f64::EPSILON, "U moves");
            module.position(ModuleAxis::One) / 320.0
        };
        let board = self.board.stop().expect("it runs");
        assert!(board.status().moving().is_empty(), "the board moves");
        let [x, y] = [BoardAxis::X, BoardAxis::Y].map(|axis| board.position(axis) / 320.0);
        let z = self.bus.into_inner().map(|bus| {
            let devices = bus.stop().expect("it runs");
            assert!(devices[0].motion().1.abs() < f64::EPSILON, "Z moves");
            f64::from(devices[0].counter()) / 640.0
        });
        [Some(x), Some(y), z, Some(u)]
    }

    /// Nothing has moved.
    #[track_caller]
    pub(crate) fn untouched(self) {
        assert_eq!(self.at_rest(), [Some(0.0), Some(0.0), Some(0.0), Some(0.0)]);
    }
}
