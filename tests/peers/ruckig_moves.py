#!/usr/bin/env python3
"""Time per move of Ruckig's C++ library, which its wheel comes with: headers and an archive.

Usage: ruckig_moves.py PROGRAM FILE. Compiles ruckig_moves.cpp beside it to PROGRAM, with the compiler CXX or c++, unless
it is there already, and runs it with the moves of FILE.
"""

import os
import pathlib
import subprocess
import sys

import ruckig

program, moves = sys.argv[1:]
if not pathlib.Path(program).exists():
    site = pathlib.Path(ruckig.__file__).parent
    archives = [site / folder / "libruckig.a" for folder in ("lib", "lib64")]
    archive = next(path for path in archives if path.exists())
    source = pathlib.Path(__file__).with_suffix(".cpp")
    compiler = os.environ.get("CXX", "c++")
    options = ["-std=c++20", "-O3", "-DNDEBUG", f"-I{site / 'include'}", "-o", program]
    subprocess.run([compiler, *options, str(source), str(archive)], check=True)
subprocess.run([program, moves], check=True)
