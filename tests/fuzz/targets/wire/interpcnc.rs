//! InterpCNC: commands in registers, and Modbus RTU requests to the emulated board.

use twin_interpcnc::emulator::{Board, BoardOptions};
use twin_interpcnc::{BoardAxis, Command, CommandRegisters, Parity};

/// Longest frame of Modbus RTU, bytes.
const FRAME: usize = 256;

pub fn check(bytes: &[u8]) {
    let mut registers: CommandRegisters = [0; 50];
    for (register, pair) in registers.iter_mut().zip(bytes.chunks_exact(2)) {
        *register = u16::from_be_bytes([pair[0], pair[1]]);
    }
    if let Ok(command) = Command::decode(&registers) {
        let encoded = command.registers();
        let mut again: CommandRegisters = [0; 50];
        again[..encoded.len()].copy_from_slice(&encoded);
        assert_eq!(Command::decode(&again), Ok(command));
    }
    let code = bytes.first_chunk().map_or(0, |code| u32::from_be_bytes(*code));
    assert!(Parity::from_code(code).is_none_or(|parity| parity.code() == code));
    let options = BoardOptions::default();
    let mut board = Board::new(&options);
    for (pause_ns, request) in super::requests(bytes) {
        board.advance(pause_ns);
        let whole = crc(request) == 0;
        assert!(whole || board.handle(request).is_none(), "a frame with a wrong check sum");
        let frame = sealed(&[&[1], request].concat());
        if let Some(answer) = board.handle(&frame) {
            assert!((5..=FRAME).contains(&answer.len()) && crc(&answer) == 0, "{answer:?}");
            assert_eq!(answer[0], 1);
            assert_eq!(answer[1] & 0x7F, request[0] & 0x7F, "{answer:?} to {frame:?}");
        }
        for axis in BoardAxis::ALL {
            assert!(board.position(axis).is_finite() && board.velocity(axis).is_finite());
        }
    }
    let image = board.eeprom();
    let again = Board::with_eeprom(&options, &image).expect("an image of a board");
    assert_eq!(again.eeprom(), image);
}

fn sealed(frame: &[u8]) -> Vec<u8> {
    [frame, &crc(frame).to_le_bytes()].concat()
}

/// CRC-16 of Modbus: that of a frame with its check sum is 0.
fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte), |crc, _| (crc >> 1) ^ (0xA001 * (crc & 1)))
    })
}
