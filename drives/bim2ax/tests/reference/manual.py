"""What the manual prints, as tables; paragraphs of rev. D in brackets.

Where it contradicts itself the reading is: plug 2 is at $42, the motor test is acknowledged with bit 15, four parameter
orders exist, and what is refused is a number that the table of parameters does not have.
The memory file has the 1 KiB of RAM, then status, identifier, page, interrupts, interrupts served.
"""

import mmap
import struct

STATUS, IDENTIFIER, PAGE, INTERRUPTS, SERVED, LENGTH = 0x400, 0x401, 0x402, 0x403, 0x404, 0x405
OUT, IN = 0x300, 0x380  # pages 6 and 7 (9.1)
ZONE, IT, ENTRIES, RECEIPT, DOORBELL = 0x00, 0x01, 0x70, 0x70, 0x7F

# (9.1.2, 9.1.1) zone: number, offset, fields, big-endian.
WRITTEN = {
    "ordre": (0, 0x02, ">HHII"),
    "position 1": (1, 0x0E, ">iHHI"),
    "position 2": (2, 0x1A, ">iHHI"),
    "parametre": (3, 0x26, ">HHII"),
}
READ = {
    "position": (0, 0x02, ">iiHH"),
    "acquittement": (1, 0x0E, ">HHII"),
    "parametre": (2, 0x1A, ">HHII"),
    "points": (3, 0x26, ">iiHH"),
    "pas": (4, 0x32, ">iiHH"),
    "bouchons": (5, 0x3E, ">III"),
}
RECEIPTS = {"ordre": 0x01, "parametre": 0x08}  # (9.2.4)


def bits(text):
    """Names of bits by their numbers, as a table prints them: "0 HOME  1 PROGRAMMED"."""
    words = text.split()
    return {name: 1 << int(number) for number, name in zip(words[::2], words[1::2])}


# (2.1.1) orders of an axis, and of a programmed move.
UC = bits("""0 HOME 1 PROGRAMMED 3 ABANDON 4 PLUS 5 MINUS 6 TO_PLUS 7 TO_MINUS 8 HARD 9 OFF 10 ON 15 TEST""")
BLOC = bits("""4 ZERO 5 FORCE 6 RELATIVE 7 PRESET 8 SPEED 11 NO_APPROACH""")
REFERENCES = range(1, 11)
# (2.2.2) what a register says of the same bits while it is so, and at the end of a programmed move.
ACK = {name: UC[name] for name in ("HOME", "PROGRAMMED", "ABANDON", "PLUS", "MINUS", "TO_PLUS", "TO_MINUS", "HARD", "OFF", "TEST")}
ACK_BLOC = bits("4 ZEROED 5 FORCED 24 NO_REFERENCE")
MOVES = ("HOME", "PROGRAMMED", "PLUS", "MINUS", "TO_PLUS", "TO_MINUS")
# (2.2.1) messages of an axis.
MESSAGE = bits("""0 SWITCH_PLUS 1 SWITCH_MINUS 2 SOFT_PLUS 3 SOFT_MINUS 4 HOMED 5 MOVING 6 HARD 7 NO_PHASES
    9 OPEN 10 SHORT 11 NO_POWER 13 CAM 14 REFUSED""")
# (2.2.3) messages of the card.
CARD = bits("0 CHECKSUM 1 AXIS_1 2 AXIS_2 3 WRITE 4 READ 5 MOVING 6 ORDER")
# (2.2.4) messages of an encoder.
ENCODER = bits("0 DIVISOR 1 FAULT 2 PLUG 4 CORRECTED 5 ALARM 13 ENDAT 14 SSI 15 INCREMENTAL")
# (3.1.1) coefficient.
COEFFICIENT = bits("""0 PRESENT 1 HOME_PLUS 2 REVERSE 3 SWAP 4 NO_SWITCHES 6 MUST_HOME 7 CAM_CLOSES 8 APPROACH
    9 APPROACH_PLUS 10 BRUTAL 11 NO_CLEARING 12 WEAK_TEST 14 SWITCHES_CLOSE 15 NO_TEST""")
# (2.1.3, 2.2.3) parameter orders.
WRITE, READ_ORDER, PLUGS, RESET = 0x1000, 0x2000, 0x4000, 0x8000
ABSENT = 0xFFFFFFFF

FAR = 4194303
# (3) number, name, access, RESET, lowest and highest value that any module takes: of currents those of the 2 A one. Two
# numbers are axis 1 and axis 2.
PARAMETERS = [row.split() for row in """
    00 01 coefficient RW reset 0     0xDFDF
    02 03 mode        RW reset 0     0x600
    04 05 current     RW reset 60    2000
    06 07 holding     RW reset 60    2000
    08 09 origin      RW reset 0     65535
    0A 0B fast        RW reset 1     65535
    0C 0D mini        RW reset 1     65535
    0E 0F approach    RW -     0     65535
    10 11 soft_plus   RW -     -4194303 4194303
    12 13 soft_minus  RW -     -4194303 4194303
    14 15 ramp        RW reset 1     65535
    2A 2B hysteresis  RW -     0     65535
    2C 2D dividend    RW reset 1     65535
    2E 2F divisor     RW reset 1     65535
    30 31 offset      RW reset -2147483648 2147483647
    34 35 bits        RW reset 0     25
    36 37 definition  RW reset 0     0x3F3F
    38 39 last        RO -     0 0
    3E 3F crc         RO -     0 0
    40 41 last_points RO -     0 0
""".strip().splitlines()] + [
    [f"{0x15 + place:02X}", f"{0x1F + place:02X}", f"reference_{place}", "RW", "-", "-4194303", "4194303"]
    for place in REFERENCES
]
NUMBERS = {row[2]: (int(row[0], 16), int(row[1], 16)) for row in PARAMETERS}
RATING, VERSION, FLASH_CRC = 0x62, 0x63, 0x3C
KNOWN = {number for pair in NUMBERS.values() for number in pair} | {0x32, 0x33, 0x3A, 0x3B, 0x3C, 0x3D, RATING, VERSION}
WRITABLE = {number for row in PARAMETERS if row[3] == "RW" for number in NUMBERS[row[2]]} | {0x32, 0x33}


def memory(path):
    with open(path, "r+b") as file:
        return mmap.mmap(file.fileno(), LENGTH)


def unsigned(value):
    return value & 0xFFFFFFFF


def signed(value):
    return value - (1 << 32) if value >> 31 else value


def field(page, table, zone):
    _, offset, form = table[zone]
    return page + offset, page + offset + struct.calcsize(form), form
