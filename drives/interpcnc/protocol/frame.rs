//! Modbus RTU frames: check sum, sealing and opening.
//!
//! Source: "MODBUS over serial line specification" 1.02.

/// Check sum of a frame: CRC-16 with polynomial `A001h`, start `FFFFh`, sent low byte first.
pub(crate) fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |crc, byte| {
        (0..8).fold(
            crc ^ u16::from(*byte),
            |crc: u16, _| if crc & 1 == 1 { crc >> 1 ^ 0xA001 } else { crc >> 1 },
        )
    })
}

/// The frame with its check sum.
pub(crate) fn seal(mut frame: Vec<u8>) -> Vec<u8> {
    let crc = crc16(&frame);
    frame.extend(crc.to_le_bytes());
    frame
}

/// Station, function and data of a frame whose check sum is right.
pub(crate) fn open(frame: &[u8]) -> Option<(u8, u8, &[u8])> {
    let (body, crc) = frame.split_last_chunk::<2>()?;
    let [address, function, data @ ..] = body else { return None };
    (crc16(body) == u16::from_le_bytes(*crc)).then_some((*address, *function, data))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_sum_is_that_of_modbus() {
        // Check value of the vector generator, which tokio-modbus' own test shares.
        assert_eq!(seal(vec![0x01, 0x03, 0x08, 0x2B, 0x00, 0x02])[6..], [0xB6, 0x63]);
        // "MODBUS over serial line specification" 1.02, appendix B: 02 07 has check sum 1241h.
        assert_eq!(crc16(&[0x02, 0x07]), 0x1241);
    }
}
