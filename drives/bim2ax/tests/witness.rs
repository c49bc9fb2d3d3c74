//! The second reading of the manual, in Python, against driver and emulator. Without Python there is no witness,
//! which is said.

use std::{
    io::{BufRead, BufReader},
    process::{Command, Stdio},
};

use super::*;
use crate::bim2ax::{
    FILE_LENGTH, MemoryFile, Start,
    bits::message,
    emulator::{EmulatedModule, EmulatorOptions},
};

fn python() -> Option<Command> {
    let mut python = Command::new("python3");
    if !python.arg("--version").output().is_ok_and(|output| output.status.success()) {
        println!("no python3 here: not witnessed");
        return None;
    }
    let mut python = Command::new("python3");
    python.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/bim2ax/tests/reference.py"));
    Some(python)
}

#[expect(
    clippy::disallowed_methods,
    reason = "these tests run in real time and are their own session"
)]
fn wall_clock() -> impl Fn() -> i64 + Send + Sync + Copy {
    let zero = std::time::Instant::now();
    move || i64::try_from(zero.elapsed().as_nanos()).unwrap()
}

#[test]
fn another_host_drives_the_emulated_module() {
    let Some(mut python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("eeprom");
    std::fs::write(&image, eeprom().to_bytes()).unwrap();
    let mut options = EmulatorOptions::new(&folder.path().join("module"));
    options.eeprom = Some(image);
    options.surroundings = surroundings();
    let module = EmulatedModule::start(&options, wall_clock()).unwrap();
    let output = python.arg("host").arg(module.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(module.module().served() > 30);
}

#[tokio::test]
async fn the_driver_drives_another_module() {
    let Some(mut python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("module");
    std::fs::write(&path, [0; FILE_LENGTH]).unwrap();
    let python = python.arg("module").arg(&path).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut other = python.spawn().unwrap();
    let mut ready = String::new();
    BufReader::new(other.stdout.take().unwrap()).read_line(&mut ready).unwrap();
    assert_eq!(ready, "ready\n");

    let options = Bim2AxOptions { deadline: seconds(5), ..Bim2AxOptions::default() };
    let memory = MemoryFile::open(&path).unwrap();
    let mut driver = Bim2Ax::new("other", memory, &options);
    let clock = &wall_clock();
    let identity = driver.identify(clock).await.unwrap();
    assert_eq!((identity.rating_ma, identity.version), (5000, 17));
    let fast = Parameter::Axis(AxisParameter::FastSpeed, ModuleAxis::Two);
    driver.set_parameter(fast, 1234, clock).await.unwrap();
    assert_eq!(driver.parameter(fast, clock).await.unwrap(), 1234);
    driver.set_phases(&BOTH, true, clock).await.unwrap();
    driver.start([Some(Start::to(-70_000)), Some(Start::to(5))], clock).await.unwrap();
    let (seen, _) = driver.rested(seconds(5), clock).await.unwrap();
    assert_eq!((seen.positions, seen.messages), ([-70_000, 5], [0, 0]));
    driver.home(&[ModuleAxis::One], clock).await.unwrap();
    driver.preset(ModuleAxis::Two, -4_194_303, clock).await.unwrap();
    let (seen, _) = driver.positions(clock).await.unwrap();
    assert_eq!((seen.positions, seen.messages), ([0, -4_194_303], [message::HOMED; 2]));
    assert_eq!(driver.plugs(clock).await.unwrap().values, [None, Some(0x0102_0304)]);
    drop(other.stdin.take());
    assert!(other.wait().unwrap().success());
}
