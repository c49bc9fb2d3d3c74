"""Drives a module through everything the manual has and checks what it says.

The module is expected to be one of 2 A, version 15 or later, with both axes present in 1/64 steps: 1000 µsteps/s
start-stop, 10000 fast, 20000 µsteps/s²; end switches at ±3000 and a cam from -900 to -400, all of which close.
"""

import struct
import sys
import time

from manual import (
    ABSENT, ACK, ACK_BLOC, BLOC, CARD, COEFFICIENT, DOORBELL, ENCODER, ENTRIES, FAR, IDENTIFIER, IN, INTERRUPTS, IT, KNOWN,
    MESSAGE, MOVES, NUMBERS, OUT, PARAMETERS, PLUGS, RATING, READ, READ_ORDER, RECEIPT, RECEIPTS, REFERENCES, RESET, SERVED,
    STATUS, UC, VERSION, WRITABLE, WRITE, WRITTEN, ZONE, field, memory, signed, unsigned,
)

CLOSES = COEFFICIENT["PRESENT"] | COEFFICIENT["CAM_CLOSES"] | COEFFICIENT["SWITCHES_CLOSE"]
PRESENT = CARD["AXIS_1"] | CARD["AXIS_2"]
M = MESSAGE


class Host:
    """9.2.2 and 9.2.3 word by word."""

    def __init__(self, path):
        self.ram = memory(path)
        self.started()

    def started(self):
        self.until(lambda: self.ram[IDENTIFIER] == 0x4E and self.ram[STATUS] & 1 == 0, "start")

    @staticmethod
    def until(condition, what):
        for _ in range(20000):
            if condition():
                return
            time.sleep(0.001)
        raise SystemExit(f"no {what} in 20 s")

    @staticmethod
    def please(what):
        print(what, flush=True)
        assert sys.stdin.readline().strip() == "done", what

    # Handshakes.

    def interrupt(self):
        served = self.ram[SERVED]
        self.ram[IN + DOORBELL] = 1
        self.ram[INTERRUPTS] = (self.ram[INTERRUPTS] + 1) & 0xFF
        self.until(lambda: self.ram[SERVED] != served, "answer")

    def put(self, zone, values):
        low, high, form = field(IN, WRITTEN, zone)
        self.ram[low:high] = struct.pack(form, *values)

    def seen(self, zone):
        low, high, form = field(OUT, READ, zone)
        return struct.unpack(form, self.ram[low:high])

    def write(self, zone, *values):
        self.ram[IN + ENTRIES : IN + ENTRIES + 4] = bytes(4)
        self.ram[IN + ZONE] = WRITTEN[zone][0] << 4
        self.put(zone, values)
        self.ram[IN + IT] = 1
        self.interrupt()

    def write_all(self, **zones):
        """(9.2.3.2) in the order given."""
        self.ram[IN + ZONE] = 0xF0
        entries = [0x70 | WRITTEN[name.replace("_", " ")][0] for name in zones]
        self.ram[IN + ENTRIES : IN + ENTRIES + 4] = bytes(entries + [0] * (4 - len(entries)))
        for name, values in zones.items():
            self.put(name.replace("_", " "), values)
        self.ram[IN + IT] = 1
        self.interrupt()

    def read(self, zone):
        number = READ[zone][0]
        self.ram[IN + ZONE] = 0xF0 | number
        self.ram[IN + IT] = 1
        self.ram[IN + ENTRIES : IN + ENTRIES + 4] = bytes(4)
        self.interrupt()
        assert self.ram[OUT + ZONE] == number and self.ram[OUT + IT] & 1, (zone, self.ram[OUT + ZONE])
        return self.seen(zone)

    # Parameters.

    def ask(self, order, number, value=0):
        self.write("parametre", order, number, unsigned(value), 0)
        return self.read("parametre")

    def refused(self, card, order, number, value=0):
        """An error shows, and falls with the next order that is correct."""
        said = self.ask(order, number, value)
        assert said[3] & ~PRESENT == CARD[card], (hex(order), hex(number), value, said)
        assert self.get(VERSION) >= 15

    def get(self, number):
        said = self.ask(READ_ORDER, number)
        assert said[:2] == (READ_ORDER, number) and said[3] & ~PRESENT == 0, (hex(number), said)
        return said[2]

    def set(self, number, value):
        said = self.ask(WRITE, number, value)
        assert said[:3] == (WRITE, number, unsigned(value)) and said[3] & ~PRESENT == 0, (hex(number), value, said)

    def reset(self, **parameters):
        """Values of axis 1, then RESET."""
        for name, value in parameters.items():
            self.set(NUMBERS[name][0], value)
        before = self.ram[SERVED]
        self.write("parametre", RESET, 0, 0, 0)
        assert self.ram[SERVED] != before
        self.started()
        # (7.3, 7.6)
        for message in self.read("position")[2:]:
            assert message & (M["HOMED"] | M["NO_PHASES"] | M["MOVING"]) == M["NO_PHASES"], hex(message)

    # Orders of one axis; the other gets none.

    def order(self, axis, uc, bloc=0):
        words = [0, 0, 0, 0]
        words[axis], words[2 + axis] = uc, bloc
        self.write("ordre", *words)

    def position(self, axis):
        said = self.read("position")
        return said[axis], said[2 + axis]

    def message(self, axis):
        return self.position(axis)[1]

    def ack(self, axis):
        said = self.read("acquittement")
        return said[axis], said[2 + axis]

    def under_way(self, axis, order):
        """(5, 6) acknowledged at once, and moving until it ends."""
        (uc, bloc), message = self.ack(axis), self.message(axis)
        assert uc == ACK[order] and bloc == 0 and message & M["MOVING"], (order, hex(uc), hex(bloc), hex(message))
        return message

    def rest(self, axis):
        self.until(lambda: self.message(axis) & M["MOVING"] == 0, "rest")
        return self.position(axis)

    def go(self, axis, target, bloc=0, speed=0):
        self.write(f"position {axis + 1}", target, speed, 0, 0)
        self.order(axis, UC["PROGRAMMED"], bloc)

    def goes(self, axis, target):
        self.go(axis, target)
        position, message = self.rest(axis)
        assert position == target, (position, target, hex(message))
        return message

    def home(self, axis):
        self.order(axis, UC["HOME"])
        position, message = self.rest(axis)
        assert position == 0 and message & M["HOMED"], (position, hex(message))

    def stays(self, axis, do):
        """What is not obeyed moves nothing."""
        before = self.position(axis)[0]
        do()
        position, message = self.position(axis)
        assert position == before and message & M["MOVING"] == 0, (before, position, hex(message))
        return message


def handshakes(it):
    """(9.2) all zones with one interrupt, several that are written with one, and receipts."""
    it.read("position")
    assert it.seen("bouchons")[:2] == (ABSENT, ABSENT)
    it.write_all(position_2=(1234, 0, 0, 0), ordre=(0, UC["PROGRAMMED"], 0, BLOC["FORCE"] | BLOC["PRESET"]))
    assert it.position(1) == (1234, M["NO_PHASES"] | M["HOMED"])
    # The order before the position: that of before counts.
    it.write_all(ordre=(0, UC["PROGRAMMED"], 0, BLOC["FORCE"] | BLOC["PRESET"]), position_2=(99, 0, 0, 0))
    assert it.position(1)[0] == 1234
    for zone, bit in RECEIPTS.items():
        it.ram[OUT + RECEIPT] = bit
        values = (0, 0, 0, 0) if zone == "ordre" else (READ_ORDER, VERSION, 0, 0)
        it.write(zone, *values)
        it.until(lambda bit=bit: it.ram[OUT + RECEIPT] & bit == 0, "receipt")


def parameters(it):
    """(3, 8) every number: what it takes, what it keeps, what it refuses."""
    assert it.get(RATING) == 2000 and it.get(VERSION) >= 15
    # (4, 7.6) phases are on by the holding current of their axis.
    assert it.message(0) & M["NO_PHASES"] and it.message(1) & M["NO_PHASES"]
    it.set(NUMBERS["holding"][0], it.get(NUMBERS["holding"][0]))
    assert it.message(0) & M["NO_PHASES"] == 0 and it.message(1) & M["NO_PHASES"]
    for row in PARAMETERS:
        for axis, number in enumerate(NUMBERS[row[2]]):
            before = it.get(number)
            if row[3] == "RO":
                it.refused("WRITE", WRITE, number, 1)
                continue
            crc = it.get(NUMBERS["crc"][axis])
            for value in (int(row[5], 0), int(row[6], 0)):
                it.set(number, value)
                assert it.get(number) == unsigned(value), (hex(number), value)
            # (3.1.20.5)
            assert before == unsigned(value) or it.get(NUMBERS["crc"][axis]) != crc, hex(number)
            it.set(number, signed(before))
            assert it.get(NUMBERS["crc"][axis]) == crc, hex(number)
    for number in sorted(set(range(0x68)) | {0xFFFF}):
        if number not in KNOWN:
            it.refused("READ", READ_ORDER, number)
        if number not in WRITABLE:
            it.refused("WRITE", WRITE, number)
    for order in (0, 1, 0x3000, 0xFFFF):
        it.refused("ORDER", order, 0)
    it.reset()


def manual_moves(it):
    """(5.2) from the order until 0 is written."""
    for axis in (0, 1):
        for name, sense in (("PLUS", 1), ("MINUS", -1)):
            begun = it.position(axis)[0]
            it.order(axis, UC[name])
            it.under_way(axis, name)
            # (4.2, 8.5) parameters are read and not written meanwhile.
            before = it.get(NUMBERS["approach"][axis])
            it.refused("MOVING", WRITE, NUMBERS["approach"][axis], before + 1)
            assert it.get(NUMBERS["approach"][axis]) == before
            it.order(axis, 0)
            stands, message = it.rest(axis)
            assert (stands - begun) * sense > 0 and message & M["REFUSED"] == 0, (begun, stands, hex(message))
            assert it.ack(axis) == (0, 0)


def homing(it):
    """(5.1, 3.1.1.8) from off the cam and on it, in both directions, as far as the parameters say."""
    start = it.position(1)[0]
    it.home(1)
    it.goes(1, start)
    it.home(0)
    it.goes(0, 500)
    it.order(0, UC["HOME"])
    # The homing of before is lost until it is done again.
    assert it.under_way(0, "HOME") & M["HOMED"] == 0
    position, message = it.rest(0)
    assert position == 0 and message & (M["HOMED"] | M["CAM"]) == M["HOMED"] | M["CAM"], hex(message)
    assert it.ack(0) == (0, 0)
    # The edge is at -400, taken in the negative direction. On the cam it is left, by the hysteresis, and taken again.
    it.goes(0, -200)
    it.set(NUMBERS["hysteresis"][0], 150)
    it.home(0)
    assert it.goes(0, 1) & M["CAM"] == 0 and it.goes(0, 0) & M["CAM"]
    # (3.1.5) the stop comes so much later, in the direction of homing.
    it.reset(origin=100)
    it.home(0)
    assert it.goes(0, 100) & M["CAM"] and it.goes(0, 101) & M["CAM"] == 0
    # (3.1.1.2) the other way the edge is that of the other side.
    it.reset(origin=0, coefficient=CLOSES | COEFFICIENT["HOME_PLUS"])
    it.order(0, UC["PROGRAMMED"], BLOC["ZERO"])
    it.goes(0, -1000)
    it.home(0)
    assert it.message(0) & M["CAM"] and it.goes(0, -1) & M["CAM"] == 0
    it.goes(0, 1000)
    it.reset(coefficient=CLOSES)
    it.home(0)


def programmed(it):
    """(6) to targets and references, absolute and relative, and positions that are declared."""
    for axis in (0, 1):
        it.home(axis)
        it.go(axis, 2000)
        it.under_way(axis, "PROGRAMMED")
        assert it.rest(axis) == (2000, M["HOMED"]) and it.ack(axis) == (0, 0)
        # (3.1.20.1) where it has stopped last is kept.
        assert signed(it.get(NUMBERS["last"][axis])) == 2000
        it.go(axis, -800, BLOC["RELATIVE"] | BLOC["SPEED"], 1000)
        assert it.under_way(axis, "PROGRAMMED") & M["HOMED"]
        assert it.rest(axis)[0] == 1200
    # Both at once; each ends by itself.
    it.write("position 1", 400, 500, 0, 0)
    it.write("position 2", -400, 1000, 0, 0)
    both = BLOC["RELATIVE"] | BLOC["SPEED"]
    it.write("ordre", UC["PROGRAMMED"], UC["PROGRAMMED"], both, both)
    assert it.rest(0)[0] == 1600 and it.rest(1)[0] == 800
    for place in REFERENCES:
        number = NUMBERS[f"reference_{place}"][0]
        it.set(number, 100 * place)
        it.order(0, UC["PROGRAMMED"], place)
        assert it.rest(0)[0] == 100 * place and it.ack(0) == (0, place)
    for place in range(11, 16):
        it.stays(0, lambda place=place: it.order(0, UC["PROGRAMMED"], place))
        assert it.ack(0)[1] & ACK_BLOC["NO_REFERENCE"], place
    it.goes(0, 700)
    for bloc, ack, expected in (
        (BLOC["ZERO"], ACK_BLOC["ZEROED"], 0),
        (BLOC["FORCE"], ACK_BLOC["FORCED"], 700),
        (BLOC["FORCE"] | BLOC["PRESET"], ACK_BLOC["FORCED"], -12345),
    ):
        it.write("position 1", -12345, 0, 0, 0)
        it.order(0, UC["PROGRAMMED"], bloc)
        assert it.position(0) == (expected, M["HOMED"]) and it.ack(0) == (0, ack), hex(bloc)
    # (6.3) this value may not be forced.
    it.write("position 1", 0xC0DE, 0, 0, 0)
    it.stays(0, lambda: it.order(0, UC["PROGRAMMED"], BLOC["FORCE"] | BLOC["PRESET"]))
    assert it.position(0)[0] == -12345
    it.home(0)


def approach(it):
    """(3.1.1.9) moves end in one direction, but those that say that they do not."""
    bits = CLOSES | COEFFICIENT["APPROACH"] | COEFFICIENT["APPROACH_PLUS"]
    it.reset(coefficient=bits, approach=300)
    it.home(0)
    it.goes(0, 1000)

    def lowest(bloc, target):
        it.go(0, target, bloc | BLOC["SPEED"], 1000)
        low = it.position(0)[0]
        while it.message(0) & M["MOVING"]:
            low = min(low, it.position(0)[0])
        assert it.position(0)[0] == target
        return min(low, target)

    assert lowest(0, 500) < 400
    assert lowest(0, 900) > 450
    assert lowest(BLOC["NO_APPROACH"], 500) == 500
    it.reset(coefficient=CLOSES)
    it.home(0)


def stops(it):
    """(5.5, 5.6, 7.5) on the ramp, homing kept, and without."""
    it.home(0)
    it.go(0, 2900, BLOC["SPEED"], 1000)
    it.order(0, UC["ABANDON"])
    assert it.ack(0)[0] == ACK["ABANDON"]
    position, message = it.rest(0)
    assert 0 <= position < 2900 and message & M["HARD"] == 0, (position, hex(message))
    it.go(0, 2900, BLOC["SPEED"], 1000)
    it.order(0, UC["HARD"])
    position, message = it.rest(0)
    assert it.ack(0)[0] == ACK["HARD"] and message & (M["HARD"] | M["HOMED"]) == M["HARD"], hex(message)
    # The demand for a move ends it.
    assert it.goes(0, position + 10) & M["HARD"] == 0
    # (5.4 to 5.7) stops count in motion, what concerns phases at rest.
    it.stays(0, lambda: it.order(0, UC["HARD"]))
    assert it.message(0) & M["HARD"] == 0
    it.order(0, UC["OFF"])
    assert it.ack(0)[0] == ACK["OFF"] and it.message(0) & M["NO_PHASES"]
    it.order(0, UC["ON"])
    assert it.message(0) & M["NO_PHASES"] == 0
    it.order(0, UC["OFF"])
    it.goes(0, position)
    assert it.message(0) & M["NO_PHASES"] == 0
    it.go(0, position + 500, BLOC["SPEED"], 500)
    it.order(0, UC["OFF"])
    assert it.message(0) & M["NO_PHASES"] == 0 and it.rest(0)[0] == position + 500


def refusals(it):
    """(7.10) an order while a move is under way, and two at once; what is under way goes on."""
    it.home(0)
    for name in MOVES:
        it.go(0, 1000, BLOC["SPEED"], 500)
        it.order(0, UC[name])
        assert it.message(0) & M["REFUSED"], name
        assert it.rest(0)[0] == 1000, name
        assert it.goes(0, 0) & M["REFUSED"] == 0
    assert it.stays(0, lambda: it.order(0, UC["PLUS"] | UC["MINUS"])) & M["REFUSED"]
    # (3.1.1.7) without homing no programmed moves, where that is a must; manual ones and those to switches are allowed.
    it.reset(coefficient=CLOSES | COEFFICIENT["MUST_HOME"])
    it.stays(0, lambda: it.go(0, 100))
    it.order(0, UC["PLUS"])
    it.under_way(0, "PLUS")
    it.order(0, 0)
    it.rest(0)
    it.home(0)
    it.goes(0, 100)
    # (3.1.1.1) an axis that is not there does nothing.
    it.reset(coefficient=CLOSES & ~COEFFICIENT["PRESENT"])
    assert it.ask(READ_ORDER, VERSION)[3] == CARD["AXIS_2"]
    for name in MOVES:
        it.stays(0, lambda name=name: it.order(0, UC[name]))
    it.reset(coefficient=CLOSES)
    it.home(0)


def limits(it):
    """(5.3, 7.1, 7.2, 3.1.1.3 to 3.1.1.5, 3.1.1.11) end switches and soft limits."""
    for axis in (0, 1):
        it.home(axis)
    for name, sense, switch, away in (("TO_MINUS", -1, "SWITCH_MINUS", "PLUS"), ("TO_PLUS", 1, "SWITCH_PLUS", "MINUS")):
        it.order(0, UC[name])
        it.under_way(0, name)
        position, message = it.rest(0)
        assert message & M[switch] and message & M["HARD"] == 0, hex(message)
        assert it.ack(0) == (0, 0)
        # The cam's edge, which is 0, is at -400 and the switches at +-3000.
        assert abs(position) >= 3000 + 400 * sense
        toward = {"PLUS": "MINUS", "MINUS": "PLUS"}[away]
        it.stays(0, lambda toward=toward: it.order(0, UC[toward]))
        it.stays(0, lambda: it.go(0, position + 10 * sense))
        assert it.goes(0, position - 500 * sense) & M[switch] == 0
    # Soft limits, once homed; moves to switches do not know them.
    it.home(0)
    it.set(NUMBERS["soft_plus"][0], 1000)
    it.set(NUMBERS["soft_minus"][0], -300)
    for target, bit, within in ((2900, "SOFT_PLUS", 900), (-2000, "SOFT_MINUS", -200)):
        it.go(0, target)
        position, message = it.rest(0)
        assert message & M[bit] and position != target, (position, hex(message))
        it.stays(0, lambda target=target: it.go(0, target))
        assert it.goes(0, within) & M[bit] == 0
    it.order(0, UC["TO_PLUS"])
    assert it.rest(0)[1] & M["SWITCH_PLUS"]
    it.set(NUMBERS["soft_plus"][0], FAR)
    it.set(NUMBERS["soft_minus"][0], -FAR)
    # Without ramp, and homing is lost, but in moves to switches.
    it.goes(0, 2000)
    it.reset(coefficient=CLOSES | COEFFICIENT["BRUTAL"])
    it.home(0)
    it.go(0, 9000)
    message = it.rest(0)[1]
    assert message & (M["SWITCH_PLUS"] | M["HARD"] | M["HOMED"]) == M["SWITCH_PLUS"] | M["HARD"], hex(message)
    it.order(0, UC["MINUS"])
    it.until(lambda: it.message(0) & M["SWITCH_PLUS"] == 0, "way off the switch")
    it.order(0, 0)
    it.rest(0)
    it.home(0)
    it.order(0, UC["TO_PLUS"])
    message = it.rest(0)[1]
    assert message & (M["SWITCH_PLUS"] | M["HOMED"]) == M["SWITCH_PLUS"] | M["HOMED"], hex(message)
    # Switches that are swapped, and none.
    it.goes(0, 1000)
    it.reset(coefficient=CLOSES | COEFFICIENT["SWAP"])
    it.order(0, UC["PROGRAMMED"], BLOC["ZERO"])
    it.go(0, 9000)
    assert it.rest(0)[1] & (M["SWITCH_PLUS"] | M["SWITCH_MINUS"]) == M["SWITCH_MINUS"]
    it.reset(coefficient=CLOSES | COEFFICIENT["NO_SWITCHES"])
    it.order(0, UC["PROGRAMMED"], BLOC["ZERO"])
    assert it.goes(0, 500) & (M["SWITCH_PLUS"] | M["SWITCH_MINUS"]) == 0
    it.goes(0, -1500)
    it.reset(coefficient=CLOSES)
    it.home(0)


def motors(it):
    """(5.7, 7.7, 7.8) motors that are not sound do not move; a test says that they are again."""
    it.home(0)
    it.order(0, UC["TEST"])
    assert it.ack(0)[0] == ACK["TEST"] and it.message(0) & (M["OPEN"] | M["SHORT"]) == 0
    for fault, bit in (("open", "OPEN"), ("short", "SHORT")):
        it.please(f"{fault} 1 on")
        it.order(0, UC["TEST"])
        assert it.message(0) & M[bit], fault
        it.stays(0, lambda: it.go(0, it.position(0)[0] + 100))
        it.please(f"{fault} 1 off")
        assert it.message(0) & M[bit], "only a test clears it"
        it.order(0, UC["TEST"])
        assert it.message(0) & M[bit] == 0
    it.goes(0, 0)
    it.please("power 1 off")
    assert it.message(0) & M["NO_POWER"] and it.message(1) & M["NO_POWER"] == 0
    it.stays(0, lambda: it.go(0, 100))
    it.please("power 1 on")
    it.home(0)
    it.go(0, 2900, BLOC["SPEED"], 1000)
    it.please("power 1 off")
    message = it.rest(0)[1]
    assert message & (M["NO_POWER"] | M["HARD"] | M["HOMED"]) == M["NO_POWER"] | M["HARD"], hex(message)
    it.please("power 1 on")
    it.home(0)


def encoders(it):
    """(2.2.4, 2.2.5, 3.1.14 to 3.1.19, 6.2) points and steps as in the examples of 6.4.1, and what encoders say."""

    def said(zone):
        return it.read(zone)[::2]

    assert said("points") == (0, ENCODER["PLUG"])
    it.please("encoder 1 incremental")
    it.reset(dividend=200, divisor=2000, definition=1)
    it.order(0, UC["PROGRAMMED"], BLOC["ZERO"])
    assert said("points") == (0, ENCODER["INCREMENTAL"] | ENCODER["PLUG"])
    it.goes(0, 2000)
    for zone, position in (("points", 0x4E20), ("pas", 0x7D0)):
        assert said(zone) == (position, ENCODER["INCREMENTAL"] | ENCODER["PLUG"]), zone
    it.order(0, UC["PROGRAMMED"], BLOC["ZERO"])
    assert said("points")[0] == 0
    it.goes(0, -500)
    # What is lost stays lost until RESET.
    it.please("encoder 1 lost")
    assert said("points")[1] & ENCODER["FAULT"]
    it.please("encoder 1 incremental")
    assert said("points")[1] & ENCODER["FAULT"]
    it.reset()
    assert said("points")[1] & ENCODER["FAULT"] == 0
    # One that counts the other way (3.1.19.2).
    it.please("encoder 1 reversed")
    it.reset(definition=3)
    it.order(0, UC["PROGRAMMED"], BLOC["ZERO"])
    it.goes(0, 20)
    assert said("points")[0] == 200
    for kind in ("SSI", "ENDAT"):
        it.please(f"encoder 1 {kind.lower()}")
        it.reset(definition=1, bits=24, offset=0)
        assert said("points")[1] & (ENCODER["SSI"] | ENCODER["ENDAT"] | ENCODER["INCREMENTAL"]) == ENCODER[kind]
        it.goes(0, it.position(0)[0] + 100)
        it.order(0, UC["PROGRAMMED"], BLOC["ZERO"])
        # The distance between the encoder and what is wanted is kept (3.1.16, 6.2).
        assert said("points")[0] == 0 and it.get(NUMBERS["offset"][0]) != 0
        it.reset()
        assert abs(said("points")[0]) <= 1 and abs(it.position(0)[0]) <= 1
    it.please("encoder 1 alarm")
    assert said("points")[1] & ENCODER["ALARM"]
    it.please("encoder 1 none")
    it.reset(definition=0, offset=0)
    assert said("points")[1] & (ENCODER["SSI"] | ENCODER["ENDAT"] | ENCODER["INCREMENTAL"]) == 0


def plugs(it):
    """(2.2.6) one by one and both; at rest and in their own time."""
    it.please("plug 2 01020304")
    assert it.read("bouchons") == (ABSENT, ABSENT, 0)
    for number, expected in ((1, ABSENT), (2, 0x01020304), (3, 0x01020304)):
        it.write("parametre", PLUGS, number, 0, 0)
        it.until(lambda number=number: it.read("parametre")[:2] == (PLUGS, number), "plug")
        assert it.read("bouchons") == (ABSENT, expected, 0), number
    assert [message & ENCODER["PLUG"] for message in it.read("points")[2:]] == [ENCODER["PLUG"], 0]


def checksum(it):
    """(8.1) only parameters are written, and the module is sound again after RESET."""
    it.please("checksum")
    it.write("parametre", RESET, 0, 0, 0)
    it.started()
    assert it.read("parametre")[3] & CARD["CHECKSUM"]
    it.stays(0, lambda: it.order(0, UC["PLUS"]))
    it.write("parametre", WRITE, NUMBERS["coefficient"][0], CLOSES, 0)
    it.reset()
    assert it.read("parametre")[3] & CARD["CHECKSUM"] == 0
    it.home(0)


PARTS = (handshakes, parameters, manual_moves, homing, programmed, approach, stops, refusals, limits, motors, plugs, encoders, checksum)


def drive(path):
    it = Host(path)
    assert it.read("position") == (0, 0, M["NO_PHASES"], M["NO_PHASES"])
    for part in PARTS:
        try:
            part(it)
        except AssertionError as wrong:
            raise SystemExit(f"{part.__name__}, line {wrong.__traceback__.tb_next.tb_lineno}: {wrong}") from wrong
        it.please(f"passed {part.__name__}")
