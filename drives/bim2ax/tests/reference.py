#!/usr/bin/env python3
"""A second reading of the BIM2AX-BOCM manual (rev. D), made of tables, to witness for the first.

    reference.py host FILE     drives the module that is emulated on a memory file and checks what it says
    reference.py module FILE   is a module on a memory file until its standard input ends

The memory file has the 1 KiB of RAM, then status, identifier, page, interrupts, interrupts served.
Standard library only.
"""

import mmap
import select
import struct
import sys
import time

STATUS, IDENTIFIER, PAGE, INTERRUPTS, SERVED, LENGTH = 0x400, 0x401, 0x402, 0x403, 0x404, 0x405
OUT, IN = 0x300, 0x380  # pages 6 and 7 (9.1)

# 9.1.2, 9.1.1: zone: (offset, fields), big-endian.
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
# 2.1.1, 2.2.1
HOME, PROGRAMMED, PLUS, STOP, OFF, ON = 0x1, 0x2, 0x10, 0x100, 0x200, 0x400
HOMED, MOVING, HARD, NO_PHASES, ON_CAM = 0x10, 0x20, 0x40, 0x80, 0x2000


def memory(path):
    with open(path, "r+b") as file:
        return mmap.mmap(file.fileno(), LENGTH)


class Host:
    """9.2.2 and 9.2.3 word by word."""

    def __init__(self, path):
        self.ram = memory(path)
        self.wait(lambda: self.ram[IDENTIFIER] == 0x4E and self.ram[STATUS] & 1 == 0, "start")

    @staticmethod
    def wait(condition, what):
        for _ in range(20000):
            if condition():
                return
            time.sleep(0.001)
        raise SystemExit(f"no {what} in 20 s")

    def interrupt(self):
        served = self.ram[SERVED]
        self.ram[IN + 0x7F] = 1
        self.ram[INTERRUPTS] = (self.ram[INTERRUPTS] + 1) & 0xFF
        self.wait(lambda: self.ram[SERVED] != served, "answer")

    def write(self, zone, *values):
        number, offset, form = WRITTEN[zone]
        self.ram[IN + 0x70 : IN + 0x74] = bytes(4)
        self.ram[IN] = number << 4
        self.ram[IN + offset : IN + offset + 12] = struct.pack(form, *values)
        self.ram[IN + 1] = 1
        self.interrupt()

    def read(self, zone):
        number, offset, form = READ[zone]
        self.ram[IN] = 0xF0 | number
        self.ram[IN + 1] = 1
        self.ram[IN + 0x70 : IN + 0x74] = bytes(4)
        self.interrupt()
        assert self.ram[OUT] == number, (zone, self.ram[OUT])
        return struct.unpack(form, self.ram[OUT + offset : OUT + offset + 12])

    def rest(self):
        self.wait(lambda: not any(word & MOVING for word in self.read("position")[2:]), "rest")
        return self.read("position")


def host(path):
    """What is written, what is expected to be read: the examples of the manual in the order of its chapters."""
    it = Host(path)
    assert it.read("position") == (0, 0, NO_PHASES, NO_PHASES)
    for number, value in ((0x0A, 10000), (0x62, 2000), (0x63, 15)):
        it.write("parametre", 0x2000, number, 0, 0)
        assert it.read("parametre") == (0x2000, number, value, 6), hex(number)
    it.write("parametre", 0x1000, 0x06, 0xC8, 0)
    assert it.read("parametre") == (0x1000, 0x06, 0xC8, 6)
    for order, number, error in ((0x1000, 0x62, 8), (0x2000, 0x64, 0x10), (0x3000, 0, 0x40)):
        it.write("parametre", order, number, 1, 0)
        assert it.read("parametre")[3] == 6 | error, hex(order)
    it.write("ordre", 0, HOME, 0, 0)
    assert it.rest()[1::2] == (0, HOMED | ON_CAM)
    it.write("ordre", 0, PLUS, 0, 0)
    assert it.read("acquittement") == (0, PLUS, 0, 0)
    it.write("ordre", 0, 0, 0, 0)
    stands = it.rest()[1]
    assert stands > 0
    it.write("position 2", stands + 2000, 0, 0, 0)
    it.write("ordre", 0, PROGRAMMED, 0, 0)
    assert it.rest()[1::2] == (stands + 2000, HOMED)
    it.write("position 1", 400, 500, 0, 0)
    it.write("position 2", -800, 1000, 0, 0)
    it.write("ordre", PROGRAMMED, PROGRAMMED, 0x140, 0x140)
    assert it.rest()[:2] == (400, stands + 1200)
    it.write("ordre", 0, PROGRAMMED, 0, 0x10)
    assert it.read("acquittement") == (0, 0, 0, 0x10)
    it.write("position 1", 12345, 0, 0, 0)
    it.write("ordre", PROGRAMMED, 0, 0xA0, 0)
    assert it.read("position")[0] == 12345
    it.write("position 1", -4194303, 1, 0, 0)
    it.write("ordre", PROGRAMMED, 0, 0x100, 0)
    it.write("ordre", STOP, STOP, 0, 0)
    assert it.read("acquittement")[:2] == (STOP, 0)
    assert it.read("position")[2:] == (HARD, HOMED)
    it.write("ordre", OFF, 0, 0, 0)
    assert it.read("position")[2] & NO_PHASES
    it.write("parametre", 0x4000, 2, 0, 0)
    it.wait(lambda: it.read("parametre")[:2] == (0x4000, 2), "plug")
    assert it.read("bouchons") == (0xFFFFFFFF, 0xFFFFFFFF, 0)


class Module:
    """Moves take no time here; everything else is as the host reads it in the manual."""

    def __init__(self, path):
        self.ram = memory(path)
        self.parameters = {0x62: 5000, 0x63: 17}
        self.position, self.messages = [0, 0], [NO_PHASES, NO_PHASES]
        self.ack, self.bloc = [0, 0], [0, 0]
        self.target = [0, 0]
        self.answer = [0, 0, 0]
        self.ram[IDENTIFIER], self.ram[STATUS] = 0x4E, 0
        self.seen = self.ram[INTERRUPTS]

    def field(self, zone):
        _, offset, form = WRITTEN[zone]
        return struct.unpack(form, self.ram[IN + offset : IN + offset + 12])

    def take(self, number):
        if number == 0:
            uc1, uc2, bloc1, bloc2 = self.field("ordre")
            self.ram[OUT + 0x70] &= 0xFE
            for axis, order, bloc in ((0, uc1, bloc1), (1, uc2, bloc2)):
                self.order(axis, order, bloc)
        elif number in (1, 2):
            self.target[number - 1] = self.field(f"position {number}")[0]
        elif number == 3:
            order, which, value, _ = self.field("parametre")
            self.ram[OUT + 0x70] &= 0xF7
            if order == 0x1000:
                self.parameters[which] = value
            self.answer = [order, which, self.parameters.get(which, 0)]

    def order(self, axis, order, bloc):
        if order & PROGRAMMED:
            self.bloc[axis] = bloc & 0x30
            declared = bloc & 0x30 != 0
            goal = 0 if bloc & 0x10 else self.target[axis]
            self.position[axis] = goal + (self.position[axis] if bloc & 0x40 else 0)
            self.messages[axis] = HOMED if declared else self.messages[axis] & HOMED
        elif order & HOME:
            self.position[axis], self.messages[axis] = 0, HOMED
        elif order & OFF:
            self.messages[axis] |= NO_PHASES
        elif order & ON:
            self.messages[axis] &= ~NO_PHASES

    def serve(self):
        asked = self.ram[IN]
        if self.ram[IN + 1] & 1 == 0:
            return
        if asked >> 4 != 0xF:
            self.take(asked >> 4)
        for entry in self.ram[IN + 0x70 : IN + 0x74]:
            if entry >> 4:
                self.take(entry & 0xF)
        said = {
            "position": (*self.position, *self.messages),
            "acquittement": (*self.ack, *self.bloc),
            "parametre": (*self.answer, 6),
            "points": (0, 0, 4, 4),
            "pas": (0, 0, 4, 4),
            "bouchons": (0xFFFFFFFF, 0x01020304, 0),
        }
        for zone, values in said.items():
            _, offset, form = READ[zone]
            self.ram[OUT + offset : OUT + offset + 12] = struct.pack(form, *values)
        self.ram[OUT + 1] = 1
        self.ram[OUT] = asked & 0xF

    def run(self):
        print("ready", flush=True)
        while not select.select([sys.stdin], [], [], 0.0005)[0]:
            if self.ram[INTERRUPTS] != self.seen:
                self.seen = self.ram[INTERRUPTS]
                self.serve()
                self.ram[SERVED] = (self.ram[SERVED] + 1) & 0xFF


if __name__ == "__main__":
    what, path = sys.argv[1:]
    if what == "host":
        host(path)
    else:
        Module(path).run()
