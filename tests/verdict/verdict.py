#!/usr/bin/env python3
"""Precision and recall of `twin check` on generated programs with known violations.

    tests/verdict/verdict.py --twin target/release/twin                    10,000 programs
    tests/verdict/verdict.py --twin target/debug/twin --count 300 --seed 7

truth.cpp generates the programs and computes their true axis extremes; `twin check` judges the same files. Every pair of
axis and rule of every program is compared: "violations" are the pairs above their limit. "lines off" are pairs with a
finding on a line that keeps the limit, or without one on a line that does not. "peaks off" are programs whose report has
another peak value than the truth. Exit status 1: a violation is missed, or a finding or its line is wrong.

- A program with a point outside the reach is judged on the rule `reach` alone, because other findings follow from it.
- Values closer to their limit than 1e-5 of it are undecided and left out.
- Where the tool turns with the path, axes jump at corners. A jump counts as the velocity that makes it in one cycle, and
  as a step to that velocity if it keeps the limit of the velocity.
- Corners that are passed within a cycle of each other make one step of the velocity, their sum.
"""

import argparse
import concurrent.futures
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterable

PLAN = "programmed"  # value of --limits: the motion follows F and E alone
MARGIN = 1e-5        # relative distance from a limit below which a value is undecided
PEAK_TOLERANCE = 1e-4
REACH_MARGIN_MM = 5e-4
CYCLE_S = 1e-3
BATCH = 100          # programs per call of twin
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
WORK_OFFSETS = {"g55": [20.0, -10.0, 5.0], "g56": [-15.5, 12.25, -3.0], "g57": [100.0, 0.0, 0.0],
                "g58": [0.0, -60.0, 0.125], "g59": [-7.0, -7.0, 7.0]}
SIZES = {"0.2 % or less": 0.002, "0.2 % to 2 %": 0.02, "2 % to 20 %": 0.2, "20 % to 200 %": 2.0, "200 % to 1000 %": 9.95,
         "1000 % or more": float("inf")}
RS274_CAPS = {"rapid_velocity_mm_per_s": 80.0, "acceleration_mm_per_s2": 400.0}
RULES = ["reach", "axis-position", "axis-velocity", "axis-acceleration", "axis-velocity-step"]


# ---------------------------------------------------------------------------------------------------------- machine files

def prepare_machine(source: pathlib.Path, folder: pathlib.Path) -> tuple[pathlib.Path, dict]:
    """Copies a machine file; adds work offsets, which shipped machines leave at 0, and caps of RS274 programs.

    RS274 has no word for rapids and accelerations: they are what the axes can do, unless a lower number caps them.
    """
    text = source.read_text(encoding="utf-8")
    text = re.sub(r"^(rapid_velocity|acceleration)_mm_per_s.*\n", "", text, flags=re.MULTILINE)
    caps = "".join(f"{key} = {value}\n" for key, value in RS274_CAPS.items())
    text = text.replace("[rs274]\n", f"[rs274]\n{caps}", 1) if "[rs274]\n" in text else f"{text}\n[rs274]\n{caps}"
    lines = "\n".join(f"{name} = {value}" for name, value in WORK_OFFSETS.items())
    table = "[rs274.work_offsets_mm]"
    if table in text:
        text = text.replace(table, f"{table}\n{lines}", 1)
    else:
        text += f"\n{table}\n{lines}\n"
    copy = folder / source.name
    copy.write_text(text, encoding="utf-8")
    return copy, tomllib.loads(text)


def flatten(machine: dict) -> str:
    """The machine as truth.cpp reads it: "key number number …"."""
    kinematics, tool = machine["kinematics"], machine.get("tool", {})
    program = {**machine.get("program", {}), **machine.get("controller", {})}
    rs274 = machine.get("rs274", {})
    frame = machine.get("work_frame", {})
    if any(frame.get("rotation_deg", [])) or any(map(any, kinematics.get("deviations", {}).values())):
        sys.exit(f"{machine['name']}: turned work frames and deviations are not supported")
    kind, acceleration = kinematics["kind"], rs274.get("acceleration_mm_per_s2", 1e9)
    source = kinematics.get("direction", "tangential" if "cutter" in kind else "fixed")
    offsets = kinematics.get("offsets_deg" if kind.startswith("scara") else "offsets_mm", [0, 0, 0])
    work = [rs274.get("work_offsets_mm", {}).get(f"g{n}", [0, 0, 0]) for n in range(54, 60)]
    numbers = {
        "offsets": [*offsets, 0, 0, 0],
        "tool_length": [tool.get("length_mm", 0)],
        "tool_offset": tool.get("offset_mm", [0, 0]),
        "tool_angle": [kinematics.get("tool_angle_deg", 0)],
        "tool_ahead": [kinematics.get("tool_ahead_mm", 0)],
        "tool_left": [kinematics.get("tool_left_mm", 0)],
        "offset_r": [kinematics.get("offset_r_deg", 0)],
        "sense_r": [-1 if kinematics.get("sense_r") == "clockwise" else 1],
        "belt_exchanged": [int(kinematics.get("belt", "standard") == "coordinates_exchanged")],
        "arms": kinematics.get("arm_lengths_mm", [0]),
        "elbow": [-1 if kinematics.get("elbow") == "high" else 1],
        "inner": [kinematics.get("inner_radius_mm", 0)],
        "outer": [kinematics.get("outer_radius_mm", 0)],
        "rod_length": [kinematics.get("rod_length_mm", 0)],
        "rod_distance": [kinematics.get("rod_distance_mm", 0)],
        "rotation": [kinematics.get("rotation_deg", 0)],
        "direction_from_path": [int(source == "tangential")],
        "direction": [kinematics.get("direction_deg", 0)],
        "work_frame": frame.get("translation_mm", [0, 0, 0]),
        "start": program.get("start_mm", [0, 0, 0]),
        "angle_tolerance": [program.get("angle_tolerance_deg", 2.0)],
        "rs274": [rs274.get("rapid_velocity_mm_per_s", 1e9), acceleration,
                  rs274.get("deceleration_mm_per_s2", acceleration)],
        "work_offsets": sum(work, []),
    }
    lines = [f"name {machine['name']}", f"kind {kind}"]
    lines += [f"{key} {' '.join(map(str, values))}" for key, values in numbers.items()]
    for axis in axes_of(machine):
        lines.append(" ".join(map(str, ("axis", *axis.values()))))
    return "\n".join(lines) + "\n"


def axes_of(machine: dict) -> list[dict]:
    """Limits of the axes in mm or degrees; axes without position limits get ±1e6."""
    axes = []
    for axis in machine["axes"]:
        unit = "deg" if axis["kind"] == "rotary" else "mm"
        acceleration = axis[f"max_acceleration_{unit}_per_s2"]
        axes.append({
            "name": axis["name"],
            "min": axis.get(f"position_min_{unit}", -1e6),
            "max": axis.get(f"position_max_{unit}", 1e6),
            "velocity": axis[f"max_velocity_{unit}_per_s"],
            "acceleration": acceleration,
            "step": axis.get(f"max_velocity_step_{unit}_per_s", acceleration * CYCLE_S),
        })
    return axes


# ------------------------------------------------------------------------------------------------------ truth and verdict

def read_truths(output: str) -> list[dict]:
    """Truth of each program, with that of its lines under "lines"."""
    truths = []
    for line in output.splitlines():
        words = line.split()
        if words[0] == "+":
            truths[-1]["lines"][int(words[1])] = {"reach": float(words[2]), "axes": read_axes(words[3:])}
        else:
            truths.append({"file": words[0], "kind": words[1], "target": words[2], "factor": float(words[3]),
                           "duration": float(words[4]), "reach": float(words[5]), "axes": read_axes(words[6:]), "lines": {}})
    return truths


def read_axes(words: list[str]) -> dict[str, dict[str, float]]:
    names = ("min", "max", "velocity", "acceleration", "step", "jump")
    return {words[i]: dict(zip(names, map(float, words[i + 1:i + 7]))) for i in range(0, len(words), 7)}


def compared(value: float, limit: float, margin: float = MARGIN) -> bool | None:
    """Whether a value is above its limit; None: too close to it to decide."""
    if abs(value - limit) <= margin * abs(limit):
        return None
    return value > limit


def expected(truth: dict, axes: list[dict]) -> dict[tuple[str, str], tuple[bool | None, float, float]]:
    """Per axis and rule: violated or not (None: undecided), true value, limit."""
    reach = truth["reach"]
    if reach <= REACH_MARGIN_MM:
        return {("", "reach"): (True if reach < -REACH_MARGIN_MM else None, reach, 0.0)}
    rules = {("", "reach"): (False, reach, 0.0)}
    for axis in axes:
        name, true = axis["name"], truth["axes"][axis["name"]]
        travel = axis["max"] - axis["min"]
        beyond = max(axis["min"] - true["min"], true["max"] - axis["max"])
        outside = None if abs(beyond) <= MARGIN * travel and travel < 1e6 else beyond > 0
        nearest = "max" if true["max"] - axis["max"] == beyond else "min"
        rules[name, "axis-position"] = (outside, true[nearest], axis[nearest])
        rules[name, "axis-acceleration"] = (compared(true["acceleration"], axis["acceleration"]),
                                            true["acceleration"], axis["acceleration"])
        jump = true["jump"] / CYCLE_S
        velocity = max(true["velocity"], jump)
        rules[name, "axis-velocity"] = (compared(velocity, axis["velocity"]), velocity, axis["velocity"])
        jumps = [line["axes"][name]["jump"] / CYCLE_S for line in truth.get("lines", {"": truth}).values()]
        step = max([true["step"], *(jump for jump in jumps if jump <= axis["velocity"])])
        rules[name, "axis-velocity-step"] = (compared(step, axis["step"]), step, axis["step"])
    return rules


def judge(truth: dict, report: dict, axes: list[dict]) -> list[dict]:
    """Compares the findings of one program with its truth, one entry per axis and rule."""
    found: dict[tuple[str, str], dict[int, float]] = defaultdict(dict)
    for finding in report["findings"]:
        if finding["severity"] == "error" and finding["rule"] in RULES:
            rule = finding["rule"]
            found["" if rule == "reach" else finding.get("axis", ""), rule][finding["line"]] = finding.get("value")
    # Bridging after a G92 is found at its line, which moves nothing.
    of_lines = {line: expected(values, axes) for line, values in truth["lines"].items()}
    scales = {(axis["name"], "axis-position"): axis["max"] - axis["min"] for axis in axes}
    entries = []
    for key, (violated, value, limit) in expected(truth, axes).items():
        reported = bool(found[key])
        verdict = ("undecided" if violated is None else "found" if violated and reported else "missed" if violated
                   else "false alarm" if reported else "right")
        lines = {line: rules[key][0] for line, rules in of_lines.items() if key in rules}
        entries.append({"verdict": verdict, "axis": key[0], "rule": key[1], "value": value, "limit": limit,
                        "excess": abs(value - limit) / scales.get(key, limit or 1.0), "twin": found[key],
                        "missed lines": [line for line, above in lines.items() if above and line not in found[key]],
                        "false lines": [line for line in found[key] if lines.get(line) is False]})
    return entries


def peaks_off(truth: dict, report: dict, axes: list[dict], text: str) -> list[str]:
    """Peak values of the report that differ from the truth by more than PEAK_TOLERANCE.

    Left out are programs that set the position on their way: each axis bridges the gap at its own limits.
    """
    bridged = truth["file"].endswith(".cnc") and text.count("G92") > 1
    if truth["reach"] <= REACH_MARGIN_MM or bridged:
        return []
    off = []
    for axis in axes:
        peak, true = report["peak"][axis["name"]], truth["axes"][axis["name"]]
        for quantity in ("velocity", "acceleration"):
            value, exact = peak[quantity]["value"], true[quantity]
            if quantity == "velocity":
                exact = max(exact, true["jump"] / CYCLE_S)
            if abs(value - exact) > PEAK_TOLERANCE * max(exact, 0.1 * axis[quantity]):
                off.append(f"{axis['name']} {quantity} {value:.9g}, truth {exact:.9g}")
        for end in ("min", "max") if axis["max"] < 1e6 else ():
            value, exact = peak["position"][end], true[end]
            if value is None or abs(value - exact) > 1e-6 * (axis["max"] - axis["min"]):
                off.append(f"{axis['name']} {end} {value}, truth {exact:.9g}")
    return off


# ------------------------------------------------------------------------------------------------------------------ runs

class Machine:
    """A machine file with its truth, its programs and the reports about them."""

    def __init__(self, source: pathlib.Path, folder: pathlib.Path):
        self.name = source.stem
        self.folder = folder / self.name
        self.folder.mkdir(parents=True)
        for urdf in source.parent.glob("*.urdf"):
            shutil.copy(urdf, self.folder)
        self.file, self.content = prepare_machine(source, self.folder)
        self.flat = self.folder / "machine.txt"
        self.flat.write_text(flatten(self.content), encoding="utf-8")
        self.axes = axes_of(self.content)

    def batch(self, options: argparse.Namespace, first: int, count: int) -> list[tuple[dict, dict]]:
        """Generates programs `first` … and checks them: pairs of truth and report."""
        truth = subprocess.run([options.truth, "generate", self.flat, str(options.seed), str(first), str(count), self.folder],
                               check=True, stdout=subprocess.PIPE, text=True).stdout
        truths = read_truths(truth)
        files = [str(self.folder / truth["file"]) for truth in truths]
        command = [options.twin, "check", *files, "--machine", self.file, "--limits", PLAN, "--format", "json"]
        done = subprocess.run(command, capture_output=True, text=True)
        reports = {}
        for line in done.stdout.splitlines():
            report = json.loads(line)
            reports[pathlib.Path(report["program"]).name] = report
        if len(reports) != count:
            sys.exit(f"{self.name}: {len(reports)} reports of {count} programs\n{done.stderr[:2000]}")
        return [(truth, reports[truth["file"]]) for truth in truths]


class Tally:
    """Rows of the table: by kind of place and by machine."""

    COLUMNS = ["programs", "violations", "found", "missed", "false alarms", "undecided", "lines off", "peaks off"]

    def __init__(self):
        self.rows: dict[str, Counter] = defaultdict(Counter)

    def add(self, row: str, entries: list[dict], off: bool) -> None:
        counts = Counter(entry["verdict"] for entry in entries)
        self.rows[row].update({
            "programs": 1, "found": counts["found"], "missed": counts["missed"], "false alarms": counts["false alarm"],
            "undecided": counts["undecided"], "violations": counts["found"] + counts["missed"], "peaks off": int(off),
            "lines off": sum(bool(entry["missed lines"] or entry["false lines"]) for entry in entries)})

    def print(self, title: str, rows: list[str]) -> None:
        print(f"{title:24}" + "".join(f"{column:>14}" for column in self.COLUMNS))
        for row in rows:
            print(f"{row:24}" + "".join(f"{self.rows[row][column]:14}" for column in self.COLUMNS))
        print()


def size_of(excess: float) -> str:
    """Row of a violation by its size: part of the limit, of the travel for positions."""
    return next(name for name, most in SIZES.items() if excess <= most)


def print_counts(title: str, rows: Iterable[str], counts: dict[str, Counter]) -> None:
    columns = ["found", "missed", "false alarm", "right", "undecided"]
    columns = [column for column in columns if any(counts[row][column] for row in rows) or column in ("found", "missed")]
    print(f"{title:24}" + "".join(f"{column:>14}" for column in columns))
    for row in rows:
        print(f"{row:24}" + "".join(f"{counts[row][column]:14}" for column in columns))
    print()


def percent(part: int, whole: int) -> str:
    return f"{100 * part / whole:.3f} %" if whole else "–"


def is_fault(entry: dict) -> bool:
    return bool(entry["verdict"] in ("missed", "false alarm") or entry["missed lines"] or entry["false lines"])


def report_fault(machine: Machine, truth: dict, bad: list[dict], text: str) -> None:
    print(f"{machine.name}/{truth['file']} ({truth['kind']}, {truth['target']} {truth['factor']:g})")
    for entry in bad:
        print(f"  {entry['verdict']}: {entry['axis']} {entry['rule']}: truth {entry['value']:.9g}, limit {entry['limit']:.9g}, "
              f"twin {entry['twin']}, lines missed {entry['missed lines']}, lines false {entry['false lines']}")
    print("".join(f"    {line}\n" for line in text.splitlines()))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--twin", default=str(ROOT / "target/release/twin"), help="program to judge")
    parser.add_argument("--count", type=int, default=10_000, help="programs over all machines")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--machine", action="append", help="only this machine (name of its file); may be repeated")
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "target/verdict", help="programs and failing programs")
    parser.add_argument("--show", type=int, default=20, help="faults that are printed in full")
    parser.add_argument("--peaks", type=int, default=0, help="differing peak values that are printed")
    options = parser.parse_args()

    shutil.rmtree(options.folder, ignore_errors=True)
    failing = options.folder / "failing"
    failing.mkdir(parents=True)
    options.truth = str(options.folder / "truth")
    subprocess.run(["c++", "-std=c++17", "-O2", "-Wall", "-o", options.truth, HERE / "truth.cpp"], check=True)
    sources = sorted((ROOT / "machines").glob("*.toml"))
    machines = [Machine(source, options.folder) for source in sources if not options.machine or source.stem in options.machine]

    jobs = []
    for index, machine in enumerate(machines):
        count = options.count // len(machines) + (index < options.count % len(machines))
        jobs += [(machine, first, min(BATCH, count - first)) for first in range(0, count, BATCH)]
    tally, shown, peaks_shown, faulty = Tally(), 0, 0, 0
    rules: dict[str, Counter] = defaultdict(Counter)
    sizes: dict[str, Counter] = defaultdict(Counter)
    with concurrent.futures.ThreadPoolExecutor(max_workers=2) as pool:
        runs = [(job[0], pool.submit(job[0].batch, options, job[1], job[2])) for job in jobs]
        for machine, run in runs:
            for truth, report in run.result():
                entries = judge(truth, report, machine.axes)
                program = machine.folder / truth["file"]
                text = program.read_text(encoding="utf-8")
                off = peaks_off(truth, report, machine.axes, text)
                for row in (truth["kind"], machine.name, "all"):
                    tally.add(row, entries, bool(off))
                for entry in entries:
                    rules[entry["rule"]][entry["verdict"]] += 1
                    if entry["rule"] != "reach" and entry["verdict"] in ("found", "missed"):
                        sizes[size_of(entry["excess"])][entry["verdict"]] += 1
                bad = [entry for entry in entries if is_fault(entry)]
                if off and peaks_shown < options.peaks:
                    peaks_shown += 1
                    print(f"peaks of {machine.name}/{truth['file']} ({truth['kind']}): " + "; ".join(off))
                if bad:
                    faulty += 1
                    shutil.copy(program, failing / f"{machine.name}-{truth['file']}")
                if bad and shown < options.show:
                    shown += 1
                    report_fault(machine, truth, bad, text)

    names = [machine.name for machine in machines]
    tally.print("place", [row for row in tally.rows if row not in names and row != "all"])
    tally.print("machine", names)
    print_counts("violation by", SIZES, sizes)
    print_counts("rule", RULES, rules)
    total = tally.rows["all"]
    print(f"\nprecision {percent(total['found'], total['found'] + total['false alarms'])}, "
          f"recall {percent(total['found'], total['violations'])}, "
          f"{total['programs']} programs, {faulty} with a fault (kept in {failing}), seed {options.seed}")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
