//! mbpoll, the command line over libmodbus: every table read, every kind of write, the refusals by their names.

use std::process::Command;

use crate::{
    emulator::{EmulatedBoard, EmulatorOptions},
    tests::emulated,
};

/// Tables as mbpoll numbers them (`-t`).
const COILS: &str = "0";
const DISCRETE: &str = "1";
const INPUT: &str = "3";
const INPUT_LONG: &str = "3:int";
const HOLDING: &str = "4";
const HOLDING_LONG: &str = "4:int";

/// Addresses and values of registers that are not 0.
type Others = &'static [(u16, i64)];

/// mbpoll on the wire to a board.
struct Mbpoll(EmulatedBoard);

impl Mbpoll {
    /// `None`, and a word about it, where mbpoll is not installed.
    fn start() -> Option<Self> {
        if Command::new("mbpoll").arg("-V").output().is_ok_and(|output| output.status.success()) {
            return Some(Self(emulated(&EmulatorOptions::default())));
        }
        println!("no mbpoll here: not witnessed");
        None
    }

    fn port(&self) -> &str {
        self.0.path().to_str().unwrap()
    }

    /// What it says with these arguments, or its complaint.
    fn run(address: &str, table: &str, rest: &[&str]) -> Result<String, String> {
        let mut mbpoll = Command::new("mbpoll");
        // RTU, addresses from 0, high word first, no parity, once, ten seconds to answer.
        mbpoll.args(["-m", "rtu", "-0", "-B", "-P", "none", "-b", "115200", "-1", "-o"]);
        mbpoll.args([if address == "1" { "10" } else { "0.3" }, "-a", address, "-t", table]);
        let output = mbpoll.args(rest).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        if output.status.success() { Ok(text(&output.stdout)) } else { Err(text(&output.stderr)) }
    }

    /// `count` values from `address` on. It shows each as `[address]: value`, words beyond 32767 also as negative.
    fn read(&self, table: &str, address: u16, count: u16) -> Vec<i64> {
        let (address, count) = (address.to_string(), count.to_string());
        let said = Self::run("1", table, &["-r", &address, "-c", &count, self.port()]).unwrap();
        let values = said.lines().filter_map(|line| line.strip_prefix('[')?.split_once("]:"));
        values.map(|(_, value)| value.split_whitespace().next().unwrap().parse().unwrap()).collect()
    }

    fn write(&self, table: &str, address: u16, values: &[i64]) -> Result<(), String> {
        let values: Vec<_> = values.iter().map(i64::to_string).collect();
        let address = address.to_string();
        let mut rest = vec!["-r", &address, self.port(), "--"];
        rest.extend(values.iter().map(String::as_str));
        let said = Self::run("1", table, &rest)?;
        let expected = format!("Written {} references.", values.len());
        assert!(said.contains(&expected), "{said}");
        Ok(())
    }

    /// Gives a command whose arguments fit 16 bits.
    fn command(&self, registers: &[i64]) {
        self.write(HOLDING, 4096, registers).unwrap();
    }

    /// Status, registers 1024 and 1025.
    fn status(&self) -> i64 {
        match self.read(INPUT, 1024, 2).as_slice() {
            [high, low] => high << 16 | low,
            other => panic!("{other:?}"),
        }
    }

    fn positions(&self) -> Vec<i64> {
        self.read(INPUT_LONG, 1026, 5)
    }
}

#[test]
fn mbpoll_reads_every_block_of_the_emulated_board() {
    let Some(it) = Mbpoll::start() else { return };
    // First address, number of values and, where one is not 0 after power-up, which: B5 and B8 of the status, the
    // board's lock; parameters 101 (speed) and 103 (address); the size of recipes.
    let blocks: [(&str, u16, u16, Others); 20] = [
        (DISCRETE, 2048, 16, &[]),
        (DISCRETE, 2080, 40, &[(2085, 1), (2088, 1)]),
        (DISCRETE, 2120, 125, &[]),
        (COILS, 256, 32, &[]),
        (COILS, 288, 1, &[(288, 1)]),
        (COILS, 320, 96, &[]),
        (INPUT, 1024, 12, &[(1025, 0x120)]),
        (INPUT, 1036, 18, &[]),
        (INPUT, 1054, 2, &[]),
        (HOLDING, 4096, 50, &[]),
        (HOLDING, 4146, 4, &[]),
        (HOLDING, 4150, 46, &[]),
        (HOLDING, 4196, 22, &[]),
        (HOLDING, 4218, 6, &[]),
        (HOLDING, 4554, 6, &[(4554, 1), (4555, 0xC200), (4559, 1)]),
        (HOLDING, 4995, 125, &[]),
        (HOLDING, 5120, 125, &[]),
        (HOLDING, 5507, 125, &[]),
        (HOLDING, 5632, 5, &[(5632, 250)]),
        (HOLDING, 6512, 125, &[]),
    ];
    for (table, first, count, others) in blocks {
        let mut expected = vec![0; count.into()];
        for (address, value) in others {
            expected[usize::from(address - first)] = *value;
        }
        assert_eq!(it.read(table, first, count), expected, "table {table} from {first}");
    }
}

#[test]
fn mbpoll_moves_the_emulated_board_and_switches_its_outputs() {
    let Some(it) = Mbpoll::start() else { return };
    // Locked: confirmed and not done. Command 80 to X.
    let to_3000 = [80, 1, 200, 500, 0, 20_000, 400, 0, 3000];
    it.command(&to_3000);
    it.write(COILS, 256, &[1]).unwrap();
    assert_eq!((it.status(), it.positions()[0], it.read(COILS, 256, 1)), (0x120, 0, vec![0]));
    // Command 66 with 1 unlocks.
    it.command(&[66, 1]);
    assert_eq!(it.status(), 0x20);
    it.command(&to_3000);
    while it.status() != 0x20 {}
    assert_eq!(it.positions(), [3000, 0, 0, 0, 0]);
    // Command 67, the manual's second example; then with values below 0.
    it.command(&[67, 5, 0, 1000, 0, 0]);
    assert_eq!(it.positions(), [1000, 0, 0, 0, 0]);
    it.command(&[67, 3, 0xFFFF, 0xFC18, 0xFFFF, 0xFFFF]);
    assert_eq!(it.positions(), [-1000, -1, 0, 0, 0]);
    // Command 6: X and Z.
    it.command(&[6, 5, 0, 5000, 0, 1000, 0xFFFF, 0xF830]);
    while it.status() != 0x20 {}
    assert_eq!(it.positions(), [1000, -1, -2000, 0, 0]);
    // Command 42 alone, which mbpoll sends by function 6, ends a move that would last for hours; 43 locks too.
    it.command(&[80, 16, 200, 500, 0, 2000, 400, 0x7FFF, 0xFFFF]);
    assert_eq!(it.status() >> 22, 1 << 4);
    it.command(&[42]);
    while it.status() != 0x20 {}
    it.command(&[43]);
    assert_eq!(it.status(), 0x120);
    it.command(&[66, 1]);
    // Outputs: one coil (function 5), several (15), registers (16).
    it.write(COILS, 258, &[1]).unwrap();
    assert_eq!(it.read(INPUT, 1038, 2), [0, 4]);
    it.write(COILS, 272, &[1, 0, 1]).unwrap();
    assert_eq!(it.read(HOLDING, 4148, 2), [5, 4]);
    it.write(HOLDING, 4148, &[0, 0x8001]).unwrap();
    assert_eq!(it.read(COILS, 256, 17), [[1].as_slice(), &[0; 14], &[1, 0]].concat());
    // Values of 32 bits; a register of the EEPROM; user bits.
    it.write(HOLDING_LONG, 4198, &[-2, 100_000]).unwrap();
    assert_eq!(it.read(HOLDING, 4198, 4), [0xFFFF, 0xFFFE, 1, 0x86A0]);
    assert_eq!(it.read(HOLDING_LONG, 4198, 2), [-2, 100_000]);
    it.write(HOLDING, 5631, &[4711]).unwrap();
    assert_eq!(it.read(HOLDING, 5631, 1), [4711]);
    it.write(COILS, 414, &[1, 1]).unwrap();
    assert_eq!(it.read(COILS, 413, 3), [0, 1, 1]);
}

#[test]
fn mbpoll_is_refused_what_the_board_cannot_do() {
    let Some(it) = Mbpoll::start() else { return };
    let (address, value) = ("Illegal data address", "Illegal data value");
    for (table, first, count) in [
        (INPUT, "1056", "1"),
        (INPUT, "1023", "1"),
        (INPUT, "1050", "7"),
        (HOLDING, "4095", "1"),
        (HOLDING, "6636", "2"),
        (COILS, "512", "1"),
        (DISCRETE, "2304", "1"),
    ] {
        let complaint =
            Mbpoll::run("1", table, &["-r", first, "-c", count, it.port()]).unwrap_err();
        assert!(complaint.contains(address), "{table} {first}: {complaint}");
    }
    let writes: [(&str, u16, &[i64], &str); 9] = [
        (HOLDING, 7000, &[1, 2], address),
        (HOLDING, 4218, &[1], address),
        (HOLDING, 4351, &[1, 2], address),
        (COILS, 289, &[1], address),
        (COILS, 415, &[1, 1], address),
        (HOLDING, 4096, &[67, 0, 0, 1], value),
        (HOLDING, 4096, &[67, 32, 0, 1], value),
        (HOLDING, 4096, &[99], value),
        (HOLDING, 4146, &[1024], value),
    ];
    for (table, first, values, expected) in writes {
        let complaint = it.write(table, first, values).unwrap_err();
        assert!(complaint.contains(expected), "{table} {first}: {complaint}");
    }
    // Nobody else answers, and the board still does.
    let complaint = Mbpoll::run("2", INPUT, &["-r", "1024", it.port()]).unwrap_err();
    assert!(complaint.contains("Connection timed out"), "{complaint}");
    assert_eq!(it.status(), 0x120);
}
