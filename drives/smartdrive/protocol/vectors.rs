//! Frames computed elsewhere, for tests: the digest's vectors for address 1, numbered as there.
//!
//! The manual prints no whole frame; values and codes of 21 and 26 are its examples. The bytes come from an independent
//! script.

/// Numbers of the vectors and their bytes.
pub(crate) const VECTORS: [&str; 35] = [
    // 1 PING adr 1
    "01 01 00 00 00 00 00",
    // 2 response: mode 3, POS 0, DONE
    "86 01 00 00 00 00 01 00 86",
    // 3 response: mode 0 + ALARM, POS 0, UNDERVOLTAGE
    "81 01 00 00 00 00 08 00 88",
    // 4 MODE 3 (remote)
    "01 04 03 00 00 00 06",
    // 5 response while switching (mode 31)
    "BE 01 00 00 00 00 00 00 BF",
    // 6 TRJINIT 1 (zero here)
    "01 20 01 00 00 00 20",
    // 7 TRJINIT 2 (homing)
    "01 20 02 00 00 00 23",
    // 8 response: SEQBUSY, POS −123, INMOTION
    "86 21 85 FF FF FF 00 01 DC",
    // 9 GOTO +3200 (max v, a)
    "01 23 80 0C 00 00 AE",
    // 10 response: POS 0, not DONE
    "86 01 00 00 00 00 00 00 87",
    // 11 GOTO −6400, 300 rpm, 1000 rpm/s (CMD 63h)
    "01 63 00 E7 FF FF 2C 01 E8 03 43",
    // 12 response in flight: POS 1600, INMOTION
    "86 01 40 06 00 00 00 01 C0",
    // 13 STEP +200
    "01 24 C8 00 00 00 ED",
    // 14 START +600 rpm
    "01 21 58 02 00 00 7A",
    // 15 START −600 rpm, 500 rpm/s
    "01 21 A8 FD F4 01 80",
    // 16 STOP (max)
    "01 22 00 00 00 00 23",
    // 17 STOP, 2000 rpm/s
    "01 22 00 00 D0 07 F4",
    // 18 STOP broadcast (no responseonse)
    "00 22 00 00 00 00 22",
    // 19 READ var 75 (VAR_Pos_Actual)
    "01 0F 4B 00 00 00 45",
    // 20 response −1000
    "86 01 18 FC FF FF 00 00 63",
    // 21 WRITE (CMD 4Eh printed) var 130 := FFFFh
    "01 4E 82 00 00 00 FF FF 00 00 CD",
    // 22 SET par 30 (VelMax) := 600
    "01 11 1E 00 58 02 54",
    // 23 response SAV 500, ACT 600, DEF 500
    "86 01 F4 01 58 02 F4 01 DD",
    // 24 SET par 26 low word of −100000
    "01 11 1A 00 60 79 13",
    // 25 SET par 27 high word of −100000
    "01 11 1B 00 FE FF 0A",
    // 26 SET par 66 := 0.3 in Q1.15 = 9830 (2666h, printed value)
    "01 11 42 00 66 26 12",
    // 27 GET par 0
    "01 12 00 00 00 00 13",
    // 28 response release 1.2.0 = 1020h
    "86 01 20 10 20 10 20 10 B7",
    // 29 IOUPDATE (05h): LED on, clear GO capture
    "01 05 00 04 08 00 08",
    // 30 response INP=0C, ACT=08, REV=00
    "86 01 0C 00 08 00 00 00 83",
    // 31 SAVE
    "01 13 00 00 00 00 12",
    // 32 LOAD factory
    "01 14 FF FF 00 00 15",
    // 33 RESET, BL=0
    "01 00 00 00 00 00 01",
    // 34 reject response: GOTO in mode 0 → REJ_BADMODE
    "80 81 00 00 00 00 02 00 03",
    // 35 reject response: REJ_WORKING during SAVE
    "BE 81 00 00 00 00 01 00 3E",
];

/// Bytes of vector `number`.
pub(crate) fn vector(number: usize) -> Vec<u8> {
    VECTORS[number - 1].split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}
