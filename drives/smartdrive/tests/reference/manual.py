"""What the manual prints, as tables.

Where it contradicts itself the reading is: flags in the bits of the TAG diagram, IOUPDATE is 05h and answers INP, -,
ACT, REV, GOTO and STEP with velocity have EE = 1.
"""

import struct

# "Description des commandes": name, CC, data (x is a byte that stays 0), fields, kind of answer, only in mode 3.
# EE follows from the size of the data.
COMMANDS = [
    ("RESET", 0x00, "<Bxxx", "BL", "POS", False),
    ("PING", 0x01, "<xxxx", "", "POS", False),
    ("MODE", 0x04, "<Bxxx", "MOD", "POS", False),
    ("IOUPDATE", 0x05, "<BBBB", "CLR SET CACT CREV", "IO", False),
    ("WRITE", 0x0E, "<HxxI", "VAR NEW", "VALUE", False),
    ("READ", 0x0F, "<Hxx", "VAR", "VALUE", False),
    ("SET", 0x11, "<HH", "PAR NEW", "PAR", False),
    ("GET", 0x12, "<Hxx", "PAR", "PAR", False),
    ("SAVE", 0x13, "<xxxx", "", "VALUE", False),
    ("LOAD", 0x14, "<Hxx", "SRC", "VALUE", False),
    ("TRJINIT", 0x20, "<Bxxx", "INI", "POS", True),
    ("START", 0x21, "<hH", "VEL ACC", "POS", True),
    ("STOP", 0x22, "<xxH", "DEC", "POS", True),
    ("GOTO", 0x23, "<i", "DST", "POS", True),
    ("GOTO", 0x23, "<iHH", "DST VEL ACC", "POS", True),
    ("STEP", 0x24, "<i", "DST", "POS", True),
    ("STEP", 0x24, "<iHH", "DST VEL ACC", "POS", True),
]
# "Trame de réponse": STA, four bytes of data, TAG; for parameters TAG is the factory's value.
ANSWERS = {
    "POS": ("<HiHB", "STA POS TAG CHK"),
    "IO": ("<HBxBBHB", "STA INP ACT REV TAG CHK"),
    "VALUE": ("<HIHB", "STA DAT TAG CHK"),
    "PAR": ("<HHHHB", "STA SAV ACT TAG CHK"),
}
REJECT, SEQBUSY, RESPONSE, ALARM = 1 << 15, 1 << 13, 1 << 7, 1
GENERIC, WORKING, BADMODE, BADPARAMS, NOTAVAILABLE = range(5)
DONE, INMOTION, TRIGGERED, STALLED, LIMITED, LIMITEDP, LIMITEDN = (1 << bit for bit in (0, 8, 9, 10, 11, 12, 13))
OFF, REMOTE, IDLE, USER = 0, 3, 31, 255
MODES = (0, 1, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12)
INIT_POSITION, INIT_HOMING, INIT_ENCODERS, INIT_ENCODER1, INIT_ENCODER2 = 1, 2, 3, 4, 5
FACTORY = 0xFFFF
LINES = ("RDY", "BRK", "LED", "GO", "DIR", "OFF", "LIMP", "LIMN")  # bits 0 to 7 of INP

# "Paramètres de configuration": index, name, access, type, lowest and highest value; of 32 bits the high word follows.
PARAMETERS = [row.split() for row in """
    0   Release        RO U16 0 65535
    2   Address        RW P16 1 31
    12  PID            RO U16 0x5342 0x5342
    13  CID            RO U16 0x0101 0x0101
    16  Flags          RW U32 0 0xFFFFFFFF
    26  PosMin         RW S32 -0x80000000 0x7FFFFFFF
    28  PosMax         RW S32 -0x80000000 0x7FFFFFFF
    30  VelMax         RW P16 1 32767
    31  AccMax         RW P16 1 32767
    32  DecMax         RW P16 0 32767
    33  DecLim         RW P16 0 32767
    43  FullSteps      RW P16 1 32767
    44  StepDivisor    RW P16 1 1024
    48  Enc1           RW P16 1 32767
    50  Enc2           RW P16 1 32767
    65  CurMax         RW Q15 0 32767
    66  CurIdle        RW Q15 0 32767
    67  CurRun         RW Q15 0 32767
    68  CurAcc         RW Q15 0 32767
    100 PosOffset      RW S32 -0x80000000 0x7FFFFFFF
    102 PushPull       RW S32 -0x80000000 0x7FFFFFFF
    104 PushPullAlt    RW S32 -0x80000000 0x7FFFFFFF
    106 AutoGOPeriod   RW P32 0 0x7FFFFFFF
    108 AutoGODuration RW P32 0 0x7FFFFFFF
    116 VelEnterHome   RW P16 0 32767
    117 VelExitHome    RW P16 0 32767
    118 AccHome        RW P16 0 32767
    119 DecHome        RW P16 0 32767
    120 CfgHome        RW U16 0 65535
""".strip().splitlines()]
# "Variables": index, access, lowest and highest value. 85 has two names and is left out.
VARIABLES = {
    **{index: ("RO", 0, 32767) for index in (42, 43, 67, 81)},
    **{index: ("RO", -0x80000000, 0x7FFFFFFF) for index in (44, 45, 74, 75)},
    **{index: ("RO", -32768, 32767) for index in (78, 79)},
    84: ("RO", 0, 32767),
    68: ("RO", 0, 65535),
    **{index: ("RW", 0, 65535) for index in (128, 129, 130)},
    **{index: ("RO", 0, 65535) for index in range(136, 156)},
}


def xor(data):
    check = 0
    for byte in data:
        check ^= byte
    return check


def request(address, name, **fields):
    for known, code, form, words, _, _ in COMMANDS:
        if known == name and words.split() == list(fields):
            extent = {4: 0, 8: 1, 16: 2, 32: 3}[struct.calcsize(form)]
            frame = bytes((address, extent << 6 | code)) + struct.pack(form, *fields.values())
            return frame + bytes((xor(frame),))
    raise KeyError((name, fields))
