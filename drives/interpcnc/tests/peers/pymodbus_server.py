#!/usr/bin/env python3
"""pymodbus 3.16 as an InterpCNC board: `pymodbus_server.py PORT`, until its standard input ends.

A board whose moves end at once and whose searches succeed: what is asked of it and how its answers are put into frames
is the point. It says "ready"; then it takes lines and answers each with one:

    requests      what has been written since: function, address, values, one after the other, separated by |
    refuse CODE   the next request is answered with this exception
    status BITS   status bits that are set besides
    input N LEVEL
"""

import asyncio
import sys

from pymodbus.constants import ExcCodes
from pymodbus.server import ModbusSerialServer
from pymodbus.simulator.simdata import SimData
from pymodbus.simulator.simdevice import SimDevice
from pymodbus.simulator.simutils import DataType

FIRST_OUTPUT, LOCK, FIRST_USER_BIT = 256, 288, 320
COMMAND, OUTPUTS = 4096, 4148
RESET, MOVE, SEGMENT, PROBE, POSITION, HOME_AXIS, STOP = 66, 80, 6, 40, 67, 78, 43


def words(value):
    return [value >> 16 & 0xFFFF, value & 0xFFFF]


def signed(high, low):
    value = high << 16 | low
    return value - (value >> 31 << 32)


class Board:
    def __init__(self):
        self.locked, self.positions, self.outputs, self.inputs = True, [0] * 5, 0, 0
        self.directions, self.probed, self.besides = 0, 0, 0
        self.command = [0] * 50
        self.asked, self.refusing = [], None

    def status(self):
        return 1 << 5 | self.locked << 8 | self.besides

    def inputs_registers(self):
        registers = words(self.status())
        for position in self.positions:
            registers += words(position)
        registers += words(self.inputs) + words(self.outputs) + [11, 22, 33, 1023] + words(self.probed)
        return registers + [0] * 8 + words(self.directions)

    def execute(self):
        number, first, *rest = self.command
        axes = [axis for axis in range(5) if first >> axis & 1]
        if number == RESET:
            self.locked = self.locked and first & 1 == 0
        elif number == STOP:
            self.locked = True
        elif number in (POSITION, SEGMENT):
            if not axes or first > 31:
                return ExcCodes.ILLEGAL_VALUE
            skip = 0 if number == POSITION else 2
            for place, axis in enumerate(axes):
                self.positions[axis] = signed(*rest[skip + 2 * place :][:2])
        elif number == MOVE:
            if len(axes) != 1:
                return ExcCodes.ILLEGAL_VALUE
            target = signed(*rest[5:7])
            self.directions = self.directions & ~first | (first if target > self.positions[axes[0]] else 0)
            self.positions[axes[0]] = target
        elif number == PROBE:
            sense = -1 if rest[0] == 0xFFFF else 1
            self.probed = self.positions[axes[0]] + sense * signed(*rest[3:5]) // 2
            self.positions[axes[0]] = self.probed + sense
        elif number == HOME_AXIS:
            self.positions[first - 1] = signed(*rest[9:11])
        return None

    def write(self, function, address, values):
        self.asked.append(f"{function} {address} {','.join(str(int(value)) for value in values)}")
        if function in (5, 15):
            for place, value in enumerate(values, address):
                if place == LOCK:
                    self.locked = bool(value)
                elif place < LOCK and not self.locked:
                    mask = 1 << place - FIRST_OUTPUT
                    self.outputs = self.outputs & ~mask | (mask if value else 0)
            return None
        for place, value in enumerate(values, address):
            if COMMAND <= place < COMMAND + 50:
                self.command[place - COMMAND] = value
            elif place in (OUTPUTS, OUTPUTS + 1) and not self.locked:
                shift = 16 if place == OUTPUTS else 0
                self.outputs = self.outputs & ~(0xFFFF << shift) | value << shift
        return self.execute() if address == COMMAND else None

    async def access(self, function, start, address, count, registers, values):
        if self.refusing is not None:
            code, self.refusing = ExcCodes(self.refusing), None
            return code
        if values is not None:
            return self.write(function, address, values)
        if function == 1:
            # Sixteen bits a register, the first address in bit 0.
            registers[0:3] = [self.outputs & 0xFFFF, self.outputs >> 16, registers[2] & 0xFFFE | self.locked]
        elif function == 2:
            status = self.status()
            registers[0:1] = [self.inputs & 0xFFFF]
            registers[2:5] = [status & 0xFFFF, status >> 16, self.directions | 0b10 << 5]
        elif function == 3:
            registers[OUTPUTS - start : OUTPUTS - start + 2] = words(self.outputs)
        elif function == 4:
            registers[0:32] = self.inputs_registers()
        return None

    def by_hand(self, line):
        what, *rest = line.split()
        if what == "requests":
            said, self.asked = " | ".join(self.asked), []
            return said
        if what == "refuse":
            self.refusing = int(rest[0])
        elif what == "status":
            self.besides = int(rest[0])
        elif what == "input":
            mask = 1 << int(rest[0]) - 1
            self.inputs = self.inputs & ~mask | (mask if rest[1] == "1" else 0)
        else:
            raise KeyError(what)
        return "done"


def holding():
    """Registers that hold what is written: parameters 101 and 103, the size of recipes, and zeros."""
    values = [0] * (6637 - COMMAND)
    for address, value in ((4554, 1), (4555, 0xC200), (4559, 1), (4218, 0xFFFF), (4219, 0xFFF9), (4221, 5), (4222, 1)):
        values[address - COMMAND] = value
    values[5632 - COMMAND] = 250
    return values


async def main(port):
    board = Board()
    blocks = (
        [SimData(FIRST_OUTPUT, count=256, values=False, datatype=DataType.BITS)],
        [SimData(2048, count=256, values=False, datatype=DataType.BITS)],
        [SimData(COMMAND, values=holding(), datatype=DataType.REGISTERS)],
        [SimData(1024, count=32, values=0, datatype=DataType.REGISTERS)],
    )
    device = SimDevice(1, simdata=blocks, use_bit_addressing=True, action=board.access)
    server = ModbusSerialServer(device, port=port, baudrate=115200, broadcast_enable=True)
    serving = asyncio.create_task(server.serve_forever())
    lines = asyncio.StreamReader()
    await asyncio.get_running_loop().connect_read_pipe(lambda: asyncio.StreamReaderProtocol(lines), sys.stdin)
    while server.transport is None:
        await asyncio.sleep(0.01)
    print("ready", flush=True)
    while line := (await lines.readline()).decode():
        print(board.by_hand(line), flush=True)
    serving.cancel()


asyncio.run(main(sys.argv[1]))
