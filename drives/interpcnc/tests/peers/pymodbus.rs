//! pymodbus, at either end.

use std::{env, ffi::OsString, process::Command as Process, sync::Arc, time::Duration};

use tokio_serial::SerialStream;

use crate::{
    AxisOptions, BoardAxis, Command, Exception, InterpCnc, InterpCncOptions, MoveProfile,
    emulator::{EmulatorOptions, Event},
    protocol::{registers::Status, vectors::vector},
    tests::{
        LOCKED,
        common::{fault_of, wall_clock},
        emulated, fails,
        peer::Peer,
        profile,
        vectors::{commands, slow_home},
    },
};
use twin_drives::emulator_host::PseudoTerminal;

/// Version the tests are about.
const VERSION: &str = "3.16.1";

/// A script under way; `None`, and a word about it, without pymodbus.
fn start(script: &str, port: &str) -> Option<Peer> {
    let named = env::var_os("TWIN_PYMODBUS_PYTHON").filter(|python| !python.is_empty());
    let python = named.clone().unwrap_or_else(|| OsString::from("python3"));
    let asked = Process::new(&python)
        .args(["-c", "import pymodbus, serial; print(pymodbus.__version__)"])
        .output();
    let found = asked.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    if !found.as_ref().is_ok_and(|found| found == VERSION) {
        assert!(named.is_none(), "TWIN_PYMODBUS_PYTHON has no pymodbus {VERSION}: {found:?}");
        println!("no pymodbus {VERSION} here (TWIN_PYMODBUS_PYTHON): not witnessed");
        return None;
    }
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peers/");
    let script = format!("{folder}{script}");
    Some(Peer::start(Process::new(python).args(["-B", &script, port])))
}

#[test]
fn pymodbus_is_the_master_of_the_emulated_board() {
    let board = emulated(&EmulatorOptions::default());
    let Some(mut master) = start("pymodbus_master.py", board.path().to_str().unwrap()) else {
        return;
    };
    let mut agreed = Vec::new();
    loop {
        let line = master.line();
        match *line.split(' ').collect::<Vec<_>>().as_slice() {
            ["agreed", part] => agreed.push(part.to_owned()),
            ["enable", closed] => board.happen(Event::Enable(closed == "1")).unwrap(),
            ["input", number, level] => {
                let number = number.parse().unwrap();
                board.happen(Event::Input { number, level: level == "1" }).unwrap();
            }
            _ => break,
        }
        if !line.starts_with("agreed") {
            master.say("done");
        }
    }
    assert_eq!(agreed, ["blocks", "lock", "memory", "moves", "searches", "refusals"]);
    master.end();
}

/// The driver and pymodbus as a board at the ends of a wire; the terminal is the wire.
fn wired() -> Option<(InterpCnc, Peer, PseudoTerminal)> {
    let (near, terminal) = PseudoTerminal::open(None).unwrap();
    let mut peer = start("pymodbus_server.py", terminal.path().to_str().unwrap())?;
    assert_eq!(peer.line(), "ready");
    let mut options = InterpCncOptions::new(vec![AxisOptions::new(BoardAxis::X)]);
    // Other tests and builds may keep the peer waiting.
    options.deadline = Duration::from_secs(5);
    let stream = SerialStream::try_from(near).unwrap();
    Some((InterpCnc::attach(Arc::from("pymodbus"), stream, &options), peer, terminal))
}

#[tokio::test]
async fn the_driver_gives_every_command_to_pymodbus() {
    let Some((mut driver, mut peer, _terminal)) = wired() else { return };
    let clock = &wall_clock();
    let (state, _) = driver.state(clock).await.unwrap();
    assert_eq!((state.status, state.positions), (Status(0x120), [0; 5]));
    driver.unlock(clock).await.unwrap();
    assert_eq!(driver.state(clock).await.unwrap().0.status, Status(0x20));
    assert_eq!(peer.have("requests"), "16 4096 66,1");

    // The registers of the vectors; then, 65536 − n where a word is negative, of other axes, masks and bits.
    let registers = |number| {
        let frame: Vec<u8> = vector(number);
        let words = frame[7..frame.len() - 2].chunks_exact(2);
        let words = words.map(|word| u16::from_be_bytes([word[0], word[1]]).to_string());
        words.collect::<Vec<_>>().join(",")
    };
    let of_vectors = commands().into_iter().map(|(number, command)| (command, registers(number)));
    let targets = [1, 2, 3, 4, -5].map(Some);
    let fast = MoveProfile { speed_hz: 150_000, ..profile(-5000) };
    let others = [
        (
            Command::Interpolated { speed_hz: 70_000, targets },
            "6,31,1,4464,0,1,0,2,0,3,0,4,65535,65531",
        ),
        (
            Command::Move { axis: BoardAxis::B, profile: fast },
            "80,16,200,50,2,18928,40,65535,60536",
        ),
        (slow_home(BoardAxis::B, -1), "78,5,5,0,20,0,4000,40,65535,5536,300,65535,65535"),
        (Command::RampStopAxes { axes: BoardAxis::X.mask().union(BoardAxis::Z.mask()) }, "41,5"),
        (Command::Reset { unlock: false, homing_error: true, probe_error: true }, "66,6"),
    ];
    let others = others.map(|(command, registers)| (command, registers.to_owned()));
    for (command, expected) in of_vectors.chain(others) {
        driver.send(&command, clock).await.unwrap();
        assert_eq!(peer.have("requests"), format!("16 4096 {expected}"));
    }
    driver.unlock(clock).await.unwrap();
    // What waits for its end.
    let patience = Duration::from_secs(5);
    driver.move_axis(BoardAxis::X, &profile(-5000), patience, clock).await.unwrap();
    assert_eq!(driver.state(clock).await.unwrap().0.positions[0], -5000);
    peer.end();
}

#[tokio::test]
async fn the_driver_reads_and_writes_every_block_of_pymodbus() {
    let Some((mut driver, mut peer, _terminal)) = wired() else { return };
    let clock = &wall_clock();
    let patience = Duration::from_secs(5);
    driver.unlock(clock).await.unwrap();
    let identity = driver.identify(clock).await.unwrap();
    assert_eq!((identity.address, identity.speed, identity.parity), (1, 115_200, 0));
    peer.have("requests");

    driver.set_output(17, true, clock).await.unwrap();
    assert_eq!(driver.outputs(clock).await.unwrap(), 0x0001_0000);
    assert_eq!(peer.have("requests"), "5 272 1");
    assert_eq!(peer.have("input 16 1"), "done");
    assert_eq!(peer.have("input 32 1"), "done");
    assert_eq!(peer.have(&format!("status {}", 1_u32 << 31 | 1 << 22)), "done");
    let seen = driver.snapshot(clock).await.unwrap();
    assert_eq!((seen.inputs, seen.outputs), (0x8000_8000, 0x0001_0000));
    assert_eq!(seen.analog_inputs, [11, 22, 33, 1023]);
    assert_eq!(seen.state.status, Status(1 << 31 | 1 << 22 | 1 << 5));
    assert_eq!(driver.counters(clock).await.unwrap(), (-7, [5, 0x0001_0000]));
    assert_eq!(peer.have("status 0"), "done");

    driver.set_analog_output(2, 1023, clock).await.unwrap();
    assert_eq!(driver.analog_outputs(clock).await.unwrap(), [0, 1023]);
    driver.set_parameter(383, 0xFFFF_FFF0, patience, clock).await.unwrap();
    assert_eq!(driver.parameters(382, 2, clock).await.unwrap(), [0, 0xFFFF_FFF0]);
    let written: Vec<_> = peer.have("requests").split(" | ").map(str::to_owned).collect();
    // Function 6 or 16 for one register is the driver's choice.
    let written: Vec<_> = written.iter().map(|write| write.split_once(' ').unwrap().1).collect();
    assert_eq!(written, ["4147 1023", "5118 65535,65520"]);
    peer.end();
}

#[tokio::test]
async fn the_driver_tells_every_exception_of_pymodbus() {
    let Some((mut driver, mut peer, _terminal)) = wired() else { return };
    let clock = &wall_clock();
    for code in [1, 2, 3, 4, 6] {
        let (refuse, expected) = (format!("refuse {code}"), Exception(code));
        assert_eq!(peer.have(&refuse), "done");
        assert_eq!(fault_of(&driver.state(clock).await), Some(&expected));
        assert_eq!(peer.have(&refuse), "done");
        assert_eq!(fault_of(&driver.send(&Command::RampStop, clock).await), Some(&expected));
        assert_eq!(peer.have(&refuse), "done");
        assert_eq!(fault_of(&driver.set_output(1, true, clock).await), Some(&expected));
    }
    // A locked board confirms the switching of an output and leaves it alone.
    fails(&driver.set_output(1, true, clock).await, LOCKED);
    assert_eq!(peer.have("requests"), "5 256 1");
    driver.state(clock).await.unwrap();
    peer.end();
}
