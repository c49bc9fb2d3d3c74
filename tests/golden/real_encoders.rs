//! Runs whose axes have encoders, declared in the machine file: a held shaft stops all axes.

use crate::desk::{Desk, comes};
use crate::real::alone;
use crate::shop::{SHORT, Shop, a_board, clock, mixture};
use twin_bim2ax::{EncoderBench, ModuleAxis, emulator as module};
use twin_drives::Control;
use twin_interpcnc::{BoardAxis, emulator as board};

/// Four points a step of X, as the machine file of [`declared`] has it.
const LINK: board::EncoderLink =
    board::EncoderLink { axis: BoardAxis::X, counts: 4, steps: 1, counts_per_revolution: 0 };
const OF_BOARD: &str =
    "[drives.encoder]\naxis = \"X\"\npoints = 4\nper_increments = 1\ntolerance_increments = 64\n";
/// 3200 µsteps a turn by 200 steps of 16.
const OF_MODULE: &str = "[drives.encoder]\naxes = [1]\npoints_per_turn = 4000\n";

/// The machine file of the shop with a section at the end of a device's.
fn declared(desk: &Desk, port: &str, section: &str) {
    let text = mixture(desk);
    let key = format!("port = \"{port}\"\nanswer_deadline_ms = 2000\n");
    let key = if text.contains(&key) { key } else { panic!("{text}") };
    desk.write("mixture.toml", &text.replace(&key, &format!("{key}\n{section}\n")));
}

fn encoder_on_x(shop: &Shop) {
    let bench = board::Bench { encoder: Some(LINK), ..board::Bench::default() };
    shop.board.control(Control::Event(board::Event::Bench(bench))).expect("it runs");
}

/// X of the board is held, and all axes of all devices stop.
#[test]
fn a_held_shaft_of_a_board_stops_the_run() {
    let shop = Shop::new();
    declared(&shop.desk, "board", OF_BOARD);
    encoder_on_x(&shop);
    shop.homed("short.cnc", "").ended(0, "");
    let done = shop.disturbed("-CONT", |_| {
        let held = board::Event::Stall(BoardAxis::X, true);
        shop.board.control(Control::Event(held)).expect("it runs");
        comes(|| shop.board.look().expect("it runs").velocity(BoardAxis::Y).abs() < f64::EPSILON);
    });
    done.ended(2, "the drives failed at line 2 (N10): device `board`, axis X: board, address 1: ");
    done.ended(2, "").reports(&[
        " steps by its counter and at ",
        " steps by its encoder (",
        "they may be 64 steps apart",
        "Where it is is not known any more",
    ]);
    let [_, _, z, u] = shop.at_rest().map(|found| found.expect("it is there"));
    assert!(u > 0.5 && u < 59.0 && z > 0.5 && z < 59.0, "{z} {u}");
}

/// The module is not set for its encoder: the start-up says how, and holds it against the machine file. Then it tells a held shaft.
#[test]
fn a_held_shaft_of_a_module_stops_the_run_and_its_encoder_is_checked_before() {
    let shop = Shop::new();
    declared(&shop.desk, "module", OF_MODULE);
    {
        let mut module = shop.module.module();
        let mut surroundings = *module.surroundings();
        surroundings.encoders[0] = Some(EncoderBench {
            points_per_turn: 4000,
            microsteps_per_turn: 3200,
            ..EncoderBench::default()
        });
        module.set_surroundings(&surroundings);
    }
    let done = shop.homed("short.cnc", "");
    done.ended(2, "").reports(&[
        "(encoder-definition-1) is 0; a number with the bits 0001h is wanted",
        "set it: twin drive bim2ax --port module --deadline 2000 set encoder-definition-1 1",
        "(divisor-1) is 2000; 4000 is wanted",
        "or `points_per_turn = 2000` of [drives.encoder] of \"module\" in mixture.toml",
        "start-up checks have failed: nothing has moved",
    ]);
    shop.copy_commands(&done);
    shop.by_hand("bim2ax", "module", "unlock 1");
    shop.homed("short.cnc", "").ended(0, "");
    let held = |on| Control::Event(module::Event::Stall(ModuleAxis::One, on));
    shop.disturbed("-CONT", |_| {
        shop.module.control(held(true));
        comes(|| shop.board.look().expect("it runs").velocity(BoardAxis::X).abs() < f64::EPSILON);
    })
    .ended(2, "the drives failed at line 2 (N10): device `module`, axis U: module: ")
    .ended(2, " µsteps by its encoder");
    // Where it is is not known, whatever the module says of its home.
    shop.module.control(held(false));
    shop.run("short.cnc", "--homed --yes").ended(2, "axis U: not homed");
    shop.homed("short.cnc", "").ended(0, "axis U is home");
    shop.at_rest();
}

#[test]
fn a_board_without_an_encoder_is_refused_where_one_is_declared() {
    let desk = Desk::new();
    alone(&desk, "interpcnc", &[]);
    let text = desk.text("mixture.toml");
    let key = "answer_deadline_ms = 2000\n";
    assert!(text.contains(key));
    desk.write("mixture.toml", &text.replace(key, &format!("{key}\n{OF_BOARD}\n")));
    let options = board::EmulatorOptions {
        link: Some(desk.path("device")),
        board: board::BoardOptions { counts: false, ..board::BoardOptions::default() },
        ..board::EmulatorOptions::default()
    };
    let running = board::EmulatedBoard::start(&options, clock()).expect("it starts");
    let unlock = "drive interpcnc --port device --deadline 2000 unlock";
    desk.twin(unlock).ended(0, "");
    let run = Shop::real("short.cnc", "--homed --yes");
    desk.twin(&run)
        .ended(2, "✗ device `board`: device, address 1: reading encoder position")
        .ended(2, "the device has no encoder: boards have one from V2.1D on");
    running.stop().expect("it runs");
    // The same board from V2.1D on, whose encoder is on no shaft, shows at once that nothing turns it.
    let running = a_board(&desk.path("device"));
    desk.twin(unlock).ended(0, "");
    desk.twin(&run).ended(2, " steps by its encoder (0 points)");
    running.stop().expect("it runs");
}

/// Emulated drives have the encoders that the machine file declares, on shafts that follow.
#[test]
fn emulated_drives_have_the_encoders_of_the_machine_file() {
    let desk = Desk::new();
    let text = mixture(&desk);
    let module = "port = \"module\"\nanswer_deadline_ms = 2000\n";
    let board = "port = \"board\"\nanswer_deadline_ms = 2000\n";
    assert!(text.contains(module) && text.contains(board));
    let down = OF_BOARD.replace("points = 4", "points = -4");
    let text = text
        .replace(module, &format!("{module}\n{OF_MODULE}\n"))
        .replace(board, &format!("{board}\n{down}\n"));
    desk.write("mixture.toml", &text);
    desk.write("short.cnc", SHORT);
    let run = "run short.cnc -m mixture.toml --report run.json";
    desk.twin(run).ended(0, "");
    assert_eq!(desk.read("run.json")["completed"], true);
    let said = desk.twin("machine mixture.toml");
    said.ended(0, "");
    said.says_all(&[
        "encoder on axis X: -4 points for 1 increments, 64 apart at most",
        "encoder on axis 1: 4000 points for 3200 increments",
    ]);
    desk.twin("machine mixture.toml --format json").ended(0, "");
}
