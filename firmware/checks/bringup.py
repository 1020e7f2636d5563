#!/usr/bin/env python3
"""Shows that the program `bringup` says the right thing of a rig in which all is well, and of each mistake in its wires: runs
it on an emulated STM32H743 with two MT9V034, and prints as Markdown what it says of which mistake.

usage: firmware/checks/bringup.py

Builds the program and the emulator. ARM_TOOLCHAIN names a toolchain with the target thumbv7em-none-eabihf, if the usual one has
it not.
"""

import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# What is built here runs at the clock of the emulated chip, whatever else would do for the rig.
os.environ.setdefault("HAARLINE_CLOCK_MHZ", "480")

ROOT = Path(__file__).resolve().parents[2]
TARGET = "thumbv7em-none-eabihf"
TARGET_DIR = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
ARM_TOOLCHAIN = os.environ.get("ARM_TOOLCHAIN")
ARM_DIR = TARGET_DIR / "arm" if ARM_TOOLCHAIN else TARGET_DIR
EMULATOR, HAARLINE = TARGET_DIR / "release" / "haarline-emulator", TARGET_DIR / "release" / "haarline"

# A mistake, what it is in words, and the first complaint about it: its step and some of its words.
MISTAKES = [
    ("no-crystal", "no 8 MHz from the debugger", 1, "no 8 MHz at the crystal's input"),
    ("no-master-clock", "PA8 open", 2, "nobody answers on I2C bus 1"),
    ("mute:1", "first sensor's I2C open", 2, "nobody answers on I2C bus 1: PB8, PB9"),
    ("mute:2", "second sensor's I2C open", 2, "nobody answers on I2C bus 2: PF1, PF0"),
    ("another:2", "second sensor is an MT9V032", 3, "sensor 2 is no MT9V034 but says 0x1313"),
    ("no-pixel-clock", "PA6 open", 4, "the pixel clock's wire"),
    ("no-trigger", "PB4 open", 4, "the trigger's wire"),
    ("no-lines", "PA4 open", 4, "the line signal's wire"),
    ("no-frames", "PG9 open", 4, "the frame signal's wire"),
    ("stuck-low:5", "D5 to ground", 5, "D5 is always low"),
    ("stuck-high:9", "D9 to 3.3 V", 5, "D9 is always high"),
    ("swapped:2:3", "D2 and D3 exchanged", 5, "D2 and D3 are exchanged"),
    ("shorted:11:12", "D11 touches D12", 5, "D11 and D12 touch each other"),
    ("crossed-buses", "I2C of the two sensors exchanged", 5, "each sensor is on the other one's I2C bus"),
    ("out-of-phase:3", "second sensor three clocks late", 6, "the second sensor is 3 pixel clocks late"),
]


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{Path(command[0]).name}, exit status {done.returncode}: {done.stderr.strip()[-2000:]}")
    return done.stdout


def build(folder):
    rig = folder / "rig.toml"
    cargo = lambda *words, cwd=ROOT, **variables: run("cargo", *words, cwd=cwd, env={**os.environ, **variables})
    cargo("build", "--quiet", "--release", "-p", "haarline-sim", CARGO_TARGET_DIR=str(TARGET_DIR))
    cargo("build", "--quiet", "--release", "--ignore-rust-version", cwd=ROOT / "firmware" / "emulator",
          CARGO_TARGET_DIR=str(TARGET_DIR))
    run(HAARLINE, "rig", "new", rig)
    text = re.sub(r'^wiring = .*$', 'wiring = "pairs14"', rig.read_text(), flags=re.M)
    # A small and fast picture: the run is over sooner.
    for field, value in {"height": 48, "frame_rate_hz": 60, "exposure_lines": 8}.items():
        text = re.sub(rf"^{field} = .*$", f"{field} = {value}", text, flags=re.M)
    rig.write_text(text)
    toolchain = {"RUSTUP_TOOLCHAIN": ARM_TOOLCHAIN} if ARM_TOOLCHAIN else {}
    cargo("build", "--quiet", "-p", "haarline-firmware", "--release", "--target", TARGET, "--bin", "bringup",
          CARGO_TARGET_DIR=str(ARM_DIR), HAARLINE_RIG=str(rig), **toolchain)
    elf = folder / "bringup.elf"
    elf.write_bytes((ARM_DIR / TARGET / "release" / "bringup").read_bytes())
    return elf


def said(folder, elf, mistake):
    """The verdicts' lines, and the bytes of the picture."""
    name = (mistake or "nothing").replace(":", "_")
    log, rows = folder / f"{name}.log", folder / f"{name}.rows"
    words = ["--wires", mistake] if mistake else []
    run(EMULATOR, elf, *words, "--frames", 1000, "--limit", 1500, "--log", log, "--rows", rows)
    text = log.read_text()
    if "bringup: " not in text:
        sys.exit(f"{name}: it never ends:\n{text}")
    return re.findall(r"(?:info|error) (step \d (?:ok|WRONG): .*)", text), rows.read_bytes()


def verdict(folder, elf, mistake):
    name, what, step, words = mistake
    lines, _ = said(folder, elf, name)
    wrong = [line for line in lines if "WRONG" in line]
    first = wrong[0] if wrong else "nothing"
    good = first.startswith(f"step {step} ") and words in first
    return good, f"| {what} | {first.replace(' WRONG', '')} |", "\n".join(lines)


def main():
    if len(sys.argv) > 1:
        sys.exit(__doc__.strip())
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        elf = build(folder)
        lines, picture = said(folder, elf, None)
        print("\n".join(lines))
        if any("WRONG" in line for line in lines) or len(lines) < 9 or len(picture) != 2 * 320 * 48:
            print(f"FAILED: a good rig is complained of, or its picture has {len(picture)} bytes")
            failed += 1
        print("\n| mistake | the first complaint |\n| --- | --- |")
        with ThreadPoolExecutor(2) as pool:
            for good, row, all_lines in pool.map(lambda mistake: verdict(folder, elf, mistake), MISTAKES):
                print(row, flush=True)
                if not good:
                    print(f"FAILED, it said:\n{all_lines}")
                    failed += 1
    sys.exit(1 if failed else 0)


main()
