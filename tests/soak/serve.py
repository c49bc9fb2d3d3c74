#!/usr/bin/env python3
"""Memory of a long run with its live view: `twin run --drives emulated --serve`, with a client that reads along.

    tests/soak/serve.py --twin target/release/twin                 an hour
    tests/soak/serve.py --twin target/debug/twin --minutes 10

The program is a circle of short lines on gantry3, in real time. The client fetches the page every 10 s and reads the
recording as it grows. Resident memory (VmRSS) is sampled every 10 s. Exit status 1: the mean of the last quarter is
more than 5 % and 3 MB above that of the second, the run ends early, or the stream has a gap of more than 5 s.

- "pages": fetches of the page. "stream": bytes of the recording that the client has read.
- "longest gap": time between two pieces of the recording.
"""

import argparse
import contextlib
import math
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PERIOD_S = 10.0
LINES_PER_S = 25         # of 0.4 mm, at 10 mm/s
RATIO, MARGIN_MB = 1.05, 3.0
LONGEST_GAP_S = 5.0
START_S = 900.0          # most time for the check of the program


def write_program(path: pathlib.Path, minutes: float) -> None:
    """Writes a circle of short lines that takes 2 % and 2 minutes longer than the run."""
    count = int(LINES_PER_S * (60 * minutes * 1.02 + 120))
    with path.open("w", encoding="utf-8") as file:
        file.write("G21 G90 F600\n")
        for number in range(1, count):
            turn = number * 0.01
            file.write(f"G1 X{300 + 40 * math.sin(turn):.4f} Y{40 * math.cos(turn) - 40:.4f}\n")
        file.write("M2\n")


def resident_mb(process: subprocess.Popen) -> float:
    status = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8")
    return int(re.search(r"^VmRSS:\s+(\d+) kB", status, flags=re.MULTILINE)[1]) / 1000


class Stream(threading.Thread):
    """Reader of the recording."""

    def __init__(self, url: str) -> None:
        super().__init__(daemon=True)
        self.url, self.bytes, self.longest_gap_s = url, 0, 0.0
        self.last_s = time.monotonic()

    def run(self) -> None:
        with contextlib.suppress(OSError), urllib.request.urlopen(f"{self.url}recording.rrd") as answer:
            while piece := answer.read1(1 << 16):
                now_s = time.monotonic()
                self.longest_gap_s = max(self.longest_gap_s, now_s - self.last_s)
                self.bytes, self.last_s = self.bytes + len(piece), now_s


def wait_for(pattern: str, process: subprocess.Popen, output: pathlib.Path) -> str:
    """First group of a pattern, once the run has printed it."""
    end_s = time.monotonic() + START_S
    while time.monotonic() < end_s and process.poll() is None:
        if found := re.search(pattern, output.read_text(encoding="utf-8")):
            return found[1]
        time.sleep(0.1)
    sys.exit(f"the run does not begin:\n{output.read_text(encoding='utf-8')}")


def sample(process: subprocess.Popen, url: str, stream: Stream, minutes: float) -> list[float]:
    """Memory every 10 s, MB, with a fetch of the page before each; ends early with the process or the stream."""
    samples, start_s = [], time.monotonic()
    print("\n| min | VmRSS, MB | stream, MB |\n|---|---|---|")
    for count in range(1, int(60 * minutes / PERIOD_S) + 1):
        time.sleep(max(0.0, start_s + PERIOD_S * count - time.monotonic()))
        if process.poll() is not None or not stream.is_alive():
            break
        with urllib.request.urlopen(url) as page:
            page.read()
        samples.append(resident_mb(process))
        if PERIOD_S * count % 60 == 0:
            print(f"| {PERIOD_S * count / 60:.0f} | {samples[-1]:.1f} | {stream.bytes / 1e6:.1f} |", flush=True)
    return samples


def judge(samples: list[float], stream: Stream, minutes: float) -> list[str]:
    """Prints the figures; what is wrong with them."""
    wanted = int(60 * minutes / PERIOD_S)
    if len(samples) < wanted:
        return [f"run or stream ended after {len(samples)} of {wanted} samples"]
    quarter = wanted // 4
    second = sum(samples[quarter:2 * quarter]) / quarter
    last = sum(samples[-quarter:]) / quarter
    limit = RATIO * second + MARGIN_MB
    step = max(abs(after - before) for before, after in zip(samples, samples[1:]))
    first = samples[min(len(samples), int(60 / PERIOD_S)) - 1]
    print(f"\nat 1 min {first:.1f} MB, at the end {samples[-1]:.1f} MB, most {max(samples):.1f} MB, largest step {step:.1f} MB")
    print(f"second quarter {second:.1f} MB, last quarter {last:.1f} MB, limit {limit:.1f} MB")
    print(f"pages {len(samples)}, stream {stream.bytes / 1e6:.1f} MB, longest gap {stream.longest_gap_s:.2f} s")
    wrong = [f"the last quarter needs {last:.1f} MB, the limit is {limit:.1f} MB"] if last > limit else []
    if stream.longest_gap_s > LONGEST_GAP_S:
        wrong.append(f"the stream paused for {stream.longest_gap_s:.1f} s, the limit is {LONGEST_GAP_S:.0f} s")
    return wrong


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--twin", type=pathlib.Path, required=True, help="the program")
    parser.add_argument("--minutes", type=float, default=60.0, help="duration of the run, 1 at least [default: 60]")
    arguments = parser.parse_args()
    if not arguments.minutes >= 1:
        parser.error("--minutes: 1 is the least")
    with tempfile.TemporaryDirectory() as folder:
        program, output = pathlib.Path(folder) / "long.ngc", pathlib.Path(folder) / "output"
        write_program(program, arguments.minutes)
        command = [arguments.twin.resolve(), "run", program, "--machine", ROOT / "machines/gantry3.toml",
                   "--drives", "emulated", "--serve", "127.0.0.1:0"]
        with output.open("w", encoding="utf-8") as file:
            process = subprocess.Popen([str(part) for part in command], stdin=subprocess.DEVNULL, stdout=file,
                                       stderr=subprocess.STDOUT)
        try:
            url = wait_for(r"live view: (http://\S+)", process, output)
            stream = Stream(url)
            stream.start()
            wait_for(r"(way to the start)", process, output)
            samples = sample(process, url, stream, arguments.minutes)
            wrong = judge(samples, stream, arguments.minutes)
        finally:
            # The run brakes and ends; one that does not is killed.
            process.send_signal(signal.SIGINT)
            try:
                process.wait(timeout=30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        text = output.read_text(encoding="utf-8")
        print("\n".join(line for line in text.splitlines() if re.match(r"ran |cycles:|device ", line)))
        if not re.search(r"^stopped by the user", text, flags=re.MULTILINE):
            wrong.append(f"the run was not ended by this script:\n{text}")
    for line in wrong:
        print(line, file=sys.stderr)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
