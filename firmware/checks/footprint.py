#!/usr/bin/env python3
"""Prints as Markdown what each method takes at 320 px and 48 disparities: flash is `.text + .rodata` of a program with one
method less the same with one that does nothing; RAM is its state and how deep its pushes need the stack, counted alike.

usage: firmware/checks/footprint.py [METHOD[=MOST]...]

Fails if a method takes more than MOST bytes of flash.

Needs cargo, the target thumbv7em-none-eabihf and qemu-system-arm.
"""

import os
import struct
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
METHODS = ["lite", "full", "block", "sgm"]
TARGET = "thumbv7em-none-eabihf"
BUILD = ["cargo", "build", "--quiet", "-p", "haarline-firmware", "--profile", "firmware", "--target", TARGET,
         "--no-default-features", "--features", "twin", "--bin", "footprint"]


def flash(elf):
    """Bytes of `.text` and `.rodata`."""
    data = elf.read_bytes()
    offset, = struct.unpack_from("<I", data, 32)
    size, count, names = struct.unpack_from("<HHH", data, 46)
    heads = [struct.unpack_from("<10I", data, offset + size * nth) for nth in range(count)]
    start = heads[names][4]
    name = lambda head: data[start + head[0] : data.index(b"\0", start + head[0])].decode()
    return sum(head[5] for head in heads if name(head) in [".text", ".rodata"])


def measure(method):
    """Bytes of flash, state and stack."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    subprocess.run(BUILD, cwd=ROOT, env={**os.environ, "HAARLINE_FOOTPRINT": method}, check=True)
    elf = target / TARGET / "firmware" / "footprint"
    qemu = ["qemu-system-arm", "-machine", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "none",
            "-semihosting-config", "enable=on,target=native", "-kernel", elf]
    done = subprocess.run(qemu, capture_output=True, text=True, timeout=300)
    words = done.stdout.split()
    if done.returncode != 0 or words[0::2] != ["state", "stack", "rows"] or int(words[5]) == 0:
        sys.exit(f"{method}: the program does not tell: {done.stdout}{done.stderr}")
    return flash(elf), int(words[1]), int(words[3])


def main():
    methods = dict((*word.split("=", 1), None)[:2] for word in sys.argv[1:] or METHODS)
    if not set(methods) <= set(METHODS) or not all(most is None or most.isdigit() for most in methods.values()):
        sys.exit(__doc__.strip())
    over = []
    nothing = measure("null")
    print("| method | flash, B | state, B | stack of a push, B | RAM, B |\n| --- | ---: | ---: | ---: | ---: |")
    for method, most in methods.items():
        code, state, stack = measure(method)
        taken, depth = code - nothing[0], stack - nothing[2]
        print(f"| {method} | {taken} | {state} | {depth} | {state + depth} |", flush=True)
        if most is not None and taken > int(most):
            over.append(f"{method}: {taken} bytes of flash, more than {most}")
    sys.exit("\n".join(over) or None)


main()
