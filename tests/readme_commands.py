#!/usr/bin/env python3
"""Runs the README's commands as they are written: in a fresh clone, and in an empty folder with the installed tool.

Usage: readme_commands.py [REPOSITORY]. What cargo builds goes into CARGO_TARGET_DIR, if that is set."""

import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# What a user has of his own: made of what the demo rendered.
OWN = {"recording/left/0001.png": "left.png", "recording/right/0001.png": "right.png"}
# And a calibration of these cameras, as OpenCV writes one.
CALIBRATION = """%YAML:1.0
---
image_width: 320
image_height: 240
K1: !!opencv-matrix
   { rows: 3, cols: 3, dt: d, data: [ 280., 0., 159.5, 0., 280., 119.5, 0., 0., 1. ] }
D1: !!opencv-matrix
   { rows: 1, cols: 5, dt: d, data: [ 0., 0., 0., 0., 0. ] }
K2: !!opencv-matrix
   { rows: 3, cols: 3, dt: d, data: [ 280., 0., 159.5, 0., 280., 119.5, 0., 0., 1. ] }
D2: !!opencv-matrix
   { rows: 1, cols: 5, dt: d, data: [ 0., 0., 0., 0., 0. ] }
R: !!opencv-matrix
   { rows: 3, cols: 3, dt: d, data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ] }
T: !!opencv-matrix
   { rows: 3, cols: 1, dt: d, data: [ -60., 0., 0. ] }
"""


def commands(readme):
    """The lines of its shell blocks, continued ones as one; comments stay, a shell skips them."""
    text = readme.read_text().replace("\\\n", "")
    blocks = re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line.strip()]


def run(line, folder, environment):
    begin = time.monotonic()
    done = subprocess.run(line, shell=True, cwd=folder, env=environment, capture_output=True, text=True)
    print(f"{done.returncode}, {time.monotonic() - begin:.1f} s: {line}", flush=True)
    if done.returncode != 0:
        sys.exit(f"in {folder}: {line}\n{done.stdout}{done.stderr}")


def lay_out(folder, rendered):
    for name, view in OWN.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(rendered / view, folder / name)
    (folder / "calibration.yml").write_text(CALIBRATION)


repository = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[1]).resolve()
with tempfile.TemporaryDirectory() as name:
    clone, empty, installed = (Path(name) / part for part in ["clone", "empty", "installed"])
    subprocess.run(["git", "clone", "--quiet", repository, clone], check=True)
    empty.mkdir()
    environment = {**os.environ, "CARGO_INSTALL_ROOT": str(installed), "PATH": f"{installed}/bin:{os.environ['PATH']}"}
    lines = commands(clone / "README.md")
    if not any(line.startswith("cargo install") for line in lines) or len(lines) < 5:
        sys.exit(f"the README has no commands to try: {lines}")

    for line in lines:
        run(line, clone, environment)
        if (clone / "out/demo/left.png").exists():
            lay_out(clone, clone / "out/demo")
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN)
    target = Path(os.environ.get("CARGO_TARGET_DIR", clone / "target"))
    size = sum(file.stat().st_size for file in target.rglob("*") if file.is_file())
    print(f"the clone: {seconds.ru_utime + seconds.ru_stime:.0f} s of processor time, {target}: {size >> 20} MiB")

    # Everything but cargo's lines works without the sources.
    shutil.rmtree(clone)
    run("haarline demo", empty, environment)
    lay_out(empty, empty / "out/demo")
    for line in lines:
        if not line.startswith("cargo"):
            run(line, empty, environment)
    said = subprocess.run("haarline twin out/demo/left.png out/demo/right.png", shell=True, cwd=empty, env=environment,
                          capture_output=True, text=True)
    if said.returncode != 2 or "cargo twin" not in said.stderr or said.stderr.count("\n") != 1:
        sys.exit(f"haarline twin does not say how its program is built: {said}")
