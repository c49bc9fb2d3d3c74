#!/usr/bin/env python3
"""Load test of the page: README's run with emulated drives while clients of the live view misbehave on the same computer.

    tests/speed/page_load.py --twin target/release/twin

Clients, all at once until the run has ended: 200 connections, of which some send nothing, some half a request and some a huge
head; two processes that ask for the page as fast as they are answered, 5,000 times per second together at most; Chromium without
a screen, if it is installed. The run has to end with status 0 after Ctrl-C, and the page within 0.5 s of it. A table has cycle
lateness, longest gap between samples, largest error and memory, without and with the clients.
"""

import argparse
import json
import multiprocessing
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM, MACHINE = ROOT / "examples/plate.cnc", ROOT / "machines/scara2.toml"
CONNECTIONS = 200
FLOODS, BATCH, BATCHES_PER_S = 2, 25, 100
LONGEST_END_S = 0.5


def flood(address: tuple[str, int], count) -> None:
    """Asks for the page in batches, on one connection after another."""
    request = f"GET / HTTP/1.1\r\nHost: {address[0]}:{address[1]}\r\n\r\n".encode() * BATCH
    while True:
        try:
            with socket.create_connection(address, timeout=2) as client:
                while True:
                    begun = time.monotonic()
                    client.sendall(request)
                    answers = 0
                    while answers < BATCH:
                        got = client.recv(1 << 20)
                        if not got:
                            raise ConnectionError
                        answers += got.count(b"HTTP/1.1 ")
                    with count.get_lock():
                        count.value += answers
                    time.sleep(max(0.0, 1 / BATCHES_PER_S - (time.monotonic() - begun)))
        except OSError:
            time.sleep(0.01)


def slow(address: tuple[str, int]) -> list[socket.socket]:
    """Connections that stay open; those that the page refuses are closed by it."""
    head = f"GET / HTTP/1.1\r\nHost: {address[0]}:{address[1]}\r\n"
    texts = [b"", head[:20].encode(), head.encode() + b"X-Long: " + b"x" * 100_000,
             head.encode() + b"Content-Length: 99999999999\r\n\r\n"]
    clients = []
    for number in range(CONNECTIONS):
        client = socket.create_connection(address, timeout=2)
        clients.append(client)
        try:
            client.sendall(texts[number % len(texts)])
        except OSError:
            pass
    return clients


def memory_mb(process: int, key: str) -> float:
    status = pathlib.Path(f"/proc/{process}/status").read_text()
    return int(re.search(rf"{key}:\s+(\d+) kB", status)[1]) / 1000


def run(twin: pathlib.Path, folder: pathlib.Path, clients: bool) -> dict:
    report = folder / "report.json"
    report.unlink(missing_ok=True)
    command = [twin, "run", PROGRAM, "--machine", MACHINE, "--serve", "127.0.0.1:0", "--report", report]
    process = subprocess.Popen([str(part) for part in command], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
    text = ""
    for line in process.stderr:
        text += line
        if found := re.search(r"http://(127\.0\.0\.1):(\d+)", line):
            break
    else:
        sys.exit(f"no page:\n{text}")
    address = (found[1], int(found[2]))
    count, others, browser, open_clients = multiprocessing.Value("q", 0), [], None, []
    begun = time.monotonic()
    if clients:
        if chromium := shutil.which("chromium") or shutil.which("google-chrome"):
            browser = subprocess.Popen(
                [chromium, "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
                 "--enable-unsafe-swiftshader", f"--user-data-dir={folder}/browser", "--remote-debugging-port=0", found[0]],
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        open_clients = slow(address)
        others = [multiprocessing.Process(target=flood, args=(address, count), daemon=True) for _ in range(FLOODS)]
        for other in others:
            other.start()
    while not report.exists() and process.poll() is None:
        time.sleep(0.05)
    ran_s, peak = time.monotonic() - begun, memory_mb(process.pid, "VmHWM")
    process.send_signal(signal.SIGINT)
    asked = time.monotonic()
    _, rest = process.communicate(timeout=60)
    end_s = time.monotonic() - asked
    for other in others:
        other.terminate()
    if browser:
        os.killpg(browser.pid, signal.SIGKILL)
        browser.wait()
    for client in open_clients:
        client.close()
    if not report.exists():
        sys.exit(f"status {process.returncode}:\n{text}{rest}")
    found = json.loads(report.read_text())
    return {"status": process.returncode, "clients": clients, "browser": bool(browser), "requests_per_s": count.value / ran_s, "end_s": end_s,
            "memory_mb": peak, "lateness": found["cycle_lateness"],
            "gap_ms": found["drive_samples"]["longest_gap_ms"], "drives_mm": found["tool_error_mm"]["drives"]["max"]}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--twin", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        rows = [run(arguments.twin.resolve(), pathlib.Path(folder), clients) for clients in (False, True)]
    print("status  clients  browser  requests/s  99 % late  latest    longest gap  drives off  memory   page ends within")
    for row in rows:
        late = row["lateness"]
        print(f"{row['status']:<7} {'yes' if row['clients'] else 'no':<8} {'yes' if row['browser'] else 'no':<8} {row['requests_per_s']:10.0f}"
              f"  {late['p99_us']:6.0f} µs  {late['max_us']:5.0f} µs  {row['gap_ms']:8.1f} ms  {row['drives_mm']:7.3f} mm"
              f"  {row['memory_mb']:4.0f} MB  {row['end_s']:.2f} s")
    if not all(row["browser"] for row in rows if row["clients"]):
        print("without a browser: there is no chromium here")
    if not all(row["requests_per_s"] > 100 for row in rows if row["clients"]):
        sys.exit("hardly a request is answered")
    if any(row["status"] != 0 or row["end_s"] > LONGEST_END_S for row in rows):
        sys.exit("a run has failed, or its page ends too late")


if __name__ == "__main__":
    main()
