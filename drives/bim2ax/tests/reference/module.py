"""A module that moves: at constant speed, without ramps. Everything else is as the host reads it in the manual.

It has two motors in 1/64 steps whose end switches are at ±3000 and whose cams go from -900 to -400, encoders of ten points a
step, and a plug at axis 2. What is not in the tables is not obeyed.
"""

import select
import struct
import sys
import time

from manual import (
    ABSENT, ACK, ACK_BLOC, BLOC, CARD, COEFFICIENT, DOORBELL, ENCODER, ENTRIES, FAR, FLASH_CRC, IDENTIFIER, IN, INTERRUPTS,
    IT, KNOWN, MESSAGE, MOVES, NUMBERS, OUT, PARAMETERS, PLUGS, RATING, READ, READ_ORDER, RECEIPT, RECEIPTS, REFERENCES,
    RESET, SERVED, STATUS, UC, VERSION, WRITABLE, WRITE, WRITTEN, ZONE, field, memory, signed, unsigned,
)

M = MESSAGE
SWITCHES, CAM, PLUG = 3000, (-900, -400), 0x01020304
BOOT, PLUG_TIME = 0.05, 0.1
START = {"coefficient": 0x4081, "mode": 0x60, "current": 500, "holding": 100, "fast": 10000, "mini": 2000, "ramp": 20000,
         "soft_plus": FAR, "soft_minus": -FAR, "dividend": 200, "divisor": 2000, "bits": 24}
RANGES = {number: (int(row[5], 0), int(row[6], 0)) for row in PARAMETERS for number in NUMBERS[row[2]]}


class Axis:
    def __init__(self, module, index):
        self.module, self.index = module, index
        self.shaft, self.zero = 0.0, 0.0
        self.messages, self.task, self.goals = M["NO_PHASES"], None, []
        self.ack, self.bloc, self.ended = 0, 0, 0
        self.speed = 0

    def parameter(self, name):
        return signed(self.module.stored[NUMBERS[name][self.index]])

    def has(self, name):
        return self.parameter("coefficient") & COEFFICIENT[name] != 0

    @property
    def position(self):
        return round(self.shaft - self.zero)

    def shown(self):
        """Messages that latch, and those that are so as it stands."""
        word = self.messages
        for so, name in (
            (self.task is not None, "MOVING"),
            (self.shaft >= SWITCHES, "SWITCH_PLUS"),
            (self.shaft <= -SWITCHES, "SWITCH_MINUS"),
            (CAM[0] <= self.shaft <= CAM[1], "CAM"),
        ):
            word |= M[name] if so else 0
        if self.messages & M["HOMED"]:
            word |= M["SOFT_PLUS"] if self.position >= self.parameter("soft_plus") else 0
            word |= M["SOFT_MINUS"] if self.position <= self.parameter("soft_minus") else 0
        return word

    def barred(self, sense):
        names = ("SWITCH_PLUS", "SOFT_PLUS") if sense > 0 else ("SWITCH_MINUS", "SOFT_MINUS")
        if self.task in ("TO_PLUS", "TO_MINUS"):
            names = names[:1]
        if self.task == "HOME":
            names = ()
        return any(self.shown() & M[name] for name in names)

    def begin(self, name, goals, speed, ended=0):
        """Goes to one goal after the other; where the way is barred it stays."""
        self.messages &= ~(M["HARD"] | M["NO_PHASES"] | M["REFUSED"])
        self.task, self.goals, self.ended = name, goals, ended
        self.ack, self.bloc = ACK[name], 0
        self.speed = speed
        if name == "HOME":
            self.messages &= ~M["HOMED"]

    def end(self, ack=0):
        done = self.task
        self.task, self.goals = None, []
        self.shaft = round(self.shaft)
        self.ack, self.bloc = ack, self.ended if done == "PROGRAMMED" and ack == 0 else 0
        if done == "HOME" and ack == 0:
            self.zero = self.shaft
            self.messages |= M["HOMED"]
        self.module.stored[NUMBERS["last"][self.index]] = unsigned(self.position)

    def pass_time(self, seconds):
        way = self.speed * seconds
        while self.task and self.goals:
            left = self.goals[0] - self.shaft
            if left and self.barred(1 if left > 0 else -1):
                self.end()
                return
            step = max(-way, min(way, left))
            if self.task in ("PLUS", "MINUS", "TO_PLUS", "TO_MINUS", "PROGRAMMED"):
                # No step over a switch.
                edge = SWITCHES if step > 0 else -SWITCHES
                if abs(self.shaft) < SWITCHES <= abs(self.shaft + step):
                    step = edge - self.shaft
            self.shaft += step
            way -= abs(step)
            if abs(self.goals[0] - self.shaft) > 1e-9:
                return
            self.goals.pop(0)
        if self.task:
            self.end()

    def home(self):
        sense = 1 if self.has("HOME_PLUS") else -1
        edge = CAM[0] if sense > 0 else CAM[1]
        clear = edge - sense * (1 + self.parameter("hysteresis"))
        last = edge + sense * self.parameter("origin")
        on = CAM[0] <= self.shaft <= CAM[1]
        self.begin("HOME", [clear, edge, last] if on else [edge, last], self.parameter("mini"))

    def programmed(self, bloc, target, speed):
        if bloc & (BLOC["ZERO"] | BLOC["FORCE"]):
            to = 0 if bloc & BLOC["ZERO"] else target if bloc & BLOC["PRESET"] else self.parameter("last")
            self.zero = self.shaft - to
            self.messages |= M["HOMED"]
            self.ack, self.bloc = 0, ACK_BLOC["ZEROED"] if bloc & BLOC["ZERO"] else ACK_BLOC["FORCED"]
            return
        number = bloc & 15
        if number and number not in REFERENCES:
            self.bloc = ACK_BLOC["NO_REFERENCE"]
            return
        if self.has("MUST_HOME") and not self.messages & M["HOMED"]:
            return
        to = self.parameter(f"reference_{number}") if number else target
        to += self.zero + (self.position if bloc & BLOC["RELATIVE"] and not number else 0)
        fast = self.parameter("fast")
        self.begin("PROGRAMMED", [to], min(speed, fast) if bloc & BLOC["SPEED"] else fast, number)

    def order(self, uc, bloc, target, speed):
        if not self.has("PRESENT"):
            return
        asked = [name for name in MOVES if uc & UC[name]]
        if self.task:
            if uc & UC["HARD"]:
                self.end(ACK["HARD"])
                self.messages = self.messages & ~M["HOMED"] | M["HARD"]
            elif uc & UC["ABANDON"]:
                self.end(ACK["ABANDON"])
            elif asked == [self.task] and self.task in ("PLUS", "MINUS"):
                pass
            elif asked:
                self.messages |= M["REFUSED"]
            elif self.task in ("PLUS", "MINUS"):
                self.end()
            return
        if len(asked) > 1:
            self.messages |= M["REFUSED"]
            return
        if uc & UC["OFF"]:
            self.messages, self.ack = self.messages | M["NO_PHASES"], ACK["OFF"]
        if uc & (UC["ON"] | UC["TEST"]):
            self.messages &= ~M["NO_PHASES"]
        if uc & UC["TEST"]:
            self.ack = ACK["TEST"]
        name = asked[0] if asked else ""
        if name == "HOME":
            self.home()
        elif name == "PROGRAMMED":
            self.programmed(bloc, target, speed)
        elif name:
            sense = -1 if name.endswith("MINUS") else 1
            self.task = name
            if self.barred(sense):
                self.task = None
            else:
                self.begin(name, [sense * 1e9], self.parameter("mini"))


class Module:
    def __init__(self, path):
        self.ram = memory(path)
        self.stored = {number: 0 for number in KNOWN}
        self.stored.update({RATING: 5000, VERSION: 17, FLASH_CRC: 0x1234})
        for name, value in START.items():
            for number in NUMBERS[name]:
                self.stored[number] = unsigned(value)
        self.ram[IDENTIFIER] = 0x4E
        self.axes = []
        self.plugs_due, self.plugs = None, [ABSENT, ABSENT]
        self.reset()
        self.seen = self.ram[INTERRUPTS]

    def reset(self):
        before = self.axes
        self.axes = [Axis(self, index) for index in (0, 1)]
        for axis, old in zip(self.axes, before):
            axis.shaft, axis.zero = old.shaft, old.shaft
        self.targets, self.answer, self.errors = [(0, 0), (0, 0)], (0, 0, 0), 0
        self.ram[STATUS], self.up = 1, time.monotonic() + BOOT

    def field(self, zone):
        low, high, form = field(IN, WRITTEN, zone)
        return struct.unpack(form, self.ram[low:high])

    def take(self, number):
        for zone, (known, _, _) in WRITTEN.items():
            if known == number:
                self.ram[OUT + RECEIPT] &= ~RECEIPTS.get(zone, 0) & 0xFF
        if number == 0:
            uc1, uc2, bloc1, bloc2 = self.field("ordre")
            for axis, uc, bloc in zip(self.axes, (uc1, uc2), (bloc1, bloc2)):
                axis.order(uc, bloc, *self.targets[axis.index])
        elif number in (1, 2):
            self.targets[number - 1] = self.field(f"position {number}")[:2]
        elif number == 3:
            self.parameter(*self.field("parametre")[:3])

    def parameter(self, order, number, value):
        self.errors, self.answer = 0, (order, number, 0)
        if order == WRITE:
            low, high = RANGES.get(number, (0, 0xFFFFFFFF))
            # The module's rating is another one than that of the table.
            high = 5000 if number in NUMBERS["current"] + NUMBERS["holding"] else high
            if any(axis.task for axis in self.axes):
                self.errors = CARD["MOVING"]
            elif number not in WRITABLE or not low <= (signed(value) if low < 0 else value) <= high:
                self.errors = CARD["WRITE"]
            else:
                self.stored[number], self.answer = value, (order, number, value)
                for axis in self.axes:
                    if number == NUMBERS["holding"][axis.index]:
                        axis.messages &= ~M["NO_PHASES"]
        elif order == READ_ORDER:
            if number in KNOWN:
                self.answer = (order, number, self.stored[number])
            else:
                self.errors = CARD["READ"]
        elif order == PLUGS:
            self.answer, self.plugs_due = (0, 0, 0), (time.monotonic() + PLUG_TIME, number)
        elif order == RESET:
            self.reset()
        else:
            self.errors = CARD["ORDER"]

    def serve(self):
        asked = self.ram[IN + ZONE]
        if self.ram[IN + IT] & 1 == 0:
            return
        if asked >> 4 != 0xF:
            self.take(asked >> 4)
        for entry in self.ram[IN + ENTRIES : IN + ENTRIES + 4]:
            if entry >> 4:
                self.take(entry & 0xF)
        one, two = self.axes
        present = [CARD[f"AXIS_{axis.index + 1}"] for axis in self.axes if axis.has("PRESENT")]
        encoded = [axis.parameter("definition") & 1 for axis in self.axes]
        # Ten points a step; of the plugs only that of axis 2 is there.
        messages = [ENCODER["INCREMENTAL"] * on | ENCODER["PLUG"] * (plug == ABSENT) for on, plug in zip(encoded, self.plugs)]
        said = {
            "position": (one.position, two.position, one.shown(), two.shown()),
            "acquittement": (one.ack, two.ack, one.bloc, two.bloc),
            "parametre": (*self.answer, self.errors | sum(present)),
            "points": (10 * one.position * encoded[0], 10 * two.position * encoded[1], *messages),
            "pas": (one.position * encoded[0], two.position * encoded[1], *messages),
            "bouchons": (*self.plugs, 0),
        }
        for zone, values in said.items():
            low, high, form = field(OUT, READ, zone)
            self.ram[low:high] = struct.pack(form, *values)
        self.ram[OUT + IT] = 1
        self.ram[OUT + ZONE] = asked & 0xF

    def run(self):
        last, ready = time.monotonic(), False
        while not select.select([sys.stdin], [], [], 0.0005)[0]:
            now = time.monotonic()
            for axis in self.axes:
                axis.pass_time(now - last)
            last = now
            if self.ram[STATUS] and now > self.up:
                self.ram[STATUS] = 0
            if not self.ram[STATUS] and not ready:
                ready = True
                print("ready", flush=True)
            if self.plugs_due and now > self.plugs_due[0]:
                number, self.plugs_due = self.plugs_due[1], None
                self.plugs[1] = PLUG if number & 2 else self.plugs[1]
                self.answer = (PLUGS, number, 0)
            if self.ram[INTERRUPTS] != self.seen and not self.ram[STATUS]:
                self.seen = self.ram[INTERRUPTS]
                self.serve()
                self.ram[SERVED] = (self.ram[SERVED] + 1) & 0xFF
