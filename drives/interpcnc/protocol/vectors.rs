//! Frames computed elsewhere, for tests: the digest's vectors for address 1, numbered as there.
//!
//! 1, 3, 5, 11, 19, 20, 22 and 24 came byte for byte from mbpoll 1.4.11 (libmodbus 3.1.6) or pymodbus 3.16.1; values
//! of 1, 3 to 5 and 7 to 10 are the manual's examples. The check sums of all come from an independent script.

use super::frame::seal;
use super::registers::COMMAND;
use crate::Command;

/// Numbers of the vectors and their bytes.
pub(crate) const VECTORS: [&str; 31] = [
    // 1 unlock: command 66, bits = 1
    "01 10 10 00 00 02 04 00 42 00 01 5F BB",
    // 2 its response
    "01 10 10 00 00 02 45 08",
    // 3 command 71, example 1: home X 10000, Y 20000
    "01 10 10 00 00 06 0C 00 47 00 03 00 00 27 10 00 00 4E 20 AF 3B",
    // 4 command 71, example 2: home X 10000, Z 20000
    "01 10 10 00 00 06 0C 00 47 00 05 00 00 27 10 00 00 4E 20 84 9B",
    // 5 command 40, example: probe Z−, IN3, NO, 10000, 1000 Hz, 100 Hz, 50, 100
    "01 10 10 00 00 0C 18 00 28 00 04 FF FF 00 03 00 01 00 00 27 10 00 00 03 E8 00 64 00 32 00 64 E6 50",
    // 6 its response
    "01 10 10 00 00 0C C4 CC",
    // 7 command 67, example 1: X := 1000
    "01 10 10 00 00 04 08 00 43 00 01 00 00 03 E8 C7 50",
    // 8 command 67, example 2: X := 1000, Z := 0
    "01 10 10 00 00 06 0C 00 43 00 05 00 00 03 E8 00 00 00 00 02 E3",
    // 9 command 96, example with its code corrected: X speed 10000 Hz
    "01 10 10 00 00 04 08 00 60 00 01 00 00 27 10 CF 10",
    // 10 command 96, example as printed (67): sets the X counter to 10000
    "01 10 10 00 00 04 08 00 43 00 01 00 00 27 10 DD D2",
    // 11 command 80: X → 100000, start/stop 200, acceleration 50, 20000 Hz, deceleration 40
    "01 10 10 00 00 09 12 00 50 00 01 00 C8 00 32 00 00 4E 20 00 28 00 01 86 A0 A3 20",
    // 12 command 80, retarget in flight: X → −5000, 150000 Hz
    "01 10 10 00 00 09 12 00 50 00 01 00 C8 00 32 00 02 49 F0 00 28 FF FF EC 78 55 75",
    // 13 command 6: X and Z, 5000 Hz, X = 1000, Z = −2000
    "01 10 10 00 00 08 10 00 06 00 05 00 00 13 88 00 00 03 E8 FF FF F8 30 55 13",
    // 14 command 6: all five axes
    "01 10 10 00 00 0E 1C 00 06 00 1F 00 00 13 88 00 00 00 01 00 00 00 02 00 00 00 03 00 00 00 04 FF FF FF FB 4C 71",
    // 15 command 78: axis 1, IN5, NC, 20, 4000 Hz, 40, −60000, slow 300, position 0
    "01 10 10 00 00 0D 1A 00 4E 00 01 00 05 00 00 00 14 00 00 0F A0 00 28 FF FF 15 A0 01 2C 00 00 00 00 8B 16",
    // 16 command 41: ramp stop X and Y
    "01 10 10 00 00 02 04 00 29 00 03 AF A6",
    // 17 command 42 by function 16
    "01 10 10 00 00 01 02 00 2A 36 4E",
    // 18 command 43 by function 16
    "01 10 10 00 00 01 02 00 2B F7 8E",
    // 19 command 42 by function 6; request = response
    "01 06 10 00 00 2A 0C D5",
    // 20 function 4, read 1024 to 1035
    "01 04 04 00 00 0C F1 3F",
    // 21 response: status 00400020, X = 100000, Y = −1, Z = A = B = 0
    "01 04 18 00 40 00 20 00 01 86 A0 FF FF FF FF 00 00 00 00 00 00 00 00 00 00 00 00 08 94",
    // 22 function 2, read 2080 to 2119
    "01 02 08 20 00 28 7B BE",
    // 23 response: the same status, direction X = 1
    "01 02 05 20 00 40 00 01 E3 81",
    // 24 function 5: OUT1 on; request = response
    "01 05 01 00 FF 00 8D C6",
    // 25 function 15: OUT1 to OUT12 = 0A5h
    "01 0F 01 00 00 0C 02 A5 00 8E 20",
    // 26 function 1: read coil 288
    "01 01 01 20 00 01 FD FC",
    // 27 function 3: read 4554 and 4555 (parameter 101, Modbus speed)
    "01 03 11 CA 00 02 E1 09",
    // 28 response with the baud rate as a number (assumption)
    "01 03 04 00 01 C2 00 FA 93",
    // 29 exception 2 to function 16 at 7000
    "01 90 02 CD C1",
    // 30 exception 1 to function 17h
    "01 97 01 8F F0",
    // 31 exception 3 to function 4 with count 0
    "01 84 03 03 01",
];

/// Bytes of vector `number`.
pub(crate) fn vector(number: usize) -> Vec<u8> {
    bytes(VECTORS[number - 1])
}

/// Bytes of a hexadecimal listing.
pub(crate) fn bytes(text: &str) -> Vec<u8> {
    text.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

/// The request that sends a command to address 1.
pub(crate) fn frame(command: &Command) -> Vec<u8> {
    let registers = command.registers();
    let count = u8::try_from(registers.len()).unwrap();
    let mut frame = vec![1, 16];
    frame.extend(COMMAND.to_be_bytes());
    frame.extend([0, count, 2 * count]);
    frame.extend(registers.iter().flat_map(|register| register.to_be_bytes()));
    seal(frame)
}
