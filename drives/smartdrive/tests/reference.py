#!/usr/bin/env python3
"""A second reading of "SmartDRIVE v1.2 - Protocole série ATB", made of tables, to witness for the first.

    reference.py master PORT   asks the module on PORT everything the manual has and checks what it says
    reference.py device        is a module on a terminal of its own, which it names, until its standard input ends

The master says on its standard output what it wants done at the module ("press LIMP") and waits for a line;
the device takes such lines on its standard input and answers each with one.
Where the manual contradicts itself the reading is: flags in the bits of the TAG diagram, IOUPDATE is 05h and
answers INP, -, ACT, REV, GOTO and STEP with velocity have EE = 1.
Standard library only.
"""

import os
import pty
import select
import struct
import sys
import time
import tty

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


def open_raw(path):
    port = os.open(path, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(port)
    return port


class Refused(Exception):
    pass


class Master:
    def __init__(self, path):
        self.port, self.address = open_raw(path), 1

    def receive(self, seconds):
        answer = b""
        while len(answer) < 9 and select.select([self.port], [], [], seconds)[0]:
            answer += os.read(self.port, 9 - len(answer))
        return answer

    def exchange(self, frame):
        os.write(self.port, frame)
        answer = self.receive(10)
        assert len(answer) == 9 and xor(answer) == 0, (frame.hex(), answer.hex())
        sta, tag = struct.unpack("<H4xHx", answer)
        assert sta & RESPONSE and sta >> 8 & 31 == self.address, (frame.hex(), answer.hex())
        if sta & REJECT:
            raise Refused(tag)
        return answer

    def silent(self, frame):
        os.write(self.port, frame)
        answer = self.receive(0.3)
        assert answer == b"", (frame.hex(), answer.hex())

    def ask(self, name, **fields):
        answer = self.exchange(request(self.address, name, **fields))
        kind = next(row[4] for row in COMMANDS if row[0] == name)
        form, words = ANSWERS[kind]
        said = dict(zip(words.split(), struct.unpack(form, answer)))
        assert name == "PING" or said["STA"] & ALARM == 0, (name, answer.hex())
        return said

    def refused(self, reasons, name, **fields):
        try:
            said = self.ask(name, **fields)
        except Refused as refusal:
            assert refusal.args[0] in reasons, (name, fields, refusal)
        else:
            raise AssertionError((name, fields, said))

    def raw_refused(self, reasons, frame):
        try:
            self.exchange(frame)
        except Refused as refusal:
            assert refusal.args[0] in reasons, (frame.hex(), refusal)
        else:
            raise AssertionError(frame.hex())

    def please(self, what):
        print(what, flush=True)
        assert sys.stdin.readline().strip() == "done", what

    def until(self, condition, what):
        for _ in range(10000):
            said = self.ask("PING")
            if condition(said):
                return said
            time.sleep(0.002)
        raise SystemExit(f"no {what}")

    def done(self):
        said = self.until(lambda said: said["TAG"] & DONE, "DONE")
        return said["POS"], said["TAG"]

    def mode(self):
        """The mode there is, once none is being changed."""
        said = self.until(lambda said: said["STA"] >> 1 & 31 != IDLE, "end of the change of mode")
        return said["STA"] >> 1 & 31

    def enter(self, mode):
        self.ask("MODE", MOD=mode)
        assert self.mode() == mode

    def get(self, index, wide=False):
        low = self.ask("GET", PAR=index)
        words = [(low[word], self.ask("GET", PAR=index + 1)[word] if wide else 0) for word in ("SAV", "ACT", "TAG")]
        return [high << 16 | low for low, high in words]

    def set(self, index, value, wide=False):
        self.ask("SET", PAR=index, NEW=value & 0xFFFF)
        if wide:
            self.ask("SET", PAR=index + 1, NEW=value >> 16 & 0xFFFF)

    def read(self, index):
        _, lowest, highest = VARIABLES[index]
        value = self.ask("READ", VAR=index)["DAT"]
        if lowest < 0:
            bits = 16 if lowest == -32768 else 32
            value &= (1 << bits) - 1
            value -= (value >> bits - 1) << bits
        assert lowest <= value <= highest, (index, value)
        return value


def frames(it):
    """"Format des messages": whom a frame is for, what is not one, and where the next begins."""
    ping = request(1, "PING")
    it.exchange(ping)
    it.silent(request(2, "PING"))
    it.silent(request(0, "PING"))
    it.silent(ping[:-1] + b"\x55")
    for length in range(1, len(ping)):
        os.write(it.port, ping[:length])
        time.sleep(0.1)
        it.exchange(ping)
    for extent in range(4):
        frame = bytes((1, extent << 6 | 0x3F)) + bytes(4 << extent)
        it.raw_refused((NOTAVAILABLE,), frame + bytes((xor(frame),)))


def modes(it):
    it.enter(OFF)
    for name, _, form, words, _, remote in COMMANDS:
        if remote:
            it.refused((BADMODE,), name, **{word: 1 for word in words.split()})
    for mode in MODES:
        it.enter(mode)
    for mode in (2, 13, 30, 32, 254):
        it.refused((BADPARAMS,), "MODE", MOD=mode)
    it.ask("MODE", MOD=USER)
    it.mode()
    # While the mode changes the module says so; a second long command is refused.
    seen = False
    for _ in range(50):
        it.ask("MODE", MOD=REMOTE)
        idle = it.ask("PING")["STA"] >> 1 & 31 == IDLE
        try:
            it.ask("MODE", MOD=REMOTE)
        except Refused as refusal:
            assert refusal.args[0] == WORKING, refusal
            seen = idle
        assert it.mode() == REMOTE
        if seen:
            return
    raise SystemExit("a change of mode is never seen")


def parameters(it):
    it.enter(OFF)
    for index, name, access, kind, low, high in PARAMETERS:
        index, low, high, wide = int(index), int(low, 0), int(high, 0), kind.endswith("32")
        mask = 0xFFFFFFFF if wide else 0xFFFF
        saved, actual, factory = it.get(index, wide)
        for value in (saved, actual, factory):
            value -= (value >> 31) << 32 if kind == "S32" else 0
            assert low <= value <= high, (name, value)
        if access == "RO":
            it.refused((BADPARAMS, NOTAVAILABLE), "SET", PAR=index, NEW=actual)
            continue
        for value in (low, high) if name != "Address" else (1,):
            it.set(index, value, wide)
            assert it.get(index, wide) == [saved, value & mask, factory], name
        it.set(index, actual, wide)
        if not wide:
            for value in (low - 1, high + 1):
                if 0 <= value <= 0xFFFF:
                    it.refused((BADPARAMS,), "SET", PAR=index, NEW=value)
        elif kind == "P32":
            it.ask("SET", PAR=index, NEW=0)
            it.refused((BADPARAMS,), "SET", PAR=index + 1, NEW=0x8000)
            it.set(index, actual, wide)
        assert it.get(index, wide) == [saved, actual, factory], name
    it.refused((BADPARAMS,), "SET", PAR=44, NEW=3)
    for index in (1, 121, 65535):
        it.refused((BADPARAMS, NOTAVAILABLE), "GET", PAR=index)
        it.refused((BADPARAMS, NOTAVAILABLE), "SET", PAR=index, NEW=0)


def storage(it):
    """The three copies: SAVE writes the working one, LOAD fills it, a reset fills it with what was saved."""
    it.enter(REMOTE)
    factory = it.get(30)[2]
    values = [factory - 1, factory - 2]
    it.set(30, values[0])
    it.ask("SAVE")
    assert it.mode() == REMOTE
    assert it.get(30) == [values[0], values[0], factory]
    it.set(30, values[1])
    assert it.get(30) == [values[0], values[1], factory]
    it.ask("LOAD", SRC=0)
    assert it.mode() == REMOTE
    assert it.get(30) == [values[0], values[0], factory]
    it.ask("LOAD", SRC=FACTORY)
    assert it.mode() == REMOTE
    assert it.get(30) == [values[0], factory, factory]
    it.refused((BADPARAMS,), "LOAD", SRC=1)
    it.set(2, 7)
    it.address = find(it, (1, 7))
    it.ask("SAVE")
    it.mode()
    it.ask("RESET", BL=0)
    it.address = find(it, (7,))
    assert it.get(2)[:2] == [7, 7] and it.get(30) == [factory, factory, factory]
    it.set(2, 1)
    it.address = find(it, (1, 7))
    it.ask("SAVE")
    it.mode()
    it.ask("RESET", BL=0)
    it.address = find(it, (1,))


def find(it, addresses):
    for _ in range(50):
        for address in addresses:
            os.write(it.port, request(address, "PING"))
            if len(it.receive(0.2)) == 9:
                return address
    raise SystemExit(f"nobody at {addresses}")


def variables(it):
    for index, (access, low, high) in VARIABLES.items():
        it.read(index)
        if access == "RO":
            it.refused((BADPARAMS, NOTAVAILABLE), "WRITE", VAR=index, NEW=0)
    for index in (0, 46, 156, 65535):
        it.refused((BADPARAMS, NOTAVAILABLE), "READ", VAR=index)
        it.refused((BADPARAMS, NOTAVAILABLE), "WRITE", VAR=index, NEW=0)
    # Outputs: by variable and by bit, both seen by both.
    for bit, index in enumerate((128, 129, 130)):
        for value in (0xFFFF, 0):
            assert it.ask("WRITE", VAR=index, NEW=value)["DAT"] == value
            assert it.ask("IOUPDATE", CLR=0, SET=0, CACT=0, CREV=0)["INP"] >> bit & 1 == value & 1
        for clear, set_, expected in ((0, 1, 1), (0, 0, 1), (1, 0, 0), (0, 0, 0)):
            said = it.ask("IOUPDATE", CLR=clear << bit, SET=set_ << bit, CACT=0, CREV=0)
            assert said["INP"] >> bit & 1 == expected
            assert it.read(index) == 0xFFFF * expected
    # Inputs: state and captures, by bit and by variable (state, either edge, active edge, inverse edge).
    it.ask("IOUPDATE", CLR=0, SET=0, CACT=0xFF, CREV=0xFF)
    for bit in range(3, 8):
        name, first = LINES[bit], 136 + 4 * (bit - 3)
        for action, inp, act, rev in (("", 0, 0, 0), ("press", 1, 1, 0), ("release", 0, 1, 1)):
            if action:
                it.please(f"{action} {name}")
            said = it.ask("IOUPDATE", CLR=0, SET=0, CACT=0, CREV=0)
            assert [said[word] >> bit & 1 for word in ("INP", "ACT", "REV")] == [inp, act, rev], (name, action, said)
            expected = [0xFFFF * flag for flag in (inp, act | rev, act, rev)]
            assert [it.read(first + k) for k in range(4)] == expected, (name, action)
        said = it.ask("IOUPDATE", CLR=0, SET=0, CACT=1 << bit, CREV=0)
        assert (said["ACT"] >> bit & 1, said["REV"] >> bit & 1) == (0, 1), (name, said)
        said = it.ask("IOUPDATE", CLR=0, SET=0, CACT=0, CREV=1 << bit)
        assert (said["ACT"] >> bit & 1, said["REV"] >> bit & 1) == (0, 0), (name, said)


def prepare(it):
    """A motor of 200 x 16 microsteps: 1 rpm is 160/3 microsteps/s."""
    it.enter(OFF)
    for index, value in ((43, 200), (44, 16), (30, 1200), (31, 3000), (32, 3000), (33, 6000), (48, 400), (50, 400)):
        it.set(index, value)
    it.set(26, -0x80000000, True)
    it.set(28, 0x7FFFFFFF, True)
    it.enter(REMOTE)
    said = it.ask("PING")
    assert said["POS"] == 0 and said["TAG"] & INMOTION == 0


def moves(it):
    prepare(it)
    # GOTO and STEP end at the target; the variables agree with POS.
    for name, fields, end in (
        ("GOTO", {"DST": 3200}, 3200),
        ("GOTO", {"DST": -6400, "VEL": 300, "ACC": 1000}, -6400),
        ("STEP", {"DST": 200}, -6200),
        ("STEP", {"DST": -1800, "VEL": 600, "ACC": 2000}, -8000),
        ("GOTO", {"DST": 0, "VEL": 0, "ACC": 0}, 0),
    ):
        said = it.ask(name, **fields)
        assert said["TAG"] & DONE == 0, (name, fields)
        fastest, moving = 0, False
        while not (said := it.ask("PING"))["TAG"] & DONE:
            fastest = max(fastest, abs(it.read(79)))
            moving = moving or said["TAG"] & INMOTION != 0
        assert moving and fastest <= (fields.get("VEL") or 1200), (name, fields, fastest)
        assert (said["POS"], said["TAG"]) == (end, DONE), (name, fields, said)
        assert it.read(74) == it.read(75) == end and it.read(78) == it.read(79) == 0
    # START reaches its speed, is followed by another while it runs, and stops within v^2 / 2a.
    for first, acceleration, second, stop in ((600, 0, 900, 1000), (-600, 2000, 300, 0)):
        it.ask("START", VEL=first, ACC=acceleration)
        assert it.done()[1] == DONE | INMOTION and it.read(78) == it.read(79) == first
        assert it.ask("START", VEL=second, ACC=acceleration)["TAG"] & DONE == 0
        assert it.done()[1] == DONE | INMOTION and it.read(78) == it.read(79) == second
        at = it.ask("STOP", DEC=stop)
        assert at["TAG"] & DONE == 0
        stands, tag = it.done()
        way = second**2 / (2 * (stop or 3000)) * 160 / 3
        assert tag == DONE and abs(stands - at["POS"] - way) < 0.02 * way, (second, stop, at, stands, way)
    # Targets are changed under way, a stop to all is obeyed and not answered, the ceiling of speed is one.
    it.ask("GOTO", DST=10_000_000)
    it.until(lambda said: said["TAG"] & INMOTION, "motion")
    it.ask("GOTO", DST=0)
    assert it.done() == (0, DONE)
    it.ask("START", VEL=100, ACC=0)
    it.done()
    it.silent(request(0, "STOP", DEC=0))
    assert it.done()[1] == DONE
    it.ask("START", VEL=-32768, ACC=32767)
    it.until(lambda said: said["TAG"] & DONE, "speed")
    assert it.read(79) == -1200
    it.ask("STOP", DEC=32767)
    it.done()


def origins(it):
    position, _ = it.done()
    it.ask("STEP", DST=3200)
    assert it.done() == (position + 3200, DONE)
    before = [it.read(44), it.read(45)]
    assert 0 not in before
    it.ask("TRJINIT", INI=INIT_ENCODER1)
    assert [it.read(44), it.read(45)] == [0, before[1]]
    it.ask("TRJINIT", INI=INIT_ENCODER2)
    assert [it.read(44), it.read(45)] == [0, 0]
    it.ask("STEP", DST=3200)
    assert it.done() == (position + 6400, DONE)
    assert [it.read(44), it.read(45)] == [400, 400]
    it.ask("TRJINIT", INI=INIT_ENCODERS)
    assert [it.read(44), it.read(45)] == [0, 0] and it.ask("PING")["POS"] == position + 6400
    it.ask("TRJINIT", INI=INIT_POSITION)
    assert it.ask("PING")["POS"] == it.read(75) == 0
    it.refused((BADPARAMS,), "TRJINIT", INI=6)
    # Homing on the switch with the user's parameters: a sequence that ends with DONE.
    for index, value in ((116, 300), (117, 30), (118, 3000), (119, 3000)):
        it.set(index, value)
    it.set(100, -123, True)
    said = it.ask("TRJINIT", INI=INIT_HOMING)
    assert said["STA"] & SEQBUSY and said["TAG"] & DONE == 0, said
    while (said := it.ask("PING"))["STA"] & SEQBUSY:
        assert said["TAG"] & DONE == 0, said
    assert said["TAG"] & DONE and said["POS"] == it.read(75), said
    it.ask("STEP", DST=50)
    assert it.done()[0] == said["POS"] + 50
    # A new mode initialises the generator.
    it.enter(REMOTE)
    assert it.ask("PING")["POS"] == 0


def stops(it):
    """What ends a move from outside: limit switches, alarms, and a move forgets them."""
    it.enter(REMOTE)
    for velocity, switch, flag in ((600, "LIMP", LIMITEDP), (-600, "LIMN", LIMITEDN)):
        it.ask("START", VEL=velocity, ACC=0)
        it.done()
        it.please(f"press {switch}")
        said = it.until(lambda said: said["TAG"] & INMOTION == 0, "end at the switch")
        assert said["TAG"] & (LIMITED | LIMITEDP | LIMITEDN) == LIMITED | flag, said
        it.please(f"release {switch}")
        assert it.ask("STEP", DST=-1600 if velocity > 0 else 1600)["TAG"] & LIMITED == 0
        assert it.done()[1] == DONE
    for bit in (0, 1, 2, 3, 4, 5, 6, 11):
        it.ask("START", VEL=60, ACC=0)
        it.please(f"alarm {bit}")
        said = it.until(lambda said: said["STA"] & ALARM, "alarm")
        assert said["STA"] >> 1 & 31 == OFF and said["TAG"] == 1 << bit, said
        assert it.read(68) == 1 << bit
        it.refused((BADMODE,), "GOTO", DST=0)
        it.please(f"clear {bit}")
        it.enter(REMOTE)
        said = it.ask("PING")
        assert said["STA"] & ALARM == 0 and said["POS"] == 0 and it.read(68) == 0


def bootloader(it):
    it.ask("RESET", BL=1)
    for _ in range(3):
        it.silent(request(1, "PING"))


class Device:
    """A module whose moves take a few exchanges instead of a time; otherwise as the master reads it in the manual."""

    def __init__(self):
        self.terminal, kept = pty.openpty()
        tty.setraw(kept)
        self.kept, self.name = kept, os.ttyname(kept)
        self.address, self.configured = 1, OFF
        self.words = {}
        for index, _, _, kind, low, _ in PARAMETERS:
            index, low = int(index), int(low, 0)
            self.words[index] = (low if low > 0 else 0) & 0xFFFF
            if kind.endswith("32"):
                self.words[index + 1] = 0
        self.words.update({0: 0x13B0, 2: 1, 30: 1200, 31: 3000, 32: 3000, 43: 200, 44: 16, 26: 0, 27: 0x8000, 28: 0xFFFF, 29: 0x7FFF})
        self.factory, self.saved = dict(self.words), dict(self.words)
        self.variables = {index: 0 for index in VARIABLES}
        self.variables[67] = 48
        self.mode, self.wanted, self.changing = OFF, OFF, 0
        self.position, self.flags, self.coming = 0, DONE, []
        self.alarms, self.busy, self.speed = 0, False, 0
        self.lines, self.active, self.inverse = 0, 0, 0
        self.refuse, self.echo, self.table, self.asked, self.deaf = None, False, False, [], 0.0

    def stay(self, command, *words):
        """What is done at the module by hand."""
        if command == "press" or command == "release":
            bit = LINES.index(words[0])
            self.lines = self.lines & ~(1 << bit) | (command == "press") << bit
            if command == "press":
                self.active |= 1 << bit
            else:
                self.inverse |= 1 << bit
        elif command == "alarm":
            self.alarms, self.mode, self.coming = int(words[0], 0), OFF, []
            self.flags = DONE
        elif command == "flags":
            self.flags, self.coming = int(words[0], 0), []
        elif command == "refuse":
            self.refuse = int(words[0])
        elif command == "echo":
            self.echo = words[0] == "on"
        elif command == "layout":
            self.table = words[0] == "table"
        elif command == "variable":
            self.variables[int(words[0])] = int(words[1], 0)
        elif command == "requests":
            said, self.asked = " | ".join(self.asked), []
            return said
        else:
            raise KeyError(command)
        return "done"

    def step(self):
        """One exchange later."""
        if self.changing:
            self.changing -= 1
            if self.changing == 0:
                self.mode, self.position, self.flags, self.coming = self.wanted, 0, DONE, []
        if self.coming:
            self.position = self.coming.pop(0)
            self.flags = INMOTION
            if not self.coming:
                self.flags, self.busy = DONE, False
        elif self.speed:
            self.position += self.speed
            self.flags = DONE | INMOTION

    def change(self, mode):
        self.wanted, self.mode, self.changing, self.busy, self.speed = mode, IDLE, 3, False, 0

    def towards(self, target):
        self.speed, way = 0, target - self.position
        self.coming = [self.position + way * k // 4 for k in range(5)]
        self.flags = 0

    def execute(self, name, fields):
        """Carries out; gives the four bytes and the word of the answer, or the reason why not."""
        get = fields.get
        place = struct.pack("<i", self.position)
        if name == "PING" or name == "RESET" or name == "MODE" or name == "TRJINIT":
            if name == "MODE":
                known = get("MOD") in MODES or get("MOD") == USER
                if not known:
                    return BADPARAMS
                self.alarms = 0
                self.change(self.configured if get("MOD") == USER else get("MOD"))
            elif name == "RESET":
                self.words, self.mode, self.position, self.flags = dict(self.saved), self.configured, 0, DONE
                self.deaf = time.monotonic() + (0.25 if get("BL") == 0 else 1e9)
            elif get("INI") == INIT_HOMING:
                offset = self.words[100] | self.words[101] << 16
                self.towards(offset - ((offset >> 31) << 32))
                self.busy = True
            elif get("INI") in (INIT_ENCODERS, INIT_ENCODER1, INIT_ENCODER2):
                for index, kinds in ((44, (3, 4)), (45, (3, 5))):
                    if get("INI") in kinds:
                        self.variables[index] = 0
            elif name == "TRJINIT":
                if get("INI") > INIT_ENCODER2:
                    return BADPARAMS
                self.position, self.coming, self.flags, self.speed = 0, [], DONE, 0
        elif name == "GOTO" or name == "STEP":
            self.towards(get("DST") + (self.position if name == "STEP" else 0))
        elif name == "START":
            # Microsteps in ten milliseconds.
            self.speed, self.flags, self.coming = get("VEL") * self.words[43] * self.words[44] // 6000, 0, []
        elif name == "STOP":
            self.towards(self.position + self.speed)
        elif name == "IOUPDATE":
            for bit in (1, 2, 4):
                if (get("SET") ^ get("CLR")) & bit:
                    self.lines = self.lines & ~bit | get("SET") & bit
            self.active &= ~get("CACT")
            self.inverse &= ~get("CREV")
            return bytes((self.lines, 0xA5, self.active, self.inverse)), 0xA5A5
        elif name == "READ" or name == "WRITE":
            index = get("VAR")
            if index not in self.variables:
                return NOTAVAILABLE
            if name == "WRITE":
                if VARIABLES[index][0] == "RO" or get("NEW") not in (0, 0xFFFF):
                    return BADPARAMS
                bit = 1 << index - 128
                self.lines = self.lines & ~bit | (bit if get("NEW") else 0)
            return struct.pack("<I", self.value(index) & 0xFFFFFFFF), 0xA5A5
        elif name == "GET" or name == "SET":
            index = get("PAR")
            if index not in self.words:
                return NOTAVAILABLE
            if name == "SET":
                if not self.allowed(index, get("NEW")):
                    return BADPARAMS
                self.words[index] = get("NEW")
            return struct.pack("<HH", self.saved[index], self.words[index]), self.factory[index]
        elif name == "SAVE" or name == "LOAD":
            if name == "SAVE":
                self.saved = dict(self.words)
            elif get("SRC") in (0, FACTORY):
                self.words = dict(self.factory if get("SRC") else self.saved)
            else:
                return BADPARAMS
            self.change(self.mode)
            return b"\xA5\xA5\xA5\xA5", 0xA5A5
        return place, None

    def allowed(self, index, value):
        for first, name, access, kind, low, high in PARAMETERS:
            first, wide = int(first), kind.endswith("32")
            if index == first + 1 and wide:
                return kind != "P32" or value < 0x8000
            if index == first:
                power = name != "StepDivisor" or value & value - 1 == 0
                return access == "RW" and power and (wide or int(low, 0) <= value <= int(high, 0))
        return False

    def value(self, index):
        if index in (74, 75):
            return self.position
        if index == 68:
            return self.alarms
        if 128 <= index <= 130:
            return 0xFFFF * (self.lines >> index - 128 & 1)
        if 136 <= index < 156:
            bit = 3 + (index - 136) // 4
            state, active, inverse = (word >> bit & 1 for word in (self.lines, self.active, self.inverse))
            return 0xFFFF * (state, active | inverse, active, inverse)[index % 4]
        return self.variables[index]

    def serve(self, frame):
        """The answer to a whole frame with its check, none to one for others or for all."""
        if frame[0] not in (0, self.address):
            return b""
        for name, code, form, words, kind, remote in COMMANDS:
            if code == frame[1] & 0x3F and struct.calcsize(form) == len(frame) - 3:
                fields = dict(zip(words.split(), struct.unpack(form, frame[2:-1])))
                break
        else:
            name, fields, kind, remote = f"{frame[1]:02X}h", {}, "POS", False
            outcome = NOTAVAILABLE
        whole = fields and request(frame[0], name, **fields) != frame
        self.asked.append(" ".join([name, *(f"{key}={value}" for key, value in fields.items()), *(["unclean"] if whole else [])]))
        self.step()
        if self.refuse is not None:
            outcome, self.refuse = self.refuse, None
        elif not name.endswith("h"):
            if self.changing and name not in ("PING", "READ", "GET"):
                outcome = WORKING
            elif remote and self.mode != REMOTE:
                outcome = BADMODE
            else:
                outcome = self.execute(name, fields)
        if frame[0] == 0:
            return b""
        sta = self.address << 8 | RESPONSE | self.mode << 1 | (SEQBUSY if self.busy else 0)
        flags = self.flags & 1 | self.flags >> 7 & 0x7E if self.table else self.flags
        if isinstance(outcome, int):
            data, tag, sta = struct.pack("<i", self.position), outcome, sta | REJECT
        else:
            data, tag = outcome
            if name == "PING" and self.alarms:
                sta, tag = sta | ALARM, self.alarms
            elif tag is None:
                tag = flags
        answer = struct.pack("<H", sta) + data + struct.pack("<H", tag)
        return answer + bytes((xor(answer),))

    def run(self):
        print(self.name, flush=True)
        bus, lines = b"", b""
        while True:
            ready = select.select([self.terminal, 0], [], [], 0.02 if bus else None)[0]
            if not ready:
                bus = b""  # a silence: what follows is a new frame
            if self.terminal in ready:
                bus += os.read(self.terminal, 64)
                if time.monotonic() < self.deaf:
                    bus = b""
                while len(bus) >= 2 and len(bus) >= (length := 3 + (4 << (bus[1] >> 6))):
                    frame, bus = bus[:length], bus[length:]
                    if xor(frame) == 0:
                        answer = self.serve(frame)
                        os.write(self.terminal, (frame if self.echo else b"") + answer)
                    else:
                        self.asked.append(f"damaged {frame.hex()}")
            if 0 in ready:
                more = os.read(0, 4096)
                if not more:
                    return
                *whole, lines = (lines + more).split(b"\n")
                for line in whole:
                    print(self.stay(*line.decode().split()), flush=True)


if __name__ == "__main__":
    if sys.argv[1] == "device":
        Device().run()
    else:
        master = Master(sys.argv[2])
        for part in (frames, modes, parameters, variables, storage, moves, origins, stops, bootloader):
            part(master)
            print(f"agreed {part.__name__}", flush=True)
