#!/usr/bin/env python3
"""Computing times of twin and of its peers on the same files, as tables.

    tests/speed/speed.py --twin target/release/twin                         programs and drawings of the project
    tests/speed/speed.py --twin target/release/twin bear.nc part.dxf ...    other RS274 programs and drawings
    tests/speed/speed.py --twin target/release/twin --install ...           installs the peers first, where it can

Peers: `rs274 -g` (LinuxCNC's interpreter, Debian's linuxcnc-uspace) reads a program; ezdxf reads a drawing, without the start
of Python. A dash: the peer is not installed. Times are user time, s: the least of three runs, one run if it takes longer than
5 s. "failed": the command did not succeed.

- "info", "check" and "limit" are `twin path --format info`, `twin check --limits programmed` and `twin limit`; "default check"
  is `twin check` within the limits of the axes. "no jerk" leaves out the jerk limits of the machine file.
- "× real time": duration of a program divided by the additional time of `--physics`.
- "Decoding" has generated programs: plain G1 lines, lines with expressions, and a loop; lines/s of the decoder alone
  (`cargo build --release -p twin-gcode --example rs274_speed`) and of `rs274 -g`.
- "Length" has programs of 1,000 and 1,000,000 lines: lines/s of `twin check --limits programmed`, and its memory.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAMS = sorted((ROOT / "tests/data/linuxcnc_planner").glob("*.ngc"))
DRAWINGS = [ROOT / "tests/data/path_drawing/part.dxf"]
LONG_S = 5.0
LINES = 1_000_000


def run(command: list, **options) -> tuple[float | None, int, str]:
    """User time in s (none if the command failed), largest memory in kB, and what the command printed."""
    with tempfile.TemporaryFile("w+") as output:
        process = subprocess.Popen([str(part) for part in command], stdout=output, stderr=subprocess.DEVNULL,
                                   stdin=subprocess.DEVNULL, **options)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        # 1: there are findings.
        good = process.returncode in (0, 1)
        return usage.ru_utime if good else None, usage.ru_maxrss, output.read()


def user_s(command: list, **options) -> float | None:
    first, _, _ = run(command, **options)
    if first is None or first > LONG_S:
        return first
    others = [run(command, **options)[0] for _ in range(2)]
    return None if None in others else min(first, *others)


def wall_ms(command: list) -> float:
    """Least of ten starts."""
    times = []
    for _ in range(10):
        start = time.perf_counter()
        run(command)
        times.append(1e3 * (time.perf_counter() - start))
    return min(times)


def shown(seconds: float | None) -> str:
    return "failed" if seconds is None else f"{seconds:.2f}" if seconds < 10 else f"{seconds:.0f}"


def table(title: str, columns: list[str], rows: list[list[str]]) -> None:
    print(f"\n{title}\n\n| {' | '.join(columns)} |\n|{'---|' * len(columns)}")
    for row in rows:
        print(f"| {' | '.join(row)} |", flush=True)


def install(folder: pathlib.Path) -> None:
    commands = [[sys.executable, "-m", "venv", folder], [folder / "bin/python", "-m", "pip", "install", "--quiet", "ezdxf"]]
    if not shutil.which("rs274") and os.getuid() == 0:
        commands.append(["apt-get", "install", "--yes", "--no-install-recommends", "linuxcnc-uspace"])
    for command in commands:
        try:
            subprocess.run(command, check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            print(f"not installed: {error}", file=sys.stderr)


def ezdxf_python(folder: pathlib.Path) -> pathlib.Path | None:
    for python in [folder / "bin/python", pathlib.Path(sys.executable)]:
        if python.exists() and subprocess.run([python, "-c", "import ezdxf"], stderr=subprocess.DEVNULL).returncode == 0:
            return python
    return None


def of_programs(twin: pathlib.Path, programs: list[pathlib.Path], home: pathlib.Path) -> None:
    machine = ROOT / "machines/gantry3.toml"
    without_jerk = home / "gantry3.toml"
    without_jerk.write_text(re.sub(r"^max_jerk.*\n", "", machine.read_text(encoding="utf-8"), flags=re.MULTILINE))
    rows = []
    for program in programs:
        lines = program.read_bytes().count(b"\n")

        def ours(*words: object, machine: pathlib.Path = machine) -> str:
            return shown(user_s([twin, words[0], program, "--machine", machine, "--dialect", "rs274", *words[1:]]))

        environment = {**os.environ, "HOME": str(home)}
        rs274 = shown(user_s(["rs274", "-g", program], env=environment)) if shutil.which("rs274") else "–"
        rows.append([program.name, f"{lines:,}", rs274, ours("path", "--format", "info"),
                     ours("check", "--limits", "programmed"), ours("check"),
                     ours("limit", machine=without_jerk), ours("limit")])
    columns = ["program", "lines", "rs274", "info", "check", "default check", "limit, no jerk", "limit"]
    table("Programs on gantry3, user s", columns, rows)


def of_drawings(twin: pathlib.Path, drawings: list[pathlib.Path], python: pathlib.Path | None) -> None:
    rows = []
    for drawing in drawings:
        peer = "–"
        if python:
            code = ("import ezdxf, time; start = time.process_time(); "
                    f"list(ezdxf.readfile({str(drawing)!r}).modelspace()); print(time.process_time() - start)")
            times = [run([python, "-c", code])[2] for _ in range(3)]
            peer = shown(min(map(float, times)) if all(times) else None)
        ours = user_s([twin, "path", drawing, "--format", "info"])
        rows.append([drawing.name, f"{drawing.stat().st_size:,}", peer, shown(ours)])
    table("Drawings, user s", ["drawing", "bytes", "ezdxf", "info"], rows)


def of_machines(twin: pathlib.Path, home: pathlib.Path) -> None:
    rows = []
    ten = home / "ten.cnc"
    for name, x, z in [("gantry3", 100, 0), ("scara2", 250, 20), ("tripod", 0, -20)]:
        machine = ROOT / f"machines/{name}.toml"
        moves = [f"N{10 * number} G1 X{x + 10 * (number % 3)} Y{10 * (number % 4)} Z{z} F50 E500" for number in range(1, 10)]
        ten.write_text("\n".join(["%", *moves]) + "\n")
        check = [twin, "check", ten, "--machine", machine]
        _, _, text = run(check)
        duration = re.search(r"([0-9.]+) s$", text, flags=re.MULTILINE)
        plain, simulated = user_s(check), user_s([*check, "--physics"])
        times = "failed"
        if duration and plain is not None and simulated is not None:
            times = f"{float(duration[1]) / max(simulated - plain, 1e-3):.0f}"
        rows.append([name, f"{wall_ms(check):.0f}", times])
    print(f"\n`twin --version`: {wall_ms([twin, '--version']):.0f} ms")
    table("Ten lines", ["machine", "check, ms", "physics, × real time"], rows)


def of_decoding(twin: pathlib.Path, home: pathlib.Path) -> None:
    decoder = twin.parent / "examples/rs274_speed"
    plain = [f"G1 X{100 + number % 7 * 5}.{number % 10} Y{100 + number % 11 * 3}" for number in range(LINES)]
    expressions = []
    for number in range(LINES // 5):
        expressions += [f"#1=[{number % 360}*3.5+#<r>/2]",
                        f"G1 X[#<r>*COS[#1]+{number % 10}] Y[#<r>*SIN[#1]-ABS[#1 MOD 7]]"]
    passes = LINES // 10
    loop = ["#1=0", f"o1 while [#1 LT {passes}]", "G1 X[#<r>*COS[#1]] Y[#<r>*SIN[#1]]", "#1=[#1+1]", "o1 endwhile"]
    rows = []
    for name, lines, count in [("plain G1", plain, LINES), ("expressions", expressions, len(expressions)),
                               ("loop", loop, 4 * passes)]:
        program = home / "decoded.ngc"
        program.write_text("\n".join(["G21 G90 F6000", "#<r>=50", *lines, "M2"]) + "\n")
        ours = user_s([decoder, program]) if decoder.exists() else None
        peer = user_s(["rs274", "-g", program], env={**os.environ, "HOME": str(home)}) if shutil.which("rs274") else None
        rates = ["–" if seconds is None else f"{count / seconds:,.0f}" for seconds in (ours, peer)]
        rows.append([name, f"{count:,}", *rates, f"{peer / ours:.1f}" if ours and peer else "–"])
    table("Decoding, lines/s", ["program", "lines", "twin", "rs274", "ratio"], rows)


def of_length(twin: pathlib.Path, home: pathlib.Path) -> None:
    program = home / "long.ngc"
    rows = []
    for lines in [1000, LINES]:
        with program.open("w") as file:
            file.write("G21 G90 F6000\n")
            for number in range(lines):
                file.write(f"G1 X{100 + number % 7 * 5}.{number % 10} Y{100 + number % 11 * 3}\n")
        seconds, memory, _ = run([twin, "check", program, "--machine", ROOT / "machines/gantry3.toml",
                                  "--limits", "programmed"])
        rate = "failed" if seconds is None else f"{lines / max(seconds, 1e-3):,.0f}"
        rows.append([f"{lines:,}", shown(seconds), rate, f"{memory / 1000:.0f}"])
    table("Length, gantry3, check --limits programmed", ["lines", "user s", "lines/s", "MB"], rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--twin", type=pathlib.Path, required=True, help="the program, built with --release")
    parser.add_argument("--install", action="store_true", help="install the peers first")
    parser.add_argument("files", nargs="*", type=pathlib.Path, help="RS274 programs and drawings (.dxf)")
    arguments = parser.parse_args()
    twin = arguments.twin.resolve()
    peers = ROOT / "target/peers"
    if arguments.install:
        install(peers)
    drawings = [file for file in arguments.files if file.suffix.lower() == ".dxf"] or DRAWINGS
    programs = [file for file in arguments.files if file.suffix.lower() != ".dxf"] or PROGRAMS
    with tempfile.TemporaryDirectory() as home:
        of_programs(twin, programs, pathlib.Path(home))
        of_drawings(twin, drawings, ezdxf_python(peers))
        of_machines(twin, pathlib.Path(home))
        of_decoding(twin, pathlib.Path(home))
        of_length(twin, pathlib.Path(home))


if __name__ == "__main__":
    main()
