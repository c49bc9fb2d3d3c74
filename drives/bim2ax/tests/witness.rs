//! The second reading of the manual, in Python, against emulator and driver. Without Python there is no witness, which
//! is said.

use std::path::Path;

use super::*;
use crate::Fault;
use crate::tests::common::fault_of;
use crate::tests::{common::wall_clock, peer::Peer};
use crate::{
    EncoderBench, EncoderKind, MemoryFile,
    emulator::{EmulatedModule, EmulatorOptions, Event},
    protocol::bits::{card, encoder_message, message, uc},
};
use twin_drives::{DriveError, Speed};

/// Parts of the manual that the host goes through, as it names them.
const PARTS: [&str; 13] = [
    "handshakes",
    "parameters",
    "manual_moves",
    "homing",
    "programmed",
    "approach",
    "stops",
    "refusals",
    "limits",
    "motors",
    "plugs",
    "encoders",
    "checksum",
];

/// The other reading as `face` at a memory file.
fn witness(face: &str, path: &Path) -> Option<Peer> {
    Some(Peer::start(Peer::reference("tests/reference")?.arg(face).arg(path)))
}

/// Does at the module what the host wants done; false if that is nothing known.
fn happens(module: &mut Module, wish: &str) -> bool {
    let mut words = wish.split(' ');
    let (what, axis, how) = (words.next(), words.next(), words.next().unwrap_or_default());
    let axis = if axis == Some("2") { ModuleAxis::Two } else { ModuleAxis::One };
    let mut around = *module.surroundings();
    let encoder = &mut around.encoders[axis.index()];
    let kind = |kind| Some(EncoderBench { kind: Some(kind), origin: 12_345, ..<_>::default() });
    match (what, how) {
        (Some("power"), how) => module.happen(Event::Power(axis, how == "on")),
        (Some("open"), how) => module.happen(Event::PhaseOpen(axis, how == "on")),
        (Some("short"), how) => module.happen(Event::PhaseShort(axis, how == "on")),
        (Some("checksum"), _) => module.happen(Event::SpoilEeprom),
        (Some("plug"), number) => {
            around.plugs[axis.index()] = Some(u32::from_str_radix(number, 16).unwrap());
            module.set_surroundings(&around);
        }
        (Some("encoder"), how) => {
            match how {
                "none" => *encoder = None,
                "incremental" => *encoder = kind(EncoderKind::Incremental),
                "ssi" => *encoder = kind(EncoderKind::Ssi),
                "endat" => *encoder = kind(EncoderKind::EnDat),
                "reversed" => encoder.as_mut().unwrap().inverted = true,
                "lost" => encoder.as_mut().unwrap().disconnected = true,
                "alarm" => encoder.as_mut().unwrap().alarm = true,
                _ => return false,
            }
            module.set_surroundings(&around);
        }
        _ => return false,
    }
    true
}

#[test]
fn another_host_finds_everything_in_the_emulated_module_as_it_reads_the_manual() {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("eeprom");
    std::fs::write(&image, eeprom().to_bytes()).unwrap();
    let mut options = EmulatorOptions::new(&folder.path().join("module"));
    options.eeprom = Some(image);
    options.surroundings = surroundings();
    options.speed = Speed::times(4);
    let module = EmulatedModule::start(&options, wall_clock()).unwrap();
    let Some(mut host) = witness("host", module.path()) else { return };
    let mut passed = Vec::new();
    loop {
        let wish = host.line();
        if wish.is_empty() {
            break;
        }
        match wish.strip_prefix("passed ") {
            Some(part) => passed.push(part.to_owned()),
            None => assert!(happens(&mut module.module(), &wish), "{wish}"),
        }
        host.say("done");
    }
    host.end();
    assert_eq!(passed, PARTS);
}

#[tokio::test]
async fn the_driver_has_everything_done_by_another_module() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("module");
    std::fs::write(&path, [0; twin_drives::port::FILE_LENGTH]).unwrap();
    let Some(mut other) = witness("module", &path) else { return };
    assert_eq!(other.line(), "ready");

    let options = Bim2AxOptions {
        deadline: seconds(5),
        reset_start: seconds(5),
        reset_deadline: seconds(20),
        ..Bim2AxOptions::default()
    };
    let memory = MemoryFile::open(&path).unwrap();
    let mut driver = Bim2Ax::new("other", memory, &options);
    let clock = &wall_clock();
    driver.reset().await.unwrap();
    let identity = driver.identify(clock).await.unwrap();
    assert_eq!((identity.rating_ma, identity.version), (5000, 17));
    assert_eq!(identity.card_messages, card::AXIS_1 | card::AXIS_2);

    parameters(&mut driver, clock).await;
    moves(&mut driver, clock).await;
    positions(&mut driver, clock).await;
    stops(&mut driver, clock).await;
    encoders(&mut driver, clock).await;
    other.end();
}

fn of(parameter: AxisParameter, axis: ModuleAxis) -> Parameter {
    Parameter::Axis(parameter, axis)
}

/// Each number is written and read back by the other's own table of them.
async fn parameters(driver: &mut Bim2Ax, clock: &dyn twin_drives::Clock) {
    let settings = driver.axis_settings(ModuleAxis::Two, clock).await.unwrap();
    let known = (settings.fast_speed, settings.start_stop_speed, settings.acceleration);
    assert_eq!(known, (10_000, 2000, 20_000));
    assert_eq!((settings.soft_plus, settings.soft_minus), (4_194_303, -4_194_303));
    let mut written = 0;
    for number in 0..=0x37 {
        let Some(parameter @ Parameter::Axis(..)) = Parameter::from_number(number) else {
            continue;
        };
        let before = driver.parameter(parameter, clock).await.unwrap();
        // In the range of all: of currents, speeds, numbers of bits.
        let value = match parameter {
            Parameter::Axis(AxisParameter::EncoderBits, _) => 13,
            _ => 300 + u32::from(number),
        };
        driver.set_parameter(parameter, value, clock).await.unwrap();
        assert_eq!(driver.parameter(parameter, clock).await.unwrap(), value, "{parameter:?}");
        driver.set_parameter(parameter, before, clock).await.unwrap();
        written += 1;
    }
    assert_eq!(written, 0x38);
    let refused = driver.set_parameter(Parameter::Rating, 1, clock).await;
    assert!(
        matches!(fault_of(&refused), Some(Fault::CardMessages { messages: card::BAD_WRITE, .. })),
        "{refused:?}"
    );
}

async fn rest(driver: &mut Bim2Ax, clock: &dyn twin_drives::Clock) -> ([i32; 2], [u16; 2]) {
    let (seen, _) = driver.rested(seconds(20), clock).await.unwrap();
    (seen.positions, seen.messages)
}

/// Programmed moves, in their own time, and what is refused on the way.
async fn moves(driver: &mut Bim2Ax, clock: &dyn twin_drives::Clock) {
    driver.set_phases(&BOTH, true, clock).await.unwrap();
    driver.start([Some(Start::to(-2000)), Some(Start::to(5))], clock).await.unwrap();
    let acknowledged = driver.acknowledgements(clock).await.unwrap();
    assert_eq!(acknowledged.uc[0], uc::PROGRAMMED);
    assert_eq!(rest(driver, clock).await, ([-2000, 5], [0, 0]));
    let slower = Start { to: 1000, speed: Some(2000), directly: true };
    driver.start([Some(slower), None], clock).await.unwrap();
    // The first is under way for 1.5 s.
    let second = driver.start([Some(Start::to(0)), None], clock).await;
    let Some(Fault::AxisMessages { messages, axis: 1, .. }) = fault_of(&second) else {
        // An acknowledgement is that of the move before.
        assert!(second.is_ok(), "{second:?}");
        let (seen, _) = driver.positions(clock).await.unwrap();
        assert_ne!(seen.messages[0] & message::REFUSED, 0);
        assert_eq!(rest(driver, clock).await.0, [1000, 5]);
        return;
    };
    assert_ne!(messages & message::REFUSED, 0);
    assert_eq!(rest(driver, clock).await.0, [1000, 5]);
}

/// Homing, and positions that are declared.
async fn positions(driver: &mut Bim2Ax, clock: &dyn twin_drives::Clock) {
    driver.home(&BOTH, clock).await.unwrap();
    let acknowledged = driver.acknowledgements(clock).await.unwrap();
    assert!(acknowledged.uc.contains(&uc::HOME), "{acknowledged:?}");
    // The cam is left by one µstep, and its edge is where it is 0.
    let homed = message::HOMED | message::ON_CAM;
    assert_eq!(rest(driver, clock).await, ([0, 0], [homed; 2]));
    let last = of(AxisParameter::LastPosition, ModuleAxis::One);
    driver.start([Some(Start::to(-77)), None], clock).await.unwrap();
    assert_eq!(rest(driver, clock).await.0, [-77, 0]);
    assert_eq!(driver.parameter(last, clock).await.unwrap().cast_signed(), -77);
    driver.preset(ModuleAxis::Two, -4_194_303, clock).await.unwrap();
    driver.zero(ModuleAxis::One, clock).await.unwrap();
    assert_eq!(rest(driver, clock).await.0, [0, -4_194_303]);
    driver.recall(ModuleAxis::One, clock).await.unwrap();
    driver.zero(ModuleAxis::Two, clock).await.unwrap();
    assert_eq!(rest(driver, clock).await.0, [-77, 0]);
}

async fn stops(driver: &mut Bim2Ax, clock: &dyn twin_drives::Clock) {
    let slowly = |to| Some(Start { to, speed: Some(500), directly: false });
    driver.start([slowly(2000), slowly(2000)], clock).await.unwrap();
    let moving = driver.set_parameter(of(AxisParameter::Approach, ModuleAxis::One), 1, clock).await;
    assert!(
        matches!(fault_of(&moving), Some(Fault::CardMessages { messages: card::MOVING, .. })),
        "{moving:?}"
    );
    driver.abandon(clock).await.unwrap();
    let (seen, messages) = rest(driver, clock).await;
    assert!(seen.iter().all(|position| *position < 2000), "{seen:?}");
    assert!(messages.iter().all(|word| word & message::HOMED != 0), "{messages:?}");
    driver.start([slowly(2000), None], clock).await.unwrap();
    driver.stop_hard(clock).await.unwrap();
    let (_, messages) = rest(driver, clock).await;
    assert_eq!(messages[0] & (message::HARD_STOPPED | message::HOMED), message::HARD_STOPPED);
    assert_eq!(messages[1] & (message::HARD_STOPPED | message::HOMED), message::HOMED);
    driver.test_motors(&BOTH, clock).await.unwrap();
    driver.set_phases(&BOTH, false, clock).await.unwrap();
    let (_, messages) = rest(driver, clock).await;
    assert!(messages.iter().all(|word| word & message::PHASES_OFF != 0), "{messages:?}");
    // By the holding current too.
    let holding = of(AxisParameter::HoldingCurrent, ModuleAxis::One);
    driver.set_parameter(holding, 400, clock).await.unwrap();
    let (_, messages) = rest(driver, clock).await;
    let off = messages.map(|word| word & message::PHASES_OFF);
    assert_eq!(off, [0, message::PHASES_OFF]);
}

/// The examples of 6.4.1: 2000 steps are 20000 points.
async fn encoders(driver: &mut Bim2Ax, clock: &dyn twin_drives::Clock) {
    let definition = of(AxisParameter::EncoderDefinition, ModuleAxis::Two);
    driver.set_parameter(definition, 1, clock).await.unwrap();
    driver.start([None, Some(Start::to(2000))], clock).await.unwrap();
    rest(driver, clock).await;
    let (points, _) = driver.encoder_points(clock).await.unwrap();
    let (steps, _) = driver.encoder_steps(clock).await.unwrap();
    assert_eq!((points.positions[1], steps.positions[1]), (20_000, 2000));
    let messages = [encoder_message::PLUG, encoder_message::INCREMENTAL | encoder_message::PLUG];
    assert_eq!(points.messages, messages);
    driver.reset().await.unwrap();
    let moving = driver.start([None, Some(Start::to(9_000_000))], clock).await;
    assert!(matches!(moving, Err(DriveError::Range { .. })), "{moving:?}");
    let (_, messages) = rest(driver, clock).await;
    assert_eq!(messages.map(|word| word & message::PHASES_OFF), [message::PHASES_OFF; 2]);
}
