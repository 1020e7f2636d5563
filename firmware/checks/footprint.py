#!/usr/bin/env python3
"""Prints as Markdown what each method takes at 320 px and 48 disparities: flash is `.text + .rodata` of a program with one
method less the same with one that does nothing, and less what copies and fills memory, which every program has; of it the
functions of evidence, by their modules; RAM is its state and how deep its pushes need the stack, counted alike.

usage: firmware/checks/footprint.py [METHOD[=MOST]...]

Fails if a method takes more than MOST bytes of flash.

Needs cargo, the target thumbv7em-none-eabihf and qemu-system-arm.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

from elf_file import SIZE, ElfFile

ROOT = Path(__file__).parents[2]
METHODS = ["lite", "full", "block", "sgm"]
TARGET = "thumbv7em-none-eabihf"
BUILD = ["cargo", "build", "--quiet", "-p", "haarline-firmware", "--profile", "firmware", "--target", TARGET,
         "--no-default-features", "--features", "twin", "--bin", "footprint"]


# Functions of the compiler's that every program has, and the modules that tell what an answer is worth.
MEMORY = re.compile(r"^(__aeabi_)?mem(cpy|move|set|clr|cmp)[48]?$|compiler_builtins3mem")
EVIDENCE = re.compile(r"8evidence|13evidence_rows|10repetition|13frame_figures")


def flash(elf):
    """Bytes of `.text` and `.rodata`."""
    return sum(head[SIZE] for name, head in elf.sections() if name in [".text", ".rodata"])


def functions(elf, pattern):
    """Bytes of the functions whose mangled names match; each once, however many names it has."""
    return sum({address: size for name, address, size in elf.functions() if pattern.search(name)}.values())


def measure(method):
    """Bytes of flash, of it evidence, state and stack."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    subprocess.run(BUILD, cwd=ROOT, env={**os.environ, "HAARLINE_FOOTPRINT": method}, check=True)
    elf = target / TARGET / "firmware" / "footprint"
    qemu = ["qemu-system-arm", "-machine", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "none",
            "-semihosting-config", "enable=on,target=native", "-kernel", elf]
    done = subprocess.run(qemu, capture_output=True, text=True, timeout=300)
    words = done.stdout.split()
    if done.returncode != 0 or words[0::2] != ["state", "stack", "rows"] or int(words[5]) == 0:
        sys.exit(f"{method}: the program does not tell: {done.stdout}{done.stderr}")
    program = ElfFile(elf)
    own = flash(program) - functions(program, MEMORY)
    return own, functions(program, EVIDENCE), int(words[1]), int(words[3])


def main():
    methods = dict((*word.split("=", 1), None)[:2] for word in sys.argv[1:] or METHODS)
    if not set(methods) <= set(METHODS) or not all(most is None or most.isdigit() for most in methods.values()):
        sys.exit(__doc__.strip())
    over = []
    nothing = measure("null")
    print("| method | flash, B | of it evidence, B | state, B | stack of a push, B | RAM, B |")
    print("| --- | ---: | ---: | ---: | ---: | ---: |")
    for method, most in methods.items():
        code, evidence, state, stack = measure(method)
        taken, depth = code - nothing[0], stack - nothing[3]
        print(f"| {method} | {taken} | {evidence} | {state} | {depth} | {state + depth} |", flush=True)
        if most is not None and taken > int(most):
            over.append(f"{method}: {taken} bytes of flash, more than {most}")
    sys.exit("\n".join(over) or None)


main()
