#!/usr/bin/env python3
"""Shows that `haarline silicon` and the board's program `bench` do what they shall, on an emulated STM32H743: every method on
three pairs, every row compared, a table written; and the same result where one byte in a hundred is lost or flipped.

usage: firmware/checks/silicon.py SCENES TWIN [ROWS]

SCENES is a folder of scenes; the upper ROWS rows (16 unless told) of the first three are sent. TWIN is the ELF file of `twin`.
ARM_TOOLCHAIN names a toolchain with the target thumbv7em-none-eabihf, if the usual one has it not. Needs opencv-python-headless.
"""

import os
import random
import re
import socket
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import cv2

# What is built here runs at the clock of the emulated chip, whatever else would do for the rig.
os.environ.setdefault("HAARLINE_CLOCK_MHZ", "480")

ROOT = Path(__file__).resolve().parents[2]
TARGET = "thumbv7em-none-eabihf"
TARGET_DIR = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
ARM_TOOLCHAIN = os.environ.get("ARM_TOOLCHAIN")
ARM_DIR = TARGET_DIR / "arm" if ARM_TOOLCHAIN else TARGET_DIR
EMULATOR, HAARLINE = TARGET_DIR / "release" / "haarline-emulator", TARGET_DIR / "release" / "haarline"
METHODS = ["full", "lite", "wavelet-block", "block", "sgm"]
# Longer than any run takes, ms of the chip's time.
LIMIT = 100_000_000


def build():
    toolchain = {"RUSTUP_TOOLCHAIN": ARM_TOOLCHAIN} if ARM_TOOLCHAIN else {}
    program = ["-p", "haarline-firmware", "--target", TARGET, "--bin", "bench"]
    for words, folder, variables in [
        (["-p", "haarline-sim"], ROOT, {"CARGO_TARGET_DIR": str(TARGET_DIR)}),
        (["--ignore-rust-version"], ROOT / "firmware" / "emulator", {"CARGO_TARGET_DIR": str(TARGET_DIR)}),
        (program, ROOT, {"CARGO_TARGET_DIR": str(ARM_DIR), **toolchain}),
    ]:
        subprocess.run(["cargo", "build", "--quiet", "--release", *words], cwd=folder, env={**os.environ, **variables}, check=True)
    return ARM_DIR / TARGET / "release" / "bench"


def scenes(source, folder, rows):
    """The upper rows of the first three scenes."""
    names = sorted(path.parent.name for path in source.glob("*/left.png"))[:3]
    if len(names) < 3:
        sys.exit(f"{source}: no three scenes")
    for name in names:
        (folder / name).mkdir(parents=True)
        for file in ["left.png", "right.png"]:
            cv2.imwrite(str(folder / name / file), cv2.imread(str(source / name / file), cv2.IMREAD_GRAYSCALE)[:rows])
        for file in ["truth.png", "meta.json"]:
            (folder / name / file).write_bytes((source / name / file).read_bytes())
    return folder


class Chip:
    """The emulated board, and the address of its serial port."""

    def __init__(self, elf):
        command = [EMULATOR, elf, "--host", "0", "--limit", str(LIMIT)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.port = int(re.search(r":(\d+)", self.process.stdout.readline())[1])

    def end(self):
        self.process.kill()
        self.process.wait()


class Lossy:
    """A wire to a port that loses or flips one byte in a hundred, either way."""

    def __init__(self, port):
        self.random, self.spoilt = random.Random(1), 0
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.serve, args=[port], daemon=True).start()

    def serve(self, port):
        near, _ = self.listener.accept()
        far = socket.create_connection(("127.0.0.1", port))
        for source, sink in [(near, far), (far, near)]:
            threading.Thread(target=self.pump, args=[source, sink], daemon=True).start()

    def pump(self, source, sink):
        try:
            while data := source.recv(4096):
                sink.sendall(bytes(self.spoil(data)))
        except OSError:
            pass

    def spoil(self, data):
        for byte in data:
            if self.random.random() >= 0.01:
                yield byte
                continue
            self.spoilt += 1
            if self.random.random() < 0.5:
                yield byte ^ self.random.randrange(1, 256)


def silicon(port, folder, table, *words):
    command = [HAARLINE, "silicon", "--port", f"127.0.0.1:{port}", folder, "-o", table, *words]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr}{done.stdout}")
    return done.stdout, table.read_text()


def figures(table):
    """Of each method its name, scenes, cycles a pixel without what an interrupted wait may shift, state, and verdict."""
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines()[2:]]
    return [(row[4], row[5], round(float(row[6])), row[11], row[-1]) for row in rows]


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__.strip())
    source, twin = Path(sys.argv[1]), Path(sys.argv[2])
    rows = int(sys.argv[3]) if len(sys.argv) == 4 else 16
    elf = build()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        pairs = scenes(source, folder / "scenes", rows)
        chip = Chip(elf)
        try:
            told, table = silicon(chip.port, pairs, folder / "table.md", "--twin", twin)
            print(table)
            found = figures(table)
            if [row[0] for row in found] != METHODS or any(row[-1] != "equal" for row in found):
                sys.exit("not every method has a row with equal maps")
            if "asked again 0 times" not in told:
                print(re.search(r"asked again .*", told)[0])
            wire = Lossy(chip.port)
            told, again = silicon(wire.port, pairs, folder / "again.md", "--again", 60)
            print(f"{wire.spoilt} bytes lost or flipped, {re.search(r'asked again .*', told)[0]}")
            if wire.spoilt < 100 or figures(again) != found:
                sys.exit(f"with bytes lost the table is another one:\n{again}")
        finally:
            chip.end()


main()
