//! Frames between a Modbus master and the emulated board, byte by byte.

use crate::desk::Desk;
use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;

/// Frames of a master and what the board answers: word order, faulty frames, exceptions.
#[test]
fn a_master_and_the_board_exchange_frames() {
    let desk = Desk::new();
    desk.meanwhile("-INT", "Ctrl-C ends it", "emulate interpcnc --link board", || {
        let mut master = Master::open(&desk.path("board"));
        // Command 67 sets the position counter of X, mask 1, to -100000; the high word comes first.
        let position = [1, 16, 0x10, 0, 0, 4, 8, 0, 67, 0, 1, 0xFF, 0xFE, 0x79, 0x60];
        assert_eq!(master.ask(&position), [1, 16, 0x10, 0, 0, 4]);
        assert_eq!(master.ask(&[1, 4, 4, 2, 0, 2]), [1, 4, 4, 0xFF, 0xFE, 0x79, 0x60]);
        // A wrong check sum, another address, and a broadcast are not answered.
        assert!(master.exchange(&[1, 3, 0x10, 0x68, 0, 2, 0, 0]).is_empty());
        assert!(master.ask(&[2, 3, 0x10, 0x68, 0, 2]).is_empty());
        assert!(master.ask(&[0, 6, 0x10, 0x32, 0, 7]).is_empty());
        // Illegal function, address and quantity.
        assert_eq!(master.ask(&[1, 0x14, 0, 0, 0, 0]), [1, 0x94, 1]);
        assert_eq!(master.ask(&[1, 3, 0x50, 0, 0, 1]), [1, 0x83, 2]);
        assert_eq!(master.ask(&[1, 4, 0x50, 0, 0, 1]), [1, 0x84, 2]);
        for quantity in [0, 126] {
            assert_eq!(master.ask(&[1, 3, 0x10, 0x68, 0, quantity]), [1, 0x83, 3], "{quantity}");
            assert_eq!(master.ask(&[1, 4, 4, 0, 0, quantity]), [1, 0x84, 3], "{quantity}");
        }
        // A gap within a frame ends it.
        let frame = with_check_sum(&[1, 3, 0x10, 0x68, 0, 2]);
        master.send(&frame[..3]);
        std::thread::sleep(Duration::from_millis(100));
        assert!(master.exchange(&frame[3..]).is_empty());
        assert_eq!(master.ask(&[1, 4, 4, 2, 0, 2]), [1, 4, 4, 0xFF, 0xFE, 0x79, 0x60]);
    })
    .ended(0, "");
}

/// A Modbus master that writes and reads bytes.
struct Master {
    port: File,
    answers: Receiver<u8>,
}

impl Master {
    fn open(path: &Path) -> Self {
        let port = File::options().read(true).write(true).open(path).expect("it opens");
        let reader = port.try_clone().expect("a second handle");
        let (sender, answers) = sync_channel(1024);
        // Ends when the emulator closes its side.
        std::thread::Builder::new()
            .name("master".to_owned())
            .spawn(move || {
                for byte in BufReader::new(reader).bytes().map_while(Result::ok) {
                    if sender.send(byte).is_err() {
                        break;
                    }
                }
            })
            .expect("a thread");
        Self { port, answers }
    }

    fn send(&mut self, bytes: &[u8]) {
        self.port.write_all(bytes).expect("it is written");
    }

    /// Sends bytes and returns the answer without its check sum, nothing if there is none within 0.5 s.
    fn exchange(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.send(bytes);
        let mut answer = Vec::new();
        let mut patience = Duration::from_millis(500);
        while let Ok(byte) = self.answers.recv_timeout(patience) {
            answer.push(byte);
            patience = Duration::from_millis(50);
        }
        let Some(content) = answer.len().checked_sub(2) else { return answer };
        assert_eq!(with_check_sum(&answer[..content]), answer, "check sum");
        answer[..content].to_vec()
    }

    fn ask(&mut self, content: &[u8]) -> Vec<u8> {
        self.exchange(&with_check_sum(content))
    }
}

/// A frame with its check sum (CRC-16 of Modbus, low byte first).
fn with_check_sum(content: &[u8]) -> Vec<u8> {
    let mut sum = 0xFFFF_u16;
    for byte in content {
        sum ^= u16::from(*byte);
        for _ in 0..8 {
            sum = if sum & 1 == 1 { (sum >> 1) ^ 0xA001 } else { sum >> 1 };
        }
    }
    [content, &sum.to_le_bytes()].concat()
}
