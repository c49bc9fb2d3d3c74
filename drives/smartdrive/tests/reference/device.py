"""A module whose moves take a few exchanges instead of a time."""

import os
import pty
import select
import struct
import time
import tty

from manual import (
    ALARM, BADMODE, BADPARAMS, COMMANDS, DONE, FACTORY, IDLE, INIT_ENCODER1, INIT_ENCODER2, INIT_ENCODERS,
    INIT_HOMING, INMOTION, LINES, MODES, NOTAVAILABLE, OFF, PARAMETERS, REJECT, REMOTE, RESPONSE, SEQBUSY, USER,
    VARIABLES, WORKING, request, xor,
)

UNDEFINED = 0xA5


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
        self.words.update({0: 0x1020, 2: 1, 30: 1200, 31: 3000, 32: 3000, 43: 200, 44: 16})
        self.words.update({26: 0, 27: 0x8000, 28: 0xFFFF, 29: 0x7FFF})
        self.factory, self.saved = dict(self.words), dict(self.words)
        self.variables = {index: 0 for index in VARIABLES}
        self.variables[67] = 48
        self.mode, self.wanted, self.changing = OFF, OFF, 0
        self.position, self.flags, self.coming = 0, DONE, []
        self.alarms, self.busy, self.speed = 0, False, 0
        self.lines, self.active, self.inverse = 0, 0, 0
        self.refuse, self.echo, self.table, self.asked, self.deaf = None, False, False, [], 0.0

    def by_hand(self, command, *words):
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
        elif command == "parameters":
            rows = [(int(row[0]), row[2], int(row[4], 0), int(row[5], 0)) for row in PARAMETERS]
            return " ".join(f"{index}:{access}:{low}:{high}" for index, access, low, high in rows)
        elif command == "variables":
            return " ".join(f"{index}:{access}:{low}:{high}" for index, (access, low, high) in VARIABLES.items())
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

    # What each command does. It gives the four bytes and the word of its answer, or the reason why not; nothing for
    # POS and the flags.

    def on_ping(self):
        pass

    def on_reset(self, bl):
        self.words, self.mode, self.position, self.flags = dict(self.saved), self.configured, 0, DONE
        self.address, self.coming, self.speed, self.alarms = self.words[2], [], 0, 0
        self.deaf = time.monotonic() + (1e9 if bl else 0.25)

    def on_mode(self, mod):
        if mod not in MODES and mod != USER:
            return BADPARAMS
        self.alarms = 0
        self.change(self.configured if mod == USER else mod)

    def on_trjinit(self, ini):
        if ini == INIT_HOMING:
            offset = self.words[100] | self.words[101] << 16
            self.towards(offset - ((offset >> 31) << 32))
            self.busy = True
        elif ini in (INIT_ENCODERS, INIT_ENCODER1, INIT_ENCODER2):
            for index, ways in ((44, (INIT_ENCODERS, INIT_ENCODER1)), (45, (INIT_ENCODERS, INIT_ENCODER2))):
                self.variables[index] = 0 if ini in ways else self.variables[index]
        elif ini > INIT_ENCODER2:
            return BADPARAMS
        else:
            self.position, self.coming, self.flags, self.speed = 0, [], DONE, 0

    def on_goto(self, dst, vel=0, acc=0):
        self.towards(dst)

    def on_step(self, dst, vel=0, acc=0):
        self.towards(self.position + dst)

    def on_start(self, vel, acc):
        # Microsteps in ten milliseconds.
        self.speed, self.flags, self.coming = vel * self.words[43] * self.words[44] // 6000, 0, []

    def on_stop(self, dec):
        self.towards(self.position + self.speed)

    def on_ioupdate(self, clr, set, cact, crev):
        for bit in (1, 2, 4):
            if (set ^ clr) & bit:
                self.lines = self.lines & ~bit | set & bit
        self.active &= ~cact
        self.inverse &= ~crev
        return bytes((self.lines, UNDEFINED, self.active, self.inverse)), UNDEFINED

    def on_write(self, var, new):
        if VARIABLES.get(var, ("RO",))[0] == "RO" or new not in (0, 0xFFFF):
            return BADPARAMS
        bit = 1 << var - 128
        self.lines = self.lines & ~bit | (bit if new else 0)
        return self.on_read(var)

    def on_read(self, var):
        if var not in VARIABLES:
            return NOTAVAILABLE
        return struct.pack("<I", self.value(var) & 0xFFFFFFFF), UNDEFINED

    def on_set(self, par, new):
        if par not in self.words:
            return NOTAVAILABLE
        if not self.allowed(par, new):
            return BADPARAMS
        self.words[par] = new
        return self.on_get(par)

    def on_get(self, par):
        if par not in self.words:
            return NOTAVAILABLE
        return struct.pack("<HH", self.saved[par], self.words[par]), self.factory[par]

    def on_save(self):
        self.saved = dict(self.words)
        self.change(self.mode)
        return bytes([UNDEFINED] * 4), UNDEFINED

    def on_load(self, src):
        if src not in (0, FACTORY):
            return BADPARAMS
        self.words = dict(self.factory if src else self.saved)
        self.change(self.mode)
        return bytes([UNDEFINED] * 4), UNDEFINED

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
        self.step()
        outcome = self.obey(frame)
        if frame[0] == 0:
            return b""
        sta = self.address << 8 | RESPONSE | self.mode << 1 | (SEQBUSY if self.busy else 0)
        data, tag = struct.pack("<i", self.position), self.flags
        if self.table:
            tag = tag & 1 | tag >> 7 & 0x7E
        if isinstance(outcome, int):
            sta, tag = sta | REJECT, outcome
        elif outcome:
            data, tag = outcome
        elif frame[1] == 0x01 and self.alarms:
            sta, tag = sta | ALARM, self.alarms
        answer = struct.pack("<H", sta) + data + struct.pack("<H", tag)
        return answer + bytes((xor(answer),))

    def obey(self, frame):
        for name, code, form, words, _, remote in COMMANDS:
            if code == frame[1] & 0x3F and struct.calcsize(form) == len(frame) - 3:
                break
        else:
            self.asked.append(f"unknown {frame.hex()}")
            return NOTAVAILABLE
        fields = dict(zip(words.split(), struct.unpack(form, frame[2:-1])))
        clean = request(frame[0], name, **fields) == frame
        said = [name, *(f"{key}={value}" for key, value in fields.items()), *([] if clean else ["unclean"])]
        self.asked.append(" ".join(said if frame[0] else [*said, "to all"]))
        if self.refuse is not None:
            reason, self.refuse = self.refuse, None
            return reason
        if self.changing and name not in ("PING", "READ", "GET"):
            return WORKING
        if remote and self.mode != REMOTE:
            return BADMODE
        return getattr(self, "on_" + name.lower())(**{key.lower(): value for key, value in fields.items()})

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
                    print(self.by_hand(*line.decode().split()), flush=True)
