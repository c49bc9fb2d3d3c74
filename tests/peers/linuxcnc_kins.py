#!/usr/bin/env python3
"""Reference values of LinuxCNC's kinematics modules for poses and joints: tests/data/linuxcnc-kinematics.json.

    LINUXCNC_SRC=.../linuxcnc tests/peers/linuxcnc_kins.py          writes the file
    LINUXCNC_SRC=.../linuxcnc tests/peers/linuxcnc_kins.py --check  compares it with what comes out now

LINUXCNC_SRC is the top of LinuxCNC's sources. Needs a C compiler (CC, else cc). The modules are compiled as they are,
in linuxcnc_kins.c beside this file; nothing of them is kept here but numbers.
"""

import json
import math
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
FILE = HERE.parent / "data" / "linuxcnc-kinematics.json"
POSES = 200


def compiled(source, folder, module):
    """The program for a module."""
    program = Path(folder) / module
    src = source / "src"
    command = [os.environ.get("CC", "cc"), "-O2", "-DRTAPI", "-DUSPACE", f'-DKINS="{module}.c"']
    if module == "scarakins":
        command.append("-DSWITCHABLE")
    for part in ["emc/kinematics", "rtapi", "hal", "emc/nml_intf", "libposemath"]:
        command += ["-I", str(src / part)]
    command += [str(HERE / "linuxcnc_kins.c"), "-o", str(program), "-lm"]
    subprocess.run(command, check=True)
    return program


def run(program, direction, flag, pins, inputs):
    """(status, flag set, numbers) per line of nine numbers."""
    text = "\n".join(" ".join(repr(value) for value in line) for line in inputs)
    command = [str(program), direction, str(flag), *map(repr, pins)]
    output = subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout
    found = []
    for line in output.splitlines():
        status, set_flag, *numbers = line.split()
        found.append((int(status), int(set_flag), [float(number) for number in numbers]))
    assert len(found) == len(inputs), "a line was lost"
    return found


def nine(values, places):
    line = [0.0] * 9
    for value, place in zip(values, places):
        line[place] = value
    return line


class Random:
    """Numbers with few digits, so that the file is short; the same ones always."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def number(self, low, high):
        return round(self.random.uniform(low, high), 4)

    def within(self, *ranges):
        return [self.number(*limits) for limits in ranges]


def series(program, direction, flag, pins, inputs, places_in, places_out):
    """One list of calls: per row the inputs, what the function returned, the flag it set, and the outputs."""
    found = run(program, direction, flag, pins, [nine(values, places_in) for values in inputs])
    rows = []
    for values, (status, set_flag, numbers) in zip(inputs, found):
        outputs = [numbers[place] for place in places_out]
        if any(math.isnan(output) for output in outputs):
            outputs = []
        rows.append([values, status, set_flag, outputs])
    return {"direction": direction, "flag": flag, "pins": pins, "rows": rows}


def corexy(program):
    values, xyz = Random(1), [0, 1, 2]
    poses = [values.within(*[(-1000, 1000)] * 3) for _ in range(POSES)]
    joints = [values.within(*[(-1000, 1000)] * 3) for _ in range(POSES)]
    return [
        series(program, "inverse", 0, [], poses, xyz, xyz),
        series(program, "forward", 0, [], joints, xyz, xyz),
    ]


def linear_delta(program):
    """R and L: those LinuxCNC presets, and slimmer and wider ones. Some places are out of reach."""
    values, xyz, all_series = Random(2), [0, 1, 2], []
    for radius, rod in [(130.25, 269.0), (60.0, 300.0), (250.0, 320.0)]:
        count = POSES if rod == 269.0 else POSES // 2
        side = rod - radius
        poses = [values.within((-side, side), (-side, side), (-400, 400)) for _ in range(count)]
        apart = 1.6 * rod
        joints = [values.within(*[(300, 300 + apart)] * 3) for _ in range(count)]
        pins = [radius, rod]
        all_series.append(series(program, "inverse", 0, pins, poses, xyz, xyz))
        all_series.append(series(program, "forward", 0, pins, joints, xyz, xyz))
    return all_series


def scara(program):
    """D1 to D6: those LinuxCNC presets, the tool on the axis of joint 3, and one that points backwards."""
    values, all_series = Random(3), []
    joints_at, pose_at = [0, 1, 2, 3], [0, 1, 2, 5]
    for d6 in [50.0, 0.0, -30.0]:
        pins = [490.0, 340.0, 50.0, 250.0, 50.0, d6]
        count = POSES if d6 > 0 else POSES // 2
        joints = [values.within((-170, 170), (-175, 175), (-50, 200), (-350, 350)) for _ in range(count)]
        all_series.append(series(program, "forward", 0, pins, joints, joints_at, pose_at))
        for flag in [0, 1]:
            poses = [
                values.within((-600, 600), (-600, 600), (200, 600), (-180, 180)) for _ in range(count)
            ]
            all_series.append(series(program, "inverse", flag, pins, poses, pose_at, joints_at))
    return all_series


MODULES = [
    (
        "corexykins",
        corexy,
        "x, y, z and joints 0, 1, 2, any length.",
    ),
    (
        "lineardeltakins",
        linear_delta,
        "x, y, z and joints 0, 1, 2, mm; pins R and L. Joints are heights, positive up, the platform below them. "
        "Tower 0 is at +y, 1 and 2 follow counter-clockwise. Where the rods do not reach the function returns -1.",
    ),
    (
        "scarakins",
        scara,
        "x, y, z (mm), c (degrees) and joints 0, 1, 3 (degrees) and 2 (mm, positive down), in the order 0 1 2 3; pins "
        "D1 to D6. Flag 0 bends the elbow counter-clockwise, 1 clockwise. Where the arms do not reach they are "
        "stretched or folded in the direction of the target and the function returns 0 all the same. The forward "
        "function sets flag 1 below 90 degrees of joint 1, though its elbow bends clockwise below 0 only.",
    ),
]


def text_of(result):
    """JSON with a row per line."""
    lines = ["{"]
    for name in ["about", "source", "version", "commit"]:
        lines.append(f"  {json.dumps(name)}: {json.dumps(result[name])},")
    lines.append('  "modules": {')
    modules = []
    for name, module in result["modules"].items():
        all_series = []
        for one in module["series"]:
            head = ", ".join(f'"{key}": {json.dumps(one[key])}' for key in ["direction", "flag", "pins"])
            rows = ",\n".join(f"            {json.dumps(row)}" for row in one["rows"])
            all_series.append(f'        {{\n          {head},\n          "rows": [\n{rows}\n          ]\n        }}')
        joined = ",\n".join(all_series)
        modules.append(
            f'    "{name}": {{\n      "about": {json.dumps(module["about"])},\n      "series": [\n{joined}\n      ]\n    }}'
        )
    lines.append(",\n".join(modules))
    lines += ["  }", "}", ""]
    return "\n".join(lines)


def commit(source):
    if "LINUXCNC_COMMIT" in os.environ:
        return os.environ["LINUXCNC_COMMIT"]
    command = ["git", "-C", str(source), "rev-parse", "HEAD"]
    found = subprocess.run(command, capture_output=True, text=True)
    return found.stdout.strip() if found.returncode == 0 else "unknown"


def main():
    if "LINUXCNC_SRC" not in os.environ:
        sys.exit("LINUXCNC_SRC is not set: the top of LinuxCNC's sources")
    source = Path(os.environ["LINUXCNC_SRC"]).resolve()
    result = {
        "about": "Made by tests/peers/linuxcnc_kins.py. A row: inputs, what the function returned, the flag that it "
        "set (forward) or was given (inverse), outputs; none if there are no numbers.",
        "source": "LinuxCNC, https://github.com/LinuxCNC/linuxcnc, src/emc/kinematics",
        "version": (source / "VERSION").read_text().strip(),
        "commit": commit(source),
        "modules": {},
    }
    with tempfile.TemporaryDirectory() as folder:
        for name, make, about in MODULES:
            program = compiled(source, folder, name)
            result["modules"][name] = {"about": about, "series": make(program)}
    text = text_of(result)
    json.loads(text)
    if sys.argv[1:] == ["--check"]:
        ours = json.loads(FILE.read_text())
        theirs = json.loads(text)
        if ours["modules"] != theirs["modules"]:
            sys.exit(f"{FILE} is not what LinuxCNC {result['version']} says")
        print(f"{FILE.name} is what LinuxCNC {result['version']} ({result['commit']}) says")
    else:
        FILE.write_text(text)
        print(f"{FILE}: {sum(len(s['rows']) for m in result['modules'].values() for s in m['series'])} rows")


if __name__ == "__main__":
    main()
