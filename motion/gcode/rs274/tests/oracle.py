#!/usr/bin/python3
"""Moves of RS274 programs, as LinuxCNC's interpreter makes them.

Usage: oracle.py [--tools FILE] [--parameters FILE] [--subroutines FOLDER] [--timeout S] [--jobs N] [FOLDER]

Needs the module `gcode` of Debian's linuxcnc-uspace, hence /usr/bin/python3. Reads all .ngc files of FOLDER, or from
standard input one JSON object a line, {"name": …, "program": …}. Prints one object a line for each, in that order:

  name      of the program
  moves     in program order, see below
  rc        0, the interpreter's error code, or null if the interpreter crashed or took longer than S seconds
  line      line at which it stopped, or the one after it
  message   why, unless rc is 0

  line      line of the program, or of the subroutine's file
  kind      rapid | feed | arc | probe | dwell
  end       x, y, z in mm: tip of the tool in the machine frame, all offsets and the rotation applied
  abc, uvw  degrees and mm, unless all are 0
  feed      mm/min, or degrees/min where only A, B and C move; not of rapids and dwells
  plane     xy | xz | yz, of arcs; also turns (counter-clockwise positive, begun ones count) and center, the two
            coordinates in the plane that LinuxCNC calls first and second, mm, machine frame
  seconds   of dwells

Tools: lines of a number, X, Y, Z of the offset and the diameter, mm. Nothing is in the spindle at first. Parameters: a
parameter file, read anew for each program. Programs begin in G21, at 0, with F 25.4.

Known faults of the module: after M6 and probing it takes the position of the last straight move, in the coordinates
that it had then, for the present one. G20 and G21 take the tool offset's number for one of the new units. An arc in XZ
or YZ has no sensible centre if the coordinates are rotated. In G93 the feed of a rotary move is wrong if G20 or G21 is
in its block.
"""
import argparse, contextlib, ctypes, json, math, os, pathlib, queue, select, subprocess, sys, tempfile, threading

FILES = 'tools', 'parameters', 'subroutines'
INCH = 25.4
# Name, and indices of first and second coordinate and of the normal.
PLANES = {1: ('xy', 0, 1, 2), 2: ('yz', 1, 2, 0), 3: ('xz', 2, 0, 1)}


class Canon:
    """Machine that the interpreter drives: inches and degrees, nine axes, converted as they come."""

    def __init__(self, parameter_file, tools):
        self.parameter_file, self.tools, self.spindle = parameter_file, tools, tool(0)
        self.moves, self.line, self.metric, self.plane = [], 0, False, PLANES[1]
        self.feed = self.rotary_feed = INCH
        self.system, self.shift, self.tool, self.at = ([0.0] * 9 for _ in range(4))
        self.cos, self.sin = 1.0, 0.0

    def __getattr__(self, name):
        """Anything else that the interpreter calls has no effect on moves."""
        if name.startswith('__'):
            raise AttributeError(name)
        return lambda *_: None

    # What it asks for.
    def check_abort(self): return False
    def get_axis_mask(self): return 0x1ff
    def get_block_delete(self): return False
    def get_external_angular_units(self): return 1.0
    def get_external_length_units(self): return 1.0

    def get_tool(self, index):
        """Index 0 is the spindle, then the table in its order."""
        return self.spindle if index == 0 else self.tools[index - 1] if index <= len(self.tools) else NO_TOOL

    # What it sets. Lengths are in mm from here on.
    def next_line(self, state):
        # The units are those of the block before; so F of a block with G20 or G21 is read as it must be.
        self.line, self.metric = max(state.sequence_number, 0), 210 in state.gcodes

    def change_tool(self, index):
        self.spindle = self.tools[index - 1] if 0 < index <= len(self.tools) else tool(0)

    def set_feed_rate(self, rate):
        self.feed = rate * INCH
        self.rotary_feed = self.feed if self.metric else rate

    # Arcs of G17.1, G18.1 and G19.1 are errors.
    def set_plane(self, plane): self.plane = PLANES.get(plane, self.plane)
    def set_g5x_offset(self, _, *offset): self.system = millimetres(offset)
    def set_g92_offset(self, *offset): self.shift = millimetres(offset)

    def set_xy_rotation(self, degrees):
        self.cos, self.sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

    def tool_offset(self, *offset):
        before, self.tool = self.tool, millimetres(offset)
        self.at = [at + old - new for at, old, new in zip(self.at, before, self.tool)]

    # What it does.
    def straight_traverse(self, *end): self.move('rapid', self.machine(millimetres(end)))
    def straight_feed(self, *end): self.move('feed', self.machine(millimetres(end)))
    def straight_probe(self, *end): self.move('probe', self.machine(millimetres(end)))
    def rigid_tap(self, *end): self.move('feed', self.machine(millimetres(end))[:3] + self.at[3:])
    def dwell(self, seconds): self.moves.append({'line': self.line, 'kind': 'dwell', 'seconds': seconds})

    def arc_feed(self, first, second, center_first, center_second, turns, along, *others):
        end, center = [0.0] * 3 + list(others), [0.0] * 9
        name, one, two, normal = self.plane
        end[one], end[two], end[normal] = first, second, along
        center[one], center[two] = center_first, center_second
        center = self.machine(millimetres(center))
        self.move('arc', self.machine(millimetres(end)), plane=name, turns=turns,
                  center=rounded((center[one], center[two])))

    def machine(self, program):
        """The machine's coordinates of a point of the program."""
        x, y, *others = (value + shift for value, shift in zip(program, self.shift))
        turned = [self.cos * x - self.sin * y, self.sin * x + self.cos * y, *others]
        return [value + system for value, system in zip(turned, self.system)]

    def move(self, kind, end, **details):
        move = {'line': self.line, 'kind': kind, 'end': rounded(end[:3])}
        for name, values in ('abc', end[3:6]), ('uvw', end[6:]):
            if any(abs(value) > 1e-12 for value in values):
                move[name] = rounded(values)
        if kind != 'rapid':
            moved = [abs(to - at) > 1e-9 for to, at in zip(end, self.at)]
            rotary = any(moved[3:6]) and not any(moved[:3] + moved[6:]) and kind != 'arc'
            move['feed'] = round(self.rotary_feed if rotary else self.feed, 6)
        self.moves.append(move | details)
        self.at = end


def tool(number, x=0.0, y=0.0, z=0.0, diameter=0.0):
    """Number, offsets of nine axes, diameter, and what lathes need."""
    return (int(number), float(x), float(y), float(z)) + (0.0,) * 6 + (float(diameter), 0.0, 0.0, 0)


NO_TOOL = tool(-1)


def millimetres(values):
    return [value if 3 <= axis < 6 else value * INCH for axis, value in enumerate(values)]


def rounded(values):
    return [round(value, 6) + 0.0 for value in values]


def child(options, folder, answers):
    """Answers each name of a program's file on standard input by the program's moves."""
    tools = [tool(*line.split()) for line in open(options.tools)] if options.tools else []
    # The interpreter looks up indices of tools in a file that is mapped into memory, and everything else by `get_tool`.
    os.environ['HOME'] = folder
    table, parameters = os.path.join(folder, 'tools'), os.path.join(folder, 'parameters')
    pathlib.Path(table).write_text(''.join(f'T{one[0]} P{one[0]}\n' for one in tools))
    if options.subroutines:
        os.environ['INI_FILE_NAME'] = os.path.join(folder, 'ini')
        pathlib.Path(folder, 'ini').write_text(f'[RS274NGC]\nSUBROUTINE_PATH={options.subroutines}\n')
    import gcode
    library = ctypes.CDLL('libtooldata.so.0', mode=ctypes.RTLD_GLOBAL)
    library._Z17tool_mmap_creatorPK13EMC_TOOL_STATi(None, 0)
    library._Z13tooldata_initb(False)
    library._Z13tooldata_loadPKcPPc(table.encode(), None)
    initial = pathlib.Path(options.parameters).read_bytes() if options.parameters else b''
    # The module keeps the tool offset of the program before.
    reset, is_dirty = os.path.join(folder, 'reset'), False
    pathlib.Path(reset).write_text('G49\nM2\n')
    for program in map(str.rstrip, sys.stdin):
        if is_dirty:
            gcode.parse(reset, Canon(parameters, tools), 'G21', '')
        pathlib.Path(parameters).write_bytes(initial)
        canon = Canon(parameters, tools)
        result = {'rc': 0, 'line': 0, 'message': ''}
        try:
            code, result['line'] = gcode.parse(program, canon, 'G21', '')
            if code > gcode.MIN_ERROR:
                result['rc'], result['message'] = code, gcode.strerror(code)
        except Exception as error:
            result['rc'], result['message'] = -1, str(error)
        is_dirty = any(canon.tool)
        print(json.dumps(result | {'moves': canon.moves}), file=answers, flush=True)


def work(options, programs, results):
    """Gives programs to a child, and to another one when it crashes or does not answer."""
    with tempfile.TemporaryDirectory() as folder:
        process, given = None, os.path.join(folder, 'program.ngc')
        for number, path, text in iter(programs.get, None):
            if text is not None:
                pathlib.Path(given).write_text(text)
            # A crash may be the fault of the program before: it counts in a child of its own.
            for is_new in [process is None, True]:
                process = process or start(options, folder)
                results[number], is_alive = ask(process, path or given, options.timeout)
                if not is_alive:
                    process.kill()
                    process.wait()
                    process = None
                if is_alive or is_new:
                    break
        if process is not None:
            process.stdin.close()
            process.wait()


def start(options, folder):
    files = [f'--{name}={file}' for name in FILES if (file := getattr(options, name))]
    command = [sys.executable, '-B', os.path.abspath(__file__), f'--child={folder}', *files]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, cwd=folder)


def ask(process, path, timeout):
    """The child's answer, and whether it is still of use."""
    with contextlib.suppress(BrokenPipeError):
        process.stdin.write(f'{path}\n'.encode())
        process.stdin.flush()
    answer, message = b'', 'no answer in time'
    while not answer.endswith(b'\n') and select.select([process.stdout], [], [], timeout)[0]:
        if not (piece := os.read(process.stdout.fileno(), 1 << 20)):
            message = 'the interpreter crashed'
            break
        answer += piece
    if answer.endswith(b'\n'):
        return json.loads(answer), True
    return {'rc': None, 'line': 0, 'message': message, 'moves': []}, False


def main():
    parser = argparse.ArgumentParser()
    for name in *FILES, 'child':
        parser.add_argument(f'--{name}', type=os.path.abspath)
    parser.add_argument('--timeout', type=float, default=5.0)
    parser.add_argument('--jobs', type=int, default=os.cpu_count())
    parser.add_argument('folder', nargs='?')
    options = parser.parse_args()
    if options.child:
        # What the interpreter prints goes elsewhere.
        answers = os.fdopen(os.dup(1), 'w')
        os.dup2(2, 1)
        return child(options, options.child, answers)
    if options.folder:
        paths = sorted(pathlib.Path(options.folder).absolute().rglob('*.ngc'))
        given = [(str(path), str(path), None) for path in paths]
    else:
        given = [(item['name'], None, item['program']) for item in map(json.loads, sys.stdin)]
    programs, results = queue.SimpleQueue(), [None] * len(given)
    for item in [(number, path, text) for number, (_, path, text) in enumerate(given)] + [None] * options.jobs:
        programs.put(item)
    workers = [threading.Thread(target=work, args=(options, programs, results)) for _ in range(options.jobs)]
    for step in threading.Thread.start, threading.Thread.join:
        for worker in workers:
            step(worker)
    for (name, _, _), result in zip(given, results):
        print(json.dumps({'name': name} | result))


if __name__ == '__main__':
    main()
