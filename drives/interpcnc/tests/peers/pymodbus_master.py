#!/usr/bin/env python3
"""pymodbus 3.16 as the master of an InterpCNC board: `pymodbus_master.py PORT`.

Every block of the manual is read and, where it can be, written; every command is given; what the board refuses is
refused. The script says on its standard output what it wants done at the board ("input 3 1") and waits for a line.
"""

import sys

from pymodbus import FramerType
from pymodbus.client import ModbusSerialClient
from pymodbus.exceptions import ModbusIOException
from pymodbus.pdu import bit_message, register_message

STATION = 1
# First and last address, how they are read, how many at a time.
BLOCKS = {
    "coils": (256, 511, "read_coils", 2000),
    "discrete inputs": (2048, 2303, "read_discrete_inputs", 2000),
    "input registers": (1024, 1055, "read_input_registers", 125),
    "holding registers": (4096, 6636, "read_holding_registers", 125),
}
FUNCTION, ADDRESS, VALUE, FAILURE = 1, 2, 3, 4
EMPTY, ESTOP, LOCKED = 1 << 5, 1 << 7, 1 << 8
HOMING, HOMING_ERROR, PROBING, PROBE_ERROR, EEPROM = 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14
ASYNC_X = 1 << 22
INTERPOLATED = 0b11111


def pair(value):
    """High word, low word."""
    return [value >> 16 & 0xFFFF, value & 0xFFFF]


def signed(high, low):
    value = high << 16 | low
    return value - (value >> 31 << 32)


class Master:
    def __init__(self, port, timeout=10):
        self.port = port
        self.client = ModbusSerialClient(port, framer=FramerType.RTU, baudrate=115200, timeout=timeout, retries=0)
        assert self.client.connect()

    def do(self, name, *arguments, **named):
        answer = getattr(self.client, name)(*arguments, device_id=STATION, **named)
        assert not answer.isError(), (name, arguments, named, answer)
        return answer

    def read(self, name, address, count=1):
        answer = self.do(name, address, count=count)
        return answer.bits[:count] if "coil" in name or "discrete" in name else answer.registers

    def holding(self, address, count=1):
        return self.read("read_holding_registers", address, count)

    def input(self, address, count=1):
        return self.read("read_input_registers", address, count)

    def long(self, address):
        return signed(*self.input(address, 2))

    def status(self):
        high, low = self.input(1024, 2)
        return high << 16 | low

    def positions(self):
        return [self.long(1026 + 2 * axis) for axis in range(5)]

    def command(self, *registers):
        self.do("write_registers", 4096, list(registers))

    def refused(self, code, name, *arguments, **named):
        answer = getattr(self.client, name)(*arguments, device_id=STATION, **named)
        assert answer.isError() and answer.exception_code == code, (code, name, arguments, named, answer)

    def request_refused(self, code, request):
        answer = self.client.execute(False, request)
        assert answer.isError() and answer.exception_code == code, (code, request, answer)

    def until(self, condition, what):
        for _ in range(10000):
            status = self.status()
            if condition(status):
                return status
        raise SystemExit(f"no {what}")

    def rest(self):
        moving = INTERPOLATED | INTERPOLATED * ASYNC_X
        return self.until(lambda status: status & moving == 0 and status & EMPTY, "rest")

    def stored(self):
        self.until(lambda status: status & EEPROM == 0, "end of the write to the EEPROM")

    @staticmethod
    def please(what):
        print(what, flush=True)
        assert sys.stdin.readline().strip() == "done", what


def blocks(it):
    """Everything reads, as it is after power-up; one address before and one after do not."""
    for name, (first, last, read, most) in BLOCKS.items():
        for address in range(first, last + 1, most):
            count = min(most, last + 1 - address)
            assert len(it.read(read, address, count)) == count, name
        it.refused(ADDRESS, read, first - 1, count=1)
        it.refused(ADDRESS, read, last + 1, count=1)
        it.refused(ADDRESS, read, last, count=2)
    assert it.status() == EMPTY | LOCKED and it.positions() == [0] * 5
    bits = it.read("read_discrete_inputs", 2080, 32)
    assert [place for place, bit in enumerate(bits) if bit] == [5, 8]
    assert it.read("read_coils", 256, 32) == [False] * 32 and it.read("read_coils", 288) == [True]
    assert it.holding(4352 + 2 * 101, 6) == [*pair(115200), *pair(0), *pair(1)]
    assert it.holding(5632, 5) == [250, 0, 0, 0, 0]


def lock(it):
    """A locked board answers as usual and does nothing; ENABLE decides whether it can be unlocked."""
    it.command(80, 1, 200, 50, *pair(20000), 40, *pair(100000))
    it.command(6, 1, *pair(5000), *pair(1000))
    it.do("write_coil", 256, True)
    it.do("write_registers", 4148, [0xFFFF, 0xFFFF])
    assert it.status() == EMPTY | LOCKED and it.positions() == [0] * 5
    assert it.read("read_coils", 256, 32) == [False] * 32 and it.input(1038, 2) == [0, 0]
    it.command(66, 1)
    assert it.status() == EMPTY and it.read("read_coils", 288) == [False]
    it.please("enable 0")
    it.until(lambda status: status & ESTOP, "loss of ENABLE")
    it.command(66, 1)
    assert it.status() == EMPTY | ESTOP | LOCKED
    it.please("enable 1")
    it.until(lambda status: status & ESTOP == 0, "ENABLE")
    assert it.status() == EMPTY | LOCKED
    it.do("write_coil", 288, False)
    assert it.status() == EMPTY


def memory(it):
    # Outputs, three ways in and three ways out.
    it.do("write_coil", 256 + 16, True)
    it.do("write_coils", 256, [bool(0x0A5 >> bit & 1) for bit in range(12)])
    assert it.input(1038, 2) == it.holding(4148, 2) == [1, 0x0A5]
    it.do("write_registers", 4148, [0x8000, 0x1234])
    assert it.input(1038, 2) == [0x8000, 0x1234]
    coils = it.read("read_coils", 256, 32)
    assert [bit for bit in range(32) if coils[bit]] == [2, 4, 5, 9, 12, 31]
    it.do("write_register", 4149, 0)
    it.do("write_register", 4148, 0)
    assert not any(it.read("read_coils", 256, 32))
    # Inputs.
    for number in (1, 3, 16, 17, 32):
        it.please(f"input {number} 1")
        assert it.long(1036) & 0xFFFFFFFF == 1 << number - 1
        if number <= 16:
            assert it.read("read_discrete_inputs", 2048, 16).index(True) == number - 1
        it.please(f"input {number} 0")
        assert it.long(1036) == 0
    # What only holds what was written: user bits, registers, values, EEPROM, a parameter without meaning (200).
    pattern = [bit % 3 == 0 for bit in range(96)]
    it.do("write_coils", 320, pattern)
    it.do("write_coil", 415, True)
    assert it.read("read_coils", 320, 96) == [*pattern[:95], True]
    for first, count in ((4150, 46), (4196, 2), (4198, 20), (4352 + 2 * 200, 2), (5120, 100), (5532, 100)):
        values = [(first * 7 + place * 257) & 0xFFFF for place in range(count)]
        it.do("write_registers", first, values)
        it.stored()
        assert it.holding(first, count) == values, first
        it.do("write_register", first, 0xABCD)
        it.stored()
        assert it.holding(first, count) == [0xABCD, *values[1:]], first
    it.do("write_registers", 4146, [1023, 512])
    assert it.holding(4146, 2) == [1023, 512]
    it.refused(VALUE, "write_register", 4146, 1024)
    # Recipes: 5000 registers, four windows.
    it.do("write_register", 5632, 100)
    it.stored()
    it.do("write_registers", 5633, [3, 3, 49, 0])
    it.stored()
    it.do("write_registers", 5637, list(range(100)))
    it.stored()
    assert it.holding(5887, 100) == list(range(100)) and it.holding(6137, 100) == it.holding(6387, 100) == [0] * 100
    it.do("write_register", 5635, 50)
    it.stored()
    for address in (5737, 6137):
        it.refused(ADDRESS, "read_holding_registers", address, count=1)
        it.refused(ADDRESS, "write_register", address, 1)
    it.refused(VALUE, "write_register", 5632, 251)
    it.refused(VALUE, "write_register", 5632, 0)
    it.do("write_register", 5632, 250)
    it.stored()
    assert it.holding(5637, 2) == [0, 0]
    # Read only and reserved.
    for address in (4218, 4223, 4224, 4351):
        it.refused(ADDRESS, "write_register", address, 0)
    for address in (289, 416, 512, 2048):
        it.refused(ADDRESS, "write_coil", address, True)


def moves(it):
    # 67, the manual's examples.
    it.command(67, 1, *pair(1000))
    assert it.positions() == [1000, 0, 0, 0, 0]
    it.command(67, 5, *pair(1000), *pair(0))
    it.command(67, 0b11111, *(word for value in (1, -2, 3, -4, 5) for word in pair(value)))
    assert it.positions() == [1, -2, 3, -4, 5]
    # 80: each axis by itself, changed on the fly.
    for axis in range(5):
        it.command(80, 1 << axis, 200, 500, *pair(20000), 400, *pair(-3000 * (axis + 1)))
    it.rest()
    assert it.positions() == [-3000, -6000, -9000, -12000, -15000]
    assert it.read("read_discrete_inputs", 2112, 5) == [False] * 5
    it.command(80, 1, 200, 500, *pair(1000), 400, *pair(1_000_000))
    it.until(lambda status: status & ASYNC_X, "motion")
    assert it.read("read_discrete_inputs", 2102) == it.read("read_discrete_inputs", 2112) == [True]
    it.command(96, 1, *pair(50000))
    it.command(80, 1, 200, 500, *pair(150000), 400, *pair(-5000))
    it.until(lambda status: status & ASYNC_X == 0 and it.long(1026) == -5000, "target")
    # 41 and 42 stop with ramp, 43 stops and locks; 4096 alone by function 6 is a command too.
    for stop in ((41, 1), (42,), (43,), None):
        it.command(80, 1, 200, 500, *pair(2000), 400, *pair(1_000_000_000))
        it.until(lambda status: status & ASYNC_X, "motion")
        if stop:
            it.command(*stop)
        else:
            it.do("write_register", 4096, 42)
        status = it.rest()
        stands = it.positions()
        assert it.positions() == stands and bool(status & LOCKED) == (stop == (43,))
        it.command(66, 1)
    # 41 leaves the other axis alone.
    it.command(80, 1, 200, 500, *pair(2000), 400, *pair(1_000_000_000))
    it.command(80, 2, 200, 500, *pair(2000), 400, *pair(1_000_000_000))
    it.command(41, 1)
    it.until(lambda status: status & ASYNC_X == 0, "rest of X")
    assert it.status() & ASYNC_X << 1
    it.command(42)
    it.rest()
    # 6: segments one after the other, on the axes of the mask only.
    it.command(67, 0b11111, *[0] * 10)
    it.command(6, 5, *pair(5000), *pair(1000), *pair(-2000))
    it.command(6, 0b11111, *pair(20000), *(word for value in (1, 2, 3, 4, -5) for word in pair(value)))
    it.command(6, 2, *pair(5000), *pair(700))
    assert it.status() & INTERPOLATED == 5
    it.rest()
    assert it.positions() == [1, 700, 3, 4, -5]
    # Arguments by function 6 first, the command last.
    for register, value in ((4097, 1), (4098, 0), (4099, 321)):
        it.do("write_register", register, value)
        assert it.positions()[0] == 1
    it.do("write_register", 4096, 67)
    assert it.positions() == [321, 700, 3, 4, -5]


def searches(it):
    # 40, the manual's example, with the edge and without.
    it.command(67, 4, *pair(0))
    probe = (40, 4, 0xFFFF, 3, 1, *pair(10000), *pair(1000), 100, 50, 100)
    it.command(*probe)
    it.until(lambda status: status & PROBING and it.long(1030) < -10, "motion")
    it.please("input 3 1")
    assert it.until(lambda status: status & PROBING == 0, "end of the probe") & PROBE_ERROR == 0
    touched, stands = it.long(1044), it.long(1030)
    # From 1000 Hz at 100 kHz/s to 100 Hz: (1000^2 - 100^2) / 2 / 100000 = 5 steps.
    assert -10000 < stands <= touched < -10 and touched - stands <= 6, (touched, stands)
    it.command(*probe)
    it.until(lambda status: status & PROBE_ERROR and status & PROBING == 0, "error: the input is there already")
    it.command(66, 4)
    assert it.status() & PROBE_ERROR == 0
    it.please("input 3 0")
    it.command(40, 4, 1, 3, 1, *pair(50), *pair(1000), 100, 50, 100)
    it.until(lambda status: status & PROBE_ERROR and status & PROBING == 0, "error: no input")
    it.command(66, 4)
    # 78: to the switch, off it, and there is the position asked for; or no switch within the stroke.
    it.command(78, 1, 5, 1, 50, *pair(4000), 40, *pair(-60000), 300, *pair(-777))
    it.until(lambda _: it.long(1054) >> 18 & 1, "homing of X")
    start = it.long(1026)
    it.until(lambda _: it.long(1026) < start - 10, "motion to the switch")
    it.please("input 5 1")
    it.until(lambda _: it.long(1054) & 1, "motion off the switch")
    it.please("input 5 0")
    it.until(lambda _: it.long(1054) >> 18 & 1 == 0, "end of homing")
    it.rest()
    assert it.long(1054) >> 19 & 1 == 0 and it.long(1026) == -777, it.long(1026)
    it.command(78, 5, 5, 1, 50, *pair(4000), 40, *pair(100), 300, *pair(0))
    it.until(lambda _: it.long(1054) >> 26 & 3 == 2, "error: no switch of B")
    # 71, example 2, on a board whose parameters know no switches.
    it.command(71, 5, *pair(10000), *pair(20000))
    it.until(lambda status: status & HOMING == 0 and status & HOMING_ERROR, "error: no switches")
    it.command(66, 2)
    assert it.status() & HOMING_ERROR == 0
    it.rest()


def refusals(it):
    for mask in (0, 32, 0xFFFF):
        it.refused(VALUE, "write_registers", 4096, [67, mask, 0, 0])
        it.refused(VALUE, "write_registers", 4096, [80, mask, 200, 50, *pair(100), 40, *pair(0)])
    for number in (0, 1, 99, 4096):
        it.refused(VALUE, "write_register", 4096, number)
    it.refused(ADDRESS, "write_registers", 7000, [1])
    it.refused(ADDRESS, "write_registers", 6636, [1, 1])
    # Counts that pymodbus would not send by itself.
    counts = (
        (register_message.ReadInputRegistersRequest, 1024, (0, 126)),
        (register_message.ReadHoldingRegistersRequest, 4352, (0, 126)),
        (bit_message.ReadCoilsRequest, 256, (0, 2001)),
        (bit_message.ReadDiscreteInputsRequest, 2048, (0, 2001)),
    )
    for kind, address, wrong in counts:
        for count in wrong:
            request = kind(address=address, count=1, dev_id=STATION)
            request.count, request.verifyCount = count, lambda most: None
            it.request_refused(VALUE, request)
    # Functions that the board does not have: 23, 22, 8, 17.
    it.refused(FUNCTION, "readwrite_registers", read_address=4150, read_count=1, write_address=4150, values=[1])
    it.refused(FUNCTION, "mask_write_register", address=4150, and_mask=0xFFFF, or_mask=0)
    it.refused(FUNCTION, "diag_query_data", b"\x12\x34")
    it.refused(FUNCTION, "report_device_id")
    # The command buffer is full at last.
    for place in range(300):
        answer = it.client.write_registers(4096, [6, 1, *pair(100), *pair(100000 + place)], device_id=STATION)
        if answer.isError():
            assert answer.exception_code == FAILURE and place > 8, (place, answer)
            break
    else:
        raise AssertionError("the buffer takes anything")
    it.command(42)
    it.rest()
    # Another station is not there; what is said to all is done and not answered.
    before = it.positions()
    it.client.write_registers(4096, [67, 1, *pair(before[0] + 1)], device_id=0, no_response_expected=True)
    assert it.positions() == [before[0] + 1, *before[1:]]
    it.client.close()
    impatient = Master(it.port, timeout=0.3)
    try:
        answer = impatient.client.read_input_registers(1024, count=1, device_id=2)
    except ModbusIOException:
        assert impatient.status() == EMPTY
    else:
        raise AssertionError(answer)


if __name__ == "__main__":
    master = Master(sys.argv[1])
    for part in (blocks, lock, memory, moves, searches, refusals):
        part(master)
        print(f"agreed {part.__name__}", flush=True)
